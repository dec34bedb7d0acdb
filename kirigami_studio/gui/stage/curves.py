"""The curves of a design over the deployment angle: read in the worker while the plots are open."""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.porosity import Porosity
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.steps import Cancel
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.queue import JobCallbacks, LatestJob
from kirigami_studio.gui.session.session import Session
from kirigami_studio.lattice.deployment import ZIPPED_BELOW, rotate
from kirigami_studio.outlines.outline import Outline

#: Angles from pi to 0, evenly; the target angle comes in addition.
ANGLES = 61
#: The first pass takes every eighth of them, each further pass halves the distance.
FIRST_STRIDE = 8
#: Angles between two reports.
AT_ONCE = 4


@dataclass(frozen=True, slots=True)
class Reading:
    """One design at one angle."""

    phi: float  #: radians
    #: siou, iou: 0..1; as scored, in the pose that suits this angle best; not a number without a target.
    siou: float
    iou: float
    area: float  #: unit cells squared; inside the outline, voids included
    porosity: float  #: 0..1; share of that area that is voids
    #: width, height: unit cells; of the box around the sheet as it lies on the screen.
    width: float
    height: float
    gap: float  #: unit cells; narrowest bottleneck between parts of the outline; 0 in contact, not a number without any


def plotting(design: PosedDesign, target: Outline | None, cancel: Cancel) -> Iterator[tuple[Reading, ...]]:
    """Read a design at all angles, a coarse picture first."""
    import pyqtgraph  # noqa: F401 - takes a quarter of a second, which the window must not wait for

    for angles in batches(design.phi_target):
        yield readings(design, target, angles)


def batches(phi_target: float) -> list[list[float]]:
    """The target angle, then all others (radians), every eighth first; phi = 0 by itself: its outline has zipped."""
    even = np.linspace(math.pi, 0.0, ANGLES)
    order, seen, stride = [phi_target], {phi_target}, FIRST_STRIDE
    while stride >= 1:
        for phi in even[::stride].tolist():
            if phi not in seen:
                order.append(phi)
                seen.add(phi)
        stride //= 2
    open_, zipped = [phi for phi in order if phi >= ZIPPED_BELOW], [phi for phi in order if phi < ZIPPED_BELOW]
    made = [open_[start : start + AT_ONCE] for start in range(0, len(open_), AT_ONCE)]
    return [zipped, *made] if zipped else made


def readings(design: PosedDesign, target: Outline | None, angles: list[float]) -> tuple[Reading, ...]:
    """Read a design at some angles whose outlines have equally many vertices."""
    from kirigami_studio.evaluate.outline_gap import outline_gap
    from kirigami_studio.pipeline.redesign import matched

    sheet, found = design.deployment, []
    outlines, openness = [sheet.outline(phi) for phi in angles], Porosity.of(sheet)
    matches = [None] * len(angles) if target is None else matched(outlines, target)
    for phi, outline, match in zip(angles, outlines, matches, strict=True):
        gap = outline_gap(sheet, phi)
        width, height = np.ptp(rotate(outline, design.pose_at(phi).angle), axis=0).tolist()
        siou, iou = (math.nan, math.nan) if match is None else (match.siou, match.iou_exact)
        size = math.nan if gap is None else gap.size
        found.append(Reading(phi, siou, iou, openness.area(phi), openness.at(phi), width, height, size))
    return tuple(found)


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
