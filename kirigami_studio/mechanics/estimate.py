"""A fast estimate of what closing a sheet stretches: the over-constrained linkage by linear least squares.

The ideal path is pushed into the sheet: every panel is put where it would be with its connectors on the nodes, and the
gaps that then open at the real rotation centres are closed as well as they can be, weighted by stiffness, with the mean
turn kept.  That is one Gauss-Newton step at every angle, begun with the correction found at the angle before.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve_banded, cholesky_banded

from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.mechanics.closing import CLOSED, TOLERATED_STRETCH, ideal_motion, jam_angle
from kirigami_studio.mechanics.energy import SIX, NetworkEnergy
from kirigami_studio.mechanics.sheet_network import SheetNetwork

#: Angles (degrees) at which stretch is estimated.
ANGLES_DEG = (150.0, 115.0, 80.0, 45.0, 15.0)


@dataclass(frozen=True, slots=True, eq=False)
class StretchEstimate:
    """Estimated stretch of every connector at some angles."""

    phi: FloatArray  #: (A,), radians; falling
    motion: FloatArray  #: (A, P, 3), mm and radians
    stretch: FloatArray  #: (A, H); in connector widths
    room: FloatArray  #: (A,), radians; the smallest void angle that is left before panels touch
    flat_room: float  #: radians; that of the flat sheet

    def jam_phi(self, tolerated: float = TOLERATED_STRETCH) -> float:
        """Angle at which a connector is stretched too far or panels touch; 0 if neither."""
        phi = np.concatenate([[math.pi], self.phi])
        worst = np.concatenate([[0.0], self.stretch.max(axis=1)])
        if self.phi[-1] > CLOSED:
            # Stretch grows like cos(phi / 2) as the sheet closes, and hardly any more at the end.
            phi, worst = np.append(phi, CLOSED), np.append(worst, worst[-1])
        return max(jam_angle(phi, worst, tolerated, True), self._touching_phi())

    def _touching_phi(self) -> float:
        """Angle at which the first void closes, 0 if none does before the sheet has closed."""
        phi, room = np.append(math.pi, self.phi), np.append(self.flat_room, self.room)
        shut = np.flatnonzero(room < 0.0)
        if shut.size:
            # Far beyond its contact an angle says nothing: panels that overlap are where no sheet comes to.
            return jam_angle(phi[: shut[0] + 1], -room[: shut[0] + 1], 0.0, True) if shut[0] else math.pi
        # Voids close as fast as the mean angle falls.
        touching = float(phi[-1] - room[-1])
        return touching if touching > CLOSED else 0.0


def estimate_stretch(deployment: Deployment, sheet: SheetNetwork, width_mm: float) -> StretchEstimate:
    """Estimate the stretch of all connectors.

    Parameters
    ----------
    sheet : SheetNetwork
        Made of its panels, row by row, at that width.
    """
    network, energy = sheet.network, NetworkEnergy(sheet.network)
    tables = deployment.topology
    layout = _Bands.of(energy, tables.rows + 1, tables.columns + 1, network.numbers)
    springs = np.stack([network.ligaments.stretching, network.ligaments.shearing], axis=1)
    phis, motions, stretch, room = np.radians(ANGLES_DEG), [], [], []
    correction = np.zeros((network.panel_count, 3))
    for phi in phis.tolist():
        ideal = ideal_motion(deployment, network, width_mm, phi)
        correction = correction + layout.step(energy, ideal + correction, springs, sheet.connectors.sign, phi)
        motion = ideal + correction
        motions.append(motion)
        stretch.append(energy.stretch(motion) / sheet.connectors.width_mm)
        room.append(float(network.void_angles(motion)[: len(sheet.connectors)].min()))
    flat_room = float(network.contacts.rest[: len(sheet.connectors)].min())
    return StretchEstimate(phis, np.array(motions), np.array(stretch), np.array(room), flat_room)


@dataclass(frozen=True, slots=True, eq=False)
class _Bands:
    """Where the blocks of the ligaments go in a banded matrix: panels line by line along the shorter side."""

    order: np.ndarray  #: (3 P,); place of every degree of freedom
    #: (L, 36); entries of the flattened lower bands; those above the diagonal go to a last place that is dropped.
    place: np.ndarray
    depth: int
    size: int

    @classmethod
    def of(cls, energy: NetworkEnergy, rows: int, columns: int, numbers: IntArray | None = None) -> _Bands:
        number = np.arange(rows * columns).reshape(rows, columns)
        rank = np.argsort((number if rows >= columns else number.T).ravel(), kind="stable")
        if numbers is not None:
            rank = np.argsort(np.argsort(rank[numbers]))
        order = (3 * rank[:, None] + np.arange(3)).ravel()
        freedoms = order[energy.freedoms]
        row, column = np.repeat(freedoms, SIX, axis=1), np.tile(freedoms, (1, SIX))
        size, below = order.size, row - column
        depth = int(below.max()) + 1
        return cls(order, np.where(below >= 0, below * size + column, depth * size), depth, size)

    def step(
        self, energy: NetworkEnergy, motion: FloatArray, springs: FloatArray, sign: FloatArray, phi: float
    ) -> FloatArray:
        """One Gauss-Newton step (P, 3) of the springs' energy with the mean turn kept at pi - phi."""
        joints = energy.network.ligaments
        local, slopes = energy.local(motion)
        off = local - energy.rest
        misfit = springs * np.stack([off.real, off.imag], axis=1)
        weighted = springs[:, :, None] * slopes
        blocks = np.matmul(np.swapaxes(slopes, 1, 2), weighted)
        turn = np.array([0.0, 0.0, -1.0, 0.0, 0.0, 1.0])
        blocks += joints.turning[:, None, None] * np.outer(turn, turn)
        # Gradient: springs and turning; border: the mean turn.
        moment = joints.turning * energy.network.turns(motion)
        pull = np.einsum("li,lia->la", misfit, slopes) + moment[:, None] * turn
        mean = (sign / len(sign))[:, None] * turn
        freedoms = self.order[energy.freedoms].ravel()
        right = np.stack([np.bincount(freedoms, part.ravel(), self.size) for part in (-pull, mean)], axis=1)
        bands = np.bincount(self.place.ravel(), blocks.ravel(), self.depth * self.size + 1)[:-1]
        bands = bands.reshape(self.depth, self.size)
        # The whole may go anywhere: holding the first panel fixes that and costs nothing.
        bands[0, :3] += bands[0].mean()
        factor = cholesky_banded(bands, overwrite_ab=True, lower=True, check_finite=False)
        free, leaning = cho_solve_banded((factor, True), right, check_finite=False).T
        missing = math.pi - phi - float(np.mean(sign * energy.network.turns(motion)))
        step = free + (missing - float(right[:, 1] @ free)) / float(right[:, 1] @ leaning) * leaning
        found: FloatArray = step[self.order].reshape(-1, 3)
        return found
