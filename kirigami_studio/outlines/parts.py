"""What a file holds, part by part: shapes and lines with layer, colour and size, of which a target is made.

A part is a connected filled region, a closed contour of lines, or a connected open line.  Its geometry is in the units
of the source, y up; :mod:`~kirigami_studio.outlines.merging` makes one outline of chosen parts.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import TYPE_CHECKING, Literal

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError, UsageError
from kirigami_studio.foundation.frozen_mapping import FrozenMapping
from kirigami_studio.foundation.plain_text import LONGEST_NOTE, plain_line
from kirigami_studio.foundation.words import tr, tr_n

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kirigami_studio.outlines.joining import Joined

#: Larger numbers of parts are not told apart any more: the smallest are left out.
MOST_PARTS = 500
#: A part below this share of the largest one's area is a speck: nobody is asked about it.
SPECK = 0.01
#: A part that fills this share of its box is a rectangle: around others, a page or a frame.
RECTANGLE = 0.99
#: A part inside a frame is one to be asked about from this share of the frame's area on.
WORTH_ASKING = 0.02
#: Digits of the areas by which it is told which part lies around which; a fill and a stroke of one outline differ by
#: rounding, and then the first counts.
SAME_AREA = 9
Cap = Literal["round", "flat", "square"]
Corner = Literal["round", "mitre", "bevel"]
ALL, LARGEST = "all", "largest"


class DrawnPartKind(Enum):
    """What makes a part."""

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
    def usual(self) -> tuple[int, ...]:
        """Numbers of the parts that are taken without asking: the largest connected region; else the largest line."""
        outer = self._outer()
        if not outer:
            return (max(self.parts, key=lambda part: part.worth).number,)
        largest = max(_groups(outer), key=lambda group: float(shapely.union_all([p.region for p in group]).area))
        return tuple(part.number for part in largest)

    @property
    def is_ambiguous(self) -> bool:
        """Whether there is something to ask: separate parts, lines without an area, or parts on a page."""
        closed = [part for part in self.parts if part.is_closed]
        if not closed:
            return True
        outer = self._outer()
        if len(_groups(self._usable(outer))) > 1:
            return True
        inside = [part for part in closed if part not in outer]
        for frame in outer:
            width, height = frame.size
            if Polygon(shell(frame.region)).area > RECTANGLE * width * height and any(
                part.region.area > WORTH_ASKING * width * height and frame.region.envelope.contains(part.region)
                for part in inside
            ):
                return True
        everything = shapely.box(*shapely.union_all([part.region for part in closed]).bounds)
        return any(shapely.box(*part.bounds).contains_properly(everything) for part in self.parts if not part.is_closed)

    def _usable(self, parts: Sequence[Part]) -> list[Part]:
        largest = max(part.worth for part in parts)
        return [part for part in parts if part.worth >= SPECK * largest]

    def _outer(self) -> list[Part]:
        """Closed parts that do not lie inside another one."""
        closed = [part for part in self.parts if part.is_closed]
        shells = [Polygon(shell(part.region)) for part in closed]
        # Hundreds of copies are not compared with each other.
        first = {each.wkb: index for index, each in reversed([*enumerate(shells)])}
        several = sorted(first.values(), key=lambda index: (-float(f"{shells[index].area:.{SAME_AREA}g}"), index))
        ranked = np.array([shells[index] for index in several], dtype=object)
        inner, around = shapely.STRtree(ranked).query(ranked, predicate="covered_by")
        # One rank for all: of parts that cover each other, the first of the largest is never hidden.
        hidden = set(inner[around < inner].tolist())
        outer = {index for rank, index in enumerate(several) if rank not in hidden}
        return [part for index, part in enumerate(closed) if index in outer]

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


def _groups(parts: Sequence[Part]) -> list[list[Part]]:
    """Parts that touch each other, together."""
    regions = [part.region for part in parts]
    one, other = shapely.STRtree(regions).query(regions, predicate="intersects")
    links = coo_array((np.ones(len(one)), (one, other)), shape=(len(parts), len(parts)))
    count, group = connected_components(links, directed=False)
    return [[part for part, of in zip(parts, group.tolist(), strict=True) if of == index] for index in range(count)]


def parts_of_region(region: BaseGeometry, like: Part) -> list[Part]:
    """The connected pieces of a filled region, each as a part; lines and pen are those of the whole."""
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
        for region in regions:
            near = chains if len(regions) == 1 else _near(chains, region)
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
