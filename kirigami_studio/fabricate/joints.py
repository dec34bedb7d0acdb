"""Where cuts meet on purpose: a slit ends on its relief hole, arc or bar, or, without a connector, on another slit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry import LineString

from kirigami_studio.fabricate.cut_path import measured_line
from kirigami_studio.fabricate.cut_plan import CutPath, CutPlan

#: Coordinates are rounded to half of this (mm): what is nearer touches.
TOUCH_MM = 2e-4

#: Numbers of two cuts, the lower one first.
Pair = tuple[int, int]


def joined_pairs(plan: CutPlan, paths: Sequence[CutPath], lines: Sequence[LineString]) -> set[Pair]:
    """Pairs of a plan's paths that meet on purpose: of one slit, or of two whose connector was removed.

    Two parts of a slit that has lost a connector to a notch meet within a kerf: the notch may end between them.
    """
    hinges = plan.hinges
    meant = {
        frozenset(pair)
        for pair in zip(hinges.cut[hinges.removed].tolist(), hinges.through[hinges.removed].tolist(), strict=True)
    }
    notched = {*hinges.cut[hinges.lost].tolist(), *hinges.through[hinges.lost].tolist()}
    cuts = [path.cut for path in paths]
    pairs = {
        (one, other)
        for one, other in touching(lines)
        if cuts[one] == cuts[other] or frozenset((cuts[one], cuts[other])) in meant
    }
    if notched:
        near = touching(lines, max(TOUCH_MM, plan.kerf_mm))
        pairs |= {(one, other) for one, other in near if cuts[one] == cuts[other] and cuts[one] in notched}
    return pairs


def joint_count(plan: CutPlan) -> int:
    """Number of ends of a plan's cuts that lie on another cut, the outline left out."""
    inner = plan.inner
    return len(ending_on_others([measured_line(path.points, path.bulges, path.closed) for path in inner]))


def touching(lines: Sequence[LineString], within_mm: float = TOUCH_MM) -> set[Pair]:
    """All pairs of lines (mm) that touch or cross, or come as near to each other as that."""
    shapes = np.array(lines, dtype=object)
    one, other = shapely.STRtree(shapes).query(shapes, "dwithin", within_mm)
    return {(first, second) for first, second in zip(one.tolist(), other.tolist(), strict=True) if first < second}


def ending_on_others(lines: Sequence[LineString]) -> list[Pair]:
    """For every end of an open line that lies on another line, which two they are."""
    both = np.array([[line.coords[0], line.coords[-1]] for line in lines]).reshape(-1, 2, 2)
    # A ring of a file may miss its own first point by a rounding error.
    open_lines = np.flatnonzero(np.linalg.norm(both[:, 1] - both[:, 0], axis=1) > TOUCH_MM)
    if not open_lines.size:
        return []
    ends = both[open_lines].reshape(-1, 2)
    end, line = shapely.STRtree(np.array(lines, dtype=object)).query(shapely.points(ends), "dwithin", TOUCH_MM)
    owner = np.repeat(open_lines, 2)[end]
    met = owner != line
    ordered = np.sort(np.stack([owner[met], line[met]], axis=1), axis=1)
    return [(int(first), int(second)) for first, second in ordered]
