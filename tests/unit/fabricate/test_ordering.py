"""The orders of cutting: nothing lost, layers kept apart, short or spread as promised."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from kirigami_studio.fabricate.cut_path import CutPath, Layer
from kirigami_studio.fabricate.cut_plan import CutPlan, plan_cuts
from kirigami_studio.fabricate.options import STRAIGHT, CutOrder
from kirigami_studio.fabricate.ordering import HEAT_REACH, STILL_HOT, in_cutting_order
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.lattice.deployment import Deployment

MakeDesign = Callable[..., Deployment]


def travel(paths: Sequence[CutPath]) -> float:
    here, total = np.zeros(2), 0.0
    for path in paths:
        total += float(np.linalg.norm(path.travelled[0] - here))
        here = path.travelled[-1]
    return total


def middles(paths: Sequence[CutPath]) -> np.ndarray:
    return np.array([0.5 * (path.points.min(axis=0) + path.points.max(axis=0)) for path in paths])


def trace(path: CutPath) -> frozenset[tuple[float, ...]]:
    """What is cut, whatever the direction and start."""
    points = np.round(path.travelled, 6)
    return frozenset(tuple(sorted((tuple(a), tuple(b)))) for a, b in pairwise(points))


def mixed_paths(seed: int = 0) -> list[CutPath]:
    """All kinds of paths on all layers, shuffled, with several that share one number of a cut."""
    generator = np.random.default_rng(seed)
    paths = [CutPath(np.array([[-1.0, -1.0], [41.0, -1.0], [41.0, 41.0], [-1.0, 41.0]]), Layer.OUTLINE, True)]
    for index in range(30):
        place = generator.uniform(1, 39, 2)
        bar = place + np.array([[0.0, 0.0], [1.0, 0.2], [1.5, 1.0]])
        paths += [
            CutPath(place + np.array([[-0.1, 0.0], [0.1, 0.0]]), Layer.RELIEF, True, index, np.array([1.0, 1.0])),
            CutPath(bar, Layer.SLITS, False, index // 2, np.array([0.0, 0.3, 0.0]) if index % 2 else None),
        ]
        if index % 3 == 0:
            paths.append(CutPath(np.array([[-1.2, place[1]], [0.5, place[1]]]), Layer.EDGE_SLITS, False, 40 + index))
    return [paths[index] for index in generator.permutation(len(paths))]


@pytest.mark.parametrize("order", CutOrder)
def test_that_every_path_is_cut_once_and_layers_follow_one_another(order: CutOrder) -> None:
    paths = mixed_paths()
    ordered = in_cutting_order(paths, order)
    layers = [list(Layer).index(path.layer) for path in ordered]
    assert layers == sorted(layers)
    key = lambda path: (path.layer.value, path.cut, sorted(trace(path)))  # noqa: E731
    assert sorted(map(key, ordered)) == sorted(map(key, paths))


@pytest.mark.parametrize("order", CutOrder)
def test_that_edge_cuts_run_inwards_and_closed_paths_keep_their_sense(order: CutOrder) -> None:
    for path in in_cutting_order(mixed_paths(), order):
        if path.layer is Layer.EDGE_SLITS:
            assert path.points[0, 0] < path.points[-1, 0]
        if path.layer is Layer.OUTLINE:
            x, y = path.points.T
            assert np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) > 0


@pytest.mark.parametrize("order", CutOrder)
def test_that_the_order_is_the_same_every_time(order: CutOrder) -> None:
    one, two = (in_cutting_order(mixed_paths(5), order) for _ in range(2))
    assert all(np.array_equal(a.points, b.points) and a.cut == b.cut for a, b in zip(one, two, strict=True))


def test_that_a_closed_path_begins_where_the_head_is_nearest() -> None:
    slit = CutPath(np.array([[1.0, 1.0], [38.0, 39.0]]), Layer.SLITS, False, 0)
    ring = CutPath(np.array([[0.0, 0.0], [40.0, 0.0], [40.0, 40.0], [0.0, 40.0]]), Layer.OUTLINE, True)
    assert in_cutting_order([ring, slit])[1].points[0].tolist() == [40.0, 40.0]


@pytest.mark.parametrize("order", CutOrder)
def test_that_nothing_to_cut_is_no_fault(order: CutOrder) -> None:
    assert in_cutting_order([], order) == ()
    (only,) = in_cutting_order([CutPath(np.array([[5.0, 5.0], [1.0, 1.0]]), Layer.SLITS, False)], order)
    assert only.points[0].tolist() == [1.0, 1.0]


def test_that_turning_a_path_turns_its_arcs() -> None:
    path = CutPath(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]]), Layer.SLITS, False, 7, np.array([0.5, 0.0, 0.0]))
    back = path.backwards()
    assert back.bulges is not None and back.bulges.tolist() == [0.0, -0.5, 0.0]
    np.testing.assert_allclose(back.travelled, path.travelled[::-1], atol=1e-12)
    assert (back.cut, back.layer, back.length) == (7, Layer.SLITS, pytest.approx(path.length))


def test_that_a_turned_and_moved_closed_path_cuts_the_same_arcs() -> None:
    points = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]])
    path = CutPath(points, Layer.RELIEF, True, 1, np.array([0.5, 0.0, -0.25, 1.0]))
    back = path.backwards()
    np.testing.assert_allclose(back.travelled, path.travelled[::-1], atol=1e-12)
    assert back.points[0].tolist() == [0.0, 0.0]
    assert trace(path.started_at(2)) == trace(path)
    assert path.started_at(2).points[0].tolist() == [4.0, 3.0]
    wrong = replace(back, bulges=-back.bulges)  # type: ignore[operator]
    assert trace(wrong) != trace(path)


def test_that_rows_go_to_and_fro_from_the_bottom(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(3, 2), options=replace(STRAIGHT, order=CutOrder.ROWS))
    assert [path.cut for path in plan.on_layer(Layer.SLITS)] == [4, 5, 3, 2, 0, 1]


def test_that_rows_without_a_grid_are_bands_of_the_sheet(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(4, 4, spread=0.1), options=replace(STRAIGHT, order=CutOrder.ROWS))
    bands = in_cutting_order([replace(path, cut=-1) for path in plan.paths], CutOrder.ROWS)
    assert travel(bands) < 1.2 * plan.travel_mm


@pytest.mark.parametrize(("seed", "spread"), [(0, 0.2), (1, 0.5), (2, 0.7), (3, 1.0), (4, 1.5)])
def test_that_the_shortest_order_is_never_longer_than_rows(seed: int, spread: float, make_design: MakeDesign) -> None:
    design = make_design(8, 7, seed, spread)
    short, rows = (
        plan_cuts(design, options=replace(STRAIGHT, order=order)) for order in (CutOrder.SHORTEST, CutOrder.ROWS)
    )
    assert short.travel_mm <= rows.travel_mm
    assert short.cut_length_mm == pytest.approx(rows.cut_length_mm)


def test_that_the_rows_are_taken_where_nothing_shorter_is_found() -> None:
    ladder = [CutPath(np.array([[0.0, y], [10.0, y]]), Layer.SLITS, False) for y in range(1, 9)]
    rows, short = (in_cutting_order(ladder, order) for order in (CutOrder.ROWS, CutOrder.SHORTEST))
    assert travel(short) <= travel(rows) == pytest.approx(8.0)


def test_that_the_travel_of_the_plan_is_that_of_the_order(make_design: MakeDesign) -> None:
    for order in CutOrder:
        plan = plan_cuts(make_design(5, 6, 2), options=replace(STRAIGHT, order=order))
        assert plan.travel_mm == pytest.approx(travel(plan.paths))


def test_that_inside_out_moves_from_the_centre_to_the_edge(make_design: MakeDesign) -> None:
    plan = plan_cuts(make_design(12, 12, 4), options=replace(STRAIGHT, order=CutOrder.INSIDE_OUT))
    far = np.linalg.norm(middles(plan.on_layer(Layer.SLITS)) - 0.5 * np.array(plan.bounds_mm), axis=1)
    pitch = 100.0 / 12
    assert far[0] < 2.5 * pitch
    # No slit is cut after one that lies more than a ring further out.
    assert np.all(np.maximum.accumulate(far) - far < 2.5 * pitch)
    rows = plan_cuts(make_design(12, 12, 4), options=replace(STRAIGHT, order=CutOrder.ROWS))
    elsewhere = np.linalg.norm(middles(rows.on_layer(Layer.SLITS)) - 0.5 * np.array(plan.bounds_mm), axis=1)
    assert not np.all(np.maximum.accumulate(elsewhere) - elsewhere < 2.5 * pitch)


def clearances(plan: CutPlan) -> np.ndarray:
    """Distance of every slit to the nearest of those cut just before it."""
    places = middles(plan.on_layer(Layer.SLITS))
    before = [places[max(0, index - STILL_HOT) : index] for index in range(1, len(places))]
    return np.array([np.linalg.norm(a - b, axis=1).min() for a, b in zip(places[1:], before, strict=True)])


def test_that_spread_keeps_away_from_what_is_still_hot(make_design: MakeDesign) -> None:
    design = make_design(12, 12, 4)
    spread, short, rows = (
        plan_cuts(design, options=replace(STRAIGHT, order=order))
        for order in (CutOrder.SPREAD, CutOrder.SHORTEST, CutOrder.ROWS)
    )
    pitch = 100.0 / 12
    assert np.mean(clearances(spread) > 0.9 * HEAT_REACH * pitch) > 0.9
    assert np.mean(clearances(short) > 0.9 * HEAT_REACH * pitch) < 0.2
    shuffled = np.random.default_rng(0).permutation(len(spread.paths))
    assert rows.travel_mm < spread.travel_mm < 0.5 * travel([spread.paths[index] for index in shuffled])


def test_that_several_paths_of_one_slit_are_cut_along_the_row_to_and_fro() -> None:
    table = cut_table(3, 3)
    paths = [
        CutPath(np.array([[x + shift, y], [x + shift + 2.0, y]]), Layer.SLITS, False, 3 * (2 - row) + column)
        for row, y in enumerate((5.0, 15.0, 25.0))
        for column, x in enumerate((2.0, 12.0, 22.0))
        for shift in (4.0, 0.0)
    ]
    ordered = in_cutting_order(paths, CutOrder.ROWS, table)
    forth = [2.0, 6.0, 12.0, 16.0, 22.0, 26.0]
    expected = [(x, y) for y, row in ((5.0, forth), (15.0, forth[::-1]), (25.0, forth)) for x in row]
    assert [(path.points[:, 0].min(), path.points[0, 1]) for path in ordered] == expected
