"""Parts of a file: shapes and lines with layer, colour and size, of which a target is made.

A part is a connected filled region, a closed contour of lines, or a connected open line.  Its geometry is in the units
of the source, y up; :mod:`~kirigami_studio.outlines.merging` makes one outline of chosen parts.

One rule says which of them are the silhouette that is seen, for all kinds of files (:class:`UsualChoice`):

- What is hardly seen counts where nothing else is closed.
- What is filled counts with its stroke.  Broad lines are painted; lines of a middling width are if they run round
  filled shapes or show more than what they enclose; thin lines count by what they enclose.
- Of what is painted and of what thin lines enclose, the silhouette with the larger area is taken, whatever lies inside.
- Thin lines that would surround all of it, were they closed, are an open contour, and nothing is taken.
- Holes are what filled shapes and broad lines leave unpainted, and thin contours right within another one of the same
  layer, colour and width; contours of others are engraved.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import TYPE_CHECKING, Literal

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from shapely.geometry import LineString, MultiLineString, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError, UsageError
from kirigami_studio.foundation.frozen_mapping import FrozenMapping
from kirigami_studio.foundation.plain_text import LONGEST_NOTE, plain_line
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.outlines.joining import Gap, Joined, closed_gaps, held, joined, opening
from kirigami_studio.outlines.pieces import ROUNDING, enclosed, united

if TYPE_CHECKING:
    from collections.abc import Mapping

#: Larger numbers of parts are not told apart any more: the smallest are left out.
MOST_PARTS = 500
#: A part below this share of the largest one's area is a speck: nobody is asked about it.
SPECK = 0.01
#: A part that fills this share of its box is a rectangle: around others, a page or a frame.
RECTANGLE = 0.99
#: A part inside a frame is one to be asked about from this share of the frame's area on.
WORTH_ASKING = 0.02
#: Pens from this share of the lines' size on are painted; from the second on, where they show more than the lines
#: enclose; the stroke of a filled shape counts from the third on.
BROAD, MIDDLING, SEEN = 0.05, 0.015, 0.005
#: This share of a silhouette is more; lines run round filled shapes that fill this share of what they enclose.
SHOWS_MORE, ROUND_FILLED = 0.02, 0.5
#: Lines that hang on a shape and are so many times as long as it may be meant, too.
REACHES_OUT = 1.5
#: An area counts as larger from this share on: less is rounding.
LARGER = 1e-6
#: A rectangle of lines whose edges are nearer to the paper's than this share of the paper is its frame.
FRAME = 0.05
#: More contours than this within another one are a drawing on it.  Two contours whose boxes differ by less than this
#: share of the size are one that is drawn twice.
MOST_BORES, DRAWN_TWICE = 40, 1e-3
#: Cosine of the turn of a line below which it has a corner.
STRAIGHT = 0.996
#: Vertices of a quarter circle at the ends and corners of strokes, and deviation of stroked lines, share of the size.
QUARTER, STROKED_FLATNESS = 16, 1.0 / 8000.0
#: Digits of the areas by which it is told which part lies around which; a fill and a stroke of one outline differ by
#: rounding, and then the first counts.
SAME_AREA = 9
Cap = Literal["round", "flat", "square"]
Corner = Literal["round", "mitre", "bevel"]
ALL, LARGEST = "all", "largest"


class DrawnPartKind(Enum):
    """Kinds of parts."""

    FILLED = "filled"
    CLOSED = "closed"  #: lines around an area
    STROKED = "stroked"  #: lines that enclose nothing


@dataclass(frozen=True, slots=True)
class StrokeStyle:
    """How lines are painted."""

    width: float = 0.0  #: source units; 0 where the source does not say
    cap: Cap = "round"  #: "round", "flat" or "square"
    join: Corner = "round"  #: "round", "mitre" or "bevel"
    mitre_limit: float = 4.0  #: length of a corner over the width, above which it is cut off
    is_on_paper: bool = False  #: whether the width is that of a plotter's pen, which says nothing of the drawing


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """One part of a source."""

    number: int  #: from 1 on, in the order of the source; unique
    name: str  #: its label or id in the source, or its kind and number; not always unique
    layer: str  #: "" where the source has none
    colour: str  #: "#rrggbb", or "" where the source has none
    kind: DrawnPartKind
    region: BaseGeometry  #: source units, y up; what is filled or enclosed, holes left open; empty for open lines
    #: tuple of (P, 2) float, source units, y up; what is painted with the pen; a closed line repeats its first vertex
    #: at the end.
    lines: tuple[FloatArray, ...] = ()
    pen: StrokeStyle = field(default_factory=StrokeStyle)
    is_named: bool = True  #: whether the name is the source's own
    is_letter: bool = False  #: whether it is a letter of a text
    is_aside: bool = False  #: whether it is a measure or a construction line: it counts where nothing else is closed
    is_faint: bool = False  #: whether it is hardly seen, such as a shadow: it counts where nothing else is closed
    #: (L, 2) float, source units; of a shape with one subpath that subpath, crossings and all.
    ring: FloatArray | None = None

    def __post_init__(self) -> None:
        for name in ("name", "layer", "colour"):
            object.__setattr__(self, name, plain_line(getattr(self, name)))

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Left, bottom, right and top, source units."""
        if self.region.is_empty:
            corners = np.concatenate(self.lines)
            return (*corners.min(axis=0).tolist(), *corners.max(axis=0).tolist())
        left, bottom, right, top = self.region.bounds
        return left, bottom, right, top

    @property
    def size(self) -> tuple[float, float]:
        """Width and height, source units."""
        left, bottom, right, top = self.bounds
        return right - left, top - bottom

    @property
    def is_closed(self) -> bool:
        """Whether it encloses an area."""
        return not self.region.is_empty

    @property
    def worth(self) -> float:
        """Area, or that of the box of an open line: what parts are ordered by."""
        width, height = self.size
        return float(self.region.area) if self.is_closed else max(width * height, 1e-3 * max(width, height) ** 2)

    def seen(self, size: float, with_lines: bool = False) -> BaseGeometry:
        """The region that is painted; lines that fill nothing count only ``with_lines``.

        Parameters
        ----------
        size : float, source units
            Of the drawing, by which it is told whether a stroke is seen.
        """
        is_filled = self.kind is DrawnPartKind.FILLED
        if not self.lines or self.pen.width <= 0.0 or not (with_lines or is_filled):
            return self.region
        if is_filled and self.pen.width < SEEN * size:
            return self.region
        lines = [shapely.get_coordinates(LineString(line).simplify(STROKED_FLATNESS * size)) for line in self.lines]
        painted = stroked(lines, self.pen, self.pen.width)
        # What lines surround belongs to the shape.
        return painted if self.region.is_empty else painted.union(self.region)

    def to_json(self, unit: str) -> dict[str, object]:
        """The entry of ``kirigami-studio parts``."""
        return {
            "number": self.number,
            "name": self.name,
            "layer": self.layer,
            "colour": self.colour,
            "kind": self.kind.value,
            "size": list(self.size),
            "unit": unit,
            "area": float(self.region.area),
            "stroke_width": self.pen.width,
        }


@dataclass(frozen=True, slots=True)
class Strokes:
    """Places on a picture by which an object is told, (x, y) in source pixels from the upper left corner, y down."""

    taken: tuple[tuple[float, float], ...] = ()  #: on the object
    left: tuple[tuple[float, float], ...] = ()  #: beside it


@dataclass(frozen=True, slots=True)
class UsualChoice:
    """Which parts are the silhouette that is seen."""

    numbers: tuple[int, ...]  #: of the parts that make its edge
    considered: tuple[int, ...]  #: of these and others of their kind, of which these are the largest together
    as_painted: bool  #: whether lines count as they are painted
    is_plain: bool  #: whether nothing else may be meant
    #: the widest gap of an open contour around the rest, x and y of its middle; no width where it is not known; None
    #: where the silhouette is closed.
    open_at: Gap | None = None
    #: open_lines, inner: lines that were not taken because they enclose nothing; contours inside the one taken;
    #: unfilled: other contours of lines, where filled shapes were taken.
    open_lines: int = 0
    inner: int = 0
    unfilled: int = 0
    has_letters_apart: bool = False  #: whether texts stand beside what was taken
    region: BaseGeometry = field(default_factory=Polygon)  #: source units; of the parts ``considered`` together


@dataclass(frozen=True, slots=True, eq=False)
class SourceParts:
    """All parts of a source.

    Names of all kinds, facts and sentences are plain lines, whatever the source has.
    """

    name: str
    parts: tuple[Part, ...]  #: at least one
    left_out: tuple[str, ...] = ()  #: what is not among them or was changed, one sentence each
    unit: str = ""  #: "mm", "px", or "" when the source has none
    #: What the file says about how it was made, if this program made it.
    facts: Mapping[str, str] = field(default_factory=FrozenMapping)
    #: (left, bottom, right, top) of a white page that was left out, source units; None without one.
    paper: tuple[float, float, float, float] | None = None
    bridged: float = 0.0  #: source units; gaps of lines up to this width were closed
    is_turned: bool = False  #: whether y runs down in the source: then it does so in sentences that name a place
    _choice: UsualChoice | None = field(default=None, init=False, repr=False)

    def __post_init__(self) -> None:
        facts = {plain_line(name): plain_line(text, LONGEST_NOTE) for name, text in self.facts.items()}
        object.__setattr__(self, "name", plain_line(self.name))
        object.__setattr__(self, "left_out", tuple(plain_line(note, LONGEST_NOTE) for note in self.left_out))
        object.__setattr__(self, "facts", FrozenMapping(facts))

    @property
    def layers(self) -> tuple[str, ...]:
        """Names of layers in the order of the source."""
        return tuple(dict.fromkeys(part.layer for part in self.parts))

    @property
    def size(self) -> float:
        """The longer side of all parts together, source units."""
        boxes = np.array([part.bounds for part in self.parts])
        return float(np.max(boxes[:, 2:].max(axis=0) - boxes[:, :2].min(axis=0)))

    @property
    def choice(self) -> UsualChoice:
        """The parts that are taken without asking."""
        if self._choice is None:
            object.__setattr__(self, "_choice", _usual(self))
        assert self._choice is not None
        return self._choice

    @property
    def usual(self) -> tuple[int, ...]:
        """Numbers of the parts that are taken without asking."""
        return self.choice.numbers

    @property
    def is_ambiguous(self) -> bool:
        """Whether there is something to ask: what is taken is not the only thing that may be meant."""
        return not self.choice.is_plain

    def chosen(self, words: str) -> tuple[Part, ...]:
        """The parts that words name: ``all``, ``largest``, or names, numbers and layers, joined by commas.

        Raises
        ------
        UsageError
            Nothing has such a name.
        """
        text = words.strip().casefold()
        if text == ALL:
            return self.parts
        if text == LARGEST:
            return self.of(self.usual)
        found: set[int] = set()
        for word in filter(None, (word.strip() for word in words.split(","))):
            key = word.casefold().removeprefix("#")
            named = {
                part.number
                for part in self.parts
                if key in (str(part.number), part.name.casefold(), part.layer.casefold(), part.colour.removeprefix("#"))
            }
            if not named:
                names = [name for name in self.layers if name] + [part.name for part in self.parts]
                raise UsageError("parts.unknown", name=word, names=", ".join(dict.fromkeys(names)))
            found |= named
        return self.of(found)

    def of(self, numbers: Iterable[int]) -> tuple[Part, ...]:
        """The parts of some numbers, in the order of the source.

        Raises
        ------
        TargetError
            There are none.
        """
        wanted = frozenset(numbers)
        parts = tuple(part for part in self.parts if part.number in wanted)
        if not parts:
            raise TargetError("parts.none_chosen")
        return parts


def shell(region: BaseGeometry) -> FloatArray:
    """The outer ring (L, 2) of a connected region."""
    return shapely.get_coordinates(shapely.get_exterior_ring(region))


def stroked(lines: Sequence[FloatArray], pen: StrokeStyle, width: float) -> BaseGeometry:
    """The region of lines (P, 2) that are painted with a pen of some width."""
    shapes, join = MultiLineString([LineString(line) for line in lines]), pen.join
    tips: list[BaseGeometry] = []
    if join == "mitre":
        found = [_mitres(line, 0.5 * width, pen.mitre_limit) for line in lines]
        if any(is_cut for _, is_cut in found):  # GEOS would cut those off at the limit, SVG and DXF at the corner
            join, tips = "bevel", [Polygon(tip) for tip in np.concatenate([tips for tips, _ in found])]
    limit = max(pen.mitre_limit, 1.0)
    painted = shapes.buffer(0.5 * width, quad_segs=QUARTER, cap_style=pen.cap, join_style=join, mitre_limit=limit)
    return shapely.union_all([painted, *tips]) if tips else painted


def _mitres(line: FloatArray, half: float, limit: float) -> tuple[FloatArray, bool]:
    """The tips (T, 4, 2) of a line's corners, and whether one is longer than ``limit`` widths."""
    if np.array_equal(line[0], line[-1]):
        line = np.concatenate([line, line[1:2]])
    along = np.diff(line, axis=0)
    length = np.linalg.norm(along, axis=1)
    corner, along = line[:-1][length > 0.0][1:], along[length > 0.0] / length[length > 0.0, None]
    before, after = along[:-1], along[1:]
    straight = np.clip(np.sum(before * after, axis=1), -1.0, 1.0)
    has_tip = np.sqrt(0.5 * (1.0 + straight)) * limit >= 1.0  # by the sine of half the angle between the two lines
    kept = has_tip & (straight < STRAIGHT)
    side = -half * np.sign(before[kept, 0] * after[kept, 1] - before[kept, 1] * after[kept, 0])[:, None]
    one, other = (side * np.column_stack([-way[kept, 1], way[kept, 0]]) for way in (before, after))
    tip = (one + other) / (1.0 + straight[kept, None])
    tips = corner[kept][:, None] + np.stack([np.zeros_like(tip), one, tip, other], axis=1)
    return tips, not bool(np.all(has_tip))


def _usual(source: SourceParts) -> UsualChoice:
    """The one rule; see the module."""
    parts, size = source.parts, source.size
    if any(part.is_closed and not part.is_aside for part in parts):
        parts = tuple(part for part in parts if not part.is_aside)
    faint = [part for part in parts if part.is_faint and part.is_closed]
    if any(part.is_closed and not part.is_faint for part in parts):
        parts = tuple(part for part in parts if not part.is_faint)
    else:
        faint = []
    shapes = [part for part in parts if part.kind is DrawnPartKind.FILLED and not part.is_letter]
    lines = [part for part in parts if part.kind is not DrawnPartKind.FILLED]
    letters = [part for part in parts if part.is_letter]
    if not shapes and not lines:
        numbers = tuple(part.number for part in letters)
        is_one = len(_groups(letters, [part.region for part in letters], size)) == 1
        return UsualChoice(numbers, numbers, False, is_one, region=united([part.region for part in letters], size))
    lines = _without_frame(lines, source.paper) if len(parts) > 1 else lines
    extent = _extent(lines)
    broad = [part for part in lines if not part.pen.is_on_paper and part.pen.width >= BROAD * extent]
    thin = [part for part in lines if part not in broad]
    solid = {part.number: part.seen(size) for part in shapes}
    solid.update((part.number, part.seen(size, True)) for part in broad)
    open_at = _open_contour(thin, solid, size)
    middling = [part for part in thin if not part.pen.is_on_paper and part.pen.width >= MIDDLING * extent]
    shown = {part.number: part.seen(size, True) for part in middling} if open_at is None else {}
    is_round = bool(shown) and _is_round(middling, solid)
    shown = shown if is_round or _shows_more(middling, shown, solid, size) else {}
    solid.update(shown)
    thin = [part for part in thin if part.number not in shown]
    solid.update((part.number, part.region) for part in letters)
    ring = {part.number: Polygon(shell(part.region)) for part in thin if part.is_closed}
    of_solid, solid_area = _largest([part for part in parts if part.number in solid], solid, size)
    of_rings, ring_area = _largest([part for part in parts if part.number in ring], ring, size)
    takes_rings = ring_area > (1.0 + LARGER) * solid_area
    taken, kinds = (of_rings, ring) if takes_rings else (of_solid, solid)
    if not taken:  # open thin lines only
        number = max(lines, key=lambda part: part.worth).number
        return UsualChoice((number,), (number,), False, False, open_at or opening(_all_lines(lines), size), len(lines))
    silhouette = Polygon(enclosed(united([kinds[part.number] for part in taken], size))[0])
    outer = _outer(taken, kinds)
    others: list[BaseGeometry] = [one for number, one in (*solid.items(), *ring.items()) if number not in kinds]
    others += [part.region for part in faint]
    considered = tuple(number for number in kinds if takes_rings or not _is_letter_apart(source, number, taken))
    closed = [part for part in parts if part.is_closed and part in (*shapes, *lines, *letters)]
    bored = _bored(taken, {_pen(part) for part in outer}) if takes_rings else []
    numbers = tuple(part.number for part in taken if part in outer or part in bored)
    bores: list[BaseGeometry]
    if takes_rings:
        bores = [ring[part.number] for part in bored]
    else:
        bores = bores_of_pens([part for part in lines if part.number in considered], kinds, size)
    plain = (
        open_at is None
        and bool(closed)
        and (is_round or not shown)
        and not _stands_apart(closed, {**solid, **ring}, size)
        and not _reaches_out(taken, silhouette)
        and not _is_framed(_outer(closed, {**solid, **ring}), closed)
        and all(_outside(one, silhouette) <= SHOWS_MORE * silhouette.area for one in others)
    )
    return UsualChoice(
        numbers,
        considered,
        any(part.number in solid for part in lines) and not takes_rings,
        plain,
        open_at,
        sum(not part.is_closed for part in thin),
        sum(number in ring for number in ring if number not in numbers) if takes_rings else 0,
        0 if takes_rings else len(ring) + sum(not part.is_closed for part in thin),
        any(part not in taken and _outside(part.region, silhouette) > 0.0 for part in letters),
        united([kinds[number] for number in considered], size).difference(shapely.union_all(bores)),
    )


def _pen(part: Part) -> tuple[str, str, float]:
    """Layer, colour and width, which contours of one kind share."""
    return part.layer, part.colour, part.pen.width


def _bored(parts: Sequence[Part], pens: Collection[tuple[str, str, float]]) -> list[Part]:
    """Holes among contours: those within others of some pens, unless they are too many."""
    found = [part for pen in pens for part in inner_contours([part for part in parts if _pen(part) == pen])]
    return found if len(found) <= MOST_BORES else []


def inner_contours(parts: Sequence[Part]) -> list[Part]:
    """The contours of lines that lie right within an outer one, all around apart from it."""
    shells = [Polygon(shell(part.region)) for part in parts]
    if len(shells) < 2:
        return []
    boxes = shapely.bounds(shells)
    far = DRAWN_TWICE * float(np.max(boxes[:, 2:] - boxes[:, :2]))
    outer, inner = shapely.STRtree(shells).query(shells, predicate="contains_properly")
    depth: dict[int, list[int]] = {}
    for around, index in zip(outer.tolist(), inner.tolist(), strict=True):
        of_shell = depth.setdefault(index, [])
        if all(np.max(np.abs(boxes[around] - boxes[other])) > far for other in (index, *of_shell)):
            of_shell.append(around)
    return [parts[index] for index, around in sorted(depth.items()) if len(around) == 1]


def bores_of_pens(lines: Sequence[Part], regions: Mapping[int, BaseGeometry], size: float) -> list[BaseGeometry]:
    """Insides that closed lines leave open as they are painted, with nothing else in them.

    Parameters
    ----------
    regions : mapping of int to shapely geometry, source units
        By the parts' numbers, everything that is taken.
    size : float, source units
        Of the drawing.
    """
    found: list[BaseGeometry] = []
    for part in lines:
        if part.is_closed and part.pen.width > 0.0:
            pen = replace(part, region=Polygon()).seen(size, with_lines=True)
            hole = part.region.difference(pen)
            others = (one for number, one in regions.items() if number != part.number)
            found += [] if any(one.intersection(hole).area > 0.0 for one in others) else [hole]
    return found


def _is_letter_apart(source: SourceParts, number: int, taken: Sequence[Part]) -> bool:
    """Whether a part is a letter that stands beside the shape."""
    return source.parts[number - 1].is_letter and all(part.number != number for part in taken)


def _all_lines(parts: Iterable[Part]) -> list[FloatArray]:
    return [line for part in parts for line in part.lines]


def _extent(parts: Sequence[Part]) -> float:
    """The longer side of some parts together, source units."""
    if not parts:
        return 0.0
    boxes = np.array([part.bounds for part in parts])
    return float(np.max(boxes[:, 2:].max(axis=0) - boxes[:, :2].min(axis=0)))


def _without_frame(lines: list[Part], paper: tuple[float, float, float, float] | None) -> list[Part]:
    """Leave out a rectangle of lines that follows the edges of the paper."""
    if paper is None:
        return lines
    page, slack = np.array(paper), FRAME * max(paper[2] - paper[0], paper[3] - paper[1])
    return [
        part
        for part in lines
        if not part.is_closed
        or np.max(np.abs(np.array(part.bounds) - page)) > slack
        or Polygon(shell(part.region)).area < RECTANGLE * part.size[0] * part.size[1]
    ]


def _is_round(lines: Sequence[Part], solid: Mapping[int, BaseGeometry]) -> bool:
    """Whether lines run round filled shapes."""
    inside = shapely.union_all([part.region for part in lines])
    return bool(shapely.union_all(list(solid.values())).intersection(inside).area > ROUND_FILLED * inside.area)


def _shows_more(
    lines: Sequence[Part], inked: Mapping[int, BaseGeometry], solid: Mapping[int, BaseGeometry], size: float
) -> bool:
    """Whether lines as they are painted show more of the silhouette than what they enclose."""
    if not any(part.is_closed for part in lines) and not solid:
        return False
    grown = [part.region.buffer(0.5 * part.pen.width, join_style="mitre") for part in lines if part.is_closed]
    fewer, more = (_filled([*solid.values(), *some], size) for some in (grown, inked.values()))
    return bool(more.difference(fewer).area > SHOWS_MORE * more.area)


def _filled(regions: Iterable[BaseGeometry], size: float) -> BaseGeometry:
    """The largest silhouette of some regions, holes filled."""
    pieces = enclosed(united(list(regions), size))
    return pieces[0] if pieces else Polygon()


def _outside(region: BaseGeometry, silhouette: Polygon) -> float:
    return float(region.difference(silhouette).area)


def _open_contour(thin: Sequence[Part], solid: Mapping[int, BaseGeometry], size: float) -> Gap | None:
    """The gap of thin open lines around everything closed: one by its box, or all joined."""
    lines = _all_lines(part for part in thin if not part.is_closed)
    closed = [*solid.values(), *(part.region for part in thin if part.is_closed)]
    if not lines or not closed:
        return None
    inside = shapely.box(*shapely.total_bounds(np.array(closed, dtype=object)))
    gap = held(lines, inside, size)
    if gap is None and any(shapely.box(*LineString(line).bounds).contains_properly(inside) for line in lines):
        gap = opening(lines, size)
    return gap


def _groups(parts: Sequence[Part], regions: Sequence[BaseGeometry], size: float) -> list[list[Part]]:
    """Parts whose regions touch each other, together."""
    shapes = np.array(regions, dtype=object)
    one, other = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=ROUNDING * size)
    links = coo_array((np.ones(len(one)), (one, other)), shape=(len(parts), len(parts)))
    count, group = connected_components(links, directed=False)
    return [[part for part, of in zip(parts, group.tolist(), strict=True) if of == index] for index in range(count)]


def _largest(parts: Sequence[Part], regions: Mapping[int, BaseGeometry], size: float) -> tuple[list[Part], float]:
    """The parts that make the largest silhouette together, and its area."""
    parts = [part for part in parts if not regions[part.number].is_empty]
    if not parts:
        return [], 0.0
    shells = {part.number: _shells(regions[part.number]) for part in parts}
    groups = _groups(parts, [shells[part.number] for part in parts], size)
    groups = [group for group in groups if not all(part.is_letter for part in group)]
    if not groups:
        return [], 0.0
    found = [(float(shapely.union_all([shells[part.number] for part in group]).area), group) for group in groups]
    area, group = max(found, key=lambda one: one[0])
    return group, area


def _shells(region: BaseGeometry) -> BaseGeometry:
    """A region with its holes filled."""
    return shapely.union_all([Polygon(piece.exterior) for piece in shapely.get_parts(region) if piece.area > 0])


def _outer(parts: Sequence[Part], regions: Mapping[int, BaseGeometry]) -> list[Part]:
    """Parts that do not lie inside another one."""
    parts = [part for part in parts if part.number in regions]
    shells = [_shells(regions[part.number]) for part in parts]
    # Hundreds of copies are not compared with each other.
    first = {each.wkb: index for index, each in reversed([*enumerate(shells)])}
    several = sorted(first.values(), key=lambda index: (-float(f"{shells[index].area:.{SAME_AREA}g}"), index))
    ranked = np.array([shells[index] for index in several], dtype=object)
    inner, around = shapely.STRtree(ranked).query(ranked, predicate="covered_by")
    # One rank for all: of parts that cover each other, the first of the largest is never hidden.
    hidden = set(inner[around < inner].tolist())
    outer = {index for rank, index in enumerate(several) if rank not in hidden}
    return [part for index, part in enumerate(parts) if index in outer]


def _stands_apart(closed: Sequence[Part], regions: Mapping[int, BaseGeometry], size: float) -> bool:
    """Whether several parts of some worth do not touch."""
    outer = _outer(closed, regions)
    largest = max(regions[part.number].area for part in outer)
    usable = [part for part in outer if regions[part.number].area >= SPECK * largest]
    return len(_groups(usable, [regions[part.number] for part in usable], size)) > 1


def _reaches_out(taken: Sequence[Part], silhouette: Polygon) -> bool:
    """Whether lines that hang on the shape and enclose nothing are much longer than it."""
    lines = _all_lines(part for part in taken if part.kind is DrawnPartKind.CLOSED)
    if not lines:
        return False
    left, bottom, right, top = silhouette.bounds
    longest = float(np.max(np.ptp(np.concatenate(lines), axis=0)))
    return longest > REACHES_OUT * max(right - left, top - bottom)


def _is_framed(outer: Sequence[Part], closed: Sequence[Part]) -> bool:
    """Whether one is a rectangle around another one of some size: a page or a frame."""
    inside = [part for part in closed if part not in outer]
    for frame in outer:
        width, height = frame.size
        if Polygon(shell(frame.region)).area > RECTANGLE * width * height and any(
            part.region.area > WORTH_ASKING * width * height and frame.region.envelope.contains(part.region)
            for part in inside
        ):
            return True
    return False


def parts_of_region(region: BaseGeometry, like: Part) -> list[Part]:
    """The connected pieces of a filled region as parts, with lines and pen of the whole."""
    pieces = [piece for piece in shapely.get_parts(region) if isinstance(piece, Polygon) and piece.area > 0]
    if len(pieces) == 1:
        return [replace(like, region=pieces[0])]
    pieces.sort(key=lambda piece: piece.area, reverse=True)
    return [
        replace(like, name=f"{like.name} ({index})" if like.name else "", region=piece, lines=_near(like.lines, piece))
        for index, piece in enumerate(pieces, start=1)
    ]


def _near(lines: tuple[FloatArray, ...], piece: Polygon) -> tuple[FloatArray, ...]:
    """Of the lines around several pieces, those around this one."""
    box = shapely.box(*piece.bounds)
    return tuple(line for line in lines if box.intersects(LineString(line)))


def _shared(lines: Sequence[FloatArray], regions: Sequence[Polygon]) -> list[tuple[FloatArray, ...]]:
    """Lines of each region: those that touch it, or are nearest to it where they touch none."""
    tree = shapely.STRtree(regions)
    found: list[list[FloatArray]] = [[] for _ in regions]
    for line in lines:
        shape = LineString(line)
        touched = tree.query(shape, predicate="intersects").tolist() or [int(tree.nearest(shape))]
        for index in touched:
            found[index].append(line)
    return [tuple(some) for some in found]


def parts_of_groups(
    groups: Sequence[tuple[Sequence[FloatArray], Part]], widest_gap: float, unit: str
) -> tuple[list[Part], list[str], float]:
    """The parts that groups of lines make, such as those of each layer, one like a part each.

    Open lines of different groups that enclose something together are parts of their own.

    Returns
    -------
    parts : list of Part
    gaps : list of str
        A sentence on those that were closed.
    bridged : float, source units
        The width up to which gaps were closed.
    """
    parts: list[Part] = []
    gaps: list[str] = []
    bridged = 0.0
    for chains, like in groups:
        net = joined(chains, widest_gap)
        gaps += closed_gaps(net, unit)
        bridged = max(bridged, widest_gap * net.size)
        parts += parts_of_lines(net, like)
    loose = [part for part in parts if not part.is_closed]
    if len(groups) > 1 and len(loose) > 1:
        net = joined(_all_lines(loose), widest_gap)
        broadest = max(loose, key=lambda part: part.pen.width)
        layers, colours = ({getattr(part, name) for part in loose} for name in ("layer", "colour"))
        layer, colour = (one.pop() if len(one) == 1 else "" for one in (layers, colours))
        found = parts_of_lines(net, replace(broadest, name="", layer=layer, colour=colour))
        if any(part.is_closed for part in found):
            gaps += closed_gaps(net, unit)
            parts = [part for part in parts if part.is_closed] + found
    return parts, gaps, bridged


def parts_of_lines(net: Joined, like: Part) -> list[Part]:
    """The connected groups of some lines, each as a part: closed where it encloses an area.

    A contour inside another one is a part of its own, as is the contour around it.
    """
    lines = shapely.get_parts(net.lines)
    ends = np.array([(line.coords[0], line.coords[-1]) for line in lines]).reshape(-1, 2)
    _, place = np.unique(ends, axis=0, return_inverse=True)
    place = place.reshape(-1, 2)
    count = int(place.max()) + 1
    links = coo_array((np.ones(len(place)), (place[:, 0], place[:, 1])), shape=(count, count))
    groups, group = connected_components(links, directed=False)
    found = []
    order = np.argsort(group[place[:, 0]], kind="stable")
    bounds = np.searchsorted(group[place[order, 0]], np.arange(groups + 1))
    for low, high in zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True):
        members = [lines[index] for index in order[low:high]]
        chains = tuple(
            shapely.get_coordinates(line) for line in shapely.get_parts(shapely.line_merge(shapely.union_all(members)))
        )
        area = shapely.union_all(shapely.get_parts(shapely.polygonize(members)))
        regions = [piece for piece in shapely.get_parts(area) if isinstance(piece, Polygon)]
        if not regions:
            found.append(replace(like, kind=DrawnPartKind.STROKED, region=Polygon(), lines=chains))
        lines_of = _shared(chains, regions) if len(regions) > 1 else []
        for index, region in enumerate(regions):
            near = chains if len(regions) == 1 else lines_of[index]
            found.append(replace(like, kind=DrawnPartKind.CLOSED, region=region, lines=near))
    return found


def numbered(parts: Sequence[Part], size: float) -> tuple[tuple[Part, ...], tuple[str, ...]]:
    """Give parts numbers, and names to those without; the smallest of too many are left out, and dust.

    Parameters
    ----------
    size : float, source units
        Of the drawing; parts below a millionth of it are rounding.
    """
    kept = [part for part in parts if max(part.size) > 1e-6 * size]
    notes: tuple[str, ...] = ()
    if len(kept) > MOST_PARTS:
        ranked = sorted(range(len(kept)), key=lambda index: kept[index].worth, reverse=True)
        notes = (
            tr_n(
                "{count} part was left out: only the {limit} largest are offered.",
                "{count} parts were left out: only the {limit} largest are offered.",
                len(kept) - MOST_PARTS,
                limit=MOST_PARTS,
            ),
        )
        kept = [kept[index] for index in sorted(ranked[:MOST_PARTS])]
    words = {
        DrawnPartKind.FILLED: tr("shape {number}"),
        DrawnPartKind.CLOSED: tr("contour {number}"),
        DrawnPartKind.STROKED: tr("line {number}"),
    }
    named = [
        replace(
            part,
            number=number,
            name=part.name or words[part.kind].format(number=number),
            is_named=bool(part.name),
        )
        for number, part in enumerate(kept, start=1)
    ]
    return tuple(named), notes


def text_left_out() -> str:
    """The sentence where texts are not read."""
    return tr("Text was left out. Convert it to paths if it belongs to the shape.")
