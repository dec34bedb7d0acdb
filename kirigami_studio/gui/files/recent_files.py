"""Which projects and targets were used last: remembered between sessions once it is known in which file."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.files.pasting import PASTED
from kirigami_studio.gui.jobs.board import Board, Ears
from kirigami_studio.gui.jobs.worker import Cancel
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.project import recent
from kirigami_studio.project.recent import Recent


class RecentFiles(QObject):
    """Holds the list; whether its files are still there is looked up in the worker, for a network may be slow."""

    changed = Signal(object)  #: Recent
    missing = Signal(frozenset)  #: paths, str, that are not there any more
    message = Signal(object)  #: Message

    def __init__(self, board: Board, parent: QObject) -> None:
        super().__init__(parent)
        self._board = board
        self._path: Path | None = None
        self.present = Recent()

    def load(self, path: Path) -> None:
        """Read the list and keep it up to date from now on; one that cannot be read is left as it is."""
        try:
            self.present = recent.load(path)
        except KirigamiError as error:
            self.message.emit(Message(str(error), Tone.WARNING))
        else:
            self._path = path
            self.changed.emit(self.present)

    def take_project(self, path: Path) -> None:
        """A project was opened or saved."""
        self._change(self.present.with_project(path))

    def take_target(self, source: str) -> None:
        """A target was read; silhouettes of the library and pasted pictures are no files of the user's."""
        path = Path(source)
        if path.suffix and not path.parent.name.startswith(PASTED):
            self._change(self.present.with_target(path))

    def clear(self) -> None:
        """Forget all."""
        self._change(Recent())

    def look(self) -> None:
        """Find out which files are missing."""
        paths = (*self.present.projects, *self.present.targets)
        if paths:
            ears = Ears(self.missing.emit)
            self._board.start(tr("looking for recent files"), partial(_looking, paths), ears)

    def _change(self, wanted: Recent) -> None:
        if wanted == self.present:
            return
        self.present = wanted
        self.changed.emit(wanted)
        if self._path is None:
            return
        try:
            recent.save(wanted, self._path)
        except KirigamiError as error:
            self._path = None  # once is enough
            self.message.emit(Message(str(error), Tone.WARNING))


def _looking(paths: tuple[str, ...], cancel: Cancel) -> Iterator[frozenset[str]]:
    yield frozenset(path for path in paths if not _is_there(path))


def _is_there(path: str) -> bool:
    try:
        return Path(path).is_file()
    except (OSError, ValueError):
        return False
