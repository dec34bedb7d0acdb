"""What a person asked for: everything that decides the result, and nothing else."""

from __future__ import annotations

import math
from dataclasses import dataclass

from kirigami_studio.evaluate.trimming import KEEP, check_keep
from kirigami_studio.foundation.errors import AngleError, UsageError
from kirigami_studio.lattice.ratio_field import RatioField, check_grid
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.polish.panel_size import check_least
from kirigami_studio.polish.regularity import PREFERENCES

LARGEST_K = 1024
LARGEST_STEPS = 64
LARGEST_POLISH = 200
LARGEST_SEARCH = 8
#: What hosts ask for unless told otherwise: nearly converged from a generator sample.
POLISH_STEPS = 15


@dataclass(frozen=True, slots=True)
class Request:
    """One design task.  The same request gives the same candidates, bit by bit, unless a budget ends it.

    Attributes
    ----------
    target : Outline
    grid : (rows, columns) voids, 2..64 each
    phi : float, radians, in [0, pi)
        Deployment angle at which the sheet should show the target; 0 is the second compact state.
    k : int, 1..1024
        Number of candidates.
    seed : int, >= 0
    variant : str
        Name of a bundled generator variant, see :func:`kirigami_studio.generator.weights.variants`.
    steps : int, 1..64
        Evaluations of the network for each sample: Euler steps of the flow, then corrections, see
        :func:`kirigami_studio.generator.flow.integrate`.
    polish : int, 0..200
        Steps of the fit on the exact geometry that every candidate gets after sampling, in one or two rounds;
        0 leaves them as drawn.
    prefer : str
        What the fits prefer among nearly equal matches, see :data:`kirigami_studio.polish.regularity.PREFERENCES`.
    least_panel : float, unit cells, 0..0.9
        Panel edges and necks that fits try not to fall below; 0 for any size.
    search : int, 0..8
        Effort of a search for a design beyond the samples, started from the best of them; 0 does without.
    trim : bool
        Also fit the best designs to cover the target and trim their edge panels; the best trimmed one then comes first.
    keep : float, unit cells, 0.02..0.4
        Depth of the material that trimming leaves at every hinge.
    budget_seconds : float, > 0, optional
        Wall time after which the best so far are returned; the first batch is always scored.
    near : RatioField, optional
        A design of the same grid that the samples are to be like.
    nearness : float, 0..1 without 1
        How near they are to lie: the time of the flow at which they start from that design.  0 draws from noise alone,
        in that design's pose.
    """

    target: Outline
    grid: tuple[int, int] = (10, 10)
    phi: float = 0.0
    k: int = 32
    seed: int = 0
    variant: str = "balanced"
    steps: int = 4
    polish: int = 0
    prefer: str = "balanced"
    least_panel: float = 0.0
    search: int = 0
    trim: bool = False
    keep: float = KEEP
    budget_seconds: float | None = None
    near: RatioField | None = None
    nearness: float = 0.0

    def __post_init__(self) -> None:
        check_grid(*self.grid)
        if not 0.0 <= self.phi < math.pi:
            raise AngleError(f"The target angle must lie in [0, pi) radians, got {self.phi:g}; 0 is the usual choice.")
        for name, value, low, high in (
            ("candidates (k)", self.k, 1, LARGEST_K),
            ("sampling steps", self.steps, 1, LARGEST_STEPS),
            ("the seed", self.seed, 0, 2**63 - 1),
            ("polishing steps", self.polish, 0, LARGEST_POLISH),
            ("the search effort", self.search, 0, LARGEST_SEARCH),
        ):
            if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
                raise UsageError(f"The number for {name} must be a whole number from {low} to {high}, got {value!r}.")
        if self.prefer not in PREFERENCES:
            raise UsageError(f"A fit can prefer {', '.join(PREFERENCES)}, not {self.prefer!r}.")
        check_least(self.least_panel)
        check_keep(self.keep)
        self._check_near()
        budget = self.budget_seconds
        if budget is None:
            return
        if isinstance(budget, bool) or not isinstance(budget, int | float) or not 0.0 < budget < math.inf:
            raise UsageError(f"The time budget must be a finite number of seconds above 0, got {budget!r}.")

    def _check_near(self) -> None:
        nearness = self.nearness
        if isinstance(nearness, bool) or not isinstance(nearness, int | float) or not 0.0 <= nearness < 1.0:
            raise UsageError(f"The nearness must be a number from 0 to less than 1, got {nearness!r}.")
        if self.near is None:
            if nearness:
                raise UsageError("A nearness needs the design that the samples are to be near.")
        elif self.near.ratio.shape != tuple(self.grid):
            near, wanted = (" x ".join(map(str, grid)) for grid in (self.near.ratio.shape, self.grid))
            raise UsageError(f"Samples near a design have its grid of {near} voids, not {wanted}.")
