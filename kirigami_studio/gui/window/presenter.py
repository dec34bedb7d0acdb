"""The window as a whole: its title, messages and status line, and the connections of its parts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.all_designs_presenter import AllDesignsConnections
from kirigami_studio.gui.gallery.gallery_presenter import DesignConnections
from kirigami_studio.gui.gallery.side_by_side import SideBySide
from kirigami_studio.gui.stage.stage_presenter import StageConnections, VoidConnections
from kirigami_studio.gui.target.target_presenter import SecondConnections, StartConnections, TargetConnections
from kirigami_studio.gui.window.controller import Controller
from kirigami_studio.gui.window.first_start import FirstStart
from kirigami_studio.project.document import Document
from kirigami_studio.studio.targets import TargetReading

if TYPE_CHECKING:
    from kirigami_studio.gui.window.main_window import MainWindow


class Connections(QObject):
    """Connects one window with its controller."""

    def __init__(self, window: MainWindow, controller: Controller) -> None:
        super().__init__(window)
        self._window = window
        self._controller = controller
        self.side_by_side = SideBySide(window, controller)
        self.designs = DesignConnections(window, controller, self.side_by_side)
        self.all_designs = AllDesignsConnections(window, controller, self.designs)
        self.target = TargetConnections(window, controller)
        self.stage = StageConnections(window, controller)
        self._connect_settings()
        self.start = StartConnections(window, controller)
        self.second = SecondConnections(window, controller)
        self._connect_messages()
        self.voids = VoidConnections(window, controller)
        self.first_start = FirstStart(window, controller)
        self._show_title()
        window.status_text.setText(tr("Choose or draw a target to begin."))

    def _connect_settings(self) -> None:
        window, controller = self._window, self._controller
        window.settings.changed.connect(lambda changes: controller.change_settings(**changes))
        window.settings.edited.connect(controller.end_drag)
        window.settings.keep_changed.connect(self._keep_seed)
        controller.variants_known.connect(window.settings.set_variants)
        controller.reader.known.connect(self._show_reading)
        controller.session.document_changed.connect(self._show_settings)
        self._show_settings(controller.document)

    def _connect_messages(self) -> None:
        window, controller = self._window, self._controller
        controller.session.document_changed.connect(self._show_title)
        controller.session.message_posted.connect(window.messages.add)
        controller.session.status_changed.connect(window.status_text.setText)
        controller.session.message_withdrawn.connect(window.messages.drop)
        controller.filing.recovery.recover_wanted.connect(window.files.recover)
        controller.filing.materials.material_added.connect(window.dialogs.reload_materials)
        window.pasting.file_wanted.connect(window.files.open)

    def _show_settings(self, document: Document) -> None:
        self._window.settings.show_settings(document.settings)

    def _show_reading(self, reading: TargetReading | None) -> None:
        """Show what the target's shape says of symmetry and grid."""
        window, settings = self._window, self._controller.document.settings
        window.settings.show_symmetry("" if reading is None else reading.symmetry)
        window.settings.show_grid_choice(
            None if reading is None else reading.grid, "" if reading is None else reading.reason
        )
        window.target.show_start_refusal("" if reading is None else reading.start_refusal)
        if reading is not None and reading.grid is not None and settings.auto_grid:
            window.target.show_reach(reading.grid)

    def _keep_seed(self, keeps: bool) -> None:
        self._controller.generation.planner.keeps_seed = keeps

    def _show_title(self) -> None:
        window, controller = self._window, self._controller
        unsaved = controller.history.unsaved
        name = controller.path.name if controller.path is not None else tr("Untitled")
        literal = name.replace("[*]", "[*][*]")  # or Qt would take it for the place of its own star
        window.setWindowTitle(tr("{name}[*] \N{EN DASH} Kirigami Studio", name=literal))
        window.setWindowModified(unsaved)
        window.heading.setText(tr("{name}  ·  unsaved changes", name=name) if unsaved else name)
