"""The one frozen value that the window shows, the history keeps and the project file holds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.project.settings import DesignSettings, FabricationSettings
from kirigami_studio.target.outline import Outline


def _nothing_known() -> Mapping[str, str]:
    return MappingProxyType({})


@dataclass(frozen=True, slots=True)
class Document:
    """Everything a person made in one project.

    Attributes
    ----------
    target : Outline or None
    settings : DesignSettings
        For the next run; the candidates may stem from an earlier one.
    candidates : tuple of Candidate
        Of one run, all of one grid, best first.
    chosen : int or None
        Index of the candidate on the stage.
    fabrication : FabricationSettings
    provenance : mapping of str to str, read-only
        Where the candidates come from: version of the program, name and hash of the model.

    Raises
    ------
    ProjectError
        Candidates without a target or of different grids, or a choice that is not among them.
    """

    target: Outline | None = None
    settings: DesignSettings = field(default_factory=DesignSettings)
    candidates: tuple[Candidate, ...] = ()
    chosen: int | None = None
    fabrication: FabricationSettings = field(default_factory=FabricationSettings)
    provenance: Mapping[str, str] = field(default_factory=_nothing_known, hash=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "candidates", tuple(self.candidates))
        object.__setattr__(self, "provenance", MappingProxyType(dict(self.provenance)))
        if self.candidates and self.target is None:
            raise ProjectError("A project with designs needs the target that they were made for.")
        grids = sorted({candidate.field.ratio.shape for candidate in self.candidates})
        if len(grids) > 1:
            sizes = " and ".join(f"{rows} x {columns}" for rows, columns in grids[:2])
            raise ProjectError(f"The designs of a project must share one grid, got {sizes}.")
        count = len(self.candidates)
        if self.chosen is not None and not (isinstance(self.chosen, int) and 0 <= self.chosen < count):
            raise ProjectError(f"Design number {self.chosen} was chosen, but the project holds {count}.")

    @property
    def candidate(self) -> Candidate | None:
        """The chosen candidate, or None."""
        return None if self.chosen is None else self.candidates[self.chosen]
