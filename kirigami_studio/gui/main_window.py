"""The one window: three columns, everything visible, nothing modal."""

from __future__ import annotations

from PySide6.QtCore import QByteArray, QSettings, QSize, Qt
from PySide6.QtGui import QCloseEvent, QDragEnterEvent, QDropEvent, QIcon, QShowEvent
from PySide6.QtWidgets import QLabel, QMainWindow, QSizePolicy, QSplitter, QVBoxLayout, QWidget

from kirigami_studio.foundation.resources import resource
from kirigami_studio.gui import actions, theme
from kirigami_studio.gui.commands import Commands
from kirigami_studio.gui.controller import Controller
from kirigami_studio.gui.panels.fabrication_panel import FabricationPanel
from kirigami_studio.gui.panels.gallery_panel import GalleryPanel
from kirigami_studio.gui.panels.generate_bar import GenerateBar
from kirigami_studio.gui.panels.message_bar import MessageBar
from kirigami_studio.gui.panels.settings_panel import SettingsPanel
from kirigami_studio.gui.panels.stage_panel import StagePanel
from kirigami_studio.gui.panels.target_panel import TargetPanel
from kirigami_studio.gui.theme import Palette
from kirigami_studio.gui.wiring import Wiring

SMALLEST = QSize(1000, 640)
FIRST = QSize(1440, 900)
#: Least and largest first width (pixels) of the outer columns, and their share of the window in between.
LEFT_WIDTH, RIGHT_WIDTH = (284, 340), (322, 372)
LEFT_SHARE, RIGHT_SHARE = 0.225, 0.25


class MainWindow(QMainWindow):
    """Builds the panels; :class:`Wiring` and :class:`Commands` connect them with the controller."""

    def __init__(self, controller: Controller, palette: Palette) -> None:
        super().__init__()
        self.controller = controller
        self.palette_ = palette
        self._laid_out = False
        self.setObjectName("studio")
        self.setWindowIcon(QIcon(str(resource("icons", "kirigami-studio.svg"))))
        self.setMinimumSize(SMALLEST)
        self.setAcceptDrops(True)
        self.resize(FIRST)
        self.messages = MessageBar()
        self.target = TargetPanel()
        self.settings = SettingsPanel()
        self.run = GenerateBar()
        self.stage = StagePanel()
        self.gallery = GalleryPanel()
        self.fabrication = FabricationPanel()
        self.actions_, _ = actions.build(self)
        self._build_toolbar()
        self._build_columns()
        self._build_status()
        self.commands = Commands(self, controller)
        self.wiring = Wiring(self, controller, self.commands)
        self.set_theme(palette)

    def _build_toolbar(self) -> None:
        bar = self.addToolBar("Main")
        bar.setObjectName("mainToolBar")
        bar.setMovable(False)
        bar.setIconSize(QSize(18, 18))
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.NoContextMenu)
        for name in ("open_project", "save"):
            bar.addAction(self.actions_[name])
        bar.addSeparator()
        for name in ("undo", "redo"):
            bar.addAction(self.actions_[name])
        self.heading = QLabel()
        self.heading.setObjectName("muted")
        self.heading.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.heading.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        bar.addWidget(self.heading)
        for name in ("theme", "guide"):
            bar.addAction(self.actions_[name])

    def _build_columns(self) -> None:
        design = QWidget()
        design.setObjectName("body")
        column = QVBoxLayout(design)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(8)
        self.settings.body.addWidget(self.run)
        column.addWidget(self.target, 1)
        column.addWidget(self.settings)
        right = QWidget()
        right.setObjectName("body")
        results = QVBoxLayout(right)
        results.setContentsMargins(0, 0, 0, 0)
        results.setSpacing(8)
        results.addWidget(self.gallery, 1)
        results.addWidget(self.fabrication)
        self.columns = QSplitter(Qt.Orientation.Horizontal)
        for part in (design, self.stage, right):
            self.columns.addWidget(part)
        self.columns.setChildrenCollapsible(False)
        self.columns.setStretchFactor(1, 1)
        body = QWidget()
        body.setObjectName("body")
        whole = QVBoxLayout(body)
        whole.setContentsMargins(10, 0, 10, 2)
        whole.setSpacing(8)
        whole.addWidget(self.messages)
        whole.addWidget(self.columns, 1)
        self.setCentralWidget(body)

    def _build_status(self) -> None:
        self.says = QLabel()
        self.says.setAccessibleName("What happens")
        self.says.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.facts = QLabel()
        bar = self.statusBar()
        bar.setSizeGripEnabled(False)
        bar.addWidget(self.says, 1)
        bar.addPermanentWidget(self.facts)

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802 - Qt's name
        super().showEvent(event)
        if not self._laid_out:
            self._laid_out = True
            left = min(max(LEFT_SHARE * self.width(), LEFT_WIDTH[0]), LEFT_WIDTH[1])
            right = min(max(RIGHT_SHARE * self.width(), RIGHT_WIDTH[0]), RIGHT_WIDTH[1])
            self.columns.setSizes([round(left), round(self.width() - left - right), round(right)])
        self.stage.view.setFocus()

    def set_theme(self, palette: Palette) -> None:
        """Dress the window in other colours."""
        from PySide6.QtWidgets import QApplication

        self.palette_ = palette
        application = QApplication.instance()
        if isinstance(application, QApplication):
            theme.apply(application, palette)
        for part in (self.target, self.settings, self.run, self.stage, self.gallery, self.fabrication, self.messages):
            part.set_palette(palette)
        actions.dress(self.actions_, palette)

    def restore(self, settings: QSettings) -> None:
        """Take the size and columns of the last time."""
        for key, take in (("geometry", self.restoreGeometry), ("columns", self.columns.restoreState)):
            value = settings.value(key)
            if isinstance(value, QByteArray):
                take(value)
                self._laid_out = True

    def remember(self, settings: QSettings) -> None:
        """Keep size and columns for the next time."""
        settings.setValue("geometry", self.saveGeometry())
        settings.setValue("columns", self.columns.saveState())

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
            self.stage.deployment.play.setChecked(False)
            self.controller.close()
            event.accept()
        else:
            event.ignore()
