"""The main window: three columns of panels, menus, toolbar and status line."""

from __future__ import annotations

from PySide6.QtCore import QByteArray, QEvent, QObject, QPoint, QRect, QSettings, QSize, Qt
from PySide6.QtGui import QCloseEvent, QIcon, QKeyEvent, QResizeEvent, QShowEvent
from PySide6.QtWidgets import (
    QAbstractSpinBox,
    QApplication,
    QLabel,
    QMainWindow,
    QSizePolicy,
    QSplitter,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from kirigami_studio.foundation.resources import resource
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.files.file_dialogs import FileDialogs, SystemFileDialogs
from kirigami_studio.gui.files.picturing import PictureMaker
from kirigami_studio.gui.gallery.gallery_panel import GalleryPanel
from kirigami_studio.gui.make.fabrication_panel import Extent, FabricationPanel
from kirigami_studio.gui.run.generate_bar import GenerateBar
from kirigami_studio.gui.run.settings_panel import SettingsPanel
from kirigami_studio.gui.session.command import Command, Switch, WindowState
from kirigami_studio.gui.target.pasting import PasteReader
from kirigami_studio.gui.target.target_panel import TargetPanel
from kirigami_studio.gui.widgets import theme
from kirigami_studio.gui.widgets.actions import CommandActions
from kirigami_studio.gui.widgets.card import ElidedLabel
from kirigami_studio.gui.widgets.file_drops import FileDrops
from kirigami_studio.gui.widgets.message_bar import MessageBar
from kirigami_studio.gui.widgets.number_field import leave_wheel
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.window import (
    design_commands,
    draw_commands,
    edit_commands,
    file_commands,
    help_commands,
    view_commands,
)
from kirigami_studio.gui.window.controller import Controller
from kirigami_studio.gui.window.file_commands import FileCommands
from kirigami_studio.gui.window.open_dialogs import Dialogs
from kirigami_studio.gui.window.presenter import Connections
from kirigami_studio.gui.window.stage_panel import StagePanel
from kirigami_studio.gui.window.submenus import LanguageMenu, PictureMenu, RecentMenu, offer_context_menus
from kirigami_studio.gui.window.unsaved_work import UnsavedWork
from kirigami_studio.gui.window.view_commands import OVERLAY_COMMANDS, Appearance

SMALLEST = QSize(1000, 640)
FIRST = QSize(1440, 900)
#: Allowance for the title bar and borders.
FRAME = QSize(16, 48)
#: Between a message and what is around it in the tool bar, pixels.
MESSAGE_GAP = 4
#: Least and largest first width (pixels) of the outer columns, and their share of the window in between.
LEFT_WIDTH, RIGHT_WIDTH = (284, 340), (322, 372)
LEFT_SHARE, RIGHT_SHARE = 0.225, 0.25
#: Smallest window height (pixels) for each extent of the fabrication panel that leaves the gallery two whole rows.
EXTENT_BY_HEIGHT = ((1000, Extent.ALL), (860, Extent.CHOICES), (0, Extent.EXPORT))
#: Commands of the toolbar by their ids, before and after the name of the project; "" is a separator.
TOOLBAR = (("open_project", "save", "", "undo", "redo"), ("theme", "guide"))


def all_commands(window: MainWindow) -> tuple[Command, ...]:
    """Return the commands of a window in the order of its menus, one record each."""
    return (
        *file_commands.commands(window),
        *edit_commands.commands(window.controller, window.dialogs, window.pasting, window.picturing),
        *draw_commands.commands(window.target, window.messages.add),
        *design_commands.commands(window),
        *view_commands.commands(window),
        *help_commands.commands(window.dialogs, window.files.open_sample),
    )


class MainWindow(QMainWindow):
    """Builds the panels and connects them with the controller; lays them out and remembers their sizes."""

    def __init__(self, controller: Controller, palette: Palette) -> None:
        super().__init__()
        self.controller = controller
        self.palette_ = palette
        self._laid_out = False
        self._sizes_before: list[int] = []
        self.starts_again = False  #: another window goes on with the project
        self.setObjectName("studio")
        self.setWindowIcon(QIcon(str(resource("icons", "kirigami-studio.svg"))))
        self.setMinimumSize(SMALLEST)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.NoContextMenu)
        self.resize(FIRST.boundedTo(self.screen().availableSize() - FRAME))
        self.messages = MessageBar(self)
        self.target = TargetPanel()
        self.settings = SettingsPanel()
        self.run = GenerateBar()
        self.stage = StagePanel()
        self.gallery = GalleryPanel()
        self.fabrication = FabricationPanel()
        self._build_columns()
        self._build_status()
        leave_wheel(self)
        for box in self.findChildren(QAbstractSpinBox):
            box.installEventFilter(self)
        self.file_dialogs: FileDialogs = SystemFileDialogs(self)
        self.unsaved = UnsavedWork(self, controller)
        self.files = FileCommands(self, controller)
        self.drops = FileDrops(self)
        self.drops.file_dropped.connect(self.files.open)
        self.dialogs = Dialogs(self, controller)
        self.appearance = Appearance(self, controller.preferences)
        self.pasting = PasteReader(controller.session, self)
        self.picturing = PictureMaker(self, controller.session, controller.cutting)
        self.heading = self._heading()
        self.connections = Connections(self, controller)
        self._build_commands()
        self._build_toolbar()
        self.messages.content_changed.connect(self._place_messages)
        self.set_theme(palette)

    def _build_columns(self) -> None:
        design = QWidget()
        design.setObjectName("body")
        column = QVBoxLayout(design)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(8)
        self.settings.body.insertWidget(0, self.fabrication.material_row)
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
        self.outer = design, right
        for part in (design, self.stage, right):
            self.columns.addWidget(part)
        self.columns.setChildrenCollapsible(False)
        self.columns.setStretchFactor(1, 1)
        self.columns.splitterMoved.connect(self._keep_columns)
        self.target.editing_changed.connect(self._make_room)
        self.stage.whole_width_wanted.connect(self._give_whole_width)
        body = QWidget()
        body.setObjectName("body")
        whole = QVBoxLayout(body)
        whole.setContentsMargins(10, 0, 10, 2)
        whole.setSpacing(8)
        self.center = QStackedWidget()
        self.center.addWidget(self.columns)
        whole.addWidget(self.center, 1)
        self.setCentralWidget(body)

    def _build_status(self) -> None:
        self.status_text = ElidedLabel(Qt.TextElideMode.ElideRight)
        self.status_text.setAccessibleName(tr("Status"))
        self.status_text.setContentsMargins(12, 0, 8, 0)
        self.facts = QLabel()
        bar = self.statusBar()
        bar.setSizeGripEnabled(False)
        bar.addWidget(self.status_text, 1)
        bar.addPermanentWidget(self.facts)

    def _build_commands(self) -> None:
        self.commands = CommandActions(self, all_commands(self), self.state)
        self.recent_menu = RecentMenu(self, self.controller.filing.recent, self.files.open)
        self.commands.insert_menu("save", self.recent_menu)
        self.picture_menu = PictureMenu(self, self.picturing, lambda proposal: self.file_dialogs.picture(proposal))
        self.commands.insert_menu("animation", self.picture_menu)
        self.language_menu = LanguageMenu(self, self.appearance)
        self.commands.append_menu("theme_system", self.language_menu)
        for name in OVERLAY_COMMANDS:
            self.stage.overlay_menu.addAction(self.commands[name])
        offer_context_menus(self.target, self.stage, self.commands)
        self.stage.welcome.offer(self.commands.actions)
        controller, refresh = self.controller, self.commands.refresh
        for document_signal in (controller.session.document_changed, controller.session.display.stage_changed):
            document_signal.connect(refresh)
        for job_signal in (controller.run.started, controller.run.ended):
            job_signal.connect(refresh)
        working = (controller.trimming, controller.refitting, controller.regularity)
        for busy_signal in (part.busy_changed for part in working):
            busy_signal.connect(refresh)
        self.stage.switches_changed.connect(refresh)
        self.stage.comparing_changed.connect(refresh)
        self.target.editing_changed.connect(refresh)
        self.target.view.context.selection_changed.connect(refresh)

    def state(self) -> WindowState:
        """Return what decides which commands can be given now."""
        controller, document, stage = self.controller, self.controller.document, self.stage
        return WindowState(
            has_target=document.target is not None,
            has_designs=bool(document.candidates),
            has_parts=bool(controller.targeting.reader.drawing_of(document.target)),
            shows_design=controller.stage is not None,
            chosen=None if document.chosen is None else document.marks[document.chosen],
            undo_label=controller.history.undo_label,
            redo_label=controller.history.redo_label,
            running=controller.running,
            busy=controller.trimming.busy or controller.refitting.busy or controller.regularity.busy,
            editing_target=self.target.editing,
            arrangements=self.target.arrangements(),
            comparing=stage.comparing,
            ideal=Switch(stage.deployment.slider.jam is not None, stage.deployment.ideal.isChecked()),
            dark=self.palette_.dark,
            follows_system=self.appearance.follows_system,
            still=controller.preferences.present.motion == "still",
        )

    def _heading(self) -> QLabel:
        """The name of the project, in the middle of the toolbar."""
        heading = QLabel()
        heading.setObjectName("muted")
        heading.setAlignment(Qt.AlignmentFlag.AlignCenter)
        heading.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        return heading

    def _build_toolbar(self) -> None:
        bar = self.addToolBar(tr("Main"))
        bar.setObjectName("mainToolBar")
        bar.setMovable(False)
        bar.setIconSize(QSize(18, 18))
        before, after = TOOLBAR
        for name in before:
            if name:
                bar.addAction(self.commands[name])
            else:
                bar.addSeparator()
        bar.addWidget(self.heading)
        for name in after:
            bar.addAction(self.commands[name])

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802 - Qt's name
        super().showEvent(event)
        self._share_width()
        self.stage.take_focus()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        self._share_width()
        self._place_messages()
        self.fabrication.fit(next(extent for height, extent in EXTENT_BY_HEIGHT if self.height() >= height))

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        """Number fields leave Space to the window, which plays the deployment."""
        asked = event.type() == QEvent.Type.ShortcutOverride
        if asked and isinstance(event, QKeyEvent) and event.key() == Qt.Key.Key_Space:
            event.ignore()
            return True
        return super().eventFilter(watched, event)

    def _place_messages(self) -> None:
        """Messages lie where the project's name is, between the buttons of the tool bar."""
        corner = self.heading.mapTo(self, QPoint(MESSAGE_GAP, MESSAGE_GAP))
        size = QSize(self.heading.width() - 2 * MESSAGE_GAP, self.heading.height() - 2 * MESSAGE_GAP)
        self.messages.lay_over(QRect(corner, size))

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
        if editing and self.stage.wants_whole_width:
            self.stage.set_comparing(False)
            sizes = self._sizes_before
        if editing:
            self._sizes_before = sizes
            self.columns.setSizes([sizes[0] + sizes[1], 0, sizes[2]])
            self.target.view.setFocus()  # hiding what has the focus would give it to the gallery's list of sort orders
        self.stage.setVisible(not editing)
        self.settings.setVisible(not editing)
        if not editing:
            self.columns.setSizes(self._sizes_before)
            self._share_width()
            if self.target.view.hasFocus() or self.focusWidget() is None:
                self.stage.take_focus()

    def _give_whole_width(self, whole: bool) -> None:
        """Three designs and more beside each other take the place of the outer columns."""
        if whole == self.outer[0].isHidden():
            return
        if whole:
            self._sizes_before = self.columns.sizes()
        for column in self.outer:
            column.setVisible(not whole)
        if not whole:
            self.columns.setSizes(self._sizes_before)
            self._share_width()

    def _keep_columns(self) -> None:
        self._laid_out = True

    def set_theme(self, palette: Palette) -> None:
        """Change to another palette."""
        self.palette_ = palette
        application = QApplication.instance()
        if isinstance(application, QApplication):
            theme.apply(application, palette)
        for part in theme.themed(self.findChildren(QWidget)):
            part.set_palette(palette)
        self.commands.set_palette(palette)

    def start_again(self) -> None:
        """Close, for another window to go on with the project, saved or not; a run has to end first."""
        if self.controller.running:
            self.controller.session.set_status(tr("Wait for the run to finish, or cancel it, then start again."))
            self.appearance.offer_start()
        elif not self.controller.hand.postpones(self.start_again):
            self.starts_again = True
            self.close()

    def restore(self, settings: QSettings) -> None:
        """Restore the size and columns of the last session."""
        for key, take in (("geometry", self.restoreGeometry), ("columns", self.columns.restoreState)):
            value = settings.value(key)
            if isinstance(value, QByteArray) and take(value) and key == "columns":
                self._laid_out = True
        self.stage.restore(settings)
        self.fabrication.restore(settings)
        self.settings.restore(settings)

    def remember(self, settings: QSettings | None = None) -> None:
        """Save size and columns for the next session, in the user's settings without others."""
        settings = QSettings() if settings is None else settings
        settings.setValue("geometry", self.saveGeometry())
        if self._laid_out:
            settings.setValue("columns", self.columns.saveState())
        self.stage.remember(settings)
        self.fabrication.remember(settings)
        self.settings.remember(settings)

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802 - Qt's name
        if not (self.starts_again or self.unsaved.may_close()):
            event.ignore()
            return
        self.stage.player.play.setChecked(False)
        self.stage.set_comparing(False)  # whose columns would be remembered
        self.dialogs.close()
        self.hide()  # the worker may be deep in an import: let it end out of sight
        self.controller.close()
        event.accept()
