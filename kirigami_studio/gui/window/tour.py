"""A guided tour: six bubbles at the real controls, each of which moves on once the user has done its step.

It is a tour over a design.  Where there is none, and nothing that could be lost, the bundled sample is borrowed for as
long as the tour takes; whoever changes it keeps it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QEvent, QObject, QPoint, QRect, Qt, QTimer, SignalInstance
from PySide6.QtGui import QAction, QShortcut
from PySide6.QtWidgets import QWidget

from kirigami_studio.foundation.resources import resource
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.stage.empty_stage import moves
from kirigami_studio.gui.widgets.callout import Callout, Ring
from kirigami_studio.gui.window.appearance import Appearance
from kirigami_studio.gui.window.columns import Columns
from kirigami_studio.gui.window.services import Services
from kirigami_studio.project.document import Document

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
    enter, leave : callable or None
        What the window does by itself as the step begins and ends.
    """

    anchor: Anchor
    title: str
    text: str
    done: tuple[SignalInstance, ...]
    enter: Callable[[], None] | None = None
    leave: Callable[[], None] | None = None


def steps_of(columns: Columns, services: Services) -> tuple[Step, ...]:
    """The tour of one window, in the order of the work."""
    stage, slider = columns.stage, columns.stage.deployment.slider
    return (
        Step(
            lambda: columns.target,
            tr("Choose a target"),
            tr(
                "Draw one (D), open a picture or drawing (Ctrl+O), or choose one from the library (Ctrl+L). Below it, "
                "type how large the opened shape is to be."
            ),
            (services.targeting.replaced,),
        ),
        Step(
            lambda: columns.run.generate,
            tr("Generate designs"),
            tr(
                "Choose the material, then Generate (Ctrl+G): the model makes several designs and fits each one to the "
                "target."
            ),
            (services.run.started,),
        ),
        Step(
            lambda: columns.gallery,
            tr("Compare"),
            tr(
                "Designs arrive best first. Each card shows the match, how even the panels are, and the flat sheet. "
                "Click one, or press PgDown."
            ),
            (columns.gallery.view.chosen,),
        ),
        Step(
            lambda: stage.deployment,
            tr("Open the sheet"),
            tr(
                "This is how it opens. Drag the angle yourself, from 180° (flat) to the target, or press Space to play "
                "and pause. Contacts are yellow."
            ),
            (slider.sliderPressed, slider.actionTriggered, stage.deployment.play.toggled),
            enter=lambda: _open_sheet(columns, services),
            leave=lambda: _show_opened(columns, services),
        ),
        Step(
            lambda: stage.cuts_switch,
            tr("Check the cuts"),
            tr("Cuts (C) shows the cut plan in cutting order. Click a connector to change its width in mm."),
            (stage.cuts_switch.clicked,),
        ),
        Step(
            lambda: _shown(columns.fabrication.export, columns.fabrication),
            tr("Export"),
            tr(
                "Export (Ctrl+E) writes the file for your machine, or a PDF to cut by hand. The file is read back and "
                "checked."
            ),
            (services.exporter.exported,),
        ),
    )


def _open_sheet(columns: Columns, services: Services) -> None:
    """Let the sheet open from flat, or lay it flat where nothing is to move by itself."""
    bar = columns.stage.deployment
    if services.session.stage is not None:
        bar.set_phi(math.pi)
        bar.play.setChecked(moves(services.preferences.present.motion, columns.style()))


def _show_opened(columns: Columns, services: Services) -> None:
    columns.stage.deployment.play.setChecked(False)
    if services.session.stage is not None:
        columns.stage.deployment.set_phi(services.session.stage.design.phi_target)


def _shown(wanted: QWidget, otherwise: QWidget) -> QWidget:
    return wanted if wanted.isVisible() else otherwise


class Tour(QObject):
    """Shows one step after another; the window stays usable meanwhile."""

    def __init__(self, columns: Columns, services: Services, appearance: Appearance, cancel: QAction) -> None:
        window = columns.window()
        super().__init__(window)
        self.window, self._columns, self._appearance = window, columns, appearance
        self._services = services
        self._borrowing = False
        self._before: tuple[Document, Path | None] | None = None
        self._sample = 0  # number of the project that is the borrowed sample
        self._entering = False
        services.project.opened.connect(self._note_sample)
        self.steps = steps_of(columns, services)
        self.at = -1
        self.ring = Ring(window)
        self.callout = Callout(window)
        self.callout.next.clicked.connect(lambda: self._go(self.at + 1))
        self.callout.back.clicked.connect(lambda: self._go(self.at - 1))
        self.callout.skip.clicked.connect(self.end)
        self._soon = QTimer(self)  # panels that fold or grow settle first
        self._soon.setSingleShot(True)
        self._soon.setInterval(0)
        self._soon.timeout.connect(self._place)
        columns.target.editing_changed.connect(lambda _: self._soon.start() if self.running else None)
        self._cancel = cancel
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
        self._services.preferences.note_tour()
        self.window.installEventFilter(self)
        self._borrow_sample()
        self._go(0)
        self.callout.setFocus(Qt.FocusReason.OtherFocusReason)

    def end(self) -> None:
        """End the tour."""
        self._leave()
        self.at = -1
        self._soon.stop()
        self._share_escape()
        self.window.removeEventFilter(self)
        had_focus = self.callout.isAncestorOf(self.window.focusWidget() or self.window) or self.callout.hasFocus()
        self.callout.hide()
        self.ring.hide()
        if had_focus:
            self._columns.stage.view.setFocus()
        self._give_back()

    def _borrow_sample(self) -> None:
        session, running = self._services.session, self._services.run.running
        if session.stage is None and not (session.history.unsaved or running or self._borrowing):
            self._borrowing, self._before = True, (session.document, session.path)
            self._services.project.open(resource("examples", "heart.kiri"))

    def _note_sample(self, path: Path) -> None:
        if self._borrowing:
            self._borrowing, self._sample = False, self._services.session.project
            if not self.running:
                self._give_back()

    def _give_back(self) -> None:
        """Take up what there was before the tour, unless the sample was changed or given up."""
        session = self._services.session
        if self._borrowing or self._before is None:
            return
        (document, path), self._before = self._before, None
        if session.project == self._sample and not session.history.unsaved and not self._services.run.running:
            session.restart(document, path)
            session.set_status(tr("The sample is put away; this is your project again."))

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        if event.type() in (QEvent.Type.Resize, QEvent.Type.LayoutRequest, QEvent.Type.PaletteChange):
            self._soon.start()
        return False

    def _happened(self, number: int) -> None:
        if self.at == number and not self._entering:
            self._go(number + 1)

    def _leave(self) -> None:
        """End what the present step does by itself."""
        leave = self.steps[self.at].leave if self.running else None
        if leave is not None:
            self._entering = True
            leave()
            self._entering = False

    def _go(self, number: int) -> None:
        if not 0 <= number < len(self.steps):
            self.end()
            return
        self._leave()
        self.at = number
        self._share_escape()
        step = self.steps[number]
        self.callout.say(step.title, step.text, number + 1, len(self.steps))
        if step.enter is not None:
            self._entering = True
            step.enter()
            self._entering = False
        self._place()
        self._soon.start()

    def _place(self) -> None:
        """Stand next to the control; hide while the drawing board takes the whole window."""
        if not self.running:
            return
        anchor = self.steps[self.at].anchor()
        self.callout.palette_ = self.ring.palette_ = self._appearance.palette
        if self._columns.target.editing or not anchor.isVisible():
            self.callout.hide()
            self.ring.hide()
            return
        place = QRect(anchor.mapTo(self.window, QPoint()), anchor.size())
        self.ring.surround(place)
        self.callout.point_at(place)

    def _share_escape(self) -> None:
        """Esc cancels what is being computed first, and ends the tour when there is nothing to cancel."""
        self._escape.setEnabled(self.running and not self._cancel.isEnabled())
