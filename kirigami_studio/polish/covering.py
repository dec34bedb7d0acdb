"""A fit for trimming: cover the target, let the rest stick out where it can be cut off, and trim.

The fit weighs what is missed fully and what sticks out a little, except at the outline's hinges, which trimming has to
leave.  Then the pose is moved to where a quick estimate of the trimmed IoU is best, and the layout is trimmed there.

No closed sheet shows a notch that turns back far (``outlines.turning``).  A sheet can cover the target with such
notches filled; one that does is fitted to that shape, and the notches are cut out of it by a deep trim.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import shapely

from kirigami_studio.evaluate.alignment import align, align_near
from kirigami_studio.evaluate.feasibility import path_contact
from kirigami_studio.evaluate.kept_panels import GRID, edge_panels
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.siou import exact_iou
from kirigami_studio.evaluate.trimming import KEEP, Trim, check_keep, trim
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.starts import TURNS_BACK
from kirigami_studio.outlines.turning import turn_back
from kirigami_studio.polish.continuation import EasyShape
from kirigami_studio.polish.levenberg import Fit, check_fit, polish

#: Weight of what sticks out.  Found on 12 drawn shapes at 10 x 10: 0.1 covers better than 0.03 or 0.01, which let the
#: layout grow until its hinges are outside.
EXCESS = 0.1
#: The layout starts so much larger, so that its hinges are near the target's boundary.
GROWN = 1.005
#: Trusted distance (unit-area lengths) of the fit.
TRUST = 0.005
#: A target that turns back from this angle on is better covered with its notches filled: a spade (160 degrees) is not.
#: They are filled until the shape turns back by no more than the second angle, with discs of one of these radii
#: (unit-area lengths), rolled along its outside.  Where a cover is wanted in any case that is done from there on: a
#: clover (167 degrees) is covered at 0.980 then, at 0.923 else, a gear (118) at 0.988 and 0.972.
DEEP_FROM, EASY_TURN = TURNS_BACK, math.radians(105.0)
DISCS = (0.05, 0.07, 0.1, 0.14, 0.2, 0.3, 0.45)
#: First moves of the search on the pose: log scale, turn (radians), shift (unit-area lengths); and how many poses are
#: looked at.
FIRST_MOVES = (0.006, 0.006, 0.006, 0.006)
LOOKS = 80


@dataclass(frozen=True, slots=True, eq=False)
class Cover:
    """A layout to be trimmed."""

    #: ``sheet`` and ``pose`` are those of ``trim``; ``steps`` is 0 where no other sheet trims better than the first.
    fit: Fit
    trim: Trim


def fit_cover(
    design: Sheet | RatioField,
    target: Outline,
    phi: float = 0.0,
    steps: int = 12,
    pose: Similarity | None = None,
    keep: float = KEEP,
    cancel: Callable[[], bool] = lambda: False,
    locked: BoolArray | None = None,
    *,
    free_rim: bool = False,
    symmetry: Symmetry | None = None,
    even: float = 0.0,
    least_panel: float = 0.0,
    least_gap: float = 0.0,
    notched: bool = False,
    afresh: bool = False,
    room: Callable[[Deployment], Deployment] = lambda deployment: deployment,
    start_weight: float = 1.0,
) -> Cover:
    """Fit a polished sheet so that its trimmed silhouette matches best.

    Parameters
    ----------
    design : Sheet or RatioField
        A sheet already polished; it is trimmed as it is, too, and the better trim counts.
    target : Outline
    phi : float, radians, in [0, pi)
    steps : int
    pose : Similarity, optional
        Layout frame at ``phi`` to target frame; aligned by IoU when missing.
    keep : float, unit cells
        See :func:`trim`.
    cancel : callable
        Asked before every step; the best so far is returned.
    locked : (m, n) bool, optional
        Voids whose ratio stays exactly as it is.
    free_rim, symmetry, even, least_panel, least_gap, start_weight
        As for :func:`polish`.
    notched : bool
        Whether notches that no closed sheet shows are cut out in any case.
    afresh : bool
        Whether the sheet is trimmed after the fit alone: where it is to be another design, not a better trim.
    room : callable
        Makes room for the connectors of a sheet before it is trimmed: afterwards its panels cannot be changed.

    Raises
    ------
    AngleError, UsageError
        An angle, a number of steps, a depth or a table of locked voids that is out of range.
    KirigamiError
        The sheet's outline crosses itself.
    """
    phi, keep = check_fit(phi, steps, TRUST), check_keep(keep)
    sheet = Sheet.of(design)

    def trimmed(fit: Fit) -> Cover:
        before = deploy(fit.sheet)
        made = room(before)
        if made is not before and path_contact(made, phi) is None:
            # Room leaves the silhouette what it is, but neither its place nor its size.
            moved = align_near(made.outline(phi), before.outline(phi), Similarity())
            fit = replace(fit, sheet=made.sheet, pose=fit.pose.compose(moved))
        return cut(fit, target, phi, keep, cancel)

    outline = deploy(sheet).outline(phi)
    pose = pose or align(outline, target.points)
    wanted, place, cut = target.filled, Similarity(), _trimmed
    filled = notches_filled(target.filled, EASY_TURN) if notched else notches_filled(target.filled)
    if filled is not None:
        laid = align(outline, filled.outline.points)
        if notched or exact_iou(laid.apply(outline), filled.outline) > exact_iou(pose.apply(outline), target.filled):
            wanted, place, cut = filled.outline, filled.frame, _trimmed_deep
            pose = place.compose(laid)
    first = Fit(sheet, pose, 0.0, 0, 0)
    best = None if afresh else trimmed(first)
    fit = polish(
        sheet,
        wanted,
        phi,
        steps,
        pose=place.inverse().compose(_grown(pose, GROWN)),
        cancel=cancel,
        trust=TRUST,
        even=even,
        least_panel=least_panel,
        least_gap=least_gap,
        free_rim=free_rim,
        symmetry=symmetry,
        excess=EXCESS,
        locked=locked,
        start_weight=start_weight,
    )
    fit = replace(fit, pose=place.compose(fit.pose))
    if fit.steps and path_contact(deploy(fit.sheet), phi) is None and not cancel():
        other = trimmed(fit)
        if best is None or other.trim.iou > best.trim.iou:
            best = other
    return best or trimmed(first)


@lru_cache(maxsize=16)
def notches_filled(target: Outline, least: float = DEEP_FROM, easy: float = EASY_TURN) -> EasyShape | None:
    """Fill the narrowest notches of a target until it turns back by ``easy``.

    None below ``least`` (radians) is filled.
    """
    if turn_back(target).angle < least:
        return None
    for radius in DISCS:
        shape = EasyShape.of(target.polygon.buffer(radius).buffer(-radius))
        if turn_back(shape.outline).angle <= easy:
            return shape
    return EasyShape.of(target.polygon.convex_hull)


def _trimmed_deep(fit: Fit, target: Outline, phi: float, keep: float, cancel: Callable[[], bool]) -> Cover:
    """Trim a layout with its notches in its own pose; along its edge where nothing would be left of it."""
    deployment = deploy(fit.sheet)
    try:
        return Cover(fit, trim(deployment, target, phi, fit.pose, keep, deep=True))
    except KirigamiError:
        return Cover(fit, trim(deployment, target, phi, fit.pose, keep))


def _trimmed(fit: Fit, target: Outline, phi: float, keep: float, cancel: Callable[[], bool]) -> Cover:
    """Trim a layout in the pose that promises most; in its own if that one holds less."""
    deployment = deploy(fit.sheet)
    plain = Cover(fit, trim(deployment, target, phi, fit.pose, keep))
    if cancel():
        return plain
    pose = TrimmedIoUEstimate(deployment, target, phi, keep).best_pose(fit.pose, cancel)
    try:
        moved = trim(deployment, target, phi, pose, keep)
    except KirigamiError:  # touching itself by rounding in one pose is no reason to lose the other
        return plain
    return plain if moved.iou <= plain.trim.iou else Cover(replace(fit, pose=pose), moved)


class TrimmedIoUEstimate:
    """A quick estimate of the trimmed IoU in any pose: the target's part of the layout, and what has to stay outside.

    What stays is the inside of the sheet, whole, and a disc of material at every hinge of an edge panel.
    """

    def __init__(self, deployment: Deployment, target: Outline, phi: float, keep: float) -> None:
        self.target, self.layout = target, shapely.Polygon(deployment.outline(phi))
        panels = edge_panels(deployment.field.rows, deployment.field.columns)
        nodes = deployment.nodes(phi)
        hinges = nodes[np.unique(panels.corners[panels.hinged])]
        edge = shapely.union_all(shapely.polygons(nodes[panels.corners]), grid_size=GRID)
        discs = shapely.union_all(shapely.buffer(shapely.points(hinges), keep, quad_segs=4))
        self.fixed = shapely.union(shapely.difference(self.layout, edge), discs.intersection(self.layout))
        shapely.prepare(self.layout)

    def iou(self, pose: Similarity) -> float:
        """Estimate for one pose."""
        place = shapely.Polygon(pose.inverse().apply(self.target.points))
        shared = float(self.layout.intersection(place).area)
        outside = float(self.fixed.difference(place).area)
        return shared / (place.area + outside)

    def best_pose(self, pose: Similarity, cancel: Callable[[], bool]) -> Similarity:
        """The pose near the given one that promises most, by a simplex over shift, turn and scale."""
        # Imported when it is needed: it takes long, and the window starts without it.
        from scipy.optimize import fmin

        def moved(move: FloatArray) -> Similarity:
            return Similarity(math.exp(move[0]), move[1], (move[2], move[3])).compose(pose)

        def loss(move: FloatArray) -> float:
            return 0.0 if cancel() else -self.iou(moved(move))

        simplex = np.vstack([np.zeros(4), np.diag(FIRST_MOVES)])
        found = fmin(loss, np.zeros(4), initial_simplex=simplex, maxfun=LOOKS, xtol=1e-4, ftol=1e-5, disp=False)
        return moved(np.asarray(found, dtype=np.float64))


def _grown(pose: Similarity, scale: float) -> Similarity:
    """Larger about the target's centre."""
    return Similarity(scale).compose(pose)
