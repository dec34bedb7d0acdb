"""Short tours through paths that may be cut in several ways, against every other tour there is."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from kirigami_studio.fabricate.routing import CuttingOrder, Ways, best_ways, nearest_neighbours, shortest_tour


def random_ways(generator: np.random.Generator, count: int) -> list[Ways]:
    """Lines that may be turned and, every third, a triangle that may begin at any corner."""
    paths = []
    for index in range(count):
        corners = generator.uniform(0, 10, 3) + 1j * generator.uniform(0, 10, 3)
        closed = index % 3 == 2
        paths.append(Ways(corners, corners, True) if closed else Ways(corners[:2], corners[1::-1], True))
    return paths


def length_of(paths: list[Ways], order: tuple[int, ...], way: tuple[int, ...], start: complex) -> float:
    here, total = start, 0.0
    for index, choice in zip(order, way, strict=True):
        total += abs(paths[index].entries[choice] - here)
        here = paths[index].exits[choice]
    return total


def every_way(paths: list[Ways], order: tuple[int, ...], start: complex) -> float:
    choices = [range(len(paths[index].entries)) for index in order]
    return min(length_of(paths, order, way, start) for way in itertools.product(*choices))


@pytest.mark.parametrize("seed", range(4))
def test_that_no_other_choice_of_ways_travels_less(seed: int) -> None:
    paths = random_ways(np.random.default_rng(seed), 7)
    tour = best_ways(paths, range(7), 1 + 2j)
    assert tour.length == pytest.approx(every_way(paths, tuple(range(7)), 1 + 2j))
    assert tour.length == pytest.approx(length_of(paths, tour.order, tour.way, 1 + 2j))


@pytest.mark.parametrize("seed", range(6))
def test_that_short_tours_through_open_cuts_are_the_shortest_there_are(seed: int) -> None:
    corners = np.random.default_rng(seed).uniform(0, 10, (6, 2, 2)) @ np.array([1.0, 1j])
    paths = [Ways(ends, ends[::-1], True) for ends in corners]
    tour = shortest_tour(paths, 0j)
    optimum = min(best_ways(paths, order, 0j).length for order in itertools.permutations(range(6)))
    assert tour.length == pytest.approx(length_of(paths, tour.order, tour.way, 0j))
    assert tour.length == pytest.approx(optimum, rel=1e-9)


def test_that_improving_never_lengthens_what_nearest_neighbours_found() -> None:
    for seed in range(5):
        paths = random_ways(np.random.default_rng(seed), 60)
        first, last = nearest_neighbours(paths, 0j), shortest_tour(paths, 0j)
        assert first.length == pytest.approx(length_of(paths, first.order, first.way, 0j))
        assert last.length == pytest.approx(length_of(paths, last.order, last.way, 0j))
        assert sorted(last.order) == list(range(60))
        assert last.length < 0.95 * first.length


def test_that_paths_with_one_direction_keep_it() -> None:
    generator = np.random.default_rng(3)
    places = generator.uniform(0, 10, (6, 2)) + 1j * generator.uniform(0, 10, (6, 2))
    paths = [Ways(place[:1], place[1:], False) for place in places]
    tour = shortest_tour(paths, 0j)
    assert tour.way == (0,) * 6
    optimum = min(length_of(paths, order, (0,) * 6, 0j) for order in itertools.permutations(range(6)))
    # Exchanges would turn them; moves alone need not find the very best.
    assert optimum - 1e-9 <= tour.length <= 1.1 * optimum


def test_that_ties_go_to_the_first() -> None:
    places = np.array([3.0 + 0j, 3.0 + 0j])
    paths = [Ways(places, places, True) for _ in range(4)]
    assert shortest_tour(paths, 0j) == CuttingOrder((0, 1, 2, 3), (0, 0, 0, 0), 3.0)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_that_a_few_paths_are_enough(count: int) -> None:
    paths = random_ways(np.random.default_rng(count), count)
    optimum = min(best_ways(paths, order, 0j).length for order in itertools.permutations(range(count)))
    assert shortest_tour(paths, 0j).length == pytest.approx(optimum)
