"""The motion within a layer: its pieces never turn against each other, each moves along an arc seen from another.

In the frame that turns with layer 1, a node of a panel with I + J even is U + R(t) V with t = pi - phi; V is one vector
for all nodes of that panel, its *drift*.  Seen from a piece with drift V', the panel is therefore shifted by
(R(t) - 1) (V - V') from its place in the flat sheet: along an exact arc of radius |V - V'|.  Layer 2 is the same with U
and the other sense of rotation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import shapely

from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.evaluate.kept_panels import all_panels
from kirigami_studio.foundation.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from kirigami_studio.lattice.deployment import Deployment, check_phi

GeometryArray = npt.NDArray[np.object_]

#: Vertices of a polygon that stands for a disc.
DISC = 64


@dataclass(frozen=True, slots=True, eq=False)
class LayerMotion:
    """Panels of both layers, row by row, in the frame of the flat sheet (mm, y up).

    Attributes
    ----------
    corners : (P, 4) complex, mm
        Flat: top, left, bottom, right.
    nodes : (P, 4) int
        Their nodes.
    hinged : (P, 4) bool
        Corners with a pin.
    layer : (P,) int
        1 for panels with I + J even, 2 for the others.
    drift : (P,) complex, mm
    sense : (P,) float
        Of the rotation that carries a layer's pieces past each other: 1 in layer 1, -1 in layer 2.
    opening : float, radians
        t at the target angle.
    """

    corners: ComplexArray
    nodes: IntArray
    hinged: BoolArray
    layer: IntArray
    drift: ComplexArray
    sense: FloatArray
    opening: float

    @classmethod
    def of(cls, deployment: Deployment, cell_mm: float, phi_target: float) -> LayerMotion:
        """The motion of a design from flat to its target angle."""
        panels = all_panels(*deployment.sheet.grid)
        even, odd = as_plane(deployment.even_part) * cell_mm, as_plane(deployment.odd_part) * cell_mm
        first = panels.corners[:, 0]
        return cls(
            corners=(even + odd)[panels.corners],
            nodes=panels.corners,
            hinged=panels.hinged,
            layer=np.where(panels.even, 1, 2),
            drift=np.where(panels.even, odd[first], even[first]),
            sense=np.where(panels.even, 1.0, -1.0),
            opening=math.pi - check_phi(phi_target),
        )

    def placed(self, shapes: GeometryArray, index: IntArray, turn: float) -> GeometryArray:
        """Carry shapes of the flat sheet with their panels to t = ``turn``, in the frame of the deployment, mm.

        Parameters
        ----------
        shapes : (S,) geometry
        index : (S,) int
            The panel of each.
        """
        back = np.exp(-0.5j * self.sense[index] * turn)
        return _moved(shapes, back, back * (np.exp(1j * self.sense[index] * turn) - 1.0) * self.drift[index])

    def brought_back(self, shapes: GeometryArray, index: IntArray, turn: float) -> GeometryArray:
        """Carry shapes at t = ``turn`` to the flat sheet with their panels: the way back of :meth:`placed`."""
        forth = np.exp(0.5j * self.sense[index] * turn)
        return _moved(shapes, forth, (1.0 - np.exp(1j * self.sense[index] * turn)) * self.drift[index])

    def close_pairs(self, reach: float) -> IntArray:
        """Pairs (K, 2) of panels of one layer that come within ``reach`` mm of each other on the way, both ways round.

        Judged by the circles around them: pairs may be too many, never too few.
        """
        middle = self.corners.mean(axis=1)
        radius = np.abs(self.corners - middle[:, None]).max(axis=1)
        found = []
        for layer in (1, 2):
            members = np.flatnonzero(self.layer == layer)
            one, other = (axis.ravel() for axis in np.meshgrid(members, members, indexing="ij"))
            one, other = one[one != other], other[one != other]
            apart = self.distance_on_arc(middle[other], middle[one], one, other)
            found.append(np.stack([one, other], axis=1)[apart <= radius[one] + radius[other] + reach])
        return np.concatenate(found)

    def distance_on_arc(self, points: ComplexArray, moving: ComplexArray, one: IntArray, other: IntArray) -> FloatArray:
        """Least distance (K,) over the motion between points of panels ``other`` and points moving with ``one``."""
        drift = self.drift[one] - self.drift[other]
        seen = points - (moving - drift)
        radius = np.abs(drift)
        # How far round the arc the point lies, measured from the arc's beginning in its own sense.
        ahead = np.mod(self.sense[one] * (np.angle(seen) - np.angle(drift)), 2.0 * math.pi)
        ends = np.minimum(np.abs(seen - drift), np.abs(seen - drift * np.exp(1j * self.sense[one] * self.opening)))
        return np.where(ahead <= self.opening, np.abs(np.abs(seen) - radius), ends)


def _moved(shapes: GeometryArray, factor: ComplexArray, shift: ComplexArray) -> GeometryArray:
    points, owner = shapely.get_coordinates(shapes, return_index=True)
    moved: GeometryArray = shapely.set_coordinates(
        shapes.copy(), as_points(as_plane(points) * factor[owner] + shift[owner])
    )
    spoilt = ~shapely.is_valid(moved)  # by rounding, where two sides touch
    moved[spoilt] = shapely.buffer(moved[spoilt], 0.0)
    return moved


def discs(centres: ComplexArray, radius: float) -> GeometryArray:
    """Polygons (K,) in circles about ``centres`` (K,), with vertices on them."""
    rim = radius * np.exp(2j * math.pi * np.arange(DISC) / DISC)
    made: GeometryArray = np.asarray(shapely.polygons(as_points(centres[:, None] + rim)), dtype=object).reshape(-1)
    return made


def swept_discs(
    centres: ComplexArray, drifts: ComplexArray, turns: FloatArray, radius: float, tolerance: float
) -> GeometryArray:
    """Areas that discs sweep along arcs: they contain the exact ones and exceed them by ``tolerance`` at most.

    Parameters
    ----------
    centres : (K,) complex, mm
        Where the discs begin.
    drifts : (K,) complex, mm
        A disc is at its centre plus (exp(i s) - 1) times its drift, s from 0 to its turn.
    turns : (K,) float, radians
        Within pi of 0.
    radius : float, mm
    tolerance : float, mm

    Returns
    -------
    areas : (K, 3) Polygon
        Of each the part of the ring, and the discs at both ends; they overlap.
    """
    made = np.empty(len(centres), dtype=object)
    reach = np.abs(drifts) + radius
    largest = np.abs(turns).max(initial=0.0)
    # The vertices of the outer arc lie outside of it, by reach (1 / cos(half a step) - 1), or reach step^2 / 8.
    steps = 2 ** np.ceil(np.log2(np.maximum(largest * np.sqrt(reach / (8.0 * tolerance)), 2.0))).astype(np.int64)
    size = max(DISC, 4 * math.ceil(0.25 * math.pi / math.sqrt(2.0 * tolerance / radius)))
    cap = radius / math.cos(math.pi / size) * np.exp(2j * math.pi * np.arange(size) / size)
    ends = centres + (np.exp(1j * turns) - 1.0) * drifts
    caps = [shapely.polygons(as_points(place[:, None] + cap)) for place in (centres, ends)]
    for count in np.unique(steps):
        here = np.flatnonzero(steps == count)
        angle = turns[here, None] * np.linspace(0.0, 1.0, count + 1) + np.angle(drifts[here])[:, None]
        middle = (centres - drifts)[here, None]
        outside = reach[here, None] / np.cos(0.5 * turns[here, None] / count)
        inside = np.maximum(np.abs(drifts[here]) - radius, 0.0)[:, None]
        ring = [middle + outside * np.exp(1j * angle), middle + inside * np.exp(1j * angle[:, ::-1])]
        made[here] = shapely.polygons(as_points(np.concatenate(ring, axis=1)))
    areas: GeometryArray = np.stack([made, *(np.asarray(one, dtype=object).reshape(-1) for one in caps)], axis=1)
    return areas


def swept_hulls(
    corners: ComplexArray, drift: complex, turn: float, tolerance: float, window: tuple[float, float, float, float]
) -> GeometryArray:
    """Convex areas that a convex polygon sweeps along an arc, as far as they come near a window.

    Grown by ``tolerance`` they contain the exact one.

    Parameters
    ----------
    corners : (C,) complex, mm
    drift : complex, mm
    turn : float, radians
        As for :func:`swept_discs`.
    tolerance : float, mm
        Sagitta of the chords that stand for the arc.
    window : (left, bottom, right, top), mm
    """
    steps = max(2, math.ceil(abs(turn) * math.sqrt(abs(drift) / (8.0 * tolerance))))
    shifts = (np.exp(1j * turn * np.arange(steps + 1) / steps) - 1.0) * drift
    points = corners + shifts[:, None]
    both = np.concatenate([points[:-1], points[1:]], axis=1)
    near = (
        (both.real.max(axis=1) >= window[0])
        & (both.imag.max(axis=1) >= window[1])
        & (both.real.min(axis=1) <= window[2])
        & (both.imag.min(axis=1) <= window[3])
    )
    hulls: GeometryArray = shapely.convex_hull(shapely.multipoints(as_points(both[near])))
    return hulls
