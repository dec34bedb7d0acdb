"""A guided tour: six bubbles at the real controls, each of which moves on once the user has done its step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from PySide6.QtCore import QEvent, QObject, QPoint, QRect, Qt, QTimer, SignalInstance
from PySide6.QtGui import QShortcut
from PySide6.QtWidgets import QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.controller import Controller
from kirigami_studio.gui.views.callout import Callout, Ring

if TYPE_CHECKING:
    from kirigami_studio.gui.main_window import MainWindow

Anchor = Callable[[], QWidget]


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """One bubble.

    Attributes
    ----------
    anchor : callable
        The control it points at, as it is now.
    title, text : str
    done : tuple of signals
        Any of them means that the user has done it.
    """

    anchor: Anchor
    title: str
    text: str
    done: tuple[SignalInstance, ...]


def steps_of(window: MainWindow, controller: Controller) -> tuple[Step, ...]:
    """The tour of one window, in the order of the work."""
    stage, slider = window.stage, window.stage.deployment.slider
    return (
        Step(
            lambda: window.target,
            tr("Choose a target"),
            tr("Draw one (D), open a picture or drawing (Ctrl+O), or choose one from the library (Ctrl+L)."),
            (controller.targeting.replaced,),
        ),
        Step(
            lambda: window.run.generate,
            tr("Generate designs"),
            tr("Generate (Ctrl+G): the model makes several designs and fits each one to the target."),
            (controller.run.started,),
        ),
        Step(
            lambda: window.gallery,
            tr("Compare"),
            tr(
                "Designs arrive best first. Each card shows the match, how even the panels are, and the flat sheet. "
                "Click one, or press PgDown."
            ),
            (window.gallery.view.chosen,),
        ),
        Step(
            lambda: stage.deployment,
            tr("Open the sheet"),
            tr("Drag the angle from 180° (flat) to the target, or press Space to play. Contacts are yellow."),
            (slider.sliderPressed, slider.actionTriggered, stage.deployment.play.toggled),
        ),
        Step(
            lambda: stage.cuts_switch,
            tr("Check the cuts"),
            tr("Cuts (C) shows the cut plan in cutting order. Click a connector to change its width in mm."),
            (stage.cuts_switch.clicked,),
        ),
        Step(
            lambda: _shown(window.fabrication.export, window.fabrication),
            tr("Export"),
            tr("Choose a material and a width, then export a DXF (Ctrl+E). The file is read back and checked."),
            (controller.cutting.exported,),
        ),
    )


def _shown(wanted: QWidget, otherwise: QWidget) -> QWidget:
    return wanted if wanted.isVisible() else otherwise


class Tour(QObject):
    """Shows one step after another; the window stays usable meanwhile."""

    def __init__(self, window: MainWindow, controller: Controller) -> None:
        super().__init__(window)
        self.window = window
        self.steps = steps_of(window, controller)
        self.at = -1
        self.ring = Ring(window)
        self.callout = Callout(window)
        self.callout.next_wanted.connect(lambda: self._go(self.at + 1))
        self.callout.back_wanted.connect(lambda: self._go(self.at - 1))
        self.callout.skip_wanted.connect(self.end)
        self._soon = QTimer(self)  # panels that fold or grow settle first
        self._soon.setSingleShot(True)
        self._soon.setInterval(0)
        self._soon.timeout.connect(self._place)
        window.target.editing_changed.connect(lambda _: self._soon.start() if self.running else None)
        self._cancel = window.commands["cancel"]
        self._escape = QShortcut(Qt.Key.Key_Escape, window, self.end)
        self._cancel.changed.connect(self._share_escape)
        self._share_escape()
        for number, step in enumerate(self.steps):
            for signal in step.done:
                signal.connect(lambda *_, number=number: self._happened(number))

    @property
    def running(self) -> bool:
        return self.at >= 0

    def start(self) -> None:
        """Begin with the first step, or go back to it."""
        self.window.installEventFilter(self)
        self._go(0)
        self.callout.setFocus(Qt.FocusReason.OtherFocusReason)

    def end(self) -> None:
        """End the tour."""
        self.at = -1
        self._soon.stop()
        self._share_escape()
        self.window.removeEventFilter(self)
        had_focus = self.callout.isAncestorOf(self.window.focusWidget() or self.window) or self.callout.hasFocus()
        self.callout.hide()
        self.ring.hide()
        if had_focus:
            self.window.stage.view.setFocus()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        if event.type() in (QEvent.Type.Resize, QEvent.Type.LayoutRequest, QEvent.Type.PaletteChange):
            self._soon.start()
        return False

    def _happened(self, number: int) -> None:
        if self.at == number:
            self._go(number + 1)

    def _go(self, number: int) -> None:
        if not 0 <= number < len(self.steps):
            self.end()
            return
        self.at = number
        self._share_escape()
        step = self.steps[number]
        self.callout.say(step.title, step.text, number + 1, len(self.steps))
        self._place()
        self._soon.start()

    def _place(self) -> None:
        """Stand next to the control; hide while the drawing board takes the whole window."""
        if not self.running:
            return
        anchor = self.steps[self.at].anchor()
        self.callout.palette_ = self.ring.palette_ = self.window.palette_
        if self.window.target.editing or not anchor.isVisible():
            self.callout.hide()
            self.ring.hide()
            return
        place = QRect(anchor.mapTo(self.window, QPoint()), anchor.size())
        self.ring.surround(place)
        self.callout.point_at(place)

    def _share_escape(self) -> None:
        """Esc cancels what is being computed first, and ends the tour when there is nothing to cancel."""
        self._escape.setEnabled(self.running and not self._cancel.isEnabled())
