"""Undo and redo by snapshots: documents are frozen and small, so every step keeps a whole one."""

from __future__ import annotations

from dataclasses import dataclass

from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Document
from kirigami_studio.project.edits import Edit

#: Steps that are kept; a document of 32 candidates at 10 x 10 is about 40 kB.
LONGEST_HISTORY = 200


@dataclass(frozen=True, slots=True)
class _Step:
    """The edit that was applied and the document before it."""

    before: Document
    edit: Edit


class History:
    """The present document with the way back and forth."""

    def __init__(self, document: Document | None = None, limit: int = LONGEST_HISTORY) -> None:
        self._limit = limit
        self.restart(document or Document())

    def restart(self, document: Document, saved: bool = True) -> None:
        """Forget every step and start from ``document`` (a new or an opened project)."""
        self._document = document
        self._saved: Document | None = document if saved else None
        self._done: list[_Step] = []
        self._undone: list[_Step] = []
        self._drag_open = False

    @property
    def document(self) -> Document:
        """The present document."""
        return self._document

    @property
    def unsaved(self) -> bool:
        """Whether the present document differs from the saved one."""
        return self._saved is None or not _alike(self._document, self._saved)

    @property
    def undo_label(self) -> str | None:
        """What Undo would take back, or None when there is nothing."""
        return self._done[-1].edit.label if self._done else None

    @property
    def redo_label(self) -> str | None:
        """What Redo would bring again, or None when there is nothing."""
        return self._undone[-1].edit.label if self._undone else None

    def apply(self, edit: Edit) -> bool:
        """Make the edit's document the present one.

        A step of the drag that is under way joins the step before it.  Returns False, and keeps the history as it is,
        when the edit changes nothing.
        """
        if _alike(edit.document, self._document):
            return False
        if self._continues_drag(edit):
            before = self._done.pop().before
            if _alike(before, edit.document):  # dragged back to where it began
                self._document = before
                self._drag_open = False
                return True
        else:
            before = self._document
            self._undone.clear()
        self._done.append(_Step(before, edit))
        del self._done[: -self._limit]
        self._document = edit.document
        self._drag_open = edit.merge_key is not None
        return True

    @property
    def steps(self) -> tuple[str, ...]:
        """Labels of all steps, the oldest first: those that are done, then those that were undone."""
        return tuple(step.edit.label for step in (*self._done, *reversed(self._undone)))

    @property
    def position(self) -> int:
        """How many of the steps are done."""
        return len(self._done)

    def go_to(self, position: int) -> bool:
        """Undo or redo until ``position`` steps are done; False when there is nothing to do.

        Raises
        ------
        ProjectError
            There are not so many steps.
        """
        if not 0 <= position <= len(self.steps):
            raise ProjectError("history.no_such_step", position=position, last=len(self.steps))
        moved = False
        while position < len(self._done):
            moved = self.undo()
        while position > len(self._done):
            moved = self.redo()
        return moved

    def end_drag(self) -> None:
        """The mouse was released: the next edit is a step of its own."""
        self._drag_open = False

    def undo(self) -> bool:
        """Go one step back; False when there is none."""
        self._drag_open = False
        if not self._done:
            return False
        step = self._done.pop()
        self._undone.append(step)
        self._document = step.before
        return True

    def redo(self) -> bool:
        """Go one undone step forth; False when there is none."""
        self._drag_open = False
        if not self._undone:
            return False
        step = self._undone.pop()
        self._done.append(step)
        self._document = step.edit.document
        return True

    def mark_saved(self, document: Document | None = None) -> None:
        """The present document is on disk now, or this one: it may have changed while an earlier one was written."""
        self._saved = self._document if document is None else document
        self._drag_open = False

    def _continues_drag(self, edit: Edit) -> bool:
        return bool(
            self._drag_open and self._done and edit.merge_key and self._done[-1].edit.merge_key == edit.merge_key
        )


def _alike(one: Document, other: Document) -> bool:
    """Whether two documents hold the same; targets of one shape, hence equal, may differ in size, place or nodes."""
    if one is other:
        return True
    return one == other and _measures(one) == _measures(other)


def _measures(document: Document) -> list[tuple[object, ...]]:
    return [_measure(outline) for outline in (document.target, *document.drawing)]


def _measure(target: Outline | None) -> tuple[object, ...]:
    return () if target is None else (target.size, target.unit, target.place, target.nodes)
