"""Play the job: step slider, play, time and length so far."""

from __future__ import annotations

from PySide6.QtCore import QElapsedTimer, Qt, QTimer, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QSlider, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.look import icons
from kirigami_studio.gui.look.readable import readable_length, readable_time
from kirigami_studio.gui.look.theme import LIGHT, Palette
from kirigami_studio.gui.panels.card import tool_button
from kirigami_studio.gui.scene.cut_items import CutSteps

#: Seconds in which a whole job is played, however long it takes to cut.
PLAY_SECONDS = 12.0
FRAME_MS = 16


class CutBar(QWidget):
    """Sets how much of the job the cut view shows."""

    step_changed = Signal(int)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._palette: Palette = LIGHT
        self._steps: CutSteps | None = None
        self._seconds = 0.0
        self._clock = QElapsedTimer()
        self.play = tool_button("playCuts", tr("Play or pause the cutting (Space)."), checkable=True)
        self.slider = QSlider(Qt.Orientation.Horizontal)
        self.slider.setObjectName("cutStep")
        self.slider.setAccessibleName(tr("Cuts made so far"))
        self.slider.setToolTip(
            tr("Cuts made so far, in cutting order (arrow keys: one cut; Home and End: none and all)")
        )
        self.slider.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.count, self.so_far = QLabel(), QLabel()
        for label, name in ((self.count, tr("Cuts so far")), (self.so_far, tr("Time and cut length so far"))):
            label.setObjectName("muted")
            label.setAccessibleName(name)
            label.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(8)
        row.addWidget(self.play)
        row.addWidget(self.slider, 1)
        row.addWidget(self.count)
        row.addWidget(self.so_far)
        self._timer = QTimer(self)
        self._timer.setInterval(FRAME_MS)
        self._timer.timeout.connect(self._advance)
        self.play.toggled.connect(self._toggle)
        self.slider.valueChanged.connect(self._tell)
        self.set_steps(None)

    @property
    def playing(self) -> bool:
        return self._timer.isActive()

    def set_steps(self, steps: CutSteps | None) -> None:
        """Another job, shown as cut to its end; None when there is nothing to play."""
        self.play.setChecked(False)
        self._steps = steps
        for part in (self.play, self.slider):
            part.setEnabled(steps is not None)
        last = 0 if steps is None else steps.last
        self.slider.setRange(0, last)
        self.slider.setPageStep(max(last // 10, 1))
        self.slider.setValue(last)
        self._show_numbers()

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self._palette = palette
        self._dress_button()

    def _dress_button(self) -> None:
        self.play.setIcon(icons.icon("pause" if self.play.isChecked() else "play", self._palette))

    def _tell(self, step: int) -> None:
        self._show_numbers()
        self.step_changed.emit(step)

    def _show_numbers(self) -> None:
        """The numbers keep their places while they grow."""
        steps = self._steps
        if steps is None:
            self.count.clear()
            self.so_far.clear()
            return
        step = self.slider.value()
        self.count.setText(f"{step} / {steps.last}")
        self.so_far.setText(f"{readable_time(steps.seconds[step])}  ·  {readable_length(steps.length_mm[step])}")
        metrics = self.fontMetrics()
        widest = f"{readable_time(99.0)}  ·  {readable_length(99_990.0)}"
        self.count.setMinimumWidth(metrics.horizontalAdvance(f"{steps.last} / {steps.last}"))
        self.so_far.setMinimumWidth(metrics.horizontalAdvance(widest))

    def _toggle(self, playing: bool) -> None:
        self._dress_button()
        if playing and self._steps is not None:
            at_end = self.slider.value() == self._steps.last
            self._seconds = 0.0 if at_end else float(self._steps.seconds[self.slider.value()])
            self._clock.start()
            self._timer.start()
        else:
            self._timer.stop()

    def _advance(self) -> None:
        """Follow the job's own time, so that long cuts take longer than short ones."""
        steps = self._steps
        if steps is None:
            return
        self._seconds += self._clock.restart() / 1000.0 * float(steps.seconds[-1]) / PLAY_SECONDS
        self.slider.setValue(steps.at(self._seconds))
        if self._seconds >= steps.seconds[-1]:
            self.play.setChecked(False)
