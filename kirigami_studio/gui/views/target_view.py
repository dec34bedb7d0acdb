"""The target: shown, and drawn by hand or corner by corner."""

from __future__ import annotations

import math
from enum import Enum

import numpy as np
from PySide6.QtCore import QPointF, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QDragEnterEvent,
    QDragLeaveEvent,
    QDropEvent,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPen,
)
from PySide6.QtWidgets import QWidget

from kirigami_studio.gui.scene.frame import Bounds, Frame
from kirigami_studio.gui.scene.target_items import paint_sketch, paint_target_shape
from kirigami_studio.gui.views.canvas import Canvas
from kirigami_studio.target.outline import Outline

#: A click this near (pixels) to the first corner closes the polygon.
CLOSING_REACH = 10.0
#: Freehand points nearer than this (pixels) to the last one are dropped: hands and mice jitter.
SMALLEST_STEP = 2.0


class Tool(Enum):
    """What a click on the target does."""

    LOOK = "look"
    FREEHAND = "freehand"
    POLYGON = "polygon"


class TargetView(Canvas):
    """Shows one outline and lets the user draw a new one."""

    freehand_drawn = Signal(object)  #: (L, 2) float array, y up, pixels
    polygon_drawn = Signal(object)  #: (L, 2) float array, y up, pixels
    file_dropped = Signal(str)
    tool_left = Signal()
    hint = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._outline: Outline | None = None
        self._tool = Tool.LOOK
        self._sketch: list[QPointF] = []
        self._pointer: QPointF | None = None
        self._drop_here = False
        self.setAcceptDrops(True)
        self.setMouseTracking(True)
        self.setObjectName("targetView")
        self.setAccessibleName("Target silhouette")
        self.setToolTip("The shape that the sheet shall show. Drop a PNG, JPG, SVG, DXF or JSON file here.")

    @property
    def outline(self) -> Outline | None:
        return self._outline

    @property
    def tool(self) -> Tool:
        return self._tool

    def show_outline(self, outline: Outline | None) -> None:
        """Show another target; an unfinished sketch is dropped."""
        self._outline = outline
        self._sketch.clear()
        self.fit()

    def set_tool(self, tool: Tool) -> None:
        """Change what clicks do."""
        self._tool = tool
        self._sketch.clear()
        self.setCursor(Qt.CursorShape.ArrowCursor if tool is Tool.LOOK else Qt.CursorShape.CrossCursor)
        if tool is not Tool.LOOK:
            self.setFocus()
        self.hint.emit(
            {
                Tool.LOOK: "",
                Tool.FREEHAND: "Draw the silhouette in one stroke; it closes itself when you let go.",
                Tool.POLYGON: "Click the corners; close with Enter or a click on the first one. Backspace takes back.",
            }[tool]
        )
        self.update()

    def empty_state(self) -> tuple[str, str, str]:
        return "target", "No target yet", "Drop an image, SVG or DXF here,\nchoose one from the library, or draw."

    def minimumSizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        """Lower than other canvases: in a low window with a message the settings below need the room."""
        return QSize(180, 56)

    def scene_bounds(self) -> Bounds | None:
        return None if self._outline is None else Bounds.of(self._outline.points)

    def paint_scene(self, painter: QPainter, frame: Frame) -> None:
        if self._outline is not None:
            painter.setOpacity(0.25 if self._tool is not Tool.LOOK else 1.0)
            paint_target_shape(painter, frame.to_pixels(self._outline.points), self.palette_)
            painter.setOpacity(1.0)

    def paint_notes(self, painter: QPainter) -> None:
        if self._sketch:
            points = [*self._sketch]
            if self._tool is Tool.POLYGON and self._pointer is not None:
                points.append(self._pointer)
            paint_sketch(painter, _pixels(points), self.palette_, corners=self._tool is Tool.POLYGON)
        if self._drop_here:
            painter.setPen(QPen(QColor(self.palette_.accent), 2.0, Qt.PenStyle.DashLine))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRoundedRect(self.rect().adjusted(6, 6, -6, -6), 8, 8)

    # drawing by hand -----------------------------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        if self._tool is Tool.LOOK or event.button() is not Qt.MouseButton.LeftButton:
            super().mousePressEvent(event)
        elif self._tool is Tool.FREEHAND:
            self._sketch = [event.position()]
        elif len(self._sketch) >= 3 and _distance(event.position(), self._sketch[0]) <= CLOSING_REACH:
            self._finish_polygon()
        elif not self._sketch or _distance(event.position(), self._sketch[-1]) > 0:
            self._sketch.append(event.position())
            self.update()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        self._pointer = event.position()
        if self._tool is Tool.LOOK:
            super().mouseMoveEvent(event)
            return
        drawing = self._tool is Tool.FREEHAND and event.buttons() & Qt.MouseButton.LeftButton
        if drawing and self._sketch and _distance(event.position(), self._sketch[-1]) >= SMALLEST_STEP:
            self._sketch.append(event.position())
        self.update()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        if self._tool is Tool.LOOK:
            super().mouseReleaseEvent(event)
        elif self._tool is Tool.FREEHAND and event.button() is Qt.MouseButton.LeftButton and self._sketch:
            stroke = self._take_sketch()
            if len(stroke) > 1:
                self.freehand_drawn.emit(stroke)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        if self._tool is Tool.LOOK:
            super().mouseDoubleClickEvent(event)
        elif self._tool is Tool.POLYGON:
            self._finish_polygon()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        key = event.key()
        if self._tool is not Tool.LOOK and key == Qt.Key.Key_Escape:
            self._sketch.clear()
            self.tool_left.emit()
        elif self._tool is Tool.POLYGON and key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self._finish_polygon()
        elif self._tool is Tool.POLYGON and key == Qt.Key.Key_Backspace and self._sketch:
            self._sketch.pop()
            self.update()
        else:
            super().keyPressEvent(event)

    def _finish_polygon(self) -> None:
        corners = self._take_sketch()
        if len(corners):
            self.polygon_drawn.emit(corners)

    def _take_sketch(self) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
        points = _pixels(self._sketch) * (1.0, -1.0)
        self._sketch = []
        self.update()
        return points

    # files dropped from outside ------------------------------------------------------------------------------------

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:  # noqa: N802 - Qt's name
        if any(url.isLocalFile() for url in event.mimeData().urls()):
            event.acceptProposedAction()
            self._drop_here = True
            self.update()

    def dragLeaveEvent(self, event: QDragLeaveEvent) -> None:  # noqa: N802 - Qt's name
        self._drop_here = False
        self.update()

    def dropEvent(self, event: QDropEvent) -> None:  # noqa: N802 - Qt's name
        self._drop_here = False
        self.update()
        files = [url.toLocalFile() for url in event.mimeData().urls() if url.isLocalFile()]
        if files:
            event.acceptProposedAction()
            self.file_dropped.emit(files[0])


def _pixels(points: list[QPointF]) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return np.array([(point.x(), point.y()) for point in points], dtype=np.float64).reshape(-1, 2)


def _distance(one: QPointF, other: QPointF) -> float:
    return math.hypot(one.x() - other.x(), one.y() - other.y())
