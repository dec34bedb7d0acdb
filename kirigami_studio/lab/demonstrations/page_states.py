"""Screenshots of the three pages: empty, at first, done, with long names, refused, busy.

``python -m kirigami_studio.lab.demonstrations.page_states --out out/pages --language de`` writes them at 1280 x 720,
with a page of small ones for each theme; with ``--scale 2`` at 3840 x 2160.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QSize
from PySide6.QtWidgets import QApplication

from kirigami_studio.foundation.words import language
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.widgets.theme import DARK, LIGHT
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.lab.demonstrations.board_states import LONG_NAME
from kirigami_studio.lab.demonstrations.offscreen_session import OffscreenSession, SessionError, main
from kirigami_studio.lab.demonstrations.state_sheet import contact_sheets
from kirigami_studio.project import edits

#: Window of a small laptop, and of a large screen at twice the scale, in pixels of the window.
SMALL, LARGE = QSize(1280, 720), QSize(1920, 1080)
#: Designs and steps of the run that is pictured while it goes on.
RUN = {"k": 6, "polish": 30, "auto_grid": False, "grid": (8, 8)}
#: Width (mm) of a cut that leaves no panel.
TOO_WIDE = 4.0


class PageStates(OffscreenSession):
    """Takes one window through the states of its pages."""

    #: States to picture, in the order in which they are made.
    states: Sequence[str] = ("empty", "first", "done", "long", "refused", "busy")

    def play(self) -> list[Path]:
        """Make all pictures and return their files."""
        window = self.window
        window.show()
        window.resize(LARGE if window.devicePixelRatioF() > 1.0 else SMALL)
        for state in self.states:  # each begins where the one before it ended
            getattr(self, state)()
        window.session.history.mark_saved()
        window.close()
        self.files.extend(contact_sheets(self.files, self.out))
        return self.files

    def pages(self, state: str) -> None:
        """Take a picture of every page in both themes."""
        window, size = self.window, self.window.size() * self.window.devicePixelRatioF()
        for palette in (LIGHT, DARK):
            window.appearance.set_theme(palette)
            for page in WindowPage:
                window.pages.turn(page)
                for _ in range(3):
                    QApplication.processEvents()
                self.picture(f"{page.value}-{state}-{language()}-{size.width()}x{size.height()}-{palette.name}")
        window.appearance.set_theme(LIGHT)

    def empty(self) -> None:
        """Without a target."""
        self.window.services.targeting.clear()
        self.pages("empty")

    def first(self) -> None:
        """With the first question, over a finished pair."""
        presenter, page = self.window.presenters.welcome, self.window.welcome
        self.window.pages.turn(WindowPage.SHAPE)
        self.window.services.targeting.open("heart")
        self.until(lambda: self.window.session.document.target is not None, "the heart was not read")
        presenter.begin()
        page.question.offer()
        page.ask(True)
        self.until(lambda: page.ready and page.pairs.complete, "the sample was not read")
        page.stop()
        self.pages("first")
        presenter.decline()

    def done(self) -> None:
        """With designs, one of them planned, judged and exported."""
        window = self.window
        window.session.history.mark_saved()
        window.files.open_sample()
        self.until(window.fabrication.export.isEnabled, "no cut plan was made")
        verdict = window.services.verdict
        self.until(lambda: verdict.state.verdict is not None and not verdict.busy, "the verdict did not come")
        self.pages("done")

    def long(self) -> None:
        """With long names of project, target and design."""
        window, session = self.window, self.window.session
        document = session.document
        if document.target is None or session.stage is None:
            raise SessionError("There is no design to name.")
        label = document.label_of(session.stage.candidate)
        if label is not None:
            window.services.labels.set(label, LONG_NAME, "The lobes are even; cut this one for the fair.")
        renamed = replace(document.target, name=LONG_NAME)
        session.restart(replace(session.document, target=renamed), Path(f"{LONG_NAME}.kiri"))
        window.services.fabrication.change(machine="cricut-maker", material="polypropylene-co2")
        self.until(window.fabrication.export.isEnabled, "no cut plan was made")
        window.messages.add(Message(f"{LONG_NAME}.svg could not be read: {LONG_NAME}.", Tone.WARNING))
        self.pages("long")
        while window.messages.messages:
            window.messages.close_message()
        window.commands["undo"].trigger()
        self.until(window.fabrication.export.isEnabled, "undo did not bring the plan back")

    def refused(self) -> None:
        """With cuts that leave no panel, and an error of a file."""
        window = self.window
        window.services.fabrication.change(kerf_mm=TOO_WIDE)
        self.until(lambda: not window.fabrication.export.isEnabled(), "the wide kerf was not refused")
        sentence = "logo.svg crosses itself at (12.4, 88.1) mm; separate the two loops there and open it again."
        window.messages.add(Message(sentence, Tone.ERROR, "first line of the trace"))
        self.pages("refused")
        while window.messages.messages:
            window.messages.close_message()
        window.commands["undo"].trigger()

    def busy(self) -> None:
        """While a run goes on, with the first designs."""
        window = self.window
        window.session.apply(edits.set_settings(window.session.document, **RUN))
        window.commands["generate"].trigger()
        self.until(lambda: bool(window.gallery.view.model_.entries), "no design came")
        self.pages("busy")
        window.commands["cancel"].trigger()


if __name__ == "__main__":
    sys.exit(main(kind=PageStates))
