"""The batched decoder in torch against the exact one: same layouts, true gradients."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Rim, Sheet, rim_table
from kirigami_studio.lattice.topology import topology
from tests.refusals import refused

pytestmark = pytest.mark.torch
torch = pytest.importorskip("torch")
batched = pytest.importorskip("kirigami_studio.lattice.batched")


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    """Blocks of a few numbers: a second thread only waits."""
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(before)


GRIDS = [(2, 2), (2, 7), (7, 2), (3, 5), (6, 6), (10, 10), (8, 11)]


def random_ratios(grid: tuple[int, int], count: int, decades: float = 1.0) -> np.ndarray:
    rng = np.random.default_rng(grid[0] * 100 + grid[1])
    return 10 ** rng.uniform(-decades, decades, (count, *grid))


@pytest.mark.parametrize("grid", GRIDS, ids=lambda grid: f"{grid[0]}x{grid[1]}")
def test_that_double_precision_gives_the_exact_sheet(grid: tuple[int, int]) -> None:
    ratios = random_ratios(grid, 5, decades=2.0)
    nodes = batched.BatchedLattice(*grid, dtype=torch.float64).compact(torch.tensor(ratios)).numpy()
    for ratio, ours in zip(ratios, nodes, strict=True):
        assert np.abs(ours - deploy(RatioField(ratio)).compact).max() < 1e-10


def random_offsets(grid: tuple[int, int], count: int) -> np.ndarray:
    """Mouths moved by up to 0.45 cells: their order stays."""
    return np.random.default_rng(grid[0]).uniform(-0.45, 0.45, (count, rim_table(*grid).even.size))


@pytest.mark.parametrize("grid", GRIDS, ids=lambda grid: f"{grid[0]}x{grid[1]}")
def test_that_free_rims_give_the_exact_sheet_and_outline(grid: tuple[int, int]) -> None:
    ratios, offsets = random_ratios(grid, 5), random_offsets(grid, 5)
    lattice = batched.BatchedLattice(*grid, dtype=torch.float64)
    given = torch.tensor(ratios), torch.tensor(offsets)
    nodes, outlines = lattice.compact(*given).numpy(), lattice.outline(given[0], 0.4, given[1]).numpy()
    for ratio, moved, ours, outline in zip(ratios, offsets, nodes, outlines, strict=True):
        design = deploy(Sheet(RatioField(ratio), Rim.moved(*grid, moved)))
        assert np.abs(ours - design.compact).max() < 1e-9
        assert np.abs(outline - design.outline(0.4)).max() < 1e-9


def test_that_offsets_of_nothing_are_the_even_rim() -> None:
    ratios = torch.tensor(random_ratios((5, 6), 3))
    lattice = batched.BatchedLattice(5, 6, dtype=torch.float64)
    assert torch.equal(lattice.compact(ratios, torch.zeros(3, lattice.mouths)), lattice.compact(ratios))


def test_that_gradients_reach_the_offsets() -> None:
    lattice = batched.BatchedLattice(3, 4, dtype=torch.float64)
    ratios, offsets = torch.tensor(random_ratios((3, 4), 2)), torch.tensor(random_offsets((3, 4), 2))
    given = ratios.requires_grad_(True), offsets.requires_grad_(True)
    assert torch.autograd.gradcheck(lambda x, moved: lattice.outline(x, 0.3, moved), given, eps=1e-6, atol=1e-6)


@pytest.mark.parametrize("shape", [(9,), (2, 9), (1, 10, 1)])
def test_that_offsets_of_another_shape_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(KirigamiError) as caught:
        batched.BatchedLattice(5, 5).compact(torch.ones(2, 5, 5), torch.zeros(shape))
    assert caught.value.code == "rim.wrong_batch_shape"


@pytest.mark.parametrize("grid", [(6, 6), (10, 10), (7, 12)], ids=lambda grid: f"{grid[0]}x{grid[1]}")
def test_that_single_precision_stays_within_1e_4_cells(grid: tuple[int, int]) -> None:
    ratios = random_ratios(grid, 20)
    outlines = batched.BatchedLattice(*grid).outline(torch.tensor(ratios), 0.4).numpy()
    assert outlines.dtype == np.float32
    for ratio, ours in zip(ratios, outlines, strict=True):
        assert np.abs(ours - deploy(RatioField(ratio)).outline(0.4)).max() < 1e-4


@pytest.mark.parametrize("grid", GRIDS, ids=lambda grid: f"{grid[0]}x{grid[1]}")
def test_that_outlines_equal_the_exact_ones_at_one_angle_per_design(grid: tuple[int, int]) -> None:
    ratios = random_ratios(grid, 4)
    angles = [0.5, 1.0, 2.5, math.pi]
    lattice = batched.BatchedLattice(*grid, dtype=torch.float64)
    outlines = lattice.outline(torch.tensor(ratios), torch.tensor(angles, dtype=torch.float64)).numpy()
    for ratio, phi, ours in zip(ratios, angles, outlines, strict=True):
        assert np.abs(ours - deploy(RatioField(ratio)).outline(phi)).max() < 1e-10


def test_that_the_unzipped_vertices_make_the_outline_at_phi_zero() -> None:
    ratios = random_ratios((5, 6), 3)
    lattice = batched.BatchedLattice(5, 6, dtype=torch.float64)
    outlines = lattice.outline(torch.tensor(ratios), 0.0)[:, lattice.unzipped].numpy()
    for ratio, ours in zip(ratios, outlines, strict=True):
        assert np.abs(ours - deploy(RatioField(ratio)).outline(0.0)).max() < 1e-10


def test_that_a_design_does_not_depend_on_its_neighbours_in_the_batch() -> None:
    ratios = torch.tensor(random_ratios((6, 5), 8))
    lattice = batched.BatchedLattice(6, 5, dtype=torch.float64)
    together = lattice.outline(ratios, 0.7)
    alone = torch.cat([lattice.outline(ratios[k : k + 1], 0.7) for k in range(8)])
    assert torch.allclose(together, alone, rtol=0, atol=1e-12)


@pytest.mark.parametrize("grid", [(2, 3), (4, 4)])
def test_that_gradients_are_those_of_finite_differences(grid: tuple[int, int]) -> None:
    lattice = batched.BatchedLattice(*grid, dtype=torch.float64)
    z = torch.tensor(np.log10(random_ratios(grid, 2)), requires_grad=True)
    assert torch.autograd.gradcheck(lambda value: lattice.outline(10.0**value, 0.3), (z,), eps=1e-6, atol=1e-6)


def test_that_parts_of_the_outline_serve_every_angle() -> None:
    ratios = torch.tensor(random_ratios((4, 5), 3))
    lattice = batched.BatchedLattice(4, 5, dtype=torch.float64)
    even, odd = lattice.outline_parts(lattice.compact(ratios))
    for phi in (0.0, 1.1, math.pi):
        assert torch.allclose(batched.deployed(even, odd, phi), lattice.outline(ratios, phi), rtol=0, atol=1e-13)


def test_that_a_large_grid_decodes_to_the_exact_sheet() -> None:
    ratios = random_ratios((32, 30), 1)
    lattice = batched.BatchedLattice(32, 30, dtype=torch.float64)
    exact = deploy(RatioField(ratios[0]))
    nodes = lattice.compact(torch.tensor(ratios))[0].numpy()
    assert nodes.shape == (topology(32, 30).node_count, 2)
    assert np.abs(nodes - exact.compact).max() < 1e-9


@pytest.mark.parametrize("shape", [(4, 5), (1, 5, 4), (1, 4, 5, 1)])
def test_that_ratios_of_another_shape_are_refused(shape: tuple[int, ...]) -> None:
    with refused(KirigamiError, "ratios.wrong_batch_shape", columns=5, rows=4):
        batched.BatchedLattice(4, 5).compact(torch.ones(shape))
