"""A slider over the deployment angle with marks at the compact sheet, the target and the first contact."""

from __future__ import annotations

import math

from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QSlider, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.look.theme import LIGHT, Palette
from kirigami_studio.gui.scene.track_items import MarkKind, Stretch, WayMark, paint_mark, paint_stretch, stretches

#: Slider steps per degree.
RESOLUTION = 10
LAST = 180 * RESOLUTION
SIDE = 14.0
HANDLE = 8.0
#: Height (pixels) of the track's middle; marks begin ``BELOW`` it.
MIDDLE, BELOW = 15.0, 9.0
#: Narrower than this (pixels) the marks carry numbers only.
ROOM_FOR_WORDS = 230
#: Labels nearer to each other than this (pixels) leave one of them out.
LABEL_GAP = 6.0


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
        self.setMouseTracking(True)
        self.setObjectName("phiSlider")
        self.setAccessibleName(tr("Deployment angle"))
        self._say_legend()
        self.valueChanged.connect(lambda value: self.phi_changed.emit(self.phi))
        self.valueChanged.connect(lambda _: self._tell_value())
        self._tell_value()

    @property
    def phi(self) -> float:
        """The angle, radians; that of a mark exactly, where the slider stands on one."""
        for mark in self.marks():
            if value_at(mark.phi) == self.value():
                return mark.phi
        return math.pi * (LAST - self.value()) / LAST

    def set_phi(self, phi: float) -> None:
        """Move to an angle, radians."""
        self.setValue(value_at(phi))

    def set_marks(self, target: float, contact: float | None) -> None:
        """Mark the target angle and the first contact, radians."""
        self._target, self._contact = target, contact
        self._say_legend()
        self.update()

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self.palette_ = palette
        self.update()

    def marks(self) -> tuple[WayMark, ...]:
        """All marks, the most important first."""
        degrees = f"{math.degrees(self._target):.0f}°"
        marks = [WayMark(MarkKind.TARGET, self._target, tr("{angle} target", angle=degrees), degrees)]
        if self._contact is not None:
            degrees = f"{math.degrees(self._contact):.0f}°"
            marks.append(WayMark(MarkKind.CONTACT, self._contact, tr("{angle} contact", angle=degrees), degrees))
        marks.append(WayMark(MarkKind.FLAT, math.pi, tr("180° flat"), "180°"))
        marks.append(WayMark(MarkKind.TURNED, 0.0, "0°", "0°"))
        return tuple(marks[:-1] if self._target == 0.0 else marks)

    def _say_legend(self) -> None:
        lines = [
            tr("Deployment angle in degrees: 180° is the flat sheet as cut, 0° fully turned."),
            tr("Plain bar: free. Thick yellow stripes: the sheet touches itself. Thin orange dashes: past the target."),
        ]
        if self._contact is not None:
            lines.append(tr("First contact at {angle:.1f}°.", angle=math.degrees(self._contact)))
        lines.append(tr("Click a mark to go there. Arrow keys: 1°, Page keys: 10°, Home and End: the ends."))
        self.setToolTip("\n".join(lines))

    def sizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return QSize(320, 44)

    # mouse ---------------------------------------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        if event.button() is not Qt.MouseButton.LeftButton:
            return
        self.setFocus()
        mark = self.mark_at(event.position())
        if mark is not None:
            self.set_phi(mark.phi)
        else:
            self.setSliderDown(True)
            self._go(event.position().x())
        event.accept()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        if self.isSliderDown():
            self._go(event.position().x())
        elif self.isEnabled() and self.mark_at(event.position()) is not None:
            self.setCursor(Qt.CursorShape.PointingHandCursor)
        else:
            self.unsetCursor()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        self.setSliderDown(False)

    def mark_at(self, place: QPointF) -> WayMark | None:
        """The mark whose sign or label lies under a pixel, if any."""
        if place.y() < MIDDLE + BELOW:
            return None
        for mark, box, _ in self._placed_marks():
            sign = QRectF(self._x(mark.phi) - 7.0, MIDDLE, 14.0, 0.5 * self.height())
            if box.contains(place) or sign.contains(place):
                return mark
        return None

    def _tell_value(self) -> None:
        """A screen reader would say the slider's whole number, which means nothing to anybody."""
        self.setAccessibleDescription(tr("{angle:.1f}°", angle=math.degrees(self.phi)))

    def _go(self, x: float) -> None:
        self.setValue(round(LAST * (x - SIDE) / max(self.width() - 2 * SIDE, 1.0)))

    def _x(self, phi: float) -> float:
        return SIDE + (self.width() - 2 * SIDE) * (1.0 - phi / math.pi)

    # drawing -------------------------------------------------------------------------------------------------------

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._paint_track(painter)
        self._paint_marks(painter)
        x = self._x(self.phi)
        if self.hasFocus():
            halo = QColor(self.palette_.accent)
            halo.setAlpha(60)
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(halo)
            painter.drawEllipse(QPointF(x, MIDDLE), HANDLE + 4, HANDLE + 4)
        painter.setPen(QPen(QColor(self.palette_.surface), 2.0))
        painter.setBrush(QColor(self.palette_.accent if self.isEnabled() else self.palette_.disabled))
        painter.drawEllipse(QPointF(x, MIDDLE), HANDLE, HANDLE)
        painter.end()

    def _paint_track(self, painter: QPainter) -> None:
        parts = stretches(self._target, self._contact)
        for kind, first, last in parts:
            left, right = self._x(first), self._x(last)
            box = QRectF(left, MIDDLE - 5.0, right - left, 10.0)
            paint_stretch(painter, kind, box, self.palette_, self.isEnabled())
        free_until = next((last for kind, _, last in parts if kind is Stretch.FREE), math.pi)
        if self.isEnabled():
            left, right = self._x(math.pi), self._x(max(self.phi, free_until))
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(QColor(self.palette_.accent))
            painter.drawRoundedRect(QRectF(left, MIDDLE - 2.5, right - left, 5.0), 2.5, 2.5)

    def _paint_marks(self, painter: QPainter) -> None:
        for mark, box, text in self._placed_marks():
            paint_mark(painter, mark.kind, QPointF(self._x(mark.phi), MIDDLE + 4.0), self.palette_)
            ends = mark.kind in (MarkKind.FLAT, MarkKind.TURNED)
            painter.setPen(QColor(self.palette_.muted if ends or not self.isEnabled() else self.palette_.text))
            painter.drawText(box, int(Qt.AlignmentFlag.AlignCenter), text)

    def _placed_marks(self) -> list[tuple[WayMark, QRectF, str]]:
        """Marks with their label and its box; one that would run into a more important one is short or empty."""
        metrics = self.fontMetrics()
        roomy = self.width() >= ROOM_FOR_WORDS
        placed: list[tuple[WayMark, QRectF, str]] = []
        for mark in self.marks():
            for text in (mark.words, mark.short) if roomy else (mark.short,):
                width = metrics.horizontalAdvance(text) + 2.0
                left = min(max(self._x(mark.phi) - 0.5 * width, SIDE - HANDLE), self.width() - SIDE + HANDLE - width)
                box = QRectF(left, MIDDLE + 13.0, width, 16.0)
                wide = box.adjusted(-LABEL_GAP, 0.0, LABEL_GAP, 0.0)
                if not any(wide.intersects(other) for _, other, _ in placed):
                    placed.append((mark, box, text))
                    break
            else:
                placed.append((mark, QRectF(), ""))
        return placed


def value_at(phi: float) -> int:
    """The slider's value at an angle, radians."""
    return round(LAST * (1.0 - phi / math.pi))
