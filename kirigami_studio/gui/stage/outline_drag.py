"""Dragging a vertex of the outline: the window says where it is wanted, a thread of its own moves it there.

Steps are taken in a thread that gestures have to themselves, not in that of long work: there a cut plan, a fit or a
trim is one step that may last seconds, and the vertex would stand still so long.  Nor are they taken in the window's
thread when they are cheap: the first step of a drag never is, because it needs a derivative.  The thread is made at the
first drag and ends with the window.

No sheet is too large.  Processor seconds until the first answer, of which half is spent once for each kind of grid, and
for each step after it: 0.13 and 0.004 at 24 x 24 voids, 0.85 and 0.014 at 40 x 40, 5.5 and 0.03 at 64 x 64.

While a step is being taken, only the newest place is kept; its result is shown when it is complete, and only the
newest where there are several.  After the release, steps go on until the last place is reached; then the drag ends.

A :class:`Follower` is written to by the window and read by the worker, without a lock: a place is one attribute that is
replaced as a whole, and so is the newest result.  Places that were replaced before a step began are skipped.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.arrays import BoolArray
from kirigami_studio.foundation.steps import Cancel
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.queue import JobCallbacks, JobQueue, LatestJob

if TYPE_CHECKING:
    from kirigami_studio.polish.vertex_drag import VertexDrag

#: Most steps towards one place: two or three bring a vertex one cell further; at the edge of its reach they are short.
MOST_STEPS = 100
#: Processor seconds that the vertex has to arrive after the release, and steps that it gets in any case.
LAST_SECONDS, LAST_STEPS = 1.0, 4
#: A step that brings the vertex less than this (unit cells) nearer has not helped.
NEARER = 1e-3
#: Steps in a row that do not help before the vertex is as near as it gets: the second has a new derivative.
MAX_STALLED_STEPS = 2


@dataclass(frozen=True, slots=True, eq=False)
class DragStart:
    """A vertex when its drag began."""

    design: PosedDesign  #: as it was shown; its pose is kept for the whole drag
    phi: float  #: angle that was shown
    vertex: int  #: number in ``Deployment.outline(phi)``
    locked: BoolArray  #: (m, n); voids that are locked
    least_gap: float = 0.0  #: unit cells; distance that pins keep, 0 for sheets without pins


@dataclass(frozen=True, slots=True, eq=False)
class DragStep:
    """The design after a step."""

    design: PosedDesign
    arrived: bool  #: whether the vertex is where the pointer was when the step began
    stuck: bool  #: whether it comes no nearer: ratio limits, locked voids or panel collisions block it


class Follower:
    """Moves one vertex after the pointer."""

    def __init__(self, start: DragStart) -> None:
        self._start = start
        self._drag: VertexDrag | None = None
        self._wanted: tuple[int, tuple[float, float]] = (0, (0.0, 0.0))
        self._served = 0
        self._last, self._spent = False, 0.0
        self.newest: DragStep | None = None  #: what the last complete step has made

    def move_to(self, place: tuple[float, float]) -> None:
        """The pointer is at a place (x, y) in the world now."""
        self._wanted = (self._wanted[0] + 1, place)

    def release(self) -> None:
        """The button was released: the present place is the last; the vertex goes there, or as far as time allows."""
        self._last = True

    @property
    def waiting(self) -> bool:
        """Whether there is a place that has not been served."""
        return self._wanted[0] != self._served

    def steps(self, cancel: Cancel) -> Iterator[DragStep]:
        """Take steps until the newest place is reached, or as nearly as it can be."""
        number = taken = stalled = 0
        while self.waiting and not cancel():
            newest, place = self._wanted
            if newest != number:
                number, taken, stalled = newest, 0, 0
            last, began = self._last, time.thread_time()
            found, gain = self._step(place)
            self._spent += last * (time.thread_time() - began)
            taken, stalled = taken + 1, 0 if gain >= NEARER else stalled + 1
            late = self._spent >= LAST_SECONDS and last and taken >= LAST_STEPS
            stuck = not found.arrived and (stalled == MAX_STALLED_STEPS or taken == MOST_STEPS or late)
            if found.arrived or stuck:
                self._served = number
            self.newest = DragStep(found.design, found.arrived, stuck)
            yield self.newest

    def _step(self, place: tuple[float, float]) -> tuple[DragStep, float]:
        """One step towards a place in the world, and how much nearer (unit cells) it has brought the vertex."""
        from kirigami_studio.pipeline.redesign import drag_step
        from kirigami_studio.polish.vertex_drag import ARRIVED, VertexDrag

        start = self._start
        before = start.design if self.newest is None else self.newest.design
        if self._drag is None:
            sheet = start.design.deployment.sheet
            self._drag = VertexDrag(sheet, start.phi, start.vertex, start.locked, start.least_gap)
        drag = self._drag
        wanted = before.to_layout(place, start.phi)
        gap = drag.gap(wanted)
        drag_step(drag, wanted)
        design = PosedDesign(drag.deployment, start.design.pose, start.design.phi_target)
        left = drag.gap(design.to_layout(place, start.phi))  # the design keeps its middle, so that places shift
        return DragStep(design, left <= ARRIVED, stuck=False), gap - left


class OutlineDrag(QObject):
    """At most one drag at a time; owns the thread of gestures."""

    followed = Signal(DragStep)
    ended = Signal()  #: released, and the last place is reached
    failed = Signal(str, str)  #: sentence, trace

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._queue: JobQueue | None = None
        self._job: LatestJob[DragStep] | None = None
        self._follower: Follower | None = None
        self._shown: DragStep | None = None
        self._held = False

    @property
    def active(self) -> bool:
        """Whether a vertex is being dragged or still on its way."""
        return self._follower is not None

    @property
    def arriving(self) -> bool:
        """Whether the vertex was released and is still on its way."""
        return self.active and not self._held

    def begin(self, start: DragStart) -> None:
        """Begin to drag a vertex."""
        self.stop()
        self._follower, self._held = Follower(start), True

    def move(self, place: tuple[float, float]) -> None:
        """The pointer has moved to a place in the world."""
        if self._follower is not None and self._held:
            self._follower.move_to(place)
            self._go_on()

    def release(self) -> None:
        """The button was released; :attr:`ended` follows when the vertex has arrived."""
        if self._follower is not None:
            self._held = False
            self._follower.release()
            self._go_on()

    def stop(self) -> None:
        """Forget the drag; nothing more is reported about it."""
        if self._job is not None:
            self._job.stop()
        self._follower = self._shown = None
        self._held = False

    def close(self) -> None:
        """Stop, and wait for the thread to end: at most one step."""
        self.stop()
        if self._queue is not None:
            self._queue.close()

    def _go_on(self) -> None:
        follower = self._follower
        if follower is None or (self._job is not None and self._job.busy):
            return
        if follower.waiting:
            if self._job is None:
                self._queue = JobQueue(self, "kirigami-gestures")
                self._job = LatestJob[DragStep](self._queue)
            callbacks = JobCallbacks(self._show, self._go_on, on_failed=self._fail)
            self._job.start(tr("moving the outline"), follower.steps, callbacks)
        elif not self._held:
            self.stop()
            self.ended.emit()

    def _show(self, _: DragStep) -> None:
        """A step is complete; what it has made may have been shown already, with the step before."""
        newest = None if self._follower is None else self._follower.newest
        if newest is not None and newest is not self._shown:
            self._shown = newest
            self.followed.emit(newest)

    def _fail(self, sentence: str, trace: str) -> None:
        self.stop()
        self.failed.emit(sentence, trace)
