"""What the keys mean while voids are edited by hand."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import Qt
from PySide6.QtGui import QKeyEvent

_WALKS = {
    Qt.Key.Key_Left: (0, -1),
    Qt.Key.Key_Right: (0, 1),
    Qt.Key.Key_Up: (-1, 0),
    Qt.Key.Key_Down: (1, 0),
}
#: Shift is part of "+" on many keyboards, so that Alt asks for fine steps here.
_TURNS = {Qt.Key.Key_Plus: 1, Qt.Key.Key_Equal: 1, Qt.Key.Key_Minus: -1, Qt.Key.Key_Underscore: -1}


@dataclass(frozen=True, slots=True)
class Step:
    """A walk to another void, or a change of the ratio.

    Attributes
    ----------
    down, right : int
        Rows and columns to walk.
    direction : int
        1 for a larger ratio, -1 for a smaller one, 0 for a walk.
    fine : bool
    """

    down: int = 0
    right: int = 0
    direction: int = 0
    fine: bool = False


def step_of(event: QKeyEvent) -> Step | None:
    """What a key asks for, if anything; Ctrl and the keys of the window stay with the window."""
    key, modifiers = Qt.Key(event.key()), event.modifiers()
    if modifiers & Qt.KeyboardModifier.ControlModifier:
        return None
    fine = bool(modifiers & Qt.KeyboardModifier.AltModifier)
    if key in _WALKS and not fine:
        down, right = _WALKS[key]
        return Step(down, right)
    if key in _TURNS:
        return Step(direction=_TURNS[key], fine=fine)
    return None
