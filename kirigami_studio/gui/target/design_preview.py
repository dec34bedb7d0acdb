"""Previews of the design while the target changes.

A quick fit in a thread of its own; the newest target alone counts.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from PySide6.QtCore import QObject, QTimer, Signal

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.run.generation import DesignRun
from kirigami_studio.gui.session.queue import JobCallbacks, JobQueue, LatestJob
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.session.user_preferences import UserPreferences
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.placed import Placed
from kirigami_studio.pipeline.request import Request
from kirigami_studio.studio.previewing import Preview, preview_for, previewing

#: Milliseconds without a change after which a preview begins: a slider that is dragged reports more often.
PAUSE_MS = 30


class DesignPreview(QObject):
    """Fits a sheet to the target on the board while nobody has asked for designs.

    There is none beside designs of a run, or while one goes on.

    Parameters
    ----------
    preferences : UserPreferences
        Keep whether previews are switched on.
    """

    found = Signal(object)  #: Preview; None while there is none
    refused = Signal(str)  #: why there is none, one sentence

    def __init__(self, session: Session, run: DesignRun, preferences: UserPreferences, parent: QObject) -> None:
        super().__init__(parent)
        self._session, self._run, self._preferences = session, run, preferences
        self._queue: JobQueue | None = None
        self._job: LatestJob[Preview] | None = None
        self._proposed: Outline | None = None
        self._asked: Request | str | None = None  # what is fitted, or why nothing is
        self._in_sight = True
        self._pause = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._pause.timeout.connect(self._start)
        session.document_changed.connect(self.refresh)
        run.started.connect(self.stop)
        run.ended.connect(self.refresh)

    @property
    def on(self) -> bool:
        """Whether previews are switched on."""
        return self._preferences.present.preview

    @property
    def busy(self) -> bool:
        """Whether a preview is being made, or about to be."""
        return self._pause.isActive() or (self._job is not None and self._job.busy)

    def switch(self) -> None:
        """Switch previews on or off, in the next window too."""
        self._preferences.keep(replace(self._preferences.present, preview=not self.on))
        self.refresh()

    def show_on(self, in_sight: bool) -> None:
        """The board comes into sight, or goes."""
        self._in_sight = in_sight
        self.refresh()

    def propose(self, placed: Placed | None) -> None:
        """Preview what the target would become while a slider is dragged; None for the target again."""
        self._proposed = None if placed is None else placed.outline
        self.refresh()

    def refresh(self) -> None:
        """Preview what is on the board now, unless that is what was asked for last."""
        asked = self._wanted_now()
        if asked == self._asked:
            return
        self.stop()
        self._asked = asked
        if isinstance(asked, str):
            self.refused.emit(asked)
        elif asked is not None:
            self._pause.start()

    def stop(self) -> None:
        """Stop the work and show nothing; what is asked for next begins anew."""
        self._pause.stop()
        self._asked = None
        if self._job is not None:
            self._job.stop()
        self.found.emit(None)

    def close(self) -> None:
        """The window is going away."""
        self._pause.stop()
        if self._queue is not None:
            self._queue.close()

    def _wanted_now(self) -> Request | str | None:
        """The request to preview, or why there is none, one sentence; None for nothing."""
        document = self._session.document
        target = self._proposed or document.target
        designed = self._proposed is None and bool(document.candidates)
        if target is None or designed or not (self._in_sight and self.on) or self._run.running:
            return None
        try:
            return preview_for(target, document.settings, document.fabrication)
        except KirigamiError as error:
            return str(error)

    def _start(self) -> None:
        if not isinstance(self._asked, Request):
            return
        if self._queue is None or self._job is None:
            self._queue = JobQueue(self, "kirigami-preview")
            self._job = LatestJob(self._queue)
        callbacks = JobCallbacks(self.found.emit, on_failed=self._fail)
        self._job.start(tr("previewing the design"), partial(previewing, self._asked), callbacks)

    def _fail(self, sentence: str, trace: str) -> None:
        self.refused.emit(sentence)
