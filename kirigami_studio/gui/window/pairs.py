"""File > Examples of pairs: finished designs from one shape to another, each pictured flat, half open and open."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QSize, Qt, QTimer, Signal
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import QDialog, QListWidgetItem, QWidget

from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.session.queue import JobCallbacks, JobQueue, LatestJob
from kirigami_studio.gui.stage.layout_items import states_pixmap
from kirigami_studio.gui.widgets.layouts import column, label
from kirigami_studio.gui.widgets.search_window import picture_list
from kirigami_studio.gui.widgets.theme import LIGHT, Palette
from kirigami_studio.studio.projects import Pair, reading_pairs
from kirigami_studio.studio.two_states import TwoStates

#: Pixels: the picture of a pair, its card, and the window.
PICTURE, CARD, SIZE = QSize(294, 98), QSize(308, 141), QSize(968, 632)
ABOUT = mark("Each is a finished design. Choose one, drag the slider, then change target or start and press Generate.")


class PairGallery(QDialog):
    """Lists the bundled pairs; a click or Enter opens one."""

    chosen = Signal(Path)

    def __init__(self, parent: QWidget, queue: JobQueue) -> None:
        super().__init__(parent)
        self.setObjectName("pairGallery")
        self.setWindowTitle(tr("Examples of pairs"))
        self.setModal(False)
        self.resize(SIZE)
        self.pairs: list[Pair] = []
        self._palette: Palette = LIGHT
        self._job = LatestJob[Pair](queue)
        self._undrawn: list[int] = []
        self._drawing = QTimer(self, singleShot=True, interval=0)  # one picture for each turn of the window
        self._drawing.timeout.connect(self._draw_next)
        self.list = picture_list("pairList", tr("Pairs of shapes"), PICTURE, CARD)
        self.about = label(tr(ABOUT), wraps=True)
        column((self.list, 1), self.about, on=self, margins=(12, 12, 12, 10))
        self.list.itemClicked.connect(self._on_activated)
        self.list.itemActivated.connect(self._on_activated)

    def read(self) -> None:
        """Read the pairs in the worker, once."""
        if not self.pairs and not self._job.busy:
            callbacks = JobCallbacks(self._add, on_failed=lambda sentence, _: self.about.setText(sentence))
            self._job.start(tr("reading the examples"), reading_pairs, callbacks)

    @property
    def complete(self) -> bool:
        """Whether all pairs are read and drawn."""
        return bool(self.pairs) and not self._job.busy and not self._undrawn

    def set_palette(self, palette: Palette) -> None:
        if palette is not self._palette:
            self._palette = palette
            self._undrawn = list(range(len(self.pairs)))
            self._drawing.start()

    def _add(self, pair: Pair) -> None:
        states = TwoStates.of(pair.candidate, pair.design, pair.target, 100.0)
        title = tr("{start} to {target}", start=states.start.name, target=states.target.name)
        item = QListWidgetItem(
            tr("{title}  ·  match {percent:.1f} %", title=title, percent=100.0 * (states.target.match or 0.0))
        )
        (rows, columns), score = pair.candidate.sheet.grid, pair.candidate.score
        lines = (
            *states.lines(),
            tr(
                "{rows} \N{MULTIPLICATION SIGN} {columns} voids, panel sizes vary by {percent:.0f} %",
                rows=rows,
                columns=columns,
                percent=100.0 * score.evenness.area_cv,
            ),
        )
        item.setToolTip("\n".join(lines))
        item.setData(Qt.ItemDataRole.AccessibleDescriptionRole, "\n".join(lines))
        item.setSizeHint(CARD)
        item.setTextAlignment(Qt.AlignmentFlag.AlignHCenter)
        self.list.addItem(item)
        self.pairs.append(pair)
        self._undrawn.append(len(self.pairs) - 1)
        self._drawing.start()

    def _draw_next(self) -> None:
        if self._undrawn:
            row = self._undrawn.pop(0)
            pair = self.pairs[row]
            picture = states_pixmap(pair.design, pair.target, PICTURE, self.devicePixelRatioF(), self._palette)
            self.list.item(row).setIcon(QIcon(picture))
        if self._undrawn:
            self._drawing.start()

    def _on_activated(self, item: QListWidgetItem) -> None:
        self.chosen.emit(self.pairs[self.list.row(item)].path)
        self.accept()
