"""sIoU, the paper's silhouette similarity: intersection over union under the best similarity transform.

Definition (paper, Appendix "Silhouette similarity metric"): lay a silhouette A over the target B by the rotation, scale
and translation T that match best, never by a reflection, fill both into 128 x 128 pixels, and compare,

    sIoU(A, B) = |T A and B| / |T A or B|.

T is found on the polygons themselves (module ``alignment``).  The 128 pixels span the longer side of the target's
bounding box and are continued beyond it, so that nothing that sticks out of the target is cut off.  *Exact IoU* is the
same ratio of areas without a raster.  For two mask images see ``mask_siou``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from kirigami_studio.evaluate.alignment import align_many, align_near
from kirigami_studio.evaluate.boundary import as_plane, checked_polygon
from kirigami_studio.evaluate.silhouette import RasterFrame, filled_in_frame, rasterise_in_frame
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.outlines.outline import Outline

#: Processors round differently: sIoU may differ by a few of 16 000 pixels, exact numbers by less than this.
PIXELS_OFF, ROUNDING = 1e-3, 1e-4
#: A silhouette that reaches this many times as far from the middle as the target is not laid upon it.
FARTHEST = 10.0
#: IoU by which another pose of a symmetric shape has to be better than the one nearby.
ANOTHER_POSE = 5e-4
#: Turns at which a silhouette with holes is tried, and how often half a step to either side is.
TURNS, HALVINGS = 24, 8


@dataclass(frozen=True, slots=True)
class ShapeMatch:
    """How well a silhouette covers the target."""

    siou: float  #: 0..1
    iou_exact: float  #: 0..1; the same on the polygons
    transform: Similarity  #: frame of the silhouette -> frame of the target; both numbers hold under it

    def is_near(self, other: ShapeMatch) -> bool:
        """Whether both numbers are those of another match but for rounding."""
        return abs(self.siou - other.siou) <= PIXELS_OFF and abs(self.iou_exact - other.iou_exact) <= ROUNDING


def siou_of_many(shapes: Sequence[FloatArray], target: Outline) -> list[ShapeMatch]:
    """The sIoU of silhouettes (L, 2) that all have the same number of vertices."""
    return _matches(shapes, target, align_many(shapes, target.points))


def iou_of_area(area: shapely.Polygon, target: Outline) -> float:
    """Exact IoU of an area in its best pose, see :func:`pose_of_area`."""
    return pose_of_area(area, target)[0]


def shown_area(laid: shapely.Polygon, target: shapely.Polygon) -> BaseGeometry:
    """Area over a target as it counts: filled, open where that is mostly a hole of the target."""
    missing = shapely.difference(shapely.Polygon(target.exterior), target)
    openings = np.array([shapely.Polygon(opening) for opening in laid.interiors], dtype=object)
    mostly = shapely.area(shapely.intersection(openings, missing)) > 0.5 * shapely.area(openings)
    shown: BaseGeometry = shapely.Polygon(laid.exterior).difference(shapely.union_all(openings[mostly]))
    return shown


def pose_of_area(area: shapely.Polygon, target: Outline, near: Similarity | None = None) -> tuple[float, Similarity]:
    """Exact IoU of an area in its best pose, and that pose: from its frame to the target's.

    Outer rings alone do not tell how a face on a disc is turned: of all turns the one counts at which holes match too.
    Symmetric shapes have several poses that are as good: then the one that is found from ``near`` on uphill.
    """
    ring = shapely.get_coordinates(area.exterior)[:-1]
    (match,) = siou_of_many([ring], target)
    if near is not None:
        nearby = siou_near(ring, target, near)
        match = nearby if nearby.iou_exact > match.iou_exact - ANOTHER_POSE else match
    if not target.holes:
        return match.iou_exact, match.transform

    def turned(angle: float) -> float:
        laid = shapely.transform(area, Similarity(1.0, angle).compose(match.transform).apply)
        shown = shown_area(laid, target.polygon)
        common = float(shown.intersection(target.polygon).area)
        return common / (float(shown.area) + target.polygon.area - common)

    step = 2.0 * math.pi / TURNS
    best, angle = max(((turned(step * number), step * number) for number in range(TURNS)), key=lambda one: one[0])
    straight = turned(0.0)
    if straight > best - ANOTHER_POSE:
        best, angle = straight, 0.0
    for halving in range(1, HALVINGS + 1):
        around = (angle - step / 2**halving, angle + step / 2**halving)
        best, angle = max((best, angle), *((turned(other), other) for other in around))
    return best, Similarity(1.0, angle).compose(match.transform)


def siou_near(shape: FloatArray, target: Outline, pose: Similarity) -> ShapeMatch:
    """The same of one silhouette (L, 2), under the best similarity that is found from ``pose`` on uphill."""
    return _matches([shape], target, [align_near(shape, target.points, pose)])[0]


def matches_in_poses(
    shapes: Sequence[FloatArray], target: Outline, poses: Sequence[Similarity]
) -> list[ShapeMatch | None]:
    """The sIoU of silhouettes (L, 2) of equally many vertices in given poses; None far off the target."""
    # A raster that holds a silhouette far off the target would be as large.
    reach = FARTHEST * float(np.abs(target.points).max())
    near = [bool(np.abs(pose.apply(shape)).max() <= reach) for shape, pose in zip(shapes, poses, strict=True)]
    close = [(shape, pose) for shape, pose, here in zip(shapes, poses, near, strict=True) if here]
    found = iter(_matches([shape for shape, _ in close], target, [pose for _, pose in close]))
    return [next(found) if here else None for here in near]


def _matches(shapes: Sequence[FloatArray], target: Outline, transforms: Sequence[Similarity]) -> list[ShapeMatch]:
    if not transforms:
        return []
    laid = np.stack([transform.apply(shape) for transform, shape in zip(transforms, shapes, strict=True)])
    found = zip(aligned_sious(laid, target.points, target.holes), exact_ious(laid, target), transforms, strict=True)
    return [ShapeMatch(float(siou), float(exact), transform) for siou, exact, transform in found]


def aligned_sious(laid: FloatArray, target: FloatArray, holes: Sequence[FloatArray] = ()) -> FloatArray:
    """The sIoU (B,) of silhouettes (B, L, 2) laid on the target (K, 2) less its holes."""
    frame = RasterFrame.around(target)
    masks, (row, column) = filled_in_frame(as_plane(laid), frame)
    still = np.zeros(masks.shape[1:], dtype=np.bool_)
    still[row : row + frame.rows, column : column + frame.columns] = rasterise_in_frame(target, frame)
    for hole in holes:
        still[row : row + frame.rows, column : column + frame.columns] &= ~rasterise_in_frame(hole, frame)
    return raster_iou(masks, still)


def raster_iou(first: BoolArray, second: BoolArray) -> FloatArray:
    """Intersection over union of masks (..., rows, columns) that share their pixels: (...)."""
    common = np.count_nonzero(first & second, axis=(-2, -1))
    return np.asarray(common / np.count_nonzero(first | second, axis=(-2, -1)))


def exact_iou(laid: FloatArray, target: Outline) -> float:
    """Intersection over union of an aligned silhouette (L, 2) and the target, on the polygons themselves."""
    return float(exact_ious(checked_polygon(laid)[np.newaxis], target)[0])


def exact_ious(laid: FloatArray, target: Outline) -> FloatArray:
    """The same of aligned silhouettes (B, L, 2): (B,)."""
    shapes = np.asarray(shapely.polygons(laid), dtype=object)
    crossing = ~shapely.is_valid(shapes)
    shapes[crossing] = shapely.make_valid(shapes[crossing])
    common = shapely.area(shapely.intersection(shapes, target.polygon))
    return np.asarray(common / (shapely.area(shapes) + target.polygon.area - common), dtype=np.float64)
