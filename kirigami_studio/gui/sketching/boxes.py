"""Shapes that fill a dragged box: figures and text."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
import numpy.typing as npt
from PySide6.QtGui import QFont, QFontMetricsF, QPainter, QPainterPath

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.look.theme import Palette
from kirigami_studio.gui.scene.frame import Frame
from kirigami_studio.gui.scene.target_items import paint_proposal, paint_size
from kirigami_studio.gui.sketching.easel import Easel, SketchTool, Spot
from kirigami_studio.gui.sketching.strokes import distance
from kirigami_studio.outlines.figure_nodes import placed_figure
from kirigami_studio.outlines.figures import Box, Figure
from kirigami_studio.outlines.lettering import lettered
from kirigami_studio.outlines.placed import Placed

FloatArray = npt.NDArray[np.float64]

#: A box smaller than this (pixels) was a click, not a drag.
LEAST_DRAG = 4.0
#: Size in which letters are outlined, pixels: flattened curves are then exact to a thousandth.
LETTER_SIZE = 400


class BoxTool(SketchTool, ABC):
    """Drags a box; subclasses say what fills it."""

    def __init__(self, easel: Easel) -> None:
        super().__init__(easel)
        self._start: Spot | None = None
        self._end: Spot | None = None

    @abstractmethod
    def shape(self, box: Box) -> Placed:
        """What fills a box.

        Raises
        ------
        TargetError
            Nothing can.
        """

    @property
    @abstractmethod
    def name(self) -> str:
        """Of the shape, for the document and the name of the change."""

    def press(self, spot: Spot) -> None:
        self._start = self._end = spot

    def move(self, spot: Spot, held: bool) -> None:
        if held and self._start is not None:
            self._end = spot

    def release(self, spot: Spot) -> None:
        start = self._start
        self.drop()
        if start is not None and distance(start.pixel, spot.pixel) >= LEAST_DRAG:
            box = Box.spanned(start.place, spot.place, spot.shift)
            self.easel.draw(lambda: self.shape(box), self.name)

    def drop(self) -> None:
        self._start = self._end = None

    def paint(self, painter: QPainter, frame: Frame, palette: Palette) -> None:
        if self._start is None or self._end is None:
            return
        box = Box.spanned(self._start.place, self._end.place, self._end.shift)
        try:
            ring = self.shape(box).ring
        except TargetError:  # too flat so far; said when the button is let go
            return
        for part in (*self.easel.mirror.all_images(ring), ring):
            paint_proposal(painter, frame.to_pixels(part), palette)
        paint_size(painter, self._end.pixel, box.size, palette)


class FigureTool(BoxTool):
    """A rectangle, ellipse, regular polygon or star."""

    def __init__(self, easel: Easel, kind: Figure) -> None:
        super().__init__(easel)
        self._kind = kind
        self.hint = tr("Drag a box for the {value}. Shift keeps it regular, Ctrl leaves the grid.", value=kind.value)

    @property
    def name(self) -> str:
        return self._kind.value

    def shape(self, box: Box) -> Placed:
        return placed_figure(self._kind, box, self.easel.corners, self.easel.waist)


class TextTool(BoxTool):
    """A word whose letters hang together."""

    hint = tr("Type the text above, then drag a box for it. Letters are moved together: a sheet is one piece.")

    @property
    def name(self) -> str:
        return "text"

    def shape(self, box: Box) -> Placed:
        text = self.easel.text.strip()
        easel = self.easel
        ring, notes = lettered(letters(text, easel.family, easel.bold, easel.italic), box)
        return Placed.from_ring(ring, text or "text", notes)


def letters(text: str, family: str = "", bold: bool = True, italic: bool = False) -> list[list[FloatArray]]:
    """Outlines of the letters of a text, each where it stands in the line; without a family in the window's own.

    Returns
    -------
    letters : list of lists of (L, 2) float, pixels, y up
        One list of rings for each character that has an outline.
    """
    font = QFont(family) if family else QFont()
    font.setPixelSize(LETTER_SIZE)
    font.setBold(bold)
    font.setItalic(italic)
    font.setHintingPreference(QFont.HintingPreference.PreferNoHinting)
    metrics = QFontMetricsF(font)
    found = []
    for index, letter in enumerate(text):
        path = QPainterPath()
        path.addText(metrics.horizontalAdvance(text[:index]), 0.0, font, letter)
        rings = [np.array([(point.x(), -point.y()) for point in part.toList()]) for part in path.toSubpathPolygons()]
        if rings:
            found.append(rings)
    return found
