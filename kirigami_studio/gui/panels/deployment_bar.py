"""Open and close the sheet: play, slider, number."""

from __future__ import annotations

import math

from PySide6.QtCore import QElapsedTimer, QSignalBlocker, QTimer, Signal
from PySide6.QtWidgets import QDoubleSpinBox, QHBoxLayout, QWidget

from kirigami_studio.gui import icons
from kirigami_studio.gui.panels.card import tool_button
from kirigami_studio.gui.panels.number_field import number_field
from kirigami_studio.gui.theme import LIGHT, Palette
from kirigami_studio.gui.views.phi_slider import PhiSlider

#: Seconds from the flat sheet to fully turned while playing.
PLAY_SECONDS = 4.0
#: Part of a whole swing during which playing rests at each end, to let the eye arrive.
REST = 0.08
FRAME_MS = 16


class DeploymentBar(QWidget):
    """Sets the angle that the layout view shows."""

    phi_changed = Signal(float)  #: radians

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._palette: Palette = LIGHT
        self._phase = 0.0
        self._clock = QElapsedTimer()
        self.play = tool_button("play", "Play or pause the deployment (Space).", checkable=True)
        self.slider = PhiSlider()
        self.number = QDoubleSpinBox()
        self.number.setObjectName("phiNumber")
        self.number.setRange(0.0, 180.0)
        self.number.setDecimals(1)
        self.number.setSuffix("°")
        self.number.setFixedWidth(92)
        number_field(self.number)
        self.number.setKeyboardTracking(False)
        self.number.setAccessibleName("Deployment angle in degrees")
        self.number.setToolTip("Deployment angle φ in degrees: 180° flat, 0° fully turned")
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(8)
        row.addWidget(self.play)
        row.addWidget(self.slider, 1)
        row.addWidget(self.number)
        self._timer = QTimer(self)
        self._timer.setInterval(FRAME_MS)
        self._timer.timeout.connect(self._advance)
        self.play.toggled.connect(self._toggle)
        self.slider.phi_changed.connect(self._tell)
        self.number.valueChanged.connect(lambda degrees: self.set_phi(math.radians(degrees)))
        self._tell(self.slider.phi)
        self.set_ready(False)

    @property
    def playing(self) -> bool:
        return self._timer.isActive()

    def set_phi(self, phi: float) -> None:
        """Show another angle, radians."""
        self.slider.set_phi(phi)

    def set_marks(self, target: float, contact: float | None) -> None:
        """Mark the target angle and the first contact, radians."""
        self.slider.set_marks(target, contact)

    def set_ready(self, ready: bool) -> None:
        """Whether there is a design to move."""
        if not ready:
            self.play.setChecked(False)
        for part in (self.play, self.slider, self.number):
            part.setEnabled(ready)

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self._palette = palette
        self.slider.set_palette(palette)
        self._dress_button()

    def _dress_button(self) -> None:
        self.play.setIcon(icons.icon("pause" if self.play.isChecked() else "play", self._palette))

    def _tell(self, phi: float) -> None:
        with QSignalBlocker(self.number):
            self.number.setValue(math.degrees(phi))
        self.phi_changed.emit(phi)

    def _toggle(self, playing: bool) -> None:
        self._dress_button()
        if playing:
            self._phase = phase_of(self.slider.phi)
            self._clock.start()
            self._timer.start()
        else:
            self._timer.stop()

    def _advance(self) -> None:
        self._phase = (self._phase + self._clock.restart() / 1000.0 / (2.0 * PLAY_SECONDS)) % 1.0
        self.slider.set_phi(phi_at(self._phase))


def phi_at(phase: float) -> float:
    """Angle (radians) in a swing from pi (phase 0) to 0 (phase 1/2) and back, with a rest at both ends."""
    there = 1.0 - abs(2.0 * (phase % 1.0) - 1.0)
    eased = min(max((there - REST) / (1.0 - 2.0 * REST), 0.0), 1.0)
    return math.pi * (1.0 - eased)


def phase_of(phi: float) -> float:
    """Phase on the opening half of the swing that shows ``phi``; a fully turned sheet closes next."""
    return 0.5 * (REST + (1.0 - 2.0 * REST) * (1.0 - phi / math.pi))
