"""Which design is compared with the chosen one, and when the stage shows both."""

from __future__ import annotations

from PySide6.QtCore import QObject, QSignalBlocker

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.controller import Controller
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.gui.session import Entry
from kirigami_studio.gui.shell import Shell
from kirigami_studio.outlines.outline import Outline


class SideBySide(QObject):
    """Keeps the compared design: a choice of the eye, which no undo knows."""

    def __init__(self, window: Shell, controller: Controller, parent: QObject) -> None:
        super().__init__(parent)
        self.window = window
        self.controller = controller
        self._compared: Candidate | None = None
        self._chosen: Candidate | None = None
        self._shown: tuple[tuple[Entry, int], tuple[Entry, int], Outline | None, float] | None = None
        stage, gallery, actions = window.stage, window.gallery, window.actions_
        gallery.view.compare_wanted.connect(self.compare_with)
        gallery.bar.compare.clicked.connect(self.show)
        actions["compare"].triggered.connect(self.show)
        actions["swap"].triggered.connect(lambda _=False: self.swap())
        stage.compare.swap_wanted.connect(self.swap)
        stage.compare.leave_wanted.connect(lambda: self.show(False))
        stage.comparing_changed.connect(self._show_switches)
        controller.session.display.stage_changed.connect(self._take_stage)
        controller.session.display.gallery_reset.connect(lambda _: self._show_pair())
        controller.session.display.candidate_found.connect(lambda _: self._show_pair())
        controller.session.document_changed.connect(lambda _: self._show_pair())
        self._show_switches(stage.comparing)

    @property
    def compared(self) -> Candidate | None:
        """The design beside the chosen one, where that is still in the gallery."""
        return None if self._entry(self._compared) is None else self._compared

    def compare_with(self, candidate: Candidate) -> None:
        """Show a design beside the chosen one."""
        stage = self.controller.stage
        if stage is None or candidate == stage.candidate:
            sentence = tr("This is the chosen design. Ctrl+click another card to compare.")
            self.controller.session.post(Message(sentence, Tone.HINT))
            return
        self._compared = candidate
        self.show(True)

    def show(self, on: bool) -> None:
        """Show two designs, the chosen one and the next card unless another was named, or the chosen one alone."""
        view, stage = self.window.gallery.view, self.controller.stage
        if on and self.compared is None and stage is not None:
            self._compared = view.beside(stage.candidate)
        if on and (stage is None or self.compared is None):
            self._show_switches(False)
            sentence = tr("Nothing to compare yet. The gallery needs two designs.")
            self.controller.session.post(Message(sentence, Tone.HINT))
            return
        if on and not self.window.stage.comparing:
            self.window.stage.compare.fit()
        self.window.stage.set_comparing(on)
        self._show_pair()

    def swap(self) -> None:
        """Choose the compared design and compare the chosen one."""
        if self.compared is not None and self.window.stage.comparing:
            self.controller.choose(self.compared)

    def _take_stage(self, entry: Entry | None) -> None:
        """Another design was chosen; where that is the compared one, the two change sides."""
        candidate = None if entry is None else entry.candidate
        if candidate is not None and candidate == self._compared:
            self._compared = self._chosen
        self._chosen = candidate
        self._show_pair()

    def _entry(self, candidate: Candidate | None) -> Entry | None:
        model = self.window.gallery.view.model_
        number = model.number_of(candidate)
        return model.all_entries[number - 1] if number else None

    def _show_pair(self) -> None:
        window = self.window
        if not window.stage.comparing:
            window.gallery.view.show_compared(None)
            return
        stage, other = self.controller.stage, self._entry(self._compared)
        if stage is None or other is None:
            window.stage.set_comparing(False)
            return
        number_of = window.gallery.view.model_.number_of
        left, right = (stage, number_of(stage.candidate)), (other, number_of(other.candidate))
        document = self.controller.document
        shown = left, right, document.target, document.fabrication.width_mm
        if shown != self._shown:
            self._shown = shown
            window.stage.compare.show_pair(*shown)
            window.stage.refresh_header()
        window.gallery.view.show_compared(other.candidate)

    def _show_switches(self, on: bool) -> None:
        """The button and the action show whether two designs are on the stage."""
        bar, actions = self.window.gallery.bar, self.window.actions_
        with QSignalBlocker(bar.compare):
            bar.compare.setChecked(on)
        actions["compare"].setChecked(on)
        actions["swap"].setEnabled(on)
        if not on:
            self.window.gallery.view.show_compared(None)
