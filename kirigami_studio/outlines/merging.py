"""Chosen parts of a source -> one outline: united, bridged, their hull; or each alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
import shapely
from scipy.sparse.csgraph import minimum_spanning_tree
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.outlines.contour import thinned
from kirigami_studio.outlines.crossings import CLEARLY_MEANT
from kirigami_studio.outlines.joining import open_contour
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.parts import (
    QUARTER,
    DrawnPartKind,
    Part,
    SourceParts,
    bores_of_pens,
    inner_contours,
    shell,
    text_left_out,
)
from kirigami_studio.outlines.pieces import (
    LEAST_BREADTH,
    STROKED_BREADTH,
    enclosed,
    has_seen_holes,
    largest_piece,
    rings_of,
    united,
)

#: Widths of bridges and of strokes, shares of the size of the chosen parts: the usual one, the least and the most.
USUAL_BRIDGE, USUAL_STROKE = 0.04, 0.02
LEAST_WIDTH, MOST_WIDTH = 1e-4, 1.0
#: Each pair of pieces has a distance to be measured.
MOST_PIECES = 200
#: Each piece by itself is designed, shown and cut by itself.
MOST_SHEETS = 24
#: Pieces below this share of the largest one's area are left over from rounding: no sheet is so small.
SPECK_OF_LARGEST = 1e-5
#: How closely a tight hull follows the parts, from 0, the convex hull, to 1.
USUAL_TIGHTNESS = 0.7
#: Distance of the points that a tight hull is made of, share of the size.
HULL_STEP = 0.01
#: Names of parts that a sentence lists.
NAMED = 6
#: Places that are farther than the nearest by this share of a bridge's width are as near.
NEAR = 0.02
#: Deviation of simplified parts, share of the size: hulls and bridges need no more.
FLATNESS = 1.0 / 8000.0


class Join(Enum):
    """Ways to make one outline of several parts."""

    UNION = "union"  #: parts that overlap or touch; of several pieces the largest
    BRIDGE = "bridge"  #: pieces are held together by bridges between their nearest places
    HULL = "hull"  #: the convex hull
    TIGHT = "tight"  #: a hull that follows the parts into hollows
    EACH = "each"  #: not at all: every piece is a sheet of its own


@dataclass(frozen=True, slots=True)
class Merging:
    """How parts become one outline."""

    join: Join = Join.UNION
    bridge: float | None = None  #: source units; width of bridges; None for the usual share of the size.
    as_painted: bool = False  #: lines count with their width, as painted; otherwise by what they enclose
    #: source units; width of lines that have none of their own; None for the usual share of the size.
    stroke: float | None = None
    tightness: float = USUAL_TIGHTNESS  #: 0..1
    fill_holes: bool | None = None  #: whether holes are filled; None for those around which only a line would stay


@dataclass(frozen=True, slots=True, eq=False)
class Merged:
    """The outline of merged parts."""

    outline: Outline
    shape: Polygon  #: source units, y up; the outline in its place among the parts
    bridges: tuple[Polygon, ...] = ()  #: source units, y up
    others: tuple[Merged, ...] = ()  #: the other pieces, where each is to be a sheet of its own

    @property
    def all(self) -> tuple[Merged, ...]:
        """This piece and the others."""
        return self, *self.others

    @property
    def place(self) -> tuple[float, float]:
        """Area centroid of the outer ring among the parts, source units, y up."""
        centroid = Polygon(self.shape.exterior).centroid
        return float(centroid.x), float(centroid.y)


def merged(source: SourceParts, parts: Sequence[Part], merging: Merging) -> Merged:
    """Make one outline of some parts of a source; its notes tell what was left out.

    Parameters
    ----------
    parts : sequence of Part
        Of the source.

    Raises
    ------
    TargetError
        No parts, no area, widths that make no sense in this drawing, or too many pieces to bridge.
    """
    if not parts:
        raise TargetError("parts.none_chosen")
    boxes = np.array([part.bounds for part in parts])
    size = float(np.max(boxes[:, 2:].max(axis=0) - boxes[:, :2].min(axis=0)))
    notes = [*source.left_out, *_rest(source, parts)]
    whole = source.size
    regions = [region for part in parts if not (region := _region(part, merging, size, whole)).is_empty]
    if not regions and merging.join not in (Join.HULL, Join.TIGHT):
        raise TargetError("parts.no_area")
    bridges: tuple[Polygon, ...] = ()
    if merging.join in (Join.HULL, Join.TIGHT):
        lines = [LineString(line) for part in parts if not part.is_closed for line in part.lines]
        region = _hull(shapely.union_all([*regions, *lines]), merging, size)
    else:
        if (open_lines := sum(not part.is_closed for part in parts)) and not merging.as_painted:
            notes.append(
                tr_n(
                    "{count} open line that encloses nothing was left out.",
                    "{count} open lines that enclose nothing were left out.",
                    open_lines,
                )
            )
        region = united(regions, size)
        if merging.as_painted:
            pens = [part for part in parts if part.lines and part.kind is not DrawnPartKind.FILLED]
            painted = [_with_pen(part, merging, size) for part in pens]
            shown = {part.number: _region(part, merging, size, whole) for part in parts}
            region = region.difference(shapely.union_all(bores_of_pens(painted, shown, 0.0)))
        else:
            contours = inner_contours([part for part in parts if part.kind is DrawnPartKind.CLOSED])
            region = region.difference(shapely.union_all([Polygon(shell(part.region)) for part in contours]))
        if merging.join is Join.BRIDGE:
            region, bridges = bridged(region, merging, size)
            if bridges:
                notes.append(
                    tr_n(
                        "{count} bridge holds the parts together.",
                        "{count} bridges hold the parts together.",
                        len(bridges),
                    )
                )
    breadth = _breadth(parts, merging.as_painted)
    if merging.join is Join.EACH:
        return _each(source, region, parts, notes, breadth, merging.fill_holes)
    alone = len(parts) == 1 < len(source.parts) and parts[0].is_named
    outline, shape = _outline(
        source, region, notes, parts[0].name if alone else source.name, breadth, merging.fill_holes
    )
    return Merged(outline, shape, bridges)


def _each(
    source: SourceParts,
    region: BaseGeometry,
    parts: Sequence[Part],
    notes: Sequence[str],
    breadth: float,
    fill_holes: bool | None,
) -> Merged:
    """Every piece of a region, in the order of the parts; the first has the notes on all.

    Raises
    ------
    TargetError
        Too many pieces.
    """
    apart = [piece for piece in shapely.get_parts(region) if isinstance(piece, Polygon)]
    least = SPECK_OF_LARGEST * max(piece.area for piece in apart)
    pieces = [(_part_of(piece, parts), piece) for piece in apart if piece.area > least]
    if len(pieces) > MOST_SHEETS:
        raise TargetError("parts.too_many_sheets", pieces=len(pieces), limit=MOST_SHEETS)
    # Pieces of one part from left to right, as they are read.
    pieces.sort(key=lambda found: (found[0].number, found[1].bounds[0]))
    made: list[Merged] = []
    for name, (_, piece) in zip(_told_apart([part for part, _ in pieces], source.name), pieces, strict=True):
        made.append(Merged(*_outline(source, piece, () if made else notes, name, breadth, fill_holes)))
    return replace(made[0], others=tuple(made[1:]))


def _told_apart(parts: Sequence[Part], name: str) -> list[str]:
    """Different names for the pieces of parts: the part's own, or ``name`` of the source."""
    found: list[str] = []
    for part in parts:
        own = part.name if part.is_named else name
        numbered = (f"{own} {number}" for number in range(2, len(parts) + 2))
        found.append(own if own not in found else next(one for one in numbered if one not in found))
    return found


def _part_of(piece: Polygon, parts: Sequence[Part]) -> Part:
    """The part that most of a piece is."""
    shares = [shapely.area(shapely.intersection(piece, part.region.buffer(0.0))) for part in parts]
    if max(shares) > 0.0:
        return parts[int(np.argmax(shares))]
    lines = [part.region if part.is_closed else shapely.multilinestrings(list(part.lines)) for part in parts]
    return parts[int(np.argmin([shapely.distance(piece, line) for line in lines]))]


def usual_outline(source: SourceParts) -> Outline:
    """The silhouette that is taken of a source without asking; its notes name the rest.

    Raises
    ------
    TargetError
        Nothing is closed, an open contour surrounds the rest, or there are only letters apart from each other.
    """
    choice, notes = source.choice, list(source.left_out)
    if choice.open_at is not None:
        way = -1.0 if source.is_turned else 1.0
        gaps = [choice.open_at._replace(y=way * choice.open_at.y)] if choice.open_at.width else []
        raise open_contour(gaps, source.bridged, source.unit)
    parts = source.of(choice.considered)
    if all(part.is_letter for part in parts) and not choice.is_plain:
        raise TargetError("parts.letters", letters=len(parts))
    if choice.inner:
        notes.append(
            tr_n(
                "{count} contour inside the outer one was left out.",
                "{count} contours inside the outer one were left out.",
                choice.inner,
            )
        )
    if choice.unfilled:
        notes.append(tr("Shapes without filling were left out."))
    elif choice.open_lines:
        notes.append(
            tr_n(
                "{count} open line that encloses nothing was left out.",
                "{count} open lines that enclose nothing were left out.",
                choice.open_lines,
            )
        )
    if choice.has_letters_apart:
        notes.append(text_left_out())
    if not choice.is_plain:
        names = ", ".join(part.name for part in source.of(choice.numbers)[:NAMED])
        notes.append(
            tr(
                "More than one shape may be meant. Taken: {names}. 'kirigami-studio parts FILE' lists all, --parts "
                "takes others.",
                names=names,
            )
        )
    rings = {b"" if part.ring is None else part.ring.tobytes(): part.ring for part in parts}
    ring = next(iter(rings.values())) if len(rings) == 1 and not choice.as_painted else None
    areas = [part.region.area for part in parts]
    if ring is not None and not any(part.lines for part in parts) and max(areas) > CLEARLY_MEANT * sum(areas):
        # Left as it is, so that crossings are judged and named.
        return _outline(source, ring, notes, source.name)[0]
    return _outline(source, choice.region, notes, source.name, _breadth(parts, choice.as_painted))[0]


def _breadth(parts: Sequence[Part], as_painted: bool) -> float:
    """How broad most of the shape of some parts is round holes, by :func:`has_seen_holes`."""
    if as_painted:
        return STROKED_BREADTH
    return 0.0 if all(part.is_letter for part in parts) else LEAST_BREADTH  # a letter of a light face is one, too


def _outline(
    source: SourceParts,
    region: BaseGeometry | FloatArray,
    notes: Sequence[str],
    name: str,
    breadth: float = 0.0,
    fill_holes: bool | None = None,
) -> tuple[Outline, Polygon]:
    """The outline of a region or a ring, judged with y as in the source; and its polygon.

    Unless it is said, holes are open where they are seen as such, by ``breadth``.
    """
    way = np.array([1.0, -1.0]) if source.is_turned else np.ones(2)
    dropped: tuple[str, ...] = ()
    holes: list[FloatArray] = []
    are_seen = True
    if isinstance(region, np.ndarray):
        ring = region * way
    else:
        turned = shapely.transform(region, lambda points: points * way)
        piece, dropped = largest_piece(turned)
        ring, holes = rings_of(piece)
        are_seen = not holes or (has_seen_holes(piece, turned, breadth) if fill_holes is None else not fill_holes)
    found = Outline.from_points(
        thinned(ring), name=name, notes=(*notes, *dropped), unit=source.unit, holes=[thinned(hole) for hole in holes]
    )
    if source.is_turned:
        turned_holes = tuple((hole * way)[::-1] for hole in found.holes)
        found = replace(found, points=(found.points * way)[::-1], holes=turned_holes)
    found = found if are_seen else found.filled
    return found, Polygon(ring * way, [hole * way for hole in holes] if are_seen else [])


def _rest(source: SourceParts, parts: Sequence[Part]) -> list[str]:
    """A sentence on the parts that were not chosen, if there are any."""
    chosen = {part.number for part in parts}
    rest = [part.name for part in source.parts if part.number not in chosen]
    if not rest:
        return []
    listed = ", ".join(rest[:NAMED]) + (", …" if len(rest) > NAMED else "")
    return [
        tr_n("{count} part was left out: {names}.", "{count} parts were left out: {names}.", len(rest), names=listed)
    ]


def _region(part: Part, merging: Merging, size: float, whole: float) -> BaseGeometry:
    """The area of a part; ``whole`` is the size of the drawing."""
    if not merging.as_painted or not part.lines:
        return part.seen(whole)
    return _with_pen(part, merging, size).seen(0.0, with_lines=True)


def _with_pen(part: Part, merging: Merging, size: float) -> Part:
    """A part of lines with the width that they are painted with."""
    width = part.pen.width or (USUAL_STROKE * size if merging.stroke is None else merging.stroke)
    _check_width("parts.stroke_width", width, size)
    return replace(part, pen=replace(part.pen, width=width))


def _check_width(code: str, width: float, size: float) -> None:
    least, most = LEAST_WIDTH * size, MOST_WIDTH * size
    if not least <= width <= most:
        raise TargetError(code, width=width, least=least, most=most)


def bridged(region: BaseGeometry, merging: Merging, size: float) -> tuple[BaseGeometry, tuple[Polygon, ...]]:
    """The region with bridges along the shortest tree that joins its pieces."""
    pieces = [piece.simplify(FLATNESS * size) for piece in enclosed(region)]
    if len(pieces) < 2:
        return region, ()
    if len(pieces) > MOST_PIECES:
        raise TargetError("parts.too_many_pieces", pieces=len(pieces), limit=MOST_PIECES)
    width = USUAL_BRIDGE * size if merging.bridge is None else merging.bridge
    _check_width("parts.bridge_width", width, size)
    shapes = np.array(pieces)
    distances = np.maximum(shapely.distance(shapes[:, None], shapes[None, :]), 1e-9 * size)
    np.fill_diagonal(distances, 0.0)
    tree = minimum_spanning_tree(distances).tocoo()
    bridges = tuple(
        _bridge(pieces[one], pieces[other], width, size)
        for one, other in zip(tree.row.tolist(), tree.col.tolist(), strict=True)
    )
    return shapely.union_all([region, *bridges]), bridges


def _bridge(one: BaseGeometry, other: BaseGeometry, width: float, size: float) -> Polygon:
    """A rectangle between the nearest places of two pieces that reaches half its width into both.

    Where a stretch of the other piece is as near, as between parallel edges, the bridge leads to its middle.
    """
    nearest = shapely.shortest_line(one, other)
    near = one.buffer(nearest.length + NEAR * width, quad_segs=QUARTER).intersection(other.boundary)
    stretch = max(shapely.get_parts(shapely.line_merge(near)), key=lambda part: float(part.length), default=None)
    if stretch is not None and stretch.length > width:
        nearest = shapely.shortest_line(one, stretch.interpolate(0.5, normalized=True))
    start, end = shapely.get_coordinates(nearest)
    length = float(np.linalg.norm(end - start))
    # Pieces that touch in a point are joined across it.
    way = (end - start) / length if length > 1e-9 * size else np.array(other.centroid.coords[0]) - start
    way = way / max(float(np.linalg.norm(way)), 1e-300)
    line = LineString([start - 0.5 * width * way, end + 0.5 * width * way])
    return line.buffer(0.5 * width, cap_style="flat")


def _hull(shape: BaseGeometry, merging: Merging, size: float) -> BaseGeometry:
    """The convex hull, or one that goes into hollows and still covers every part."""
    if shape.is_empty:
        raise TargetError("parts.no_area")
    if merging.join is Join.HULL:
        return shape.convex_hull
    if not 0.0 <= merging.tightness <= 1.0:
        raise TargetError("parts.tightness", value=merging.tightness)
    points = shapely.extract_unique_points(shapely.segmentize(shape.simplify(FLATNESS * size), HULL_STEP * size))
    # The hull of the points may cut off a corner of a part between them.
    tight = shapely.concave_hull(points, ratio=1.0 - merging.tightness).union(shape)
    return tight if len(enclosed(tight)) == 1 else shape.convex_hull
