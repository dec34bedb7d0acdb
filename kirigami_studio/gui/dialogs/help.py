"""Help: the user guide with contents and search, and the sheet of all keys and mouse gestures with a search."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path

from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtGui import QKeyEvent, QKeySequence, QShortcut, QTextCursor
from PySide6.QtWidgets import (
    QHeaderView,
    QLabel,
    QLineEdit,
    QSplitter,
    QTextBrowser,
    QTextEdit,
    QTreeWidget,
    QTreeWidgetItem,
    QTreeWidgetItemIterator,
    QVBoxLayout,
    QWidget,
)

from kirigami_studio.foundation.resources import resource
from kirigami_studio.foundation.words import language, tr, tr_n
from kirigami_studio.gui.command import Command

#: Headings down to this level are in the guide's contents.
DEEPEST = 3
#: Role of a heading's place in the text, characters.
PLACE = Qt.ItemDataRole.UserRole


def guide_file() -> Path:
    """The guide in the language that is spoken, such as ``guide.de.md``; the English one where there is none."""
    own = resource("guide", f"guide.{language().split('_')[0]}.md")
    return own if own.is_file() else resource("guide", "guide.md")


class GuideWindow(QWidget):
    """Shows the guide in the window's language beside its contents, and finds words in it."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent, Qt.WindowType.Window)
        self.setWindowTitle(tr("Kirigami Studio guide"))
        self._places: list[QTextCursor] = []
        self._at = -1
        self.text = QTextBrowser()
        self.text.setObjectName("guideText")
        self.text.setAccessibleName(tr("User guide"))
        self.text.setOpenExternalLinks(True)
        self.search = QLineEdit()
        self.search.setPlaceholderText(tr("Search the guide"))
        self.search.setAccessibleName(tr("Search the guide"))
        self.search.setToolTip(tr("Find words in the guide (Ctrl+F); Enter goes on, Shift+Enter back."))
        self.search.setClearButtonEnabled(True)
        self.found = QLabel()
        self.found.setObjectName("muted")
        self.contents = QTreeWidget()
        self.contents.setObjectName("guideContents")
        self.contents.setAccessibleName(tr("Contents of the guide"))
        self.contents.setHeaderHidden(True)
        self.contents.setIndentation(14)
        self.contents.setUniformRowHeights(True)
        self._lay_out()
        self._read()
        QShortcut(QKeySequence.StandardKey.Find, self, self._begin_search)
        self.search.textChanged.connect(self._find)
        self.contents.itemClicked.connect(self._go_to)
        self.contents.itemActivated.connect(self._go_to)
        self.text.verticalScrollBar().valueChanged.connect(self._follow)
        self.resize(960, 720)

    def _lay_out(self) -> None:
        side = QWidget()
        left = QVBoxLayout(side)
        left.setContentsMargins(12, 12, 4, 12)
        left.setSpacing(6)
        for part in (self.search, self.found, self.contents):
            left.addWidget(part)
        columns = QSplitter(Qt.Orientation.Horizontal)
        columns.setChildrenCollapsible(False)
        columns.addWidget(side)
        columns.addWidget(self.text)
        columns.setStretchFactor(1, 1)
        columns.setSizes([260, 700])
        whole = QVBoxLayout(self)
        whole.setContentsMargins(0, 0, 0, 0)
        whole.addWidget(columns)

    def _read(self) -> None:
        """Show the guide of the present language."""
        self._file = guide_file()
        # Pictures of the window in its own language are in a folder beside the others.
        self.text.setSearchPaths([str(resource("guide", language().split("_")[0])), str(resource("guide"))])
        self.text.setMarkdown(self._file.read_text(encoding="utf-8"))
        self._list_contents()

    def _change_language(self) -> None:
        """The same section in the other language, and the same words searched for."""
        if guide_file() == self._file:
            return
        lines, at = self.headings, self.contents.currentItem()
        section = next((row for row, line in enumerate(lines) if line is at), None)
        self._read()
        if section is not None:
            self.text.document().size()  # laid out whole, or it could not be scrolled that far
            self._go_to(self.headings[section])
        self._find(self.search.text())

    def _list_contents(self) -> None:
        """One line for each heading, under the one above it."""
        self.contents.clear()
        above: dict[int, QTreeWidgetItem] = {}
        block = self.text.document().begin()
        while block.isValid():
            level = block.blockFormat().headingLevel()
            if 2 <= level <= DEEPEST:
                line = QTreeWidgetItem([block.text()])
                line.setToolTip(0, block.text())
                line.setData(0, PLACE, block.position())
                above[level] = line
                if level > 2 and level - 1 in above:
                    above[level - 1].addChild(line)
                else:
                    self.contents.addTopLevelItem(line)
            block = block.next()
        self.contents.expandAll()

    @property
    def headings(self) -> list[QTreeWidgetItem]:
        """The lines of the contents, in the order of the text."""
        walk, found = QTreeWidgetItemIterator(self.contents), []
        while line := walk.value():
            found.append(line)
            walk += 1
        return found

    def _go_to(self, line: QTreeWidgetItem) -> None:
        self.text.verticalScrollBar().setValue(round(self._height(line)))
        self.contents.setCurrentItem(line)

    def _height(self, line: QTreeWidgetItem) -> float:
        """Height of a heading in the text, from its beginning, in pixels."""
        block = self.text.document().findBlock(line.data(0, PLACE))
        return self.text.document().documentLayout().blockBoundingRect(block).top()

    def _follow(self) -> None:
        """The text was scrolled: the contents show where."""
        top = self.text.verticalScrollBar().value() + 12
        passed = list(takewhile(lambda line: self._height(line) <= top, self.headings))  # those below wait for layout
        if passed:
            self.contents.setCurrentItem(passed[-1])

    def _begin_search(self) -> None:
        self.search.setFocus()
        self.search.selectAll()

    def _find(self, words: str) -> None:
        """Mark every place with these words, and go to the first one from here on."""
        document, wanted = self.text.document(), words.strip()
        self._places, self._at = [], -1
        cursor = document.find(wanted) if wanted else QTextCursor()
        while not cursor.isNull():
            self._places.append(cursor)
            cursor = document.find(wanted, cursor)
        top = self.text.cursorForPosition(QPoint(4, 12)).position()
        below = (place for place, found in enumerate(self._places) if found.position() >= top)
        self._show_place(next(below, 0))

    def _show_place(self, place: int) -> None:
        count = len(self._places)
        if not count:
            self.found.setText(tr("Not found") if self.search.text().strip() else "")
            self.text.setExtraSelections([])
            return
        self._at = place % count
        self.found.setText(tr("{place} of {count}", place=self._at + 1, count=count))
        here, others = self.palette().highlight().color(), self.palette().highlight().color()
        others.setAlpha(70)
        marks = []
        for number, found in enumerate(self._places):
            mark = QTextEdit.ExtraSelection()
            mark.cursor = found
            mark.format.setBackground(here if number == self._at else others)
            if number == self._at:
                mark.format.setForeground(self.palette().highlightedText().color())
            marks.append(mark)
        self.text.setExtraSelections(marks)
        there = QTextCursor(self._places[self._at])
        there.clearSelection()
        self.text.setTextCursor(there)
        self.text.ensureCursorVisible()

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802 - Qt's name
        """The guide follows the language of the window."""
        if event.type() == QEvent.Type.LanguageChange:
            self._change_language()
        super().changeEvent(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        """Enter goes to the next place, Shift+Enter to the one before; Esc clears the search, then closes the guide."""
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and self._places:
            back = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
            self._show_place(self._at + (-1 if back else 1))
        elif event.key() != Qt.Key.Key_Escape:
            super().keyPressEvent(event)
        elif self.search.text():
            self.search.clear()
        else:
            self.close()


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
        Gesture(board, tr("+ and -, 0, 1, 2"), tr("Zoom; show everything, actual size, the selection")),
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
        self.resize(860, 640)

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
