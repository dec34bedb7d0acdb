"""The named changes a person can make: each takes a document and returns an edit, none alters anything."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TypedDict, Unpack

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions, CutOrder
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Document
from kirigami_studio.project.settings import FabricationSettings


@dataclass(frozen=True, slots=True)
class Edit:
    """A new document and what led to it.

    Attributes
    ----------
    label : str
        As it follows the word Undo: "Choose design 3".
    document : Document
    merge_key : str or None
        Consecutive edits of one key are steps of one drag and undo together.
    """

    label: str
    document: Document
    merge_key: str | None = None


class SettingsChange(TypedDict, total=False):
    """Fields of :class:`DesignSettings` that an edit may replace."""

    grid: tuple[int, int]
    phi: float
    k: int
    seed: int
    variant: str
    steps: int
    polish: int
    prefer: str
    search: int


class FabricationChange(TypedDict, total=False):
    """Fields of :class:`FabricationSettings` that an edit may replace."""

    width_mm: float
    material: str
    connector_mm: float | None
    kerf_mm: float | None
    options: CutOptions
    profile: str
    dxf_version: str


class OptionsChange(TypedDict, total=False):
    """Fields of :class:`CutOptions` that hold for the whole sheet, which an edit may replace."""

    style: ConnectorStyle
    order: CutOrder
    tabs: int
    tab_mm: float


_NAMES = {
    "grid": tr("the grid"),
    "phi": tr("the target angle"),
    "k": tr("the number of candidates"),
    "seed": tr("the seed"),
    "variant": tr("the generator"),
    "steps": tr("the number of steps"),
    "polish": tr("the polish"),
    "prefer": tr("what the polish prefers"),
    "search": tr("the search"),
    "width_mm": tr("the sheet's width"),
    "material": tr("the material"),
    "connector_mm": tr("the connector width"),
    "kerf_mm": tr("the kerf"),
    "options": tr("the cuts"),
    "profile": tr("the machine profile"),
    "dxf_version": tr("the DXF version"),
    "style": tr("the connector style"),
    "order": tr("the cutting order"),
    "tabs": tr("the number of tabs"),
    "tab_mm": tr("the tab width"),
}


def set_target(document: Document, target: Outline) -> Edit:
    """Take another target; the designs of the old one go."""
    changed = without_designs(document, target)
    return Edit(tr("Set target {name}", name=target.name), changed)


def without_designs(document: Document, target: Outline | None) -> Document:
    """The document with another target; the designs of the old one, and what was said of them, go."""
    return replace(document, target=target, candidates=(), chosen=None, provenance={}, marks=(), locked=frozenset())


def edit_target(document: Document, target: Outline, gesture: str) -> Edit:
    """Reshape the target by a gesture such as "Rotate target"; the steps of one drag undo together."""
    changed = without_designs(document, target)
    return Edit(gesture, changed, merge_key=f"target:{gesture}")


def set_settings(document: Document, **changes: Unpack[SettingsChange]) -> Edit:
    """Change how the next run searches.

    Raises
    ------
    GridError, AngleError, UsageError
        The number does not fit; see :class:`DesignSettings`.
    """
    changed = replace(document, settings=replace(document.settings, **changes))
    return Edit(_label(changes), changed, merge_key=_merge_key("settings", changes))


def set_candidates(
    document: Document,
    candidates: Iterable[Candidate],
    provenance: Mapping[str, str],
    target: Outline | None = None,
) -> Edit:
    """Take the designs of a finished run, best first, and choose the best.

    ``target`` is the one that the run was made for, if the document should return to it.  Choices about single hinges
    stay while the grid stays: on another one their numbers would name other places.
    """
    found = tuple(candidates)
    changed = replace(
        document,
        fabrication=_without_strange_hinges(document, found),
        target=document.target if target is None else target,
        candidates=found,
        chosen=0 if found else None,
        provenance=provenance,
        marks=(),
        locked=frozenset(),
    )
    count = len(found)
    return Edit(tr_n("Generate {count} design", "Generate {count} designs", count), changed)


def _without_strange_hinges(document: Document, found: tuple[Candidate, ...]) -> FabricationSettings:
    settings, options = document.fabrication, document.fabrication.options
    before = {candidate.field.ratio.shape for candidate in document.candidates}
    after = {candidate.field.ratio.shape for candidate in found}
    if before == after or not (options.hinge_mm or options.removed):
        return settings
    return replace(settings, options=replace(options, hinge_mm=(), removed=()))


def replace_candidate(document: Document, index: int, candidate: Candidate, gesture: str) -> Edit:
    """Put an improved design in the place of candidate ``index`` and choose it."""
    return Edit(gesture, replace(document, candidates=with_candidate(document, index, candidate), chosen=index))


def with_candidate(document: Document, index: int, candidate: Candidate) -> tuple[Candidate, ...]:
    """The designs with ``candidate`` in the place of the one that it was made of, whose run it shares."""
    candidates = list(document.candidates)
    candidates[index] = replace(candidate, made_with=candidate.made_with or candidates[index].made_with)
    return tuple(candidates)


def choose(document: Document, index: int | None) -> Edit:
    """Put candidate ``index`` on the stage, or none.

    Raises
    ------
    ProjectError
        There is no such candidate.
    """
    label = tr("Choose no design") if index is None else tr("Choose design {index}", index=index + 1)
    return Edit(label, replace(document, chosen=index))


def set_fabrication(document: Document, **changes: Unpack[FabricationChange]) -> Edit:
    """Change how the design is cut; dragging one slider is one undo step.

    Raises
    ------
    UsageError
        The number does not fit; see :class:`FabricationSettings`.
    """
    changed = replace(document, fabrication=replace(document.fabrication, **changes))
    return Edit(_label(changes), changed, merge_key=_merge_key("fabrication", changes))


def set_cut_options(document: Document, **changes: Unpack[OptionsChange]) -> Edit:
    """Change what holds for all cuts of the sheet; dragging one number is one undo step.

    Raises
    ------
    FabricationError
        The number does not fit; see :class:`CutOptions`.
    """
    options = replace(document.fabrication.options, **changes)
    changed = replace(document, fabrication=replace(document.fabrication, options=options))
    return Edit(_label(changes), changed, merge_key=_merge_key("options", changes))


def _label(changes: Mapping[str, object]) -> str:
    return tr("Change ") + tr(" and ").join(_NAMES[name] for name in changes)


def _merge_key(room: str, changes: Mapping[str, object]) -> str:
    return f"{room}:{','.join(sorted(changes))}"
