"""Pieces while they are being made: panels, ears, notches, and the room of their neighbours."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.assembly.motion import GeometryArray, LayerMotion, discs, polygons, swept_discs, swept_hulls
from kirigami_studio.assembly.options import PinOptions
from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.evaluate.kept_panels import PanelTable
from kirigami_studio.foundation.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from kirigami_studio.lattice.deployment import Deployment

#: Notches exceed the exact sweep of ears and clearance by this at most, mm, and contain it but for what their options
#: round off.
NOTCH_TOLERANCE = 0.01
#: Sagitta of the chords by which bodies are swept, mm: an extension keeps as much more distance than it has to.
BODY_TOLERANCE = 0.15
#: Chords of a quarter circle at corners of areas that are looked at.
ZONE_CHORDS = 4
#: By this, mm, outlines of what is swept are coarser than the bodies.
COARSE = 0.25
#: Necks that pieces are made with, as shares of those asked for, where wider ones are cut through.
NARROWER = (0.75, 0.5, 0.25, 0.05)
#: Corners sharper than 2 asin(1 / MITRE) = 23 degrees are blunted.
MITRE = 5.0
#: Discs of straps are so much larger, mm, than half a neck, and so far apart: a row of them is a neck wide.  Their
#: notches are larger by the scallops between.
STRAP_MORE, STRAP_STEP, STRAP_SCALLOP = 0.06, 0.6, 0.03
#: Times that pins are left out, and notches cut anew.
ROUNDS = 6
#: Grid (mm) of overlays that fail in floating point, where edges nearly coincide.
SNAPPED_MM = 1e-6
#: Parts added to a piece overlap it by this, mm, so that they hold together in floating point.
OVERLAP = 0.004
#: Parts smaller than this, mm2, are neither cut off nor added.
LEAST_PART = 0.5
#: Differences between polygons that are smaller, mm2, are those of rounding.
TOO_SMALL = 1e-3
#: Vertices that lie nearer than this, mm, to the line between their neighbours are left out.
STRAIGHT = 0.005
#: Slits of pieces narrower than twice this, mm, are closed where they are longer than half of that.
SLIT, SLIT_LENGTH = 1e-4, 0.02
#: Areas between necks are larger by this, mm, all round than the shapes that they are parts of: edges that nearly
#: coincide take overlays six times as long.
CLEAR = 1e-4


#: Index of a panel, its own ears and those that pass it, and their radii; the straps of all.
_Notching = tuple[int, bytes, bytes, bytes, bytes, bytes]


@dataclass(frozen=True, slots=True, eq=False)
class _Notched:
    """A panel with its ears, less its notches.

    Attributes
    ----------
    shape : geometry
    held : Polygon or None
        The part of it that hangs together by necks as asked for.
    movers : (N,) int
        Ears that cut it, as flat indices of corners.
    strapped : (M,) int
        Ears whose straps do.
    """

    shape: BaseGeometry
    held: Polygon | None
    movers: IntArray
    strapped: IntArray


@dataclass(eq=False)
class Shaping:
    """The pieces of one design in the flat sheet, mm; they change while rims are shaped.

    Attributes
    ----------
    motion : LayerMotion
    options : PinOptions
    bodies : (P,) Polygon
        What there is of each piece, holes not drilled.
    ear_radius : (P, 4) float, mm
        Of the ear at each corner: smaller than asked for where it would cut a neighbour through.
    neck_mm : (P,) float
        Least width of each: as asked for, or less where neighbours' ears leave no more.
    broken : set of int
        Panels whose ears do not hang together.
    """

    motion: LayerMotion
    options: PinOptions
    bodies: GeometryArray = field(init=False)
    ear_radius: FloatArray = field(init=False)
    neck_mm: FloatArray = field(init=False)
    broken: set[int] = field(default_factory=set)
    weak: set[int] = field(default_factory=set)  #: nodes whose pins have no wall, or no neck to their piece
    cutting: set[int] = field(default_factory=set)  #: nodes whose ears cut a neck

    def __post_init__(self) -> None:
        planes = np.unique(self.motion.plane).tolist()
        members = {plane: np.flatnonzero(self.motion.plane == plane) for plane in planes}
        self._parts = {plane: _ConvexParts.of(one, self.motion.corners[one]) for plane, one in members.items()}
        self.neck_mm = np.full(len(self.motion.layer), self.options.neck_mm)
        self.ear_radius = np.full(self.motion.corners.shape, 0.5 * self.options.ear_mm)
        self.bodies = np.full(len(self.motion.layer), Polygon(), dtype=object)

    @classmethod
    def of(
        cls,
        deployment: Deployment,
        cell_mm: float,
        phi_target: float,
        options: PinOptions,
        panels: PanelTable | None = None,
        unwanted: Sequence[int] = (),
        needless: Sequence[int] = (),
    ) -> Shaping:
        """Panels, all or some, with ears, less what the ears of their neighbours sweep.

        Pins of ``unwanted`` nodes are left out first, one after the other, as long as the sheet keeps its one motion.
        Pins without wall or neck are left out as long as the sheet keeps its one motion: their ears cut nothing then.
        So are those at ``needless`` nodes, the first ones first: after them, or before them where that leaves fewer
        necks narrow.
        """
        motion = LayerMotion.of(deployment, cell_mm, phi_target, options.in_one_plane, panels).without(unwanted)
        known: dict[_Notching, _Notched] = {}
        made = cls._made(deployment, motion, options, known)
        fewer = made.motion.without(needless)
        if fewer is not made.motion:
            made = min(cls._made(deployment, fewer, options, known), made, key=lambda one: one.faults)
        sooner = motion.without(needless) if made.faults else motion
        if sooner is not motion:
            made = min(made, cls._made(deployment, sooner, options, known), key=lambda one: one.faults)
        return made

    @classmethod
    def _made(
        cls, deployment: Deployment, motion: LayerMotion, options: PinOptions, known: dict[_Notching, _Notched]
    ) -> Shaping:
        """Leave out pins until all have walls and necks, or the motion is lost without another."""
        made = cls(motion, options)
        blanks = polygons(motion.corners)
        if options.in_one_plane:  # any two sides may meet
            blanks = shapely.buffer(blanks, -0.5 * options.clearance_mm, join_style="mitre")
        else:
            blanks = _less(blanks, made._rubbing_sides(deployment))
        made._begin(blanks, known)
        for _ in range(ROUNDS):
            fewer = motion.without(sorted(made.weak))
            if fewer is motion:
                fewer = motion.without(sorted(made.cutting))
            if fewer is motion:
                break
            motion = fewer
            made = cls(motion, options)
            made._begin(blanks, known)
        return made

    def copy(self) -> Shaping:
        """Pieces to be shaped in another way, from where these are."""
        other = copy(self)
        other.bodies, other._parts, other._sweeps = self.bodies.copy(), dict(self._parts), self._sweeps
        return other

    @property
    def faults(self) -> int:
        """Number of pieces that fall apart, and of pins that have no wall or cut a neck."""
        return len(self.broken) + len(self.weak) + len(self.cutting)

    def _begin(self, blanks: GeometryArray, known: dict[_Notching, _Notched]) -> None:
        """Cut the notches; straps that cut a piece through go, then ears become smaller.

        Panels that have the same ears, and are passed by the same ones, as one in ``known`` are cut as that.
        """
        motion, options = self.motion, self.options
        mover, seen = self._passing_ears
        order = np.argsort(seen, kind="stable")
        passing = np.split(mover[order], np.cumsum(np.bincount(seen, minlength=len(blanks)))[:-1])
        self._straps = _Straps.of(motion, options).clear_of_walls(motion, options, mover, seen)
        radii = [0.5 * (0.5 * options.ear_mm + options.keep_mm), options.keep_mm]
        while True:
            straps = self._straps.by_ear()
            keys = [self._notching(index, movers, straps) for index, movers in enumerate(passing)]
            fresh = [index for index, key in enumerate(keys) if key not in known]
            known |= zip([keys[index] for index in fresh], self._notched(fresh, blanks, passing), strict=True)
            notched = [known[key] for key in keys]
            narrow = [one for one in notched if one.held is None]
            given_up = np.isin(self._straps.ear, [ear for one in narrow for ear in one.strapped.tolist()])
            if given_up.any():
                self._straps = self._straps.some(~given_up)
                continue
            cutting = np.concatenate([np.zeros(0, dtype=np.int64), *(one.movers for one in narrow)])
            if not len(cutting) or not radii or np.all(self.ear_radius.ravel()[cutting] <= radii[0]):
                break
            self.ear_radius.ravel()[cutting] = np.minimum(self.ear_radius.ravel()[cutting], radii.pop(0))
        self.cutting = set(motion.nodes.ravel()[cutting].tolist())
        for ear in np.unique(self._straps.ear).tolist():
            own = discs(self._straps.centre[self._straps.ear == ear], self._straps.radius, options.rounded_mm)
            plane = int(motion.plane[ear // 4])
            hull = Polygon(shapely.get_coordinates(shapely.union_all(own).convex_hull))
            self._parts[plane] = self._parts[plane].with_more(ear // 4, np.array([hull], dtype=object))
        for index, one in enumerate(notched):
            self._find_weak(index, self._most_pinned(index, one.shape) if one.held is None else one.held)
            self.bodies[index] = self._held_narrowly(index, one.shape) if one.held is None else one.held

    def _notching(self, index: int, movers: IntArray, straps: Mapping[int, bytes]) -> _Notching:
        """Key of the notches of a panel: its own ears, those that pass it, and their straps."""
        radius = self.ear_radius.ravel()
        own = np.flatnonzero(self.motion.hinged[index]) + 4 * index
        ears = own.tobytes(), radius[own].tobytes(), movers.tobytes(), radius[movers].tobytes()
        return index, *ears, b"".join(straps.get(ear, b"") for ear in (*own.tolist(), *movers.tolist()))

    def _notched(self, fresh: Sequence[int], blanks: GeometryArray, passing: Sequence[IntArray]) -> list[_Notched]:
        """Cut the notches of some panels; ``passing`` are the ears that may touch each."""
        motion = self.motion
        owner, corner = np.nonzero(motion.hinged & np.isin(np.arange(len(blanks)), fresh)[:, None])
        beyond = self.options.rounded_mm
        ears = discs(motion.corners[owner, corner], self.ear_radius[owner, corner], beyond)
        place, straps = np.zeros(len(blanks), dtype=np.int64), self._straps
        place[fresh] = np.arange(len(fresh))
        strapped = np.isin(straps.ear // 4, fresh)
        parts = np.concatenate([blanks[fresh], ears, discs(straps.centre[strapped], straps.radius, beyond)])
        owners = np.concatenate([np.arange(len(fresh)), place[owner], place[straps.ear[strapped] // 4]])
        whole = _united_by(parts, owners, len(fresh))
        mover = np.concatenate([np.zeros(0, dtype=np.int64), *(passing[index] for index in fresh)])
        seen = np.repeat(np.array(fresh, dtype=np.int64), [len(passing[index]) for index in fresh])
        number, passed = straps.passing(mover, seen)
        areas = np.concatenate(
            [
                self._swept_ears(mover, seen),
                self._sweep(straps.ear[number], passed, straps.centre[number], straps.radius + STRAP_SCALLOP),
            ]
        )
        mover, seen, is_strap = (
            np.concatenate(both)
            for both in (
                (mover, straps.ear[number]),
                (seen, passed),
                (np.zeros(len(mover), dtype=np.bool_), np.ones(len(number), dtype=np.bool_)),
            )
        )
        shapely.prepare(whole)
        meets = np.any(shapely.intersects(whole[place[seen]][:, None], areas), axis=1)
        notches = _united_by(areas[meets].ravel(), np.repeat(place[seen[meets]], areas.shape[1]), len(fresh))
        shapes = _less(whole, notches)
        return [
            _Notched(
                shape,
                self.held_together(index, shape),
                mover[meets & (seen == index) & ~is_strap],
                mover[meets & (seen == index) & is_strap],
            )
            for index, shape in zip(fresh, shapes, strict=True)
        ]

    def _most_pinned(self, index: int, shape: BaseGeometry) -> Polygon:
        """The part of a shape between necks that has most pins, and of those the largest."""
        centres = shapely.points(as_points(self.motion.corners[index][self.motion.hinged[index]]))
        half = 0.5 * self.options.neck_mm
        cores = shapely.get_parts(shapely.buffer(shape, -half)).tolist()
        if not cores:
            return _largest(shape)
        core = max(cores, key=lambda one: (int(np.sum(shapely.contains(one, centres))), float(one.area)))
        return _largest(shared(shapely.buffer(core, half, join_style="mitre", mitre_limit=MITRE), shape))

    def _find_weak(self, index: int, body: Polygon) -> None:
        """Note the nodes of a piece whose pins have less wall than asked for."""
        motion, options = self.motion, self.options
        corners = np.flatnonzero(motion.hinged[index])
        centres = shapely.points(as_points(motion.corners[index][corners]))
        wall = shapely.distance(body.exterior, centres) - 0.5 * options.pin_mm
        thin = ~shapely.contains(body, centres) | (wall < options.asked_wall_mm - 2.0 * NOTCH_TOLERANCE)
        self.weak |= set(motion.nodes[index, corners[thin]].tolist())

    def _rubbing_sides(self, deployment: Deployment) -> GeometryArray:
        """Strips (P,) along sides on which pieces of one layer meet, half of their gap wide."""
        motion, ratios = self.motion, deployment.field.ratio
        columns = deployment.sheet.columns
        strips = np.full(len(motion.layer), Polygon(), dtype=object)
        if self.options.side_mm <= 0.0:
            return strips
        lines: list[ComplexArray] = []
        owners: list[IntArray] = []
        place = np.full(ratios.size + sum(ratios.shape) + 1, -1)
        place[motion.panel] = np.arange(len(motion.panel))
        upper: IntArray = np.arange(len(place)).reshape(-1, columns + 1)[:-1, :-1]
        # Around a void: upper left with its lower right side, and so on; (panel, first corner, second corner).
        long_diagonal = [(upper, 2, 3), (upper + columns + 2, 0, 1)]
        short_diagonal = [(upper + 1, 1, 2), (upper + columns + 1, 3, 0)]
        for pair, longer in ((long_diagonal, ratios < 1.0), (short_diagonal, ratios > 1.0)):
            for panel, start, end in pair:
                owner = place[panel[longer]]
                owners.append(owner[owner >= 0])
                lines.append(motion.corners[owners[-1]][:, [start, end]])
        sides = np.asarray(shapely.linestrings(as_points(np.concatenate(lines))), dtype=object)
        wide = shapely.buffer(sides, 0.5 * self.options.side_mm, cap_style="flat")
        return _united_by(wide, np.concatenate(owners), len(strips))

    @property
    def reach_mm(self) -> float:
        """How far pieces are extended at most."""
        return self.options.reach * self.motion.cell_mm

    @cached_property
    def pairs(self) -> IntArray:
        """Pairs (K, 2) of pieces of one plane that may come near each other; the second is passed."""
        return self.motion.close_pairs(2.0 * self.options.ear_mm + 3.0 * self.reach_mm + self.options.clearance_mm)

    @cached_property
    def _passing_ears(self) -> tuple[IntArray, IntArray]:
        """Ears, as flat indices of corners, and the panels of their plane that they may touch."""
        return self._ears_near(self.reach_mm)

    @cached_property
    def _reached_ears(self) -> tuple[IntArray, IntArray]:
        """The same with panels that are extended in both end states."""
        return self._ears_near(3.0 * self.reach_mm)

    def _ears_near(self, reach_mm: float) -> tuple[IntArray, IntArray]:
        """Ears and panels of their plane, larger by a reach, that they may touch."""
        motion, options = self.motion, self.options
        one, other = self.pairs.T
        ear = (4 * one[:, None] + np.arange(4)).ravel()
        seen = np.repeat(other, 4)
        # An ear on a panel's own node is shaped to it by the joint.
        passing = motion.hinged.ravel()[ear] & np.all(motion.nodes[seen] != motion.nodes.ravel()[ear, None], axis=1)
        ear, seen = ear[passing], seen[passing]
        middle = motion.corners.mean(axis=1)
        radius = np.abs(motion.corners - middle[:, None]).max(axis=1)
        radius += options.ear_mm + options.clearance_mm + reach_mm
        apart = motion.distance_on_arc(middle[seen], motion.corners.ravel()[ear], ear // 4, seen)
        near = apart <= radius[seen]
        return ear[near], seen[near]

    def _swept_ears(self, ear: IntArray, seen: IntArray) -> GeometryArray:
        """Areas (K, 3) that ears (flat indices of corners) with clearance sweep, seen from panels."""
        return self._sweep(ear, seen, self.motion.corners.ravel()[ear], self.ear_radius.ravel()[ear])

    def _sweep(self, ear: IntArray, seen: IntArray, centre: ComplexArray, radius: FloatArray | float) -> GeometryArray:
        """The same of other discs of the ears' panels."""
        if not len(ear):
            return np.empty((0, 3), dtype=object)
        motion = self.motion
        grown = np.broadcast_to(radius + self.options.clearance_mm, centre.shape)
        drift = motion.seen_drift(ear // 4, seen, centre)
        turns, within = motion.sense[seen] * motion.opening, self.options.rounded_mm
        return swept_discs(centre, drift, turns, grown, NOTCH_TOLERANCE, within)

    @cached_property
    def _sweeps(self) -> list[tuple[GeometryArray, shapely.STRtree]]:
        """Sweeps (K,) of the ears that may touch each panel, and a tree of them."""
        mover, seen = self._reached_ears
        order = np.argsort(seen, kind="stable")
        swept = self._swept_ears(mover[order], seen[order])
        ends = np.cumsum(np.bincount(seen, minlength=len(self.bodies)))[:-1]
        return [(one.ravel(), shapely.STRtree(one.ravel())) for one in np.split(swept, ends)]

    @cached_property
    def ear_distances(self) -> tuple[IntArray, IntArray, FloatArray]:
        """Two ears in one plane (flat indices of corners), and their least distance, mm.

        Of each pair of pieces that pass each other, both ways round.
        """
        motion = self.motion
        mover, seen = self._passing_ears
        first, second = np.repeat(mover, 4), (4 * seen[:, None] + np.arange(4)).ravel()
        hinged = motion.hinged.ravel()[second]
        first, second = first[hinged], second[hinged]
        corners = motion.corners.ravel()
        return first, second, motion.distance_on_arc(corners[second], corners[first], first // 4, second // 4)

    def free(self, index: int, area: BaseGeometry) -> BaseGeometry:
        """The part of an area that no other piece of its plane needs, seen from a piece.

        Parts below ``LEAST_PART`` are left out.
        """
        free = _worthwhile(area)
        if len(free):
            ears, tree = self._sweeps[index]
            touching = np.unique(tree.query(free, predicate="intersects")[1])
            free = _worthwhile(less(together(free), united(*ears[touching])))
        if len(free):
            free = _worthwhile(less(together(free), self._swept_bodies(index, free)))
        return together(free)

    def _swept_bodies(self, index: int, parts: GeometryArray) -> BaseGeometry:
        """Area near some parts that other pieces sweep with their clearance, seen from a piece."""
        motion = self.motion
        grown = self.options.clearance_mm + BODY_TOLERANCE
        boxes = shapely.bounds(parts) + grown * np.array([-1.0, -1.0, 1.0, 1.0])
        (left, bottom), (right, top) = boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)
        middle, half = 0.5 * complex(left + right, bottom + top), 0.5 * abs(complex(right - left, top - bottom))
        others = self._parts[int(motion.plane[index])]
        moving = np.flatnonzero(others.owner != index)
        here = np.full(len(moving), index)
        apart = motion.distance_on_arc(np.full(len(moving), middle), others.centre[moving], others.owner[moving], here)
        moving = moving[apart <= half + others.radius[moving]]
        corners = others.corners[moving]
        drifts = motion.seen_drift(others.owner[moving], here[: len(moving)], corners)
        turn = float(motion.sense[index]) * motion.opening
        hulls = swept_hulls(corners, drifts, turn, BODY_TOLERANCE, boxes)
        whole = together(parts)
        shapely.prepare(whole)
        near = shapely.union_all(hulls[shapely.dwithin(whole, hulls, grown)])
        swept: BaseGeometry = near.buffer(grown / math.cos(0.25 * math.pi / ZONE_CHORDS), quad_segs=ZONE_CHORDS)
        return swept

    def held_together(self, index: int, shape: BaseGeometry) -> Polygon | None:
        """The part of a shape that has all ears of a piece, and nothing narrower than a neck.

        None where the ears do not hang together by necks as wide as those of the piece.
        """
        wide = self._between_necks(index, shape)
        return None if wide is None else self._tidied(shared(wide, shape))

    def _between_necks(self, index: int, shape: BaseGeometry) -> BaseGeometry | None:
        """The area of the same part, larger by ``CLEAR`` all round."""
        centres = shapely.points(as_points(self.motion.corners[index][self.motion.hinged[index]]))
        half = 0.5 * float(self.neck_mm[index])
        for core in shapely.get_parts(shapely.buffer(shape, -half)):
            if np.all(shapely.contains(core, centres)):
                wide: BaseGeometry = shapely.buffer(core, half + CLEAR, join_style="mitre", mitre_limit=MITRE)
                return wide
        return None

    def _tidied(self, shape: BaseGeometry) -> Polygon:
        """The largest part, without needless vertices and holes too small for an ear."""
        return _tidy(_largest(shape), 0.25 * math.pi * self.options.ear_mm**2)

    def _held_narrowly(self, index: int, shape: BaseGeometry) -> Polygon:
        """The same by the widest necks that there are; the largest part where there are none."""
        for share in NARROWER:
            self.neck_mm[index] = share * self.options.neck_mm
            if (one := self.held_together(index, shape)) is not None:
                return one
        self.broken.add(index)
        return _largest(shape)

    def with_more(self, index: int, room: BaseGeometry) -> tuple[Polygon, BaseGeometry] | None:
        """Body of a piece with what of an area hangs on to it by a neck, and that; or None."""
        body: Polygon = self.bodies[index]
        both = united(body, room)
        if (wide := self._between_necks(index, both)) is None:
            return None
        if wide.covers(both):
            return self._tidied(both), room
        frame = wide if wide.covers(body) else united(wide, body)
        whole = shared(both, frame)
        return self._tidied(whole), room if both.area - whole.area < TOO_SMALL else shared(room, frame)

    def add(self, index: int, shape: Polygon, added: BaseGeometry) -> None:
        """Give a piece a larger shape; the part ``added`` counts for all that pass it later."""
        new = shapely.get_parts(added)
        plane = int(self.motion.plane[index])
        self._parts[plane] = self._parts[plane].with_more(index, new[shapely.area(new) > TOO_SMALL])
        self.bodies[index] = shape

    def close_slits(self) -> None:
        """Close slits narrower than ``SLIT``, left where sides of additions meet."""
        closed = shapely.buffer(shapely.buffer(self.bodies, SLIT, join_style="mitre"), -SLIT, join_style="mitre")
        slit = shapely.length(self.bodies) - shapely.length(closed) > SLIT_LENGTH
        self.bodies[slit] = closed[slit]

    def placed(self, turn: float) -> GeometryArray:
        """All pieces at t = ``turn``, in the frame of the deployment, mm."""
        return self.motion.placed(self.bodies, np.arange(len(self.bodies)), turn)


@dataclass(frozen=True, slots=True, eq=False)
class _Straps:
    """Discs that lead from ears at sharp corners to where the panel is as wide as a neck.

    An ear of radius r hangs on 2 r sin(w / 2) of a panel with the angle w there.
    """

    ear: IntArray  #: (D,); the ear of each disc, as the flat index of its corner
    centre: ComplexArray  #: (D,), mm
    radius: float  #: mm

    @classmethod
    def of(cls, motion: LayerMotion, options: PinOptions) -> _Straps:
        """Straps of all corners that need one; none in a single plane, where partners turn."""
        before, after = (np.roll(motion.corners, way, axis=1) - motion.corners for way in (1, -1))
        half = 0.5 * np.abs(np.angle(before / after))
        radius = 0.5 * options.neck_mm + STRAP_MORE
        needed = motion.hinged & (options.ear_mm * np.sin(half) < options.neck_mm) & (not options.in_one_plane)
        ears = np.flatnonzero(needed)
        inwards = (before / np.abs(before) + after / np.abs(after)).ravel()[ears]
        inwards /= np.abs(inwards)
        first = 0.5 * options.ear_mm - radius
        last = np.minimum(0.5 * options.neck_mm / np.sin(half.ravel()[ears]), options.ear_mm + options.clearance_mm)
        steps = np.ceil((last - first) / STRAP_STEP).astype(np.int64).clip(1) + 1
        share = np.concatenate([np.linspace(0.0, 1.0, count) for count in steps] or [np.zeros(0)])
        along = first + share * np.repeat(last - first, steps)
        ear = np.repeat(ears, steps)
        return cls(ear, motion.corners.ravel()[ear] + along * np.repeat(inwards, steps), radius)

    def clear_of_walls(self, motion: LayerMotion, options: PinOptions, mover: IntArray, seen: IntArray) -> _Straps:
        """Those discs whose notches leave the walls of all pins beside; see :meth:`passing`."""
        number, passed = self.passing(mover, seen)
        number, panel = np.repeat(number, 4), np.repeat(passed, 4)
        pins = motion.corners[passed].ravel()
        apart = motion.distance_on_arc(pins, self.centre[number], self.ear[number] // 4, panel)
        least = self.radius + options.clearance_mm + STRAP_SCALLOP + 0.5 * options.pin_mm + options.asked_wall_mm
        near = number[(apart < least) & motion.hinged[passed].ravel()]
        return self.some(~np.isin(np.arange(len(self.ear)), near))

    def by_ear(self) -> dict[int, bytes]:
        """Centres of the discs of each ear that has some."""
        first = np.flatnonzero(np.diff(self.ear, prepend=-1))  # those of one ear follow each other
        centres = np.split(self.centre, first[1:])
        return {ear: one.tobytes() for ear, one in zip(self.ear[first].tolist(), centres, strict=False)}

    def some(self, chosen: BoolArray) -> _Straps:
        """Those discs that are chosen."""
        return _Straps(self.ear[chosen], self.centre[chosen], self.radius)

    def passing(self, mover: IntArray, seen: IntArray) -> tuple[IntArray, IntArray]:
        """Numbers of discs, and the panels that they may touch, from those of ears."""
        order = np.argsort(mover, kind="stable")
        first, last = (np.searchsorted(mover[order], self.ear, side=side) for side in ("left", "right"))
        pairs = [order[one:other] for one, other in zip(first, last, strict=True)]
        number = np.repeat(np.arange(len(self.ear)), last - first)
        return number, seen[np.concatenate([np.zeros(0, dtype=np.int64), *pairs])]


@dataclass(frozen=True, slots=True, eq=False)
class _ConvexParts:
    """Convex polygons that sweep with pieces of one layer."""

    owner: IntArray  #: (C,)
    corners: ComplexArray  #: (C, K), mm; the last one repeated where there are fewer
    centre: ComplexArray  #: (C,), mm
    radius: FloatArray  #: (C,), mm; of a circle round each

    @classmethod
    def of(cls, owner: IntArray, corners: ComplexArray) -> _ConvexParts:
        """Polygons by their corners."""
        centre = corners.mean(axis=1)
        return cls(owner, corners, centre, np.abs(corners - centre[:, None]).max(axis=1))

    def with_more(self, owner: int, shapes: GeometryArray) -> _ConvexParts:
        """These polygons, and convex ones that cover small shapes of one piece."""
        if not len(shapes):
            return self
        points, number = shapely.get_coordinates(_covered_by_convex(shapes), return_index=True)
        inner = np.append(number[1:] == number[:-1], False)  # rings end where they begin
        corners, counts = as_plane(points[inner]), np.bincount(number[inner])
        width = max(self.corners.shape[1], int(counts.max()))
        place = np.minimum(np.arange(width), counts[:, None] - 1) + (np.cumsum(counts) - counts)[:, None]
        more = _ConvexParts.of(np.full(len(counts), owner), corners[place])
        here = np.pad(self.corners, ((0, 0), (0, width - self.corners.shape[1])), mode="edge")
        return _ConvexParts(
            np.concatenate([self.owner, more.owner]),
            np.concatenate([here, more.corners]),
            np.concatenate([self.centre, more.centre]),
            np.concatenate([self.radius, more.radius]),
        )


def _covered_by_convex(shapes: GeometryArray) -> GeometryArray:
    """Cover small shapes by convex polygons: coarse hulls, or triangles of hollow shapes."""
    hulls = shapely.convex_hull(shapes)
    compact = shapely.area(hulls) < 1.25 * shapely.area(shapes)
    grown = shapely.buffer(np.where(compact, hulls, shapes), COARSE, join_style="mitre")
    coarse = shapely.simplify(grown, COARSE)
    triangles = [
        one if whole else shapely.constrained_delaunay_triangles(one)
        for one, whole in zip(coarse, compact, strict=True)
    ]
    found: GeometryArray = shapely.get_parts(np.array(triangles, dtype=object))
    return found


def less(shape: BaseGeometry, other: BaseGeometry) -> BaseGeometry:
    """The areas of a shape outside of another."""
    return _areas(_overlay(shapely.difference, shape, other))


def shared(shape: BaseGeometry, other: BaseGeometry) -> BaseGeometry:
    """The areas that two shapes share."""
    return _areas(_overlay(shapely.intersection, shape, other))


def united(*shapes: BaseGeometry) -> BaseGeometry:
    """The areas of several shapes together."""
    return _areas(_overlay(shapely.union_all, shapes)) if shapes else Polygon()


def together(parts: GeometryArray) -> BaseGeometry:
    """Polygons, of which no two overlap, as one shape."""
    found = shapely.multipolygons(shapely.get_parts(parts))
    assert isinstance(found, BaseGeometry)  # one array makes one geometry
    return found


def _worthwhile(shape: BaseGeometry) -> GeometryArray:
    """The parts of a shape that are not too small."""
    parts: GeometryArray = shapely.get_parts(shape)
    return parts[shapely.area(parts) >= LEAST_PART]


def _overlay(overlay: Callable[..., BaseGeometry], *shapes: BaseGeometry | Sequence[BaseGeometry]) -> BaseGeometry:
    """An overlay in floating point, or on a fine grid where that fails."""
    try:
        return overlay(*shapes)
    except shapely.GEOSException:
        return overlay(*map(_valid, shapes), grid_size=SNAPPED_MM)


def _valid(shape: BaseGeometry | Sequence[BaseGeometry]) -> BaseGeometry:
    """The areas of a shape, or of several, without parts that overlap or have no area."""
    parts = [shape] if isinstance(shape, BaseGeometry) else shape
    return shapely.GeometryCollection([_areas(shapely.make_valid(part)) for part in parts]).buffer(0.0)


def _areas(shape: BaseGeometry) -> BaseGeometry:
    """The shape without points and lines in which two areas touch."""
    if shape.geom_type in ("Polygon", "MultiPolygon"):
        return shape
    parts = shapely.get_parts(shape)
    return _overlay(shapely.union_all, parts[shapely.get_dimensions(parts) == 2])


def _tidy(part: Polygon, least_hole: float) -> Polygon:
    """The polygon without vertices on straight lines, and without holes too small for an ear."""
    rings = [ring for ring in part.interiors if Polygon(ring).area > least_hole]
    for careful in (False, True):  # which takes five times as long
        simple = shapely.simplify(Polygon(part.exterior, rings), STRAIGHT, preserve_topology=careful)
        if simple.is_valid and isinstance(simple, Polygon) and not simple.is_empty:
            return simple
    return part


def _largest(shape: BaseGeometry) -> Polygon:
    parts: list[Polygon] = shapely.get_parts(shape).tolist()
    return max(parts, key=lambda part: float(part.area))


def _less(shapes: GeometryArray, others: GeometryArray) -> GeometryArray:
    made: GeometryArray = np.asarray(shapely.difference(shapes, others), dtype=object)
    return made


def _united_by(shapes: GeometryArray, owner: IntArray, count: int) -> GeometryArray:
    """Unions (count,) of the shapes that belong to each owner."""
    order = np.argsort(owner, kind="stable")
    groups = np.split(np.asarray(shapes, dtype=object)[order], np.cumsum(np.bincount(owner, minlength=count))[:-1])
    together = np.full(count, Polygon(), dtype=object)
    for index, group in enumerate(groups):
        if len(group):
            together[index] = shapely.union_all(group)
    return together
