"""Targets that were traced from a picture: where each came from, and tracing it again at another threshold."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, cast

from PySide6.QtCore import QObject, Signal

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.jobs import steps
from kirigami_studio.gui.jobs.queue import JobCallbacks, JobQueue
from kirigami_studio.gui.jobs.slot import LatestJob
from kirigami_studio.gui.jobs.steps import Picture
from kirigami_studio.outlines.outline import Outline

if TYPE_CHECKING:
    from kirigami_studio.outlines.read_image import Traced

#: Outlines whose picture is remembered, so that undo brings its threshold back too.
CAPACITY = 256


class Tracing(QObject):
    """Traces one picture at a time; while it does, only the latest wish is kept."""

    traced = Signal(object)  #: Outline
    refused = Signal(str)
    settled = Signal()  #: the drag is over and its last threshold is traced

    def __init__(self, queue: JobQueue, parent: QObject) -> None:
        super().__init__(parent)
        self._pictures: OrderedDict[Outline, Picture] = OrderedDict()
        self._slot = LatestJob(queue)
        self._wanted: Picture | None = None
        self._drag_over = False

    def remember(self, outline: Outline, picture: Picture) -> None:
        """Keep where an outline came from."""
        self._pictures[outline] = picture
        self._pictures.move_to_end(outline)
        while len(self._pictures) > CAPACITY:
            self._pictures.popitem(last=False)

    def picture_of(self, outline: Outline | None) -> Picture | None:
        """The picture behind an outline, None when it was drawn, chosen from the library or read as lines."""
        return None if outline is None else self._pictures.get(outline)

    def retrace(self, picture: Picture, threshold: float | None) -> None:
        """Trace a picture at another threshold (0 black .. 1 white), None for the automatic one."""
        self._wanted = replace(picture, threshold=picture.automatic if threshold is None else threshold)
        if not self._slot.busy:
            self._start(self._wanted)

    def end_drag(self) -> None:
        """The slider was let go; its last threshold may still be on its way."""
        self._drag_over = True
        self._settle()

    def stop(self) -> None:
        """Forget what is still being traced: the target is another one now."""
        self._wanted, self._drag_over = None, False
        self._slot.stop()

    def _start(self, picture: Picture) -> None:
        callbacks = JobCallbacks(
            partial(self._take, picture), partial(self._go_on, picture), on_failed=partial(self._fail, picture)
        )
        self._slot.start(tr("tracing {name}", name=picture.path.name), partial(steps.tracing, picture), callbacks)

    def _take(self, picture: Picture, report: object) -> None:
        # By its shape, not by its type: the reader is imported in the worker, which takes a while.
        outline = getattr(report, "outline", None)
        if isinstance(outline, Outline):
            self.remember(outline, replace(picture, traced=cast("Traced", report)))
            self.traced.emit(outline)

    def _fail(self, picture: Picture, sentence: str, trace: str) -> None:
        self.refused.emit(sentence)
        self._go_on(picture)

    def _go_on(self, done: Picture) -> None:
        """Trace again when the slider has moved on in the meantime."""
        if self._wanted is not None and self._wanted != done:
            self._start(self._wanted)
        else:
            self._settle()

    def _settle(self) -> None:
        if self._drag_over and not self._slot.busy:
            self._drag_over = False
            self.settled.emit()
