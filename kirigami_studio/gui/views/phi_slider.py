"""A slider over the deployment angle with marks at the compact sheet, the target and the first contact."""

from __future__ import annotations

import math

from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPainterPath, QPaintEvent, QPen
from PySide6.QtWidgets import QSlider, QWidget

from kirigami_studio.gui.theme import LIGHT, Palette

#: Slider steps per degree.
RESOLUTION = 10
LAST = 180 * RESOLUTION
SIDE = 14.0
HANDLE = 8.0
#: Narrower than this (pixels) the marks carry numbers only.
ROOM_FOR_WORDS = 230


class PhiSlider(QSlider):
    """From pi (compact, left) to 0 (second compact state, right); its value counts tenths of a degree of opening."""

    phi_changed = Signal(float)  #: radians

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(Qt.Orientation.Horizontal, parent)
        self.palette_: Palette = LIGHT
        self._target = 0.0
        self._contact: float | None = None
        self.setRange(0, LAST)
        self.setSingleStep(RESOLUTION)
        self.setPageStep(10 * RESOLUTION)
        self.setMinimumHeight(44)
        self.setObjectName("phiSlider")
        self.setAccessibleName("Deployment angle")
        self.setToolTip("Deployment angle in degrees: 180° is the flat sheet as cut, 0° fully turned (arrow keys: 1°)")
        self.valueChanged.connect(lambda value: self.phi_changed.emit(self.phi))

    @property
    def phi(self) -> float:
        """The angle, radians."""
        return math.pi * (LAST - self.value()) / LAST

    def set_phi(self, phi: float) -> None:
        """Move to an angle, radians."""
        self.setValue(round(LAST * (1.0 - phi / math.pi)))

    def set_marks(self, target: float, contact: float | None) -> None:
        """Mark the target angle and the first contact, radians."""
        self._target, self._contact = target, contact
        self.update()

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self.palette_ = palette
        self.update()

    def sizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return QSize(320, 44)

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        if event.button() is Qt.MouseButton.LeftButton:
            self.setSliderDown(True)
            self.setFocus()
            self._go(event.position().x())
            event.accept()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        if self.isSliderDown():
            self._go(event.position().x())

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        self.setSliderDown(False)

    def _go(self, x: float) -> None:
        self.setValue(round(LAST * (x - SIDE) / max(self.width() - 2 * SIDE, 1.0)))

    def _x(self, phi: float) -> float:
        return SIDE + (self.width() - 2 * SIDE) * (1.0 - phi / math.pi)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        middle = 15.0
        self._paint_track(painter, middle)
        self._paint_marks(painter, middle)
        x = self._x(self.phi)
        if self.hasFocus():
            halo = QColor(self.palette_.accent)
            halo.setAlpha(60)
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(halo)
            painter.drawEllipse(QPointF(x, middle), HANDLE + 4, HANDLE + 4)
        painter.setPen(QPen(QColor(self.palette_.surface), 2.0))
        painter.setBrush(QColor(self.palette_.accent if self.isEnabled() else self.palette_.disabled))
        painter.drawEllipse(QPointF(x, middle), HANDLE, HANDLE)
        painter.end()

    def _paint_track(self, painter: QPainter, middle: float) -> None:
        left, right = self._x(math.pi), self._x(0.0)
        spans = [(left, right, self.palette_.strong_border)]
        if self.isEnabled():
            spans.append((left, self._x(self.phi), self.palette_.accent))
            if self._contact is not None:
                spans.append((self._x(self._contact), right, self.palette_.fault))
        painter.setPen(Qt.PenStyle.NoPen)
        for start, end, colour in spans:
            painter.setBrush(QColor(colour))
            painter.drawRoundedRect(QRectF(start, middle - 2.5, max(end - start, 0.0), 5.0), 2.5, 2.5)

    def _paint_marks(self, painter: QPainter, middle: float) -> None:
        centre, right = Qt.AlignmentFlag.AlignHCenter, Qt.AlignmentFlag.AlignRight
        roomy = self.width() >= ROOM_FOR_WORDS
        marks = [(math.pi, "180° flat" if roomy else "180°", Qt.AlignmentFlag.AlignLeft, self.palette_.muted)]
        near_end = self._target < 0.25
        label = f"{math.degrees(self._target):.0f}°{' target' if roomy else ''}"
        marks.append((self._target, label, right if near_end else centre, self.palette_.target))
        if self._target > 0.8:
            marks.append((0.0, "0°", right, self.palette_.muted))
        for phi, text, side, colour in marks:
            x = self._x(phi)
            box = QRectF(x - 60, middle + 12, 120, 18)
            if side is Qt.AlignmentFlag.AlignLeft:
                box.moveLeft(x - HANDLE)
            elif side is right:
                box.moveRight(x + HANDLE)
            painter.setPen(QColor(self.palette_.muted if colour == self.palette_.muted else self.palette_.text))
            painter.drawText(box, int(side | Qt.AlignmentFlag.AlignVCenter), text)
        tip = QPointF(self._x(self._target), middle + 4)
        triangle = QPainterPath(tip)
        triangle.lineTo(tip + QPointF(-5, 8))
        triangle.lineTo(tip + QPointF(5, 8))
        triangle.closeSubpath()
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(self.palette_.target))
        painter.drawPath(triangle)
