"""How designs do as cut, found out in the worker: the one on the stage simulated, all others estimated."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QTimer, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.queue import JobCallbacks, LatestJob
from kirigami_studio.gui.session.session import Entry, Session
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.sheet_size import cut_for
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.designing import Judged, any_sheet, one_sheet
from kirigami_studio.studio.making import CutRequest, Estimated, MadePieces, Planned, estimating, simulating

if TYPE_CHECKING:
    from kirigami_studio.fabricate.material import Material
    from kirigami_studio.studio.as_cut import AsCut, SimulatedSheet
    from kirigami_studio.studio.verdict import Verdict

#: Sheets that are kept; one of 10 x 10 voids takes about half a megabyte.
CAPACITY = 32
#: Changes that follow each other faster than this (ms) lead to one estimate.
ESTIMATE_DELAY_MS = 250
#: A design, how it is cut, and its target.
Key = tuple[Candidate, FabricationSettings, Outline | None]


@dataclass(frozen=True, slots=True, eq=False)
class AsCutState:
    """What is known of the design on the stage."""

    sheet: SimulatedSheet | None = None
    busy: bool = False  #: whether it is being found out
    problem: str = ""  #: why it cannot be found out, "" if it can


UNKNOWN, BUSY = AsCutState(), AsCutState(busy=True)


class AsCutReader(QObject):
    """Closes at most one sheet at a time; a new plan takes the place of the one before."""

    changed = Signal(AsCutState)

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._job = LatestJob["SimulatedSheet | None"](session.queue)
        self._known: OrderedDict[Key, SimulatedSheet] = OrderedDict()
        self._candidate: Candidate | None = None
        self.state = UNKNOWN
        session.display.stage_changed.connect(self._on_stage)
        session.display.settled.connect(self._wait)
        session.fabrication_changed.connect(self._wait)

    @property
    def busy(self) -> bool:
        """Whether a sheet is being closed."""
        return self._job.busy

    def forget(self) -> None:
        """The design is about to be planned anew: stop, and say that nothing is known."""
        self._drop()
        self._say(UNKNOWN)

    def _drop(self) -> None:
        self._job.stop()
        self._candidate = None

    def _wait(self) -> None:
        """The design on the stage is about to be planned."""
        self._drop()
        self._say(UNKNOWN if self._session.stage is None else BUSY)

    def read(self, request: CutRequest, made: Planned | MadePieces) -> None:
        """Close a sheet whose cuts are planned, unless that was done; pins need none of it."""
        stage = self._session.stage
        if stage is None or stage.candidate != request.candidate:
            return
        if not isinstance(made, Planned):
            self.forget()
            return
        self._job.stop()
        self._candidate = request.candidate
        # What files are written for does not matter to the sheet.
        settings = one_sheet(request.settings)
        key = (request.candidate, settings, request.target)
        if key in self._known:
            self._known.move_to_end(key)
            self._say(AsCutState(self._known[key]))
            return
        callbacks = JobCallbacks(partial(self._on_result, key), on_failed=self._fail)
        self._job.start(tr("closing the sheet as cut"), partial(simulating, request, made), callbacks)
        self._say(BUSY)

    def _on_stage(self, entry: Entry | None) -> None:
        if entry is None or entry.candidate != self._candidate:
            self.forget()

    def _on_result(self, key: Key, found: SimulatedSheet | None) -> None:
        if found is None:
            return
        self._known[key] = found
        while len(self._known) > CAPACITY:
            self._known.popitem(last=False)
        self._say(AsCutState(found))

    def _fail(self, sentence: str, trace: str) -> None:
        self._say(AsCutState(problem=sentence))

    def _say(self, state: AsCutState) -> None:
        if state is not self.state:
            self.state = state
            self.changed.emit(state)


class AsCutEstimates(QObject):
    """Estimates for all designs of the gallery whether they close, once more when material, widths or style change.

    What was simulated, in a close look of the run or because a design was on the stage, takes the place of an estimate.
    """

    changed = Signal(object)  #: dict of Candidate to AsCut, as far as they are known
    judged = Signal()  #: the verdict on a design was made

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._job = LatestJob[Estimated](session.queue)
        self._entries: tuple[Entry, ...] = ()
        self._settings: FabricationSettings | None = None
        self.known: dict[Candidate, AsCut] = {}
        self.material: Material | None = None  #: that they were estimated in
        self._verdicts: dict[Candidate, tuple[FabricationSettings, Verdict]] = {}
        self._timer = QTimer(self, singleShot=True, interval=ESTIMATE_DELAY_MS)
        self._timer.timeout.connect(self._begin)
        session.display.gallery_reset.connect(self._on_entries)
        session.fabrication_changed.connect(self._forget_outdated)

    @property
    def busy(self) -> bool:
        """Whether designs are still to be estimated."""
        return self._job.busy or self._timer.isActive()

    @property
    def verdicts(self) -> dict[Candidate, Verdict]:
        """Those that were made of designs as they are cut now."""
        document = self._session.document
        return {
            candidate: verdict
            for candidate, (settings, verdict) in self._verdicts.items()
            if settings == one_sheet(cut_for(document, candidate))
        }

    @property
    def found(self) -> dict[Candidate, AsCut]:
        """Findings on designs as they are cut now; verdicts that were made overrule estimates."""
        made = {candidate: one.as_cut for candidate, one in self.verdicts.items() if one.as_cut is not None}
        return {**self.known, **made}

    def as_cut_of(self, candidate: Candidate) -> AsCut | None:
        """Findings on one design as it is cut now."""
        settings, verdict = self._verdicts.get(candidate, (None, None))
        made = None if verdict is None else verdict.as_cut
        if made is not None and settings == one_sheet(cut_for(self._session.document, candidate)):
            return made
        return self.known.get(candidate)

    def take_look(self, looked: Judged) -> None:
        """A run has looked closely at a design: that takes the place of an estimate."""
        if looked.as_cut is not None:
            self.known[looked.candidate] = looked.as_cut
        self.changed.emit(dict(self.known))

    def take_verdict(self, request: CutRequest, verdict: Verdict) -> None:
        """A design was judged, on the stage or for its card: from now on that is shown everywhere."""
        self._verdicts[request.candidate] = one_sheet(request.settings), verdict
        self.judged.emit()

    def forget_verdicts(self) -> None:
        """Materials have changed: verdicts that were made with them no longer hold."""
        self._verdicts.clear()
        self._forget_outdated()

    def close(self) -> None:
        """Estimate no more."""
        self._timer.stop()

    def _cut(self) -> FabricationSettings:
        """How designs are cut now."""
        return any_sheet(self._session.document.fabrication)

    def _forget_outdated(self) -> None:
        """The sheet is cut otherwise: nothing is shown that was found out about another."""
        if self._cut() != self._settings:
            self.known = {}
        self.changed.emit(dict(self.known))
        self._timer.start()

    def _on_entries(self, entries: tuple[Entry, ...]) -> None:
        self._entries = entries
        self._timer.start()

    def _begin(self) -> None:
        self._job.stop()
        document, settings, run = self._session.document, self._cut(), self._session.as_cut
        there = {entry.candidate for entry in self._entries}
        before = self.known
        if settings != self._settings:
            self._settings, self.known = settings, {}
        self.known = {candidate: found for candidate, found in self.known.items() if candidate in there}
        self._verdicts = {candidate: found for candidate, found in self._verdicts.items() if candidate in there}
        if run is not None and run.sheet == settings:  # closed on their connectors in the run
            self.known |= {candidate: found for candidate, found in run.simulated.items() if candidate in there}
        if before:
            self.changed.emit(dict(self.known))
        missing = tuple(
            (entry.candidate, entry.design.deployment, one_sheet(cut_for(document, entry.candidate)))
            for entry in self._entries
            if entry.candidate not in self.known
        )
        if missing:
            steps = partial(estimating, missing)
            self._job.start(tr("estimating the designs as cut"), steps, JobCallbacks(self._on_result, self._tell))

    def _on_result(self, report: Estimated) -> None:
        self.known.update(report.found)
        self.material = report.material

    def _tell(self) -> None:
        self.changed.emit(dict(self.known))
