"""What a new user meets: a sample that moves on the empty stage, and one question, for machine and material."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from PySide6.QtCore import QLocale, QObject

from kirigami_studio.export.paper import Paper
from kirigami_studio.fabricate.material import library
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.queue import JobCallbacks
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.session.user_preferences import UserPreferences
from kirigami_studio.gui.stage.empty_stage import moves
from kirigami_studio.gui.window.stage_panel import StagePanel
from kirigami_studio.project.edits import Edit
from kirigami_studio.project.preferences import MotionPreference, TypedSize
from kirigami_studio.studio.projects import Pair, reading_sample

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


class FirstStart(QObject):
    """Begins once the window is shown; a question that was answered, or declined, is not asked again."""

    def __init__(
        self, stage: StagePanel, session: Session, preferences: UserPreferences, start_tour: Callable[[], None]
    ) -> None:
        super().__init__(stage)
        self._stage, self._session, self._preferences = stage, session, preferences
        empty = stage.empty
        empty.chosen.connect(self.choose)
        empty.declined.connect(self.decline)
        empty.tour.clicked.connect(start_tour)

    def begin(self) -> None:
        """Read the sample and ask the question, if it was not asked before."""
        callbacks: JobCallbacks[Pair] = JobCallbacks(self._on_sample)
        self._session.queue.start(tr("reading the sample"), reading_sample, callbacks)
        if not self._preferences.present.machine_asked:
            question = self._stage.empty.question
            question.offer(library().materials)
            question.show()

    def _on_sample(self, sample: Pair) -> None:
        stage = self._stage
        stage.empty.show_sample(sample.design, sample.target)
        stage.place_sample()
        if moves(self._preferences.present.motion, self._stage.style()):
            stage.empty.start()

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
        elif known is not None:
            wanted = replace(wanted, size=TypedSize.OPENED, opened_mm=known.sheet_mm)
        preferences.keep(wanted)
        cut = wanted.new_document().fabrication
        changed = replace(session.document, fabrication=cut)
        if session.history.unsaved or session.document.candidates:
            session.apply(Edit(tr("Change the material"), changed))
        else:  # nothing was done yet: this is how it starts
            session.restart(changed, session.path)
        self._stage.empty.question.hide()
        name = material if known is None else tr(known.name)
        limits = None if known is None else known.limits_note
        begin = tr("Cutting {material}. Press Generate (Ctrl+G).", material=name)
        session.set_status(begin if limits is None else limits.text)

    def decline(self) -> None:
        """Do not ask again."""
        preferences = self._preferences
        preferences.keep(replace(preferences.present, machine_asked=True))
        self._stage.empty.question.hide()

    def switch_motion(self) -> None:
        """Let what moves by itself stand still, or move again."""
        preferences, empty = self._preferences, self._stage.empty
        still = preferences.present.motion is MotionPreference.STILL
        preferences.keep(
            replace(preferences.present, motion=MotionPreference.SYSTEM if still else MotionPreference.STILL)
        )
        if moves(preferences.present.motion, self._stage.style()):
            empty.start()
        else:
            empty.stop()
