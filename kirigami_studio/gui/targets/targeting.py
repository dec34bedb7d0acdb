"""Which target is designed for: read from a file, traced, drawn, cleared; each becomes an edit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.jobs.queue import JobQueue
from kirigami_studio.gui.targets.reading import Reading
from kirigami_studio.gui.targets.tracing import Tracing
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project import edits
from kirigami_studio.project.document import Document
from kirigami_studio.project.edits import Edit


class Targeting(QObject):
    """Reads and traces targets in the worker; every gesture on the target passes here."""

    replaced = Signal(object)  #: Edit that makes all work for the old target pointless
    adjusted = Signal(object)  #: Edit by a step of a threshold's drag
    begun = Signal(object)  #: Document that the history is to start from
    settled = Signal()  #: the drag is over
    source_read = Signal(str)  #: where a target was read from
    status = Signal(str)
    failed = Signal(str, str)  #: sentence, trace

    def __init__(self, queue: JobQueue, document: Callable[[], Document], parent: QObject) -> None:
        super().__init__(parent)
        self._document = document
        self._blank = Document()
        self.tracing = Tracing(queue, self)
        self.reading = Reading(queue, self.tracing, self)
        self.reading.read.connect(self._take_read)
        self.reading.failed.connect(self.failed)
        self.tracing.traced.connect(self._take_traced)
        self.tracing.refused.connect(self.status)
        self.tracing.settled.connect(self.settled)

    def stop(self) -> None:
        """Forget what is still being read or traced."""
        self.reading.stop()
        self.tracing.stop()

    def open(self, source: str, first: bool = False) -> None:
        """Read a file, or a silhouette of the library by name."""
        self.status.emit(tr("Reading {name} …", name=Path(source).name))
        self.reading.start(source, first)

    def start_with(self, source: str, blank: Document) -> None:
        """Read the first target; into the ``blank`` document it is where the history starts, no change to be undone."""
        self._blank = blank
        self.open(source, first=True)

    def change_threshold(self, threshold: float | None) -> None:
        """Trace the target's picture again at another grey level, 0..1; None for the automatic one."""
        picture = self.tracing.picture_of(self._document().target)
        if picture is not None:
            self.tracing.retrace(picture, threshold)

    def reshape(self, edit: Edit) -> None:
        """Take an edit that the drawing board made of the target."""
        self.replaced.emit(edit)
        self.status.emit(f"{edit.label}.")

    def clear(self) -> None:
        """Start over with an empty target."""
        document = self._document()
        if document.target is not None:
            self.replaced.emit(Edit(tr("Clear target"), edits.without_designs(document, None)))
            self.status.emit(tr("Target cleared. Undo brings it back."))

    def _take_traced(self, outline: Outline) -> None:
        self.adjusted.emit(edits.edit_target(self._document(), outline, tr("Change threshold")))
        self.status.emit(tr("{count} points at this threshold.", count=len(outline.points)))

    def _take_read(self, outline: Outline, first: bool) -> None:
        document = self._document()
        if first and document == self._blank:
            self.begun.emit(replace(document, target=outline))
            said = tr("Target: {name}. Press Generate (Ctrl+G), or choose another target.", name=outline.name)
        else:
            self.replaced.emit(edits.set_target(document, outline))
            said = tr("Target: {name}. Press Generate (Ctrl+G) to design a sheet for it.", name=outline.name)
        self.source_read.emit(self.reading.source)
        self.status.emit(said)
