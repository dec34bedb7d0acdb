"""The best match from no guess at all: several poses and several ways to the target, coarse grids before fine ones.

A plain fit follows nearest boundary points and gets stuck where the target turns away from the sheet: thin arms, deep
hollows, unlucky rotations.  The search fits from several rotations of the target, each by several ways: with stiff,
even panels that soften; led by the transport map of the inside; and by thickened shapes.  A target that turns back far
is grown out of rounder shapes.  The best go on, and on larger grids they are first found on a coarse one and carried
over.  Where target and lattice share a symmetry, fits that keep it join in, and win when they match as well.

Every choice is fixed: the same request gives the same fits.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import lru_cache
from itertools import product

import numpy as np
import shapely

from kirigami_studio.evaluate.alignment import align
from kirigami_studio.evaluate.evenness import evenness
from kirigami_studio.evaluate.feasibility import path_contact
from kirigami_studio.evaluate.pins import GAP_ROUNDING, hand_of, least_pin_distance
from kirigami_studio.evaluate.second_target import SecondTarget
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.siou import exact_iou
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField, check_grid
from kirigami_studio.lattice.sheet import RIM_REACH, Rim, Sheet, resized_sheet
from kirigami_studio.lattice.symmetry import Symmetry, symmetry_of
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.proportions import Proportions
from kirigami_studio.outlines.rounding import rounded
from kirigami_studio.outlines.starts import RECTANGLE, StartShape
from kirigami_studio.outlines.turning import turn_back
from kirigami_studio.polish.flat_sheet import can_have, first_sheet, uniform_sheet
from kirigami_studio.polish.junctions import junction_weight
from kirigami_studio.polish.levenberg import Fit, check_fit, polish
from kirigami_studio.polish.objective import SPARINGLY, FitPhase
from kirigami_studio.polish.panel_size import check_least
from kirigami_studio.polish.pinwheel import HANDS, check_gap, pinwheel
from kirigami_studio.polish.preferences import Preference
from kirigami_studio.polish.symmetry import KeptSymmetry, SymmetricPose, shared_symmetries
from kirigami_studio.polish.transport_map import TransportMap

#: Largest grid that is searched directly; finer ones start from a search on about this many voids each way.
COARSE = 10

#: Margins (unit-area lengths) by which the target is thickened on the way to it.
MARGINS = (0.2, 0.14, 0.09, 0.05, 0.02)
#: The same after a coarse fit was carried over: slightly thickened, arms get the room that the finer grid allows.
LIFTED_MARGINS = (0.09, 0.05, 0.02)

#: Rounder shapes on the way to a target that turns back far, and the weights of even panels on all but the last few,
#: and on these.  At 16 x 16 a plug ends at 0.890 from each of four rotations; from the uniform sheet alone, led by the
#: transport map or not, at 0.849 from the best of them.
ROUNDER, GROWN_EVEN, LAST_GROWN, LAST_GROWN_EVEN = 12, 1e-2, 3, 1e-3

#: A target turns back far from this angle on: closed layouts manage less than 180 degrees.  A club and a spade (160)
#: end at 0.96 from either way up when they are grown, at 0.92 to 0.97 else.
TURNS_BACK = math.radians(140.0)

#: Steps on each easier shape, of a first look at the target, and of the last fit.
EASY_STEPS, LOOK_STEPS, LAST_STEPS = 4, 8, 20

#: Steps of the fit without a search that every search is compared with.
PLAIN_STEPS = 40

#: Trusted distances (unit-area lengths): far parts must pull in the search, area counts in the end.
FAR, NEAR, FINE = 0.03, 0.01, 0.005

#: Rotations tried per effort when quarter turns, half turns, or no turns carry reachable shapes to reachable shapes.
QUARTER, HALF, WHOLE = 4, 6, 8

#: A target is long when the logarithm of its length over its width is above the first, a sheet above the second.
LONG, SHORT = 0.15, 1e-6

#: Fits that are carried to the end, per effort.
KEPT = 3
LARGEST_EFFORT = 8

#: A symmetric fit is preferred to another that matches no more than this much better.
FAIR_LOSS = 0.002

#: Vertices of a thickened shape may move by this (unit-area lengths): round corners need no more.
ACCURACY = 0.002


def sparingly(*phases: FitPhase) -> tuple[FitPhase, ...]:
    """Phases whose steps are corrected only where they gain much."""
    return tuple(replace(phase, corrected=SPARINGLY) for phase in phases)


def cooled(even: float) -> tuple[FitPhase, ...]:
    """Stages that begin with stiff, even panels and far parts that pull, and end with the weight ``even``.

    Found on 12 drawn shapes at 10 x 10: the mean CV of panel areas falls from 0.70 to 0.49 at the same exact IoU.
    """
    return sparingly(
        FitPhase(8, 0.1, max(3e-2, even)),
        FitPhase(8, 0.05, max(1e-2, even)),
        FitPhase(8, 0.02, max(1e-3, even)),
        FitPhase(16, FINE, even, junctions=junction_weight(even)),
    )


def guided(even: float) -> tuple[FitPhase, ...]:
    """The same with a transport map of the inside that fades: for arms and hollows that trap the others."""
    return sparingly(
        FitPhase(7, 0.1, max(1e-2, even), 0.1),
        FitPhase(7, 0.06, max(3e-3, even), 0.03),
        FitPhase(7, 0.03, max(1e-3, even), 0.01),
        FitPhase(7, 0.015, max(5e-4, even), 0.003),
        FitPhase(14, FINE, even, junctions=junction_weight(even)),
    )


class Way(Enum):
    """How a fit from the uniform sheet goes about it."""

    COOLED = "cooled"
    GUIDED = "guided"
    GROWN = "grown"
    THICKENED = "thickened"

    @classmethod
    def suited_to(cls, target: Outline, symmetry: Symmetry | None = None) -> tuple[Way, ...]:
        """The ways that find most for a target: one more where a symmetry leaves few poses to begin with."""
        ways = (cls.GUIDED, cls.GROWN) if turn_back(target).angle >= TURNS_BACK else (cls.COOLED, cls.GUIDED)
        return ways if symmetry is None else (*ways, cls.THICKENED)


@dataclass(frozen=True, slots=True)
class FitOptions:
    """What all fits of one request ask for beside the match."""

    preference: Preference = field(default_factory=Preference)
    least_panel: float = 0.0  #: unit cells
    free_rim: bool = False
    even: float = 0.0  #: Weight of even panels in the end
    symmetry: KeptSymmetry = KeptSymmetry.AUTO  #: Which symmetries of the target sheets may keep
    evenness_price: float = 0.0  #: IoU that a coefficient of variation of panel areas lower by 1 is worth
    symmetry_price: float = FAIR_LOSS  #: IoU that a symmetric sheet may lack and still wins
    start: StartShape = RECTANGLE  #: What the sheets look like while they are flat
    second: SecondTarget | None = None  #: What they should also show on their way
    least_gap: float = 0.0  #: unit cells; of pinned sheets, which keep turns alone, see ``pinwheel``; 0 for others

    @property
    def hands(self) -> tuple[int, ...]:
        """Hands that fits begin with: both of pinned sheets; others have none."""
        return HANDS if self.least_gap else (0,)

    def beginning(self, grid: tuple[int, int], hand: int) -> Sheet:
        """Sheet where fits without a guess begin: the uniform one, or the pinwheel of a hand."""
        return self.handed(first_sheet(grid, self.start, free_rim=self.free_rim), hand)

    def handed(self, sheet: Sheet, hand: int) -> Sheet:
        """The pinwheel of a hand that is near a sheet; without one the sheet itself."""
        return pinwheel(sheet, self.least_gap, hand) if hand else sheet


def fit_shape(
    target: Outline,
    grid: tuple[int, int],
    phi: float = 0.0,
    starts: Sequence[Sheet | RatioField] = (),
    effort: int = 1,
    cancel: Callable[[], bool] = lambda: False,
    options: FitOptions | None = None,
) -> list[Fit]:
    """Search for the sheets whose outline at ``phi`` matches ``target`` best.

    Parameters
    ----------
    target : Outline
    grid : (rows, columns)
    phi : float, radians, in [0, pi)
    starts : sequence of Sheet or RatioField
        Guesses of any grid, fitted beside the search's own starts.
    effort : int, 1..8
        Multiplies the number of rotations and of fits that are carried to the end.
    cancel : callable
        Asked before every step; the best so far are returned.
    options : FitOptions, optional

    Returns
    -------
    fits : list of Fit
        Those that are worth most first: exact IoU, less the prices of ``options``; at least one.  ``evaluations``
        counts the decodings of the whole search.

    Raises
    ------
    AngleError, GridError, UsageError
        An angle, a grid or an effort that is out of range.
    TargetError
        A symmetry is asked for that the target is far from.
    """
    check_grid(*grid)
    phi = check_fit(phi, LAST_STEPS, NEAR)
    if not isinstance(effort, int) or isinstance(effort, bool) or not 1 <= effort <= LARGEST_EFFORT:
        raise UsageError("search.effort_out_of_range", most=LARGEST_EFFORT, effort=effort)
    options = options or FitOptions()
    check_least(options.least_panel)
    check_gap(options.least_gap)
    search = _FitSearch(target, phi, cancel, options)
    guesses = [Sheet.of(start) for start in starts]
    coarse = coarser(grid)
    found = search.first_looks(coarse, effort)
    if coarse == grid:
        found += [search.from_guess(guess, grid) for guess in guesses]
    best = search.completed(_best(found, KEPT * effort))
    if coarse != grid:
        raised = [look for one in best for look in search.lifted(one, grid)]
        raised += [search.from_guess(guess, grid) for guess in guesses]
        best = search.completed(_best(raised, KEPT * effort))
    best = search.completed(best, FINE)
    best = _best([search.aligned(one) for one in (*best, *search.plain(grid))], len(best))
    return [replace(one.fit, evaluations=search.evaluations) for one in best]


def fit_from_uniform(
    target: Outline,
    grid: tuple[int, int],
    phi: float,
    angle: float,
    way: Way,
    options: FitOptions,
    symmetry: Symmetry | None = None,
    cancel: Callable[[], bool] = lambda: False,
    hand: int = 0,
    phases: Sequence[FitPhase] = (),
) -> Fit:
    """One fit from the uniform sheet, turned by ``angle`` (radians): stiff and even first, led by the transport map of
    the inside, growing out of a round shape, or shrinking from a thickened one; a pinned one begins with the pinwheel
    of a ``hand``, 1 or -1.  ``phases`` take the place of those of the way.
    """
    sheet, even = options.beginning(grid, hand), options.even
    pose, evaluations = _centred(sheet, phi, angle), 0
    route = _route(target, way, even)
    if route:
        pose = route[0][0].frame.compose(pose)
    for easy, weight in route:
        fit = polish(
            sheet,
            easy.outline,
            phi,
            0,
            options.preference,
            easy.frame.inverse().compose(pose),
            cancel,
            phases=sparingly(FitPhase(EASY_STEPS, FAR, weight)),
            least_gap=options.least_gap,
            free_rim=options.free_rim,
            symmetry=symmetry,
            start_weight=options.start.weight,
        )
        sheet, pose, evaluations = fit.sheet, easy.frame.compose(fit.pose), evaluations + fit.evaluations
    fit = polish(
        sheet,
        target,
        phi,
        0,
        options.preference,
        pose,
        cancel,
        phases=tuple(phases) or _phases(way, even),
        transport=TransportMap.of(sheet, target, angle) if way is Way.GUIDED else None,
        least_panel=options.least_panel,
        least_gap=options.least_gap,
        free_rim=options.free_rim,
        symmetry=symmetry,
        second=options.second,
        start_weight=options.start.weight,
    )
    return replace(fit, evaluations=evaluations + fit.evaluations)


def _phases(way: Way, even: float) -> tuple[FitPhase, ...]:
    """Phases of a way, once the target itself is fitted."""
    match way:
        case Way.COOLED:
            return cooled(even)
        case Way.GUIDED:
            return guided(even)
        case Way.GROWN:
            look = FitPhase(LOOK_STEPS, FAR, max(LAST_GROWN_EVEN, even))
        case Way.THICKENED:
            look = FitPhase(LOOK_STEPS, FAR, even)
    return sparingly(look, FitPhase(LAST_STEPS, FINE, even, junctions=junction_weight(even)))


def _route(target: Outline, way: Way, even: float) -> list[tuple[EasyShape, float]]:
    """Shapes on the way to a target, and the weight of even panels on each."""
    match way:
        case Way.GROWN:
            shapes = _rounder(target)
            stiff = len(shapes) - LAST_GROWN
            return [
                (easy, max(even, GROWN_EVEN if place < stiff else LAST_GROWN_EVEN)) for place, easy in enumerate(shapes)
            ]
        case Way.THICKENED:
            return [(easy, even) for easy in thickened(target, MARGINS)]
        case _:
            return []


def fit_by_stages(
    target: Outline,
    grid: tuple[int, int],
    phi: float,
    angle: float,
    phases: Sequence[FitPhase],
    free_rim: bool,
    symmetry: Symmetry | None,
    start: StartShape = RECTANGLE,
) -> Fit:
    """One fit from the uniform sheet, turned by ``angle`` (radians), through ``phases`` that need no transport map."""
    sheet = first_sheet(grid, start, free_rim=free_rim)
    pose = _centred(sheet, phi, angle)
    return polish(
        sheet,
        target,
        phi,
        0,
        pose=pose,
        phases=phases,
        free_rim=free_rim,
        symmetry=symmetry,
        start_weight=start.weight,
    )


def first_angles(
    target: Outline,
    grid: tuple[int, int],
    effort: int = 1,
    setting: KeptSymmetry = KeptSymmetry.AUTO,
    start: StartShape = RECTANGLE,
    *,
    pinned: bool = False,
) -> list[tuple[float, Symmetry | None]]:
    """Rotations to begin with, those that keep a symmetry first: both ways up for a mirror axis.

    A long sheet counts them from the one that lays it along a long target, and those near that one come first.  A
    ``pinned`` sheet has no mirrors.
    """
    angles = _rotations(grid, effort, start)
    upright = start.proportion(*grid)
    proportions = Proportions.of(target)
    along = proportions.direction
    if abs(upright) > SHORT and proportions.along(along) > LONG:
        first = along if upright < 0.0 else along - 0.5 * math.pi
        angles = sorted((first + angle for angle in angles), key=lambda angle: abs(math.sin(angle - first)))
    looks: list[tuple[float, Symmetry | None]] = []
    for pose in shared_symmetries(target, grid, setting, start, pinned=pinned):
        looks += [(angle, pose.symmetry) for angle in _own_angles(pose, angles)]
    return looks + [(angle, None) for angle in angles]


def _own_angles(pose: SymmetricPose, angles: list[float]) -> list[float]:
    """Rotations of the sheet that lay its axis on the target's; any for a turn."""
    return angles if pose.angle is None else [pose.angle - 0.5 * math.pi, pose.angle + 0.5 * math.pi]


def lifted(sheet: Sheet, grid: tuple[int, int], start: StartShape = RECTANGLE) -> Sheet:
    """The sheet carried to another grid, within the bounds of a fit; another start shape is laid under it anew."""
    carried = resized_sheet(sheet, *grid)
    z = np.clip(carried.field.log10, -LOG_RATIO_LIMIT, LOG_RATIO_LIMIT)
    offsets = np.clip(carried.rim.offsets(*grid), -RIM_REACH, RIM_REACH)
    field, rim = RatioField.from_log10(z), Rim.moved(*grid, offsets, carried.rim.hinges)
    flat = sheet if start.is_plain else uniform_sheet(grid, start)
    return Sheet(field, rim, flat.start, flat.cell)


@dataclass(frozen=True, slots=True)
class _FoundFit:
    """A fit, its exact IoU in its own pose, whether the sheet gets there untouched, and what symmetry it has.

    ``small`` says that a panel is smaller than asked for, or that pins are nearer; ``worth`` is the IoU less the price
    of uneven panels and what the second target lacks, plus what a symmetry is worth.
    """

    fit: Fit
    iou: float
    clear: bool
    small: bool
    worth: float
    symmetry: Symmetry | None = None


class _FitSearch:
    """What all fits of one request share."""

    def __init__(self, target: Outline, phi: float, cancel: Callable[[], bool], options: FitOptions) -> None:
        self.target, self.phi, self.cancel, self.options = target, phi, cancel, options
        self.evaluations = 0

    def first_looks(self, grid: tuple[int, int], effort: int) -> list[_FoundFit]:
        """Fits from the uniform sheet: every rotation on every way, those that keep a symmetry first."""
        thick = thickened(self.target, MARGINS)
        ways = Way.suited_to(self.target)
        found: list[_FoundFit] = []
        options = self.options
        poses = first_angles(self.target, grid, effort, options.symmetry, options.start, pinned=options.least_gap > 0.0)
        for (angle, symmetry), hand in product(poses, options.hands):
            for way in ways:
                if found and self.cancel():
                    return found
                found.append(self._from_uniform(grid, angle, way, symmetry, hand))
            sheet = options.beginning(grid, hand)
            first = thick[0].frame.compose(_centred(sheet, self.phi, angle))
            if found and self.cancel():
                return found
            found.append(self._along(thick, sheet, first, symmetry))
        return found

    def _from_uniform(
        self, grid: tuple[int, int], angle: float, way: Way, symmetry: Symmetry | None, hand: int
    ) -> _FoundFit:
        fit = fit_from_uniform(self.target, grid, self.phi, angle, way, self.options, symmetry, self.cancel, hand)
        self.evaluations += fit.evaluations
        return self._found(fit, symmetry)

    def _along(self, route: list[EasyShape], sheet: Sheet, pose: Similarity, symmetry: Symmetry | None) -> _FoundFit:
        for easy in route:
            own = easy.frame.inverse().compose(pose)
            fit = self._polish(sheet, easy.outline, EASY_STEPS, own, FAR, symmetry, least_panel=0.0)
            sheet, pose = fit.sheet, easy.frame.compose(fit.pose)
        return self._fit(sheet, pose, LOOK_STEPS, FAR, symmetry)

    def from_guess(self, guess: Sheet, grid: tuple[int, int]) -> _FoundFit:
        """A look from a sheet of any grid, aligned by IoU; it keeps its symmetry and hand."""
        sheet = self._laid(guess, grid)
        pose = align(deploy(sheet).outline(self.phi), self.target.points)
        return self._fit(sheet, pose, LOOK_STEPS, FAR, symmetry_of(sheet))

    def plain(self, grid: tuple[int, int]) -> list[_FoundFit]:
        """The fit without a search, of every hand, so that a search never ends with less."""
        found = []
        for sheet in (self.options.beginning(grid, hand) for hand in self.options.hands):
            pose = align(deploy(sheet).outline(self.phi), self.target.points)
            found.append(self._fit(sheet, pose, PLAIN_STEPS, FINE, None))
        return found

    def _laid(self, sheet: Sheet, grid: tuple[int, int]) -> Sheet:
        """A sheet carried to another grid; a pinned one keeps its hand."""
        laid = lifted(sheet, grid, self.options.start)
        return self.options.handed(laid, hand_of(laid.field)) if self.options.least_gap else laid

    def aligned(self, found: _FoundFit) -> _FoundFit:
        """The same sheet in the pose of largest IoU, which is what a score compares."""
        outline = deploy(found.fit.sheet).outline(self.phi)
        pose = align(outline, self.target.points)
        iou = exact_iou(pose.apply(outline), self.target)
        if iou <= found.iou:
            return found
        return replace(found, fit=replace(found.fit, pose=pose), iou=iou, worth=found.worth + iou - found.iou)

    def lifted(self, coarse: _FoundFit, grid: tuple[int, int]) -> list[_FoundFit]:
        """Looks on a finer grid from a fit on a coarse one; grids of equal parities have the same symmetries."""
        sheet = self._laid(coarse.fit.sheet, grid)
        pose = align(deploy(sheet).outline(self.phi), self.target.points)
        routes = [[], thickened(self.target, LIFTED_MARGINS)]
        kept = coarse.symmetry
        if kept is not None and not can_have(grid, self.options.start, kept):
            kept = None
        return [self._along(route, sheet, pose, kept) for route in routes]

    def completed(self, found: list[_FoundFit], trust: float = NEAR) -> list[_FoundFit]:
        """The fits carried to the end, best first."""
        ends = [self._fit(one.fit.sheet, one.fit.pose, LAST_STEPS, trust, one.symmetry) for one in found]
        return _best([_best([end, one], 1)[0] for end, one in zip(ends, found, strict=True)], len(ends))

    def _fit(self, sheet: Sheet, pose: Similarity, steps: int, trust: float, symmetry: Symmetry | None) -> _FoundFit:
        least = self.options.least_panel
        return self._found(self._polish(sheet, self.target, steps, pose, trust, symmetry, least), symmetry)

    def _found(self, fit: Fit, symmetry: Symmetry | None) -> _FoundFit:
        deployment = deploy(fit.sheet)
        laid = fit.pose.apply(deployment.outline(self.phi))
        iou, options = exact_iou(laid, self.target), self.options
        figures = evenness(deployment)
        small = min(figures.least_edge, figures.least_neck) < options.least_panel
        if options.least_gap:
            small = small or least_pin_distance(deployment) < options.least_gap - GAP_ROUNDING
        worth = iou - options.evenness_price * figures.area_cv
        if options.second is not None and fit.second_pose is not None:
            laid = fit.second_pose.apply(deployment.outline(options.second.phi))
            worth -= options.second.weight * (1.0 - exact_iou(laid, options.second.outline))
        if symmetry is not None:
            worth += options.symmetry_price
        return _FoundFit(fit, iou, path_contact(deployment, self.phi) is None, small, worth, symmetry)

    def _polish(
        self,
        sheet: Sheet,
        target: Outline,
        steps: int,
        pose: Similarity,
        trust: float,
        symmetry: Symmetry | None,
        least_panel: float,
    ) -> Fit:
        options = self.options
        fit = polish(
            sheet,
            target,
            self.phi,
            steps,
            options.preference,
            pose,
            self.cancel,
            trust=trust,
            even=options.even,
            least_panel=least_panel,
            least_gap=options.least_gap,
            free_rim=options.free_rim,
            symmetry=symmetry,
            second=options.second,
            start_weight=options.start.weight,
        )
        self.evaluations += fit.evaluations
        return fit


def _best(found: list[_FoundFit], count: int) -> list[_FoundFit]:
    """The ``count`` that are worth most, those with small panels and those that touch themselves last.

    Equal ones keep their order.
    """

    def key(one: _FoundFit) -> tuple[bool, bool, float]:
        return not one.clear, one.small, -one.worth

    return sorted(found, key=key)[:count]


def _rotations(grid: tuple[int, int], effort: int, start: StartShape) -> list[float]:
    """Angles to start from, evenly over the part of a turn that symmetry leaves: see the sheet's exact symmetries."""
    if can_have(grid, start, Symmetry.QUARTER_TURN):
        turn, count = 0.5 * math.pi, QUARTER
    elif can_have(grid, start, Symmetry.HALF_TURN):
        turn, count = math.pi, HALF
    else:
        turn, count = 2.0 * math.pi, WHOLE
    return [turn * index / (count * effort) for index in range(count * effort)]


def coarser(grid: tuple[int, int], most: int = COARSE) -> tuple[int, int]:
    """A grid of at most about ``most`` voids each way, of its parities and nearly its aspect."""
    share = most / max(grid)
    if share >= 1.0:
        return grid

    def fewer(count: int) -> int:
        odd = count % 2
        return max(2 + odd, 2 * round((count * share - odd) / 2) + odd)

    return fewer(grid[0]), fewer(grid[1])


def _centred(design: Sheet | RatioField, phi: float, angle: float) -> Similarity:
    """Pose that turns the layout by ``angle`` and gives it area 1 around the origin."""
    sheet = shapely.Polygon(deploy(design).outline(phi))
    turned = Similarity(1.0 / math.sqrt(sheet.area), angle)
    x, y = turned.apply(np.array([sheet.centroid.x, sheet.centroid.y]))
    return Similarity(turned.scale, angle, (-x, -y))


@dataclass(frozen=True, slots=True)
class EasyShape:
    """One shape on the way."""

    outline: Outline
    frame: Similarity  #: Carries ``outline``'s own unit-area frame to the target's frame

    @classmethod
    def of(cls, shape: shapely.geometry.base.BaseGeometry) -> EasyShape:
        """A shape in the target's frame, holes filled."""
        solid = shapely.Polygon(shapely.get_exterior_ring(shape)).simplify(ACCURACY)
        frame = Similarity(math.sqrt(solid.area), 0.0, (solid.centroid.x, solid.centroid.y))
        return cls(Outline.from_points(shapely.get_coordinates(solid)[:-1]), frame)


@lru_cache(maxsize=8)
def _rounder(target: Outline) -> list[EasyShape]:
    return [EasyShape.of(shape) for shape in rounded(target, ROUNDER)]


def thickened(target: Outline, margins: Sequence[float]) -> list[EasyShape]:
    """``target`` with its boundary moved outwards by each margin (unit-area lengths, > 0), holes filled."""
    return [EasyShape.of(target.polygon.buffer(margin)) for margin in margins]
