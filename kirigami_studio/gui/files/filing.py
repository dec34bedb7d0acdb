"""The project's files: saving and opening, recovery, recent files, the material that came along."""

from __future__ import annotations

import tempfile
from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.files.recent_files import RecentFiles
from kirigami_studio.gui.files.recovering import Recovery
from kirigami_studio.gui.make.cutting import MaterialStore
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.queue import JobCallbacks
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.target.pasting import PASTED
from kirigami_studio.gui.target.targeting import Targeting
from kirigami_studio.project.document import Document
from kirigami_studio.studio.projects import ChangedOnDisk, Project, Saved, loading, saving


class ProjectFiles(QObject):
    """Saves and opens projects, with the picture behind the target."""

    saved = Signal(Path, Document)  #: the document that the file holds
    opened = Signal(Path, Document)
    save_failed = Signal()
    changed_on_disk = Signal(ChangedOnDisk)  #: the file was not written, since somebody else has changed it

    def __init__(self, session: Session, targeting: Targeting, parent: QObject) -> None:
        super().__init__(parent)
        self._session, self._tracer = session, targeting.tracer
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._count = 0

    def save(self, path: Path) -> None:
        """Write the open project, unless the file there was changed since it was read or written here."""
        session = self._session
        document = session.document
        session.set_status(tr("Saving {name} …", name=path.name))
        picture = self._tracer.picture_of(document.target)
        steps = partial(saving, document, picture, path, session.on_disk)
        callbacks = JobCallbacks(partial(self._on_saved, document, session.project), on_failed=self._report_save_failed)
        session.queue.start(tr("saving {name}", name=path.name), steps, callbacks)

    def overwrite(self, changed: ChangedOnDisk) -> None:
        """Write the open project over what somebody else has made of its file."""
        self._session.on_disk[changed.path] = changed.digest
        self.save(changed.path)

    def open(self, path: Path) -> None:
        """Read a project file."""
        session = self._session
        session.set_status(tr("Opening {name} …", name=path.name))
        steps = partial(loading, path, self.new_folder(), session.on_disk)
        callbacks = JobCallbacks(partial(self._on_opened, path), on_failed=session.report_failure)
        session.queue.start(tr("opening {name}", name=path.name), steps, callbacks)

    def new_folder(self) -> Path:
        """A folder for the picture of one project; it lasts as long as the session."""
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix=PASTED)
            self.destroyed.connect(self._folder.cleanup)
        self._count += 1
        return Path(self._folder.name) / f"{PASTED}{self._count}"

    def _on_saved(self, document: Document, project: int, saved: Saved | ChangedOnDisk) -> None:
        if isinstance(saved, ChangedOnDisk):
            self.save_failed.emit()
            self._session.set_status(tr("Not saved: {name} was changed on disk.", name=saved.path.name))
            if project == self._session.project:
                self.changed_on_disk.emit(saved)
            return
        if saved.left_out:
            self._session.post(Message(saved.left_out, Tone.WARNING))
        if project == self._session.project:
            self.saved.emit(saved.path, document)
        else:  # another project was opened meanwhile, which does not live in that file
            self._session.set_status(tr("Saved {path}.", path=saved.path))

    def _report_save_failed(self, sentence: str, trace: str) -> None:
        self.save_failed.emit()
        self._session.report_failure(sentence, trace)

    def _on_opened(self, path: Path, project: Project) -> None:
        for note in project.notes:
            self._session.post(Message(note, Tone.WARNING))
        if project.picture is not None and project.document.target is not None:
            self._tracer.remember(project.document.target, project.picture)
        self.opened.emit(path, project.document)


class Filing(QObject):
    """Owns what deals with the project's files."""

    saved = Signal(Path, Document)  #: the document that the file holds
    opened = Signal(Path, Document)
    recovered = Signal(Document, object)  #: Path of its project or None

    def __init__(self, session: Session, targeting: Targeting, parent: QObject) -> None:
        super().__init__(parent)
        self.projects = ProjectFiles(session, targeting, self)
        self.recovery = Recovery(session, targeting.tracer, self.projects.new_folder, self)
        self.recent = RecentFiles(session, self)
        self.materials = MaterialStore(session, self)
        targeting.source_read.connect(self.recent.take_target)
        self.projects.saved.connect(self._report_saved)
        self.projects.opened.connect(self._report_opened)
        self.recovery.recovered.connect(self._report_recovered)

    def close(self) -> None:
        """The session ends as it should; the worker has ended."""
        self.recovery.close()

    def _report_saved(self, path: Path, document: Document) -> None:
        self.saved.emit(path, document)
        self.recent.take_project(path)

    def _report_opened(self, path: Path, document: Document) -> None:
        self.opened.emit(path, document)
        self.recent.take_project(path)
        self.materials.compare(document)

    def _report_recovered(self, document: Document, path: Path | None) -> None:
        self.recovered.emit(document, path)
        self.materials.compare(document)
