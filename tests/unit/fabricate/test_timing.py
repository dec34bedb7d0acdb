"""The time model against closed forms."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from shapely.geometry import LineString

from kirigami_studio.fabricate.cut_path import CutPath, Layer
from kirigami_studio.fabricate.cut_plan import plan_cuts
from kirigami_studio.fabricate.material import Material, find_material
from kirigami_studio.fabricate.timing import DOUBT, Edges, cut_times, run_seconds, travel_lengths
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import Deployment

MakeDesign = Callable[..., Deployment]


@pytest.fixture
def machine() -> Material:
    """100 mm/s cutting, 200 mm/s travelling, 1000 mm/s^2, no delays, one pass."""
    return replace(find_material("card-co2"), speed_mm_s=100.0, travel_mm_s=200.0, acceleration_mm_s2=1000.0, passes=1)


def slit(*points: tuple[float, float], bulges: tuple[float, ...] | None = None, closed: bool = False) -> CutPath:
    arcs = None if bulges is None else np.array(bulges)
    return CutPath(np.array(points), Layer.SLITS, closed, 0, arcs)


def runs_of(path: CutPath, flowing_turn: float) -> FloatArray:
    """The runs of one path."""
    return Edges.of([path]).runs(flowing_turn)[1]


def test_that_a_short_run_never_reaches_the_speed() -> None:
    seconds = run_seconds(np.array([1.0, 100.0, 1000.0]), 100.0, 1000.0)
    np.testing.assert_allclose(seconds, [2.0 * np.sqrt(1.0 / 1000.0), 1.0 + 0.1 - 0.0, 10.0 + 0.1])
    assert run_seconds(np.array([10.0]), 100.0, 1000.0)[0] == pytest.approx(0.2)


def test_that_cut_travel_and_extra_follow_their_formulas(machine: Material) -> None:
    machine = replace(machine, on_delay_s=0.3, off_delay_s=0.2)
    times = cut_times([slit((30.0, 40.0), (130.0, 40.0)), slit((130.0, 41.0), (130.0, 42.0))], machine)
    assert times.cut == pytest.approx((1.0 + 0.1) + 2.0 * math.sqrt(1.0 / 1000.0))
    assert times.travel == pytest.approx((50.0 / 200.0 + 0.2) + 2.0 * math.sqrt(1.0 / 1000.0))
    assert times.extra == pytest.approx(2 * 0.5)
    assert times.total == pytest.approx(times.cut + times.travel + times.extra)


def test_that_passes_repeat_everything(machine: Material) -> None:
    paths = [slit((1.0, 1.0), (9.0, 1.0)), slit((2.0, 3.0), (2.0, 8.0))]
    machine = replace(machine, on_delay_s=0.1)
    once, thrice = cut_times(paths, machine), cut_times(paths, replace(machine, passes=3))
    for name in ("cut", "travel", "extra", "total", "low", "high"):
        assert getattr(thrice, name) == pytest.approx(3.0 * getattr(once, name))


def test_that_the_range_of_a_straight_cut_comes_from_the_acceleration_alone(machine: Material) -> None:
    times = cut_times([slit((0.0, 0.0), (100.0, 0.0))], machine)
    assert times.low == pytest.approx(1.0 + 100.0 / (1000.0 * DOUBT))
    assert times.high == pytest.approx(1.0 + 100.0 / (1000.0 / DOUBT))
    assert times.low < times.total < times.high


def test_that_the_slow_end_stops_at_every_vertex_and_the_fast_end_only_at_sharp_ones(machine: Material) -> None:
    turn = math.radians(30.0)
    corner, end = (50.0, 0.0), (50.0 + 50.0 * math.cos(turn), 50.0 * math.sin(turn))
    bent = slit((0.0, 0.0), corner, end)
    np.testing.assert_allclose(runs_of(bent, math.radians(45.0)), [100.0])
    np.testing.assert_allclose(runs_of(bent, math.radians(10.0)), [50.0, 50.0])
    times = cut_times([bent], machine)
    assert times.low == pytest.approx(1.0 + 0.1 / DOUBT)
    assert times.cut == pytest.approx(2 * (0.5 + 0.1))
    assert times.high == pytest.approx(2 * (0.5 + 0.1 * DOUBT))
    square = slit((0.0, 0.0), (50.0, 0.0), (50.0, 50.0))
    assert len(runs_of(square, math.radians(45.0))) == 2


def test_that_an_arc_is_one_run_as_long_as_the_arc() -> None:
    circle = slit((-2.0, 0.0), (2.0, 0.0), bulges=(1.0, 1.0), closed=True)
    np.testing.assert_allclose(runs_of(circle, 1e-6), [4.0 * math.pi])
    quarter = math.tan(math.radians(90.0) / 4.0)
    # Straight on, a quarter circle to the left of radius 3, straight on: smooth; the same to the right has two corners.
    for bulge, runs in ((quarter, 1), (-quarter, 3)):
        hook = slit((-5.0, 0.0), (0.0, 0.0), (3.0, 3.0), (3.0, 9.0), bulges=(0.0, bulge, 0.0, 0.0))
        found = runs_of(hook, math.radians(10.0))
        assert len(found) == runs
        assert found.sum() == pytest.approx(5.0 + 1.5 * math.pi + 6.0)
        assert found.sum() == pytest.approx(hook.length, rel=1e-3)


def test_that_the_runs_of_a_job_are_those_of_its_paths_one_after_the_other() -> None:
    bent = slit((0.0, 0.0), (4.0, 0.0), (4.0, 3.0))
    ring = slit((-2.0, 0.0), (2.0, 0.0), bulges=(1.0, 1.0), closed=True)
    on = slit((4.0, 3.0), (9.0, 3.0))
    path, lengths = Edges.of([bent, ring, on]).runs(math.radians(10.0))
    assert path.tolist() == [0, 0, 1, 2]
    np.testing.assert_allclose(lengths, [4.0, 3.0, 4.0 * math.pi, 5.0])


def test_that_travel_goes_from_the_end_of_one_cut_to_the_start_of_the_next() -> None:
    ring = slit((3.0, 4.0), (6.0, 4.0), (6.0, 8.0), closed=True)
    after = slit((3.0, 5.0), (9.0, 5.0))
    np.testing.assert_allclose(travel_lengths([ring, after, ring]), [5.0, 1.0, math.hypot(6.0, 1.0)])
    assert travel_lengths([]).tolist() == []


def test_that_nothing_to_cut_takes_no_time(machine: Material) -> None:
    times = cut_times([], machine)
    assert (times.total, times.low, times.high) == (0.0, 0.0, 0.0)


def test_that_the_times_of_a_plan_add_up(make_design: MakeDesign) -> None:
    material = find_material("drag-knife")
    plan = plan_cuts(make_design(5, 5), 150.0, material=material)
    assert plan.seconds_estimate == plan.times.total
    assert plan.times.low < plan.times.total < plan.times.high
    assert plan.times.extra == pytest.approx(len(plan.paths) * 0.2)
    # By hand, with a stop at every vertex: no corner of a plan is blunt enough to be taken without one.
    edges = np.concatenate([np.hypot(*np.diff(LineString(path.travelled).coords, axis=0).T) for path in plan.paths])
    assert plan.times.cut == pytest.approx(run_seconds(edges, 75.0, 1000.0).sum())
