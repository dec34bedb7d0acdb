"""What is open in the window: the document with its history, its designs, the design on the stage.

The parts of the window share one :class:`Session`.  An edit goes ``apply`` -> history -> ``document_changed`` ->
:class:`DesignDisplay`, which decodes what is missing and emits what the views show.  Messages, status lines and
failures go through the session too.  It imports no widgets.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.fabricate.panel_sizes import least_panel_share
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.queue import JobCallbacks, JobQueue
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.symmetry import symmetry_of
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.project.document import Document
from kirigami_studio.project.edits import Edit
from kirigami_studio.project.history import History
from kirigami_studio.project.sheet_size import cut_for, sized
from kirigami_studio.project.target_parts import kept_to_scale
from kirigami_studio.studio.designing import Decoded, KnownAsCut, decoding, ranking_of

#: Designs whose motion is kept; one of 10 x 10 voids takes about 15 kB.
CAPACITY = 2048


@dataclass(frozen=True, slots=True, eq=False)
class Entry:
    """One card: a candidate with its decoded, posed design."""

    candidate: Candidate
    design: PosedDesign  #: with its final field, pose and angle: trimmed if the candidate is
    rise: float = 0.0  #: what polishing has added to its sIoU in the run that goes on
    kept: bool = False  #: whether it was there before the run that goes on


def same_sample(one: Candidate, other: Candidate) -> bool:
    """Whether two candidates are one sample of one generator, before and after polishing."""
    return _sample(one) == _sample(other)


def _sample(candidate: Candidate) -> tuple[str, int, int, Origin]:
    return candidate.variant, candidate.seed, candidate.index, candidate.origin


class DesignCache:
    """Keeps the most recently used motions, so that undo, redo and a new choice draw at once."""

    def __init__(self) -> None:
        self._motions: OrderedDict[Candidate, Deployment] = OrderedDict()
        self._entries: dict[Candidate, Entry] = {}

    def put(self, candidate: Candidate, deployment: Deployment) -> None:
        """Keep a motion that was decoded."""
        self._motions[candidate] = deployment
        self._motions.move_to_end(candidate)
        least_panel_share(deployment)  # measured now, one by one, so that sorting does not wait for it
        symmetry_of(candidate.sheet)
        while len(self._motions) > CAPACITY:
            dropped, _ = self._motions.popitem(last=False)
            self._entries.pop(dropped, None)

    def missing(self, candidates: tuple[Candidate, ...]) -> tuple[Candidate, ...]:
        """Those that have not been decoded yet."""
        return tuple(candidate for candidate in candidates if candidate not in self._motions)

    def entry(self, candidate: Candidate) -> Entry:
        """The card of a candidate, posed for the angle it was scored or trimmed at; decodes it when it must."""
        if candidate not in self._entries:
            if candidate not in self._motions:
                self.put(candidate, deploy(candidate.final_sheet))
            motion = self._motions[candidate]
            design = PosedDesign(motion, candidate.final_pose, candidate.final_phi, candidate.trim)
            self._entries[candidate] = Entry(candidate, design)
        return self._entries[candidate]


class DesignDisplay(QObject):
    """Which designs the gallery shows and which one is on the stage, from the document or from a run."""

    stage_changed = Signal(object)  #: Entry or None
    gallery_reset = Signal(tuple)  #: of Entry
    candidate_found = Signal(Entry)
    settled = Signal()  #: the document's choice is on the stage

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._session = session
        self._stage: Entry | None = None
        self._preview: Candidate | None = None
        self._best_of_run: Entry | None = None
        self.ranking = Ranking()  #: of the run that goes on
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

    def begin_run(self, kept: tuple[Candidate, ...] = (), stays: bool = False, ranking: Ranking | None = None) -> None:
        """Make room for new designs beside those that are kept, which are ranked as ``ranking`` says.

        ``stays`` leaves the chosen one on the stage; else a design that is not kept leaves it.
        """
        self.ranking = ranking or Ranking()
        self._session.queue.abandon(self._decoding)  # the document is shown again when the run is over
        self._preview, self._best_of_run = self._session.document.candidate if stays else None, None
        if not stays and self._stage is not None and self._stage.candidate not in kept:
            self._put_on_stage(None)  # it may be for another target, of another grid
        self.gallery_reset.emit(tuple(replace(self._session.cache.entry(candidate), kept=True) for candidate in kept))

    def look_at(self, candidate: Candidate) -> None:
        """Put a candidate of the run on the stage."""
        self._preview = candidate
        self._put_on_stage(self._session.cache.entry(candidate))

    def add(self, entry: Entry) -> None:
        """Show a new or improved candidate; the best one takes the stage unless the user looks at another."""
        self.candidate_found.emit(entry)
        looked_at = self._preview if self._preview not in self._session.document.candidates else None
        if looked_at is not None and same_sample(looked_at, entry.candidate):
            self._preview = entry.candidate
            self._put_on_stage(entry)
        best = self._best_of_run
        key = self.ranking.key
        if best is None or key(entry.candidate) < key(best.candidate):
            self._best_of_run = entry
            if self._preview is None:
                self._put_on_stage(entry)

    # from the document ---------------------------------------------------------------------------------------------

    def show(self) -> None:
        """Show the candidates of the document and the chosen one; those not seen before are decoded first."""
        session = self._session
        missing = session.cache.missing(session.document.candidates)
        if missing:
            callbacks = JobCallbacks(self._keep, self._show_all, on_failed=session.report_failure)
            self._decoding = session.queue.start(tr("computing the layouts"), partial(decoding, missing), callbacks)
        else:
            self._show_all()

    def show_chosen(self) -> None:
        """Show another choice among the same candidates."""
        candidate = self._session.document.candidate
        if self._preview is not None:  # chosen while a run goes on: it stays chosen when the run is done
            self._preview = candidate
        self._put_on_stage(None if candidate is None else self._session.cache.entry(candidate))
        self.settled.emit()

    def _keep(self, decoded: Decoded) -> None:
        self._session.cache.put(decoded.candidate, decoded.deployment)

    def _show_all(self) -> None:
        candidates = self._session.document.candidates
        self.gallery_reset.emit(tuple(self._session.cache.entry(candidate) for candidate in candidates))
        self.show_chosen()

    def _put_on_stage(self, entry: Entry | None) -> None:
        if entry is not self._stage:
            self._stage = entry
            self.stage_changed.emit(entry)


class Session(QObject):
    """The open project, the one way to change it and to report to the user.

    Parameters
    ----------
    earlier : Session, optional
        Of a closed window, whose project is the open one, with its history.
    """

    document_changed = Signal(Document)
    fabrication_changed = Signal()  #: nothing else has changed
    message_posted = Signal(Message)
    message_withdrawn = Signal(Message)
    status_changed = Signal(str)

    def __init__(self, parent: QObject | None = None, earlier: Session | None = None) -> None:
        super().__init__(parent)
        self.queue = JobQueue(self)  #: runs all long work but the drag of a vertex
        self.history: History = History() if earlier is None else earlier.history
        self.cache: DesignCache = DesignCache() if earlier is None else earlier.cache
        self.display = DesignDisplay(self)
        #: Where the project was saved or opened.
        self.path: Path | None = None if earlier is None else earlier.path
        #: SHA-256 of project files as they were read or written here last.
        self.on_disk: dict[Path, str] = {} if earlier is None else earlier.on_disk
        #: How many projects were open before this one.
        self.project: int = 0 if earlier is None else earlier.project
        #: What the latest run has found out about designs as cut.
        self.as_cut: KnownAsCut | None = None if earlier is None else earlier.as_cut

    @property
    def ranking(self) -> Ranking:
        """What the document puts first, with what the latest run has found out about its designs as cut."""
        return ranking_of(self.document, self.as_cut)

    @property
    def document(self) -> Document:
        """The present document."""
        return self.history.document

    @property
    def stage(self) -> Entry | None:
        """The design that is shown large."""
        return self.display.stage

    def width_of(self, candidate: Candidate | None) -> float:
        """Width of the flat sheet of a design, mm: each design opens to the size asked for."""
        document = self.document
        return (document.fabrication if candidate is None else cut_for(document, candidate)).width_mm

    # changing the document -----------------------------------------------------------------------------------------

    def apply(self, edit: Edit) -> None:
        """Make an edit part of the history and show what it changed."""
        before = self.document
        if self.history.apply(replace(edit, document=kept_to_scale(before, sized(edit.document)))):
            self.set_status(tr("Done: {label}.", label=edit.label))
            self.announce(before)

    def announce(self, before: Document | None = None) -> None:
        """Tell the views what has changed since ``before``, everything without it."""
        document = self.document
        self.document_changed.emit(document)
        if before is None or before.candidates is not document.candidates or before.target is not document.target:
            self.display.show()
        elif before.chosen != document.chosen:
            self.display.show_chosen()
        elif before.fabrication != document.fabrication:
            self.fabrication_changed.emit()

    def restart(self, document: Document, path: Path | None, saved: bool = True) -> None:
        """Begin with another project; nothing can be undone, and the views show all of it."""
        self.project += 1
        self.path = path
        self.history.restart(sized(document), saved)
        self.announce()

    # reporting to the user ------------------------------------------------------------------------------------------

    def post(self, message: Message) -> None:
        """Show a message above the columns."""
        self.message_posted.emit(message)

    def hint(self, sentence: str) -> None:
        """Show a sentence that helps on."""
        self.post(Message(sentence, Tone.HINT))

    def withdraw(self, message: Message) -> None:
        """Take a message away that no longer applies."""
        self.message_withdrawn.emit(message)

    def set_status(self, text: str) -> None:
        """Show a line at the bottom of the window."""
        self.status_changed.emit(text)

    def refuse(self, error: KirigamiError) -> None:
        """Say why nothing was changed."""
        self.document_changed.emit(self.document)  # so that the control shows the present value again
        self.post(Message(str(error), Tone.ERROR))
        self.set_status(tr("Nothing changed."))

    def report_failure(self, sentence: str, trace: str) -> None:
        """Say what went wrong, with the trace behind it."""
        self.post(Message(sentence, Tone.ERROR, trace))
        self.set_status(tr("That failed; nothing changed."))
