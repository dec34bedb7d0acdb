"""Gesture -> named edit on the frozen document -> history -> signals to the views.

The only place of the window that changes the document.  Long work goes to the job board; what it brings back becomes
an edit here, or a message.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Unpack

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.resources import resource_root
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.collecting import Collecting, Plan
from kirigami_studio.gui.comparing import Comparing
from kirigami_studio.gui.cutting import Cutting
from kirigami_studio.gui.design_run import DesignRun
from kirigami_studio.gui.fabricating import Fabricating
from kirigami_studio.gui.file_kinds import kind_of
from kirigami_studio.gui.filing import Filing
from kirigami_studio.gui.finishing import Finishing
from kirigami_studio.gui.hand_editing import HandEditing
from kirigami_studio.gui.jobs import steps
from kirigami_studio.gui.jobs.board import Board, Ears
from kirigami_studio.gui.marking import Marking
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.gui.plotting import Plotting
from kirigami_studio.gui.preferring import Preferring
from kirigami_studio.gui.recovering import Work
from kirigami_studio.gui.refitting import Refitting
from kirigami_studio.gui.shelf import Shelf
from kirigami_studio.gui.showing import Showing
from kirigami_studio.gui.targeting import Targeting
from kirigami_studio.gui.views.gallery_model import Entry
from kirigami_studio.pipeline.events import Result
from kirigami_studio.project import edits
from kirigami_studio.project.design_facts import design_facts
from kirigami_studio.project.document import Document
from kirigami_studio.project.edits import Edit, FabricationChange, SettingsChange
from kirigami_studio.project.history import History
from kirigami_studio.target.outline import Outline


class Controller(QObject):
    """Holds the history, runs the jobs, tells the views."""

    document_changed = Signal(object)  #: Document
    variants_known = Signal(object)  #: tuple of str
    saved = Signal(object)  #: Path
    opened = Signal(object)  #: Path
    message = Signal(object)  #: Message
    status = Signal(str)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.board = Board(self)
        self.history = History()
        self.path: Path | None = None
        shelf = Shelf()
        self.showing = Showing(self.board, shelf, self)
        self.run = DesignRun(self.board, shelf, self)
        self.finishing = Finishing(self.board, shelf, lambda: self.document, self)
        self.hand = HandEditing(self.board, shelf, lambda: self.document, self)
        self.refitting = Refitting(self.board, shelf, lambda: self.document, self)
        self.comparing = Comparing(self.board, shelf, self)
        self.fabricating = Fabricating(lambda: self.document, self)
        self.cutting = Cutting(self.board, self)
        self.targeting = Targeting(self.board, lambda: self.document, self)
        self.preferring = Preferring(self)
        self.collecting = Collecting(lambda: self.document, self)
        self.marking = Marking(lambda: self.document, self)
        self.plotting = Plotting(self.board, self)
        self.filing = Filing(self.board, self._work, self.targeting, self)
        self._connect()

    def _connect(self) -> None:
        self.run.found.connect(self.showing.take_found)
        self.run.told.connect(self.status)
        self.run.completed.connect(self._take_result)
        self.run.cancelled.connect(self._run_cancelled)
        self.run.failed.connect(self._run_failed)
        self.showing.settled.connect(self._plan_soon)
        self.showing.stage_changed.connect(self._forget_stage)
        self.fabricating.refused.connect(self._refuse)
        self.targeting.replaced.connect(self._replace)
        self.targeting.adjusted.connect(self._adjust)
        self.targeting.begun.connect(self._begin)
        self.targeting.settled.connect(self.end_drag)
        self.filing.saved.connect(self._saved)
        self.filing.opened.connect(self._opened)
        self.filing.recovered.connect(self._recovered)
        self.document_changed.connect(lambda _: self.filing.recovering.notice())
        self.hand.drafted.connect(self._stop_finish)
        for part in self._parts():
            self._hear(part)

    def _parts(self) -> tuple[QObject, ...]:
        making = (self.targeting, self.collecting, self.marking, self.finishing, self.fabricating, self.cutting)
        changing = (self.hand, self.refitting)
        return (self.showing, self.comparing, self.plotting, *making, *changing, self.preferring, self.filing)

    def _hear(self, part: QObject) -> None:
        """Take what a part proposes and says; not every part has all four signals."""
        takers = {"edited": self._apply, "message": self.message, "status": self.status, "failed": self._tell_failure}
        for name, take in takers.items():
            signal = getattr(part, name, None)
            if signal is not None:
                signal.connect(take)

    @property
    def document(self) -> Document:
        return self.history.document

    @property
    def stage(self) -> Entry | None:
        """The design that is shown large."""
        return self.showing.stage

    @property
    def running(self) -> bool:
        """Whether candidates are being generated."""
        return self.run.running

    def close(self) -> None:
        """Stop all work; the window is going away."""
        self.cutting.close()
        self.board.close()
        self.filing.close()

    def use_preferences(self, path: Path) -> None:
        """Start with what was preferred the last time, and remember what is from now on."""
        untouched = self.document == self.preferring.new_document()
        self.preferring.load(path)
        if untouched:
            self.history.restart(self.preferring.new_document())
            self._show()

    def warm_up(self) -> None:
        """Import in the worker what the first run needs, and learn which generators there are."""
        ears = Ears(self._take_warmth, on_failed=self._tell_failure)
        self.board.start("loading the generator", steps.warming, ears)

    def _take_warmth(self, report: object) -> None:
        if isinstance(report, tuple):
            self.variants_known.emit(report)

    def start_with(self, source: str) -> None:
        """Read the first target; it is where the history starts, not a change to be undone or saved."""
        self.targeting.start_with(source, self.preferring.new_document())

    # settings ------------------------------------------------------------------------------------------------------

    def change_settings(self, **changes: Unpack[SettingsChange]) -> None:
        """Change how the next run searches."""
        try:
            self._apply(edits.set_settings(self.document, **changes))
        except KirigamiError as error:
            self._refuse(error)

    def change_fabrication(self, **changes: Unpack[FabricationChange]) -> None:
        """Change how the design is cut."""
        self.fabricating.change(**changes)

    def end_drag(self) -> None:
        """A number was typed or dragged to its end: the next change is an undo step of its own."""
        self.history.end_drag()

    # generate ------------------------------------------------------------------------------------------------------

    def generate(self) -> None:
        """Start a run for the present target and settings; pinned designs stay where they fit."""
        if not self.hand.postpones(self.generate):
            self._start(self.collecting.anew)

    def again(self) -> None:
        """Draw more designs, from the next seed, beside those there are."""
        if not self.hand.postpones(self.again):
            self._start(self.collecting.more)

    def more_like(self, nearness: float) -> None:
        """Draw more designs near the chosen one, beside those there are."""
        if not self.hand.postpones(lambda: self.more_like(nearness)):
            self._start(lambda target: self.collecting.alike(target, nearness))

    def _start(self, planned: Callable[[Outline], Plan]) -> None:
        if self.running:
            return
        if self.document.target is None:
            self.message.emit(Message("Choose or draw a target first, then press Generate.", Tone.HINT))
            return
        try:
            plan = planned(self.document.target)
        except KirigamiError as error:
            self._refuse(error)
            return
        self._stop_finish()
        self.showing.begin_run(plan.kept, plan.joins)
        self.run.start(plan.request, plan.kept if plan.joins else None)
        self.status.emit(plan.says)

    def cancel(self) -> None:
        """Ask the run, or the trimming of a design, to stop; the document stays as it is."""
        if self.running:
            self.run.cancel()
            self.status.emit("Stopping …")
        elif self.finishing.busy:
            self.finishing.cancel()
        elif self.refitting.busy:
            self.refitting.cancel()

    def _take_result(self, result: Result, provenance: dict[str, str]) -> None:
        before = self.document
        self._apply(self.collecting.edit_for(result, provenance, self.showing.preview))
        if self.document is before:  # all of it was there already
            self.showing.show(before)
        self.status.emit(self.collecting.told(result, before))

    def _run_cancelled(self) -> None:
        self.showing.show(self.document)
        self.status.emit("Generation stopped; nothing was changed.")

    def _run_failed(self, sentence: str, trace: str) -> None:
        self.showing.show(self.document)
        self._tell_failure(sentence, trace)

    # choose --------------------------------------------------------------------------------------------------------

    def choose(self, candidate: Candidate) -> None:
        """Put a candidate on the stage; during a run it is only looked at."""
        if self.hand.postpones(lambda: self.choose(candidate)):
            return
        if self.running:
            self.showing.look_at(candidate)
        elif candidate in self.document.candidates:
            self._apply(edits.choose(self.document, self.document.candidates.index(candidate)))

    def compare(self, on: bool) -> None:
        """Find out how the design on the stage was drawn, or stop doing so."""
        stage = self.stage
        if on and stage is not None:
            self.comparing.look_up(stage.candidate, self.document.target)
        else:
            self.comparing.stop()

    def trim(self, on: bool) -> None:
        """Trim the chosen design to the target, or take its trim off."""
        if self.hand.postpones(lambda: self.trim(on)):
            return
        if self.running:
            self.message.emit(Message("Wait until the designs are done, then trim the one you choose.", Tone.HINT))
        else:
            self.finishing.switch(on)

    def _forget_stage(self, entry: Entry | None) -> None:
        """Another design is on the stage: what was asked for the one before is no longer wanted."""
        candidate = None if entry is None else entry.candidate
        self.finishing.stop_unless(candidate)
        self.refitting.stop_unless(candidate)

    def _stop_finish(self) -> None:
        """The design is about to change: what was being made of it belongs to the old one."""
        self.finishing.stop()
        self.refitting.stop()

    # cut -----------------------------------------------------------------------------------------------------------

    def export(self, path: Path) -> None:
        """Write the chosen design's cut file or picture; the extension says which."""
        if self.hand.postpones(lambda: self.export(path)):
            return
        order = self._order()
        if order is None:
            self.message.emit(Message("There is no design to export yet; generate one first.", Tone.HINT))
        else:
            if kind_of(path.suffix).cuts:
                self.preferring.remember(self.document)
            self.cutting.export(order, path)

    def export_all(self, folder: Path, name: str) -> None:
        """Write everything that there is of the chosen design into a folder."""
        if self.hand.postpones(lambda: self.export_all(folder, name)):
            return
        order = self._order()
        if order is not None:
            self.cutting.export_all(order, folder, name)

    def replan(self) -> None:
        """A material has changed on disk."""
        self.document_changed.emit(self.document)
        self._plan_soon()

    def _plan_soon(self) -> None:
        self.cutting.plan_soon(self._order())

    @property
    def order(self) -> steps.Order | None:
        """The design on the stage and how it is to be cut."""
        return self._order()

    def _order(self) -> steps.Order | None:
        stage, document = self.stage, self.document
        if stage is None:
            return None
        facts = design_facts(document, stage.candidate)
        return steps.Order(stage.candidate, stage.design.deployment, document.target, document.fabrication, facts)

    # project -------------------------------------------------------------------------------------------------------

    def save(self, path: Path) -> None:
        """Write the project file."""
        if not self.hand.postpones(lambda: self.save(path)):
            self.filing.storing.save(self.document, path)

    def _saved(self, path: Path, document: Document) -> None:
        self.path = path
        self.history.mark_saved(document)
        self.saved.emit(path)
        self.document_changed.emit(self.document)
        self.status.emit(f"Saved {path}.")

    def open_project(self, path: Path) -> None:
        """Read a project file."""
        self.filing.storing.open(path)

    def _opened(self, path: Path, document: Document) -> None:
        self._stop_design()
        self.path = None if path.is_relative_to(resource_root()) else path  # a bundled one is saved elsewhere
        self.history.restart(document)
        self.opened.emit(path)
        self._show()
        self.status.emit(f"Opened {path}.")

    def _work(self) -> Work:
        picture = self.targeting.tracing.picture_of(self.document.target)
        return Work(self.document, self.path, self.history.unsaved, picture)

    def _recovered(self, document: Document, path: Path | None) -> None:
        self._stop_design()
        self.path = path
        self.history.restart(document, saved=False)
        self._show()

    def new_project(self) -> None:
        """Forget everything and start empty."""
        self._stop_design()
        self.path = None
        self.history.restart(self.preferring.new_document())
        self._show()
        self.status.emit("New project. Choose or draw a target.")

    def undo(self) -> None:
        """Go one step back."""
        if self.hand.postpones(self.undo):
            return
        label = self.history.undo_label
        if self.history.undo():
            self._stop_design()
            self._show()
            self.status.emit(f"Undone: {label}.")

    def redo(self) -> None:
        """Go one undone step forth."""
        if self.hand.postpones(self.redo):
            return
        label = self.history.redo_label
        if self.history.redo():
            self._stop_design()
            self._show()
            self.status.emit(f"Redone: {label}.")

    def go_to(self, position: int) -> None:
        """Undo or redo until so many steps of the history are done."""
        if self.history.go_to(position):
            self._stop_design()
            self._show()
            label = self.history.undo_label
            self.status.emit(tr("Back at the start.") if label is None else tr("At the step: {label}.", label=label))

    def _stop_design(self) -> None:
        """Another document comes: what is still on its way belongs to the old one."""
        self.targeting.stop()
        self.hand.stop()
        self._stop_finish()
        self.run.abandon()

    # telling the views ---------------------------------------------------------------------------------------------

    def _begin(self, document: Document) -> None:
        self.history.restart(document)
        self._show()

    def _replace(self, edit: Edit) -> None:
        self._stop_design()
        self._apply(edit)

    def _adjust(self, edit: Edit) -> None:
        self.run.abandon()
        self._apply(edit)

    def _apply(self, edit: Edit) -> None:
        before = self.document
        if self.history.apply(edit):
            self.status.emit(f"{edit.label}.")
            self._show(before)

    def _show(self, before: Document | None = None) -> None:
        document = self.document
        self.document_changed.emit(document)
        if before is None or before.candidates is not document.candidates or before.target is not document.target:
            self.showing.show(document)
        elif before.chosen != document.chosen:
            self.showing.show_chosen(document)
        elif before.fabrication != document.fabrication:
            self._plan_soon()

    def refuse(self, error: KirigamiError) -> None:
        """Tell why nothing was changed."""
        self._refuse(error)

    def _refuse(self, error: KirigamiError) -> None:
        self.document_changed.emit(self.document)  # so that the control shows the value that holds
        self.message.emit(Message(str(error), Tone.ERROR))
        self.status.emit("Nothing was changed.")

    def _tell_failure(self, sentence: str, trace: str) -> None:
        self.message.emit(Message(sentence, Tone.ERROR, trace))
        self.status.emit("That did not succeed; nothing was changed.")
