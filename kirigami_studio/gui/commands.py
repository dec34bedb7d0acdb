"""What menus, shortcuts and file questions do: commands of the window to the controller."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path

from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import QAbstractButton, QComboBox

from kirigami_studio.foundation.resources import resource
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.actions import insert_menu
from kirigami_studio.gui.beside import Beside
from kirigami_studio.gui.controller import Controller
from kirigami_studio.gui.dressing import Dressing
from kirigami_studio.gui.files.pasting import PasteReader
from kirigami_studio.gui.files.picturing import PictureMaker
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.gui.panels.menus import PictureMenu, RecentMenu
from kirigami_studio.gui.shell import Shell
from kirigami_studio.gui.views.layout_view import USUAL, Overlay
from kirigami_studio.gui.views.target_view import Tool
from kirigami_studio.outlines.combining import Combine

OVERLAY_ACTIONS = {
    "show_target": Overlay.TARGET,
    "show_mismatch": Overlay.MISMATCH,
    "show_faults": Overlay.FAULTS,
    "show_ratios": Overlay.RATIOS,
    "show_openings": Overlay.OPENINGS,
    "show_small_parts": Overlay.SMALL_PARTS,
    "show_panel_numbers": Overlay.PANEL_NUMBERS,
    "show_void_numbers": Overlay.VOID_NUMBERS,
}


class Commands(Beside):
    """Carries out the window's actions; asks for files and guards unsaved work."""

    def __init__(self, window: Shell, controller: Controller) -> None:
        super().__init__(window, controller)
        self.recent = RecentMenu(window, controller.filing.recent, self.take_file)
        insert_menu(window, "save", self.recent)
        self.dressing = Dressing(window, controller.preferring)
        self.pasting = PasteReader(controller.session, self)
        self.pasting.file_wanted.connect(self.take_file)
        controller.filing.recovery.recover_wanted.connect(
            lambda leftover: self.guard(
                tr("recover another project"), partial(controller.filing.recovery.recover, leftover)
            )
        )
        self.picturing = PictureMaker(window, controller.session, controller.cutting)
        self.pictures = PictureMenu(window, self.picturing, lambda proposal: self.files.picture(proposal))
        insert_menu(window, "animation", self.pictures)
        controller.filing.materials.material_added.connect(self.take_materials)
        self._closing = self._quit_when_saved = False
        controller.saved.connect(lambda _: self._saved())
        controller.filing.projects.save_failed.connect(self._stay)
        self._connect_actions()

    def _connect_actions(self) -> None:
        window, controller, actions = self.window, self.controller, self.window.actions_
        bar = window.stage.deployment
        commands: dict[str, Callable[[], object]] = {
            "new": lambda: self.guard(tr("start a new project"), controller.new_project),
            "open_project": lambda: self.guard(tr("open another project"), self.ask_project),
            "save": self.save,
            "save_as": self.save_as,
            "open_target": self.ask_target,
            "library": self.show_library,
            "export": self.export,
            "export_all": self.export_all,
            "materials": self.show_materials,
            "animation": partial(self.export, ".gif"),
            "copy_picture": lambda: self.picturing.copy(self.picturing.view_at_work()),
            "copy_cuts": self.picturing.copy_cuts,
            "quit": window.close,
            "undo": controller.undo,
            "redo": controller.redo,
            "history": self.show_history,
            "paste": lambda: self.pasting.take(QGuiApplication.clipboard().mimeData()),
            "edit_target": window.target.buttons["edit"].click,
            "mode_new": partial(self._set_mode, Combine.REPLACE),
            "mode_add": partial(self._set_mode, Combine.ADD),
            "mode_subtract": partial(self._set_mode, Combine.SUBTRACT),
            "axis": self._cycle_axis,
            "grid": window.target.tools.grid.click,
            "clear": controller.targeting.clear,
            "generate": controller.generation.generate,
            "cancel": controller.cancel,
            "trim": window.stage.trim.click,
            "before": window.stage.before.click,
            "next": partial(self._walk, 1),
            "previous": partial(self._walk, -1),
            "play": self._play,
            "slower": partial(bar.options.change_speed, -1),
            "faster": partial(bar.options.change_speed, 1),
            "play_mode": bar.options.next_mode,
            "next_fault": partial(window.stage.tour.step, 1),
            "previous_fault": partial(window.stage.tour.step, -1),
            "to_flat": partial(bar.set_phi, math.pi),
            "to_target": self._to_target,
            "cuts": window.stage.cuts_switch.click,
            "plots": window.stage.plots_switch.click,
            "fit": window.stage.fit,
            "theme": self.dressing.switch,
            "theme_system": self.dressing.follow,
            "guide": self.show_guide,
            "shortcuts": self.show_shortcuts,
            "tour": self.tour.start,
            "sample": lambda: self.guard(tr("open the sample project"), self.open_sample),
        }
        for name, command in commands.items():
            actions[name].triggered.connect(lambda _=False, command=command: command())
        for tool in set(Tool) - {Tool.LOOK}:
            actions[tool.value].triggered.connect(partial(self._take_tool, tool))
        for name, overlay in OVERLAY_ACTIONS.items():
            actions[name].setChecked(overlay in USUAL)
            actions[name].toggled.connect(partial(window.stage.set_overlay, overlay))
            window.stage.overlay_menu.addAction(actions[name])
        window.target.editing_changed.connect(self._give_mode_keys)
        self._give_mode_keys(window.target.editing)

    def _give_mode_keys(self, editing: bool) -> None:
        """The keys of adding and taking away hold on the board only: elsewhere + and - change a ratio."""
        for name in ("mode_new", "mode_add", "mode_subtract"):
            self.window.actions_[name].setEnabled(editing)

    def _take_tool(self, tool: Tool, _: bool = False) -> None:
        if self.window.target.tools.buttons[tool].isEnabled():
            self.window.target.set_tool(tool)
        else:
            self.controller.session.post(Message(tr("No target to edit yet. Draw or open one first."), Tone.HINT))

    def _set_mode(self, mode: Combine) -> None:
        if self.window.target.tools.modes[mode].isEnabled():
            self.window.target.set_editing(True)
            self.window.target.tools.set_mode(mode)

    def _cycle_axis(self) -> None:
        self.window.target.set_editing(True)
        self.window.target.tools.axis.cycle()

    def ask_target(self) -> None:
        """Open a target file of the user's choice."""
        path = self.files.target()
        if path is not None:
            self.controller.targeting.open(str(path))

    def take_file(self, name: str) -> None:
        """Open a dropped file: a project or a target."""
        if Path(name).suffix.lower() == ".kiri":
            self.guard(tr("open another project"), lambda: self.controller.open_project(Path(name)))
        else:
            self.controller.targeting.open(name)

    def ask_project(self) -> None:
        """Open a project of the user's choice."""
        path = self.files.project()
        if path is not None:
            self.controller.open_project(path)

    def save(self) -> bool:
        """Save where the project lives; ask when it has no place yet.  False if the user thought better of it."""
        if self.controller.path is None:
            return self.save_as()
        self.controller.save(self.controller.path)
        return True

    def save_as(self) -> bool:
        """Save in a place of the user's choice; False if there is none."""
        path = self.files.save(f"{self._name()}.kiri")
        if path is not None:
            self.controller.save(path)
        return path is not None

    def export(self, extension: str = ".dxf") -> None:
        """Write the cut file, or another kind of file, in a place of the user's choice."""
        if self.controller.stage is None:
            self.controller.session.post(Message(tr("No design to export yet. Generate one first."), Tone.HINT))
            return
        path = self.files.export(f"{self._name()}{extension}")
        if path is not None:
            self.controller.export(path)

    def export_all(self) -> None:
        """Write everything that there is of the design into a folder of the user's choice."""
        folder = self.files.folder()
        if folder is not None:
            self.controller.export_all(folder, self._name())

    def open_sample(self) -> None:
        """Open the bundled project; it is saved elsewhere."""
        self.controller.open_project(resource("examples", "heart.kiri"))

    def _play(self) -> None:
        """Space plays, unless the keyboard's focus is on a button or a list of choices, which own the key by custom.

        The mouse gives none of them the focus, so after a click Space plays.
        """
        focused = self.window.focusWidget()
        if isinstance(focused, QAbstractButton):
            focused.click()
        elif isinstance(focused, QComboBox):
            focused.showPopup()
        elif self.window.stage.player.play.isEnabled():
            self.window.stage.player.play.toggle()

    def _to_target(self) -> None:
        stage = self.controller.stage
        if stage is not None:
            self.window.stage.deployment.set_phi(stage.design.phi_target)

    def _walk(self, step: int) -> None:
        view = self.window.gallery.view
        row = view.currentIndex().row() + step
        if 0 <= row < view.model_.rowCount():
            view.setCurrentIndex(view.model_.index(row, 0))

    # unsaved work --------------------------------------------------------------------------------------------------

    def guard(self, purpose: str, then: Callable[[], None]) -> None:
        """Do something that forgets the document; with unsaved changes ask in the message bar first."""
        if self.controller.hand.postpones(lambda: self.guard(purpose, then)):
            return
        if not self.controller.history.unsaved:
            then()
            return
        self.controller.session.post(
            Message(
                tr("This project has unsaved changes. Save before you {purpose}?", purpose=purpose),
                Tone.WARNING,
                actions=(
                    (tr("Save first"), self._save_first),
                    (tr("{capitalize} without saving", capitalize=purpose.capitalize()), then),
                ),
            )
        )

    def may_close(self) -> bool:
        """Whether the window may close now; asks in the message bar when work would be lost."""
        if self.controller.hand.postpones(self.window.close):
            return False
        if self._closing or not self.controller.history.unsaved:
            return True
        self.controller.session.post(
            Message(
                tr("This project has unsaved changes. Save before you quit?"),
                Tone.WARNING,
                actions=((tr("Save and quit"), self._save_and_quit), (tr("Quit without saving"), self._quit)),
            )
        )
        return False

    def _save_first(self) -> None:
        self.save()

    def _save_and_quit(self) -> None:
        self._quit_when_saved = True
        if not self.save():
            self._quit_when_saved = False

    def _saved(self) -> None:
        if self._quit_when_saved:
            self._quit_when_saved = False
            self.window.close()  # which asks again if the work went on while the file was written

    def _stay(self) -> None:
        """The project could not be saved: a later save is no wish to quit."""
        self._quit_when_saved = False

    def _quit(self) -> None:
        self._closing = True
        self.window.close()

    def _name(self) -> str:
        if self.controller.path is not None:
            return self.controller.path.stem
        target = self.controller.document.target
        return target.name if target is not None else "untitled"
