"""Settings of a search for designs, shared by requests, projects and the window."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from enum import StrEnum
from typing import Any, Literal, TypedDict

from kirigami_studio.evaluate.second_target import SecondTarget
from kirigami_studio.foundation.errors import AngleError, GridError
from kirigami_studio.foundation.settings import Choice, Setting, check
from kirigami_studio.foundation.words import mark
from kirigami_studio.lattice.ratio_field import check_grid
from kirigami_studio.outlines.starts import RECTANGLE, StartShape
from kirigami_studio.polish.preferences import FitPreference
from kirigami_studio.polish.symmetry import KeptSymmetry

#: Steps of a fit unless others are asked for: nearly converged from a generator sample.
POLISH_STEPS = 15
#: The paper's grid.
USUAL_GRID = (10, 10)
#: Where a preference stands between match (0) and regular (1).
REGULAR = {
    FitPreference.ACCURACY: 0.0,
    FitPreference.BALANCED: 0.5,
    FitPreference.REGULARITY: 0.75,
    FitPreference.CALM: 1.0,
}


class RimRule(StrEnum):
    """Where cuts meet the rim; the values are the names on the command line and in files."""

    FREE = "free"  #: where fits move them
    EVEN = "even"  #: evenly spaced, as in the paper


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignChoices:
    """Choices of a search, whatever its grid and its target.

    Attributes
    ----------
    phi : float, radians, in [0, pi)
        Angle at which the sheet should show the target; 0 is the second compact state.
    k : int, 1..1024
        Number of candidates.
    seed : int, >= 0
        The same seed gives the same designs.
    variant : str
        Name of a bundled generator variant, see :func:`kirigami_studio.generator.weights.variants`.
    steps : int, 1..64
        Evaluations of the network for each sample: Euler steps of the flow, then corrections, see
        :func:`kirigami_studio.generator.flow.integrate`.
    polish : int, 0..200
        Steps of the fit on the exact geometry that every candidate gets after sampling, in one or two rounds;
        0 leaves them as sampled.
    prefer : FitPreference
        What the fits prefer among nearly equal matches.
    search : int, 0..8
        Effort of a search for a design beyond the samples, started from the best of them; 0 does without.
    symmetry : KeptSymmetry
        What designs have to keep.
    rim : RimRule
        Where cuts meet the rim: where fits move them, or evenly spaced as in the paper.
    regular : float, 0..1
        What ranking prefers, from the best match (0) to even panels (1), see :mod:`kirigami_studio.pipeline.rank`.
    start : StartShape
        What the sheets look like while they are flat.
    second : SecondTarget, optional
        What they should also show on their way to ``phi``.

    Raises
    ------
    AngleError, UsageError
        With the number that does not fit.
    """

    phi: float = field(
        default=0.0,
        metadata=Setting(
            about=mark("Deployment angle at which the sheet matches the target, in degrees; 0° is fully turned."),
            help="deployment angle in radians (0.5, pi/3) or degrees (30deg); pi is the flat sheet",
            least=0.0,
            most=math.pi,
            below_most=True,
            code="request.angle_out_of_range",
            error=AngleError,
            always_written=True,
            undo=mark("Change the target angle"),
            label=mark("Ang&le"),
            spoken=mark("Target angle in degrees"),
            widget="targetAngle",
            scale=180.0 / math.pi,
            high=179.0,
            decimals=1,
            unit="°",
            option="--phi",
            metavar="ANGLE",
        ).metadata,
    )
    k: int = field(
        default=32,
        metadata=Setting(
            about=mark("Number of designs to generate and compare (1 to {most})."),
            least=1,
            most=1024,
            code="request.k_out_of_range",
            always_written=True,
            undo=mark("Change the number of designs"),
            label=mark("Desig&ns"),
            widget="candidates",
            option="--k",
        ).metadata,
    )
    seed: int = field(
        default=0,
        metadata=Setting(
            about=mark("Random seed. The same seed gives the same designs."),
            least=0,
            most=2**63 - 1,
            code="request.seed_out_of_range",
            always_written=True,
            undo=mark("Change the seed"),
            label=mark("&Seed"),
            high=2**31 - 1,
            option="--seed",
        ).metadata,
    )
    symmetry: KeptSymmetry = field(
        default=KeptSymmetry.AUTO,
        metadata=Setting(
            help="symmetry that designs keep; auto: the target's own",
            code="request.unknown_symmetry",
            always_written=True,
            undo=mark("Change the symmetry"),
            label=mark("S&ymmetric"),
            spoken=mark("Symmetry of the designs"),
            choices=(
                Choice(
                    KeptSymmetry.AUTO, mark("Auto"), mark("Symmetric designs for symmetric targets, beside free ones.")
                ),
                Choice(KeptSymmetry.NONE, mark("Off"), mark("Ignore the target's symmetry.")),
                Choice(
                    KeptSymmetry.MIRROR,
                    mark("Mirror"),
                    mark("Every design is its own mirror image, as a sketched heart is meant to be."),
                ),
                Choice(
                    KeptSymmetry.TURN,
                    mark("Turn"),
                    mark("Every design looks the same after a half or quarter turn."),
                ),
            ),
            option="--symmetry",
        ).metadata,
    )
    rim: RimRule = field(
        default=RimRule.FREE,
        metadata=Setting(
            help="where cuts meet the rim: free moves them to fit, even spaces them as in the paper",
            code="request.unknown_rim",
            always_written=True,
            undo=mark("Change the rim"),
            label=mark("Rim"),
            spoken=mark("Rim: where cuts meet the sheet's sides"),
            choices=(
                Choice(RimRule.FREE, mark("Free"), mark("Cuts meet the sheet's sides where that helps the match.")),
                Choice(RimRule.EVEN, mark("Even"), mark("Cuts meet the sheet's sides at even distances.")),
            ),
            option="--rim",
        ).metadata,
    )
    regular: float = field(
        default=0.5,
        metadata=Setting(
            about=mark(
                "Left: the closest match. Right: even panels. Moving it ranks the designs, letting it go fits them "
                "again."
            ),
            help="what ranking prefers, from 0, the best match, to 1, even panels (default: that of --prefer, 0.5)",
            least=0.0,
            most=1.0,
            code="request.regular_out_of_range",
            always_written=True,
            undo=mark("Change match or regular"),
            spoken=mark("Match or regular"),
            option="--regular",
            metavar="0..1",
            open_unless_given=True,
        ).metadata,
    )
    variant: str = field(
        default="balanced",
        metadata=Setting(
            help="generator variant, see 'kirigami-studio variants'",
            code="settings.variant_not_a_name",
            always_written=True,
            undo=mark("Change the model"),
            label=mark("&Model"),
            spoken=mark("Generator variant"),
            choices=(
                Choice("prior", mark("Varied"), mark("Trained on random sheets only: most variety, rougher layouts.")),
                Choice("accuracy", mark("For match"), mark("Tuned for the closest match.")),
                Choice(
                    "regularity",
                    mark("For evenness"),
                    mark("Tuned for even panels that are easy to cut; slightly lower match."),
                ),
                Choice("balanced", mark("For both"), mark("Tuned for both match and even panels. Recommended.")),
                Choice(
                    "paper",
                    mark("As in the paper"),
                    mark("The paper's own way: a small U-Net, trained on 5000 designs. To compare with."),
                ),
                Choice(
                    "paper-accuracy",
                    mark("Paper, for match"),
                    mark("As in the paper, tuned by its GRPO for the closest match."),
                ),
                Choice(
                    "paper-balanced",
                    mark("Paper, for both"),
                    mark("As in the paper, tuned by its GRPO for match and even panels."),
                ),
                Choice(
                    "paper-regularity",
                    mark("Paper, for evenness"),
                    mark("As in the paper, tuned by its GRPO for even panels."),
                ),
            ),
            option="--variant",
        ).metadata,
    )
    steps: int = field(
        default=4,
        metadata=Setting(
            help="sampling steps: half Euler steps, half corrections",
            least=1,
            most=64,
            code="request.steps_out_of_range",
            always_written=True,
            undo=mark("Change the number of sampling steps"),
            option="--steps",
        ).metadata,
    )
    polish: int = field(
        default=POLISH_STEPS,
        metadata=Setting(
            help="fit every design on the exact geometry (default: yes)",
            least=0,
            most=200,
            code="request.polish_out_of_range",
            always_written=True,
            undo=mark("Change the polish setting"),
            label=mark("Pol&ish"),
            choices=(
                Choice(0, mark("Off"), mark("Keep designs as generated.")),
                Choice(5, mark("Light"), mark("A quick fit: most of the improvement, close to the generated design.")),
                Choice(POLISH_STEPS, mark("Full"), mark("Nearly converged. Recommended.")),
                Choice(60, mark("Deep"), mark("Continues until nothing improves; for sharp corners and thin arms.")),
            ),
            option="--polish",
            switched=True,
        ).metadata,
    )
    prefer: FitPreference = field(
        default=FitPreference.BALANCED,
        metadata=Setting(
            help="what polishing prefers among nearly equal matches, and a preset of --regular: 0, 0.5, 0.75, 1",
            code="request.unknown_preference",
            always_written=True,
            undo=mark("Change the polish preference"),
            label=mark("&Prefer"),
            spoken=mark("What polishing prefers"),
            choices=(
                Choice(FitPreference.ACCURACY, mark("Match"), mark("The closest match, regardless of panel shape.")),
                Choice(
                    FitPreference.BALANCED,
                    mark("Balanced"),
                    mark("Recommended: nearly as close, with smoother ratios (lower TV)."),
                ),
                Choice(
                    FitPreference.REGULARITY,
                    mark("Smooth"),
                    mark("Lower TV than Balanced, at a slightly lower match."),
                ),
                Choice(FitPreference.CALM, mark("Smoothest"), mark("The lowest TV, at a lower match.")),
            ),
            option="--prefer",
        ).metadata,
    )
    search: int = field(
        default=0,
        metadata=Setting(
            about=mark(
                "Search for one more design, from more poses and in more ways. Takes a few seconds; helps with thin "
                "arms and notches."
            ),
            help="also search for a better design, effort 1 to 8 (default 0: no search; --search alone: 1)",
            least=0,
            most=8,
            code="request.search_out_of_range",
            always_written=True,
            undo=mark("Change the search setting"),
            label=mark("Tr&y harder"),
            spoken=mark("Try harder: search for one more design"),
            option="--search",
            metavar="EFFORT",
            alone=1,
        ).metadata,
    )
    start: StartShape = field(default=RECTANGLE, metadata=Setting(undo=mark("Change the start outline")).metadata)
    second: SecondTarget | None = field(default=None, metadata=Setting(undo=mark("Change the second target")).metadata)

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True, slots=True)
class DesignSettings(DesignChoices):
    """How candidates are searched for, as a project keeps it.

    Attributes
    ----------
    grid : (rows, columns) voids, 2..64 each
        Where ``auto_grid`` is set, the last one that was chosen.
    auto_grid : bool
        Whether every run chooses its grid itself.

    Raises
    ------
    GridError, AngleError, UsageError
        With the number that does not fit.
    """

    grid: tuple[int, int] = field(default=USUAL_GRID, metadata=Setting(undo=mark("Change the grid")).metadata)
    auto_grid: bool = field(
        default=True,
        metadata=Setting(
            about=mark("Choose the grid for each target: as coarse as its shape allows."),
            always_written=True,
            undo=mark("Change the grid"),
            spoken=mark("Choose the grid automatically"),
            widget="autoGrid",
        ).metadata,
    )

    def __post_init__(self) -> None:
        grid = tuple(self.grid)
        if len(grid) != 2 or not all(isinstance(count, int) and not isinstance(count, bool) for count in grid):
            raise GridError("settings.grid_not_two_numbers", value=self.grid)
        check_grid(*grid)
        object.__setattr__(self, "grid", grid)
        check(self)


class DesignChange(TypedDict, total=False):
    """Types of values for :class:`DesignChoices`, whose choices may be given by their words."""

    phi: float
    k: int
    seed: int
    symmetry: KeptSymmetry | Literal["auto", "none", "mirror", "turn"]
    rim: RimRule | Literal["free", "even"]
    regular: float
    variant: str
    steps: int
    polish: int
    prefer: FitPreference | Literal["accuracy", "balanced", "regularity", "calm"]
    search: int


def choices_of(one: DesignChoices) -> dict[str, Any]:
    """Return the choices of a request or of a project's settings, to make one of the other."""
    return {entry.name: getattr(one, entry.name) for entry in fields(DesignChoices)}


def with_balance(given: dict[str, Any]) -> dict[str, Any]:
    """Choices in which a balance that was left open is that of what fits are to prefer."""
    if given.get("regular") is not None:
        return given
    return {
        **given,
        "regular": REGULAR.get(given.get("prefer", FitPreference.BALANCED), REGULAR[FitPreference.BALANCED]),
    }


def chosen_settings(grid: tuple[int, int] | None, choices: dict[str, Any], **more: Any) -> DesignSettings:
    """Make the settings of a search of choices by name; without a grid every run chooses one."""
    fixed: dict[str, Any] = {} if grid is None else {"grid": grid}
    return DesignSettings(**fixed, auto_grid=grid is None, **with_balance(choices), **more)
