"""Beside the drawing board: a sheet that moves, a question, ways to begin, finished pairs.

The question is for machine and material; once it is answered, or declined, it is not asked again.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from PySide6.QtCore import QElapsedTimer, QEvent, QLocale, QObject, Qt, QTimer
from PySide6.QtGui import QAction, QHideEvent, QResizeEvent
from PySide6.QtWidgets import QApplication, QGridLayout, QSizePolicy, QStyle, QWidget

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.export.paper import Paper
from kirigami_studio.fabricate.machine import MachineKind, cuttable, find_machine
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.make.machine_question import CuttingQuestion
from kirigami_studio.gui.session.overlays import Overlay
from kirigami_studio.gui.session.queue import JobCallbacks
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.session.user_preferences import UserPreferences
from kirigami_studio.gui.stage.deployment_bar import phi_at
from kirigami_studio.gui.stage.layout_view import LayoutView
from kirigami_studio.gui.widgets.card import Card, ToolButton
from kirigami_studio.gui.widgets.layouts import column
from kirigami_studio.gui.widgets.readable import readable_mm
from kirigami_studio.gui.window.pairs import PairList
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.edits import Edit
from kirigami_studio.project.preferences import MotionPreference, TypedSize
from kirigami_studio.settings.layers import note_before_run
from kirigami_studio.studio.projects import Pair, reading_sample

#: Seconds from flat to open and back: slower than a design is played, so that it draws no eye from the work.
SWING_SECONDS = 10.0
#: Thirty pictures a second are enough for a slow motion.
FRAME_MS = 33
#: Anything that the user does to the window; the sample stands still from then on.
ACTS = frozenset(
    {QEvent.Type.MouseButtonPress, QEvent.Type.KeyPress, QEvent.Type.Wheel, QEvent.Type.Drop, QEvent.Type.TouchBegin}
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
    ("open_target", "open", mark("Open a file")),
    ("library", "library", mark("Silhouettes")),
    ("sample", "project", mark("Finished heart")),
    ("recover", "reset", mark("Recover work")),
)
#: Pixels of height that the sheet has at least, and at most.
LEAST_VIEW, MOST_VIEW = 100, 260
#: Pixels of height from which on sheet and question have room below each other.
TALL = 660


class WelcomePage(Card):
    """Shows a sheet that moves until the user does anything, and what can be done next."""

    def __init__(self) -> None:
        super().__init__(tr("Begin"))
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
        self.view.setMinimumHeight(LEAST_VIEW)
        self.view.setMaximumHeight(MOST_VIEW)
        self.view.hide()
        self.question = CuttingQuestion()
        self.question.hide()
        self.offers: dict[str, ToolButton] = {}
        self._grid = QGridLayout()
        self._grid.setSpacing(6)
        self.pairs = PairList()
        self.body.addLayout(column((self.view, 2), self.question, self._grid, (self.pairs, 3), spacing=8))

    def offer(self, actions: Mapping[str, QAction]) -> None:
        """Offer ways to begin, by commands of the window."""
        for place, (name, icon, text) in enumerate(OFFERS):
            button = ToolButton(f"offer-{name}", icon, actions[name].toolTip())
            button.setProperty("offer", True)
            button.setText(tr(text))
            button.setAccessibleName(tr(text))
            button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
            button.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
            button.clicked.connect(actions[name].trigger)
            self.offers[name] = button
            self._grid.addWidget(button, *divmod(place, 2))
        self.offer_recovery(False)

    def offer_recovery(self, left: bool) -> None:
        """Offer unsaved work where an earlier session is known to have left some."""
        self.offers["recover"].setVisible(left)
        sample = self.offers["sample"]
        self._grid.removeWidget(sample)
        self._grid.addWidget(sample, 1, 0, 1, 1 if left else 2)

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
        self._make_room()
        self._phase = 0.5

    def ask(self, on: bool) -> None:
        """Show the question, or take it away."""
        self.question.setVisible(on)
        self._make_room()

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

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        self._make_room()

    def _make_room(self) -> None:
        """In a low window the question takes the place of the sheet."""
        self.view.setVisible(self.ready and (self.question.isHidden() or self.height() >= TALL))

    def hideEvent(self, event: QHideEvent) -> None:  # noqa: N802 - Qt's name
        super().hideEvent(event)
        self.stop()

    def _advance(self) -> None:
        self._phase = (self._phase + self._clock.restart() / 1000.0 / SWING_SECONDS) % 1.0
        self.view.set_phi(phi_at(self._phase, last=self._target))


class WelcomePresenter(QObject):
    """Begins once the window is shown."""

    def __init__(self, page: WelcomePage, session: Session, preferences: UserPreferences) -> None:
        super().__init__(page)
        self._page, self._session, self._preferences = page, session, preferences
        page.question.answered.connect(self.choose)
        page.question.declined.connect(self.decline)

    def begin(self) -> None:
        """Read the sample and ask the question, if it was not asked before."""
        callbacks: JobCallbacks[Pair] = JobCallbacks(self._on_sample)
        self._session.queue.start(tr("reading the sample"), reading_sample, callbacks)
        self._page.pairs.read(self._session.queue)
        if not self._preferences.present.machine_asked:
            question = self._page.question
            question.offer()
            self._page.ask(True)

    def _on_sample(self, sample: Pair) -> None:
        self._page.show_sample(sample.design, sample.target)
        if moves(self._preferences.present.motion, self._page.style()):
            self._page.start()

    def choose(self, machine: str, material: str) -> None:
        """Cut this material on this machine from now on, in this project and in new ones."""
        preferences, session = self._preferences, self._session
        chosen = find_machine(machine)
        known = cuttable(chosen).get(material) or find_material(material)  # with the machine's kerf and name
        wanted = replace(
            preferences.present, machine=machine, material=material, profile=chosen.profile, machine_asked=True
        )
        if chosen.kind is MachineKind.HAND:
            letter = QLocale.system().territory() in LETTER_LANDS
            wanted = replace(
                wanted, paper=Paper.LETTER if letter else Paper.A4, size=TypedSize.OPENED, opened_mm=BY_HAND_MM
            )
        else:
            wanted = replace(wanted, size=TypedSize.FLAT, width_mm=known.sheet_mm)
        preferences.keep(wanted)
        cut = wanted.new_document().fabrication
        changed = replace(session.document, fabrication=cut)
        if session.history.unsaved or session.document.candidates:
            session.apply(Edit(tr("Change the material"), changed))
        else:  # nothing was done yet: this is how it starts
            session.restart(changed, session.path)
        self._page.ask(False)
        begin = tr("Cutting {material}. Press Generate (Ctrl+G).", material=tr(known.name))
        note = note_before_run(cut)
        words = [begin if note is None else note.text]
        if wanted.size is TypedSize.FLAT:
            words.append(tr("Its sheets are {width} wide to begin with.", width=readable_mm(known.sheet_mm)))
        session.set_status(" ".join(words))

    def decline(self) -> None:
        """Do not ask again."""
        preferences = self._preferences
        preferences.keep(replace(preferences.present, machine_asked=True))
        self._page.ask(False)

    def switch_motion(self) -> None:
        """Let what moves by itself stand still, or move again."""
        preferences, page = self._preferences, self._page
        still = preferences.present.motion is MotionPreference.STILL
        preferences.keep(
            replace(preferences.present, motion=MotionPreference.SYSTEM if still else MotionPreference.STILL)
        )
        if moves(preferences.present.motion, self._page.style()):
            page.start()
        else:
            page.stop()


def moves(preferred: str, style: QStyle) -> bool:
    """Whether things may move by themselves, by preferences and desktop."""
    animated = bool(style.styleHint(QStyle.StyleHint.SH_Widget_Animate))
    duration = style.styleHint(QStyle.StyleHint.SH_Widget_Animation_Duration)
    return preferred == "system" and animated and duration > 0 and not math.isnan(duration)
