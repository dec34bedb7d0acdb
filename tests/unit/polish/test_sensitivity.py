"""The derivative of the outline against two slow oracles: the deployment itself, and torch's autograd."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.sparse

from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Rim, Sheet, rim_table
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.polish.basis import Basis
from kirigami_studio.polish.factor import factored
from kirigami_studio.polish.sensitivity import OutlineModel

GRIDS = [(2, 2), (3, 4), (5, 5), (6, 3), (10, 10)]
ANGLES = [0.0, 0.4, 2.0]


def random_z(rows: int, columns: int, seed: int = 3) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-1.0, 1.0, rows * columns)


@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("phi", ANGLES)
def test_that_the_outline_is_the_deployments_outline(grid: tuple[int, int], phi: float) -> None:
    z = random_z(*grid)
    expected = deploy(RatioField.from_log10(z.reshape(grid))).outline(phi)
    model = OutlineModel(*grid, phi)
    assert np.abs(model.outline(z) - expected).max() < 1e-10
    assert np.abs(model.linearised(z)[0] - expected).max() < 1e-10


@pytest.mark.torch
@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("phi", ANGLES)
def test_that_the_derivative_is_the_one_of_autograd(grid: tuple[int, int], phi: float) -> None:
    torch = pytest.importorskip("torch")
    from kirigami_studio.lattice.batched import BatchedLattice

    z = random_z(*grid)
    lattice = BatchedLattice(*grid, dtype=torch.float64)

    def outline(flat):  # type: ignore[no-untyped-def]
        loop = lattice.outline(torch.pow(10.0, flat.view(1, *grid)), phi)[0]
        return loop[lattice.unzipped] if phi == 0.0 else loop

    expected = torch.autograd.functional.jacobian(outline, torch.tensor(z), vectorize=True).numpy()
    _, derivative = OutlineModel(*grid, phi).linearised(z)
    assert derivative.shape == expected.shape
    assert np.abs(derivative - expected).max() < 1e-9 * max(1.0, np.abs(expected).max())


def test_that_outlines_near_the_zipped_state_keep_their_edge_hinges() -> None:
    count = OutlineModel(4, 6, 0.0).outline(np.zeros(24)).shape[0]
    assert count == 2 * (4 + 6) + 4
    assert OutlineModel(4, 6, 1e-3).outline(np.zeros(24)).shape[0] == 4 * (4 + 6) + 4


def test_that_extreme_ratios_still_have_a_finite_derivative() -> None:
    z = np.random.default_rng(1).uniform(-3.0, 3.0, 64)
    outline, derivative = OutlineModel(8, 8, math.pi / 7).linearised(z)
    assert np.isfinite(outline).all()
    assert np.isfinite(derivative).all()


def random_shape(grid: tuple[int, int], seed: int = 5) -> np.ndarray:
    draw = np.random.default_rng(seed)
    return np.concatenate([draw.uniform(-1.0, 1.0, grid[0] * grid[1]), draw.uniform(-0.4, 0.4, sum(grid))])


STARTS = [None, [[0, 0], [5, 1], [7, -2], [4, -7], [-1, -4]]]


@pytest.mark.parametrize("grid", [(3, 4), (5, 5), (6, 3)])
@pytest.mark.parametrize("phi", ANGLES)
@pytest.mark.parametrize("start", STARTS, ids=["rectangle", "pentagon"])
def test_that_the_outline_of_a_free_rim_is_the_deployments(
    grid: tuple[int, int], phi: float, start: list[list[float]] | None
) -> None:
    shape, voids = random_shape(grid), grid[0] * grid[1]
    field = RatioField.from_log10(shape[:voids].reshape(grid))
    sheet = Sheet(field, Rim.moved(*grid, shape[voids:]), start, (1.0, 0.8))
    model = OutlineModel.of(sheet, phi, free_rim=True)
    assert np.abs(model.outline(shape) - deploy(sheet).outline(phi)).max() < 1e-10
    assert np.abs(OutlineModel.of(sheet, phi).outline(shape[:voids]) - deploy(sheet).outline(phi)).max() < 1e-10


@pytest.mark.parametrize("grid", [(3, 4), (5, 5), (6, 3)])
@pytest.mark.parametrize("phi", ANGLES)
@pytest.mark.parametrize("start", STARTS, ids=["rectangle", "pentagon"])
def test_that_derivatives_by_ratios_and_mouths_are_central_differences(
    grid: tuple[int, int], phi: float, start: list[list[float]] | None
) -> None:
    model = OutlineModel(*grid, phi, start=None if start is None else np.array(start), cell=(1.0, 0.8), free_rim=True)
    shape, step = random_shape(grid), 1e-6
    steps = step * np.eye(shape.size)
    outline = np.stack([(model.outline(shape + one) - model.outline(shape - one)) / (2 * step) for one in steps], -1)
    nodes = np.stack([(model.nodes(shape + one) - model.nodes(shape - one)) / (2 * step) for one in steps], -1)
    assert np.abs(model.linearised(shape)[1] - outline).max() < 1e-6
    motion, basis = model.node_motion(model.decoded(shape)), Basis.of(shape.size, None)
    assert np.abs(motion.derivative(basis) - np.moveaxis(nodes, 1, 0)).max() < 1e-6
    draw = np.random.default_rng(2)
    for few_or_many in (3, shape.size + 1):
        along = draw.normal(size=(2, few_or_many, model.node_count))
        expected = along[0] @ nodes[:, 0] + along[1] @ nodes[:, 1]
        assert np.abs(motion.slopes(*along, basis) - expected).max() < 1e-5


@pytest.mark.parametrize("grid", [(5, 5), (13, 14)], ids=["dense", "by rows"])
@pytest.mark.parametrize("symmetry", [None, Symmetry.LEFT_RIGHT, Symmetry.TOP_BOTTOM])
def test_that_the_curvature_is_the_product_of_derivatives(grid: tuple[int, int], symmetry: Symmetry | None) -> None:
    if symmetry is not None and not symmetry.fits(*grid):
        symmetry = None
    model = OutlineModel(*grid, 0.0, free_rim=True)
    shape = random_shape(grid)
    basis = Basis.of(shape.size, None if symmetry is None else symmetry.on(*grid))
    motion = model.node_motion(model.decoded(basis.nearest(shape)))
    random = scipy.sparse.random(2 * model.node_count, 2 * model.node_count, 0.01, format="csr", random_state=1)
    stiffness = (random + random.T).tocsr()
    whole = motion.derivative(basis)
    both = np.concatenate(list(whole))
    expected = both.T @ (stiffness @ both)
    np.testing.assert_allclose(motion.curvature(stiffness, basis), expected, atol=1e-9 * np.abs(expected).max())
    some = np.arange(basis.size)[1::3]
    columns = motion.curvature(stiffness, basis, some)
    np.testing.assert_allclose(columns, expected[:, some], atol=1e-9 * np.abs(expected).max())
    force = np.random.default_rng(3).normal(size=(model.node_count, 2))
    gradient = basis.reduced(motion.gradient(force))
    np.testing.assert_allclose(gradient, force[:, 0] @ whole[0] + force[:, 1] @ whole[1], atol=1e-9)


@pytest.mark.parametrize("rows", [4, 20])
@pytest.mark.parametrize("sides", [3, 0])
def test_that_the_system_is_solved_both_ways(rows: int, sides: int) -> None:
    """The dense way and the way row by row against a plain solution of the written-out matrix."""
    draw, width = np.random.default_rng(4), 11
    coupling = draw.uniform(0.0, 0.5 / width, (2, rows, width, width))
    matrix = np.eye(rows * width)
    for i in range(rows):
        own = slice(i * width, (i + 1) * width)
        if i:
            matrix[own, (i - 1) * width : i * width] = -coupling[0, i]
        if i < rows - 1:
            matrix[own, (i + 1) * width : (i + 2) * width] = -coupling[1, i]
    right = draw.normal(size=(rows * width, sides))
    factor = factored(coupling, np.arange(rows * width))
    np.testing.assert_allclose(factor.solve(right), np.linalg.solve(matrix, right), atol=1e-12)
    np.testing.assert_allclose(factor.solve_transposed(right), np.linalg.solve(matrix.T, right), atol=1e-12)


@pytest.mark.parametrize("phi", [0.4, 2.0])
@pytest.mark.parametrize("start", STARTS, ids=["rectangle", "pentagon"])
def test_that_free_edge_hinges_are_those_of_the_deployment_with_their_derivative(
    phi: float, start: list[list[float]] | None
) -> None:
    grid, voids = (4, 5), 20
    hinges = np.random.default_rng(7).uniform(-0.4, 0.4, rim_table(*grid).hinges.size)
    shape, step = np.concatenate([random_shape(grid), hinges]), 1e-6
    rim = Rim.moved(*grid, shape[voids : voids + sum(grid)], hinges)
    sheet = Sheet(RatioField.from_log10(shape[:voids].reshape(grid)), rim, start, (1.0, 0.8))
    model = OutlineModel.of(sheet, phi, free_rim=True, free_hinges=True)
    assert model.size == shape.size
    assert np.abs(model.outline(shape) - deploy(sheet).outline(phi)).max() < 1e-10
    assert np.abs(OutlineModel.of(sheet, phi).outline(shape[:voids]) - deploy(sheet).outline(phi)).max() < 1e-10
    steps = step * np.eye(shape.size)
    outline = np.stack([(model.outline(shape + one) - model.outline(shape - one)) / (2 * step) for one in steps], -1)
    nodes = np.stack([(model.nodes(shape + one) - model.nodes(shape - one)) / (2 * step) for one in steps], -1)
    motion, basis = model.node_motion(model.decoded(shape)), Basis.of(shape.size, None)
    assert np.abs(motion.outline(basis) - outline).max() < 1e-6
    assert np.abs(motion.derivative(basis) - np.moveaxis(nodes, 1, 0)).max() < 1e-6
    force = np.random.default_rng(2).normal(size=(model.node_count, 2))
    assert np.abs(motion.gradient(force) - np.einsum("nd,ndv->v", force, nodes)).max() < 1e-5


def test_that_the_second_state_of_moved_edge_hinges_is_the_deployments() -> None:
    rim = Rim.moved(3, 4, np.zeros(7), np.full(rim_table(3, 4).hinges.size, 0.2))
    sheet = Sheet(RatioField.from_log10(random_z(3, 4).reshape(3, 4)), rim)
    expected = deploy(sheet).outline(0.0)
    assert np.abs(OutlineModel.of(sheet, 0.0).outline(sheet.field.log10.ravel()) - expected).max() < 1e-10
