"""Which candidates are one design, which look alike, and which are worth a fit first.

Two sheets are the same when one is the other turned: by half a turn where rows + columns is even (z stays), and on even
square grids by a quarter turn (z changes its sign), at every angle of deployment; the mouths of the rim turn with them.
*Distance* is the root mean square difference of z = log10 x over the voids, the smallest over these turns; a mouth that
is apart by a cell counts as much as a void whose z is apart by 1.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence

import numpy as np

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.pipeline.rank import USUAL, Ranking

#: Nearer than this two candidates are one design: ratios that differ by under 5 % look the same on a cut sheet.
#: 32 samples for one target are 0.2 to 0.7 apart.
DUPLICATE = 0.02

#: Nearer than this to a better candidate, a design waits until the others have had their fit: the nearest twentieth of
#: all pairs among 32 samples for a star.
ALIKE = 0.3

#: Root mean square difference of :func:`_look` below which two sheets look the same: nodes are then 0.3 cells apart.
SAME_LOOK = 0.15


def distances(design: Sheet | RatioField, others: Sequence[Sheet | RatioField]) -> FloatArray:
    """Difference between a sheet and each of several on the same grid, (len(others),); 0 for the same sheet turned.

    Infinite where the start outline or the cell is another.
    """
    sheet, rest = Sheet.of(design), [Sheet.of(other) for other in others]
    hinges = _moves_hinges((sheet, *rest))
    ways, voids = np.stack(turns(sheet, hinges)), sheet.rows * sheet.columns
    table = np.array([_state(other, hinges) for other in rest]).reshape(len(rest), 1, ways.shape[1])
    nearest = np.sqrt(np.square(table - ways).sum(axis=2) / voids).min(axis=1)
    nearest[[_kind(other) != _kind(sheet) for other in rest]] = np.inf
    return np.asarray(nearest)


def turns(design: Sheet | RatioField, hinges: bool = False) -> list[FloatArray]:
    """z, then the offsets of the mouths, of the same sheet in all its turned positions: one, two or four (m n + R,).

    Those of the edge hinges follow where they are asked for (m n + R + E,).

    A sheet with a start outline of its own has one position; with cells that are not square it has no quarter turns.
    """
    sheet = Sheet.of(design)
    state, symmetry = _state(sheet, hinges), Symmetry.QUARTER_TURN
    if sheet.cell[0] != sheet.cell[1] or not symmetry.fits(*sheet.grid):
        symmetry = Symmetry.HALF_TURN
    if sheet.start is not None or not symmetry.fits(*sheet.grid):
        return [state]
    tables = symmetry.on(*sheet.grid)
    every, signs = tables.source[:, : state.size], tables.sign[:, : state.size]
    return [state, *(sign * state[source] for source, sign in zip(every, signs, strict=True))]


def _state(sheet: Sheet, hinges: bool) -> FloatArray:
    """z row by row, then how far mouths are from their even places, unit cells, and edge hinges from halfway."""
    rim, grid = sheet.rim, sheet.grid
    parts = [sheet.field.log10.ravel(), rim.offsets(*grid)]
    return np.concatenate([*parts, rim.hinge_offsets(*grid)] if hinges else parts)


def _moves_hinges(sheets: Sequence[Sheet]) -> bool:
    """Whether any of some sheets has edge hinges that are not halfway."""
    return not all(sheet.rim.folds_shut for sheet in sheets)


def _kind(sheet: Sheet) -> Hashable:
    """What sheets that can be compared have in common."""
    return sheet.grid, sheet.cell, None if sheet.start is None else sheet.start.tobytes()


def look_alikes(candidates: Sequence[Candidate], ranking: Ranking = USUAL) -> tuple[int, ...]:
    """The group of each candidate: designs of one group look the same, also turned or mirrored.

    Best first, a candidate joins the first group whose best it looks like, else it begins the next: group 0 is that of
    the best of all, and the best of a group represents it.
    """
    groups = [0] * len(candidates)
    heads: list[int] = []
    alike = _alike([candidate.sheet for candidate in candidates])
    families = np.array([candidate.family for candidate in candidates])
    alike &= families[:, None] == families  # a whole sheet and one with notches never look the same
    for place in sorted(range(len(candidates)), key=lambda place: ranking.key(candidates[place])):
        joined = np.flatnonzero(alike[place, heads])
        if not joined.size:
            heads.append(place)
        groups[place] = int(joined[0]) if joined.size else len(heads) - 1
    return tuple(groups)


def _alike(sheets: Sequence[Sheet]) -> BoolArray:
    """Which sheets look the same, (N, N)."""
    table = np.zeros((len(sheets), len(sheets)), dtype=np.bool_)
    kinds: dict[Hashable, list[int]] = {}
    for place, sheet in enumerate(sheets):
        kinds.setdefault(_kind(sheet), []).append(place)
    for members in kinds.values():
        table[np.ix_(members, members)] = _alike_of_a_kind([sheets[place] for place in members])
    return table


def _alike_of_a_kind(sheets: Sequence[Sheet]) -> BoolArray:
    """The same for sheets of one grid and outline, in all positions that the lattice has."""
    grid = sheets[0].grid
    looks = np.array([_look(sheet) for sheet in sheets])
    size = np.square(looks).sum(axis=1)
    products = looks @ looks.T
    for symmetry in Symmetry:
        if symmetry.fits(*grid):
            tables = symmetry.on(*grid)
            for source, sign in zip(tables.source, tables.sign, strict=True):
                source, sign = source[: looks.shape[1]], sign[: looks.shape[1]]
                np.maximum(products, (sign * looks[:, source]) @ looks.T, out=products)
    alike: BoolArray = size[:, None] + size - 2.0 * products < SAME_LOOK**2 * looks.shape[1]
    return alike


def _look(sheet: Sheet) -> FloatArray:
    """Where nodes rest in their slits, from -1 at one end to 1, and mouths on the rim, in cells: (m n + R,)."""
    return np.concatenate([np.tanh(0.5 * np.log(sheet.field.ratio.ravel())), sheet.rim.offsets(*sheet.grid)])


def worth_a_fit(candidates: Sequence[Candidate], ranking: Ranking = USUAL) -> tuple[Candidate, ...]:
    """The order in which candidates are fitted, duplicates left out.

    Best first, but a candidate that is alike a better one waits until all others have had their turn: when the time is
    short, different designs are fitted.  Of candidates that are one design only the best is fitted.
    """
    first: list[Candidate] = []
    later: list[Candidate] = []
    for candidate in ranking.ranked(candidates):
        chosen = [other.sheet for other in (*first, *later)]
        nearest = distances(candidate.sheet, chosen).min() if chosen else np.inf
        if nearest >= DUPLICATE:
            (first if nearest >= ALIKE else later).append(candidate)
    return (*first, *later)


def distinct(candidates: Sequence[Candidate], others: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Those candidates that are a design of their own: neither one of ``others`` nor of an earlier one.

    All on one grid.  Distances come from one matrix product, because a thousand against a thousand is usual; they
    agree with :func:`distances` far below :data:`DUPLICATE`.
    """
    if not candidates:
        return ()
    everything = [one.sheet for one in (*others, *candidates)]
    hinges, kinds = _moves_hinges(everything), [_kind(sheet) for sheet in everything]
    known = np.array([_state(sheet, hinges) for sheet in everything])
    size = np.square(known).sum(axis=1)
    own = size[len(others) :]
    nearest = np.full((len(candidates), len(known)), np.inf)
    ways = [turns(one.sheet, hinges) for one in candidates]
    for number in range(max(len(way) for way in ways)):
        turned = np.array([way[number % len(way)] for way in ways])
        np.minimum(nearest, own[:, None] + size - 2.0 * (turned @ known.T), out=nearest)
    rows, columns = candidates[0].sheet.grid
    alike = nearest < DUPLICATE**2 * rows * columns
    if len(set(kinds)) > 1:
        alike &= np.array([[one == other for other in kinds] for one in kinds[len(others) :]])
    kept: list[int] = []
    for number, row in enumerate(alike):
        earlier = [len(others) + place for place in kept]
        if not row[: len(others)].any() and not row[earlier].any():
            kept.append(number)
    return tuple(candidates[number] for number in kept)
