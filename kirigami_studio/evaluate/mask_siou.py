"""sIoU of two mask images, as the command line measures it; the sIoU of a design's score is in ``siou``.

As in the paper's appendix ("Silhouette similarity metric") the masks are aligned by a similarity transform (boundary
Procrustes start, principal axes otherwise, refinement), one is filled into the pixels of the other, and the IoU is
taken at 128 x 128.  It differs from the paper's evaluator in two points: only a rim of three pixels around the canvas
is left out, where the paper leaves out all that falls off its image grid, and both directions are averaged, so that
swapping the masks changes nothing.

Masks of any size are first brought to one scale: cropped, 128 pixels on the longer side, with the way back.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import shapely
from scipy.ndimage import affine_transform, uniform_filter
from scipy.optimize import fmin
from skimage.measure import find_contours

from kirigami_studio.evaluate.alignment import align
from kirigami_studio.evaluate.boundary import as_plane, checked_polygon, moments
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.siou import raster_iou
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.paper import MASK_SIZE

#: Contours are thinned to this deviation in pixels: half the staircase of a slanted edge.
CONTOUR_TOLERANCE = 0.5

#: Contours with less area (square pixels) are left out of the alignment.
SMALLEST_CONTOUR = 4.0

#: Pixels beyond the canvas that do not count.  Silhouettes fill their image, so even good matches lose a pixel or two
#: there, and the paper's numbers do not see them: with 3 all reference values on good matches are met within 0.0075
#: (0: within 0.0144), while poor matches gain 0.005 on average (the full crop: 0.023, up to 0.18).
RIM = 3

#: Rotations tried for silhouettes with holes or several pieces, whose outer contour is not the whole shape.
RAGGED_RING = 48

#: How far the pose of the released evaluator's measure is climbed from the alignment: 4 % in scale, 0.1 rad, a pixel.
#: That evaluator takes the first better pose it meets, not the best; with this reach poor matches, too, come within
#: 0.007 of its values on average (24 pairs).
RELEASED_REACH = (math.log(1.04), 0.1, 0.1, 0.1)

#: How many of them are refined by a simplex.
RAGGED_KEPT = 3

#: First steps of the simplex in log scale, radians, and tenths of the mask (x, y); then its evaluations.
FIRST_STEPS = (0.08, 0.08, 0.2, 0.2)
EVALUATIONS = 90


def mask_siou(a: npt.ArrayLike, b: npt.ArrayLike, *, crop: bool = False) -> tuple[float, Similarity]:
    """Similarity-aligned IoU of two masks.

    Parameters
    ----------
    a, b : (H, W) bool, 0/1 or 0..255
        Masks of any size; row 0 on top.
    crop : bool
        Leave out all that leaves the canvas of the fixed mask, as the paper's released evaluator does; only for
        comparison with its numbers, since it flatters poor matches by up to 0.18.

    Returns
    -------
    siou : float, 0..1
        Exactly the same for (b, a).
    transform : Similarity
        Takes ``a`` to ``b``; pixels, x right, y up, origin in the lower left corner of each image.

    Raises
    ------
    KirigamiError
        A mask that is empty, not 2-D, or not finite.
    """
    first, second = FittedMask.from_array(a, 1), FittedMask.from_array(b, 2)
    # One order for both calls: the search then takes the same path whichever mask is named first.
    swapped = first.key > second.key
    value, laid = best_pose(second, first, crop) if swapped else best_pose(first, second, crop)
    if swapped:
        laid = laid.inverse()
    return value, second.to_source.compose(laid).compose(first.to_source.inverse())


def released_siou(design: npt.ArrayLike, target: npt.ArrayLike) -> float:
    """sIoU of the paper's released evaluator: the target cut off at the edge of its pixels.

    The pose is searched by this very measure.  What leaves the canvas does not count, so a target that outgrows it
    fills a design that fills its canvas: the uniform sheet has about 0.93 on targets of the Sobol family.

    Parameters
    ----------
    design, target : (H, W) bool, 0/1 or 0..255
        Masks of any size; row 0 on top.

    Raises
    ------
    KirigamiError
        A mask that is empty, not 2-D, or not finite.
    """
    fixed, moving = FittedMask.from_array(design, 1), FittedMask.from_array(target, 2)

    def cropped(pose: Similarity) -> float:
        return posed_iou(moving, fixed, pose, crop=True)

    start = max(_poses(moving, fixed), key=cropped)
    return max(cropped(start), cropped(_climbed(fixed, start, cropped, RELEASED_REACH)))


def _poses(moving: FittedMask, fixed: FittedMask) -> list[Similarity]:
    """Alignments by outlines, and by pixels where outlines are not the whole shape."""
    poses = _outline_poses(moving, fixed)
    return poses if moving.solid and fixed.solid else [*poses, *_pixel_poses(moving, fixed)]


def best_pose(moving: FittedMask, fixed: FittedMask, crop: bool) -> tuple[float, Similarity]:
    """The best of all alignments, measured both ways."""
    poses = _poses(moving, fixed)

    def both_ways(pose: Similarity) -> float:
        return 0.5 * (posed_iou(moving, fixed, pose, crop) + posed_iou(fixed, moving, pose.inverse(), crop))

    values = [both_ways(pose) for pose in poses]
    best = int(np.argmax(values))
    return values[best], poses[best]


def _outline_poses(moving: FittedMask, fixed: FittedMask) -> list[Similarity]:
    """Alignments of the largest outer contours and, with several pieces, of their convex hulls."""
    mine, theirs = moving.outer_contours(), fixed.outer_contours()
    if not (mine and theirs):
        return [_concentric(moving, fixed, 0.0)]
    poses = [align(mine[0], theirs[0])]
    if max(len(mine), len(theirs)) > 1:
        poses.append(align(_hull(mine), _hull(theirs)))
    return poses


def _hull(contours: list[FloatArray]) -> FloatArray:
    """Convex hull (L, 2) of several contours."""
    hull = shapely.convex_hull(shapely.MultiPoint(np.concatenate(contours)))
    return checked_polygon(shapely.get_coordinates(hull)[:-1])


def _concentric(moving: FittedMask, fixed: FittedMask, angle: float) -> Similarity:
    """Equal area, common centroid, turned by ``angle``."""
    factor = math.sqrt(fixed.area / moving.area) * complex(math.cos(angle), math.sin(angle))
    return Similarity.from_complex(factor, fixed.centroid() - factor * moving.centroid())


def _pixel_poses(moving: FittedMask, fixed: FittedMask) -> list[Similarity]:
    """The best of a ring of rotations on the pixels themselves, refined by a simplex.

    Needed only for holes and several pieces: on solid silhouettes a search on pixels gains nothing but raster noise.
    """

    def soft(pose: Similarity) -> float:
        return _soft_iou(moving, fixed, pose)

    angles = 2.0 * np.pi * np.arange(RAGGED_RING) / RAGGED_RING
    starts = [_concentric(moving, fixed, float(angle)) for angle in angles]
    scores = np.array([soft(start) for start in starts])
    peaks = np.flatnonzero((scores >= np.roll(scores, 1)) & (scores >= np.roll(scores, -1)))
    best = peaks[np.argsort(-scores[peaks], kind="stable")][:RAGGED_KEPT]
    return [_climbed(fixed, starts[k], soft) for k in best]


def _climbed(
    fixed: FittedMask,
    start: Similarity,
    value: Callable[[Similarity], float],
    reach: tuple[float, float, float, float] = (math.inf, math.inf, math.inf, math.inf),
) -> Similarity:
    """Nelder-Mead on ``value`` in (log scale, rotation, x, y) about the middle of the fixed mask, as far as ``reach``.

    Lengths are in tenths of the mask.
    """
    pivot = fixed.centroid()
    length = 0.1 * max(fixed.coverage.shape)

    def moved(move: FloatArray) -> Similarity:
        move = np.clip(move, np.negative(reach), reach)
        factor = complex(np.exp(move[0] + 1j * move[1]))
        shift = pivot - factor * pivot + length * complex(move[2], move[3])
        return Similarity.from_complex(factor, shift).compose(start)

    def cost(move: FloatArray) -> float:
        return -value(moved(move))

    simplex = np.vstack([np.zeros(4), np.diag(FIRST_STEPS)])
    found = fmin(
        cost,
        np.zeros(4),
        initial_simplex=simplex,
        maxfun=EVALUATIONS,
        xtol=1e-3,
        ftol=1e-4,
        disp=False,
    )
    return moved(np.asarray(found, dtype=np.float64))


def _soft_iou(moving: FittedMask, fixed: FittedMask, pose: Similarity) -> float:
    """IoU with fractional coverage, for climbing from afar: the smaller coverage is common."""
    seen = moving.posed(pose, fixed.coverage.shape)
    common = float(np.minimum(seen, fixed.coverage).sum())
    return common / (moving.area * pose.scale**2 + fixed.area - common)


def posed_iou(moving: FittedMask, fixed: FittedMask, pose: Similarity, crop: bool) -> float:
    """IoU of the moving mask in its pose, in the pixels of the fixed one, with room for all that sticks out."""
    height, width = moving.coverage.shape
    corners = pose.apply([(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)])
    beyond = float(np.maximum(-corners, corners - fixed.coverage.shape[::-1]).max())
    margin = max(0, math.ceil(beyond)) + RIM
    seen = moving.posed(pose, fixed.coverage.shape, margin) >= 0.5
    still = np.pad(fixed.filled, margin)
    rows, columns = (slice(max(0, part.start + margin), part.stop + margin) for part in fixed.canvas)
    if crop:
        seen, still = seen[rows, columns], still[rows, columns]
    else:
        rim = np.zeros(seen.shape, dtype=np.bool_)
        rim[_widened(rows), _widened(columns)] = True
        rim[rows, columns] = False
        seen, still = seen & ~rim, still & ~rim
    return float(raster_iou(seen, still))


def _widened(part: slice) -> slice:
    """A range of pixels with the rim on both sides."""
    return slice(max(0, part.start - RIM), part.stop + RIM)


@dataclass(frozen=True, slots=True, eq=False)
class FittedMask:
    """A silhouette at the paper's resolution."""

    #: (H, W), 0..1, read-only; 0 or 1 inside; one empty pixel all around; the longer side of the silhouette measures
    #: 128 pixels.
    coverage: FloatArray
    #: (slice, slice); rows and columns of the original image in the pixels of ``coverage``; may begin below 0.
    canvas: tuple[slice, slice]
    #: Plane of ``coverage`` -> plane of the original mask; both in pixels, x right, y up, origin in the lower left
    #: corner of the image.
    to_source: Similarity
    #: (K, 2) arrays; all contours in (row, column), thinned to the tolerance; closed, the first point repeated.
    loops: tuple[FloatArray, ...]

    @classmethod
    def from_array(cls, mask: npt.ArrayLike, number: int = 1) -> FittedMask:
        """Crop and scale a 2-D mask of booleans, 0/1 or 0..255 grey levels (foreground above half of the range).

        Problems name it by its ``number``.

        Raises
        ------
        KirigamiError
            Not a 2-D array of finite numbers, or no foreground.
        """
        source = _foreground(mask, number)
        rows, columns = np.flatnonzero(source.any(axis=1)), np.flatnonzero(source.any(axis=0))
        top, left = int(rows[0]), int(columns[0])
        cropped = source[top : rows[-1] + 1, left : columns[-1] + 1]
        height, width = cropped.shape
        factor = max(height, width) / MASK_SIZE
        size = [max(1, round(length / factor)) + 2 for length in (height, width)]
        padded = np.pad(cropped, 1).astype(np.float64)
        if factor > 1.0:
            padded = uniform_filter(padded, size=max(1, round(factor)), mode="constant")
        # Pixel centres of the fitted mask on those of the padded crop; both silhouettes share their middle.
        first = [
            (0.5 - 0.5 * count) * factor + 0.5 * length - 0.5 for count, length in zip(size, padded.shape, strict=True)
        ]
        sampled = affine_transform(padded, [factor, factor], first, tuple(size), order=1)
        coverage = (sampled >= 0.5).astype(np.float64)
        coverage.setflags(write=False)
        if not coverage.any():
            raise KirigamiError("siou.mask_too_thin", number=number, size=MASK_SIZE)
        middle = complex(left + 0.5 * width, source.shape[0] - top - 0.5 * height)
        shift = middle - factor * complex(0.5 * size[1], 0.5 * size[0])
        canvas = tuple(
            slice(1 - round(before / factor), 1 + round((length - before) / factor))
            for before, length in zip((top, left), source.shape, strict=True)
        )
        to_source = Similarity(factor, 0.0, (shift.real, shift.imag))
        # scikit-image 0.26 ships this without annotations; GEOS thins contours 20 times as fast.
        contours = find_contours(coverage, 0.5)  # type: ignore[no-untyped-call]
        thinned = (shapely.LineString(loop).simplify(CONTOUR_TOLERANCE, preserve_topology=False) for loop in contours)
        return cls(coverage, (canvas[0], canvas[1]), to_source, tuple(map(shapely.get_coordinates, thinned)))

    @property
    def key(self) -> tuple[float, tuple[int, ...], bytes]:
        """An order among masks that depends on their pixels only."""
        return self.area, self.coverage.shape, self.coverage.tobytes()

    @property
    def filled(self) -> BoolArray:
        """Foreground pixels."""
        filled: BoolArray = self.coverage >= 0.5
        return filled

    @property
    def area(self) -> float:
        """Number of foreground pixels."""
        return float(self.coverage.sum())

    @property
    def solid(self) -> bool:
        """Whether the silhouette is one piece without holes, so that its outer contour is the whole shape."""
        return len(self.loops) == 1

    def outer_contours(self) -> list[FloatArray]:
        """Outer contours, largest first: each (L, 2) float, x right, y up, pixels."""
        loops = []
        for loop in self.loops:
            row, column = loop[:-1].T
            points = np.column_stack([column + 0.5, self.coverage.shape[0] - 0.5 - row])
            # Contours keep the background on their left: outer loops run clockwise, holes counter-clockwise.
            area = -moments(as_plane(points))[0]
            if area >= SMALLEST_CONTOUR:
                loops.append((area, points[::-1]))
        return [points for _, points in sorted(loops, key=lambda item: -item[0])]

    def posed(self, pose: Similarity, shape: tuple[int, ...], margin: int = 0) -> FloatArray:
        """Coverage after ``pose``, in the pixels of another mask of ``shape`` widened by ``margin``; bilinear.

        Returns
        -------
        coverage : (H + 2 margin, W + 2 margin) float, 0..1
        """
        back = pose.inverse().matrix
        # Row r, column c of the picture: x = c - margin + 1/2, y = H - 1/2 - r + margin; the same for the source.
        (xx, xy, x0), (yx, yy, y0) = back
        height, source = shape[0], self.coverage.shape[0]
        x, y = 0.5 - margin, height - 0.5 + margin
        offset = (source - 0.5 - (yx * x + yy * y + y0), xx * x + xy * y + x0 - 0.5)
        size = (shape[0] + 2 * margin, shape[1] + 2 * margin)
        return np.asarray(affine_transform(self.coverage, [[yy, -yx], [-xy, xx]], offset, size, order=1))

    def centroid(self) -> complex:
        """Mean of the foreground pixels, x + iy."""
        row, column = np.nonzero(self.filled)
        return complex(column.mean() + 0.5, self.coverage.shape[0] - 0.5 - row.mean())


def _foreground(mask: npt.ArrayLike, number: int) -> BoolArray:
    """Threshold a 2-D mask at half of its range (1 for booleans and 0/1, 255 beyond that)."""
    try:
        array = np.asarray(mask)
    except ValueError:
        raise KirigamiError("siou.mask_ragged", number=number) from None
    if array.ndim != 2 or array.size == 0 or array.dtype.kind not in "buif":
        raise KirigamiError("siou.mask_not_a_table", number=number, shape=array.shape, kind=array.dtype)
    values = array.astype(np.float64)
    if not np.isfinite(values).all():
        row, column = np.argwhere(~np.isfinite(values))[0]
        raise KirigamiError("siou.mask_not_finite", number=number, value=values[row, column], row=row, column=column)
    filled: BoolArray = values >= (0.5 if values.max() <= 1.0 else 127.5)
    if not filled.any():
        raise KirigamiError("siou.mask_empty", number=number, rows=values.shape[0], columns=values.shape[1])
    return filled
