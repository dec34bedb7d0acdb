"""The Edit menu: undo and redo, the clipboard, the target."""

from __future__ import annotations

from functools import partial
from operator import attrgetter

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
    command = partial(Command, tr("&Edit"))
    undo = partial(command, enabled_when=lambda now: now.undo_label is not None, worded=_undo_wording)
    redo = partial(command, enabled_when=lambda now: now.redo_label is not None, worded=_redo_wording)
    paste, copy = tr("Paste a picture, SVG or path as the target"), tr("Copy a picture of the active view")
    cuts = tr("Copy the cut plan as SVG in mm")

    def take_pasted() -> None:
        pasting.take(QGuiApplication.clipboard().mimeData())

    def copy_view() -> None:
        picturing.copy(picturing.view_at_work())

    return (
        undo("undo", tr("&Undo"), tr("Undo"), project.undo, "Ctrl+Z", "undo"),
        redo("redo", tr("&Redo"), tr("Redo"), project.redo, "Ctrl+Y; Ctrl+Shift+Z", "redo"),
        command(
            "history", tr("&History …"), tr("List all steps and jump to one"), dialogs.show_history, "Ctrl+Shift+H"
        ),
        command("paste", tr("&Paste target"), paste, take_pasted, "Ctrl+V", gap=True),
        command("copy_picture", tr("&Copy picture"), copy, copy_view, "Ctrl+Shift+C"),
        command("copy_cuts", tr("Copy cuts as S&VG"), cuts, picturing.copy_cuts, "Ctrl+Alt+C"),
        command(
            "clear",
            tr("Clear tar&get"),
            tr("Remove the target"),
            targeting.clear,
            icon="clear",
            enabled_when=attrgetter("has_target"),
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
