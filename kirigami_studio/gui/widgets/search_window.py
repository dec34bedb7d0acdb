"""What the guide, the sheet of shortcuts and About share: a window with a search field, and a list it narrows down."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QKeyEvent, QKeySequence, QResizeEvent, QShortcut
from PySide6.QtWidgets import QHeaderView, QLineEdit, QListView, QListWidget, QTreeWidget, QTreeWidgetItem, QWidget

from kirigami_studio.gui.widgets.layouts import label

#: Role of the words that a line is found by.
WORDS = Qt.ItemDataRole.UserRole


def search_field(prompt: str) -> QLineEdit:
    """A field that says what it searches while it is empty, with a button that clears it."""
    field = QLineEdit()
    field.setPlaceholderText(prompt)
    field.setAccessibleName(prompt)
    field.setClearButtonEnabled(True)
    return field


class PictureList(QListWidget):
    """Pictures with their names below them, in a grid of cards at least so large that fills the width."""

    def __init__(self, name: str, accessible: str, picture: QSize, card: QSize) -> None:
        super().__init__()
        self._card = card
        self.setObjectName(name)
        self.setAccessibleName(accessible)
        self.setViewMode(QListView.ViewMode.IconMode)
        self.setMovement(QListView.Movement.Static)
        self.setResizeMode(QListView.ResizeMode.Adjust)
        self.setIconSize(picture)
        self.setWordWrap(True)
        self._fill_width()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        self._fill_width()

    def _fill_width(self) -> None:
        width = self.width() - 2 * self.frameWidth() - self.verticalScrollBar().sizeHint().width()
        columns = max(width // self._card.width(), 1)
        cell = QSize(max(width // columns - 1, self._card.width()), self._card.height())
        if cell != self.gridSize():
            self.setGridSize(cell)


class SearchWindow(QWidget):
    """A window with a search field: Ctrl+F goes to it, Esc clears it, then closes the window."""

    def __init__(self, parent: QWidget, title: str, prompt: str, tip: str) -> None:
        super().__init__(parent, Qt.WindowType.Window)
        self.setWindowTitle(title)
        self.search = search_field(prompt)
        self.search.setToolTip(tip)
        self.found = label()
        QShortcut(QKeySequence.StandardKey.Find, self, self._begin_search)

    def _begin_search(self) -> None:
        self.search.setFocus()
        self.search.selectAll()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        """Esc clears the search, then closes the window."""
        if event.key() != Qt.Key.Key_Escape:
            super().keyPressEvent(event)
        elif self.search.text():
            self.search.clear()
        else:
            self.close()


class SearchedList(QTreeWidget):
    """Lines in columns, alone or under headings, of which only those with the wanted words are shown."""

    def __init__(self, columns: Sequence[str], name: str) -> None:
        super().__init__()
        self.setAccessibleName(name)
        self.setHeaderLabels(list(columns))
        self.setRootIsDecorated(False)
        self.setUniformRowHeights(True)
        self.header().setStretchLastSection(False)
        self.header().setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        self.header().setSectionResizeMode(1, QHeaderView.ResizeMode.ResizeToContents)
        self._lines: list[QTreeWidgetItem] = []
        self._heads: dict[str, QTreeWidgetItem] = {}

    def add(self, cells: Sequence[str], words: str, tips: Sequence[str], under: str = "") -> None:
        """A line at the end of its heading, which is made where it is the first one there."""
        line = QTreeWidgetItem(list(cells))
        line.setData(0, WORDS, words.lower())
        for column, tip in enumerate(tips):
            line.setToolTip(column, tip)
        if under:
            self._head(under).addChild(line)
        else:
            self.addTopLevelItem(line)
        self._lines.append(line)

    def _head(self, text: str) -> QTreeWidgetItem:
        if text not in self._heads:
            head = self._heads[text] = QTreeWidgetItem([text])
            font = self.font()
            font.setBold(True)
            head.setFont(0, font)
            head.setFlags(Qt.ItemFlag.ItemIsEnabled)
            self.addTopLevelItem(head)
            head.setFirstColumnSpanned(True)
            head.setExpanded(True)
        return self._heads[text]

    @property
    def shown_lines(self) -> list[QTreeWidgetItem]:
        """The lines that are shown, in the order they were added."""
        return [line for line in self._lines if not line.isHidden()]

    def narrow(self, text: str) -> int:
        """Show the lines that have every word of ``text``, and the headings over them; how many lines they are."""
        words = text.lower().split()
        for line in self._lines:
            line.setHidden(not all(word in line.data(0, WORDS) for word in words))
        for head in self._heads.values():
            head.setHidden(all(line.isHidden() for line in self._lines if line.parent() is head))
        return len(self.shown_lines)
