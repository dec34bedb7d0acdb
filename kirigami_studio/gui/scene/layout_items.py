"""Paint the sheet: panels in two blues, so that the eye sees which way each one turns."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QPainter, QPen

from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.gui.look.theme import Palette
from kirigami_studio.gui.scene.paths import line_path, quad_paths

#: Panels smaller than this (pixels) get no line: it would swallow them.
SMALLEST_LINED_PANEL = 5.0


def paint_panels(
    painter: QPainter,
    panels: FloatArray,
    turns_left: BoolArray,
    palette: Palette,
    kept: Mapping[int, FloatArray] | None = None,
) -> None:
    """Fill all panels.

    Parameters
    ----------
    panels : (K, 4, 2) float, pixels
    turns_left : (K,) bool
        Panels that turn counter-clockwise while the sheet opens get the lighter blue.
    kept : mapping of row to (P, 2) float, pixels, optional
        What is drawn instead of trimmed panels.
    """
    kept = kept or {}
    whole = np.ones(len(panels), dtype=np.bool_)
    whole[list(kept)] = False
    size = np.median(np.linalg.norm(panels[:, 2] - panels[:, 0], axis=-1)) if len(panels) else 0.0
    line = QPen(Qt.PenStyle.NoPen)
    if size >= SMALLEST_LINED_PANEL:
        line = QPen(QColor(palette.panel_line), 1.0 if size > 14 else 0.6)
        line.setJoinStyle(Qt.PenJoinStyle.MiterJoin)
    for chosen, colour in ((~turns_left, palette.panel_even), (turns_left, palette.panel_odd)):
        # A pen in the fill's colour keeps hairline gaps of antialiasing from showing between closed panels.
        painter.setPen(line if line.style() != Qt.PenStyle.NoPen else QPen(QColor(colour), 0.5))
        painter.setBrush(QColor(colour))
        for path in quad_paths(panels[chosen & whole]):
            painter.drawPath(path)
        for row, part in kept.items():
            if chosen[row]:
                painter.drawPath(line_path(part, closed=True))


def turning_left(rows: int, columns: int) -> BoolArray:
    """Which of the (rows + 1)(columns + 1) panels turn counter-clockwise: those with I + J odd."""
    odd: BoolArray = np.add.outer(np.arange(rows + 1), np.arange(columns + 1)) % 2 == 1
    return odd.reshape(-1)
