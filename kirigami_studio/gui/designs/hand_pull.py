"""A void in the hand: how far the mouse went is how far one corner of the void slides along its slit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.project.document import Void

#: Ratios that a hand gives, the same as those of the generator and the fits.
SMALLEST, LARGEST = 0.1, 10.0
#: Share of a slit by which the motion of a void's corners is measured.
PROBE = 0.02
#: Corners that move less than this share of the one that moves most are not taken hold of.
LIVELY = 0.6
#: Least motion (lengths of the world per whole slit) that is believed, in cells of the sheet.
LEAST = 0.25


@dataclass(frozen=True, slots=True, eq=False)
class Pull:
    """A void that is held.

    The corner that moves slides along its slit with the share s = x / (1 + x), so a motion of the mouse along the
    slit is a change of s.

    Attributes
    ----------
    void : Void
    place : (x, y) float, world
        Where it was taken hold of.
    share : float
        s at that time.
    motion : (2,) float, world
        How far the held corner moves when s goes from 0 to 1, to first order.
    corner : int
        Which corner, 0..3, is held.
    """

    void: Void
    place: tuple[float, float]
    share: float
    motion: FloatArray
    corner: int

    @classmethod
    def of(cls, design: PosedDesign, void: Void, place: tuple[float, float], phi: float) -> Pull:
        """Take hold of a void: of the nearest of the corners that move."""
        field = design.deployment.field
        share = share_of(float(field.ratio[void]))
        low, high = max(share - PROBE, share_of(SMALLEST) / 2), min(share + PROBE, (1 + share_of(LARGEST)) / 2)
        motion = (_corners(design, void, high, phi) - _corners(design, void, low, phi)) / (high - low)
        here = _corners(design, void, share, phi)
        length = np.hypot(*motion.T)
        distance = np.hypot(*(here - place).T)
        distance[length < LIVELY * length.max()] = np.inf
        corner = int(distance.argmin())
        least = LEAST * design.pose.scale
        return cls(void, place, share, motion[corner] * max(1.0, least / max(float(length[corner]), 1e-12)), corner)

    def ratio_at(self, place: tuple[float, float]) -> float:
        """The ratio when the hand is at a place in the world; within the bounds."""
        moved = np.subtract(place, self.place)
        share = self.share + float(moved @ self.motion) / max(float(self.motion @ self.motion), 1e-18)
        share = min(max(share, share_of(SMALLEST)), share_of(LARGEST))
        return share / (1.0 - share)


def share_of(ratio: float) -> float:
    """s = x / (1 + x): how far along its slit a void's corner lies."""
    return ratio / (1.0 + ratio)


def _corners(design: PosedDesign, void: Void, share: float, phi: float) -> FloatArray:
    """Corners (4, 2) of a void in the world, if its ratio were that of ``share``."""
    table = design.deployment.field.ratio.copy()
    table[void] = share / (1.0 - share)
    changed = PosedDesign(deploy(RatioField(table)), design.pose, design.phi_target)
    corners: FloatArray = changed.nodes(phi)[changed.deployment.topology.void_nodes[void]]
    return corners
