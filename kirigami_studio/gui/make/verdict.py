"""The verdict on the design on the stage as it is cut now, and fixes for it, found in the worker."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.export.profile import DxfVersion
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.steps import Steps
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.queue import JobCallbacks, LatestJob
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.stage.as_cut import AsCutReader
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.designing import request_for
from kirigami_studio.studio.making import CutRequest, ExportedFiles, MadePieces, Planned, fixing, judging

if TYPE_CHECKING:
    from kirigami_studio.fabricate.cut_plan import CutPlan
    from kirigami_studio.pipeline.request import Request
    from kirigami_studio.studio.fixes import Advice
    from kirigami_studio.studio.verdict import Verdict

#: Designs and settings whose fixes are kept.
CAPACITY = 32


@dataclass(frozen=True, slots=True, eq=False)
class VerdictState:
    """What is known of the design on the stage."""

    verdict: Verdict | None = None  #: None without a design, and before its cuts are planned
    pending: bool = False  #: Whether the sheet is still being planned or closed on its connectors
    advice: Advice | None = None  #: Fixes that were tried, once they were
    searching: bool = False  #: Whether they are being tried

    @property
    def known(self) -> bool:
        """Whether there is something to show."""
        return self.verdict is not None or self.pending

    @property
    def lines(self) -> tuple[str, ...]:
        """The list that is shown: the verdict's own, each problem with the fix that was tried."""
        checking = tr("Checking the sheet as cut …")
        if self.verdict is None:
            return (checking,) if self.pending else ()
        level, *reasons = self.verdict.lines if self.advice is None else self.advice.lines_for(self.verdict)
        return (checking if self.pending else level, *reasons)


UNKNOWN, PENDING = VerdictState(), VerdictState(pending=True)


class VerdictKeeper(QObject):
    """Judges the design on the stage whenever its plan or its simulation is there; looks for fixes where it is not
    ready to cut.
    """

    changed = Signal(VerdictState)
    judged = Signal(CutRequest, object)  #: what is cut, and the Verdict on it

    def __init__(self, session: Session, as_cut: AsCutReader, parent: QObject) -> None:
        super().__init__(parent)
        self._session, self._as_cut = session, as_cut
        self._job = LatestJob["Verdict | Advice | None"](session.queue)
        self._known: OrderedDict[tuple[Candidate, FabricationSettings], Advice] = OrderedDict()
        self._planned: tuple[CutRequest, Planned] | None = None
        self._exported: tuple[CutPlan, Verdict] | None = None  #: the last plan whose files were read back
        self.state = UNKNOWN
        session.display.stage_changed.connect(self.forget)
        session.display.settled.connect(self._wait)
        session.fabrication_changed.connect(self._wait)
        as_cut.changed.connect(self._judge)

    @property
    def busy(self) -> bool:
        """Whether the verdict is still to come, or fixes are being tried."""
        return self.state.pending or self._job.busy

    def forget(self) -> None:
        """The design is about to change, or is not planned: nothing is known."""
        self._drop()
        self._say(UNKNOWN)

    def _drop(self) -> None:
        self._job.stop()
        self._planned = None

    def forget_fixes(self) -> None:
        """Materials have changed: what was found with them no longer holds."""
        self._known.clear()

    def _wait(self) -> None:
        """The design on the stage is about to be planned."""
        self._drop()
        self._say(UNKNOWN if self._session.stage is None else PENDING)

    def take_plan(self, request: CutRequest, made: Planned | MadePieces) -> None:
        """The cuts or the pieces of a design are planned and checked; pieces are judged already."""
        stage = self._session.stage
        if stage is None or stage.candidate != request.candidate:
            return
        if isinstance(made, Planned):
            self._planned = request, made
            self._judge()
            return
        self._drop()
        if not made.verdict.ok:
            self._try_fixes(request, made.verdict)
        self._take(request, made.verdict)

    def _try_fixes(self, request: CutRequest, verdict: Verdict) -> None:
        steps = partial(fixing, request, verdict, *self._alternatives(request))
        self._start(tr("trying fixes"), request, verdict, steps)

    def take_export(self, exported: ExportedFiles) -> None:
        """Take the verdict with the files that were read back; of several parts the shown one."""
        if exported.parts:
            for part in exported.parts:
                if self._planned is None or part.planned is None or part.planned.plan is self._planned[1].plan:
                    self.take_export(part)
            return
        if exported.pieces is not None and exported.verdict is not None and self.state.known:
            self._say(replace(self.state, verdict=exported.verdict))
        if exported.planned is None or exported.verdict is None:
            return
        self._exported = exported.planned.plan, exported.verdict
        found = self._of_files()
        if found is not None and self._planned is not None and not self.state.pending:
            self.judged.emit(self._planned[0], found)
            self._say(replace(self.state, verdict=found))

    def _of_files(self) -> Verdict | None:
        """The verdict with what was read back from files of the present plan."""
        if self._exported is None or self._planned is None or self._exported[0] is not self._planned[1].plan:
            return None
        return self._exported[1]

    def take_refusal(self, request: CutRequest, sentence: str) -> None:
        """The cuts of a design cannot be planned, for this reason."""
        from kirigami_studio.fabricate.findings import Problem
        from kirigami_studio.studio.verdict import Verdict

        self._planned = None
        verdict = Verdict((Problem.error("plan.refused", reason=sentence),))
        self._try_fixes(request, verdict)
        self._take(request, verdict)

    def _judge(self) -> None:
        if self._planned is None:
            return
        (request, made), state = self._planned, self._as_cut.state
        as_cut = state.problem or (None if state.sheet is None else state.sheet.as_cut)
        self._job.stop()
        self._say(VerdictState(made.verdict, pending=True))
        if as_cut is not None:
            steps = partial(judging, request, made, as_cut, *self._alternatives(request))
            self._start(tr("judging the sheet"), request, made.verdict, steps)

    def _alternatives(self, request: CutRequest) -> tuple[dict[str, Candidate], Request | None]:
        """Other designs by their names, and the run that would find coarser ones, if any."""
        document = self._session.document
        try:
            run = None if document.target is None else request_for(document.target, document.settings, request.settings)
        except KirigamiError:  # its material is gone, which the verdict tells
            run = None
        return document.named_candidates, run

    def _start(self, name: str, request: CutRequest, before: Verdict, steps: Steps[Verdict | Advice | None]) -> None:
        callbacks = JobCallbacks(partial(self._take, request), on_failed=partial(self._fail, before))
        self._job.start(name, steps, callbacks)

    def _take(self, request: CutRequest, report: Verdict | Advice | None) -> None:
        """A verdict, or what was tried for the one before."""
        from kirigami_studio.studio.verdict import Verdict

        if report is None:
            return
        # What files are written for does not matter to the sheet.
        key = request.candidate, replace(request.settings, profile="any", dxf_version=DxfVersion.R2010)
        if not isinstance(report, Verdict):
            self._known[key] = report
            while len(self._known) > CAPACITY:
                self._known.popitem(last=False)
            self._say(VerdictState(self.state.verdict, advice=report))
            return
        report = self._of_files() or report
        self.judged.emit(request, report)
        if report.ok:
            self._say(VerdictState(report))
        elif key in self._known:
            self._job.stop()
            self._known.move_to_end(key)
            self._say(VerdictState(report, advice=self._known[key]))
        else:
            self._say(VerdictState(report, searching=True))

    def _fail(self, before: Verdict, sentence: str, trace: str) -> None:
        """No fixes could be looked for; or the sheet could not even be judged, which is said."""
        from kirigami_studio.fabricate.findings import Problem

        if not self.state.pending:
            self._say(replace(self.state, searching=False))
            return
        not_judged = Problem.warning("verdict.not_made", reason=sentence)
        self._say(VerdictState(replace(before, problems=(*before.problems, not_judged))))
        self._session.report_failure(sentence, trace)

    def _say(self, state: VerdictState) -> None:
        if state is not self.state:
            self.state = state
            self.changed.emit(state)
