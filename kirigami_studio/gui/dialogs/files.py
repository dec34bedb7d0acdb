"""Which file? The system's own choosers, with the right filters."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

from PySide6.QtWidgets import QFileDialog, QWidget

TARGET_FILTER = "Targets (*.png *.jpg *.jpeg *.bmp *.svg *.dxf *.json);;All files (*)"
PROJECT_FILTER = "Kirigami Studio projects (*.kiri)"
DXF_FILTER = "DXF cut file, mm (*.dxf)"


class FileQuestions(Protocol):
    """Who answers when a file is needed; None means that the user thought better of it."""

    def target(self) -> Path | None:
        """A target to open."""

    def project(self) -> Path | None:
        """A project to open."""

    def save(self, proposal: str) -> Path | None:
        """A place for the project."""

    def dxf(self, proposal: str) -> Path | None:
        """A place for the cut file."""


class FileChoosers:
    """Asks the user with the system's choosers."""

    def __init__(self, window: QWidget) -> None:
        self._window = window

    def target(self) -> Path | None:
        name, _ = QFileDialog.getOpenFileName(self._window, "Open target", "", TARGET_FILTER)
        return Path(name) if name else None

    def project(self) -> Path | None:
        name, _ = QFileDialog.getOpenFileName(self._window, "Open project", "", PROJECT_FILTER)
        return Path(name) if name else None

    def save(self, proposal: str) -> Path | None:
        name, _ = QFileDialog.getSaveFileName(self._window, "Save project", proposal, PROJECT_FILTER)
        return with_suffix(name, ".kiri")

    def dxf(self, proposal: str) -> Path | None:
        name, _ = QFileDialog.getSaveFileName(self._window, "Export DXF", proposal, DXF_FILTER)
        return with_suffix(name, ".dxf")


def with_suffix(name: str, suffix: str) -> Path | None:
    """The chosen place with the file type's extension; None for no choice."""
    if not name:
        return None
    path = Path(name)
    return path if path.suffix.lower() == suffix else path.with_name(path.name + suffix)
