"""Which candidates are one design, and in which order they are fitted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from uneven_sheets import uneven_sheet

from kirigami_studio.evaluate.alignment import align
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.evaluate.siou import exact_iou
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Rim, Sheet, rim_table
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline.variety import (
    ALIKE,
    DUPLICATE,
    SAME_LOOK,
    distances,
    distinct,
    look_alikes,
    turns,
    worth_a_fit,
)


def random_field(seed: int, rows: int = 6, columns: int = 6) -> RatioField:
    return RatioField.from_log10(np.random.default_rng(seed).uniform(-0.6, 0.6, (rows, columns)))


def sheet_of(state: FloatArray, rows: int, columns: int) -> Sheet:
    """The sheet with these z and offsets of mouths."""
    z, offsets = state[: rows * columns].reshape(rows, columns), state[rows * columns :]
    return Sheet(RatioField.from_log10(z), Rim.moved(rows, columns, offsets))


def images_of(field: RatioField) -> list[FloatArray]:
    """z of the same sheet in all its turned positions, by hand."""
    z = field.log10
    if sum(z.shape) % 2:
        return [z]
    quarters = range(4) if field.rows == field.columns and field.rows % 2 == 0 else (0, 2)
    return [np.rot90(z, quarter) * (-1.0) ** quarter for quarter in quarters]


@pytest.fixture(scope="module")
def candidate() -> Callable[[RatioField, float, int], Candidate]:
    target = load("heart")

    def made(field: RatioField, siou: float, index: int) -> Candidate:
        score = evaluate(deploy(field), target)
        return Candidate(Sheet(field), replace(score, siou=siou, iou_exact=siou, feasible=True), 0, index)

    return made


@pytest.mark.parametrize("phi", [0.0, 0.7])
@pytest.mark.parametrize(("grid", "count"), [((6, 6), 4), ((6, 8), 2), ((5, 7), 2), ((7, 7), 2), ((5, 6), 1)])
@pytest.mark.parametrize("uneven", [False, True])
def test_that_every_turn_is_the_same_sheet(uneven: bool, grid: tuple[int, int], count: int, phi: float) -> None:
    sheet = uneven_sheet(*grid, seed=1) if uneven else Sheet(random_field(1, *grid))
    still = deploy(sheet).outline(phi)
    target = Outline.from_points(still)
    ways = turns(sheet)
    assert len(ways) == count
    for z in ways:
        outline = deploy(sheet_of(z, *grid)).outline(phi)
        assert exact_iou(align(outline, target.points).apply(outline), target) == pytest.approx(1.0, abs=1e-6)


def test_that_edge_hinges_tell_sheets_apart_and_turn_with_them() -> None:
    sheet = uneven_sheet(5, 5, seed=1)
    hinges = np.random.default_rng(3).uniform(-0.4, 0.4, rim_table(5, 5).hinges.size)
    moved = Sheet(sheet.field, Rim(*sheet.rim.sides, hinges))
    turned = turns(moved, hinges=True)[1]
    mouths = 25 + sheet.rim.positions.size
    half = Sheet(RatioField.from_log10(turned[:25].reshape(5, 5)), Rim.moved(5, 5, turned[25:mouths], turned[mouths:]))
    apart = distances(moved, [moved, sheet, half])
    assert apart[[0, 2]] == pytest.approx(0.0, abs=1e-9) and apart[1] > DUPLICATE
    still = deploy(moved).outline(1.0)
    outline, target = deploy(half).outline(1.0), Outline.from_points(still)
    assert exact_iou(align(outline, target.points).apply(outline), target) == pytest.approx(1.0, abs=1e-6)


def test_that_the_distance_is_the_smallest_over_the_turns() -> None:
    field, other = random_field(1), random_field(2)
    by_hand = min(np.sqrt(np.mean((z - other.log10) ** 2)) for z in images_of(field))
    assert distances(field, [other, field]) == pytest.approx([by_hand, 0.0], abs=1e-15)
    assert by_hand < np.sqrt(np.mean((field.log10 - other.log10) ** 2))


def test_that_of_duplicates_only_the_best_is_fitted(candidate: Callable[..., Candidate]) -> None:
    field = random_field(1)
    turned = RatioField.from_log10(-np.rot90(field.log10) + 0.5 * DUPLICATE)
    worse, better, other = candidate(field, 0.8, 0), candidate(turned, 0.9, 1), candidate(random_field(2), 0.7, 2)
    assert worth_a_fit([worse, better, other]) == (better, other)


def test_that_a_design_like_a_better_one_waits_for_the_others(candidate: Callable[..., Candidate]) -> None:
    field = random_field(1)
    alike = RatioField.from_log10(field.log10 + 0.5 * ALIKE)
    best, second, third = candidate(field, 0.9, 0), candidate(alike, 0.8, 1), candidate(random_field(2), 0.7, 2)
    assert worth_a_fit([third, second, best]) == (best, third, second)


@pytest.mark.parametrize("grid", [(6, 6), (6, 8), (5, 6)])
def test_that_distinct_designs_are_those_that_one_by_one_comparison_finds(
    candidate: Callable[[RatioField, float, int], Candidate], grid: tuple[int, int]
) -> None:
    old = [random_field(seed, *grid) for seed in range(3)]
    new = [random_field(seed, *grid) for seed in range(10, 14)]
    moved = [RatioField.from_log10(field.log10 + shift) for field in (old[1], new[0]) for shift in (0.019, 0.021)]
    turned = [RatioField.from_log10(images_of(field)[-1] + 0.001) for field in (old[2], new[1])]
    others = [candidate(field, 0.9, number) for number, field in enumerate(old)]
    found = [candidate(field, 0.8, number) for number, field in enumerate([*new, *moved, *turned, *old])]
    expected: list[Candidate] = []
    for one in found:
        if distances(one.sheet.field, [other.sheet.field for other in (*others, *expected)]).min() >= DUPLICATE:
            expected.append(one)
    assert distinct(found, others) == tuple(expected)
    assert len(expected) == 6 and distinct([], others) == ()
    assert distinct(found[:4], []) == tuple(found[:4])


@pytest.mark.parametrize("grid", [(6, 6), (5, 6), (5, 7)])
def test_that_sheets_that_differ_in_rim_start_or_cell_are_designs_of_their_own(grid: tuple[int, int]) -> None:
    score = evaluate(deploy(RatioField.uniform(*grid)), load("heart"))
    plain, moved = Sheet(random_field(3, *grid)), uneven_sheet(*grid, seed=3)
    field, circle = plain.field, uneven_sheet(*grid, start=True).start
    turned = sheet_of(turns(Sheet(field, moved.rim))[-1], *grid)
    sheets = [plain, Sheet(field, moved.rim), Sheet(field, None, circle), Sheet(field, cell=(1.0, 1.5)), turned]
    found = [Candidate(sheet, replace(score, siou=0.9 - 0.1 * place), 0, place) for place, sheet in enumerate(sheets)]
    assert distinct(found, []) == tuple(found[:4]), "the last is the second, turned"
    assert distinct(found, found[1:2]) == (found[0], found[2], found[3])
    assert {one.index for one in worth_a_fit(found)} == {0, 1, 2, 3}
    assert distances(plain, sheets)[[0, 2, 3]].tolist() == [0.0, np.inf, np.inf]
    assert distances(turned, sheets[1:2])[0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("grid", [(6, 6), (5, 6), (5, 7)])
def test_that_turned_mirrored_and_near_sheets_are_one_group(
    candidate: Callable[[RatioField, float, int], Candidate], grid: tuple[int, int]
) -> None:
    field = random_field(1, *grid)
    near = RatioField.from_log10(field.log10 + 0.5 * SAME_LOOK)
    images = [
        RatioField.from_log10(image)
        for symmetry in Symmetry
        if symmetry.fits(*grid)
        for image in symmetry.images(field.log10)
    ]
    alike = [candidate(one, 0.8 + 0.01 * number, number) for number, one in enumerate([field, near, *images])]
    other = candidate(random_field(2, *grid), 0.95, 50)
    groups = look_alikes([*alike, other])
    assert groups == (*[1] * len(alike), 0)
    assert look_alikes([]) == ()


def test_that_another_rim_or_grid_is_another_look(candidate: Callable[[RatioField, float, int], Candidate]) -> None:
    plain = candidate(RatioField.uniform(6, 6), 0.9, 0)
    rim = Rim.moved(6, 6, np.full(rim_table(6, 6).even.size, 0.5))
    moved = replace(plain, sheet=Sheet(RatioField.uniform(6, 6), rim), index=1)
    larger = candidate(RatioField.uniform(6, 8), 0.9, 2)
    assert len(set(look_alikes([plain, moved, larger]))) == 3
