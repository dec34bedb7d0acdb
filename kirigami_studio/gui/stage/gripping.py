"""Where to hold the design on the stage and where to pull it, found out in the worker while the overlay is on."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.queue import JobCallbacks, LatestJob
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.stage.as_cut import AsCutReader, AsCutState
from kirigami_studio.studio.making import gripping

if TYPE_CHECKING:
    from kirigami_studio.mechanics.gripping import Gripping
    from kirigami_studio.studio.as_cut import SimulatedSheet

#: Sheets whose grips are kept.
CAPACITY = 32


@dataclass(frozen=True, slots=True, eq=False)
class GripState:
    """What is known of the grips of the design on the stage.

    Attributes
    ----------
    found : Gripping or None
    sheet : SimulatedSheet or None
        That they were found for.
    busy : bool
        Whether they are looked for.
    problem : str
        Why there are none, "" if that is not so.
    """

    found: Gripping | None = None
    sheet: SimulatedSheet | None = None
    busy: bool = False
    problem: str = ""


UNKNOWN = GripState()


class GripFinder(QObject):
    """Looks for the grips of one sheet at a time, and only while they are wanted."""

    changed = Signal(GripState)

    def __init__(self, session: Session, as_cut: AsCutReader, parent: QObject) -> None:
        super().__init__(parent)
        self._session, self._as_cut = session, as_cut
        self._job = LatestJob["Gripping | None"](session.queue)
        self._known: OrderedDict[SimulatedSheet, Gripping] = OrderedDict()
        self._wanted = False
        self.state = UNKNOWN
        as_cut.changed.connect(self._follow)

    def want(self, wanted: bool) -> None:
        """Whether they are shown."""
        if wanted != self._wanted:
            self._wanted = wanted
            self._follow(self._as_cut.state)

    def _follow(self, state: AsCutState) -> None:
        """The sheet as cut is another one, or is about to be."""
        self._job.stop()
        stage, sheet = self._session.stage, state.sheet
        if not self._wanted:
            self._say(UNKNOWN)
        elif sheet is None or stage is None:
            self._say(GripState(busy=state.busy, problem=state.problem))
        elif sheet in self._known:
            self._known.move_to_end(sheet)
            self._say(GripState(self._known[sheet], sheet))
        else:
            width = self._session.document.fabrication.width_mm
            steps = partial(gripping, sheet, stage.design.deployment, width)
            callbacks = JobCallbacks(partial(self._on_result, sheet), on_failed=self._fail)
            self._job.start(tr("looking for grips"), steps, callbacks)
            self._say(GripState(sheet=sheet, busy=True))

    def _on_result(self, sheet: SimulatedSheet, found: Gripping | None) -> None:
        if found is None:
            return
        self._known[sheet] = found
        while len(self._known) > CAPACITY:
            self._known.popitem(last=False)
        self._say(GripState(found, sheet))

    def _fail(self, sentence: str, trace: str) -> None:
        self._say(GripState(problem=sentence))

    def _say(self, state: GripState) -> None:
        self.state = state
        self.changed.emit(state)
