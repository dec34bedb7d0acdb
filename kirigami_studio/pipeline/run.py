"""The whole way from request to ranked candidates, as an iterator of events."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable, Generator, Hashable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby, pairwise, zip_longest
from typing import TYPE_CHECKING

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.foundation.errors import Cancelled, SheetError
from kirigami_studio.foundation.steps import never
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.starts import RECTANGLE, no_closed_sheet_shows
from kirigami_studio.pipeline.auto_grid import GridChoice, Trials, chosen_for
from kirigami_studio.pipeline.auto_start import StartChoice, chosen_start
from kirigami_studio.pipeline.events import (
    CandidateFound,
    CandidateImproved,
    Event,
    Finished,
    Phase,
    Progress,
    Result,
    Started,
)
from kirigami_studio.pipeline.pool import Pool, shared_pool
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.tasks import (
    CoverTask,
    GuidedTask,
    PinnedCoverTask,
    PolishTask,
    PolishTogether,
    SearchTask,
    Task,
    TaskResult,
    TrialTask,
    TrimTask,
    fit_target,
    scored,
)
from kirigami_studio.pipeline.variety import worth_a_fit
from kirigami_studio.polish.continuation import Way, first_angles
from kirigami_studio.polish.covering import EASY_TURN, notches_filled
from kirigami_studio.polish.pinwheel import HANDS
from kirigami_studio.polish.symmetry import KeptSymmetry, SymmetricPose, shared_symmetries
from kirigami_studio.polish.unfolding import unfolded
from kirigami_studio.settings.design import USUAL_GRID, RimRule

if TYPE_CHECKING:
    from kirigami_studio.generator.weights import Model

#: Candidates scored in one batch.
SCORED_TOGETHER = 32

#: Runs that also fit the uniform sheet draw no fewer samples than this, and keep the best: drawing and scoring a sample
#: takes an eighth of the time of fitting it.  Not of pinned sheets: what a sample matches says little about its pieces.
LEAST_DRAWN = 32

#: At most so many candidates are fitted one after the other and scored in one batch: half of the time of one by one.
FITTED_TOGETHER = 4

#: Steps that every candidate gets before any gets more: designs improve early, and a short budget is shared fairly.
#: 5 + 10 steps end where 15 do (24 samples for heart and star: sIoU within 0.0005, TV 1 % higher).
FIRST_ROUND = 5

#: The worse half of the samples get fewer: none of the first eight designs of runs for a heart, a butterfly and a star
#: was among these.
BRIEF_ROUND = 3

#: Only the better ones get the steps that are left: this share of them, and no fewer than so many.  Of 24 samples each
#: for 12 of the drawn shapes, none that came first in the end was behind the third after five steps, and none that came
#: second to sixth behind the tenth.
SECOND_ROUND, SECOND_ROUND_LEAST = 0.5, 8

#: Candidates that a search starts from: the best that differ.
SEARCH_STARTS = 3

#: Worth that a sample may lack after its first round and still get a second one, and that a design may lack in the end
#: and still be finished.  Of 192 samples for 8 drawn shapes none that lacked more than 0.0015 came first in the end,
#: and finishing added 0.0004 at most.
MAY_WIN, MAY_COME_FIRST = 0.0015, 0.0003

#: Share of the steps that are left which a second round takes; the others are for designs that may come first in the
#: end.  Of 15 samples for 3 shapes 4 of 10 steps brought as much worth as all of them: the match grows, and with it the
#: unevenness of panels.
SECOND_STEPS = 0.5

#: So many samples get a second round whatever they lack: they are on the first row of cards.
SECOND_ROUND_SHOWN = 4

#: Where the first design matches by less than this after the first round, the shape is hard: the whole better half goes
#: on, by twice the steps that are left and at most so many more, and designs are finished by as many as were asked for.
#: Not of pinned sheets: pieces of a crescent and of a letter T match worse for it.
HARD_BELOW, HARD_STEPS = 0.989, 10

#: Fits from the uniform sheet end once the best two agree in worth within this.  Until then poses whose fits agree with
#: the best are tried another way, and others are left behind.
AGREED = 0.001

#: Most designs that get steps once more in the end: those that may come first.
FINISHED = 3

#: Designs that are trimmed: the best that differ.
TRIMMED = 3

#: Designs that cover the target are made of at most so many closed ones, until one matches by this.  The first of each
#: symmetry comes before the others: samples that went on for long have none, and a puzzle is covered by 0.976 from
#: those, by 0.985 from symmetric fits.
COVERS, COVERED_WELL = 3, 0.985
#: They are made in any case where no closed design of a run that was fitted to its end matches better than this.
COVERED_BELOW = 0.97
#: Where only the first closed design matches less than this, it is covered along its edge, and where that matches less
#: than the second, with its notches cut out; covers stay where they are worth more than it.  A fish matches by 0.993
#: then in the place of 0.9765, a bone by 0.994 (0.9815), a mushroom by 0.990 (0.983), all as symmetric as before.
CLOSER_BELOW, COVERED_CLOSELY = 0.985, 0.99
#: The same of pinned sheets: notches are filled until the shape turns back by one of these (radians), it is covered
#: from so many poses by sheets of both hands, and so many covers are kept.  A fit takes half a second: no arm has to be
#: reached.
PINNED_COVER_TURNS, PINNED_COVER_POSES, PINNED_COVERS = (EASY_TURN, math.radians(60.0)), 8, 4

#: Seconds between two signs of life while fits are under way.
HEARTBEAT = 0.25

#: Seconds of one step of a fit at 10 x 10 with all that follows, which grow with the number of voids to this power.
STEP_SECONDS, STEP_GROWTH = 12e-3, 1.3

#: Symmetries of one target that samples are divided among.
MOST_SYMMETRIES = 2

#: Steps that a search takes for one unit of effort.
SEARCH_STEPS = 600

#: Seconds of work that starting worker processes must save at least half of.
WORTH_STARTING = 0.8

#: Seconds between two looks at the cancel flag and the clock.
LOOK = 0.02

#: Seconds after the end of the budget that workers get to hand in their best so far.
GRACE = 1.0


def run(request: Request, cancel: Callable[[], bool] = never, pool: Pool | None = None) -> Iterator[Event]:
    """Sample, score, polish, fit from the uniform sheet, search, finish, cover, trim, rank.

    The result does not depend on who polishes, on the number of workers, or on the order in which they end; only a
    budget makes it depend on the clock.  All samples are returned: a duplicate of a better sample is kept as it was
    sampled.  Designs fitted from the uniform sheet follow them, ``k`` in all: more samples take the places of fits that
    are not needed, as those before them agree.  What a search finds is added as number ``k``.  Where closed sheets show
    the target badly, designs that cover it follow (:func:`needs_cover`, :func:`may_be_closer`).

    Parameters
    ----------
    request : Request
    cancel : callable
        Asked between candidates, and every 0.02 s or after every step of a fit; once true the run stops.
    pool : Pool, optional
        Worker processes; the program's own by default.

    Yields
    ------
    Event
        ``Started``, then ``Progress`` and ``CandidateFound`` in turn, ``CandidateImproved`` with polishing, and
        ``Finished``.

    Raises
    ------
    Cancelled
        ``cancel`` returned true.
    ModelError, UsageError
        The variant cannot be loaded or does not exist.
    """
    watch = Watch(cancel, time.perf_counter(), request.budget_seconds)
    pool = pool or shared_pool()
    request = with_grid(request, pool)
    work = _Work(request, watch, _gaining(pool, request))
    yield Started(request.k)
    yield Progress(0, request.k, tr("Loading the generator"))
    with closing(work.guide()) as guided:
        next(guided, None)  # workers fit the uniform sheet while the generator samples
        yield from work.sample()
        yield from guided
    yield from work.fill()
    work.evaluations += work.samples * decodings(request)
    if request.polish:
        yield from work.polish()
    if request.search:
        yield from work.search()
    if request.polish >= 2 * FIRST_ROUND:
        yield from work.finish()
    yield from work.cover()
    if request.trims:
        yield from work.trim()
    candidates = work.ranking.ranked(work.found)
    yield Finished(Result(request, candidates, work.evaluations, watch.seconds, work.cut_short))


def trimmed_further(
    result: Result, cancel: Callable[[], bool] = never, pool: Pool | None = None
) -> Generator[Event, None, Result]:
    """Trim the next designs of a run, where those that it trimmed cannot be cut."""
    request = result.request
    work = _Work(request, Watch(cancel, time.perf_counter()), _gaining(pool or shared_pool(), request))
    work.found, work.evaluations = list(result.candidates), result.forward_evaluations
    yield from work.trim()
    return replace(result, candidates=work.ranking.ranked(work.found), forward_evaluations=work.evaluations)


def covered_on_pins(
    result: Result, cancel: Callable[[], bool] = never, pool: Pool | None = None
) -> Generator[Event, None, Result]:
    """Add pinned sheets that cover the target, whose panels in its notches are given up."""
    request = result.request
    work = _Work(request, Watch(cancel, time.perf_counter()), _gaining(pool or shared_pool(), request))
    work.found, work.evaluations = list(result.candidates), result.forward_evaluations
    yield from work.cover_on_pins()
    return replace(result, candidates=work.ranking.ranked(work.found), forward_evaluations=work.evaluations)


def promise_on_pins(cover: Candidate) -> float:
    """Measure how far a cover promises pieces that show the target and, flat, the start.

    Of 208 covers of a clover, a leaf, a plug and a puzzle it foretells 0.6 of the variance of both matches' sum within
    a shape and grid: they show something between what is trimmed and the whole sheet, and lack what is given up.
    """
    return cover.match + cover.score.iou_exact - cover.given_up


def with_grid(request: Request, pool: Pool | None = None) -> Request:
    """The request on its start and grid, chosen where these were left to the run.

    They are those of the design that samples are near, else those that suit the target, see :func:`start_choice` and
    :func:`grid_choice`.

    Raises
    ------
    TargetError
        A symmetry is asked for that the target does not have.
    """
    if request.start.is_auto:
        request = request.with_start(RECTANGLE if request.near is not None else start_choice(request, pool).start)
    if request.grid is not None:
        return request
    return request.resolved(grid_choice(request, pool).grid if request.near is None else request.near.grid)


def grid_choice(request: Request, pool: Pool | None = None) -> GridChoice:
    """The grid for a request and the reason; workers that are ready do the short fits that decide about hard shapes.

    Raises
    ------
    TargetError
        A symmetry is asked for that the target does not have.
    """
    return chosen_for(request, _trials_in(pool))


def start_choice(request: Request, pool: Pool | None = None) -> StartChoice:
    """The start for a request that leaves it open, and the reason; see :func:`grid_choice`."""
    return chosen_start(request, _trials_in(pool))


def _trials_in(pool: Pool | None) -> Trials:
    """Short fits, done by workers that are ready, else here."""
    workers = pool or shared_pool()
    ready = workers if workers.usable and workers.ready else None

    def trials(asked: Request, tasks: Sequence[TrialTask]) -> list[float]:
        made = dict(filter(None, answers(ready, asked, tasks, Watch(never, time.perf_counter()))))
        return [made[place].worth for place in range(len(tasks))]

    return trials


def best_of(request: Request, cancel: Callable[[], bool] = never, pool: Pool | None = None) -> Result:
    """Run to the end and return the result alone."""
    for event in run(request, cancel, pool):
        if isinstance(event, Finished):
            return event.result
    raise Cancelled("run.no_result")


def sample(request: Request, model: Model | None = None) -> tuple[Sheet, ...]:
    """Sample all designs that are not fitted from the uniform sheet, see :func:`drawn`."""
    return tuple(sheet for kind in drawn(request, model) for sheet in kind.sheets[: kind.kept])


@dataclass(frozen=True, slots=True)
class DrawnKind:
    """Samples that keep one symmetry, or none."""

    sheets: tuple[Sheet, ...]
    kept: int  #: How many of them a run has a place for; others are to choose from


def drawn(request: Request, model: Model | None = None, least: int = 0) -> list[DrawnKind]:
    """Sample the request's sheets; torch is imported here, on the first run, and not when the program starts.

    There are ``k`` of them, or ``least`` if that is more: as many as are not fitted from the uniform sheet have a
    place, the others are to choose from.  Where the target has symmetries that the grid can keep, samples that keep
    them come first: half of all, or all where a symmetry is asked for.  ``model`` takes the place of the bundled
    variant that the request names.
    """
    from kirigami_studio.generator.sampler import Near, sample_fields, sample_sheets
    from kirigami_studio.generator.weights import load_model

    model = model or load_model(request.variant)
    grid, seed, steps, phi = request.chosen_grid, request.seed, request.steps, request.phi
    count = request.k - len(fits_from_uniform(request))
    if request.near is not None:
        near = Near(request.near.field, rotation_of_target(request.near, request.silhouette, phi), request.nearness)
        fields = sample_fields(model, request.silhouette, grid, count, seed, steps, phi, near=near)
        return [DrawnKind(tuple(on_sheet(request, field) for field in fields), count)]
    # The model knows no other start than the rectangle, and where mouths of that are.
    draw = (
        sample_sheets
        if model.moves_mouths and request.rim is RimRule.FREE and request.start.is_plain
        else sample_fields
    )
    every = max(request.k, least)
    shares, of_all = symmetric_shares(request, count), symmetric_shares(request, every)
    kept = [share for _, share in shares] + [0] * (len(of_all) - len(shares))
    kinds: list[tuple[int, int, SymmetricPose | None]] = [
        (most, share, pose) for (pose, most), share in zip(of_all, kept, strict=True)
    ]
    if sum(kept) < count:
        kinds.append((every - sum(most for _, most in of_all), count - sum(kept), None))
    made = []
    for most, share, pose in kinds:
        target = request.silhouette if pose is None else fit_target(request, pose.symmetry)
        symmetry, upward = (None, None) if pose is None else (pose.symmetry, pose.angle)
        found = draw(model, target, grid, most, seed, steps, phi, symmetry=symmetry, upward=upward)
        made.append(DrawnKind(tuple(on_sheet(request, one) for one in found), share))
    return made


def best_of_each(
    kinds: Sequence[DrawnKind], found: Sequence[Candidate], ranking: Ranking
) -> tuple[list[Candidate], list[Candidate]]:
    """Divide scored samples into those that are kept and those to spare.

    They come in the order in which they were drawn.  The best of each kind are kept, in that order.
    """
    best: list[Candidate] = []
    spare: list[Candidate] = []
    first = 0
    for kind in kinds:
        ranked = ranking.ranked(found[first : first + len(kind.sheets)])
        best += sorted(ranked[: kind.kept], key=lambda one: one.index)
        spare += ranked[kind.kept :]
        first += len(kind.sheets)
    return best, spare


def varied_first(candidates: Iterable[Candidate]) -> list[Candidate]:
    """Put the first of each symmetry before the others."""
    firsts: list[Candidate] = []
    others: list[Candidate] = []
    seen: set[Symmetry | None] = set()
    for one in candidates:
        (others if one.symmetry in seen else firsts).append(one)
        seen.add(one.symmetry)
    return firsts + others


def fits_from_uniform(request: Request) -> list[GuidedTask]:
    """The fits from the uniform sheet, by several ways from each pose, symmetric ones first and of each symmetry in
    turn; they have the last numbers.
    """
    if not request.fitted_starts:
        return []
    grid, hands = request.chosen_grid, request.fit_options.hands
    angles = first_angles(request.silhouette, grid, 1, request.symmetry, request.start, pinned=request.pinned)
    if request.symmetry in (KeptSymmetry.MIRROR, KeptSymmetry.TURN):
        angles = [one for one in angles if one[1] is not None] or angles
    ways: dict[Symmetry | None, list[tuple[float, Symmetry | None, Way, int]]] = {}
    for symmetry in dict.fromkeys(symmetry for _, symmetry in angles):
        suited = Way.suited_to(request.silhouette, symmetry)
        poses = [angle for angle, kept in angles if kept is symmetry]
        # Another pose gives more than another way.
        ways[symmetry] = [(angle, symmetry, way, hand) for way in suited for angle in poses for hand in hands]
    free = ways.pop(None, [])
    in_turn = [one for several in zip_longest(*ways.values()) for one in several if one is not None]
    chosen = [*in_turn, *free][: request.fitted_starts]
    return [GuidedTask(request.k - len(chosen) + place, *way) for place, way in enumerate(chosen)]


def symmetric_shares(request: Request, count: int) -> list[tuple[SymmetricPose, int]]:
    """Symmetries that ``count`` samples keep, and how many of them keep each."""
    grid, setting, start = request.chosen_grid, request.symmetry, request.start
    poses = shared_symmetries(request.silhouette, grid, setting, start, pinned=request.pinned)
    poses = poses[:MOST_SYMMETRIES]
    together = count if request.symmetry in (KeptSymmetry.MIRROR, KeptSymmetry.TURN) and poses else count // 2
    each = [together // len(poses) + (place < together % len(poses)) for place in range(len(poses))]
    return [(pose, share) for pose, share in zip(poses, each, strict=True) if share]


def on_sheet(request: Request, sample: Sheet | RatioField) -> Sheet:
    """The sheet of a sample that is not one: that of the design that samples are near, with other ratios, else the
    uniform sheet.

    The model knows no hollows: where the start has some, the sheet is unfolded; one that stays folded is not feasible.
    """
    if isinstance(sample, Sheet):
        return sample
    flat = request.uniform if request.near is None or request.rim is RimRule.EVEN else request.near
    sheet = flat.with_field(sample)
    try:
        return unfolded(sheet, free_rim=request.rim is RimRule.FREE)
    except SheetError:
        return sheet


def rotation_of_target(sheet: Sheet, target: Outline, phi: float) -> float:
    """Rotation, radians, that brings the target into the pose in which a design shows it."""
    return -evaluate(deploy(sheet), target, phi).transform.angle


def decodings(request: Request) -> int:
    """How often the generator decodes a sample while it samples it; scoring it is one more."""
    from kirigami_studio.generator.weights import load_model

    return load_model(request.variant).decodings(request.steps)


@dataclass(frozen=True, slots=True)
class RunPhase:
    """A part of a run that works on several designs: its progress message, and the code of its cancellation."""

    words: str
    stopped: str
    phase: Phase

    def progress(self, done: int, total: int) -> Progress:
        """How far it is."""
        return Progress(done, total, tr(self.words, done=done, total=total), self.phase)


GUIDING = RunPhase(mark("Fitting: {done} of {total} done"), "run.stopped_polishing", Phase.FITTING)
POLISHING = RunPhase(mark("Polishing: {done} of {total} done"), "run.stopped_polishing", Phase.POLISHING)
SEARCHING = RunPhase(mark("Searching: {done} of {total} done"), "run.stopped_searching", Phase.SEARCHING)
FINISHING = RunPhase(mark("Finishing: {done} of {total} done"), "run.stopped_polishing", Phase.FINISHING)
COVERING = RunPhase(mark("Covering: {done} of {total} done"), "run.stopped_trimming", Phase.COVERING)
TRIMMING = RunPhase(mark("Trimming: {done} of {total} done"), "run.stopped_trimming", Phase.TRIMMING)


class _Work:
    """The state of one run: candidates by number, and what they cost."""

    def __init__(self, request: Request, watch: Watch, pool: Pool | None) -> None:
        self.request, self.watch, self.pool = request, watch, pool
        self.ranking = Ranking.of(request)
        self.found: list[Candidate] = []
        self.spare: list[Candidate] = []
        self.samples = 0
        self.evaluations = 0
        self.hard = False
        self.cut_short = False

    def sample(self) -> Iterator[Event]:
        """Draw samples, score them, the first batch whatever the budget, and keep the best."""
        chosen_from = self.request.fitted_starts and not self.request.pinned
        kinds = drawn(self.request, least=LEAST_DRAWN if chosen_from else 0)
        sheets = [sheet for kind in kinds for sheet in kind.sheets]
        found: list[Candidate] = []
        for start in range(0, len(sheets), SCORED_TOGETHER):
            self.watch.check("run.stopped_scoring", start, len(sheets))
            if start and self.watch.expired():
                self.cut_short = True
                break
            found += scored(self.request, sheets[start : start + SCORED_TOGETHER], start)
            words = tr("Candidate {done} of {total}", done=len(found), total=len(sheets))
            yield Progress(len(found), len(sheets), words, Phase.SAMPLING)
        self.samples = len(found)
        self.evaluations += len(found)
        chosen, self.spare = best_of_each(kinds, found, self.ranking)
        yield from self._kept(chosen, range(len(chosen)))

    def fill(self) -> Iterator[Event]:
        """Keep spare samples in the places of fits that were not needed."""
        known = {one.index for one in self.found}
        if not self.cut_short:
            yield from self._kept(self.spare, [number for number in range(self.request.k) if number not in known])

    def _kept(self, candidates: Sequence[Candidate], numbers: Sequence[int]) -> Iterator[Event]:
        for one, number in zip(candidates, numbers, strict=False):
            self.found.append(replace(one, index=number))
            yield CandidateFound(number, self.found[-1])

    def polish(self) -> Iterator[Event]:
        """Fit samples that differ: a few steps for all, then the rest for those that may win."""
        chosen = worth_a_fit([one for one in self.found if one.origin is not Origin.GUIDED], self.ranking)
        total, whole = len(chosen), self.request.polish < 2 * FIRST_ROUND
        steps = self.request.polish if whole else FIRST_ROUND
        better = {one.index for one in self.ranking.ranked(chosen)[: math.ceil(SECOND_ROUND * total)]}
        first = [PolishTask(one, steps if whole or one.index in better else BRIEF_ROUND, whole) for one in chosen]
        yield from self._polished(first, 0, total)
        if whole:
            return
        self.hard = self._is_hard()
        best = max(SECOND_ROUND_LEAST, math.ceil(SECOND_ROUND * total))
        places = {one.index: place for place, one in enumerate(self.found)}
        now = self.ranking.ranked(self.found[places[candidate.index]] for candidate in chosen)[:best]
        # What the first round has improved gets the steps that are left, others those of both rounds.
        near = now if self.hard else self._near_first(now, MAY_WIN)
        again = [
            PolishTask(one, self._second_steps if one.polished else FIRST_ROUND + self._second_steps)
            for one in (near if len(near) > SECOND_ROUND_SHOWN else now[:SECOND_ROUND_SHOWN])
        ]
        yield from self._polished(again, total, total + len(again))

    @property
    def _second_steps(self) -> int:
        """Steps of a second round."""
        left = self.request.polish - FIRST_ROUND
        return left + min(left, HARD_STEPS) if self.hard else math.ceil(SECOND_STEPS * left)

    def _is_hard(self) -> bool:
        """Whether the first design so far misses so much that further steps are worth their time."""
        first = min(self.found, key=self.ranking.key, default=None)
        return first is not None and not self.request.pinned and first.score.iou_exact < HARD_BELOW

    def _near_first(self, candidates: Iterable[Candidate], lacking: float) -> list[Candidate]:
        """Those candidates that lack no more worth than this of the first design so far."""
        first = min(self.found, key=self.ranking.key, default=None)
        if first is None or not first.score.feasible:
            return list(candidates)
        least = self.ranking.worth(first) - lacking
        return [one for one in candidates if self.ranking.worth(one) >= least]

    def _polished(self, tasks: Sequence[PolishTask], done: int, total: int) -> Iterator[Event]:
        places = {one.index: place for place, one in enumerate(self.found)}
        several = [PolishTogether(part) for part in shared_out(tasks, 1 if self.pool is None else self.pool.size)]
        for report in self._carried_out(several, POLISHING, done, total):
            if isinstance(report, Progress):
                yield report
                continue
            number, answer = report
            for task, part in zip(several[number].tasks, answer.parts, strict=True):
                done += 1
                if part.candidate is not None:
                    self.found[places[task.candidate.index]] = part.candidate
                    yield CandidateImproved(part.candidate.index, part.candidate)
                    self.watch.check(POLISHING.stopped, done, total)
            yield POLISHING.progress(done, total)

    def guide(self) -> Generator[Event]:
        """Fit from the uniform sheet in several poses and ways until the best two agree."""
        tasks = fits_from_uniform(self.request)
        worth: dict[GuidedTask, float] = {}
        done = 0
        for _, way in groupby(tasks, key=self._turn_of(tasks)):
            best = sorted(worth.values())[-2:]
            if len(best) == 2 and best[1] - best[0] <= AGREED:
                return
            asked = [task for task in way if self._keeps_up(task, worth)]
            for report in self._carried_out(asked, GUIDING, done, done + len(asked)):
                if isinstance(report, Progress):
                    yield report
                elif report[1].candidate is not None:
                    done, found = done + 1, report[1].candidate
                    worth[asked[report[0]]] = self.ranking.worth(found)
                    self.found.append(found)
                    yield CandidateFound(found.index, found)

    @staticmethod
    def _turn_of(tasks: Sequence[GuidedTask]) -> Callable[[GuidedTask], int]:
        """How many ways its pose is tried before a task."""
        turns: dict[GuidedTask, int] = {}
        seen: Counter[Hashable] = Counter()
        for task in tasks:
            turns[task] = seen[task.pose]
            seen[task.pose] += 1
        return turns.__getitem__

    @staticmethod
    def _keeps_up(task: GuidedTask, worth: Mapping[GuidedTask, float]) -> bool:
        """Whether the pose of a task has not been left behind by others."""
        own = [each for other, each in worth.items() if other.pose == task.pose]
        return not own or max(own) >= max(worth.values()) - AGREED

    def search(self) -> Iterator[Event]:
        """Look for a better design from the best that differ and from scratch."""
        starts = tuple(candidate.sheet for candidate in worth_a_fit(self.found, self.ranking)[:SEARCH_STARTS])
        for report in self._carried_out([SearchTask(self._next_index(), starts)], SEARCHING, 0, 1):
            if isinstance(report, Progress):
                yield report
            elif report[1].candidate is not None:
                self.found.append(report[1].candidate)
                yield CandidateFound(report[1].candidate.index, report[1].candidate)

    def _next_index(self) -> int:
        return max(self.request.k, len(self.found))

    def finish(self) -> Iterator[Event]:
        """Fit the best that differ once more, with the last weights, by the steps that are left; for a hard shape by
        all.
        """
        chosen: Sequence[Candidate] = worth_a_fit(self.found, self.ranking)
        steps = self.request.polish
        if not self.hard:
            chosen = self._near_first(chosen, MAY_COME_FIRST)
            steps -= FIRST_ROUND + self._second_steps
        chosen = chosen[:FINISHED]
        tasks = [PolishTask(candidate, steps) for candidate in chosen]
        yield from self._replaced(chosen, tasks, FINISHING)

    def trim(self) -> Iterator[Event]:
        """Trim the best that differ, also from those that are trimmed already."""
        closed = [one for one in self.found if one.origin is not Origin.COVERED]
        chosen = [one for one in worth_a_fit(closed, self.ranking) if one.trim is None][:TRIMMED]
        yield from self._replaced(chosen, [TrimTask(candidate) for candidate in chosen], TRIMMING)

    def cover(self) -> Iterator[Event]:
        """Make covers of the best designs that differ, where closed ones show the target badly.

        Where it is the first one alone that misses something, covers of it have to be worth more.
        """
        closed, least = worth_a_fit(self.found, self.ranking), -math.inf
        if needs_cover(self.request, self.found):
            tasks, enough = [CoverTask(one) for one in varied_first(closed)[:COVERS]], COVERED_WELL
        elif may_be_closer(self.request, closed):
            tasks, enough = [CoverTask(closed[0], notched) for notched in (False, True)], COVERED_CLOSELY
            least = self.ranking.worth(closed[0])
        else:
            return
        for task in tasks:
            if all(one.match < enough for one in self.found if one.origin is Origin.COVERED):
                yield from self._covered_by([task], 1, least)

    def cover_on_pins(self) -> Iterator[Event]:
        """Make covers of pinned sheets from scratch."""
        request = self.request
        tasks: list[PinnedCoverTask] = []
        for easy in PINNED_COVER_TURNS:
            filled = notches_filled(request.silhouette, easy, easy)
            if filled is None:
                continue
            setting, grid = request.symmetry, request.chosen_grid
            poses = first_angles(filled.outline, grid, 1, setting, request.start, pinned=True)[:PINNED_COVER_POSES]
            tasks += [PinnedCoverTask(0, *pose, hand, easy) for pose in poses for hand in HANDS]
        yield from self._covered_by(tasks, PINNED_COVERS)

    def _covered_by(self, tasks: Sequence[Task], most: int, least: float = -math.inf) -> Iterator[Event]:
        """The best covers that tasks make, where they are worth more than this, as designs."""
        covers: dict[int, Candidate] = {}
        for report in self._carried_out(tasks, COVERING, 0, len(tasks)):
            if isinstance(report, Progress):
                yield report
            elif (cover := report[1].candidate) is not None and self.ranking.worth_as_made(cover) > least:
                covers[report[0]] = cover

        def order(place: int) -> tuple[object, ...]:
            cover = replace(covers[place], index=place)
            promise = promise_on_pins(cover) if self.request.pinned else 0.0
            return -promise, *self.ranking.key(cover)

        best = sorted(covers, key=order)[:most]
        for place in sorted(best):
            cover = replace(covers[place], index=self._next_index())
            self.found.append(cover)
            yield CandidateFound(cover.index, cover)

    def _replaced(self, chosen: Sequence[Candidate], tasks: Sequence[Task], phase: RunPhase) -> Iterator[Event]:
        """Each chosen candidate as its task makes it."""
        for report in self._carried_out(tasks, phase, 0, len(tasks)):
            if isinstance(report, Progress):
                yield report
            elif report[1].candidate is not None:
                place = self.found.index(chosen[report[0]])
                self.found[place] = report[1].candidate
                yield CandidateImproved(report[1].candidate.index, report[1].candidate)

    def _carried_out(
        self, tasks: Sequence[Task], phase: RunPhase, done: int, total: int, request: Request | None = None
    ) -> Iterator[Progress | tuple[int, TaskResult]]:
        """Answers as they come, with signs of life in between; those of another request where one is given."""
        reported = time.perf_counter()
        with closing(answers(self.pool, request or self.request, tasks, self.watch)) as reports:
            next(reports)  # workers begin
            yield phase.progress(done, total)
            for report in reports:
                self.watch.check(phase.stopped, done, total)
                now = time.perf_counter()
                if report is not None:
                    done += max(1, len(report[1].parts))
                    self.evaluations += report[1].evaluations
                    yield report
                elif now - reported > HEARTBEAT:
                    reported = now
                    yield phase.progress(done, total)
        self.watch.check(phase.stopped, done, total)
        self.cut_short = self.cut_short or self.watch.expired()


def shared_out(tasks: Sequence[PolishTask], workers: int) -> list[tuple[PolishTask, ...]]:
    """Divide tasks into parts for workers, as many and as large for each.

    None has more than :data:`FITTED_TOGETHER`.
    """
    count = min(len(tasks), workers * math.ceil(len(tasks) / (workers * FITTED_TOGETHER)))
    ends = [len(tasks) * (part + 1) // count for part in range(count)]
    return [tuple(tasks[start:end]) for start, end in pairwise([0, *ends])]


def needs_cover(request: Request, found: Sequence[Candidate]) -> bool:
    """Whether covers may show more of the target than the closed designs that were found."""
    if not request.may_cover:
        return False
    if no_closed_sheet_shows(request.silhouette, request.start):
        return True
    most = max((one.score.iou_exact for one in found if one.score.feasible), default=0.0)
    return most < COVERED_BELOW and request.polish >= 2 * FIRST_ROUND and not request.trims


def may_be_closer(request: Request, closed: Sequence[Candidate]) -> bool:
    """Whether covers may be worth more than the first of the closed designs of a run, best first."""
    if not request.may_cover or request.trims or request.polish < 2 * FIRST_ROUND or not closed:
        return False
    score = closed[0].score
    return score.feasible and score.iou_exact < CLOSER_BELOW


@dataclass(frozen=True, slots=True)
class Watch:
    """The cancel flag and the clock of one run."""

    cancel: Callable[[], bool]  #: True once the user asked to stop
    began: float  #: seconds; on ``time.perf_counter``
    budget: float | None = None  #: seconds; wall time that the run may take

    @property
    def seconds(self) -> float:
        """Wall time since the run began."""
        return time.perf_counter() - self.began

    def expired(self) -> bool:
        """Whether the budget is used up."""
        return self.budget is not None and self.seconds >= self.budget

    def stopped(self) -> bool:
        """Whether work should end with the best so far, for either reason."""
        return self.expired() or self.cancel()

    def check(self, code: str, done: int, total: int) -> None:
        """End the run if the user asked for it.

        Raises
        ------
        Cancelled
            With ``code``, and how far the run came.
        """
        if self.cancel():
            raise Cancelled(code, done=done, total=total)


def answers(
    pool: Pool | None, request: Request, tasks: Sequence[Task], watch: Watch
) -> Generator[tuple[int, TaskResult] | None]:
    """Do tasks in order; yield (place in ``tasks``, answer) in the order in which they end, and None in between.

    The first is None: workers have got work then, of little size also those that start, and this process begins none
    before the next.
    Ends early when the watch's budget is used up: tasks under way then answer with the best so far, others not at all.
    The caller looks at the cancel flag at every yield; closing this iterator stops the work within one step.
    """
    waiting = dict(enumerate(tasks))
    by_workers: Iterator[tuple[int, TaskResult] | None] = iter(())
    if pool is not None and not watch.stopped():
        by_workers = _by_workers(pool, request, waiting, watch)
    yield next(by_workers, None)
    for report in by_workers:
        if report is not None:
            del waiting[report[0]]
        yield report
    for number, task in list(waiting.items()):
        if watch.stopped():
            return
        yield number, task.carry_out(request, watch.stopped)


def _by_workers(
    pool: Pool, request: Request, waiting: dict[int, Task], watch: Watch
) -> Generator[tuple[int, TaskResult] | None]:
    stopped_at: float | None = None
    works = [(number, partial(task.carry_out, request)) for number, task in waiting.items()]
    with closing(pool.answers(works, LOOK)) as reports:
        for report in reports:
            yield report
            if stopped_at is None and watch.expired():
                stopped_at = time.perf_counter()
                pool.wind_down()
            if stopped_at is not None and time.perf_counter() > stopped_at + GRACE:
                return


def work_seconds(request: Request) -> float:
    """Roughly how long polishing and search take in one process."""
    rows, columns = request.grid or USUAL_GRID
    steps = request.k * request.polish + request.search * SEARCH_STEPS
    growth = float((rows * columns / 100.0) ** STEP_GROWTH)
    return steps * STEP_SECONDS * growth


def gains(pool: Pool, request: Request) -> bool:
    """Whether ``pool`` would do the request's fits sooner, or without blocking this process."""
    busy = request.polish > 0 or request.search > 0
    return busy and pool.usable and (pool.ready or work_seconds(request) > WORTH_STARTING)


def _gaining(pool: Pool, request: Request) -> Pool | None:
    """The pool, starting up while the generator is loaded, if the request gains from it."""
    if not gains(pool, request):
        return None
    pool.start()
    return pool
