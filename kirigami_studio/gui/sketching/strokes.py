"""Drawing in one stroke, and corner by corner."""

from __future__ import annotations

import math

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QKeyEvent, QPainter

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.look.theme import Palette
from kirigami_studio.gui.scene.target_items import paint_sketch
from kirigami_studio.gui.scene.view_transform import ViewTransform
from kirigami_studio.gui.sketching.sketch_context import FREEHAND, Place, PointerEvent, SketchContext, SketchTool
from kirigami_studio.outlines.mirroring import Mirror
from kirigami_studio.outlines.placed import Placed

#: A click this near (pixels) to the first corner closes the polygon.
CLOSING_REACH = 10.0
#: Freehand points nearer than this (pixels) to the last one are dropped: hands and mice jitter.
SMALLEST_STEP = 2.0
#: A mirrored stroke ends this near to its start, as a share of its last piece.
CLOSING_SHARE = 0.01
#: No mirror.
PLAIN = Mirror()


class Freehand(SketchTool):
    """One stroke; it is smoothed and closes itself."""

    hint = tr("Draw the silhouette in one stroke; it closes itself when you let go.")

    def __init__(self, context: SketchContext) -> None:
        super().__init__(context)
        self._spots: list[PointerEvent] = []

    def press(self, pointer: PointerEvent) -> None:
        self._spots = [pointer]

    def move(self, pointer: PointerEvent, held: bool) -> None:
        if held and self._spots and distance(pointer.pixel, self._spots[-1].pixel) >= SMALLEST_STEP:
            self._spots.append(pointer)

    def release(self, pointer: PointerEvent) -> None:
        points, mirror = np.array([pointer.free for pointer in self._spots]), self.context.mirror
        self.drop()
        if len(points) > 1:
            self.context.draw(lambda: stroke_of(points, mirror), FREEHAND)

    def drop(self) -> None:
        self._spots = []

    def paint(self, painter: QPainter, transform: ViewTransform, palette: Palette) -> None:
        if self._spots:
            points = transform.to_pixels(np.array([pointer.free for pointer in self._spots]))
            paint_sketch(painter, points, palette, corners=False)
            _paint_images(painter, transform, palette, self.context, [pointer.free for pointer in self._spots])


def stroke_of(points: np.ndarray[tuple[int, ...], np.dtype[np.float64]], mirror: Mirror = PLAIN) -> Placed:
    """Smooth a stroke (P, 2), mm, from axis to axis together with its images.

    SciPy is loaded at the first one, not when the window opens.
    """
    from kirigami_studio.outlines.refining import stroked

    whole = mirror.completed(points)
    if whole is None:
        return stroked(points)
    closing = whole[:1] + CLOSING_SHARE * (whole[-1:] - whole[:1])  # almost there: no gap that would be told
    return mirror.evened(stroked(np.concatenate([whole, closing])))


class Corners(SketchTool):
    """A polygon, click by click."""

    hint = tr("Click the corners; close with Enter or a click on the first one. Backspace takes back.")

    def __init__(self, context: SketchContext) -> None:
        super().__init__(context)
        self._spots: list[PointerEvent] = []
        self._pointer: PointerEvent | None = None

    def press(self, pointer: PointerEvent) -> None:
        if len(self._spots) >= 3 and distance(pointer.pixel, self._spots[0].pixel) <= CLOSING_REACH:
            self._finish()
        elif not self._spots or pointer.place != self._spots[-1].place:
            self._spots.append(pointer)

    def move(self, pointer: PointerEvent, held: bool) -> None:
        self._pointer = pointer

    def double_click(self, pointer: PointerEvent) -> None:
        self._finish()

    def key(self, event: QKeyEvent) -> bool:
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self._finish()
        elif event.key() == Qt.Key.Key_Backspace and self._spots:
            self._spots.pop()
        else:
            return False
        return True

    def drop(self) -> None:
        self._spots = []

    def _finish(self) -> None:
        corners = np.array([pointer.place for pointer in self._spots])
        whole = self.context.mirror.completed(corners) if len(corners) else None
        ring = corners if whole is None else whole
        self.drop()
        if len(corners):
            self.context.draw(lambda: Placed.from_ring(ring, "polygon"), "polygon")

    def paint(self, painter: QPainter, transform: ViewTransform, palette: Palette) -> None:
        if not self._spots:
            return
        places = [pointer.place for pointer in self._spots]
        if self._pointer is not None:
            places.append(self._pointer.place)
        paint_sketch(painter, transform.to_pixels(np.array(places)), palette, corners=True)
        _paint_images(painter, transform, palette, self.context, places)


def _paint_images(
    painter: QPainter, transform: ViewTransform, palette: Palette, context: SketchContext, places: list[Place]
) -> None:
    """Draw what the mirror makes of an unfinished line."""
    for image in context.mirror.all_images(np.array(places)):
        paint_sketch(painter, transform.to_pixels(image), palette, corners=False)


def distance(one: QPointF, other: QPointF) -> float:
    """Pixels between two positions."""
    return math.hypot(one.x() - other.x(), one.y() - other.y())
