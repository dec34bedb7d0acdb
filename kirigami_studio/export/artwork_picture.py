"""Picture files -> pictures that can be printed on a sheet: upright, 8 bits a channel, RGB or RGBA, PNG or JPEG."""

from __future__ import annotations

import io
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image, ImageOps

from kirigami_studio.export.artwork import ArtPicture
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines.read_image import MOST_MEGABYTES, opened_image
from kirigami_studio.outlines.read_svg import painted_lines
from kirigami_studio.outlines.source_file import decoding, read_bytes
from kirigami_studio.outlines.svg_safety import self_contained_svg

FORMATS = ("PNG", "JPEG", "BMP", "TIFF", "WEBP")
#: Larger pictures are averaged down: a sheet of 300 x 200 mm is printed at 500 dpi from so many pixels.
KEPT_PIXELS = 24_000_000
#: An SVG is drawn once, with so many pixels along its longer side.
SVG_SIDE = 3000
#: Points of the lines of an SVG that are kept, to be engraved on pieces.
MOST_LINE_POINTS = 100_000
#: Larger pictures (bytes) without transparency are kept as JPEG.
LARGEST_PNG = 8 * 2**20
JPEG_QUALITY = 95
#: The EXIF entry that says which way is up; 1 is upright.
ORIENTATION = 0x0112
#: Draws an SVG document, with so many pixels along its longer side, as PNG.
DrawSvg = Callable[[bytes, int], bytes]


def read_picture(path: str | Path, draw_svg: DrawSvg | None = None) -> ArtPicture:
    """Read a picture file for printing.

    Parameters
    ----------
    path : str or Path
        PNG, JPEG, BMP, TIFF, WebP or SVG, any colour mode, at most 100 million pixels.  Pictures of more than
        24 million pixels are averaged down to that.
    draw_svg : callable, optional
        Draws SVG documents; they are refused without.

    Raises
    ------
    TargetError
        No such file, no picture, a damaged one, or far too large.
    """
    path = Path(path)
    content = read_bytes(path, MOST_MEGABYTES)
    if path.suffix.lower() == ".svg":
        if draw_svg is None:
            raise TargetError("artwork.no_svg_here", name=path.name)
        with decoding(path, "artwork.picture_damaged"):
            drawing = self_contained_svg(content)
            picture = picture_of(path.name, draw_svg(drawing, SVG_SIDE))
            return replace(picture, lines=_lines_of(drawing, picture.size))
    with decoding(path, "artwork.picture_damaged"):
        return picture_of(path.name, content)


def _lines_of(drawing: bytes, size: tuple[int, int]) -> tuple[FloatArray, ...]:
    """The lines of an SVG in the pixels of its picture; none where there are too many."""
    try:
        lines = painted_lines(drawing, size)
    except TargetError:  # it is a picture all the same
        return ()
    return lines if sum(map(len, lines)) <= MOST_LINE_POINTS else ()


def picture_of(name: str, content: bytes) -> ArtPicture:
    """The picture that the bytes of a file hold; bytes that can be printed as they are stay the same.

    Parameters
    ----------
    content : bytes
        PNG, JPEG, BMP, TIFF or WebP.

    Raises
    ------
    TargetError
        Too many pixels.
    Exception
        Whatever Pillow raises on damaged files.
    """
    opened = opened_image(content, FORMATS)
    width, height = opened.size
    upright = ImageOps.exif_transpose(opened)
    image = _eight_bits(upright)
    reduction = math.ceil(math.sqrt(width * height / KEPT_PIXELS))
    if reduction > 1:
        image = image.reduce(reduction)
    plain = opened.format in ("PNG", "JPEG") and upright.size == opened.size and opened.mode == image.mode
    if plain and reduction == 1 and opened.getexif().get(ORIENTATION, 1) == 1:
        return ArtPicture(name, content, image.size)
    profile = opened.info.get("icc_profile") if opened.mode.startswith("RGB") else None
    return ArtPicture(name, _encoded(image, opened.format == "JPEG", profile), image.size)


def _eight_bits(image: Image.Image) -> Image.Image:
    """RGB, or RGBA where something is transparent; 16- and 32-bit greys from their darkest to their lightest."""
    if image.mode.startswith(("I", "F")):
        grey = np.asarray(image, dtype=np.float64)
        low, high = float(grey.min()), float(grey.max())
        if image.mode.startswith("I;16"):
            low, high = 0.0, 65535.0
        return Image.fromarray(np.uint8(np.round(255.0 * (grey - low) / max(high - low, 1e-12)))).convert("RGB")
    return image.convert("RGBA" if image.has_transparency_data else "RGB")


def _encoded(image: Image.Image, photo: bool, profile: bytes | None) -> bytes:
    """As PNG, or as JPEG where it was one or would be large and has no transparency; with its colour profile."""
    stream = io.BytesIO()
    if not photo:
        image.save(stream, format="PNG", icc_profile=profile)
        if stream.tell() <= LARGEST_PNG or image.mode == "RGBA":
            return stream.getvalue()
        stream = io.BytesIO()
    image.save(stream, format="JPEG", quality=JPEG_QUALITY, subsampling=0, icc_profile=profile)
    return stream.getvalue()
