"""How the design on the stage does as cut, found out in the worker once its cuts are planned."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.jobs.as_cut_jobs import simulating
from kirigami_studio.gui.jobs.cut_jobs import CutRequest, Planned
from kirigami_studio.gui.jobs.queue import JobCallbacks, LatestJob
from kirigami_studio.gui.session import Entry, Session
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.settings import FabricationSettings

if TYPE_CHECKING:
    from kirigami_studio.project.as_cut import SimulatedSheet

#: Sheets that are kept; one of 10 x 10 voids takes about half a megabyte.
CAPACITY = 32
#: A design, how it is cut, and its target.
Key = tuple[Candidate, FabricationSettings, Outline | None]


@dataclass(frozen=True, slots=True, eq=False)
class AsCutState:
    """What is known of the design on the stage.

    Attributes
    ----------
    sheet : SimulatedSheet or None
    busy : bool
        Whether it is being found out.
    problem : str
        Why it cannot be found out, "" if it can.
    """

    sheet: SimulatedSheet | None = None
    busy: bool = False
    problem: str = ""


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
        session.display.stage_changed.connect(self._take_stage)
        session.display.settled.connect(self._wait)
        session.fabrication_changed.connect(self._wait)

    @property
    def busy(self) -> bool:
        """Whether a sheet is being closed."""
        return self._job.busy

    def forget(self) -> None:
        """The design is about to be planned anew: stop, and say that nothing is known."""
        self._job.stop()
        self._candidate = None
        self._say(UNKNOWN)

    def _wait(self) -> None:
        """The design on the stage is about to be planned."""
        self.forget()
        if self._session.stage is not None:
            self._say(BUSY)

    def read(self, request: CutRequest, made: Planned) -> None:
        """Close a sheet whose cuts are planned, unless that was done before."""
        stage = self._session.stage
        if stage is None or stage.candidate != request.candidate:
            return
        self._job.stop()
        self._candidate = request.candidate
        # What files are written for does not matter to the sheet.
        settings = replace(request.settings, profile="any", dxf_version="R2010")
        key = (request.candidate, settings, request.target)
        if key in self._known:
            self._known.move_to_end(key)
            self._say(AsCutState(self._known[key]))
            return
        callbacks = JobCallbacks(partial(self._take, key), on_failed=self._fail)
        self._job.start(tr("closing the sheet as cut"), partial(simulating, request, made), callbacks)
        self._say(BUSY)

    def _take_stage(self, entry: Entry | None) -> None:
        if entry is None or entry.candidate != self._candidate:
            self.forget()

    def _take(self, key: Key, found: SimulatedSheet | None) -> None:
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
