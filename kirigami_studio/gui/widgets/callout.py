"""A bubble with an arrow that points at a control, and a ring around that control."""

from __future__ import annotations

from PySide6.QtCore import QPoint, QPointF, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QKeyEvent, QPainter, QPainterPath, QPaintEvent, QPen
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.widgets.theme import LIGHT, Palette

ARROW = 11
WIDTH = 330
#: Pixels between bubble and control, and between bubble and the window's edge.
GAP, MARGIN = 5, 8


class Ring(QWidget):
    """Lies over the window around one control and lets every click through."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.palette_: Palette = LIGHT
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.hide()

    def surround(self, place: QRect) -> None:
        """Lie around a rectangle of the window."""
        self.setGeometry(place.adjusted(-4, -4, 4, 4))
        self.raise_()
        self.show()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(QColor(self.palette_.target), 2.5))
        painter.drawRoundedRect(QRectF(self.rect()).adjusted(2, 2, -2, -2), 9, 9)
        painter.end()


class Callout(QWidget):
    """Title, text, and the buttons Back, Next and Skip."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self._window = window
        self.palette_: Palette = LIGHT
        self._tip = QPoint()
        self.setObjectName("callout")
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.title = QLabel()
        self.title.setObjectName("cardTitle")
        self.text = QLabel()
        self.text.setWordWrap(True)
        self.count = QLabel()
        self.count.setObjectName("muted")
        self.skip = self._button(tr("&Skip the tour"), tr("End the tour (Esc). Restart it from Help > Tour."), "link")
        self.back = self._button(tr("&Back"), tr("Previous step (Left)."))
        self.next = self._button(tr("&Next"), tr("Next step (Right or Return)."))
        head, buttons = QHBoxLayout(), QHBoxLayout()
        head.addWidget(self.title, 1)
        head.addWidget(self.count)
        buttons.addWidget(self.skip)
        buttons.addStretch(1)
        buttons.addWidget(self.back)
        buttons.addWidget(self.next)
        self._column = QVBoxLayout(self)
        self._column.setSpacing(7)
        self._column.addLayout(head)
        self._column.addWidget(self.text)
        self._column.addLayout(buttons)
        self.hide()

    def _button(self, text: str, tip: str, name: str = "") -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setToolTip(tip)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        button.setAutoDefault(False)
        return button

    def say(self, title: str, text: str, number: int, total: int) -> None:
        """Show other words; ``number`` counts from 1."""
        self.title.setText(title)
        self.text.setText(text)
        self.count.setText(tr("{number} of {total}", number=number, total=total))
        self.back.setEnabled(number > 1)
        self.next.setText(tr("&Done") if number == total else tr("&Next"))
        self.setAccessibleName(tr("Tour, step {number} of {total}: {title}", number=number, total=total, title=title))
        self.setAccessibleDescription(text)

    def point_at(self, place: QRect) -> None:
        """Show the bubble beside a rectangle of the window, where there is room, with the arrow towards its middle."""
        self._column.setContentsMargins(14 + ARROW, 10 + ARROW, 14 + ARROW, 10 + ARROW)
        width = WIDTH + 2 * ARROW
        size = QSize(width, self._column.totalHeightForWidth(width))
        room = self._window.rect().adjusted(MARGIN, MARGIN, -MARGIN, -MARGIN)
        self.setGeometry(QRect(beside(place, size, room), size))
        self._tip = self.mapFromParent(place.center())
        self.raise_()
        self.show()
        self.update()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        buttons = {
            Qt.Key.Key_Escape: self.skip,
            Qt.Key.Key_Left: self.back,
            Qt.Key.Key_Right: self.next,
            Qt.Key.Key_Return: self.next,
            Qt.Key.Key_Enter: self.next,
        }
        button = buttons.get(Qt.Key(event.key()))
        if button is None:
            super().keyPressEvent(event)
        else:
            button.click()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        body = QRectF(self.rect()).adjusted(ARROW, ARROW, -ARROW, -ARROW)
        shape = QPainterPath()
        shape.addRoundedRect(body, 10, 10)
        shape = shape.united(arrow(body, QPointF(self._tip)))
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setBrush(QColor(self.palette_.surface))
        painter.setPen(QPen(QColor(self.palette_.target), 1.6))
        painter.drawPath(shape)
        painter.end()


def beside(place: QRect, size: QSize, room: QRect) -> QPoint:
    """Upper left corner of a bubble of ``size`` beside ``place``: where most room is left, inside ``room``."""
    x = place.center().x() - size.width() // 2
    y = place.center().y() - size.height() // 2
    spare = {
        (place.right() + GAP, y): room.right() - place.right() - size.width(),
        (place.left() - GAP - size.width(), y): place.left() - room.left() - size.width(),
        (x, place.top() - GAP - size.height()): place.top() - room.top() - size.height(),
        (x, place.bottom() + GAP): room.bottom() - place.bottom() - size.height(),
    }
    left, top = max(spare, key=lambda corner: spare[corner])
    left = min(max(left, room.left()), room.right() - size.width())
    top = min(max(top, room.top()), room.bottom() - size.height())
    return QPoint(left, top)


def arrow(body: QRectF, tip: QPointF) -> QPainterPath:
    """The triangle from the side of ``body`` that ``tip`` lies beyond; empty when it lies beyond none."""
    half, inset = 9.0, 18.0
    result = QPainterPath()
    x = min(max(tip.x(), body.left() + inset), body.right() - inset)
    y = min(max(tip.y(), body.top() + inset), body.bottom() - inset)
    if tip.x() < body.left() or tip.x() > body.right():
        side, way = (body.left(), -1) if tip.x() < body.left() else (body.right(), 1)
        corners = [QPointF(side, y - half), QPointF(side + way * (ARROW - 1), y), QPointF(side, y + half)]
    elif tip.y() < body.top() or tip.y() > body.bottom():
        side, way = (body.top(), -1) if tip.y() < body.top() else (body.bottom(), 1)
        corners = [QPointF(x - half, side), QPointF(x, side + way * (ARROW - 1)), QPointF(x + half, side)]
    else:
        return result
    result.moveTo(corners[0])
    for corner in corners[1:]:
        result.lineTo(corner)
    result.closeSubpath()
    return result
