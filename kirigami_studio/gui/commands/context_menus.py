"""The menus of the right mouse button and the menu key: for each view the commands that belong to what it shows."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QPoint, Qt
from PySide6.QtWidgets import QMenu, QWidget

if TYPE_CHECKING:
    from kirigami_studio.gui.main_window import MainWindow

#: Commands by id, "" for a gap.  Those that cannot be given now are grey.
BOARD = (
    *("undo", "redo", "", "points", "pose", "polygon", "freehand", "rectangle", "ellipse", "regular", "star", "text"),
    *("", "paste", "copy_picture", "clear", "", "fit", "zoom_selection", "zoom_real", "zoom_in", "zoom_out"),
    *("", "grid", "axis", "", "edit_target"),
)
TARGET = ("edit_target", "", "open_target", "library", "paste", "copy_picture", "clear")
STAGE = (
    *("play", "to_flat", "to_target", "", "show_target", "show_mismatch", "show_faults", "show_stretch", "show_grips"),
    *("", "before", "hand", "cuts", "plots", "compare", "", "more_like", "refit", "pin", "reject"),
    *("", "copy_picture", "fit", "zoom_in", "zoom_out"),
)
CUTS = ("undo", "redo", "", "cuts", "", "copy_picture", "copy_cuts", "export", "", "fit", "zoom_in", "zoom_out")


def offer_context_menus(window: MainWindow) -> None:
    """Give the views of a window their menus."""
    target, stage = window.target, window.stage
    _offer(window, stage.view, lambda: STAGE)
    _offer(window, stage.cuts.view, lambda: CUTS)
    _offer(window, target.view, lambda: BOARD if target.editing else TARGET)


def _offer(window: MainWindow, view: QWidget, names: Callable[[], tuple[str, ...]]) -> None:
    view.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
    view.customContextMenuRequested.connect(partial(_open, window, view, names))


def _open(window: MainWindow, view: QWidget, names: Callable[[], tuple[str, ...]], place: QPoint) -> None:
    window.commands.refresh()
    menu = QMenu(view)
    menu.setObjectName("contextMenu")
    menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    for name in names():
        if name:
            menu.addAction(window.commands[name])
        else:
            menu.addSeparator()
    menu.popup(view.mapToGlobal(place))
