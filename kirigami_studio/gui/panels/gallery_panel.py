"""The candidates with their count."""

from __future__ import annotations

from PySide6.QtCore import QSize
from PySide6.QtWidgets import QLabel, QWidget

from kirigami_studio.gui.panels.card import Card
from kirigami_studio.gui.theme import Palette
from kirigami_studio.gui.views.gallery_view import GalleryView


class GalleryPanel(Card):
    """Title, count and cards."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__("Candidates", parent, right_inset=4)
        self.view = GalleryView()
        self.count = QLabel()
        self.count.setObjectName("muted")
        self.header.addWidget(self.count)
        self.body.addWidget(self.view, 1)
        for signal in (self.view.model_.rowsInserted, self.view.model_.modelReset):
            signal.connect(self._count)

    def _count(self) -> None:
        entries = self.view.model_.entries
        feasible = sum(entry.candidate.score.feasible for entry in entries)
        self.count.setText(f"{feasible} of {len(entries)} feasible" if entries else "")
        self.count.setContentsMargins(0, 0, 8, 0)

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self.view.set_palette(palette)

    def minimumSizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return QSize(250, 236)
