"""Patches of pictures -> pixels, each patch resampled once, with smooth edges."""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import shapely
from PIL import Image, ImageDraw

from kirigami_studio.export.artwork import ArtPicture
from kirigami_studio.export.artwork_patches import Patch, rings_of
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.units import MM_PER_INCH

#: Larger bitmaps are refused.
MOST_PIXELS = 100_000_000
#: Edges of regions are drawn so many times larger and then reduced.
SUPERSAMPLING = 4
#: Patches whose pixels on a millimetre agree so well are made from one reduced picture.
DENSITY_DECIMALS = 5
Colour = tuple[int, int, int, int]
NOTHING: Colour = (255, 255, 255, 0)


def most_dpi(width_mm: float, height_mm: float) -> int:
    """The finest whole resolution that a bitmap of a size may have."""
    dots_per_mm = math.sqrt(MOST_PIXELS / (width_mm * height_mm))
    return math.floor(dots_per_mm * MM_PER_INCH - 0.5)  # half a dot less: rows and columns are rounded up


@dataclass(frozen=True, slots=True)
class BitmapFrame:
    """A rectangle of the plane as a bitmap; its upper left corner is that of pixel (0, 0).

    Raises
    ------
    ExportError
        More pixels than a bitmap may have, or a resolution that is not above 0.
    """

    #: low, high: (x, y), mm; its corners; y up.
    low: tuple[float, float]
    high: tuple[float, float]
    dpi: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.dpi) and self.dpi > 0.0):
            raise ExportError("artwork.impossible_dpi", dpi=self.dpi)
        width, height = self.pixels
        if width * height > MOST_PIXELS:
            most = math.floor(self.dpi * math.sqrt(MOST_PIXELS / (width * height)))
            raise ExportError("artwork.too_many_pixels", width=width, height=height, dpi=self.dpi, most_dpi=most)

    @property
    def dots_per_mm(self) -> float:
        return self.dpi / MM_PER_INCH

    @property
    def pixels(self) -> tuple[int, int]:
        """Width and height; the last row and column may reach beyond the page."""
        width, height = (
            max(1, math.ceil((far - near) * self.dots_per_mm - 1e-6))
            for near, far in zip(self.low, self.high, strict=True)
        )
        return width, height

    def to_pixels(self, points: FloatArray) -> FloatArray:
        """Points (P, 2) in mm -> pixels (P, 2), y down."""
        corner = np.array([self.low[0], self.high[1]])
        pixels: FloatArray = (points - corner) * (self.dots_per_mm, -self.dots_per_mm)
        return pixels

    def to_plane(self, pixel: complex) -> complex:
        """A place u + iv of the bitmap, v down -> mm."""
        return complex(self.low[0], self.high[1]) + pixel.conjugate() / self.dots_per_mm


def paint(patches: Sequence[Patch], page: BitmapFrame, ground: Colour = NOTHING) -> Image.Image:
    """Paint patches, whose frame is in mm, one over the other: RGBA."""
    canvas = Image.new("RGBA", page.pixels, ground)
    sources: dict[tuple[ArtPicture, float], Image.Image] = {}
    for patch in patches:
        density = round(patch.dots_per_mm, DENSITY_DECIMALS)
        if (patch.picture, density) not in sources:
            sources[patch.picture, density] = _reduced(patch.picture, page.dots_per_mm / patch.dots_per_mm)
        _paint_patch(canvas, patch, sources[patch.picture, density], page)
    return canvas


@lru_cache(maxsize=2)
def image_of(content: bytes) -> Image.Image:
    """The pixels of a picture file as RGBA, kept for the next time and not to be written to."""
    with Image.open(io.BytesIO(content)) as image:
        return image.convert("RGBA")


def _reduced(picture: ArtPicture, share: float) -> Image.Image:
    """The picture with as many pixels as the bitmap has for it, if that is fewer: sampling would skip some.

    Its colours are multiplied by its alpha, as all resampling needs them: Pillow would do that again for every patch.
    """
    image = image_of(picture.content)
    if share < 1.0:
        width, height = (max(1, round(side * share)) for side in picture.size)
        image = image.resize((width, height), Image.Resampling.LANCZOS)
    return image.convert("RGBa")


def _paint_patch(canvas: Image.Image, patch: Patch, source: Image.Image, page: BitmapFrame) -> None:
    low_x, low_y, high_x, high_y = patch.region.bounds
    near = page.to_pixels(np.array([[low_x, high_y], [high_x, low_y]]))
    left, top = (max(0, math.floor(value)) for value in near[0].tolist())
    right, bottom = (min(math.ceil(value), side) for value, side in zip(near[1].tolist(), canvas.size, strict=True))
    if right <= left or bottom <= top:
        return
    size = (right - left, bottom - top)
    # Pillow's matrix leads from the bitmap to the source.
    shrunk = (source.width / patch.picture.size[0], source.height / patch.picture.size[1])
    start, across, down = (
        ((page.to_plane(complex(left, top) + step) - patch.shift) / patch.factor).conjugate() for step in (0, 1, 1j)
    )
    across, down = across - start, down - start
    matrix = (
        across.real * shrunk[0], down.real * shrunk[0], start.real * shrunk[0],
        across.imag * shrunk[1], down.imag * shrunk[1], start.imag * shrunk[1],
    )  # fmt: skip
    shown = source.transform(size, Image.Transform.AFFINE, matrix, Image.Resampling.BICUBIC).convert("RGBA")
    mask = _mask(patch, page, (left, top), size)
    shown = Image.alpha_composite(canvas.crop((left, top, right, bottom)), shown)
    canvas.paste(shown, (left, top), mask)


def _mask(patch: Patch, page: BitmapFrame, corner: tuple[int, int], size: tuple[int, int]) -> Image.Image:
    """How much of each pixel a region covers."""
    large = Image.new("L", (size[0] * SUPERSAMPLING, size[1] * SUPERSAMPLING), 0)
    draw = ImageDraw.Draw(large)
    for part in shapely.get_parts(patch.region):
        outer, *holes = rings_of(part)
        for ring, fill in ((outer, 255), *((hole, 0) for hole in holes)):
            places = (page.to_pixels(ring) - corner) * SUPERSAMPLING - 0.5
            draw.polygon([(x, y) for x, y in places.tolist()], fill=fill)
    return large.reduce(SUPERSAMPLING)
