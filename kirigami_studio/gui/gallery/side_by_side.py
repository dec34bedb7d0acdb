"""Which design is compared with the chosen one, and when the stage shows both."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QSignalBlocker

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.compare_page import ComparedDesign
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.session import Entry
from kirigami_studio.gui.window.controller import Controller
from kirigami_studio.outlines.outline import Outline

if TYPE_CHECKING:
    from kirigami_studio.gui.window.main_window import MainWindow


class SideBySide(QObject):
    """Keeps the compared design, which is no part of the document: comparing is not undone."""

    def __init__(self, window: MainWindow, controller: Controller) -> None:
        super().__init__(window)
        self._window = window
        self._controller = controller
        self._compared: Candidate | None = None
        self._chosen: Candidate | None = None
        self._shown: tuple[ComparedDesign, ComparedDesign, Outline | None] | None = None
        stage, gallery = window.stage, window.gallery
        gallery.view.compare_wanted.connect(self.compare_with)
        gallery.bar.compare.clicked.connect(self.show)
        stage.compare.swap_wanted.connect(self.swap)
        stage.compare.leave_wanted.connect(lambda: self.show(False))
        stage.comparing_changed.connect(self._show_switches)
        controller.session.display.stage_changed.connect(self._take_stage)
        controller.session.display.gallery_reset.connect(self._show_pair)
        controller.session.display.candidate_found.connect(self._show_pair)
        controller.session.document_changed.connect(self._show_pair)
        self._show_switches(stage.comparing)

    @property
    def compared(self) -> Candidate | None:
        """The design beside the chosen one, where that is still in the gallery."""
        return None if self._entry(self._compared) is None else self._compared

    def compare_with(self, candidate: Candidate) -> None:
        """Show a design beside the chosen one."""
        stage = self._controller.stage
        if stage is None or candidate == stage.candidate:
            sentence = tr("This is the chosen design. Ctrl+click another card to compare.")
            self._controller.session.post(Message(sentence, Tone.HINT))
            return
        self._compared = candidate
        self.show(True)

    def show(self, on: bool) -> None:
        """Show two designs, the chosen one and the next card unless another was named, or the chosen one alone."""
        view, stage = self._window.gallery.view, self._controller.stage
        if on and self.compared is None and stage is not None:
            self._compared = view.beside(stage.candidate)
        if on and (stage is None or self.compared is None):
            self._show_switches(False)
            sentence = tr("Nothing to compare yet. The gallery needs two designs.")
            self._controller.session.post(Message(sentence, Tone.HINT))
            return
        if on and not self._window.stage.comparing:
            self._window.stage.compare.fit()
        self._window.stage.set_comparing(on)
        self._show_pair()

    def swap(self) -> None:
        """Choose the compared design and compare the chosen one."""
        if self.compared is not None and self._window.stage.comparing:
            self._controller.choose(self.compared)

    def _take_stage(self, entry: Entry | None) -> None:
        """Another design was chosen; where that is the compared one, the two change sides."""
        candidate = None if entry is None else entry.candidate
        if candidate is not None and candidate == self._compared:
            self._compared = self._chosen
        self._chosen = candidate
        self._show_pair()

    def _entry(self, candidate: Candidate | None) -> Entry | None:
        model = self._window.gallery.view.model_
        number = model.number_of(candidate)
        return model.all_entries[number - 1] if number else None

    def _show_pair(self) -> None:
        window = self._window
        if not window.stage.comparing:
            window.gallery.view.show_compared(None)
            return
        stage, other = self._controller.stage, self._entry(self._compared)
        if stage is None or other is None:
            window.stage.set_comparing(False)
            return
        name_of = window.gallery.view.model_.name_of
        session = self._controller.session
        left, right = (
            ComparedDesign(entry, name_of(entry.candidate), session.width_of(entry.candidate))
            for entry in (stage, other)
        )
        shown = left, right, session.document.target
        if shown != self._shown:
            self._shown = shown
            window.stage.compare.show_pair(*shown)
            window.stage.show_title()
        window.gallery.view.show_compared(other.candidate)

    def _show_switches(self, on: bool) -> None:
        """The button shows whether two designs are on the stage."""
        button = self._window.gallery.bar.compare
        with QSignalBlocker(button):
            button.setChecked(on)
        if not on:
            self._window.gallery.view.show_compared(None)
