"""Pictures -> Outline: what differs from the colour of the border, largest piece, sub-pixel contour."""

from __future__ import annotations

import io
import math
import warnings
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import shapely
from PIL import Image, ImageOps, UnidentifiedImageError
from scipy import ndimage
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.outlines.background import middle_of, opacity_level, separated
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.parts import DrawnPartKind, Part, SourceParts, numbered, parts_of_region
from kirigami_studio.outlines.pieces import has_seen_holes, rings_of
from kirigami_studio.outlines.source_file import decoding, read_bytes
from kirigami_studio.outlines.trace import LEAST_PIXELS, trace

#: Larger pictures are refused: decoding them takes gigabytes.
MOST_PIXELS = 100_000_000

#: Larger pictures are averaged down to this side; the shape is judged on far fewer pixels.
WORKING_SIDE = 2048

#: Grey range (of 0..1) below which a picture is blank; JPEG noise on white paper stays below.
LEAST_CONTRAST = 0.06
#: Shorter side of a picture whose border tells its background, pixels, and opacity (of 255) that is none.
LEAST_SIDE, CLEAR = 8, 12

#: Regions of a picture: the least share of it, those that are offered at most, and pixels around one that is traced.
LEAST_SHARE, MOST_REGIONS, MARGIN = 2e-4, 200, 6
#: Colours that a picture is told apart into, its longer side then, the least share of one, and the range (of 255) of
#: its channels that makes a colour.
MOST_COLOURS, COLOUR_SIDE, LEAST_OF_COLOUR, LEAST_CHROMA = 8, 768, 0.005, 48
MOST_PIXELS_IN_COLOUR = 25_000_000
#: A picture of more regions is noise; a colour of more specks is texture.
MOST_SPECKS, TEXTURE = 10_000, 200

#: A shape in a picture is one to be asked about from this share of the largest one's area on; many make noise.
ISLAND, MOST_ISLANDS = 0.1, 20

#: As Pillow calls them; of an animation the first picture is read.
FORMATS = ("PNG", "JPEG", "BMP", "WEBP", "TIFF", "GIF", "AVIF")
MOST_MEGABYTES = 200
#: Range of channels (of 255) up to which a picture is in grey, but for a share of its pixels.
MOST_OF_GREY, TINTED = 24, 1e-3
#: Share of the shape, below which what is on the other side of the background's grey level is dirt.
OTHER_SIDE = 0.02
#: Larger files are decoded again for every threshold.
KEPT_MEGABYTES = 24


class Levels(NamedTuple):
    """A picture reduced to one number a pixel."""

    #: (H, W); 0 black, transparent or far from the background .. 1 white, opaque or like the background
    grey: FloatArray
    reduction: int  #: source pixels along the side of one pixel of ``grey``
    ground: float  #: level of the background
    automatic: float  #: level that divides it from the shape
    is_plain: bool  #: whether the shape is meant without doubt
    notes: tuple[str, ...]
    #: (width, height); of the source, turned upright; pixels at its lower and right edge may share a pixel of ``grey``
    #: with nothing.
    size: tuple[int, int]


class Traced(NamedTuple):
    """An outline and its place in its picture."""

    outline: Outline
    scale: float  #: source pixels; length in the picture of one unit of the outline
    #: (x, y), source pixels; the outline's centroid, from the picture's lower left corner, y up.
    centre: tuple[float, float]
    picture: tuple[int, int]  #: (width, height), source pixels; as the picture is looked at, turned upright


def read_image(path: str | Path, threshold: float | None = None) -> Outline:
    """Outline of a picture, see :func:`trace_image`; ``size`` in source pixels."""
    return trace_image(path, threshold).outline


def trace_image(path: str | Path, threshold: float | None = None) -> Traced:
    """Outline of the largest shape that differs from the colour of the border, or that is opaque.

    Parameters
    ----------
    path : str or Path
        A picture of one of ``FORMATS`` with 1 to 100 million pixels, any colour mode.
    threshold : float, optional
        Level 0 .. 1 that separates shape and background; default ``automatic_threshold``.  Pictures in grey have their
        grey levels, 0 black .. 1 white; others 1 where they are like their background .. 0 where they differ most.

    Returns
    -------
    Traced
        Its outline's ``size`` is in source pixels.

    Raises
    ------
    TargetError
        Not such a picture, blank, noise only, or ``threshold`` leaves no shape.
    """
    path = Path(path)
    content = read_bytes(path, MOST_MEGABYTES)
    with decoding(path, "source.image_damaged"):
        levels = _levels(content)
        ink = _ink(levels, threshold)
        piece, notes = trace(ink)
        if threshold is None and not (levels.is_plain and is_alone(np.bincount(ndimage.label(ink > 0)[0].ravel())[1:])):
            notes = (*notes, _choices())
        outline = _outline(piece, path.stem, (*levels.notes, *notes), levels.reduction, levels.is_plain)
        return _in_picture(outline, (rings_of(piece)[0] + 0.5) * levels.reduction, levels)


def _outline(piece: Polygon, name: str, notes: tuple[str, ...], reduction: int, is_plain: bool) -> Outline:
    """The outline of a traced piece, pixels; its holes are open where they are plain."""
    ring, holes = rings_of(piece)
    found = Outline.from_points(ring * reduction, name, notes, unit="px", holes=[hole * reduction for hole in holes])
    return found if is_plain and has_seen_holes(piece) else found.filled


def is_alone(areas: npt.ArrayLike) -> bool:
    """Whether only the largest of several regions can be meant, by their areas."""
    ranked = np.sort(np.asarray(areas, dtype=np.float64))[::-1]
    return len(ranked) < 2 or ranked[1] < ISLAND * ranked[0] or ranked[0] < 0.5 * float(np.sum(ranked[MOST_ISLANDS:]))


def _choices() -> str:
    return tr(
        "More than one shape may be meant in this picture: check what was taken. --object X,Y takes the one at a "
        "place, --parts those that 'kirigami-studio parts FILE' lists."
    )


def image_parts(path: str | Path, threshold: float | None = None, in_colour: bool = True) -> SourceParts:
    """Connected regions of a picture as parts: dark or light ones, and those of each colour.

    A coloured picture has a layer for each of its main colours but the one of its border, which nobody takes without
    asking.  A picture in grey has regions by its threshold alone, as have all where ``in_colour`` is not asked for.
    Regions below ``LEAST_SHARE`` of the picture are specks.

    Raises
    ------
    TargetError
        As :func:`trace_image`, but for pictures of specks.
    """
    path = Path(path)
    content = read_bytes(path, MOST_MEGABYTES)
    with decoding(path, "source.image_damaged"):
        levels = _levels(content)
        ink = _ink(levels, threshold)
        found, specks = _regions(ink, levels.reduction, "", "")
        for colour, field, reduction in _colours(content) if in_colour else ():
            more, dust = _regions(field, reduction, colour, colour)
            if dust > TEXTURE:
                continue
            found += [replace(part, is_aside=True) for part in more]
            specks += dust
        if not found:
            raise TargetError("trace.specks", specks=specks)
        found += _holes_in(found, LEAST_SHARE * levels.size[0] * levels.size[1])
        parts, too_many = numbered(found, float(max(levels.size)))
        notes = (*levels.notes, *too_many)
        if specks:
            notes = (tr_n("{count} speck was left out.", "{count} specks were left out.", specks), *notes)
        return SourceParts(path.stem, parts, notes, "px")


def _regions(ink: FloatArray, reduction: int, layer: str, colour: str) -> tuple[list[Part], int]:
    """The connected regions above 0 as parts, source pixels, and the number of specks."""
    labels, count = ndimage.label(ink > 0)
    if count > MOST_SPECKS:
        return [], count
    sizes = np.bincount(labels.ravel(), minlength=count + 1)[1:]
    least = max(LEAST_PIXELS, LEAST_SHARE * ink.size)
    order = [index for index in np.argsort(sizes)[::-1].tolist() if sizes[index] >= least][:MOST_REGIONS]
    boxes = ndimage.find_objects(labels)
    parts = []
    for index in order:
        rows, columns = boxes[index]
        top, left = max(rows.start - MARGIN, 0), max(columns.start - MARGIN, 0)
        window = (slice(top, rows.stop + MARGIN), slice(left, columns.stop + MARGIN))
        field, own = ink[window], labels[window] == index + 1
        try:
            piece, _ = trace(np.where(own, field, np.where(field > 0, -field, field)))
        except TargetError:
            continue  # thinner than a pixel
        below = ink.shape[0] - window[0].start - field.shape[0]
        region = in_pixels(piece, (left, below), reduction)
        like = Part(0, "", layer, colour, DrawnPartKind.FILLED, Polygon())
        parts += parts_of_region(region, like)
    return parts, count - len(order)


def _holes_in(parts: Sequence[Part], least: float) -> list[Part]:
    """Holes of shapes as parts, such as a white star on a red disc."""
    holes = [Polygon(ring) for part in parts if not part.is_aside for one in shapely.get_parts(part.region)
             for ring in one.interiors]  # fmt: skip
    holes = sorted((hole for hole in holes if hole.area >= least), key=lambda hole: hole.area, reverse=True)
    return [Part(0, "", "", "", DrawnPartKind.FILLED, hole, is_aside=True) for hole in holes[:MOST_REGIONS]]


def in_pixels(piece: Polygon, shift: tuple[float, float], reduction: int) -> BaseGeometry:
    """A traced piece, moved and enlarged to source pixels."""
    return shapely.transform(piece, lambda points: (points + shift) * reduction).buffer(0)


def _colours(content: bytes) -> list[tuple[str, FloatArray, int]]:
    """Main colours of a picture but its border's: name, where (1, elsewhere -1), reduction."""
    image = ImageOps.exif_transpose(opened_image(content))
    if image.width * image.height > MOST_PIXELS_IN_COLOUR:
        return []
    reduction = math.ceil(max(image.size) / COLOUR_SIDE)
    flat = on_paper(image)
    small = flat.reduce(reduction) if reduction > 1 else flat
    few = small.quantize(MOST_COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    table, places = few.getpalette() or [], np.asarray(few)
    colours = [tuple(table[3 * k : 3 * k + 3]) for k in range(len(table) // 3)]
    if not any(max(colour) - min(colour) > LEAST_CHROMA for colour in colours):
        return []
    border = int(np.bincount(np.concatenate([places[0], places[-1], places[:, 0], places[:, -1]])).argmax())
    found = []
    for index, (red, green, blue) in enumerate(colours):
        here = places == index
        if index != border and np.mean(here) >= LEAST_OF_COLOUR:
            found.append((f"#{red:02x}{green:02x}{blue:02x}", np.where(here, 1.0, -1.0), reduction))
    return found if len(found) > 1 else []


def _in_picture(outline: Outline, ring: FloatArray, levels: Levels) -> Traced:
    """Place of an outline: its box is that of the ring (L, 2), source pixels."""
    width = outline.size[0] if outline.size is not None else float(np.ptp(ring[:, 0]))
    scale = width / float(np.ptp(outline.points[:, 0]))
    x, y = (ring.min(axis=0) - scale * outline.points.min(axis=0)).tolist()
    below = levels.grey.shape[0] * levels.reduction - levels.size[1]  # the last row of grey may reach out below
    return Traced(outline, scale, (x, y - below), levels.size)


def picture_size(path: str | Path) -> tuple[int, int]:
    """Width and height of a picture, turned upright, pixels.

    Raises
    ------
    TargetError
        Not a picture, or blank.
    """
    return _levels_of(path).size


def is_plain_picture(path: str | Path) -> bool:
    """Whether the shape of a picture is meant without doubt: sharp edges on a background of one colour.

    Raises
    ------
    TargetError
        Not a picture, or blank.
    """
    return _levels_of(path).is_plain


def automatic_threshold(path: str | Path) -> float:
    """Level in 0..1 of ``read_image``: midway between background and shape at its edge.

    Raises
    ------
    TargetError
        Not a picture, or blank.
    """
    return _levels_of(path).automatic


def _levels_of(path: str | Path) -> Levels:
    path = Path(path)
    content = read_bytes(path, MOST_MEGABYTES)
    with decoding(path, "source.image_damaged"):
        return _levels(content)


def outline_of_mask(mask: BoolArray, name: str) -> Outline:
    """Outline of the largest piece of a mask; row 0 is the top.

    Parameters
    ----------
    mask : (H, W) bool
        True inside the shape.

    Raises
    ------
    TargetError
        Not a two-dimensional mask, or no shape in it.
    """
    mask = np.asarray(mask)
    if mask.ndim != 2 or mask.size == 0:
        raise TargetError("mask.wrong_shape", shape=mask.shape)
    if not mask.any():
        raise TargetError("mask.empty")
    piece, notes = trace(np.where(mask, 0.5, -0.5))
    return _outline(piece, name, notes, 1, True)


def opened_image(content: bytes, formats: tuple[str, ...] = FORMATS, most_pixels: int | None = None) -> Image.Image:
    """Decode a picture, all of it.

    Parameters
    ----------
    formats : tuple of str
        Those that are read, as Pillow calls them.

    Raises
    ------
    TargetError
        Too many pixels.
    Exception
        Whatever Pillow raises on damaged files.
    """
    with warnings.catch_warnings():
        # Pillow warns from 89 Mpixel on, where the limit here is the sentence below; and of oddities in TIFF.
        warnings.simplefilter("ignore")
        try:
            image = Image.open(io.BytesIO(content), formats=formats)
        except Image.DecompressionBombError:
            raise TargetError("image.far_too_many_pixels") from None
        except UnidentifiedImageError:
            # Pillow's own words name the object in memory and not the file.
            raise ValueError("it does not begin like one") from None
        width, height = image.size
        limit = MOST_PIXELS if most_pixels is None else most_pixels
        if width * height > limit:
            raise TargetError("image.too_many_pixels", width=width, height=height, limit=limit // 10**6)
        image.load()
    return image


def _levels(content: bytes) -> Levels:
    """Decode a picture and reduce it to the level of each pixel; the last one is kept while its threshold is moved."""
    return (_kept_levels if len(content) <= KEPT_MEGABYTES * 1_000_000 else _decoded_levels)(content)


def _decoded_levels(content: bytes) -> Levels:
    image = ImageOps.exif_transpose(opened_image(content))
    reduction = math.ceil(max(image.size) / WORKING_SIDE)
    coloured = None
    if image.mode.startswith(("I", "F")):
        grey = stretched(_array(image.convert("F"), reduction))
    elif (alpha := alpha_of(image)) is not None:
        return _opaque(_array(alpha, reduction) / 255.0, reduction, image.size)
    else:
        flat = image.convert("L") if image.mode in ("1", "L") else on_paper(image)
        grey = _array(flat.convert("L"), reduction) / 255.0
        if flat.mode != "L":
            seen = _array(flat, reduction, np.float32)
            if np.mean(np.ptp(seen, axis=2) > MOST_OF_GREY) > TINTED:
                coloured = seen / np.float32(255.0)
    if min(grey.shape) < LEAST_SIDE:
        return _divided_by_grey(grey, reduction, image.size)
    found = separated(grey[..., None] if coloured is None else coloured)
    if found is None or (coloured is None and float(np.ptp(grey)) < LEAST_CONTRAST):
        return _divided_by_grey(grey, reduction, image.size)
    notes = (tr("The page around the shape was left out."),) if found.is_on_page else ()
    if coloured is None and found.ground is not None and not found.is_on_page:
        darker, lighter = (
            float(np.mean(side > 0.01 * found.level)) for side in (found.ground - grey, grey - found.ground)
        )
        if min(darker, lighter) <= OTHER_SIDE * max(darker, lighter):
            level = found.ground + (0.01 if lighter > darker else -0.01) * found.level
            return Levels(grey, reduction, found.ground, level, found.is_plain, notes, image.size)
    highest = float(np.max(found.distance))
    alike = 1.0 - found.distance / highest
    return Levels(alike, reduction, 1.0, 1.0 - found.level / highest, found.is_plain, notes, image.size)


_kept_levels = lru_cache(maxsize=1)(_decoded_levels)


def _array(image: Image.Image, reduction: int, kind: type = np.float64) -> FloatArray:
    """Values of a picture, averaged over squares of pixels."""
    return np.asarray(image.reduce(reduction) if reduction > 1 else image, dtype=kind)


def _opaque(opacity: FloatArray, reduction: int, size: tuple[int, int]) -> Levels:
    """Levels of a transparent picture."""
    if min(opacity.shape) < LEAST_SIDE or float(np.ptp(opacity)) < LEAST_CONTRAST:
        return Levels(opacity, reduction, 0.0, _automatic(opacity), True, (), size)
    found = opacity_level(opacity)
    return Levels(opacity, reduction, 0.0, 0.01 * found.level, found.is_plain, (), size)


def _divided_by_grey(grey: FloatArray, reduction: int, size: tuple[int, int]) -> Levels:
    """Levels of a picture that shows nothing on the colour of its border, divided by Otsu's level."""
    level = _automatic(grey)
    ground = float(np.mean(_border(grey) > level) >= 0.5)
    return Levels(grey, reduction, ground, level, False, (), size)


def stretched(deep: FloatArray) -> FloatArray:
    """Levels from 0 to 1 of a 16- or 32-bit picture: it seldom uses its whole range."""
    lowest, highest = float(np.min(deep)), float(np.max(deep))
    return (deep - lowest) / max(highest - lowest, 1e-12)


def alpha_of(image: Image.Image) -> Image.Image | None:
    """The opacity of a picture whose border is transparent."""
    if not image.has_transparency_data:
        return None
    alpha = image.convert("RGBA").getchannel("A")
    opacity = np.asarray(alpha, dtype=np.float64)
    is_border_clear = np.mean(_border(opacity) < 128) > 0.5 or np.mean(_corners_of(opacity) < 128) > 0.5
    return alpha if is_border_clear and float(np.max(opacity)) > CLEAR else None


def on_paper(image: Image.Image) -> Image.Image:
    """The colours of a picture, white where it is transparent."""
    if not image.has_transparency_data:
        return image.convert("RGB")
    coloured = image.convert("RGBA")
    return Image.alpha_composite(Image.new("RGBA", coloured.size, "white"), coloured).convert("RGB")


def _corners_of(values: FloatArray) -> FloatArray:
    return values[[0, 0, -1, -1], [0, -1, 0, -1]]


def _border(grey: FloatArray) -> FloatArray:
    """Values of the outermost pixels."""
    return np.concatenate([grey[0], grey[-1], grey[1:-1, 0], grey[1:-1, -1]])


def _automatic(grey: FloatArray) -> float:
    contrast = float(np.ptp(grey))
    if contrast < LEAST_CONTRAST:
        raise TargetError("image.blank", percent=100 * contrast)
    return middle_of(grey)


def _ink(levels: Levels, threshold: float | None) -> FloatArray:
    """How much each pixel belongs to the shape: above 0 inside, 0 at the threshold."""
    level = levels.automatic if threshold is None else _checked(threshold)
    ink = levels.grey - level if levels.ground < level else level - levels.grey
    if not np.any(ink > 0) or np.all(ink > 0):
        raise TargetError("image.one_colour", threshold=level)
    return ink


def _checked(threshold: float) -> float:
    if isinstance(threshold, bool) or not isinstance(threshold, int | float) or not 0.0 < threshold < 1.0:
        raise TargetError("image.threshold", value=threshold)
    return float(threshold)
