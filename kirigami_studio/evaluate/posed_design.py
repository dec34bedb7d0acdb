"""The moving sheet in the target's frame: one motion for the screen, pictures and the animation.

A deployment is computed in its own layout frame.  A :class:`PosedDesign` places it over its target at the target angle
and, at every other angle, keeps the mean of all nodes where it is then.  While the sheet closes to the flat one, it
turns until that stands upright.  What trimming left of the edge panels, and what it took, turns and moves with the
panels.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry.base import BaseGeometry

from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.evaluate.kept_panels import GRID
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.trimming import Trim
from kirigami_studio.foundation.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from kirigami_studio.lattice.deployment import Deployment

#: Angles at which the motion's extent is sampled; the extent is smooth in the angle.
EXTENT_SAMPLES = 9
#: A flat rectangle is turned by this much (radians) more than an eighth before its next side counts as the lower one:
#: designs over a square are often posed at 45 degrees, and what a hand edit changes there must not turn the sheet.
SLACK = math.radians(1.0)


@dataclass(frozen=True, slots=True, eq=False)
class PosedDesign:
    """One design over its target at ``phi_target``, and at every other angle with the same centre (mean of all nodes).

    From ``phi_target`` to the flat sheet it turns with the angle until the flat sheet is upright: rectangles by an
    eighth of a turn or a degree more, so that they may stand on their short side; other start outlines to the side that
    is theirs.
    """

    deployment: Deployment
    pose: Similarity  #: layout frame at ``phi_target`` -> world
    phi_target: float  #: radians
    trim: Trim | None = None  #: what was cut off the edge panels

    @property
    def turn(self) -> float:
        """How far the flat sheet is turned back, so that it stands upright; radians, counter-clockwise.

        A rectangle that could be turned either way, posed at 45 degrees, keeps its long side where it is.
        """
        whole = 0.5 * math.pi if self.deployment.sheet.start is None else 2.0 * math.pi
        angle = abs(self.pose.angle)
        upright = whole * math.floor((angle + 0.5 * whole - SLACK) / whole)
        return math.copysign(1.0, self.pose.angle) * (upright - angle)

    def pose_at(self, phi: float) -> Similarity:
        """Layout frame at angle ``phi`` -> world."""
        return _pose_at(self, phi)

    def nodes(self, phi: float) -> FloatArray:
        """All nodes at angle ``phi``: (N, 2) float, world, not to be written to."""
        return _placed_nodes(self, phi)

    def panels(self, nodes: FloatArray) -> FloatArray:
        """Panel corners (K, 4, 2) out of :meth:`nodes`."""
        return nodes[self.deployment.topology.panel_nodes].reshape(-1, 4, 2)

    def voids(self, nodes: FloatArray) -> FloatArray:
        """Void corners p0 to p3 (m, n, 4, 2) out of :meth:`nodes`."""
        return nodes[self.deployment.topology.void_nodes]

    def mm_per_world(self, width_mm: float) -> float:
        """Millimetres of one world unit, where the flat sheet is ``width_mm`` wide."""
        return width_mm / (float(np.ptp(self.deployment.compact[:, 0])) * self.pose.scale)

    def kept(self, nodes: FloatArray, phi: float) -> dict[int, FloatArray]:
        """What stays of the trimmed panels, (P, 2) each by its row in :meth:`panels`, out of :meth:`nodes`.

        No points of those of which nothing stays.
        """
        if self.trim is None:
            return {}
        rings = trimmed_parts(self.deployment, self.trim).kept
        return dict(zip(rings.panel.tolist(), rings.at(nodes, self.pose_at(phi), phi), strict=True))

    def parts(self, phi: float) -> list[FloatArray]:
        """What there is of every panel at angle ``phi``, row by row: list of (P, 2) float, world."""
        nodes = self.nodes(phi)
        parts = list(self.panels(nodes))
        for row, part in self.kept(nodes, phi).items():
            parts[row] = part
        return [part for part in parts if len(part)]

    def removed(self, nodes: FloatArray, phi: float) -> list[FloatArray]:
        """What trimming cut off: list of (P, 2), out of :meth:`nodes`."""
        if self.trim is None:
            return []
        return trimmed_parts(self.deployment, self.trim).removed.at(nodes, self.pose_at(phi), phi)

    def outline(self, nodes: FloatArray, phi: float) -> FloatArray:
        """Boundary polygon (L, 2) out of :meth:`nodes`, before anything was cut off."""
        boundary: FloatArray = nodes[self.deployment.outline_loop(phi)]
        return boundary

    def silhouette(self, phi: float) -> list[FloatArray]:
        """Rings (P, 2) of the silhouette at ``phi``, world: the outer one, then holes; voids filled."""
        nodes = self.nodes(phi)
        outline = self.outline(nodes, phi)
        removed = self.removed(nodes, phi)
        if not removed:
            return [outline]
        cut = shapely.union_all(polygons_of(removed), grid_size=GRID)
        left = shapely.get_parts(shapely.difference(shapely.Polygon(outline), cut, grid_size=GRID))
        largest = shapely.orient_polygons(max(left, key=lambda part: float(part.area)))
        return [shapely.get_coordinates(ring)[:-1] for ring in (largest.exterior, *largest.interiors)]

    def to_world(self, places: npt.ArrayLike, phi: float) -> FloatArray:
        """Map places (..., 2) of the layout frame at ``phi`` to the world."""
        return self.pose_at(phi).apply(places)

    def to_layout(self, place: tuple[float, float], phi: float) -> FloatArray:
        """Map one place of the world to the layout frame at ``phi``: (2,), the way back of :meth:`to_world`."""
        return self.pose_at(phi).inverse().apply(np.asarray(place))

    def laid_over(self, made: Deployment) -> PosedDesign:
        """Another sheet of the same grid, posed so that its outline at ``phi_target`` is nearest to this one's.

        Nearest by least squares over the outline's nodes, each weighted by the length of outline that is its own.
        """
        meant = as_plane(self.outline(self.nodes(self.phi_target), self.phi_target))
        other = PosedDesign(made, Similarity(), self.phi_target, self.trim)
        own = as_plane(other.outline(made.nodes(self.phi_target), self.phi_target))
        length = np.abs(np.roll(meant, -1) - np.roll(meant, 1))
        there, here = (points - np.average(points, weights=length) for points in (meant, own))
        factor = complex(np.sum(length * there * np.conj(here)) / np.sum(length * np.abs(here) ** 2))
        shift = complex(np.average(meant - factor * own, weights=length))
        return PosedDesign(made, Similarity.from_complex(factor, shift), self.phi_target, self.trim)

    def extent(self) -> FloatArray:
        """Lower left and upper right corner of the box around the whole motion from pi to 0: (2, 2) float, world."""
        clouds = [self.nodes(float(phi)) for phi in np.linspace(math.pi, 0.0, EXTENT_SAMPLES)]
        lowest = np.min([cloud.min(axis=0) for cloud in clouds], axis=0)
        highest = np.max([cloud.max(axis=0) for cloud in clouds], axis=0)
        return np.stack([lowest, highest])


@lru_cache(maxsize=512)
def _placed_middle(design: PosedDesign) -> FloatArray:
    middle: FloatArray = design.pose.apply(design.deployment.nodes(design.phi_target)).mean(axis=0)
    return middle


@lru_cache(maxsize=16)
def _pose_at(design: PosedDesign, phi: float) -> Similarity:
    share = max((phi - design.phi_target) / (math.pi - design.phi_target), 0.0) if design.phi_target < math.pi else 0.0
    turned = replace(design.pose, angle=design.pose.angle + share * design.turn, shift=(0.0, 0.0))
    x, y = _placed_middle(design) - turned.apply(design.deployment.nodes(phi).mean(axis=0))
    return replace(turned, shift=(float(x), float(y)))


@lru_cache(maxsize=16)
def _placed_nodes(design: PosedDesign, phi: float) -> FloatArray:
    """The nodes at the angles that were asked for last: whoever draws a design asks several times."""
    placed = design.pose_at(phi).apply(design.deployment.nodes(phi))
    placed.setflags(write=False)
    return placed


@lru_cache(maxsize=256)
def trimmed_parts(deployment: Deployment, trim: Trim) -> TrimmedParts:
    """Both sides of a trim: 10 ms for 40 trimmed panels, so they are divided when a design is decoded, and kept."""
    return TrimmedParts.of(deployment, trim)


def covered(
    sheet: FloatArray, target: shapely.Polygon, removed: Sequence[FloatArray] = (), voids: FloatArray | None = None
) -> BaseGeometry:
    """The area within the outline of a sheet (L, 2), crossings and all, less what was cut off.

    Parameters
    ----------
    removed : sequence of (P, 2) float, world
        What was cut off.
    voids : (V, 4, 2) float, world, optional
        They count as covered, but for those beside the target that a cut has opened.
    """
    area: BaseGeometry = shapely.Polygon(sheet)
    if not area.is_valid:
        area = _without_lines(shapely.make_valid(area))
    if not removed:
        return area
    off = shapely.union_all(polygons_of(removed), grid_size=GRID)
    area = shapely.difference(area, off, grid_size=GRID)
    if voids is not None:
        openings = np.asarray(shapely.polygons(voids), dtype=np.object_)
        if (crossed := ~shapely.is_valid(openings)).any():  # a void may fold over itself beyond its closed state
            openings[crossed] = shapely.make_valid(openings[crossed], method="structure", keep_collapsed=False)
        beside = shapely.area(shapely.intersection(openings, target)) < 0.5 * shapely.area(openings)
        lost = openings[beside & shapely.intersects(openings, off.buffer(10.0 * GRID))]
        area = shapely.difference(area, shapely.union_all(lost, grid_size=GRID), grid_size=GRID)
    return _without_lines(area)


def _without_lines(area: BaseGeometry) -> BaseGeometry:
    """The polygons of an area: lines may be left over where a sheet touches itself."""
    parts = shapely.get_parts(area)
    return shapely.union_all(parts[shapely.area(parts) > 0.0], grid_size=GRID)


def polygons_of(rings: Sequence[FloatArray]) -> npt.NDArray[np.object_]:
    """Shapely polygons inside of closed lines (L, 2), all made in one call; empty ones for lines without points."""
    made = np.full(len(rings), shapely.Polygon(), dtype=object)
    drawn = [place for place, ring in enumerate(rings) if len(ring)]
    if drawn:
        numbers = np.repeat(np.arange(len(drawn)), [len(rings[place]) for place in drawn])
        points = np.concatenate([rings[place] for place in drawn])
        made[drawn] = shapely.polygons(shapely.linearrings(points, indices=numbers))
    return made


@dataclass(frozen=True, slots=True, eq=False)
class Rings:
    """Polygons that each move with one panel."""

    panel: IntArray  #: (R,); number of the panel, row by row
    anchor: IntArray  #: (R,); its top node
    even: BoolArray  #: (R,); panels with I + J even turn by -a while the sheet opens, the others by +a
    ends: IntArray  #: (R,); where each ring ends in ``offsets``
    offsets: ComplexArray  #: (P,), unit cells; vertices seen from the anchor, in the compact sheet

    @classmethod
    def of(cls, deployment: Deployment, numbered: list[tuple[int, FloatArray]]) -> Rings:
        """Rings (P, 2) in the compact sheet with the number of the panel that each moves with."""
        panel = np.array([number for number, _ in numbered], dtype=np.int64)
        line, place = np.divmod(panel, deployment.field.columns + 1)
        anchor = deployment.topology.panel_nodes.reshape(-1, 4)[panel, 0]
        lengths = np.array([len(ring) for _, ring in numbered], dtype=np.int64)
        points = np.concatenate([ring for _, ring in numbered]) if numbered else np.zeros((0, 2))
        offsets = as_plane(points) - np.repeat(as_plane(deployment.compact)[anchor], lengths)
        return cls(panel, anchor, (line + place) % 2 == 0, np.cumsum(lengths), offsets)

    def at(self, nodes: FloatArray, pose: Similarity, phi: float) -> list[FloatArray]:
        """The rings (P, 2) in the world, where ``nodes`` (N, 2) are the sheet's at ``phi`` in a pose."""
        half = 0.5 * (math.pi - phi)
        turn = pose.factor * np.exp(1j * np.where(self.even, -half, half))
        lengths = np.diff(self.ends, prepend=0)
        points = self.offsets * np.repeat(turn, lengths) + np.repeat(as_plane(nodes)[self.anchor], lengths)
        return np.split(as_points(points), self.ends[:-1]) if len(lengths) else []


@dataclass(frozen=True, slots=True, eq=False)
class TrimmedParts:
    """Both sides of a trim: ``kept`` has one ring for each trimmed panel, ``removed`` one for each piece."""

    kept: Rings
    removed: Rings

    @classmethod
    def of(cls, deployment: Deployment, trim: Trim) -> TrimmedParts:
        """Divide the panels of a trimmed design."""
        corners = deployment.compact[deployment.topology.panel_nodes.reshape(-1, 4)]
        kept = [(number, part) for number, part in enumerate(trim.kept) if part is not None]
        numbers = np.array([number for number, _ in kept], dtype=np.int64)
        rest = shapely.difference(
            shapely.polygons(corners[numbers]), polygons_of([part for _, part in kept]), grid_size=GRID
        )
        pieces, panel = shapely.get_parts(rest, return_index=True)
        rings = [shapely.get_coordinates(ring)[:-1] for ring in shapely.get_exterior_ring(pieces)]
        found = zip(numbers[panel].tolist(), rings, shapely.area(pieces).tolist(), strict=True)
        removed = [(number, ring) for number, ring, area in found if area > 0.0]
        return cls(Rings.of(deployment, kept), Rings.of(deployment, removed))
