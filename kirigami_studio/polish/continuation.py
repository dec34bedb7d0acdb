"""The best match from no guess at all: several poses and easier shapes first, coarse grids before fine ones.

A plain fit follows nearest boundary points and gets stuck where the target turns away from the sheet: thin arms, deep
hollows, unlucky rotations.  The search fits from several rotations of the target, directly and by way of thickened
shapes, for a few steps each; the best go on, and on larger grids they are first found on a coarse one and lifted.
Where target and lattice share a symmetry, fits that keep it join in, and win when they match as well.

Every choice is fixed: the same request gives the same fits.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from kirigami_studio.evaluate.alignment import align
from kirigami_studio.evaluate.feasibility import path_contact
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.siou import exact_iou
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField, check_grid
from kirigami_studio.lattice.resize import resize_fields
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.polish.levenberg import Fit, check_fit, polish
from kirigami_studio.polish.panel_size import check_least
from kirigami_studio.polish.preferences import Preference
from kirigami_studio.polish.symmetry import shared_symmetries

#: Largest grid that is searched directly; finer ones start from a search on about this many voids each way.
COARSE = 10

#: Margins (unit-area lengths) by which the target is thickened on the two ways to it: at once, and in steps.
ROUTES: tuple[tuple[float, ...], ...] = ((), (0.2, 0.14, 0.09, 0.05, 0.02))

#: The same after a coarse fit was lifted: a slightly thickened target gives arms the room that the finer grid allows.
LIFTED_ROUTES: tuple[tuple[float, ...], ...] = ((), (0.09, 0.05, 0.02))

#: Steps on each easier shape, of a first look at the target, and of the last fit.
EASY_STEPS, LOOK_STEPS, LAST_STEPS = 4, 8, 20

#: Steps of the fit without a search that every search is compared with.
PLAIN_STEPS = 40

#: Trusted distances (unit-area lengths): far parts must pull in the search, area counts in the end.
FAR, NEAR, FINE = 0.03, 0.01, 0.005

#: Rotations tried per effort when quarter turns, half turns, or no turns carry reachable shapes to reachable shapes.
QUARTER, HALF, WHOLE = 4, 6, 8

#: Fits that are carried to the end, per effort.
KEPT = 3
LARGEST_EFFORT = 8

#: A symmetric fit is preferred to another that matches no more than this much better.
FAIR_LOSS = 0.002

#: Vertices of a thickened shape may move by this (unit-area lengths): round corners need no more.
ACCURACY = 0.002


def fit_shape(
    target: Outline,
    grid: tuple[int, int],
    phi: float = 0.0,
    starts: Sequence[RatioField] = (),
    effort: int = 1,
    cancel: Callable[[], bool] = lambda: False,
    preference: Preference | None = None,
    least_panel: float = 0.0,
) -> list[Fit]:
    """Search for the fields whose outline at ``phi`` matches ``target`` best.

    Parameters
    ----------
    target : Outline
    grid : (rows, columns)
    phi : float, radians, in [0, pi)
    starts : sequence of RatioField
        Guesses of any grid, fitted beside the search's own starts.
    effort : int, 1..8
        Multiplies the number of rotations and of fits that are carried to the end.
    cancel : callable
        Asked before every step; the best so far are returned.
    preference, least_panel
        As for :func:`polish`.

    Returns
    -------
    fits : list of Fit
        Best exact IoU first; at least one.  ``evaluations`` counts the decodings of the whole search.

    Raises
    ------
    AngleError, GridError, UsageError
        An angle, a grid or an effort that is out of range.
    """
    check_grid(*grid)
    phi = check_fit(phi, LAST_STEPS, NEAR)
    if not isinstance(effort, int) or isinstance(effort, bool) or not 1 <= effort <= LARGEST_EFFORT:
        raise UsageError("search.effort_out_of_range", most=LARGEST_EFFORT, effort=effort)
    search = _Search(target, phi, cancel, preference or Preference(), check_least(least_panel))
    coarse = _coarser(grid)
    found = search.first_looks(coarse, effort)
    found += [search.from_guess(lifted(start, coarse)) for start in starts]
    best = search.completed(_best(found, KEPT * effort))
    if coarse != grid:
        raised = [look for one in best for look in search.lifted(one, grid)]
        raised += [search.from_guess(lifted(start, grid)) for start in starts]
        best = search.completed(_best(raised, KEPT * effort))
    best = search.completed(best, FINE)
    best = _best([search.aligned(one) for one in (*best, search.plain(grid))], len(best))
    return [replace(one.fit, evaluations=search.evaluations) for one in best]


def lifted(field: RatioField, grid: tuple[int, int]) -> RatioField:
    """The field carried to another grid, within the bounds of a fit."""
    z = resize_fields(field.log10[np.newaxis], *grid)[0]
    return RatioField.from_log10(np.clip(z, -1.0, 1.0))


@dataclass(frozen=True, slots=True)
class _Found:
    """A fit, its exact IoU in its own pose, whether the sheet gets there untouched, and what symmetry it has."""

    fit: Fit
    iou: float
    clear: bool
    symmetry: Symmetry | None = None


class _Search:
    """What all fits of one request share."""

    def __init__(
        self,
        target: Outline,
        phi: float,
        cancel: Callable[[], bool],
        preference: Preference,
        least_panel: float,
    ) -> None:
        self.target, self.phi, self.cancel = target, phi, cancel
        self.preference, self.least_panel = preference, least_panel
        self.evaluations = 0

    def first_looks(self, grid: tuple[int, int], effort: int) -> list[_Found]:
        """Fits from the uniform sheet: every rotation on every route, then those that keep a symmetry."""
        routes = [thickened(self.target, margins) for margins in ROUTES]
        angles = _rotations(grid, self.phi, effort)
        looks: list[tuple[float, Symmetry | None]] = [(angle, None) for angle in angles]
        for shared in shared_symmetries(self.target, grid, self.phi):
            own = angles if shared.angle is None else [shared.angle - 0.5 * math.pi, shared.angle + 0.5 * math.pi]
            looks += [(angle, shared.symmetry) for angle in own]
        field = RatioField.uniform(*grid)
        found: list[_Found] = []
        for angle, symmetry in looks:
            pose = _centred(field, self.phi, angle)
            for route in routes:
                if found and self.cancel():
                    return found
                first = route[0].frame if route else Similarity()
                found.append(self._along(route, field, first.compose(pose), symmetry))
        return found

    def _along(self, route: list[EasyShape], field: RatioField, pose: Similarity, symmetry: Symmetry | None) -> _Found:
        for easy in route:
            own = easy.frame.inverse().compose(pose)
            fit = self._polish(field, easy.outline, EASY_STEPS, own, FAR, symmetry)
            field, pose = fit.field, easy.frame.compose(fit.pose)
        return self._fit(field, pose, LOOK_STEPS, FAR, symmetry)

    def from_guess(self, field: RatioField) -> _Found:
        """A look from a given field, aligned by IoU."""
        pose = align(deploy(field).outline(self.phi), self.target.points)
        return self._fit(field, pose, LOOK_STEPS, FAR, None)

    def plain(self, grid: tuple[int, int]) -> _Found:
        """The fit without a search, so that a search never ends with less."""
        field = RatioField.uniform(*grid)
        pose = align(deploy(field).outline(self.phi), self.target.points)
        return self._fit(field, pose, PLAIN_STEPS, FINE, None)

    def aligned(self, found: _Found) -> _Found:
        """The same field in the pose of largest IoU, which is what a score compares."""
        outline = deploy(found.fit.field).outline(self.phi)
        pose = align(outline, self.target.points)
        iou = exact_iou(pose.apply(outline), self.target)
        return found if iou <= found.iou else replace(found, fit=replace(found.fit, pose=pose), iou=iou)

    def lifted(self, coarse: _Found, grid: tuple[int, int]) -> list[_Found]:
        """Looks on a finer grid from a fit on a coarse one; grids of equal parities have the same symmetries."""
        field = lifted(coarse.fit.field, grid)
        pose = align(deploy(field).outline(self.phi), self.target.points)
        routes = [thickened(self.target, margins) for margins in LIFTED_ROUTES]
        return [self._along(route, field, pose, coarse.symmetry) for route in routes]

    def completed(self, found: list[_Found], trust: float = NEAR) -> list[_Found]:
        """The fits carried to the end, best first."""
        ends = [self._fit(one.fit.field, one.fit.pose, LAST_STEPS, trust, one.symmetry) for one in found]
        return _best([_best([end, one], 1)[0] for end, one in zip(ends, found, strict=True)], len(ends))

    def _fit(self, field: RatioField, pose: Similarity, steps: int, trust: float, symmetry: Symmetry | None) -> _Found:
        fit = self._polish(field, self.target, steps, pose, trust, symmetry)
        deployment = deploy(fit.field)
        laid = fit.pose.apply(deployment.outline(self.phi))
        return _Found(fit, exact_iou(laid, self.target), path_contact(deployment, self.phi) is None, symmetry)

    def _polish(
        self,
        field: RatioField,
        target: Outline,
        steps: int,
        pose: Similarity,
        trust: float,
        symmetry: Symmetry | None,
    ) -> Fit:
        fit = polish(
            field,
            target,
            self.phi,
            steps,
            self.preference,
            pose,
            self.cancel,
            trust=trust,
            least_panel=self.least_panel,
            symmetry=symmetry,
        )
        self.evaluations += fit.evaluations
        return fit


def _best(found: list[_Found], count: int) -> list[_Found]:
    """The ``count`` best by IoU, those that touch themselves last; equal ones keep their order."""

    def key(one: _Found) -> tuple[bool, float]:
        return not one.clear, -one.iou - (FAIR_LOSS if one.symmetry else 0.0)

    return sorted(found, key=key)[:count]


def _rotations(grid: tuple[int, int], phi: float, effort: int) -> list[float]:
    """Angles to start from, evenly over the part of a turn that symmetry leaves: see the grid's exact symmetries."""
    rows, columns = grid
    if rows % 2 != columns % 2:
        turn, count = 2.0 * math.pi, WHOLE
    elif rows % 2 == 0 and rows == columns and phi == 0.0:
        turn, count = 0.5 * math.pi, QUARTER
    else:
        turn, count = math.pi, HALF
    return [turn * index / (count * effort) for index in range(count * effort)]


def _coarser(grid: tuple[int, int]) -> tuple[int, int]:
    """The grid to search on: at most about COARSE voids each way, of the same parity and nearly the same aspect."""
    share = COARSE / max(grid)
    if share >= 1.0:
        return grid

    def fewer(count: int) -> int:
        odd = count % 2
        return max(2 + odd, 2 * round((count * share - odd) / 2) + odd)

    return fewer(grid[0]), fewer(grid[1])


def _centred(field: RatioField, phi: float, angle: float) -> Similarity:
    """Pose that turns the layout by ``angle`` and gives it area 1 around the origin."""
    sheet = shapely.Polygon(deploy(field).outline(phi))
    turned = Similarity(1.0 / math.sqrt(sheet.area), angle)
    x, y = turned.apply(np.array([sheet.centroid.x, sheet.centroid.y]))
    return Similarity(turned.scale, angle, (-x, -y))


@dataclass(frozen=True, slots=True)
class EasyShape:
    """One shape on the way.

    Attributes
    ----------
    outline : Outline
    frame : Similarity
        Carries ``outline``'s own unit-area frame to the target's frame.
    """

    outline: Outline
    frame: Similarity


def thickened(target: Outline, margins: Sequence[float]) -> list[EasyShape]:
    """``target`` with its boundary moved outwards by each margin (unit-area lengths, > 0), holes filled."""
    return [_shape(target.polygon.buffer(margin)) for margin in margins]


def _shape(thick: shapely.geometry.base.BaseGeometry) -> EasyShape:
    solid = shapely.Polygon(shapely.get_exterior_ring(thick)).simplify(ACCURACY)
    frame = Similarity(math.sqrt(solid.area), 0.0, (solid.centroid.x, solid.centroid.y))
    return EasyShape(Outline.from_points(shapely.get_coordinates(solid)[:-1]), frame)
