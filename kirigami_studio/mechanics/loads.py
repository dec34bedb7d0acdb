"""Energy and force of a closing: elastic, yielding, and bent out of the plane.

A closing is found with connectors that are elastic in the plane, which is the upper figure.  Two others follow from its
turns, connector by connector, each a strip that bends evenly over its length l with outer fibre strain turn t / (2 l):

    in the plane      across the width w, E h w^3 / (12 l), and no further than its outer fibre yields elastic
    out of the plane  across the thickness h, E w h^3 / (12 l), likewise; nothing is stretched and nothing touches

Beyond the turn y at which the outer fibre yields, an elastic, ideally plastic strip of rectangular section has the
moment 3/2 M (1 - (y / turn)^2 / 3), with M its moment at y (any textbook of plasticity): the plastic neck.  The last
figure is a lower bound; which one is to be believed depends on the sheet's thickness over the connectors' width.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.mechanics.closing import Closing
from kirigami_studio.mechanics.drive import rated

#: A slope needs as many steps; a closing that got stuck before them has none.
LEAST_STEPS = 3


@dataclass(frozen=True, slots=True, eq=False)
class Load:
    """Energy and force of a closing, step by step."""

    energy_mj: FloatArray  #: (S,), mJ
    #: (S,), N mm, or None; moment against the mean angle, where that is driven; None where grips are.
    torque_nmm: FloatArray | None
    #: (S,), N; of a lever as long as a panel where the mean angle is driven; along the way of the grips otherwise.
    force_n: FloatArray

    def to_json(self) -> dict[str, object]:
        """By names with their units; no torque where grips are driven."""
        torque = {} if self.torque_nmm is None else {"torque_nmm": self.torque_nmm}
        return {"energy_mj": self.energy_mj, **torque, "force_n": self.force_n}


@dataclass(frozen=True, slots=True, eq=False)
class Loads:
    """One closing by three figures."""

    in_plane: Load  #: elastic, bent in the plane and stretched: the upper figure, as simulated
    in_plane_yielding: Load  #: the same with plastic necks where the material yields
    out_of_plane: Load  #: bent across the thickness, with plastic necks: the lower figure


def loads(found: Closing, yield_strain: float = 0.0) -> Loads:
    """Energy and force of a closing by all three figures; yield strain 0: it never yields."""
    connectors, sheet = found.sheet.connectors, found.sheet.sheet
    turn = np.abs(found.sheet.opening(found.path.motion))
    stiff = found.sheet.network.ligaments.turning
    thin = np.minimum(connectors.width_mm, sheet.thickness_mm)
    thick = np.maximum(connectors.width_mm, sheet.thickness_mm)
    bent = sheet.young_mpa * thick * thin**3 / (12.0 * connectors.flexure_mm)
    length = 2.0 * connectors.flexure_mm * (yield_strain if yield_strain > 0.0 else np.inf)
    elastic = np.sum(0.5 * stiff * turn**2, axis=1)
    yielding = np.sum(strip_work(stiff, turn, length / connectors.width_mm), axis=1)
    escaped = np.sum(strip_work(bent, turn, length / thin), axis=1)
    return Loads(
        _load(found, found.path.energy, found.path.force),
        _load(found, found.path.energy - elastic + yielding),
        _load(found, escaped),
    )


def strip_work(stiffness: FloatArray, turn: FloatArray, yields: FloatArray) -> FloatArray:
    """Work (S, H), mJ, of bending strips.

    Parameters
    ----------
    stiffness : (H,) float, N mm
        Of the elastic strips.
    turn : (S, H) float, radians
    yields : (H,) float, radians
        Turn at which the outer fibre yields; infinite for strips that never do.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = turn / yields
        # The integral of the moment over the turn, in units of M y.
        plastic = 0.5 + 1.5 * (ratio - 1.0) + 0.5 * (1.0 / ratio - 1.0)
        work: FloatArray = np.where(ratio > 1.0, stiffness * yields**2 * plastic, 0.5 * stiffness * turn**2)
    return work


def _load(found: Closing, energy: FloatArray, slope: FloatArray | None = None) -> Load:
    """Load of an energy (S,); its slope by the displacement is that of its steps unless given."""
    at = found.path.drive.displacement
    if slope is None:
        slope = rated(energy[:, None], at)[:, 0] if len(at) >= LEAST_STEPS else np.zeros(len(at))
    if found.path.drive.weights.size:
        return Load(energy, slope, slope / found.sheet.network.panel_size)
    return Load(energy, None, slope)
