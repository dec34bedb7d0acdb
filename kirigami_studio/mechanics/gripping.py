"""Which panels to hold and lead by pins, so that a sheet follows its ideal path.

An over-constrained sheet has one easy motion, but long waves of it are nearly as easy: led by two corners, a large
sheet opens as far as its widest state and turns back.  Panels that take part most in the softest motions are the ones
to pin.
"""

from __future__ import annotations

import math
from collections.abc import Generator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import eigsh

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import MechanicsError
from kirigami_studio.foundation.steps import result_of
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.mechanics.closing import CLOSED, STEPS, Closing, closing_steps, ideal_motion
from kirigami_studio.mechanics.drive import Drive, prescribed_places
from kirigami_studio.mechanics.energy import NetworkEnergy
from kirigami_studio.mechanics.sheet_network import SheetNetwork

#: So many times as finely is the way of grips followed, so that its length and direction are exact.
FINER = 8
#: Angles (degrees) of the ideal path whose softest motions are looked at, and how many beyond the number of pins.
LOOKED_AT_DEG, MORE_MOTIONS = (137.0, 86.0, 40.0), 4
#: Numbers of pins that are tried, the fewest first.
PINS = (2, 4, 8, 12, 20)
#: A sheet follows its path if its mean angle keeps within this (radians) of that of the pins.  It lags by some degrees
#: where it is widest, because pins pull hardly on turns there; one that does not follow turns back and ends far away.
FOLLOWS = math.radians(15.0)


@dataclass(frozen=True, slots=True, eq=False)
class Gripping:
    """Panels to hold and to lead, and what comes of it."""

    #: held, moved: panels, row by row.
    held: tuple[int, ...]
    moved: tuple[int, ...]
    closing: Closing
    follows: bool  #: whether the sheet keeps to the ideal path as far as it was led


def find_grips(
    deployment: Deployment, sheet: SheetNetwork, width_mm: float, end: float = CLOSED, steps: int = STEPS
) -> Gripping:
    """The fewest pins by which a sheet can be led, all in one go; see :func:`grip_steps`."""
    return result_of(grip_steps(deployment, sheet, width_mm, end, steps))


def grip_steps(
    deployment: Deployment, sheet: SheetNetwork, width_mm: float, end: float = CLOSED, steps: int = STEPS
) -> Generator[None, None, Gripping]:
    """Find the fewest pins by which a sheet can be led along its ideal path; two if none suffice.

    Yields after every step of every trial.  A sheet that no pins lead springs back where it is widest, by however many
    it is held: two open it as far as that, and then its panels are turned on by hand.

    Parameters
    ----------
    end : float, radians
    """
    angles = np.linspace(math.pi, end, steps)
    order = SoftMotions.for_grips(deployment, sheet, width_mm).order(min(PINS[-1], sheet.network.panel_count))
    first: Gripping | None = None
    for count in PINS:
        held, moved = tuple(order[:1]), tuple(order[1:count])
        yield
        found = yield from closing_steps(sheet, grips(deployment, sheet, width_mm, held, moved, end, steps))
        off = np.abs(found.phi - angles[: len(found.phi)])
        tried = Gripping(held, moved, found, len(found.phi) == steps and bool(np.all(off <= FOLLOWS)))
        first = first or tried
        if tried.follows or count >= len(order):
            break
    return tried if tried.follows else first or tried


@dataclass(frozen=True, slots=True, eq=False)
class SoftMotions:
    """The softest motions of a sheet on its ideal path, each as large as its energy allows.

    Attributes
    ----------
    panels : tuple of int
        All panels, row by row.
    ways : (K, 2, M) float
        How the middle of each of them moves in each of the motions.
    """

    panels: tuple[int, ...]
    ways: FloatArray

    @classmethod
    def of(cls, deployment: Deployment, sheet: SheetNetwork, width_mm: float, count: int) -> SoftMotions:
        """Those of the least eigenvalues of the Hessian, as many as a number of pins need."""
        network = sheet.network
        panels = tuple(network.number_of(place) for place in range(network.panel_count))
        return cls(panels, _softest(deployment, sheet, width_mm, count))

    @classmethod
    def for_grips(cls, deployment: Deployment, sheet: SheetNetwork, width_mm: float) -> SoftMotions:
        """As many as the most pins need that are tried."""
        return cls.of(deployment, sheet, width_mm, min(PINS[-1], sheet.network.panel_count))

    def order(self, count: int, among: Sequence[int] | None = None) -> list[int]:
        """Panels in the order in which pins at their middles take away most of the motions.

        What a pin takes away is no longer counted for the next one.  Only those of ``among`` are chosen, if given.
        """
        wanted = None if among is None else frozenset(among)
        free = np.array([wanted is None or panel in wanted for panel in self.panels])
        left, chosen = self.ways, []
        for _ in range(count):
            place = int(np.argmax(np.where(free, np.sum(left**2, axis=(1, 2)), -1.0)))
            chosen.append(self.panels[place])
            left = _pinned(left, place)
        return list(dict.fromkeys(chosen))

    def taken(self, panels: Sequence[int]) -> float:
        """Share of the motions, 0 to 1, that pins at the middles of panels take away."""
        place = {panel: number for number, panel in enumerate(self.panels)}
        rows = np.concatenate([self.ways[place[panel]] for panel in panels])
        basis, _ = np.linalg.qr(rows.T)
        flat = self.ways.reshape(-1, self.ways.shape[-1])
        return float(np.sum((flat @ basis) ** 2) / np.sum(flat**2))


def _pinned(left: FloatArray, place: int) -> FloatArray:
    """Motions that are left where one panel is pinned."""
    basis, _ = np.linalg.qr(left[place].T)
    found: FloatArray = left - (left @ basis) @ basis.T
    return found


def panels_to_pin(deployment: Deployment, sheet: SheetNetwork, width_mm: float, count: int) -> list[int]:
    """Panels in the order in which pins at their middles take away most soft motions."""
    return SoftMotions.of(deployment, sheet, width_mm, count).order(count)


def _softest(deployment: Deployment, sheet: SheetNetwork, width_mm: float, count: int) -> FloatArray:
    """How the middles of all panels move in the softest motions, (K, 2, M)."""
    energy, network = NetworkEnergy(sheet.network), sheet.network
    per_turn = diags_array(1.0 / np.tile([1.0, 1.0, network.panel_size], network.panel_count))
    soft = []
    for angle in LOOKED_AT_DEG:
        hessian = energy.slopes(ideal_motion(deployment, network, width_mm, math.radians(angle)))[1]
        scaled = csc_array(per_turn @ hessian @ per_turn)
        wanted = min(count + MORE_MOTIONS, 3 * network.panel_count - 2)
        # Below all eigenvalues: the three motions of the whole have none.
        shift = -1e-3 * float(np.mean(scaled.diagonal()))
        start = np.linspace(1.0, 2.0, 3 * network.panel_count)
        values, vectors = eigsh(scaled, k=wanted, sigma=shift, v0=start)
        soft.append((vectors / np.sqrt(np.maximum(values - shift, 1e-12))).reshape(-1, 3, wanted)[:, :2])
    found: FloatArray = np.concatenate(soft, axis=2)
    return found


def grips(
    deployment: Deployment,
    sheet: SheetNetwork,
    width_mm: float,
    held: Sequence[int],
    moved: Sequence[int],
    end: float = CLOSED,
    steps: int = STEPS,
) -> Drive:
    """Pin some panels at their middles and lead them along the ideal path; pinned panels may turn.

    Parameters
    ----------
    held, moved : sequence of int
        Panels, row by row.  The middle of those that are held stays where it is.
    end : float, radians

    Returns
    -------
    drive : Drive
        Its displacement is the way, mm, that the middle of the moved panels has gone from that of the held ones.

    Raises
    ------
    MechanicsError
        Unknown panels, panels that trimming took, fewer than two altogether, or none to move.
    """
    network = sheet.network
    here, there = ([network.place_of(panel) for panel in panels] for panels in (held, moved))
    panels = [*here, *there]
    if not held or not moved:
        raise MechanicsError("drive.no_grips")
    angles = np.linspace(math.pi, end, FINER * (steps - 1) + 1)
    places = np.stack([network.centroids + ideal_motion(deployment, network, width_mm, phi)[:, :2] for phi in angles])
    # Seen from the held panels, whose middle stays.
    places -= places[:, here].mean(axis=1, keepdims=True) - places[0, here].mean(axis=0)
    middle = places[:, there].mean(axis=1)
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(middle, axis=0), axis=1))])
    return prescribed_places(panels, (places - network.centroids)[:, panels], way, FINER)
