"""What a person can ask of the studio: each gesture becomes a named edit, a job, or a sentence on why not."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Unpack

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.designs.collection import Plan
from kirigami_studio.gui.file_kinds import kind_of
from kirigami_studio.gui.jobs import steps
from kirigami_studio.gui.jobs.queue import JobCallbacks
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.gui.workbench import Workbench
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project import edits
from kirigami_studio.project.edits import FabricationChange, SettingsChange


class Controller(Workbench):
    """The commands of the window."""

    def use_preferences(self, path: Path) -> None:
        """Start with what was preferred the last time, and remember what is from now on."""
        untouched = self.document == self.preferring.new_document()
        self.preferring.load(path)
        if untouched:
            self._restart(self.preferring.new_document())
            self.show()

    def warm_up(self) -> None:
        """Import in the worker what the first run needs, and learn which generators there are."""
        callbacks = JobCallbacks(self._take_warmth, on_failed=self.tell_failure)
        self.queue.start(tr("loading the generator"), steps.warming, callbacks)

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
            self.apply(edits.set_settings(self.document, **changes))
        except KirigamiError as error:
            self.refuse(error)

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
            self.message.emit(Message(tr("Choose or draw a target first, then press Generate."), Tone.HINT))
            return
        try:
            plan = planned(self.document.target)
        except KirigamiError as error:
            self.refuse(error)
            return
        self.stop_finish()
        self.showing.begin_run(plan.kept, plan.joins)
        self.run.start(plan.request, plan.kept if plan.joins else None)
        self.status.emit(plan.says)

    def cancel(self) -> None:
        """Ask the run, or the trimming of a design, to stop; the document stays as it is."""
        if self.running:
            self.run.cancel()
            self.status.emit(tr("Stopping …"))
        elif self.finishing.busy:
            self.finishing.cancel()
        elif self.refitting.busy:
            self.refitting.cancel()

    # choose --------------------------------------------------------------------------------------------------------

    def choose(self, candidate: Candidate) -> None:
        """Put a candidate on the stage; during a run it is only looked at."""
        if self.hand.postpones(lambda: self.choose(candidate)):
            return
        if self.running:
            self.showing.look_at(candidate)
        elif candidate in self.document.candidates:
            self.apply(edits.choose(self.document, self.document.candidates.index(candidate)))

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
            self.message.emit(Message(tr("Wait for the run to finish, then trim a design."), Tone.HINT))
        else:
            self.finishing.switch(on)

    # cut -----------------------------------------------------------------------------------------------------------

    def export(self, path: Path) -> None:
        """Write the chosen design's cut file or picture; the extension says which."""
        if self.hand.postpones(lambda: self.export(path)):
            return
        order = self.cut_request
        if order is None:
            self.message.emit(Message(tr("No design to export yet. Generate one first."), Tone.HINT))
        else:
            if kind_of(path.suffix).cuts:
                self.preferring.remember(self.document)
            self.cutting.export(order, path)

    def export_all(self, folder: Path, name: str) -> None:
        """Write everything that there is of the chosen design into a folder."""
        if self.hand.postpones(lambda: self.export_all(folder, name)):
            return
        order = self.cut_request
        if order is not None:
            self.cutting.export_all(order, folder, name)

    def replan(self) -> None:
        """A material has changed on disk."""
        self.document_changed.emit(self.document)
        self.plan_soon()

    # project -------------------------------------------------------------------------------------------------------

    def save(self, path: Path) -> None:
        """Write the project file."""
        if not self.hand.postpones(lambda: self.save(path)):
            self.filing.storing.save(self.document, path)

    def open_project(self, path: Path) -> None:
        """Read a project file."""
        self.filing.storing.open(path)

    def new_project(self) -> None:
        """Forget everything and start empty."""
        self.stop_design()
        self.path = None
        self._restart(self.preferring.new_document())
        self.show()
        self.status.emit(tr("New project. Choose or draw a target."))

    def undo(self) -> None:
        """Go one step back."""
        if self.hand.postpones(self.undo):
            return
        label = self.history.undo_label
        if self.history.undo():
            self.stop_design()
            self.show()
            self.status.emit(tr("Undone: {label}.", label=label))

    def redo(self) -> None:
        """Go one undone step forth."""
        if self.hand.postpones(self.redo):
            return
        label = self.history.redo_label
        if self.history.redo():
            self.stop_design()
            self.show()
            self.status.emit(tr("Redone: {label}.", label=label))

    def go_to(self, position: int) -> None:
        """Undo or redo until so many steps of the history are done."""
        if not self.hand.postpones(lambda: self.go_to(position)) and self.history.go_to(position):
            self.stop_design()
            self.show()
            label = self.history.undo_label
            self.status.emit(tr("Back at the start.") if label is None else tr("Now at step: {label}.", label=label))
