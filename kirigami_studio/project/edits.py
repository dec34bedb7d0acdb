"""The named edits: each takes a document and returns an edit, none alters anything."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypedDict, Unpack

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.second_target import SecondTarget
from kirigami_studio.export.artwork import ArtPicture, Artwork, PictureFit, SheetState
from kirigami_studio.fabricate.options import CutOptions
from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.foundation.settings import settings_of
from kirigami_studio.foundation.words import mark, tr, tr_n
from kirigami_studio.outlines.drawing import Guides
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.starts import StartShape
from kirigami_studio.project.document import FARTHEST_GUIDE, MOST_GUIDES, Document, Void
from kirigami_studio.project.labels import run_labels
from kirigami_studio.settings.design import DesignChange, DesignSettings
from kirigami_studio.settings.fabrication import (
    FabricationChange,
    FabricationSettings,
    OptionsChange,
    construction_changes,
)


@dataclass(frozen=True, slots=True)
class Edit:
    """A new document and what led to it."""

    label: str  #: as it follows the word Undo: "Choose design 3"
    document: Document
    merge_key: str | None = None  #: consecutive edits of one key are steps of one drag and undo together


class SettingsChange(DesignChange, total=False):
    """Fields of :class:`DesignSettings` that an edit may replace."""

    grid: tuple[int, int]
    auto_grid: bool
    start: StartShape
    second: SecondTarget | None


class LaidChange(TypedDict, total=False):
    """Fields of :class:`Laid` that an edit may replace, but the picture."""

    state: SheetState
    fitting: PictureFit
    scale: float
    turn: float
    shift: tuple[float, float]


#: What a document says of parts of its target whose target has none.
ALONE: dict[str, Any] = {"other_parts": (), "part": 0, "place": None}
#: Settings that change others with them.
BRINGING_OTHERS = ("machine", "material")
#: What the Undo menu says of a change to a setting that has no words of its own for it.
OTHER_CHANGE = mark("Change a setting")
#: Widths of single connectors are rounded to this many decimals of a millimetre.
DECIMALS = 4


def set_target(document: Document, target: Outline) -> Edit:
    """Take another target; the designs of the old one go.  A size in mm is that of the opened shape."""
    changed = replace(without_designs(as_drawn(document, target), target), **ALONE)
    return Edit(tr("Set target {name}", name=target.name), changed)


def edit_target(document: Document, target: Outline, gesture: str) -> Edit:
    """Reshape the target by a gesture such as "Rotate target"; the steps of one drag undo together."""
    changed = without_designs(as_drawn(document, target), target)
    return Edit(gesture, changed, merge_key=f"target:{gesture}")


def without_designs(document: Document, target: Outline | None) -> Document:
    """The document with another target; the designs of the old one, their marks, names and locks go."""
    return replace(
        document,
        target=target,
        drawing=(),
        candidates=(),
        chosen=None,
        provenance={},
        marks=(),
        labels=(),
        locked=frozenset(),
    )


def as_drawn(document: Document, target: Outline) -> Document:
    """The document whose opened shape has the size that a target was drawn with, if that is another one in mm."""
    before = document.target
    if target.unit != "mm" or target.size is None or (before is not None and before.size == target.size):
        return document
    return replace(document, fabrication=replace(document.fabrication, opened_mm=max(target.size)))


def set_guides(document: Document, guides: Guides, gesture: str) -> Edit:
    """Let other guides lie on the drawing board, by a gesture such as "Move guide"; far off they lie at the limit.

    Where there would be more than can be kept, those that are there stay.
    """
    nearer = tuple(
        tuple(min(max(at, -FARTHEST_GUIDE), FARTHEST_GUIDE) for at in _kept_guides(places, before))
        for places, before in zip(guides, document.guides, strict=True)
    )
    return Edit(gesture, replace(document, guides=(nearer[0], nearer[1])))


def _kept_guides(places: tuple[float, ...], before: tuple[float, ...]) -> tuple[float, ...]:
    if len(places) <= MOST_GUIDES:
        return places
    known = set(before)
    return tuple(sorted(sorted(places, key=lambda at: at not in known)[:MOST_GUIDES]))


def set_settings(document: Document, **changes: Unpack[SettingsChange]) -> Edit:
    """Change how the next run searches; a grid that is given is no longer chosen by the run.

    Raises
    ------
    GridError, AngleError, UsageError
        The number does not fit; see :class:`DesignSettings`.  Or the sheet would not pass the second target on its way.
    """
    values: dict[str, Any] = {**changes}
    settings = replace(document.settings, **values)
    if settings.second is not None and changes.keys() & {"phi", "second"}:
        settings.second.check_on_the_way_to(settings.phi)
    if "grid" in changes and "auto_grid" not in changes:
        settings = replace(settings, auto_grid=False)
    changed = replace(document, settings=settings)
    removes = "second" in changes and changes["second"] is None
    label = tr("Remove the second target") if removes else _label(DesignSettings, changes)
    return Edit(label, changed, merge_key=_merge_key("settings", changes))


def set_fabrication(document: Document, **changes: Unpack[FabricationChange]) -> Edit:
    """Change how the design is cut; dragging one slider is one undo step.

    A width that is given no longer follows the size of the opened shape.

    Raises
    ------
    UsageError
        The number does not fit; see :class:`FabricationSettings`.
    """
    values: dict[str, Any] = {**construction_changes(document.fabrication, changes), **changes}
    cut = replace(document.fabrication, **values)
    if "width_mm" in changes and "opened_mm" not in changes:
        cut = replace(cut, opened_mm=None)
    changed = replace(document, fabrication=cut)
    return Edit(_label(FabricationSettings, changes), changed, merge_key=_merge_key("fabrication", changes))


def set_cut_options(document: Document, **changes: Unpack[OptionsChange]) -> Edit:
    """Change what holds for all cuts of the sheet; dragging one number is one undo step.

    Raises
    ------
    FabricationError
        The number does not fit; see :class:`CutOptions`.
    """
    values: dict[str, Any] = {**changes}
    options = replace(document.fabrication.options, **values)
    changed = replace(document, fabrication=replace(document.fabrication, options=options))
    return Edit(_label(CutOptions, changes), changed, merge_key=_merge_key("options", changes))


def set_artwork(document: Document, artwork: Artwork | None) -> Edit:
    """Print another picture on the sheet, or none."""
    label = tr("Remove the artwork") if artwork is None else tr("Lay {name} on it", name=artwork.first.picture.name)
    return Edit(label, replace(document, artwork=artwork))


def place_artwork(document: Document, **changes: Unpack[LaidChange]) -> Edit:
    """Lay the picture otherwise; dragging one number is one undo step.

    Raises
    ------
    ExportError
        A number that no placed picture has.
    ProjectError
        There is no picture.
    """
    if document.artwork is None:
        raise ProjectError("artwork.none")
    first = replace(document.artwork.first, **changes)
    changed = replace(document, artwork=replace(document.artwork, first=first))
    return Edit(tr("Place the artwork"), changed, merge_key=_merge_key("artwork", changes))


def share_artwork(document: Document, second: ArtPicture | None, stripes: int) -> Edit:
    """Let a second picture share the sheet by stripes, or no longer; dragging their number is one undo step.

    Raises
    ------
    ExportError
        A number of stripes that no sheet has.
    ProjectError
        There is no first picture.
    """
    before = document.artwork
    if before is None:
        raise ProjectError("artwork.none")
    changed = replace(document, artwork=replace(before, second=second, stripes=stripes))
    if second is before.second:
        return Edit(tr("Change the stripes"), changed, merge_key="artwork:stripes")
    if second is None:
        return Edit(tr("Remove the second picture"), changed)
    return Edit(tr("Lay {name} between", name=second.name), changed)


def _label(kind: type, changes: Mapping[str, object]) -> str:
    """Entry of the Undo menu for a change; of several at once the one that brings the others."""
    settings = settings_of(kind)
    name = next(name for name in (*BRINGING_OTHERS, *settings) if name in changes)
    return tr(settings[name].setting.undo or OTHER_CHANGE)


def _merge_key(part: str, changes: Mapping[str, object]) -> str:
    return f"{part}:{','.join(sorted(changes))}"


def set_candidates(
    document: Document,
    candidates: Iterable[Candidate],
    provenance: Mapping[str, str],
    target: Outline | None = None,
) -> Edit:
    """Take the designs of a finished run, best first, and choose the best.

    ``target`` is the one that the run was made for, if the document should return to it.  Choices for single
    connectors stay while the grid stays: on another grid their numbers would name other places.
    """
    found = tuple(candidates)
    changed = replace(
        document,
        fabrication=_fabrication_for(document, found),
        target=document.target if target is None else target,
        drawing=document.drawing if target is None or target == document.target else (),
        candidates=found,
        chosen=0 if found else None,
        provenance=provenance,
        marks=(),
        labels=run_labels(document.runs, len(found)),
        runs=document.runs + (1 if found else 0),
        locked=frozenset(),
    )
    count = len(found)
    return Edit(tr_n("Generate {count} design", "Generate {count} designs", count), changed)


def _fabrication_for(document: Document, found: tuple[Candidate, ...]) -> FabricationSettings:
    """The fabrication settings for new designs; on another grid without choices for single connectors."""
    settings, options = document.fabrication, document.fabrication.options
    before = {candidate.sheet.grid for candidate in document.candidates}
    after = {candidate.sheet.grid for candidate in found}
    if before == after or not (options.hinge_mm or options.removed):
        return settings
    return replace(settings, options=replace(options, hinge_mm=(), removed=()))


def choose(document: Document, index: int | None) -> Edit:
    """Choose candidate ``index``, or none.

    Raises
    ------
    ProjectError
        There is no such candidate.
    """
    label = tr("Deselect the design") if index is None else tr("Choose design {name}", name=_name(document, index))
    return Edit(label, replace(document, chosen=index))


def _name(document: Document, index: int) -> str:
    """What a design is called; its number where there is none, which the document refuses."""
    return document.labels[index].text if 0 <= index < len(document.labels) else str(index)


def replace_candidate(document: Document, index: int, candidate: Candidate, gesture: str) -> Edit:
    """Put an improved design in the place of candidate ``index`` and choose it."""
    return Edit(gesture, replace(document, candidates=with_candidate(document, index, candidate), chosen=index))


def take_changed(
    document: Document, before: Candidate, after: Candidate, gesture: str, merge_key: str | None = None
) -> Edit | None:
    """Put a changed design in the place of the one it came from; which design is chosen stays as it is.

    Gestures of one ``merge_key`` that follow one another undo together.  None when the document does not hold the
    design any more: it was replaced while the change was being scored.
    """
    if before not in document.candidates:
        return None
    candidates = with_candidate(document, document.candidates.index(before), after)
    return Edit(gesture, replace(document, candidates=candidates), merge_key)


def with_candidate(document: Document, index: int, candidate: Candidate) -> tuple[Candidate, ...]:
    """The designs with ``candidate`` in the place of the one that it was made from, whose run it shares."""
    candidates = list(document.candidates)
    candidates[index] = replace(candidate, made_with=candidate.made_with or candidates[index].made_with)
    return tuple(candidates)


def moves_locked(document: Document, before: Candidate, after: Candidate) -> bool:
    """Whether a change gives another ratio to a void that is locked now, by the ratios that are shown and cut."""
    shown = [one.final_sheet for one in (before, after)]
    return any(shown[0].field.ratio[void] != shown[1].field.ratio[void] for void in document.locked)


def lock_voids(document: Document, voids: Iterable[Void], on: bool) -> Edit:
    """Lock voids against changes by hand, or unlock them.

    Raises
    ------
    ProjectError
        The designs have no such void.
    """
    chosen = frozenset(voids)
    locked = document.locked | chosen if on else document.locked - chosen
    return Edit(_lock_label(chosen, on), replace(document, locked=locked))


def lock_all(document: Document, on: bool) -> Edit:
    """Lock every void of the grid, or none."""
    rows, columns = document.candidates[0].sheet.grid if document.candidates else (0, 0)
    every = frozenset((row, column) for row in range(rows) for column in range(columns))
    label = tr("Lock all voids") if on else tr("Unlock all voids")
    return Edit(label, replace(document, locked=every if on else frozenset()))


def _lock_label(voids: frozenset[Void], on: bool) -> str:
    if len(voids) == 1:
        ((row, column),) = voids
        if on:
            return tr("Lock the void in row {row}, column {column}", row=row, column=column)
        return tr("Unlock the void in row {row}, column {column}", row=row, column=column)
    if on:
        return tr_n("Lock {count} void", "Lock {count} voids", len(voids))
    return tr_n("Unlock {count} void", "Unlock {count} voids", len(voids))


def set_hinge_width(document: Document, hinges: Collection[int], width_mm: float) -> Edit:
    """Give connectors a finished width of their own; the steps of one drag undo together.

    Removed connectors among others stay removed; they come back only if all of these are removed.

    Parameters
    ----------
    hinges : collection of int
        Numbered as in ``slits.CutTable``.

    Raises
    ------
    FabricationError
        The width is not above 0, or a number is negative.
    """
    gone = set(document.fabrication.options.removed)
    hinges = [hinge for hinge in hinges if hinge not in gone] or hinges
    options = document.fabrication.options.without(hinges)
    widths = dict(options.hinge_mm) | dict.fromkeys(hinges, round(float(width_mm), DECIMALS))
    changed = replace(options, hinge_mm=tuple(sorted(widths.items())))
    numbers = ",".join(str(hinge) for hinge in sorted(hinges))
    label = tr_n(
        "Set connector {number} to {width_mm:g} mm",
        "Set {count} connectors to {width_mm:g} mm",
        len(hinges),
        number=min(hinges, default=0),
        width_mm=width_mm,
    )
    return _edit(document, changed, label, f"hinges:{numbers}")


def remove_hinges(document: Document, hinges: Collection[int]) -> Edit:
    """Leave no connector at these hinges."""
    number = min(hinges, default=0)
    label = tr_n("Cut through connector {number}", "Cut through {count} connectors", len(hinges), number=number)
    return _edit(document, document.fabrication.options.cut_through(hinges), label)


def reset_hinges(document: Document, hinges: Collection[int]) -> Edit:
    """Give connectors the sheet's usual width again."""
    number = min(hinges, default=0)
    label = tr_n("Reset connector {number}", "Reset {count} connectors", len(hinges), number=number)
    return _edit(document, document.fabrication.options.without(hinges), label)


def _edit(document: Document, options: CutOptions, label: str, merge_key: str | None = None) -> Edit:
    fabrication = replace(document.fabrication, options=options)
    return Edit(label, replace(document, fabrication=fabrication), merge_key)
