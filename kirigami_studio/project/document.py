"""The one frozen value that the window shows, the history keeps and the project file holds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.export.artwork import Artwork
from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.foundation.frozen_mapping import FrozenMapping
from kirigami_studio.outlines.drawing import NO_GUIDES, Guides
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.labels import Label, run_labels
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings

#: Guides lie within this distance of the middle of the board, mm, and there are no more of them along one axis.
FARTHEST_GUIDE, MOST_GUIDES = 1e6, 1000
#: Parts of one target, each a sheet of its own.
MOST_PARTS = 24
#: A void by its row and column.
Void = tuple[int, int]


class Mark(Enum):
    """The user's opinion of a candidate."""

    NONE = "none"
    PINNED = "pinned"
    REJECTED = "rejected"


@dataclass(frozen=True, slots=True)
class Document:
    """Everything the user made in one project.

    Raises
    ------
    ProjectError
        Candidates without a target or of different grids, a choice that is not among them, more or fewer marks or
        labels than candidates, a locked void that their grid does not have, guides that no board has, or parts without
        a target.
    """

    target: Outline | None = None
    #: For the next run; the candidates may stem from an earlier one.
    settings: DesignSettings = field(default_factory=DesignSettings)
    candidates: tuple[Candidate, ...] = ()  #: of one run or of several runs for one target, all of one grid, best first
    chosen: int | None = None  #: index of the candidate on the stage
    fabrication: FabricationSettings = field(default_factory=FabricationSettings)
    #: read-only; where the candidates come from, of all runs together; each candidate knows its own run.
    provenance: Mapping[str, str] = field(default_factory=FrozenMapping, hash=False)
    marks: tuple[Mark, ...] = ()  #: one for each candidate, pinned, rejected or neither; left out, none of them has any
    #: frozenset of (row, column); voids whose ratio a change by hand leaves as it is.
    locked: frozenset[Void] = frozenset()
    artwork: Artwork | None = None  #: what is printed on the sheet
    #: The objects of the drawing board that the target was made of, the lowest first; none for a target that is one
    #: object by itself.
    drawing: tuple[Outline, ...] = ()
    guides: Guides = NO_GUIDES  #: mm; of the drawing board: x of the upright ones and y of the level ones, ascending
    labels: tuple[Label, ...] = ()  #: name and note of each candidate; left out, they are named as those of one run
    runs: int = 0  #: how many runs have named designs; the next one begins with another letter
    #: The other parts of a target of several separate pieces, each with its designs and without others, in order.
    other_parts: tuple[Document, ...] = ()
    part: int = 0  #: place of this one among all parts
    #: (x, y); area centroid of this part in the drawing of all, in the unit of the target's size, y up.
    place: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "candidates", tuple(self.candidates))
        object.__setattr__(self, "drawing", tuple(self.drawing))
        self._check_guides()
        object.__setattr__(self, "provenance", FrozenMapping(self.provenance))
        if self.candidates and self.target is None:
            raise ProjectError("project.designs_without_target")
        grids = sorted({candidate.sheet.grid for candidate in self.candidates})
        if len(grids) > 1:
            (rows, columns), (other_rows, other_columns) = grids[:2]
            raise ProjectError(
                "project.grids_differ",
                rows=rows,
                columns=columns,
                other_rows=other_rows,
                other_columns=other_columns,
            )
        count = len(self.candidates)
        if self.chosen is not None and not (isinstance(self.chosen, int) and 0 <= self.chosen < count):
            raise ProjectError("project.no_such_design", index=self.chosen, designs=count)
        self._check_marks(count)
        self._check_labels(count)
        self._check_parts()

    def _check_marks(self, count: int) -> None:
        marks = tuple(self.marks) or (Mark.NONE,) * count
        if len(marks) != count:
            raise ProjectError("project.marks_do_not_match", marks=len(marks), designs=count)
        object.__setattr__(self, "marks", marks)
        object.__setattr__(self, "locked", frozenset(self.locked))
        rows, columns = self.candidates[0].sheet.grid if self.candidates else (0, 0)
        outside = sorted(void for void in self.locked if not (0 <= void[0] < rows and 0 <= void[1] < columns))
        if outside:
            row, column = outside[0]
            raise ProjectError("project.no_such_void", row=row, column=column, rows=rows, columns=columns)

    def _check_guides(self) -> None:
        upright, level = (tuple(sorted({float(at) for at in places})) for places in self.guides)
        if not all(abs(at) <= FARTHEST_GUIDE for at in (*upright, *level)):
            raise ProjectError("project.guide_too_far", limit=FARTHEST_GUIDE)
        if max(len(upright), len(level)) > MOST_GUIDES:
            raise ProjectError("project.too_many_guides", limit=MOST_GUIDES)
        object.__setattr__(self, "guides", (upright, level))

    def _check_labels(self, count: int) -> None:
        object.__setattr__(self, "runs", max(self.runs, 1 if count else 0))
        labels = tuple(self.labels) or run_labels(max(self.runs - 1, 0), count)
        if len(labels) != count:
            raise ProjectError("project.labels_do_not_match", labels=len(labels), designs=count)
        object.__setattr__(self, "labels", labels)

    def _check_parts(self) -> None:
        others = tuple(self.other_parts)
        object.__setattr__(self, "other_parts", others)
        if not (isinstance(self.part, int) and 0 <= self.part <= len(others) < MOST_PARTS):
            raise ProjectError("project.no_such_part", number=self.part, parts=len(others) + 1, limit=MOST_PARTS)
        if others and (self.target is None or any(one.target is None or one.other_parts for one in others)):
            raise ProjectError("project.part_without_target")
        if self.place is not None and not all(math.isfinite(value) for value in self.place):
            raise ProjectError("project.part_nowhere", x=self.place[0], y=self.place[1])

    @property
    def parts(self) -> tuple[Document, ...]:
        """All parts of the target as they were left, this one among them."""
        alone = replace(self, other_parts=(), part=0) if self.other_parts else self
        return (*self.other_parts[: self.part], alone, *self.other_parts[self.part :])

    @property
    def drawn_by_hand(self) -> bool:
        """Whether the target holds work of the drawing board: several objects, or one drawn or changed there."""
        return bool(self.drawing) or (self.target is not None and self.target.place is not None)

    @property
    def candidate(self) -> Candidate | None:
        """The chosen candidate, or None."""
        return None if self.chosen is None else self.candidates[self.chosen]

    @property
    def label(self) -> Label | None:
        """Name and note of the chosen candidate, or None."""
        return None if self.chosen is None else self.labels[self.chosen]

    @property
    def named_candidates(self) -> dict[str, Candidate]:
        """The candidates by their names, best first."""
        return {label.text: one for label, one in zip(self.labels, self.candidates, strict=True)}

    def label_of(self, candidate: Candidate) -> Label | None:
        """Name and note of a candidate, None for one that is not among them."""
        found = next((place for place, one in enumerate(self.candidates) if one is candidate), None)
        if found is None and candidate in self.candidates:
            found = self.candidates.index(candidate)
        return None if found is None else self.labels[found]

    def name_of(self, candidate: Candidate) -> str:
        """What a design is called; one that is not among the candidates stands for the chosen one, "" without any."""
        label = self.label_of(candidate) or self.label
        return "" if label is None else label.text
