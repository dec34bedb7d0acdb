"""The window alive: the shell, its controller, and what connects them."""

from __future__ import annotations

from PySide6.QtGui import QCloseEvent, QDragEnterEvent, QDropEvent

from kirigami_studio.gui.commands import Commands
from kirigami_studio.gui.controller import Controller
from kirigami_studio.gui.look.theme import Palette
from kirigami_studio.gui.shell import Shell
from kirigami_studio.gui.wiring import Wiring


class MainWindow(Shell):
    """A shell whose gestures reach the controller and whose panels hear from it."""

    def __init__(self, controller: Controller, palette: Palette) -> None:
        super().__init__(palette)
        self.controller = controller
        self.commands = Commands(self, controller)
        self.wiring = Wiring(self, controller, self.commands)

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:  # noqa: N802 - Qt's name
        if any(url.isLocalFile() for url in event.mimeData().urls()):
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:  # noqa: N802 - Qt's name
        files = [url.toLocalFile() for url in event.mimeData().urls() if url.isLocalFile()]
        if files:
            event.acceptProposedAction()
            self.commands.take_file(files[0])

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802 - Qt's name
        if self.commands.may_close():
            self.stage.player.play.setChecked(False)
            self.commands.close_dialogs()
            self.hide()  # the worker may be deep in an import: let it end out of sight
            self.controller.close()
            event.accept()
        else:
            event.ignore()
