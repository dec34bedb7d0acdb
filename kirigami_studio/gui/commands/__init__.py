"""Every command of the window: one record each, in one module for each menu.

A record (:class:`~kirigami_studio.gui.command.Command`) holds all that is to know of a command: its id, text,
keys, icon, when it is enabled and what it does.  :class:`~kirigami_studio.gui.commands.actions.CommandActions` makes
the menus of them and keeps them up to date with the window's state; the sheet of shortcuts lists the same records.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kirigami_studio.gui.command import Command
from kirigami_studio.gui.commands import design, draw, edit, file, help, view

if TYPE_CHECKING:
    from kirigami_studio.gui.main_window import MainWindow


def all_commands(window: MainWindow) -> tuple[Command, ...]:
    """Return the commands of a window in the order of its menus."""
    return tuple(one for menu in (file, edit, draw, design, view, help) for one in menu.commands(window))
