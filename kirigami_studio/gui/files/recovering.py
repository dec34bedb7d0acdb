"""Work that a crash must not take: kept in a file of its own while it is unsaved, offered again at the next start."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from PySide6.QtCore import QDateTime, QDeadlineTimer, QLocale, QLockFile, QObject, QTimer, Signal

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.jobs import project_steps
from kirigami_studio.gui.jobs.project_steps import Left, Leftover, Project
from kirigami_studio.gui.jobs.queue import JobCallbacks, JobQueue
from kirigami_studio.gui.jobs.steps import Picture
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.project import recovery
from kirigami_studio.project.document import Document
from kirigami_studio.project.recovery import Note

#: Kept work is a whole project.
SUFFIX = ".kiri"
#: The work is kept once nothing has changed for so long (ms) …
QUIET_MS = 3_000
#: … and at the latest so long after the first change that is not kept yet.
LONGEST_MS = 20_000
#: Earlier sessions that are asked about at one start, the newest.
MOST_OFFERS = 5


@dataclass(frozen=True, slots=True)
class Work:
    """What there is to lose."""

    document: Document
    path: Path | None
    unsaved: bool
    picture: Picture | None = None


class Recovering(QObject):
    """Keeps the unsaved work of this session and offers that of sessions that ended unexpectedly.

    Does nothing until it is told in which folder.  Every session has a lock beside its file, so that studios which run
    at the same time leave each other's alone; a lock dies with its process.
    """

    recovered = Signal(object, object)  #: Document; Path of its project or None
    recover_wanted = Signal(object)  #: Leftover; whoever asks about unsaved changes goes on with recover()
    picture_found = Signal(object, object)  #: Outline, Picture that it was traced from; comes before recovered
    kept = Signal(object)  #: Document that is on disk now
    message = Signal(object)  #: Message
    failed = Signal(str, str)  #: sentence, trace
    status = Signal(str)

    def __init__(self, queue: JobQueue, work: Callable[[], Work], place: Callable[[], Path], parent: QObject) -> None:
        super().__init__(parent)
        self._queue = queue
        self._work, self._place = work, place
        self.quiet_ms, self.longest_ms = QUIET_MS, LONGEST_MS
        self._folder: Path | None = None
        self._own: Path | None = None
        self._lock: QLockFile | None = None
        self._kept: Document | None = None
        self._job: int | None = None
        self._told = False
        self._offered: dict[Path, QLockFile] = {}
        self._pending: Leftover | None = None
        self._latest: QDeadlineTimer | None = None
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.timeout.connect(self._keep)

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
        self.notice()

    # the present session -------------------------------------------------------------------------------------------

    def notice(self) -> None:
        """The document, or what is saved of it, may have changed."""
        if self._own is None:
            return
        work = self._work()
        if not work.unsaved:
            self._forget()
        elif work.document is not self._kept:
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
        work = self._work()
        if self._own is None or self._job is not None or not work.unsaved:
            return  # a job that is under way looks again when it ends
        self._latest = None
        if not self._locked(self._own):
            self._cannot_keep(tr("no permission to write to {folder}", folder=self._own.parent))
            return
        path = "" if work.path is None else str(work.path.absolute())
        note = Note(_name_of(work), path, recovery.now(), os.getpid())
        callbacks = JobCallbacks(
            self._take_kept, self._look_again, on_failed=lambda sentence, _: self._not_kept(sentence)
        )
        steps = partial(project_steps.keeping, work.document, work.picture, note, self._own)
        self._job = self._queue.start(tr("autosaving"), steps, callbacks)

    def _locked(self, own: Path) -> bool:
        if self._lock is None:
            with suppress(OSError):
                own.parent.mkdir(parents=True, exist_ok=True)
            lock = _lock_of(own)
            if not lock.tryLock(0):
                return False
            self._lock = lock
        return True

    def _take_kept(self, document: object) -> None:
        if isinstance(document, Document):
            self._kept = document
            self._drop_pending()
            self.kept.emit(document)

    def _look_again(self) -> None:
        self._job = None
        self.notice()

    def _not_kept(self, sentence: str) -> None:
        self._job = None
        self._cannot_keep(sentence)

    def _cannot_keep(self, reason: str) -> None:
        """Say it once; the next change tries again."""
        if not self._told:
            self._told = True
            sentence = tr("Autosave is unavailable. Save often.")
            self.message.emit(Message(sentence, Tone.WARNING, reason))

    def _forget(self) -> None:
        self._timer.stop()
        self._latest = self._kept = None
        if self._own is None:
            return
        if self._job is not None:  # it may be writing at this moment
            self._queue.abandon(self._job)
            self._job = None
            self._queue.start(
                tr("cleaning up autosave files"), partial(project_steps.removing, self._own), JobCallbacks()
            )
        _remove(self._own)
        self._drop_pending()

    # earlier sessions ----------------------------------------------------------------------------------------------

    def look_back(self) -> None:
        """Look for work that was kept by sessions which are no longer running."""
        if self._folder is None:
            return
        try:
            files = sorted(self._folder.glob(f"*{SUFFIX}"), key=lambda file: file.stat().st_mtime, reverse=True)
        except OSError:
            return  # a folder that cannot be read holds nothing that could be offered
        abandoned = []
        for file in files:
            if file != self._own and file not in self._offered and len(self._offered) < MOST_OFFERS:
                lock = _lock_of(file)
                if lock.tryLock(0):
                    self._offered[file] = lock
                    abandoned.append(file)
        if abandoned:
            callbacks = JobCallbacks(self._offer, on_failed=self.failed.emit)
            steps = partial(project_steps.looking, tuple(abandoned[::-1]))
            self._queue.start(tr("looking for unsaved work"), steps, callbacks)

    def _offer(self, leftover: object) -> None:
        if not isinstance(leftover, Leftover):
            return
        discard = (tr("Discard"), lambda: self.discard(leftover))
        later = (tr("Keep for later"), lambda: self.leave(leftover))
        if leftover.note is None:
            sentence = tr("Kirigami Studio quit unexpectedly, and its autosaved work cannot be read.")
            self.message.emit(Message(sentence, Tone.WARNING, leftover.fault, (discard, later)))
            return
        sentence = tr(
            "Kirigami Studio quit unexpectedly. Recover {name}, last changed {when}?",
            name=leftover.note.name,
            when=format_time(leftover.note),
        )
        recover = (tr("Recover"), lambda: self.recover_wanted.emit(leftover))
        details = leftover.note.path or tr("Never saved.")
        self.message.emit(Message(sentence, Tone.WARNING, details, (recover, discard, later)))

    def recover(self, leftover: Leftover) -> None:
        """Open the kept work; its file goes once this session keeps the work itself."""
        self.status.emit(tr("Recovering {name} …", name=_called(leftover)))
        callbacks = JobCallbacks(
            partial(self._take_recovered, leftover), on_failed=partial(self._not_recovered, leftover)
        )
        steps = partial(project_steps.recovering, leftover, self._place())
        self._queue.start(tr("recovering {called}", called=_called(leftover)), steps, callbacks)

    def discard(self, leftover: Leftover) -> None:
        """Delete the kept work."""
        _remove(leftover.file)
        self.leave(leftover)
        self.status.emit(tr("Discarded the autosaved work: {name}.", name=_called(leftover)))

    def leave(self, leftover: Leftover) -> None:
        """Ask again at the next start."""
        lock = self._offered.pop(leftover.file, None)
        if lock is not None:
            lock.unlock()

    def _take_recovered(self, leftover: Leftover, report: object) -> None:
        if isinstance(report, Left):
            self.message.emit(Message(report.sentence, Tone.WARNING))
        if not isinstance(report, Project):
            return
        document = report.document
        if report.picture is not None:
            self.picture_found.emit(document.target, report.picture)
        self._pending = leftover
        path = leftover.note.path if leftover.note is not None else ""
        self.recovered.emit(document, Path(path) if path else None)
        self.status.emit(tr("Recovered {name}. Not saved yet.", name=_called(leftover)))
        if self._job is not None:  # what it keeps was given up, and says nothing about what was recovered
            self._queue.abandon(self._job)
            self._job = None
        self._keep()

    def _not_recovered(self, leftover: Leftover, sentence: str, trace: str) -> None:
        self.leave(leftover)
        self.failed.emit(sentence, trace)

    def _drop_pending(self) -> None:
        """What was recovered is in this session's own file, saved, or given up: the old file may go."""
        if self._pending is not None:
            pending, self._pending = self._pending, None
            _remove(pending.file)
            self.leave(pending)


def format_time(note: Note) -> str:
    """When the work was changed, as a person says it: the time alone if that was today."""
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


def _name_of(work: Work) -> str:
    if work.path is not None:
        return work.path.name
    target = work.document.target
    return tr("Untitled") if target is None else tr("an unsaved project for {target}", target=target.name)


def _called(leftover: Leftover) -> str:
    return leftover.file.name if leftover.note is None else leftover.note.name


def _remove(file: Path) -> None:
    with suppress(OSError):
        file.unlink(missing_ok=True)
