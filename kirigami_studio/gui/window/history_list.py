"""Edit > History: every step by its name; a click goes there."""

from __future__ import annotations

from PySide6.QtCore import QPoint, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent
from PySide6.QtWidgets import QListWidget, QListWidgetItem, QWidget

from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.gui.widgets.layouts import column, label
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.project.history import History

#: Pixels.
WIDTH = 300


class HistoryList(QWidget):
    """A small window; the present step is selected, undone ones are pale."""

    step_wanted = Signal(int)  #: number of steps to keep done

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent, Qt.WindowType.Tool)
        self.setWindowTitle(tr("History"))
        self.setObjectName("historyList")
        self.steps = QListWidget()
        self.steps.setAccessibleName(tr("History steps"))
        self.steps.setToolTip(tr("Click a step or press Enter to go there. Later steps can be redone."))
        self.steps.setUniformItemSizes(True)
        self.steps.setSpacing(2)
        self.steps.itemClicked.connect(self._go)
        self.steps.itemActivated.connect(self._go)
        self.counted = label()
        column((self.steps, 1), self.counted, on=self, spacing=6, margins=(8, 8, 8, 8))
        self.resize(WIDTH, 380)
        # Over the stage's upper right corner: beside the candidates, off the target and the menus.
        self.move(parent.mapToGlobal(QPoint(round(0.74 * parent.width()) - WIDTH, 120)))

    def show_history(self, history: History, palette: Palette) -> None:
        """List the steps of a history."""
        names = (tr("Start"), *history.steps)
        if [self.steps.item(row).text() for row in range(self.steps.count())] != list(names):
            self.steps.clear()
            self.steps.addItems(names)
        self.steps.setCurrentRow(history.position)
        for row in range(self.steps.count()):
            item = self.steps.item(row)
            font = item.font()
            font.setBold(row == history.position)
            font.setItalic(row > history.position)
            item.setFont(font)
            item.setForeground(QColor(palette.muted if row > history.position else palette.text))
            item.setToolTip(tr("Undone. Click to redo.") if row > history.position else "")
        self.steps.scrollToItem(self.steps.item(history.position))
        undone = len(history.steps) - history.position
        if undone:
            text = tr_n(
                "{count} step, {undone} undone", "{count} steps, {undone} undone", history.position, undone=undone
            )
        else:
            text = tr_n("{count} step", "{count} steps", history.position)
        self.counted.setText(text)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        if event.key() == Qt.Key.Key_Escape:
            self.close()
        else:
            super().keyPressEvent(event)

    def _go(self, item: QListWidgetItem) -> None:
        self.step_wanted.emit(self.steps.row(item))
