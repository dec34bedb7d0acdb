"""Dragging a vertex of the outline: the window says where it is wanted, a thread of its own moves it there.

Steps are taken in a thread that gestures have to themselves, not in that of long work: there a cut plan, a fit or a
trim is one step that may last seconds, and the vertex would stand still so long.  Nor are they taken in the window's
thread when they are cheap: the first step of a drag never is, because it needs a derivative.  The thread is made at the
first drag and ends with the window.

No sheet is too large.  Processor seconds until the first answer, of which half is spent once for each kind of grid, and
for each step after it: 0.13 and 0.004 at 24 x 24 voids, 0.85 and 0.014 at 40 x 40, 5.5 and 0.03 at 64 x 64.

While a step is being taken, only the newest place is kept; its result is shown when it is complete, and only the
newest where there are several.  After the release, steps go on until the last place is reached; then the drag ends.
"""

from __future__ import annotations

from PySide6.QtCore import QObject, Signal

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.queue import JobCallbacks, JobQueue, LatestJob
from kirigami_studio.gui.stage.vertex_drag import DragStart, DragStep, Follower


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
