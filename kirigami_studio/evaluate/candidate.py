"""One scored design with its provenance: what the gallery shows, a run yields and a project keeps."""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import field as dataclass_field
from enum import Enum

from kirigami_studio.evaluate.score import Score
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.trimming import Trim
from kirigami_studio.lattice.ratio_field import RatioField


class Origin(Enum):
    """How a design came to be."""

    SAMPLED = "sampled"  #: by the generator for the target
    SEARCHED = "searched"  #: found by the search that follows the samples
    RESAMPLED = "resampled"  #: by the generator near another design
    EDITED = "edited"  #: changed by hand


@dataclass(frozen=True, slots=True)
class Candidate:
    """A ratio field, its score and where it came from.

    Attributes
    ----------
    field : RatioField
    score : Score
        Against the request's target at the request's angle.
    seed : int
        Seed of the run that sampled it.
    index : int
        Its place in that run's sampling order.
    polished : bool
        Whether a fit on the exact geometry has improved it after sampling.
    sampled_field : RatioField or None
        The field as it was sampled, where a fit has improved it.
    trim : Trim or None
        The same design fitted to cover the target and trimmed, where that was asked for; its score is its own.
    variant : str
        Generator that sampled it, "" where that is not known.
    origin : Origin
    made_with : tuple of (name, text)
        Settings of the run that sampled it, by their names in a provenance; empty where they are not known.  The same
        design is the same whatever is known of its run: this takes no part in comparisons.
    """

    field: RatioField
    score: Score
    seed: int
    index: int
    polished: bool = False
    sampled_field: RatioField | None = None
    trim: Trim | None = None
    variant: str = ""
    origin: Origin = Origin.SAMPLED
    made_with: tuple[tuple[str, str], ...] = dataclass_field(default=(), compare=False)

    @property
    def final_field(self) -> RatioField:
        """The ratios that are shown and cut: those that were fitted for trimming, if the candidate is trimmed."""
        return self.field if self.trim is None else self.trim.field

    @property
    def final_pose(self) -> Similarity:
        """Where the final field's layout lies on the target."""
        return self.score.transform if self.trim is None else self.trim.pose

    @property
    def final_phi(self) -> float:
        """Angle (radians) at which the final field shows the target."""
        return self.score.phi if self.trim is None else self.trim.phi
