"""Submenus: recent files, pictures of the views, the language of the window; and the context menus of views."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QAction, QActionGroup
from PySide6.QtWidgets import QMenu, QWidget, QWidgetAction

from kirigami_studio.foundation.words import languages, tr
from kirigami_studio.gui.files.picturing import SCALES, PictureMaker
from kirigami_studio.gui.files.recent_files import RecentFiles
from kirigami_studio.gui.make.cuts_page import CutsPage
from kirigami_studio.gui.target.target_panel import TargetPanel
from kirigami_studio.gui.target.target_view import TargetView
from kirigami_studio.gui.widgets.actions import CommandActions
from kirigami_studio.gui.widgets.language import NAMES, SYSTEM
from kirigami_studio.gui.widgets.layouts import label
from kirigami_studio.gui.window.appearance import Appearance
from kirigami_studio.gui.window.stage_panel import StagePanel
from kirigami_studio.project.recent import Recent

#: Commands by id, "" for a gap.  Those that cannot be given now are grey.
BOARD = (
    *("undo", "redo", "", "duplicate", "delete", "union", "difference", "intersection", "to_front", "to_back"),
    *("", "pose", "points", "polygon", "freehand", "rectangle", "ellipse", "regular", "star", "text"),
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


class PictureMenu(QMenu):
    """Export picture of: every view in sight, how large, and with or without overlays."""

    def __init__(self, parent: QWidget, picturing: PictureMaker, ask: Callable[[str], Path | None]) -> None:
        super().__init__(tr("Export picture o&f"), parent)
        self._picturing = picturing
        self._ask = ask
        self.menuAction().setStatusTip(tr("Export a view as PNG or SVG"))
        self.setToolTipsVisible(True)
        self.aboutToShow.connect(self.refresh)
        self.refresh()

    def refresh(self) -> None:
        """List the views in sight."""
        self.clear()
        for name, view in self._picturing.views().items():
            self.addAction(name.replace("&", "&&")).triggered.connect(partial(self._write, view, name))
        self.addSeparator()
        sizes = QActionGroup(self)
        for scale in SCALES:
            each = self.addAction(tr("&{scale}\N{MULTIPLICATION SIGN} size (PNG)", scale=scale))
            each.setToolTip(tr("{scale} PNG pixels per screen pixel", scale=scale))
            each.setCheckable(True)
            each.setChecked(scale == self._picturing.scale)
            each.triggered.connect(lambda _=False, scale=scale: setattr(self._picturing, "scale", scale))
            sizes.addAction(each)
        self.addSeparator()
        overlays = self.addAction(tr("Include &overlays"))
        overlays.setObjectName("pictureOverlays")
        overlays.setCheckable(True)
        overlays.setChecked(self._picturing.overlays)
        overlays.toggled.connect(lambda on: setattr(self._picturing, "overlays", on))

    def _write(self, view: QWidget, name: str, _: bool = False) -> None:
        path = self._ask(f"{name.lower()}.png")
        if path is not None:
            self._picturing.write(view, path)


class RecentMenu(QMenu):
    """Open recent: projects, then targets, each by its name; missing ones are grey."""

    def __init__(self, parent: QWidget, files: RecentFiles, take: Callable[[str], None]) -> None:
        super().__init__(tr("Open &recent"), parent)
        self._files = files
        self._take = take
        self.entries: dict[str, QAction] = {}
        self.setToolTipsVisible(True)
        self.menuAction().setStatusTip(tr("Recently used projects and targets"))
        self.aboutToShow.connect(files.look)
        files.changed.connect(self.show_recent)
        files.missing.connect(self.show_missing)
        self.show_recent(files.present)

    def show_recent(self, recent: Recent) -> None:
        """List these files."""
        self.clear()
        self.entries.clear()
        for title, paths in ((tr("Projects"), recent.projects), (tr("Targets"), recent.targets)):
            if paths:
                self.addAction(self._caption(title))
            for number, path in enumerate(paths, start=1):
                self._add(path, number, paths)
        self.addSeparator()
        forget = self.addAction(tr("&Clear list"))
        forget.setObjectName("clearRecent")
        forget.triggered.connect(lambda _=False: self._files.clear())
        self.menuAction().setEnabled(bool(self.entries))

    def show_missing(self, missing: frozenset[str]) -> None:
        """Offer what is there, in grey what is not."""
        for path, action in self.entries.items():
            action.setEnabled(path not in missing)
            action.setToolTip(tr("{path} no longer exists.", path=path) if path in missing else path)

    def _caption(self, title: str) -> QAction:
        """A heading in the menu; the style draws no titles of sections."""
        words, caption = label(title), QWidgetAction(self)
        words.setContentsMargins(12, 6, 12, 2)
        caption.setDefaultWidget(words)
        caption.setEnabled(False)
        return caption

    def _add(self, path: str, number: int, paths: tuple[str, ...]) -> None:
        name = Path(path).name
        if sum(Path(other).name == name for other in paths) > 1:
            name = tr("{name} in {folder}", name=name, folder=Path(path).parent.name)
        shown = name.replace("&", "&&")
        action = self.addAction(f"&{number % 10}  {shown}")
        action.setToolTip(path)
        action.setStatusTip(path)
        action.triggered.connect(lambda _=False: self._take(path))
        self.entries[path] = action


class LanguageMenu(QMenu):
    """The window's language: the desktop's, or one of those there are."""

    def __init__(self, parent: QWidget, appearance: Appearance) -> None:
        super().__init__(tr("Language"), parent)
        self._appearance = appearance
        self.choices: dict[str, QAction] = {}
        self.menuAction().setStatusTip(tr("Change the language of the window"))
        group = QActionGroup(self)
        for code in (SYSTEM, *languages()):
            name = tr("&System") if code == SYSTEM else NAMES.get(code, code)
            each = self.choices[code] = self.addAction(name)
            each.setCheckable(True)
            each.triggered.connect(lambda _=False, code=code: appearance.choose_language(code))
            group.addAction(each)
        self.aboutToShow.connect(self.refresh)
        self.refresh()

    def refresh(self) -> None:
        """Check the preferred language."""
        chosen = self.choices.get(self._appearance.language)
        if chosen is not None:
            chosen.setChecked(True)


def offer_context_menus(target: TargetPanel, stage: StagePanel, cuts: CutsPage, commands: CommandActions) -> None:
    """Give the views of target, stage and cuts their menus."""
    _offer(commands, stage.view, lambda: STAGE)
    _offer(commands, cuts.view, lambda: CUTS)
    _offer(commands, target.view, lambda: BOARD if target.editing else TARGET)


def _offer(commands: CommandActions, view: QWidget, names: Callable[[], tuple[str, ...]]) -> None:
    view.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
    view.customContextMenuRequested.connect(partial(_open, commands, view, names))


def _open(commands: CommandActions, view: QWidget, names: Callable[[], tuple[str, ...]], place: QPoint) -> None:
    if isinstance(view, TargetView):
        view.select_at(QPointF(place))
    commands.refresh()
    menu = QMenu(view)
    menu.setObjectName("contextMenu")
    menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    for name in names():
        if name:
            menu.addAction(commands[name])
        else:
            menu.addSeparator()
    menu.popup(view.mapToGlobal(place))
