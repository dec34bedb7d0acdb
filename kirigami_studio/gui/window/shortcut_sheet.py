"""Help > Keyboard shortcuts: the sheet of all keys and mouse gestures, with a search."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from PySide6.QtGui import QKeySequence
from PySide6.QtWidgets import QWidget

from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.gui.session.command import Command
from kirigami_studio.gui.widgets.layouts import column
from kirigami_studio.gui.widgets.search_window import SearchedList, SearchWindow


@dataclass(frozen=True, slots=True)
class Gesture:
    """A mouse gesture: in which view, how, and with what effect."""

    view: str
    does: str
    effect: str


def gestures() -> tuple[Gesture, ...]:
    """Gestures of all views, then those of single ones."""
    anywhere, board, cuts, numbers = tr("All views"), tr("Drawing board"), tr("Cuts"), tr("Numbers and angle")
    hand, gallery = tr("Edit by hand"), tr("Designs")
    return (
        Gesture(anywhere, tr("Wheel"), tr("Zoom at the pointer")),
        Gesture(anywhere, tr("Drag"), tr("Pan the view")),
        Gesture(anywhere, tr("Double-click"), tr("Fit view")),
        Gesture(tr("Start tile"), tr("Drop a file"), tr("Start as the shape in it; Delete goes back to the rectangle")),
        Gesture(board, tr("+ and -, 0"), tr("Zoom; show everything")),
        Gesture(board, tr("Space+drag or middle button"), tr("Pan the board")),
        Gesture(board, tr("Drag from a ruler"), tr("Pull out a guide; back onto the ruler removes it")),
        Gesture(board, tr("Esc"), tr("Take back one thing: gesture, selection, tool; then leave the board")),
        Gesture(anywhere, tr("Right-click or the menu key"), tr("Open the menu of what is there")),
        Gesture(board, tr("Ctrl while drawing"), tr("Ignore the grid")),
        Gesture(board, tr("Shift while dragging a box"), tr("Keep the shape regular")),
        Gesture(board, tr("Drag a point"), tr("Move it; arrow keys nudge it (Shift: farther)")),
        Gesture(board, tr("Double-click the outline"), tr("Add a point there")),
        Gesture(board, tr("Shift while rotating"), tr("Rotate in 15° steps")),
        Gesture(board, tr("[ and ] with points"), tr("Go through the points; Ctrl+A selects all, Delete removes")),
        Gesture(
            hand, tr("Wheel or + and -"), tr("Change the void's ratio; Shift (wheel) or Alt (keys) for fine steps")
        ),
        Gesture(hand, tr("Drag a void"), tr("Change its ratio; Esc cancels the drag")),
        Gesture(hand, tr("Drag a corner of the outline"), tr("Move the outline as far as it can go")),
        Gesture(hand, tr("Drag a disc on the rim"), tr("Move the edge cut there along its side, up to its neighbours")),
        Gesture(hand, tr("Alt+click a void"), tr("Lock or unlock it")),
        Gesture(hand, tr("Arrow keys"), tr("Go to the next void; beyond the last one, to the edge cut there")),
        Gesture(hand, tr("Arrow keys with an edge cut"), tr("Move it along its side (Alt: fine), or go back inside")),
        Gesture(gallery, tr("Ctrl+click a card"), tr("Compare it with the chosen design")),
        Gesture(gallery, tr("Delete"), tr("Reject the chosen design; Undo restores it")),
        Gesture(cuts, tr("Click a connector"), tr("Select it; type a width in mm, or press Delete")),
        Gesture(cuts, tr("Shift+click"), tr("Add to or remove from the selection")),
        Gesture(cuts, tr("Shift+drag"), tr("Select everything in the box; Ctrl+A selects all")),
        Gesture(cuts, tr("Drag a connector"), tr("Widen or narrow it (Alt: fine)")),
        Gesture(cuts, tr("Double-click a connector"), tr("Cut it through, or restore it")),
        Gesture(numbers, tr("Arrow keys"), tr("One step; Page Up and Page Down: ten")),
    )


class ShortcutSheet(SearchWindow):
    """Lists the commands that have keys, and the gestures; typing filters both."""

    def __init__(self, parent: QWidget, commands: Iterable[Command]) -> None:
        super().__init__(
            parent,
            title=tr("Keyboard shortcuts"),
            prompt=tr("Search commands, keys and gestures"),
            tip=tr("Show only lines that contain these words"),
        )
        self.list = SearchedList([tr("Action"), tr("Keys or mouse")], name=tr("Shortcuts and gestures"))
        self.list.setObjectName("shortcutList")
        column(self.search, (self.list, 1), self.found, on=self, margins=(12, 12, 12, 10))
        self._fill(commands)
        self.search.textChanged.connect(self._filter)
        self._filter("")
        self.resize(860, 640)

    def _fill(self, commands: Iterable[Command]) -> None:
        for command in commands:
            if command.shortcuts:
                keys = tr(" or ").join(shown(keys) for keys in command.shortcuts)
                text = command.text.replace("&", "")
                self._add(command.menu.replace("&", "").rpartition("|")[2], command.tip or text, keys, text)
        for gesture in gestures():
            self._add(gesture.view, gesture.effect, gesture.does)

    def _add(self, group: str, effect: str, keys: str, text: str = "") -> None:
        self.list.add([effect, keys], words=f"{effect} {keys} {group} {text}", tips=[effect], under=group)

    def showing(self) -> list[tuple[str, str]]:
        """The visible lines: effect, keys."""
        return [(line.text(0), line.text(1)) for line in self.list.shown_lines]

    def _filter(self, text: str) -> None:
        self.found.setText(tr_n("{count} line", "{count} lines", self.list.narrow(text)))


def shown(keys: str) -> str:
    """A key sequence as this platform writes it."""
    return QKeySequence(keys).toString(QKeySequence.SequenceFormat.NativeText)
