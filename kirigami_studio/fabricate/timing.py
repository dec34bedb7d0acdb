"""How long cutting takes: a head that speeds up and slows down on every run (trapezoid model), and how far to trust it.

A run is what the head does without stopping.  The estimate stops at every corner sharper than ``FLOWING_TURN`` and
takes the material's acceleration as it stands.  The range around it has two ends: at the slow one the head stops at
every vertex and the acceleration is ``DOUBT`` times smaller, at the fast one it stops only where it turns by more than
``SWIFT_TURN`` and the acceleration is ``DOUBT`` times larger.  An arc is one edge.  Neither end knows what heat, blower
or controller add; passes repeat the whole job, and delays apply to every path of every pass.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kirigami_studio.fabricate.cut_path import CutPath, edge_lengths
from kirigami_studio.fabricate.material import Material
from kirigami_studio.foundation.arrays import FloatArray

#: Turns (radians) that a head takes without stopping: in the estimate, and at the fast end of the range.
FLOWING_TURN, SWIFT_TURN = math.radians(10.0), math.radians(45.0)
#: The acceleration may be wrong by this factor; it is the number that people know least.
DOUBT = 2.0


@dataclass(frozen=True, slots=True)
class CutTimes:
    """Seconds for a job, all passes together.

    Attributes
    ----------
    cut, travel, extra : float
        With the beam on, between cuts, and for switching it on and off.
    low, high : float
        What the whole job may take, see the assumptions of this module.
    """

    cut: float
    travel: float
    extra: float
    low: float
    high: float

    @property
    def total(self) -> float:
        """The estimate for the whole job."""
        return self.cut + self.travel + self.extra


def run_seconds(lengths: FloatArray, speed: float, acceleration: float) -> FloatArray:
    """Seconds for straight runs from rest to rest.

    ``L >= v^2 / a``: ``L / v + v / a``; shorter runs never reach the speed: ``2 sqrt(L / a)``.
    """
    reaches_speed = lengths >= speed**2 / acceleration
    seconds: FloatArray = np.where(
        reaches_speed, lengths / speed + speed / acceleration, 2.0 * np.sqrt(lengths / acceleration)
    )
    return seconds


def travel_lengths(paths: Sequence[CutPath]) -> FloatArray:
    """Length of each move with the beam off, from the origin through all paths in order: (paths,) float, mm."""
    exits = np.array([np.zeros(2), *[path.points[0 if path.closed else -1] for path in paths]])[:-1]
    entries = np.array([path.points[0] for path in paths]).reshape(-1, 2)
    lengths: FloatArray = np.linalg.norm(entries - exits, axis=1)
    return lengths


def run_lengths(path: CutPath, flowing_turn: float) -> FloatArray:
    """Lengths (R,), mm, of what is cut between two stops: turns up to ``flowing_turn`` (radians) are no stop."""
    ends = np.roll(path.points, -1, axis=0) if path.closed else path.points[1:]
    chord = ends - path.points[: len(ends)]
    bulge = np.zeros(len(ends)) if path.bulges is None else path.bulges[: len(ends)]
    # An arc of sweep 4 atan(b) sets out half of that to the right of its chord and arrives as much to the left.
    half = 2.0 * np.arctan(bulge)
    length = edge_lengths(path.points, path.bulges, path.closed)
    heading = np.arctan2(chord[:, 1], chord[:, 0])
    turn = (heading - half)[1:] - (heading + half)[:-1]
    stops = np.flatnonzero(np.abs(np.angle(np.exp(1j * turn))) > flowing_turn) + 1
    return np.add.reduceat(length, np.concatenate([[0], stops]))


def cut_times(paths: Sequence[CutPath], material: Material) -> CutTimes:
    """Estimate the time of a job, and the range around it."""
    cut, travel = _moving_seconds(paths, material, FLOWING_TURN, 1.0)
    extra = material.passes * len(paths) * (material.on_delay_s + material.off_delay_s)
    return CutTimes(
        cut=cut,
        travel=travel,
        extra=extra,
        low=sum(_moving_seconds(paths, material, SWIFT_TURN, DOUBT)) + extra,
        high=sum(_moving_seconds(paths, material, 0.0, 1.0 / DOUBT)) + extra,
    )


def _moving_seconds(
    paths: Sequence[CutPath], material: Material, flowing_turn: float, eagerness: float
) -> tuple[float, float]:
    """Seconds with the beam on and off; ``eagerness`` multiplies the acceleration."""
    if not paths:
        return 0.0, 0.0
    acceleration = eagerness * material.acceleration_mm_s2
    runs = np.concatenate([run_lengths(path, flowing_turn) for path in paths])
    cut = float(run_seconds(runs, material.speed_mm_s, acceleration).sum())
    travel = float(run_seconds(travel_lengths(paths), material.travel_mm_s, acceleration).sum())
    return material.passes * cut, material.passes * travel
