"""Project files, written and read off the window's thread."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from kirigami_studio.gui.jobs import steps
from kirigami_studio.gui.jobs.board import Board, Ears
from kirigami_studio.project.document import Document


class Storing(QObject):
    """Saves and opens projects."""

    saved = Signal(object, object)  #: Path, Document that it holds
    opened = Signal(object, object)  #: Path, Document
    failed = Signal(str, str)  #: sentence, trace
    status = Signal(str)

    def __init__(self, board: Board, parent: QObject) -> None:
        super().__init__(parent)
        self._board = board

    def save(self, document: Document, path: Path) -> None:
        """Write a project file."""
        self.status.emit(f"Saving {path.name} …")
        ears = Ears(partial(self._saved, document), on_failed=self.failed.emit)
        self._board.start(f"saving {path.name}", partial(steps.saving, document, path), ears)

    def open(self, path: Path) -> None:
        """Read a project file."""
        self.status.emit(f"Opening {path.name} …")
        ears = Ears(partial(self._opened, path), on_failed=self.failed.emit)
        self._board.start(f"opening {path.name}", partial(steps.loading, path), ears)

    def _saved(self, document: Document, path: object) -> None:
        if isinstance(path, Path):
            self.saved.emit(path, document)

    def _opened(self, path: Path, document: object) -> None:
        if isinstance(document, Document):
            self.opened.emit(path, document)
