"""The three columns of the window: target and settings, stage, gallery and making."""

from __future__ import annotations

from PySide6.QtCore import QByteArray, QSettings, QSize, Qt
from PySide6.QtWidgets import QSplitter, QStackedWidget, QWidget

from kirigami_studio.gui.gallery.gallery_panel import GalleryPanel
from kirigami_studio.gui.make.fabrication_panel import Extent, FabricationPanel
from kirigami_studio.gui.run.generate_bar import GenerateBar
from kirigami_studio.gui.run.settings_panel import SettingsPanel
from kirigami_studio.gui.target.target_panel import TargetPanel
from kirigami_studio.gui.widgets.layouts import column
from kirigami_studio.gui.window.stage_panel import StagePanel

#: Least and largest first width (pixels) of the outer columns, and their share of the window in between.
LEFT_WIDTH, RIGHT_WIDTH = (284, 340), (322, 372)
LEFT_SHARE, RIGHT_SHARE = 0.225, 0.25
#: Smallest window height (pixels) for each extent of the fabrication panel that leaves the gallery two whole rows.
EXTENT_BY_HEIGHT = ((1000, Extent.ALL), (860, Extent.CHOICES), (0, Extent.EXPORT))


class Columns(QWidget):
    """Lays the panels out, and remembers their sizes."""

    def __init__(self) -> None:
        super().__init__()
        self.target = TargetPanel()
        self.settings = SettingsPanel()
        self.run = GenerateBar()
        self.stage = StagePanel()
        self.gallery = GalleryPanel()
        self.fabrication = FabricationPanel()
        self._laid_out = False
        self._sizes_before: list[int] = []
        self.settings.body.insertWidget(0, self.fabrication.material_row)
        self.settings.body.addWidget(self.run)
        self.splitter = QSplitter(Qt.Orientation.Horizontal)
        self._outer = _column(self.target, self.settings), _column(self.gallery, self.fabrication)
        for part in (self._outer[0], self.stage, self._outer[1]):
            self.splitter.addWidget(part)
        self.splitter.setChildrenCollapsible(False)
        self.splitter.setStretchFactor(1, 1)
        self.splitter.splitterMoved.connect(self._keep_sizes)
        self.target.editing_changed.connect(self._make_room)
        self.stage.whole_width_wanted.connect(self._give_whole_width)
        self.pages = QStackedWidget()  #: the columns, and what is shown in their place
        self.pages.addWidget(self.splitter)
        column((self.pages, 1), on=self, margins=(10, 0, 10, 2))

    def fit(self, window: QSize) -> None:
        """Lay the panels out for a window of this size."""
        self.share_width(window.width())
        self.fabrication.fit(next(extent for height, extent in EXTENT_BY_HEIGHT if window.height() >= height))

    def share_width(self, width: int) -> None:
        """Share the window's width among the columns, until the user has moved a border."""
        if not self._laid_out and not self.target.editing:
            left = min(max(LEFT_SHARE * width, LEFT_WIDTH[0]), LEFT_WIDTH[1])
            right = min(max(RIGHT_SHARE * width, RIGHT_WIDTH[0]), RIGHT_WIDTH[1])
            self.splitter.setSizes([round(left), round(width - left - right), round(right)])
        elif self.target.editing:  # what a larger window has to give goes to the drawing board
            right = min(self._sizes_before[2], RIGHT_WIDTH[1])
            self.splitter.setSizes([width - right, 0, right])

    def _make_room(self, editing: bool) -> None:
        """The target's editor takes the place of the stage and the settings while it is open."""
        sizes = self.splitter.sizes()
        if editing and self.stage.wants_whole_width:
            self.stage.set_comparing(False)
            sizes = self._sizes_before
        if editing:
            self._sizes_before = sizes
            self.splitter.setSizes([sizes[0] + sizes[1], 0, sizes[2]])
            self.target.view.setFocus()  # hiding what has the focus would give it to the gallery's list of sort orders
        self.stage.setVisible(not editing)
        self.settings.setVisible(not editing)
        if not editing:
            self.splitter.setSizes(self._sizes_before)
            self.share_width(self.window().width())
            if self.target.view.hasFocus() or self.window().focusWidget() is None:
                self.stage.take_focus()

    def _give_whole_width(self, whole: bool) -> None:
        """Three designs and more beside each other take the place of the outer columns."""
        if whole == self._outer[0].isHidden():
            return
        if whole:
            self._sizes_before = self.splitter.sizes()
        for outer in self._outer:
            outer.setVisible(not whole)
        if not whole:
            self.splitter.setSizes(self._sizes_before)
            self.share_width(self.window().width())

    def _keep_sizes(self) -> None:
        self._laid_out = True

    def restore(self, settings: QSettings) -> None:
        """Restore the columns of the last session."""
        value = settings.value("columns")
        if isinstance(value, QByteArray) and self.splitter.restoreState(value):
            self._laid_out = True
        self.stage.restore(settings)
        self.fabrication.restore(settings)
        self.settings.restore(settings)

    def remember(self, settings: QSettings) -> None:
        """Save the columns for the next session."""
        if self._laid_out:
            settings.setValue("columns", self.splitter.saveState())
        self.stage.remember(settings)
        self.fabrication.remember(settings)
        self.settings.remember(settings)


def _column(upper: QWidget, lower: QWidget) -> QWidget:
    """Two panels above each other, of which the first one grows."""
    both = QWidget()
    column((upper, 1), lower, on=both, spacing=8)
    return both
