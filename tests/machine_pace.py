"""How fast the machine does what a window does just now, so that limits in seconds hold as ratios on any other."""

from __future__ import annotations

import time

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QImage, QPainter, QPainterPath, QStandardItem, QStandardItemModel, QTextDocument
from PySide6.QtWidgets import QGraphicsScene
from stopwatch import fastest

#: Processor seconds of :func:`_reference_work` on the machine for which the limits are written.
REFERENCE = 0.019


def window_slowness(repeats: int = 2) -> float:
    """How many times slower this thread is at the moment than on the machine for which limits are written; at least 1.

    The work is what a window does: Python that calls Qt, tables, laid out text, a scene, antialiased painting.  It is
    the same whatever style sheet the application has.  A time divided by this is a ratio of two times of one run.
    """
    return max(1.0, fastest(_reference_work, repeats, time.thread_time) / REFERENCE)


def _reference_work() -> None:
    table, text, scene = QStandardItemModel(), QTextDocument(), QGraphicsScene()
    for number in range(300):
        table.appendRow([QStandardItem(f"Row {number}"), QStandardItem(str(number))])
    text.setHtml("".join(f"<p style='color: #123456'>Line <b>{number}</b> of the text</p>" for number in range(60)))
    text.setTextWidth(300.0)
    text.size()
    for number in range(200):
        scene.addPath(_quadrilateral(number))
    picture = QImage(500, 500, QImage.Format.Format_ARGB32_Premultiplied)
    picture.fill(Qt.GlobalColor.white)
    painter = QPainter(picture)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    scene.render(painter)
    for number in range(1000):
        painter.drawPath(_quadrilateral(number))
    painter.end()


def _quadrilateral(number: int) -> QPainterPath:
    x, y = 7.0 * (number % 60), 7.0 * (number // 60)
    path = QPainterPath(QPointF(x, y))
    for place in (QPointF(x + 9, y + 2), QPointF(x + 7, y + 11), QPointF(x - 2, y + 9)):
        path.lineTo(place)
    path.closeSubpath()
    return path
