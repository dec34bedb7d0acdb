"""Where the voids and the outline's vertices of a design appear, and which of them a pixel means."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.gui.scene.posed import PosedDesign
from kirigami_studio.gui.scene.view_transform import Bounds, ViewTransform
from kirigami_studio.project.document import Void

#: Distance (pixels) from a closed slit, or from the edge of an open void, that still means the void.
VOID_REACH = 7.0
#: Distance (pixels) from a vertex of the outline that still means the vertex.
VERTEX_REACH = 8.0
#: Closer than this (radians) to the flat sheet, which is a rectangle whatever the ratios, the outline cannot be moved.
STIFF_WITHIN = 0.02
#: While a design is edited by hand, the picture keeps its place until its box has changed by this share.
STEADY = 0.08


@dataclass(frozen=True, slots=True, eq=False)
class VoidShapes:
    """One design at one angle, in pixels.

    Attributes
    ----------
    design : PosedDesign
    phi : float, radians
    transform : ViewTransform
        World -> pixels.
    corners : (m, n, 4, 2) float, pixels
        p0..p3 of every void.
    vertices : (L, 2) float, pixels
        The outline, as :meth:`PosedDesign.outline` goes round.
    """

    design: PosedDesign
    phi: float
    transform: ViewTransform
    corners: FloatArray
    vertices: FloatArray

    @classmethod
    def of(cls, design: PosedDesign, phi: float, transform: ViewTransform) -> VoidShapes:
        """Place a design."""
        nodes = design.nodes(phi)
        corners = transform.to_pixels(nodes[design.deployment.topology.void_nodes])
        return cls(design, phi, transform, corners, transform.to_pixels(design.outline(nodes, phi)))

    @property
    def movable(self) -> bool:
        """Whether a ratio can move the outline at this angle."""
        return self.phi < math.pi - STIFF_WITHIN

    def void_at(self, x: float, y: float, reach: float = VOID_REACH) -> Void | None:
        """The void that pixel (x, y) lies in; else the nearest one within ``reach`` pixels: closed ones are slits."""
        quads = self.corners.reshape(-1, 4, 2)
        distance = edge_distance(quads, np.array((x, y)))
        distance[inside(quads, np.array((x, y)))] = -1.0
        nearest = int(distance.argmin())
        if distance[nearest] > reach:
            return None
        row, column = divmod(nearest, self.corners.shape[1])
        return row, column

    def vertex_at(self, x: float, y: float, reach: float = VERTEX_REACH) -> int | None:
        """The vertex of the outline that is nearest to pixel (x, y), within ``reach`` pixels; none that cannot move."""
        if not self.movable:
            return None
        distance = np.hypot(*(self.vertices - (x, y)).T)
        nearest = int(distance.argmin())
        return nearest if distance[nearest] <= reach else None

    def voids_within(self, left: float, top: float, right: float, bottom: float) -> frozenset[Void]:
        """Voids whose middle lies in a box of pixels."""
        middle = self.corners.mean(axis=2)
        hit = np.all((middle >= (left, top)) & (middle <= (right, bottom)), axis=-1)
        return frozenset((int(row), int(column)) for row, column in np.argwhere(hit))


def inside(quads: FloatArray, place: FloatArray) -> BoolArray:
    """Which convex quadrilaterals (K, 4, 2), turning either way, a place (2,) lies strictly in: (K,)."""
    edge = np.roll(quads, -1, axis=1) - quads
    offset = place - quads
    side = edge[..., 0] * offset[..., 1] - edge[..., 1] * offset[..., 0]
    found: BoolArray = np.all(side > 0.0, axis=1) | np.all(side < 0.0, axis=1)
    return found


def edge_distance(quads: FloatArray, place: FloatArray) -> FloatArray:
    """Distance of a place (2,) from the edges of quadrilaterals (K, 4, 2): (K,)."""
    edge = np.roll(quads, -1, axis=1) - quads
    offset = place - quads
    squared = np.maximum(np.square(edge).sum(axis=-1), 1e-12)
    share = np.clip((offset * edge).sum(axis=-1) / squared, 0.0, 1.0)
    gap = offset - share[..., None] * edge
    distance: FloatArray = np.hypot(gap[..., 0], gap[..., 1]).min(axis=1)
    return distance


def steady(before: Bounds, now: Bounds) -> Bounds:
    """The box that was shown before, as long as the one that is to be shown now has hardly changed."""
    span = max(before.right - before.left, before.top - before.bottom)
    moved = np.subtract(
        (before.left, before.bottom, before.right, before.top), (now.left, now.bottom, now.right, now.top)
    )
    return before if float(np.abs(moved).max()) <= STEADY * span else now
