"""Open and close the sheet: play, slider, number."""

from __future__ import annotations

import math

from PySide6.QtCore import QElapsedTimer, QSettings, QSignalBlocker, QTimer, Signal
from PySide6.QtWidgets import QHBoxLayout, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.look import icons
from kirigami_studio.gui.look.theme import LIGHT, Palette
from kirigami_studio.gui.panels.card import tool_button
from kirigami_studio.gui.panels.number_field import DecimalField, number_field
from kirigami_studio.gui.panels.play_options import PlayMode, PlayOptions, phase_of, phi_at
from kirigami_studio.gui.views.phi_slider import PhiSlider

#: Seconds from the flat sheet to fully turned while playing at the usual speed.
PLAY_SECONDS = 4.0
FRAME_MS = 16
#: Radians from the last angle at which the sheet counts as open: less than a step of the slider.
AT_LAST = 1e-3


class DeploymentBar(QWidget):
    """Sets the angle that the layout view shows."""

    phi_changed = Signal(float)  #: radians

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._palette: Palette = LIGHT
        self._phase = 0.0
        self._target = 0.0
        self._clock = QElapsedTimer()
        self.play = tool_button("play", tr("Play or pause the deployment (Space)."), checkable=True)
        self.options = PlayOptions()
        self.slider = PhiSlider()
        self.number = DecimalField()
        self.number.setObjectName("phiNumber")
        self.number.setRange(0.0, 180.0)
        self.number.setDecimals(1)
        self.number.setSuffix("°")
        self.number.setFixedWidth(82)
        number_field(self.number)
        self.number.setKeyboardTracking(False)
        self.number.setAccessibleName(tr("Deployment angle in degrees"))
        self.number.setToolTip(tr("Deployment angle φ in degrees: 180° flat, 0° fully turned"))
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        row.addWidget(self.play)
        row.addWidget(self.options)
        row.addWidget(self.slider, 1)
        row.addWidget(self.number)
        self._timer = QTimer(self)
        self._timer.setInterval(FRAME_MS)
        self._timer.timeout.connect(self._advance)
        self.play.toggled.connect(self._toggle)
        self.options.changed.connect(self._play_on)
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
        self._target = target
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
        self.options.set_palette(palette)
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
            mode, last = self.options.mode, self._last()
            self._phase = phase_of(self.slider.phi, mode, last)
            if mode is not PlayMode.SWING and phi_at(self._phase, mode, last) <= last + AT_LAST:
                self._phase = 0.0  # it stands open already: start from the flat sheet
            self._clock.start()
            self._timer.start()
        else:
            self._timer.stop()

    def _play_on(self) -> None:
        """The mode has changed: go on from where the sheet is."""
        self._phase = phase_of(self.slider.phi, self.options.mode, self._last())

    def _last(self) -> float:
        """The angle (radians) up to which the sheet is opened."""
        return self._target if self.options.to_target.isChecked() else 0.0

    def _advance(self) -> None:
        mode = self.options.mode
        swings = 2.0 if mode is PlayMode.SWING else 1.0
        self._phase += self._clock.restart() / 1000.0 * self.options.speed / (swings * PLAY_SECONDS)
        ended = mode is PlayMode.ONCE and self._phase >= 1.0
        if mode is not PlayMode.ONCE:
            self._phase %= 1.0
        self.slider.set_phi(phi_at(self._phase, mode, self._last()))
        if ended:
            self.play.setChecked(False)

    def restore(self, settings: QSettings) -> None:
        """Play as the last time."""
        self.options.restore(settings)

    def remember(self, settings: QSettings) -> None:
        """Keep how it is played for the next time."""
        self.options.remember(settings)
