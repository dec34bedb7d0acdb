"""Shape agreement of many designs with one target, under the best similarity: exact, and on the paper's raster."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from kirigami_studio.evaluate.alignment import align_many
from kirigami_studio.evaluate.boundary import as_plane
from kirigami_studio.evaluate.silhouette import RasterFrame, filled_in_frame, rasterise_in_frame
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.outlines.outline import Outline


@dataclass(frozen=True, slots=True)
class Agreement:
    """How well one outline, laid over the target by ``transform``, covers it."""

    siou: float
    iou_exact: float
    transform: Similarity


def agreement_of_many(shapes: Sequence[FloatArray], outline: Outline) -> list[Agreement]:
    """Align shapes (L, 2) with equal numbers of vertices and measure them."""
    transforms = align_many(shapes, outline.points)
    laid = np.stack([transform.apply(shape) for transform, shape in zip(transforms, shapes, strict=True)])
    found = zip(raster_ious(laid, outline.points), exact_ious(laid, outline), transforms, strict=True)
    return [Agreement(float(drawn), float(exact), transform) for drawn, exact, transform in found]


def exact_ious(laid: FloatArray, outline: Outline) -> FloatArray:
    """Intersection over union of aligned silhouettes (B, L, 2) and the target, on the polygons themselves: (B,)."""
    shapes = np.asarray(shapely.polygons(laid), dtype=object)
    crossing = ~shapely.is_valid(shapes)
    shapes[crossing] = shapely.make_valid(shapes[crossing])
    common = shapely.area(shapely.intersection(shapes, outline.polygon))
    return np.asarray(common / (shapely.area(shapes) + outline.polygon.area - common), dtype=np.float64)


def raster_ious(laid: FloatArray, target: FloatArray) -> FloatArray:
    """The same on 128 x 128 pixels around the target, continued so far that nothing is cut off: (B,)."""
    frame = RasterFrame.around(target)
    masks, (row, column) = filled_in_frame(as_plane(laid), frame)
    still = rasterise_in_frame(target, frame)
    window = masks[:, row : row + frame.rows, column : column + frame.columns]
    common = _count(window & still)
    return np.asarray(common / (_count(masks) + np.count_nonzero(still) - common), dtype=np.float64)


def _count(masks: BoolArray) -> IntArray:
    return np.asarray(np.count_nonzero(masks, axis=(1, 2)))
