"""Move one vertex of the outline to a place by the least change of the ratios; the rim stays as it is.

Damped Gauss-Newton steps on z = log10 x, on the exact outline o(z) with its exact derivative, for

    |o_v - place|^2  +  HOLD * mean |o_k - o_k(start)|^2  +  CHANGE * mean (z - start)^2,

where k runs over the other vertices: they hold on softly, so that the outline gives way around the vertex and stays as
it is elsewhere.  Every state that is kept is physical if the start was.

There are many more voids than coordinates of the outline, so the step is solved for in the outline: with R the weighted
derivative, r the weighted gaps, c the weight of the change and d = z - start, it is
R^T (R R^T + c I)^-1 (R d - r) - d.  R R^T is factored once for each derivative, and outlines on trial come from the
sparse solve of :func:`deploy`.  At 24 x 24 and 48 x 48 voids a step takes 4 and 20 ms of processor time, 48 and 860 ms
where it needs a new derivative; with the m * n normal equations and a dense solve it took 23 and 590, 65 and 1390.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from kirigami_studio.evaluate.feasibility import invalid_quads, path_contact
from kirigami_studio.evaluate.pins import RoomBound
from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.polish.levenberg import check_fit, check_locked
from kirigami_studio.polish.sensitivity import OutlineModel

#: Weight of the other vertices and of the change of z, relative to the vertex that is moved.
HOLD, CHANGE = 2e-2, 1e-3
#: No step changes any z by more than this: the derivative holds only nearby.
LONGEST_STEP = 0.25
#: Halvings of a step that does not lower the cost or would not be physical.
HALVINGS = 6
#: Distance (unit cells) from its place at which the vertex counts as arrived.
ARRIVED = 3e-3
#: A derivative is used again as long as a step leaves no more than this share of the distance.
KEPT_GAP = 0.5
#: Decimals of z that are kept, as in the fit: files repeat such ratios exactly.
DECIMALS = 9


class VertexDrag:
    """One vertex that is dragged, from the press of the button to its release.

    Parameters
    ----------
    design : Sheet or RatioField
        Where the drag begins; ratios alone stand for the paper's sheet.
    phi : float, radians, in [0, pi)
        Angle at which the outline is seen.
    vertex : int
        Number in ``Deployment.outline(phi)``.
    locked : (m, n) bool, optional
        Voids whose ratio stays exactly as it is.
    least_gap : float, unit cells
        Distance that pins keep, or that of the start where they are nearer there; 0 for sheets without pins.

    Raises
    ------
    UsageError
        There is no such vertex, or ``locked`` is not a table of the sheet's grid.
    AngleError
        ``phi`` is not in [0, pi): the flat sheet has its outline whatever the ratios.
    """

    def __init__(
        self,
        design: Sheet | RatioField,
        phi: float,
        vertex: int,
        locked: BoolArray | None = None,
        least_gap: float = 0.0,
    ) -> None:
        phi, sheet = check_fit(phi, 0, 1.0), Sheet.of(design)
        self._model = OutlineModel.of(sheet, phi)
        self._given = sheet
        self._start: FloatArray = sheet.field.log10.ravel()
        self._deployment = deploy(sheet)
        self._outline = self._deployment.outline(phi)
        if not 0 <= vertex < len(self._outline):
            raise UsageError("drag.no_such_vertex", last=len(self._outline) - 1, vertex=vertex)
        self._vertex = vertex
        self._free = np.flatnonzero(~check_locked(locked, sheet.field).ravel())
        self._low, self._high = np.minimum(self._start, -LOG_RATIO_LIMIT), np.maximum(self._start, LOG_RATIO_LIMIT)
        self._weight = np.full(len(self._outline), HOLD / len(self._outline))
        self._weight[vertex] = 1.0
        self._change = CHANGE / self._start.size
        self._z, self._here = self._start, self._outline
        self._slopes: FloatArray | None = None
        self._dual: _Dual | None = None
        self._room = RoomBound.of(self._deployment, least_gap) if least_gap > 0.0 else None
        self._guarded = self._is_physical(self._deployment)

    @property
    def deployment(self) -> Deployment:
        """The design as it is now."""
        return self._deployment

    @property
    def place(self) -> FloatArray:
        """Where the vertex is now: (2,), unit cells."""
        where: FloatArray = self._here[self._vertex]
        return where

    def gap(self, place: FloatArray) -> float:
        """Distance (unit cells) that the vertex is from ``place``; at most :data:`ARRIVED` once it has arrived."""
        return float(np.hypot(*(self.place - place)))

    def cost(self, z: FloatArray, outline: FloatArray, place: FloatArray) -> float:
        """What is minimised, at z (m * n,) with its outline (L, 2) for a wanted place (2,), unit cells."""
        change = z - self._start
        gaps = np.square(self._gaps(outline, place)).sum(axis=1)
        return float(self._weight @ gaps) + self._change * float(change @ change)

    def gradient(self, z: FloatArray, outline: FloatArray, place: FloatArray, slopes: FloatArray) -> FloatArray:
        """Derivative (m * n,) of the cost, from the outline (L, 2) at z and its derivative (L, 2, m * n)."""
        weighted = self._weight[:, None] * self._gaps(outline, place)
        gradient: FloatArray = 2.0 * (np.tensordot(weighted, slopes, axes=2) + self._change * (z - self._start))
        return gradient

    def move(self, place: FloatArray, steps: int = 3) -> Sheet:
        """Bring the vertex to ``place`` (2,), unit cells, or as far as ratio limits, locked voids and collisions allow.

        Parameters
        ----------
        place : (2,) float, unit cells
            In the frame of ``Deployment.outline(phi)``.
        steps : int
            At most so many steps are taken; a later call goes on from here.
        """
        fresh = False
        for _ in range(steps):
            if self._slopes is None:
                self._slopes, self._dual, fresh = self._model.linearised(self._z)[1], None, True
            before = self.gap(place)
            moved = self._advance(place, self._slopes)
            after = self.gap(place)
            if moved and after <= ARRIVED:
                break
            if not moved or after > KEPT_GAP * before:  # the derivative is used up, or the vertex comes no nearer
                if fresh and not moved:
                    break
                self._slopes, fresh = None, False
        return self._deployment.sheet

    def _advance(self, place: FloatArray, slopes: FloatArray) -> bool:
        """Take one step, if a physical one is found that lowers the cost; whether it was."""
        before, step = self.cost(self._z, self._here, place), self._step(place, slopes)
        for _ in range(HALVINGS):
            z = self._moved(step)
            deployment = deploy(self._sheet_of(z))
            outline = deployment.outline(self._model.phi)
            if self.cost(z, outline, place) < before:
                physical = self._is_physical(deployment)
                if physical or not self._guarded:
                    self._z, self._here, self._guarded = z, outline, physical
                    self._deployment = deployment
                    return True
            step = 0.5 * step
        return False

    def _moved(self, step: FloatArray) -> FloatArray:
        """The state after a step (m * n,): within the bounds, rounded where it has changed."""
        z: FloatArray = np.clip(self._z + step, self._low, self._high)
        moved: FloatArray = np.where(step == 0.0, self._z, np.round(z, DECIMALS))
        return moved

    def _step(self, place: FloatArray, slopes: FloatArray) -> FloatArray:
        """The Gauss-Newton step (m * n,): locked voids stay, and those at a bound that would be pushed beyond it."""
        gradient = self.gradient(self._z, self._here, place, slopes)
        inward = ~((self._z >= self._high) & (gradient < 0.0)) & ~((self._z <= self._low) & (gradient > 0.0))
        free = self._free[inward[self._free]]
        step = np.zeros_like(self._z)
        if not free.size:
            return step
        root = np.sqrt(self._weight)[:, None]
        if self._dual is None or not np.array_equal(self._dual.free, free):
            self._dual = _Dual.of(root, slopes, free, self._change)
        gaps = (root * self._gaps(self._here, place)).ravel()
        step[free] = self._dual.step(gaps, (self._z - self._start)[free])
        longest = float(np.abs(step).max())
        return step * min(1.0, LONGEST_STEP / longest) if longest else step

    def _gaps(self, outline: FloatArray, place: FloatArray) -> FloatArray:
        """How far every vertex of an outline (L, 2) is from where it should be: (L, 2)."""
        gaps = outline - self._outline
        gaps[self._vertex] = outline[self._vertex] - place
        return gaps

    def _sheet_of(self, z: FloatArray) -> Sheet:
        """The sheet of a state; ratios that were not touched keep every digit."""
        given = self._given.field.ratio
        table, start = z.reshape(given.shape), self._start.reshape(given.shape)
        return self._given.with_field(RatioField(np.where(table == start, given, np.power(10.0, table))))

    def _is_physical(self, deployment: Deployment) -> bool:
        """Whether no quad is invalid at the angle, the way there is free, and pins keep apart."""
        if self._room is not None and not self._room.keeps(deployment):
            return False
        return not invalid_quads(deployment, self._model.phi) and path_contact(deployment, self._model.phi) is None


@dataclass(frozen=True, slots=True, eq=False)
class _Dual:
    """The step's equations in the outline's coordinates, for one derivative and one set of voids."""

    free: IntArray  #: (F,); voids that may change
    rows: FloatArray  #: (2 L, F); weighted derivative of the outline
    factor: tuple[FloatArray, bool]  #: (2 L, 2 L), bool; Cholesky factor of rows @ rows.T + change * I

    @classmethod
    def of(cls, root: FloatArray, slopes: FloatArray, free: IntArray, change: float) -> _Dual:
        """Weigh a derivative (L, 2, m * n) with ``root`` (L, 1), and factor."""
        rows = (root[..., None] * slopes[..., free]).reshape(-1, free.size)
        matrix = rows @ rows.T
        matrix[np.diag_indices_from(matrix)] += change
        return cls(free, rows, scipy.linalg.cho_factor(matrix, lower=True, overwrite_a=True, check_finite=False))

    def step(self, gaps: FloatArray, changed: FloatArray) -> FloatArray:
        """The step (F,) from the weighted gaps (2 L,) and how far the free voids' z are from the start (F,)."""
        solved = scipy.linalg.cho_solve(self.factor, self.rows @ changed - gaps, check_finite=False)
        step: FloatArray = self.rows.T @ solved - changed
        return step
