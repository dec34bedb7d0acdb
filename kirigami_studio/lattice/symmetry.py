"""Exact symmetries of the lattice: sheets that equal their own turned or mirrored image.

With z = log10 x, row i from the top and column j from the left, the lattice has

* the flip left to right, when the number of columns is odd: z changes its sign;
* the flip top to bottom, when the number of rows is odd: z changes its sign;
* both flips, when both numbers are odd;
* the half turn, when rows and columns are both even or both odd: z stays;
* the quarter turn, on square grids with an even number of rows: z changes its sign.

A flip changes the sense in which panels turn, which an odd number of columns (rows) makes good: even and odd panels
change places.  Mouths go where the flip or turn takes them; their offset along the side changes its sign where their
direction along the side is reversed.  So do edge hinges, whose direction, clockwise, is reversed by flips.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import cache, cached_property, lru_cache

import numpy as np
from scipy.sparse import csc_matrix

from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lattice.sheet import RimPath, Sheet, anchor_points, rim_nodes, rim_table


@dataclass(frozen=True, slots=True)
class Move:
    """A flip left to right, if any, then quarter turns, counter-clockwise."""

    turns: int  #: quarter turns
    flipped: bool

    @property
    def sign(self) -> float:
        """Factor of z: a void's ratio is inverted by a flip and by a quarter turn."""
        return -1.0 if self.flipped != bool(self.turns % 2) else 1.0

    @property
    def matrix(self) -> FloatArray:
        """The move about the origin, (2, 2): applied to row vectors from the right."""
        flip = np.diag([-1.0, 1.0]) if self.flipped else np.eye(2)
        return np.asarray(flip @ np.linalg.matrix_power(np.array([[0.0, 1.0], [-1.0, 0.0]]), self.turns))

    def image(self, z: FloatArray) -> FloatArray:
        """Fields (..., m, n), log10 of ratios, of the flipped and turned sheet."""
        image: FloatArray = self.sign * np.rot90(np.flip(z, -1) if self.flipped else z, self.turns, axes=(-2, -1))
        return image


FLIP, FLIP_DOWN, HALF = Move(0, True), Move(2, True), Move(2, False)


class Symmetry(Enum):
    """A group of moves that the lattice of suitable grids has.

    Attributes
    ----------
    label : str
        Name in files and JSON; which of the two single mirrors it is follows from the grid.
    moves : tuple of Move
        All moves that leave a symmetric sheet as it is, other than none at all.
    """

    LEFT_RIGHT = ("mirror", (FLIP,))
    TOP_BOTTOM = ("mirror", (FLIP_DOWN,))
    HALF_TURN = ("half_turn", (HALF,))
    QUARTER_TURN = ("quarter_turn", (Move(1, False), HALF, Move(3, False)))
    TWO_MIRRORS = ("two_mirrors", (FLIP, FLIP_DOWN, HALF))

    def __init__(self, label: str, moves: tuple[Move, ...]) -> None:
        self.label, self.moves = label, moves

    @property
    def mirrors(self) -> bool:
        """Whether a flip is among the moves: a target's axis then lies along the sheet's."""
        return any(move.flipped for move in self.moves)

    def fits(self, rows: int, columns: int) -> bool:
        """Whether the lattice of a grid has this symmetry."""
        match self:
            case Symmetry.LEFT_RIGHT:
                return columns % 2 == 1
            case Symmetry.TOP_BOTTOM:
                return rows % 2 == 1
            case Symmetry.TWO_MIRRORS:
                return rows % 2 == 1 and columns % 2 == 1
            case Symmetry.HALF_TURN:
                return (rows + columns) % 2 == 0
            case Symmetry.QUARTER_TURN:
                return rows == columns and rows % 2 == 0

    def images(self, z: FloatArray) -> tuple[FloatArray, ...]:
        """Fields (..., m, n) as each move takes them."""
        return tuple(move.image(z) for move in self.moves)

    def symmetric(self, z: FloatArray) -> FloatArray:
        """The nearest fields (..., m, n) that equal all their images."""
        total = z.copy()
        for image in self.images(z):
            total += image
        mean: FloatArray = total / (1 + len(self.moves))
        return mean

    def on(self, rows: int, columns: int) -> GridSymmetry:
        """The symmetry of one grid, rim included (cached).

        Raises
        ------
        UsageError
            The lattice of this grid does not have it.
        """
        return _on(self, rows, columns)


@dataclass(frozen=True, eq=False)
class GridSymmetry:
    """Signed permutations of one grid's numbers: z, then offsets of mouths and of edge hinges."""

    symmetry: Symmetry
    rows: int
    columns: int
    source: IntArray  #: (G, m * n + R + E); for each move, where the image's entries come from
    sign: FloatArray  #: (G, m * n + R + E); what they are multiplied with

    def symmetric(self, z: FloatArray) -> FloatArray:
        """The nearest fields (..., m, n) that equal all their images."""
        return self.symmetry.symmetric(z)

    def symmetric_offsets(self, offsets: FloatArray) -> FloatArray:
        """The nearest rim offsets (..., R), unit cells, that equal all their images."""
        cells = self.rows * self.columns
        mouths = slice(cells, cells + offsets.shape[-1])
        total = offsets.copy()
        for source, sign in zip(self.source[:, mouths] - cells, self.sign[:, mouths], strict=True):
            total += sign * offsets[..., source]
        mean: FloatArray = total / (1 + len(self.source))
        return mean

    @cached_property
    def basis(self) -> csc_matrix:
        """All symmetric states: (m * n + R + E, reduced).

        A state (z row by row, then the offsets of mouths and edge hinges) is symmetric exactly when it is
        ``basis @ y``.  Columns are orthogonal with entries 1, -1 and 0: each entry of y is the value at the first place
        of its orbit, so bounds on y are bounds on all values.
        """
        count = self.source.shape[1]
        own = np.arange(count)
        source = np.concatenate([own[None], self.source])
        sign = np.concatenate([np.ones((1, count)), self.sign])
        first = source.min(axis=0)
        # An entry that some move takes to its own negative is zero; all moves that lead to the first place agree else.
        fixed_zero = np.any((source == own) & (sign < 0), axis=0)
        value = sign[source.argmin(axis=0), own]
        kept = np.flatnonzero(~fixed_zero)
        heads, column = np.unique(first[kept], return_inverse=True)
        return csc_matrix((value[kept], (kept, column)), shape=(count, heads.size))


#: Tried in this order: the first that holds has the others among its moves.
MOST_FIRST = (
    Symmetry.TWO_MIRRORS,
    Symmetry.QUARTER_TURN,
    Symmetry.LEFT_RIGHT,
    Symmetry.TOP_BOTTOM,
    Symmetry.HALF_TURN,
)
#: Differences of z and of places on the rim (unit cells) below this are rounding.
SAME = 1e-6


@lru_cache(maxsize=4096)
def symmetry_of(sheet: Sheet) -> Symmetry | None:
    """The largest symmetry that a sheet has, with its rim and start outline; None without any."""
    return next((symmetry for symmetry in MOST_FIRST if has_symmetry(sheet, symmetry)), None)


def nearly_symmetric(sheet: Sheet, off: float) -> Symmetry | None:
    """The largest symmetry of a sheet whose ratios may be ``off`` (log10); None without."""
    return next((symmetry for symmetry in MOST_FIRST if has_symmetry(sheet, symmetry, off)), None)


def has_symmetry(sheet: Sheet, symmetry: Symmetry, off: float = SAME) -> bool:
    """Whether a sheet with its rim and start has a symmetry; ratios may be ``off`` (log10)."""
    if not symmetry.fits(*sheet.grid):
        return False
    z, points = sheet.field.log10, anchor_points(sheet) if sheet.rim.folds_shut else rim_nodes(sheet)
    points = points - 0.5 * (points.min(axis=0) + points.max(axis=0))
    return all(np.abs(image - z).max() < off for image in symmetry.images(z)) and all(
        _same_points(points @ move.matrix, points) for move in symmetry.moves
    )


def _same_points(some: FloatArray, others: FloatArray) -> bool:
    return bool(np.abs(some[:, None] - others).sum(axis=2).min(axis=1).max() < SAME)


@cache
def _on(symmetry: Symmetry, rows: int, columns: int) -> GridSymmetry:
    if not symmetry.fits(rows, columns):
        raise UsageError("symmetry.not_on_grid", symmetry=symmetry.label, rows=rows, columns=columns)
    number = np.arange(rows * columns).reshape(rows, columns)
    path, table = RimPath(rows, columns), rim_table(rows, columns)
    middle = np.array([columns + 1, -rows - 1]) / 2
    anchors = path.anchors(table.even)
    place, hinge_place = anchors[table.mouths] - middle, anchors[table.between].mean(axis=1) - middle
    along = path.slopes(table.even)
    source, sign = [], []
    for move in symmetry.moves:
        field = np.rot90(np.fliplr(number) if move.flipped else number, move.turns).ravel()
        mouth, hinge = _taken_to(place, move), _taken_to(hinge_place, move)
        source.append(np.concatenate([field, number.size + mouth, number.size + mouth.size + hinge]))
        turned = np.einsum("rd,rd->r", (along @ move.matrix)[mouth], along)
        reversed_ = np.full(hinge.size, -1.0 if move.flipped else 1.0)
        sign.append(np.concatenate([np.full(number.size, move.sign), turned, reversed_]))
    tables = GridSymmetry(symmetry, rows, columns, np.array(source), np.array(sign))
    tables.source.setflags(write=False)
    tables.sign.setflags(write=False)
    return tables


def _taken_to(place: FloatArray, move: Move) -> IntArray:
    """Which of some places (K, 2) a move takes to each of them: (K,)."""
    found: IntArray = np.abs((place @ move.matrix)[None] - place[:, None]).sum(axis=2).argmin(axis=1)
    return found
