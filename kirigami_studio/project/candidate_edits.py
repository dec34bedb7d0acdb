"""The named changes to the collection of designs: marking one, and adding those of another run."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.design_facts import joined_provenance, with_run
from kirigami_studio.project.document import Document, Mark
from kirigami_studio.project.edits import Edit, set_candidates
from kirigami_studio.project.labels import Label, cleaned_name, cleaned_note, run_labels
from kirigami_studio.settings.design import DesignSettings

#: Designs that a project collects at most; one run may bring as many.
LARGEST_COLLECTION = 1024
#: Sorting key of a candidate; smaller is better.
RankKey = Callable[[Candidate], Any]


def set_mark(document: Document, index: int, mark: Mark, chosen: int | None = None) -> Edit:
    """Pin or reject candidate ``index``, or take that back.

    ``chosen`` is chosen in the same step, as when the design that is rejected was the chosen one.

    Raises
    ------
    ProjectError
        There is no such candidate.
    """
    if not 0 <= index < len(document.candidates):
        raise ProjectError("project.no_such_design", index=index, designs=len(document.candidates))
    marks = list(document.marks)
    before, marks[index] = marks[index], mark
    name = document.labels[index].text
    labels = {
        Mark.PINNED: tr("Pin design {name}", name=name),
        Mark.REJECTED: tr("Reject design {name}", name=name),
        Mark.NONE: tr("Unpin design {name}", name=name)
        if before is Mark.PINNED
        else tr("Restore design {name}", name=name),
    }
    return Edit(
        labels[mark], replace(document, marks=tuple(marks), chosen=document.chosen if chosen is None else chosen)
    )


def set_label(document: Document, index: int, name: str, note: str) -> Edit:
    """Call candidate ``index`` otherwise, and note something of it; without a name it has its own one again.

    Raises
    ------
    ProjectError
        There is no such candidate, another one has that name, or a text is too long.
    """
    if not 0 <= index < len(document.candidates):
        raise ProjectError("project.no_such_design", index=index, designs=len(document.candidates))
    before, name = document.labels[index], cleaned_name(name)
    after = Label(before.code, "" if name == before.code else name, cleaned_note(note))
    others = document.labels[:index] + document.labels[index + 1 :]
    if any(after.text.casefold() in (one.text.casefold(), one.code.casefold()) for one in others):
        raise ProjectError("labels.taken", name=after.text)
    labels = (*document.labels[:index], after, *document.labels[index + 1 :])
    told = (
        tr("Rename design {name}", name=before.text)
        if after.name != before.name
        else tr("Note on design {name}", name=before.text)
    )
    return Edit(told, replace(document, labels=labels))


@dataclass(frozen=True, slots=True)
class NewDesigns:
    """What a finished run adds to a project."""

    candidates: tuple[Candidate, ...]
    provenance: Mapping[str, str]
    seed: int | None = None  #: Seed that the settings show from now on; None leaves them as they are.
    target: Outline | None = None  #: what the run was made for, if the document should return to it
    #: (rows, columns); what the settings show from now on where the run has chosen it.
    grid: tuple[int, int] | None = None


def add_candidates(document: Document, new: NewDesigns, rank: RankKey, limit: int = LARGEST_COLLECTION) -> Edit:
    """Join the designs of another run for the same target, grid and angle to those there are.

    All are ranked together; marks and names stay with their designs, and the same design stays chosen.  A sheet that is
    there already is not added.  Where more than ``limit`` would come together, the worst rejected designs go first,
    then the worst unmarked ones; pinned designs and the chosen one stay.
    """
    marked = dict(zip(document.candidates, document.marks, strict=True))
    sheets = {candidate.sheet for candidate in document.candidates}
    added = with_run(_without_repeats(new.candidates, sheets), new.provenance)
    present = with_run(document.candidates, document.provenance)
    kept = _within([*present, *added], marked, document.candidate, rank, limit)
    changed = _collected(document, kept, marked, document.candidate, _labelled(document))
    changed = replace(changed, provenance=joined_provenance(document.provenance, new.provenance))
    changed = replace(changed, settings=_settings(document, new))
    if not added:
        return Edit(tr("Change the seed"), replace(document, settings=changed.settings))
    return Edit(tr_n("Add {count} design", "Add {count} designs", len(added)), changed)


def renew_candidates(document: Document, new: NewDesigns, rank: RankKey, chosen: Candidate | None = None) -> Edit:
    """Take the designs of a new run in the place of all but the pinned ones, and choose one, by default the best.

    Pinned designs stay only where they share target, grid and angle with the new ones, which the caller has checked.
    A design that is found again keeps its name.
    """
    known = with_run(document.candidates, document.provenance)
    pinned = [one for one, mark in zip(known, document.marks, strict=True) if mark is Mark.PINNED]
    sheets = {candidate.sheet for candidate in pinned}
    fresh = with_run(_without_repeats(new.candidates, sheets), new.provenance)
    found = sorted([*pinned, *fresh], key=rank)
    joined = joined_provenance(document.provenance, new.provenance) if pinned else new.provenance
    edit = set_candidates(document, found, joined, new.target)
    label = tr_n("Generate {count} design", "Generate {count} designs", len(new.candidates))
    marked = dict.fromkeys(pinned, Mark.PINNED)
    changed = _collected(edit.document, found, marked, chosen or found[0], _labelled(document), document.runs)
    return Edit(label, replace(changed, settings=_settings(document, new)))


def _settings(document: Document, new: NewDesigns) -> DesignSettings:
    """The settings with the seed and the grid that the run has found."""
    settings = document.settings
    seed = settings.seed if new.seed is None else new.seed
    return replace(settings, seed=seed, grid=settings.grid if new.grid is None else new.grid)


def rank_again(document: Document, regular: float, rank: RankKey, merge_key: str) -> Edit:
    """Put the designs into another order, with the balance (0 match, 1 regular) that it follows from.

    The design that is chosen stays chosen, unless it was the first: then the new first one is.
    """
    settings = replace(document.settings, regular=regular)
    ordered = sorted(document.candidates, key=rank)
    chosen = ordered[0] if document.chosen == 0 else document.candidate
    changed = _collected(document, ordered, _marked(document), chosen, _labelled(document))
    return Edit(tr("Change match or regular"), replace(changed, settings=settings), merge_key)


def replace_candidates(
    document: Document, better: Mapping[Candidate, Candidate], rank: RankKey, merge_key: str
) -> Edit:
    """Put better designs in the places of those that they were made from, and all into their order.

    Marks and the choice pass over to them; where the first one was chosen, the new first one is.
    """
    changed = [better.get(one, one) for one in document.candidates]
    marked = dict(zip(changed, document.marks, strict=True))
    labelled = dict(zip(changed, document.labels, strict=True))
    ordered = sorted(changed, key=rank)
    chosen = None if document.chosen is None else changed[document.chosen]
    after = _collected(document, ordered, marked, ordered[0] if document.chosen == 0 else chosen, labelled)
    return Edit(tr("Change match or regular"), after, merge_key)


def _marked(document: Document) -> dict[Candidate, Mark]:
    return dict(zip(document.candidates, document.marks, strict=True))


def _without_repeats(found: Iterable[Candidate], sheets: Iterable[Sheet]) -> list[Candidate]:
    """Those whose sheet is neither among ``sheets`` nor that of an earlier one."""
    seen, fresh = set(sheets), []
    for candidate in found:
        if candidate.sheet not in seen:
            seen.add(candidate.sheet)
            fresh.append(candidate)
    return fresh


def _within(
    candidates: list[Candidate], marked: dict[Candidate, Mark], chosen: Candidate | None, rank: RankKey, limit: int
) -> list[Candidate]:
    """At most ``limit`` of the candidates, best first."""
    ordered = sorted(candidates, key=rank)
    for mark in (Mark.REJECTED, Mark.NONE):
        spare = [one for one in ordered if marked.get(one, Mark.NONE) is mark and one != chosen]
        surplus = min(max(len(ordered) - limit, 0), len(spare))
        dropped = set(spare[len(spare) - surplus :])
        ordered = [one for one in ordered if one not in dropped]
    return ordered


def _labelled(document: Document) -> dict[Candidate, Label]:
    return dict(zip(document.candidates, document.labels, strict=True))


def _collected(
    document: Document,
    candidates: list[Candidate],
    marked: dict[Candidate, Mark],
    chosen: Candidate | None,
    labelled: dict[Candidate, Label],
    runs: int | None = None,
) -> Document:
    """The document with other candidates, marked and named as they were; new ones are named as those of one run.

    ``runs`` is how many runs have named designs before, by default those that the document knows of.
    """
    before = document.runs if runs is None else runs
    fresh = [one for one in candidates if one not in labelled]
    names = dict(zip(fresh, run_labels(before, len(fresh), labelled.values()), strict=True)) | labelled
    return replace(
        document,
        candidates=tuple(candidates),
        marks=tuple(marked.get(one, Mark.NONE) for one in candidates),
        chosen=candidates.index(chosen) if chosen in candidates else None,
        labels=tuple(names[one] for one in candidates),
        runs=before + (1 if fresh else 0),
    )
