"""The requests of the user: the parts, and those that concern several of them.

A request of one part goes to that part (``controller.generation.generate``, ``controller.fabrication.change``); here is
what has to stop, save or replace the work of several.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.resources import resource_root
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.files.filing import Filing
from kirigami_studio.gui.gallery.chosen_design import Refitter, SampledScores, TrimSwitch
from kirigami_studio.gui.make.cutting import CutPlanner, FabricationEditor
from kirigami_studio.gui.make.verdict import VerdictKeeper
from kirigami_studio.gui.run.generation import Generation
from kirigami_studio.gui.run.look_alikes import LookAlikes
from kirigami_studio.gui.run.regularity import Regularity
from kirigami_studio.gui.run.target_reader import TargetReader
from kirigami_studio.gui.session.collection import DesignLabels, DesignMarks
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.queue import JobCallbacks, JobQueue
from kirigami_studio.gui.session.session import Entry, Session
from kirigami_studio.gui.session.user_preferences import UserPreferences
from kirigami_studio.gui.stage.artwork import ArtworkKeeper
from kirigami_studio.gui.stage.as_cut import AsCutEstimates, AsCutReader
from kirigami_studio.gui.stage.curves import CurveReader
from kirigami_studio.gui.stage.gripping import GripFinder
from kirigami_studio.gui.stage.hand_editor import HandEditor
from kirigami_studio.gui.target.targeting import SecondReader, StartReader, Targeting
from kirigami_studio.project import edits
from kirigami_studio.project.document import Document
from kirigami_studio.project.edits import Edit, SettingsChange
from kirigami_studio.project.history import History
from kirigami_studio.studio import importing
from kirigami_studio.studio.file_kinds import kind_of
from kirigami_studio.studio.making import ANIMATION, CutRequest, Motion

if TYPE_CHECKING:
    from kirigami_studio.studio.fixes import Fix


class Controller(QObject):
    """Owns the session and the parts that work on it; goes on with the project of an ``earlier`` one that is closed.

    Attributes
    ----------
    session : Session
        Document, history, stage; the parts report to the user through it.
    hand, trimming, refitting, sampled, marks, labels, curves, as_cut
        What is done to the chosen design, or found out about it.
    generation, run
        Making designs, and the run that makes them.
    reader
        What the target's shape says before a run.
    regularity, alikes, estimates
        The balance of match and regularity over the designs, which of them look the same, which close as cut.
    fabrication, cutting, verdict
        The numbers a design is cut with, its cut plan and files, and what is to be expected of the sheet.
    targeting, filing, preferences
        The target, the project's files, the preferences.
    start, second
        Read start outlines and second targets.
    artwork
        What is printed on the sheet.
    """

    saved = Signal(Path)
    opened = Signal(Path)
    variants_known = Signal(tuple)  #: of str, the generators on offer

    def __init__(self, parent: QObject | None = None, earlier: Controller | None = None) -> None:
        super().__init__(parent)
        before: Session | None = None if earlier is None else earlier.session
        self.session: Session = Session(self, before)
        session = self.session
        self.hand = HandEditor(session, self)
        self.trimming = TrimSwitch(session, self)
        self.refitting = Refitter(session, self)
        self.sampled = SampledScores(session, self)
        self.marks = DesignMarks(session)
        self.labels = DesignLabels(session)
        self.curves = CurveReader(session, self)
        self.generation = Generation(session, self.hand, self)
        self.run = self.generation.run
        self.reader = TargetReader(session, self)
        self.run.grid_chosen.connect(self.reader.read_again)
        self.regularity = Regularity(session, self)
        self.alikes = LookAlikes(session, self)
        self.preferences = UserPreferences(session)
        self.fabrication = FabricationEditor(session, self.preferences.note_choice)
        self.cutting = CutPlanner(session, self)
        self.as_cut = AsCutReader(session, self)
        self.grips = GripFinder(session, self.as_cut, self)
        self.estimates = AsCutEstimates(session, self)
        self.verdict = VerdictKeeper(session, self.as_cut, self)
        self.targeting = Targeting(session, self)
        self.start = StartReader(session, self)
        self.second = SecondReader(session, self)
        self.artwork = ArtworkKeeper(session, self)
        self.filing = Filing(session, self.targeting, self)
        if earlier is not None:
            self.targeting.remember_sources(earlier.targeting)
        self._connect()

    def _connect(self) -> None:
        self.session.display.stage_changed.connect(self._stop_work_on_others)
        self.hand.drafted.connect(self._stop_work_on_design)
        self.cutting.answered.connect(self.as_cut.read)
        self.cutting.answered.connect(self.verdict.take_plan)
        self.cutting.refused.connect(lambda _: self.as_cut.forget())
        self.cutting.not_planned.connect(self.verdict.take_refusal)
        self.verdict.judged.connect(self.estimates.take_verdict)
        self.generation.begun.connect(self._stop_work_on_design)
        self.targeting.replaced.connect(self._replace_target)
        self.targeting.adjusted.connect(self._adjust_target)
        self.targeting.begun.connect(self._begin)
        self.filing.saved.connect(self._note_saved)
        self.filing.opened.connect(self._show_opened)
        self.filing.recovered.connect(self._show_recovered)

    @property
    def document(self) -> Document:
        """The present document."""
        return self.session.document

    @property
    def history(self) -> History:
        """The present document with the way back and forth."""
        return self.session.history

    @property
    def queue(self) -> JobQueue:
        """Runs the long work."""
        return self.session.queue

    @property
    def path(self) -> Path | None:
        """Where the project was saved or opened."""
        return self.session.path

    @property
    def stage(self) -> Entry | None:
        """The design that is shown large."""
        return self.session.stage

    @property
    def running(self) -> bool:
        """Whether candidates are being generated."""
        return self.run.running

    def close(self) -> None:
        """Stop all work; the window is going away."""
        self.reader.close()
        self.cutting.close()
        self.estimates.close()
        self.hand.close()
        self.queue.close()
        self.filing.close()

    # the start -----------------------------------------------------------------------------------------------------

    def use_preferences(self, path: Path) -> None:
        """Start with what was preferred the last time, and remember what is from now on."""
        untouched = self.document in (Document(), self.preferences.new_document()) and not self.history.steps
        self.preferences.load(path)
        if untouched:
            self.session.restart(self.preferences.new_document(), self.path)

    def warm_up(self) -> None:
        """Import in the worker what the first run needs, and learn which generators there are."""
        callbacks = JobCallbacks(self._on_variants, on_failed=self.session.report_failure)
        self.queue.start(tr("loading the generator"), importing.warming, callbacks)

    def _on_variants(self, variants: tuple[str, ...]) -> None:
        if variants:
            self.variants_known.emit(variants)

    def start_with(self, source: str) -> None:
        """Read the first target; it is where the history starts, not a change to be undone or saved."""
        self.targeting.start_with(source)

    # settings ------------------------------------------------------------------------------------------------------

    def change_settings(self, **changes: Unpack[SettingsChange]) -> None:
        """Change how the next run searches."""
        if "start" in changes:
            self.start.stop()
        if "second" in changes:
            self.second.stop()
        try:
            self.session.apply(edits.set_settings(self.document, **changes))
        except KirigamiError as error:
            self.session.refuse(error)

    def end_drag(self) -> None:
        """A number was typed or dragged to its end: the next change is an undo step of its own."""
        self.history.end_drag()

    # designs -------------------------------------------------------------------------------------------------------

    def cancel(self) -> None:
        """Ask the run, or the work on a design, to stop; the document stays as it is."""
        if self.running:
            self.generation.cancel()
        elif self.trimming.busy:
            self.trimming.cancel()
        elif self.refitting.busy:
            self.refitting.cancel()
        elif self.regularity.busy:
            self.regularity.cancel()

    def choose(self, candidate: Candidate) -> None:
        """Put a candidate on the stage; during a run it is only looked at."""
        if self.hand.postpones(lambda: self.choose(candidate)):
            return
        if self.running:
            self.session.display.look_at(candidate)
        elif candidate in self.document.candidates:
            self.session.apply(edits.choose(self.document, self.document.candidates.index(candidate)))

    def show_before(self, on: bool) -> None:
        """Find out how the design on the stage was sampled, or stop doing so."""
        stage = self.stage
        if on and stage is not None:
            self.sampled.look_up(stage.candidate, self.document.target)
        else:
            self.sampled.stop()

    def trim(self, on: bool) -> None:
        """Trim the chosen design to the target, or take its trim off."""
        if self.hand.postpones(lambda: self.trim(on)):
            return
        if self.running:
            text = tr("Wait for the run to finish, then trim a design.")
            self.session.post(Message(text, Tone.HINT))
        else:
            self.trimming.switch(on)

    def refit(self) -> None:
        """Fit the chosen design again."""
        if not self.running and not self.hand.postpones(self.refit):
            self.trimming.job.stop()
            self.refitting.start()

    def _stop_work_on_others(self, entry: Entry | None) -> None:
        """Another design is on the stage: work on the one before is no longer wanted."""
        candidate = None if entry is None else entry.candidate
        self.trimming.job.stop_unless(candidate)
        self.refitting.job.stop_unless(candidate)

    def _stop_work_on_design(self) -> None:
        """The design is about to change: what is being made of it belongs to the old one."""
        self.regularity.stop()
        self.trimming.job.stop()
        self.refitting.job.stop()
        self.as_cut.forget()
        self.verdict.forget()

    # cuts ----------------------------------------------------------------------------------------------------------

    def export(self, path: Path, motion: Motion = Motion.AS_CUT) -> None:
        """Write the chosen design's cut file or picture, by the extension; ``motion`` is what an animation shows."""
        if self.hand.postpones(lambda: self.export(path, motion)):
            return
        request = self.cutting.request
        if request is None:
            text = tr("No design to export yet. Generate one first.")
            self.session.post(Message(text, Tone.HINT))
        elif path.suffix.lower() == ANIMATION:
            self.cutting.animate(request, path, motion, self.as_cut.state.sheet)
        else:
            if kind_of(path.suffix).cuts:
                self.preferences.remember(self.document)
            self.cutting.export(self._with_as_cut(request), path)

    def export_all(self, folder: Path, name: str) -> None:
        """Write everything that there is of the chosen design into a folder."""
        if self.hand.postpones(lambda: self.export_all(folder, name)):
            return
        request = self.cutting.request
        if request is not None:
            self.cutting.export_all(self._with_as_cut(request), folder, name)

    def export_artwork(self, folder: Path) -> None:
        """Write the printed sheet into a folder."""
        if self.hand.postpones(lambda: self.export_artwork(folder)):
            return
        request = self.cutting.request
        if request is not None:
            self.cutting.export_artwork(request, folder)

    def _with_as_cut(self, request: CutRequest) -> CutRequest:
        """The request with how the design does as cut, if that is known."""
        sheet = self.as_cut.state.sheet
        return request if sheet is None else replace(request, as_cut=sheet.as_cut)

    def apply_fix(self, fix: Fix) -> None:
        """Make a change that was tried on the chosen design."""
        if not self.running and not self.hand.postpones(lambda: self.apply_fix(fix)):
            self.session.apply(fix.edit(self.document))
            self.end_drag()

    def replan(self) -> None:
        """A material has changed on disk."""
        self.session.document_changed.emit(self.document)
        self.verdict.forget_fixes()
        self.estimates.forget_verdicts()
        self.cutting.plan_soon()

    # the project ---------------------------------------------------------------------------------------------------

    def save(self, path: Path) -> None:
        """Write the project file."""
        if not self.hand.postpones(lambda: self.save(path)):
            self.filing.projects.save(path)

    def open_project(self, path: Path) -> None:
        """Read a project file."""
        self.filing.projects.open(path)

    def open_design(self, document: Document, source: str) -> None:
        """Take over the design that a cut file carries, as a project that is not saved yet."""
        self._stop_all()
        self.session.restart(document, None, saved=False)
        self.targeting.source_read.emit(source)
        self.session.set_status(tr("Opened the design that {name} was cut from.", name=Path(source).name))

    def new_project(self) -> None:
        """Forget everything and start empty."""
        self._stop_all()
        self.session.restart(self.preferences.new_document(), None)
        self.session.set_status(tr("New project. Choose or draw a target."))

    def undo(self) -> None:
        """Go one step back."""
        if self.hand.postpones(self.undo):
            return
        label = self.history.undo_label
        if self.history.undo():
            self._show_step(tr("Undone: {label}.", label=label))

    def redo(self) -> None:
        """Go one undone step forward."""
        if self.hand.postpones(self.redo):
            return
        label = self.history.redo_label
        if self.history.redo():
            self._show_step(tr("Redone: {label}.", label=label))

    def go_to(self, position: int) -> None:
        """Undo or redo until so many steps of the history are done."""
        if not self.hand.postpones(lambda: self.go_to(position)) and self.history.go_to(position):
            label = self.history.undo_label
            self._show_step(tr("Back at the start.") if label is None else tr("Now at step: {label}.", label=label))

    def _show_step(self, status: str) -> None:
        self._stop_all()
        self.session.announce()
        self.session.set_status(status)

    def _note_saved(self, path: Path, document: Document) -> None:
        self.session.path = path
        self.history.mark_saved(document)
        self.saved.emit(path)
        self.session.document_changed.emit(self.document)
        self.session.set_status(tr("Saved {path}.", path=path))

    def _show_opened(self, path: Path, document: Document) -> None:
        self._stop_all()
        bundled = path.is_relative_to(resource_root())
        self.session.restart(document, None if bundled else path)  # a bundled one is saved elsewhere
        self.opened.emit(path)
        self.session.set_status(
            tr("Opened the example {name}. Save keeps a copy of it.", name=path.stem)
            if bundled
            else tr("Opened {path}.", path=path)
        )

    def _show_recovered(self, document: Document, path: Path | None) -> None:
        self._stop_all()
        self.session.restart(document, path, saved=False)

    def _stop_all(self) -> None:
        """Another document comes: what is on its way belongs to the old one."""
        self.targeting.stop()
        self.start.stop()
        self.second.stop()
        self.artwork.stop()
        self.hand.stop()
        self._stop_work_on_design()
        self.run.abandon()

    # the target ----------------------------------------------------------------------------------------------------

    def _begin(self, document: Document) -> None:
        self.session.restart(document, self.path)

    def _replace_target(self, edit: Edit) -> None:
        before, was_running = self.document, self.running
        self._stop_all()
        self.session.apply(edit)
        self._show_after_run(was_running, before)

    def _adjust_target(self, edit: Edit) -> None:
        before, was_running = self.document, self.running
        self.run.abandon()
        self.session.apply(edit)
        self._show_after_run(was_running, before)

    def _show_after_run(self, was_running: bool, before: Document) -> None:
        """A run was given up for an edit that has changed nothing: its designs must not stay in sight."""
        if was_running and self.document is before:
            self.session.display.show()
