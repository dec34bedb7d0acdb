"""Do the cuts of a file lie where a cutter expects them: inside the outline, above the origin, the outline last?"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon

from kirigami_studio.export.dxf_content import FilePath
from kirigami_studio.fabricate.checks import Problem, Severity
from kirigami_studio.fabricate.cut_plan import Layer

#: Cuts may end this far (mm) beyond the outline: edge cuts run over it on purpose.
REACH_MM = 1.0
#: Contact with the outline below this (mm) is rounding.
TOUCH_MM = 1e-3


def placement_problems(paths: Sequence[FilePath], outline: Polygon | None) -> list[Problem]:
    """List cuts outside the outline, slits that cross it, coordinates below the origin, and cuts after the outline."""
    problems: list[Problem] = []
    low = np.concatenate([drawn.points for drawn in paths]).min(axis=0)
    if low.min() < -TOUCH_MM:
        text = f"Coordinates go down to ({low[0]:.2f}, {low[1]:.2f}); some machines cut off what lies below the origin."
        problems.append(Problem(text, Severity.WARNING))
    if outline is None:
        return problems
    inside, reach = outline.buffer(-TOUCH_MM), outline.buffer(REACH_MM)
    lines = [LineString(drawn.points) for drawn in paths]
    for drawn, line in zip(paths, lines, strict=True):
        x, y = drawn.points[0]
        if not line.within(reach):
            text = f"The cut at x = {x:.2f}, y = {y:.2f} leaves the sheet; move it inside the outline or delete it."
            problems.append(Problem(text, Severity.ERROR, (float(x), float(y))))
        elif drawn.layer == Layer.SLITS.value and not line.within(inside):
            text = f"The slit at x = {x:.2f}, y = {y:.2f} reaches the outline; no connector is left at its end."
            problems.append(Problem(text, Severity.ERROR, (float(x), float(y))))
    ring = outline.exterior.buffer(TOUCH_MM)
    on_ring = np.array([bool(shapely.within(line, ring)) for line in lines])
    if on_ring.any() and not on_ring[-1]:
        text = "Cuts come after the outline in the file; the sheet may move once it is free, so cut the outline last."
        problems.append(Problem(text, Severity.WARNING))
    return problems
