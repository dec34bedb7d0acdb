"""The drawing with its parts, where a click chooses a part or leaves it out, and the outline that is made of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QImage, QMouseEvent, QPainter, QPainterPath, QPaintEvent, QPen, QPixmap
from PySide6.QtWidgets import QSizePolicy, QWidget

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.target.target_view import picture_image
from kirigami_studio.gui.widgets.paths import area_path, blank, ink, line_path, painter_on, round_pen
from kirigami_studio.gui.widgets.theme import LIGHT, Palette
from kirigami_studio.gui.widgets.view_transform import Bounds, ViewTransform
from kirigami_studio.outlines.merging import Merged
from kirigami_studio.studio.parts import PartsRead, Photo, bounds_of, part_at

MARGIN = 16.0
#: Pixels around a line within which a click means it; from which on a drag is a stroke; radius of a place.
REACH, LEAST_STROKE, DOT = 8.0, 5.0, 3.5


class PartView(QWidget):
    """Draws chosen parts filled, the others pale, the result in the target's colour."""

    clicked = Signal(int)  #: number of a part
    #: places of a click or a stroke on a picture, pixels from its upper left corner, and whether the object is there
    stroked = Signal(tuple, bool)
    pointed = Signal(int)  #: number of the part under the pointer, 0 for none

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("partView")
        self.setAccessibleName(tr("Drawing with its parts"))
        self.setMouseTracking(True)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.palette_: Palette = LIGHT
        self._read: PartsRead | None = None
        self._chosen: frozenset[int] = frozenset()
        self._current = 0
        self._stroke = 0.0
        self._result: Merged | None = None
        self._stale = False
        self._photo: QImage | None = None
        self._stroke_places: list[QPointF] = []
        self._takes = True  # whether the stroke that is being drawn is on the object

    def sizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return QSize(520, 380)

    def minimumSizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return QSize(240, 160)

    def set_palette(self, palette: Palette) -> None:
        self.palette_ = palette
        self.update()

    def show_drawing(self, read: PartsRead) -> None:
        """Show another drawing."""
        photo, before = read.photo, self._read.photo if self._read is not None else None
        if photo is None:
            self._photo = None
        elif before is None or before.seen is not photo.seen:
            self._photo = picture_image(photo.seen)
        self._read, self._result, self._current = read, None, 0
        self.update()

    def show_choice(self, chosen: frozenset[int], stroke: float) -> None:
        """Mark the chosen parts; ``stroke`` is the width of lines without one, source units, 0 for thin lines."""
        self._chosen, self._stroke, self._stale = chosen, stroke, True
        self.update()

    def show_result(self, result: Merged | None) -> None:
        """Show what the chosen parts become."""
        self._result, self._stale = result, False
        self.update()

    def mark(self, number: int) -> None:
        """Bring one part forward, 0 for none."""
        if number != self._current:
            self._current = number
            self.update()

    @property
    def transform(self) -> ViewTransform:
        """From the source to pixels; the result is inside, too."""
        left, bottom, right, top = bounds_of(self._read) if self._read is not None else (0.0, 0.0, 1.0, 1.0)
        if self._result is not None:
            for piece in self._result.all:
                one, two, three, four = piece.shape.bounds
                left, bottom, right, top = min(left, one), min(bottom, two), max(right, three), max(top, four)
        return ViewTransform.fitting(Bounds(left, bottom, right, top), QRectF(self.rect()), MARGIN)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        painter = painter_on(self)
        ink(painter, self.palette_.border, fill=self.palette_.canvas)
        painter.drawRoundedRect(QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5), 8.0, 8.0)
        if self._read is None:
            return
        transform = self.transform
        if self._photo is not None and self._read.photo is not None:
            corners = transform.to_pixels(np.array([[0.0, self._read.photo.size[1]], [self._read.photo.size[0], 0.0]]))
            painter.drawImage(QRectF(QPointF(*corners[0].tolist()), QPointF(*corners[1].tolist())), self._photo)
        for chosen in (False, True):
            for part, sketch in zip(self._read.source.parts, self._read.sketches, strict=True):
                # On a picture the colours that nobody wants would hide it.
                is_shown = self._photo is None or chosen or not part.is_aside or part.number == self._current
                if is_shown and (part.number in self._chosen) is chosen:
                    path = part_path(sketch, transform, part.is_closed)
                    width = (part.pen.width or self._stroke) * transform.scale if self._stroke else 0.0
                    current = part.number == self._current
                    paint_part(
                        painter,
                        path,
                        self.palette_,
                        closed=part.is_closed and (self._photo is None or chosen),
                        chosen=chosen,
                        current=current,
                        pen=width,
                    )
        if self._result is not None and self._chosen:
            bridges = [area_path(bridge, transform) for bridge in self._result.bridges]
            for piece in self._result.all:
                shape = area_path(piece.shape, transform)
                paint_result(painter, shape, bridges, self.palette_, stale=self._stale)
        if self._read.photo is not None:
            self._paint_strokes(painter, self._read.photo)

    def _paint_strokes(self, painter: QPainter, photo: Photo) -> None:
        """The places where the object was taken, those beside it, and the stroke that is being drawn."""
        for places, colour in ((photo.strokes.taken, self.palette_.accent), (photo.strokes.left, self.palette_.bad)):
            for x, y in places:
                centre = self.transform.to_pixels(np.array([x, photo.size[1] - y])).tolist()
                painter.setPen(QPen(QColor(self.palette_.canvas), 1.5))
                painter.setBrush(QColor(colour))
                painter.drawEllipse(QPointF(*centre), DOT, DOT)
        if len(self._stroke_places) > 1:
            colour = self.palette_.accent if self._takes else self.palette_.bad
            painter.setPen(QPen(QColor(colour), 2.0 * DOT, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
            painter.drawPolyline(self._stroke_places)

    def _part_below(self, place: QPointF) -> int:
        if self._read is None:
            return 0
        transform = self.transform
        return part_at(self._read, transform.to_world(place), REACH / transform.scale)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        if self._stroke_places:
            self._stroke_places.append(event.position())
            self.update()
            return
        number = self._part_below(event.position())
        other = Qt.CursorShape.ArrowCursor if self._photo is None else Qt.CursorShape.CrossCursor
        self.setCursor(Qt.CursorShape.PointingHandCursor if number else other)
        self.pointed.emit(number)

    def leaveEvent(self, event: QEvent) -> None:  # noqa: N802 - Qt's name
        self.pointed.emit(0)

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        number = self._part_below(event.position())
        if self._photo is not None and event.button() in (Qt.MouseButton.LeftButton, Qt.MouseButton.RightButton):
            self._takes = event.button() == Qt.MouseButton.LeftButton
            self._stroke_places = [event.position()]
        elif event.button() == Qt.MouseButton.LeftButton and number:
            self.clicked.emit(number)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        """Take the object of a picture that was clicked on, or a part of it that is not chosen yet."""
        places, self._stroke_places = self._stroke_places, []
        if not places or self._read is None or self._read.photo is None:
            return
        number = self._part_below(places[0])
        is_click = all((place - places[0]).manhattanLength() < LEAST_STROKE for place in places)
        if is_click and number and self._takes and number not in self._chosen:
            self.clicked.emit(number)
        else:
            self.stroked.emit(self._on_photo(places[:1] if is_click else places, self._read.photo), self._takes)
        self.update()

    def _on_photo(self, places: Sequence[QPointF], photo: Photo) -> tuple[tuple[float, float], ...]:
        """Places of the window as pixels of a picture, inside it."""
        width, height = photo.size
        world = [self.transform.to_world(place) for place in places]
        return tuple((min(max(x, 0.0), width), min(max(height - y, 0.0), height)) for x, y in world)


def part_path(sketch: Sequence[FloatArray], transform: ViewTransform, closed: bool) -> QPainterPath:
    """The rings of a part with its holes, or its lines, pixels."""
    path = QPainterPath()
    path.setFillRule(Qt.FillRule.OddEvenFill)
    for line in sketch:
        path.addPath(line_path(transform.to_pixels(line), closed=closed))
    return path


def paint_part(
    painter: QPainter, path: QPainterPath, palette: Palette, *, closed: bool, chosen: bool, current: bool, pen: float
) -> None:
    """Draw one part; ``pen`` is the width of its lines in pixels, where they are taken as painted."""
    line = QColor(palette.panel_line if chosen else palette.strong_border)
    fill = QColor(palette.panel_odd)
    if pen > 1.0 and not closed:
        wide = QPen(fill if chosen else QColor(palette.grid), pen, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap)
        wide.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
        painter.strokePath(path, wide)
    if closed:
        fill.setAlpha(150)
        painter.fillPath(path, fill if chosen else QColor(palette.grid))
    painter.strokePath(path, round_pen(palette.accent if current else line.name(), 2.5 if current else 1.2))


def paint_result(
    painter: QPainter, outline: QPainterPath, bridges: Sequence[QPainterPath], palette: Palette, *, stale: bool
) -> None:
    """Draw the outline that is made of the parts, paler while a newer one is being made."""
    painter.save()
    painter.setOpacity(0.35 if stale else 1.0)
    for bridge in bridges:
        painter.fillPath(bridge, QColor(palette.target_fill))
    fill = QColor(palette.target_fill)
    fill.setAlpha(70)
    painter.fillPath(outline, fill)
    painter.strokePath(outline, round_pen(palette.target, 2.4))
    painter.restore()


def part_pixmap(sketch: Sequence[FloatArray], closed: bool, size: QSize, ratio: float, palette: Palette) -> QPixmap:
    """A part's picture for lists, as large as it goes into ``size``, logical pixels."""
    pixmap = blank(size, ratio)
    painter = painter_on(pixmap)
    box = QRectF(0, 0, size.width(), size.height())
    low = [min(float(line[:, axis].min()) for line in sketch) for axis in (0, 1)]
    high = [max(float(line[:, axis].max()) for line in sketch) for axis in (0, 1)]
    transform = ViewTransform.fitting(Bounds(low[0], low[1], high[0], high[1]), box, 4.0)
    path = part_path(sketch, transform, closed)
    if closed:
        painter.fillPath(path, QColor(palette.panel_odd))
    painter.strokePath(path, round_pen(palette.panel_line if closed else palette.text, 1.4))
    painter.end()
    return pixmap
