"""Shapes that people would draw: an endless, seeded source of target outlines.

Random fields make silhouettes that all look like sheets; drawings have round sides, arms, notches and sharp corners.
Each family below makes one kind of drawing about the origin, of size about 1; what they make is rounded now and then,
stretched and turned.  Number k of seed s is always the same outline.  The silhouettes of the library are not used.
Letters come from the typeface that the PDF writer brings along (Bitstream Vera, four faces).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache
from importlib.resources import as_file, files

import numpy as np
import shapely
from numpy.random import Generator
from PIL import Image, ImageDraw, ImageFont
from shapely import BufferCapStyle, BufferJoinStyle, Polygon
from shapely.affinity import rotate, scale, translate

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.read_image import outline_of_mask

#: Faces of the letters.
FACES = ("Vera.ttf", "VeraBd.ttf", "VeraIt.ttf", "VeraBI.ttf")
#: One solid piece each.  L and T are left out because silhouettes of the library show them, and 7 with them: what the
#: studio is judged by is not what it learns from.
CHARACTERS = "ABCDEFGHJKMNOPQRSUVWXYZabcdefghkmnopqrstuvwxyz234568909&@#$"
#: Height of the letters in pixels: edges are smooth to a two-hundredth of it.
LETTER_PIXELS = 160
#: Stretch of a shape along an axis of its own choice: aspect 0.6 to 1.6.
ASPECTS = (0.6, 1.6)
#: Shapes of less area for their perimeter, 4 pi A / P^2 (1 for a circle), are thinner than ten voids can follow.
SMALLEST_COMPACTNESS = 0.2
#: Points of a curve that is drawn by a formula.
CURVE = 160


def drawn_shape(seed: int, number: int) -> Outline:
    """Shape ``number`` of ``seed``; its name is its family's."""
    rng = np.random.default_rng((seed, number))
    names = tuple(FAMILIES)
    shares = np.array([share for share, _ in FAMILIES.values()])
    while True:
        name = names[int(rng.choice(len(names), p=shares / shares.sum()))]
        try:
            outline = Outline.from_points(_varied(Polygon(FAMILIES[name][1](rng)), rng), name)
        except TargetError:
            # Some draws are not one shape: arms that miss each other, corners rounded away.
            continue
        perimeter = outline.polygon.length
        if 4 * math.pi / perimeter**2 >= SMALLEST_COMPACTNESS:
            return outline


def _varied(shape: Polygon, rng: Generator) -> FloatArray:
    """The shape as it was drawn: corners rounded or not, stretched, upright or turned."""
    shape = _solid(shape)
    to_unit_area = 1 / math.sqrt(shape.area)
    shape = scale(shape, to_unit_area, to_unit_area, origin=(0, 0))
    if rng.random() < 0.4:
        radius = rng.uniform(0.01, 0.1)
        shape = _solid(shape.buffer(-radius).buffer(2 * radius).buffer(-radius))
    stretch = math.exp(rng.uniform(*np.log(ASPECTS)) / 2)
    if rng.random() < 0.3:
        shape = rotate(shape, rng.uniform(0, 180), origin=(0, 0))
    shape = scale(shape, stretch, 1 / stretch, origin=(0, 0))
    if rng.random() < 0.6:
        shape = rotate(shape, rng.uniform(0, 360), origin=(0, 0))
    return _outer(shapely.simplify(shape, 1e-3))


def _solid(shape: shapely.Geometry) -> Polygon:
    """The largest piece without its holes."""
    pieces = [piece for piece in shapely.get_parts(shapely.make_valid(shape)) if isinstance(piece, Polygon)]
    if not pieces or max(pieces, key=shapely.area).area < 1e-6:
        raise TargetError("training.shape_without_area")
    return Polygon(max(pieces, key=shapely.area).exterior)


def _polar(radius: FloatArray, angle: FloatArray) -> FloatArray:
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def _turn(count: int) -> FloatArray:
    return np.linspace(0, 2 * math.pi, count, endpoint=False)


def _superellipse(rng: Generator) -> FloatArray:
    power = 2 / math.exp(rng.uniform(math.log(0.7), math.log(6)))
    t = _turn(CURVE)
    c, s = np.cos(t), np.sin(t)
    return np.stack([np.sign(c) * np.abs(c) ** power, np.sign(s) * np.abs(s) ** power], axis=1)


def _regular_polygon(rng: Generator) -> FloatArray:
    count = int(rng.integers(3, 10))
    return _polar(np.ones(count), _turn(count))


def _star(rng: Generator) -> FloatArray:
    count = int(rng.integers(3, 10))
    return _polar(np.where(np.arange(2 * count) % 2, rng.uniform(0.3, 0.85), 1.0), _turn(2 * count))


def _fourier_blob(rng: Generator) -> FloatArray:
    t = _turn(CURVE)
    order = np.arange(1, int(rng.integers(3, 8)))
    size = rng.normal(size=order.size) * rng.uniform(0.1, 0.5) / order ** rng.uniform(0.3, 1.2)
    phase = rng.uniform(0, 2 * math.pi, order.size)
    return _polar(np.exp((size * np.cos(np.outer(t, order) + phase)).sum(axis=1)), t)


def _petals(rng: Generator) -> FloatArray:
    t = _turn(2 * CURVE)
    count, depth = int(rng.integers(2, 8)), rng.uniform(0.1, 0.6)
    return _polar((1 - depth) + depth * np.abs(np.cos(0.5 * count * t)) ** rng.uniform(0.5, 2.0), t)


def _random_polygon(rng: Generator) -> FloatArray:
    count = int(rng.integers(3, 14))
    angle = _turn(count) + rng.uniform(-0.45, 0.45, count) * (2 * math.pi / count)
    return _polar(rng.uniform(rng.uniform(0.2, 0.8), 1.0, count), angle)


def _hull(rng: Generator) -> FloatArray:
    return _outer(shapely.MultiPoint(rng.normal(size=(int(rng.integers(4, 9)), 2))).convex_hull)


def _cross(rng: Generator) -> FloatArray:
    bars = [_box(0, 0, 1, rng.uniform(0.15, 0.5)), _box(0, rng.uniform(-0.4, 0.4), rng.uniform(0.15, 0.5), 1)]
    return _union(bars)


def _blocks(rng: Generator) -> FloatArray:
    """A few rectangles against each other: stairs, brackets, houses without roofs."""
    cells = rng.random((4, 4)) < rng.uniform(0.4, 0.7)
    # A hair of overlap keeps blocks that meet in an edge together.
    return _union([_box(column, row, 0.501, 0.501) for row, column in np.argwhere(cells)])


def _strokes(rng: Generator) -> FloatArray:
    """Thick pen strokes that start on each other: limbs, handles, signs."""
    pen = rng.uniform(0.12, 0.3)
    cap = (BufferCapStyle.round, BufferCapStyle.flat, BufferCapStyle.square)[int(rng.integers(3))]
    join = (BufferJoinStyle.round, BufferJoinStyle.mitre, BufferJoinStyle.bevel)[int(rng.integers(3))]
    start, pieces = np.zeros(2), []
    for _ in range(int(rng.integers(1, 4))):
        heading = rng.uniform(0, 2 * math.pi) + np.cumsum(rng.normal(size=int(rng.integers(1, 4))))
        way = _polar(rng.uniform(0.4, 1.0, heading.size), heading)
        line = np.concatenate([[start], start + np.cumsum(way, axis=0)])
        pieces.append(shapely.LineString(line).buffer(pen, cap_style=cap, join_style=join))
        start = line[int(rng.integers(len(line)))]
    return _union(pieces)


def _gear(rng: Generator) -> FloatArray:
    count, depth, tip = int(rng.integers(5, 13)), rng.uniform(0.1, 0.3), rng.uniform(0.25, 0.5)
    base = np.repeat(_turn(count), 4)
    place = np.tile([-tip, -0.6 * tip, 0.6 * tip, tip], count) * math.pi / count
    return _polar(np.tile([1 - depth, 1.0, 1.0, 1 - depth], count), base + place)


def _crescent(rng: Generator) -> FloatArray:
    whole, bite = shapely.Point(0, 0).buffer(1), shapely.Point(rng.uniform(0.35, 1.0), 0).buffer(rng.uniform(0.5, 1.0))
    return _outer(whole.difference(bite))


def _drop(rng: Generator) -> FloatArray:
    t, power = _turn(CURVE), rng.uniform(0.7, 3.0)
    return np.stack([np.sin(t) * np.abs(np.sin(t / 2)) ** power, np.cos(t) * rng.uniform(0.9, 1.5)], axis=1)


def _leaf(rng: Generator) -> FloatArray:
    reach = rng.uniform(0.3, 0.75)
    lens = shapely.Point(-reach, 0).buffer(1).intersection(shapely.Point(reach, rng.uniform(-0.3, 0.3)).buffer(1))
    return _outer(lens)


def _arrow(rng: Generator) -> FloatArray:
    shaft, head, neck, notch = rng.uniform([0.1, 0.35, -0.3, -0.2], [0.3, 0.7, 0.5, 0.25])
    half = np.array([[1, 0], [neck, head], [neck - notch, shaft], [-1, shaft * rng.uniform(0.6, 1.4)]])
    return np.concatenate([half, (half * [1, -1])[:0:-1]])


def glyph(rng: Generator) -> FloatArray:
    """One filled character: (L, 2), y up, pixels."""
    face = FACES[int(rng.integers(len(FACES)))]
    return _letter_outline(face, CHARACTERS[int(rng.integers(len(CHARACTERS)))])


@cache
def _letter_outline(face: str, character: str) -> FloatArray:
    with as_file(files("reportlab") / "fonts" / face) as path:
        font = ImageFont.truetype(str(path), LETTER_PIXELS)
    canvas = Image.new("L", (2 * LETTER_PIXELS, 2 * LETTER_PIXELS))
    ImageDraw.Draw(canvas).text((LETTER_PIXELS // 3, LETTER_PIXELS // 3), character, fill=255, font=font)
    return outline_of_mask(np.asarray(canvas) > 127, character).points


def _composition(rng: Generator) -> FloatArray:
    """Ellipses, boxes and triangles in a heap, half of them mirror-symmetric: mushrooms, bottles, vehicles."""
    pieces: list[shapely.Geometry] = []
    centred = rng.random() < 0.5
    for _ in range(int(rng.integers(2, 5))):
        maker = (_superellipse, _regular_polygon, _random_polygon)[int(rng.integers(3))]
        piece = rotate(_solid(Polygon(maker(rng))), 90 if centred else rng.uniform(0, 360), origin=(0, 0))
        width, height = rng.uniform(0.25, 0.9, 2)
        x, y = rng.uniform(-0.8, 0.8, 2)
        pieces.append(translate(scale(piece, width, height, origin=(0, 0)), 0 if centred else x, y))
    if centred:
        pieces += [scale(piece, -1, 1, origin=(0, 0)) for piece in pieces]
    return _union(pieces)


def _box(x: float, y: float, half_width: float, half_height: float) -> Polygon:
    return shapely.box(x - half_width, y - half_height, x + half_width, y + half_height)


def _union(pieces: Sequence[shapely.Geometry]) -> FloatArray:
    return _outer(shapely.union_all(pieces))


def _outer(shape: shapely.Geometry) -> FloatArray:
    return np.asarray(_solid(shape).exterior.coords, dtype=np.float64)[:-1]


#: How often each family is drawn, relative to the others.
FAMILIES: dict[str, tuple[float, Callable[[Generator], FloatArray]]] = {
    "superellipse": (1.0, _superellipse),
    "regular polygon": (1.0, _regular_polygon),
    "star": (1.5, _star),
    "blob": (1.5, _fourier_blob),
    "petals": (1.0, _petals),
    "polygon": (2.0, _random_polygon),
    "hull": (0.7, _hull),
    "cross": (0.7, _cross),
    "blocks": (1.0, _blocks),
    "strokes": (1.5, _strokes),
    "gear": (0.7, _gear),
    "crescent": (0.8, _crescent),
    "drop": (0.7, _drop),
    "leaf": (0.7, _leaf),
    "arrow": (1.0, _arrow),
    "glyph": (2.0, glyph),
    "composition": (2.5, _composition),
}
