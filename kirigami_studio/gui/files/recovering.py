"""Recovery after a crash: unsaved work is kept in a file of its own and offered again at the next start."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path

from PySide6.QtCore import QDateTime, QDeadlineTimer, QLocale, QLockFile, QObject, QTimer, Signal

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.queue import JobCallbacks
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.target.targeting import PictureTracer
from kirigami_studio.project import recovery
from kirigami_studio.project.document import Document
from kirigami_studio.project.recovery import RecoveryNote
from kirigami_studio.studio.projects import Leftover, Project, keeping, loading, reading_leftovers, removing

#: Unsaved work is kept as a whole project.
SUFFIX = ".kiri"
#: The work is kept once nothing has changed for so long (ms) …
QUIET_MS = 3_000
#: … and at the latest so long after the first change that is not kept yet.
LONGEST_MS = 20_000
#: Earlier sessions that are asked about at one start, the newest.
MOST_OFFERS = 5


class Recovery(QObject):
    """Keeps the unsaved work of this session and offers that of sessions that ended unexpectedly.

    Does nothing until :meth:`use` says in which folder.  Every session has a lock beside its file, so that studios
    which run at the same time leave each other's alone; a lock dies with its process.
    """

    recovered = Signal(Document, object)  #: Path of its project or None
    recover_wanted = Signal(Leftover)  #: whoever asks about unsaved changes goes on with recover()
    kept = Signal(Document)  #: is on disk now
    left_behind = Signal(bool)  #: whether there is work of earlier sessions to ask about

    def __init__(
        self, session: Session, tracer: PictureTracer, new_folder: Callable[[], Path], parent: QObject
    ) -> None:
        super().__init__(parent)
        self._session, self._tracer, self._new_folder = session, tracer, new_folder
        self.quiet_ms, self.longest_ms = QUIET_MS, LONGEST_MS
        self._folder: Path | None = None
        self._own: Path | None = None
        self._lock: QLockFile | None = None
        self._kept: Document | None = None
        self._job: int | None = None
        self._warned = False
        self._offered: dict[Path, QLockFile] = {}
        self._questions: dict[Path, Message] = {}
        self._pending: Leftover | None = None
        self._latest: QDeadlineTimer | None = None
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.timeout.connect(self._keep)
        session.document_changed.connect(self.notice)

    @property
    def file(self) -> Path | None:
        """Where this session keeps its work; None without a folder."""
        return self._own

    @property
    def waiting(self) -> bool:
        """Whether a change is about to be kept."""
        return self._timer.isActive() or self._job is not None

    def use(self, folder: Path) -> None:
        """Keep work in this folder from now on, and offer what earlier sessions left there."""
        self._folder = folder
        self._own = folder / f"{os.getpid()}-{os.urandom(6).hex()}{SUFFIX}"
        self.look_back()
        self.left_behind.emit(bool(self._offered))
        self.notice()

    # the present session -------------------------------------------------------------------------------------------

    def notice(self) -> None:
        """The document, or what is saved of it, may have changed."""
        if self._own is None:
            return
        if not self._session.history.unsaved:
            self._forget()
        elif self._session.document is not self._kept:
            if self._latest is None:
                self._latest = QDeadlineTimer(self.longest_ms)
            self._timer.start(min(self.quiet_ms, max(0, self._latest.remainingTime())))

    def close(self) -> None:
        """The session ends as it should: nothing of it is left to recover.  The worker must have ended."""
        self._job = None
        self._forget()
        for lock in self._offered.values():
            lock.unlock()
        self._offered.clear()
        if self._lock is not None:
            self._lock.unlock()
            self._lock = None

    def _keep(self) -> None:
        session = self._session
        if self._own is None or self._job is not None or not session.history.unsaved:
            return  # a job that is under way looks again when it ends
        self._latest = None
        if not self._locked(self._own):
            self._cannot_keep(tr("no permission to write to {folder}", folder=self._own.parent))
            return
        document = session.document
        path = "" if session.path is None else str(session.path.absolute())
        digest = "" if session.path is None else session.on_disk.get(session.path, "")
        note = RecoveryNote(_name_of(document, session.path), path, recovery.now(), digest)
        callbacks = JobCallbacks(self._on_kept, self._look_again, on_failed=self._report_not_kept)
        steps = partial(keeping, document, self._tracer.picture_of(document.target), note, self._own)
        self._job = session.queue.start(tr("autosaving"), steps, callbacks)

    def _locked(self, own: Path) -> bool:
        if self._lock is None:
            with suppress(OSError):
                own.parent.mkdir(parents=True, exist_ok=True)
            lock = _lock_of(own)
            if not lock.tryLock(0):
                return False
            self._lock = lock
        return True

    def _on_kept(self, document: Document) -> None:
        self._kept = document
        self._drop_pending()
        self.kept.emit(document)

    def _look_again(self) -> None:
        self._job = None
        self.notice()

    def _report_not_kept(self, sentence: str, trace: str) -> None:
        self._job = None
        self._cannot_keep(sentence)

    def _cannot_keep(self, reason: str) -> None:
        """Say it once; the next change tries again."""
        if not self._warned:
            self._warned = True
            sentence = tr("Autosave is unavailable. Save often.")
            self._session.post(Message(sentence, Tone.WARNING, reason))

    def _forget(self) -> None:
        self._timer.stop()
        self._latest = self._kept = None
        if self._own is None:
            return
        if self._job is not None:  # it may be writing at this moment
            self._session.queue.abandon(self._job)
            self._job = None
            self._session.queue.start(tr("cleaning up autosave files"), partial(removing, self._own), JobCallbacks())
        _remove(self._own)
        self._drop_pending()

    # earlier sessions ----------------------------------------------------------------------------------------------

    def look_back(self) -> None:
        """Look for work that was kept by sessions which are no longer running."""
        self._read(self._abandoned())

    def offer_again(self) -> None:
        """Ask once more about all work of earlier sessions, also what was left for later, or say that there is none."""
        waiting = *self._offered, *self._abandoned()
        for message in self._questions.values():
            self._session.withdraw(message)
        self._questions.clear()
        self._read(waiting)
        if not waiting:
            self._session.hint(tr("There is no unsaved work to recover."))

    def _abandoned(self) -> tuple[Path, ...]:
        """Files of sessions that are no longer running, oldest first, locked from now on."""
        if self._folder is None:
            return ()
        try:
            files = sorted(self._folder.glob(f"*{SUFFIX}"), key=lambda file: file.stat().st_mtime, reverse=True)
        except OSError:
            return ()  # a folder that cannot be read holds nothing that could be offered
        abandoned = []
        for file in files:
            if file != self._own and file not in self._offered and len(self._offered) < MOST_OFFERS:
                lock = _lock_of(file)
                if lock.tryLock(0):
                    self._offered[file] = lock
                    abandoned.append(file)
        return tuple(abandoned[::-1])

    def _read(self, files: tuple[Path, ...]) -> None:
        if files:
            callbacks = JobCallbacks(self._offer, on_failed=self._session.report_failure)
            self._session.queue.start(tr("looking for unsaved work"), partial(reading_leftovers, files), callbacks)

    def _ask(self, leftover: Leftover, message: Message) -> None:
        self._questions[leftover.file] = message
        self._session.post(message)

    def _offer(self, leftover: Leftover) -> None:
        discard = (tr("Discard"), lambda: self.discard(leftover))
        later = (tr("Keep for later"), lambda: self.leave(leftover))
        if leftover.note is None:
            sentence = tr("Kirigami Studio quit unexpectedly, and its autosaved work cannot be read.")
            self._ask(leftover, Message(sentence, Tone.WARNING, leftover.fault, (discard, later)))
            return
        sentence = tr(
            "Kirigami Studio quit unexpectedly. Recover {name}, last changed {when}?",
            name=leftover.note.name,
            when=format_time(leftover.note),
        )
        recover = (tr("Recover"), lambda: self.recover_wanted.emit(leftover))
        details = leftover.note.path or tr("Never saved.")
        self._ask(leftover, Message(sentence, Tone.WARNING, details, (recover, discard, later)))

    def recover(self, leftover: Leftover) -> None:
        """Open the kept work; its file goes once this session keeps the work itself."""
        self._session.set_status(tr("Recovering {name} …", name=_called(leftover)))
        callbacks = JobCallbacks(
            partial(self._on_recovered, leftover), on_failed=partial(self._report_not_recovered, leftover)
        )
        steps = partial(loading, leftover.file, self._new_folder(), self._session.on_disk)
        self._session.queue.start(tr("recovering {called}", called=_called(leftover)), steps, callbacks)

    def discard(self, leftover: Leftover) -> None:
        """Delete the kept work."""
        _remove(leftover.file)
        self.leave(leftover)
        self.left_behind.emit(bool(self._offered))
        self._session.set_status(tr("Discarded the autosaved work: {name}.", name=_called(leftover)))

    def leave(self, leftover: Leftover) -> None:
        """Ask again at the next start, or when File > Recover unsaved work is chosen."""
        self._questions.pop(leftover.file, None)
        lock = self._offered.pop(leftover.file, None)
        if lock is not None:
            lock.unlock()

    def _on_recovered(self, leftover: Leftover, project: Project) -> None:
        for note in project.notes:
            self._session.post(Message(note, Tone.WARNING))
        document = project.document
        if project.picture is not None and document.target is not None:
            self._tracer.remember(document.target, project.picture)
        self._pending = leftover
        path = leftover.note.path if leftover.note is not None else ""
        if leftover.note is not None and path:  # what the lost session knew of the file
            self._session.on_disk[Path(path)] = leftover.note.digest
        self.recovered.emit(document, Path(path) if path else None)
        self._session.set_status(tr("Recovered {name}. Not saved yet.", name=_called(leftover)))
        if self._job is not None:  # what it keeps was given up, and says nothing about what was recovered
            self._session.queue.abandon(self._job)
            self._job = None
        self._keep()

    def _report_not_recovered(self, leftover: Leftover, sentence: str, trace: str) -> None:
        self.leave(leftover)
        self._session.report_failure(sentence, trace)

    def _drop_pending(self) -> None:
        """What was recovered is in this session's own file, saved, or given up: the old file may go."""
        if self._pending is not None:
            pending, self._pending = self._pending, None
            _remove(pending.file)
            self.leave(pending)
            self.left_behind.emit(bool(self._offered))


def format_time(note: RecoveryNote) -> str:
    """When the work was changed, as the user says it: the time alone if that was today."""
    when = QDateTime.fromSecsSinceEpoch(int(note.when.timestamp()))
    locale = QLocale()
    time = locale.toString(when.time(), QLocale.FormatType.ShortFormat)
    if when.date() == QDateTime.currentDateTime().date():
        return tr("today at {time}", time=time)
    return tr("on {day} at {time}", day=locale.toString(when.date(), QLocale.FormatType.LongFormat), time=time)


def _lock_of(file: Path) -> QLockFile:
    lock = QLockFile(str(file.with_suffix(".lock")))
    lock.setStaleLockTime(0)  # a lock is as old as its session; only the end of the process makes it stale
    return lock


def _name_of(document: Document, path: Path | None) -> str:
    if path is not None:
        return path.name
    target = document.target
    return tr("Untitled") if target is None else tr("an unsaved project for {target}", target=target.name)


def _called(leftover: Leftover) -> str:
    return leftover.file.name if leftover.note is None else leftover.note.name


def _remove(file: Path) -> None:
    with suppress(OSError):
        file.unlink(missing_ok=True)
