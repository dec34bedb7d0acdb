"""The sheet that is cut: ratios, rim, outline while flat, and size of its cells.

Along each side, *mouths* and *edge hinges* alternate.  At a mouth a cut leaves the sheet: two panels own a node each,
at the same place while the sheet is flat.  At an edge hinge two panels share the node.  The paper spaces both evenly.
All that the second compact state needs is that each edge hinge sits halfway between its two neighbouring mouths (a
corner counts as a mouth): its two rim edges then still fold onto each other.  That frees the mouths, and as every
compact node is a fixed combination of the rim's, all nodes are linear in them.  A sheet that shows its target half open
needs no second compact state: there edge hinges may sit anywhere between their mouths (``Rim.hinges``), as in the
sheets of Choi, Dudte and Mahadevan (2019), whose notches are narrower for it.

Nor does the flat sheet have to be a rectangle: with mouths and corners on any convex outline and edge hinges halfway
along the chords between them, the barycentric system of ``compact`` divides that polygon into panels all the same.
Around hollows of an outline it does so for some ratios and mouths only: others turn panels over.
``start_outline`` decides which places along the rim the outline's points have.
"""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import field as attribute
from functools import cache
from typing import Literal

import numpy as np
import numpy.typing as npt

from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.foundation.errors import SheetError, UsageError
from kirigami_studio.lattice.ratio_field import RatioField, check_grid, frozen
from kirigami_studio.lattice.resize import resize_fields
from kirigami_studio.lattice.start_outline import checked_start, vertex_places
from kirigami_studio.lattice.topology import topology

Side = Literal["top", "right", "bottom", "left"]
SIDES: tuple[Side, ...] = ("top", "right", "bottom", "left")

#: Mouths, corners and hinges may not come nearer to each other than this (unit cells): what is exact needs room.
LEAST_GAP = 1e-3
#: How far (unit cells) fits and samples move a mouth from its even place: rim edges stay longer than 0.3 cells.
RIM_REACH = 0.7
#: How far (share of the rim between two mouths) fits move an edge hinge from halfway: the same 1 : 10 as of ratios.
HINGE_REACH = 0.4
#: Edge hinges stay this far (share) from halfway at most: a rim edge needs length.
FARTHEST_HINGE = 0.49
#: Sides of a cell (unit cells): within these bounds tolerances in cells mean something.
CELL_SIDES = (0.05, 20.0)


@dataclass(frozen=True, slots=True, eq=False)
class RimTable:
    """Places of the rim's nodes for one grid, as combinations of mouths and corners.

    The *anchors* of a side are its two corners and its mouths.  They are numbered along the rim, clockwise from the
    top left corner.
    """

    #: (R,); anchor numbers of the mouths, side by side: top and bottom left to right, right and left top to bottom.
    mouths: IntArray
    even: FloatArray  #: (R,), unit cells; where the paper has these mouths, along their sides
    side: IntArray  #: (R,); the side of each mouth: 0 top, 1 right, 2 bottom, 3 left
    #: (A,), unit cells; where the paper has the anchors, along the rim clockwise from the top left corner.
    anchor_place: FloatArray
    node: IntArray  #: (G,); the given nodes, numbered as in :class:`~kirigami_studio.lattice.topology.Topology`
    #: (G, A); each given node as a combination of the anchors: 1 at its own, one half at both neighbours of an edge
    #: hinge.
    share: FloatArray
    hinges: IntArray  #: (E,); rows of ``share`` of the edge hinges, clockwise
    between: IntArray  #: (E, 2); the anchors before and after each of them, clockwise

    def shares(self, hinges: FloatArray) -> FloatArray:
        """``share`` with edge hinges moved from halfway by ``hinges`` (E,); none if that is empty."""
        if not hinges.size:
            return self.share
        moved = self.share.copy()
        moved[self.hinges, self.between[:, 0]] = 0.5 - hinges
        moved[self.hinges, self.between[:, 1]] = 0.5 + hinges
        return moved


@cache
def rim_table(rows: int, columns: int) -> RimTable:
    """The (cached) table of an m x n grid."""
    tables = topology(rows, columns)
    width, height = columns + 1, rows + 1
    around = 2 * (width + height)
    node = np.flatnonzero(tables.fixed)
    x, depth = tables.uniform_nodes[node, 0], -tables.uniform_nodes[node, 1]
    right, bottom, left = (x == width) & (depth > 0), (depth == height) & (x < width), (x == 0) & (depth > 0)
    place = np.where(depth == 0, x, 0.0)
    place = np.where(right, width + depth, place)
    place = np.where(bottom, width + height + (width - x), place)
    place = np.where(left & ~bottom, around - depth, place)
    corners = [0, width, width + height, 2 * width + height]
    hinge = np.isin(node, _edge_hinges(rows, columns))
    anchor_place = np.unique(place[~hinge])
    share = np.zeros((node.size, anchor_place.size))
    at = np.searchsorted(anchor_place, place)
    share[~hinge, at[~hinge]] = 1.0
    hinges = np.flatnonzero(hinge)
    hinges = hinges[np.argsort(place[hinges])]
    between = np.stack([at[hinges] - 1, at[hinges] % anchor_place.size], axis=1)
    share[hinges[:, None], between] = 0.5
    mouths, even, side = [], [], []
    for number, (first, length, along) in enumerate(
        zip(corners, (width, height, width, height), (1, 1, -1, -1), strict=True)
    ):
        inside = np.flatnonzero((anchor_place > first) & (anchor_place < first + length))[::along]
        mouths.append(inside)
        even.append(anchor_place[inside] - first if along > 0 else first + length - anchor_place[inside])
        side.append(np.full(inside.size, number))
    table = RimTable(
        np.concatenate(mouths), np.concatenate(even), np.concatenate(side), anchor_place, node, share, hinges, between
    )
    for values in (table.mouths, table.even, table.side, table.anchor_place, table.node, table.share, hinges, between):
        values.setflags(write=False)
    return table


def _edge_hinges(rows: int, columns: int) -> IntArray:
    """Given nodes that two panels share."""
    tables = topology(rows, columns)
    shared = np.concatenate([tables.h[1:-1].ravel(), tables.v[:, 1:-1].ravel()])
    hinges: IntArray = shared[tables.fixed[shared]]
    return hinges


@dataclass(frozen=True, slots=True, eq=False)
class Rim:
    """Where the cuts meet the rim: mouths along each side, and edge hinges that are off halfway."""

    #: top, bottom: (k,), unit cells; from left to right, inside 0 .. n + 1.
    top: FloatArray
    #: right, left: (k,), unit cells; from top to bottom, inside 0 .. m + 1.
    right: FloatArray
    bottom: FloatArray
    left: FloatArray
    #: (E,); how far each edge hinge is from halfway between its mouths, as a share of the rim between these, clockwise
    #: from the top left corner; empty where all are halfway, which the second compact state needs.
    hinges: FloatArray = attribute(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        for name, given in zip((*SIDES, "hinges"), (*self.sides, self.hinges), strict=True):
            try:
                values = _numbers(given)
            except (TypeError, ValueError, OverflowError):
                values = frozen([np.nan])
            if values.ndim != 1 or not np.all(np.isfinite(values)):
                if name == "hinges":
                    raise SheetError("rim.hinges_not_numbers")
                raise SheetError("rim.not_numbers", side=name)
            object.__setattr__(self, name, values)
        if not self.hinges.any():
            object.__setattr__(self, "hinges", frozen(np.zeros(0)))

    @classmethod
    @cache
    def even(cls, rows: int, columns: int) -> Rim:
        """The paper's: mouths and hinges at whole positions."""
        return cls.moved(rows, columns, np.zeros(rim_table(rows, columns).even.size))

    @classmethod
    def moved(cls, rows: int, columns: int, offsets: FloatArray, hinges: FloatArray | None = None) -> Rim:
        """Mouths moved along their sides by ``offsets`` (R,), unit cells, as in :class:`RimTable`.

        Edge hinges are moved by the shares ``hinges`` (E,), in its order too.
        """
        table = rim_table(rows, columns)
        positions = table.even + offsets
        top, right, bottom, left = (positions[table.side == number] for number in range(4))
        return cls(top, right, bottom, left, np.zeros(0) if hinges is None else hinges)

    @property
    def folds_shut(self) -> bool:
        """Whether all edge hinges are halfway, so that the second compact state is whole."""
        return not self.hinges.size

    def folding_shut(self) -> Rim:
        """The same mouths with all edge hinges halfway."""
        return self if self.folds_shut else Rim(*self.sides)

    def hinge_offsets(self, rows: int, columns: int) -> FloatArray:
        """How far each edge hinge is from halfway: (E,) float, share of the rim between its mouths."""
        return self.hinges if self.hinges.size else np.zeros(rim_table(rows, columns).hinges.size)

    @property
    def sides(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Top, right, bottom, left."""
        return self.top, self.right, self.bottom, self.left

    @property
    def positions(self) -> FloatArray:
        """All mouths in the order of :class:`RimTable`: (R,) float, unit cells."""
        return np.concatenate(self.sides)

    def offsets(self, rows: int, columns: int) -> FloatArray:
        """How far each mouth is from its even place: (R,) float, unit cells."""
        return self.positions - rim_table(rows, columns).even

    def check(self, rows: int, columns: int) -> None:
        """Refuse a rim that does not belong to the grid.

        Raises
        ------
        SheetError
            A side has another number of mouths, or mouths that are not in order between its corners; or edge hinges of
            another number, or too near to a mouth.
        """
        table = rim_table(rows, columns)
        if self.hinges.size not in (0, table.hinges.size):
            raise SheetError(
                "rim.wrong_hinges", wanted=table.hinges.size, got=self.hinges.size, rows=rows, columns=columns
            )
        if np.abs(self.hinges).max(initial=0.0) > FARTHEST_HINGE:
            raise SheetError("rim.hinge_too_far", farthest=FARTHEST_HINGE)
        for number, (name, values) in enumerate(zip(SIDES, self.sides, strict=True)):
            wanted = int(np.count_nonzero(table.side == number))
            if values.size != wanted:
                raise SheetError(
                    "rim.wrong_count", side=name, wanted=wanted, got=values.size, rows=rows, columns=columns
                )
            length = float(columns + 1 if number % 2 == 0 else rows + 1)
            if np.any(np.diff(np.concatenate([[0.0], values, [length]])) < LEAST_GAP):
                raise SheetError("rim.not_in_order", side=name, length=length, least=LEAST_GAP)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Rim) and all(
            np.array_equal(mine, yours)
            for mine, yours in zip((*self.sides, self.hinges), (*other.sides, other.hinges), strict=True)
        )

    def __hash__(self) -> int:
        return hash(self.positions.tobytes() + self.hinges.tobytes())

    def __reduce__(self) -> tuple[type[Rim], tuple[FloatArray, ...]]:
        return Rim, (*self.sides, self.hinges)


@dataclass(frozen=True, slots=True, eq=False)
class Sheet:
    """One design before it moves: everything that decides where its cuts are."""

    field: RatioField
    rim: Rim  #: evenly spaced unless given
    #: (P, 2), unit cells; outline of the flat sheet, simple, clockwise (y up) from the place of the top left corner
    #: panel's corner; the other three corners and the even places of the mouths follow at the shares of its length that
    #: they have on the rectangle, moved so that its sharp corners are among them, see ``start_outline``.  None for the
    #: rectangle of (n + 1) x (m + 1) cells.
    start: FloatArray | None
    #: (width, height), unit cells; scales the flat sheet; other than (1, 1) gives a rectangle of another aspect.
    cell: tuple[float, float]
    _hash: int = attribute(repr=False)  # sheets, and candidates that have them, are keys of many tables

    def __init__(
        self,
        field: RatioField,
        rim: Rim | None = None,
        start: npt.ArrayLike | None = None,
        cell: tuple[float, float] = (1.0, 1.0),
    ) -> None:
        if rim is None:
            rim = Rim.even(field.rows, field.columns)
        else:
            rim.check(field.rows, field.columns)
        object.__setattr__(self, "field", field)
        object.__setattr__(self, "rim", rim)
        object.__setattr__(self, "start", None if start is None else checked_start(start))
        object.__setattr__(self, "cell", _checked_cell(cell))
        outline = None if self.start is None else self.start.tobytes()
        object.__setattr__(self, "_hash", hash((self.field, self.rim, self.cell, outline)))

    @classmethod
    def of(cls, design: Sheet | RatioField) -> Sheet:
        """A sheet, or the paper's sheet with these ratios."""
        return design if isinstance(design, Sheet) else cls(design)

    @classmethod
    def uniform(cls, rows: int, columns: int) -> Sheet:
        """All ratios 1 and an even rim: the floor that every score is compared with."""
        return cls(RatioField.uniform(rows, columns))

    @property
    def rows(self) -> int:
        return self.field.rows

    @property
    def columns(self) -> int:
        return self.field.columns

    @property
    def grid(self) -> tuple[int, int]:
        """(rows, columns) of voids."""
        return self.field.rows, self.field.columns

    @property
    def has_even_rim(self) -> bool:
        """Whether the mouths are where the paper has them."""
        return self.rim == Rim.even(*self.grid)

    @property
    def is_default(self) -> bool:
        """Whether rim, start outline and cell are the paper's: ratios alone tell the sheet."""
        return self == Sheet(self.field)

    def with_field(self, field: RatioField) -> Sheet:
        """The same sheet with other ratios of the same grid."""
        return replace_sheet(self, field=field)

    def plain(self) -> Sheet:
        """The uniform sheet of the same grid, start outline and cell: what a score compares with."""
        return Sheet(RatioField.uniform(*self.grid), None, self.start, self.cell)

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, Sheet)
            and self.field == other.field
            and self.rim == other.rim
            and self.cell == other.cell
            and (self.start is None) == (other.start is None)
            and (self.start is None or other.start is None or np.array_equal(self.start, other.start))
        )

    def __hash__(self) -> int:
        return self._hash

    def __reduce__(self) -> tuple[type[Sheet], tuple[object, ...]]:
        return Sheet, (self.field, self.rim, self.start, self.cell)


def replace_sheet(sheet: Sheet, field: RatioField | None = None, rim: Rim | None = None) -> Sheet:
    """The same sheet with other ratios or another rim."""
    return Sheet(field or sheet.field, rim or sheet.rim, sheet.start, sheet.cell)


def rim_nodes(sheet: Sheet) -> FloatArray:
    """The given nodes (G, 2), unit cells, in the order of ``rim_table(...).node``."""
    return np.asarray(rim_table(*sheet.grid).shares(sheet.rim.hinges) @ anchor_points(sheet))


def anchor_points(sheet: Sheet) -> FloatArray:
    """Corners and mouths (A, 2), unit cells, clockwise from the top left corner."""
    return RimPath(*sheet.grid, sheet.start, sheet.cell).anchors(sheet.rim.positions)


@dataclass(frozen=True, slots=True, eq=False)
class RimPath:
    """The flat sheet's outline as a path that mouths move along."""

    rows: int
    columns: int
    start: FloatArray | None = None  #: (P, 2)
    cell: tuple[float, float] = (1.0, 1.0)  #: (width, height), unit cells
    #: Vertices of the outline, the first again at the end, without the cell, and their places.
    _corners: FloatArray = attribute(init=False, repr=False)
    _corner_place: FloatArray = attribute(init=False, repr=False)

    def __post_init__(self) -> None:
        width, height = float(self.columns + 1), float(self.rows + 1)
        if self.start is None:
            place = np.array([0.0, width, width + height, 2 * width + height, 2.0 * (width + height)])
            corners = np.array([[0.0, 0.0], [width, 0.0], [width, -height], [0.0, -height], [0.0, 0.0]])
        else:
            place, _ = vertex_places(
                self.start, self.rows, self.columns, rim_table(self.rows, self.columns).anchor_place
            )
            corners = np.concatenate([self.start, self.start[:1]])
        object.__setattr__(self, "_corners", corners)
        object.__setattr__(self, "_corner_place", place)

    def anchors(self, positions: FloatArray) -> FloatArray:
        """Corners and mouths (A, 2), unit cells, from the mouths' ``positions`` (R,)."""
        table = rim_table(self.rows, self.columns)
        place = table.anchor_place.copy()
        place[table.mouths] = self._around(positions)
        return self._points(place)

    def slopes(self, positions: FloatArray) -> FloatArray:
        """Derivatives (R, 2) of the mouths' points by their own positions.

        At a vertex of the start it is that of the part behind it, clockwise.
        """
        table = rim_table(self.rows, self.columns)
        if self.start is None:
            along = np.array([[1.0, 0.0], [0.0, -1.0], [1.0, 0.0], [0.0, -1.0]])[table.side]
            return np.asarray(along * self.cell)
        corners, corner_place = self._corners, self._corner_place
        part = np.searchsorted(corner_place, self._around(positions), side="right") - 1
        slope = np.diff(corners, axis=0) / np.diff(corner_place)[:, None]
        clockwise = np.where(table.side < 2, 1.0, -1.0)
        return np.asarray(clockwise[:, None] * slope[np.clip(part, 0, len(slope) - 1)] * self.cell)

    def cut_off(self, positions: FloatArray) -> FloatArray:
        """Areas (A,), unit cells squared, between the outline from anchor to anchor and its chords.

        Those that chords cut off are positive, those that they add across hollows negative.
        """
        table = rim_table(self.rows, self.columns)
        corners, corner_place = self._corners, self._corner_place
        corners = corners * self.cell
        place = table.anchor_place.copy()
        place[table.mouths] = self._around(positions)
        points = self._points(place)
        # Twice the area swept by the ray from the origin, clockwise, up to each vertex, then up to each anchor.
        swept = np.concatenate([[0.0], np.cumsum(_swept(corners[:-1], corners[1:]))])
        part = np.clip(np.searchsorted(corner_place, place, side="right") - 1, 0, len(corners) - 2)
        to_anchor = swept[part] + _swept(corners[part], points)
        along = np.diff(np.append(to_anchor, swept[-1] + to_anchor[0]))
        return np.asarray(0.5 * (along - _swept(points, np.roll(points, -1, axis=0))))

    def outline(self) -> FloatArray:
        """The path itself: (P, 2), unit cells, clockwise."""
        return np.asarray(self._corners[:-1] * self.cell)

    @property
    def held(self) -> BoolArray:
        """Which mouths (R,) belong at sharp corners of the start outline, where fits leave them."""
        table = rim_table(self.rows, self.columns)
        if self.start is None:
            return np.zeros(table.mouths.size, dtype=np.bool_)
        return vertex_places(self.start, self.rows, self.columns, table.anchor_place)[1][table.mouths]

    def _around(self, positions: FloatArray) -> FloatArray:
        """Places (R,) of the mouths along the rim, clockwise from the top left corner, unit cells."""
        side = rim_table(self.rows, self.columns).side
        width, height = self.columns + 1, self.rows + 1
        first = np.array([0, width, 2 * width + height, 2 * (width + height)])[side]
        return np.where(side < 2, first + positions, first - positions)

    def _points(self, place: FloatArray) -> FloatArray:
        """Points of the outline at places along it, clockwise from the top left corner: (K, 2)."""
        corners, corner_place = self._corners, self._corner_place
        points = np.stack([np.interp(place, corner_place, corners[:, axis]) for axis in (0, 1)], axis=1)
        return np.asarray(points * self.cell)


def _swept(first: FloatArray, second: FloatArray) -> FloatArray:
    """Twice the areas swept clockwise from the origin between points (K, 2) and others."""
    return np.asarray(first[:, 1] * second[:, 0] - first[:, 0] * second[:, 1])


def _numbers(values: npt.ArrayLike) -> FloatArray:
    """Read-only float64 copy of real numbers; text and truth values are none."""
    table = np.asarray(values)
    if table.dtype.kind not in "iuf" and table.size:
        raise TypeError("not real numbers")
    return frozen(table)


def _checked_cell(cell: tuple[float, float]) -> tuple[float, float]:
    try:
        size = _numbers(cell)
    except (TypeError, ValueError, OverflowError):
        size = frozen([])
    if size.shape != (2,) or not np.all(np.isfinite(size) & (size > 0)):
        raise UsageError("cell.not_positive", cell=cell)
    least, most = CELL_SIDES
    if size.min() < least or size.max() > most:
        raise UsageError("cell.out_of_range", width=size[0], height=size[1], least=least, most=most)
    return float(size[0]), float(size[1])


def resized_sheet(sheet: Sheet, rows: int, columns: int) -> Sheet:
    """The sheet carried to another grid: ratios by parity, the rim's offsets along sides.

    On another grid edge hinges are halfway.
    """
    check_grid(rows, columns)
    if sheet.grid == (rows, columns):
        return sheet
    z = resize_fields(sheet.field.log10[np.newaxis], rows, columns)[0]
    old, new = rim_table(*sheet.grid), rim_table(rows, columns)
    offsets = np.zeros(new.even.size)
    share = sheet.rim.offsets(*sheet.grid)
    for number in range(4):
        before = (sheet.columns if number % 2 == 0 else sheet.rows) + 1
        after = (columns if number % 2 == 0 else rows) + 1
        mine, theirs = old.side == number, new.side == number
        place = np.concatenate([[0.0], old.even[mine] / before, [1.0]])
        value = np.concatenate([[0.0], share[mine] / before, [0.0]])
        offsets[theirs] = after * np.interp(new.even[theirs] / after, place, value)
    rim = Rim.moved(rows, columns, offsets)
    return Sheet(RatioField.from_log10(z), rim, sheet.start, sheet.cell)
