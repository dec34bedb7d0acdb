"""The base of every drawing area: background dots, fit, zoom, pan and the text of its empty state."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from enum import Enum
from functools import cache

import numpy as np
from PySide6.QtCore import QObject, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QAccessible,
    QAccessibleInterface,
    QColor,
    QFocusEvent,
    QFont,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QPixmap,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QAccessibleWidget, QSizePolicy, QWidget

from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.widgets.paths import blank, ink, painter_on
from kirigami_studio.gui.widgets.theme import LIGHT, Palette
from kirigami_studio.gui.widgets.view_transform import Bounds, ViewTransform

MARGIN = 28.0
ZOOM_STEP = 1.2
SMALLEST_ZOOM, LARGEST_ZOOM = 0.2, 60.0
#: Distance of the background dots, pixels.
GRID_STEP = 22
#: Height of a row of these dots, pixels.
DOT_ROW = 6
ICON_EDGE = 40
#: Height of the picture of an empty view with what is below it, and a width that leaves little room beside words.
ICON_ROOM, NARROW = 52, 200


class Canvas(QWidget):
    """Shows a scene in world units; subclasses say what is in it.

    Subclasses override :meth:`scene_bounds`, :meth:`paint_scene` and :meth:`empty_state`.
    """

    view_changed = Signal(float, QPointF)  #: zoom and shift (pixels), after a gesture has changed them

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.palette_ = LIGHT
        self._zoom = 1.0
        self._shift = QPointF(0.0, 0.0)
        self._grip: QPointF | None = None
        self.overlays: frozenset[Enum] = frozenset()
        self.rendering = False  #: whether it is drawn into a picture instead of the screen
        self._background: tuple[tuple[int, int, float, str], QPixmap] | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self._by_tab = False  # whether it got the keyboard by the Tab key, which shows where it is
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)

    # for subclasses to override --------------------------------------------------------------------------------------

    def scene_bounds(self) -> Bounds | None:
        """World box to be shown; None when there is nothing yet."""
        return None

    def scene_box(self) -> QRectF:
        """Part of the view (pixels) that the scene is fitted into; the rest is for legends."""
        return QRectF(self.rect())

    def paint_scene(self, painter: QPainter, transform: ViewTransform) -> None:
        """Draw the scene."""

    def paint_notes(self, painter: QPainter) -> None:
        """Draw legends and captions on top, in pixels."""

    def empty_state(self) -> tuple[str, str, str]:
        """Icon, headline and hint shown while there is nothing."""
        return "info", "", ""

    # public ----------------------------------------------------------------------------------------------------------

    def set_palette(self, palette: Palette) -> None:
        self.palette_ = palette
        self.update()

    def transform(self) -> ViewTransform | None:
        """How the world appears now; None while there is nothing."""
        bounds = self.scene_bounds()
        if bounds is None:
            return None
        box = self.scene_box()
        fitted = ViewTransform.fitting(bounds, box, self.margin())
        return fitted.zoomed(self._zoom, box.center()).moved(self._shift.x(), self._shift.y())

    def margin(self) -> float:
        """Pixels that stay free around the fitted scene."""
        return min(MARGIN, 0.06 * min(self.width(), self.height()))

    def fit(self) -> None:
        """Show everything again."""
        self._zoom, self._shift = 1.0, QPointF(0.0, 0.0)
        self._show_view()

    def zoom(self, factor: float, about: QPointF | None = None) -> None:
        """Zoom, keeping the pixel ``about`` (the middle unless given) in place."""
        wanted = min(max(self._zoom * factor, SMALLEST_ZOOM), LARGEST_ZOOM)
        factor = wanted / self._zoom
        middle = self.scene_box().center()
        offset = (about or middle) - middle
        self._shift = offset + (self._shift - offset) * factor
        self._zoom = wanted
        self._show_view()

    def zoom_to(self, place: tuple[float, float], zoom: float) -> None:
        """Bring a place of the world to the middle, enlarged ``zoom`` times over the fitted picture."""
        self.fit()
        self.zoom(zoom)
        transform = self.transform()
        if transform is not None:
            x, y = transform.to_pixels(np.array(place)).tolist()
            self._shift += self.scene_box().center() - QPointF(x, y)
            self._show_view()

    def render_to(self, painter: QPainter, size: QSize) -> None:
        """Render the view into any paint device, as large as ``size`` allows, without the background dots."""
        factor = min(size.width() / max(self.width(), 1), size.height() / max(self.height(), 1))
        self.rendering = True
        painter.save()
        painter.scale(factor, factor)
        painter.setClipRect(self.rect())
        painter.setFont(self.font())
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.fillRect(self.rect(), QColor(self.palette_.canvas))
        try:
            self._paint_content(painter)
        finally:
            painter.restore()
            self.rendering = False

    @contextmanager
    def without_overlays(self) -> Iterator[None]:
        """Draw no overlays inside this context."""
        before, self.overlays = self.overlays, frozenset()
        try:
            yield
        finally:
            self.overlays = before

    def set_view(self, zoom: float, shift: QPointF) -> None:
        """Show the part that another canvas of the same size and scene shows; no signal is emitted for it."""
        self._zoom, self._shift = zoom, QPointF(shift)
        self.update()

    def _show_view(self) -> None:
        self.view_changed.emit(self._zoom, QPointF(self._shift))
        self.update()

    # events --------------------------------------------------------------------------------------------------------

    def minimumSizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return QSize(180, 140)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        self.update()

    def wheelEvent(self, event: QWheelEvent) -> None:  # noqa: N802 - Qt's name
        if self.scene_bounds() is None:
            event.ignore()
            return
        self.zoom(math.pow(ZOOM_STEP, event.angleDelta().y() / 120.0), event.position())
        event.accept()

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        if event.button() in (Qt.MouseButton.LeftButton, Qt.MouseButton.MiddleButton):
            self._grip = event.position()
            event.accept()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        if self._grip is not None and self.scene_bounds() is not None:
            self._shift += event.position() - self._grip
            self._grip = event.position()
            self.setCursor(Qt.CursorShape.ClosedHandCursor)
            self._show_view()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        self._grip = None
        self.unsetCursor()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        self.fit()

    def focusInEvent(self, event: QFocusEvent) -> None:  # noqa: N802 - Qt's name
        super().focusInEvent(event)
        self._by_tab = event.reason() in (Qt.FocusReason.TabFocusReason, Qt.FocusReason.BacktabFocusReason)

    def focusOutEvent(self, event: QFocusEvent) -> None:  # noqa: N802 - Qt's name
        super().focusOutEvent(event)
        self._by_tab = False

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        painter = painter_on(self)
        try:
            self._paint_background(painter)
            self._paint_content(painter)
            if self._by_tab:
                ink(painter, self.palette_.accent, 2.0)
                painter.drawRoundedRect(QRectF(self.rect()).adjusted(1.0, 1.0, -1.0, -1.0), 7, 7)
        finally:  # Qt crashes over a widget whose painter was left open by an error
            painter.end()

    # drawing -------------------------------------------------------------------------------------------------------

    def _paint_content(self, painter: QPainter) -> None:
        transform = self.transform()
        if transform is None:
            self._paint_empty(painter)
        else:
            self.paint_scene(painter, transform)
        self.paint_notes(painter)

    def _paint_background(self, painter: QPainter) -> None:
        if self.rendering:
            self._paint_ground(painter)
            return
        key = (self.width(), self.height(), self.devicePixelRatioF(), self.palette_.name)
        if self._background is None or self._background[0] != key:
            self._background = (key, self._background_picture())
        painter.drawPixmap(0, 0, self._background[1])

    def _background_picture(self) -> QPixmap:
        """Border and dots; cached, because a thousand round dots take longer to draw than the sheet.

        One row of dots is drawn and laid down as often as there are rows: a view of 1700 x 1300 has 4500 of them.
        """
        ratio = self.devicePixelRatioF()
        picture = blank(self.size(), ratio)
        painter = painter_on(picture)
        self._paint_ground(painter)
        dots = self._row_of_dots(ratio)
        for y in range(GRID_STEP // 2 + (self.height() % GRID_STEP) // 2, self.height() - 4, GRID_STEP):
            painter.drawPixmap(0, y - DOT_ROW // 2, dots)
        painter.end()
        return picture

    def _paint_ground(self, painter: QPainter) -> None:
        ink(painter, self.palette_.border, fill=self.palette_.canvas)
        painter.drawRoundedRect(QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5), 7, 7)

    def _row_of_dots(self, ratio: float) -> QPixmap:
        """The dots across the view; ``ratio`` device pixels per pixel."""
        row = blank(QSize(self.width(), DOT_ROW), ratio)
        painter = painter_on(row)
        pen = QPen(QColor(self.palette_.grid), 2.0)
        pen.setCapStyle(Qt.PenCapStyle.RoundCap)
        painter.setPen(pen)
        columns = range(GRID_STEP // 2 + (self.width() % GRID_STEP) // 2, self.width() - 4, GRID_STEP)
        painter.drawPoints([QPointF(x, DOT_ROW // 2) for x in columns])
        painter.end()
        return row

    def _paint_empty(self, painter: QPainter) -> None:
        name, headline, hint = self.empty_state()
        if not headline:
            return
        margin = 16 if self.width() > NARROW else 6
        box = QRectF(self.rect()).adjusted(margin, 0, -margin, 0)
        bold = QFont(self.font())
        bold.setPointSizeF(bold.pointSizeF() * 1.15)
        bold.setWeight(QFont.Weight.DemiBold)
        flags = int(Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignTop | Qt.TextFlag.TextWordWrap)
        room = QRectF(0.0, 0.0, box.width(), 1000.0)
        painter.setFont(self.font())
        below = painter.boundingRect(room, flags, hint).height() + 6
        painter.setFont(bold)
        needed = painter.boundingRect(room, flags, headline).height() + below
        pictured = self.height() - 2 * 6 >= needed + ICON_ROOM
        if pictured:
            top = min(box.center().y() - 64, self.height() - 6 - needed - ICON_ROOM)
            picture = icons.pixmap(name, self.palette_.strong_border, ICON_EDGE, self.devicePixelRatioF())
            painter.drawPixmap(QPointF(box.center().x() - ICON_EDGE / 2, top), picture)
            top += ICON_ROOM
        else:  # in a low view words come first, and of them the headline
            top = max(0.0, box.center().y() - needed / 2)
        painter.setPen(QColor(self.palette_.text))
        used = painter.boundingRect(QRectF(box.left(), top, box.width(), 80), flags, headline)
        painter.drawText(used, flags, headline)
        painter.setFont(self.font())
        painter.setPen(QColor(self.palette_.muted))
        if used.bottom() + below <= self.height():
            painter.drawText(QRectF(box.left(), used.bottom() + 6, box.width(), 1000.0), flags, hint)


@cache
def name_roles() -> None:
    """Let screen readers call canvases so: a widget that is painted has no role of its own."""
    QAccessible.installFactory(_interface_of)


def _interface_of(_: str, of: QObject) -> QAccessibleInterface | None:
    return QAccessibleWidget(of, QAccessible.Role.Canvas) if isinstance(of, Canvas) else None
