"""Starts that runs choose: a rectangle, unless short fits of another promise more.

Every arm with parallel flanks takes a corner of the sheet (``outlines.turning``), and a tip or a hollow on the axis a
corner or a hollow there: so a hexagon, a triangle, a disk, and rectangles with a gable or a notch are tried beside the
rectangle, by the fits that decide between grids.  Shapes that need few corners and are expected to match have the
rectangle at once: it is cut without waste.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.sentences import sentence
from kirigami_studio.outlines.starts import RECTANGLE, StartShape, start_shape
from kirigami_studio.outlines.turning import sides_needed
from kirigami_studio.pipeline.auto_grid import TRIAL, Trials, one_by_one, predicted_for, remembered
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.tasks import TrialTask
from kirigami_studio.polish.continuation import first_angles

#: What is tried beside the rectangle.
TRIED = ("hexagon", "triangle", "circle", "gable", "notch")
#: Where a shape needs fewer sides than the first and is expected to match at least as well as the second, nothing is
#: tried.
FEW_SIDES, EXPECTED = 4, 0.98
#: Poses of each start.
POSES = 3
#: Another start is taken where its short fits are worth more than the rectangle's by this.  They tell worths apart by
#: about 0.01: of a clover a notch gains 0.010 in them, and 0.003 in whole runs.
GAIN = 0.015

_CHOSEN: dict[Hashable, StartChoice] = {}


@dataclass(frozen=True, slots=True)
class StartChoice:
    """A start and why it was taken."""

    start: StartShape
    code: str
    #: tuple of (str, object); the reason, as a sentence's code and what it names.
    fields: tuple[tuple[str, object], ...]

    @property
    def reason(self) -> str:
        """One sentence for the user."""
        return sentence(self.code, dict(self.fields))


def chosen_start(request: Request, trials: Trials = one_by_one) -> StartChoice:
    """The start that a run takes where that is left to it; what was chosen is remembered."""
    sheet = (request.width_mm, request.least_feature_mm, request.least_gap_mm, request.fit_options.free_rim)
    grid = None if request.grid_chosen else request.grid
    key = request.target, request.phi, request.symmetry, grid, request.start.weight, *sheet
    return remembered(_CHOSEN, key, lambda: _tried(request, trials))


def _tried(request: Request, trials: Trials) -> StartChoice:
    plain = replace(request, start=_weighed(RECTANGLE, request))
    sides, expected = sides_needed(request.silhouette), predicted_for(plain).predicted_match
    if request.pinned or (sides < FEW_SIDES and expected >= EXPECTED):
        return StartChoice(plain.start, "start.few_corners", (("percent", 100.0 * expected),))
    worth = {RECTANGLE.name: _worth(plain, trials)}
    starts = {RECTANGLE.name: plain.start}
    for name in TRIED:
        starts[name] = _weighed(start_shape(name), request)
        try:
            worth[name] = _worth(replace(request, start=starts[name]), trials)
        except KirigamiError:  # it cannot have the grid, or the symmetry, that is asked for
            continue
    best = max(worth, key=worth.__getitem__)
    fields = ("name", best), ("sides", sides), ("count", len(worth))
    if worth[best] < worth[RECTANGLE.name] + GAIN:
        return StartChoice(plain.start, "start.rectangle_tried", fields)
    return StartChoice(starts[best], "start.other_tried", fields)


def _weighed(start: StartShape, request: Request) -> StartShape:
    return replace(start, weight=request.start.weight)


def _worth(request: Request, trials: Trials) -> float:
    """Best worth of short fits from a start: exact IoU less the price of uneven panels."""
    grid = request.grid or predicted_for(request).grid
    poses = first_angles(request.silhouette, grid, 1, request.symmetry, request.start)
    # Poses without a symmetry are tried too: symmetric ones come first.
    free = [pose for pose in poses if pose[1] is None]
    tasks = [TrialTask(grid, *pose, TRIAL) for pose in dict.fromkeys([*poses[: POSES - 1], *free[:POSES]])]
    return max(trials(replace(request, grid=grid), tasks), default=0.0)
