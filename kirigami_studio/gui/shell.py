"""What the one window consists of: three columns, everything visible, nothing modal.

The shell knows no controller: :class:`~kirigami_studio.gui.main_window.MainWindow` brings it to life.
"""

from __future__ import annotations

from PySide6.QtCore import QByteArray, QEvent, QObject, QSettings, QSize, Qt
from PySide6.QtGui import QIcon, QKeyEvent, QResizeEvent, QShowEvent
from PySide6.QtWidgets import (
    QAbstractSpinBox,
    QApplication,
    QLabel,
    QMainWindow,
    QSizePolicy,
    QSplitter,
    QVBoxLayout,
    QWidget,
)

from kirigami_studio.foundation.resources import resource
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui import actions
from kirigami_studio.gui.look import theme
from kirigami_studio.gui.look.theme import Palette
from kirigami_studio.gui.panels.fabrication_panel import Extent, FabricationPanel
from kirigami_studio.gui.panels.gallery_panel import GalleryPanel
from kirigami_studio.gui.panels.generate_bar import GenerateBar
from kirigami_studio.gui.panels.message_bar import MessageBar
from kirigami_studio.gui.panels.settings_panel import SettingsPanel
from kirigami_studio.gui.panels.stage_panel import StagePanel
from kirigami_studio.gui.panels.target_panel import TargetPanel

SMALLEST = QSize(1000, 640)
FIRST = QSize(1440, 900)
#: What a title bar and borders may add.
FRAME = QSize(16, 48)
#: Least and largest first width (pixels) of the outer columns, and their share of the window in between.
LEFT_WIDTH, RIGHT_WIDTH = (284, 340), (322, 372)
LEFT_SHARE, RIGHT_SHARE = 0.225, 0.25
#: Least height (pixels) of the window at which the fabrication panel shows as much and the gallery has two whole rows.
ROOM_FOR = ((1000, Extent.ALL), (860, Extent.CHOICES), (0, Extent.EXPORT))


class Shell(QMainWindow):
    """Builds the panels, the toolbar and the status line; dresses them, lays them out, remembers their sizes."""

    def __init__(self, palette: Palette) -> None:
        super().__init__()
        self.palette_ = palette
        self._laid_out = False
        self._sizes_before: list[int] = []
        self.setObjectName("studio")
        self.setWindowIcon(QIcon(str(resource("icons", "kirigami-studio.svg"))))
        self.setMinimumSize(SMALLEST)
        self.setAcceptDrops(True)
        self.resize(FIRST.boundedTo(self.screen().availableSize() - FRAME))
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
        for box in self.findChildren(QAbstractSpinBox):
            box.installEventFilter(self)
        self.set_theme(palette)

    def _build_toolbar(self) -> None:
        bar = self.addToolBar(tr("Main"))
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
        self.columns.splitterMoved.connect(self._keep_columns)
        self.target.editing_changed.connect(self._make_room)
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
        self.says.setAccessibleName(tr("Status"))
        self.says.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.facts = QLabel()
        bar = self.statusBar()
        bar.setSizeGripEnabled(False)
        bar.addWidget(self.says, 1)
        bar.addPermanentWidget(self.facts)

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802 - Qt's name
        super().showEvent(event)
        self._share_width()
        self.stage.view.setFocus()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        self._share_width()
        self.fabrication.fit(next(extent for height, extent in ROOM_FOR if self.height() >= height))

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        """A number has no use for Space: leave it to the window, which plays."""
        asked = event.type() == QEvent.Type.ShortcutOverride
        if asked and isinstance(event, QKeyEvent) and event.key() == Qt.Key.Key_Space:
            event.ignore()
            return True
        return super().eventFilter(watched, event)

    def _share_width(self) -> None:
        """Share the width among the columns, until the user has moved a border between them."""
        if not self._laid_out and not self.target.editing:
            left = min(max(LEFT_SHARE * self.width(), LEFT_WIDTH[0]), LEFT_WIDTH[1])
            right = min(max(RIGHT_SHARE * self.width(), RIGHT_WIDTH[0]), RIGHT_WIDTH[1])
            self.columns.setSizes([round(left), round(self.width() - left - right), round(right)])
        elif self.target.editing:  # what a larger window has to give goes to the drawing board
            right = min(self._sizes_before[2], RIGHT_WIDTH[1])
            self.columns.setSizes([self.width() - right, 0, right])

    def _make_room(self, editing: bool) -> None:
        """The target's editor takes the place of the stage and the settings while it is open."""
        sizes = self.columns.sizes()
        if editing:
            self._sizes_before = sizes
            self.columns.setSizes([sizes[0] + sizes[1], 0, sizes[2]])
            self.target.view.setFocus()  # hiding what has the focus would hand it to the gallery's list of orders
        self.stage.setVisible(not editing)
        self.settings.setVisible(not editing)
        if not editing:
            self.columns.setSizes(self._sizes_before)
            self._share_width()
            if self.target.view.hasFocus() or self.focusWidget() is None:
                self.stage.view.setFocus()

    def _keep_columns(self) -> None:
        self._laid_out = True

    def set_theme(self, palette: Palette) -> None:
        """Dress the window in other colours."""
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
            if isinstance(value, QByteArray) and take(value) and key == "columns":
                self._laid_out = True
        self.stage.restore(settings)
        self.fabrication.restore(settings)

    def remember(self, settings: QSettings) -> None:
        """Keep size and columns for the next time."""
        settings.setValue("geometry", self.saveGeometry())
        if self._laid_out:
            settings.setValue("columns", self.columns.saveState())
        self.stage.remember(settings)
        self.fabrication.remember(settings)
