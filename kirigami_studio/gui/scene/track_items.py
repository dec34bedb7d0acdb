"""Paint the way from the flat sheet to the fully turned one: free, past its first contact, past the target."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPainterPath, QPen

from kirigami_studio.gui.look.theme import Palette

#: Pixels that a contact's stretch is high, and that its stripes are apart.
CONTACT_HEIGHT, STRIPE = 9.0, 6.0
FREE_HEIGHT = 5.0


class Stretch(Enum):
    """What a part of the way is like; each has a colour, a thickness and a pattern of its own."""

    FREE = "free"
    CONTACT = "contact"
    PAST = "past"


class MarkKind(Enum):
    """What a mark on the way stands for."""

    FLAT = "flat"
    CONTACT = "contact"
    TARGET = "target"
    TURNED = "turned"


@dataclass(frozen=True, slots=True)
class WayMark:
    """A place on the way that a person may want to go to.

    Attributes
    ----------
    kind : MarkKind
    phi : float, radians
    words, short : str
        Label where there is room, and where there is not.
    """

    kind: MarkKind
    phi: float
    words: str
    short: str


def stretches(target: float, contact: float | None) -> tuple[tuple[Stretch, float, float], ...]:
    """Parts of the way with their first and last angle, radians; those without length are left out.

    Contacts are looked for up to the target angle only, so that what comes after it is said to be past the target.
    """
    free_until = target if contact is None else max(contact, target)
    parts = (
        (Stretch.FREE, math.pi, free_until),
        (Stretch.CONTACT, free_until, target),
        (Stretch.PAST, target, 0.0),
    )
    return tuple(part for part in parts if part[1] > part[2])


def paint_stretch(painter: QPainter, kind: Stretch, box: QRectF, palette: Palette, enabled: bool) -> None:
    """Draw one part: a plain bar when free, thick and striped in contact, thin dashes past the target."""
    middle = box.center().y()
    if kind is Stretch.FREE or not enabled:
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(palette.strong_border))
        bar = QRectF(box.left(), middle - 0.5 * FREE_HEIGHT, box.width(), FREE_HEIGHT)
        painter.drawRoundedRect(bar, 2.5, 2.5)
    elif kind is Stretch.CONTACT:
        _paint_striped(painter, QRectF(box.left(), middle - 0.5 * CONTACT_HEIGHT, box.width(), CONTACT_HEIGHT), palette)
    else:
        pen = QPen(QColor(palette.target), 2.6, Qt.PenStyle.CustomDashLine, Qt.PenCapStyle.FlatCap)
        pen.setDashPattern([1.6, 1.4])
        painter.setPen(pen)
        painter.drawLine(QPointF(box.left() + 2.0, middle), QPointF(box.right(), middle))


def _paint_striped(painter: QPainter, bar: QRectF, palette: Palette) -> None:
    painter.save()
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(palette.fault))
    painter.drawRoundedRect(bar, 2.0, 2.0)
    painter.setClipRect(bar)
    painter.setPen(QPen(QColor(palette.fault_line), 1.8))
    height = bar.height()
    count = int((bar.width() + height) / STRIPE) + 1
    starts = [bar.left() - height + STRIPE * number for number in range(count + 1)]
    painter.drawLines([QLineF(x, bar.bottom(), x + height, bar.top()) for x in starts])
    painter.setClipping(False)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(QPen(QColor(palette.strong_border), 1.0))
    painter.drawRoundedRect(bar, 2.0, 2.0)
    painter.restore()


def paint_mark(painter: QPainter, kind: MarkKind, tip: QPointF, palette: Palette) -> None:
    """Draw the sign of a mark below the track: an arrow to the target, a diamond at a contact, a tick at the ends."""
    path = QPainterPath(tip)
    if kind is MarkKind.TARGET:
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
    contact = kind is MarkKind.CONTACT
    painter.setPen(QPen(QColor(palette.fault_line), 1.2) if contact else QPen(Qt.PenStyle.NoPen))
    painter.setBrush(QColor(palette.fault if contact else palette.target))
    painter.drawPath(path)
