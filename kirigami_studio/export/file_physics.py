"""What a written cut file does to the sheet: pieces, smallest ligament, lengths cut twice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.export.profile import Profile
from kirigami_studio.export.slots import joined_ring
from kirigami_studio.export.strokes import Stroke
from kirigami_studio.fabricate.cut_plan import CutPlan, Layer
from kirigami_studio.fabricate.finished_sheet import overlap_length, remaining_pieces, smallest_ligament

#: Chord tolerance (mm) for measuring: well below the tolerance of finished widths.
MEASURED_CHORD_MM = 2e-4
#: Strokes that come as near as this (mm) are one cut.
TOUCH_MM = 1e-4


@dataclass(frozen=True, slots=True)
class Physics:
    """The sheet after cutting.

    Attributes
    ----------
    pieces : int
    min_ligament_mm : float or None
        None when there is nothing to measure.
    overlap_mm : float
    """

    pieces: int
    min_ligament_mm: float | None
    overlap_mm: float


def file_physics(strokes: Sequence[Stroke], plan: CutPlan, profile: Profile) -> Physics:
    """Cut the sheet along the strokes of a file.

    Parameters
    ----------
    strokes : sequence of Stroke
        As read, in file order.
    plan : CutPlan
        Its kerf, and which of the strokes are the outline (by number, for the names are the profile's).
    profile : Profile
    """
    outlines = 1 if profile.slots else len(plan.on_layer(Layer.OUTLINE))
    drawn = [stroke.drawn(MEASURED_CHORD_MM) for stroke in strokes]
    lines = [LineString(points) for points in drawn]
    inner, rim = lines[:-outlines], drawn[-outlines:]
    ring = rim[0][:-1] if outlines == 1 else joined_ring(rim)
    boundary = Polygon(ring)
    kerf = 0.0 if profile.slots else plan.kerf_mm
    loops = [Polygon(line) for line, stroke in zip(inner, strokes, strict=False) if stroke.closed]
    sheet: BaseGeometry = boundary.difference(shapely.union_all(loops))
    pieces = remaining_pieces(sheet, inner, kerf)
    cuts = _joined(inner, strokes, plan, profile)
    ligament = smallest_ligament(cuts, boundary.exterior, kerf) if cuts else None
    return Physics(len(pieces), None if ligament is None else ligament.width_mm, max(overlap_length(lines), 0.0))


def _joined(lines: list[LineString], strokes: Sequence[Stroke], plan: CutPlan, profile: Profile) -> list[BaseGeometry]:
    """Cuts as one geometry each: relief cuts belong to what they touch, slits of a removed connector to each other.

    Two slits that touch although every connector was kept stay two, so that nothing is left between them.
    """
    if not lines:
        return []
    relief = np.array([stroke.layer == Layer.RELIEF.value for stroke in strokes[: len(lines)]])
    if profile.one_layer and len(plan.paths) == len(strokes):
        relief = np.array([path.layer is Layer.RELIEF for path in plan.paths[: len(lines)]])
    one, other = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=TOUCH_MM)
    meant = relief[one] | relief[other] | bool(plan.options.removed)
    graph = coo_array((np.ones(int(meant.sum())), (one[meant], other[meant])), shape=(len(lines), len(lines)))
    _, group = connected_components(graph, directed=False)
    members: dict[int, list[LineString]] = {}
    for number, line in zip(group.tolist(), lines, strict=True):
        members.setdefault(number, []).append(line)
    return [parts[0] if len(parts) == 1 else shapely.multilinestrings(parts) for parts in members.values()]
