"""Changes to a design by hand: another field in its place, and locks that keep voids as they are."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.project.document import Document, Void
from kirigami_studio.project.edits import Edit, with_candidate


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


def moves_locked(document: Document, before: Candidate, after: Candidate) -> bool:
    """Whether a change gives another ratio to a void that is locked now, by the ratios that are shown and cut."""
    shown = [one.final_field for one in (before, after)]
    return any(shown[0].ratio[void] != shown[1].ratio[void] for void in document.locked)


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
    rows, columns = document.candidates[0].field.ratio.shape if document.candidates else (0, 0)
    every = frozenset((row, column) for row in range(rows) for column in range(columns))
    label = tr("Lock all voids") if on else tr("Unlock all voids")
    return Edit(label, replace(document, locked=every if on else frozenset()))


def _lock_label(voids: frozenset[Void], on: bool) -> str:
    if len(voids) == 1:
        ((row, column),) = voids
        if on:
            return tr("Lock void ({row}, {column})", row=row, column=column)
        return tr("Unlock void ({row}, {column})", row=row, column=column)
    if on:
        return tr_n("Lock {count} void", "Lock {count} voids", len(voids))
    return tr_n("Unlock {count} void", "Unlock {count} voids", len(voids))
