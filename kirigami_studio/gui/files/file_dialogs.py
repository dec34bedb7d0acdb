"""File dialogs: the system's own, with the right filters, in the folder that was used last."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import Protocol

from PySide6.QtWidgets import QFileDialog, QWidget

from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.outlines.read import READERS
from kirigami_studio.studio.file_kinds import FILE_KINDS, kind_of

PROJECT_FILTER = mark("Kirigami Studio projects (*.kiri)")


class FileToOpen(Enum):
    """A file to open: title of its dialog, name and extensions of the files listed."""

    TARGET = mark("Open target"), mark("Targets"), tuple(READERS)
    START = mark("Open start outline"), mark("Shapes"), tuple(READERS)
    ARTWORK = (
        mark("Choose picture"),
        mark("Pictures"),
        (".png", ".jpg", ".jpeg", ".svg", ".bmp", ".tif", ".tiff", ".webp"),
    )
    PROJECT = mark("Open project"), mark("Kirigami Studio projects"), (".kiri",)

    @property
    def filter(self) -> str:
        """As a file dialog lists it: files of these kinds, or all."""
        _, kinds, extensions = self.value
        patterns = " ".join(f"*{extension}" for extension in extensions)
        every = "" if self is FileToOpen.PROJECT else ";;" + tr("All files (*)")
        return f"{tr(kinds)} ({patterns}){every}"


class FileDialogs(Protocol):
    """Asks the user for files; None means that the user has cancelled."""

    def open(self, wanted: FileToOpen) -> Path | None:
        """A file to open."""

    def save(self, proposal: str) -> Path | None:
        """A place for the project."""

    def export(self, proposal: str, to_folder: bool = False) -> Path | None:
        """A place for an exported file; the proposal's extension is the kind that is offered first.

        With ``to_folder``, files of that kind are several, in a folder of that name.
        """

    def picture(self, proposal: str) -> Path | None:
        """A place for the picture of a view, PNG or SVG."""

    def folder(self) -> Path | None:
        """A folder for many files."""


class SystemFileDialogs:
    """The dialogs of the desktop."""

    def __init__(self, window: QWidget) -> None:
        self._window = window
        self._opened = ""  #: folder of the file that was opened last
        self._written = ""  #: folder of the file that was written last

    def open(self, wanted: FileToOpen) -> Path | None:
        name, _ = QFileDialog.getOpenFileName(self._window, tr(wanted.value[0]), self._opened, wanted.filter)
        self._opened = str(Path(name).parent) if name else self._opened
        return Path(name) if name else None

    def save(self, proposal: str) -> Path | None:
        dialog = self._saver(tr("Save project"), proposal, [tr(PROJECT_FILTER)])
        return self._answer(dialog)

    def export(self, proposal: str, to_folder: bool = False) -> Path | None:
        kind = kind_of(Path(proposal).suffix)
        title = mark("Export {upper} to a folder of this name") if to_folder else mark("Export {upper}")
        filters = [each.filter for each in FILE_KINDS]
        dialog = self._saver(tr(title, upper=kind.extension[1:].upper()), proposal, filters)
        dialog.selectNameFilter(kind.filter)
        dialog.filterSelected.connect(lambda text: follow_filter(dialog, text))
        return self._answer(dialog)

    def picture(self, proposal: str) -> Path | None:
        kinds = {tr("PNG picture (*.png)"): ".png", tr("SVG drawing (*.svg)"): ".svg"}
        dialog = self._saver(tr("Export picture"), proposal, list(kinds))
        dialog.filterSelected.connect(lambda text: take_extension(dialog, kinds.get(text, "")))
        return self._answer(dialog)

    def folder(self) -> Path | None:
        name = QFileDialog.getExistingDirectory(self._window, tr("Export to a folder"), self._first_shown)
        return self._remembered(name)

    @property
    def _first_shown(self) -> str:
        """The folder of the file that was written last, or else opened."""
        return self._written or self._opened

    def _saver(self, title: str, proposal: str, filters: list[str]) -> QFileDialog:
        """A dialog that appends the extension itself, so that it asks before it overwrites the right file."""
        dialog = QFileDialog(self._window, title, self._first_shown)
        dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
        dialog.setFileMode(QFileDialog.FileMode.AnyFile)
        dialog.setNameFilters(filters)
        dialog.setDefaultSuffix(Path(proposal).suffix)
        dialog.selectFile(proposal)
        return dialog

    def _answer(self, dialog: QFileDialog) -> Path | None:
        accepted = dialog.exec() == QFileDialog.DialogCode.Accepted
        names = dialog.selectedFiles() if accepted else []
        dialog.deleteLater()
        return self._remembered(names[0] if names else "")

    def _remembered(self, name: str) -> Path | None:
        if not name:
            return None
        self._written = str(Path(name).parent)
        return Path(name)


def follow_filter(dialog: QFileDialog, text: str) -> None:
    """Give the proposed name the extension of the file type that was picked."""
    take_extension(dialog, next((kind.extension for kind in FILE_KINDS if kind.filter == text), ""))


def take_extension(dialog: QFileDialog, extension: str) -> None:
    """Give the proposed name another extension, unless that is empty."""
    if extension:
        dialog.setDefaultSuffix(extension)
        names = dialog.selectedFiles()
        if names:
            dialog.selectFile(Path(names[0]).with_suffix(extension).name)
