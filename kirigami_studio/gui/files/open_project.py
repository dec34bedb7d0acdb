"""The open project: begun, opened, saved, recovered; recent files, its material."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from kirigami_studio.foundation.resources import resource_root
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.files.recent_files import RecentFiles
from kirigami_studio.gui.files.recovering import Recovery
from kirigami_studio.gui.make.cutting import ProjectStock
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.queue import JobCallbacks
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.session.user_preferences import UserPreferences
from kirigami_studio.gui.stage.hand_editor import HandEditor
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
        """Write the open project, unless its file was changed since it was read or written."""
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


class OpenProject(QObject):
    """Replaces the open project, saves it, and goes along its history.

    Parameters
    ----------
    hand : HandEditor
        Finishes what is being changed by hand first.
    preferences : UserPreferences
        Has what new projects start with.
    stop_work : callable
        Stops all work for the present document, before another one comes.

    Attributes
    ----------
    files : ProjectFiles
    recovery : Recovery
    recent : RecentFiles
    stock : ProjectStock
    """

    saved = Signal(Path)
    opened = Signal(Path)
    begun = Signal()  #: an empty one

    def __init__(
        self,
        session: Session,
        targeting: Targeting,
        hand: HandEditor,
        preferences: UserPreferences,
        stop_work: Callable[[], None],
        parent: QObject,
    ) -> None:
        super().__init__(parent)
        self._session, self._targeting, self._hand = session, targeting, hand
        self._preferences, self._stop_work = preferences, stop_work
        self.files = ProjectFiles(session, targeting, self)
        self.recovery = Recovery(session, targeting.tracer, self.files.new_folder, self)
        self.recent = RecentFiles(session, self)
        self.stock = ProjectStock(session, self)
        targeting.source_read.connect(self.recent.take_target)
        self.files.saved.connect(self._on_saved)
        self.files.opened.connect(self._on_opened)
        self.recovery.recovered.connect(self._on_recovered)

    def close(self) -> None:
        """Let go of the copy kept for recovery, as the session ends as it should."""
        self.recovery.close()

    # another project -----------------------------------------------------------------------------------------------

    def new(self) -> None:
        """Forget everything and start empty."""
        self._stop_work()
        self._session.restart(self._preferences.new_document(), None)
        self.begun.emit()
        self._session.set_status(tr("New project. Choose or draw a target."))

    def open(self, path: Path) -> None:
        """Read a project file."""
        self.files.open(path)

    def open_design(self, document: Document, source: str) -> None:
        """Take over the design that a cut file carries, as a project that is not saved yet."""
        self._stop_work()
        self._session.restart(document, None, saved=False)
        self._targeting.source_read.emit(source)
        self._session.set_status(tr("Opened the design that {name} was cut from.", name=Path(source).name))

    def save(self, path: Path) -> None:
        """Write the project file."""
        if not self._hand.postpones(lambda: self.save(path)):
            self.files.save(path)

    def _on_saved(self, path: Path, document: Document) -> None:
        session = self._session
        session.path = path
        session.history.mark_saved(document)
        self.saved.emit(path)
        session.document_changed.emit(session.document)
        session.set_status(tr("Saved {path}.", path=path))
        self.recent.take_project(path)

    def _on_opened(self, path: Path, document: Document) -> None:
        self._stop_work()
        bundled = path.is_relative_to(resource_root())
        self._session.restart(document, None if bundled else path)  # a bundled one is saved elsewhere
        self.opened.emit(path)
        self._session.set_status(
            tr("Opened the example {name}. Save keeps a copy of it.", name=path.stem)
            if bundled
            else tr("Opened {path}.", path=path)
        )
        self.recent.take_project(path)
        self.stock.compare(document)

    def _on_recovered(self, document: Document, path: Path | None) -> None:
        self._stop_work()
        self._session.restart(document, path, saved=False)
        self.stock.compare(document)

    # its history ---------------------------------------------------------------------------------------------------

    def undo(self) -> None:
        """Go one step back."""
        if self._hand.postpones(self.undo):
            return
        label = self._session.history.undo_label
        if self._session.history.undo():
            self._show_step(tr("Undone: {label}.", label=label))

    def redo(self) -> None:
        """Go one undone step forward."""
        if self._hand.postpones(self.redo):
            return
        label = self._session.history.redo_label
        if self._session.history.redo():
            self._show_step(tr("Redone: {label}.", label=label))

    def go_to(self, position: int) -> None:
        """Undo or redo until so many steps of the history are done."""
        history = self._session.history
        if not self._hand.postpones(lambda: self.go_to(position)) and history.go_to(position):
            label = history.undo_label
            self._show_step(tr("Back at the start.") if label is None else tr("Now at step: {label}.", label=label))

    def _show_step(self, status: str) -> None:
        self._stop_work()
        self._session.announce()
        self._session.set_status(status)
