"""Examples of pairs: finished designs from one shape to another, flat, half open and open."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QSize, Qt, QTimer, Signal
from PySide6.QtGui import QHideEvent, QIcon, QShowEvent
from PySide6.QtWidgets import QListWidgetItem, QWidget

from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.session.queue import JobCallbacks, JobQueue, LatestJob
from kirigami_studio.gui.stage.layout_items import states_pixmap
from kirigami_studio.gui.widgets.layouts import column, label
from kirigami_studio.gui.widgets.search_window import PictureList
from kirigami_studio.gui.widgets.theme import LIGHT, Palette
from kirigami_studio.studio.projects import Pair, reading_pairs
from kirigami_studio.studio.two_states import TwoStates

#: Pixels: the picture of a pair, and its card.
PICTURE, CARD = QSize(258, 86), QSize(270, 124)
ABOUT = mark("Finished pairs: choose one, drag the slider.")


class PairList(QWidget):
    """Lists the bundled pairs; a click or Enter opens one."""

    chosen = Signal(Path)

    def __init__(self) -> None:
        super().__init__()
        self.pairs: list[Pair] = []
        self._palette: Palette = LIGHT
        self._job: LatestJob[Pair] | None = None
        self._undrawn: list[int] = []
        self._drawing = QTimer(self, singleShot=True, interval=0)  # one picture for each turn of the window
        self._drawing.timeout.connect(self._draw_next)
        self.list = PictureList("pairList", tr("Pairs of shapes"), PICTURE, CARD)
        self.list.setMinimumHeight(CARD.height())
        self.about = label(tr(ABOUT), wraps=True)
        column(self.about, (self.list, 1), on=self, spacing=4)
        self.list.itemClicked.connect(self._on_activated)
        self.list.itemActivated.connect(self._on_activated)

    def read(self, queue: JobQueue) -> None:
        """Read the pairs in the worker, once."""
        if self._job is None:
            self._job = LatestJob[Pair](queue)
            callbacks = JobCallbacks(self._add, on_failed=lambda sentence, _: self.about.setText(sentence))
            self._job.start(tr("reading the examples"), reading_pairs, callbacks)

    @property
    def complete(self) -> bool:
        """Whether all pairs are read and drawn."""
        return self._job is not None and not self._job.busy and bool(self.pairs) and not self._undrawn

    def set_palette(self, palette: Palette) -> None:
        if palette is not self._palette:
            self._palette = palette
            self._undrawn = list(range(len(self.pairs)))
            self._draw_soon()

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
        self._draw_soon()

    def _draw_next(self) -> None:
        if self._undrawn:
            row = self._undrawn.pop(0)
            pair = self.pairs[row]
            picture = states_pixmap(pair.design, pair.target, PICTURE, self.devicePixelRatioF(), self._palette)
            self.list.item(row).setIcon(QIcon(picture))
        self._draw_soon()

    def _draw_soon(self) -> None:
        """Pictures are drawn while they are in sight."""
        if self._undrawn and self.isVisible():
            self._drawing.start()

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802 - Qt's name
        super().showEvent(event)
        self._draw_soon()

    def hideEvent(self, event: QHideEvent) -> None:  # noqa: N802 - Qt's name
        super().hideEvent(event)
        self._drawing.stop()

    def _on_activated(self, item: QListWidgetItem) -> None:
        self.chosen.emit(self.pairs[self.list.row(item)].path)
