"""The rasteriser against scikit-image, and its frame."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from skimage.draw import polygon2mask

from kirigami_studio.evaluate.boundary import as_plane
from kirigami_studio.evaluate.mask_siou import mask_siou
from kirigami_studio.evaluate.silhouette import RasterFrame, filled_in_frame, rasterise
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from tests.refusals import refused


def slow_mask(polygon: FloatArray, frame: RasterFrame) -> np.ndarray:
    """The same picture by scikit-image's point-in-polygon test at every pixel centre."""
    column = (polygon[:, 0] - frame.left) / frame.pixel - 0.5
    row = (frame.top - polygon[:, 1]) / frame.pixel - 0.5
    return polygon2mask((frame.rows, frame.columns), np.column_stack([row, column]))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("phi", [0.0, 0.8])
def test_that_the_scanline_mask_is_the_point_in_polygon_mask(seed: int, phi: float) -> None:
    field = RatioField.from_log10(np.random.default_rng(seed).uniform(-1, 1, (10, 10)))
    outline = deploy(field).outline(phi)
    frame = RasterFrame.around(outline, 128)
    assert np.count_nonzero(rasterise(outline) != slow_mask(outline, frame)) <= 2


def test_that_the_longer_side_fills_the_mask_and_the_other_is_centred() -> None:
    mask = rasterise([(5, 5), (9, 5), (9, 6), (5, 6)], 64)
    assert mask.any(axis=0).all()
    assert np.flatnonzero(mask.any(axis=1)).tolist() == list(range(24, 40))


def test_that_row_zero_is_on_top() -> None:
    mask = rasterise([(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4)], 40)
    assert mask[0].sum() == 10
    assert mask[-1].sum() == 40


def test_that_place_size_and_orientation_do_not_change_the_mask(letter_l: FloatArray) -> None:
    np.testing.assert_array_equal(rasterise(letter_l), rasterise(letter_l[::-1] * 8.0 + 16.0))


def test_that_a_frame_keeps_its_pixels_where_it_is_continued_to_hold_several_shapes(letter_l: FloatArray) -> None:
    moved = letter_l + np.array([1.0, -2.0])
    (first, second), _ = filled_in_frame(as_plane(np.stack([letter_l, moved])), RasterFrame.around(letter_l, 100))
    assert first.sum() == rasterise(letter_l, 100).sum() == second.sum()
    np.testing.assert_array_equal(second[40:, 20:], first[: first.shape[0] - 40, : first.shape[1] - 20])


def test_that_a_sheet_that_overlaps_itself_is_still_filled() -> None:
    doubly_wound = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (4, 0), (4, 4), (0, 4)]
    assert rasterise(doubly_wound, 16).all()


def test_that_silhouettes_match_the_reference_masks(oracles: Mapping[str, np.ndarray]) -> None:
    masks = oracles["10x10_mask"]
    for index in (0, 9, 20, 26, 31):
        outline = deploy(RatioField(oracles["10x10_ratio"][index])).outline(0.0)
        assert mask_siou(rasterise(outline), masks[index])[0] > 0.96  # number 26 is thin


@pytest.mark.parametrize(
    "polygon",
    [
        [(0, 0), (1, 0), (np.nan, 1)],
        [(0, 0), (1, 1)],
        [(0, 0), (1, 1), (2, 2)],
        [(0, 0, 1)] * 4,
        "heart",
        [[0, 1], [2]],
    ],
)
def test_that_polygons_without_area_or_with_nan_are_refused(polygon: object) -> None:
    with pytest.raises(KirigamiError, match="silhouette"):
        rasterise(polygon)  # type: ignore[arg-type]


@pytest.mark.parametrize("size", [0, 1, 10**6, 12.5, True])
def test_that_impossible_sizes_are_refused(size: int, letter_l: FloatArray) -> None:
    with refused(KirigamiError, "raster.size_out_of_range"):
        rasterise(letter_l, size)
