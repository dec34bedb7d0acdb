"""Everything about the project's files: saving and opening, recovery, recent files, materials that came along."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from kirigami_studio.gui.cuts.stocking import MaterialStore
from kirigami_studio.gui.files.recent_files import RecentFiles
from kirigami_studio.gui.files.recovering import Recovering, Work
from kirigami_studio.gui.files.storing import Storing
from kirigami_studio.gui.jobs.queue import JobQueue
from kirigami_studio.gui.targets.targeting import Targeting
from kirigami_studio.project.document import Document


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
