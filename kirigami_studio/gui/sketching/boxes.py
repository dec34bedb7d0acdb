"""Shapes that fill a dragged box: figures and text."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from PySide6.QtGui import QFont, QFontMetricsF, QPainter, QPainterPath

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.look.theme import Palette
from kirigami_studio.gui.scene.target_items import paint_proposal, paint_size
from kirigami_studio.gui.scene.view_transform import ViewTransform
from kirigami_studio.gui.sketching.sketch_context import PointerEvent, SketchContext, SketchTool
from kirigami_studio.gui.sketching.strokes import distance
from kirigami_studio.outlines.figures import Box, Figure, placed_figure
from kirigami_studio.outlines.lettering import lettered
from kirigami_studio.outlines.placed import Placed

#: A box smaller than this (pixels) was a click, not a drag.
LEAST_DRAG = 4.0
#: Size in which letters are outlined, pixels: flattened curves are then exact to a thousandth.
LETTER_SIZE = 400


class BoxTool(SketchTool, ABC):
    """Drags a box; subclasses say what fills it."""

    def __init__(self, context: SketchContext) -> None:
        super().__init__(context)
        self._start: PointerEvent | None = None
        self._end: PointerEvent | None = None

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

    def press(self, pointer: PointerEvent) -> None:
        self._start = self._end = pointer

    def move(self, pointer: PointerEvent, held: bool) -> None:
        if held and self._start is not None:
            self._end = pointer

    def release(self, pointer: PointerEvent) -> None:
        start = self._start
        self.drop()
        if start is not None and distance(start.pixel, pointer.pixel) >= LEAST_DRAG:
            box = Box.spanned(start.place, pointer.place, pointer.shift)
            self.context.draw(lambda: self.shape(box), self.name)

    def drop(self) -> None:
        self._start = self._end = None

    def paint(self, painter: QPainter, transform: ViewTransform, palette: Palette) -> None:
        if self._start is None or self._end is None:
            return
        box = Box.spanned(self._start.place, self._end.place, self._end.shift)
        try:
            ring = self.shape(box).ring
        except TargetError:  # too flat so far; said when the button is let go
            return
        for part in (*self.context.mirror.all_images(ring), ring):
            paint_proposal(painter, transform.to_pixels(part), palette)
        paint_size(painter, self._end.pixel, box.size, palette)


class FigureTool(BoxTool):
    """A rectangle, ellipse, regular polygon or star."""

    def __init__(self, context: SketchContext, kind: Figure) -> None:
        super().__init__(context)
        self._kind = kind
        self.hint = tr("Drag a box for the {value}. Shift keeps it regular, Ctrl leaves the grid.", value=kind.value)

    @property
    def name(self) -> str:
        return self._kind.value

    def shape(self, box: Box) -> Placed:
        return placed_figure(self._kind, box, self.context.corners, self.context.waist)


class TextTool(BoxTool):
    """A word whose letters hang together."""

    hint = tr("Type the text above, then drag a box for it. Letters are moved together: a sheet is one piece.")

    @property
    def name(self) -> str:
        return "text"

    def shape(self, box: Box) -> Placed:
        text = self.context.text.strip()
        context = self.context
        ring, notes = lettered(letters(text, context.family, context.bold, context.italic), box)
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
