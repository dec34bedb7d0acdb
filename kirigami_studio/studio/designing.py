"""Designing: settings -> request -> run -> designs, ranked as cut -> project; and the jobs on single designs.

What a run computes is composed in ``pipeline``; here stands what window, command line and API ask it for, how its
designs are ranked by how they do as cut, and what project they make.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import TYPE_CHECKING

import numpy as np

from kirigami_studio.evaluate.candidate import Candidate, Family, Origin
from kirigami_studio.evaluate.posed_design import trimmed_parts
from kirigami_studio.evaluate.trimming import DEEP_KEEP, KEEP
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.fabricate.options import COPY_GAP_MM
from kirigami_studio.fabricate.panel_sizes import least_panel_share
from kirigami_studio.foundation.errors import Cancelled, FabricationError, KirigamiError, UsageError
from kirigami_studio.foundation.steps import Cancel, never
from kirigami_studio.foundation.threads import one_blas_thread
from kirigami_studio.foundation.words import tr
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.symmetry import symmetry_of
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.starts import RECTANGLE, TURNS_BACK, StartShape, hollows
from kirigami_studio.outlines.turning import sides_needed, turn_back
from kirigami_studio.pipeline.best_as_cut import MOST_PIECED, Looking, best_as_cut
from kirigami_studio.pipeline.events import (
    CandidateFound,
    CandidateImproved,
    Event,
    Finished,
    Phase,
    Progress,
    Result,
)
from kirigami_studio.pipeline.pool import Pool
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.request import Request, provenance
from kirigami_studio.pipeline.variety import distinct, look_alikes
from kirigami_studio.polish.flat_sheet import width_in_cells
from kirigami_studio.polish.pinwheel import gap_in_cells
from kirigami_studio.project.candidate_edits import NewDesigns, renew_candidates
from kirigami_studio.project.document import Document, Void
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings, is_pinned, is_printed, material_for, pin_gap_mm
from kirigami_studio.settings.layers import hinge_layer
from kirigami_studio.studio import importing
from kirigami_studio.studio.cutting import least_feature_mm, room_mm, span_mm
from kirigami_studio.studio.run_progress import RunProgress

if TYPE_CHECKING:
    from kirigami_studio.studio.as_cut import AsCut

#: Notes on what keeps closed sheets from showing a target, by the families that there are designs of.
_LIMITS = {
    "covers.turns_back": {
        frozenset[Family](): "covers.turns_back_ahead",
        frozenset({Family.CLOSED}): "covers.turns_back_closed",
        frozenset({Family.COVER}): "covers.turns_back_cover",
        frozenset(Family): "covers.turns_back",
    },
    "covers.many_arms": {
        frozenset[Family](): "covers.many_arms_ahead",
        frozenset({Family.CLOSED}): "covers.many_arms_closed",
        frozenset({Family.COVER}): "covers.many_arms_cover",
        frozenset(Family): "covers.many_arms",
    },
}
#: Target angles up to this are those of a closed sheet, radians.
CLOSED = 1e-9
#: Designs that are estimated as cut between two reports.
ESTIMATED_AT_ONCE = 8


@dataclass(frozen=True, slots=True, eq=False)
class Decoded:
    """A candidate with the exact motion of its final sheet."""

    candidate: Candidate
    deployment: Deployment


@dataclass(frozen=True, slots=True)
class ModelFound:
    """The generator that a run uses: SHA-256 of its weights."""

    digest: str


@dataclass(frozen=True, slots=True)
class Refitted:
    """What a fit from a design's present sheet has found."""

    decoded: Decoded  #: the fitted design with its motion, trimmed if the one it began with was
    better: bool  #: whether it ranks before the one it began with, both untrimmed
    untrimmed: str = ""  #: why it could not be trimmed again, "" if that was not to be done or was


@dataclass(frozen=True, slots=True)
class GridChosen:
    """The grid that a run has chosen, and why in one sentence."""

    grid: tuple[int, int]
    reason: str


@dataclass(frozen=True, slots=True)
class FittedAgain:
    """How many designs of all were fitted again; one of them before and after, where it became better."""

    done: int
    total: int
    before: Candidate | None
    after: Candidate | None


@dataclass(frozen=True, slots=True, eq=False)
class KnownAsCut:
    """What a run has found out about designs as cut, which holds as long as they are cut that way."""

    sheet: FabricationSettings  #: how the designs are cut, see :func:`any_sheet`
    jam_phi: Mapping[Candidate, float]  #: radians
    refusals: Mapping[Candidate, Note]
    losses: Mapping[Candidate, float]  #: as :class:`~kirigami_studio.pipeline.rank.Ranking` has them
    simulated: Mapping[Candidate, AsCut]  #: those that were closed on their connectors in a close look

    @classmethod
    def of(cls, result: Result, cut: FabricationSettings) -> KnownAsCut:
        """What is known after a run."""
        from kirigami_studio.studio.as_cut import AsCut, Source

        found = {
            candidate: one
            for candidate, one in result.as_cut.items()
            if isinstance(one, AsCut) and one.source is Source.SIMULATION
        }
        return cls(any_sheet(cut), result.jam_phi, result.refusals, result.losses, found)

    def simulation(self, candidate: Candidate, cut: FabricationSettings) -> AsCut | None:
        """Look up how a design does as cut; None unless a close look has closed it in this size."""
        same = cut.opened_mm is None and one_sheet(cut) == self.sheet
        return self.simulated.get(candidate) if same else None


@dataclass(frozen=True, slots=True)
class StartChosen:
    """The start that a run has chosen, and why in one sentence."""

    start: StartShape
    reason: str


@dataclass(frozen=True, slots=True)
class Judged:
    """A design that a run has looked at closely."""

    candidate: Candidate
    refusal: Note | None  #: why it cannot be cut
    loss: float  #: worth (IoU) that it loses by being cut
    as_cut: AsCut | None  #: how it does as cut; None where nobody had to look


#: Covers of pinned sheets are made where no pieces match better than this.
COVERED_PIECES_BELOW = 0.95
#: How often other designs are trimmed, where none that is trimmed can be cut.
TRIMMED_FURTHER = 2
#: What a run reports.
RunReport = Event | ModelFound | GridChosen | StartChosen | Decoded | Judged
#: What fitting designs again reports.
RefitReport = Decoded | FittedAgain | Progress | Judged | KnownAsCut
#: Gets how far a run has come.
Tell = Callable[[Progress], object]


def request_for(
    target: Outline,
    wanted: DesignSettings,
    cut: FabricationSettings,
    *,
    least_panel_mm: float = 0.0,
    trim: bool = False,
    budget_seconds: float | None = None,
) -> Request:
    """The run that these settings ask for, on the sheet that is cut.

    Parameters
    ----------
    cut : FabricationSettings
        The sheet's width, and what its material and connectors need.
    least_panel_mm : float
        Least panel edge and neck that is asked for.

    Raises
    ------
    KirigamiError
        The settings do not go together.
    """
    return Request.of(
        target,
        wanted,
        trim=trim,
        budget_seconds=budget_seconds,
        width_mm=cut.width_mm,
        least_feature_mm=max(least_feature_mm(cut), least_panel_mm),
        room_mm=sizes_of(cut)[1],
        span_mm=_span_of(cut),
        least_gap_mm=pin_gap_mm(cut),
        two_layers=pin_gap_mm(cut) > 0.0 and not is_printed(cut),
    )


def run_design(
    request: Request,
    cut: FabricationSettings,
    cancel: Cancel = never,
    *,
    least_panel_mm: float = 0.0,
    beside: tuple[Candidate, ...] = (),
    only_new: bool = False,
    pool: Pool | None = None,
) -> Iterator[Event | GridChosen | StartChosen | Judged]:
    """Choose the grid, run, and rank by how designs do as cut: the best that can be cut in this material first.

    Parameters
    ----------
    request : Request
        Its grid may be open.
    least_panel_mm : float
        Least panel edge and neck that is asked for.
    beside : tuple of Candidate
        Designs that stay beside those of the run, and are ranked with them.
    only_new : bool
        Whether the result keeps only designs that differ from those ``beside`` and from each other.
    pool : Pool, optional
        Of the fits; the program's own unless given.

    Yields
    ------
    Event, GridChosen, StartChosen or Judged
        Those of the pipeline, what was left to the run first, designs as they are judged, and at last ``Finished``;
        progress is that of the whole run.

    Raises
    ------
    Cancelled
        ``cancel`` returned true.
    """
    from kirigami_studio.pipeline.run import grid_choice, start_choice, with_grid

    if request.start.is_auto and request.near is None:
        yield Progress(0, request.k, tr("Choosing the start"))
        chosen = start_choice(request)
        yield StartChosen(chosen.start, chosen.reason)
        request = request.with_start(chosen.start)
    if request.grid is None and request.near is None:
        yield Progress(0, request.k, tr("Choosing the grid"))
        choice = grid_choice(request)
        yield GridChosen(choice.grid, choice.reason)
    request = _with_sizes(with_grid(request), cut, least_panel_mm)
    whole = RunProgress(request)
    for event in _WholeRun(cut, least_panel_mm, beside, only_new, cancel, pool).events(request):
        yield whole.placed(event) if isinstance(event, Progress) else event


@dataclass(frozen=True, slots=True, eq=False)
class _WholeRun:
    """A run, ranked by how its designs do as cut, and what follows from that."""

    cut: FabricationSettings
    least_panel_mm: float
    beside: tuple[Candidate, ...]
    only_new: bool
    cancel: Cancel
    pool: Pool | None

    def events(self, request: Request) -> Iterator[Event | GridChosen | Judged]:
        """All of it, ``Finished`` at last."""
        from kirigami_studio.pipeline.run import covered_on_pins, run, trimmed_further

        result = yield from _new_designs(run(request, self.cancel, self.pool), self.beside, self.only_new)
        began = time.perf_counter()
        result = yield from self._ranked(result)
        for _ in range(TRIMMED_FURTHER):
            if not wants_other_trims(result):
                break
            result = yield from trimmed_further(result, self.cancel, self.pool)
            result = yield from self._ranked(result)
        if wants_smaller_pieces(result):
            before = result.seconds
            result = yield from self._with_smaller_pieces(result)
            began += result.seconds - before  # designing is no judging
        if wants_covers_on_pins(result):
            result = yield from covered_on_pins(result, self.cancel, self.pool)
            result = yield from self._ranked(result)
        yield Finished(replace(result, judging_seconds=time.perf_counter() - began))

    def _ranked(self, result: Result) -> Generator[Progress | Judged, None, Result]:
        return ranked_as_cut(result, self.cut, self.beside, self.cancel, self.pool)

    def _with_smaller_pieces(self, result: Result) -> Generator[Event | GridChosen | Judged, None, Result]:
        """Run on a grid of smaller pieces, and return the result with the better first design.

        The start is held loosely: pieces are cut to it.  The result has the time of both runs.
        """
        from kirigami_studio.pipeline.auto_grid import on_smaller_pieces, remember
        from kirigami_studio.pipeline.run import run

        choice, start = on_smaller_pieces(result.request), result.request.start
        if choice is None:
            return result
        try:
            request = _with_sizes(replace(result.request, grid=choice.grid), self.cut, self.least_panel_mm)
            running = run(replace(request, start=start.held_loosely()), self.cancel, self.pool)
            told = (event for event in running if isinstance(event, Progress | Finished))
            other = yield from _new_designs(told, self.beside, self.only_new)
            other = yield from self._ranked(replace(other, request=request))
        except Cancelled:
            raise
        except KirigamiError:  # what was found before stays
            return result
        both, best = (result, other), result
        if _worth_of_first(other) > _worth_of_first(result):
            best = other
            remember(request, choice)
            yield GridChosen(choice.grid, choice.reason)
            yield from (CandidateFound(one.index, one) for one in sorted(other.candidates, key=lambda one: one.index))
        evaluations = sum(one.forward_evaluations for one in both)
        return replace(best, seconds=sum(one.seconds for one in both), forward_evaluations=evaluations)


def _new_designs(
    designing: Iterator[Event], beside: tuple[Candidate, ...], only_new: bool
) -> Generator[Event, None, Result]:
    """Pass on the events of a run, and return its result: all designs, or those that are new."""
    for event in designing:
        if isinstance(event, Finished):
            result = event.result
            if not only_new:
                return result
            # Comparing a thousand designs with a thousand takes a second.
            new = distinct(result.candidates, beside)
            return replace(result, candidates=new, repeats=len(result.candidates) - len(new))
        yield event
    raise Cancelled("run.no_result")


def _worth_of_first(result: Result) -> float:
    """Worth of the first design as made; minus infinity without designs."""
    return max((result.ranking.worth_as_made(one) for one in result.candidates[:1]), default=-math.inf)


def wants_smaller_pieces(result: Result) -> bool:
    """Whether the run chose a grid whose pieces show the target badly."""
    request = result.request
    free = request.grid_chosen and request.near is None and request.budget_seconds is None
    return free and wants_covers_on_pins(result)


def wants_covers_on_pins(result: Result) -> bool:
    """Whether the pieces of all inspected designs show the target badly."""
    if not result.request.may_cover_pieces or result.budget_ended:
        return False
    made = [result.ranking.made_match(one) for one in result.losses if one not in result.refusals]
    return max(made, default=0.0) < COVERED_PIECES_BELOW


def wants_other_trims(result: Result) -> bool:
    """Whether designs are to be trimmed that are not yet, as none of those that are can be cut."""
    asked = result.request.trims and result.request.budget_seconds is None
    trimmed = [one for one in result.candidates if one.trim is not None]
    feasible = any(one.trim is None and one.score.feasible for one in result.candidates)
    return asked and bool(trimmed) and feasible and all(one in result.refusals for one in trimmed)


def why_untrimmed(result: Result) -> Note | None:
    """Why no design of a run was trimmed as asked for; None where one is."""
    if not result.request.trims or any(one.trim is not None for one in result.candidates):
        return None
    return Note("design.trimming_cut_short" if result.budget_ended else "design.none_trimmed", {})


def first_of_families(candidates: Sequence[Candidate]) -> dict[Family, tuple[int, Candidate]]:
    """Place and design of the first of each family, of candidates sorted best first."""
    found: dict[Family, tuple[int, Candidate]] = {}
    for place, candidate in enumerate(candidates):
        found.setdefault(candidate.family, (place, candidate))
    return found


def why_covered(candidates: Sequence[Candidate], target: Outline | None, start: StartShape = RECTANGLE) -> Note | None:
    """Why covers stand beside closed designs: the most that each family shows.

    Returns
    -------
    Note or None
        None without a target, and where there are designs of one family alone.
    """
    best = _best_of_families(candidates)
    if target is None or len(best) < len(Family):
        return None
    return closed_limit(candidates, target, start) or Note.of("covers.better", **_figures(best))


def closed_limit(candidates: Sequence[Candidate], target: Outline | None, start: StartShape = RECTANGLE) -> Note | None:
    """Limit of closed sheets for a target, with the most that each family has found.

    Returns
    -------
    Note or None
        None without a target, and where nothing stands against a closed sheet.
    """
    if target is None or any(one.score.phi > CLOSED for one in candidates) or not _is_convex(start):
        return None
    limit = _limit(target, _sides(candidates, start))
    if limit is None:
        return None
    code, facts = limit
    best = _best_of_families(candidates)
    return Note.of(_LIMITS[code][frozenset(best)], **facts, **_figures(best))


def limit_of(document: Document) -> Note | None:
    """Note beside the match of a project's designs: the limit of closed sheets, or of covers.

    Pieces on pins are extended beyond their sheet, so what that cannot show says nothing of them.
    """
    opens = not document.candidates and document.settings.phi > CLOSED
    if opens or is_pinned(document.fabrication):
        return None
    return _said(document.candidates, document.target, document.settings.start)


def limit_of_run(result: Result) -> Note | None:
    """The same of the designs of a run."""
    request = result.request
    return None if request.least_gap_mm else _said(result.candidates, request.target, request.start)


def _said(candidates: Sequence[Candidate], target: Outline | None, start: StartShape) -> Note | None:
    return why_covered(candidates, target, start) or closed_limit(candidates, target, start)


def _best_of_families(candidates: Sequence[Candidate]) -> dict[Family, Candidate]:
    """The best match of each family, of designs that can be closed."""
    best: dict[Family, Candidate] = {}
    for one in candidates:
        if one.score.feasible and (one.family not in best or one.match > best[one.family].match):
            best[one.family] = one
    return best


def _figures(best: Mapping[Family, Candidate]) -> dict[str, float]:
    """Match of each family, and what covers give up, in percent."""
    figures = {family.value: 100.0 * one.match for family, one in best.items()}
    if Family.COVER in best:
        figures["given_up"] = 100.0 * best[Family.COVER].given_up
    return figures


def _sides(candidates: Sequence[Candidate], start: StartShape) -> float:
    """Straight sides of the flat sheet; endless where the next run chooses its start."""
    if not start.is_auto:
        return start.sides
    if not candidates:
        return math.inf
    outline = candidates[0].sheet.start
    return RECTANGLE.sides if outline is None else len(outline)


@lru_cache(maxsize=16)
def _is_convex(start: StartShape) -> bool:
    """Whether a start has no hollows: what is known of closed sheets is known of such."""
    return start.outline is None or not hollows(start.outline)


@lru_cache(maxsize=64)
def _limit(target: Outline, sides: float) -> tuple[str, Mapping[str, float]] | None:
    """Code and facts of the limit of closed sheets of so many sides; None without one."""
    target = target.filled
    back = turn_back(target)
    if back.angle >= TURNS_BACK:
        low, high = target.points.min(axis=0), target.points.max(axis=0)
        across, up = (100.0 * (back.stretch.mean(axis=0) - low) / (high - low)).tolist()
        return "covers.turns_back", {"degrees": math.degrees(back.angle), "across": across, "up": up}
    return ("covers.many_arms", {"sides": sides}) if sides_needed(target) > sides else None


def completed(run: Iterator[object], tell: Tell) -> Result:
    """Take all steps of a run in one go, and tell how far it comes.

    Raises
    ------
    Cancelled
        It ended without a result.
    """
    for event in run:
        if isinstance(event, Progress):
            tell(event)
        elif isinstance(event, Finished):
            return event.result
    raise Cancelled("run.no_result")


def ranked_as_cut(
    result: Result,
    cut: FabricationSettings,
    beside: tuple[Candidate, ...],
    cancel: Cancel,
    pool: Pool | None = None,
) -> Generator[Progress | Judged, None, Result]:
    """Rank designs with those beside them; report between the steps of every look.

    Whoever iterates may do other work at each report.  Workers that are ready look at the second design and those that
    follow it, and make pieces on pins of a few designs at once.
    """
    from kirigami_studio.pipeline.pool import shared_pool
    from kirigami_studio.studio.as_cut import estimates
    from kirigami_studio.studio.assembling import kept
    from kirigami_studio.studio.looking_ahead import LooksAhead
    from kirigami_studio.studio.verdict import CloseLook, looking

    pool = pool or shared_pool()
    target = result.request.target
    everything = replace(result, candidates=(*beside, *result.candidates))
    progress = Progress(0, len(everything.candidates), tr("Checking designs as cut"), Phase.JUDGING)
    known: dict[Candidate, AsCut] = {}
    for start in range(0, len(everything.candidates), ESTIMATED_AT_ONCE):
        with one_blas_thread():
            known |= estimates(everything.candidates[start : start + ESTIMATED_AT_ONCE], cut)
        yield progress
    jams = {one: as_cut.jam_phi for one, as_cut in known.items()}

    looked: list[Judged] = []
    ahead: LooksAhead | None = None

    def look(one: Candidate) -> Generator[None, None, CloseLook]:
        found = None if ahead is None or not ahead.has(one) else (yield from ahead.look(one))
        if found is None:
            found = yield from looking(one, cut, target, cancel)
        if found.as_cut is not None:
            known[one] = found.as_cut  # a simulation takes the place of the estimate
        looked.append(Judged(one, found.refusal, found.loss, found.as_cut))
        return found

    steps = best_as_cut(everything, jams, look)
    try:
        while True:
            try:
                step = next(steps)
            except StopIteration as end:
                found: Result = end.value
                break
            yield from looked
            looked.clear()
            if isinstance(step, Looking):
                progress = _looking_at(step.number, step.total)
                order = step.order
                if is_pinned(cut) and kept(order[0], cut, target) is not None:
                    order = order[:1]
                elif ahead is not None and not ahead.has(order[0]):
                    ahead.close()
                    ahead = None
                if ahead is None and len(order) > 1 and (is_pinned(cut) or step.number > 1) and pool.ready:
                    several = order[: min(pool.size, MOST_PIECED)] if is_pinned(cut) else order
                    ahead = LooksAhead(pool, result.request, several, cut, cancel)
            yield progress
    finally:
        if ahead is not None:
            ahead.close()
    yield from looked
    stay = {id(one) for one in beside}
    return replace(found, candidates=tuple(one for one in found.candidates if id(one) not in stay), as_cut=known)


def _looking_at(number: int, total: int) -> Progress:
    message = tr("Checking: {number} of {total}", number=number, total=total)
    return Progress(number - 1, total, message, Phase.JUDGING)


def _with_sizes(request: Request, cut: FabricationSettings, least_panel_mm: float) -> Request:
    """The request with what depends on the size of its cells, once its grid is known."""
    from kirigami_studio.pipeline.redesign import keep_for_connectors

    least = least_panel_mm * width_in_cells(request.chosen_grid, request.start) / cut.width_mm
    request = replace(request, least_panel=least)
    if not request.trims and not request.may_cover:
        return request
    # How deep material has to stay at the hinges of a trimmed sheet so that its connectors hold.
    cut = hinge_layer(cut)
    widths = (cut.width_mm, cut.connector_mm, cut.kerf_mm)
    try:
        least = least_keep(request.target, request.trim)
        return replace(request, keep=keep_for_connectors(request.uniform, material_for(cut), *widths, least))
    except FabricationError:
        if request.trims:
            raise
        return replace(request, covers=False)


def generating(
    request: Request,
    cut: FabricationSettings,
    beside: tuple[Candidate, ...],
    only_new: bool,
    cancel: Cancel,
) -> Iterator[RunReport]:
    """Run a design for the window: every new or improved candidate is followed by its decoded motion."""
    importing.import_generator()
    from kirigami_studio.generator.weights import digest_of

    yield ModelFound(digest_of(request.variant))
    for event in run_design(request, cut, cancel, beside=beside, only_new=only_new):
        yield event
        if isinstance(event, CandidateFound | CandidateImproved):
            yield decoded(event.candidate)


def facts_of(request: Request) -> dict[str, str]:
    """Where the designs of a run come from."""
    from kirigami_studio.generator.weights import digest_of

    return provenance(request, digest_of(request.variant))


def document_of(result: Result, cut: FabricationSettings) -> Document:
    """The project that a run makes of its request: its designs, ranked, the best chosen."""
    request, facts = result.request, facts_of(result.request)
    empty = Document(request.target, request.settings, fabrication=cut)
    return renew_candidates(empty, NewDesigns(result.candidates, facts), result.ranking.key).document


def ranking_of(document: Document, known: KnownAsCut | None = None) -> Ranking:
    """What the document's settings, sheet and material put first, with what is known of designs that are cut so."""
    settings, cut = document.settings, document.fabrication
    ranking = Ranking(settings.regular, cut.width_mm, sizes_of(cut)[0], gap_of(cut))
    if known is None or known.sheet != any_sheet(cut):
        return ranking
    return replace(ranking, jam_phi=known.jam_phi, refusals=known.refusals, losses=known.losses)


def least_gap_of(cut: FabricationSettings, sheet: Sheet) -> float:
    """Distance (unit cells) that pins of a sheet have to keep; 0 without room for pins."""
    try:
        gap_mm = pin_gap_mm(cut)
    except (FabricationError, UsageError):  # which planning explains
        return 0.0
    return gap_in_cells(gap_mm, cut.width_mm, float(np.ptp(deploy(sheet).compact[:, 0]))) if gap_mm else 0.0


def one_sheet(cut: FabricationSettings) -> FabricationSettings:
    """What matters of the settings to a sheet, whatever kind of file it is written to and how many times."""
    plain, options = FabricationSettings(), replace(cut.options, copies=1, copy_gap_mm=COPY_GAP_MM)
    return replace(
        cut,
        options=options,
        profile=plain.profile,
        dxf_version=plain.dxf_version,
        paper=plain.paper,
        markers=plain.markers,
        engrave=plain.engrave,
        board_cut=plain.board_cut,
    )


def any_sheet(cut: FabricationSettings) -> FabricationSettings:
    """Settings of a sheet without the width of one design, where all open to one size."""
    settings = one_sheet(cut)
    return settings if settings.opened_mm is None else replace(settings, width_mm=settings.opened_mm)


def decoding(candidates: tuple[Candidate, ...], cancel: Cancel) -> Iterator[Decoded]:
    """Decode the candidates of an opened project."""
    for candidate in candidates:
        yield decoded(candidate)


def decoded(candidate: Candidate) -> Decoded:
    """A candidate with the motion of its final sheet.

    What the gallery and the stage ask of every design is found out here and kept by who found it: the window does not
    wait for it.
    """
    deployment = deploy(candidate.final_sheet)
    least_panel_share(deployment)
    symmetry_of(candidate.sheet)
    if candidate.trim is not None:
        trimmed_parts(deployment, candidate.trim)
    return Decoded(candidate, deployment)


def grouping(candidates: tuple[Candidate, ...], ranking: Ranking, cancel: Cancel) -> Iterator[tuple[int, ...]]:
    """Find which designs look alike."""
    yield look_alikes(candidates, ranking)


def scoring_sample(candidate: Candidate, target: Outline, cancel: Cancel) -> Iterator[Decoded]:
    """Score a candidate as the generator sampled it, in the pose that suits it best."""
    from kirigami_studio.pipeline.redesign import sampled

    before = sampled(candidate, target)
    if before is not None:
        yield decoded(before)


def refitting(
    candidate: Candidate,
    target: Outline,
    wanted: DesignSettings,
    locked: frozenset[Void],
    settings: FabricationSettings,
    cancel: Cancel,
) -> Iterator[Refitted]:
    """Fit a candidate on the exact geometry from its present sheet, and trim it again if it is trimmed."""
    from kirigami_studio.pipeline.redesign import refitted

    least_mm, room_mm = sizes_of(settings)
    refit = refitted(
        candidate,
        target,
        wanted.prefer,
        locked,
        partial(keep_for, candidate, target, settings),
        cancel,
        regular=wanted.regular,
        free_rim=wanted.rim == "free",
        width_mm=settings.width_mm,
        least_feature_mm=least_mm,
        room_mm=room_mm,
        least_gap_mm=gap_of(settings),
        span_mm=_span_of(settings),
        start_weight=wanted.start.weight,
    )
    untrimmed = "" if refit.trim_problem is None else str(refit.trim_problem)
    yield Refitted(decoded(refit.candidate), refit.better, untrimmed)


def fitting_again(
    request: Request,
    candidates: tuple[Candidate, ...],
    among: tuple[Candidate, ...],
    cut: FabricationSettings,
    cancel: Cancel,
) -> Iterator[RefitReport]:
    """Fit designs again by what the request prefers; a better one comes decoded before its report.

    Where some became better, what is known of all of them as cut comes last: ``among`` are the designs there were.
    """
    from kirigami_studio.pipeline.fit_again import fit_again

    better: dict[Candidate, Candidate] = {}
    for report in fit_again(request, candidates, cancel):
        if report.before is not None and report.after is not None:
            better[report.before] = report.after
            yield decoded(report.after)
        yield FittedAgain(report.done, report.total, report.before, report.after)
    if better:
        found = Result(request, tuple(better.get(one, one) for one in among), 0, 0.0)
        yield KnownAsCut.of((yield from ranked_as_cut(found, cut, (), cancel)), cut)


def trimming(
    candidate: Candidate, target: Outline, wanted: DesignSettings, settings: FabricationSettings, cancel: Cancel
) -> Iterator[Decoded]:
    """Fit a candidate so that it covers the target, and trim it, with room for the connectors at its hinges."""
    from kirigami_studio.pipeline.redesign import Room, trimmed
    from kirigami_studio.polish.panel_size import least_in_cells

    least_mm, _ = sizes_of(settings)
    least = least_in_cells(least_mm, settings.width_mm, candidate.score.evenness.width)
    room = Room(settings.width_mm, _span_of(settings))
    found = trimmed(
        candidate,
        target,
        keep_for(candidate, target, settings),
        cancel,
        least_panel=least,
        room=room,
        start_weight=wanted.start.weight,
    )
    if cancel():
        raise Cancelled("trim.stopped")
    yield decoded(found.candidate)


def sizes_of(settings: FabricationSettings) -> tuple[float, float]:
    """Panel edge and neck (mm) that the material allows at least, and that leaves connectors their full width.

    Pinned sheets have no connectors.  Zeros for a material that is not known here.
    """
    try:
        return least_feature_mm(settings), 0.0 if pin_gap_mm(settings) else room_mm(settings)
    except KirigamiError:
        return 0.0, 0.0


def _span_of(settings: FabricationSettings) -> float:
    """Width of a connector and of the cut that sheets leave room for; 0 without any."""
    try:
        return 0.0 if pin_gap_mm(settings) else span_mm(settings)
    except KirigamiError:
        return 0.0


def gap_of(settings: FabricationSettings) -> float:
    """Distance, mm, that pins keep; 0 without pins, and for an unknown material."""
    try:
        return pin_gap_mm(settings)
    except KirigamiError:
        return 0.0


def least_keep(target: Outline, edge: bool) -> float:
    """Depth (unit cells) of the material that stays at hinges whatever the connectors are.

    Less stays of a sheet with holes or notches than of one that is trimmed along its ``edge`` alone.
    """
    return KEEP if edge and not target.holes else DEEP_KEEP


def keep_for(candidate: Candidate, target: Outline, settings: FabricationSettings) -> float:
    """Depth (unit cells) of the material that trimming has to leave at the hinges of a candidate."""
    from kirigami_studio.pipeline.redesign import keep_for_connectors

    sheet, cut = candidate.sheet, hinge_layer(settings)
    widths = cut.width_mm, cut.connector_mm, cut.kerf_mm
    least = least_keep(target, candidate.origin is not Origin.COVERED)
    return keep_for_connectors(sheet, material_for(cut), *widths, least)
