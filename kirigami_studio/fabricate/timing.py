"""How long cutting takes: a head that speeds up and slows down on every run (trapezoid model), and how far to trust it.

A run is what the head does without stopping.  The estimate stops at every corner sharper than ``FLOWING_TURN`` and
takes the machine's acceleration as it stands; the cutting speed is the material's, as far as the machine reaches it.
The range around it has two ends: at the slow one the head stops at every vertex and the acceleration is ``DOUBT`` times
smaller, at the fast one it stops only where it turns by more than ``SWIFT_TURN`` and the acceleration is ``DOUBT``
times larger.  An arc is one edge.  Neither end knows what heat, blower or controller add; passes repeat the whole job,
and delays apply to every path and every sharp corner of every pass.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kirigami_studio.fabricate.cut_path import CutPath, arc_lengths
from kirigami_studio.fabricate.machine import Machine, machine_of
from kirigami_studio.fabricate.material import Material
from kirigami_studio.foundation.arrays import FloatArray, IntArray

#: Turns (radians) that a head takes without stopping: in the estimate, and at the fast end of the range.
FLOWING_TURN, SWIFT_TURN = math.radians(10.0), math.radians(45.0)
#: The acceleration may be wrong by this factor; it is the number that people know least.
DOUBT = 2.0


@dataclass(frozen=True, slots=True)
class CutTimes:
    """Seconds for a job, all passes together."""

    #: cut, travel, extra: with the beam on, between cuts, and for switching it on and off.
    cut: float
    travel: float
    extra: float
    #: low, high: what the whole job may take, see the assumptions of this module.
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


@dataclass(frozen=True, slots=True, eq=False)
class Edges:
    """The edges of all paths of a job in the order of cutting."""

    path: IntArray  #: (E,); place of the path that an edge belongs to
    length: FloatArray  #: (E,), mm; arcs as arcs
    #: (E,), radians; how far the head turns before an edge, without sign; infinite at the start of a path.
    turn: FloatArray

    @classmethod
    def of(cls, paths: Sequence[CutPath]) -> Edges:
        """Measure the edges of all paths at once: one by one, a large job takes a hundred times as long."""
        if not paths:
            return cls(np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros(0))
        lines = [
            points for path in paths for points in ((path.points, path.points[:1]) if path.closed else (path.points,))
        ]
        counts = np.array([len(path.points) + int(path.closed) for path in paths])
        of_point = np.repeat(np.arange(len(paths)), counts)
        inner = of_point[1:] == of_point[:-1]  # from the end of a path to the start of the next there is no edge
        chord = np.diff(np.concatenate(lines), axis=0)[inner]
        bulge = np.concatenate(
            [np.zeros(count) if path.bulges is None else path.bulges[:count]
             for path, count in zip(paths, (counts - 1).tolist(), strict=True)]
        )  # fmt: skip
        # An arc of sweep 4 atan(b) sets out half of that to the right of its chord and arrives as much to the left.
        half = 2.0 * np.arctan(bulge)
        heading = np.arctan2(chord[:, 1], chord[:, 0])
        edge = of_point[1:][inner]
        turn = np.full(len(edge), np.inf)
        turn[1:] = np.abs(np.angle(np.exp(1j * ((heading - half)[1:] - (heading + half)[:-1]))))
        turn[np.diff(edge, prepend=-1) > 0] = np.inf
        return cls(edge, arc_lengths(np.linalg.norm(chord, axis=1), bulge), turn)

    @property
    def sharp_corners(self) -> IntArray:
        """Places of edges after a turn sharper than ``SWIFT_TURN``, those that begin a path left out."""
        return np.flatnonzero((self.turn > SWIFT_TURN) & np.isfinite(self.turn))

    def runs(self, flowing_turn: float) -> tuple[IntArray, FloatArray]:
        """What is cut between two stops, where turns up to ``flowing_turn`` (radians) are no stop.

        Returns
        -------
        path : (R,) int
            Place of the path that a run belongs to.
        length : (R,) float, mm
        """
        starts = np.flatnonzero(self.turn > flowing_turn)
        return self.path[starts], np.add.reduceat(self.length, starts) if len(starts) else np.zeros(0)


def cut_times(paths: Sequence[CutPath], material: Material, machine: Machine | None = None) -> CutTimes:
    """Estimate the time of a job, and its range; without a machine, on that of the material."""
    machine = machine_of(material) if machine is None else machine
    edges, moves = Edges.of(paths), travel_lengths(paths)
    cut, travel = _moving_seconds(edges, moves, material, machine, FLOWING_TURN, 1.0)
    switching = len(paths) * (machine.on_delay_s + machine.off_delay_s)
    extra = material.passes * (switching + len(edges.sharp_corners) * machine.corner_delay_s)
    return CutTimes(
        cut=cut,
        travel=travel,
        extra=extra,
        low=sum(_moving_seconds(edges, moves, material, machine, SWIFT_TURN, DOUBT)) + extra,
        high=sum(_moving_seconds(edges, moves, material, machine, 0.0, 1.0 / DOUBT)) + extra,
    )


def _moving_seconds(
    edges: Edges, moves: FloatArray, material: Material, machine: Machine, flowing_turn: float, eagerness: float
) -> tuple[float, float]:
    """Seconds with the beam on and off; ``eagerness`` multiplies the acceleration."""
    acceleration = eagerness * machine.acceleration_mm_s2
    _, runs = edges.runs(flowing_turn)
    cut = float(run_seconds(runs, machine.speed_mm_s(material), acceleration).sum())
    travel = float(run_seconds(moves, machine.travel_mm_s, acceleration).sum())
    return material.passes * cut, material.passes * travel
