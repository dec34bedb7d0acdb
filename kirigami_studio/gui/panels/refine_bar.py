"""Below the drawing board: simplify, smooth, and the target's real size."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QSlider, QStyle, QStyleOptionSlider, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.look import icons
from kirigami_studio.gui.look.theme import Palette
from kirigami_studio.gui.panels.card import tool_button
from kirigami_studio.gui.panels.number_field import LengthField, number_field
from kirigami_studio.outlines.placed import LARGEST_MM, Placed


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


#: Slider steps from nothing to most.
STEPS = 100
#: Name, caption, tooltip.
SLIDERS = (
    ("simplify", tr("S&implify"), tr("Drop points: the further to the right, the fewer corners stay")),
    ("smooth", tr("S&mooth"), tr("Round corners and calm edges; the area stays")),
)


class RefineBar(QWidget):
    """Two sliders with a live preview, two lengths in mm."""

    previewed = Signal(str, float)  #: name of the slider, strength 0..1
    refined = Signal(str, float)
    size_wanted = Signal(float, float)  #: width and height, mm

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(8)
        self._ratio = 1.0
        self._size = (0.0, 0.0)
        self.sliders: dict[str, QSlider] = {}
        for name, caption, tip in SLIDERS:
            slider = GrooveSlider()
            slider.setObjectName("threshold")
            slider.setRange(0, STEPS)
            slider.setPageStep(STEPS // 10)
            slider.setAccessibleName(tr("{replace} the target", replace=caption.replace("&", "")))
            slider.setToolTip(tip)
            slider.setMinimumWidth(60)
            slider.valueChanged.connect(lambda value, name=name: self._slide(name, value))
            slider.sliderReleased.connect(lambda name=name: self._settle(name))
            self.sliders[name] = slider
            row.addWidget(_caption(caption, slider))
            row.addWidget(slider, 1)
        self.width_ = _length(tr("Width of the target"))
        self.height_ = _length(tr("Height of the target"))
        for caption, field in ((tr("Size"), self.width_), ("\N{MULTIPLICATION SIGN}", self.height_)):
            row.addWidget(_caption(caption, field))
            row.addWidget(field)
        self.proportions = tool_button("keepProportions", tr("Keep proportions. Off: width or height alone."), True)
        self.proportions.setChecked(True)
        row.addWidget(self.proportions)
        self.width_.valueChanged.connect(self._take_width)
        self.height_.valueChanged.connect(self._take_height)

    def _take_width(self, width: float) -> None:
        self.size_wanted.emit(width, width / self._ratio if self.proportions.isChecked() else self._size[1])

    def _take_height(self, height: float) -> None:
        self.size_wanted.emit(height * self._ratio if self.proportions.isChecked() else self._size[0], height)

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self.proportions.setIcon(icons.icon("chain", palette))

    def show_placed(self, placed: Placed | None) -> None:
        """Show the target's size on the board."""
        self.setEnabled(placed is not None)
        if placed is None:
            return
        width, height = self._size = placed.size
        self._ratio = width / height
        for field, value in ((self.width_, width), (self.height_, height)):
            with QSignalBlocker(field):
                field.setValue(value)

    def restart(self) -> None:
        """The sliders stand for another target: nothing is simplified or smoothed yet."""
        for slider in self.sliders.values():
            with QSignalBlocker(slider):
                slider.setValue(0)

    def _slide(self, name: str, value: int) -> None:
        for other, slider in self.sliders.items():
            if other != name:
                with QSignalBlocker(slider):
                    slider.setValue(0)
        if self.sliders[name].isSliderDown():
            self.previewed.emit(name, value / STEPS)
        else:
            self.refined.emit(name, value / STEPS)

    def _settle(self, name: str) -> None:
        self.refined.emit(name, self.sliders[name].value() / STEPS)


def _caption(text: str, buddy: QWidget) -> QLabel:
    label = QLabel(text)
    label.setObjectName("muted")
    label.setBuddy(buddy)
    return label


def _length(name: str) -> LengthField:
    field = LengthField()
    field.setRange(0.1, LARGEST_MM)
    field.setDecimals(1)
    field.setSuffix(tr(" mm"))
    number_field(field)
    field.setKeyboardTracking(False)
    field.setAccessibleName(name)
    field.setToolTip(
        tr("{name} in mm; 3 in or 8.5 cm may be typed too. The chain beside it keeps the proportions.", name=name)
    )
    return field
