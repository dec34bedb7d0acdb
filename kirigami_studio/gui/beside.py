"""What opens beside the window and blocks nothing: editors, reports, lists, the guide and the tour."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Qt, QUrl
from PySide6.QtGui import QDesktopServices

from kirigami_studio.gui.controller import Controller
from kirigami_studio.gui.dialogs.files import FileChoosers, FileQuestions
from kirigami_studio.gui.jobs.cut_jobs import Exported
from kirigami_studio.gui.shell import Shell
from kirigami_studio.gui.tour import Tour

if TYPE_CHECKING:
    from kirigami_studio.fabricate.material import Material
    from kirigami_studio.gui.dialogs.export_report import ExportReport
    from kirigami_studio.gui.dialogs.help import GuideWindow, ShortcutSheet
    from kirigami_studio.gui.dialogs.material_editor import MaterialEditor
    from kirigami_studio.gui.dialogs.silhouette_picker import SilhouettePicker
    from kirigami_studio.gui.panels.history_list import HistoryList


class Beside(QObject):
    """Opens each of them on demand, keeps it, and closes all of them with the window."""

    def __init__(self, window: Shell, controller: Controller) -> None:
        super().__init__(window)
        self.window = window
        self.controller = controller
        self.files: FileQuestions = FileChoosers(window)
        self.tour = Tour(window, controller)
        self.guide: GuideWindow | None = None
        self.picker: SilhouettePicker | None = None
        self.report: ExportReport | None = None
        self.materials: MaterialEditor | None = None
        self.history: HistoryList | None = None
        self.shortcuts: ShortcutSheet | None = None

    def show_materials(self) -> None:
        """Open the material editor, or bring it to the front."""
        from kirigami_studio.gui.dialogs.material_editor import MaterialEditor

        key = self.controller.document.fabrication.material
        if self.materials is None:
            self.materials = MaterialEditor(self.window, key)
            self.materials.stock_changed.connect(self.take_materials)
            self.materials.coupon_wanted.connect(self.export_coupon)
        self.materials.choose(key)
        self.materials.show()
        self.materials.raise_()
        self.materials.activateWindow()

    def take_materials(self, key: str) -> None:
        """The stock of materials has changed."""
        self.window.fabrication.reload_materials()
        self.controller.replan()

    def export_coupon(self, material: Material) -> None:
        """Write the calibration coupon of a material in a place of the user's choice."""
        path = self.files.export(f"coupon-{material.key}.dxf")
        if path is not None:
            self.controller.cutting.export_coupon(material, path)

    def show_report(self, exported: Exported) -> None:
        """Show what two readers found in a written cut file, in the place of an earlier report."""
        from kirigami_studio.gui.dialogs.export_report import ExportReport

        self.close_report()
        if not exported.verifications:
            return
        self.report = ExportReport(self.window, exported.verifications, self.window.palette_)
        self.report.folder_wanted.connect(show_in_folder)
        self.report.show()

    def close_report(self) -> None:
        """Close the report, if there is one."""
        if self.report is not None:
            self.report.close()
            self.report.deleteLater()
            self.report = None

    def close_dialogs(self) -> None:
        """The window is closing: what stands beside it goes with it."""
        self.tour.end()
        self.close_report()
        for dialog in (self.materials, self.guide, self.history, self.shortcuts):
            if dialog is not None:
                dialog.close()

    def show_history(self) -> None:
        """Open the list of all steps, or bring it to the front."""
        from kirigami_studio.gui.panels.history_list import HistoryList

        if self.history is None:
            self.history = HistoryList(self.window)
            self.history.step_wanted.connect(self.controller.go_to)
            self.controller.session.document_changed.connect(self._update_history)
        self.history.show()
        self._update_history()
        self.history.raise_()
        self.history.activateWindow()

    def _update_history(self) -> None:
        if self.history is not None and self.history.isVisible():
            self.history.show_history(self.controller.history, self.window.palette_)

    def show_library(self) -> None:
        """Open the popup with the library's silhouettes."""
        from kirigami_studio.gui.dialogs.silhouette_picker import SilhouettePicker

        self.picker = SilhouettePicker(self.window, self.window.palette_)
        self.picker.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.picker.chosen.connect(self.controller.targeting.open)
        self.picker.show_below(self.window.target.buttons["library"])

    def show_guide(self) -> None:
        """Open the guide, or bring it to the front."""
        from kirigami_studio.gui.dialogs.help import GuideWindow

        if self.guide is None:
            self.guide = GuideWindow(self.window)
        self.guide.show()
        self.guide.raise_()
        self.guide.activateWindow()

    def show_shortcuts(self) -> None:
        """Open the sheet of keys and gestures, or bring it to the front."""
        from kirigami_studio.gui.dialogs.help import ShortcutSheet

        if self.shortcuts is None:
            self.shortcuts = ShortcutSheet(self.window)
        self.shortcuts.show()
        self.shortcuts.raise_()
        self.shortcuts.activateWindow()
        self.shortcuts.search.setFocus()


def show_in_folder(path: Path) -> None:
    """Let the desktop show the folder that a written file lies in, or a written folder itself."""
    folder = path if path.is_dir() else path.parent
    QDesktopServices.openUrl(QUrl.fromLocalFile(str(folder)))
