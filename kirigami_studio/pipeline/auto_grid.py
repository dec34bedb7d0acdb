"""The grid for a target: as coarse as the shape allows, with the parities that its symmetry needs.

How well a grid will match is predicted from the shape alone, with a formula that was fitted to fits, see
:func:`predicted_match`.  Long outlines, deep hollows and many bends need many panels, and a sheet of the shape's own
proportions does with fewer.  Of all grids with the right parities the one with the fewest voids is taken that is
expected to match well enough, or, where none is, the one that is expected to match best.  A hard shape with a mirror
axis depends much on the proportions of its sheet: there, short fits on a few grids decide, and on some finer ones where
none of these will do.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeVar

import numpy as np
import shapely

from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.sentences import sentence
from kirigami_studio.lattice.laying import start_error
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.proportions import Proportions
from kirigami_studio.outlines.reach import share_of_arms
from kirigami_studio.outlines.starts import RECTANGLE, StartShape
from kirigami_studio.outlines.symmetry import TOLERANCE
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.tasks import TrialTask
from kirigami_studio.polish.continuation import first_angles, sparingly
from kirigami_studio.polish.flat_sheet import uniform_sheet, width_in_cells
from kirigami_studio.polish.objective import FitPhase
from kirigami_studio.polish.symmetry import KeptSymmetry, SymmetricPose, shared_symmetries, symmetric_poses

#: Fewest rows and columns, and most unless another limit is asked for.
COARSEST, FINEST = 6, 16
#: The same of pinned sheets, whose pieces somebody has to put together.
COARSEST_PINNED, FINEST_PINNED = 3, 10
#: Most rows of upright ones, and most panels; and of those for shapes that pieces of a usual grid show badly.
HIGHEST, MOST_PIECES, MOST_SMALL_PIECES = 14, 91, 121
#: Distances between pins (unit cells) that sheets have room for, and those with small pieces: on 10 x 10 a clover of
#: 240 mm in plywood has room for 0.413.
MOST_GAP, SMALL_GAP = 0.375, 0.42
#: Fewest voids; coarser grids match simple shapes, but hardly show how a sheet opens.
FEWEST_VOIDS, FEWEST_PINNED = 99, 49
#: The coarsest grid with at least this predicted match is taken.
GOAL = 0.992
#: Where no grid reaches it, the coarsest one is taken that misses no more than the best one divided by this.  Without a
#: symmetry fits take twice as long: a flag and a house match 0.986 and 0.977 on 14 x 14, 0.980 and 0.980 on 16 x 16.
WORTHWHILE, WORTHWHILE_FREE = 0.96, 0.88
#: Where a shape with a mirror axis is expected to stay below the last number, grids are tried that miss no more than
#: the best one times the first, of proportions (logarithm of height over width) that differ by at least the second and
#: lie within the third of the square's and the shape's own.  Nine short steps rank the grids of a star, a butterfly, a
#: vase, a cross and a leaf as the whole fits do.
TRIED_MISSING, TRIED_APART, TRIED_ROOM, MOST_TRIED, TRIED_BELOW = 1.6, 0.09, 0.25, 4, 0.989
#: Where the best of them is worth less than this, short fits were lost and tell nothing about grids: those of a bone.
TELLING = 0.8
#: Where the best of them is worth (exact IoU less the price of uneven panels) something between the first two, some
#: finer grids are tried: longer ones of at most so many rows, columns and panels.  The best of these is taken where it
#: is worth more by this.  A butterfly gains 0.010 of IoU by it, a crescent 0.009; a cross and an airplane, which are
#: worth less, gain nothing.  Sheets of other starts do without, for the sake of time.
FINER_BETWEEN, FINER_GAIN = (0.95, 0.975), 0.005
FINER_LIMIT, FINER_PANELS = 24, 312
#: Poses of each grid that are tried, and the steps of each fit.
TRIED_POSES = 2
#: The same of pinned sheets that may be upright, and how many of their grids are tried.
UPRIGHT_POSES, UPRIGHT_TRIED = 6, 3
#: Where short fits of a long target (logarithm of its length over its width) to a pinned sheet of another start are
#: lost on the predicted grid, worth less than the second, grids of as many pieces are tried whose cells are longer, by
#: up to the third.  From a disk those of a bone are worth 0.42 on 7 x 7 and 0.83 on 5 x 9 voids, those of eleven other
#: long shapes 0.77 or more on the predicted grid.
LONG_TARGET, LOST, LONGER_CELLS, AS_MANY = 0.4, 0.6, 0.65, 0.75
#: Where less than the first is expected of such a sheet, short fits decide between as many of its grids, those that are
#: expected to match best; another one than the predicted is taken where it is worth more by the last.
HARD, ALIKE_TRIED, ALIKE_GAIN = 0.96, 3, 0.015
#: Phases of such a fit.
TRIAL = (FitPhase(3, 0.1, 3e-2), FitPhase(3, 0.04, 3e-3), FitPhase(3, 0.01, 1e-3))
#: Panels of a fitted sheet have hardly any edge or neck below this share of a cell.
SMALLEST_SHARE = 0.25
#: Proportions of sheets (logarithm of height over width) lie between the square and the shape's own, give or take this.
PROPORTION_ROOM = 0.12
#: The same between the grid of another start than a rectangle of square cells and that start.
START_ROOM = 0.2
#: Most of a start's area that its flat sheet may cover beside it or leave out; moved mouths take a little more.
MOST_START_ERROR = 0.0042
#: The same of pinned sheets, whose grids are coarse and whose rim pieces are cut to the start where they have room.
MOST_START_ERROR_PINNED = 0.025
#: What a start that is symmetric is symmetric on: a corner on an axis needs a mouth in the middle of a side.
SYMMETRIC_GRIDS = ((11, 11), (12, 12), (9, 9), (13, 11), (9, 11))
#: Details below this (unit-area lengths) do not count as bends.
COARSENESS = 0.01
#: A hole is as wide as so many panels at least, and a wall beside it as this: where they are two panels wide, 98 % of
#: a round hole opens, at 1.5 and 1.2 panels three quarters, as the hinges within stay.  Where no grid is as fine, one
#: that has this share of the panels of the finest will do.
HOLE_PANELS, WALL_PANELS, FINEST_SHARE = 1.7, 1.6, 0.9
#: Parts narrower than twice this (unit-area lengths) are limbs.
LIMB = 0.2
#: Numbers of panels for which it is measured what is narrower than two of them; in between that is interpolated.
MEASURED_PANELS = (48.0, 80.0, 130.0, 200.0, 300.0, 600.0)

#: Logarithm of the share that a fit misses: a constant for the usual number of panels, and factors of the figures.
CONSTANT, PANELS, LENGTH, BENDS, LIMBS, ARMS, PROPORTIONS = -5.2, -0.54, 1.16, 0.81, 1.81, 1.93, 0.9
USUAL_PANELS = 140.0
#: Sheets of this power of the shape's proportions match best.
BEST_PROPORTIONS = 0.66

#: Choices that are remembered by what they depend on, oldest first, and how many of them.
Choice = TypeVar("Choice")
_CHOSEN: dict[Hashable, GridChoice] = {}
REMEMBERED = 64

#: Codes of the reason where the coarsest grid that matches is taken, by the symmetry that its parities are for.
COARSEST_CODES: dict[Symmetry | None, str] = {
    None: "grid.coarsest_expected",
    Symmetry.LEFT_RIGHT: "grid.coarsest_with_mirror_axis",
    Symmetry.TOP_BOTTOM: "grid.coarsest_with_mirror_axis",
    Symmetry.TWO_MIRRORS: "grid.coarsest_with_two_mirror_axes",
    Symmetry.HALF_TURN: "grid.coarsest_with_turn",
    Symmetry.QUARTER_TURN: "grid.coarsest_with_turn",
}


@dataclass(frozen=True, slots=True)
class GridChoice:
    """A grid and why it was taken."""

    grid: tuple[int, int]  #: (rows, columns) voids
    #: Symmetric set-ups that are worth trying on it, the most promising first; empty for a shape without symmetry.
    poses: tuple[SymmetricPose, ...]
    predicted_match: float  #: expected exact IoU of the best design without a search
    code: str
    #: tuple of (str, object); the reason, as a sentence's code and what it names.
    fields: tuple[tuple[str, object], ...]

    @property
    def reason(self) -> str:
        """One sentence for the user."""
        return sentence(self.code, dict(self.fields))


@dataclass(frozen=True, slots=True)
class ShapeFigures:
    """What makes a target hard."""

    length: float  #: logarithm of its perimeter over that of a square of the same area
    bends: float  #: logarithm of 1 plus its turns to the right, in half turns: 0 for a convex shape
    limbs: float  #: square root of the share of its area in limbs
    arms: tuple[float, ...]  #: the same for parts narrower than two panels, for each of ``MEASURED_PANELS``

    @classmethod
    def of(cls, target: Outline) -> ShapeFigures:
        """Measure a target."""
        points = shapely.get_coordinates(shapely.Polygon(target.points).simplify(COARSENESS))[:-1]
        after = np.roll(points, -1, axis=0) - points
        before = np.roll(after, 1, axis=0)
        turns = np.arctan2(
            before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], np.einsum("ij,ij->i", before, after)
        )
        return cls(
            math.log(float(np.hypot(*after.T).sum()) / 4.0),
            math.log1p(-float(turns[turns < 0.0].sum()) / math.pi),
            math.sqrt(share_of_arms(target, LIMB)),
            tuple(math.sqrt(share_of_arms(target, 1.0 / math.sqrt(panels))) for panels in MEASURED_PANELS),
        )


def predicted_match(
    figures: ShapeFigures, grid: tuple[int, int], proportion: float, start: StartShape = RECTANGLE
) -> float:
    """Expected exact IoU of the best design on a grid without a search.

    The logarithm of what is missed is linear in a few figures.  Fitted to fits from the uniform sheet, led by the
    transport map and not: 76 shapes (the library and 36 drawn ones) on 177 grids.  On these the median error is 0.004,
    on 23 other shapes (52 grids) 0.003; what is predicted at 0.95 or less may be off by several hundredths.

    Parameters
    ----------
    figures : ShapeFigures
    grid : (rows, columns) voids
    proportion : float
        Logarithm of the shape's height over its width, as it will lie on the sheet.
    start : StartShape
    """
    rows, columns = grid
    panels = (rows + 1) * (columns + 1)
    missing = (
        CONSTANT
        + PANELS * math.log(panels / USUAL_PANELS)
        + LENGTH * figures.length**2
        + BENDS * figures.bends
        + LIMBS * figures.limbs
        + ARMS * float(np.interp(panels, MEASURED_PANELS, figures.arms))
        + PROPORTIONS * (start.proportion(rows, columns) - BEST_PROPORTIONS * proportion) ** 2
    )
    return 1.0 - min(math.exp(missing), 0.5)


@lru_cache(maxsize=64)
def choose_grid(
    target: Outline,
    symmetry: KeptSymmetry = KeptSymmetry.AUTO,
    width_mm: float = 100.0,
    least_feature_mm: float = 0.0,
    limit: int = FINEST,
    start: StartShape = RECTANGLE,
    least_gap_mm: float = 0.0,
    upright: bool = False,
) -> GridChoice:
    """The coarsest grid that is expected to match a target, or the one that is expected to match it best.

    Parameters
    ----------
    target : Outline
    symmetry : KeptSymmetry
        As for :func:`kirigami_studio.polish.symmetry.symmetric_poses`.
    width_mm : float
        Width of the flat sheet.
    least_feature_mm : float
        Least panel edge and neck that the material allows; 0 where that is not known.
    limit : int
        Most rows and columns.
    start : StartShape
        What the sheets look like while they are flat: its symmetry has to be kept too, its corners need mouths, and a
        round one needs enough chords.
    least_gap_mm : float
        How far apart pins stay, which has to fit into the cells; 0 for sheets without.
    upright : bool
        Whether pinned sheets for long shapes may be high: their width limits the number of cells.

    Raises
    ------
    TargetError
        A symmetry is asked for and the target is far from any.
    UsageError
        The start, or a pinned sheet, cannot have the symmetry that is asked for.
    """
    pinned, holes_need = least_gap_mm > 0.0, panels_for_holes(target)
    target = target.filled
    poses = _poses(target, symmetry, start, pinned=pinned)
    figures = ShapeFigures.of(target)
    smallest = SMALLEST_SHARE * width_mm / least_feature_mm if least_feature_mm > 0.0 else math.inf
    coarsest = COARSEST
    if pinned:
        smallest = min(smallest, MOST_GAP * width_mm / least_gap_mm)
        coarsest, limit = COARSEST_PINNED, min(limit, HIGHEST if upright else FINEST_PINNED)
    # Few grids of sheets in two layers fit another start.
    odd = upright and not start.is_plain
    found = list(_candidates(target, figures, poses, limit, start, coarsest=coarsest, upright=upright, odd=odd))
    found = found or _nearest(target, figures, poses, limit, start)
    if upright:
        found = [one for one in found if one.panels <= MOST_PIECES] or [min(found, key=lambda one: one.panels)]
    most_error = MOST_START_ERROR_PINNED if pinned else MOST_START_ERROR
    found = [one for one in found if one.start_error <= most_error] or [min(found, key=lambda one: one.start_error)]
    cuttable = [one for one in found if one.width <= smallest] or [min(found, key=lambda one: one.width)]
    fewest = FEWEST_PINNED if pinned else FEWEST_VOIDS
    enough = [one for one in cuttable if one.grid[0] * one.grid[1] >= fewest] or cuttable
    without_holes, enough = _coarsest(enough), _fine_enough(enough, holes_need)
    best = _coarsest(enough)
    finer = [one for one in found if one.panels > best.panels and one.match > best.match]
    held_back = best.match < GOAL and len(cuttable) < len(found) and bool(finer)
    # Of a sketch, a symmetric sheet shows the shape halfway to its image.
    overlap = 1.0 if best.pose is None or best.pose.overlap >= TOLERANCE else best.pose.overlap
    match = best.match - 0.5 * (1.0 - overlap)
    rows, columns = best.grid
    fields: dict[str, object] = {"rows": rows, "columns": columns, "percent": 100.0 * match}
    if held_back:
        code = "grid.pins_would_be_too_near" if pinned else "grid.panels_would_be_too_small"
        fields |= {"width_mm": width_mm, "least_mm": least_gap_mm if pinned else least_feature_mm}
    elif best.match < GOAL:
        code = "grid.best_expected"
    else:
        code = COARSEST_CODES[best.pose.symmetry if best.pose else None]
    if best is not without_holes and not held_back:
        code = "grid.finer_for_holes"
    kept = shared_symmetries(target, best.grid, symmetry, start, pinned=pinned)
    kept.sort(key=lambda pose: pose != best.pose)
    return GridChoice(best.grid, tuple(kept), match, code, tuple(fields.items()))


def predicted_for(request: Request) -> GridChoice:
    """What :func:`choose_grid` says for a request, at once."""
    return choose_grid(
        request.target,
        request.symmetry,
        request.width_mm,
        request.least_feature_mm,
        FINEST,
        request.start,
        request.least_gap_mm,
        request.two_layers,
    )


#: Whoever carries out the short fits that decide between grids: the worth of each, in their order.
Trials = Callable[[Request, Sequence[TrialTask]], list[float]]


def one_by_one(request: Request, tasks: Sequence[TrialTask]) -> list[float]:
    """Carry out trials in this process."""
    return [task.carry_out(request, lambda: False).worth for task in tasks]


def chosen_for(request: Request, trials: Trials = one_by_one) -> GridChoice:
    """The grid that a run takes, whether or not the request has it: the predicted one, or the best that was tried.

    Trying takes about a second in one process, and is done for hard shapes with a mirror axis alone.  What was chosen
    is remembered.
    """
    return remembered(_CHOSEN, _key(request), lambda: _tried(request, trials))


def remembered(known: dict[Hashable, Choice], key: Hashable, choose: Callable[[], Choice]) -> Choice:
    """A choice that was made before, or made now; the oldest of :data:`REMEMBERED` goes."""
    choice = known.get(key)
    if choice is None:
        choice = choose()
        while len(known) >= REMEMBERED:
            known.pop(next(iter(known)), None)
        known[key] = choice
    return choice


def known_for(request: Request) -> GridChoice:
    """The grid that a run takes, as far as that is known at once: the one that was tried before, else the predicted."""
    return _CHOSEN.get(_key(request)) or predicted_for(request)


def _key(request: Request) -> Hashable:
    """What a choice depends on."""
    sheet = (request.width_mm, request.least_feature_mm, request.least_gap_mm, request.fit_options.free_rim)
    return request.target, request.phi, request.symmetry, request.start, request.two_layers, *sheet


def _tried(request: Request, trials: Trials) -> GridChoice:
    target, start, symmetry = request.silhouette, request.start, request.symmetry
    choice = predicted_for(request)
    if request.two_layers:
        return _tried_upright(request, choice, trials)
    hard = choice.code in ("grid.best_expected", "grid.finer_for_holes") and choice.predicted_match < TRIED_BELOW
    if not hard or request.pinned or not choice.poses or choice.poses[0].angle is None:
        return choice
    poses = _poses(target, symmetry, start)
    figures, least_feature = ShapeFigures.of(target), request.least_feature_mm
    smallest = SMALLEST_SHARE * request.width_mm / least_feature if least_feature > 0.0 else math.inf
    most_missing = TRIED_MISSING * (1.0 - choice.predicted_match)
    near = [
        one
        for one in _candidates(target, figures, poses, FINER_LIMIT, start, TRIED_ROOM)
        if 1.0 - one.match <= most_missing and one.width <= smallest
    ]
    near = _fine_enough(near, panels_for_holes(request.target))
    picked = _apart([one for one in near if max(one.grid) <= FINEST])
    if len(picked) < 2:
        return choice
    worth = _worth(request, picked, trials)
    best, code = max(worth, key=worth.__getitem__), "grid.best_tried"
    if worth[best] < TELLING:
        return choice
    least, most = FINER_BETWEEN
    if start.is_plain and least <= worth[best] < most:
        finer = _worth(request, _finer(near, best), trials)
        worth |= finer
        finest = max(finer, key=finer.__getitem__, default=best)
        if worth[finest] >= worth[best] + FINER_GAIN:
            best, code = finest, "grid.finer_tried"
    rows, columns = best.grid
    kept = shared_symmetries(target, best.grid, symmetry, start)
    fields = {"rows": rows, "columns": columns, "count": len(worth), "percent": 100.0 * best.match}
    return GridChoice(best.grid, tuple(kept), best.match, code, tuple(fields.items()))


def on_smaller_pieces(request: Request) -> GridChoice | None:
    """Choose the grid of smaller pieces that is expected to match best.

    For a target that pieces on the request's grid show badly.  Of another start than a rectangle it is the grid of its
    proportions.  None where the pins leave no room for smaller pieces; they may come nearer than on grids that are
    chosen at once.
    """
    rows, columns = request.chosen_grid
    finer = [
        one
        for one in _upright(request, MOST_SMALL_PIECES, SMALL_GAP, START_ROOM)
        if one.panels > (rows + 1) * (columns + 1) and one.start_error <= MOST_START_ERROR_PINNED
    ]
    start = request.start

    def wanted(one: _Candidate) -> tuple[float, float]:
        return 0.0 if start.is_plain else -abs(one.proportion - start.proportion(1, 1)), one.match

    best = max(finer, key=wanted, default=None)
    if best is None:
        return None
    poses = shared_symmetries(request.silhouette, best.grid, request.symmetry, start, pinned=True)
    fields = {"rows": best.grid[0], "columns": best.grid[1]}
    return GridChoice(best.grid, tuple(poses), best.match, "grid.smaller_pieces", tuple(fields.items()))


def remember(request: Request, choice: GridChoice) -> None:
    """Keep a choice for requests that depend on the same: it turned out to be the better one."""
    _CHOSEN.pop(_key(request), None)
    remembered(_CHOSEN, _key(request), lambda: choice)


def _upright(request: Request, most: int, gap: float = MOST_GAP, start_room: float = LONGER_CELLS) -> list[_Candidate]:
    """Grids of pinned sheets, square or upright, of at most so many pieces.

    Pins need no more than ``gap`` cells between them.
    """
    target, start, least = request.silhouette, request.start, request.least_feature_mm
    widest = gap * request.width_mm / request.least_gap_mm
    widest = min(widest, SMALLEST_SHARE * request.width_mm / least) if least > 0.0 else widest
    found = _candidates(
        target,
        ShapeFigures.of(target),
        _poses(target, request.symmetry, start, pinned=True),
        HIGHEST,
        start,
        start_room=start_room,
        coarsest=COARSEST_PINNED,
        upright=True,
        odd=not start.is_plain,
    )
    return [one for one in found if one.width <= widest and one.panels <= most]


def _tried_upright(request: Request, choice: GridChoice, trials: Trials) -> GridChoice:
    """The grid of a pinned sheet: of as many pieces, square or upright, whichever short fits match better.

    Pins are left out of account: of seven silhouettes the best short fits have the grid of the best pinned ones.
    """
    target, start = request.silhouette, request.start
    if choice.predicted_match >= TRIED_BELOW:
        return choice
    near = _upright(request, MOST_PIECES)
    if start.is_plain:
        picked = _apart([one for one in near if one.grid[0] * one.grid[1] >= FEWEST_PINNED])[:UPRIGHT_TRIED]
        worth = _worth(request, picked, trials) if len(picked) > 1 else {}
    else:
        near = [one for one in near if one.start_error <= MOST_START_ERROR_PINNED]
        worth = _worth_of_long_cells(request, choice, near, trials) or _worth_of_alike(request, choice, near, trials)
    best = max(worth, key=worth.__getitem__, default=None)
    if best is None or worth[best] < (TELLING if start.is_plain else LOST):
        return choice
    rows, columns = best.grid
    kept = shared_symmetries(target, best.grid, request.symmetry, start, pinned=True)
    fields = {"rows": rows, "columns": columns, "count": len(worth), "percent": 100.0 * best.match}
    return GridChoice(best.grid, tuple(kept), best.match, "grid.best_tried", tuple(fields.items()))


def _worth_of_long_cells(
    request: Request, choice: GridChoice, near: list[_Candidate], trials: Trials
) -> dict[_Candidate, float]:
    """Worth of grids of long cells where fits of a long target are lost on the predicted one."""
    proportions = Proportions.of(request.silhouette)
    own = next((one for one in near if one.grid == choice.grid), None)
    if own is None or proportions.along(proportions.direction) < LONG_TARGET:
        return {}
    worth = _worth(request, [own], trials)
    if worth[own] >= LOST:
        return {}
    longer = [
        one for one in near if one.proportion < own.proportion and AS_MANY * own.panels <= one.panels <= own.panels
    ]
    return worth | _worth(request, longer, trials)


def _worth_of_alike(
    request: Request, choice: GridChoice, near: list[_Candidate], trials: Trials
) -> dict[_Candidate, float]:
    """Worth of grids with the start's proportions where little is expected of the predicted one."""
    square = request.start.proportion(1, 1)
    alike = [one for one in near if abs(one.proportion - square) <= START_ROOM]
    picked = sorted(alike, key=lambda one: -one.match)[:ALIKE_TRIED]
    own = next((one for one in picked if one.grid == choice.grid), None)
    if choice.predicted_match >= HARD or own is None or len(picked) < 2:
        return {}
    return {one: worth - (one is not own) * ALIKE_GAIN for one, worth in _worth(request, picked, trials).items()}


def _apart(candidates: Sequence[_Candidate]) -> list[_Candidate]:
    """Grids whose proportions differ, at most :data:`MOST_TRIED`; those that are expected to match best."""
    picked: list[_Candidate] = []
    for one in sorted(candidates, key=lambda one: -one.match):
        apart = all(abs(one.proportion - other.proportion) > TRIED_APART for other in picked)
        if len(picked) < MOST_TRIED and apart:
            picked.append(one)
    return picked


def _worth(request: Request, grids: Sequence[_Candidate], trials: Trials) -> dict[_Candidate, float]:
    """What short fits on each grid reach, symmetric ones first: the best exact IoU, less the price of uneven panels."""
    target, setting, pinned = request.silhouette, request.symmetry, request.pinned
    poses = UPRIGHT_POSES if pinned else TRIED_POSES
    # Corrected, those of pinned sheets no longer tell that a cross suits a square one and an arrow an upright one.
    phases = sparingly(*TRIAL) if pinned else TRIAL
    tasks, owners = [], []
    for one in grids:
        for angle, kept in first_angles(target, one.grid, 1, setting, request.start, pinned=pinned)[:poses]:
            tasks.append(TrialTask(one.grid, angle, kept, phases))
            owners.append(one)
    worth: dict[_Candidate, float] = {}
    for owner, reached in zip(owners, trials(request, tasks), strict=True):
        worth[owner] = max(reached, worth.get(owner, reached))
    return worth


def _finer(candidates: list[_Candidate], best: _Candidate) -> list[_Candidate]:
    """Finer grids that are at least as long as the best of the others: of each kind of ends of the axis, the one that
    is expected to match best.
    """
    long = math.copysign(1.0, best.proportion)
    longer = [
        one
        for one in candidates
        if best.panels < one.panels <= FINER_PANELS
        and max(one.grid) > FINEST
        and long * one.proportion >= abs(best.proportion)
    ]
    kinds: dict[tuple[int, int], _Candidate] = {}
    for one in sorted(longer, key=lambda one: -one.match):
        kinds.setdefault(_ends_of_axis(one), one)
    return list(kinds.values())


def _ends_of_axis(candidate: _Candidate) -> tuple[int, int]:
    """What lies on a mirror axis where it leaves the sheet: a mouth at both ends, at one, or at none.

    The closed outline has a side across the axis there where it has a mouth, and a corner where it has none.  That
    depends on the number of voids along the axis, even or odd, and on the middle one of those across it.
    """
    rows, columns = candidate.grid
    if candidate.pose is not None and candidate.pose.symmetry is Symmetry.TOP_BOTTOM:
        rows, columns = columns, rows
    return (0, 0) if rows % 2 == 0 else (1, columns % 4)


@dataclass(frozen=True, slots=True)
class _Candidate:
    grid: tuple[int, int]
    pose: SymmetricPose | None
    match: float
    width: float
    start_error: float

    @property
    def proportion(self) -> float:
        return math.log((self.grid[0] + 1) / (self.grid[1] + 1))

    @property
    def panels(self) -> int:
        return (self.grid[0] + 1) * (self.grid[1] + 1)


@lru_cache(maxsize=64)
def panels_for_holes(target: Outline) -> float:
    """Number of panels that holes and the walls beside them need."""
    if not target.holes:
        return 0.0
    widths = [2.0 * float(shapely.maximum_inscribed_circle(shapely.Polygon(hole)).length) for hole in target.holes]
    rings = np.array([shapely.LinearRing(ring) for ring in target.rings], dtype=object)
    walls = [float(shapely.distance(ring, np.delete(rings, place)).min()) for place, ring in enumerate(rings)]
    return max((HOLE_PANELS / min(widths)) ** 2, (WALL_PANELS / max(min(walls), 1e-6)) ** 2)


def _fine_enough(candidates: list[_Candidate], panels: float) -> list[_Candidate]:
    """Those with so many panels; where there are none, those with nearly as many as the finest."""
    most = max((one.panels for one in candidates), default=0)
    return [one for one in candidates if one.panels >= min(panels, FINEST_SHARE * most)]


def _coarsest(candidates: list[_Candidate]) -> _Candidate:
    """The fewest panels that reach the goal; where none do, the fewest that match nearly as well as the best."""
    good = [one for one in candidates if one.match >= GOAL]
    if not good:
        least_missing = min(1.0 - one.match for one in candidates)
        share = WORTHWHILE_FREE if candidates[0].pose is None else WORTHWHILE
        good = [one for one in candidates if (1.0 - one.match) * share <= least_missing]
    return min(good, key=lambda one: (one.panels, -one.match))


def _candidates(
    target: Outline,
    figures: ShapeFigures,
    poses: tuple[SymmetricPose, ...],
    limit: int,
    start: StartShape,
    room: float = PROPORTION_ROOM,
    start_room: float = START_ROOM,
    coarsest: int = COARSEST,
    upright: bool = False,
    odd: bool = False,
) -> Iterator[_Candidate]:
    """Grids with the parities of the most specific symmetries.

    Without a symmetry they have even numbers of voids both ways, or ``odd`` ones, too.
    Rectangles of square cells have proportions between the square and the shape's; others those of the start.  Sheets
    for shapes without an axis are wide rather than high, or ``upright``: those whose width limits the number of cells.
    """
    coarsest = min(coarsest, limit - 1)
    sizes = range(coarsest, limit + 1)
    # A sheet on its side is the same for the eye: a single axis is laid upright.
    settings: list[SymmetricPose | None] = [pose for pose in poses if pose.symmetry is poses[0].symmetry]
    proportions = Proportions.of(target)
    for pose in settings or [None]:
        free = proportions.direction + (0.0 if upright else 0.5 * math.pi)
        along = free if pose is None or pose.angle is None else pose.angle
        proportion = proportions.along(along)
        low, high = min(0.0, proportion) - room, max(0.0, proportion) + room
        if not start.is_plain:
            low, high = start.proportion(1, 1) - start_room, start.proportion(1, 1) + start_room
        for rows in sizes:
            for columns in sizes:
                grid = rows, columns
                if pose is None and (rows % 2 or columns % 2) and not odd:
                    continue
                if not low <= math.log((rows + 1) / (columns + 1)) <= high:
                    continue
                if pose is None or pose.fits(grid, start):
                    match = predicted_match(figures, grid, proportion, start)
                    error = start_error(uniform_sheet(grid, start))
                    yield _Candidate(grid, pose, match, width_in_cells(grid, start), error)


def _nearest(
    target: Outline, figures: ShapeFigures, poses: tuple[SymmetricPose, ...], limit: int, start: StartShape
) -> list[_Candidate]:
    """Grids for a start that is longer than any: those whose proportions come nearest to it."""
    found = list(_candidates(target, figures, poses, limit, start, start_room=math.inf))
    off = [abs(one.proportion - start.proportion(1, 1)) for one in found]
    return [one for one, far in zip(found, off, strict=True) if far <= min(off) + PROPORTION_ROOM]


def _poses(
    target: Outline, symmetry: KeptSymmetry, start: StartShape, *, pinned: bool = False
) -> tuple[SymmetricPose, ...]:
    """The symmetric set-ups of a target that sheets of a start can have on some grid."""
    poses = symmetric_poses(target, symmetry, pinned=pinned)
    if start.is_plain:
        return poses
    kept = tuple(pose for pose in poses if any(pose.fits(grid, start) for grid in SYMMETRIC_GRIDS))
    if poses and not kept and symmetry in (KeptSymmetry.MIRROR, KeptSymmetry.TURN):
        rows, columns = SYMMETRIC_GRIDS[0]
        raise UsageError("symmetry.not_of_start", name=start.name, rows=rows, columns=columns, symmetry=symmetry)
    return kept
