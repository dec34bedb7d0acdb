"""Help: the user guide, and the sheet of all keys and mouse gestures with a search."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from PySide6.QtCore import Qt
from PySide6.QtGui import QKeyEvent, QKeySequence
from PySide6.QtWidgets import (
    QHeaderView,
    QLabel,
    QLineEdit,
    QTextBrowser,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from kirigami_studio.foundation.resources import resource
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.gui.command import Command


class GuideWindow(QWidget):
    """Shows ``resources/guide/guide.md``."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent, Qt.WindowType.Window)
        self.setWindowTitle(tr("Kirigami Studio guide"))
        self.text = QTextBrowser()
        self.text.setObjectName("guideText")
        self.text.setAccessibleName(tr("User guide"))
        self.text.setOpenExternalLinks(True)
        self.text.setSearchPaths([str(resource("guide"))])  # for its pictures
        self.text.setMarkdown(resource("guide", "guide.md").read_text(encoding="utf-8"))
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.text)
        self.resize(680, 720)


#: Role of the words that a line is found by.
WORDS = Qt.ItemDataRole.UserRole


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


class ShortcutSheet(QWidget):
    """Lists the commands that have keys, and the gestures; typing filters both."""

    def __init__(self, parent: QWidget, commands: Iterable[Command]) -> None:
        super().__init__(parent, Qt.WindowType.Window)
        self.setWindowTitle(tr("Keyboard shortcuts"))
        self.search = QLineEdit()
        self.search.setPlaceholderText(tr("Search commands, keys and gestures"))
        self.search.setAccessibleName(tr("Search shortcuts"))
        self.search.setToolTip(tr("Show only lines that contain these words"))
        self.search.setClearButtonEnabled(True)
        self.list = QTreeWidget()
        self.list.setObjectName("shortcutList")
        self.list.setAccessibleName(tr("Shortcuts and gestures"))
        self.list.setColumnCount(2)
        self.list.setHeaderLabels([tr("Action"), tr("Keys or mouse")])
        self.list.setRootIsDecorated(False)
        self.list.setUniformRowHeights(True)
        self.list.header().setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        self.list.header().setSectionResizeMode(1, QHeaderView.ResizeMode.ResizeToContents)
        self.found = QLabel()
        self.found.setObjectName("muted")
        column = QVBoxLayout(self)
        column.setContentsMargins(12, 12, 12, 10)
        column.addWidget(self.search)
        column.addWidget(self.list, 1)
        column.addWidget(self.found)
        self._fill(commands)
        self.search.textChanged.connect(self._filter)
        self._filter("")
        self.resize(720, 640)

    def _fill(self, commands: Iterable[Command]) -> None:
        for command in commands:
            if command.shortcuts:
                keys = tr(" or ").join(shown(keys) for keys in command.shortcuts)
                text = command.text.replace("&", "")
                self._add(command.menu.replace("&", ""), command.tip or text, keys, text)
        for gesture in gestures():
            self._add(gesture.view, gesture.effect, gesture.does)
        self.list.expandAll()

    def _add(self, group: str, effect: str, keys: str, text: str = "") -> None:
        heads = self.list.findItems(group, Qt.MatchFlag.MatchExactly)
        if not heads:
            head = QTreeWidgetItem([group])
            font = self.font()
            font.setBold(True)
            head.setFont(0, font)
            head.setFlags(Qt.ItemFlag.ItemIsEnabled)
            self.list.addTopLevelItem(head)
            head.setFirstColumnSpanned(True)
            heads = [head]
        line = QTreeWidgetItem([effect, keys])
        line.setToolTip(0, effect)
        line.setData(0, WORDS, f"{effect} {keys} {group} {text}".lower())
        heads[0].addChild(line)

    def showing(self) -> list[tuple[str, str]]:
        """The visible lines: effect, keys."""
        return [(line.text(0), line.text(1)) for line in self._lines() if not line.isHidden()]

    def _heads(self) -> list[QTreeWidgetItem]:
        found = (self.list.topLevelItem(row) for row in range(self.list.topLevelItemCount()))
        return [head for head in found if head is not None]

    def _lines(self) -> list[QTreeWidgetItem]:
        return [line for head in self._heads() for line in lines_of(head)]

    def _filter(self, text: str) -> None:
        words = text.lower().split()
        for line in self._lines():
            line.setHidden(not all(word in line.data(0, WORDS) for word in words))
        for head in self._heads():
            head.setHidden(all(line.isHidden() for line in lines_of(head)))
        self.found.setText(tr_n("{count} line", "{count} lines", len(self.showing())))

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        """Esc clears the search, then closes the sheet."""
        if event.key() != Qt.Key.Key_Escape:
            super().keyPressEvent(event)
        elif self.search.text():
            self.search.clear()
        else:
            self.close()


def lines_of(head: QTreeWidgetItem) -> list[QTreeWidgetItem]:
    """The lines under a heading."""
    return [line for line in (head.child(row) for row in range(head.childCount())) if line is not None]


def shown(keys: str) -> str:
    """A key sequence as this platform writes it."""
    return QKeySequence(keys).toString(QKeySequence.SequenceFormat.NativeText)
