"""The request of a run: everything that decides its result, and what files repeat of it."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, field, replace
from typing import Any

from kirigami_studio import __version__
from kirigami_studio.evaluate.trimming import DEEP_KEEP, check_keep
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.settings import Setting, check
from kirigami_studio.lattice.ratio_field import check_grid
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.starts import AUTO as AUTO_START
from kirigami_studio.outlines.starts import USUAL_WEIGHT as USUAL_START_WEIGHT
from kirigami_studio.outlines.starts import StartShape
from kirigami_studio.polish.continuation import FitOptions
from kirigami_studio.polish.even_panels import even_weight
from kirigami_studio.polish.flat_sheet import first_sheet, width_in_cells
from kirigami_studio.polish.panel_size import check_least, least_in_cells
from kirigami_studio.polish.pinwheel import gap_in_cells
from kirigami_studio.polish.preferences import PREFERENCES
from kirigami_studio.polish.symmetry import KeptSymmetry
from kirigami_studio.settings.design import USUAL_GRID, DesignChoices, DesignSettings, RimRule, choices_of

#: Width of a sheet whose mouths have moved on a round start, at most, over that of the uniform one.
WIDER = 1.005


@dataclass(frozen=True, slots=True)
class Request(DesignChoices):
    """One design task.  The same request gives the same candidates, bit by bit, unless a budget ends it."""

    target: Outline
    #: (rows, columns); none leaves the choice to the run, see :meth:`resolved`
    grid: tuple[int, int] | None = USUAL_GRID
    #: unit cells, 0..0.9; panel edges and necks that no fit falls below, wherever a sheet near by allows that; 0 for
    #: any size.  What the material needs (``least_feature_mm``) is kept in any case, see :attr:`kept_size`.
    least_panel: float = field(default=0.0, kw_only=True)
    #: Also fit the best designs to cover the target and trim their edge panels; the best trimmed one then comes first
    trim: bool = field(
        default=False,
        kw_only=True,
        metadata=Setting(
            help="trim the best design to the target: adds trimmed_iou and trims cut.dxf", option="--trim"
        ).metadata,
    )
    #: unit cells, 0.02..0.4; depth of the material that trimming leaves at every hinge
    keep: float = field(default=DEEP_KEEP, kw_only=True)
    #: Whether designs that cover the target may be made where no closed sheet shows it, see :attr:`may_cover`
    covers: bool = field(default=True, kw_only=True)
    #: > 0, optional; wall time after which the best so far are returned; the first batch is always scored
    budget_seconds: float | None = field(
        default=None,
        kw_only=True,
        metadata=Setting(
            help="stop after this time with the best so far; results then depend on the machine (default: none)",
            least=0.0,
            above_least=True,
            code="request.budget_not_positive",
            option="--budget",
            metavar="SECONDS",
        ).metadata,
    )
    #: A design of the same grid that the samples are to be like; they have its rim unless an even one is asked for
    near: Sheet | None = field(default=None, kw_only=True)
    #: 0..1 without 1; how near they are to lie: the time of the flow at which they start from that design.  0 starts
    #: from noise alone, in that design's pose.
    nearness: float = field(
        default=0.0,
        kw_only=True,
        metadata=Setting(least=0.0, most=1.0, below_most=True, code="request.nearness_out_of_range").metadata,
    )
    #: > 0; width of the flat sheet
    width_mm: float = field(
        default=100.0,
        kw_only=True,
        metadata=Setting(least=0.0, above_least=True, code="request.width_not_positive").metadata,
    )
    #: >= 0; least panel edge and neck, between centre lines of cuts, that the material allows; 0 where that is not
    #: known
    least_feature_mm: float = field(
        default=0.0, kw_only=True, metadata=Setting(least=0.0, code="request.least_feature_out_of_range").metadata
    )
    #: >= 0; panel edge and neck that fits leave, so that connectors have their full width; smaller ones can still be
    #: cut
    room_mm: float = field(
        default=0.0, kw_only=True, metadata=Setting(least=0.0, code="request.least_feature_out_of_range").metadata
    )
    #: >= 0; width of a connector and of the cut, which sheets to be trimmed get room for; 0 where connectors need none
    span_mm: float = field(
        default=0.0, kw_only=True, metadata=Setting(least=0.0, code="request.least_feature_out_of_range").metadata
    )
    #: >= 0; how far apart pins stay, between their centres, of pinned sheets; 0 for others
    least_gap_mm: float = field(
        default=0.0, kw_only=True, metadata=Setting(least=0.0, code="request.least_gap_out_of_range").metadata
    )
    #: Whether pieces on pins lie in two layers.  They are cut one by one, so the sheet may be higher than wide
    two_layers: bool = field(default=False, kw_only=True)
    grid_chosen: bool = field(default=False, kw_only=True)  #: Whether the run chose the grid
    start_chosen: bool = field(default=False, kw_only=True)  #: Whether the run chose the start
    #: 0..64; designs that are fitted from the uniform sheet instead of sampled, in several poses: at most a quarter of
    #: all, and none without ``polish``, near another design, or on a budget.  By default two ways from a few poses.
    guided: int = field(default=8, kw_only=True, metadata=Setting(least=0, most=64).metadata)

    def __post_init__(self) -> None:
        if self.grid is not None:
            check_grid(*self.grid)
        check(self)
        if self.second is not None:
            self.second.check_on_the_way_to(self.phi)
        check_least(self.least_panel)
        check_keep(self.keep)
        if self.near is None:
            if self.nearness:
                raise UsageError("request.nearness_without_design")
        elif self.grid is not None and self.near.grid != tuple(self.grid):
            (rows, columns), near = self.grid, self.near
            raise UsageError(
                "request.near_other_grid", near_rows=near.rows, near_columns=near.columns, rows=rows, columns=columns
            )

    @classmethod
    def of(cls, target: Outline, settings: DesignSettings, **more: Any) -> Request:
        """Ask for a run for a target by settings of a project, with ``more`` fields."""
        return cls(target, None if settings.auto_grid else settings.grid, **choices_of(settings) | more)

    @property
    def settings(self) -> DesignSettings:
        """The settings that a project keeps of it.

        Raises
        ------
        UsageError
            Its grid is left to the run, which has not chosen it yet.
        """
        choices = choices_of(self)
        if self.start_chosen:
            choices["start"] = StartShape(AUTO_START, weight=self.start.weight)
        return DesignSettings(self.chosen_grid, self.grid_chosen, **choices)

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
    def may_cover(self) -> bool:
        """Whether its run makes covers, where these show more than closed sheets do.

        Like fits from the uniform sheet they do not depend on the seed, and are left out where these are.  A second
        target is for whole sheets, and pieces on pins have notches of their own.
        """
        return self.covers and self.fitted_starts > 0 and self.second is None and not self.pinned

    @property
    def may_cover_pieces(self) -> bool:
        """Whether covers may be made for pieces on pins that show the target badly.

        Only where layers lie on each other, of which pieces are cut one by one (``two_layers``); prints have one.
        """
        return self.covers and self.fitted_starts > 0 and self.second is None and self.two_layers and self.phi == 0.0

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

    @property
    def silhouette(self) -> Outline:
        """The target with its holes filled, for the fits of whole sheets."""
        return self.target.filled

    @property
    def trims(self) -> bool:
        """Whether its best designs are trimmed: where asked for, and for a target with holes.

        Pieces on pins are cut by rules of their own.
        """
        return self.trim or (bool(self.target.holes) and not self.pinned)

    @property
    def pinned(self) -> bool:
        """Whether its sheets have pins."""
        return self.least_gap_mm > 0.0

    @property
    def least_gap(self) -> float:
        """How far apart pins stay, unit cells; 0 for sheets without, and where the grid is open.

        A little more on other starts than rectangles: their width is known as soon as their mouths have moved.
        """
        if self.grid is None or not self.pinned:
            return 0.0
        width = width_in_cells(self.grid, self.start)
        return gap_in_cells(self.least_gap_mm, self.width_mm, width if self.start.is_plain else WIDER * width)

    def _in_cells(self, size_mm: float) -> float:
        """A size in unit cells; 0 where that is nearly a cell or more, for no design has it, or the grid is open."""
        if self.grid is None:
            return 0.0
        return least_in_cells(size_mm, self.width_mm, width_in_cells(self.grid, self.start))

    @property
    def fit_options(self) -> FitOptions:
        """What fits ask for beside the match."""
        return FitOptions(
            PREFERENCES[self.prefer],
            self.kept_size,
            self.rim is RimRule.FREE,
            self.even,
            self.symmetry,
            start=self.start,
            second=self.second,
            least_gap=self.least_gap,
        )

    @property
    def uniform(self) -> Sheet:
        """The uniform sheet of the chosen grid and the start, unfolded where that has hollows.

        Raises
        ------
        SheetError
            Panels fold over around a hollow on this grid.
        """
        return first_sheet(self.chosen_grid, self.start, free_rim=self.rim is RimRule.FREE)

    def resolved(self, grid: tuple[int, int]) -> Request:
        """The same request on the grid that was chosen for it; a grid that it has already stays."""
        return replace(self, grid=grid, grid_chosen=True) if self.grid is None else self

    def with_start(self, start: StartShape) -> Request:
        """The same request with the start that was chosen for it; one that it has already stays."""
        return replace(self, start=start, start_chosen=True) if self.start.is_auto else self


def as_in_paper(request: Request) -> Request:
    """The same request in the paper's setting: an even rim, no symmetry asked for, ranked by match alone."""
    return replace(request, symmetry=KeptSymmetry.NONE, rim=RimRule.EVEN, regular=0.0, guided=0)


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
    if request.start_chosen:
        known["start_choice"] = "auto"
    if request.kept_size:
        known["least_panel"] = f"{request.kept_size:g}"
    if request.least_gap:
        known["least_gap"] = f"{request.least_gap:g}"
    if request.trims:
        known["trim_keep"] = f"{request.keep:g}"
    if request.search:
        known["search"] = str(request.search)
    if request.fitted_starts:
        known["fitted_starts"] = str(request.fitted_starts)
    if request.near is not None:
        mouths = (
            b""
            if request.near.has_even_rim
            else request.near.rim.positions.tobytes() + request.near.rim.hinges.tobytes()
        )
        known["near"] = hashlib.sha256(request.near.field.ratio.tobytes() + mouths).hexdigest()[:16]
        known["nearness"] = f"{request.nearness:g}"
    if request.budget_seconds is not None:
        known["budget_seconds"] = f"{request.budget_seconds:g}"
    return known
