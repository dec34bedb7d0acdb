"""Everything about the project's files: saving and opening, recovery, recent files, materials that came along."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.cuts.cutting import MaterialStore
from kirigami_studio.gui.files.pasting import PASTED
from kirigami_studio.gui.files.recent_files import RecentFiles
from kirigami_studio.gui.files.recovering import Recovering, Work
from kirigami_studio.gui.jobs import project_steps
from kirigami_studio.gui.jobs.project_steps import Left, Project
from kirigami_studio.gui.jobs.queue import JobCallbacks, JobQueue
from kirigami_studio.gui.jobs.steps import Picture
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.gui.targets.targeting import Targeting
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Document


class Storing(QObject):
    """Saves and opens projects, with the picture behind the target."""

    saved = Signal(object, object)  #: Path, Document that it holds
    opened = Signal(object, object)  #: Path, Document
    picture_found = Signal(object, object)  #: Outline, Picture that it was traced from; comes before opened
    message = Signal(object)  #: Message
    failed = Signal(str, str)  #: sentence, trace
    status = Signal(str)

    def __init__(
        self, queue: JobQueue, picture_of: Callable[[Outline | None], Picture | None], parent: QObject
    ) -> None:
        super().__init__(parent)
        self._queue = queue
        self._picture_of = picture_of
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._count = 0
        self._project = 0  # how many projects were on the window before this one

    def save(self, document: Document, path: Path) -> None:
        """Write a project file."""
        self.status.emit(tr("Saving {name} …", name=path.name))
        callbacks = JobCallbacks(partial(self._saved, document, self._project), on_failed=self.failed.emit)
        steps = partial(project_steps.saving, document, self._picture_of(document.target), path)
        self._queue.start(tr("saving {name}", name=path.name), steps, callbacks)

    def open(self, path: Path) -> None:
        """Read a project file."""
        self.status.emit(tr("Opening {name} …", name=path.name))
        callbacks = JobCallbacks(partial(self._opened, path), on_failed=self.failed.emit)
        self._queue.start(
            tr("opening {name}", name=path.name), partial(project_steps.loading, path, self.place()), callbacks
        )

    def begin(self) -> None:
        """Another project is on the window: a file that is still being written is not where that one lives."""
        self._project += 1

    def place(self) -> Path:
        """A folder for the picture of one project; it lasts as long as the session."""
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix=PASTED)
            self.destroyed.connect(self._folder.cleanup)
        self._count += 1
        return Path(self._folder.name) / f"{PASTED}{self._count}"

    def _saved(self, document: Document, project: int, report: object) -> None:
        if isinstance(report, Left):
            self.message.emit(Message(report.sentence, Tone.WARNING))
        elif isinstance(report, Path) and project == self._project:
            self.saved.emit(report, document)
        elif isinstance(report, Path):
            self.status.emit(tr("Saved {path}.", path=report))

    def _opened(self, path: Path, report: object) -> None:
        if isinstance(report, Left):
            self.message.emit(Message(report.sentence, Tone.WARNING))
        elif isinstance(report, Project):
            if report.picture is not None:
                self.picture_found.emit(report.document.target, report.picture)
            self.opened.emit(path, report.document)


class Filing(QObject):
    """Owns these parts and lets them speak with one voice."""

    saved = Signal(object, object)  #: Path, Document that it holds
    opened = Signal(object, object)  #: Path, Document
    recovered = Signal(object, object)  #: Document; Path of its project or None
    message = Signal(object)  #: Message
    status = Signal(str)
    failed = Signal(str, str)  #: sentence, trace

    def __init__(self, queue: JobQueue, work: Callable[[], Work], targeting: Targeting, parent: QObject) -> None:
        super().__init__(parent)
        tracing = targeting.tracing
        self.storing = Storing(queue, tracing.picture_of, self)
        self.recovering = Recovering(queue, work, self.storing.place, self)
        self.recent = RecentFiles(queue, self)
        self.stocking = MaterialStore(self)
        for message in (self.storing.message, self.recovering.message, self.recent.message, self.stocking.message):
            message.connect(self.message)
        for status in (self.storing.status, self.recovering.status, self.stocking.status):
            status.connect(self.status)
        for part in (self.storing, self.recovering):
            part.failed.connect(self.failed)
            part.picture_found.connect(tracing.remember)
        targeting.source_read.connect(self.recent.take_target)
        self.storing.saved.connect(self._saved)
        self.storing.opened.connect(self._opened)
        self.recovering.recovered.connect(self._recovered)

    def close(self) -> None:
        """The session ends as it should; the worker has ended."""
        self.recovering.close()

    def _saved(self, path: Path, document: Document) -> None:
        self.saved.emit(path, document)
        self.recent.take_project(path)

    def _opened(self, path: Path, document: Document) -> None:
        self.opened.emit(path, document)
        self.recent.take_project(path)
        self.stocking.welcome(document)

    def _recovered(self, document: Document, path: Path | None) -> None:
        self.recovered.emit(document, path)
        self.stocking.welcome(document)
