"""Which projects and targets were used last: remembered between sessions once it is known in which file.

Several sessions share the file: each change is made to what the file holds at that moment, under a lock.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from PySide6.QtCore import QLockFile, QObject, Signal

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.steps import Cancel
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.queue import JobCallbacks
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.target.pasting import PASTED
from kirigami_studio.project import recent
from kirigami_studio.project.recent import Recent

#: Milliseconds that the window waits at most for another session to write its change, which takes a few: it takes no
#: events meanwhile.
PATIENCE_MS = 80
#: Milliseconds after which the lock of a session that has died no longer counts.
STALE_MS = 5000


class RecentFiles(QObject):
    """Holds the list; whether its files are still there is looked up in the worker, for a network may be slow."""

    changed = Signal(Recent)
    missing = Signal(frozenset)  #: paths, str, that are not there any more

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._path: Path | None = None
        self.present = Recent()

    def load(self, path: Path) -> None:
        """Read the list and keep it up to date from now on; one that cannot be read is left as it is."""
        try:
            self.present = recent.load(path)
        except KirigamiError as error:
            self._session.post(Message(str(error), Tone.WARNING))
        else:
            self._path = path
            self.changed.emit(self.present)

    def take_project(self, path: Path) -> None:
        """A project was opened or saved."""
        self._change(lambda known: known.with_project(path))

    def take_target(self, source: str) -> None:
        """A target was read; silhouettes of the library and pasted pictures are no files of the user's."""
        path = Path(source)
        if path.suffix and not path.parent.name.startswith(PASTED):
            self._change(lambda known: known.with_target(path))

    def clear(self) -> None:
        """Forget all, what other sessions have added too."""
        self._change(lambda _: Recent())

    def look(self) -> None:
        """Take over what other sessions have added, and find out which files are missing."""
        self._read_again()
        paths = (*self.present.projects, *self.present.targets)
        if paths:
            callbacks = JobCallbacks(self.missing.emit)
            self._session.queue.start(tr("checking recent files"), partial(_looking, paths), callbacks)

    def _change(self, change: Callable[[Recent], Recent]) -> None:
        if self._path is None:
            self._on_change(change(self.present))
            return
        try:
            self._on_change(changed_file(self._path, change))
        except KirigamiError as error:
            self._path = None  # once is enough
            self._session.post(Message(str(error), Tone.WARNING))
            self._on_change(change(self.present))

    def _read_again(self) -> None:
        if self._path is not None:
            try:
                self._on_change(recent.load(self._path))
            except KirigamiError as error:
                self._path = None
                self._session.post(Message(str(error), Tone.WARNING))

    def _on_change(self, known: Recent) -> None:
        if known != self.present:
            self.present = known
            self.changed.emit(known)


def changed_file(path: Path, change: Callable[[Recent], Recent], patience_ms: int = PATIENCE_MS) -> Recent:
    """Change the list that the file holds now, whoever wrote it, and return it.

    A session that keeps the lock for longer than ``patience_ms`` may lose its entry, or this one may.

    Raises
    ------
    ProjectError
        The file cannot be read; it is left as it is.
    ExportError
        It cannot be written.
    """
    if not path.parent.is_dir():  # the first session of all
        return _written(Recent(), change, path)
    lock = QLockFile(f"{path}.lock")
    lock.setStaleLockTime(STALE_MS)
    lock.tryLock(patience_ms)  # without it the list is changed all the same
    try:
        return _written(recent.load(path), change, path)
    finally:
        lock.unlock()


def _written(known: Recent, change: Callable[[Recent], Recent], path: Path) -> Recent:
    wanted = change(known)
    if wanted != known:
        recent.save(wanted, path)
    return wanted


def _looking(paths: tuple[str, ...], cancel: Cancel) -> Iterator[frozenset[str]]:
    yield frozenset(path for path in paths if not _is_there(path))


def _is_there(path: str) -> bool:
    try:
        return Path(path).is_file()
    except (OSError, ValueError):
        return False
