"""A slider whose groove is as good as its handle: a press anywhere takes hold, and only letting go settles."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QSlider, QStyle, QStyleOptionSlider


class GrooveSlider(QSlider):
    """Goes to the pointer at once and stays down until the button is let go, so that a click shows before it counts."""

    def __init__(self) -> None:
        super().__init__(Qt.Orientation.Horizontal)
        self._offset = 0.0

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        if event.button() is not Qt.MouseButton.LeftButton:
            event.ignore()
            return
        option = QStyleOptionSlider()
        self.initStyleOption(option)
        handle = self.style().subControlRect(
            QStyle.ComplexControl.CC_Slider, option, QStyle.SubControl.SC_SliderHandle, self
        )
        on_handle = handle.contains(event.position().toPoint())
        self._offset = event.position().x() - handle.left() if on_handle else 0.5 * handle.width()
        self.setSliderDown(True)
        if not on_handle:
            self.setValue(self._value_at(event.position().x(), handle.width()))
        event.accept()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        if self.isSliderDown():
            option = QStyleOptionSlider()
            self.initStyleOption(option)
            width = self.style().pixelMetric(QStyle.PixelMetric.PM_SliderLength, option, self)
            self.setValue(self._value_at(event.position().x(), width))
            event.accept()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        if self.isSliderDown() and event.button() is Qt.MouseButton.LeftButton:
            self.setSliderDown(False)
            event.accept()

    def _value_at(self, x: float, handle: int) -> int:
        return QStyle.sliderValueFromPosition(
            self.minimum(), self.maximum(), round(x - self._offset), max(self.width() - handle, 1)
        )
