"""The paper's four solvers, with its settings (Table of settings, Appendix "Solver comparison").

What the paper leaves open is read so that the evaluations come out as it reports them (986.0, 625.1, 1000.0, 1000.0):

* CMA-ES samples whole generations only: 58 of 17 are 986.  Its tolerances are the library's own ``tolx`` and
  ``tolfunrel``; at 100 dimensions the cap comes first.
* The swarm ends when its best value has not gained 0.1 % for five rounds, or has drawn together.
* The local search halves its step after a batch without gain.  A restart ends where steps no longer count, and another
  one follows; restarts share what is left of the cap evenly, so that all eight are begun.
* Powell's search is SciPy's; at 100 dimensions its first pass over all directions reaches the cap.

CMA-ES is pycma.  The swarm is written here: pyswarms (1.3.0) draws from NumPy's global random state, moves particles
that leave the box to random places, cannot be told a cap on evaluations, and has not been kept up since 2021.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from scipy.optimize import Bounds, minimize

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.lab.baselines.search import Patience, Solver, Stopping, Trial


@dataclass(frozen=True, slots=True)
class CmaEs:
    """Covariance matrix adaptation evolution strategy (Hansen and Ostermeier 2001), from a random mean.

    Attributes
    ----------
    step : float
        First standard deviation, as a share of the box.
    """

    step: float = 0.3

    def solve(self, trial: Trial, stopping: Stopping, rng: Generator) -> None:
        """Sample generations of 4 + floor(3 log n) points.

        Raises
        ------
        KirigamiError
            The package ``cma`` is not installed.
        """
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # it misses matplotlib, for plots that nobody asks for
                from cma.evolution_strategy import CMAEvolutionStrategy
        except ImportError as error:
            raise KirigamiError("benchmark.cma_missing") from error
        box = trial.box
        options = {
            "bounds": [box.low, box.high],
            "popsize": 4 + int(3 * np.log(box.size)),
            "tolx": stopping.x_tolerance * box.width,
            "tolfunrel": stopping.relative_tolerance,
            "randn": lambda *shape: rng.standard_normal(shape),
            "seed": np.nan,
            "verbose": -10,
            "verb_log": 0,
        }
        state = CMAEvolutionStrategy(box.random(rng, 1)[0], self.step * box.width, options)
        while not state.stop() and trial.left >= state.popsize:
            points = state.ask()
            # Its map into the box is exact to rounding only.
            state.tell(points, -trial.values(box.clipped(np.array(points))))


@dataclass(frozen=True, slots=True)
class ParticleSwarm:
    """Particle swarm (Kennedy and Eberhart 1995) with one best place for all.

    A particle that would leave the box stays on its wall, with no speed across it.

    Attributes
    ----------
    particles : int
    inertia : float
    own, shared : float
        Pulls to the particle's own best place and to the swarm's: the paper's c1 and c2.
    """

    particles: int = 24
    inertia: float = 0.7
    own: float = 1.5
    shared: float = 1.5

    def solve(self, trial: Trial, stopping: Stopping, rng: Generator) -> None:
        """Move all particles once a round, from even random places and rest."""
        box = trial.box
        places = box.random(rng, min(self.particles, trial.left))
        speeds = np.zeros_like(places)
        best, best_values = places.copy(), trial.values(places)
        patience = Patience(stopping, float(best_values.max()))
        while trial.left >= len(places):
            leader = best[np.argmax(best_values)]
            pull, shared_pull = rng.random((2, *places.shape))
            speeds = (
                self.inertia * speeds
                + self.own * pull * (best - places)
                + self.shared * shared_pull * (leader - places)
            )
            moved = places + speeds
            places = box.clipped(moved)
            speeds[places != moved] = 0.0
            values = trial.values(places)
            better = values > best_values
            best[better], best_values[better] = places[better], values[better]
            drawn_together = float(np.ptp(places, axis=0).max()) < stopping.x_tolerance * box.width
            if patience.ended(float(best_values.max())) or drawn_together:
                return


@dataclass(frozen=True, slots=True)
class LocalSearch:
    """Random restarts of a search that takes the best of a batch of Gaussian steps (after Boender et al. 1982).

    Attributes
    ----------
    restarts, batch : int
    step : float
        First standard deviation of a step in each coordinate, as a share of the box.
    shrink : float
        Factor of the step after a batch without gain.
    """

    restarts: int = 8
    batch: int = 10
    step: float = 0.25
    shrink: float = 0.5

    def solve(self, trial: Trial, stopping: Stopping, rng: Generator) -> None:
        """Search from one random place after the other."""
        for number in range(self.restarts):
            until = trial.left - trial.left // (self.restarts - number)
            if trial.left > until:
                self._descend(trial, until, stopping, rng)

    def _descend(self, trial: Trial, until: int, stopping: Stopping, rng: Generator) -> None:
        """One restart; it leaves ``until`` evaluations to the others."""
        box = trial.box
        place = box.random(rng, 1)[0]
        value = float(trial.values(place[np.newaxis])[0])
        step = self.step
        while step >= stopping.x_tolerance and trial.left > until:
            count = min(self.batch, trial.left - until)
            points = box.clipped(place + step * box.width * rng.standard_normal((count, box.size)))
            values = trial.values(points)
            first = int(np.argmax(values))
            if values[first] > value:
                place, value = points[first], float(values[first])
            else:
                step *= self.shrink


@dataclass(frozen=True, slots=True)
class Powell:
    """Bounded search along one direction after the other (Powell 1964), from one random place."""

    def solve(self, trial: Trial, stopping: Stopping, rng: Generator) -> None:
        """Run SciPy's search until it converges or the cap ends it."""
        box = trial.box

        def cost(point: FloatArray) -> float:
            # A line search is inside to rounding only.
            return -float(trial.values(box.clipped(point)[np.newaxis])[0])

        minimize(
            cost,
            box.random(rng, 1)[0],
            method="Powell",
            bounds=Bounds(np.full(box.size, box.low), np.full(box.size, box.high)),
            options={"xtol": stopping.x_tolerance, "ftol": stopping.relative_tolerance},
        )


#: By the names that commands and reports use.
SOLVERS: dict[str, Solver] = {
    "cma-es": CmaEs(),
    "swarm": ParticleSwarm(),
    "local-search": LocalSearch(),
    "powell": Powell(),
}
