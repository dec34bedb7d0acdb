"""The workbench behind the window: the history, the parts that work on it, and how their news become edits.

Whatever changes the document passes through :meth:`Workbench.apply`; long work goes to the job board.
"""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QObject, Signal

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.resources import resource_root
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.cuts.cutting import Cutting, Fabricating
from kirigami_studio.gui.designs.chosen_design import Comparing, Refitting, TrimJob
from kirigami_studio.gui.designs.collection import Collecting, Marking, StoppedRun
from kirigami_studio.gui.designs.design_cache import DesignCache, Entry
from kirigami_studio.gui.designs.design_run import DesignRun
from kirigami_studio.gui.designs.hand_editing import HandEditing
from kirigami_studio.gui.designs.plotting import Plotting
from kirigami_studio.gui.designs.showing import Showing
from kirigami_studio.gui.files.filing import Filing
from kirigami_studio.gui.files.recovering import Work
from kirigami_studio.gui.jobs import steps
from kirigami_studio.gui.jobs.queue import JobQueue
from kirigami_studio.gui.look.preferring import Preferring
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.gui.targets.targeting import Targeting
from kirigami_studio.pipeline.events import Result
from kirigami_studio.project.design_facts import design_facts
from kirigami_studio.project.document import Document
from kirigami_studio.project.edits import Edit
from kirigami_studio.project.history import History


class Workbench(QObject):
    """Holds the history and the parts, runs the jobs, tells the views."""

    document_changed = Signal(object)  #: Document
    variants_known = Signal(object)  #: tuple of str
    saved = Signal(object)  #: Path
    opened = Signal(object)  #: Path
    message = Signal(object)  #: Message
    status = Signal(str)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.queue = JobQueue(self)
        self.history = History()
        self.path: Path | None = None
        cache = DesignCache()
        self.showing = Showing(self.queue, cache, self)
        self.run = DesignRun(self.queue, cache, self)
        self.finishing = TrimJob(self.queue, cache, lambda: self.document, self)
        self.hand = HandEditing(self.queue, cache, lambda: self.document, self)
        self.refitting = Refitting(self.queue, cache, lambda: self.document, self)
        self.comparing = Comparing(self.queue, cache, self)
        self.fabricating = Fabricating(lambda: self.document, self)
        self.cutting = Cutting(self.queue, self)
        self.targeting = Targeting(self.queue, lambda: self.document, self)
        self.preferring = Preferring(self)
        self.collecting = Collecting(lambda: self.document, self)
        self.stopped = StoppedRun(lambda: self.document, self)
        self.marking = Marking(lambda: self.document, self)
        self.plotting = Plotting(self.queue, self)
        self.filing = Filing(self.queue, self._work, self.targeting, self)
        self._connect()

    def _connect(self) -> None:
        self.run.found.connect(self.showing.take_found)
        self.run.told.connect(self.status)
        self.run.completed.connect(self._take_result)
        self.run.cancelled.connect(self._run_cancelled)
        self.run.failed.connect(self._run_failed)
        self.stopped.kept.connect(self._take_result)
        self.document_changed.connect(self.stopped.follow)
        self.showing.settled.connect(self.plan_soon)
        self.showing.stage_changed.connect(self._forget_stage)
        self.fabricating.refused.connect(self.refuse)
        self.targeting.replaced.connect(self._replace)
        self.targeting.adjusted.connect(self._adjust)
        self.targeting.begun.connect(self._begin)
        self.targeting.settled.connect(self.history.end_drag)
        self.filing.saved.connect(self._saved)
        self.filing.opened.connect(self._opened)
        self.filing.recovered.connect(self._recovered)
        self.document_changed.connect(lambda _: self.filing.recovering.notice())
        self.hand.drafted.connect(self.stop_finish)
        for part in self._parts():
            self._hear(part)

    def _parts(self) -> tuple[QObject, ...]:
        making = (self.targeting, self.collecting, self.marking, self.finishing, self.fabricating, self.cutting)
        changing = (self.stopped, self.hand, self.refitting)
        return (self.showing, self.comparing, self.plotting, *making, *changing, self.preferring, self.filing)

    def _hear(self, part: QObject) -> None:
        """Take what a part proposes and says; not every part has all four signals."""
        takers = {"edited": self.apply, "message": self.message, "status": self.status, "failed": self.tell_failure}
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
        self.hand.close()
        self.queue.close()
        self.filing.close()

    # news of the parts ----------------------------------------------------------------------------------------------

    def _take_result(self, result: Result, provenance: dict[str, str]) -> None:
        before = self.document
        self.apply(self.collecting.edit_for(result, provenance, self.showing.preview))
        if self.document is before:  # all of it was there already
            self.showing.show(before)
        self.status.emit(self.collecting.told(result, before))

    def _run_cancelled(self) -> None:
        self.showing.show(self.document)
        self.status.emit(tr("Generation stopped; nothing changed."))
        self.stopped.offer(self.run.so_far())

    def _run_failed(self, sentence: str, trace: str) -> None:
        self.showing.show(self.document)
        self.tell_failure(sentence, trace)

    def _forget_stage(self, entry: Entry | None) -> None:
        """Another design is on the stage: what was asked for the one before is no longer wanted."""
        candidate = None if entry is None else entry.candidate
        self.finishing.stop_unless(candidate)
        self.refitting.stop_unless(candidate)

    def stop_finish(self) -> None:
        """The design is about to change: what was being made of it belongs to the old one."""
        self.finishing.stop()
        self.refitting.stop()

    def plan_soon(self) -> None:
        """The cuts of the design on the stage are to be planned anew."""
        self.cutting.plan_soon(self.cut_request)

    @property
    def cut_request(self) -> steps.CutRequest | None:
        """The design on the stage and how it is to be cut."""
        stage, document = self.stage, self.document
        if stage is None:
            return None
        facts = design_facts(document, stage.candidate)
        return steps.CutRequest(stage.candidate, stage.design.deployment, document.target, document.fabrication, facts)

    def _saved(self, path: Path, document: Document) -> None:
        self.path = path
        self.history.mark_saved(document)
        self.saved.emit(path)
        self.document_changed.emit(self.document)
        self.status.emit(tr("Saved {path}.", path=path))

    def _opened(self, path: Path, document: Document) -> None:
        self.stop_design()
        self.path = None if path.is_relative_to(resource_root()) else path  # a bundled one is saved elsewhere
        self._restart(document)
        self.opened.emit(path)
        self.show()
        self.status.emit(tr("Opened {path}.", path=path))

    def _work(self) -> Work:
        picture = self.targeting.tracing.picture_of(self.document.target)
        return Work(self.document, self.path, self.history.unsaved, picture)

    def _recovered(self, document: Document, path: Path | None) -> None:
        self.stop_design()
        self.path = path
        self._restart(document, saved=False)
        self.show()

    def _restart(self, document: Document, saved: bool = True) -> None:
        """Another project begins."""
        self.filing.storing.begin()
        self.history.restart(document, saved)

    def stop_design(self) -> None:
        """Another document comes: what is still on its way belongs to the old one."""
        self.targeting.stop()
        self.hand.stop()
        self.stop_finish()
        self.run.abandon()

    # telling the views ---------------------------------------------------------------------------------------------

    def _begin(self, document: Document) -> None:
        self._restart(document)
        self.show()

    def _replace(self, edit: Edit) -> None:
        before = self.document
        shows_run = self.running
        self.stop_design()
        self.apply(edit)
        self._show_after_run(shows_run, before)

    def _adjust(self, edit: Edit) -> None:
        before = self.document
        shows_run = self.running
        self.run.abandon()
        self.apply(edit)
        self._show_after_run(shows_run, before)

    def _show_after_run(self, shows_run: bool, before: Document) -> None:
        """A run was given up for an edit that has changed nothing: its designs must not stay in sight."""
        if shows_run and self.document is before:
            self.showing.show(before)

    def apply(self, edit: Edit) -> None:
        """Make an edit part of the history and show what it changed."""
        before = self.document
        if self.history.apply(edit):
            self.status.emit(f"{edit.label}.")
            self.show(before)

    def show(self, before: Document | None = None) -> None:
        """Tell the views what has changed since ``before``, everything without it."""
        document = self.document
        self.document_changed.emit(document)
        if before is None or before.candidates is not document.candidates or before.target is not document.target:
            self.showing.show(document)
        elif before.chosen != document.chosen:
            self.showing.show_chosen(document)
        elif before.fabrication != document.fabrication:
            self.plan_soon()

    def refuse(self, error: KirigamiError) -> None:
        """Tell why nothing was changed."""
        self.document_changed.emit(self.document)  # so that the control shows the value that holds
        self.message.emit(Message(str(error), Tone.ERROR))
        self.status.emit(tr("Nothing changed."))

    def tell_failure(self, sentence: str, trace: str) -> None:
        """Say what went wrong, with the trace behind it."""
        self.message.emit(Message(sentence, Tone.ERROR, trace))
        self.status.emit(tr("That failed; nothing changed."))
