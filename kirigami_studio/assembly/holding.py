"""Places that hold a sheet in an end state: holes and tabs where two parts meet there.

Holes are for magnets, eyelets or thread.  Parts *meet* along their edges, or lie on each other: then one magnet faces
the other, and an eyelet goes through both.  A few places hold all of a sheet, which has one degree of freedom: they lie
as far apart as they can.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely.geometry import Point, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.assembly.checks import body_of
from kirigami_studio.assembly.meetings import Lock, Meeting, locks, meetings
from kirigami_studio.assembly.pieces import Assembly, Piece, RoundHole
from kirigami_studio.assembly.pinned import PinnedPlan
from kirigami_studio.fabricate.findings import Problem
from kirigami_studio.fabricate.hold import STITCHES_MM, TABS_MM, HeldState, HoldKind, HoldOptions
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import rotate

#: Places in each state, at most; fewer where fewer fit.
MOST_PLACES = 6
#: Steps along a meeting at which a place is tried, mm.
STEP_MM = 1.0
#: Distance of holes with their walls, and of tabs, from the edge where parts meet: outlines are as exact, mm.
OFF_EDGE_MM = 0.05
#: Edges of tiles lie farther apart than their gap by this, mm, where the cuts between them have bows.
BOWED_MM = 2.0
#: Chords of a quarter circle round holes; the walls are as much thicker as chords miss it.
CHORDS = 32
NORTH, SOUTH = "N", "S"
#: Words on a state that nothing holds: where parts meet along edges, and where none do.
MISSING = {
    (HeldState.OPEN, True): "hold.no_room_open",
    (HeldState.OPEN, False): "hold.nothing_meets_open",
    (HeldState.FLAT, True): "hold.no_room_flat",
    (HeldState.FLAT, False): "hold.nothing_meets_flat",
}


@dataclass(frozen=True, slots=True, eq=False)
class HoldPlace:
    """A place that holds two parts together.

    Attributes
    ----------
    number : int
        In pictures and lists, from 1.
    state : HeldState
    kind : HoldKind
    parts : (str, str)
        Ids of pieces, or numbers of panels.
    at : pair of (K, 2) float, mm
        In the frame of each part: middles of its holes, or corners of its half of a tab, those on the edge last.
    hole_mm : float
        Diameter of the holes; 0 for tabs.
    through : bool
        Whether the parts lie on each other there; else they lie side by side.
    apart_mm : float
        Between the middles of the first holes of both in that state; 0 for tabs and where they lie on each other.
    poles : (str, str)
        Poles of magnets that face the reader, "N" or "S"; empty for others.
    """

    number: int
    state: HeldState
    kind: HoldKind
    parts: tuple[str, str]
    at: tuple[FloatArray, FloatArray]
    hole_mm: float
    through: bool
    apart_mm: float
    poles: tuple[str, str]


@dataclass(frozen=True, slots=True, eq=False)
class Site:
    """Where two parts meet in a state, and may be held.

    Attributes
    ----------
    parts : (str, str)
    state : HeldState
    edges : pair of (2, 2) float, mm, or None
        Ends of the length along which they touch, in the frame of each; None where they lie on each other.
    middle : pair of (2,) float, mm
        Of that length, or of the material that both have there.
    where : (3, 2) float, mm
        Where the middle is in that state, and where those of both parts are in the other one.
    rows : (int, int)
        Rows of their panels, or others of panels in one row: where they differ, poles do.
    apart_mm : float
        How far both middles are apart in the other state.
    """

    parts: tuple[str, str]
    state: HeldState
    edges: tuple[FloatArray, FloatArray] | None
    middle: tuple[FloatArray, FloatArray]
    where: FloatArray
    rows: tuple[int, int]
    apart_mm: float


@dataclass(frozen=True, slots=True, eq=False)
class HeldPlaces:
    """Chosen places.

    Attributes
    ----------
    places : tuple of HoldPlace
    problems : tuple of Problem
        States in which nothing fits.
    """

    places: tuple[HoldPlace, ...] = ()
    problems: tuple[Problem, ...] = ()


def chosen(
    sites: Iterable[Site], free: Mapping[str, BaseGeometry], options: HoldOptions, gap_mm: float
) -> tuple[HoldPlace, ...]:
    """Choose places that fit, each as far as possible from all before it.

    Those where parts lie on each other come first.

    Parameters
    ----------
    sites : iterable of Site
    free : mapping of str to Polygon or MultiPolygon, mm
        Where holes with their walls, or tabs, may lie in each part, in its frame.
    options : HoldOptions
    gap_mm : float
        Between edges that meet.
    """
    left = dict(free)
    found: list[HoldPlace] = []
    for state in options.when.states:
        open_sites = [site for site in sites if site.state is state and _suits(site, options.kind)]
        taken: list[Site] = []
        while open_sites and len(taken) < MOST_PLACES:
            site = max(open_sites, key=lambda one: (one.edges is None, _spread(one, taken), one.apart_mm))
            open_sites.remove(site)
            at = _fitted(site, left, options, gap_mm)
            if at is None or (options.kind is HoldKind.MAGNETS and _attracted(site, taken, options.magnet_mm)):
                continue
            for name, points in zip(site.parts, at, strict=True):
                left[name] = left[name].difference(_covered(points, options))
            taken.append(site)
            found.append(_place(len(found) + 1, site, at, options, gap_mm))
    return tuple(found)


def _suits(site: Site, kind: HoldKind) -> bool:
    """Whether parts of a kind hold there: thread and tabs need an edge."""
    return site.edges is not None or kind in (HoldKind.MAGNETS, HoldKind.EYELETS)


def _spread(site: Site, taken: Sequence[Site]) -> float:
    """Distance from the nearest place before, mm; from nowhere, what it moves."""
    if not taken:
        return site.apart_mm
    return min(math.dist(site.where[0], one.where[0]) for one in taken)


def _attracted(site: Site, taken: Sequence[Site], magnet_mm: float) -> bool:
    """Whether a magnet would face that of another place in the other end state."""
    return any(
        math.dist(one, other) < magnet_mm for before in taken for one in site.where[1:] for other in before.where[1:]
    )


def _fitted(
    site: Site, free: Mapping[str, BaseGeometry], options: HoldOptions, gap_mm: float
) -> tuple[FloatArray, FloatArray] | None:
    """Holes or halves of a tab in the frames of both parts; None where they have no room."""
    if site.edges is None:
        at = (site.middle[0][np.newaxis], site.middle[1][np.newaxis])
        return at if _room(at, site, free, options) else None
    lengths = [float(np.linalg.norm(edge[1] - edge[0])) for edge in site.edges]
    along = np.arange(0.0, 0.5 * min(lengths) + 1e-9, STEP_MM)
    for shape in _shapes(options, gap_mm):
        for shift in (sign * step for step in along for sign in ((1.0, -1.0) if step else (1.0,))):
            sides = [
                _on_edge(shape, edge, middle, shift, free[name])
                for edge, middle, name in zip(site.edges, site.middle, site.parts, strict=True)
            ]
            if _room((sides[0], sides[1]), site, free, options):
                return sides[0], sides[1]
    return None


def _shapes(options: HoldOptions, gap_mm: float) -> list[FloatArray]:
    """Holes, or halves of tabs, to try: (K, 2) float, mm, along an edge and inwards."""
    inwards = _inwards(options, gap_mm)
    if options.kind is HoldKind.TABS:
        start = 0.5 * gap_mm
        return [
            np.array([[-0.5 * long, deep], [0.5 * long, deep], [0.5 * long, start], [-0.5 * long, start]])
            for long, deep in TABS_MM
        ]
    if options.kind is HoldKind.STITCHES:
        return [np.array([[-0.5 * long, inwards], [0.5 * long, inwards]]) for long in STITCHES_MM]
    return [np.array([[0.0, inwards]])]


def _inwards(options: HoldOptions, gap_mm: float) -> float:
    """Distance of the middle of a hole from the line on which parts meet, mm."""
    return 0.5 * (options.hole_mm + gap_mm) + options.wall_mm + OFF_EDGE_MM


def _on_edge(shape: FloatArray, edge: FloatArray, middle: FloatArray, shift: float, free: BaseGeometry) -> FloatArray:
    """A shape at an edge, on its inner side."""
    way = (edge[1] - edge[0]) / np.linalg.norm(edge[1] - edge[0])
    inwards = np.array([-way[1], way[0]])
    depth = max(float(shape[:, 1].max()), 1.0)
    if not free.intersects(Point(middle + depth * inwards)) and free.intersects(Point(middle - depth * inwards)):
        inwards = -inwards
    found: FloatArray = middle + (shape[:, :1] + shift) * way + shape[:, 1:] * inwards
    return found


def _room(
    at: tuple[FloatArray, FloatArray], site: Site, free: Mapping[str, BaseGeometry], options: HoldOptions
) -> bool:
    return all(free[name].covers(_needed(points, options)) for name, points in zip(site.parts, at, strict=True))


def _needed(points: FloatArray, options: HoldOptions) -> BaseGeometry:
    """Material that a part needs: holes and their walls, or half a tab short of the edge."""
    if options.kind is HoldKind.TABS:
        return Polygon(points).buffer(-OFF_EDGE_MM, join_style="mitre")
    reach = (0.5 * options.hole_mm + options.wall_mm) / math.cos(0.25 * math.pi / CHORDS)
    return shapely.union_all(shapely.buffer(shapely.points(points), reach, quad_segs=CHORDS))


def _covered(points: FloatArray, options: HoldOptions) -> BaseGeometry:
    """Area that other places keep clear of by a wall."""
    if options.kind is HoldKind.TABS:
        return Polygon(points)
    return shapely.union_all(shapely.buffer(shapely.points(points), 0.5 * options.hole_mm, quad_segs=CHORDS))


def _place(
    number: int, site: Site, at: tuple[FloatArray, FloatArray], options: HoldOptions, gap_mm: float
) -> HoldPlace:
    through = site.edges is None
    poles = ("", "")
    if options.kind is HoldKind.MAGNETS:
        # Face to face, the same pole of both looks at the reader; side by side they attract if their poles differ.
        one, other = (NORTH, NORTH) if through else (NORTH if row % 2 == 0 else SOUTH for row in site.rows)
        poles = (one, other)
    beside = 0.0 if through or options.kind is HoldKind.TABS else 2.0 * _inwards(options, gap_mm)
    return HoldPlace(number, site.state, options.kind, site.parts, at, options.hole_mm, through, beside, poles)


# pieces on pins -------------------------------------------------------------------------------------------------------


def held(plan: PinnedPlan, options: HoldOptions) -> HeldPlaces:
    """Choose places that hold the pieces of a pinned design."""
    if options.kind is HoldKind.NONE:
        return HeldPlaces()
    sizes = plan.options
    gap_mm = sizes.clearance_mm if sizes.in_one_plane else sizes.side_mm
    found: list[Lock | Meeting] = [
        one for one in meetings(plan.assembly, gap_mm, sizes.in_one_plane) if one.state in options.when.states
    ]
    met = {one.state for one in found}
    if options.kind in (HoldKind.MAGNETS, HoldKind.EYELETS) and not sizes.in_one_plane:
        for state in options.when.states:
            found += locks(plan, state, options.hole_mm, options.head_mm, options.wall_mm)
    reach = 0.5 * options.hole_mm + options.wall_mm if options.hole_mm else 0.0
    if sizes.in_one_plane:  # joints are in the ears
        clear = 0.5 * sizes.ear_mm + sizes.clearance_mm
    else:
        clear = max(0.5 * (sizes.head_mm + options.head_mm), 0.5 * sizes.pin_mm + reach) - reach
    free = {}
    for piece in plan.assembly.pieces:
        pins = shapely.buffer([Point(hole.centre) for hole in piece.holes], clear, quad_segs=CHORDS)
        free[piece.id] = body_of(piece).difference(shapely.union_all(pins))
    places = chosen(_sites(plan.assembly, found), free, options, gap_mm)
    return HeldPlaces(places, missing(places, options, met))


def held_tiles(assembly: Assembly, options: HoldOptions, gap_mm: float) -> HeldPlaces:
    """Choose places that hold tiles, which are nowhere joined by pins.

    Parameters
    ----------
    assembly : Assembly
    options : HoldOptions
    gap_mm : float
        Between the edges of two tiles that meet.
    """
    if options.kind is HoldKind.NONE:
        return HeldPlaces()
    found = [one for one in meetings(assembly, gap_mm + BOWED_MM, True) if one.state in options.when.states]
    places = chosen(_sites(assembly, found), {one.id: body_of(one) for one in assembly.pieces}, options, gap_mm)
    return HeldPlaces(places, missing(places, options, {one.state for one in found}))


def missing(places: Sequence[HoldPlace], options: HoldOptions, met: Iterable[HeldState]) -> tuple[Problem, ...]:
    """Problems of states that nothing holds.

    Parameters
    ----------
    met : iterable of HeldState
        States in which parts meet along edges.
    """
    return tuple(
        Problem.warning(MISSING[state, state in met])
        for state in options.when.states
        if not any(place.state is state for place in places)
    )


def _sites(assembly: Assembly, found: Iterable[Lock | Meeting]) -> list[Site]:
    """Sites where pieces meet, or lie on each other."""
    ends = {HeldState.OPEN: assembly.phi_target, HeldState.FLAT: math.pi}
    poses = {state: dict(zip(assembly.by_id, assembly.poses(phi), strict=True)) for state, phi in ends.items()}
    sites = []
    for one in found:
        edges = one.at if isinstance(one, Meeting) else None
        middle = (one.at[0], one.at[1]) if edges is None else (edges[0].mean(axis=0), edges[1].mean(axis=0))
        other = HeldState.FLAT if one.state is HeldState.OPEN else HeldState.OPEN
        there = [_carried(poses[other][name], at) for name, at in zip(one.pieces, middle, strict=True)]
        where = np.array([_carried(poses[one.state][one.pieces[0]], middle[0]), *there])
        rows = (assembly.by_id[one.pieces[0]].panel[0], assembly.by_id[one.pieces[1]].panel[0])
        rows = rows if rows[0] != rows[1] else (0, 1)
        sites.append(Site(one.pieces, one.state, edges, middle, where, rows, math.dist(*there)))
    return sites


def _carried(pose: FloatArray, point: FloatArray) -> FloatArray:
    carried: FloatArray = rotate(point, float(pose[2])) + pose[:2]
    return carried


def with_places(assembly: Assembly, places: Sequence[HoldPlace]) -> Assembly:
    """The assembly with the holes of places drilled, and with marks where tabs lie."""
    holes: dict[str, list[RoundHole]] = {}
    marks: dict[str, list[FloatArray]] = {}
    for place in places:
        for name, at in zip(place.parts, place.at, strict=True):
            if place.kind is HoldKind.TABS:
                marks.setdefault(name, []).append(at[[3, 0, 1, 2]])
            else:
                holes.setdefault(name, []).extend(RoundHole(point, place.hole_mm) for point in at)

    def made(piece: Piece) -> Piece:
        drilled = (*piece.holes, *holes.get(piece.id, ()))
        return replace(piece, holes=drilled, marks=tuple(marks.get(piece.id, ())))

    return replace(assembly, pieces=tuple(map(made, assembly.pieces)))
