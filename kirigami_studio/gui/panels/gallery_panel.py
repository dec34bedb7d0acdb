"""The candidates with their count, what they are sorted by, and more of them."""

from __future__ import annotations

from PySide6.QtCore import QSize
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.designs.selecting import Selection, counted
from kirigami_studio.gui.look.theme import Palette
from kirigami_studio.gui.panels.card import INSET, Card, FittingLabel
from kirigami_studio.gui.panels.gallery_bar import GalleryBar
from kirigami_studio.gui.views.gallery_view import GalleryView


class GalleryPanel(Card):
    """Title, count, bar and cards."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(tr("Candidates"), parent, right_inset=4)
        self.view = GalleryView()
        self.bar = GalleryBar()
        self.count = FittingLabel()
        self.count.setContentsMargins(0, 0, 8, 0)
        self.header.addWidget(self.count)
        self.body.addWidget(self.bar)
        self.body.addWidget(self.view, 1)
        self.view.model_.arranged.connect(self._count)
        self.view.clear_wanted.connect(self.bar.show_all)
        self.bar.selection_changed.connect(self._select)

    def _select(self, selection: Selection) -> None:
        self.view.select(selection)
        self._count()

    def _count(self) -> None:
        model = self.view.model_
        self.count.set_texts(*counted([entry.candidate for entry in model.entries], len(model.all_entries)))
        self._fit_count()
        self.view.viewport().update()

    def _fit_count(self) -> None:
        self.count.fit(self.width() - INSET - 4 - self.title.sizeHint().width() - 16)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        self._fit_count()
        super().resizeEvent(event)

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self.view.set_palette(palette)
        self.bar.set_palette(palette)

    def minimumSizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return QSize(250, 236)
