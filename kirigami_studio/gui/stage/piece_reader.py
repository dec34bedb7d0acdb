"""Pieces of the designs in sight, made in the worker one after the other."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QTimer, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.export.artwork import Artwork
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.queue import JobCallbacks, LatestJob
from kirigami_studio.gui.session.session import Entry, Session
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Document
from kirigami_studio.project.sheet_size import cut_for
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.designing import one_sheet
from kirigami_studio.studio.making import CutRequest, MadePieces, PicturedPieces, Planned, has_pieces, picturing

if TYPE_CHECKING:
    from kirigami_studio.assembly.posed_pieces import PosedPieces

#: Cards that have scrolled out of sight wait no longer when so many others were asked for since.
MOST_WAITING = 24
#: Milliseconds without another wish, or another change of the settings, before designs are made.
DELAY_MS = 120


class PieceReader(QObject):
    """Pieces of designs as they are cut now; earlier ones are shown until these are there.

    Nothing is made while a run goes on: its designs are not final.

    Parameters
    ----------
    running : callable
        Whether a run goes on.
    """

    changed = Signal()  #: pieces are there that were not, or those that were shown no longer hold
    judged = Signal(CutRequest, object)  #: the Verdict on pieces that were made

    def __init__(self, session: Session, running: Callable[[], bool], parent: QObject) -> None:
        super().__init__(parent)
        self._session, self._running = session, running
        self._job = LatestJob[PicturedPieces](session.queue)
        # How they are cut; None where artwork has changed since.
        self._known: dict[Candidate, tuple[FabricationSettings | None, PosedPieces | None]] = {}
        self._target: Outline | None = None
        self._artwork: Artwork | None = None
        self._document: Document | None = None  # that the following belongs to
        self._made_of_pieces, self._cut = False, FabricationSettings()
        self._cuts: dict[Candidate, FabricationSettings] = {}  # of designs that were asked for
        self._waiting: dict[Candidate, None] = {}
        self._in_work: dict[Candidate, FabricationSettings] = {}  # the design whose pieces are being made
        self._timer = QTimer(self, singleShot=True, interval=DELAY_MS)
        self._timer.timeout.connect(self._begin)
        session.display.gallery_reset.connect(self._keep)
        session.fabrication_changed.connect(self.changed)

    @property
    def busy(self) -> bool:
        """Whether pieces are still to come."""
        return self._job.busy or self._timer.isActive()

    def stop(self) -> None:
        """Make no more of what was asked for."""
        self._timer.stop()
        self._job.stop()
        self._waiting.clear()
        self._in_work = {}

    def of(self, candidate: Candidate) -> PosedPieces | None:
        """The pieces of a design, which are made soon if they are not there; None for panels."""
        self._follow(self._session.document)
        if not self._made_of_pieces or self._target is None:
            return None
        cut, pieces = self._known.get(candidate, (None, None))
        wanted = self._cut_of(candidate)
        if wanted not in (cut, self._in_work.get(candidate)) and not self._running():
            self._waiting.pop(candidate, None)
            self._waiting[candidate] = None
            while len(self._waiting) > MOST_WAITING:
                del self._waiting[next(iter(self._waiting))]
            if not self.busy:
                self._timer.start()
        return pieces

    def take(self, request: CutRequest, made: Planned | MadePieces) -> None:
        """The pieces of the design on the stage were made: its card has them, too."""
        if isinstance(made, MadePieces) and request.target == self._session.document.target:
            self._follow(self._session.document)
            self._known[request.candidate] = one_sheet(request.settings), made.posed
            self._waiting.pop(request.candidate, None)
            self.changed.emit()

    def _follow(self, document: Document) -> None:
        """Note how designs of a document are cut."""
        if document is self._document:
            return
        self._document, self._cut = document, one_sheet(document.fabrication)
        self._made_of_pieces, self._cuts = has_pieces(document.fabrication), {}
        if document.target != self._target:
            self._target, self._known = document.target, {}
            self._waiting.clear()
        if document.artwork != self._artwork:
            self._artwork = document.artwork
            self._known = {candidate: (None, pieces) for candidate, (_, pieces) in self._known.items()}

    def _cut_of(self, candidate: Candidate) -> FabricationSettings:
        """How a design is cut; each has its own width where all open to one size."""
        if self._cut.opened_mm is None:
            return self._cut
        if candidate not in self._cuts:
            self._cuts[candidate] = one_sheet(cut_for(self._session.document, candidate))
        return self._cuts[candidate]

    def _keep(self, entries: tuple[Entry, ...]) -> None:
        """Other designs are in the gallery: forget those that are gone."""
        there = {entry.candidate for entry in entries}
        self._known = {candidate: found for candidate, found in self._known.items() if candidate in there}
        self._waiting = {candidate: None for candidate in self._waiting if candidate in there}

    def _begin(self) -> None:
        """Make the pieces of the design that waits longest."""
        if not self._waiting or self._job.busy or self._running():
            return
        candidate = next(iter(self._waiting))
        del self._waiting[candidate]
        self._in_work = {candidate: self._cut_of(candidate)}
        entry, document = self._session.cache.entry(candidate), self._session.document
        request = CutRequest(
            candidate, entry.design.deployment, document.target, self._in_work[candidate], document=document
        )
        callbacks = JobCallbacks(self._on_result, self._go_on, on_failed=lambda *_: self._go_on())
        self._job.start(tr("making the pieces of a design"), partial(picturing, (request,)), callbacks)

    def _go_on(self) -> None:
        self._in_work = {}
        self._begin()

    def _on_result(self, report: PicturedPieces) -> None:
        request, verdict = report.request, report.verdict
        if request.target == self._target:
            current = request.artwork == self._artwork
            self._known[request.candidate] = request.settings if current else None, report.pieces
            self.changed.emit()
            if verdict is not None:
                self.judged.emit(request, verdict)
