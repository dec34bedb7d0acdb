"""Letters and digits as outlines, from the typeface that the PDF writer brings along (Bitstream Vera, four faces)."""

from __future__ import annotations

from functools import cache
from importlib.resources import as_file, files

import numpy as np
from numpy.random import Generator
from PIL import Image, ImageDraw, ImageFont

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.outlines.read_image import outline_of_mask

FACES = ("Vera.ttf", "VeraBd.ttf", "VeraIt.ttf", "VeraBI.ttf")
#: One solid piece each.  L and T are left out because silhouettes of the library show them, and 7 with them: what the
#: studio is judged by is not what it learns from.
CHARACTERS = "ABCDEFGHJKMNOPQRSUVWXYZabcdefghkmnopqrstuvwxyz234568909&@#$"
#: Height of the letters in pixels: edges are smooth to a two-hundredth of it.
SIZE = 160


def glyph(rng: Generator) -> FloatArray:
    """One filled character: (L, 2), y up, pixels."""
    face = FACES[int(rng.integers(len(FACES)))]
    return _outline(face, CHARACTERS[int(rng.integers(len(CHARACTERS)))])


@cache
def _outline(face: str, character: str) -> FloatArray:
    with as_file(files("reportlab") / "fonts" / face) as path:
        font = ImageFont.truetype(str(path), SIZE)
    canvas = Image.new("L", (2 * SIZE, 2 * SIZE))
    ImageDraw.Draw(canvas).text((SIZE // 3, SIZE // 3), character, fill=255, font=font)
    return outline_of_mask(np.asarray(canvas) > 127, character).points
