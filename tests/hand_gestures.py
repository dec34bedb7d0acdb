"""What a hand does to the layout view of a window, with real events."""

from __future__ import annotations

import math
from collections.abc import Callable

from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.gui.stage.layout_view import LayoutView
from kirigami_studio.gui.stage.void_items import VoidShapes
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.project.document import Void

Until = Callable[[Callable[[], bool]], None]
LEFT, NONE = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
SHIFT, ALT = Qt.KeyboardModifier.ShiftModifier, Qt.KeyboardModifier.AltModifier
OPEN = math.radians(100.0)


def shapes_of(view: LayoutView) -> VoidShapes:
    transform = view.transform()
    assert view.design is not None and transform is not None
    return VoidShapes.of(view.design, view.phi, transform)


def middle_of(view: LayoutView, void: Void) -> QPoint:
    x, y = shapes_of(view).corners[void].mean(axis=0)
    return QPoint(round(x), round(y))


def vertex_at(view: LayoutView, vertex: int) -> QPoint:
    x, y = shapes_of(view).vertices[vertex]
    return QPoint(round(x), round(y))


def turn(view: LayoutView, place: QPoint, notches: int, modifiers: Qt.KeyboardModifier = NONE) -> None:
    at = QPointF(place)
    event = QWheelEvent(
        at, QPointF(view.mapToGlobal(place)), QPoint(), QPoint(0, 120 * notches), Qt.MouseButton.NoButton, modifiers,
        Qt.ScrollPhase.NoScrollPhase, False,
    )  # fmt: skip
    QApplication.sendEvent(view, event)


def drag(
    view: LayoutView, start: QPoint, end: QPoint, modifiers: Qt.KeyboardModifier = NONE, let_go: bool = True
) -> None:
    QTest.mouseMove(view, start)
    QTest.mousePress(view, LEFT, modifiers, start)
    for step in range(1, 6):
        QTest.mouseMove(view, start + (end - start) * (step / 5))
        QApplication.processEvents()
    if let_go:
        QTest.mouseRelease(view, LEFT, modifiers, end)


def chosen(window: MainWindow) -> Candidate:
    candidate = window.session.document.candidate
    assert candidate is not None
    return candidate


def ratio(window: MainWindow, void: Void) -> float:
    return float(chosen(window).sheet.field.ratio[void])


def settle(window: MainWindow, until: Until) -> None:
    until(lambda: not window.services.hand.busy)
