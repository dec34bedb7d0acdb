"""A command of the window as a record, and the state of the window that enables, checks and names it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from PySide6.QtGui import QAction

from kirigami_studio.project.document import Mark


class Switch(NamedTuple):
    """A checkable button of the stage, whose command has the same state."""

    enabled: bool
    checked: bool


@dataclass(frozen=True, slots=True)
class WindowState:
    """All that decides which commands are enabled, checked, and how they are worded."""

    #: has_target, has_designs: what the document holds.
    has_target: bool
    has_designs: bool
    has_parts: bool  #: the target was read from a drawing whose parts can be chosen
    shows_design: bool  #: a design is shown large; during a run it need not be the document's
    chosen: Mark | None  #: mark of the document's chosen design, None when there is none
    #: undo_label, redo_label: the steps that Undo and Redo would take.
    undo_label: str | None
    redo_label: str | None
    running: bool  #: designs are being generated
    busy: bool  #: the chosen design is being trimmed or fitted again
    editing_target: bool  #: the drawing board is open
    previews: bool  #: a design is previewed while the target changes
    page: str  #: that is shown
    arrangements: frozenset[str]  #: what can be done with the objects that are selected on the board
    comparing: bool  #: two designs are shown side by side
    ideal: Switch
    #: dark, follows_system: the theme, and whether it is the desktop's.
    dark: bool
    follows_system: bool
    still: bool  #: nothing moves by itself
    inches: bool  #: fields for lengths show inches

    @property
    def can_change_design(self) -> bool:
        """Whether a finished design is chosen and nothing is being generated."""
        return self.chosen is not None and not self.running


class Wording(NamedTuple):
    """How a command is shown."""

    text: str
    tip: str
    icon: str = ""


def always(state: WindowState) -> bool:
    """The condition of commands that are always enabled."""
    return True


@dataclass(frozen=True, slots=True)
class Command:
    """One command of the window."""

    menu: str  #: title of the menu that it stands in, "|" between a menu and one inside
    id: str  #: name of its action
    text: str  #: as in the menu, ``&`` before the mnemonic
    tip: str  #: what it does, for the status line and the tooltip
    run: Callable[[], object]  #: what it does
    keys: str = ""  #: key sequences, "; " between them; the first is shown
    icon: str = ""  #: bundled icon, or "" for none
    gap: bool = False  #: a separator comes before it
    enabled_when: Callable[[WindowState], bool] = always  #: whether it can be given in a state of the window
    #: Whether it is checked; None for a command that is no switch.
    checked_when: Callable[[WindowState], bool] | None = None
    #: Its text, tip and icon where they depend on the state of the window.
    worded: Callable[[WindowState], Wording] | None = None
    switch: QAction | None = None  #: the action of a switch that a panel owns: the command is that action

    @classmethod
    def switching(
        cls, menu: str, id: str, text: str, tip: str, switch: QAction, keys: str = "", icon: str = "", **more: Any
    ) -> Command:
        """Return the command that a switch of a panel is."""
        return cls(menu, id, text, tip, switch.trigger, keys, icon, switch=switch, **more)

    @property
    def shortcuts(self) -> tuple[str, ...]:
        """Key sequences one by one."""
        return tuple(self.keys.split("; ")) if self.keys else ()

    def wording(self, state: WindowState) -> Wording:
        """Return its text, tip and icon in a state of the window."""
        return Wording(self.text, self.tip, self.icon) if self.worded is None else self.worded(state)
