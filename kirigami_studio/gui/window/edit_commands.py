"""The Edit menu: undo and redo, the clipboard, the target."""

from __future__ import annotations

from PySide6.QtGui import QGuiApplication

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.files.open_project import OpenProject
from kirigami_studio.gui.files.picturing import PictureMaker
from kirigami_studio.gui.session.command import Command, WindowState, Wording
from kirigami_studio.gui.target.pasting import PasteReader
from kirigami_studio.gui.target.targeting import Targeting
from kirigami_studio.gui.window.open_dialogs import Dialogs


def commands(
    project: OpenProject, targeting: Targeting, dialogs: Dialogs, pasting: PasteReader, picturing: PictureMaker
) -> tuple[Command, ...]:
    """Return the commands of the Edit menu."""
    menu = tr("&Edit")
    return (
        Command(
            "undo",
            menu,
            tr("&Undo"),
            tr("Undo"),
            project.undo,
            shortcuts=("Ctrl+Z",),
            icon="undo",
            enabled_when=lambda now: now.undo_label is not None,
            worded=_undo_wording,
        ),
        Command(
            "redo",
            menu,
            tr("&Redo"),
            tr("Redo"),
            project.redo,
            shortcuts=("Ctrl+Y", "Ctrl+Shift+Z"),
            icon="redo",
            enabled_when=lambda now: now.redo_label is not None,
            worded=_redo_wording,
        ),
        Command(
            "history",
            menu,
            tr("&History …"),
            tr("List all steps and jump to one"),
            dialogs.show_history,
            shortcuts=("Ctrl+Shift+H",),
        ),
        Command(
            "paste",
            menu,
            tr("&Paste target"),
            tr("Paste a picture, SVG or path as the target"),
            lambda: pasting.take(QGuiApplication.clipboard().mimeData()),
            shortcuts=("Ctrl+V",),
            gap=True,
        ),
        Command(
            "copy_picture",
            menu,
            tr("&Copy picture"),
            tr("Copy a picture of the active view"),
            lambda: picturing.copy(picturing.view_at_work()),
            shortcuts=("Ctrl+Shift+C",),
        ),
        Command(
            "copy_cuts",
            menu,
            tr("Copy cuts as S&VG"),
            tr("Copy the cut plan as SVG in mm"),
            picturing.copy_cuts,
            shortcuts=("Ctrl+Alt+C",),
        ),
        Command(
            "clear",
            menu,
            tr("Clear tar&get"),
            tr("Remove the target"),
            targeting.clear,
            icon="clear",
            enabled_when=lambda now: now.has_target,
        ),
    )


def _undo_wording(now: WindowState) -> Wording:
    if now.undo_label is None:
        return Wording(tr("&Undo"), tr("Undo"), "undo")
    return Wording(tr("&Undo: {step}", step=now.undo_label), tr("Undo: {step}", step=now.undo_label), "undo")


def _redo_wording(now: WindowState) -> Wording:
    if now.redo_label is None:
        return Wording(tr("&Redo"), tr("Redo"), "redo")
    return Wording(tr("&Redo: {step}", step=now.redo_label), tr("Redo: {step}", step=now.redo_label), "redo")
