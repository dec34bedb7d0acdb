"""The File menu: opening projects and targets, saving, exporting."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from kirigami_studio.fabricate.material import Material
from kirigami_studio.foundation.resources import resource
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.command import Command
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.window.controller import Controller
from kirigami_studio.gui.window.unsaved_work import NEW_PROJECT, OTHER_PROJECT, PAIR, RECOVERED, SAMPLE
from kirigami_studio.project.document import Document
from kirigami_studio.project.labels import file_ending
from kirigami_studio.studio.making import Motion
from kirigami_studio.studio.projects import Leftover

if TYPE_CHECKING:
    from kirigami_studio.gui.window.main_window import MainWindow


class FileCommands(QObject):
    """Asks for files, and hands them to the controller."""

    def __init__(self, window: MainWindow, controller: Controller) -> None:
        super().__init__(window)
        self._window = window
        self._controller = controller

    def new_project(self) -> None:
        """Start an empty project."""
        self._window.unsaved.guard(NEW_PROJECT, self._controller.new_project)

    def ask_project(self) -> None:
        """Open a project of the user's choice."""
        self._window.unsaved.guard(OTHER_PROJECT, self._choose_project)

    def _choose_project(self) -> None:
        path = self._window.file_dialogs.project()
        if path is not None:
            self._controller.open_project(path)

    def ask_target(self) -> None:
        """Open a target file of the user's choice."""
        path = self._window.file_dialogs.target()
        if path is not None:
            self._controller.targeting.open(str(path))

    def ask_start(self) -> None:
        """Read a file of the user's choice as the start outline."""
        path = self._window.file_dialogs.start()
        if path is not None:
            self._controller.start.open(str(path))

    def ask_second(self) -> None:
        """Read a file of the user's choice as the second target."""
        path = self._window.file_dialogs.target()
        if path is not None:
            self._controller.second.open(str(path))

    def open(self, name: str) -> None:
        """Open a dropped, pasted or recent file: a project or a target."""
        if Path(name).suffix.lower() == ".kiri":
            self._window.unsaved.guard(OTHER_PROJECT, lambda: self._controller.open_project(Path(name)))
        else:
            self._controller.targeting.open(name)

    def open_design(self, document: Document, source: str) -> None:
        """Open the design that a cut file of this program carries; it is saved elsewhere."""
        self._window.unsaved.guard(OTHER_PROJECT, lambda: self._controller.open_design(document, source))

    def open_sample(self) -> None:
        """Open the bundled project; it is saved elsewhere."""
        self._window.unsaved.guard(SAMPLE, self._open_sample)

    def _open_sample(self) -> None:
        self._controller.open_project(resource("examples", "heart.kiri"))

    def open_pair(self, path: Path) -> None:
        """Open one of the bundled pairs; it is saved elsewhere."""
        self._window.unsaved.guard(PAIR, lambda: self._controller.open_project(path))

    def recover(self, leftover: Leftover) -> None:
        """Open what a session that ended unexpectedly has left."""
        self._window.unsaved.guard(RECOVERED, partial(self._controller.filing.recovery.recover, leftover))

    def animate(self, motion: Motion = Motion.AS_CUT) -> None:
        """Write the animation in a place of the user's choice; the ideal one says so in the name that is offered."""
        self._export(".gif" if motion is Motion.AS_CUT else "-ideal.gif", motion)

    def export(self, extension: str = "") -> None:
        """Write the cut file that suits the material, or another kind of file, in a place of the user's choice."""
        self._export(extension or self._window.fabrication.exports.extension, Motion.AS_CUT)

    def _export(self, ending: str, motion: Motion) -> None:
        if self._controller.stage is None:
            sentence = tr("No design to export yet. Generate one first.")
            self._window.messages.add(Message(sentence, Tone.HINT))
            return
        path = self._window.file_dialogs.export(f"{self._name}{ending}")
        if path is not None:
            self._controller.export(path, motion)

    @property
    def _name(self) -> str:
        """What files of the design on the stage are called: the project's name, then the design's."""
        stage = self._controller.stage
        label = None if stage is None else self._controller.document.label_of(stage.candidate)
        project = self._window.unsaved.name
        return project if label is None else f"{project}-{file_ending(label)}"

    def export_all(self) -> None:
        """Write everything that there is of the design into a folder of the user's choice."""
        folder = self._window.file_dialogs.folder()
        if folder is not None:
            self._controller.export_all(folder, self._name)

    def ask_artwork(self) -> None:
        """Lay a picture of the user's choice on the sheet."""
        path = self._window.file_dialogs.artwork()
        if path is not None:
            self._controller.artwork.open(path)

    def ask_second_artwork(self) -> None:
        """Let a second picture of the user's choice share the sheet."""
        path = self._window.file_dialogs.artwork()
        if path is not None:
            self._controller.artwork.open_second(path)

    def export_artwork(self) -> None:
        """Write the printed sheet into a folder of the user's choice; without artwork, offer to choose a picture."""
        if self._controller.document.artwork is None:
            self._window.dialogs.show_artwork()
            return
        folder = self._window.file_dialogs.folder()
        if folder is not None:
            self._controller.export_artwork(folder)

    def export_coupon(self, material: Material) -> None:
        """Write the calibration coupon of a material in a place of the user's choice."""
        path = self._window.file_dialogs.export(f"coupon-{material.key}.dxf")
        if path is not None:
            self._controller.cutting.export_coupon(material, path)


def commands(window: MainWindow) -> tuple[Command, ...]:
    """Return the commands of the File menu."""
    files, menu = window.files, tr("&File")
    return (
        Command(
            "new", menu, tr("&New project"), tr("Start an empty project"), files.new_project, shortcuts=("Ctrl+N",)
        ),
        Command(
            "open_project",
            menu,
            tr("Open &project …"),
            tr("Open a .kiri project"),
            files.ask_project,
            shortcuts=("Ctrl+Shift+O",),
            icon="project",
        ),
        Command(
            "recover",
            menu,
            tr("Reco&ver unsaved work …"),
            tr("Ask again about work that an earlier session left unsaved"),
            window.controller.filing.recovery.offer_again,
        ),
        Command(
            "save",
            menu,
            tr("&Save project"),
            tr("Save the project"),
            window.unsaved.save,
            shortcuts=("Ctrl+S",),
            icon="save",
        ),
        Command(
            "save_as",
            menu,
            tr("Save project &as …"),
            tr("Save the project under another name"),
            window.unsaved.save_as,
            shortcuts=("Ctrl+Shift+S",),
        ),
        Command(
            "open_target",
            menu,
            tr("&Open target …"),
            tr("Open a target silhouette"),
            files.ask_target,
            shortcuts=("Ctrl+O",),
            icon="open",
            gap=True,
        ),
        Command(
            "choose_parts",
            menu,
            tr("C&hoose parts …"),
            tr("Choose other parts of the target's drawing, or join them in another way"),
            window.controller.targeting.choose_parts,
            enabled_when=lambda now: now.has_parts,
        ),
        Command(
            "library",
            menu,
            tr("Target &library …"),
            tr("Choose a silhouette from the library"),
            window.dialogs.show_library,
            shortcuts=("Ctrl+L",),
            icon="library",
        ),
        Command(
            "pairs",
            menu,
            tr("E&xamples of pairs …"),
            tr("Open one of twelve finished designs that lead from one shape to another"),
            window.dialogs.show_pairs,
        ),
        Command(
            "export",
            menu,
            tr("Export &cut file …"),
            tr("Export a cut file in mm, or a picture"),
            files.export,
            shortcuts=("Ctrl+E",),
            icon="export",
            gap=True,
            enabled_when=lambda now: now.shows_design,
        ),
        Command(
            "export_all",
            menu,
            tr("Export &everything …"),
            tr("Export every file type to one folder"),
            files.export_all,
            shortcuts=("Ctrl+Shift+E",),
            enabled_when=lambda now: now.shows_design,
        ),
        Command(
            "export_artwork",
            menu,
            tr("Export art&work …"),
            tr("Export the picture on the sheet, in register with the cuts"),
            files.export_artwork,
            enabled_when=lambda now: now.shows_design,
        ),
        Command(
            "animation",
            menu,
            tr("Export an&imation …"),
            tr("Export a looping GIF of the sheet as cut: it stops where it jams"),
            files.animate,
        ),
        Command(
            "animation_ideal",
            menu,
            tr("Expor&t ideal animation …"),
            tr("Export a looping GIF of the ideal motion, with connectors of no width"),
            partial(files.animate, Motion.IDEAL),
        ),
        Command(
            "quit",
            menu,
            tr("&Quit"),
            tr("Close Kirigami Studio"),
            window.close,
            shortcuts=("Ctrl+Q",),
            gap=True,
        ),
    )
