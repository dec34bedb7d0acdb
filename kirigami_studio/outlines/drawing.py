"""Several objects on the drawing board: selected, ordered, lined up, combined, and united into the one target."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import tr_n
from kirigami_studio.outlines.combining import SNAP, Combine, combined
from kirigami_studio.outlines.mirroring import Axis, Mirror, mirrored
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.pieces import WORTH_SAYING, largest_piece
from kirigami_studio.outlines.placed import Placed

#: How far a copy lies beside what it was made of, mm.
COPY_SHIFT = (5.0, -5.0)
#: How far an outline that is added lies beside the other objects, and how long it is where its size is not known:
#: shares of their longer side.
BESIDE, HALF = 0.08, 0.5
BRIDGE = "bridge"
#: Where guides of a drawing board lie, mm: x of the upright ones, y of the level ones.
Guides = tuple[tuple[float, ...], tuple[float, ...]]
NO_GUIDES: Guides = ((), ())


class Order(Enum):
    """Where objects go among those above and below them."""

    TOP = "top"
    UP = "up"
    DOWN = "down"
    BOTTOM = "bottom"


class Boolean(Enum):
    """What is made of selected objects: all of them, the lowest less the others, or what they share."""

    UNION = "union"
    SUBTRACT = "subtract"
    INTERSECT = "intersect"


class AlignedSide(Enum):
    """What is lined up: the axis, 0 for x, and the share of an object's box on it."""

    LEFT = (0, 0.0)
    CENTRE = (0, 0.5)
    RIGHT = (0, 1.0)
    BOTTOM = (1, 0.0)
    MIDDLE = (1, 0.5)
    TOP = (1, 1.0)


@dataclass(frozen=True, slots=True, eq=False)
class United:
    """The target that objects make."""

    target: Placed  #: the largest piece of them
    loose: frozenset[int] = frozenset()  #: objects that hang apart from it


@dataclass(frozen=True, slots=True, eq=False)
class Drawing:
    """Objects, the lowest first, and which of them are selected."""

    objects: tuple[Placed, ...] = ()
    selected: frozenset[int] = frozenset()

    def __post_init__(self) -> None:
        inside = frozenset(index for index in self.selected if 0 <= index < len(self.objects))
        object.__setattr__(self, "selected", inside)

    # what is there -------------------------------------------------------------------------------------------------

    @property
    def chosen(self) -> tuple[int, ...]:
        """The selected objects, the lowest first; one that is alone needs no selecting."""
        return (0,) if len(self.objects) == 1 else tuple(sorted(self.selected))

    @property
    def active(self) -> int | None:
        """The object whose points are edited: the topmost selected one, else the topmost."""
        return max(self.chosen, default=len(self.objects) - 1) if self.objects else None

    def box(self, indices: Collection[int]) -> tuple[FloatArray, FloatArray]:
        """Lower left and upper right corner (2,), mm, of the box around some objects."""
        rings = np.concatenate([self.objects[index].ring for index in indices])
        return rings.min(axis=0), rings.max(axis=0)

    def at(self, place: tuple[float, float]) -> int | None:
        """The topmost object that covers a place, mm."""
        covering = (k for k, each in enumerate(self.objects) if shapely.contains_xy(each.polygon, *place))
        return max(covering, default=None)

    def within(self, low: FloatArray, high: FloatArray) -> frozenset[int]:
        """Objects that lie wholly in a box, mm."""
        rings = [each.ring for each in self.objects]
        return frozenset(k for k, ring in enumerate(rings) if np.all(ring >= low) and np.all(ring <= high))

    def united(self) -> United:
        """The one target that the objects make.

        Raises
        ------
        TargetError
            There are none, or they enclose nothing.
        """
        if len(self.objects) == 1:
            return United(self.objects[0])
        region = self._region()
        piece, _ = largest_piece(region)
        polygons = [each.polygon for each in self.objects]
        loose = frozenset(k for k, each in enumerate(polygons) if each.intersection(piece).area < 0.5 * each.area)
        lowest = next(each for k, each in enumerate(self.objects) if k not in loose)
        notes = [note for k, each in enumerate(self.objects) if k not in loose for note in each.outline.notes]
        if loose:
            notes.append(
                tr_n(
                    "{count} object hangs apart and is left out. Move it, bridge it, or keep the largest.",
                    "{count} objects hang apart and are left out. Move them, bridge them, or keep the largest.",
                    len(loose),
                )
            )
        return United(Placed.from_polygon(piece, lowest.outline.name, dict.fromkeys(notes)), loose)

    def _region(self) -> BaseGeometry:
        polygons = [each.polygon for each in self.objects]
        return shapely.union_all(polygons, grid_size=SNAP * max(each.scale for each in self.objects))

    # objects -------------------------------------------------------------------------------------------------------

    def select(self, indices: Iterable[int]) -> Drawing:
        """The same objects, others selected."""
        return replace(self, selected=frozenset(indices))

    def with_active(self, made: Placed) -> Drawing:
        """Another shape in the place of the active object, or the first one."""
        index = self.active
        if index is None:
            return Drawing((made,), frozenset({0}))
        return replace(self, objects=(*self.objects[:index], made, *self.objects[index + 1 :]))

    def added(self, *made: Placed) -> Drawing:
        """Objects on top of the others, selected."""
        count = len(self.objects)
        return Drawing((*self.objects, *made), frozenset(range(count, count + len(made))))

    def beside(self, outline: Outline) -> Drawing:
        """An outline as one more object on the right of the others: in its own size where that is known in mm, else
        half as long as they are.
        """
        low, high = self.box(range(len(self.objects)))
        length = float(np.max(high - low))
        made = Placed.on_board(replace(outline, place=None))
        if outline.size is None or outline.unit != "mm":
            made = made.enlarged(HALF * length / max(made.size), (0.0, 0.0))
        own_low, own_high = made.ring.min(axis=0), made.ring.max(axis=0)
        x = float(high[0] - own_low[0]) + BESIDE * length
        y = 0.5 * float(np.sum((low, high), axis=0)[1] - np.sum((own_low, own_high), axis=0)[1])
        return self.added(made.moved((x, y)))

    def changed(self, change: Callable[[Placed], Placed]) -> Drawing:
        """Each selected object changed."""
        chosen = self.chosen
        return replace(
            self, objects=tuple(change(each) if k in chosen else each for k, each in enumerate(self.objects))
        )

    def moved(self, by: tuple[float, float]) -> Drawing:
        """The selected objects elsewhere, by so many mm."""
        return self.changed(lambda each: each.moved(by))

    def duplicated(self) -> Drawing:
        """Copies of the selected objects on top, a little beside them, selected."""
        return self.added(*(self.objects[k].moved(COPY_SHIFT) for k in self.chosen))

    def without(self, indices: Collection[int]) -> Drawing:
        """The drawing without some objects; nothing is selected."""
        return Drawing(tuple(each for k, each in enumerate(self.objects) if k not in indices))

    def deleted(self) -> Drawing:
        """The drawing without the selected objects."""
        return self.without(self.chosen)

    def with_holes(self, filled: bool) -> Drawing:
        """The objects with their holes filled or open; one object where a hole lies between several."""
        made = replace(self, objects=tuple(each.with_holes(filled) for each in self.objects))
        target = made.united().target
        done = not (target.outline.holes if filled else target.outline.filled_holes)
        return made if done else Drawing((target.with_holes(filled),), frozenset({0}))

    def without_hole_at(self, place: tuple[float, float]) -> Drawing | None:
        """The drawing with the topmost hole around a place, mm, filled; None without one."""
        for k in range(len(self.objects) - 1, -1, -1):
            if (made := self.objects[k].without_hole_at(place)) is not None:
                return replace(self, objects=(*self.objects[:k], made, *self.objects[k + 1 :]))
        return None

    def ordered(self, order: Order) -> Drawing:
        """The selected objects above or below others; they stay selected."""
        every, chosen = list(range(len(self.objects))), set(self.chosen)
        if order in (Order.TOP, Order.BOTTOM):
            rest = [k for k in every if k not in chosen]
            every = [*rest, *self.chosen] if order is Order.TOP else [*self.chosen, *rest]
        else:
            step = 1 if order is Order.UP else -1
            for k in self.chosen[::-step]:
                at = every.index(k)
                if 0 <= at + step < len(every) and every[at + step] not in chosen:
                    every[at], every[at + step] = every[at + step], every[at]
        return Drawing(
            tuple(self.objects[k] for k in every), frozenset(at for at, k in enumerate(every) if k in chosen)
        )

    def aligned(self, side: AlignedSide) -> Drawing:
        """The selected objects with one side, or their middles, on one line of the box around them."""
        axis, share = side.value
        low, high = self.box(self.chosen)
        line = low[axis] + share * (high[axis] - low[axis])
        return self._each_along(axis, lambda own_low, own_high: line - own_low - share * (own_high - own_low))

    def distributed(self, axis: int) -> Drawing:
        """The selected objects with equal gaps between their boxes along x (0) or y (1); the outermost stay."""
        boxes = {k: self.box((k,)) for k in self.chosen}
        row = sorted(boxes, key=lambda k: float(boxes[k][0][axis] + boxes[k][1][axis]))
        sizes = {k: float(high[axis] - low[axis]) for k, (low, high) in boxes.items()}
        start = float(boxes[row[0]][0][axis])
        gap = (float(boxes[row[-1]][1][axis]) - start - sum(sizes.values())) / max(len(row) - 1, 1)
        objects = list(self.objects)
        for k in row:
            objects[k] = _along(objects[k], axis, start - float(boxes[k][0][axis]))
            start += sizes[k] + gap
        return replace(self, objects=tuple(objects))

    def _each_along(self, axis: int, way: Callable[[float, float], float]) -> Drawing:
        def shifted(each: Placed) -> Placed:
            ring = each.ring[:, axis]
            return _along(each, axis, way(float(ring.min()), float(ring.max())))

        return self.changed(shifted)

    # shapes of several -----------------------------------------------------------------------------------------------

    def joined(self, how: Boolean) -> Drawing:
        """What is made of the selected objects, in the place of the topmost of them; each piece is an object.

        Raises
        ------
        TargetError
            Nothing would be left or changed.
        """
        chosen = self.chosen
        shapes = [self.objects[k].polygon for k in chosen]
        grid = SNAP * max(self.objects[k].scale for k in chosen)
        if how is Boolean.UNION:
            region = shapely.union_all(shapes, grid_size=grid)
        elif how is Boolean.INTERSECT:
            region = shapes[0]
            for shape in shapes[1:]:
                region = shapely.intersection(region, shape, grid_size=grid)
        else:
            region = shapely.difference(shapes[0], shapely.union_all(shapes[1:]), grid_size=grid)
        least = WORTH_SAYING * shapes[0].area
        parts = [each for each in shapely.get_parts(region) if isinstance(each, Polygon) and each.area > least]
        if not parts:
            raise TargetError("combine.nothing_shared" if how is Boolean.INTERSECT else "combine.nothing_left")
        if how is Boolean.UNION and len(parts) == len(chosen):
            raise TargetError("combine.apart")
        name = self.objects[chosen[0]].outline.name
        made = tuple(Placed.from_polygon(each, name) for each in parts)
        below = [each for k, each in enumerate(self.objects[: chosen[-1]]) if k not in chosen]
        above = self.objects[chosen[-1] + 1 :]
        return Drawing((*below, *made, *above), frozenset(range(len(below), len(below) + len(made))))

    def with_drawn(self, drawn: Placed, how: Combine, name: str, mirror: Mirror) -> Drawing:
        """Take a shape that was drawn: as another object, or joined with those that it overlaps.

        Raises
        ------
        TargetError
            As :func:`~kirigami_studio.outlines.mirroring.mirrored`.
        """
        if how is Combine.NEW or not self.objects:
            return self.added(*_with_images(drawn, name, mirror))
        region = shapely.union_all(mirror.united([drawn.polygon]))
        touched = [k for k, each in enumerate(self.objects) if _overlap(each.polygon, region)]
        if len(touched) < 2:
            index = touched[0] if touched else self.active or 0
            return self.select({index}).with_active(mirrored(self.objects[index], drawn, how, name, mirror))
        if how is not Combine.ADD:
            made = {k: mirrored(self.objects[k], drawn, how, name, mirror) for k in touched}
            return replace(self, objects=tuple(made.get(k, each) for k, each in enumerate(self.objects)))
        first = self.objects[touched[0]]
        whole = shapely.union_all([region, *(self.objects[k].polygon for k in touched)])
        one = combined(first, Placed.from_polygon(largest_piece(whole)[0], name), Combine.ADD)
        rest = [k for k in range(len(self.objects)) if k not in touched[1:]]
        objects = tuple(one if k == touched[0] else self.objects[k] for k in rest)
        return Drawing(objects, frozenset({rest.index(touched[0])}))

    def bridged(self) -> Drawing:
        """The drawing with bridges between what hangs apart, each an object.

        Raises
        ------
        TargetError
            Too many pieces.
        """
        from kirigami_studio.outlines.merging import Join, Merging, bridged  # SciPy, not at the window's start

        region = self._region()
        left, bottom, right, top = region.bounds
        _, bridges = bridged(region, Merging(Join.BRIDGE), max(right - left, top - bottom))
        return self.added(*(Placed.from_polygon(each, BRIDGE) for each in bridges))

    def largest(self) -> Drawing:
        """The drawing without what hangs apart from its largest piece."""
        return self.without(self.united().loose)


def about(each: Placed, angle: float, centre: FloatArray) -> Placed:
    """An object turned counter-clockwise by ``angle``, radians, about a place (2,), mm."""
    cos, sin = math.cos(angle), math.sin(angle)
    matrix = np.array([[cos, sin], [-sin, cos]])
    return each.mapped(matrix, centre - centre @ matrix)


def _with_images(drawn: Placed, name: str, mirror: Mirror) -> tuple[Placed, ...]:
    """A drawn shape and its images: one object where they hang together, else several."""
    if mirror.axis is Axis.NONE:
        return (drawn,)
    pieces = mirror.united([drawn.polygon])
    if len(pieces) == 1:
        return (mirrored(None, drawn, Combine.NEW, name, mirror),)
    own, notes = drawn.outline.name, drawn.outline.notes
    return tuple(Placed.from_polygon(each, own, notes) for each in pieces)


def _overlap(one: BaseGeometry, other: BaseGeometry) -> bool:
    return bool(one.intersection(other).area > WORTH_SAYING * min(one.area, other.area))


def _along(each: Placed, axis: int, way: float) -> Placed:
    return each.moved((way, 0.0) if axis == 0 else (0.0, way))
