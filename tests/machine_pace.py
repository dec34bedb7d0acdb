"""How fast the machine is just now, so that limits in seconds hold as ratios on any other."""

from __future__ import annotations

from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QPainter, QPixmap
from PySide6.QtWidgets import QPushButton, QVBoxLayout, QWidget
from stopwatch import fastest

#: Processor seconds of :func:`_reference_work` on the machine for which the limits of the clock tests are written.
REFERENCE = 0.015


def slowness() -> float:
    """How many times slower this machine is at the moment than the one for which limits are written; at least 1.

    The work is what a window does: Python that calls Qt, widgets that a style sheet dresses, antialiased painting.
    A time divided by this is a ratio of two times of one run, which other programs and slower processors leave alone.
    """
    return max(1.0, fastest(_reference_work) / REFERENCE)


def _reference_work() -> None:
    form = QWidget()
    layout = QVBoxLayout(form)
    for number in range(40):
        layout.addWidget(QPushButton(f"Button {number}"))
    form.setStyleSheet("QWidget { color: #123456; } QPushButton { padding: 3px; border: 1px solid gray; }")
    form.ensurePolished()
    form.grab()
    picture = QPixmap(500, 500)
    picture.fill(Qt.GlobalColor.white)
    painter = QPainter(picture)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    for number in range(1500):
        x, y = 7.0 * (number % 60), 7.0 * (number // 60)
        painter.drawPolygon([QPointF(x, y), QPointF(x + 9, y + 2), QPointF(x + 7, y + 11), QPointF(x - 2, y + 9)])
    painter.end()
    form.deleteLater()
