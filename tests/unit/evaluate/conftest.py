"""Shapes and reference values that several evaluate tests share."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.compact import barycentric_stencil
from kirigami_studio.lattice.deployment import Deployment, even_panel_part
from kirigami_studio.lattice.ratio_field import RatioField, frozen
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.topology import topology

ORACLES = Path(__file__).parents[2] / "data" / "oracles" / "reference_layouts.npz"


@pytest.fixture(scope="session")
def oracles() -> Mapping[str, np.ndarray]:
    """The reference implementation's arrays, packed masks (..., 128, 16) unpacked to (..., 128, 128) bool."""
    with np.load(ORACLES) as archive:
        arrays = {name: archive[name] for name in archive.files}
    return {
        name: np.unpackbits(array, axis=-1).astype(bool) if name.endswith("_mask") else array
        for name, array in arrays.items()
    }


@pytest.fixture
def letter_l() -> FloatArray:
    """A shape without any symmetry."""
    return np.array([(0, 0), (3, 0), (3, 1), (1, 1), (1, 5), (0, 5)], dtype=float)


@pytest.fixture(scope="session")
def colliding() -> Deployment:
    """A sheet cut from a ring of 6 radians instead of a rectangle: its two ends collide on the way."""
    return ring_sector(2, 12, 6.0)


def ring_sector(rows: int, columns: int, opening: float) -> Deployment:
    """A sheet cut from a ring instead of a rectangle: its two ends face each other and collide on the way.

    The boundary anchors lie on the sector, the interior solves the same barycentric system, densely.
    """
    field, tables = RatioField.uniform(rows, columns), topology(rows, columns)
    angle = tables.uniform_nodes[:, 0] / (columns + 1) * opening
    radius = (columns + 1) / opening + tables.uniform_nodes[:, 1] + 0.5 * (rows + 1)
    right = np.column_stack([radius * np.sin(angle), radius * np.cos(angle)])
    node, ends, void = barycentric_stencil(rows, columns)
    x = field.ratio.ravel()[void]
    matrix = np.eye(tables.node_count)
    matrix[node, ends[:, 0]] -= x / (1 + x)
    matrix[node, ends[:, 1]] -= 1 / (1 + x)
    right[node] = 0.0
    nodes = frozen(np.linalg.solve(matrix, right))
    even = frozen(even_panel_part(nodes, tables))
    return Deployment(Sheet(field), nodes, even, frozen(nodes - nodes[0] - even))
