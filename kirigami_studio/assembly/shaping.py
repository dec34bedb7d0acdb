"""Pieces while they are being made: panel, ears, notches, and everything that moves past them in their layer."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.assembly.motion import GeometryArray, LayerMotion, discs, swept_discs, swept_hulls
from kirigami_studio.assembly.options import PinOptions
from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.foundation.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from kirigami_studio.lattice.deployment import Deployment

#: Notches contain the exact sweep of ears and clearance, and exceed it by this at most, mm.
NOTCH_TOLERANCE = 0.01
#: Sagitta of the chords by which bodies are swept, mm: an extension keeps as much more distance than it has to.
BODY_TOLERANCE = 0.04
#: By this, mm, outlines of what is swept are coarser than the bodies.
COARSE = 0.25
#: Corners sharper than 2 asin(1 / MITRE) = 23 degrees are blunted.
MITRE = 5.0
#: Parts added to a piece overlap it by this, mm, so that they hold together in floating point.
OVERLAP = 0.004
#: Differences between polygons that are smaller, mm2, are those of rounding.
TOO_SMALL = 1e-3
#: Vertices that lie nearer than this, mm, to the line between their neighbours are left out.
STRAIGHT = 0.002


@dataclass(eq=False)
class Shaping:
    """The pieces of one design in the frame of the flat sheet, mm; they change while rims are shaped.

    Attributes
    ----------
    motion : LayerMotion
    options : PinOptions
    bodies : (P,) Polygon
        What there is of each piece, holes not drilled.
    broken : set of int
        Panels whose ears do not hang together.
    """

    motion: LayerMotion
    options: PinOptions
    bodies: GeometryArray = field(init=False)
    broken: set[int] = field(default_factory=set)

    def __post_init__(self) -> None:
        self._parts = {1: _ConvexParts(), 2: _ConvexParts()}
        for layer, parts in self._parts.items():
            members = np.flatnonzero(self.motion.layer == layer)
            parts.add(members, list(self.motion.corners[members]))
        self.bodies = np.array([Polygon()] * len(self.motion.layer), dtype=object)

    @classmethod
    def of(cls, deployment: Deployment, cell_mm: float, phi_target: float, options: PinOptions) -> Shaping:
        """Panels with ears, less what the ears of their neighbours sweep."""
        made = cls(LayerMotion.of(deployment, cell_mm, phi_target), options)
        made._begin(deployment)
        return made

    def _begin(self, deployment: Deployment) -> None:
        motion, options = self.motion, self.options
        panels = _less(shapely.polygons(as_points(motion.corners)), self._rubbing_sides(deployment))
        owner, corner = np.nonzero(motion.hinged)
        ears = discs(motion.corners[owner, corner], 0.5 * options.ear_mm)
        whole = _united_by(np.concatenate([panels, ears]), np.concatenate([np.arange(len(panels)), owner]), len(panels))
        self.bodies = whole
        mover, seen = self._passing_ears
        areas = self._swept_ears(mover, seen, 0.5 * options.ear_mm + options.clearance_mm)
        meets = np.any(shapely.intersects(areas, whole[seen][:, None]), axis=1)
        notches = _united_by(areas[meets].ravel(), np.repeat(seen[meets], areas.shape[1]), len(panels))
        for index, shape in enumerate(_less(whole, notches)):
            one = self.held_together(index, shape)
            if one is None:
                self.broken.add(index)
                one = _largest(shape)
            self.bodies[index] = one

    def _rubbing_sides(self, deployment: Deployment) -> GeometryArray:
        """Strips along the sides on which pieces of one layer meet, half of their gap wide: (P,) geometry."""
        motion, ratios = self.motion, deployment.field.ratio
        rows, columns = ratios.shape
        strips: GeometryArray = np.array([Polygon()] * len(motion.layer), dtype=object)
        if self.options.side_mm <= 0.0:
            return strips
        lines: list[ComplexArray] = []
        owners: list[IntArray] = []
        row, column = np.indices(ratios.shape)
        upper = row * (columns + 1) + column
        # Around a void: upper left with its lower right side, and so on; (panel, first corner, second corner).
        long_diagonal = [(upper, 2, 3), (upper + columns + 2, 0, 1)]
        short_diagonal = [(upper + 1, 1, 2), (upper + columns + 1, 3, 0)]
        for sides, longer in ((long_diagonal, ratios < 1.0), (short_diagonal, ratios > 1.0)):
            for panel, start, end in sides:
                corners = motion.corners[panel[longer]]
                lines.append(corners[:, [start, end]])
                owners.append(panel[longer])
        owner = np.concatenate(owners)
        wide = shapely.buffer(
            shapely.linestrings(as_points(np.concatenate(lines))), 0.5 * self.options.side_mm, cap_style="flat"
        )
        return _united_by(wide, owner, len(strips))

    @cached_property
    def pairs(self) -> IntArray:
        """Pairs (K, 2) of pieces of one layer that may come near each other: one that moves past the other."""
        return self.motion.close_pairs(2.0 * (self.options.ear_mm + self.options.reach_mm) + self.options.clearance_mm)

    @cached_property
    def _passing_ears(self) -> tuple[IntArray, IntArray]:
        """Ears, as flat indices of corners, and the panels of their layer that they may touch."""
        motion, options = self.motion, self.options
        one, other = self.pairs.T
        ear = (4 * one[:, None] + np.arange(4)).ravel()
        seen = np.repeat(other, 4)
        hinged = motion.hinged.ravel()[ear]
        ear, seen = ear[hinged], seen[hinged]
        middle = motion.corners.mean(axis=1)
        radius = np.abs(motion.corners - middle[:, None]).max(axis=1) + options.ear_mm + options.clearance_mm
        apart = motion.distance_on_arc(middle[seen], motion.corners.ravel()[ear], ear // 4, seen)
        near = apart <= radius[seen]
        return ear[near], seen[near]

    def _swept_ears(self, ear: IntArray, seen: IntArray, radius: float) -> GeometryArray:
        motion = self.motion
        drift = motion.drift[ear // 4] - motion.drift[seen]
        turn = motion.sense[seen] * motion.opening
        return swept_discs(motion.corners.ravel()[ear], drift, turn, radius, NOTCH_TOLERANCE)

    @cached_property
    def ear_distances(self) -> tuple[IntArray, IntArray, FloatArray]:
        """Corners (flat indices) of two ears in one layer, and their least distance over the motion, mm.

        Of each pair of pieces that pass each other, both ways round.
        """
        motion = self.motion
        mover, seen = self._passing_ears
        first, second = np.repeat(mover, 4), (4 * seen[:, None] + np.arange(4)).ravel()
        hinged = motion.hinged.ravel()[second]
        first, second = first[hinged], second[hinged]
        corners = motion.corners.ravel()
        return first, second, motion.distance_on_arc(corners[second], corners[first], first // 4, second // 4)

    def blocked(self, index: int, window: BaseGeometry) -> BaseGeometry:
        """The area near a window (flat) that other pieces of its layer need when piece ``index`` is there."""
        motion, options = self.motion, self.options
        grown = options.clearance_mm + BODY_TOLERANCE
        left, bottom, right, top = window.bounds
        box = (left - grown, bottom - grown, right + grown, top + grown)
        middle, reach = (
            0.5 * complex(left + right, bottom + top),
            0.5 * abs(complex(right - left, top - bottom)) + grown,
        )
        turn = float(motion.sense[index]) * motion.opening

        def near(mover: IntArray, place: ComplexArray, radius: FloatArray | float) -> BoolArray:
            seen = np.full(len(mover), index)
            return motion.distance_on_arc(np.full(len(mover), middle), place, mover, seen) <= reach + radius

        parts = self._parts[int(motion.layer[index])]
        moving = parts.owner != index
        moving[moving] = near(parts.owner[moving], parts.centre[moving], parts.radius[moving])
        hulls = [
            swept_hulls(
                parts.corners[part],
                complex(motion.drift[parts.owner[part]] - motion.drift[index]),
                turn,
                BODY_TOLERANCE,
                box,
            )
            for part in np.flatnonzero(moving)
        ]
        bodies = shapely.buffer(shapely.union_all(np.concatenate(hulls)), grown) if hulls else Polygon()
        mover, seen = self._passing_ears
        mover = mover[seen == index]
        radius = 0.5 * options.ear_mm + options.clearance_mm
        mover = mover[near(mover // 4, motion.corners.ravel()[mover], radius)]
        ears = self._swept_ears(mover, np.full(len(mover), index), radius).ravel()
        touching = ears[shapely.intersects(ears, window)]
        return shapely.union_all(np.append(shapely.clip_by_rect(touching, *box), bodies))

    def held_together(self, index: int, shape: BaseGeometry) -> Polygon | None:
        """The part of a shape with all ears of a piece, without anything narrower than the least neck.

        None where the ears do not hang together by necks that are wide enough.
        """
        centres = shapely.points(as_points(self.motion.corners[index][self.motion.hinged[index]]))
        for part in shapely.get_parts(opened(shape, self.options.neck_mm)):
            if np.all(shapely.contains(part, centres)):
                return _tidy(part, 0.25 * math.pi * self.options.ear_mm**2)
        return None

    def add(self, index: int, shape: Polygon) -> None:
        """Give a piece a larger shape; it is kept in mind by all that move past it later."""
        added = shapely.get_parts(less(shape, self.bodies[index]))
        parts = [convex for part in added[shapely.area(added) > TOO_SMALL] for convex in _convex_parts(part)]
        self._parts[int(self.motion.layer[index])].add([index] * len(parts), parts)
        self.bodies[index] = shape

    def placed(self, turn: float) -> GeometryArray:
        """All pieces at t = ``turn``, in the frame of the deployment, mm."""
        return self.motion.placed(self.bodies, np.arange(len(self.bodies)), turn)


class _ConvexParts:
    """Convex polygons that sweep with pieces of one layer.

    Attributes
    ----------
    owner : (C,) int
    corners : list of (K,) complex, mm
    centre : (C,) complex, mm
    radius : (C,) float, mm
        Of a circle round each.
    """

    def __init__(self) -> None:
        self.owner = np.zeros(0, dtype=np.int64)
        self.corners: list[ComplexArray] = []
        self.centre = np.zeros(0, dtype=np.complex128)
        self.radius = np.zeros(0)

    def add(self, owner: IntArray | Sequence[int], corners: Sequence[ComplexArray]) -> None:
        """Add polygons (C,) with their owners."""
        if not len(corners):
            return
        centre = np.array([part.mean() for part in corners])
        radius = np.array([np.abs(part - place).max() for part, place in zip(corners, centre, strict=True)])
        self.owner = np.concatenate([self.owner, np.asarray(owner, dtype=np.int64)])
        self.corners += corners
        self.centre, self.radius = np.concatenate([self.centre, centre]), np.concatenate([self.radius, radius])


def opened(shape: BaseGeometry, width: float) -> BaseGeometry:
    """The shape without anything narrower than a width: its morphological opening, corners kept."""
    core = shapely.buffer(shape, -0.5 * width, join_style="mitre", mitre_limit=MITRE)
    return shared(shapely.buffer(core, 0.5 * width, join_style="mitre", mitre_limit=MITRE), shape)


def less(shape: BaseGeometry, other: BaseGeometry) -> BaseGeometry:
    """The areas of a shape outside of another."""
    return _areas(shape.difference(other))


def shared(shape: BaseGeometry, other: BaseGeometry) -> BaseGeometry:
    """The areas that two shapes share."""
    return _areas(shape.intersection(other))


def united(*shapes: BaseGeometry) -> BaseGeometry:
    """The areas of several shapes together."""
    return _areas(shapely.union_all(shapes))


def _areas(shape: BaseGeometry) -> BaseGeometry:
    """The shape without points and lines in which two areas touch."""
    if shape.geom_type in ("Polygon", "MultiPolygon"):
        return shape
    parts = shapely.get_parts(shape)
    return shapely.union_all(parts[shapely.get_dimensions(parts) == 2])


def _tidy(part: Polygon, least_hole: float) -> Polygon:
    """The polygon without vertices on straight lines, and without holes that nothing could move in."""
    rings = [ring for ring in part.interiors if Polygon(ring).area > least_hole]
    simple = shapely.simplify(Polygon(part.exterior, rings), STRAIGHT)
    return simple if simple.is_valid and simple.geom_type == "Polygon" else part


def _convex_parts(part: Polygon) -> list[ComplexArray]:
    """Convex polygons that cover a small part."""
    hull = part.convex_hull
    if hull.geom_type != "Polygon":
        return []
    if hull.area < 1.25 * part.area:
        coarse = [shapely.simplify(shapely.buffer(hull, COARSE, join_style="mitre"), COARSE)]
    else:
        rounded = shapely.simplify(shapely.buffer(part, COARSE, join_style="mitre"), COARSE)
        coarse = shapely.get_parts(shapely.constrained_delaunay_triangles(rounded))
    return [as_plane(shapely.get_coordinates(one)[:-1]) for one in coarse]


def _largest(shape: BaseGeometry) -> Polygon:
    return max(shapely.get_parts(shape), key=lambda part: float(part.area))


def _less(shapes: GeometryArray, others: GeometryArray) -> GeometryArray:
    made: GeometryArray = np.asarray(shapely.difference(shapes, others), dtype=object)
    return made


def _united_by(shapes: GeometryArray, owner: IntArray, count: int) -> GeometryArray:
    """Unions (count,) of the shapes that belong to each owner."""
    order = np.argsort(owner, kind="stable")
    groups = np.split(np.asarray(shapes, dtype=object)[order], np.cumsum(np.bincount(owner, minlength=count))[:-1])
    united: GeometryArray = np.array([Polygon()] * count, dtype=object)
    for index, group in enumerate(groups):
        if len(group):
            united[index] = shapely.union_all(group)
    return united
