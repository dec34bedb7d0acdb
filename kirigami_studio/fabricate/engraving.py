"""The name of a design on its cut sheet: one line of single strokes inside one panel, clear of everything that is cut.

Panels are whole ones, the largest first.  In each, the middle of the text is that of the largest circle in what is
free, once that was squeezed along the text until the text is as wide as it is high; there it is written as high as it
fits.  Upright letters may be somewhat smaller than those along a slanted edge would be.

An engraved name is no cut: lengths, times, pieces and widths of a plan do not count it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely.affinity import affine_transform
from shapely.geometry import LineString, Polygon

from kirigami_studio.fabricate.copies import DECIMALS
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.fabricate.lettering import Engraving, Lettering, lettered
from kirigami_studio.foundation.arrays import FloatArray

#: Capitals are at most and at least this high (mm), in steps of ``STEP_MM``.
LARGEST_MM, LEAST_MM, STEP_MM = 4.0, 1.0, 0.05
#: Material (mm) that stays between what the name and what a cut burns, a kerf wide each.
MARGIN_MM = 0.4
#: Distance of the line under a number from its foot, in heights of a capital.
UNDERLINE = 0.35
#: Panels that are tried.
MOST_PANELS = 16
#: Panels whose areas differ by less than this share of the largest one count as equally large.
SAME_AREA = 0.02
#: Text along a slanted edge has to be larger than upright text by this.
WORTH_A_TURN = 1.25
#: Text that climbs is turned by up to a right angle and this (radians), so that nearly upright edges read upwards.
MOST_TURNED = math.radians(100.0)
#: Directions nearer than this (radians) are tried once.
SAME_DIRECTION = math.radians(3.0)


@dataclass(frozen=True, slots=True)
class _Place:
    """Where a text fits: its middle (mm), its direction (radians), and how high its capitals are (mm)."""

    panel: int
    middle: tuple[float, float]
    turn: float
    height_mm: float

    @property
    def worth(self) -> float:
        return self.height_mm / (WORTH_A_TURN if self.turn else 1.0)


def engraved(plan: CutPlan, text: str) -> CutPlan:
    """The plan with a name on its sheet; with a note instead where it has no room for it.

    Parameters
    ----------
    text : str
        Letters without strokes are left out, and a note says so.
    """
    written = lettered(text)
    if not written.lines:
        return replace(plan, notes=(*plan.notes, Note.of("plan.name_without_letters", name=text)))
    notes = [Note.of("plan.name_letters_left_out", name=text, letters=written.missing)] if written.missing else []
    place = None
    for one in _places(plan, written):
        if place is None or one.worth > place.worth:
            place = one
        if place.worth >= LARGEST_MM:
            break
    if place is None:
        notes.append(Note.of("plan.name_without_room", name=text, least_mm=LEAST_MM))
        return replace(plan, notes=(*plan.notes, *notes))
    found = Engraving(written.text.strip(), place.height_mm, place.panel, _laid(written, place))
    return replace(plan, engraving=found, notes=(*plan.notes, *notes))


def written_in(area: Polygon, text: str) -> tuple[FloatArray, ...]:
    """Strokes (P, 2), mm, of an upright text as high as it fits into an area; none without room.

    The line under it says which side is down, so that 6 and 9 differ.
    """
    written = lettered(text)
    x = np.concatenate(written.lines)[:, 0]
    bar = np.array([[x.min(), -UNDERLINE], [x.max(), -UNDERLINE]])
    underlined = replace(written, lines=(*written.lines, bar))
    place = None if area.is_empty else _highest(0, area, _size(underlined), 0.0)
    return () if place is None else _laid(underlined, place)


def clearance_mm(kerf_mm: float) -> float:
    """Distance (mm) that strokes of a name keep from centre lines of cuts: half a kerf for either, and a margin."""
    return kerf_mm + MARGIN_MM


@dataclass(frozen=True, slots=True)
class Clearance:
    """How far a name is from what is cut."""

    distance_mm: float  #: between centre lines
    where: tuple[float, float]  #: (x, y), mm; on the name


def nearest_cut(names: Sequence[FloatArray], cuts: Sequence[FloatArray]) -> Clearance:
    """Where strokes of a name, one at least, come nearest to cuts, one at least: lines of points (P, 2), mm."""
    lines = np.array([LineString(points) for points in cuts])
    strokes = np.array([LineString(points) for points in names])
    (stroke, cut), distances = shapely.STRtree(lines).query_nearest(strokes, return_distance=True, all_matches=False)
    nearest = int(np.argmin(distances))
    between = shapely.shortest_line(strokes[stroke[nearest]], lines[cut[nearest]])
    x, y = shapely.get_coordinates(between)[0].tolist()
    return Clearance(float(distances[nearest]), (x, y))


def _places(plan: CutPlan, written: Lettering) -> Iterator[_Place]:
    """The highest place in each of the largest whole panels."""
    size = _size(written)
    clear = clearance_mm(plan.kerf_mm)
    cuts = np.array([LineString(path.travelled) for path in plan.paths])
    tree = shapely.STRtree(cuts)
    widths = np.where(plan.hinges.removed, 0.0, plan.hinges.requested_mm)
    hinges = shapely.buffer(shapely.points(plan.hinges.position.reshape(-1, 2)), widths + clear)
    for number in _largest(plan):
        panel = Polygon(plan.panels[number])
        near = cuts[tree.query(panel, predicate="dwithin", distance=clear)]
        taken = [*shapely.buffer(near, clear), *hinges[shapely.intersects(hinges, panel)]]
        parts = shapely.get_parts(panel.buffer(-clear).difference(shapely.union_all(taken)))
        free = max((part for part in parts if isinstance(part, Polygon)), key=lambda part: part.area, default=None)
        if free is None or free.is_empty:
            continue
        yield from (place for turn in _directions(panel) if (place := _highest(number, free, size, turn)) is not None)


def _size(written: Lettering) -> FloatArray:
    """Width and height (2,) that a text takes, in heights of a capital."""
    width, height = np.ptp(np.concatenate(written.lines), axis=0)
    # A text that is a line by itself ("-") is taken as high as it is wide, at most as high as a capital.
    size: FloatArray = np.maximum((width, height), min(max(width, height), 1.0))
    return size


def _largest(plan: CutPlan) -> list[int]:
    """Numbers of whole panels, the largest first; of equally large ones the lowest, then the leftmost."""
    whole = [number for number, panel in enumerate(plan.panels) if len(panel) == 4]
    if not whole:
        return []
    corners = np.array([plan.panels[number] for number in whole])
    area = shapely.area(shapely.polygons(corners))
    rank = np.floor((1.0 - area / area.max()) / SAME_AREA)
    middle = corners.mean(axis=1).round(1)
    order = np.lexsort((middle[:, 0], middle[:, 1], rank))
    return [whole[place] for place in order[:MOST_PANELS].tolist()]


def _directions(panel: Polygon) -> list[float]:
    """Upright, and along the panel's edges (radians), those that differ."""
    edges = np.diff(shapely.get_coordinates(panel.exterior), axis=0)
    along = np.arctan2(edges[:, 1], edges[:, 0])
    found = [0.0]
    for turn in (MOST_TURNED - (MOST_TURNED - along) % math.pi).tolist():
        if all(abs(math.remainder(turn - other, math.pi)) > SAME_DIRECTION for other in found):
            found.append(turn)
    return found


def _highest(number: int, free: Polygon, size: FloatArray, turn: float) -> _Place | None:
    """The highest place of a text ``size`` (2,), in heights of a capital, in what is free of a panel."""
    width, height = size.tolist()
    c, s, squeeze = math.cos(turn), math.sin(turn), height / width
    squeezed = affine_transform(free, (squeeze * c, squeeze * s, -s, c, 0.0, 0.0))
    x, y = shapely.get_coordinates(shapely.maximum_inscribed_circle(squeezed))[0]
    middle = np.array([c * x / squeeze - s * y, s * x / squeeze + c * y])
    heights = np.arange(round(LEAST_MM / STEP_MM), round(LARGEST_MM / STEP_MM) + 1) * STEP_MM
    corners = 0.5 * np.array([[-width, -height], [width, -height], [width, height], [-width, height]])
    boxes = shapely.polygons(middle + heights[:, None, None] * (corners @ np.array([[c, s], [-s, c]])))
    shapely.prepare(free)
    fits = heights[shapely.contains_properly(free, boxes)]
    if not fits.size:
        return None
    return _Place(number, (float(middle[0]), float(middle[1])), turn, round(float(fits.max()), 2))


def _laid(written: Lettering, place: _Place) -> tuple[FloatArray, ...]:
    """The strokes (mm) of a text at its place."""
    points = np.concatenate(written.lines)
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    c, s = math.cos(place.turn), math.sin(place.turn)
    turned = place.height_mm * np.array([[c, s], [-s, c]])
    lines = tuple(np.round((line - middle) @ turned + np.array(place.middle), DECIMALS) + 0.0 for line in written.lines)
    for line in lines:
        line.setflags(write=False)
    return lines
