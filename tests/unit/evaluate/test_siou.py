"""sIoU and exact IoU of many silhouettes at once, against one at a time and against the definition."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from kirigami_studio.evaluate.boundary import as_plane
from kirigami_studio.evaluate.silhouette import RasterFrame, filled_in_frame, rasterise_in_frame
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.siou import aligned_sious, exact_ious
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.silhouettes import load


@pytest.fixture(scope="module")
def laid() -> FloatArray:
    """Silhouettes of about the target's size, some far outside its frame, some crossing themselves."""
    draw = np.random.default_rng(2)
    shapes = []
    for _ in range(10):
        outline = deploy(RatioField.from_log10(draw.uniform(-1, 1, (6, 6)))).outline(0.5)
        pose = Similarity(0.12 * draw.uniform(0.7, 1.4), draw.uniform(0, 6), tuple(draw.uniform(-0.6, 0.6, 2)))
        shapes.append(pose.apply(outline - outline.mean(axis=0)))
    shapes[3] = draw.permutation(shapes[3])
    return np.stack(shapes)


def siou_by_definition(shape: FloatArray, target: FloatArray) -> float:
    """Both filled into the target's 128 x 128 pixels, which go on for another target's length on every side."""
    own = RasterFrame.around(target)
    side = own.rows * own.pixel
    frame = RasterFrame(own.left - side, own.top + side, own.pixel, 3 * own.rows, 3 * own.columns)
    first, second = rasterise_in_frame(shape, frame), rasterise_in_frame(target, frame)
    return float(np.count_nonzero(first & second) / np.count_nonzero(first | second))


def test_that_pixels_are_counted_as_one_by_one(laid: FloatArray) -> None:
    target = load("heart").points
    assert aligned_sious(laid, target).tolist() == [siou_by_definition(shape, target) for shape in laid]
    assert [aligned_sious(shape[None], target)[0] for shape in laid] == aligned_sious(laid, target).tolist()


def test_that_many_polygons_are_filled_as_one_by_one(laid: FloatArray) -> None:
    frame = RasterFrame.around(load("star").points, 40)
    masks, (row, column) = filled_in_frame(as_plane(laid), frame)
    assert (row, column) > (0, 0)
    for mask, shape in zip(masks, laid, strict=True):
        np.testing.assert_array_equal(mask[row : row + 40, column : column + 40], rasterise_in_frame(shape, frame))


def test_that_polygons_are_measured_as_one_by_one(laid: FloatArray) -> None:
    target = load("heart")
    valid = [shapely.make_valid(shapely.Polygon(shape)) for shape in laid]
    expected = [shape.intersection(target.polygon).area / shape.union(target.polygon).area for shape in valid]
    assert exact_ious(laid, target) == pytest.approx(expected, abs=1e-9)
