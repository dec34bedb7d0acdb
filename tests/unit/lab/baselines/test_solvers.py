"""The four solvers on a problem whose answer is known: they improve, keep to cap and box, and repeat themselves."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.lab.baselines.search import KEPT, Box, CapReached, Judge, Patience, Search, Stopping, Trial, search
from kirigami_studio.lab.baselines.solvers import SOLVERS, CmaEs, LocalSearch, ParticleSwarm

BOX = Box(-1.0, 1.0, 6)
#: Inside the box but for one coordinate, so that the best allowed point is on a wall.
PEAK = np.array([0.3, -0.5, 0.1, 0.7, -0.2, 1.4])
SHORT = Stopping(evaluations=300)


@dataclass
class Hill:
    """A smooth hill that writes down what it is asked."""

    feasible: bool = True
    asked: list[FloatArray] = field(default_factory=list)

    def __call__(self, points: FloatArray) -> tuple[FloatArray, BoolArray]:
        self.asked.append(points.copy())
        distance: FloatArray = np.sqrt(((points - PEAK) ** 2).sum(axis=1))
        return 1.0 - 0.3 * distance, np.full(len(points), self.feasible)

    @property
    def points(self) -> FloatArray:
        return np.concatenate(self.asked)


def climbed(name: str, judge: Judge, stopping: Stopping = SHORT, seed: int = 1) -> Search:
    return search(SOLVERS[name], judge, BOX, stopping, np.random.default_rng(seed))


@pytest.mark.parametrize("name", SOLVERS)
def test_that_every_solver_climbs_within_its_box_and_cap(name: str) -> None:
    hill = Hill()
    found = climbed(name, hill)
    best = 1.0 - 0.3 * 0.4
    assert found.first < 0.78
    assert best - 0.1 < found.best <= best
    assert found.evaluations == len(hill.points) <= 300
    assert (np.abs(hill.points) <= 1.0).all()


@pytest.mark.parametrize("name", SOLVERS)
@pytest.mark.parametrize("cap", [1, 7, 47])
def test_that_no_solver_passes_its_cap(name: str, cap: int) -> None:
    hill = Hill()
    found = climbed(name, hill, Stopping(evaluations=cap, x_tolerance=0.0, relative_tolerance=0.0, patience=10_000))
    assert found.evaluations == sum(len(points) for points in hill.asked) <= cap
    if name in ("powell", "local-search", "swarm"):
        assert found.evaluations > 0.9 * cap - 24


@pytest.mark.parametrize("name", SOLVERS)
def test_that_the_same_random_state_gives_the_same_search(name: str) -> None:
    first, again, other = Hill(), Hill(), Hill()
    np.random.default_rng(0)
    climbed(name, first)
    np.random.seed(7)  # noqa: NPY002  (the global state must not matter)
    climbed(name, again)
    climbed(name, other, seed=2)
    assert np.array_equal(first.points, again.points)
    assert not np.array_equal(first.points[:1], other.points[:1])


@pytest.mark.parametrize("name", SOLVERS)
def test_that_the_best_different_candidates_are_kept_in_order(name: str) -> None:
    hill = Hill()
    found = climbed(name, hill)
    values = [candidate.value for candidate in found.candidates]
    assert len(values) == KEPT
    assert values == sorted(values, reverse=True)
    assert values[0] == found.best
    assert len({candidate.point.tobytes() for candidate in found.candidates}) == KEPT
    everything, _ = Hill()(np.unique(hill.points, axis=0))
    assert values == sorted(everything, reverse=True)[:KEPT]
    for candidate in found.candidates:
        assert np.array_equal(hill.points[candidate.evaluation - 1], candidate.point)


@pytest.mark.parametrize("name", SOLVERS)
def test_that_nothing_is_a_candidate_where_nothing_is_feasible(name: str) -> None:
    found = climbed(name, Hill(feasible=False))
    assert found.candidates == ()
    assert found.evaluations > 0


@pytest.mark.parametrize("name", ["cma-es", "swarm", "powell"])
def test_that_solvers_stop_by_themselves_where_nothing_is_to_be_gained(name: str) -> None:
    def level(points: FloatArray) -> tuple[FloatArray, BoolArray]:
        return np.full(len(points), 0.5), np.full(len(points), True)

    assert climbed(name, level, Stopping(evaluations=5000)).evaluations < 2500


def test_that_the_settings_are_the_papers() -> None:
    """986 evaluations of CMA-ES are 58 generations of 17 at 100 dimensions, 24 x 41 are a swarm that never rests."""
    box = Box(-1.0, 1.0, 100)
    sizes: dict[str, list[int]] = {}
    for name, solver in SOLVERS.items():
        asked: list[int] = sizes.setdefault(name, [])

        def rising(points: FloatArray, asked: list[int] = asked) -> tuple[FloatArray, BoolArray]:
            asked.append(len(points))
            # Every round gains, so that only the cap ends the search.
            rise = 1.02 ** len(asked) * (1.0 + 0.1 * points[:, 0])
            return rise, np.full(len(points), True)

        search(solver, rising, box, Stopping(), np.random.default_rng(0))
    assert sizes["cma-es"] == [17] * 58
    assert sizes["swarm"] == [24] * 41
    assert sum(sizes["local-search"]) == 1000
    assert sizes["local-search"].count(1) == 8
    assert set(sizes["local-search"][1:13]) <= {10, 4}
    assert sizes["powell"] == [1] * 1000
    assert (CmaEs().step, ParticleSwarm().inertia, ParticleSwarm().own, ParticleSwarm().shared) == (0.3, 0.7, 1.5, 1.5)
    assert (LocalSearch().step, LocalSearch().shrink) == (0.25, 0.5)
    assert Stopping() == Stopping(1000, 1e-3, 1e-3, 5)


def test_that_patience_ends_after_five_rounds_without_a_gain_that_counts() -> None:
    patience = Patience(Stopping(), 0.8)
    assert [patience.ended(best) for best in (0.9, 0.9004, 0.9008, 0.9008, 0.9008)] == [False] * 5
    assert patience.ended(0.9008)
    # Small gains add up: 0.9002, 0.9004, ... is one per mille above 0.9 after the fifth round.
    patience = Patience(Stopping(), 0.9)
    assert not any(patience.ended(0.9 + 0.0003 * k) for k in range(1, 40))


def test_that_a_trial_refuses_more_points_than_are_left_and_points_outside() -> None:
    hill = Hill()
    trial = Trial(hill, BOX, 3)
    trial.values(np.zeros((2, 6)))
    with pytest.raises(CapReached):
        trial.values(np.zeros((2, 6)))
    assert (trial.evaluations, trial.left, len(hill.points)) == (2, 1, 2)
    with pytest.raises(ValueError, match="box"):
        trial.values(np.full((1, 6), 1.1))
    assert len(trial.result().candidates) == 1
