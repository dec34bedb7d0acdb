"""Help > User guide: the text beside its contents, with a search."""

from __future__ import annotations

from itertools import takewhile
from pathlib import Path

from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QKeyEvent, QTextCursor
from PySide6.QtWidgets import (
    QSplitter,
    QTextBrowser,
    QTextEdit,
    QTreeWidget,
    QTreeWidgetItem,
    QTreeWidgetItemIterator,
    QWidget,
)

from kirigami_studio.foundation.resources import resource
from kirigami_studio.foundation.words import language, tr
from kirigami_studio.gui.widgets.layouts import column
from kirigami_studio.gui.widgets.search_window import SearchWindow

#: Headings down to this level are in the guide's contents.
DEEPEST = 3
#: Role of a heading's place in the text, characters.
PLACE = Qt.ItemDataRole.UserRole


def guide_file() -> Path:
    """The guide in the language that is spoken, such as ``guide.de.md``; the English one where there is none."""
    own = resource("guide", f"guide.{language().split('_')[0]}.md")
    return own if own.is_file() else resource("guide", "guide.md")


class GuideWindow(SearchWindow):
    """Shows the guide in the window's language beside its contents, and finds words in it."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(
            parent,
            title=tr("Kirigami Studio guide"),
            prompt=tr("Search the guide"),
            tip=tr("Find words in the guide (Ctrl+F); Enter goes on, Shift+Enter back."),
        )
        self._places: list[QTextCursor] = []
        self._at = -1
        self.text = QTextBrowser()
        self.text.setObjectName("guideText")
        self.text.setAccessibleName(tr("User guide"))
        self.text.setOpenExternalLinks(True)
        self.contents = QTreeWidget()
        self.contents.setObjectName("guideContents")
        self.contents.setAccessibleName(tr("Contents of the guide"))
        self.contents.setHeaderHidden(True)
        self.contents.setIndentation(14)
        self.contents.setUniformRowHeights(True)
        self._lay_out()
        self._read()
        self.search.textChanged.connect(self._find)
        self.contents.itemClicked.connect(self._go_to)
        self.contents.itemActivated.connect(self._go_to)
        self.text.verticalScrollBar().valueChanged.connect(self._follow)
        self.resize(960, 720)

    def _lay_out(self) -> None:
        side = QWidget()
        column(self.search, self.found, self.contents, on=side, spacing=6, margins=(12, 12, 4, 12))
        columns = QSplitter(Qt.Orientation.Horizontal)
        columns.setChildrenCollapsible(False)
        columns.addWidget(side)
        columns.addWidget(self.text)
        columns.setStretchFactor(1, 1)
        columns.setSizes([260, 700])
        column(columns, on=self)

    def _read(self) -> None:
        """Show the guide of the present language."""
        # Pictures of the window in its own language are in a folder beside the others.
        self.text.setSearchPaths([str(resource("guide", language().split("_")[0])), str(resource("guide"))])
        self.text.setMarkdown(guide_file().read_text(encoding="utf-8"))
        self._list_contents()

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

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        """Enter goes to the next place, Shift+Enter to the one before; Esc clears the search, then closes the guide."""
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and self._places:
            back = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
            self._show_place(self._at + (-1 if back else 1))
        else:
            super().keyPressEvent(event)
