"""Shapes that pass each other: the same as by brute force, with few looks."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from pinned_assemblies import small_assembly
from shapely import affinity
from shapely.geometry import Polygon

from kirigami_studio.assembly.passing import passing


def brute(shapes: list[Polygon], poses: np.ndarray) -> dict[int, float]:
    """Shared area, mm2, at every pose where some is."""
    found: dict[int, float] = {}
    for number, pose in enumerate(poses):
        placed = [
            affinity.translate(affinity.rotate(shape, turn, (0, 0), use_radians=True), x, y)
            for shape, (x, y, turn) in zip(shapes, pose, strict=True)
        ]
        one, other = np.triu_indices(len(placed), 1)
        at = np.array(placed, dtype=object)
        total = float(shapely.area(shapely.intersection(at[one], at[other])).sum())
        if total > 0.0:
            found[number] = total
    return found


@pytest.mark.parametrize("seed", range(6))
def test_that_no_overlap_of_shapes_on_any_way_is_left_out(seed: int) -> None:
    random = np.random.default_rng(seed)
    count, angles = 7, 40
    shapes = [
        affinity.translate(affinity.rotate(Polygon(random.uniform(0.5, 3.0) * np.array(
            [(0.0, 0.0), (4.0, 0.0), (4.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0)]
        )), random.uniform(0.0, 360.0)), *random.uniform(-2.0, 2.0, 2))
        for _ in range(count)
    ]  # fmt: skip
    way = np.linspace(0.0, 1.0, angles)[:, None, None]
    start, end = random.uniform(-15.0, 15.0, (2, count, 3))
    poses = start + way * (end - start)
    poses[..., 2] *= 0.2
    poses[17, 2] = poses[17, 3]  # a jump
    found = passing(shapes, poses)
    wanted = brute(shapes, poses)
    assert {one.pose: pytest.approx(one.area_mm2, abs=1e-9) for one in found.overlaps} == wanted
    assert 17 in wanted


def test_that_pieces_that_keep_apart_are_looked_at_at_few_of_their_poses() -> None:
    assembly = small_assembly(6, 6, 1)
    poses = np.array([assembly.poses(phi) for phi in np.linspace(math.pi, 0.0, 181)])
    layer = np.array([piece.layer for piece in assembly.pieces])
    for number in (1, 2):
        bodies = [Polygon(piece.outline) for piece in assembly.pieces if piece.layer == number]
        found = passing(bodies, poses[:, layer == number])
        pairs = len(bodies) * (len(bodies) - 1) // 2
        assert not found.overlaps
        assert found.looks < 0.02 * pairs * len(poses), "pairs are compared where they may touch, not at every angle"
