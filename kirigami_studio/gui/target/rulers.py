"""Rulers at two edges of the drawing board, and the guides that are pulled out of them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QColor, QPainter, QPen

from kirigami_studio.foundation.words import ShownUnit, number, tr
from kirigami_studio.gui.target.sketch_context import SketchContext
from kirigami_studio.gui.widgets.paths import ink
from kirigami_studio.gui.widgets.readable import round_step
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.widgets.view_transform import ViewTransform

#: Width of a ruler, pixels.
RULER = 18.0
#: A guide is taken within this distance, pixels.
REACH = 5.0
#: Numbers on a ruler are at least this far apart, pixels.
NUMBER_STEP = 56.0
#: Lengths of ticks without and with a number, pixels.
TICK, LONG_TICK = 4.0, 9.0
#: Axes: an upright guide has an x, a level one a y.
X, Y = 0, 1


@dataclass(frozen=True, slots=True)
class Held:
    """A guide that is being dragged."""

    axis: int
    at: float  #: mm; where it lies
    new: bool  #: whether it comes out of a ruler
    #: How often guides had been laid on the board when it was taken; more often, an undo changed them meanwhile.
    shown: int


class Rulers:
    """Pulls guides out of the rulers, moves them, and puts them back; whose board it is keeps them."""

    def __init__(self, context: SketchContext) -> None:
        self._context = context
        self._held: Held | None = None

    @property
    def busy(self) -> bool:
        """Whether a guide is being dragged."""
        return self._held is not None

    def over(self, pixel: QPointF) -> int | None:
        """The axis of the guides that the ruler under a pixel gives; None beside the rulers."""
        if 0.0 <= pixel.y() < RULER:
            return Y
        return X if 0.0 <= pixel.x() < RULER else None

    def press(self, pixel: QPointF, *, takes: bool) -> bool:
        """Begin to drag a guide out of a ruler, or the one that is there if it ``takes`` guides; whether one is."""
        axis, place = self.over(pixel), self._context.transform.to_world(pixel)
        if axis is not None:
            self._held = Held(axis, place[axis], new=True, shown=self._context.guides_shown)
            return True
        for way in (X, Y) if takes else ():
            near = [at for at in self._context.guides[way] if self._far(at, place[way]) <= REACH]
            if near:
                self._put(way, [at for at in self._context.guides[way] if at != near[0]])
                self._held = Held(way, near[0], new=False, shown=self._context.guides_shown)
                return True
        return False

    def move(self, pixel: QPointF, *, free: bool) -> bool:
        """Move the guide that is held, on the grid unless ``free``; whether one is."""
        if self._held is None:
            return False
        at = self._context.transform.to_world(pixel)[self._held.axis]
        snaps = self._context.snapping and not free
        self._held = replace(self._held, at=self._context.snapped(at) if snaps else at)
        return True

    def release(self, pixel: QPointF) -> bool:
        """Leave the guide there, or put it away over a ruler; whether one was held."""
        held, self._held = self._held, None
        if held is None:
            return False
        if self._context.guides_shown != held.shown:  # undone meanwhile: what is there now is what was wanted
            return True
        stays = pixel.x() >= RULER and pixel.y() >= RULER
        if stays:
            self._put(held.axis, [*self._context.guides[held.axis], held.at])
        if stays or not held.new:
            gesture = tr("Add guide") if held.new else tr("Move guide") if stays else tr("Remove guide")
            self._context.guides_changed.emit(gesture)
        return True

    def _far(self, one: float, other: float) -> float:
        return abs(one - other) * self._context.transform.scale

    def _put(self, axis: int, places: list[float]) -> None:
        upright, level = self._context.guides
        kept = tuple(sorted(set(places)))
        self._context.guides = (kept, level) if axis == X else (upright, kept)

    def paint(self, painter: QPainter, transform: ViewTransform, area: QRectF, palette: Palette) -> None:
        """Draw guides, and the rulers on top."""
        held = self._held if self._held is not None and self._held.shown == self._context.guides_shown else None
        painter.setPen(QPen(QColor(palette.accent), 1.0))
        for axis in (X, Y):
            places = [*self._context.guides[axis], *((held.at,) if held is not None and held.axis == axis else ())]
            for at in places:
                pixel = _pixel(transform, axis, at)
                if axis == X:
                    painter.drawLine(QPointF(pixel, area.top()), QPointF(pixel, area.bottom()))
                else:
                    painter.drawLine(QPointF(area.left(), pixel), QPointF(area.right(), pixel))
        for axis in (X, Y):
            self._paint_ruler(painter, transform, area, palette, axis)

    def _paint_ruler(
        self, painter: QPainter, transform: ViewTransform, area: QRectF, palette: Palette, axis: int
    ) -> None:
        length = area.width() if axis == X else area.height()
        strip = QRectF(0.0, 0.0, length, RULER) if axis == X else QRectF(0.0, RULER, RULER, length - RULER)
        ink(painter, None, fill=palette.surface)
        painter.drawRect(strip)
        font = painter.font()
        small = painter.font()
        small.setPointSizeF(0.75 * font.pointSizeF())
        painter.setFont(small)
        painter.setPen(QPen(QColor(palette.muted), 1.0))
        step = round_step(NUMBER_STEP / transform.scale, ShownUnit.mm())
        ends = sorted(transform.to_world(QPointF(*spot))[axis] for spot in ((0.0, 0.0), (area.width(), area.height())))
        for tick in range(math.floor(5 * ends[0] / step), math.ceil(5 * ends[1] / step) + 1):
            at, numbered = tick * step / 5, tick % 5 == 0
            pixel, reach = _pixel(transform, axis, at), LONG_TICK if numbered else TICK
            if pixel < RULER:
                continue
            if axis == X:
                painter.drawLine(QPointF(pixel, RULER - reach), QPointF(pixel, RULER))
            else:
                painter.drawLine(QPointF(RULER - reach, pixel), QPointF(RULER, pixel))
            written = number(at / ShownUnit.mm() + 0.0, ".6g")
            if numbered and fits(axis, pixel, painter.fontMetrics().horizontalAdvance(written), length):
                painter.save()
                painter.translate(*((pixel + 3, 11.0) if axis == X else (11.0, pixel - 3)))
                painter.rotate(0.0 if axis == X else -90.0)
                painter.drawText(QPointF(0.0, 0.0), written)
                painter.restore()
        painter.setFont(font)


def fits(axis: int, pixel: float, room: int, length: float) -> bool:
    """Whether a number beside a tick, ``room`` pixels long, lies whole on the ruler."""
    return pixel + 3 + room <= length if axis == X else pixel - 3 - room >= RULER and pixel <= length


def _pixel(transform: ViewTransform, axis: int, at: float) -> float:
    return transform.origin[axis] + (transform.scale if axis == X else -transform.scale) * at
