"""Pictures of shapes whose silhouette is known: cut at borders and corners, pale, in uneven light, with shadows, noisy.

``pictures`` makes them; every one has the mask of the part of its shape that lies in the picture.
``python tests/synthetic_pictures.py`` reads all of them, prints a line of JSON on each kind and each that is silently
another shape, and a summary; ``make readers`` calls it.
"""

from __future__ import annotations

import collections
import io
import itertools
import json
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image, ImageChops, ImageDraw, ImageFilter

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.read_image import is_plain_picture, trace_image

#: Pixels of the longer side, and the overlap from which on both are the same shape.
SIDE, SAME = 256, 0.97
#: Times as fine as the picture in which shapes are drawn.
FINE = 4
SHAPES = ("rounded square", "disk", "star", "heart", "ring", "letter-l")
#: Middle of the shape and its size, shares of the picture: inside, at an edge, cut there, cut at a corner, larger.
PLACES = {
    "inside": (0.5, 0.5, 0.6),
    "at the left": (0.3, 0.5, 0.6),
    "cut at the top": (0.5, 0.2, 0.7),
    "cut at the right": (0.75, 0.55, 0.75),
    "cut at a corner": (0.22, 0.24, 0.8),
    "cut at another corner": (0.7, 0.72, 0.85),
    "fills the picture": (0.5, 0.5, 1.0),
}
Colour = tuple[int, int, int]
#: Colours of shape and ground.
COLOURS: dict[str, tuple[Colour, Colour]] = {
    "black on white": ((10, 10, 10), (255, 255, 255)),
    "white on dark green": ((255, 255, 255), (20, 80, 60)),
    "pale on white": ((250, 240, 205), (255, 255, 255)),
    "red on green": ((210, 40, 40), (60, 130, 60)),
    "light on wood": ((235, 232, 225), (150, 105, 70)),
    "white on grey": ((245, 245, 245), (150, 150, 150)),
}
#: Light and file: with a shadow beside the shape, with light from one side or corner, noisy, as JPEG, transparent.
WAYS = ("plain", "shadow", "light", "dark corner", "jpeg", "noise", "transparent")


@dataclass(frozen=True)
class Known:
    """A picture, and (H, W) bool where its shape is."""

    name: str
    kind: str
    content: bytes
    ending: str
    mask: np.ndarray


def shape_mask(name: str, place: tuple[float, float, float]) -> Image.Image:
    """Coverage of a shape, 0 to 255."""
    across, down, share = place
    size, fine = share * SIDE * FINE, SIDE * FINE
    image = Image.new("L", (fine, fine))
    draw = ImageDraw.Draw(image)
    left, top = across * fine - size / 2, down * fine - size / 2
    box = (left, top, left + size - 1, top + size - 1)
    if name == "rounded square":
        draw.rounded_rectangle(box, 0.2 * size, fill=255)
    elif name in ("disk", "ring"):
        draw.ellipse(box, fill=255)
        if name == "ring":
            inner = 0.25 * size
            draw.ellipse((left + inner, top + inner, left + size - inner, top + size - inner), fill=0)
    else:
        points = silhouettes.load(name).points * (1.0, -1.0)
        low, high = points.min(axis=0), points.max(axis=0)
        placed = (points - (low + high) / 2) * size / np.max(high - low) + (across * fine, down * fine)
        draw.polygon([tuple(point) for point in placed.tolist()], fill=255)
    return image.resize((SIDE, SIDE), Image.Resampling.BOX)


def painted(mask: Image.Image, colours: tuple[Colour, Colour], way: str, draw: np.random.Generator) -> Image.Image:
    """A picture of a shape."""
    shape, ground = colours
    below = Image.new("RGB", mask.size, ground)
    if way == "shadow":
        shadow = ImageChops.offset(mask, 5, 6)
        shadow.paste(0, (0, 0, SIDE, 6))
        shadow.paste(0, (0, 0, 5, SIDE))
        shadow = shadow.filter(ImageFilter.GaussianBlur(4)).point(lambda level: int(0.6 * level))
        below = Image.composite(Image.new("RGB", mask.size), below, shadow)
    image = Image.composite(Image.new("RGB", mask.size, shape), below, mask)
    y, x = np.mgrid[:SIDE, :SIDE] / (SIDE - 1.0)
    if way in ("light", "dark corner"):
        light = 0.55 + 0.45 * x if way == "light" else 1.0 - 0.5 * np.hypot(1.0 - x, 1.0 - y) / 1.42
        image = Image.fromarray((np.asarray(image) * light[..., None]).round().astype(np.uint8))
    elif way == "noise":
        grain = draw.normal(0.0, 5.0, (SIDE, SIDE, 3))
        image = Image.fromarray((np.asarray(image) + grain).clip(0, 255).astype(np.uint8))
    elif way == "transparent":
        image = Image.new("RGB", mask.size, shape)
        image.putalpha(mask)
    return image


def known(shape: str, place: str, colours: str, way: str, seed: int = 0) -> Known:
    """One picture; a shape that fills all of it has no ground."""
    mask = shape_mask(shape, PLACES[place])
    image = painted(mask, COLOURS[colours], way, np.random.default_rng(seed))
    stream, ending = io.BytesIO(), ".jpg" if way in ("jpeg", "shadow", "light") else ".png"
    image.save(stream, {".jpg": "JPEG", ".png": "PNG"}[ending], quality=80)
    name = ", ".join((shape, place, colours, way))
    return Known(name, way, stream.getvalue(), ending, np.asarray(mask) >= 128)


def pictures(every: int = 1) -> Iterator[Known]:
    """Every so many of all combinations, the same ones each time."""
    for number, words in enumerate(itertools.product(SHAPES, PLACES, COLOURS, WAYS), start=1):
        shape, place, colours, way = words
        is_whole = (shape, place) == ("rounded square", "fills the picture")
        is_repeated = way == "transparent" and colours != "black on white"
        if not (number % every or is_whole or is_repeated):
            yield known(shape, place, colours, way, number)


def overlap(one: Known, path: Path) -> float:
    """IoU of a picture as it is read with its shape, holes filled."""
    from scipy import ndimage
    from skimage.draw import polygon2mask

    traced = trace_image(path)
    points = traced.outline.points * traced.scale + traced.centre
    rows = one.mask.shape[0] - points[:, 1] - 0.5
    drawn = polygon2mask(one.mask.shape, np.column_stack([rows, points[:, 0] - 0.5]))
    # A ring that the picture cuts is filled where its hole is enclosed.
    wanted = ndimage.binary_fill_holes(one.mask)
    return float(np.sum(drawn & wanted) / np.sum(drawn | wanted))


def judged(one: Known, folder: Path) -> tuple[str, float]:
    """The result, one of same, asked, refused and silent; and the overlap."""
    path = folder / f"known{one.ending}"
    path.write_bytes(one.content)
    try:
        share = overlap(one, path)
    except KirigamiError:
        return "refused", 0.0
    if share >= SAME:
        return "same" if is_plain_picture(path) else "same, asked", share
    return "silent" if is_plain_picture(path) else "asked", share


def main() -> int:
    """Judge all pictures and print the shares."""
    every = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    by_kind: dict[str, collections.Counter[str]] = collections.defaultdict(collections.Counter)
    with tempfile.TemporaryDirectory() as place:
        for one in pictures(every):
            result, share = judged(one, Path(place))
            by_kind[one.kind][result] += 1
            if result == "silent":
                sys.stdout.write(json.dumps({"silent": one.name, "iou": round(share, 3)}) + "\n")
    for kind, results in by_kind.items():
        sys.stdout.write(json.dumps({"kind": kind, **results}) + "\n")
    total = sum(by_kind.values(), collections.Counter())
    sys.stdout.write(json.dumps({"kind": "pictures", "pictures": total.total(), **total}) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
