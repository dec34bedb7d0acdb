"""What a target's shape says before any run: how symmetric it is, and which grid suits it."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QObject, QTimer, Signal

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.queue import JobCallbacks, LatestJob
from kirigami_studio.gui.session.session import Session
from kirigami_studio.pipeline.request import Request
from kirigami_studio.project.document import Document
from kirigami_studio.studio.designing import request_for
from kirigami_studio.studio.targets import TargetReading, reading_shape

#: Milliseconds without a change after which a target is read: drags of its outline are not followed.
PAUSE_MS = 250


class TargetReader(QObject):
    """Reads the target in the worker whenever target, angle, symmetry, start, sheet or material have changed.

    As long as they are those that a project was opened with, its designs' grid is the one that was chosen for them.
    """

    known = Signal(object)  #: TargetReading, or None while there is none

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._job = LatestJob[TargetReading](session.queue)
        self._asked: tuple[object, ...] | None = None
        self._request: Request | None = None
        self._project = -1  # number of the project that was read last
        self._opened: tuple[object, ...] | None = None  # what was asked when it was opened
        self._grid: tuple[int, int] | None = None  # chosen by the run that made its designs
        self._pause = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._pause.timeout.connect(self._read)
        session.document_changed.connect(self._follow)

    def close(self) -> None:
        """The window is going away."""
        self._pause.stop()
        self._job.stop()

    def read_again(self) -> None:
        """A run has chosen a grid by trying: that may be another one than was expected."""
        self._opened = self._grid = None
        if not self._pause.isActive():
            self._read()

    def _follow(self, document: Document) -> None:
        request = next_run(document)
        asked = None
        if request is not None:
            sheet = (request.width_mm, request.least_feature_mm, request.least_gap_mm)
            unfolding = () if request.start.is_plain else (request.grid, request.rim)
            asked = (request.target, request.phi, request.symmetry, request.start, *sheet, *unfolding)
        if self._session.project != self._project:
            self._project, self._opened = self._session.project, asked
        made = asked == self._opened and document.settings.auto_grid and bool(document.candidates)
        grid = document.settings.grid if made else None
        if (asked, grid) == (self._asked, self._grid):
            return
        self._asked, self._request, self._grid = asked, request, grid
        self._job.stop()
        self.known.emit(None)
        if request is None:
            self._pause.stop()
        else:
            self._pause.start()

    def _read(self) -> None:
        if self._request is not None:
            callbacks = JobCallbacks(self.known.emit, on_failed=self._session.report_failure)
            self._job.start(
                tr("reading the target's shape"), partial(reading_shape, self._request, self._grid), callbacks
            )


def next_run(document: Document) -> Request | None:
    """The run that the settings ask for, None where they ask for none."""
    if document.target is None:
        return None
    try:
        return request_for(document.target, document.settings, document.fabrication)
    except KirigamiError:
        return None
