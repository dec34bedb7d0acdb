"""Nonsense is refused where it enters, in one sentence with the numbers in it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from kirigami_studio.foundation.errors import AngleError, GridError, RatioError, UsageError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField, check_grid
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.topology import topology
from tests.refusals import refused


def one_wrong(value: float) -> np.ndarray:
    table = np.ones((3, 4))
    table[1, 2] = value
    return table


@pytest.mark.parametrize(
    ("ratio", "said"),
    [
        (one_wrong(math.nan), r"void \(1, 2\) is nan"),
        (one_wrong(math.inf), r"void \(1, 2\) is inf"),
        (one_wrong(0.0), r"void \(1, 2\) is 0"),
        (one_wrong(-2.5), r"void \(1, 2\) is -2.5"),
        (one_wrong(1e7), r"void \(1, 2\) is 1e\+07; .* 1e-06 to 1e\+06"),
        (one_wrong(1e-7), r"void \(1, 2\) is 1e-07"),
        ([["1", "2"], ["1", "1"]], "table of numbers"),
        (np.ones((3, 3), dtype=bool), "table of numbers"),
        (np.ones(100), r"\(100,\)"),
        (np.ones((2, 3, 4)), r"\(2, 3, 4\)"),
        (np.float64(1.0), r"\(\)"),
        ([[1.0, 2.0], [3.0]], "table of numbers"),
        ([["a", "b"], ["c", "d"]], "table of numbers"),
        (None, "Ratio"),
        ([], r"\(0,\)"),
        (np.ones((2, 2)) * 1j, "table of numbers"),
        ([[10**400, 1], [1, 1]], "table of numbers"),
        ({"ratio": 1}, "table of numbers"),
    ],
)
def test_that_a_bad_ratio_table_is_refused(ratio: object, said: str) -> None:
    with pytest.raises(RatioError, match=said):
        RatioField(ratio)  # type: ignore[arg-type]


@pytest.mark.parametrize("shape", [(1, 5), (5, 1), (65, 5), (5, 65), (0, 3)])
def test_that_a_grid_outside_2_to_64_is_refused_with_both_numbers(shape: tuple[int, int]) -> None:
    for attempt in (
        lambda: RatioField(np.ones(shape)),
        lambda: RatioField.uniform(*shape),
        lambda: topology(*shape),
        lambda: check_grid(*shape),
    ):
        with pytest.raises(GridError, match=f"{shape[0]} x {shape[1]}"):
            attempt()


@pytest.mark.parametrize("grid", [(2.5, 3), (3.0, 3), ("3", 3), (None, 3), (math.nan, 3), (True, 3)])
def test_that_a_grid_of_anything_but_whole_numbers_is_refused(grid: tuple[object, object]) -> None:
    with pytest.raises(GridError):
        check_grid(*grid)  # type: ignore[arg-type]
    with pytest.raises(GridError):
        RatioField.uniform(*grid)  # type: ignore[arg-type]


@pytest.mark.parametrize("phi", [-1e-9, 3.2, math.nan, math.inf, "wide", None, 1j])
def test_that_an_impossible_angle_is_refused_by_every_view_of_the_motion(phi: object) -> None:
    design = deploy(RatioField.uniform(3, 3))
    for view in (design.nodes, design.voids, design.panels, design.outline, design.area):
        with pytest.raises(AngleError, match="deployment angle"):
            view(phi)  # type: ignore[arg-type]


@pytest.mark.parametrize("z", [[[400.0, 0], [0, 0]], [[-400.0, 0], [0, 0]], [[math.nan, 0], [0, 0]]])
def test_that_exponents_beyond_the_numbers_are_refused(z: list[list[float]]) -> None:
    with pytest.raises(RatioError, match=r"void \(0, 0\)"):
        RatioField.from_log10(z)


@pytest.mark.parametrize("z", [[["a", 0], [0, 0]], [[0, 0], [0]], None])
def test_that_exponents_that_are_no_table_are_refused(z: object) -> None:
    with pytest.raises(RatioError):
        RatioField.from_log10(z)  # type: ignore[arg-type]


@pytest.mark.parametrize("cell", [(0.0, 1.0), (1.0, -1.0), (math.nan, 1.0), (1.0,), ("wide", 1.0)])
def test_that_an_impossible_cell_is_refused(cell: tuple[float, ...]) -> None:
    with refused(UsageError, "cell.not_positive"):
        Sheet(RatioField.uniform(3, 3), cell=cell)  # type: ignore[arg-type]


@pytest.mark.parametrize("exponent", [-6.0, 6.0])
def test_that_ratios_at_the_end_of_their_range_still_give_finite_sheets(exponent: float) -> None:
    z = np.zeros((4, 4))
    z[1, 1], z[2, 2] = exponent, -exponent
    assert np.isfinite(deploy(RatioField.from_log10(z)).nodes(0.3)).all()
