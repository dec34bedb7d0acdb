"""Stable equilibria along a drive, by Newton's method with an exact, sparse factorisation.

At every step the prescribed degrees of freedom get their values and the energy of the rest is brought to a minimum:
Newton steps, shortened until the energy falls.  The signs of the factors' pivots tell how many directions of the free
degrees there are in which the energy has a maximum (Sylvester's law of inertia).  Where there is one the Hessian is
shifted, so that the step still leads downhill: what is found is a minimum, never a saddle.  Where a stable path ends,
the least eigenvalue of the free Hessian has reached zero and the network snaps to another one.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.errors import MechanicsError
from kirigami_studio.foundation.steps import result_of
from kirigami_studio.mechanics.drive import Drive
from kirigami_studio.mechanics.energy import NetworkEnergy
from kirigami_studio.mechanics.network import PanelNetwork

#: Newton's method ends when a step promises less than this share of the energy.
PRECISION = 1e-11
#: Energy (in mean turning stiffnesses) below which an energy counts as nothing.
STILL = 1e-6
MOST_ITERATIONS = 80
#: A step is divided at most so often before a shift of the Hessian counts as a snap.
MOST_HALVINGS = 5
#: First shift as a share of the Hessian's mean diagonal, the factor to the next, and the largest.
FIRST_SHIFT, NEXT_SHIFT, LARGEST_SHIFT = 1e-6, 8.0, 1e6
#: A line search accepts this share of the promised fall of the energy (Armijo), and halves at most so often.
FALL, MOST_SHORTENINGS = 1e-4, 40
#: SuperLU's symmetric mode: pivots stay on the diagonal, so that their signs tell the inertia.
SYMMETRIC = {"SymmetricMode": True}
#: Up to so many degrees of freedom eigenvalues are found directly.
FEW = 12
#: A force below this share of the largest one is none.
NO_FORCE = 1e-6
#: Stable states nearer to each other than this share of the path are one.
SAME_STATE = 1e-3
#: Precision of the least eigenvalue, relative.
EIGENVALUE_PRECISION = 1e-4


@dataclass(frozen=True, slots=True, eq=False)
class EquilibriumPath:
    """Equilibria of a network, step by step."""

    drive: Drive
    motion: FloatArray  #: (S, P, 3), mm and radians
    energy: FloatArray  #: (S,), mJ
    reaction: FloatArray  #: (S, D), N and N mm; gradient of the energy at the prescribed degrees of freedom
    force: FloatArray  #: (S,); derivative of the energy by the drive's displacement: N, or N mm where that is an angle.
    #: (S,), N/mm; least eigenvalue of the free Hessian, turns counted in panel sizes: 0 where the network is about to
    #: snap.
    least: FloatArray
    #: (S,); whether the stable path ended on the way to this step, so that the network jumped to another one.
    snapped: BoolArray

    @property
    def stable(self) -> FloatArray:
        """Displacements at which the network rests if it is let go: where the energy along the path has a minimum.

        The beginning counts where there is no force; states that the path snapped past do not.
        """
        force, at = self.force, self.drive.displacement
        rest = at[:1] if abs(force[0]) <= NO_FORCE * float(np.max(np.abs(force), initial=0.0)) else at[:0]
        before, after = force[:-1], force[1:]
        onward = np.sign(np.diff(at))
        rises = np.flatnonzero((onward * before < 0.0) & (onward * after > 0.0) & ~self.snapped[1:])
        rises = rises[(rises > 0) | (rest.size == 0)]
        share = before[rises] / (before[rises] - after[rises])
        found = np.sort(np.concatenate([rest, at[rises] + share * (at[rises + 1] - at[rises])]))
        # A path that comes back passes the same state twice.
        apart = np.diff(found, prepend=-np.inf) > SAME_STATE * float(np.ptp(at))
        return np.asarray(found[apart], dtype=np.float64)


def follow(network: PanelNetwork, drive: Drive) -> EquilibriumPath:
    """Find the equilibria along a drive, all in one go; see :func:`follow_steps`."""
    return result_of(follow_steps(network, drive))


def follow_steps(
    network: PanelNetwork, drive: Drive, start: FloatArray | None = None, until_stuck: bool = False
) -> Generator[None, None, EquilibriumPath]:
    """Find the equilibria along a drive; yields after each, and returns the path.

    Parameters
    ----------
    start : (P, 3) float, optional
        Motion to begin with; at rest unless given.
    until_stuck : bool
        Whether to return the steps up to the last equilibrium that there is, instead of refusing.

    Raises
    ------
    MechanicsError
        No equilibrium was found at some step, for instance because panels that are driven run into each other.
    """
    system = _DrivenSystem(network, drive)
    motion = np.zeros((network.panel_count, 3)) if start is None else np.array(start, dtype=np.float64)
    if motion.shape != (network.panel_count, 3):
        raise MechanicsError("network.wrong_shape", name="start", found=motion.shape, wanted=(network.panel_count, 3))
    motions, energies, reactions, pulls, least, snapped = [], [], [], [], [], []
    for step in range(drive.steps):
        try:
            # A step that goes too far overflows; it is then shortened.
            with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                motion, jumped = system.advance(motion, step)
        except MechanicsError:
            if not until_stuck or step == 0:
                raise
            break
        motions.append(motion)
        found = system.report(motion)
        energies.append(found.energy)
        reactions.append(found.reaction)
        pulls.append(found.pull)
        least.append(found.least)
        snapped.append(jumped)
        yield
    reaction, drive = np.array(reactions), drive.first(len(motions))
    return EquilibriumPath(
        drive,
        np.array(motions),
        np.array(energies),
        reaction,
        drive.force(reaction, np.array(pulls)),
        np.array(least),
        np.array(snapped),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Equilibrium:
    """What is known about one equilibrium."""

    energy: float
    reaction: FloatArray
    pull: float
    least: float


class _Factors:
    """A factored Hessian of the free degrees of freedom (F, F), and the prescribed mean that borders it.

    With H the Hessian and a the border, the bordered matrix has as many negative eigenvalues as H, and one more where
    its Schur complement ``-a H^-1 a`` is negative.  On the motions that leave the mean as it is H is positive definite
    if and only if there is exactly one.
    """

    def __init__(self, hessian: csc_array, border: FloatArray) -> None:
        self._lu = splu(hessian, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=SYMMETRIC)
        self._border = border
        negative = int(np.sum(self._lu.U.diagonal() < 0.0))
        if border.size:
            self._leaning: FloatArray = self._lu.solve(border)
            self._complement = float(border @ self._leaning)
            negative += int(self._complement > 0.0) - 1
        on_diagonal = bool(np.array_equal(self._lu.perm_r, self._lu.perm_c))
        self.definite = negative == 0 and on_diagonal

    def solve(self, right: FloatArray, rise: float = 0.0) -> FloatArray:
        """The step (F,) with ``H step = right`` as far as the mean allows, which it raises by ``rise``."""
        step: FloatArray = self._lu.solve(right)
        if self._border.size:
            step += (rise - float(self._border @ step)) / self._complement * self._leaning
        return step


class _DrivenSystem:
    """The free degrees of freedom of a driven network, and what is prescribed for them."""

    def __init__(self, network: PanelNetwork, drive: Drive) -> None:
        size = 3 * network.panel_count
        if drive.freedoms.size and not 0 <= drive.freedoms.min() <= drive.freedoms.max() < size:
            raise MechanicsError("drive.unknown_panel", panel=int(drive.freedoms.max()) // 3, last=size // 3 - 1)
        if drive.weights.size not in (0, size):
            raise MechanicsError("network.wrong_shape", name="weights", found=drive.weights.shape, wanted=(size,))
        self.drive = drive
        self.energy = NetworkEnergy(network)
        self.free = np.setdiff1d(np.arange(size), drive.freedoms)
        self.row: FloatArray = drive.weights[self.free] if drive.weights.size else np.zeros(0)
        self.constraints = 1 if self.row.size else 0
        per_turn = np.tile([1.0, 1.0, network.panel_size], network.panel_count)
        self.scale: FloatArray = per_turn[self.free]
        self.little = STILL * float(np.mean(network.ligaments.turning))
        # The pattern is the same at all steps; numbers stand for the entries, 1 for the first: 0 would be no entry.
        hessian = self.energy.slopes(np.zeros((network.panel_count, 3)))[1]
        numbers = np.arange(1.0, hessian.nnz + 1.0)
        numbered = csc_array((numbers, hessian.indices, hessian.indptr), shape=hessian.shape)
        self.pattern = csc_array(numbered[self.free][:, self.free])
        self.source = self.pattern.data.astype(np.intp) - 1
        own = np.repeat(np.arange(self.free.size), np.diff(self.pattern.indptr))
        self.diagonal = np.flatnonzero(self.pattern.indices == own)

    def advance(self, motion: FloatArray, step: int) -> tuple[FloatArray, bool]:
        """From an equilibrium to the one at a step, in as many parts as it takes; and whether it snapped."""
        done, size, snapped = 0.0, 1.0, False
        begin = motion.ravel()[self.drive.freedoms]
        level = float(self.drive.weights @ motion.ravel()) if self.constraints else 0.0
        while done < 1.0:
            share = min(1.0, done + size)
            patient = size > 0.5**MOST_HALVINGS
            wanted = begin + share * (self.drive.path[step] - begin)
            wanted_level = level + share * (self.drive.level[step] - level) if self.constraints else 0.0
            found = self._relaxed(motion, wanted, wanted_level, patient)
            if found is None:
                if not patient:
                    raise MechanicsError(
                        "equilibrium.not_found", step=step, displacement=float(self.drive.displacement[step])
                    )
                size *= 0.5
                continue
            motion, jumped = found
            snapped |= jumped
            done, size = share, min(1.0, 2.0 * size)
        return motion, snapped

    def report(self, motion: FloatArray) -> _Equilibrium:
        """Energy, reactions and the least eigenvalue at an equilibrium."""
        gradient, hessian = self.energy.slopes(motion)
        reaction = gradient[self.drive.freedoms]
        pull = 0.0
        if self.constraints:
            # At an equilibrium the gradient is a multiple of the prescribed combination.
            pull = float(self.row @ gradient[self.free]) / float(self.row @ self.row)
            reaction = reaction - pull * self.drive.weights[self.drive.freedoms]
        return _Equilibrium(self.energy.value(motion), reaction, pull, self._least(self._factored(hessian, 0.0)))

    def _relaxed(
        self, motion: FloatArray, wanted: FloatArray, level: float, patient: bool
    ) -> tuple[FloatArray, bool] | None:
        """The minimum of the energy with prescribed values; None where a shorter way there has to be tried."""
        begun = self._predicted(motion, wanted, level)
        if begun is None:
            return None
        motion, shifted = begun, False
        value = self.energy.value(motion)
        for _ in range(MOST_ITERATIONS):
            gradient, hessian = self.energy.slopes(motion)
            step, needed_shift = self._downhill(gradient[self.free], hessian)
            if needed_shift and patient:
                return None
            shifted |= needed_shift
            promised = -float(gradient[self.free] @ step)
            if promised <= PRECISION * (abs(value) + self.little) and not needed_shift:
                return self._moved(motion, step), shifted
            found = self._shortened(motion, step, value, promised)
            if found is None:
                return (motion, shifted) if promised <= 1e4 * PRECISION * (abs(value) + self.little) else None
            motion, value = found
        return None

    def _predicted(self, motion: FloatArray, wanted: FloatArray, level: float) -> FloatArray | None:
        """The motion with prescribed values, the free ones following along the tangent; None where a void closes."""
        flat = motion.ravel()
        change = wanted - flat[self.drive.freedoms]
        rise = level - float(self.drive.weights @ flat) if self.constraints else 0.0
        if not np.any(change) and rise == 0.0:
            return motion
        _, hessian = self.energy.slopes(motion)
        given = np.zeros(flat.size)
        given[self.drive.freedoms] = change
        coupled = (hessian @ given)[self.free]
        if self.constraints:
            rise -= float(self.drive.weights[self.drive.freedoms] @ change)
        moved = flat.copy()
        moved[self.drive.freedoms] = wanted
        moved[self.free] += self._factored(hessian, 0.0).solve(-coupled, rise)
        found = moved.reshape(motion.shape)
        return found if np.isfinite(self.energy.value(found)) else None

    def _downhill(self, gradient: FloatArray, hessian: csc_array) -> tuple[FloatArray, bool]:
        """A Newton step (F,), and whether the Hessian had to be shifted for it."""
        shift = 0.0
        mean = self._mean_diagonal(hessian)
        while True:
            factors = self._factored(hessian, shift)
            if factors.definite:
                step = factors.solve(-gradient)
                if np.all(np.isfinite(step)):
                    return step, shift > 0.0
            shift = NEXT_SHIFT * shift if shift else FIRST_SHIFT * mean
            if shift > LARGEST_SHIFT * mean:
                raise MechanicsError("equilibrium.singular")

    def _mean_diagonal(self, hessian: csc_array) -> float:
        return float(np.mean(np.abs(hessian.diagonal()[self.free]) / self.scale**2))

    def _factored(self, hessian: csc_array, shift: float) -> _Factors:
        """Factors of the free Hessian with a shift (N/mm) of its diagonal."""
        values = hessian.data[self.source]
        values[self.diagonal] += shift * self.scale**2
        try:
            return _Factors(
                csc_array((values, self.pattern.indices, self.pattern.indptr), shape=self.pattern.shape), self.row
            )
        except RuntimeError:
            # A pivot was exactly zero: a direction without stiffness.
            if shift > 0.0:
                raise MechanicsError("equilibrium.singular") from None
            return self._factored(hessian, FIRST_SHIFT * self._mean_diagonal(hessian))

    def _least(self, factors: _Factors) -> float:
        """The free Hessian's eigenvalue that is nearest to zero, N/mm: the least one where it is positive definite."""
        size = self.free.size

        def inverse(vector: FloatArray) -> FloatArray:
            solved: FloatArray = self.scale * factors.solve(self.scale * vector.ravel())
            return solved

        if size <= FEW:
            values = np.linalg.eigvalsh(np.stack([inverse(column) for column in np.eye(size)]))
            return 1.0 / float(values[np.argmax(np.abs(values))])
        operator = LinearOperator((size, size), matvec=inverse, dtype=np.float64)
        start = np.linspace(1.0, 2.0, size)
        value = eigsh(operator, k=1, which="LM", v0=start, tol=EIGENVALUE_PRECISION, return_eigenvectors=False)
        return 1.0 / float(value[0])

    def _shortened(
        self, motion: FloatArray, step: FloatArray, value: float, promised: float
    ) -> tuple[FloatArray, float] | None:
        """The first of ever shorter steps that lowers the energy as it should; None without one."""
        share = 1.0
        for _ in range(MOST_SHORTENINGS):
            tried = self._moved(motion, share * step)
            energy = self.energy.value(tried)
            if energy <= value - FALL * share * promised:
                return tried, energy
            share *= 0.5
        return None

    def _moved(self, motion: FloatArray, step: FloatArray) -> FloatArray:
        moved = motion.ravel().copy()
        moved[self.free] += step
        return moved.reshape(motion.shape)
