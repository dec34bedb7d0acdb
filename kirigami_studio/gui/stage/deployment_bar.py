"""Open and close the sheet: play, how it is played, slider, number."""

from __future__ import annotations

import math
from enum import Enum

from PySide6.QtCore import QElapsedTimer, QSettings, QSignalBlocker, Qt, QTimer, Signal
from PySide6.QtGui import QAction, QActionGroup, QResizeEvent
from PySide6.QtWidgets import QGridLayout, QMenu, QToolButton, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.stage.phi_slider import PhiSlider
from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.widgets.card import TOOL_ICON, SwitchButton, ToolButton
from kirigami_studio.gui.widgets.number_field import DecimalField, decimal_field
from kirigami_studio.gui.widgets.theme import LIGHT, Palette

#: Seconds from the flat sheet to fully turned while playing at the usual speed.
PLAY_SECONDS = 4.0
FRAME_MS = 16
#: A bar narrower than this (pixels) has its slider below the buttons.
NARROW = 380
#: Radians from the last angle at which the sheet counts as open: less than a step of the slider.
AT_LAST = 1e-3
#: Part of a whole swing during which playing rests at each end, to let the eye arrive.
REST = 0.08
#: How many times faster than usual the deployment may be played.
SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0)


class PlayMode(Enum):
    """What happens when the sheet has opened."""

    SWING = "swing"  #: it closes again
    LOOP = "loop"  #: it starts again from the flat sheet
    ONCE = "once"  #: it stays


MODE_ICONS = {PlayMode.SWING: "swing", PlayMode.LOOP: "loop", PlayMode.ONCE: "once"}


def phi_at(phase: float, mode: PlayMode = PlayMode.SWING, last: float = 0.0) -> float:
    """Angle (radians) at a phase (0..1): from pi to ``last``, and back when swinging, with a rest at both ends.

    A swing is open at phase 1/2, the others at 1.
    """
    there = 1.0 - abs(2.0 * (phase % 1.0) - 1.0) if mode is PlayMode.SWING else min(max(phase, 0.0), 1.0)
    eased = min(max((there - REST) / (1.0 - 2.0 * REST), 0.0), 1.0)
    return math.pi - eased * (math.pi - last)


def phase_of(phi: float, mode: PlayMode = PlayMode.SWING, last: float = 0.0) -> float:
    """Phase while opening that shows ``phi``; angles past ``last`` count as open."""
    opened = min((math.pi - phi) / (math.pi - last), 1.0)
    there = REST + (1.0 - 2.0 * REST) * opened
    return 0.5 * there if mode is PlayMode.SWING else there


class DeploymentBar(QWidget):
    """Sets the angle that the layout view shows."""

    phi_changed = Signal(float)  #: radians

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._phase = 0.0
        self._target = 0.0
        self._clock = QElapsedTimer()
        self.play = ToolButton("play", "play", tr("Play or pause the deployment (Space)."), checkable=True)
        self.options = PlayOptions()
        self.slider = PhiSlider()
        tip = tr("As cut: show the panels with their bows and connectors, as they are cut (Shift+C).")
        self.as_cut_button = SwitchButton("asCutSwitch", "connector", tip)
        self.as_cut_button.hide()  # shown where a sheet is drawn as it is cut
        self.as_cut = self.as_cut_button.switch
        self.as_cut.setChecked(True)
        self.ideal = QToolButton()
        self.ideal.setText(tr("Ideal"))
        self.ideal.setObjectName("ideal")
        self.ideal.setCheckable(True)
        self.ideal.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.ideal.setToolTip(tr("Ideal: go on beyond the jam, as connectors of no width would (Shift+J)."))
        self.ideal.setAccessibleName(tr("Ideal motion beyond the jam"))
        self.ideal.hide()
        self.number = decimal_field(
            DecimalField,
            "phiNumber",
            0.0,
            180.0,
            suffix="°",
            accessible=tr("Deployment angle in degrees"),
            tip=tr("Deployment angle φ in degrees: 180° flat, 0° fully turned"),
            width=82,
        )
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(0, 0, 0, 0)
        self._grid.setSpacing(4)
        self._grid.setColumnStretch(2, 1)
        for place, part in enumerate((self.play, self.options, None, self.as_cut_button, self.ideal, self.number)):
            if part is not None:
                self._grid.addWidget(part, 0, place)
        self._grid.addWidget(self.slider, 0, 2)
        self._timer = QTimer(self)
        self._timer.setInterval(FRAME_MS)
        self._timer.timeout.connect(self._advance)
        self.play.toggled.connect(self._toggle)
        self.options.changed.connect(self._play_on)
        self.slider.phi_changed.connect(self._on_phi)
        self.ideal.toggled.connect(self.slider.set_ideal)
        self.number.valueChanged.connect(lambda degrees: self.set_phi(math.radians(degrees)))
        self._on_phi(self.slider.phi)
        self.set_ready(False)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        """In a narrow bar the slider has a line of its own."""
        super().resizeEvent(event)
        place = (1, 0, 1, 6) if self.width() < NARROW else (0, 2, 1, 1)
        if self._grid.getItemPosition(self._grid.indexOf(self.slider)) != place:
            self._grid.removeWidget(self.slider)
            self._grid.addWidget(self.slider, *place)

    @property
    def playing(self) -> bool:
        return self._timer.isActive()

    def set_phi(self, phi: float) -> None:
        """Show another angle, radians."""
        self.slider.set_phi(phi)

    def set_marks(self, target: float, contact: float | None, second: float | None = None) -> None:
        """Mark the target angle, the first contact and the angle of a second target, radians."""
        self._target = target
        self.slider.set_marks(target, contact, second)

    def set_jam(self, jam: float | None) -> None:
        """Mark the angle (radians) at which the sheet jams as cut; None where it does not, or nothing is known."""
        self.slider.set_jam(jam)
        self.ideal.setVisible(jam is not None)

    def set_ready(self, ready: bool) -> None:
        """Whether there is a design to move."""
        if not ready:
            self.play.setChecked(False)
        for part in (self.play, self.slider, self.number):
            part.setEnabled(ready)

    def _on_phi(self, phi: float) -> None:
        with QSignalBlocker(self.number):
            self.number.setValue(math.degrees(phi))
        self.phi_changed.emit(phi)

    def _toggle(self, playing: bool) -> None:
        self.play.show_icon("pause" if self.play.isChecked() else "play")
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
        """Play as the last time, and show as much of the cuts."""
        self.options.restore(settings)
        self.as_cut.setChecked(settings.value("asCut") != "no")

    def remember(self, settings: QSettings) -> None:
        """Keep how it is played and shown for the next time."""
        self.options.remember(settings)
        settings.setValue("asCut", "yes" if self.as_cut.isChecked() else "no")


class PlayOptions(QToolButton):
    """A button with a menu; it shows the mode, and the speed when that is not the usual one."""

    changed = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._palette: Palette = LIGHT
        self.setObjectName("playOptions")
        self.setIconSize(TOOL_ICON)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.setAccessibleName(tr("Play options"))
        menu = QMenu(self)
        menu.setToolTipsVisible(True)
        self.modes: dict[PlayMode, QAction] = {}
        self.speeds: dict[float, QAction] = {}
        words = {
            PlayMode.SWING: (tr("Back and for&th"), tr("Open and close repeatedly")),
            PlayMode.LOOP: (tr("&Loop"), tr("Open repeatedly from flat")),
            PlayMode.ONCE: (tr("O&nce"), tr("Open once and stop")),
        }
        modes, speeds = QActionGroup(self), QActionGroup(self)
        for mode, (text, tip) in words.items():
            self.modes[mode] = self._add(menu, modes, text, tip, mode is PlayMode.SWING)
        menu.addSeparator()
        for speed in SPEEDS:
            text = tr("{speed:g}\N{MULTIPLICATION SIGN}", speed=speed)
            tip = tr("{speed:g}\N{MULTIPLICATION SIGN} normal speed", speed=speed)
            self.speeds[speed] = self._add(menu, speeds, text, tip, speed == 1.0)
        menu.addSeparator()
        self.to_target = menu.addAction(tr("&Only to the target angle"))
        self.to_target.setCheckable(True)
        self.to_target.toggled.connect(self._on_choice)
        self.setMenu(menu)
        self._on_choice()

    def _add(self, menu: QMenu, group: QActionGroup, text: str, tip: str, checked: bool) -> QAction:
        """Offer one of several choices."""
        action = menu.addAction(text)
        action.setToolTip(tip)
        action.setCheckable(True)
        action.setActionGroup(group)
        action.setChecked(checked)
        action.toggled.connect(self._on_choice)
        return action

    @property
    def mode(self) -> PlayMode:
        return next(mode for mode, action in self.modes.items() if action.isChecked())

    @property
    def speed(self) -> float:
        """Times the usual speed."""
        return next(speed for speed, action in self.speeds.items() if action.isChecked())

    def next_mode(self) -> None:
        """Go to the next mode, after the last one to the first."""
        modes = list(self.modes)
        self.modes[modes[(modes.index(self.mode) + 1) % len(modes)]].setChecked(True)

    def change_speed(self, step: int) -> None:
        """Play ``step`` speeds faster, or slower when it is negative."""
        place = min(max(SPEEDS.index(self.speed) + step, 0), len(SPEEDS) - 1)
        self.speeds[SPEEDS[place]].setChecked(True)

    def set_palette(self, palette: Palette) -> None:
        self._palette = palette
        for mode, action in self.modes.items():
            action.setIcon(icons.icon(MODE_ICONS[mode], palette))
        self._on_choice()

    def restore(self, settings: QSettings) -> None:
        """Play as the last time."""
        for mode, action in self.modes.items():
            if settings.value("playMode") == mode.value:
                action.setChecked(True)
        for speed, action in self.speeds.items():
            if settings.value("playSpeed") == f"{speed:g}":
                action.setChecked(True)
        self.to_target.setChecked(settings.value("playToTarget") == "yes")

    def remember(self, settings: QSettings) -> None:
        """Keep the choice for the next time."""
        settings.setValue("playMode", self.mode.value)
        settings.setValue("playSpeed", f"{self.speed:g}")
        settings.setValue("playToTarget", "yes" if self.to_target.isChecked() else "no")

    def _on_choice(self, on: bool = True) -> None:
        if not on and self.sender() is not self.to_target:
            return  # of two choices that trade places only the new one counts
        usual = self.speed == 1.0
        self.setText("" if usual else tr("{speed:g}\N{MULTIPLICATION SIGN}", speed=self.speed))
        beside, only = Qt.ToolButtonStyle.ToolButtonTextBesideIcon, Qt.ToolButtonStyle.ToolButtonIconOnly
        self.setToolButtonStyle(only if usual else beside)
        self.setIcon(icons.icon(MODE_ICONS[self.mode], self._palette))
        self.setToolTip(_playing(self.mode, self.speed))
        self.changed.emit()


def _playing(mode: PlayMode, speed: float) -> str:
    """How the deployment is played, and the keys that change it."""
    if mode is PlayMode.SWING:
        return tr(
            "Back and forth at {speed:g}\N{MULTIPLICATION SIGN} speed. < and > change the speed, Shift+P the mode.",
            speed=speed,
        )
    if mode is PlayMode.LOOP:
        return tr(
            "Loop at {speed:g}\N{MULTIPLICATION SIGN} speed. < and > change the speed, Shift+P the mode.", speed=speed
        )
    return tr(
        "Once at {speed:g}\N{MULTIPLICATION SIGN} speed. < and > change the speed, Shift+P the mode.", speed=speed
    )
