"""Which design is compared with the chosen one, and when the stage shows both."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.compare_page import ComparedDesign, ComparePage
from kirigami_studio.gui.gallery.gallery_panel import GalleryPanel
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.session import Entry, Session
from kirigami_studio.outlines.outline import Outline


class SideBySide(QObject):
    """Keeps the compared design, which is no part of the document: comparing is not undone.

    Parameters
    ----------
    panel : GalleryPanel
    page : ComparePage
        Shows both.
    session : Session
    choose : callable
        Puts a design on the stage.
    turn : callable
        Turns the stage to the page, or back; :meth:`follow` is told of it.
    """

    def __init__(
        self,
        panel: GalleryPanel,
        page: ComparePage,
        session: Session,
        *,
        choose: Callable[[Candidate], None],
        turn: Callable[[bool], None],
    ) -> None:
        super().__init__(page)
        self._view, self._switch, self._page, self._session = panel.view, panel.bar.compare.switch, page, session
        self._choose, self._turn = choose, turn
        self._comparing = False
        self._compared: Candidate | None = None
        self._chosen: Candidate | None = None
        self._shown: tuple[ComparedDesign, ComparedDesign, Outline | None] | None = None
        self._switch.triggered.connect(self.show)
        page.swap.clicked.connect(self.swap)
        page.leave.clicked.connect(lambda: self.show(False))
        self._show_switches(False)

    @property
    def compared(self) -> Candidate | None:
        """The design beside the chosen one, where that is still in the gallery."""
        return None if self._entry(self._compared) is None else self._compared

    def compare_with(self, candidate: Candidate) -> None:
        """Show a design beside the chosen one."""
        stage = self._session.stage
        if stage is None or candidate == stage.candidate:
            sentence = tr("This is the chosen design. Ctrl+click another card to compare.")
            self._session.post(Message(sentence, Tone.HINT))
            return
        self._compared = candidate
        self.show(True)

    def show(self, on: bool) -> None:
        """Show two designs, the chosen one and the next card unless another was named, or the chosen one alone."""
        stage = self._session.stage
        if on and self.compared is None and stage is not None:
            self._compared = self._view.beside(stage.candidate)
        if on and (stage is None or self.compared is None):
            self._show_switches(False)
            sentence = tr("Nothing to compare yet. The gallery needs two designs.")
            self._session.post(Message(sentence, Tone.HINT))
            return
        if on and not self._comparing:
            self._page.fit()
        self._turn(on)
        self.show_pair()

    def follow(self, comparing: bool) -> None:
        """The stage shows two designs now, or one."""
        self._comparing = comparing
        self._show_switches(comparing)

    def swap(self) -> None:
        """Choose the compared design and compare the chosen one."""
        if self.compared is not None and self._comparing:
            self._choose(self.compared)

    def show_design(self, entry: Entry | None) -> None:
        """Another design was chosen; where that is the compared one, the two change sides."""
        candidate = None if entry is None else entry.candidate
        if candidate is not None and candidate == self._compared:
            self._compared = self._chosen
        self._chosen = candidate
        self.show_pair()

    def _entry(self, candidate: Candidate | None) -> Entry | None:
        model = self._view.model_
        number = model.number_of(candidate)
        return model.all_entries[number - 1] if number else None

    def show_pair(self) -> None:
        """Show both as they are now, or one alone where the other is gone."""
        if not self._comparing:
            self._view.show_compared(None)
            return
        session, name_of = self._session, self._view.model_.name_of
        stage, other = session.stage, self._entry(self._compared)
        if stage is None or other is None:
            self._turn(False)
            return
        left, right = (
            ComparedDesign(entry, name_of(entry.candidate), session.width_of(entry.candidate))
            for entry in (stage, other)
        )
        shown = left, right, session.document.target
        if shown != self._shown:
            self._shown = shown
            self._page.show_pair(*shown)
        self._view.show_compared(other.candidate)

    def _show_switches(self, on: bool) -> None:
        """The switch says whether two designs are on the stage."""
        self._switch.setChecked(on)
        if not on:
            self._view.show_compared(None)
