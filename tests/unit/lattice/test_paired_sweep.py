"""The sweep over paired columns against a dense solve of the whole system."""

from __future__ import annotations

import numpy as np
import pytest

pytestmark = pytest.mark.torch
torch = pytest.importorskip("torch")

from kirigami_studio.lattice.paired_sweep import _pair_tables, paired_sweep, transposed  # noqa: E402

ROWS, WIDTH = 5, 6


def dense_and_weights(first: int, width: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """I - E F - G H of random weights, as one matrix, and the weights (4, m, w)."""
    weights = np.zeros((4, ROWS, width))
    matrix = np.eye(ROWS * width)
    for row in range(ROWS):
        for one in range((first + row) % 2, width - 1, 2):
            pair = np.array([one, one + 1])
            for way, beside in ((0, row - 1), (2, row + 1)):
                if not 0 <= beside < ROWS:
                    continue
                given, of = rng.uniform(0.1, 0.5, 2), rng.uniform(0.1, 0.5, 2)
                weights[way, row, pair], weights[way + 1, row, pair] = given, of
                matrix[np.ix_(row * width + pair, beside * width + pair)] -= np.outer(given, of)
    return matrix, weights


@pytest.mark.parametrize("width", [WIDTH, WIDTH + 1])
@pytest.mark.parametrize("first", [0, 1])
def test_that_it_solves_the_system_and_its_transpose(first: int, width: int) -> None:
    rng = np.random.default_rng(width + first)
    matrices, weights = zip(*(dense_and_weights(first, width, rng) for _ in range(3)), strict=True)
    right = rng.standard_normal((3, ROWS * width, 2))
    coupling = torch.tensor(np.array(weights))
    rows = torch.tensor(right).view(3, ROWS, width, 2)
    for system, found in (
        (np.array(matrices), paired_sweep(coupling, rows, first)),
        (np.array(matrices).transpose(0, 2, 1), paired_sweep(transposed(coupling), rows, 1 - first)),
    ):
        expected = np.linalg.solve(system, right)
        assert np.abs(found.numpy().reshape(expected.shape) - expected).max() < 1e-12


def test_that_gradients_go_through_after_a_call_without_them() -> None:
    _, weights = dense_and_weights(0, WIDTH, np.random.default_rng(0))
    coupling, rows = torch.tensor(weights[None]), torch.ones(1, ROWS, WIDTH, 2, dtype=torch.float64)
    _pair_tables.cache_clear()
    with torch.inference_mode():
        paired_sweep(coupling, rows)
    assert torch.autograd.gradcheck(paired_sweep, (coupling.requires_grad_(), rows.requires_grad_()))
