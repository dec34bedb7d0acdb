"""Gesture -> named edit on the frozen document -> history -> signals to the views.

The only place of the window that changes the document.  Long work goes to the job board; what it brings back becomes
an edit here, or a message.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Unpack

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.gui.cutting import Cutting
from kirigami_studio.gui.design_run import DesignRun
from kirigami_studio.gui.jobs import steps
from kirigami_studio.gui.jobs.board import Board, Ears
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.gui.reading import Reading
from kirigami_studio.gui.shelf import Shelf
from kirigami_studio.gui.tracing import Tracing
from kirigami_studio.gui.views.gallery_model import Entry, same_sample
from kirigami_studio.pipeline.events import Result
from kirigami_studio.pipeline.rank import rank_key
from kirigami_studio.pipeline.request import Request
from kirigami_studio.project import edits
from kirigami_studio.project.document import Document
from kirigami_studio.project.edits import Edit, FabricationChange, SettingsChange
from kirigami_studio.project.history import History
from kirigami_studio.target.outline import Outline

FloatArray = npt.NDArray[np.float64]


class Controller(QObject):
    """Holds the history, runs the jobs, tells the views."""

    document_changed = Signal(object)  #: Document
    stage_changed = Signal(object)  #: Entry or None
    gallery_reset = Signal(object)  #: tuple of Entry
    candidate_found = Signal(object)  #: Entry
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
        self._shelf = Shelf()
        self.run = DesignRun(self.board, self._shelf, self)
        self.cutting = Cutting(self.board, self)
        self.tracing = Tracing(self.board, self)
        self.reading = Reading(self.board, self.tracing, self)
        self._stage: Entry | None = None
        self._preview: Candidate | None = None
        self._best_of_run: Entry | None = None
        self.run.found.connect(self._take_found)
        self.run.completed.connect(self._take_result)
        self.run.cancelled.connect(self._run_cancelled)
        self.run.failed.connect(self._run_failed)
        self.reading.read.connect(self._take_read)
        self.reading.failed.connect(self._tell_failure)
        self.tracing.traced.connect(self._take_traced)
        self.tracing.refused.connect(self.status)
        self.tracing.settled.connect(self.end_drag)
        self.cutting.message.connect(self.message)
        self.cutting.status.connect(self.status)

    @property
    def document(self) -> Document:
        return self.history.document

    @property
    def stage(self) -> Entry | None:
        """The design that is shown large."""
        return self._stage

    @property
    def running(self) -> bool:
        """Whether candidates are being generated."""
        return self.run.running

    def close(self) -> None:
        """Stop all work; the window is going away."""
        self.cutting.close()
        self.board.close()

    def warm_up(self) -> None:
        """Import in the worker what the first run needs, and learn which generators there are."""
        ears = Ears(self._take_warmth, on_failed=self._tell_failure)
        self.board.start("loading the generator", steps.warming, ears)

    def _take_warmth(self, report: object) -> None:
        if isinstance(report, tuple):
            self.variants_known.emit(report)

    # target --------------------------------------------------------------------------------------------------------

    def open_target(self, source: str, first: bool = False) -> None:
        """Read a file, or a silhouette of the library by name."""
        self.status.emit(f"Reading {Path(source).name} …")
        self.reading.start(source, first)

    def start_with(self, source: str) -> None:
        """Read the first target; it is where the history starts, not a change to be undone or saved."""
        self.open_target(source, first=True)

    def change_threshold(self, threshold: float | None) -> None:
        """Trace the target's picture again at another grey level, 0..1; None for the automatic one."""
        picture = self.tracing.picture_of(self.document.target)
        if picture is not None:
            self.tracing.retrace(picture, threshold)

    def take_freehand(self, points: FloatArray) -> None:
        """Smooth a stroke (L, 2), y up, into a target."""
        from kirigami_studio.target.editing import smooth_freehand

        self._draw(lambda: smooth_freehand(points).renamed("drawing"))

    def take_polygon(self, points: FloatArray) -> None:
        """Make corners (L, 2), y up, a target."""
        self._draw(lambda: Outline.from_points(points, name="polygon"))

    def clear_target(self) -> None:
        """Start over with an empty target."""
        document = self.document
        if document.target is not None:
            empty = Document(settings=document.settings, fabrication=document.fabrication)
            self._stop_design()
            self._apply(Edit("Clear target", empty))
            self.status.emit("Target cleared. Undo brings it back.")

    def _draw(self, make: Callable[[], Outline]) -> None:
        try:
            outline = make()
        except KirigamiError as error:
            self._refuse(error)
            return
        self._take_target(outline)

    def _take_traced(self, outline: Outline) -> None:
        self.run.abandon()
        self._apply(edits.edit_target(self.document, outline, "Change threshold"))
        self.status.emit(f"{len(outline.points)} points at this threshold.")

    def _take_target(self, outline: Outline) -> None:
        self._stop_design()
        self._apply(edits.set_target(self.document, outline))
        self.status.emit(f"Target: {outline.name}. Press Generate (Ctrl+G) to design a sheet for it.")

    def _take_read(self, outline: Outline, first: bool) -> None:
        if first and self.document == Document():
            self.history.restart(Document(target=outline))
            self._show()
            self.status.emit(f"Target: {outline.name}. Press Generate (Ctrl+G), or choose another target.")
        else:
            self._take_target(outline)

    # settings ------------------------------------------------------------------------------------------------------

    def change_settings(self, **changes: Unpack[SettingsChange]) -> None:
        """Change how the next run searches."""
        try:
            self._apply(edits.set_settings(self.document, **changes))
        except KirigamiError as error:
            self._refuse(error)

    def change_fabrication(self, **changes: Unpack[FabricationChange]) -> None:
        """Change how the design is cut."""
        try:
            self._apply(edits.set_fabrication(self.document, **changes))
        except KirigamiError as error:
            self._refuse(error)

    def end_drag(self) -> None:
        """A number was typed or dragged to its end: the next change is an undo step of its own."""
        self.history.end_drag()

    # generate ------------------------------------------------------------------------------------------------------

    def generate(self) -> None:
        """Start a run for the present target and settings."""
        document, settings = self.document, self.document.settings
        if self.running:
            return
        if document.target is None:
            self.message.emit(Message("Choose or draw a target first, then press Generate.", Tone.HINT))
            return
        try:
            request = Request(
                document.target,
                settings.grid,
                settings.phi,
                settings.k,
                settings.seed,
                settings.variant,
                settings.steps,
                settings.polish,
            )
        except KirigamiError as error:
            self._refuse(error)
            return
        self._preview, self._best_of_run = None, None
        self.gallery_reset.emit(())
        self.run.start(request)
        self.status.emit(f"Generating {request.k} designs for {request.target.name} …")

    def cancel(self) -> None:
        """Ask the run to stop; the document stays as it is."""
        if self.running:
            self.run.cancel()
            self.status.emit("Stopping …")

    def _take_found(self, entry: Entry) -> None:
        self.candidate_found.emit(entry)
        best = self._best_of_run
        if self._preview is not None and same_sample(self._preview, entry.candidate):
            self._preview = entry.candidate
            self._set_stage(entry)
        if best is None or rank_key(entry.candidate) < rank_key(best.candidate):
            self._best_of_run = entry
            if self._preview is None:
                self._set_stage(entry)

    def _take_result(self, result: Result, provenance: dict[str, str]) -> None:
        edit = edits.set_candidates(self.document, result.candidates, provenance, result.request.target)
        if self._preview is not None and self._preview in result.candidates:
            chosen = edits.choose(edit.document, result.candidates.index(self._preview))
            edit = Edit(edit.label, chosen.document)
        self._apply(edit)
        score = result.best.score
        self.status.emit(
            f"{len(result.candidates)} designs in {result.seconds:.1f} s. Best: sIoU {100 * score.siou:.1f} %, "
            f"{100 * score.siou_gain:+.1f} over the uniform sheet."
        )

    def _run_cancelled(self) -> None:
        self._show_candidates()
        self.status.emit("Generation stopped; nothing was changed.")

    def _run_failed(self, sentence: str, trace: str) -> None:
        self._show_candidates()
        self._tell_failure(sentence, trace)

    # choose --------------------------------------------------------------------------------------------------------

    def choose(self, candidate: Candidate) -> None:
        """Put a candidate on the stage; during a run it is only looked at."""
        if self.running:
            self._preview = candidate
            self._set_stage(self._shelf.entry(candidate))
        elif candidate in self.document.candidates:
            self._apply(edits.choose(self.document, self.document.candidates.index(candidate)))

    def _set_stage(self, entry: Entry | None) -> None:
        if entry is not self._stage:
            self._stage = entry
            self.stage_changed.emit(entry)

    # cut -----------------------------------------------------------------------------------------------------------

    def export(self, path: Path) -> None:
        """Write the chosen design's cut file or picture; the extension says which."""
        stage, document = self._stage, self.document
        if stage is None:
            self.message.emit(Message("There is no design to export yet; generate one first.", Tone.HINT))
            return
        order = steps.Order(stage.candidate, stage.design.deployment, document.target, document.fabrication)
        self.cutting.export(order, path)

    def _plan_soon(self) -> None:
        deployment = None if self._stage is None else self._stage.design.deployment
        self.cutting.plan_soon(deployment, self.document.fabrication)

    # project -------------------------------------------------------------------------------------------------------

    def save(self, path: Path) -> None:
        """Write the project file."""
        work = partial(steps.saving, self.document, path)
        self.status.emit(f"Saving {path.name} …")
        self.board.start(f"saving {path.name}", work, Ears(self._saved, on_failed=self._tell_failure))

    def _saved(self, path: object) -> None:
        if isinstance(path, Path):
            self.path = path
            self.history.mark_saved()
            self.saved.emit(path)
            self.document_changed.emit(self.document)
            self.status.emit(f"Saved {path}.")

    def open_project(self, path: Path) -> None:
        """Read a project file."""
        self.status.emit(f"Opening {path.name} …")
        ears = Ears(lambda document: self._opened(path, document), on_failed=self._tell_failure)
        self.board.start(f"opening {path.name}", partial(steps.loading, path), ears)

    def _opened(self, path: Path, document: object) -> None:
        if isinstance(document, Document):
            self._stop_design()
            self.path = path
            self.history.restart(document)
            self.opened.emit(path)
            self._show()
            self.status.emit(f"Opened {path}.")

    def new_project(self) -> None:
        """Forget everything and start empty."""
        self._stop_design()
        self.path = None
        self.history.restart(Document())
        self._show()
        self.status.emit("New project. Choose or draw a target.")

    def undo(self) -> None:
        """Go one step back."""
        label = self.history.undo_label
        if self.history.undo():
            self._stop_design()
            self._show()
            self.status.emit(f"Undone: {label}.")

    def redo(self) -> None:
        """Go one undone step forth."""
        label = self.history.redo_label
        if self.history.redo():
            self._stop_design()
            self._show()
            self.status.emit(f"Redone: {label}.")

    def _stop_design(self) -> None:
        """Another document comes: what is still on its way belongs to the old one."""
        self.reading.stop()
        self.tracing.stop()
        self.run.abandon()

    # telling the views ---------------------------------------------------------------------------------------------

    def _apply(self, edit: Edit) -> None:
        before = self.document
        if not self.history.apply(edit):
            return
        self._show(before)

    def _show(self, before: Document | None = None) -> None:
        document = self.document
        self.document_changed.emit(document)
        if before is None or before.candidates is not document.candidates or before.target is not document.target:
            self._show_candidates()
        elif before.chosen != document.chosen:
            self._show_chosen()
        elif before.fabrication != document.fabrication:
            self._plan_soon()

    def _show_candidates(self) -> None:
        missing = self._shelf.missing(self.document.candidates)
        if missing:
            ears = Ears(self._decoded, self._candidates_ready, on_failed=self._tell_failure)
            self.board.start("decoding the designs", partial(steps.decoding, missing), ears)
        else:
            self._candidates_ready()

    def _decoded(self, report: object) -> None:
        if isinstance(report, steps.Decoded):
            self._shelf.put(report.candidate, report.deployment)

    def _candidates_ready(self) -> None:
        self.gallery_reset.emit(tuple(self._shelf.entry(candidate) for candidate in self.document.candidates))
        self._show_chosen()

    def _show_chosen(self) -> None:
        candidate = self.document.candidate
        self._set_stage(None if candidate is None else self._shelf.entry(candidate))
        self._plan_soon()

    def _refuse(self, error: KirigamiError) -> None:
        self.document_changed.emit(self.document)  # so that the control shows the value that holds
        self.message.emit(Message(str(error), Tone.ERROR))
        self.status.emit("Nothing was changed.")

    def _tell_failure(self, sentence: str, trace: str) -> None:
        self.message.emit(Message(sentence, Tone.ERROR, trace))
        self.status.emit("That did not succeed; nothing was changed.")
