"""Masks of any size -> one scale: cropped, 128 pixels on the longer side, with the way back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.ndimage import affine_transform, map_coordinates, uniform_filter
from skimage.measure import approximate_polygon, find_contours

from kirigami_studio.evaluate.boundary import as_plane, moments
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.paper import MASK_SIZE

#: Contours are thinned to this deviation in pixels: half the staircase of a slanted edge.
CONTOUR_TOLERANCE = 0.5

#: Contours with less area (square pixels) say nothing about the pose.
SMALLEST_CONTOUR = 4.0


@dataclass(frozen=True, slots=True, eq=False)
class FittedMask:
    """A silhouette at the paper's resolution.

    Attributes
    ----------
    coverage : (H, W) float, 0..1, read-only
        0 or 1 inside; one empty pixel all around; the longer side of the silhouette measures 128 pixels.
    canvas : (slice, slice)
        Rows and columns of the original image in the pixels of ``coverage``; may begin below 0.
    to_source : Similarity
        Plane of ``coverage`` -> plane of the original mask; both in pixels, x right, y up, origin in the lower left
        corner of the image.
    """

    coverage: FloatArray
    canvas: tuple[slice, slice]
    to_source: Similarity

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
        row, column = (
            (np.arange(count) + 0.5 - 0.5 * count) * factor + 0.5 * length - 0.5
            for count, length in zip(size, padded.shape, strict=True)
        )
        sampled = map_coordinates(padded, np.meshgrid(row, column, indexing="ij"), order=1, mode="constant")
        coverage = (sampled >= 0.5).astype(np.float64)
        coverage.setflags(write=False)
        if not coverage.any():
            raise KirigamiError("mask.too_thin", number=number, size=MASK_SIZE)
        middle = complex(left + 0.5 * width, source.shape[0] - top - 0.5 * height)
        shift = middle - factor * complex(0.5 * size[1], 0.5 * size[0])
        canvas = tuple(
            slice(1 - round(before / factor), 1 + round((length - before) / factor))
            for before, length in zip((top, left), source.shape, strict=True)
        )
        return cls(coverage, (canvas[0], canvas[1]), Similarity(factor, 0.0, (shift.real, shift.imag)))

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
        """Whether the silhouette is one piece without holes, so that its outer contour says all."""
        return len(self._loops()) == 1

    def _loops(self) -> list[FloatArray]:
        """All contours in (row, column), thinned to the tolerance; closed, the first point repeated."""
        # scikit-image 0.26 ships these two without annotations.
        loops = find_contours(self.coverage, 0.5)  # type: ignore[no-untyped-call]
        return [approximate_polygon(loop, CONTOUR_TOLERANCE) for loop in loops]  # type: ignore[no-untyped-call]

    def outer_contours(self) -> list[FloatArray]:
        """Outer contours, largest first: each (L, 2) float, x right, y up, pixels."""
        loops = []
        for loop in self._loops():
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
    """Threshold a 2-D mask at half of its range (1 for booleans and 0/1, 255 beyond that).

    Raises
    ------
    KirigamiError
        Not 2-D, not numbers, not finite, or empty.
    """
    try:
        array = np.asarray(mask)
    except ValueError:
        raise KirigamiError("mask.ragged", number=number) from None
    if array.ndim != 2 or array.size == 0 or array.dtype.kind not in "buif":
        raise KirigamiError("mask.not_a_table", number=number, shape=array.shape, kind=array.dtype)
    values = array.astype(np.float64)
    if not np.isfinite(values).all():
        row, column = np.argwhere(~np.isfinite(values))[0]
        raise KirigamiError("mask.not_finite", number=number, value=values[row, column], row=row, column=column)
    filled: BoolArray = values >= (0.5 if values.max() <= 1.0 else 127.5)
    if not filled.any():
        raise KirigamiError("mask.empty", number=number, rows=values.shape[0], columns=values.shape[1])
    return filled
