"""Where a picture is divided into shape and ground: a slider that the contour follows."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QSlider, QWidget

from kirigami_studio.foundation.words import tr

#: Slider steps from black to white; the ends would leave no shape.
STEPS = 200


class ThresholdBar(QWidget):
    """Shown for targets that came from a picture; grey levels run from 0 (black) to 1 (white)."""

    changed = Signal(float)  #: grey level 0..1
    automatic_wanted = Signal()
    edited = Signal()  #: the drag is over

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        caption = QLabel(tr("&Threshold"))
        caption.setObjectName("muted")
        self.slider = QSlider(Qt.Orientation.Horizontal)
        self.slider.setObjectName("threshold")
        self.slider.setRange(1, STEPS - 1)
        self.slider.setPageStep(STEPS // 20)
        self.slider.setAccessibleName(tr("Threshold between shape and ground, from black to white"))
        self.slider.setToolTip(
            tr("Grey level that divides shape and ground: 0 % is black, 100 % white (arrow keys: 0.5 %)")
        )
        self.number = QLabel()
        self.number.setObjectName("muted")
        self.number.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self.number.setMinimumWidth(self.number.fontMetrics().horizontalAdvance("99.5 %"))
        self.automatic = QPushButton(tr("Auto"))
        self.automatic.setObjectName("small")
        self.automatic.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.automatic.setToolTip(tr("Back to the threshold that was found in the picture"))
        caption.setBuddy(self.slider)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(8)
        row.addWidget(caption)
        row.addWidget(self.slider, 1)
        row.addWidget(self.number)
        row.addWidget(self.automatic)
        self.slider.valueChanged.connect(self._tell)
        self.slider.sliderReleased.connect(self.edited)
        self.automatic.clicked.connect(self.automatic_wanted)

    def show_levels(self, threshold: float, automatic: float) -> None:
        """Show the level that holds, 0..1; a slider under the hand is left where it is."""
        if not self.slider.isSliderDown():
            with QSignalBlocker(self.slider):
                self.slider.setValue(round(STEPS * threshold))
            self.number.setText(f"{100 * threshold:.1f} %")
        self.automatic.setEnabled(threshold != automatic)

    def _tell(self, value: int) -> None:
        self.number.setText(f"{100 * value / STEPS:.1f} %")
        self.changed.emit(value / STEPS)
        if not self.slider.isSliderDown():
            self.edited.emit()
