"""An ink field -> its largest piece with holes, by contours at level 0 between pixels."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import shapely
from scipy import ndimage
from shapely.geometry import Polygon
from skimage import measure

from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import tr_n

#: scikit-image carries no types; the annotation states what is used of it.
find_contours: Callable[[FloatArray, float], list[FloatArray]] = measure.find_contours

#: Blur before contouring, pixels: removes the staircase of a hard mask, rounds corners by under half a pixel.
BLUR = 0.7

#: Error in pixels that simplification may add, and the number of vertices it aims at.
MOST_ERROR = 0.25
AIMED_VERTICES = 400

#: A shape of fewer pixels has no form that could be followed.
LEAST_PIXELS = 16

#: A picture is noise when it falls into more pieces than this and none holds half of the ink.
MOST_SPECKS = 20


def trace(ink: FloatArray) -> tuple[Polygon, tuple[str, ...]]:
    """Return the largest piece with its holes.

    Parameters
    ----------
    ink : (H, W) float
        Above 0 inside the shape, below 0 outside, row 0 on top.  Where it varies smoothly over an edge
        (anti-aliasing) the contour follows between pixels.

    Returns
    -------
    piece : shapely.Polygon, pixels, y up
        One pixel of ink is a square of side 1; the bottom left pixel is centred at (0, 0).  A hole within a pixel of
        the rim is filled.
    notes : tuple of str
        What was left out.

    Raises
    ------
    TargetError
        Nothing but specks.
    """
    piece, notes = _main_piece(ink > 0)
    solid = ndimage.binary_fill_holes(piece)
    highest = float(np.max(np.abs(ink)))
    field = np.where(solid & ~piece, highest, ink)
    field[~solid & (ink > 0)] = -highest
    contours = _contours(field)
    if not contours:
        raise TargetError("trace.thinner_than_a_pixel")
    outer = max(contours, key=lambda ring: Polygon(ring).area)
    rim, holes = Polygon(outer), []
    if np.any(solid & ~piece):
        # What lies in a hole belongs to it.
        missing = np.where(solid, np.where(piece, -np.abs(ink), np.abs(ink)), -highest)
        holes = [hole for hole in _contours(missing) if Polygon(hole).area >= LEAST_PIXELS]
        holes = [hole for hole in holes if Polygon(hole).is_valid and rim.contains_properly(Polygon(hole))]
    return Polygon(_simplified(outer), [_simplified(hole) for hole in holes]), notes


def _contours(field: FloatArray) -> list[FloatArray]:
    """The closed contours (L, 2) of a field (H, W) at level 0, pixels, y up."""
    margin = 4  # Wider than the blur: shapes that touch the border close half a pixel outside.
    outside = -float(np.max(np.abs(field)))
    calm = ndimage.gaussian_filter(np.pad(field, margin, constant_values=outside), BLUR, mode="nearest")
    rings = [ring[:-1] - margin for ring in find_contours(calm, 0.0) if len(ring) > 4]
    return [np.column_stack([ring[:, 1], field.shape[0] - 1 - ring[:, 0]]) for ring in rings]


def _main_piece(mask: BoolArray) -> tuple[BoolArray, tuple[str, ...]]:
    """Largest edge-connected piece of a mask, with a note on the others."""
    labels = np.asarray(ndimage.label(mask)[0])
    sizes = np.bincount(labels.ravel())[1:]
    main = int(np.argmax(sizes))
    total, largest = int(np.sum(sizes)), int(sizes[main])
    if len(sizes) > MOST_SPECKS and largest < 0.5 * total:
        raise TargetError("trace.specks", specks=len(sizes))
    if largest < LEAST_PIXELS:
        raise TargetError("trace.too_few_pixels", pixels=largest)
    piece: BoolArray = labels == main + 1
    if len(sizes) == 1:
        return piece, ()
    note = tr_n(
        "Only the largest shape is used: {count} island was left out ({percent:.2g} % of the area).",
        "Only the largest shape is used: {count} islands were left out ({percent:.2g} % of the area).",
        len(sizes) - 1,
        percent=100 * (1 - largest / total),
    )
    return piece, (note,)


def _simplified(points: FloatArray) -> FloatArray:
    """Drop vertices until ``AIMED_VERTICES`` remain or the error reaches ``MOST_ERROR`` pixels."""
    polygon, simpler = Polygon(points), points
    for error in (0.05, 0.1, 0.15, 0.2, MOST_ERROR):
        simpler = shapely.get_coordinates(polygon.simplify(error))[:-1]
        if len(simpler) <= AIMED_VERTICES:
            break
    return simpler
