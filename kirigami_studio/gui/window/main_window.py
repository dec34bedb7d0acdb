"""The main window: composes services, panels, presenters, menus, toolbar and status line."""

from __future__ import annotations

from PySide6.QtCore import QByteArray, QPoint, QRect, QSettings, QSize, Qt
from PySide6.QtGui import QCloseEvent, QIcon, QResizeEvent, QShowEvent
from PySide6.QtWidgets import QLabel, QMainWindow, QSizePolicy, QWidget

from kirigami_studio.foundation.resources import resource
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.files.file_dialogs import FileDialogs, SystemFileDialogs
from kirigami_studio.gui.files.picturing import PictureMaker
from kirigami_studio.gui.session.command import Command, Switch, WindowState
from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.target.pasting import PasteReader
from kirigami_studio.gui.widgets.actions import CommandActions
from kirigami_studio.gui.widgets.announcing import announce
from kirigami_studio.gui.widgets.canvas import name_roles
from kirigami_studio.gui.widgets.card import ElidedLabel
from kirigami_studio.gui.widgets.file_drops import FileDrops
from kirigami_studio.gui.widgets.fitted_text import BriefTooltips
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
from kirigami_studio.gui.window.appearance import Appearance
from kirigami_studio.gui.window.file_commands import FileCommands
from kirigami_studio.gui.window.open_dialogs import Dialogs
from kirigami_studio.gui.window.pages import WORDS, Pages, WindowPage
from kirigami_studio.gui.window.presenters import Presenters
from kirigami_studio.gui.window.services import Services
from kirigami_studio.gui.window.submenus import LanguageMenu, PictureMenu, RecentMenu, offer_context_menus
from kirigami_studio.gui.window.unsaved_work import UnsavedWork
from kirigami_studio.gui.window.view_commands import OVERLAY_COMMANDS, PAGE_COMMANDS

SMALLEST = QSize(1000, 640)
FIRST = QSize(1440, 900)
#: Allowance for the title bar and borders.
FRAME = QSize(16, 48)
#: Between a message and what is around it in the tool bar, pixels.
MESSAGE_GAP = 4
#: Commands of the toolbar by their ids, before and after the name of the project; "" is a separator.
TOOLBAR = (("open_project", "save", "", "undo", "redo", "", *PAGE_COMMANDS), ("theme", "guide"))


class MainWindow(QMainWindow):
    """Gives every part what it needs; has the title, the toolbar, the menus and the status line.

    Parameters
    ----------
    file_dialogs : FileDialogs, optional
        In the place of the desktop's.
    """

    def __init__(self, services: Services, palette: Palette, file_dialogs: FileDialogs | None = None) -> None:
        super().__init__()
        session, project = services.session, services.project
        self.services, self.session = services, session
        self.starts_again = False  #: another window goes on with the project
        self.setObjectName("studio")
        self.setWindowIcon(QIcon(str(resource("icons", "kirigami-studio.svg"))))
        self.setMinimumSize(SMALLEST)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.NoContextMenu)
        self.resize(FIRST.boundedTo(self.screen().availableSize() - FRAME))
        self.messages = MessageBar(self)
        self.pages = pages = Pages()
        self.target, self.settings, self.run = pages.target, pages.settings, pages.run
        self.stage, self.gallery, self.welcome = pages.stage, pages.gallery, pages.welcome
        self.fabrication, self.cuts = pages.fabrication, pages.cuts
        self.setCentralWidget(pages)
        self._build_status()
        name_roles()
        ask = file_dialogs or SystemFileDialogs(self)
        self.unsaved = UnsavedWork(self, session, project, services.hand, ask)
        self.files = FileCommands(services, self.unsaved, ask, self.fabrication.exports, self)
        self.appearance = Appearance(self, session, services.preferences, palette, self.start_again)
        self.dialogs = Dialogs(
            self,
            services,
            self.files,
            self.appearance,
            library_button=self.target.buttons["library"],
            commands=lambda: self.commands.records,
        )
        self.pasting = PasteReader(session, self)
        self.picturing = PictureMaker(self, session, services.cutting)
        self.heading = ElidedLabel()  #: name of the project, in the middle of the toolbar
        self.heading.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.heading.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self.presenters = Presenters(
            pages,
            services,
            dialogs=self.dialogs,
            files=self.files,
            pasting=self.pasting,
            status=self.status_text,
            command=lambda name: self.commands[name],
        )
        self._connect_session()
        self.commands = CommandActions(self, self._all_commands(), self.state)
        self._build_submenus(ask)
        self._refresh_commands()
        self._build_toolbar()
        self.messages.content_changed.connect(self._place_messages)
        self.appearance.unit_changed.connect(self._show_unit)
        self.welcome.offer(self.commands.actions)
        self.appearance.changed.connect(self.commands.set_palette)
        self.appearance.set_theme(palette)
        # Last: they look at every event of what they are put on, and most come while a window is put together.
        leave_wheel(self)
        BriefTooltips(self)
        self.drops = FileDrops(self)
        self.drops.file_dropped.connect(self.files.open)

    def _build_status(self) -> None:
        self.status_text = ElidedLabel(Qt.TextElideMode.ElideRight)
        self.status_text.setAccessibleDescription(tr("Status"))
        self.status_text.setContentsMargins(12, 0, 8, 0)
        self.facts = QLabel()
        bar = self.statusBar()
        bar.setSizeGripEnabled(False)
        bar.addWidget(self.status_text, 1)
        bar.addPermanentWidget(self.facts)

    def _connect_session(self) -> None:
        """Messages, status line and title."""
        session = self.session
        session.message_posted.connect(self.messages.add)
        session.message_withdrawn.connect(self.messages.drop)
        self.services.run.started.connect(lambda: self.messages.dismiss(Tone.HINT, Tone.DONE))
        session.status_changed.connect(self.status_text.setText)
        self.presenters.stage.facts_changed.connect(self.facts.setText)
        session.document_changed.connect(self._show_title)
        self.pages.turned.connect(self._announce_page)
        self._show_title()
        self.status_text.setText(tr("Choose or draw a target to begin."))

    def _show_title(self) -> None:
        unsaved, path = self.session.history.unsaved, self.session.path
        name = path.name if path is not None else tr("Untitled")
        literal = name.replace("[*]", "[*][*]")  # or Qt would take it for the place of its own star
        self.setWindowTitle(tr("{name}[*] \N{EN DASH} Kirigami Studio", name=literal))
        self.setWindowModified(unsaved)
        self.heading.setText(tr("{name}  ·  unsaved changes", name=name) if unsaved else name)

    def _announce_page(self, page: WindowPage) -> None:
        title, about = (tr(words) for words in WORDS[page])
        announce(self, f"{title}. {about}")

    def _all_commands(self) -> tuple[Command, ...]:
        """The commands in the order of the menus, one record each."""
        services, dialogs, presenters = self.services, self.dialogs, self.presenters
        project, targeting = services.project, services.targeting
        return (
            *file_commands.commands(
                self.files,
                self.unsaved,
                project=project,
                targeting=targeting,
                show_library=dialogs.show_library,
                show_pairs=presenters.show_pairs,
                export_artwork=dialogs.export_artwork,
                show_print=dialogs.show_print,
                close=self.close,
            ),
            *edit_commands.commands(project, targeting, dialogs, self.pasting, self.picturing),
            *draw_commands.commands(self.target, self.session.post),
            *design_commands.commands(services, self.stage, self.gallery, presenters, dialogs),
            *view_commands.commands(self.pages, self.session, presenters, self.appearance, services.preview.switch),
            *help_commands.commands(dialogs, self.files.open_sample),
        )

    def _build_submenus(self, ask: FileDialogs) -> None:
        self.recent_menu = RecentMenu(self, self.services.project.recent, self.files.open)
        self.commands.insert_menu("save", self.recent_menu)
        self.picture_menu = PictureMenu(self, self.picturing, ask.picture)
        self.commands.insert_menu("animation", self.picture_menu)
        self.language_menu = LanguageMenu(self, self.appearance)
        self.commands.append_menu("theme_system", self.language_menu)
        for name in OVERLAY_COMMANDS:
            self.stage.overlay_menu.addAction(self.commands[name])
        offer_context_menus(self.target, self.stage, self.cuts, self.commands)

    def _refresh_commands(self) -> None:
        """Enable and name the commands anew at whatever :meth:`state` depends on."""
        services, session, chosen = self.services, self.session, self.services.chosen
        for signal in (
            session.document_changed,
            session.display.stage_changed,
            services.run.started,
            services.run.ended,
            chosen.trimming.busy_changed,
            chosen.refitting.busy_changed,
            services.regularity.busy_changed,
            self.stage.switches_changed,
            self.stage.comparing_changed,
            self.pages.turned,
            self.target.view.context.selection_changed,
        ):
            signal.connect(self.commands.refresh)

    def state(self) -> WindowState:
        """Return what decides which commands can be given now."""
        services, session, stage = self.services, self.session, self.stage
        document = session.document
        return WindowState(
            has_target=document.target is not None,
            has_designs=bool(document.candidates),
            has_parts=bool(services.targeting.reader.drawing_of(document.target)),
            shows_design=session.stage is not None,
            chosen=None if document.chosen is None else document.marks[document.chosen],
            undo_label=session.history.undo_label,
            redo_label=session.history.redo_label,
            running=services.run.running,
            busy=services.chosen.busy,
            editing_target=self.target.editing,
            previews=services.preview.on,
            page=self.pages.page.value,
            arrangements=self.target.arrangements(),
            comparing=stage.comparing,
            ideal=Switch(stage.deployment.slider.jam is not None, stage.deployment.ideal.isChecked()),
            dark=self.appearance.palette.dark,
            follows_system=self.appearance.follows_system,
            inches=self.appearance.in_inches,
            still=services.preferences.present.motion == "still",
        )

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
        self.page_buttons: dict[WindowPage, QWidget] = {}
        for name, page in PAGE_COMMANDS.items():
            button = self.page_buttons[page] = bar.widgetForAction(self.commands[name])
            button.setProperty("page", True)
            button.setFocusPolicy(Qt.FocusPolicy.TabFocus)

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802 - Qt's name
        super().showEvent(event)
        self.pages.share_width(self.width())
        self.target.view.setFocus()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        self.pages.share_width(self.width())
        self._place_messages()

    def _show_unit(self) -> None:
        """Write all lengths in the unit that was switched to."""
        self.presenters.show_unit()
        for part in self.findChildren(QWidget):
            part.update()

    def _place_messages(self) -> None:
        """Messages lie where the project's name is, between the buttons of the tool bar."""
        corner = self.heading.mapTo(self, QPoint(MESSAGE_GAP, MESSAGE_GAP))
        size = QSize(self.heading.width() - 2 * MESSAGE_GAP, self.heading.height() - 2 * MESSAGE_GAP)
        self.messages.lay_over(QRect(corner, size))

    def start_again(self) -> None:
        """Close, for another window to go on with the project, saved or not; a run has to end first."""
        if self.services.run.running:
            self.session.set_status(tr("Wait for the run to finish, or cancel it, then start again."))
            self.appearance.offer_start()
        elif not self.services.hand.postpones(self.start_again):
            self.starts_again = True
            self.close()

    def restore(self, settings: QSettings) -> None:
        """Restore size and columns of the last session."""
        geometry = settings.value("geometry")
        if isinstance(geometry, QByteArray):
            self.restoreGeometry(geometry)
        self.pages.restore(settings)

    def remember(self, settings: QSettings | None = None) -> None:
        """Save size and columns for the next session, in the user's settings without others."""
        settings = QSettings() if settings is None else settings
        settings.setValue("geometry", self.saveGeometry())
        self.pages.remember(settings)

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802 - Qt's name
        if not (self.starts_again or self.unsaved.may_close()):
            event.ignore()
            return
        self.pages.stop_playing()
        self.stage.set_comparing(False)  # whose columns would be remembered
        self.dialogs.close()
        self.hide()  # the worker may be deep in an import: let it end out of sight
        self.services.close()
        event.accept()
