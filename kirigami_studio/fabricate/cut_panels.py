"""The panels of a sheet as its cuts leave them, with bows, shaped ends and trimmed edges.

Cuts do not close around a panel: at every connector the material goes on into the next one.  There a panel ends at the
*neck*, the shortest line from the end of the slit to the cut that it rests on.  Cuts and necks together divide the
sheet; every part belongs to the panel that it has most area in common with.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt
import shapely

from kirigami_studio.fabricate.cut_path import Layer
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.slits import SHEET_EDGE
from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray

#: Necks reach over the cuts at both their ends by this (mm), so that rounding leaves no gap; no cut is as short as two.
BEYOND_MM = 1e-3
#: An edge nearer than this (mm) to a neck lies on it.
ON_NECK_MM = 1e-6
#: A part of the sheet that shares less of its area with every panel belongs to none.
OWN_SHARE = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class PanelLines:
    """Lines that each move with one panel."""

    points: FloatArray  #: (N, 2), mm; of all lines, one after the other
    ends: IntArray  #: (L,); where each line ends in ``points``
    panel: IntArray  #: (L,); number of the panel, row by row

    @classmethod
    def of(cls, lines: Sequence[tuple[int, FloatArray]]) -> PanelLines:
        """Lines (Q, 2) with the numbers of their panels."""
        points = np.concatenate([line for _, line in lines]) if lines else np.zeros((0, 2))
        ends = np.cumsum([len(line) for _, line in lines], dtype=np.intp)
        return cls(points, ends, np.array([number for number, _ in lines], dtype=np.intp))

    @property
    def owner(self) -> IntArray:
        """Number of the panel of every point: (N,) int."""
        owner: IntArray = np.repeat(self.panel, np.diff(self.ends, prepend=0))
        return owner

    def split(self, points: FloatArray) -> list[FloatArray]:
        """The lines (Q, 2) out of their points (N, 2), here or moved."""
        return np.split(points, self.ends[:-1]) if len(self.ends) else []


@dataclass(frozen=True, slots=True, eq=False)
class CutPanels:
    """All panels of a plan that are there, in its frame, arcs as chords."""

    outlines: PanelLines  #: one closed ring for each panel, along the centre lines of cuts and across necks
    cuts: PanelLines  #: its parts that are cut, necks left out, and the cuts that end inside a panel

    def numbered(self, count: int) -> list[FloatArray]:
        """Outlines (Q, 2) of ``count`` panels, row by row, without points for those that are not there."""
        found = [np.zeros((0, 2))] * count
        for number, ring in zip(self.outlines.panel.tolist(), self.outlines.split(self.outlines.points), strict=True):
            found[number] = ring
        return found

    def moved(self, shift: FloatArray) -> CutPanels:
        """The same panels in another frame."""
        moved = (PanelLines(part.points + shift, part.ends, part.panel) for part in (self.outlines, self.cuts))
        return CutPanels(*moved)


@lru_cache(maxsize=16)
def cut_panels(plan: CutPlan) -> CutPanels:
    """Divide a sheet into the panels that its cuts leave."""
    lines, _ = _lines(plan)
    ends = necks_of(plan)[1]
    more = ends[:, 1] - ends[:, 0]
    more *= BEYOND_MM / np.maximum(np.hypot(*more.T), BEYOND_MM)[:, None]
    necks = [
        shapely.LineString([tip - beyond, tip, foot, foot + beyond])
        for (tip, foot), beyond in zip(ends, more, strict=True)
    ]
    noded = shapely.union_all([*lines, *necks])
    faces, bridges, dangles, _ = shapely.polygonize_full(shapely.get_parts(noded))
    parts = shapely.get_parts(faces)
    panel = panels_of(parts, plan)
    rings: list[tuple[int, FloatArray]] = []
    for number in np.unique(panel[panel >= 0]).tolist():
        own = shapely.get_parts(shapely.union_all(parts[panel == number]))
        largest = own[np.argmax(shapely.area(own))]
        rings.append((number, shapely.get_coordinates(shapely.orient_polygons(largest).exterior)[:-1]))
    outlines = PanelLines.of(rings)
    loose = np.concatenate([shapely.get_parts(bridges), shapely.get_parts(dangles)])
    inside = _inside(loose[shapely.length(loose) > 2.0 * BEYOND_MM], rings)
    return CutPanels(outlines, PanelLines.of([*_along_cuts(outlines, necks), *inside]))


def _lines(plan: CutPlan) -> tuple[npt.NDArray[np.object_], IntArray]:
    """Centre lines of all cuts, tabs closed, and the number of the cut of each; -1 for rims."""
    # Holes are of no cut, as the outline is.
    paths = [*plan.inner, *plan.on_layer(Layer.HOLES)]
    closed = [path for path in plan.on_layer(Layer.OUTLINE) if path.closed]
    ring = closed[0].travelled if len(closed) == 1 else np.concatenate([plan.outline, plan.outline[:1]])
    lines = [*(shapely.LineString(path.travelled) for path in paths), shapely.LineString(ring)]
    return np.array(lines, dtype=object), np.array([*(path.cut for path in paths), SHEET_EDGE])


def necks_of(plan: CutPlan) -> tuple[IntArray, FloatArray]:
    """Where panels end at their connectors.

    Returns
    -------
    hinges : (N,) int
        Numbers of the connectors, removed ones left out.
    ends : (N, 2, 2) float, mm
        From the end of each one's slit to the nearest place of the cut that it rests on, on centre lines.
    """
    lines, owner = _lines(plan)
    groups = {number: shapely.multilinestrings(lines[owner == number].tolist()) for number in set(owner.tolist())}
    outline = groups[SHEET_EDGE]
    numbers, ends, hinges = [], [], plan.hinges
    for hinge in np.flatnonzero(~hinges.lost & (hinges.finished_mm > 0.0)).tolist():
        slit = groups.get(int(hinges.cut[hinge]))
        if slit is None:
            continue
        tip = shapely.get_coordinates(shapely.shortest_line(slit, shapely.Point(hinges.position[hinge])))[0]
        through = groups.get(int(hinges.through[hinge]), outline)
        # Where trimming took the cut that a slit rests on, the outline is in its place.
        against = through if through is outline else shapely.union(through, outline)
        foot = shapely.get_coordinates(shapely.shortest_line(against, shapely.Point(tip)))[0]
        numbers.append(hinge)
        ends.append([tip, foot])
    return np.array(numbers, dtype=np.intp), np.array(ends).reshape(-1, 2, 2)


def panels_of(parts: npt.NDArray[np.object_], plan: CutPlan) -> IntArray:
    """The panel that each part belongs to, -1 for none."""
    there = [number for number, panel in enumerate(plan.panels) if len(panel) > 2]
    ideal = np.array([shapely.make_valid(shapely.Polygon(plan.panels[number])) for number in there], dtype=object)
    part, near = shapely.STRtree(ideal).query(parts, "intersects")
    shared = shapely.area(shapely.intersection(parts[part], ideal[near]))
    found, most = np.full(len(parts), -1), OWN_SHARE * shapely.area(parts)
    for number, panel, area in zip(part.tolist(), near.tolist(), shared.tolist(), strict=True):
        if area > most[number]:
            found[number], most[number] = there[panel], area
    closed = [*plan.on_layer(Layer.RELIEF), *plan.on_layer(Layer.HOLES)]
    holes = [shapely.Polygon(path.flattened) for path in closed if path.closed]
    if holes:
        found[np.unique(shapely.STRtree(holes).query(shapely.point_on_surface(parts), "within")[0])] = -1
    return found


def _along_cuts(outlines: PanelLines, necks: Sequence[shapely.LineString]) -> list[tuple[int, FloatArray]]:
    """The parts of outlines between necks, closed lines where there are none."""
    following = np.concatenate([np.roll(ring, -1, axis=0) for ring in outlines.split(outlines.points)])
    middles = shapely.points(0.5 * (outlines.points + following))
    cut = np.ones(len(middles), dtype=np.bool_)
    if necks:
        cut[np.unique(shapely.STRtree(necks).query(middles, "dwithin", ON_NECK_MM)[0])] = False
    found = []
    masks = np.split(cut, outlines.ends[:-1])
    for number, ring, mask in zip(outlines.panel.tolist(), outlines.split(outlines.points), masks, strict=True):
        found += [(number, run) for run in _runs(ring, mask)]
    return found


def _runs(ring: FloatArray, cut: BoolArray) -> list[FloatArray]:
    """Lines (Q, 2) along the edges of a ring that are cut."""
    if cut.all():
        return [np.concatenate([ring, ring[:1]])]
    # Begin behind an edge that is none, so that no line runs over the ring's beginning.
    first = int(np.argmin(cut)) + 1
    ring, cut = np.roll(ring, -first, axis=0), np.roll(cut, -first)
    changes = np.flatnonzero(np.diff(cut.astype(np.int8), prepend=0))
    # The last edge is none: every line that begins ends.
    return [ring[start : stop + 1] for start, stop in zip(changes[::2].tolist(), changes[1::2].tolist(), strict=True)]


def _inside(loose: npt.NDArray[np.object_], rings: Sequence[tuple[int, FloatArray]]) -> list[tuple[int, FloatArray]]:
    """Cuts by the panel that they end in; what is cut beyond the outline is in none."""
    areas = [shapely.Polygon(ring) for _, ring in rings]
    middles = shapely.line_interpolate_point(loose, 0.5, normalized=True)
    pairs = shapely.STRtree(areas).query(middles, "within").T.tolist()
    return [(rings[place][0], shapely.get_coordinates(loose[line])) for line, place in pairs]
