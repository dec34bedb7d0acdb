"""Drawing in one stroke, and corner by corner."""

from __future__ import annotations

import math

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QKeyEvent, QPainter

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.look.theme import Palette
from kirigami_studio.gui.scene.frame import Frame
from kirigami_studio.gui.scene.target_items import paint_sketch
from kirigami_studio.gui.sketching.easel import FREEHAND, Easel, Place, SketchTool, Spot
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

    def __init__(self, easel: Easel) -> None:
        super().__init__(easel)
        self._spots: list[Spot] = []

    def press(self, spot: Spot) -> None:
        self._spots = [spot]

    def move(self, spot: Spot, held: bool) -> None:
        if held and self._spots and distance(spot.pixel, self._spots[-1].pixel) >= SMALLEST_STEP:
            self._spots.append(spot)

    def release(self, spot: Spot) -> None:
        points, mirror = np.array([spot.free for spot in self._spots]), self.easel.mirror
        self.drop()
        if len(points) > 1:
            self.easel.draw(lambda: stroke_of(points, mirror), FREEHAND)

    def drop(self) -> None:
        self._spots = []

    def paint(self, painter: QPainter, frame: Frame, palette: Palette) -> None:
        if self._spots:
            points = frame.to_pixels(np.array([spot.free for spot in self._spots]))
            paint_sketch(painter, points, palette, corners=False)
            _paint_images(painter, frame, palette, self.easel, [spot.free for spot in self._spots])


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

    def __init__(self, easel: Easel) -> None:
        super().__init__(easel)
        self._spots: list[Spot] = []
        self._pointer: Spot | None = None

    def press(self, spot: Spot) -> None:
        if len(self._spots) >= 3 and distance(spot.pixel, self._spots[0].pixel) <= CLOSING_REACH:
            self._finish()
        elif not self._spots or spot.place != self._spots[-1].place:
            self._spots.append(spot)

    def move(self, spot: Spot, held: bool) -> None:
        self._pointer = spot

    def double_click(self, spot: Spot) -> None:
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
        corners = np.array([spot.place for spot in self._spots])
        whole = self.easel.mirror.completed(corners) if len(corners) else None
        ring = corners if whole is None else whole
        self.drop()
        if len(corners):
            self.easel.draw(lambda: Placed.from_ring(ring, "polygon"), "polygon")

    def paint(self, painter: QPainter, frame: Frame, palette: Palette) -> None:
        if not self._spots:
            return
        places = [spot.place for spot in self._spots]
        if self._pointer is not None:
            places.append(self._pointer.place)
        paint_sketch(painter, frame.to_pixels(np.array(places)), palette, corners=True)
        _paint_images(painter, frame, palette, self.easel, places)


def _paint_images(painter: QPainter, frame: Frame, palette: Palette, easel: Easel, places: list[Place]) -> None:
    """Draw what the mirror makes of an unfinished line."""
    for image in easel.mirror.all_images(np.array(places)):
        paint_sketch(painter, frame.to_pixels(image), palette, corners=False)


def distance(one: QPointF, other: QPointF) -> float:
    """Pixels between two positions."""
    return math.hypot(one.x() - other.x(), one.y() - other.y())
