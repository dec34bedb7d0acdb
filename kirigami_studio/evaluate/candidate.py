"""One scored design with its provenance: what the gallery shows, a run yields and a project keeps."""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import field as attribute
from enum import Enum, StrEnum

from kirigami_studio.evaluate.pins import least_gap_of
from kirigami_studio.evaluate.score import Score
from kirigami_studio.evaluate.second_target import SecondMatch
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.trimming import Trim
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.symmetry import Symmetry, symmetry_of


class Origin(Enum):
    """How a design came to be."""

    SAMPLED = "sampled"  #: by the generator for the target
    GUIDED = "guided"  #: fitted from the uniform sheet, led by the target itself
    SEARCHED = "searched"  #: found by the search that follows the samples
    RESAMPLED = "resampled"  #: by the generator near another design
    EDITED = "edited"  #: changed by hand
    COVERED = "covered"  #: fitted to cover the target, so that what sticks out of it is cut away


class Family(StrEnum):
    """How a design shows its target; the values stand on the command line."""

    CLOSED = "closed"  #: by the whole sheet
    COVER = "cover"  #: by a sheet that covers it, of which parts are cut away


@dataclass(frozen=True, slots=True)
class Candidate:
    """A sheet, its score and where it came from."""

    sheet: Sheet
    score: Score  #: against the request's target at the request's angle
    seed: int  #: seed of the run that sampled it
    index: int  #: its place in that run's sampling order
    polished: bool = False  #: whether a fit on the exact geometry has improved it after sampling
    sampled_sheet: Sheet | None = None  #: the sheet as it was sampled, where a fit has improved it
    #: The same design fitted to cover the target and trimmed, where that was asked for; its score is its own.
    trim: Trim | None = None
    variant: str = ""  #: generator that sampled it, "" where that is not known
    origin: Origin = Origin.SAMPLED
    #: How well its sheet, untrimmed, shows a second target on its way, where one was asked for.
    second: SecondMatch | None = None
    #: tuple of (name, text); settings of the run that sampled it, by their names in a provenance; empty where they are
    #: not known.  The same design is the same whatever is known of its run: this takes no part in comparisons.
    made_with: tuple[tuple[str, str], ...] = attribute(default=(), compare=False)

    @property
    def symmetry(self) -> Symmetry | None:
        """The largest symmetry that the sheet has."""
        return symmetry_of(self.sheet)

    @property
    def family(self) -> Family:
        """How it shows the target."""
        return Family.CLOSED if self.trim is None else Family.COVER

    @property
    def match(self) -> float:
        """Exact IoU, 0..1, of what is shown and cut: trimmed, if it is."""
        return self.score.iou_exact if self.trim is None else self.trim.iou

    @property
    def given_up(self) -> float:
        """Share of the flat sheet's area, 0..1, that is cut away."""
        return 0.0 if self.trim is None else self.trim.removed_share

    @property
    def least_gap(self) -> float:
        """Least distance, unit cells, of pins of the sheet that is shown and cut, if it has pins."""
        return least_gap_of(self.final_sheet)

    @property
    def final_sheet(self) -> Sheet:
        """The sheet that is shown and cut: the one that was fitted for trimming, if the candidate is trimmed."""
        return self.sheet if self.trim is None else self.trim.sheet

    @property
    def final_pose(self) -> Similarity:
        """Where the final sheet's layout lies on the target."""
        return self.score.transform if self.trim is None else self.trim.pose

    @property
    def final_phi(self) -> float:
        """Angle (radians) at which the final sheet shows the target."""
        return self.score.phi if self.trim is None else self.trim.phi
