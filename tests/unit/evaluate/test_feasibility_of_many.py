"""Many designs checked at once, against the checks of one design at a time."""

from __future__ import annotations

import math

import numpy as np
import pytest
from uneven_sheets import uneven_sheet

from kirigami_studio.evaluate.crossing import deepest_crossing, stays_clear
from kirigami_studio.evaluate.feasibility import (
    Feasibility,
    feasibility_of_many,
    invalid_quads,
    overlap_ratio,
    path_contact,
)
from kirigami_studio.foundation.arrays import ComplexArray
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet

SAMPLES = 32


def one_by_one(sheet: Deployment, phi: float) -> Feasibility:
    return Feasibility(invalid_quads(sheet, phi), overlap_ratio(sheet, phi), path_contact(sheet, phi))


def random_linkage(draw: np.random.Generator, edges: int) -> tuple[ComplexArray, ComplexArray]:
    """U and V of a closed chain of rigid edges, each of which turns with one family or the other."""
    even = np.roll(np.repeat([True, False], edges // 2), draw.integers(edges))
    if draw.random() < 0.5:
        even = draw.permutation(even)
    vector = draw.normal(size=edges) + 1j * draw.normal(size=edges)
    # A rounded loop to begin with, so that chains without any crossing come up too.
    vector = draw.uniform(0.1, 1.3) * vector + 2.0 * np.exp(2j * np.pi * np.arange(edges) / edges)
    parts = []
    for family in (even, ~even):
        steps = np.where(family, vector, 0.0)
        steps[family] -= steps[family].mean()
        parts.append(np.concatenate([[0.0], np.cumsum(steps)[:-1]]))
    return parts[0], parts[1]


@pytest.mark.parametrize("phi", [0.0, 0.6, 2.0, math.pi])
def test_that_a_linkage_is_clear_when_no_sampled_angle_shows_a_crossing(phi: float) -> None:
    draw = np.random.default_rng(7)
    chains = [random_linkage(draw, 8) for _ in range(150)]
    even, odd = (np.stack(part) for part in zip(*chains, strict=True))
    theta = (math.pi - phi) * np.arange(1, SAMPLES + 1) / SAMPLES
    seen = [
        all(deepest_crossing(u + turn * v) is None for turn in np.exp(1j * theta))
        for u, v in zip(even, odd, strict=True)
    ]
    assert stays_clear(even, odd, phi, SAMPLES).tolist() == seen
    assert 3 <= sum(seen) <= 147, "both answers must come up"


@pytest.mark.parametrize("phi", [0.0, 0.4, 1.7, math.pi])
@pytest.mark.parametrize("grid", [(6, 6), (5, 8)])
def test_that_a_batch_is_checked_as_its_members_are(grid: tuple[int, int], phi: float) -> None:
    draw = np.random.default_rng(3)
    sheets = [deploy(RatioField.from_log10(draw.uniform(-3, 3, grid))) for _ in range(6)]
    assert feasibility_of_many(sheets, phi) == [one_by_one(sheet, phi) for sheet in sheets]


@pytest.mark.parametrize("phi", [0.0, 0.4, 1.7, math.pi])
@pytest.mark.parametrize("start", [False, True])
def test_that_sheets_with_uneven_rims_are_checked_alike_in_a_batch_whatever_their_size(start: bool, phi: float) -> None:
    sheets = [uneven_sheet(6, 7, seed, decades=2.0, start=start) for seed in range(4)]
    large = [Sheet(sheet.field, sheet.rim, sheet.start, (0.1, 15.0)) for sheet in sheets]
    designs = [deploy(sheet) for sheet in (*sheets, *large)]
    assert feasibility_of_many(designs, phi) == [one_by_one(design, phi) for design in designs]


@pytest.mark.parametrize("part", [1.5, 1.01, 0.99, 0.3])
def test_that_a_colliding_sheet_among_sound_ones_is_found(colliding: Deployment, part: float) -> None:
    contact = path_contact(colliding, 0.0)
    assert contact is not None
    phi = part * contact.phi
    sound = deploy(RatioField.uniform(colliding.field.rows, colliding.field.columns))
    found = feasibility_of_many([sound, colliding, sound], phi)
    assert found == [one_by_one(sheet, phi) for sheet in (sound, colliding, sound)]
    assert [one.feasible for one in found] == [True, part > 1.0, True]
