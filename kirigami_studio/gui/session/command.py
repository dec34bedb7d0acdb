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
    """All that decides which commands are enabled, checked, and how they are worded.

    Attributes
    ----------
    has_target, has_designs : bool
        What the document holds.
    has_parts : bool
        The target was read from a drawing whose parts can be chosen.
    shows_design : bool
        A design is shown large; during a run it need not be the document's.
    chosen : Mark or None
        Mark of the document's chosen design, None when there is none.
    undo_label, redo_label : str or None
        The steps that Undo and Redo would take.
    running : bool
        Designs are being generated.
    busy : bool
        The chosen design is being trimmed or fitted again.
    editing_target : bool
        The drawing board is open.
    arrangements : frozenset of str
        What can be done with the objects that are selected on the board.
    comparing : bool
        Two designs are shown side by side.
    ideal : Switch
    dark, follows_system : bool
        The theme, and whether it is the desktop's.
    still : bool
        Nothing moves by itself.
    """

    has_target: bool
    has_designs: bool
    has_parts: bool
    shows_design: bool
    chosen: Mark | None
    undo_label: str | None
    redo_label: str | None
    running: bool
    busy: bool
    editing_target: bool
    arrangements: frozenset[str]
    comparing: bool
    ideal: Switch
    dark: bool
    follows_system: bool
    still: bool

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
    """One command of the window.

    Attributes
    ----------
    menu : str
        Title of the menu that it stands in.
    id : str
        Name of its action.
    text : str
        As in the menu, ``&`` before the mnemonic.
    tip : str
        What it does, for the status line and the tooltip.
    run : callable
        What it does.
    keys : str
        Key sequences, "; " between them; the first is shown.
    icon : str
        Bundled icon, or "" for none.
    gap : bool
        A separator comes before it.
    enabled_when : callable
        Whether it can be given in a state of the window.
    checked_when : callable or None
        Whether it is checked; None for a command that is no switch.
    worded : callable or None
        Its text, tip and icon where they depend on the state of the window.
    switch : QAction or None
        The action of a switch that a panel owns: the command is that action.
    """

    menu: str
    id: str
    text: str
    tip: str
    run: Callable[[], object]
    keys: str = ""
    icon: str = ""
    gap: bool = False
    enabled_when: Callable[[WindowState], bool] = always
    checked_when: Callable[[WindowState], bool] | None = None
    worded: Callable[[WindowState], Wording] | None = None
    switch: QAction | None = None

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
