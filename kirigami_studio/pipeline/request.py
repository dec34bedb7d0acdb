"""What a person asked for: everything that decides the result, and what files repeat of it."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, replace

from kirigami_studio import __version__
from kirigami_studio.evaluate.second_target import SecondTarget
from kirigami_studio.evaluate.trimming import KEEP, check_keep
from kirigami_studio.foundation.errors import AngleError, UsageError
from kirigami_studio.lattice.ratio_field import check_grid
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.starts import RECTANGLE, StartShape
from kirigami_studio.outlines.starts import USUAL_WEIGHT as USUAL_START_WEIGHT
from kirigami_studio.polish.continuation import Wishes
from kirigami_studio.polish.even_panels import even_weight
from kirigami_studio.polish.flat_sheet import first_sheet, width_in_cells
from kirigami_studio.polish.panel_size import check_least, least_in_cells
from kirigami_studio.polish.preferences import PREFERENCES
from kirigami_studio.polish.symmetry import SYMMETRIES

LARGEST_K = 1024
LARGEST_STEPS = 64
LARGEST_POLISH = 200
LARGEST_SEARCH = 8
LARGEST_GUIDED = 64
#: Two ways from a few poses.
GUIDED_STARTS = 8
#: The default of window and command line: nearly converged from a generator sample.
POLISH_STEPS = 15
#: The paper's grid.
USUAL_GRID = (10, 10)
#: Where cuts meet the rim: where fits move them, or evenly spaced as in the paper.
RIMS = ("free", "even")
#: Where a preference stands between match (0) and regular (1).
REGULAR = {"accuracy": 0.0, "balanced": 0.5, "regularity": 0.75, "calm": 1.0}


@dataclass(frozen=True, slots=True)
class Request:
    """One design task.  The same request gives the same candidates, bit by bit, unless a budget ends it.

    Attributes
    ----------
    target : Outline
    grid : (rows, columns) voids, 2..64 each, or None
        None leaves the choice to the run, see :meth:`resolved`.
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
        0 leaves them as sampled.
    prefer : str
        What the fits prefer among nearly equal matches, see :data:`kirigami_studio.polish.preferences.PREFERENCES`.
    least_panel : float, unit cells, 0..0.9
        Panel edges and necks that no fit falls below, wherever a sheet near by allows that; 0 for any size.  What the
        material needs (``least_feature_mm``) is kept in any case, see :attr:`kept_size`.
    search : int, 0..8
        Effort of a search for a design beyond the samples, started from the best of them; 0 does without.
    trim : bool
        Also fit the best designs to cover the target and trim their edge panels; the best trimmed one then comes first.
    keep : float, unit cells, 0.02..0.4
        Depth of the material that trimming leaves at every hinge.
    budget_seconds : float, > 0, optional
        Wall time after which the best so far are returned; the first batch is always scored.
    near : Sheet, optional
        A design of the same grid that the samples are to be like; they have its rim unless an even one is asked for.
    nearness : float, 0..1 without 1
        How near they are to lie: the time of the flow at which they start from that design.  0 starts from noise alone,
        in that design's pose.
    symmetry : str
        What designs have to keep, one of :data:`kirigami_studio.polish.symmetry.SYMMETRIES`.
    rim : str
        One of :data:`RIMS`.
    regular : float, 0..1
        What ranking prefers, from the best match (0) to even panels (1), see :mod:`kirigami_studio.pipeline.rank`.
    width_mm : float, > 0
        Width of the flat sheet.
    least_feature_mm : float, >= 0
        Least panel edge and neck, between centre lines of cuts, that the material allows; 0 where that is not known.
    room_mm : float, >= 0
        Panel edge and neck that fits leave, so that connectors have their full width; smaller ones can still be cut.
    grid_chosen : bool
        Whether the run chose the grid.
    guided : int, 0..64
        Designs that are fitted from the uniform sheet instead of sampled, in several poses: at most a quarter of all,
        and none without ``polish``, near another design, or on a budget.
    start : StartShape
        What the sheets look like while they are flat.
    second : SecondTarget, optional
        What they should also show on their way to ``phi``.
    """

    target: Outline
    grid: tuple[int, int] | None = USUAL_GRID
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
    near: Sheet | None = None
    nearness: float = 0.0
    symmetry: str = "auto"
    rim: str = "free"
    regular: float = 0.5
    width_mm: float = 100.0
    least_feature_mm: float = 0.0
    room_mm: float = 0.0
    grid_chosen: bool = False
    guided: int = GUIDED_STARTS
    start: StartShape = RECTANGLE
    second: SecondTarget | None = None

    def __post_init__(self) -> None:
        if self.grid is not None:
            check_grid(*self.grid)
        if not 0.0 <= self.phi < math.pi:
            raise AngleError("request.angle_out_of_range", phi=self.phi)
        for code, value, least, most in (
            ("request.k_out_of_range", self.k, 1, LARGEST_K),
            ("request.steps_out_of_range", self.steps, 1, LARGEST_STEPS),
            ("request.seed_out_of_range", self.seed, 0, 2**63 - 1),
            ("request.polish_out_of_range", self.polish, 0, LARGEST_POLISH),
            ("request.search_out_of_range", self.search, 0, LARGEST_SEARCH),
            ("request.guided_out_of_range", self.guided, 0, LARGEST_GUIDED),
        ):
            if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
                raise UsageError(code, value=value, least=least, most=most)
        if self.prefer not in PREFERENCES:
            raise UsageError("request.unknown_preference", prefer=self.prefer, choices=", ".join(PREFERENCES))
        if self.symmetry not in SYMMETRIES:
            raise UsageError("request.unknown_symmetry", symmetry=self.symmetry, choices=", ".join(SYMMETRIES))
        if self.rim not in RIMS:
            raise UsageError("request.unknown_rim", rim=self.rim, choices=", ".join(RIMS))
        if not _is_number(self.regular) or not 0.0 <= self.regular <= 1.0:
            raise UsageError("request.regular_out_of_range", regular=self.regular)
        if not _is_number(self.width_mm) or not 0.0 < self.width_mm < math.inf:
            raise UsageError("request.width_not_positive", width_mm=self.width_mm)
        for size in (self.least_feature_mm, self.room_mm):
            if not _is_number(size) or not 0.0 <= size < math.inf:
                raise UsageError("request.least_feature_out_of_range", least_mm=size)
        if self.second is not None:
            self.second.check_on_the_way_to(self.phi)
        check_least(self.least_panel)
        check_keep(self.keep)
        self._check_near()
        budget = self.budget_seconds
        if budget is None:
            return
        if not _is_number(budget) or not 0.0 < budget < math.inf:
            raise UsageError("request.budget_not_positive", budget=budget)

    @property
    def chosen_grid(self) -> tuple[int, int]:
        """The grid of (rows, columns) voids.

        Raises
        ------
        UsageError
            It is left to the run, which has not chosen it yet.
        """
        if self.grid is None:
            raise UsageError("request.grid_not_chosen")
        return self.grid

    @property
    def fitted_starts(self) -> int:
        """Most designs that are fitted from the uniform sheet: a shape may offer fewer poses to begin with."""
        possible = self.polish and self.near is None and self.budget_seconds is None
        return min(self.guided, self.k // 4) if possible else 0

    @property
    def even(self) -> float:
        """Weight of even panels in fits, see :func:`kirigami_studio.polish.even_panels.even_weight`."""
        return even_weight(self.regular)

    @property
    def kept_size(self) -> float:
        """Edges and necks (unit cells) that fits do not fall below: :attr:`kept_when_trimmed`, or more if connectors
        need it.
        """
        return max(self.kept_when_trimmed, self._in_cells(self.room_mm))

    @property
    def kept_when_trimmed(self) -> float:
        """Edges and necks (unit cells) that sheets to be trimmed do not fall below: ``least_panel``, or more if the
        material needs it.

        These sheets cover the target, notches and all, and have no room to give away.
        """
        return max(self.least_panel, self._in_cells(self.least_feature_mm))

    def _in_cells(self, size_mm: float) -> float:
        """A size in unit cells; 0 where that is nearly a cell or more, for no design has it, or the grid is open."""
        if self.grid is None:
            return 0.0
        return least_in_cells(size_mm, self.width_mm, width_in_cells(self.grid, self.start))

    @property
    def wishes(self) -> Wishes:
        """What fits ask for beside the match."""
        return Wishes(
            PREFERENCES[self.prefer],
            self.kept_size,
            self.rim == "free",
            self.even,
            self.symmetry,
            start=self.start,
            second=self.second,
        )

    @property
    def uniform(self) -> Sheet:
        """The uniform sheet of the chosen grid and the start, unfolded where that has hollows.

        Raises
        ------
        SheetError
            Panels fold over around a hollow on this grid.
        """
        return first_sheet(self.chosen_grid, self.start, free_rim=self.rim == "free")

    def resolved(self, grid: tuple[int, int]) -> Request:
        """The same request on the grid that was chosen for it; a grid that it has already stays."""
        return replace(self, grid=grid, grid_chosen=True) if self.grid is None else self

    def _check_near(self) -> None:
        nearness = self.nearness
        if not _is_number(nearness) or not 0.0 <= nearness < 1.0:
            raise UsageError("request.nearness_out_of_range", nearness=nearness)
        if self.near is None:
            if nearness:
                raise UsageError("request.nearness_without_design")
        elif self.grid is not None and self.near.grid != tuple(self.grid):
            (rows, columns), near = self.grid, self.near
            raise UsageError(
                "request.near_other_grid", near_rows=near.rows, near_columns=near.columns, rows=rows, columns=columns
            )


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and not math.isnan(value)


def as_in_paper(request: Request) -> Request:
    """The same request in the paper's setting: an even rim, no symmetry asked for, ranked by match alone."""
    return replace(request, symmetry="none", rim="even", regular=0.0, guided=0)


def provenance(request: Request, digest: str) -> dict[str, str]:
    """Describe a run so that it can be repeated, for projects and exported files; what was not asked for is left out.

    The generator's weights have the SHA-256 ``digest``.

    A design that the samples are near is named by the start of the SHA-256 of its ratios, row by row, as doubles, and
    of the places of its mouths where its rim is not even.
    """
    known = {
        "application": f"kirigami-studio {__version__}",
        "model": request.variant,
        "model_sha256": digest,
        "k": str(request.k),
        "steps": str(request.steps),
        "polish": str(request.polish),
    }
    if request.polish or request.search:
        known["prefer"] = request.prefer
    known |= {"symmetry": request.symmetry, "rim": request.rim, "regular": f"{request.regular:g}"}
    if not request.start.is_plain:
        known["start"] = request.start.name
    if request.start.weight != USUAL_START_WEIGHT:
        known["start_weight"] = f"{request.start.weight:g}"
    if request.start.outline is not None:
        known["start_sha256"] = request.start.digest
    if request.second is not None:
        known |= {
            "second_target": request.second.outline.name,
            "second_target_sha256": request.second.digest,
            "second_target_deg": f"{math.degrees(request.second.phi):g}",
            "second_target_weight": f"{request.second.weight:g}",
        }
    if request.grid_chosen:
        known["grid_choice"] = "auto"
    if request.kept_size:
        known["least_panel"] = f"{request.kept_size:g}"
    if request.trim:
        known["trim_keep"] = f"{request.keep:g}"
    if request.search:
        known["search"] = str(request.search)
    if request.fitted_starts:
        known["fitted_starts"] = str(request.fitted_starts)
    if request.near is not None:
        mouths = b"" if request.near.has_even_rim else request.near.rim.positions.tobytes()
        known["near"] = hashlib.sha256(request.near.field.ratio.tobytes() + mouths).hexdigest()[:16]
        known["nearness"] = f"{request.nearness:g}"
    if request.budget_seconds is not None:
        known["budget_seconds"] = f"{request.budget_seconds:g}"
    return known
