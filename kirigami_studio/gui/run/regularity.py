"""The balance of match and regularity over the designs that are there.

While it is moved, the cards are ranked again, which takes no work.  When it is let go, the document takes it, and the
worker fits the designs again by it; both are one undo step.  A design is replaced only by one that ranks before it.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.gui.session.queue import JobCallbacks, LatestJob
from kirigami_studio.gui.session.session import Session
from kirigami_studio.pipeline.events import Progress
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.request import Request
from kirigami_studio.project import candidate_edits, edits
from kirigami_studio.project.document import Document, Mark
from kirigami_studio.settings.design import POLISH_STEPS
from kirigami_studio.studio.designing import Decoded, FittedAgain, KnownAsCut, RefitReport, fitting_again, request_for


class Regularity(QObject):
    """Ranks the designs of the document by another balance, and fits them again."""

    ranked = Signal(Ranking)  #: order of the cards while the balance is moved
    busy_changed = Signal(bool)
    progressed = Signal(int, int, str)  #: done, total, a sentence

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._job = LatestJob[RefitReport](session.queue)
        self._known: KnownAsCut | None = None  # of the designs, those that became better among them
        self._better: dict[Candidate, Candidate] = {}
        self._choices = 0
        self._expected: Document | None = None  # what the document was when the fit began

    @property
    def busy(self) -> bool:
        """Whether designs are being fitted again."""
        return self._job.busy

    @property
    def _merge_key(self) -> str:
        """The edits of one choice undo together, those of two do not."""
        return f"regular {self._choices}"

    def preview(self, regular: float) -> None:
        """Rank the cards by a balance, 0 (match) to 1 (regular), while it is moved."""
        if self._session.document.candidates:
            self.ranked.emit(replace(self._session.ranking, regular=regular))

    def choose(self, regular: float, shown: tuple[Candidate, ...]) -> None:
        """Take a balance into the document, and fit the designs again that are ``shown``."""
        session = self._session
        self.stop()
        if regular == session.document.settings.regular:
            session.display.show()
            return
        self._choices += 1
        request = _request(session.document, regular)
        if request is None:
            session.apply(edits.set_settings(session.document, regular=regular))
            return
        ranking = replace(session.ranking, regular=regular)
        session.apply(candidate_edits.rank_again(session.document, regular, ranking.key, self._merge_key))
        self._begin(request, shown)

    def _begin(self, request: Request, shown: tuple[Candidate, ...]) -> None:
        from kirigami_studio.pipeline.fit_again import worth_fitting_again

        document = self._session.document
        rejected = {one for one, mark in zip(document.candidates, document.marks, strict=True) if mark is Mark.REJECTED}
        keeps = document.candidate if document.locked else None
        wanted = tuple(
            one
            for one in document.candidates
            if one in shown and one not in rejected and one != keeps and worth_fitting_again(one)
        )
        if not wanted:
            return
        self._better, self._expected, self._known = {}, document, None
        callbacks = JobCallbacks(self._take, self._finish, self._end, self._fail)
        steps = partial(fitting_again, request, wanted, document.candidates, document.fabrication)
        self._job.start(tr("fitting the designs again"), steps, callbacks)
        self.busy_changed.emit(True)

    def cancel(self) -> None:
        """Stop because the user says so; the order stays."""
        self.stop()
        self._session.set_status(tr("Fitting stopped; the designs are ranked again but unchanged."))

    def stop(self) -> None:
        """Stop, and forget what was found."""
        if self.busy:
            self._job.stop()
            self._end()

    def _take(self, report: RefitReport) -> None:
        match report:
            case Decoded(candidate, deployment):
                self._session.cache.put(candidate, deployment)
            case FittedAgain(done, total, before, after):
                if before is not None and after is not None:
                    self._better[before] = after
                sentence = tr("Fitting again: {done} of {total} designs", done=done, total=total)
                self.progressed.emit(done, 2 * total, sentence)
            case Progress(done, total, sentence):  # of checking, the second half
                self.progressed.emit(total + done, 2 * total, sentence)
            case KnownAsCut():
                self._known = report

    def _finish(self) -> None:
        session, better, expected, known = self._session, self._better, self._expected, self._known
        self._end()
        if session.document.candidates is not (None if expected is None else expected.candidates):
            session.set_status(tr("The designs changed while they were fitted; the fits are not used."))
            return
        if not better:
            session.set_status(tr("Ranked again. Fitting again made no design better."))
            return
        if known is not None:
            session.as_cut = known
        key = session.ranking.key
        session.apply(candidate_edits.replace_candidates(session.document, better, key, self._merge_key))
        session.set_status(
            tr_n("Ranked again; {count} design improved.", "Ranked again; {count} designs improved.", len(better))
        )

    def _fail(self, sentence: str, trace: str) -> None:
        self._end()
        self._session.report_failure(sentence, trace)

    def _end(self) -> None:
        self._better, self._expected, self._known = {}, None, None
        self.busy_changed.emit(False)


def _request(document: Document, regular: float) -> Request | None:
    """The run that the document's designs would be of with this balance; None without designs."""
    if document.target is None or not document.candidates:
        return None
    first = document.candidates[0]
    settings = replace(
        document.settings,
        regular=regular,
        auto_grid=False,
        grid=first.sheet.grid,
        phi=first.score.phi,
        polish=document.settings.polish or POLISH_STEPS,
        search=0,
    )
    try:
        return replace(request_for(document.target, settings, document.fabrication), guided=0)
    except KirigamiError:
        return None
