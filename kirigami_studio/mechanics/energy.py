"""Elastic energy of a network with its exact gradient and sparse Hessian, for all ligaments at once.

For a ligament from x_A to x_B let ``e = R(-(theta_A + theta_B)/2 - axis) (x_B - x_A)``: what the user sees who turns
with the mean of both panels, its first component along the ligament's axis.  Then

    slender      E = 1/2 k_a (|e| - l)^2 + 1/2 k_s l^2 psi^2 + 1/2 k_t (theta_B - theta_A)^2,    psi = angle of e
    T-junction   E = 1/2 k_n e_1^2       + 1/2 k_s e_2^2     + 1/2 k_t (theta_B - theta_A)^2

(Deng, Raney, Bertoldi and Tournat 2017; Bordiga et al., Nature Materials 2024, whose program DifFlexMM has the slender
form, which is singular where both points coincide).  A void angle a below a_c adds

    E = (k_c / 4) a_c^2 (1 / (x + 1) - 1 / (x - 1) - 2),    x = (a - a_c) / a_c,

which grows without bound as the void closes.  A point that is stopped by an edge adds

    E = -k g^3 / (6 s) for -s < g < 0,    E = k (g^2 / 2 + s g / 2 + s^2 / 6) for g < -s,
    g = n . (R(-theta_A) (x_B - x_A) - r_A)

with the edge's normal n and place r_A on panel A, and the point's place x_B: g is its distance from the edge, negative
behind it, where the stiffness grows to k within the depth s.  (Were it there at once, Newton's method would not get
over the kink.)  Points of the plane are complex numbers here: a turn is a product, and
all derivatives of e are short.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from scipy.sparse import csc_array

from kirigami_studio.foundation.arrays import ComplexArray, FloatArray, IntArray
from kirigami_studio.mechanics.network import CONTACT_BELOW, PanelNetwork

#: Degrees of freedom of a ligament: u_x, u_y, theta of A, then of B.
SIX = 6


class NetworkEnergy:
    """Energy of one network as a function of the motion of its panels.

    Parameters
    ----------
    network : PanelNetwork

    Motions are (P, 3) float: u_x and u_y in mm, theta in radians; zeros are the network at rest.  Energies are in
    N mm = mJ.

    Attributes
    ----------
    network : PanelNetwork
    freedoms : (L, 6) int
        Degrees of freedom of A and B at every ligament: 3 p + k is u_x, u_y or theta of panel p.
    rest : (L,) complex, mm
        e at rest.
    """

    def __init__(self, network: PanelNetwork) -> None:
        joints = network.ligaments
        self.network = network
        self._first, self._second = joints.panels.T
        centres = _plane(network.centroids)
        points = _plane(joints.points)
        self._gap = centres[self._second] - centres[self._first]
        self._arms = points - centres[joints.panels]
        span = points[:, 1] - points[:, 0]
        self._slender = np.flatnonzero(joints.slender)
        self._axis = np.where(joints.slender, np.angle(span), joints.axis)
        self.rest: ComplexArray = span * np.exp(-1j * self._axis)
        self.freedoms = _freedoms(joints.panels)
        self._stopped = _freedoms(network.stops.panels)

    @cached_property
    def _pattern(self) -> tuple[csc_array, IntArray]:
        """A matrix with the Hessian's entries, and to which of them every entry of the blocks adds."""
        size, freedoms = 3 * self.network.panel_count, np.concatenate([self.freedoms, self._stopped])
        row = np.repeat(freedoms, SIX, axis=1).ravel()
        column = np.tile(freedoms, (1, SIX)).ravel()
        filled = csc_array((np.ones(row.size), (row, column)), shape=(size, size))
        filled.sort_indices()
        keys = np.repeat(np.arange(size), np.diff(filled.indptr)) * size + filled.indices
        return filled, np.searchsorted(keys, column * size + row)

    def value(self, motion: FloatArray) -> float:
        """Energy, mJ; infinite where a void has closed."""
        local, _ = self.local(motion)
        stretch, shear = self._strains(local)
        joints = self.network.ligaments
        turn = self.network.turns(motion)
        elastic = 0.5 * float(
            np.sum(joints.stretching * stretch**2 + joints.shearing * shear**2 + joints.turning * turn**2)
        )
        stopped = float(np.sum(self._stopping(self._distances(motion)[0])[0]))
        return elastic + stopped + float(np.sum(self._contact(motion)[0]))

    def gradient(self, motion: FloatArray) -> FloatArray:
        """Derivative (3 P,) of the energy by the motion: N for u_x and u_y, N mm for theta."""
        local, by_freedom = self.local(motion)
        return self._assembled(self._force(local), by_freedom, motion)

    def slopes(self, motion: FloatArray) -> tuple[FloatArray, csc_array]:
        """Gradient (3 P,) and Hessian (3 P, 3 P) together."""
        local, by_freedom = self.local(motion)
        force, curvature = self._force(local), self._curvature(local)
        blocks = np.einsum("lia,lij,ljb->lab", by_freedom, curvature, by_freedom)
        blocks += self._bending(force, local, motion)
        joints, contacts = self.network.ligaments, self.network.contacts
        turning: FloatArray = joints.turning.copy()
        np.add.at(turning, contacts.ligament, self._contact(motion)[2])
        for one, other, sign in ((2, 2, 1.0), (5, 5, 1.0), (2, 5, -1.0), (5, 2, -1.0)):
            blocks[:, one, other] += sign * turning
        pattern, place = self._pattern
        entries = np.concatenate([blocks.ravel(), self._stiffening(motion).ravel()])
        values = np.bincount(place, weights=entries, minlength=pattern.nnz)
        hessian = csc_array((values, pattern.indices, pattern.indptr), shape=pattern.shape)
        return self._assembled(force, by_freedom, motion), hessian

    def stretch(self, motion: FloatArray) -> FloatArray:
        """How far the two ends of every ligament moved apart, seen from between its panels: (..., L) mm, 0 at rest."""
        if motion.ndim > 2:
            return np.stack([self.stretch(entry) for entry in motion])
        moved: FloatArray = np.abs(self.local(motion)[0] - self.rest)
        return moved

    def tension(self, motion: FloatArray) -> FloatArray:
        """Force (..., L) that stretches every ligament along its axis, N; negative where it is compressed."""
        if motion.ndim > 2:
            return np.stack([self.tension(entry) for entry in motion])
        pull: FloatArray = self.network.ligaments.stretching * self._strains(self.local(motion)[0])[0]
        return pull

    def local(self, motion: FloatArray) -> tuple[ComplexArray, FloatArray]:
        """e (L,), mm, and its derivatives (L, 2, 6) by the degrees of freedom of A and B; rows of ``freedoms``."""
        u = motion[:, 0] + 1j * motion[:, 1]
        theta_a, theta_b = motion[self._first, 2], motion[self._second, 2]
        frame = np.exp(-1j * (0.5 * (theta_a + theta_b) + self._axis))
        arm_a, arm_b = self._turned_arms(motion, frame)
        local = frame * (self._gap + u[self._second] - u[self._first]) + arm_b - arm_a
        slopes = np.stack(
            [-frame, -1j * frame, -1j * arm_a - 0.5j * local, frame, 1j * frame, 1j * arm_b - 0.5j * local], axis=-1
        )
        return local, np.stack([slopes.real, slopes.imag], axis=1)

    def _turned_arms(self, motion: FloatArray, frame: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Arms of A and B (L,) in the ligaments' frames."""
        turn = np.exp(1j * motion[:, 2])
        return frame * turn[self._first] * self._arms[:, 0], frame * turn[self._second] * self._arms[:, 1]

    def _strains(self, local: ComplexArray) -> tuple[FloatArray, FloatArray]:
        """What the two springs are stretched by (L,), mm."""
        off = local - self.rest
        stretch, shear = off.real.copy(), off.imag.copy()
        thin = self._slender
        length = self.rest[thin].real
        stretch[thin] = np.abs(local[thin]) - length
        shear[thin] = length * np.angle(local[thin])
        return stretch, shear

    def _force(self, local: ComplexArray) -> FloatArray:
        """Derivative (L, 2) of the springs' energy by e."""
        joints = self.network.ligaments
        stretch, shear = self._strains(local)
        pull, push = joints.stretching * stretch, joints.shearing * shear
        force = pull + 1j * push
        thin = self._slender
        along = local[thin] / np.abs(local[thin])
        force[thin] = along * (pull[thin] + 1j * push[thin] * self.rest[thin].real / np.abs(local[thin]))
        return np.stack([force.real, force.imag], axis=-1)

    def _curvature(self, local: ComplexArray) -> FloatArray:
        """Second derivative (L, 2, 2) of the springs' energy by e."""
        joints = self.network.ligaments
        found = np.zeros((len(joints), 2, 2))
        found[:, 0, 0], found[:, 1, 1] = joints.stretching, joints.shearing
        thin = self._slender
        radius, length = np.abs(local[thin]), self.rest[thin].real
        along = np.stack([local[thin].real, local[thin].imag], axis=-1) / radius[:, None]
        across = np.stack([-along[:, 1], along[:, 0]], axis=-1)
        pull = joints.stretching[thin] * (radius - length)
        bend = joints.shearing[thin] * length**2
        psi = np.angle(local[thin])
        mixed = along[:, :, None] * across[:, None]
        found[thin] = (
            joints.stretching[thin, None, None] * along[:, :, None] * along[:, None]
            + (pull / radius + bend / radius**2)[:, None, None] * across[:, :, None] * across[:, None]
            - (bend * psi / radius**2)[:, None, None] * (mixed + np.swapaxes(mixed, 1, 2))
        )
        return found

    def _bending(self, force: FloatArray, local: ComplexArray, motion: FloatArray) -> FloatArray:
        """What the curvature of e itself adds to the Hessian's blocks: (L, 6, 6)."""
        theta_a, theta_b = motion[self._first, 2], motion[self._second, 2]
        frame = np.exp(-1j * (0.5 * (theta_a + theta_b) + self._axis))
        arm_a, arm_b = self._turned_arms(motion, frame)
        pull = force[:, 0] - 1j * force[:, 1]
        found = np.zeros((len(local), SIX, SIX))
        for moved, sign in ((0, -1.0), (3, 1.0)):
            for axis, unit in ((0, 1.0), (1, 1j)):
                bent = (pull * (-0.5j * sign * unit) * frame).real
                for turned in (2, 5):
                    found[:, moved + axis, turned] = found[:, turned, moved + axis] = bent
        found[:, 2, 2] = found[:, 5, 5] = (pull * (-0.25 * local)).real
        found[:, 2, 5] = found[:, 5, 2] = (pull * (0.5 * (arm_b - arm_a) - 0.25 * local)).real
        return found

    def _contact(self, motion: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Energy of every contact (C,), its slope and its curvature by theta_B - theta_A."""
        contacts = self.network.contacts
        x = (self.network.void_angles(motion) - CONTACT_BELOW) / CONTACT_BELOW
        energy, slope, curvature = np.zeros((3, len(contacts)))
        near = np.flatnonzero(x < 0.0)
        if near.size:
            y, scale = x[near], 0.25 * contacts.stiffness[near]
            closed = y <= -1.0
            y[closed] = -0.5
            energy[near] = np.where(
                closed, np.inf, scale * CONTACT_BELOW**2 * (1.0 / (y + 1.0) - 1.0 / (y - 1.0) - 2.0)
            )
            slope[near] = contacts.sign[near] * scale * CONTACT_BELOW * ((y - 1.0) ** -2 - (y + 1.0) ** -2)
            curvature[near] = scale * 2.0 * ((y + 1.0) ** -3 - (y - 1.0) ** -3)
        return energy, slope, curvature

    def _distances(self, motion: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """g of every stop (T,), mm, its slopes (T, 6) and its second derivatives (T, 6, 6) by the freedoms of A and B.

        Infinite for panels that are not near each other.
        """
        stops = self.network.stops
        edge, point = stops.panels.T
        centres, u = _plane(self.network.centroids), motion[:, 0] + 1j * motion[:, 1]
        turn = np.exp(1j * motion[:, 2])
        normal = np.conj(_plane(stops.normal))
        back = np.conj(turn[edge]) * normal
        arm = back * turn[point] * (_plane(stops.point) - centres[point])
        seen = back * (centres[point] + u[point] - centres[edge] - u[edge]) + arm
        gap = (seen - normal * (_plane(stops.foot) - centres[edge])).real
        slopes = np.stack([-back, -1j * back, -1j * seen, back, 1j * back, 1j * arm], axis=-1).real
        bends = np.zeros((len(stops), SIX, SIX))
        for moved, sign in ((0, -1.0), (3, 1.0)):
            bends[:, moved, 2] = bends[:, 2, moved] = (-1j * sign * back).real
            bends[:, moved + 1, 2] = bends[:, 2, moved + 1] = (sign * back).real
        bends[:, 2, 2], bends[:, 5, 5] = -seen.real, -arm.real
        bends[:, 2, 5] = bends[:, 5, 2] = arm.real
        turned = self.network.turns(motion)[stops.ligament] * np.sign(stops.turned)
        return np.where(turned > np.abs(stops.turned), gap, np.inf), slopes, bends

    def _stopping(self, gap: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Energy of every stop (T,), its slope and its curvature by g."""
        stiffness, soft = self.network.stops.stiffness, self.network.stops.soft
        depth = np.maximum(-gap, 0.0)
        rising = depth < soft
        energy = np.where(rising, depth**3 / (6.0 * soft), 0.5 * depth**2 - 0.5 * soft * depth + soft**2 / 6.0)
        slope = -np.where(rising, 0.5 * depth**2 / soft, depth - 0.5 * soft)
        return stiffness * energy, stiffness * slope, stiffness * np.minimum(depth / soft, 1.0)

    def _stiffening(self, motion: FloatArray) -> FloatArray:
        """Blocks (T, 6, 6) that stops add to the Hessian."""
        gap, slopes, bends = self._distances(motion)
        _, push, stiffness = self._stopping(gap)
        square = slopes[:, :, None] * slopes[:, None]
        blocks: FloatArray = stiffness[:, None, None] * square + push[:, None, None] * bends
        return blocks

    def _assembled(self, force: FloatArray, by_freedom: FloatArray, motion: FloatArray) -> FloatArray:
        joints, contacts = self.network.ligaments, self.network.contacts
        parts = np.einsum("li,lia->la", force, by_freedom)
        moment: FloatArray = joints.turning * self.network.turns(motion)
        np.add.at(moment, contacts.ligament, self._contact(motion)[1])
        parts[:, 2] -= moment
        parts[:, 5] += moment
        size = 3 * self.network.panel_count
        total = np.bincount(self.freedoms.ravel(), weights=parts.ravel(), minlength=size)
        gap, slopes, _ = self._distances(motion)
        pushed = self._stopping(gap)[1][:, None] * slopes
        total += np.bincount(self._stopped.ravel(), weights=pushed.ravel(), minlength=size)
        return np.asarray(total, dtype=np.float64)


def _freedoms(panels: IntArray) -> IntArray:
    """Degrees of freedom (K, 6) of pairs of panels (K, 2)."""
    found: IntArray = (3 * panels[:, :, None] + np.arange(3)).reshape(len(panels), SIX)
    return found


def _plane(points: FloatArray) -> ComplexArray:
    plane: ComplexArray = points[..., 0] + 1j * points[..., 1]
    return plane
