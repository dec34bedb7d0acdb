"""What is done to a network: which degrees of freedom are held or moved, and through which values.

A drive has a path of steps.  At every step it prescribes some degrees of freedom, and may prescribe the mean of the
ligaments' turns; all the rest is free.  Degree of freedom 3 p + k is u_x, u_y or theta (k = 0, 1, 2) of panel p.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.foundation.errors import MechanicsError
from kirigami_studio.mechanics.network import PanelNetwork

#: Panels whose centroids lie this near (in panel sizes) to the end of the network belong to its last row.
END_ROW = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """A path of prescribed values.

    Raises
    ------
    MechanicsError
        Values of other shapes or that are not finite, or nothing that would keep the network in its place.
    """

    freedoms: IntArray  #: (D,); prescribed degrees of freedom
    path: FloatArray  #: (S, D), mm and radians; their values, step by step; a network at rest has zeros
    displacement: FloatArray  #: (S,); what the reaction force is measured against: mm of a grip, or radians of an angle
    rate: FloatArray  #: (S, D); derivative of ``path`` by ``displacement``
    #: (3 P,); a linear combination of all degrees of freedom that is prescribed as well; empty for none.
    weights: FloatArray = field(default_factory=lambda: np.zeros(0))
    #: (S,); its values, step by step; its derivative by ``displacement`` is ``level_rate``.
    level: FloatArray = field(default_factory=lambda: np.zeros(0))
    level_rate: FloatArray = field(default_factory=lambda: np.zeros(0))  #: (S,)

    def __post_init__(self) -> None:
        steps = len(self.displacement)
        if steps < 1 or self.path.shape != (steps, len(self.freedoms)) or self.rate.shape != self.path.shape:
            raise MechanicsError("drive.wrong_shape", steps=steps, found=self.path.shape)
        if self.weights.size and (self.level.shape != (steps,) or self.level_rate.shape != (steps,)):
            raise MechanicsError("drive.wrong_shape", steps=steps, found=self.level.shape)
        values = (self.path, self.displacement, self.rate, self.weights, self.level, self.level_rate)
        if not all(np.all(np.isfinite(part)) for part in values):
            raise MechanicsError("drive.not_finite")
        if len(np.unique(self.freedoms)) != len(self.freedoms):
            raise MechanicsError("drive.prescribed_twice")
        if len(self.freedoms) < 3:
            raise MechanicsError("drive.network_adrift", found=len(self.freedoms))

    @property
    def steps(self) -> int:
        return len(self.displacement)

    def first(self, steps: int) -> Drive:
        """The drive up to a step."""
        return replace(
            self,
            path=self.path[:steps],
            displacement=self.displacement[:steps],
            rate=self.rate[:steps],
            level=self.level[:steps],
            level_rate=self.level_rate[:steps],
        )

    def force(self, reaction: FloatArray, pull: FloatArray) -> FloatArray:
        """Force (S,) along the displacement from the reactions (S, D) and from the pull (S,) on the prescribed mean."""
        along: FloatArray = np.sum(reaction * self.rate, axis=1)
        return along + pull * self.level_rate if self.weights.size else along


def rated(path: FloatArray, displacement: FloatArray) -> FloatArray:
    """Derivative (S, D) of a path by the displacement (S,), of second order in the steps.

    Raises
    ------
    MechanicsError
        Fewer than 3 steps, or steps at which the displacement does not grow.
    """
    if len(displacement) < 3:
        raise MechanicsError("drive.too_few_steps", found=len(displacement), least=3)
    if not np.all(np.diff(displacement) > 0.0):
        raise MechanicsError("drive.nothing_moves")
    slope: FloatArray = np.gradient(path, displacement, axis=0, edge_order=2)
    return slope


def moved_panels(
    network: PanelNetwork, held: Sequence[int], moved: Mapping[int, tuple[float, float, float]], steps: int
) -> Drive:
    """Hold some panels fast and move others evenly to a displacement and turn (mm, mm, radians).

    The displacement is the longest way that a moved panel goes; where all of them only turn, it is the largest turn.
    """
    _check_panels(network, [*held, *moved])
    if not moved:
        raise MechanicsError("drive.nothing_moves")
    goal = np.zeros((network.panel_count, 3))
    for panel, motion in moved.items():
        goal[panel] = motion
    freedoms = _all_of([*held, *moved])
    total = float(np.max(np.linalg.norm(goal[:, :2], axis=1))) or float(np.max(np.abs(goal[:, 2])))
    if total == 0.0:
        raise MechanicsError("drive.nothing_moves")
    share = np.linspace(0.0, 1.0, steps)
    rate = np.tile(goal.ravel()[freedoms] / total, (steps, 1))
    return Drive(freedoms, share[:, None] * goal.ravel()[freedoms], share * total, rate)


def clamped_ends(network: PanelNetwork, ends: int, direction: int, distance_mm: float, steps: int) -> Drive:
    """Clamp the panels at both ends of the network and move those at the upper end.

    Parameters
    ----------
    ends : int
        0: the columns at the left and at the right; 1: the rows at the bottom and at the top.
    direction : int
        Along which axis, 0 for x and 1 for y, the right or upper end moves.
    distance_mm : float
        How far; negative in the other direction.
    """
    place = network.centroids[:, ends]
    reach = END_ROW * network.panel_size
    first, last = np.flatnonzero(place < place.min() + reach), np.flatnonzero(place > place.max() - reach)
    if np.intersect1d(first, last).size:
        raise MechanicsError("drive.ends_meet")
    goal = [0.0, 0.0, 0.0]
    goal[direction] = distance_mm
    moved = dict.fromkeys(last.tolist(), (goal[0], goal[1], goal[2]))
    return moved_panels(network, first.tolist(), moved, steps)


def mean_turn(network: PanelNetwork, signs: FloatArray, turns: FloatArray) -> Drive:
    """Prescribe the mean turn of the ligaments and nothing else: the sheet finds the easiest way itself.

    Parameters
    ----------
    signs : (L,) float
        +1 where a ligament's turn theta_B - theta_A grows as the network is driven, -1 where it falls.
    turns : (S,) float, radians
        Mean of ``signs`` times the turns, step by step; also the displacement.
    """
    weights = np.zeros(3 * network.panel_count)
    share = signs / len(signs)
    np.add.at(weights, 3 * network.ligaments.panels[:, 0] + 2, -share)
    np.add.at(weights, 3 * network.ligaments.panels[:, 1] + 2, share)
    # Held so that the whole does not drift; forces and moments there are zero.
    freedoms = _all_of([_middle_panel(network)])
    still = np.zeros((len(turns), 3))
    return Drive(freedoms, still, turns, still, weights, turns, np.ones(len(turns)))


def prescribed_places(panels: Sequence[int], shifts: FloatArray, displacement: FloatArray, every: int = 1) -> Drive:
    """Lead panels through given places and let them turn.

    Parameters
    ----------
    panels : sequence of K int
    shifts : (S, K, 2) float, mm
    displacement : (S,) float, mm
        The way of the grips.
    every : int
        Only each so many of the places is a step; those between make the derivative exact.
    """
    freedoms: IntArray = (3 * np.asarray(panels, dtype=np.intp)[:, None] + np.arange(2)).ravel()
    path = shifts.reshape(len(shifts), -1)
    rate = rated(path, displacement)
    return Drive(freedoms, path[::every], displacement[::every], rate[::every])


def _middle_panel(network: PanelNetwork) -> int:
    return int(np.argmin(np.linalg.norm(network.centroids - network.centroids.mean(axis=0), axis=1)))


def _all_of(panels: Sequence[int]) -> IntArray:
    freedoms: IntArray = (3 * np.asarray(panels, dtype=np.intp)[:, None] + np.arange(3)).ravel()
    return freedoms


def _check_panels(network: PanelNetwork, panels: Sequence[int]) -> None:
    for panel in panels:
        if not 0 <= panel < network.panel_count:
            raise MechanicsError("drive.unknown_panel", panel=panel, last=network.panel_count - 1)
