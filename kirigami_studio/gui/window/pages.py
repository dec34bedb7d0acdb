"""The pages of the window, which share their panels: shape, design, make."""

from __future__ import annotations

from enum import Enum

from PySide6.QtCore import QSettings, Qt, Signal
from PySide6.QtWidgets import QSplitter, QStackedWidget, QWidget

from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.gallery.gallery_panel import GalleryPanel
from kirigami_studio.gui.make.cut_view import CutView
from kirigami_studio.gui.make.cuts_page import CutBar, CutsPage
from kirigami_studio.gui.make.fabrication_panel import FabricationPanel
from kirigami_studio.gui.run.generate_bar import GenerateBar
from kirigami_studio.gui.run.part_bar import PartBar
from kirigami_studio.gui.run.settings_panel import SettingsPanel
from kirigami_studio.gui.stage.deployment_bar import DeploymentBar
from kirigami_studio.gui.target.target_panel import TargetPanel
from kirigami_studio.gui.target.target_view import TargetView
from kirigami_studio.gui.widgets.layouts import column, row
from kirigami_studio.gui.window.stage_panel import StagePanel
from kirigami_studio.gui.window.welcome_page import WelcomePage


class WindowPage(Enum):
    """A page of the window."""

    SHAPE = "shape"  #: draw or read the target, choose what it is made with
    DESIGN = "design"  #: generate, compare, edit
    MAKE = "make"  #: material, sheet, files


#: Title, and what is done there, by page.
WORDS = {
    WindowPage.SHAPE: (mark("Shape"), mark("Draw or open the target, its start and its size")),
    WindowPage.DESIGN: (mark("Design"), mark("Generate designs, compare them and edit one")),
    WindowPage.MAKE: (mark("Make"), mark("Machine, material, cuts and files of the chosen design")),
}
#: Shares of the window's width that the outer columns take on a page, with the least and largest of each in pixels.
SHARES = {
    WindowPage.SHAPE: ((1.0, 284, 9999), (0.27, 322, 380)),
    WindowPage.DESIGN: ((0.225, 284, 340), (0.25, 322, 372)),
    WindowPage.MAKE: ((0.25, 336, 440), (0.35, 330, 900)),
}
#: Largest widths of the button that starts a run, and of the second target, pixels.
BUTTON, SECOND = 340, 420


class Pages(QWidget):
    """Lays out on each page the panels that belong there, and remembers their sizes."""

    turned = Signal(WindowPage)

    def __init__(self) -> None:
        super().__init__()
        self.page = WindowPage.SHAPE
        self.target, self.settings, self.run = TargetPanel(), SettingsPanel(), GenerateBar()
        self.stage, self.gallery = StagePanel(), GalleryPanel()
        self.fabrication, self.cuts, self.welcome = FabricationPanel(), CutsPage(), WelcomePage()
        self.run.setMaximumWidth(BUTTON)
        self._moved: dict[WindowPage, list[int]] = {}  # sizes of columns whose borders the user has moved
        self._whole = False
        self._before = WindowPage.DESIGN  # where leaving the drawing board leads
        second = self.settings.second
        self._parts: dict[WindowPage, tuple[QWidget, ...]] = {
            WindowPage.SHAPE: (self.target, second, self.run, self.welcome),
            WindowPage.DESIGN: (self.target, self.settings, self.run, self.stage, self.gallery),
            WindowPage.MAKE: (self.fabrication, self.stage, self.cuts),
        }
        left, right = QWidget(), QWidget()
        second.setMaximumWidth(SECOND)
        start = row((second, 300), ..., (self.run, 400), spacing=12)
        column((self.target, 1), self.settings, start, (self.fabrication, 1), on=left, spacing=8)
        column((self.gallery, 1), (self.cuts, 1), (self.welcome, 1), on=right, spacing=8)
        self._outer = left, right
        self.splitter = QSplitter(Qt.Orientation.Horizontal)
        for part in (left, self.stage, right):
            self.splitter.addWidget(part)
        self.splitter.setChildrenCollapsible(False)
        self.splitter.setStretchFactor(1, 1)
        self.splitter.splitterMoved.connect(self._keep_sizes)
        self.target.editing_changed.connect(self._follow_board)
        self.stage.whole_width_wanted.connect(self._give_whole_width)
        self.stage.comparing_changed.connect(self._follow_comparison)
        self.stack = QStackedWidget()  #: the columns, and what is shown in their place
        self.stack.addWidget(self.splitter)
        self.parts = PartBar()
        column(self.parts, (self.stack, 1), on=self, margins=(10, 0, 10, 2))
        self._show()

    def turn(self, page: WindowPage) -> None:
        """Show a page; what is done there keeps its state."""
        if page is self.page:
            return
        if self.page is not WindowPage.SHAPE:
            self._before = self.page
        self.page = page
        self.cuts.bar.play.setChecked(False)
        if self.stage.comparing and page is not WindowPage.DESIGN:
            self.stage.set_comparing(False)
        self._show()
        self._share(self.window().width())
        if page is WindowPage.SHAPE:
            self.target.view.setFocus()
        elif self.target.view.hasFocus() or self.window().focusWidget() is None:
            self.stage.take_focus()
        self.turned.emit(page)

    def _show(self) -> None:
        shown = self._parts[self.page]
        self.setAccessibleName(tr(WORDS[self.page][0]))
        for part in {part for parts in self._parts.values() for part in parts}:
            part.setVisible(part in shown)
        self.target.set_editing(self.page is WindowPage.SHAPE)
        for outer in self._outer:
            if (layout := outer.layout()) is not None:
                layout.activate()  # the splitter bounds a column by what it held before, otherwise

    def _follow_board(self, editing: bool) -> None:
        """The drawing board is the first page: opening and leaving it turns the pages."""
        if editing:
            self.turn(WindowPage.SHAPE)
        elif self.page is WindowPage.SHAPE:
            self.turn(self._before)

    def _follow_comparison(self, comparing: bool) -> None:
        if comparing:
            self.turn(WindowPage.DESIGN)

    # what has the keyboard -----------------------------------------------------------------------------------------

    @property
    def player(self) -> DeploymentBar | CutBar:
        """The player of Space: the cutting while its sheet has the keyboard, else the deployment."""
        return self.cuts.bar if self._at_cuts else self.stage.player

    @property
    def in_sight(self) -> TargetView | CutView | StagePanel:
        """The view that is zoomed."""
        if self.page is WindowPage.SHAPE:
            return self.target.view
        return self.cuts.view if self._at_cuts else self.stage

    @property
    def _at_cuts(self) -> bool:
        focused = self.window().focusWidget()
        return self.page is WindowPage.MAKE and focused is not None and self.cuts.isAncestorOf(focused)

    def stop_playing(self) -> None:
        """Let everything stand still."""
        for player in (self.stage.player, self.cuts.bar):
            player.play.setChecked(False)

    def show_cuts(self) -> None:
        """Go to the sheet as it is cut, or back from it."""
        if self._at_cuts:
            self.turn(WindowPage.DESIGN)
            self.stage.take_focus()
        else:
            self.turn(WindowPage.MAKE)
            self.cuts.view.setFocus()

    # widths --------------------------------------------------------------------------------------------------------

    def share_width(self, width: int) -> None:
        """Share the window's new width among the columns until the user has moved a border."""
        if self.page not in self._moved:
            self._share(width)

    def _share(self, width: int) -> None:
        left, right = (round(min(max(share * width, least), most)) for share, least, most in SHARES[self.page])
        if self.page in self._moved:
            left, _, right = self._moved[self.page]
            width = self.splitter.width() - 2 * self.splitter.handleWidth()
        if not self._whole:
            left = width - right if self.page is WindowPage.SHAPE else left
            self.splitter.setSizes([left, max(width - left - right, 0), right])

    def _give_whole_width(self, whole: bool) -> None:
        """Three designs and more beside each other take the place of the outer columns."""
        if whole == self._whole:
            return
        self._whole = whole
        for outer in self._outer:
            outer.setVisible(not whole)
        self._share(self.window().width())

    def _keep_sizes(self) -> None:
        self._moved[self.page] = self.splitter.sizes()

    def restore(self, settings: QSettings) -> None:
        """Restore the columns of the last session."""
        for page in WindowPage:
            saved = settings.value(f"columns-{page.value}")
            if isinstance(saved, list) and len(saved) == 3 and all(str(size).isdecimal() for size in saved):
                self._moved[page] = [int(size) for size in saved]
        self._share(self.window().width())
        self.stage.restore(settings)
        self.settings.restore(settings)

    def remember(self, settings: QSettings) -> None:
        """Save the columns for the next session."""
        for page, sizes in self._moved.items():
            settings.setValue(f"columns-{page.value}", sizes)
        self.stage.remember(settings)
        self.settings.remember(settings)
