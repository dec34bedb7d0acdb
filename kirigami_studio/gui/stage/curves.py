"""The curves of the design on the stage, read in the worker while the plots are open."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.queue import JobCallbacks, LatestJob
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.stage.plot_jobs import Reading, plotting
from kirigami_studio.outlines.outline import Outline

#: Curves that are kept.
CAPACITY = 64


@dataclass(frozen=True, slots=True, eq=False)
class Curves:
    """What is known of one design so far, from the flat sheet on.

    ``cell_share`` is the width of a unit cell as a part of the flat sheet's width; ``complete`` says that no angle is
    missing.
    """

    readings: tuple[Reading, ...]
    cell_share: float
    complete: bool = False


class CurveReader(QObject):
    """Reads at most one design at a time; another design on the stage takes its place."""

    grown = Signal(object)  #: Curves of the design on the stage, or None

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._design: PosedDesign | None = None
        self._target: Outline | None = None
        self._wanted = False
        self._job = LatestJob[tuple[Reading, ...]](session.queue)
        self._known: OrderedDict[tuple[PosedDesign, Outline | None], Curves] = OrderedDict()

    @property
    def busy(self) -> bool:
        """Whether a design is being read."""
        return self._job.busy

    def show(self, design: PosedDesign | None, target: Outline | None) -> None:
        """Another design, or none, is on the stage."""
        if design is not self._design or target is not self._target:
            self._design, self._target = design, target
            self._begin()

    def want(self, wanted: bool) -> None:
        """Whether the plots are open."""
        self._wanted = wanted
        self._begin()

    def _begin(self) -> None:
        self.stop()
        design = self._design
        if not self._wanted or design is None:
            self.grown.emit(None)
            return
        known = self._known.get((design, self._target))
        if known is not None and known.complete:
            self.grown.emit(known)
            return
        begun = Curves((), 1.0 / float(np.ptp(design.deployment.compact[:, 0])))
        self._known[design, self._target] = begun
        self.grown.emit(begun)
        while len(self._known) > CAPACITY:
            self._known.popitem(last=False)
        callbacks = JobCallbacks(self._on_result, self._end, on_failed=self._session.report_failure)
        self._job.start(tr("computing the plots"), partial(plotting, design, self._target), callbacks)

    def stop(self) -> None:
        """Read no further."""
        self._job.stop()

    def _on_result(self, readings: tuple[Reading, ...]) -> None:
        self._grow(readings, complete=False)

    def _end(self) -> None:
        self._grow((), complete=True)

    def _grow(self, more: tuple[Reading, ...], complete: bool) -> None:
        if self._design is None:
            return
        key = (self._design, self._target)
        together = sorted(self._known[key].readings + more, key=lambda reading: -reading.phi)
        self._known[key] = replace(self._known[key], readings=tuple(together), complete=complete)
        self.grown.emit(self._known[key])
