"""What lies at the two ends of the slider: the flat sheet and the opened one, with pictures, sizes and matches."""

from __future__ import annotations

from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QAbstractButton, QHBoxLayout, QSizePolicy, QWidget

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.designs.two_states import State, TwoStates
from kirigami_studio.gui.look.theme import LIGHT, Palette
from kirigami_studio.gui.scene.target_items import paint_start_shape, paint_target_shape
from kirigami_studio.gui.scene.view_transform import Bounds, ViewTransform

#: Edge of a picture (pixels), and room between it and the words.
PICTURE, GAP = 20, 9


class EndsLine(QWidget):
    """Two buttons below the slider; each names an end of the motion and goes there."""

    flat_wanted = Signal()
    open_wanted = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.start = EndButton("flatEnd", sheet=True)
        self.target = EndButton("openEnd", sheet=False)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(10)
        row.addWidget(self.start, 1)
        row.addWidget(self.target, 1)
        self._named = self._low = False
        self.start.clicked.connect(self.flat_wanted)
        self.target.clicked.connect(self.open_wanted)
        self.show_states(None)

    def show_states(self, states: TwoStates | None) -> None:
        """Name both ends of a design; nothing without one."""
        self._named = states is not None
        self.setVisible(self._named and not self._low)
        if states is None:
            return
        flat, opened = states.lines()
        self.start.show_state(states.start, tr("{state}. Click to close the sheet.", state=flat))
        self.target.show_state(states.target, tr("{state}. Click to open the sheet.", state=opened))

    def set_low(self, low: bool) -> None:
        """Leave room to the drawing in a low panel; the status line tells both matches, too."""
        self._low = low
        self.setVisible(self._named and not self._low)


class EndButton(QAbstractButton):
    """A small outline and the longest text that fits: the start at the left, the target at the right."""

    def __init__(self, name: str, sheet: bool) -> None:
        super().__init__()
        self.setObjectName(name)
        self._is_sheet = sheet
        self._state: State | None = None
        self._palette: Palette = LIGHT
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setCursor(Qt.CursorShape.PointingHandCursor)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)

    def show_state(self, state: State, tip: str) -> None:
        """Show another end."""
        self._state = state
        self.setToolTip(tip)
        self.setAccessibleName(state.texts()[0])
        self.setAccessibleDescription(tip)
        self.update()

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self._palette = palette
        self.update()

    def sizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return QSize(160, PICTURE + 4)

    def drawn_text(self) -> str:
        """What is shown at the present width."""
        if self._state is None:
            return ""
        metrics, room, texts = self.fontMetrics(), self.width() - PICTURE - GAP - 4, self._state.texts()
        fitting = next((text for text in texts if metrics.horizontalAdvance(text) <= room), texts[-1])
        return metrics.elidedText(fitting, Qt.TextElideMode.ElideRight, room)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        if self._state is None:
            return
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self.hasFocus() or self.underMouse():
            painter.setPen(QPen(QColor(self._palette.accent if self.hasFocus() else self._palette.border), 1.0))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRoundedRect(QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5), 5, 5)
        left = 2.0 if self._is_sheet else self.width() - PICTURE - 2.0
        paint_end(painter, QRectF(left, 2.0, PICTURE, PICTURE), self._state.outline, self._is_sheet, self._palette)
        painter.setPen(QColor(self._palette.muted))
        words = QRectF(self.rect()).adjusted(PICTURE + GAP, 0, 0, 0)
        side = Qt.AlignmentFlag.AlignLeft
        if not self._is_sheet:
            words, side = QRectF(self.rect()).adjusted(0, 0, -PICTURE - GAP, 0), Qt.AlignmentFlag.AlignRight
        painter.drawText(words, int(side | Qt.AlignmentFlag.AlignVCenter), self.drawn_text())
        painter.end()


def paint_end(painter: QPainter, box: QRectF, outline: FloatArray, sheet: bool, palette: Palette) -> None:
    """Draw an outline (P, 2), y up, as large as fits: a sheet is blue, a target orange."""
    transform = ViewTransform.fitting(Bounds.of(outline), box, 1.0)
    paint = paint_start_shape if sheet else paint_target_shape
    paint(painter, transform.to_pixels(outline), palette, 1.4)
