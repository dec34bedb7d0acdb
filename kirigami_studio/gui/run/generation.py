"""Generating designs: plan a run for the present document, run it, turn its result into an edit.

:class:`Generation` is what a person asks; :class:`RunPlanner` says what to ask the generator for and what becomes of
its result; :class:`DesignRun` runs at most one run at a time; :class:`StoppedRun` offers what a stopped run had found.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from PySide6.QtCore import QElapsedTimer, QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.foundation.errors import KirigamiError, UsageError
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.gui.run.look_alikes import COMPARED_AT_ONCE
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.queue import JobCallbacks, LatestJob
from kirigami_studio.gui.session.session import Entry, Session
from kirigami_studio.gui.stage.hand_editor import HandEditor
from kirigami_studio.gui.widgets.readable import readable_time
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.starts import RECTANGLE, StartShape
from kirigami_studio.pipeline.events import (
    CandidateFound,
    CandidateImproved,
    Finished,
    Phase,
    Progress,
    Result,
    Started,
)
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.request import Request, provenance
from kirigami_studio.pipeline.variety import distinct, look_alikes
from kirigami_studio.polish.flat_sheet import uniform_sheet
from kirigami_studio.project import candidate_edits, target_parts
from kirigami_studio.project.candidate_edits import NewDesigns
from kirigami_studio.project.design_facts import with_run
from kirigami_studio.project.document import Document, Mark
from kirigami_studio.project.edits import Edit
from kirigami_studio.studio.designing import (
    Decoded,
    GridChosen,
    Judged,
    KnownAsCut,
    ModelFound,
    RunReport,
    StartChosen,
    generating,
    request_for,
)

#: Angles closer than this (radians) are one.
SAME_ANGLE = 1e-9
#: Steps of the bar that shows how far a run is.
WHOLE = 1000


class Generation(QObject):
    """Starts and stops runs, and brings what they find into the document."""

    begun = Signal()  #: before the first design; what is being made of the chosen design is no longer wanted

    def __init__(self, session: Session, hand: HandEditor, parent: QObject) -> None:
        super().__init__(parent)
        self._session, self._hand = session, hand
        self.planner = RunPlanner(session)
        self.run = DesignRun(session, self)
        self.stopped = StoppedRun(session, self._take_result)
        self._shown = 0  # part that was shown when the run was asked for
        self._left: list[int] = []  # parts whose turn comes next
        self.run.found.connect(session.display.add)
        self.run.completed.connect(self._take_result)
        self.run.cancelled.connect(self._offer_found)
        self.run.failed.connect(self._report_failure)
        self.run.ended.connect(self._stop_unless_done)
        session.document_changed.connect(self.stopped.follow)

    def generate(self) -> None:
        """Start a run for the present target and settings; pinned designs stay where they fit.

        Of a target of several parts it is for the one that is shown, then for those that have no designs yet.
        """
        if self._hand.postpones(self.generate) or self.run.running:
            return
        document = self._session.document
        self._shown = document.part
        others = [*range(document.part + 1, len(document.parts)), *range(document.part)]
        self._left = [number for number in others if not document.parts[number].candidates]
        self._start(self.planner.anew)

    def again(self) -> None:
        """Draw more designs, from the next seed, beside those there are."""
        if not self._hand.postpones(self.again):
            self._left = []
            self._start(self.planner.more)

    def more_like(self, nearness: float) -> None:
        """Draw more designs near the chosen one, beside those there are."""
        if not self._hand.postpones(lambda: self.more_like(nearness)):
            self._left = []
            self._start(lambda target: self.planner.alike(target, nearness))

    def cancel(self) -> None:
        """Stop the run at once; the document stays as it is."""
        self.run.cancel()

    def _start(self, plan_for: Callable[[Outline], RunPlan]) -> None:
        session = self._session
        target = session.document.target
        if self.run.running:
            return
        if target is None:
            session.hint(tr("Choose or draw a target first, then press Generate."))
            return
        try:
            plan = plan_for(target)
        except KirigamiError as error:
            session.refuse(error)
            return
        self.begun.emit()
        session.display.begin_run(plan.kept, plan.joins, Ranking.of(plan.request))
        self.run.start(plan.request, plan.kept, plan.joins)
        session.set_status(plan.status)

    def _take_result(self, result: Result, facts: dict[str, str]) -> None:
        session = self._session
        before = session.document
        session.apply(self.planner.edit_for(result, facts, session.display.preview))
        if session.document is before:  # all of it was there already
            session.display.show()
        session.set_status(self.planner.summary(result, before, self.run.grid_reason, self.run.seconds))
        self._go_on()

    def _go_on(self) -> None:
        """Show the next part that waits for designs and start its run; in the end the first."""
        session = self._session
        if not session.document.other_parts:
            return
        # A part of the shape and size of one that was just designed has its designs already.
        self._left = [number for number in self._left if not session.document.parts[number].candidates]
        if not self._left:
            if session.document.part != self._shown:
                session.apply(target_parts.show_part(session.document, self._shown))
                session.history.end_drag()
            return
        session.apply(target_parts.show_part(session.document, self._left.pop(0)))
        session.history.end_drag()
        self._start(self.planner.anew)

    def _stop_unless_done(self, done: bool) -> None:
        """Parts whose turn has not come wait for the next run, where this one was stopped."""
        if not done:
            self._left = []

    def _offer_found(self) -> None:
        self._session.display.show()
        self._session.set_status(tr("Generation stopped; nothing changed."))
        self.stopped.offer(self.run.so_far())

    def _report_failure(self, sentence: str, trace: str) -> None:
        self._session.display.show()
        self._session.report_failure(sentence, trace)


@dataclass(frozen=True, slots=True)
class RunPlan:
    """A run that is to start."""

    request: Request
    kept: tuple[Candidate, ...]  #: designs of the document that stay in sight, best first
    joins: bool  #: whether what it brings joins those there are, and the choice stays
    seed: int | None  #: seed that the settings show afterwards
    status: str  #: what the status line says at its start


class RunPlanner:
    """Plans runs for the present document and turns their results into edits."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self.plan: RunPlan | None = None  #: the run that was planned last
        self.added: frozenset[Candidate] = frozenset()  #: by the last run to designs that were there
        self.keeps_seed = True  #: whether Generate draws from the seed that is shown
        self._drawn: set[tuple[int, int]] = set()  # project and seed of every run so far, also of those undone

    def _next_seed(self, document: Document) -> int:
        """The next seed; where it is not kept, one that no run has drawn from, so that no two runs are the same."""
        drawn = () if self.keeps_seed else (seed for project, seed in self._drawn if project == self._session.project)
        return next_seed(document, drawn)

    def anew(self, target: Outline) -> RunPlan:
        """New designs in the place of all but the pinned ones.

        Raises
        ------
        KirigamiError
            The settings do not go together.
        """
        document = self._session.document
        settings = document.settings
        seed = settings.seed if self.keeps_seed else self._next_seed(document)
        request = request_for(target, replace(settings, seed=seed), document.fabrication)
        status = tr_n(
            "Generating {count} design for {name} …",
            "Generating {count} designs for {name} …",
            request.k,
            name=target.name,
        )
        kept = Ranking.of(request).ranked(_staying(document, request))
        self._drawn.add((self._session.project, seed))
        self.plan = RunPlan(request, kept, False, seed, status)
        return self.plan

    def more(self, target: Outline) -> RunPlan:
        """More designs for the same grid and angle, from the next seed.

        Raises
        ------
        KirigamiError
            There are no designs to add to.
        """
        request = self._joining(target)
        status = tr_n(
            "Generating {count} more design from seed {seed} …",
            "Generating {count} more designs from seed {seed} …",
            request.k,
            seed=request.seed,
        )
        return self._joined(request, status)

    def alike(self, target: Outline, nearness: float) -> RunPlan:
        """More designs, drawn near the chosen one.

        Raises
        ------
        KirigamiError
            No design is chosen, or it cannot be drawn near.
        """
        document = self._session.document
        chosen = document.candidate
        if chosen is None:
            raise UsageError("designs.none_chosen")
        start = own_start(chosen, document.settings.start)
        request = replace(self._joining(target), near=chosen.sheet, nearness=nearness, search=0, start=start)
        name = "" if document.label is None else document.label.text
        status = tr_n(
            "Generating {count} design like design {name} …",
            "Generating {count} designs like design {name} …",
            request.k,
            name=name,
        )
        return self._joined(request, status)

    def _joining(self, target: Outline) -> Request:
        document = self._session.document
        if not document.candidates:
            raise UsageError("designs.none_to_add_to")
        first = document.candidates[0]
        seed = self._next_seed(document)
        same = replace(document.settings, auto_grid=False, grid=first.sheet.grid, phi=first.score.phi, seed=seed)
        # Fits from the uniform sheet do not depend on the seed: they would be the same again.
        return replace(request_for(target, same, document.fabrication), guided=0)

    def _joined(self, request: Request, status: str) -> RunPlan:
        seed = None if self.keeps_seed else request.seed
        self._drawn.add((self._session.project, request.seed))
        kept = Ranking.of(request).ranked(self._session.document.candidates)
        self.plan = RunPlan(request, kept, True, seed, status)
        return self.plan

    def edit_for(self, result: Result, facts: dict[str, str], preview: Candidate | None) -> Edit:
        """What a completed run leads to; where it joins, its result holds new designs alone.

        ``facts`` say where the designs come from, ``preview`` is the design that the user looked at meanwhile.
        """
        plan = self.plan
        document = target_parts.showing_target(self._session.document, result.request.target)
        self._session.as_cut = KnownAsCut.of(result, document.fabrication)
        seed = None if plan is None else plan.seed
        if plan is not None and plan.joins:
            self.added = frozenset(result.candidates)
            new = NewDesigns(result.candidates, facts, seed)
            edit = candidate_edits.add_candidates(document, new, self._session.ranking.key)
            return _choosing(edit, preview)
        self.added = frozenset()
        staying = _staying(document, result.request)
        if not staying and Mark.PINNED in document.marks:
            self._session.hint(tr("Pinned designs for another grid or angle were removed. Undo restores them."))
            document = replace(document, marks=())
        grid = result.request.grid if result.request.grid_chosen else None
        new = NewDesigns(result.candidates, facts, seed, result.request.target, grid)
        chosen = preview if preview is not None and preview in (*staying, *result.candidates) else None
        edit = candidate_edits.renew_candidates(document, new, self._session.ranking.key, chosen)
        return replace(edit, document=target_parts.with_twins(edit.document, document.part))

    def summary(self, result: Result, before: Document, grid_reason: str = "", seconds: float = 0.0) -> str:
        """Sentence on a completed run: times, best match, the reason for a grid that it chose.

        ``seconds`` is all that it took, choices and loading included.
        """
        plan, document = self.plan, self._session.document
        if plan is None or not plan.joins:
            designing = readable_time(max(seconds - result.judging_seconds, result.seconds))
            judging = readable_time(result.judging_seconds)
            if result.best in result.refusals:
                return tr_n(
                    "{count} design in {designing}, checked as cut in {judging}. It cannot be cut in this material and "
                    "size: the verdict says why.",
                    "{count} designs in {designing}, checked as cut in {judging}. None can be cut in this material and "
                    "size: the verdict says why.",
                    len(result.candidates),
                    designing=designing,
                    judging=judging,
                )
            told = tr_n(
                "{count} design in {designing}, checked as cut in {judging}: match {match:.1f} %, panels "
                "±{variation:.0f} %.",
                "{count} designs in {designing}, checked as cut in {judging}. Best: match {match:.1f} %, panels "
                "±{variation:.0f} %.",
                len(result.candidates),
                designing=designing,
                judging=judging,
                match=100 * result.ranking.made_match(result.best),
                variation=100 * result.best.score.evenness.area_cv,
            )
            return f"{told} {grid_reason}".strip()
        known = set(before.candidates)
        fresh = [one for one in document.candidates if one not in known]
        added = len(fresh)
        nearly = self._nearly_the_same(before, fresh)
        if nearly:
            return nearly
        if not added:
            return tr("No new designs; {count} already in the gallery.", count=result.repeats)
        if result.repeats:
            return tr_n(
                "{count} design added, {repeats} already in the gallery. Best new match: {match:.1f} %.",
                "{count} designs added, {repeats} already in the gallery. Best new match: {match:.1f} %.",
                added,
                repeats=result.repeats,
                match=100 * result.ranking.made_match(result.best),
            )
        return tr_n(
            "{count} design added. Best new match: {match:.1f} %.",
            "{count} designs added. Best new match: {match:.1f} %.",
            added,
            match=100 * result.ranking.made_match(result.best),
        )

    def _nearly_the_same(self, before: Document, fresh: Sequence[Candidate]) -> str:
        """What is said where most designs that were drawn near another one look just like it, else ""."""
        near = None if self.plan is None else self.plan.request.near
        origin = next((one for one in before.candidates if one.sheet == near), None)
        if origin is None or not fresh or len(fresh) > COMPARED_AT_ONCE:
            return ""
        groups = look_alikes((origin, *fresh))
        alike = sum(group == groups[0] for group in groups[1:])
        if 2 * alike <= len(fresh):
            return ""
        return tr_n(
            "{count} design added; {alike} looks the same. Move the slider towards far for more variety.",
            "{count} designs added; {alike} look the same. Move the slider towards far for more variety.",
            len(fresh),
            alike=alike,
        )


def next_seed(document: Document, drawn: Iterable[int] = ()) -> int:
    """The first seed from the settings' own on that no design of the document, and no run ``drawn`` so far, has had."""
    used = {candidate.seed for candidate in document.candidates} | set(drawn)
    seed = document.settings.seed
    while seed in used:
        seed += 1
    return seed


def own_start(candidate: Candidate, present: StartShape) -> StartShape:
    """What a design starts as: the ``present`` start where it is that one, else one that is made of its sheet."""
    sheet = candidate.sheet
    laid = uniform_sheet(sheet.grid, present)
    if Sheet(laid.field, laid.rim, sheet.start, sheet.cell) == laid:
        return present
    name = dict(candidate.made_with).get("start", RECTANGLE.name)
    if sheet.start is not None:
        return StartShape(name, Outline.from_points(sheet.start, name))
    if sheet.cell == (1.0, 1.0):
        return RECTANGLE
    (rows, columns), (width, height) = sheet.grid, sheet.cell
    return StartShape(name, None, (columns + 1) * width / ((rows + 1) * height))


def _staying(document: Document, request: Request) -> tuple[Candidate, ...]:
    """Pinned designs that share target, grid and angle with a run for the present target."""
    return tuple(
        one
        for one, mark in zip(document.candidates, document.marks, strict=True)
        if mark is Mark.PINNED
        and request.grid in (None, one.sheet.grid)
        and abs(one.score.phi - request.phi) < SAME_ANGLE
    )


def _choosing(edit: Edit, preview: Candidate | None) -> Edit:
    """The edit with the design that was looked at on the stage."""
    candidates = edit.document.candidates
    if preview is None or preview not in candidates:
        return edit
    return Edit(edit.label, replace(edit.document, chosen=candidates.index(preview)))


class DesignRun(QObject):
    """One run of the generator: its reports become signals and decoded entries."""

    started = Signal(int)
    progressed = Signal(int, int, str)
    grid_chosen = Signal()  #: where that was left to the run
    found = Signal(Entry)  #: new or improved
    judged = Signal(Judged)  #: a design was looked at closely
    completed = Signal(Result, dict)  #: with its provenance
    cancelled = Signal()
    failed = Signal(str, str)  #: sentence, trace
    ended = Signal(bool)  #: whether it was completed; comes before the three above

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._session = session
        self._job = LatestJob[RunReport](session.queue)
        self._digest = ""
        self.grid_reason = ""  #: why the last run has its grid, where it chose that
        self._asked = 0
        self._request: Request | None = None
        self._others: tuple[Candidate, ...] = ()
        self._ranking = Ranking()
        self._reports = 0
        self._clock, self._took, self._checking = QElapsedTimer(), 0.0, False
        self._sampled: dict[int, float] = {}  # sIoU of each candidate when it was found
        self._latest: dict[int, Candidate] = {}

    @property
    def seconds(self) -> float:
        """Wall time since the run began, choices and loading included."""
        return self._took or 1e-3 * self._clock.elapsed()

    @property
    def running(self) -> bool:
        """Whether candidates are being generated."""
        return self._job.busy

    def start(self, request: Request, beside: tuple[Candidate, ...] = (), joins: bool = False) -> None:
        """Begin; the caller has made sure that nothing runs.

        Designs are ranked with those ``beside``.  Where the run ``joins`` these, its result holds only others, perhaps
        none.
        """
        self._asked, self._request, self._reports = request.k, request, 0
        self._others = beside if joins else ()
        self._ranking, self.grid_reason = Ranking.of(request), ""
        self._clock.start()
        self._took, self._checking = 0.0, False
        self._sampled.clear()
        self._latest.clear()
        callbacks = JobCallbacks(self._take, partial(self.ended.emit, False), self._cancel, self._fail)
        steps = partial(generating, request, self._session.document.fabrication, beside, joins)
        self._job.start(tr("generating designs"), steps, callbacks)
        self.started.emit(request.k)

    def cancel(self) -> None:
        """Stop it at once: whatever it still loads or computes until its next report goes unheard."""
        if self.running:
            self._job.stop()
            self._cancel()

    def abandon(self) -> None:
        """Stop it and ignore what it would still report."""
        if self.running:
            self._job.stop()
            self.ended.emit(False)

    def so_far(self) -> tuple[Result, dict[str, str]] | None:
        """What the last run has found until now, as if its time had ended, and its provenance; None for nothing.

        The result counts as decoded only the designs that were reported.
        """
        if self._request is None:
            return None
        candidates = distinct(self._ranking.ranked(self._latest.values()), self._others) if self._latest else ()
        if not candidates:
            return None
        result = Result(self._request, candidates, self._reports, 1e-3 * self._clock.elapsed(), budget_ended=True)
        return result, provenance(self._request, self._digest)

    def _take(self, report: RunReport) -> None:
        match report:
            case ModelFound(digest):
                self._digest = digest
            case GridChosen(grid, reason):
                self.grid_reason = reason
                if self._request is not None:
                    self._request = replace(self._request, grid=grid, grid_chosen=True)
                self._latest.clear()  # a run that takes another grid in the end reports its designs anew
                self._sampled.clear()
                self._session.set_status(reason)
                self.grid_chosen.emit()
            case StartChosen(start, reason):
                if self._request is not None:
                    self._request = self._request.with_start(start)
                self._session.set_status(reason)
            case Started():
                self.progressed.emit(0, WHOLE, tr("Starting (0 of {total})", total=report.total))
            case Progress():
                self.progressed.emit(round(WHOLE * report.share), WHOLE, report.message)
                if report.phase is Phase.JUDGING and not self._checking:
                    self._checking = True
                    self._session.set_status(
                        tr(
                            "Designs are checked as they will be cut, best first, until none could be better. "
                            "Look at any of them meanwhile."
                        )
                    )
            case Judged():
                self.judged.emit(report)
            case CandidateFound() | CandidateImproved():
                self._note(report.candidate)
            case Decoded(candidate, deployment):
                if self._request is not None:  # so that its card can name its start while the run goes on
                    (candidate,) = with_run((candidate,), provenance(self._request, self._digest))
                self._session.cache.put(candidate, deployment)
                entry = self._session.cache.entry(candidate)
                self.found.emit(replace(entry, rise=candidate.score.siou - self._sampled[candidate.index]))
            case Finished(result):
                self._job.stop()  # the result is the end
                self._took = 1e-3 * self._clock.elapsed()
                self.ended.emit(True)
                self.completed.emit(result, provenance(result.request, self._digest))

    def _note(self, candidate: Candidate) -> None:
        """Count a candidate and say in the status line how far polishing and search have come."""
        improved = candidate.index in self._sampled
        self._sampled.setdefault(candidate.index, candidate.score.siou)
        self._latest[candidate.index] = candidate
        self._reports += 1
        best = min(self._latest.values(), key=self._ranking.key)
        if candidate.origin is Origin.GUIDED:
            self._session.set_status(
                tr(
                    "Fitted from the uniform sheet: match {match:.1f} % (best {best:.1f} %).",
                    match=100 * candidate.score.iou_exact,
                    best=100 * best.match,
                )
            )
        elif candidate.origin is Origin.COVERED:
            self._session.set_status(
                tr(
                    "Covers the shape: match {match:.1f} %, gives up {percent:.0f} % of the sheet (best {best:.1f} %).",
                    match=100 * candidate.match,
                    percent=100 * candidate.given_up,
                    best=100 * best.match,
                )
            )
        elif candidate.index >= self._asked:
            self._session.set_status(
                tr(
                    "Search found a design: match {match:.1f} % (best {best:.1f} %).",
                    match=100 * candidate.score.iou_exact,
                    best=100 * best.match,
                )
            )
        elif improved:
            polished = sum(one.polished for one in self._latest.values())
            self._session.set_status(
                tr(
                    "Polished {polished} of {asked} (best {best:.1f} %)",
                    polished=polished,
                    asked=self._asked,
                    best=100 * best.match,
                )
            )

    def _cancel(self) -> None:
        self.ended.emit(False)
        self.cancelled.emit()

    def _fail(self, sentence: str, trace: str) -> None:
        self.ended.emit(False)
        self.failed.emit(sentence, trace)


class StoppedRun:
    """Offers what a stopped run had found, for as long as it belongs to the document."""

    def __init__(self, session: Session, keep: Callable[[Result, dict[str, str]], None]) -> None:
        self._session, self._keep_result = session, keep
        self._offer: Message | None = None
        self._found: tuple[Result, dict[str, str]] | None = None
        self._belongs_to: tuple[Outline | None, tuple[Candidate, ...]] = (None, ())

    def offer(self, found: tuple[Result, dict[str, str]] | None) -> None:
        """Ask whether the designs shall stay; the document is as it was until then."""
        self.withdraw()
        if found is None:
            return
        document = self._session.document
        self._found, self._belongs_to = found, (document.target, document.candidates)
        count = len(found[0].candidates)
        sentence = tr_n(
            "Stopped after {count} design; it may be unfinished.",
            "Stopped after {count} designs; some may be unfinished.",
            count,
        )
        action = tr_n("Keep it", "Keep these designs", count)
        self._offer = Message(sentence, Tone.HINT, actions=((action, self._keep),))
        self._session.post(self._offer)

    def follow(self, document: Document) -> None:
        """The document has changed: designs for another target, or beside other designs, are of no use."""
        target, candidates = self._belongs_to
        if self._offer is not None and (document.target != target or document.candidates is not candidates):
            self.withdraw()

    def withdraw(self) -> None:
        """Forget the designs."""
        message, self._offer, self._found = self._offer, None, None
        if message is not None:
            self._session.withdraw(message)

    def _keep(self) -> None:
        found = self._found
        self.withdraw()
        if found is not None:
            self._keep_result(*found)
