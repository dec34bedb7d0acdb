"""The page of the stage before there is a design: ways to begin, first steps, a question.

The question is for machine and material; once it is answered, or declined, it is not asked again.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from PySide6.QtCore import QElapsedTimer, QEvent, QLocale, QObject, Qt, QTimer, Signal
from PySide6.QtGui import QAction, QHideEvent, QResizeEvent
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
from kirigami_studio.export.paper import Paper
from kirigami_studio.fabricate.material import BY_HAND, Material, library
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.session.overlays import Overlay
from kirigami_studio.gui.session.queue import JobCallbacks
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.session.user_preferences import UserPreferences
from kirigami_studio.gui.stage.deployment_bar import phi_at
from kirigami_studio.gui.stage.layout_view import LayoutView
from kirigami_studio.gui.widgets.card import ToolButton, muted_label
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.edits import Edit
from kirigami_studio.project.preferences import Motion, TypedSize
from kirigami_studio.studio.projects import Pair, reading_sample

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
#: Longer side (mm) of opened shapes that are cut by hand: their sheets fit on one page of A4 or Letter.
BY_HAND_MM = 150.0
#: Where printers hold Letter paper.
LETTER_LANDS = frozenset(
    {
        QLocale.Country.UnitedStates,
        QLocale.Country.Canada,
        QLocale.Country.Mexico,
        QLocale.Country.Philippines,
        QLocale.Country.Chile,
        QLocale.Country.Colombia,
    }
)
#: Ways to begin: command, icon, words.
OFFERS = (
    ("edit_target", "edit", mark("Draw a shape")),
    ("open_target", "open", mark("Open a file")),
    ("library", "library", mark("Silhouettes")),
    ("sample", "project", mark("Finished heart")),
    ("pairs", "swap", mark("Finished pairs")),
    ("recover", "reset", mark("Recover work")),
)
#: From a shape to a cut file.
STEPS = (
    mark("Choose a target: draw it (E), open a file (Ctrl+O), or take a silhouette (Ctrl+L). Type its size."),
    mark("Choose the material, then Generate (Ctrl+G)."),
    mark("Compare designs, best first (K). Click the one to keep."),
    mark("Open the sheet with the slider, or play it (Space)."),
    mark("Check the cuts in cutting order (C)."),
    mark("Export the file for your machine, or a PDF to cut by hand (Ctrl+E)."),
)
#: Pixels of height that the sheet has at least.
LEAST_VIEW = 140


class WelcomePage(QWidget):
    """Shows a sheet that moves until the user does anything, and what can be done next."""

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
        self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        self.view = LayoutView()
        self.view.setObjectName("sampleView")
        self.view.setAccessibleName(tr("A sample sheet that opens and closes"))
        self.view.setToolTip("")
        self.view.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.view.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.view.set_overlays(frozenset({Overlay.TARGET}))
        self.view.setMinimumHeight(LEAST_VIEW)
        keeps = self.view.sizePolicy()
        keeps.setRetainSizeWhenHidden(True)
        self.view.setSizePolicy(keeps)
        self.view.hide()
        self.headline = QLabel()
        self.headline.setObjectName("cardTitle")
        self.hint = muted_label()
        self.guide = QPushButton(tr("Guide"))
        self.guide.setObjectName("link")
        self.guide.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.question = MachineQuestion()
        self.question.chosen.connect(self.chosen)
        self.question.declined.connect(self.declined)
        self.question.hide()
        self.offers: dict[str, ToolButton] = {}
        self._grid = QGridLayout()
        self._grid.setSpacing(6)
        self.steps = QWidget()
        rows = QGridLayout(self.steps)
        rows.setContentsMargins(0, 0, 0, 0)
        rows.setColumnStretch(1, 1)
        for row, step in enumerate(STEPS):
            number, words = QLabel(str(row + 1)), muted_label()
            number.setObjectName("number")
            words.setText(tr(step))
            rows.addWidget(number, row, 0, Qt.AlignmentFlag.AlignTop)
            rows.addWidget(words, row, 1)
        words_ = QVBoxLayout()
        words_.setSpacing(2)
        words_.addWidget(self.headline)
        words_.addWidget(self.hint)
        line = QHBoxLayout()
        line.addLayout(words_, 1)
        line.addWidget(self.guide, 0, Qt.AlignmentFlag.AlignTop)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(8)
        column.addWidget(self.view, 1)
        column.addLayout(line)
        column.addWidget(self.question)
        column.addLayout(self._grid)
        column.addWidget(self.steps)

    def offer(self, actions: Mapping[str, QAction]) -> None:
        """Offer ways to begin, by commands of the window."""
        for name, icon, text in OFFERS:
            button = ToolButton(f"offer-{name}", icon, actions[name].toolTip())
            button.setProperty("offer", True)
            button.setText(tr(text))
            button.setAccessibleName(tr(text))
            button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
            button.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
            button.clicked.connect(actions[name].trigger)
            self.offers[name] = button
        self.guide.setToolTip(actions["guide"].toolTip())
        self.guide.clicked.connect(actions["guide"].trigger)
        self._arrange()

    def _arrange(self) -> None:
        """Lay out offers in few rows, and the steps where the sheet keeps its height."""
        widest = max((button.sizeHint().width() for button in self.offers.values()), default=1)
        most = max(1, (self.width() + self._grid.spacing()) // (widest + self._grid.spacing()))
        columns = next(count for count in (6, 3, 2, 1) if count <= most)
        for place, button in enumerate(self.offers.values()):
            self._grid.addWidget(button, *divmod(place, columns))
        for column in range(len(OFFERS)):
            self._grid.setColumnStretch(column, 1 if column < columns else 0)
        layout = self.layout()
        if layout is not None:
            shown = self.steps.isVisibleTo(self)
            least = layout.totalHeightForWidth(self.width())
            if not shown:
                least += self.steps.heightForWidth(self.width()) + layout.spacing()
            self.steps.setVisible(least <= self.height())

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        self._arrange()

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
        self.view.show()
        self._phase = 0.5

    def say(self, headline: str, hint: str) -> None:
        """Say what to do next."""
        self.headline.setText(headline)
        self.hint.setText(hint)
        self._arrange()

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
    """The question for machine and material, answered by one click or two."""

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
            for key, material in materials.items():
                menu.addAction(tr(material.name)).triggered.connect(lambda _=False, key=key: self.chosen.emit(key))
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


class WelcomePresenter(QObject):
    """Begins once the window is shown."""

    def __init__(self, page: WelcomePage, session: Session, preferences: UserPreferences) -> None:
        super().__init__(page)
        self._page, self._session, self._preferences = page, session, preferences
        page.chosen.connect(self.choose)
        page.declined.connect(self.decline)

    def begin(self) -> None:
        """Read the sample and ask the question, if it was not asked before."""
        callbacks: JobCallbacks[Pair] = JobCallbacks(self._on_sample)
        self._session.queue.start(tr("reading the sample"), reading_sample, callbacks)
        if not self._preferences.present.machine_asked:
            question = self._page.question
            question.offer(library().materials)
            question.show()

    def _on_sample(self, sample: Pair) -> None:
        self._page.show_sample(sample.design, sample.target)
        if moves(self._preferences.present.motion, self._page.style()):
            self._page.start()

    def choose(self, material: str) -> None:
        """Cut with this material from now on, in this project and in new ones."""
        preferences, session = self._preferences, self._session
        known = library().materials.get(material)
        wanted = replace(preferences.present, material=material, machine_asked=True)
        if known is not None and known.by_hand:
            letter = QLocale.system().territory() in LETTER_LANDS
            wanted = replace(
                wanted, paper=Paper.LETTER if letter else Paper.A4, size=TypedSize.OPENED, opened_mm=BY_HAND_MM
            )
        preferences.keep(wanted)
        cut = wanted.new_document().fabrication
        changed = replace(session.document, fabrication=cut)
        if session.history.unsaved or session.document.candidates:
            session.apply(Edit(tr("Change the material"), changed))
        else:  # nothing was done yet: this is how it starts
            session.restart(changed, session.path)
        self._page.question.hide()
        name = material if known is None else tr(known.name)
        session.set_status(tr("Cutting {material}. Press Generate (Ctrl+G).", material=name))

    def decline(self) -> None:
        """Do not ask again."""
        preferences = self._preferences
        preferences.keep(replace(preferences.present, machine_asked=True))
        self._page.question.hide()

    def switch_motion(self) -> None:
        """Let what moves by itself stand still, or move again."""
        preferences, page = self._preferences, self._page
        still = preferences.present.motion is Motion.STILL
        preferences.keep(replace(preferences.present, motion=Motion.SYSTEM if still else Motion.STILL))
        if moves(preferences.present.motion, self._page.style()):
            page.start()
        else:
            page.stop()


def moves(preferred: str, style: QStyle) -> bool:
    """Whether things may move by themselves, by preferences and desktop."""
    animated = bool(style.styleHint(QStyle.StyleHint.SH_Widget_Animate))
    duration = style.styleHint(QStyle.StyleHint.SH_Widget_Animation_Duration)
    return preferred == "system" and animated and duration > 0 and not math.isnan(duration)
