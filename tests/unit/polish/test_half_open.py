"""Fits of sheets that show their target half open: edge hinges leave the middle, and narrow notches match more."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from kirigami_studio.evaluate.feasibility import path_contact
from kirigami_studio.evaluate.siou import exact_iou
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.sheet import HINGE_REACH, Sheet, rim_table
from kirigami_studio.lattice.symmetry import Symmetry, symmetry_of
from kirigami_studio.outlines.read import read_target
from kirigami_studio.polish.continuation import FitOptions, Way, fit_from_uniform
from kirigami_studio.polish.levenberg import polish

LITERATURE = Path(__file__).parents[2] / "data" / "literature"
HALF = 0.5 * math.pi


@pytest.mark.parametrize(
    ("name", "published", "angle", "way", "symmetry"),
    [
        ("star", 0.861, math.pi / 6, Way.GUIDED, Symmetry.HALF_TURN),
        ("anvil", 0.910, 2 * math.pi / 3, Way.COOLED, None),
        ("rainbow", 0.917, math.pi / 6, Way.GUIDED, None),
    ],
)
def test_that_sheets_of_36_panels_match_more_than_published_ones_half_open(
    name: str, published: float, angle: float, way: Way, symmetry: Symmetry | None
) -> None:
    target = read_target(str(LITERATURE / f"choi2019_{name}.json"))
    fit = fit_from_uniform(target, (5, 5), HALF, angle, way, FitOptions(free_rim=True), symmetry)
    design = deploy(fit.sheet)
    assert exact_iou(fit.pose.apply(design.outline(HALF)), target) > published + 0.005
    assert path_contact(design, HALF) is None
    assert 0.1 < np.abs(fit.sheet.rim.hinges).max() <= HINGE_REACH
    assert symmetry is None or symmetry_of(fit.sheet) is symmetry


def test_that_fits_to_the_second_state_put_edge_hinges_halfway() -> None:
    target = read_target("heart")
    half = polish(Sheet.uniform(4, 4), target, 1.0, steps=3, free_rim=True).sheet
    assert not half.rim.folds_shut
    for free in (True, False):
        assert polish(half, target, 0.0, steps=2, free_rim=free).sheet.rim.folds_shut


def test_that_edge_hinges_stay_where_the_rim_is_even() -> None:
    fit = polish(Sheet.uniform(4, 4), read_target("heart"), 1.0, steps=3)
    assert fit.sheet.has_even_rim and fit.sheet.rim.hinge_offsets(4, 4).size == rim_table(4, 4).hinges.size
