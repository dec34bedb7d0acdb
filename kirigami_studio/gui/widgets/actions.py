"""Commands as actions: the menus, and the one place that enables, checks and names them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial

from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMainWindow, QMenu

from kirigami_studio.gui.session.command import Command, WindowState, Wording
from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.widgets.theme import Palette


class CommandActions:
    """The commands of one window as actions in its menus, by their ids."""

    def __init__(self, window: QMainWindow, commands: Iterable[Command], state: Callable[[], WindowState]) -> None:
        self.records = tuple(commands)
        self._window = window
        self._state_now = state
        self._state = state()
        self._worded: dict[str, Wording] = {}  # how each command is shown
        self._menus: dict[str, QMenu] = {}
        self.actions = {command.id: self._action(command) for command in self.records}
        for command in self.records:
            self._show(command)

    def __getitem__(self, command: str) -> QAction:
        return self.actions[command]

    def _action(self, command: Command) -> QAction:
        menu = self._menu(command.menu)
        action = command.switch
        if action is None:
            action = QAction(command.text, self._window)
            action.setCheckable(command.checked_when is not None)
            action.triggered.connect(partial(self._run, command.id))
        action.setObjectName(command.id)
        action.setShortcuts([QKeySequence(keys) for keys in command.shortcuts])
        if command.gap:
            menu.addSeparator()
        menu.addAction(action)
        self._window.addAction(action)
        return action

    def _menu(self, title: str) -> QMenu:
        """The menu of a title, made where it is the first time."""
        if title not in self._menus:
            outer, _, own = title.rpartition("|")
            self._menus[title] = self._menu(outer).addMenu(own) if outer else self._window.menuBar().addMenu(own)
        return self._menus[title]

    def _run(self, name: str, _: bool = False) -> None:
        command = next(one for one in self.records if one.id == name)
        command.run()
        self.refresh()
        # Qt has toggled a switch, whether or not the command did anything; and the words may have changed
        self._show(next(one for one in self.records if one.id == name))

    def insert_menu(self, before: str, menu: QMenu) -> None:
        """Put a menu of menus before a command."""
        command = next(one for one in self.records if one.id == before)
        self._menus[command.menu].insertMenu(self.actions[before], menu)

    def append_menu(self, after: str, menu: QMenu) -> None:
        """Put a menu at the end of the menu that a command stands in."""
        command = next(one for one in self.records if one.id == after)
        self._menus[command.menu].addMenu(menu)

    def refresh(self, *_: object) -> None:
        """Enable, check and name all commands as the window is now; takes whatever a signal carries."""
        state = self._state_now()
        if state != self._state:
            self._state = state
            for command in self.records:
                self._show(command)

    def set_palette(self, palette: Palette) -> None:
        """Draw all icons in the colours of a theme."""
        self.refresh()
        for command in self.records:
            icon = command.wording(self._state).icon
            if icon:
                self.actions[command.id].setIcon(icons.icon(icon, palette))

    def _show(self, command: Command) -> None:
        """Show one command as it is in the state of the window."""
        action, wording = self.actions[command.id], command.wording(self._state)
        if command.switch is None:  # else its panel says so
            action.setEnabled(command.enabled_when(self._state))
        if command.checked_when is not None:
            action.setChecked(command.checked_when(self._state))
        if self._worded.get(command.id) == wording:
            return
        self._worded[command.id] = wording
        action.setText(wording.text)
        action.setStatusTip(wording.tip)
        if command.switch is not None:
            return
        if command.shortcuts:
            keys = QKeySequence(command.shortcuts[0]).toString(QKeySequence.SequenceFormat.NativeText)
            action.setToolTip(f"{wording.tip} ({keys})")
        else:
            action.setToolTip(wording.tip)
