"""A rigid model of the sheet in a cut file, and where it jams; it shares no code with the product.

Panels are what erosion by half a connector leaves apart, connectors the necks between them.  Each neck turns about a
point of its narrowest section: the middle, or, beside a straight flank, 0.73 (sharp slit) to 0.56 widths (kerf of four
widths) from it.  Panels keep their shape but for what bends around the necks.  The sheet is closed by Gauss-Newton on
the gaps at all necks, with its mean turn prescribed; panels that are in each other push each other out.  It jams where
a neck is stretched by more than it bears, or where panels stay in each other by more than two necks in a row bear.  A
panel narrower than a connector is read as two, and sheets with tabs, whose outline is cut in parts, are not read.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import shapely
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order
from scipy.sparse.linalg import spsolve
from shapely.geometry import Point, Polygon
from shapely.geometry.base import BaseGeometry

from tests.panel_reader import DUST_MM2, ROUND, read_sheet

ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.intp]
FloatArray = npt.NDArray[np.float64]
Areas = npt.NDArray[np.object_]
#: What a connector bears (in widths), as the product's documents say it: more is a jam.
TOLERATED = 0.45
#: Erosion that breaks connectors, in their widths.
BREAKS = 0.51
#: Around a connector so many spans of width and kerf bend: they belong to no rigid panel.
BENDING = 1.25
#: Places this near (mm) to each other are one.
NEAR_MM = 1e-3
#: A flank is straight where it leaves its tangent by less than this share of the connector within one width.
STRAIGHT = 0.05
#: Regions between opened panels larger than this (squares of the width) are necks of narrower connectors, and larger
#: than that strips, as narrow everywhere.
SHORT, LONG = 0.3, 0.5
#: Eroded panels that hang together by a short neck are not further apart (in widths).
NEAREST = 1.5
#: Parts smaller than this (squares of the width) between two necks belong to the connector.
SMALL = 15.0
#: Mean turns (degrees) at which the sheet is looked at: small steps where panels meet.
STEPS_DEG = (*np.arange(6.0, 168.0, 6.0).tolist(), *np.arange(168.0, 178.5, 1.0).tolist())
#: Share by which what connectors bear is not known better.
UNSURE = 0.05
#: Corners that are deeper than this (in widths) in another panel are pushed out, and how often more are looked for.
PUSHED, MOST_LOOKS = 0.1, 4
#: Around a neck this share of the smaller panel's size is squeezed where both panels of it meet.
SQUEEZED = 0.5
#: A step on which panels meet is taken in so many parts.
FINER = 8
MOST_ITERATIONS, FINE_STEP = 25, 1e-5


@dataclass(frozen=True)
class Necks:
    """Connectors as a file has them.

    Attributes
    ----------
    panels : (H, 2) int
    centre : (H,) complex, mm
        What they turn about.
    across : (H,) complex
        Unit vector from one end of the narrowest section to the other.
    width_mm, longer_mm : (H,) float
        Narrowest section, and by how much the neck is longer than one beside a straight slit.
    """

    panels: IntArray
    centre: ComplexArray
    across: ComplexArray
    width_mm: FloatArray
    longer_mm: FloatArray

    def __len__(self) -> int:
        return len(self.width_mm)


@dataclass(frozen=True)
class RigidSheet:
    """Panels and necks of a file.

    Attributes
    ----------
    panels : (P,) object
        What stays rigid of every panel, mm.
    middle : (P,) complex, mm
    size_mm : (P,) float
        Roots of their areas.
    necks : Necks
    kerf_mm : float
    pieces : int
        Parts of the sheet.
    """

    panels: Areas
    middle: ComplexArray
    size_mm: FloatArray
    necks: Necks
    kerf_mm: float
    pieces: int


@dataclass(frozen=True)
class RigidClosing:
    """What became of closing it.

    Attributes
    ----------
    jam_deg : float
        Angle at which it jams, 0 where it closes.
    early_deg, late_deg : float
        The same for connectors that bear :data:`UNSURE` less, and more.
    phi_deg, stretch, depth : (S,) float
        Angles, largest stretch (in widths) and depth of a contact (in widths) at each.
    """

    jam_deg: float
    early_deg: float
    late_deg: float
    phi_deg: FloatArray
    stretch: FloatArray
    depth: FloatArray


# reading --------------------------------------------------------------------------------------------------------------


def read_rigid(path: Path, kerf_mm: float, connector_mm: float, copies: int = 1, slots: bool = False) -> RigidSheet:
    """Read a cut file, or a folder of one file a layer.

    Parameters
    ----------
    path : Path
    kerf_mm, connector_mm : float
    copies : int
        That the file holds.
    slots : bool
        Whether its curves are the edges of what is left, and not the middles of the cuts.
    """
    area = read_sheet(path, 0.0 if slots else kerf_mm, copies).area
    parts = [part for part in shapely.get_parts(area) if part.area > DUST_MM2]
    sheet = max(parts, key=lambda part: float(part.area))
    left = shapely.buffer(sheet, -BREAKS * connector_mm, quad_segs=ROUND)
    kept = np.array([one for one in shapely.get_parts(left) if one.area > DUST_MM2], dtype=object)
    opened = shapely.buffer(kept, BREAKS * connector_mm, quad_segs=ROUND)
    return _rigid(sheet, kept, opened, kerf_mm, connector_mm, len(parts))


def _rigid(
    sheet: Polygon, eroded: Areas, opened: Areas, kerf_mm: float, connector_mm: float, pieces: int
) -> RigidSheet:
    rim, crumbs = shapely.boundary(sheet), [[one] for one in opened]
    # Short necks lie where eroded panels are nearest to each other, strips are left over by opened ones.
    places: dict[tuple[int, int], tuple[Point, float]] = {}
    for one, other in _neighbours(eroded, NEAREST * connector_mm):
        line = shapely.shortest_line(eroded[one], eroded[other])
        if line.within(sheet):
            places[one, other] = shapely.line_interpolate_point(line, 0.5, normalized=True), 0.0
    tree = shapely.STRtree(opened)
    for region in shapely.get_parts(shapely.difference(sheet, shapely.union_all(opened))):
        beside = [int(number) for number in np.sort(tree.query(region, "dwithin", distance=NEAR_MM))]
        if len(beside) == 1:
            crumbs[beside[0]].append(region)
        elif len(beside) == 2 and region.area > SHORT * connector_mm**2:
            strip = float(region.area) if region.area > LONG * connector_mm**2 else 0.0
            places.setdefault((beside[0], beside[1]), (shapely.centroid(region), strip))
    rows = [(pair, *_neck(*place, rim, kerf_mm, connector_mm)) for pair, place in places.items()]
    necks = Necks(*map(np.array, zip(*rows, strict=True)))
    necks, there = _in_series(necks, shapely.area(opened))
    opened, crumbs = opened[there], [crumbs[number] for number in there]
    panels = shapely.buffer([shapely.union_all(parts) for parts in crumbs], -0.5 * NEAR_MM)
    reach = BENDING * (necks.width_mm + kerf_mm) + 0.5 * necks.longer_mm
    bends = shapely.buffer(shapely.points(necks.centre.real, necks.centre.imag), reach, quad_segs=8)
    for number, panel in enumerate(panels):
        own = bends[np.any(necks.panels == number, axis=1)]
        panels[number] = shapely.simplify(shapely.difference(panel, shapely.union_all(own)), 2.0 * NEAR_MM)
    middle = shapely.get_coordinates(shapely.centroid(opened)) @ (1.0, 1j)
    return RigidSheet(panels, middle, np.sqrt(shapely.area(opened)), necks, kerf_mm, pieces)


def _in_series(necks: Necks, areas: FloatArray) -> tuple[Necks, IntArray]:
    """One neck for two with a small part between, and the panels that stay: arcs are narrow at both ends."""
    small = areas < SMALL * float(np.median(necks.width_mm)) ** 2
    beside = np.bincount(necks.panels.ravel(), minlength=len(areas))
    between = np.flatnonzero(small & (beside == 2))
    rows = []
    for part in between:
        first, second = np.flatnonzero(np.any(necks.panels == part, axis=1))
        ends = [int(next(panel for panel in necks.panels[neck] if panel != part)) for neck in (first, second)]
        way = necks.centre[second] - necks.centre[first]
        rows.append(
            (
                sorted(ends),
                0.5 * (necks.centre[first] + necks.centre[second]),
                1j * way / abs(way),
                min(necks.width_mm[[first, second]]),
                abs(way),
            )
        )
    kept = ~np.isin(necks.panels, between).any(axis=1)
    columns = (necks.panels, necks.centre, necks.across, necks.width_mm, necks.longer_mm)
    merged = [
        np.concatenate(
            [column[kept], np.array([row[place] for row in rows], column.dtype).reshape(-1, *column.shape[1:])]
        )
        for place, column in enumerate(columns)
    ]
    there = np.setdiff1d(np.arange(len(areas)), between)
    merged[0] = np.searchsorted(there, merged[0])
    return Necks(*merged), there


def _neck(
    about: Point, strip_mm2: float, rim: BaseGeometry, kerf_mm: float, connector_mm: float
) -> tuple[complex, complex, float, float]:
    """Centre, direction across, width and extra length of the neck about a place."""
    middle = complex(about.x, about.y)
    near = shapely.get_parts(shapely.line_merge(shapely.intersection(rim, about.buffer(1.5 * connector_mm))))
    first = min(near, key=about.distance)
    one = complex(*shapely.shortest_line(about, first).coords[1])
    # The other end lies on the other side: without a kerf, beyond the first end another edge is as near.
    opposite = _half_plane(middle, middle - one, 1.5 * connector_mm)
    beyond = [part for line in near for part in shapely.get_parts(shapely.intersection(line, opposite)) if part.length]
    second = min(beyond, key=about.distance)
    other = complex(*shapely.shortest_line(about, second).coords[1])
    if not strip_mm2:
        flank = min(
            shapely.get_parts(shapely.intersection(first, _half_plane(middle, one - middle, 1.5 * connector_mm))),
            key=about.distance,
        )
        one, other = (complex(*end) for end in shapely.shortest_line(flank, second).coords)
    width = abs(other - one)
    direction = (other - one) / width
    straight = [_is_straight(rim, end, direction, width) for end in (one, other)]
    share = 0.5
    if straight[0] is not straight[1] and not strip_mm2:
        away = 0.73 - 0.17 * min(kerf_mm / (4.0 * width), 1.0)
        share = away if straight[0] else 1.0 - away
    return one + share * (other - one), direction, width, strip_mm2 / width


def _half_plane(middle: complex, normal: complex, size_mm: float) -> Polygon:
    """What of a square about a place lies on the side of a normal."""
    unit = normal / abs(normal)
    corners = middle + size_mm * unit * np.array([1e-6 + 1j, 1.0 + 1j, 1.0 - 1j, 1e-6 - 1j])
    return Polygon(np.column_stack([corners.real, corners.imag]))


def _is_straight(rim: BaseGeometry, end: complex, across: complex, width: float) -> bool:
    """Whether the rim of the sheet is a straight line across an end of a neck."""
    here = shapely.intersection(rim, Point(end.real, end.imag).buffer(width))
    near = [
        part
        for part in shapely.get_parts(shapely.line_merge(here))
        if part.distance(Point(end.real, end.imag)) < NEAR_MM
    ]
    if not near:
        return False
    points = shapely.get_coordinates(near[0]) @ (1.0, 1j)
    off = ((points - end) * across.conjugate()).real
    return bool(np.abs(off).max() < STRAIGHT * width)


# closing --------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Touch:
    """A corner of one panel that is in another one.

    Attributes
    ----------
    inner, outer : int
        Panels.
    point, foot : complex, mm
        The corner, and the place of the outer panel's edge nearest to it, at rest.
    normal : complex
        Out of the outer panel there, at rest.
    """

    inner: int
    outer: int
    point: complex
    foot: complex
    normal: complex


class _Model:
    """Gaps, turns and contacts of a sheet, and their slopes."""

    def __init__(self, sheet: RigidSheet) -> None:
        necks = sheet.necks
        self.sheet, self.count = sheet, len(sheet.middle)
        self.one, self.other = necks.panels.T
        self.sign = _colours(necks.panels, self.count)
        between = np.sqrt(sheet.size_mm[self.one] * sheet.size_mm[self.other])
        ratio = np.log(np.maximum(between / necks.width_mm, 2.0))
        slender = necks.longer_mm / necks.width_mm
        # Springs over E h: pulled, sheared (N/mm each) and turned (N mm).
        self.pulled = np.sqrt(1.0 / (4.08 * ratio - 1.7 + slender))
        self.sheared = np.sqrt(1.0 / (4.29 * ratio + 1.6 + slender**3))
        bends = sheet.kerf_mm + 1.275 * necks.width_mm + necks.longer_mm
        self.turned = np.sqrt(necks.width_mm**3 / (12.0 * bends))

    def gaps(self, state: FloatArray) -> ComplexArray:
        """How far (H,), mm, both sides of every neck are apart, in the frame of the neck between its panels."""
        apart = self._moved(state, self.other) - self._moved(state, self.one)
        found: ComplexArray = apart * np.exp(-1j * self._frame(state))
        return found

    def turns(self, state: FloatArray) -> FloatArray:
        """By how much (H,), radians, the second panel has turned against the first one."""
        angle = state[2::3]
        found: FloatArray = angle[self.other] - angle[self.one]
        return found

    def _frame(self, state: FloatArray) -> FloatArray:
        angle = state[2::3]
        return np.angle(self.sheet.necks.across) + 0.5 * (angle[self.one] + angle[self.other])

    def _moved(self, state: FloatArray, panel: IntArray) -> ComplexArray:
        return self._at(state, panel, self.sheet.necks.centre)

    def _at(self, state: FloatArray, panel: IntArray, point: ComplexArray) -> ComplexArray:
        place = state[0::3] + 1j * state[1::3]
        arm = point - self.sheet.middle[panel]
        found: ComplexArray = self.sheet.middle[panel] + place[panel] + arm * np.exp(1j * state[2::3][panel])
        return found

    def polygons(self, state: FloatArray) -> Areas:
        """What is rigid of all panels, moved."""
        return np.array([self._moved_panel(state, number) for number in range(self.count)], dtype=object)

    def _moved_panel(self, state: FloatArray, number: int) -> BaseGeometry:
        def move(points: FloatArray) -> FloatArray:
            moved = self._at(state, np.full(len(points), number), points @ (1.0, 1j))
            return np.column_stack([moved.real, moved.imag])

        return shapely.transform(self.sheet.panels[number], move)

    def overlap(self, state: FloatArray) -> float:
        """Area (mm^2) that panels share, pair by pair."""
        panels = self.polygons(state)
        return sum(float(panels[a].intersection(panels[b]).area) for a, b in _neighbours(panels))

    def depth(self, state: FloatArray) -> float:
        """How deep (mm) a corner of a panel is in another one at most."""
        panels = self.polygons(state)
        pairs = [pair for a, b in _neighbours(panels) for pair in ((a, b), (b, a))]
        return max((_depth(panels[inner], panels[outer]) for inner, outer in pairs), default=0.0)

    def touches(self, state: FloatArray) -> list[Touch]:
        """The deepest corner of every panel that is in another one."""
        panels, least = self.polygons(state), PUSHED * float(np.median(self.sheet.necks.width_mm))
        necks: dict[tuple[int, int], list[complex]] = {}
        places = self._moved(state, self.one).tolist()
        for pair, place in zip(np.sort(self.sheet.necks.panels, axis=1).tolist(), places, strict=True):
            necks.setdefault((pair[0], pair[1]), []).append(place)
        found = []
        for pair in _neighbours(panels):
            for inner, outer in (pair, pair[::-1]):
                line = _deepest(panels[inner], panels[outer])
                if line is not None and abs(line[1] - line[0]) >= least and pair in necks:
                    # What meets beside a neck is squeezed: flanks stop each other at their far ends.
                    size = SQUEEZED * min(self.sheet.size_mm[[*pair]])
                    beside = shapely.union_all([Point(at.real, at.imag).buffer(size) for at in necks[pair]])
                    line = _deepest(*(shapely.difference(panels[panel], beside) for panel in (inner, outer)))
                if line is None or abs(line[1] - line[0]) < least:
                    continue
                point, foot = (self._at_rest(state, *end) for end in zip((inner, outer), line, strict=True))
                normal = (line[1] - line[0]) / abs(line[1] - line[0]) * np.exp(-1j * state[3 * outer + 2])
                found.append(Touch(inner, outer, point, foot, complex(normal)))
        return found

    def is_near(self, state: FloatArray, touch: Touch) -> bool:
        """Whether a corner is still at the panel that it touched."""
        least = PUSHED * float(np.median(self.sheet.necks.width_mm))
        corner = complex(self._at(state, np.array([touch.inner]), np.array([touch.point]))[0])
        return bool(self._moved_panel(state, touch.outer).distance(Point(corner.real, corner.imag)) <= least)

    def _at_rest(self, state: FloatArray, panel: int, place: complex) -> complex:
        """Where a place on a moved panel is in the flat sheet."""
        x, y, angle = state[3 * panel : 3 * panel + 3]
        middle = complex(self.sheet.middle[panel])
        return middle + (place - middle - complex(x, y)) * complex(np.exp(-1j * angle))

    def pushes(self, state: FloatArray, touches: list[Touch]) -> tuple[IntArray, FloatArray, FloatArray]:
        """Freedoms (T, 6) of the panels of touches, slopes of their depths by them, and the depths (T,), mm."""
        inner, outer = np.array([(one.inner, one.outer) for one in touches], dtype=np.intp).reshape(-1, 2).T
        point, foot, normal = np.array([(one.point, one.foot, one.normal) for one in touches]).reshape(-1, 3).T
        out = normal * np.exp(1j * state[2::3][outer])
        corner = self._at(state, inner, point)
        depth = ((self._at(state, outer, foot) - corner) * out.conjugate()).real
        arms = [
            corner - self.sheet.middle[panel] - state[0::3][panel] - 1j * state[1::3][panel] for panel in (outer, inner)
        ]
        slopes = np.stack(
            [
                value
                for sign, arm in zip((1.0, -1.0), arms, strict=True)
                for value in (sign * out.real, sign * out.imag, sign * (1j * arm * out.conjugate()).real)
            ],
            axis=1,
        )
        places = np.concatenate([3 * outer[:, None] + np.arange(3), 3 * inner[:, None] + np.arange(3)], axis=1)
        inside = depth > 0.0
        return places[inside], slopes[inside], depth[inside]

    def step(self, state: FloatArray, mean: float, touches: list[Touch]) -> FloatArray:
        """One Gauss-Newton step towards least energy at a mean turn (radians)."""
        necks = self.sheet.necks
        places = np.concatenate([3 * self.one[:, None] + np.arange(3), 3 * self.other[:, None] + np.arange(3)], axis=1)
        gaps, turns = self.gaps(state), self.turns(state)
        frame = np.exp(-1j * self._frame(state))
        slopes = np.zeros((len(necks), 6), dtype=np.complex128)
        for panel, first, sign in ((self.one, 0, -1.0), (self.other, 3, 1.0)):
            arm = (necks.centre - self.sheet.middle[panel]) * np.exp(1j * state[2::3][panel])
            slopes[:, first], slopes[:, first + 1] = sign * frame, sign * 1j * frame
            slopes[:, first + 2] = sign * 1j * arm * frame - 0.5j * gaps
        turning = np.zeros((len(necks), 6))
        turning[:, 2], turning[:, 5] = -1.0, 1.0
        # Along the section a neck is sheared, across it pulled.
        parts = [
            (self.sheared[:, None] * slopes.real, self.sheared * gaps.real),
            (self.pulled[:, None] * slopes.imag, self.pulled * gaps.imag),
            (self.turned[:, None] * turning, self.turned * turns),
        ]
        rows = [(places, *part) for part in parts]
        if touches:  # an edge resists as the sheet itself does
            rows.append(self.pushes(state, touches))
        matrix = sparse.vstack([_matrix(at, slope, 3 * self.count) for at, slope, _ in rows])
        off = np.concatenate([value for _, _, value in rows])
        kept = _matrix(places, self.sign[:, None] * turning / len(necks), 3 * self.count).sum(axis=0)
        missing = mean - float(np.mean(self.sign * turns))
        # A little of the diagonal keeps the whole in its place.
        normal = (matrix.T @ matrix + 1e-9 * sparse.eye(3 * self.count)).tocsc()
        border = sparse.bmat([[normal, kept.T], [kept, None]], format="csc")
        right = np.concatenate([-(matrix.T @ off), [missing]])
        return np.asarray(spsolve(border, right))[:-1]


def closed_rigid(sheet: RigidSheet) -> RigidClosing:
    """Close a sheet step by step, and find where it jams."""
    model = _Model(sheet)
    widths = sheet.necks.width_mm
    # Slits open, whichever colour of panels turns to the left: the other way panels run into each other at once.
    first = math.radians(STEPS_DEG[0])
    flat = np.zeros(3 * model.count)
    sign = min((1.0, -1.0), key=lambda one: model.overlap(_settled(model, flat, one * first)))
    state, before = flat, flat
    rows: list[tuple[float, float, float]] = [(180.0, 0.0, 0.0)]
    touches: list[Touch] = []
    for turn, last, earlier in zip(STEPS_DEG, (0.0, *STEPS_DEG), (0.0, 0.0, *STEPS_DEG), strict=False):
        ahead = (turn - last) / (last - earlier) if last > earlier else 0.0
        mean, start, seen = sign * math.radians(turn), state + ahead * (state - before), touches
        before, (state, touches) = state, _pushed(model, start, mean, touches)
        if len(touches) > len(seen) and turn - last > 2.0:  # a corner leaves by the edge that it came in by
            state, touches = before, seen
            for part in np.linspace(math.radians(last), math.radians(turn), FINER + 1)[1:].tolist():
                state, touches = _pushed(model, state, sign * part, touches)
        stretch = float((np.abs(model.gaps(state)) / widths).max())
        rows.append((180.0 - turn, stretch, model.depth(state) / float(np.median(widths))))
        if max(stretch / TOLERATED, rows[-1][2] / (2.0 * TOLERATED)) > 1.0 + UNSURE:
            break
    phi, stretch, depth = np.array(rows).T
    share = np.maximum(stretch / TOLERATED, depth / (2.0 * TOLERATED))
    early, jam, late = (_passed(phi, share, least) for least in (1.0 - UNSURE, 1.0, 1.0 + UNSURE))
    return RigidClosing(jam, early, late, phi, stretch, depth)


def _passed(phi_deg: FloatArray, share: FloatArray, least: float) -> float:
    """The angle (degrees) at which a growing share passes a value; 0 where it never does."""
    over = np.flatnonzero(share > least)
    if not over.size:
        return 0.0
    last = int(over[0])
    part = (least - share[last - 1]) / (share[last] - share[last - 1])
    return float(phi_deg[last - 1] + part * (phi_deg[last] - phi_deg[last - 1]))


def _pushed(model: _Model, state: FloatArray, mean: float, touches: list[Touch]) -> tuple[FloatArray, list[Touch]]:
    """The state of least energy at a mean turn (radians), panels pushed out of each other, and where they touch."""
    for _ in range(MOST_LOOKS):
        state = _settled(model, state, mean, touches)
        known = {(one.inner, one.outer): one for one in touches}
        found = {(one.inner, one.outer): one for one in model.touches(state)}
        if found.keys() <= known.keys():
            break
        touches = list((known | found).values())
    return state, [one for one in touches if model.is_near(state, one)]


def _settled(model: _Model, state: FloatArray, mean: float, touches: Sequence[Touch] = ()) -> FloatArray:
    """The state of least energy at a mean turn (radians)."""
    for _ in range(MOST_ITERATIONS):
        step = model.step(state, mean, list(touches))
        largest = float(np.abs(step[2::3]).max())
        state = state + step * min(1.0, 0.3 / largest if largest > 0.0 else 1.0)
        if largest < FINE_STEP:
            break
    return state


def _matrix(places: IntArray, slopes: FloatArray, size: int) -> sparse.csr_matrix:
    rows = np.repeat(np.arange(len(places)), places.shape[1])
    return sparse.csr_matrix((slopes.ravel(), (rows, places.ravel())), shape=(len(places), size))


def _neighbours(panels: Areas, distance: float = 0.0) -> list[tuple[int, int]]:
    """Pairs of panels within a distance (mm) of each other."""
    one, other = shapely.STRtree(panels).query(panels, "dwithin", distance=distance)
    return [(int(a), int(b)) for a, b in zip(one, other, strict=True) if a < b]


def _depth(inner: BaseGeometry, outer: BaseGeometry) -> float:
    """How deep (mm) the deepest corner of one panel is in another one."""
    line = _deepest(inner, outer)
    return 0.0 if line is None else abs(line[1] - line[0])


def _deepest(inner: BaseGeometry, outer: BaseGeometry) -> tuple[complex, complex] | None:
    """The deepest corner of one panel in another one, and the place of its edge nearest to it."""
    corners = shapely.get_coordinates(inner)
    inside = shapely.points(corners[shapely.contains_xy(outer, *corners.T)])
    if not len(inside):
        return None
    lines = shapely.shortest_line(inside, shapely.boundary(outer))
    one, other = shapely.get_coordinates(lines[np.argmax(shapely.length(lines))]) @ (1.0, 1j)
    return complex(one), complex(other)


def _colours(pairs: IntArray, count: int) -> FloatArray:
    """+1 or -1 (H,): which way every neck turns; panels that hang together turn against each other."""
    ones = np.ones(len(pairs))
    graph = sparse.csr_matrix((ones, pairs.T), shape=(count, count))
    order, before = breadth_first_order(graph, 0, directed=False)
    colour = np.zeros(count)
    colour[0] = 1.0
    for panel in order[1:]:
        colour[panel] = -colour[before[panel]]
    return colour[pairs[:, 1]]
