"""Polygon -> square mask: the raster on which the paper compares silhouettes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from kirigami_studio.evaluate.boundary import as_plane, checked_polygon, scan_crossings, scan_crossings_of_many
from kirigami_studio.foundation.arrays import BoolArray, ComplexArray, FloatArray
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.paper import MASK_SIZE

#: Larger masks would not fit into memory on an ordinary machine.
LARGEST_MASK = 8192


@dataclass(frozen=True, slots=True)
class RasterFrame:
    """Where the pixels of a mask lie in the plane; row 0 on top, y up."""

    #: left, top: upper left corner of pixel (0, 0).
    left: float
    top: float
    pixel: float  #: > 0; side of a pixel, in the units of the polygon
    rows: int
    columns: int

    @classmethod
    def around(cls, polygon: FloatArray, size: int = MASK_SIZE) -> RasterFrame:
        """The square frame that the longer side of the polygon's bounding box fills, centred on its midpoint."""
        low, high = polygon.min(axis=0), polygon.max(axis=0)
        side = float((high - low).max())
        centre = 0.5 * (low + high)
        return cls(float(centre[0]) - 0.5 * side, float(centre[1]) + 0.5 * side, side / size, size, size)


def _pixels(length: float, pixel: float) -> int:
    return int(np.ceil(length / pixel))


def rasterise(polygon: npt.ArrayLike, size: int = MASK_SIZE) -> BoolArray:
    """Fill a polygon into a square mask.

    Parameters
    ----------
    polygon : (L, 2) float
        y up, any place and size.
    size : int, 2..8192
        Pixels each way; the longer side of the bounding box fills it, the other is centred.

    Returns
    -------
    mask : (size, size) bool
        True where the pixel's centre is inside; row 0 on top.

    Raises
    ------
    KirigamiError
        A polygon without area or with values that are not finite, or an impossible size.
    """
    points = checked_polygon(polygon)
    if isinstance(size, bool) or not isinstance(size, int | np.integer) or not 2 <= size <= LARGEST_MASK:
        raise KirigamiError("raster.size_out_of_range", most=LARGEST_MASK, size=size)
    return rasterise_in_frame(points, RasterFrame.around(points, int(size)))


def rasterise_in_frame(polygon: npt.ArrayLike, frame: RasterFrame) -> BoolArray:
    """Fill a polygon into a given frame, so that several shapes share their pixels.

    Pixels whose centre has a winding number other than 0 are filled: a sheet that overlaps itself is still filled.

    Parameters
    ----------
    polygon : (L, 2) float
        Parts outside the frame are cut off.

    Returns
    -------
    mask : (frame.rows, frame.columns) bool
    """
    plane = as_plane(checked_polygon(polygon))
    bottom = frame.top - (frame.rows - 0.5) * frame.pixel
    line, crossing, downward = scan_crossings(plane, bottom, frame.pixel, frame.rows)
    column = np.ceil((crossing - frame.left) / frame.pixel - 0.5).astype(np.intp)
    change = np.zeros((frame.rows, frame.columns + 1), dtype=np.intp)
    np.add.at(change, (frame.rows - 1 - line, np.clip(column, 0, frame.columns)), downward)
    filled: BoolArray = np.cumsum(change[:, :-1], axis=1) != 0
    return filled


def filled_in_frame(planes: ComplexArray, frame: RasterFrame) -> tuple[BoolArray, tuple[int, int]]:
    """Fill several polygons into the pixels of one frame, continued so far that nothing is cut off.

    The pixels of a polygon do not depend on the others: it is the same as ``rasterise_in_frame`` one by one.

    Parameters
    ----------
    planes : (B, L) complex
        Vertices x + iy of closed polygons that cover more than a line.

    Returns
    -------
    masks : (B, rows, columns) bool
    place : (row, column) int
        Where the frame begins in them.
    """
    count, length = planes.shape
    low, high = planes.real.min(), planes.real.max()
    left = max(0, _pixels(frame.left - low, frame.pixel))
    right = max(0, _pixels(high - frame.left - frame.columns * frame.pixel, frame.pixel))
    bottom = frame.top - frame.rows * frame.pixel
    below = max(0, _pixels(bottom - planes.imag.min(), frame.pixel))
    above = max(0, _pixels(planes.imag.max() - frame.top, frame.pixel))
    first = frame.top - (frame.rows - 0.5) * frame.pixel
    line, crossing, downward, edge = scan_crossings_of_many(planes, first, frame.pixel, (-below, frame.rows + above))
    column = np.ceil((crossing - frame.left) / frame.pixel - 0.5).astype(np.intp)
    rows, columns = below + frame.rows + above, left + frame.columns + right
    change = np.zeros((count, rows, columns + 1), dtype=np.int8)
    np.add.at(change, (edge // length, above + frame.rows - 1 - line, np.clip(left + column, 0, columns)), downward)
    filled: BoolArray = np.cumsum(change[..., :-1], axis=2, dtype=np.int8) != 0
    return filled, (above, left)
