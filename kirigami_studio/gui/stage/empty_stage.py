"""What the stage shows while there is no design: a sample sheet that opens and closes by itself, and the next step.

The first start also asks here for machine and material, once.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from PySide6.QtCore import QElapsedTimer, QEvent, QObject, Qt, QTimer, Signal
from PySide6.QtGui import QHideEvent, QResizeEvent
from PySide6.QtWidgets import (
    QApplication,
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QMenu,
    QPushButton,
    QSizePolicy,
    QStyle,
    QVBoxLayout,
    QWidget,
)

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.fabricate.material import BY_HAND, Material
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.session.overlays import Overlay
from kirigami_studio.gui.stage.deployment_bar import phi_at
from kirigami_studio.gui.stage.layout_view import LayoutView
from kirigami_studio.outlines.outline import Outline

#: Seconds from flat to open and back: slower than a design is played, so that it draws no eye from the work.
SWING_SECONDS = 10.0
#: Thirty pictures a second are enough for a slow motion.
FRAME_MS = 33
#: Anything that the user does to the window; the sample stands still from then on.
ACTS = frozenset(
    {QEvent.Type.MouseButtonPress, QEvent.Type.KeyPress, QEvent.Type.Wheel, QEvent.Type.Drop, QEvent.Type.TouchBegin}
)
#: Machines in the words of the question, by those of the materials, in the order in which they are offered.
MACHINES = (
    (BY_HAND, mark("Paper and scissors"), mark("Print a PDF on paper or thin card and cut along its lines.")),
    ("cutting plotter", mark("Cutting plotter"), mark("A blade, as in Cricut and Silhouette machines.")),
    ("CO2 laser", mark("CO2 laser"), mark("Card, plastics, felt, leather.")),
    ("UV or green pulsed laser", mark("UV laser"), mark("Thin films and foils.")),
)


class EmptyStage(QWidget):
    """Moves from when it is started until the user does anything; then it stands still."""

    chosen = Signal(str)  #: key of a material
    declined = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._phase = 0.0
        self._target = 0.0
        self._clock = QElapsedTimer()
        self._timer = QTimer(self)
        self._timer.setInterval(FRAME_MS)
        self._timer.timeout.connect(self._advance)
        self.view = LayoutView()
        self.view.setObjectName("sampleView")
        self.view.setAccessibleName(tr("A sample sheet that opens and closes"))
        self.view.setToolTip("")
        self.view.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.view.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.view.set_overlays(frozenset({Overlay.TARGET}))
        self.headline = QLabel()
        self.headline.setObjectName("cardTitle")
        self.hint = QLabel()
        self.hint.setObjectName("muted")
        self.hint.setWordWrap(True)
        self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        self.tour = QPushButton(tr("Take a tour"))
        self.tour.setObjectName("link")
        self.tour.setToolTip(tr("Six steps through the window, with a finished design."))
        self.tour.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.question = MachineQuestion()
        self.question.chosen.connect(self.chosen)
        self.question.declined.connect(self.declined)
        self.question.hide()
        words = QVBoxLayout()
        words.setSpacing(2)
        words.addWidget(self.headline)
        words.addWidget(self.hint)
        line = QHBoxLayout()
        line.addLayout(words, 1)
        line.addWidget(self.tour)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(8)
        column.addWidget(self.view, 1)
        column.addLayout(line)
        column.addWidget(self.question)

    @property
    def ready(self) -> bool:
        """Whether there is a sample to show."""
        return self.view.design is not None

    @property
    def moving(self) -> bool:
        """Whether it opens and closes now."""
        return self._timer.isActive()

    def show_sample(self, design: PosedDesign, target: Outline) -> None:
        """Show a design, open, as it stands still."""
        self._target = design.phi_target
        self.view.show_design(design, None, target)
        self.view.set_phi(self._target)
        self._phase = 0.5

    def say(self, headline: str, hint: str) -> None:
        """Say what to do next."""
        self.headline.setText(headline)
        self.hint.setText(hint)

    def start(self) -> None:
        """Open and close until the user does something in the window."""
        application = QApplication.instance()
        if self.ready and self.isVisible() and not self.moving and application is not None:
            application.installEventFilter(self)
            self._clock.start()
            self._timer.start()

    def stop(self) -> None:
        """Stand still."""
        application = QApplication.instance()
        if self.moving and application is not None:
            application.removeEventFilter(self)
        self._timer.stop()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        if event.type() in ACTS and isinstance(watched, QWidget) and watched.window() is self.window():
            self.stop()
        return False

    def hideEvent(self, event: QHideEvent) -> None:  # noqa: N802 - Qt's name
        super().hideEvent(event)
        self.stop()

    def _advance(self) -> None:
        self._phase = (self._phase + self._clock.restart() / 1000.0 / SWING_SECONDS) % 1.0
        self.view.set_phi(phi_at(self._phase, last=self._target))


class MachineQuestion(QFrame):
    """Asks once what designs are cut with, and from what; one click answers, two where a machine cuts several."""

    chosen = Signal(str)  #: key of a material
    declined = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("machineQuestion")
        self.title = QLabel(tr("What will you cut with?"))
        self.title.setObjectName("cardTitle")
        self.why = QLabel(tr("It decides how fine designs may be. You can change it at any time."))
        self.why.setObjectName("muted")
        self.why.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.later = QPushButton(tr("Not now"))
        self.later.setObjectName("link")
        self.later.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.later.setToolTip(tr("Start with thin film and a UV laser; the material can be changed at any time."))
        self.later.clicked.connect(self.declined)
        self.buttons: dict[str, QPushButton] = {}
        head = QHBoxLayout()
        head.addWidget(self.title, 1)
        head.addWidget(self.later)
        self._grid = QGridLayout()
        self._grid.setSpacing(8)
        column = QVBoxLayout(self)
        column.setContentsMargins(12, 6, 8, 10)
        column.setSpacing(6)
        column.addLayout(head)
        column.addWidget(self.why)
        column.addLayout(self._grid)

    def offer(self, materials: Mapping[str, Material]) -> None:
        """Offer the machines that these materials are for, by their keys."""
        for machine, name, about in MACHINES:
            found = {key: material for key, material in materials.items() if material.machine == machine}
            if found and machine not in self.buttons:
                self._add(machine, name, about, found)

    def _add(self, machine: str, name: str, about: str, materials: Mapping[str, Material]) -> None:
        button = QPushButton(tr(name))
        button.setObjectName("machineChoice")
        button.setToolTip(tr(about))
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        if len(materials) == 1:
            (key,) = materials
            button.clicked.connect(lambda: self.chosen.emit(key))
        else:
            menu = QMenu(button)
            menu.setToolTipsVisible(True)
            # What one sheet of cannot close comes last, and says so.
            for key, material in sorted(materials.items(), key=lambda item: item[1].limits_note is not None):
                action = menu.addAction(tr(material.name))
                action.setToolTip(tr(material.note) if material.limits_note is None else material.limits_note.text)
                action.triggered.connect(lambda _=False, key=key: self.chosen.emit(key))
            button.setMenu(menu)
        button.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.buttons[machine] = button
        self._arrange()

    def _arrange(self) -> None:
        """In one row where all names fit, else in two; the reason gives way in a narrow stage."""
        buttons = list(self.buttons.values())
        widest = max((button.sizeHint().width() for button in buttons), default=0)
        columns = 4 if len(buttons) * (widest + 8) <= self.width() else 2
        for place, button in enumerate(buttons):
            self._grid.addWidget(button, *divmod(place, columns))
        self.why.setVisible(columns > 2)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        self._arrange()


def moves(preferred: str, style: QStyle) -> bool:
    """Whether things may move by themselves: not where the preferences, or the desktop's animations, are off."""
    animated = bool(style.styleHint(QStyle.StyleHint.SH_Widget_Animate))
    duration = style.styleHint(QStyle.StyleHint.SH_Widget_Animation_Duration)
    return preferred == "system" and animated and duration > 0 and not math.isnan(duration)
