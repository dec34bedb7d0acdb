"""Pictures on a sheet: one or two, and their places on the opened or on the flat sheet.

Points of the plane are complex numbers x + iy with y up, pixels are u + iv with v down from the picture's upper left
corner; a picture with the map (a, b) shows its pixel p at a conj(p) + b.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import ExportError, TargetError

#: Larger pictures (bytes) are refused: projects store them.
LARGEST_PICTURE = 16 * 2**20
#: A picture that fills the box also covers so much around it, in longer sides of the box: room for the bleed.
BEYOND = 0.02
SMALLEST_SCALE, LARGEST_SCALE = 0.01, 100.0
#: Stripes across a sheet with two pictures: 0.6 mm each where it is 100 mm wide.
USUAL_STRIPES, FEWEST_STRIPES, MOST_STRIPES = 160, 2, 1000


@dataclass(frozen=True, slots=True)
class ArtPicture:
    """A picture to be printed.

    Raises
    ------
    TargetError
        Too many bytes for a project to keep, or no pixels.
    """

    name: str  #: of the file it was read from
    content: bytes  #: PNG or JPEG, upright, 8 bits a channel, RGB or RGBA
    size: tuple[int, int]  #: (width, height), pixels
    #: tuple of (P, 2) float, pixels; lines of an SVG, which pieces get engraved; a closed one repeats its first point
    lines: tuple[FloatArray, ...] = field(default=(), compare=False, repr=False)
    line_hash: int = field(default=0, init=False, repr=False)  #: of the lines, by which pictures are compared

    def __post_init__(self) -> None:
        object.__setattr__(self, "line_hash", hash(tuple(line.tobytes() for line in self.lines)) if self.lines else 0)
        if len(self.content) > LARGEST_PICTURE or min(self.size) < 1:
            megabytes, limit = len(self.content) / 2**20, LARGEST_PICTURE // 2**20
            raise TargetError("artwork.picture_too_large", name=self.name, megabytes=megabytes, limit=limit)

    @property
    def is_jpeg(self) -> bool:
        """Whether its bytes are a JPEG's; they are a PNG's else."""
        return self.content.startswith(b"\xff\xd8")

    @property
    def extension(self) -> str:
        """Of a file with these bytes, with the dot."""
        return ".jpg" if self.is_jpeg else ".png"


class SheetState(Enum):
    """Where a picture is seen whole."""

    TARGET = "target"
    FLAT = "flat"


class PictureFit(Enum):
    """How large a picture is laid: all of it inside the box of the state, or all of the box covered."""

    FIT = "fit"
    FILL = "fill"


@dataclass(frozen=True, slots=True)
class Laid:
    """A picture and where it lies.

    Raises
    ------
    ExportError
        Numbers that no placed picture has.
    """

    picture: ArtPicture
    state: SheetState = SheetState.TARGET  #: on the target, or on the flat sheet
    fitting: PictureFit = PictureFit.FILL  #: into the box around the target, or around the flat sheet
    scale: float = 1.0  #: times the size that ``fitting`` gives, above 0
    turn: float = 0.0  #: radians; counter-clockwise, about the picture's middle
    #: (x, y); of the picture's middle from the box's, in widths and heights of the box.
    shift: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        numbers = (self.scale, self.turn, *self.shift)
        if not all(map(math.isfinite, numbers)) or not SMALLEST_SCALE <= self.scale <= LARGEST_SCALE:
            raise ExportError(
                "artwork.impossible_place", scale=self.scale, smallest=SMALLEST_SCALE, largest=LARGEST_SCALE
            )

    def map_into(self, low: FloatArray, high: FloatArray) -> tuple[complex, complex]:
        """The picture's map (a, b) into the frame of a box from ``low`` (2,) to ``high`` (2,)."""
        size = high - low
        if self.fitting is PictureFit.FILL:
            size = size + 2.0 * BEYOND * float(size.max())
        width, height = self.picture.size
        ratios = (float(size[0]) / width, float(size[1]) / height)
        length = min(ratios) if self.fitting is PictureFit.FIT else max(ratios)
        factor = self.scale * length * cmath.exp(1j * self.turn)
        x, y = (0.5 * (low + high) + np.array(self.shift) * (high - low)).tolist()
        return factor, complex(x, y) - factor * complex(0.5 * width, -0.5 * height)


@dataclass(frozen=True, slots=True)
class Artwork:
    """The pictures on a sheet.

    Raises
    ------
    ExportError
        Fewer than 2 stripes or more than 1000.
    """

    first: Laid
    second: ArtPicture | None = None  #: seen whole in the other state, in stripes between those of the first one
    stripes: int = USUAL_STRIPES  #: stripes of both across the width of the flat sheet

    def __post_init__(self) -> None:
        if not FEWEST_STRIPES <= self.stripes <= MOST_STRIPES:
            raise ExportError("artwork.stripes", stripes=self.stripes, fewest=FEWEST_STRIPES, most=MOST_STRIPES)

    @property
    def has_lines(self) -> bool:
        """Whether a picture of it has lines, which pieces get engraved."""
        return any(laid.picture.lines for laid in self.laid)

    @property
    def laid(self) -> tuple[Laid, ...]:
        """Both pictures as they lie; the second one is neither turned nor shifted."""
        if self.second is None:
            return (self.first,)
        other = SheetState.FLAT if self.first.state is SheetState.TARGET else SheetState.TARGET
        return self.first, Laid(self.second, other, self.first.fitting)
