"""The File menu: opening projects and targets, saving, exporting."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from operator import attrgetter
from pathlib import Path

from PySide6.QtCore import QObject

from kirigami_studio.fabricate.material import Material
from kirigami_studio.foundation.resources import resource
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.files.file_dialogs import FileDialogs, FileToOpen
from kirigami_studio.gui.files.open_project import OpenProject
from kirigami_studio.gui.make.export_row import ExportRow
from kirigami_studio.gui.session.command import Command
from kirigami_studio.gui.target.targeting import Targeting
from kirigami_studio.gui.window.services import Services
from kirigami_studio.gui.window.unsaved_work import NEW_PROJECT, OTHER_PROJECT, PAIR, RECOVERED, SAMPLE, UnsavedWork
from kirigami_studio.project.document import Document
from kirigami_studio.project.labels import file_ending
from kirigami_studio.studio.making import Motion, Output, writes_layers
from kirigami_studio.studio.projects import Leftover


class FileCommands(QObject):
    """Asks for files, and hands them to the places.

    Parameters
    ----------
    unsaved : UnsavedWork
        Is asked before another project replaces this one.
    exports : ExportRow
        Has the kind of file that suits the material.
    """

    def __init__(
        self, services: Services, unsaved: UnsavedWork, ask: FileDialogs, exports: ExportRow, parent: QObject
    ) -> None:
        super().__init__(parent)
        self._services, self._unsaved, self._ask, self._exports = services, unsaved, ask, exports

    def new_project(self) -> None:
        """Start an empty project."""
        self._unsaved.guard(NEW_PROJECT, self._services.project.new)

    def ask_project(self) -> None:
        """Open a project of the user's choice."""
        self._unsaved.guard(OTHER_PROJECT, self._choose_project)

    def _choose_project(self) -> None:
        self._ask_for(FileToOpen.PROJECT, self._services.project.open)

    def _ask_for(self, wanted: FileToOpen, take: Callable[[Path], None]) -> None:
        path = self._ask.open(wanted)
        if path is not None:
            take(path)

    def ask_target(self) -> None:
        """Open a target file of the user's choice."""
        self._ask_for(FileToOpen.TARGET, lambda path: self._services.targeting.open(str(path)))

    def ask_start(self) -> None:
        """Read a file of the user's choice as the start outline."""
        self._ask_for(FileToOpen.START, lambda path: self._services.start.open(str(path)))

    def ask_second(self) -> None:
        """Read a file of the user's choice as the second target."""
        self._ask_for(FileToOpen.TARGET, lambda path: self._services.second.open(str(path)))

    def open(self, name: str) -> None:
        """Open a dropped, pasted or recent file: a project or a target."""
        if Path(name).suffix.lower() == ".kiri":
            self._unsaved.guard(OTHER_PROJECT, lambda: self._services.project.open(Path(name)))
        else:
            self._services.targeting.open(name)

    def open_design(self, document: Document, source: str) -> None:
        """Open the design that a cut file of this program carries; it is saved elsewhere."""
        self._unsaved.guard(OTHER_PROJECT, lambda: self._services.project.open_design(document, source))

    def open_sample(self) -> None:
        """Open the bundled project; it is saved elsewhere."""
        self._unsaved.guard(SAMPLE, self._open_sample)

    def _open_sample(self) -> None:
        # a method, so that two questions about it are equal, and the second is not asked beside the first
        self._services.project.open(resource("examples", "heart.kiri"))

    def open_pair(self, path: Path) -> None:
        """Open one of the bundled pairs; it is saved elsewhere."""
        self._unsaved.guard(PAIR, lambda: self._services.project.open(path))

    def recover(self, leftover: Leftover) -> None:
        """Open what a session that ended unexpectedly has left."""
        self._unsaved.guard(RECOVERED, partial(self._services.project.recovery.recover, leftover))

    def animate(self, motion: Motion = Motion.AS_CUT) -> None:
        """Write the animation in a place of the user's choice; the ideal one says so in the name that is offered."""
        self._export(".gif" if motion is Motion.AS_CUT else "-ideal.gif", motion)

    def export(self, extension: str = "") -> None:
        """Write the cut file that suits the material, or another kind of file, in a place of the user's choice."""
        self._export(extension or self._exports.extension, Motion.AS_CUT)

    def _export(self, ending: str, motion: Motion) -> None:
        if self._services.session.stage is None:
            self._services.session.hint(tr("No design to export yet. Generate one first."))
            return
        proposal, request = f"{self._name}{ending}", self._services.cutting.request
        path = self._ask.export(proposal, request is not None and writes_layers(request, Output(Path(proposal))))
        if path is not None:
            self._services.exporter.export(path, motion)

    @property
    def _name(self) -> str:
        """What files of the design on the stage are called: the project's name, then the design's."""
        stage = self._services.session.stage
        label = None if stage is None else self._services.session.document.label_of(stage.candidate)
        project = self._unsaved.name
        return project if label is None else f"{project}-{file_ending(label)}"

    def export_all(self) -> None:
        """Write everything that there is of the design into a folder of the user's choice."""
        folder = self._ask.folder()
        if folder is not None:
            self._services.exporter.export_all(folder, self._name)

    def ask_artwork(self) -> None:
        """Lay a picture of the user's choice on the sheet."""
        self._ask_for(FileToOpen.ARTWORK, self._services.artwork.open)

    def ask_second_artwork(self) -> None:
        """Let a second picture of the user's choice share the sheet."""
        self._ask_for(FileToOpen.ARTWORK, self._services.artwork.open_second)

    def export_artwork(self) -> None:
        """Write the printed sheet into a folder of the user's choice."""
        folder = self._ask.folder()
        if folder is not None:
            self._services.exporter.export_artwork(folder)

    def export_coupon(self, material: Material) -> None:
        """Write the calibration coupon of a material in a place of the user's choice."""
        path = self._ask.export(f"coupon-{material.key}.dxf")
        if path is not None:
            self._services.exporter.export_coupon(material, path)


def commands(
    files: FileCommands,
    unsaved: UnsavedWork,
    *,
    project: OpenProject,
    targeting: Targeting,
    show_library: Callable[[], None],
    show_pairs: Callable[[], None],
    export_artwork: Callable[[], None],
    show_print: Callable[[], None],
    close: Callable[[], object],
) -> tuple[Command, ...]:
    """Return the commands of the File menu."""
    command = partial(Command, tr("&File"))
    sheet = partial(command, enabled_when=attrgetter("shows_design"))
    recover = tr("Ask again about work that an earlier session left unsaved")
    parts = tr("Choose other parts of the target's drawing, or join them in another way")
    pairs = tr("Open one of twelve finished designs that lead from one shape to another")
    artwork = tr("Export the picture on the sheet, in register with the cuts")
    moving = tr("Export a looping GIF of the sheet as cut: it stops where it jams")
    ideal = tr("Export a looping GIF of the ideal motion, with connectors of no width")
    save_as, cut = tr("Save the project under another name"), tr("Export a cut file in mm, or a picture")
    library, every = tr("Choose a silhouette from the library"), tr("Export every file type to one folder")
    return (
        command("new", tr("&New project"), tr("Start an empty project"), files.new_project, "Ctrl+N"),
        command(
            "open_project",
            tr("Open &project …"),
            tr("Open a .kiri project"),
            files.ask_project,
            "Ctrl+Shift+O",
            "project",
        ),
        command("recover", tr("Reco&ver unsaved work …"), recover, project.recovery.offer_again),
        command("save", tr("&Save project"), tr("Save the project"), unsaved.save, "Ctrl+S", "save"),
        command("save_as", tr("Save project &as …"), save_as, unsaved.save_as, "Ctrl+Shift+S"),
        command(
            "open_target",
            tr("&Open target …"),
            tr("Open a target silhouette"),
            files.ask_target,
            "Ctrl+O",
            "open",
            gap=True,
        ),
        command(
            "choose_parts", tr("C&hoose parts …"), parts, targeting.choose_parts, enabled_when=attrgetter("has_parts")
        ),
        command("library", tr("Target &library …"), library, show_library, "Ctrl+L", "library"),
        command("pairs", tr("E&xamples of pairs …"), pairs, show_pairs),
        sheet("export", tr("Export &cut file …"), cut, files.export, "Ctrl+E", "export", gap=True),
        sheet("export_all", tr("Export &everything …"), every, files.export_all, "Ctrl+Shift+E"),
        sheet("export_artwork", tr("Export art&work …"), artwork, export_artwork),
        command(
            "share",
            tr("Share as a pa&ge …"),
            tr("One file that moves in every browser, with the project inside"),
            partial(files.export, ".html"),
        ),
        sheet(
            "print",
            tr("Print …"),
            tr("Print the cut sheet at true size, or see its pages"),
            show_print,
            "Ctrl+P",
            "print",
        ),
        command("animation", tr("Export an&imation …"), moving, files.animate),
        command("animation_ideal", tr("Expor&t ideal animation …"), ideal, partial(files.animate, Motion.IDEAL)),
        command("quit", tr("&Quit"), tr("Close Kirigami Studio"), close, "Ctrl+Q", gap=True),
    )
