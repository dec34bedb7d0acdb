"""A slider over the deployment angle: free, in contact, past the target; marks at flat, contact and target."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

from PySide6.QtCore import QLineF, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QMouseEvent, QPainter, QPainterPath, QPaintEvent, QPen, QWheelEvent
from PySide6.QtWidgets import QSlider, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.widgets.paths import ink, painter_on
from kirigami_studio.gui.widgets.theme import LIGHT, Palette

#: Slider steps per degree.
RESOLUTION = 10
LAST = 180 * RESOLUTION
SIDE = 14.0
HANDLE = 8.0
#: Height (pixels) of the track's middle; marks begin ``BELOW`` it.
MIDDLE, BELOW = 15.0, 9.0
#: Pixels that a contact's stretch is high, and that its stripes are apart.
CONTACT_HEIGHT, STRIPE = 9.0, 6.0
FREE_HEIGHT = 5.0
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
        self._second: float | None = None
        self.jam: float | None = None  #: angle (radians) at which the sheet jams as cut
        self._ideal = False
        self.setRange(0, LAST)
        self.setSingleStep(RESOLUTION)
        self.setPageStep(10 * RESOLUTION)
        self.setMinimumHeight(44)
        self.setMouseTracking(True)
        self.setObjectName("phiSlider")
        self._update_tooltip()
        self.valueChanged.connect(lambda value: self.phi_changed.emit(self.phi))
        self.valueChanged.connect(lambda _: self._describe_value())
        self._describe_value()

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

    def set_marks(self, target: float, contact: float | None, second: float | None = None) -> None:
        """Mark the target angle, the first contact and the angle of a second target, radians."""
        self._target, self._contact, self._second = target, contact, second
        self._update_tooltip()
        self.update()

    def set_jam(self, jam: float | None) -> None:
        """Mark the angle (radians) at which the sheet jams as cut; None where it closes or nothing is known."""
        self.jam = jam
        self._update_tooltip()
        self.update()

    def set_ideal(self, ideal: bool) -> None:
        """Whether the handle goes on beyond the jam, as connectors of no width would let it."""
        self._ideal = ideal
        self.update()

    def stopped(self, value: int) -> int:
        """Where the handle stops on its way to a value: at the jam, unless it is beyond it already."""
        if self.jam is None or self._ideal or self.value() > value_at(self.jam):
            return value
        return min(value, value_at(self.jam))

    def set_palette(self, palette: Palette) -> None:
        self.palette_ = palette
        self.update()

    def marks(self) -> tuple[TrackMark, ...]:
        """All marks, the most important first."""
        found = (
            (MarkKind.TARGET, self._target, tr("{angle} target")),
            (MarkKind.JAM, self.jam, tr("{angle} jams")),
            (MarkKind.SECOND, self._second, tr("{angle} second")),
            (MarkKind.CONTACT, self._contact, tr("{angle} contact")),
            (MarkKind.FLAT, math.pi, tr("180° flat")),
            (MarkKind.TURNED, None if self._target == 0.0 else 0.0, "0°"),
        )
        degrees = {kind: f"{math.degrees(phi):.0f}°" for kind, phi, _ in found if phi is not None}
        return tuple(
            TrackMark(kind, phi, words.format(angle=degrees[kind]), degrees[kind])
            for kind, phi, words in found
            if phi is not None
        )

    def _update_tooltip(self) -> None:
        lines = [
            tr("Deployment angle: 180° is the flat sheet, 0° fully turned."),
            tr("Yellow stripes: touches itself. Orange dashes: past the target."),
        ]
        if self._contact is not None:
            lines.append(tr("First contact at {angle:.1f}°.", angle=math.degrees(self._contact)))
        if self.jam is not None:
            lines.append(
                tr(
                    "Jams at {angle:.1f}° as cut: the handle stops there. Ideal lets it go on.",
                    angle=math.degrees(self.jam),
                )
            )
        if self._second is not None:
            lines.append(tr("Second target at {angle:.1f}°.", angle=math.degrees(self._second)))
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

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        before = self.value()
        super().keyPressEvent(event)
        self._stop_after(before)

    def wheelEvent(self, event: QWheelEvent) -> None:  # noqa: N802 - Qt's name
        before = self.value()
        super().wheelEvent(event)
        self._stop_after(before)

    def _stop_after(self, before: int) -> None:
        """Go back to the jam where a step has led past it."""
        if self.jam is not None and not self._ideal and before <= value_at(self.jam) < self.value():
            self.setValue(value_at(self.jam))

    def mark_at(self, place: QPointF) -> TrackMark | None:
        """The mark whose sign or label lies under a pixel, if any."""
        if place.y() < MIDDLE + BELOW:
            return None
        for mark, box, _ in self._placed_marks():
            sign = QRectF(self._x(mark.phi) - 7.0, MIDDLE, 14.0, 0.5 * self.height())
            if box.contains(place) or sign.contains(place):
                return mark
        return None

    def _describe_value(self) -> None:
        """A screen reader would say the slider's whole number, which means nothing to anybody."""
        angle = tr("{angle:.1f}°", angle=math.degrees(self.phi))
        self.setAccessibleName(tr("Deployment angle: {angle}", angle=angle))
        self.setAccessibleDescription(angle)

    def _go(self, x: float) -> None:
        self.setValue(self.stopped(round(LAST * (x - SIDE) / max(self.width() - 2 * SIDE, 1.0))))

    def _x(self, phi: float) -> float:
        return SIDE + (self.width() - 2 * SIDE) * (1.0 - phi / math.pi)

    # drawing -------------------------------------------------------------------------------------------------------

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        painter = painter_on(self)
        self._paint_track(painter)
        self._paint_marks(painter)
        x = self._x(self.phi)
        if self.hasFocus():
            ink(painter, None, fill=self.palette_.accent, alpha=60)
            painter.drawEllipse(QPointF(x, MIDDLE), HANDLE + 4, HANDLE + 4)
        ink(
            painter,
            self.palette_.surface,
            2.0,
            fill=self.palette_.accent if self.isEnabled() else self.palette_.disabled,
        )
        painter.drawEllipse(QPointF(x, MIDDLE), HANDLE, HANDLE)
        painter.end()

    def _paint_track(self, painter: QPainter) -> None:
        parts = track_parts(self._target, self._contact, self.jam)
        for kind, first, last in parts:
            left, right = self._x(first), self._x(last)
            box = QRectF(left, MIDDLE - 5.0, right - left, 10.0)
            paint_track_part(painter, kind, box, self.palette_, self.isEnabled())
        free_until = next((last for kind, _, last in parts if kind is TrackPart.FREE), math.pi)
        if self.isEnabled():
            left, right = self._x(math.pi), self._x(max(self.phi, free_until))
            ink(painter, None, fill=self.palette_.accent)
            painter.drawRoundedRect(QRectF(left, MIDDLE - 2.5, right - left, 5.0), 2.5, 2.5)

    def _paint_marks(self, painter: QPainter) -> None:
        for mark, box, text in self._placed_marks():
            paint_mark(painter, mark.kind, QPointF(self._x(mark.phi), MIDDLE + 4.0), self.palette_)
            ends = mark.kind in (MarkKind.FLAT, MarkKind.TURNED)
            painter.setPen(QColor(self.palette_.muted if ends or not self.isEnabled() else self.palette_.text))
            painter.drawText(box, int(Qt.AlignmentFlag.AlignCenter), text)

    def _placed_marks(self) -> list[tuple[TrackMark, QRectF, str]]:
        """Marks with their label and its box; one that would run into a more important one makes way or is empty.

        It is short where that helps, and else stands left of the other one.
        """
        metrics = self.fontMetrics()
        roomy = self.width() >= ROOM_FOR_WORDS
        placed: list[tuple[TrackMark, QRectF, str]] = []
        for mark in self.marks():
            texts = (mark.words, mark.short) if roomy else (mark.short,)
            beside = [other.left() - LABEL_GAP for _, other, text in placed if text]
            for text, end in [(text, None) for text in texts] + [(text, end) for text in texts for end in beside]:
                width = metrics.horizontalAdvance(text) + 2.0
                left = min(max(self._x(mark.phi) - 0.5 * width, SIDE - HANDLE), self.width() - SIDE + HANDLE - width)
                if (
                    end is not None and not 0.0 <= left + width - end <= 2.0 * width + LABEL_GAP
                ):  # too far from its mark
                    continue
                box = QRectF(left if end is None else end - width, MIDDLE + 13.0, width, 16.0)
                if box.left() < 0.0:
                    continue
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


class TrackPart(Enum):
    """What a part of the track stands for; each has its own colour, thickness and pattern."""

    FREE = "free"
    CONTACT = "contact"
    JAMMED = "jammed"
    PAST = "past"


class MarkKind(Enum):
    """What a mark on the track stands for."""

    FLAT = "flat"
    JAM = "jam"
    CONTACT = "contact"
    TARGET = "target"
    SECOND = "second"
    TURNED = "turned"


@dataclass(frozen=True, slots=True)
class TrackMark:
    """An angle on the track that a click goes to."""

    kind: MarkKind
    phi: float  #: radians
    #: words, short: label where there is room, and where there is not.
    words: str
    short: str


def track_parts(
    target: float, contact: float | None, jam: float | None = None
) -> tuple[tuple[TrackPart, float, float], ...]:
    """Parts of the track with their first and last angle, radians; those without length are left out.

    Contacts are looked for up to the target angle only, so that what comes after it is said to be past the target.
    What comes after a jam is jammed, up to the target.
    """
    free_until = target if contact is None else max(contact, target)
    moves_until = free_until if jam is None else max(jam, free_until)
    touches_until = target if jam is None else max(jam, target)
    parts = (
        (TrackPart.FREE, math.pi, moves_until),
        (TrackPart.CONTACT, moves_until, touches_until),
        (TrackPart.JAMMED, min(moves_until, touches_until), target),
        (TrackPart.PAST, target, 0.0),
    )
    return tuple(part for part in parts if part[1] > part[2])


def paint_track_part(painter: QPainter, kind: TrackPart, box: QRectF, palette: Palette, enabled: bool) -> None:
    """Draw one part: a plain bar when free, thick and striped in contact, thin dashes past the target."""
    middle = box.center().y()
    if kind is TrackPart.FREE or not enabled:
        ink(painter, None, fill=palette.strong_border)
        bar = QRectF(box.left(), middle - 0.5 * FREE_HEIGHT, box.width(), FREE_HEIGHT)
        painter.drawRoundedRect(bar, 2.5, 2.5)
    elif kind is TrackPart.JAMMED:
        ink(painter, palette.warning, 1.2, fill=palette.warning_soft)
        bar = QRectF(box.left(), middle - 0.5 * FREE_HEIGHT, box.width(), FREE_HEIGHT)
        painter.drawRoundedRect(bar, 2.5, 2.5)
    elif kind is TrackPart.CONTACT:
        _paint_striped(painter, QRectF(box.left(), middle - 0.5 * CONTACT_HEIGHT, box.width(), CONTACT_HEIGHT), palette)
    else:
        pen = QPen(QColor(palette.target), 2.6, Qt.PenStyle.CustomDashLine, Qt.PenCapStyle.FlatCap)
        pen.setDashPattern([1.6, 1.4])
        painter.setPen(pen)
        painter.drawLine(QPointF(box.left() + 2.0, middle), QPointF(box.right(), middle))


def _paint_striped(painter: QPainter, bar: QRectF, palette: Palette) -> None:
    painter.save()
    ink(painter, None, fill=palette.fault)
    painter.drawRoundedRect(bar, 2.0, 2.0)
    painter.setClipRect(bar)
    painter.setPen(QPen(QColor(palette.fault_line), 1.8))
    height = bar.height()
    count = int((bar.width() + height) / STRIPE) + 1
    starts = [bar.left() - height + STRIPE * number for number in range(count + 1)]
    painter.drawLines([QLineF(x, bar.bottom(), x + height, bar.top()) for x in starts])
    painter.setClipping(False)
    ink(painter, palette.strong_border)
    painter.drawRoundedRect(bar, 2.0, 2.0)
    painter.restore()


def paint_mark(painter: QPainter, kind: MarkKind, tip: QPointF, palette: Palette) -> None:
    """Draw the sign of a mark below the track: an arrow to the target, a hollow one to a second target, a diamond at a
    contact, a bar at a jam, a tick at the ends."""
    if kind is MarkKind.JAM:
        ink(painter, None, fill=palette.warning)
        painter.drawRoundedRect(QRectF(tip.x() - 1.75, tip.y() - 13.0, 3.5, 21.0), 1.5, 1.5)
        return
    path = QPainterPath(tip)
    if kind in (MarkKind.TARGET, MarkKind.SECOND):
        path.lineTo(tip + QPointF(-5, 8))
        path.lineTo(tip + QPointF(5, 8))
    elif kind is MarkKind.CONTACT:
        for dx, dy in ((4.5, 4.5), (0, 9), (-4.5, 4.5)):
            path.lineTo(tip + QPointF(dx, dy))
    else:
        painter.setPen(QPen(QColor(palette.muted), 1.4))
        painter.drawLine(tip + QPointF(0, 2), tip + QPointF(0, 7))
        return
    path.closeSubpath()
    match kind:
        case MarkKind.CONTACT:
            ink(painter, palette.fault_line, 1.2, fill=palette.fault)
        case MarkKind.SECOND:
            ink(painter, palette.target, 1.4, fill=palette.surface)
        case _:
            ink(painter, None, fill=palette.target)
    painter.drawPath(path)
