"""The lattice's exact symmetries, found in targets and kept by fits."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.siou import exact_iou
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError, UsageError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.outlines.symmetry import symmetry_of
from kirigami_studio.polish.continuation import fit_shape
from kirigami_studio.polish.levenberg import polish
from kirigami_studio.polish.symmetry import (
    shared_symmetries,
    symmetric_poses,
    symmetric_target,
)


def outline_of(z: FloatArray, phi: float) -> Outline:
    return Outline.from_points(deploy(RatioField.from_log10(z)).outline(phi))


def moved(outline: Outline, angle: float, flipped: bool) -> FloatArray:
    """The outline mirrored at the x axis if asked, then turned."""
    points = outline.points * (1.0, -1.0) if flipped else outline.points
    c, s = math.cos(angle), math.sin(angle)
    turned: FloatArray = points @ np.array([[c, s], [-s, c]])
    return turned


@pytest.mark.parametrize(
    ("symmetry", "grid", "angle", "flipped"),
    [
        (Symmetry.LEFT_RIGHT, (4, 5), math.pi, True),
        (Symmetry.LEFT_RIGHT, (5, 7), math.pi, True),
        (Symmetry.TOP_BOTTOM, (5, 4), 0.0, True),
        (Symmetry.HALF_TURN, (4, 6), math.pi, False),
        (Symmetry.HALF_TURN, (5, 3), math.pi, False),
        (Symmetry.QUARTER_TURN, (6, 6), 0.5 * math.pi, False),
    ],
)
def test_that_a_symmetric_field_makes_a_symmetric_outline(
    symmetry: Symmetry, grid: tuple[int, int], angle: float, flipped: bool
) -> None:
    rough = np.random.default_rng(2).uniform(-0.8, 0.8, grid)
    z = symmetry.symmetric(rough)
    assert all(image == pytest.approx(z) for image in symmetry.images(z))
    for phi in (0.0, 0.9):
        outline = outline_of(z, phi)
        assert exact_iou(moved(outline, angle, flipped), outline) > 1.0 - 1e-9
        other = outline_of(rough, phi)
        assert exact_iou(moved(other, angle, flipped), other) < 0.99, "a rough field is not symmetric"


def test_that_the_sheet_lies_along_the_axis_of_the_target() -> None:
    def angle(target: Outline, grid: tuple[int, int]) -> float:
        found = shared_symmetries(target, grid)[0].angle
        assert found is not None
        return found

    assert angle(load("heart"), (4, 5)) == pytest.approx(0.5 * math.pi, abs=1e-3)
    assert shared_symmetries(load("letter-l"), (5, 5)) == []
    tilted = Outline.from_points(moved(load("heart"), 0.4, False))
    assert angle(tilted, (4, 5)) == pytest.approx(0.5 * math.pi + 0.4, abs=1e-3)
    assert math.remainder(angle(tilted, (5, 4)) - 0.4, math.pi) == pytest.approx(0.0, abs=1e-3)


def test_that_a_grid_offers_only_the_symmetries_of_its_lattice() -> None:
    def offered(name: str, grid: tuple[int, int]) -> list[Symmetry]:
        return [shared.symmetry for shared in shared_symmetries(load(name), grid)]

    assert offered("heart", (10, 10)) == []
    assert offered("heart", (10, 11)) == [Symmetry.LEFT_RIGHT]
    assert offered("heart", (11, 10)) == [Symmetry.TOP_BOTTOM]
    assert offered("plus", (10, 10)) == [Symmetry.QUARTER_TURN]
    assert offered("plus", (10, 12)) == [Symmetry.HALF_TURN]
    assert offered("wave", (8, 12)) == [Symmetry.HALF_TURN]
    assert offered("wave", (8, 11)) == []
    assert offered("hexagon", (9, 11)) == [Symmetry.TWO_MIRRORS] * 2 + [Symmetry.HALF_TURN]
    assert offered("hexagon", (10, 10)) == [Symmetry.HALF_TURN]
    assert offered("star", (10, 11)) == [Symmetry.LEFT_RIGHT]
    assert offered("square", (11, 11)) == [Symmetry.TWO_MIRRORS] * 2 + [Symmetry.HALF_TURN]


def test_that_a_symmetry_can_be_switched_off_or_forced_on_a_sketch() -> None:
    def asked(name: str, setting: str) -> list[Symmetry]:
        return [pose.symmetry for pose in symmetric_poses(load(name), setting)]

    assert asked("heart", "none") == [] and asked("hexagon", "turn") == [Symmetry.HALF_TURN]
    assert asked("cloud", "auto") == []
    assert asked("cloud", "mirror") == [Symmetry.LEFT_RIGHT, Symmetry.TOP_BOTTOM]
    with pytest.raises(TargetError) as refused:
        symmetric_poses(load("letter-l"), "mirror")
    assert refused.value.code == "symmetry.no_mirror_axis"
    with pytest.raises(TargetError) as refused:
        symmetric_poses(load("heart"), "turn")
    assert refused.value.code == "symmetry.no_turn"
    for setting, grid in (("mirror", (10, 10)), ("turn", (10, 11))):
        with pytest.raises(UsageError, match="set the grid to auto") as wrong:
            shared_symmetries(load("hexagon"), grid, setting=setting)
        assert wrong.value.code == f"symmetry.no_{setting}_on_grid"


def test_that_a_sketch_is_fitted_by_the_shape_that_it_is_meant_to_be() -> None:
    heart, cloud = load("heart"), load("cloud")
    (axis, _) = symmetric_poses(heart, "mirror")
    assert symmetric_target(heart, axis) is heart
    (axis, _) = symmetric_poses(cloud, "mirror")
    assert symmetry_of(symmetric_target(cloud, axis)).axes[0].overlap > 1.0 - 1e-6


def test_that_a_fit_keeps_the_symmetry_it_was_given() -> None:
    target = load("heart")
    sheet = deploy(RatioField.uniform(5, 5)).outline(0.0)
    middle = shapely.Polygon(sheet).centroid
    upright = Similarity(1 / 6, 0.0, (-middle.x / 6, -middle.y / 6))
    fit = polish(RatioField.uniform(5, 5), target, steps=12, pose=upright, symmetry=Symmetry.LEFT_RIGHT)
    assert Symmetry.LEFT_RIGHT.symmetric(fit.field.log10) == pytest.approx(fit.field.log10, abs=1e-8)
    assert np.ptp(fit.field.log10) > 0.5


def test_that_the_search_makes_a_symmetric_sheet_for_a_round_target() -> None:
    best = fit_shape(load("circle"), (4, 4))[0]
    assert Symmetry.QUARTER_TURN.symmetric(best.field.log10) == pytest.approx(best.field.log10, abs=1e-8)
