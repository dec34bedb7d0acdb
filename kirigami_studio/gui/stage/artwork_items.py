"""Paint artwork on the moving panels: every panel is filled with its part of the printed flat sheet, turned with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QBrush, QImage, QPainter, QTransform

from kirigami_studio.export.artwork import Artwork
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.gui.widgets.paths import line_path
from kirigami_studio.gui.widgets.view_transform import ViewTransform

if TYPE_CHECKING:
    from kirigami_studio.export.artwork_patches import PrintedSheet


@dataclass(frozen=True, slots=True, eq=False)
class ShownArtwork:
    """The printed flat sheet of one design.

    Attributes
    ----------
    artwork : Artwork
    sheet : PrintedSheet
    image : QImage
        Nothing where nothing is printed.
    corner : complex, mm
        Where its upper left corner lies on the flat sheet; y up.
    dots_per_mm : float
    """

    artwork: Artwork
    sheet: PrintedSheet
    image: QImage
    corner: complex
    dots_per_mm: float


def paint_artwork(
    painter: QPainter,
    shown: ShownArtwork,
    phi: float,
    panels: FloatArray,
    trimmed: Mapping[int, FloatArray],
    transform: ViewTransform,
) -> None:
    """Fill all panels with artwork.

    Parameters
    ----------
    painter : QPainter
    shown : ShownArtwork
        The printed flat sheet of the design that is drawn.
    phi : float, radians
    panels : (K, 4, 2) float, pixels
    trimmed : mapping of row to (P, 2) float, pixels
        What trimming has left of panels, drawn instead of them.
    transform : ViewTransform
    """
    motion = shown.sheet.motion(phi)
    # Pixels count downwards, in the view and in the artwork: between them lie the conjugates.
    turn = transform.scale * np.conj(motion.factor)
    factor = turn / shown.dots_per_mm
    shift = turn * np.conj(shown.corner) + transform.scale * np.conj(motion.shift) + complex(*transform.origin)
    painter.save()
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
    brush = QBrush(shown.image)
    for row, (a, b) in enumerate(zip(factor.tolist(), shift.tolist(), strict=True)):
        ring = trimmed.get(row, panels[row])
        if len(ring):
            brush.setTransform(QTransform(a.real, a.imag, -a.imag, a.real, b.real, b.imag))
            painter.fillPath(line_path(ring, closed=True), brush)
    painter.restore()
