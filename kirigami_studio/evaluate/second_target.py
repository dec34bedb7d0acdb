"""A second target, for an angle between flat and that of the first target.

The flat sheet itself needs none: its outline is the start, and is met exactly.  What a second target asks for has its
own size, place and rotation, and a weight: the design loses so much worth for each share of match that it lacks there.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from kirigami_studio.evaluate.siou import ShapeMatch, matches_in_poses, siou_of_many
from kirigami_studio.foundation.errors import AngleError
from kirigami_studio.foundation.settings import Setting, check
from kirigami_studio.foundation.words import mark
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.outlines.outline import Outline

#: Angle (radians) and weight unless others are asked for.
USUAL_PHI, USUAL_WEIGHT = math.radians(45.0), 0.3


@dataclass(frozen=True, slots=True)
class SecondTarget:
    """Another target of a sheet on its way.

    Attributes
    ----------
    outline : Outline
        Its holes are filled.
    phi : float, radians, above 0 and below pi
        Angle at which the sheet should show it.
    weight : float, above 0, up to 4
        Weight of its match, where that of the first target has 1: it may count four times as much.

    Raises
    ------
    AngleError, UsageError
        An angle or a weight out of range.
    """

    outline: Outline
    phi: float = field(
        default=USUAL_PHI,
        metadata=Setting(
            least=0.0,
            above_least=True,
            most=math.pi,
            below_most=True,
            code="second_target.angle_out_of_range",
            error=AngleError,
            help="angle at which it should show the second target, above --phi",
            label=mark("At"),
            spoken=mark("Angle of the second target in degrees"),
            widget="secondAngle",
            scale=180.0 / math.pi,
            step=5.0,
            decimals=1,
            unit="°",
            option="--at-deg",
            keyword="also_phi",
            metavar="DEGREES",
            open_unless_given=True,
        ).metadata,
    )
    weight: float = field(
        default=USUAL_WEIGHT,
        metadata=Setting(
            about=mark("How much the second target counts; the first has 1 ({low:g} to {most:g})."),
            least=0.0,
            above_least=True,
            most=4.0,
            code="second_target.weight_out_of_range",
            help="weight of the second target, that of the first being 1",
            label=mark("&Weight"),
            spoken=mark("Weight of the second target"),
            widget="secondWeight",
            low=0.01,
            step=0.1,
            option="--weight",
            keyword="also_weight",
            metavar="WEIGHT",
            open_unless_given=True,
        ).metadata,
    )

    def __post_init__(self) -> None:
        check(self)
        object.__setattr__(self, "outline", self.outline.filled)  # a sheet on its way has none of the target's holes

    def check_on_the_way_to(self, phi: float) -> None:
        """Refuse a second target that the sheet does not pass before it is at ``phi`` (radians).

        Raises
        ------
        AngleError
            Its angle is not larger.
        """
        if self.phi <= phi:
            raise AngleError("second_target.not_on_the_way", second=math.degrees(self.phi), first=math.degrees(phi))

    @property
    def digest(self) -> str:
        """The start of the SHA-256 of its points: names of files say little."""
        return hashlib.sha256(self.outline.points.tobytes()).hexdigest()[:16]


@dataclass(frozen=True, slots=True)
class SecondMatch:
    """How well a design shows its second target."""

    target: SecondTarget
    match: ShapeMatch  #: under the similarity that suits that angle best

    @property
    def price(self) -> float:
        """The IoU that the design lacks there, times the weight."""
        return self.target.weight * (1.0 - self.match.iou_exact)


def matched_again(deployment: Deployment, before: SecondMatch | None) -> SecondMatch | None:
    """How well a changed design shows the second target that it had, if it had one."""
    return second_matches([deployment], None if before is None else before.target)[0]


def second_matches(deployments: Sequence[Deployment], target: SecondTarget | None) -> list[SecondMatch] | list[None]:
    """How well designs of one grid show a second target; None for each where there is none."""
    if target is None:
        return [None] * len(deployments)
    outlines = [deployment.outline(target.phi) for deployment in deployments]
    return [SecondMatch(target, match) for match in siou_of_many(outlines, target.outline)]


def confirmed_match(deployment: Deployment, read: SecondMatch) -> SecondMatch:
    """Keep a match from a file that is the design's in its pose; else match the design again."""
    target, match = read.target, read.match
    (own,) = matches_in_poses([deployment.outline(target.phi)], target.outline, [match.transform])
    if own is not None and own.is_near(match):
        return read
    return SecondMatch(target, siou_of_many([deployment.outline(target.phi)], target.outline)[0])
