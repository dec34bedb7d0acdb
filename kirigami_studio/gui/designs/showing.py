"""Which designs the gallery shows and which one stands on the stage, from the document or from a run."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.designs.design_cache import DesignCache, Entry, same_sample
from kirigami_studio.gui.jobs import steps
from kirigami_studio.gui.jobs.queue import JobCallbacks, JobQueue
from kirigami_studio.pipeline.rank import rank_key
from kirigami_studio.project.document import Document


class Showing(QObject):
    """Decodes what it must and tells the views."""

    stage_changed = Signal(object)  #: Entry or None
    gallery_reset = Signal(object)  #: tuple of Entry
    candidate_found = Signal(object)  #: Entry
    settled = Signal()  #: the document's choice is on the stage
    failed = Signal(str, str)  #: sentence, trace

    def __init__(self, queue: JobQueue, cache: DesignCache, parent: QObject) -> None:
        super().__init__(parent)
        self._queue = queue
        self._cache = cache
        self._document = Document()
        self._stage: Entry | None = None
        self._preview: Candidate | None = None
        self._best_of_run: Entry | None = None
        self._decoding = 0  # number of the job

    @property
    def stage(self) -> Entry | None:
        """The design that is shown large."""
        return self._stage

    @property
    def preview(self) -> Candidate | None:
        """The candidate of the run that is being looked at, if the user has picked one."""
        return self._preview

    # during a run --------------------------------------------------------------------------------------------------

    def begin_run(self, kept: tuple[Candidate, ...] = (), stays: bool = False) -> None:
        """Make room for new designs beside those that are kept; ``stays`` leaves the chosen one on the stage."""
        self._queue.abandon(self._decoding)  # the document is shown again when the run is over
        self._preview, self._best_of_run = self._document.candidate if stays else None, None
        self.gallery_reset.emit(tuple(replace(self._cache.entry(candidate), kept=True) for candidate in kept))

    def look_at(self, candidate: Candidate) -> None:
        """Put a candidate of the run on the stage."""
        self._preview = candidate
        self._put_on_stage(self._cache.entry(candidate))

    def take_found(self, entry: Entry) -> None:
        """A new or improved candidate; the best one takes the stage unless the user looks at another."""
        self.candidate_found.emit(entry)
        looked_at = self._preview if self._preview not in self._document.candidates else None
        if looked_at is not None and same_sample(looked_at, entry.candidate):
            self._preview = entry.candidate
            self._put_on_stage(entry)
        best = self._best_of_run
        if best is None or rank_key(entry.candidate) < rank_key(best.candidate):
            self._best_of_run = entry
            if self._preview is None:
                self._put_on_stage(entry)

    # from the document ---------------------------------------------------------------------------------------------

    def show(self, document: Document) -> None:
        """Show the candidates of a document and the chosen one; those not seen before are decoded first."""
        self._document = document
        missing = self._cache.missing(document.candidates)
        if missing:
            callbacks = JobCallbacks(self._decoded, self._ready, on_failed=self.failed.emit)
            self._decoding = self._queue.start(tr("computing the layouts"), partial(steps.decoding, missing), callbacks)
        else:
            self._ready()

    def show_chosen(self, document: Document) -> None:
        """Show another choice among the same candidates."""
        self._document = document
        candidate = document.candidate
        if self._preview is not None:  # chosen while a run goes on: it stays chosen when the run is done
            self._preview = candidate
        self._put_on_stage(None if candidate is None else self._cache.entry(candidate))
        self.settled.emit()

    def _decoded(self, report: object) -> None:
        if isinstance(report, steps.Decoded):
            self._cache.put(report.candidate, report.deployment)

    def _ready(self) -> None:
        self.gallery_reset.emit(tuple(self._cache.entry(candidate) for candidate in self._document.candidates))
        self.show_chosen(self._document)

    def _put_on_stage(self, entry: Entry | None) -> None:
        if entry is not self._stage:
            self._stage = entry
            self.stage_changed.emit(entry)
