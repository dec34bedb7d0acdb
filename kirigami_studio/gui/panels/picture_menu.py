"""File > Export picture of: the views in sight, how large, with or without what is drawn over them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from PySide6.QtGui import QActionGroup
from PySide6.QtWidgets import QMenu, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.files.picturing import SCALES, Picturing


class PictureMenu(QMenu):
    """Asks where to, and lets the pictures be made."""

    def __init__(self, parent: QWidget, picturing: Picturing, ask: Callable[[str], Path | None]) -> None:
        super().__init__(tr("Export pi&cture of"), parent)
        self._picturing = picturing
        self._ask = ask
        self.menuAction().setStatusTip(tr("Write a view as PNG or SVG"))
        self.setToolTipsVisible(True)
        self.aboutToShow.connect(self.refresh)
        self.refresh()

    def refresh(self) -> None:
        """List the views in sight."""
        self.clear()
        for name, view in self._picturing.views().items():
            self.addAction(name.replace("&", "&&")).triggered.connect(partial(self._write, view, name))
        self.addSeparator()
        sizes = QActionGroup(self)
        for scale in SCALES:
            each = self.addAction(tr("&{scale} x as large (PNG)", scale=scale))
            each.setToolTip(tr("{scale} pixels of a PNG for each pixel of the view", scale=scale))
            each.setCheckable(True)
            each.setChecked(scale == self._picturing.scale)
            each.triggered.connect(partial(self._set_scale, scale))
            sizes.addAction(each)
        self.addSeparator()
        overlays = self.addAction(tr("With &overlays, as seen"))
        overlays.setObjectName("pictureOverlays")
        overlays.setCheckable(True)
        overlays.setChecked(self._picturing.overlays)
        overlays.toggled.connect(self._set_overlays)

    def _write(self, view: QWidget, name: str, _: bool = False) -> None:
        path = self._ask(f"{name.lower()}.png")
        if path is not None:
            self._picturing.write(view, path)

    def _set_scale(self, scale: int, _: bool = False) -> None:
        self._picturing.scale = scale

    def _set_overlays(self, on: bool) -> None:
        self._picturing.overlays = on
