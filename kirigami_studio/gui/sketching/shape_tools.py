"""Tools that make a new shape: a stroke, a polygon, a figure or a text in a box."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QFont, QFontMetricsF, QKeyEvent, QPainter, QPainterPath

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import mark
from kirigami_studio.gui.look.theme import Palette
from kirigami_studio.gui.scene.target_items import paint_proposal, paint_size, paint_sketch
from kirigami_studio.gui.scene.view_transform import ViewTransform
from kirigami_studio.gui.sketching.sketch_context import (
    FREEHAND,
    POLYGON,
    TEXT,
    Place,
    PointerEvent,
    SketchContext,
    SketchTool,
    distance,
)
from kirigami_studio.outlines.figures import Box, Figure, placed_figure
from kirigami_studio.outlines.lettering import lettered
from kirigami_studio.outlines.mirroring import Mirror
from kirigami_studio.outlines.placed import Placed

#: A click this near (pixels) to the first corner closes the polygon.
CLOSING_REACH = 10.0
#: Freehand points nearer than this (pixels) to the last one are dropped: hands and mice jitter.
SMALLEST_STEP = 2.0
#: A mirrored stroke ends this near to its start, as a share of its last piece.
CLOSING_SHARE = 0.01
#: A box smaller than this (pixels) was a click, not a drag.
LEAST_DRAG = 4.0
#: Size in which letters are outlined, pixels: flattened curves are then exact to a thousandth.
LETTER_SIZE = 400
#: No mirror.
PLAIN = Mirror()


class Freehand(SketchTool):
    """One stroke; it is smoothed and closes itself."""

    hint = mark("Draw the silhouette in one stroke; it closes when you release.")

    def __init__(self, context: SketchContext) -> None:
        super().__init__(context)
        self._pointers: list[PointerEvent] = []

    def press(self, pointer: PointerEvent) -> None:
        self._pointers = [pointer]

    def move(self, pointer: PointerEvent, held: bool) -> None:
        if held and self._pointers and distance(pointer.pixel, self._pointers[-1].pixel) >= SMALLEST_STEP:
            self._pointers.append(pointer)

    def release(self, pointer: PointerEvent) -> None:
        points, mirror = np.array([pointer.free for pointer in self._pointers]), self.context.mirror
        self.drop()
        if len(points) > 1:
            self.context.draw(lambda: stroke_of(points, mirror), FREEHAND)

    @property
    def busy(self) -> bool:
        return bool(self._pointers)

    def drop(self) -> None:
        self._pointers = []

    def paint(self, painter: QPainter, transform: ViewTransform, palette: Palette) -> None:
        if self._pointers:
            points = transform.to_pixels(np.array([pointer.free for pointer in self._pointers]))
            paint_sketch(painter, points, palette, corners=False)
            _paint_images(painter, transform, palette, self.context, [pointer.free for pointer in self._pointers])


def stroke_of(points: FloatArray, mirror: Mirror = PLAIN) -> Placed:
    """Smooth a stroke (P, 2), mm, from axis to axis together with its images.

    SciPy is loaded at the first one, not when the window opens.
    """
    from kirigami_studio.outlines.refining import stroked

    whole = mirror.completed(points)
    if whole is None:
        return stroked(points)
    closing = whole[:1] + CLOSING_SHARE * (whole[-1:] - whole[:1])  # almost closed: a gap too small to be reported
    return mirror.evened(stroked(np.concatenate([whole, closing])))


class Corners(SketchTool):
    """A polygon, click by click."""

    hint = mark("Click corners; close with Enter or a click on the first one. Backspace removes the last.")

    def __init__(self, context: SketchContext) -> None:
        super().__init__(context)
        self._pointers: list[PointerEvent] = []
        self._pointer: PointerEvent | None = None

    def press(self, pointer: PointerEvent) -> None:
        if len(self._pointers) >= 3 and distance(pointer.pixel, self._pointers[0].pixel) <= CLOSING_REACH:
            self._finish()
        elif not self._pointers or pointer.place != self._pointers[-1].place:
            self._pointers.append(pointer)

    def move(self, pointer: PointerEvent, held: bool) -> None:
        self._pointer = pointer

    def double_click(self, pointer: PointerEvent) -> None:
        self._finish()

    def key(self, event: QKeyEvent) -> bool:
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self._finish()
        elif event.key() == Qt.Key.Key_Backspace and self._pointers:
            self._pointers.pop()
        else:
            return False
        return True

    @property
    def busy(self) -> bool:
        return bool(self._pointers)

    def drop(self) -> None:
        self._pointers = []

    def _finish(self) -> None:
        corners = np.array([pointer.place for pointer in self._pointers])
        whole = self.context.mirror.completed(corners) if len(corners) else None
        ring = corners if whole is None else whole
        self.drop()
        if len(corners):
            self.context.draw(lambda: Placed.from_ring(ring, POLYGON), POLYGON)

    def paint(self, painter: QPainter, transform: ViewTransform, palette: Palette) -> None:
        if not self._pointers:
            return
        places = [pointer.place for pointer in self._pointers]
        if self._pointer is not None:
            places.append(self._pointer.place)
        paint_sketch(painter, transform.to_pixels(np.array(places)), palette, corners=True)
        _paint_images(painter, transform, palette, self.context, places)


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

    @property
    def busy(self) -> bool:
        return self._start is not None

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
        self.hint = mark("Drag a box for the shape. Shift keeps it regular, Ctrl ignores the grid.")

    @property
    def name(self) -> str:
        return self._kind.value

    def shape(self, box: Box) -> Placed:
        return placed_figure(self._kind, box, self.context.corners, self.context.waist)


class TextTool(BoxTool):
    """A word whose letters hang together."""

    hint = mark("Type the text above, then drag a box for it. Letters are moved together into one piece.")

    @property
    def name(self) -> str:
        return TEXT

    def shape(self, box: Box) -> Placed:
        text = self.context.text.strip()
        context = self.context
        ring, notes = lettered(letters(text, context.family, context.bold, context.italic), box)
        return Placed.from_ring(ring, text or TEXT, notes)


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


def _paint_images(
    painter: QPainter, transform: ViewTransform, palette: Palette, context: SketchContext, places: list[Place]
) -> None:
    """Draw what the mirror makes of an unfinished line."""
    for image in context.mirror.all_images(np.array(places)):
        paint_sketch(painter, transform.to_pixels(image), palette, corners=False)
