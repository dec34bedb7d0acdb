"""The motion within a layer: seen from one piece, each other moves along an arc, unturned.

In the frame that turns with layer 1, a node of a panel with I + J even is U + R(t) V with t = pi - phi; V is one vector
for all nodes of that panel, its *drift*.  Seen from a piece with drift V', the panel is therefore shifted by
(R(t) - 1) (V - V') from its place in the flat sheet: along an exact arc of radius |V - V'|.  Layer 2 is the same with U
and the other sense of rotation.

Panels of the other layer share U, their drift, instead of V: seen from that piece, they turn about U + V' by t.  So
where both layers lie in one plane, every point moves along an exact arc, too.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import numpy.typing as npt
import shapely
from scipy.linalg import qr

from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.evaluate.kept_panels import PanelTable, all_panels
from kirigami_studio.foundation.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from kirigami_studio.lattice.deployment import Deployment, check_phi

GeometryArray = npt.NDArray[np.object_]

#: Polygons in discs miss them by this at most, mm.
ROUNDNESS_MM = 0.01
#: A pin is needed if its conditions are implied by others to less than this share.
NEEDED = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class LayerMotion:
    """Panels of both layers, row by row, in the frame of the flat sheet (mm, y up).

    Attributes
    ----------
    panel : (P,) int
        Their numbers in the sheet, of which some panels may be cut away.
    corners : (P, 4) complex, mm
        Flat: top, left, bottom, right.
    nodes : (P, 4) int
        Their nodes.
    hinged : (P, 4) bool
        Corners with a pin.
    layer : (P,) int
        1 for panels with I + J even, 2 for the others.
    plane : (P,) int
        Pieces of one plane pass each other, those of different planes may lie on each other: 1 and 2 as the layers, or
        1 for all.
    drift : (P,) complex, mm
    sense : (P,) float
        Of the rotation that carries a layer's pieces past each other: 1 in layer 1, -1 in layer 2.
    opening : float, radians
        t at the target angle.
    cell_mm : float
        Width of a unit cell.
    """

    panel: IntArray
    corners: ComplexArray
    nodes: IntArray
    hinged: BoolArray
    layer: IntArray
    plane: IntArray
    drift: ComplexArray
    sense: FloatArray
    opening: float
    cell_mm: float

    @classmethod
    def of(
        cls,
        deployment: Deployment,
        cell_mm: float,
        phi_target: float,
        in_one_plane: bool = False,
        panels: PanelTable | None = None,
    ) -> LayerMotion:
        """The motion of a design, or of some of its panels, from flat to its target angle."""
        panels = panels or all_panels(*deployment.sheet.grid)
        even, odd = as_plane(deployment.even_part) * cell_mm, as_plane(deployment.odd_part) * cell_mm
        first = panels.corners[:, 0]
        layer = np.where(panels.even, 1, 2)
        return cls(
            panel=panels.index,
            corners=(even + odd)[panels.corners],
            nodes=panels.corners,
            hinged=panels.hinged,
            layer=layer,
            plane=np.ones_like(layer) if in_one_plane else layer,
            drift=np.where(panels.even, odd[first], even[first]),
            sense=np.where(panels.even, 1.0, -1.0),
            opening=math.pi - check_phi(phi_target),
            cell_mm=cell_mm,
        )

    def without(self, nodes: Sequence[int]) -> LayerMotion:
        """The motion with as many of these nodes' pins left out as it keeps being the only one.

        They are left out one by one, in their order: a pin without which pieces would move in other ways stays.  Where
        all stay it is this motion itself.
        """
        if not nodes:
            return self
        pins, held = _held(self)
        if freedom(self) != 1:
            return self
        # Conditions can go if others imply them: if their part of this projection, onto what holds the sheet no more
        # than others do, is not singular.
        spare = np.eye(len(held)) - held @ held.T
        left_out = []
        hinged = set(pins.tolist())
        for node in (one for one in nodes if one in hinged):
            at = 2 * int(np.searchsorted(pins, node)) + np.arange(2)
            own = spare[np.ix_(at, at)]
            if float(np.linalg.eigvalsh(own)[0]) > NEEDED:
                spare -= spare[:, at] @ np.linalg.solve(own, spare[at])
                left_out.append(node)
        return replace(self, hinged=self.hinged & ~np.isin(self.nodes, left_out)) if left_out else self

    def placed(self, shapes: GeometryArray, index: IntArray, turn: float) -> GeometryArray:
        """Carry shapes of the flat sheet with their panels to t = ``turn``; deployment's frame, mm.

        Parameters
        ----------
        shapes : (S,) geometry
        index : (S,) int
            The panel of each.
        """
        back = np.exp(-0.5j * self.sense[index] * turn)
        return _moved(shapes, back, back * (np.exp(1j * self.sense[index] * turn) - 1.0) * self.drift[index])

    def brought_back(self, shapes: GeometryArray, index: IntArray, turn: float) -> GeometryArray:
        """Carry shapes at t = ``turn`` back to the flat sheet: the inverse of :meth:`placed`."""
        forth = np.exp(0.5j * self.sense[index] * turn)
        return _moved(shapes, forth, (1.0 - np.exp(1j * self.sense[index] * turn)) * self.drift[index])

    def close_pairs(self, reach: float) -> IntArray:
        """Pairs (K, 2) of panels of one plane that come within ``reach`` mm of each other.

        Both ways round, over the whole motion, judged by the circles around them: never too few.
        """
        middle = self.corners.mean(axis=1)
        radius = np.abs(self.corners - middle[:, None]).max(axis=1)
        found = []
        for plane in np.unique(self.plane):
            members = np.flatnonzero(self.plane == plane)
            one, other = (axis.ravel() for axis in np.meshgrid(members, members, indexing="ij"))
            one, other = one[one != other], other[one != other]
            apart = self.distance_on_arc(middle[other], middle[one], one, other)
            found.append(np.stack([one, other], axis=1)[apart <= radius[one] + radius[other] + reach])
        return np.concatenate(found)

    def seen_drift(self, one: IntArray, other: IntArray, moving: ComplexArray) -> ComplexArray:
        """Drifts (K, ...), mm, of points (K, ...) of panels ``one``, seen from ``other``.

        A point is at its place in the flat sheet plus (R(t) - 1) times its drift, in the sense of ``other``.
        """
        shape = (-1, *[1] * (moving.ndim - 1))
        mine, theirs = self.drift[one].reshape(shape), self.drift[other].reshape(shape)
        alike = (self.layer[one] == self.layer[other]).reshape(shape)
        return np.asarray(np.where(alike, mine, moving - mine) - theirs)

    def distance_on_arc(self, points: ComplexArray, moving: ComplexArray, one: IntArray, other: IntArray) -> FloatArray:
        """Least distance (K,) between points of panels ``other`` and points moving with ``one``."""
        drift = self.seen_drift(one, other, moving)
        seen = points - (moving - drift)
        radius = np.abs(drift)
        # How far round the arc the point lies, measured from the arc's beginning in its own sense.
        ahead = np.mod(self.sense[other] * (np.angle(seen) - np.angle(drift)), 2.0 * math.pi)
        ends = np.minimum(np.abs(seen - drift), np.abs(seen - drift * np.exp(1j * self.sense[other] * self.opening)))
        return np.asarray(np.where(ahead <= self.opening, np.abs(np.abs(seen) - radius), ends))


def freedom(motion: LayerMotion) -> int:
    """Count the small motions of a half open sheet on its pins, beside those of the whole."""
    return 3 * len(motion.layer) - 3 - int(_held(motion)[1].shape[1])


@lru_cache(maxsize=2)  # of one motion, several sets of pins are tried
def _held(motion: LayerMotion) -> tuple[IntArray, FloatArray]:
    """Nodes (N,) with pins, and an orthonormal basis of what their conditions hold.

    The basis has 2 N rows and 3 P - 3 columns less the freedom.
    """
    pins, conditions = _conditions(motion)
    basis, sizes, _ = qr(conditions, mode="economic", pivoting=True)
    sizes = np.abs(np.diag(sizes))
    least = sizes.max(initial=0.0) * max(conditions.shape) * np.finfo(np.float64).eps
    return pins, np.asarray(basis[:, : np.count_nonzero(sizes > least)], dtype=np.float64)


def _conditions(motion: LayerMotion) -> tuple[IntArray, FloatArray]:
    """Nodes (N,) with pins, ascending, and their conditions (2 N, 3 P) on shifts and turns."""
    turn = 0.5 * motion.opening
    drift, spin = motion.drift[:, None], np.exp(1j * motion.sense * turn)[:, None]
    points = np.exp(-0.5j * motion.sense * turn)[:, None] * (motion.corners + (spin - 1.0) * drift)
    piece, corner = np.nonzero(motion.hinged)
    order = np.argsort(motion.nodes[piece, corner], kind="stable")
    piece, corner = piece[order], corner[order]
    place = points[piece, corner]
    # The two pieces of a pin follow each other: shifts and turns of both are the same at the pin.
    row, count = np.arange(len(piece) // 2), len(motion.layer)
    conditions = np.zeros((len(piece), 3 * count))
    for one, at, sign in ((piece[::2], place[::2], 1.0), (piece[1::2], place[1::2], -1.0)):
        conditions[2 * row, 3 * one] = conditions[2 * row + 1, 3 * one + 1] = sign
        conditions[2 * row, 3 * one + 2] = -sign * at.imag
        conditions[2 * row + 1, 3 * one + 2] = sign * at.real
    return motion.nodes[piece[::2], corner[::2]], conditions


def _moved(shapes: GeometryArray, factor: ComplexArray, shift: ComplexArray) -> GeometryArray:
    points, owner = shapely.get_coordinates(shapes, return_index=True)
    moved: GeometryArray = shapely.set_coordinates(
        shapes.copy(), as_points(as_plane(points) * factor[owner] + shift[owner])
    )
    spoilt = ~shapely.is_valid(moved)  # by rounding, where two sides touch
    moved[spoilt] = shapely.buffer(moved[spoilt], 0.0)
    return moved


def polygons(corners: ComplexArray) -> GeometryArray:
    """Polygons (K,) with the given corners (K, C)."""
    return np.asarray(shapely.polygons(as_points(corners)), dtype=object).reshape(-1)


def discs(centres: ComplexArray, radius: FloatArray | float, beyond: float = 0.0) -> GeometryArray:
    """Polygons (K,) for circles about ``centres`` (K,).

    Corners are as far outside of them as ``beyond``, mm, and sides inside by ``ROUNDNESS_MM`` at most.
    """
    radii = np.broadcast_to(radius, centres.shape) + beyond
    return polygons(centres[:, None] + radii[:, None] * _corners(float(radii.max(initial=0.0)), ROUNDNESS_MM + beyond))


def _corners(radius: float, tolerance: float) -> ComplexArray:
    """Corners (N,) on the unit circle, as many as a radius and a tolerance ask for."""
    count = 4 * max(4, math.ceil(0.25 * math.pi * math.sqrt(radius / (2.0 * tolerance))))
    return np.asarray(np.exp(2j * math.pi * np.arange(count) / count))


def swept_discs(
    centres: ComplexArray,
    drifts: ComplexArray,
    turns: FloatArray,
    radius: FloatArray,
    tolerance: float,
    within: float = 0.0,
) -> GeometryArray:
    """Areas that contain those swept by discs along arcs, and exceed them by ``tolerance``.

    They may lack as much as ``within`` all round.

    Parameters
    ----------
    centres : (K,) complex, mm
        Where the discs begin.
    drifts : (K,) complex, mm
        A disc is at its centre plus (exp(i s) - 1) times its drift, s from 0 to its turn.
    turns : (K,) float, radians
        Within pi of 0.
    radius : (K,) float, mm
    tolerance, within : float, mm

    Returns
    -------
    areas : (K, 3) Polygon
        Of each the part of the ring, and the discs at both ends; they overlap.
    """
    made = np.empty(len(centres), dtype=object)
    radius, tolerance = radius - within, tolerance + within
    reach = np.abs(drifts) + radius
    largest = np.abs(turns).max(initial=0.0)
    # The vertices of the outer arc lie outside of it, by reach (1 / cos(half a step) - 1), or reach step^2 / 8.
    steps = 4 * np.ceil(0.25 * np.maximum(largest * np.sqrt(reach / (8.0 * tolerance)), 2.0)).astype(np.int64)
    corners = _corners(float(radius.max(initial=0.0)), tolerance)
    cap = radius[:, None] / math.cos(math.pi / len(corners)) * corners
    ends = centres + (np.exp(1j * turns) - 1.0) * drifts
    caps = [polygons(place[:, None] + cap) for place in (centres, ends)]
    for count in np.unique(steps):
        here = np.flatnonzero(steps == count)
        angle = turns[here, None] * np.linspace(0.0, 1.0, count + 1) + np.angle(drifts[here])[:, None]
        middle = (centres - drifts)[here, None]
        outside = reach[here, None] / np.cos(0.5 * turns[here, None] / count)
        inside = np.maximum(np.abs(drifts[here]) - radius[here], 0.0)[:, None]
        ring = [middle + outside * np.exp(1j * angle), middle + inside * np.exp(1j * angle[:, ::-1])]
        made[here] = polygons(np.concatenate(ring, axis=1))
    return np.stack([made, *caps], axis=1)


def swept_hulls(
    corners: ComplexArray, drifts: ComplexArray, turn: float, tolerance: float, windows: FloatArray
) -> GeometryArray:
    """Convex areas that convex polygons sweep along arcs near some windows.

    Grown by ``tolerance`` they contain the exact ones.

    Parameters
    ----------
    corners : (C, K) complex, mm
    drifts : (C, K) or (C, 1) complex, mm
        Of every corner.
    turn : float, radians
        As for :func:`swept_discs`.
    tolerance : float, mm
        Sagitta of the chords that stand for the arcs.
    windows : (W, 4) float, mm
        Left, bottom, right and top of each.
    """
    if np.all(drifts == drifts[:, :1]):  # unturned: all corners of a polygon move alike
        drifts = drifts[:, :1]
    needed = np.maximum(np.ceil(abs(turn) * np.sqrt(np.abs(drifts).max(axis=1) / (8.0 * tolerance))), 2.0)
    steps = 2 ** np.ceil(np.log2(needed)).astype(np.int64)
    both = [
        _steps_near(corners[steps == count], drifts[steps == count], turn, int(count), windows)
        for count in np.unique(steps)
    ]
    # Hulls of lines, which are quicker to make than multipoints.
    if not both:
        return np.empty(0, dtype=object)
    lines = shapely.linestrings(as_points(np.concatenate(both)))
    return np.asarray(shapely.convex_hull(lines), dtype=object).reshape(-1)


def _steps_near(
    corners: ComplexArray, drifts: ComplexArray, turn: float, steps: int, windows: FloatArray
) -> ComplexArray:
    """Corners (N, 2 K) of polygons before and after steps that come near windows."""
    shifts = (np.exp(1j * turn * np.arange(steps + 1) / steps) - 1.0)[:, None] * drifts[:, None, :]
    near = np.ones((len(windows), len(corners), steps), dtype=bool)
    for axis, (corner, shift) in enumerate(((corners.real, shifts.real), (corners.imag, shifts.imag))):
        least, most = shift.min(axis=2), shift.max(axis=2)
        high = corner.max(axis=1)[:, None] + np.maximum(most[:, :-1], most[:, 1:])
        low = corner.min(axis=1)[:, None] + np.minimum(least[:, :-1], least[:, 1:])
        near &= (high >= windows[:, axis, None, None]) & (low <= windows[:, axis + 2, None, None])
    polygon, step = np.nonzero(near.any(axis=0))
    return np.concatenate([corners[polygon] + shifts[polygon, step + end] for end in (0, 1)], axis=1)
