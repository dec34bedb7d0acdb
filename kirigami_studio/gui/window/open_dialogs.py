"""The dialogs of a window: opened on demand, kept, and closed with it.  None of them blocks the window."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QRect, Qt, QUrl, Signal
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QWidget

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.command import Command
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.widgets.number_field import leave_wheel
from kirigami_studio.gui.window.appearance import Appearance
from kirigami_studio.gui.window.file_commands import FileCommands
from kirigami_studio.gui.window.services import Services
from kirigami_studio.studio.making import ExportedFiles

if TYPE_CHECKING:
    from kirigami_studio.gui.gallery.label_editor import LabelEditor
    from kirigami_studio.gui.make.export_report import ExportReport
    from kirigami_studio.gui.make.print_dialog import PrintDialog
    from kirigami_studio.gui.make.shelf_editors import MaterialEditor
    from kirigami_studio.gui.stage.artwork_editor import ArtworkEditor
    from kirigami_studio.gui.target.outline_board import OutlineBoard, StartBoard
    from kirigami_studio.gui.target.part_picker import PartPicker
    from kirigami_studio.gui.target.silhouette_picker import SilhouettePicker
    from kirigami_studio.gui.window.about import AboutWindow
    from kirigami_studio.gui.window.guide import GuideWindow
    from kirigami_studio.gui.window.history_list import HistoryList
    from kirigami_studio.gui.window.shortcut_sheet import ShortcutSheet
    from kirigami_studio.outlines.outline import Outline
    from kirigami_studio.studio.parts import PartsRead, Purpose


class Dialogs(QObject):
    """Opens each dialog of one window; its module is imported when it is first wanted.

    Parameters
    ----------
    window : QWidget
        The parent of the dialogs.
    library_button : QWidget
        The library opens below it.
    commands : callable
        All commands of the window.
    """

    materials_changed = Signal()  #: those on disk

    def __init__(
        self,
        window: QWidget,
        services: Services,
        files: FileCommands,
        appearance: Appearance,
        *,
        library_button: QWidget,
        commands: Callable[[], tuple[Command, ...]],
    ) -> None:
        super().__init__(window)
        self._window, self._services, self._files, self._appearance = window, services, files, appearance
        self._library_button, self._commands = library_button, commands
        self.guide: GuideWindow | None = None
        self.picker: SilhouettePicker | None = None
        self.report: ExportReport | None = None
        self.printing: PrintDialog | None = None
        self.materials: MaterialEditor | None = None
        self.history: HistoryList | None = None
        self.shortcuts: ShortcutSheet | None = None
        self.about: AboutWindow | None = None
        self.start_board: StartBoard | None = None
        self.second_board: OutlineBoard | None = None
        self.parts: PartPicker | None = None
        self._on_parts: Callable[[Outline, bool], None] = services.targeting.reader.take_chosen
        self.artwork: ArtworkEditor | None = None
        self.label: LabelEditor | None = None

    def show_materials(self) -> None:
        """Open the material editor, or bring it to the front."""
        from kirigami_studio.gui.make.shelf_editors import MaterialEditor

        key = self._services.session.document.fabrication.material
        if self.materials is None:
            self.materials = MaterialEditor(self._window, key)
            self.materials.contents_changed.connect(self.materials_changed)
            self.materials.coupon_wanted.connect(self._files.export_coupon)
        self.materials.choose(key)
        bring_to_front(self.materials)

    def show_report(self, exported: ExportedFiles) -> None:
        """Show what two readers found in a written cut file, in the place of an earlier report."""
        from kirigami_studio.gui.make.export_report import ExportReport

        self.close_report()
        if not exported.verifications:
            return
        self.report = ExportReport(self._window, exported.verifications, self._appearance.palette, exported.verdict)
        self.report.folder_wanted.connect(show_in_folder)
        self.report.open_wanted.connect(self.open_in_program)
        self.report.show()

    def open_in_program(self, path: Path) -> None:
        """Let the desktop open a written file in its program, such as LightBurn for its projects."""
        if not QDesktopServices.openUrl(QUrl.fromLocalFile(str(path))):
            sentence = tr(
                "No program is set up for {kind} files. Open {name} in the program of your machine.",
                **kind_and_name(path),
            )
            self._services.session.post(Message(sentence, Tone.WARNING, str(path)))

    def show_print(self) -> None:
        """Show the cut sheet on paper, as it is printed, or bring that to the front."""
        from kirigami_studio.gui.make.print_dialog import PrintDialog

        planner = self._services.cutting
        if self.printing is None:
            self.printing = PrintDialog(self._window, self._services.session.queue)
            self.printing.changed.connect(lambda changes: self._services.fabrication.change(**changes))
            self.printing.pdf_wanted.connect(lambda: self._files.export(".pdf"))
            planner.planned.connect(self._update_print)
            planner.refused.connect(lambda _: self._update_print())
        bring_to_front(self.printing)
        self._update_print()

    def _update_print(self) -> None:
        if self.printing is not None and self.printing.isVisible():
            self.printing.show_plan(self._services.cutting.made, self._services.session.document.fabrication)

    def close_report(self) -> None:
        """Close the report, if there is one."""
        if self.report is not None:
            self.report.close()
            self.report.deleteLater()
            self.report = None

    def show_history(self) -> None:
        """Open the list of all steps, or bring it to the front."""
        from kirigami_studio.gui.window.history_list import HistoryList

        if self.history is None:
            self.history = HistoryList(self._window)
            self.history.step_wanted.connect(self._services.project.go_to)
            self._services.session.document_changed.connect(self._update_history)
        self.history.show()
        self._update_history()
        bring_to_front(self.history)

    def _update_history(self) -> None:
        if self.history is not None and self.history.isVisible():
            self.history.show_history(self._services.session.history, self._appearance.palette)

    def show_library(self) -> None:
        """Open the popup with the library's silhouettes, for the target."""
        self._pick_silhouette(self._services.targeting.open, self._library_button)

    def show_start_library(self, below: QWidget) -> None:
        """Open it for the start outline, below what was clicked."""
        self._pick_silhouette(self._services.start.open, below)

    def show_start_board(self) -> None:
        """Open the board that the start is drawn on, with the present start."""
        from kirigami_studio.gui.target.outline_board import StartBoard

        if self.start_board is None:
            self.start_board = StartBoard(self._window)
            self.start_board.taken.connect(self._services.start.take)
            self.start_board.check_wanted.connect(self._services.start.check)
            self._services.start.checked.connect(self.start_board.show_check)
            self._appearance.colour(self.start_board)
        self.start_board.begin(self._services.session.document.settings.start.outline)
        bring_to_front(self.start_board)

    def show_second_library(self, below: QWidget) -> None:
        """Open the popup with the library's silhouettes for the second target, below what was clicked."""
        self._pick_silhouette(self._services.second.open, below)

    def show_second_board(self) -> None:
        """Open the board that the second target is drawn on, with the present one."""
        from kirigami_studio.gui.target.outline_board import SECOND_WORDS, OutlineBoard

        if self.second_board is None:
            self.second_board = OutlineBoard(self._window, SECOND_WORDS)
            self.second_board.taken.connect(self._services.second.take)
            self._appearance.colour(self.second_board)
        second = self._services.session.document.settings.second
        self.second_board.begin(None if second is None else second.outline)
        bring_to_front(self.second_board)

    def show_parts(self, purpose: Purpose, take: Callable[[Outline, bool], None], read: PartsRead) -> None:
        """Ask which parts of a drawing are the target, the start or the second target."""
        from kirigami_studio.gui.target.part_picker import PartPicker

        if self.parts is None:
            session = self._services.session
            self.parts = PartPicker(self._window, self._services.session.queue)
            self.parts.taken.connect(lambda outline, usual: self._on_parts(outline, usual))
            self.parts.pieces_taken.connect(self._services.targeting.reader.take_pieces)
            self.parts.rejected.connect(lambda: session.set_status(tr("No part was taken; nothing changed.")))
        self._on_parts = take
        self.parts.begin(read, purpose)
        self._appearance.colour(self.parts)
        bring_to_front(self.parts)

    def show_artwork(self) -> None:
        """Open the window that lays a picture on the sheet, or bring it to the front."""
        from kirigami_studio.gui.stage.artwork_editor import ArtworkEditor

        if self.artwork is None:
            keeper = self._services.artwork
            self.artwork = ArtworkEditor(self._window)
            self.artwork.choose.clicked.connect(self._files.ask_artwork)
            self.artwork.remove.clicked.connect(keeper.remove)
            self.artwork.second.clicked.connect(self._files.ask_second_artwork)
            self.artwork.remove_second.clicked.connect(keeper.remove_second)
            self.artwork.stripes_wanted.connect(keeper.share)
            self.artwork.changed.connect(lambda changes: keeper.place(**changes))
            self.artwork.edited.connect(self._services.session.history.end_drag)
            self.artwork.export.clicked.connect(self.export_artwork)
            self._services.session.document_changed.connect(self._update_artwork)
            self._services.session.display.stage_changed.connect(self._update_artwork)
        self._update_artwork()
        bring_to_front(self.artwork)

    def export_artwork(self) -> None:
        """Write the printed sheet into a folder; without artwork, offer to choose a picture."""
        if self._services.session.document.artwork is None:
            self.show_artwork()
        else:
            self._files.export_artwork()

    def _update_artwork(self) -> None:
        if self.artwork is not None:
            self.artwork.show_artwork(self._services.session.document.artwork, self._services.session.stage is not None)

    def _pick_silhouette(self, take: Callable[[str], None], below: QWidget) -> None:
        from kirigami_studio.gui.target.silhouette_picker import SilhouettePicker

        self.picker = SilhouettePicker(self._window, self._appearance.palette)
        self.picker.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.picker.chosen.connect(take)
        self.picker.show_below(below)

    def show_label(self, candidate: Candidate | None, beside: QRect) -> None:
        """Open the name and the note of a design beside a place on the screen."""
        from kirigami_studio.gui.gallery.label_editor import LabelEditor

        label = self._services.labels.of(candidate)
        if label is None:
            return
        self.label = LabelEditor(self._window, label, partial(self._services.labels.set, label))
        self.label.destroyed.connect(self._forget_label)
        self.label.show_beside(beside)

    def _forget_label(self) -> None:
        self.label = None

    def show_guide(self) -> None:
        """Open the guide, or bring it to the front."""
        from kirigami_studio.gui.window.guide import GuideWindow

        if self.guide is None:
            self.guide = GuideWindow(self._window)
        bring_to_front(self.guide)

    def show_shortcuts(self) -> None:
        """Open the sheet of keys and gestures, or bring it to the front."""
        from kirigami_studio.gui.window.shortcut_sheet import ShortcutSheet

        if self.shortcuts is None:
            self.shortcuts = ShortcutSheet(self._window, self._commands())
        bring_to_front(self.shortcuts)
        self.shortcuts.search.setFocus()

    def show_about(self) -> None:
        """Open the window with version and licences, or bring it to the front."""
        from kirigami_studio.gui.window.about import AboutWindow

        if self.about is None:
            self.about = AboutWindow(self._window)
        bring_to_front(self.about)

    def close(self) -> None:
        """The window is closing, and its dialogs with it."""
        self.close_report()
        asking = (self.start_board, self.second_board, self.parts)
        read = (self.guide, self.history, self.shortcuts, self.about)
        for dialog in (self.materials, self.printing, *read, *asking, self.artwork):
            if dialog is not None:
                dialog.close()


def bring_to_front(dialog: QWidget) -> None:
    """Show a dialog over the others and give it the keyboard."""
    leave_wheel(dialog)
    dialog.show()
    dialog.raise_()
    dialog.activateWindow()


def kind_and_name(path: Path) -> dict[str, str]:
    """The kind of a file, as in its name, and the name."""
    return {"kind": path.suffix, "name": path.name}


def show_in_folder(path: Path) -> None:
    """Let the desktop show the folder that a written file lies in, or a written folder itself."""
    folder = path if path.is_dir() else path.parent
    QDesktopServices.openUrl(QUrl.fromLocalFile(str(folder)))
