"""A click or a stroke on a picture -> the object there, as a part of the picture.

A pixel belongs to the object if its colour is nearer to one of the taken places than to the background and to every
place that was left out; of all such pixels those count that hang together with a taken place.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from PIL import ImageOps
from scipy import ndimage
from shapely.geometry import Polygon

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import tr
from kirigami_studio.outlines.background import colours_in_lab, separated
from kirigami_studio.outlines.parts import DrawnPartKind, Part, Strokes
from kirigami_studio.outlines.read_image import MOST_MEGABYTES, alpha_of, in_pixels, on_paper, opened_image, stretched
from kirigami_studio.outlines.source_file import decoding, read_bytes
from kirigami_studio.outlines.trace import trace

#: Longer side at which objects are taken, pixels.
SIDE = 1024
#: Blur before colours are compared, pixels: grain of photos is finer.
GRAIN = 1.0
#: Places of strokes whose colours count, spread evenly.
MOST_PLACES = 40
#: Half the side of the square around a place in which the object has to be met, pixels.
REACH = 2
#: Colours (distance) that are one.
SAME = 6.0
Place = tuple[float, float]


@dataclass(frozen=True, slots=True, eq=False)
class _Looked:
    """A picture in which objects are taken."""

    colours: FloatArray  #: (H, W, C); CIELAB, or grey levels in per cent
    ground: FloatArray  #: (H, W); distance of each pixel from the background
    reduction: int  #: source pixels along the side of one pixel
    size: tuple[int, int]  #: (width, height), source pixels


def picked_part(path: str | Path, strokes: Strokes) -> Part:
    """The object at some places of a picture, as a part without number.

    Raises
    ------
    TargetError
        Not a picture, no places, a place outside it, or nothing there but background.
    """
    path = Path(path)
    content = read_bytes(path, MOST_MEGABYTES)
    with decoding(path, "source.image_damaged"):
        looked = _looked(content)
        if not strokes.taken:
            raise TargetError("object.no_place")
        taken, left = ([_pixel(place, looked) for place in _some(places)] for places in (strokes.taken, strokes.left))
        beside = looked.ground
        if left:
            off = _nearest(looked.colours, left)
            beside = np.minimum(beside, off)
            # What was taken before goes where it is of a colour that was left out.
            taken = [place for place in taken if off[place] > SAME] or taken
        ink = _connected(beside - _nearest(looked.colours, taken), taken)
        if ink is None:
            raise TargetError("object.nothing_there")
        piece, _ = trace(ink)
        below = looked.colours.shape[0] * looked.reduction - looked.size[1]
        region = in_pixels(piece, (0.5, 0.5 - below / looked.reduction), looked.reduction)
        return Part(0, tr("object"), "", "", DrawnPartKind.FILLED, max(_pieces(region), key=lambda one: one.area))


def _pieces(region: object) -> Sequence[Polygon]:
    return [region] if isinstance(region, Polygon) else list(getattr(region, "geoms", ()))


def _some(places: Sequence[Place]) -> list[Place]:
    """Of many places some, spread evenly."""
    index = np.unique(np.linspace(0, len(places) - 1, min(len(places), MOST_PLACES)).round().astype(int))
    return [places[one] for one in index.tolist()]


def _pixel(place: Place, looked: _Looked) -> tuple[int, int]:
    """Row and column of a place."""
    x, y = place
    width, height = looked.size
    if not (0.0 <= x <= width and 0.0 <= y <= height):
        raise TargetError("object.outside", x=x, y=y, width=width, height=height)
    rows, columns = looked.colours.shape[:2]
    return min(int(y / looked.reduction), rows - 1), min(int(x / looked.reduction), columns - 1)


def _nearest(colours: FloatArray, places: Sequence[tuple[int, int]]) -> FloatArray:
    """Distance (H, W) of each pixel's colour from the nearest of those at some places."""
    least = np.full(colours.shape[:2], np.inf)
    for row, column in places:
        off = colours - colours[row, column]
        np.minimum(least, np.sqrt(np.sum(off * off, axis=2)), out=least)
    return least


def _connected(ink: FloatArray, places: Sequence[tuple[int, int]]) -> FloatArray | None:
    """What hangs together with some places, outside below 0; None where nothing does."""
    labels, _ = ndimage.label(ink > 0)
    near = [
        labels[max(row - REACH, 0) : row + REACH + 1, max(column - REACH, 0) : column + REACH + 1]
        for row, column in places
    ]
    found = np.setdiff1d(np.unique(np.concatenate([one.ravel() for one in near])), [0])
    if not len(found):
        return None
    own = np.isin(labels, found)
    return np.where(own, ink, -np.abs(ink))


@lru_cache(maxsize=1)
def _looked(content: bytes) -> _Looked:
    """A picture, reduced; the last one is kept while it is clicked on."""
    image = ImageOps.exif_transpose(opened_image(content))
    reduction = math.ceil(max(image.size) / SIDE)
    seen: Any
    if image.mode.startswith(("I", "F")):
        deep = stretched(np.asarray(image.convert("F").reduce(reduction), dtype=np.float64))
        seen = deep[..., None].astype(np.float32)
    else:
        seen = np.asarray(on_paper(image).reduce(reduction), dtype=np.float32) / np.float32(255.0)
    colours = colours_in_lab(seen).astype(np.float64)
    colours = ndimage.gaussian_filter(colours, (GRAIN, GRAIN, 0.0))
    if (alpha := alpha_of(image)) is not None:
        ground = np.asarray(alpha.reduce(reduction), dtype=np.float64) / 2.55
    else:
        found = separated(seen)
        # Without a background of its own the border says what the object is not.
        border = np.median(np.concatenate([colours[0], colours[-1], colours[:, 0], colours[:, -1]]), axis=0)
        ground = np.linalg.norm(colours - border, axis=2) if found is None else found.distance
    return _Looked(colours, ground, reduction, image.size)
