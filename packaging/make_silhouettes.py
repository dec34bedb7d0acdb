"""Make the bundled silhouettes: ``python packaging/make_silhouettes.py`` rewrites resources/silhouettes/.

Every shape is a construction of circles, polygons and splines made here; nothing is traced from artwork.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import shapely
from scipy.interpolate import CubicSpline
from shapely.affinity import rotate, scale, translate
from shapely.geometry import Point, Polygon, box
from shapely.geometry.base import BaseGeometry

FOLDER = Path(__file__).resolve().parents[1] / "resources" / "silhouettes"

#: Vertices of a stored silhouette at most; the tolerance below, at area 1, is 1/13 of a pixel of a 128-pixel raster.
MOST_VERTICES = 300
TOLERANCE = 6e-4

Pairs = Sequence[tuple[float, float]]


class Silhouette(NamedTuple):
    name: str
    title: str
    about: str
    make: Callable[[], BaseGeometry]


def regular(corners: int, turn: float = 0.0) -> Polygon:
    """Regular polygon of radius 1, one corner up, turned by ``turn`` degrees."""
    angle = np.pi / 2 + 2 * np.pi * np.arange(corners) / corners + np.deg2rad(turn)
    return Polygon(np.column_stack([np.cos(angle), np.sin(angle)]))


def pointed_star(points: int, inner: float) -> Polygon:
    """Star of outer radius 1 and inner radius ``inner``, one point up."""
    angle = np.pi / 2 + np.pi * np.arange(2 * points) / points
    r = np.where(np.arange(2 * points) % 2 == 0, 1.0, inner)
    return Polygon(np.column_stack([r * np.cos(angle), r * np.sin(angle)]))


def ellipse(x: float, y: float, a: float, b: float, turn: float = 0.0) -> BaseGeometry:
    """Filled ellipse around (x, y) with half axes a, b, turned by ``turn`` degrees."""
    return translate(rotate(scale(disc(0, 0, 1), a, b, origin=(0, 0)), turn, origin=(0, 0)), x, y)


def disc(x: float, y: float, r: float) -> BaseGeometry:
    return Point(x, y).buffer(r, quad_segs=64)


def union(*parts: BaseGeometry) -> BaseGeometry:
    return shapely.unary_union(parts)


def rounded(shape: BaseGeometry, convex: float, concave: float | None = None) -> BaseGeometry:
    """Round outer corners by radius ``convex`` and inner corners by ``concave`` (default: the same)."""
    inward = convex if concave is None else concave
    shape = shape.buffer(-convex, quad_segs=32).buffer(convex, quad_segs=32)
    return shape.buffer(inward, quad_segs=32).buffer(-inward, quad_segs=32)


def smooth(points: Pairs) -> Polygon:
    """Closed curve: periodic cubic spline through the points, centripetal parameter."""
    closed = np.array([*points, points[0]], dtype=np.float64)
    knots = np.concatenate([[0.0], np.cumsum(np.sqrt(np.linalg.norm(np.diff(closed, axis=0), axis=1)))])
    spline = CubicSpline(knots, closed, bc_type="periodic")
    return Polygon(spline(np.linspace(0, knots[-1], 800, endpoint=False)))


def arc(points: Pairs) -> list[tuple[float, float]]:
    """Open curve through the points (natural spline), as vertices to be joined with others."""
    line = np.array(points, dtype=np.float64)
    knots = np.concatenate([[0.0], np.cumsum(np.sqrt(np.linalg.norm(np.diff(line, axis=0), axis=1)))])
    spline = CubicSpline(knots, line, bc_type="natural")
    return [(float(x), float(y)) for x, y in spline(np.linspace(0, knots[-1], 160))]


def mirrored(right: Pairs) -> Polygon:
    """Close a right half, given from top to bottom, by its mirror image in the y axis."""
    return Polygon([*right, *[(-x, y) for x, y in reversed(right)]]).buffer(0)


def heart() -> BaseGeometry:
    t = 2 * np.pi * np.arange(720) / 720
    x = 16 * np.sin(t) ** 3
    y = 13 * np.cos(t) - 5 * np.cos(2 * t) - 2 * np.cos(3 * t) - np.cos(4 * t)
    return Polygon(np.column_stack([x, y])).buffer(0)


def drop() -> BaseGeometry:
    # The two tangents from the tip to a circle.
    tip, r = 2.4, 1.0
    touch = np.arcsin(r / tip)
    corner = (r * np.cos(touch), r * np.sin(touch))
    return union(disc(0, 0, r), Polygon([(0, tip), (-corner[0], corner[1]), corner]))


def leaf() -> BaseGeometry:
    blade = mirrored(arc([(0.0, 2.0), (0.42, 1.35), (0.78, 0.35), (0.72, -0.5), (0.3, -1.15), (0.0, -1.38)]))
    stem = Polygon([(-0.09, -1.2), (0.09, -1.2), (0.13, -2.0), (-0.13, -2.0)])
    return rounded(rotate(union(blade, stem), -35, origin=(0, 0)), 0.015, 0.08)


def around(part: BaseGeometry, count: int) -> BaseGeometry:
    """Union of ``count`` copies of a part, turned evenly around the origin."""
    return union(*(rotate(part, 360 * k / count, origin=(0, 0)) for k in range(count)))


def flower() -> BaseGeometry:
    return rounded(union(around(ellipse(0, 0.95, 0.6, 0.75), 5), disc(0, 0, 0.7)), 0.0, 0.12)


def clover() -> BaseGeometry:
    lobe = translate(scale(heart(), 1 / 17, 1 / 17, origin=(0, 0)), 0, 1.02)
    leaves = around(lobe, 3)
    stem = Polygon([(-0.12, 0.1), (0.12, 0.1), (0.12, -1.2), (0.26, -1.95), (-0.06, -2.0), (-0.1, -1.2)])
    return rounded(union(leaves, disc(0, 0, 0.25), stem), 0.04, 0.1)


def crescent() -> BaseGeometry:
    moon = disc(0, 0, 1.0).difference(disc(0.52, 0.0, 0.8))
    return rounded(rotate(moon, 25, origin=(0, 0)), 0.03, 0.0)


def egg() -> BaseGeometry:
    t = 2 * np.pi * np.arange(720) / 720
    return Polygon(np.column_stack([0.76 * np.cos(t) * (1 - 0.2 * np.sin(t)), np.sin(t)]))


def bean() -> BaseGeometry:
    return smooth([(-1.2, -0.1), (-0.9, 0.65), (0.0, 1.0), (0.9, 0.65), (1.2, -0.1), (0.85, -0.62), (0.4, -0.36),
                   (0.0, -0.2), (-0.4, -0.36), (-0.85, -0.62)])  # fmt: skip


def shield() -> BaseGeometry:
    side = arc([(1.0, 0.9), (1.02, 0.1), (0.72, -0.75), (0.0, -1.45)])
    top = arc([(0.0, 1.2), (0.35, 1.06), (0.7, 0.98), (1.0, 1.02)])
    return mirrored([*top, *side])


def bone() -> BaseGeometry:
    ends = union(*(disc(x, y, 0.5) for x in (-1.5, 1.5) for y in (-0.4, 0.4)))
    return rounded(union(ends, box(-1.5, -0.32, 1.5, 0.32)), 0.0, 0.18)


def butterfly() -> BaseGeometry:
    upper = smooth([(0.0, 0.05), (0.3, 0.75), (0.95, 1.35), (1.6, 1.3), (1.7, 0.75), (1.3, 0.15), (0.6, -0.1)])
    lower = smooth([(0.0, 0.1), (0.75, 0.05), (1.2, -0.3), (1.15, -0.95), (0.7, -1.25), (0.3, -0.85), (0.0, -0.35)])
    wings = union(upper, lower)
    body = ellipse(0, 0.0, 0.17, 0.95)
    return rounded(union(wings, scale(wings, -1, 1, origin=(0, 0)), body), 0.03, 0.08)


def fish() -> BaseGeometry:
    back = arc([(-1.55, 0.05), (-0.9, 0.68), (0.0, 0.78), (0.8, 0.36), (1.25, 0.14)])
    belly = arc([(1.25, -0.14), (0.8, -0.42), (0.0, -0.72), (-0.9, -0.55), (-1.55, 0.05)])
    body = Polygon([*back, *belly])
    tail = Polygon([(1.0, 0.0), (2.0, 0.82), (1.78, 0.0), (2.0, -0.82)])
    fin = Polygon([(-0.55, 0.6), (0.15, 1.15), (0.75, 1.1), (0.6, 0.35)])
    lower_fin = Polygon([(-0.1, -0.6), (0.35, -1.05), (0.7, -1.0), (0.55, -0.4)])
    return rounded(union(body, tail, fin, lower_fin), 0.05, 0.12)


def cloud() -> BaseGeometry:
    puffs = [(-1.05, 0.0, 0.52), (-0.42, 0.38, 0.6), (0.4, 0.48, 0.72), (1.1, 0.02, 0.55)]
    return rounded(union(*(disc(*puff) for puff in puffs), box(-1.05, -0.52, 1.1, 0.1)), 0.0, 0.07)


def gear() -> BaseGeometry:
    tooth = Polygon([(-0.24, 0.8), (0.24, 0.8), (0.15, 1.24), (-0.15, 1.24)])
    return rounded(union(disc(0, 0, 0.95), around(tooth, 10)), 0.035, 0.05)


def bell() -> BaseGeometry:
    flank = arc([(0.1, 1.05), (0.5, 0.85), (0.68, 0.2), (0.76, -0.4), (1.12, -0.85)])
    dome = mirrored([(0.0, 1.07), *flank, (1.12, -1.0), (0.0, -1.0)])
    return rounded(union(dome, disc(0, -1.02, 0.27), disc(0, 1.1, 0.17)), 0.04, 0.04)


def vase() -> BaseGeometry:
    flank = arc([(0.62, 1.6), (0.36, 1.25), (0.32, 0.95), (0.72, 0.35), (0.92, -0.25), (0.72, -0.95), (0.45, -1.4)])
    return rounded(mirrored([(0.0, 1.6), *flank, (0.52, -1.55), (0.0, -1.55)]), 0.03, 0.03)


def pick() -> BaseGeometry:
    # Reuleaux-like triangle: three discs, each around one corner, a little larger than the triangle's side.
    corners = shapely.get_coordinates(regular(3, 180))[:3]
    bulged = shapely.intersection_all([disc(float(x), float(y), 2.0) for x, y in corners])
    return scale(rounded(bulged, 0.28, 0.0), 1.0, 1.15)


def puzzle() -> BaseGeometry:
    knob, neck = disc(0, 0.27, 0.27), box(-0.15, -0.1, 0.15, 0.2)
    tab = union(knob, neck)
    plate = union(box(-1, -1, 1, 1), translate(tab, 0, 1), translate(rotate(tab, -90, origin=(0, 0)), 1, 0))
    socket = union(translate(tab, 0, -1), translate(rotate(tab, -90, origin=(0, 0)), -1, 0))
    return rounded(plate.difference(socket), 0.03, 0.05)


def mushroom() -> BaseGeometry:
    cap = mirrored([*arc([(0.0, 1.1), (0.7, 0.92), (1.2, 0.3), (1.22, 0.0)]), *arc([(1.05, -0.12), (0.0, -0.2)])])
    stalk = mirrored([(0.0, 0.1), *arc([(0.4, 0.1), (0.36, -0.5), (0.5, -1.1)]), (0.3, -1.2), (0.0, -1.2)])
    return rounded(union(cap, stalk), 0.08, 0.06)


def speech() -> BaseGeometry:
    tail = Polygon([(-0.75, -0.3), (-0.15, -0.5), (-0.85, -1.35)])
    return rounded(union(rounded(box(-1.3, -0.75, 1.3, 0.8), 0.35), tail), 0.03, 0.03)


def fir() -> BaseGeometry:
    tiers = [Polygon([(0, 1.8), (-0.7, 0.8), (0.7, 0.8)]), Polygon([(0, 1.3), (-0.95, 0.0), (0.95, 0.0)]),
             Polygon([(0, 0.7), (-1.2, -0.95), (1.2, -0.95)])]  # fmt: skip
    return rounded(union(*tiers, box(-0.22, -1.5, 0.22, -0.9)), 0.02, 0.02)


def pear() -> BaseGeometry:
    flank = arc(
        [(0.0, 1.45), (0.3, 1.32), (0.46, 0.85), (0.68, 0.25), (0.98, -0.4), (0.8, -1.12), (0.35, -1.36), (0.0, -1.4)]
    )
    stem = rotate(box(-0.07, 1.3, 0.07, 1.8), -12, origin=(0, 1.3))
    return rounded(union(mirrored(flank), stem), 0.02, 0.05)


def hourglass() -> BaseGeometry:
    flank = arc([(0.85, 1.2), (0.8, 0.85), (0.28, 0.2), (0.22, 0.0), (0.28, -0.2), (0.8, -0.85), (0.85, -1.2)])
    return rounded(mirrored([(0.0, 1.2), *flank, (0.0, -1.2)]), 0.04, 0.0)


def wave() -> BaseGeometry:
    x = np.linspace(-1.6, 1.6, 300)
    y = 0.22 * np.sin(2 * np.pi * x / 1.6)
    ribbon = [*zip(x, y + 0.5, strict=True), *zip(x[::-1], y[::-1] - 0.5, strict=True)]
    return Polygon(ribbon)


def face() -> BaseGeometry:
    smile = disc(0, 0.1, 0.66).intersection(box(-1, -1, 1, -0.12)) - disc(0, 0.3, 0.62)
    return disc(0, 0, 1) - rounded(smile, 0.03) - ellipse(-0.36, 0.3, 0.16, 0.2) - ellipse(0.36, 0.3, 0.16, 0.2)


def letter_a() -> BaseGeometry:
    whole = Polygon([(-1.15, -1.2), (-0.45, 1.2), (0.45, 1.2), (1.15, -1.2)])
    hole = Polygon([(-0.33, -0.18), (0.33, -0.18), (0, 0.78)])
    return whole - hole - Polygon([(-0.62, -1.3), (0.62, -1.3), (0.47, -0.75), (-0.47, -0.75)])


def letter_b() -> BaseGeometry:
    upper = union(box(-0.8, 0, 0.25, 1.2), disc(0.25, 0.6, 0.6))
    lower = union(box(-0.8, -1.2, 0.25, 0.1), disc(0.25, -0.55, 0.65))
    holes = union(
        box(-0.25, 0.38, 0.2, 0.82), disc(0.2, 0.6, 0.22), box(-0.25, -0.8, 0.22, -0.3), disc(0.22, -0.55, 0.25)
    )
    return rounded(union(upper, lower), 0.0, 0.05) - holes


SILHOUETTES: tuple[Silhouette, ...] = (
    Silhouette("circle", "Circle", "Smooth and convex; corners of the sheet have to vanish.", lambda: disc(0, 0, 1)),
    Silhouette("ellipse", "Ellipse", "A circle stretched 8 to 5.", lambda: ellipse(0, 0, 1.6, 1.0)),
    Silhouette("square", "Square", "The easiest target: the uniform sheet itself.", lambda: box(-1, -1, 1, 1)),
    Silhouette("rectangle", "Rectangle", "A square stretched 8 to 5.", lambda: box(-1.6, -1, 1.6, 1)),
    Silhouette("triangle", "Triangle", "Three sharp corners; a sheet has four.", lambda: regular(3)),
    Silhouette("pentagon", "Pentagon", "Five equal sides.", lambda: regular(5)),
    Silhouette("hexagon", "Hexagon", "Six equal sides.", lambda: regular(6)),
    Silhouette("octagon", "Octagon", "Eight equal sides, nearly a circle.", lambda: regular(8, 22.5)),
    Silhouette("star", "Star", "Five points and five deep notches.", lambda: pointed_star(5, 0.45)),
    Silhouette("six-point-star", "Six-point star", "Two triangles, one upside down.", lambda: pointed_star(6, 3**-0.5)),
    Silhouette("heart", "Heart", "One notch and one point on a smooth curve.", heart),
    Silhouette("drop", "Drop", "A circle with one sharp tip.", drop),
    Silhouette("leaf", "Leaf", "A slanting blade with a stem.", leaf),
    Silhouette("flower", "Flower", "Five round petals.", flower),
    Silhouette("clover", "Clover", "Three heart-shaped leaves on a stem.", clover),
    Silhouette("cross", "Cross", "An upright with a crossbar above the middle.",
               lambda: union(box(-0.32, -1.5, 0.32, 1.1), box(-0.95, 0.0, 0.95, 0.62))),
    Silhouette("plus", "Plus", "Four equal arms.", lambda: union(box(-0.4, -1.2, 0.4, 1.2), box(-1.2, -0.4, 1.2, 0.4))),
    Silhouette("arrow", "Arrow", "A shaft with a wide head.",
               lambda: union(box(-1.5, -0.4, 0.3, 0.4), Polygon([(0.25, 0.95), (0.25, -0.95), (1.5, 0)]))),
    Silhouette("crescent", "Crescent", "A moon with two thin horns: hard.", crescent),
    Silhouette("egg", "Egg", "An oval with a blunt and a narrow end.", egg),
    Silhouette("bean", "Bean", "A rounded shape with one shallow bay.", bean),
    Silhouette("shield", "Shield", "Straight shoulders and a pointed foot.", shield),
    Silhouette("bone", "Bone", "Four knobs on a narrow shaft.", bone),
    Silhouette("butterfly", "Butterfly", "Two pairs of wings around a body.", butterfly),
    Silhouette("fish", "Fish", "Body, fins and a forked tail.", fish),
    Silhouette("cloud", "Cloud", "Round puffs on a flat base.", cloud),
    Silhouette("gear", "Gear", "Ten teeth: fine detail for fine grids.", gear),
    Silhouette("letter-l", "Letter L", "Two bars meeting in one inner corner.",
               lambda: union(box(0, 0, 0.75, 2.4), box(0, 0, 1.7, 0.75))),
    Silhouette("letter-t", "Letter T", "A bar on a stem.",
               lambda: union(box(-1.1, 0.6, 1.1, 1.3), box(-0.36, -1.2, 0.36, 1.3))),
    Silhouette("house", "House", "A gable with a chimney.",
               lambda: union(Polygon([(-1, -1), (1, -1), (1, 0.25), (1.25, 0.25), (0, 1.4), (-1.25, 0.25), (-1, 0.25)]),
                             box(0.5, 0.3, 0.8, 1.3))),
    Silhouette("bell", "Bell", "A flared skirt with a clapper.", bell),
    Silhouette("vase", "Vase", "A belly under a narrow neck.", vase),
    Silhouette("pick", "Guitar pick", "A rounded triangle.", pick),
    Silhouette("puzzle", "Puzzle piece", "Two tabs and two sockets: hard.", puzzle),
    Silhouette("mushroom", "Mushroom", "A wide cap on a stalk.", mushroom),
    Silhouette("speech-bubble", "Speech bubble", "A rounded box with a pointed tail.", speech),
    Silhouette("fir", "Fir tree", "Three tiers on a short trunk.", fir),
    Silhouette("pear", "Pear", "A belly, a shoulder and a stem.", pear),
    Silhouette("hourglass", "Hourglass", "Two bulbs joined by a narrow waist.", hourglass),
    Silhouette("wave", "Wave", "A ribbon between two parallel waves.", wave),
    Silhouette("ring", "Ring", "A disc with a round hole.", lambda: disc(0, 0, 1) - disc(0, 0, 0.4)),
    Silhouette("washer", "Washer", "A narrower ring: its hole is half as wide as it is.",
               lambda: disc(0, 0, 1) - disc(0, 0, 0.52)),
    Silhouette("frame", "Frame", "A rectangle with a rectangular hole.",
               lambda: box(-1.4, -1, 1.4, 1) - box(-0.85, -0.5, 0.85, 0.5)),
    Silhouette("gear-with-bore", "Gear with bore", "Ten teeth around a hole for a shaft.",
               lambda: gear() - disc(0, 0, 0.36 * np.sqrt(gear().area / np.pi))),
    Silhouette("face", "Face", "Two eyes and a smile: three holes.", face),
    Silhouette("letter-a", "Letter A", "Two legs and a bar around a hole.", letter_a),
    Silhouette("letter-b", "Letter B", "A stem and two bowls: two holes.", letter_b),
    Silhouette("letter-o", "Letter O", "An ellipse with a narrower one as its hole.",
               lambda: ellipse(0, 0, 0.85, 1.1) - ellipse(0, 0, 0.38, 0.6)),
)  # fmt: skip


def rings(silhouette: Silhouette) -> list[list[list[float]]]:
    """Outer ring and holes, counter-clockwise, the filled shape of area 1 around its centroid.

    Raises
    ------
    ValueError
        The construction is not one polygon, or needs more than ``MOST_VERTICES``.
    """
    shape = silhouette.make()
    if not isinstance(shape, Polygon) or not shape.is_valid:
        raise ValueError(f"{silhouette.name} is not one polygon")
    filled = Polygon(shape.exterior)
    shape = translate(shape, -filled.centroid.x, -filled.centroid.y)
    size = filled.area**-0.5
    unit = scale(shape, size, size, origin=(0, 0)).simplify(TOLERANCE)
    found = []
    for ring in (unit.exterior, *sorted(unit.interiors, key=lambda hole: hole.centroid.coords[0])):
        points = np.round(shapely.get_coordinates(shapely.normalize(Polygon(ring)))[:-1][::-1], 5)
        found.append([[float(x), float(y)] for x, y in points + 0.0])
    if (count := sum(map(len, found))) > MOST_VERTICES:
        raise ValueError(f"{silhouette.name} has {count} vertices, more than {MOST_VERTICES}")
    return found


def text(silhouette: Silhouette) -> str:
    """The stored file: one vertex a line, so that a change shows in a diff."""
    head = {"name": silhouette.name, "title": silhouette.title, "about": silhouette.about}
    outer, *holes = (",\n".join(f"  {json.dumps(vertex)}" for vertex in ring) for ring in rings(silhouette))
    inner = ", ".join(f"[\n{rows}\n]" for rows in holes)
    more = f', "holes": [{inner}]' if holes else ""
    return json.dumps(head)[:-1] + f', "points": [\n{outer}\n]{more}}}\n'


def main() -> None:
    FOLDER.mkdir(parents=True, exist_ok=True)
    for silhouette in SILHOUETTES:
        (FOLDER / f"{silhouette.name}.json").write_text(text(silhouette), encoding="utf-8")


if __name__ == "__main__":
    main()
