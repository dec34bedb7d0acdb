"""The problems of the cut check as a list; one that has a place leads to it."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, QSize, Qt, Signal
from PySide6.QtWidgets import QListWidget, QListWidgetItem, QWidget

from kirigami_studio.fabricate.checks import Problem, Severity
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.look import icons
from kirigami_studio.gui.look.theme import LIGHT, Palette

#: Lines that are shown without scrolling.
MOST_LINES = 3
ICONS = {Severity.ERROR: "fault", Severity.WARNING: "warning"}
WORDS = {Severity.ERROR: tr("Error"), Severity.WARNING: tr("Warning")}


class ProblemList(QListWidget):
    """One line for each problem: symbol, word and sentence; hidden while there is none."""

    picked = Signal(int)  #: number of the problem

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._problems: tuple[Problem, ...] = ()
        self._palette: Palette = LIGHT
        self.setObjectName("problemList")
        self.setAccessibleName(tr("Problems of the cut plan"))
        self.setIconSize(QSize(16, 16))
        self.setTextElideMode(Qt.TextElideMode.ElideRight)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.currentRowChanged.connect(self._tell)
        self.itemClicked.connect(lambda item: self._tell(self.row(item)))
        self.hide()

    def show_problems(self, problems: tuple[Problem, ...]) -> None:
        """Show another plan's problems."""
        self._problems = problems
        with QSignalBlocker(self):
            self.clear()
            for problem in problems:
                item = QListWidgetItem(f"{WORDS[problem.severity]}: {problem.text}")
                place = "" if problem.where is None else tr("\nClick to see the place.")
                item.setToolTip(f"{problem.text}{place}")
                self.addItem(item)
            self.setCurrentRow(-1)
        self._dress()
        self.setVisible(bool(problems))
        lines = min(len(problems), MOST_LINES)
        self.setFixedHeight(lines * (self.fontMetrics().height() + 8) + 6)

    def show_picked(self, problem: int) -> None:
        """Mark the line of a problem that was picked in the drawing."""
        with QSignalBlocker(self):
            self.setCurrentRow(problem)

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self._palette = palette
        self._dress()

    def _dress(self) -> None:
        for row, problem in enumerate(self._problems):
            self.item(row).setIcon(icons.icon(ICONS[problem.severity], self._palette, self._palette.warning))

    def _tell(self, row: int) -> None:
        if row >= 0:
            self.picked.emit(row)
