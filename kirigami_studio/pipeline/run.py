"""The whole way from request to ranked candidates, as an iterator of events."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate_many
from kirigami_studio.foundation.errors import Cancelled
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.pipeline.events import (
    CandidateFound,
    CandidateImproved,
    Event,
    Finished,
    Progress,
    Result,
    Started,
)
from kirigami_studio.pipeline.rank import rank_key, ranked
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.threads import one_blas_thread
from kirigami_studio.polish.levenberg import polish

#: Candidates scored in one batch: enough to save time, few enough to see them arrive.
SCORED_TOGETHER = 8


def never() -> bool:
    """A cancel flag that is never raised."""
    return False


def run(request: Request, cancel: Callable[[], bool] = never) -> Iterator[Event]:
    """Sample, decode, score, polish if asked for, and rank.

    Parameters
    ----------
    request : Request
    cancel : callable
        Asked between candidates; once true the run stops.

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
    began = time.perf_counter()
    yield Started(request.k)
    yield Progress(0, request.k, "Loading the generator")
    fields = sample(request)
    found: list[Candidate] = []
    for start in range(0, len(fields), SCORED_TOGETHER):
        _stop_if(cancel, f"Stopped after {start} of {request.k} candidates; nothing was changed.")
        for candidate in scored(request, fields[start : start + SCORED_TOGETHER], start):
            found.append(candidate)
            yield CandidateFound(candidate.index, candidate)
        yield Progress(len(found), request.k, f"Candidate {len(found)} of {request.k}")
    evaluations = len(found)
    for done, candidate in enumerate(ranked(found) if request.polish else ()):
        _stop_if(cancel, f"Stopped while polishing candidate {done + 1} of {request.k}; nothing was changed.")
        yield Progress(done, request.k, f"Polishing candidate {done + 1} of {request.k}")
        better, tried = polished(request, candidate)
        evaluations += tried
        if better is not candidate:
            found[candidate.index] = better
            yield CandidateImproved(candidate.index, better)
    yield Finished(Result(request, ranked(found), evaluations, time.perf_counter() - began))


def sample(request: Request) -> tuple[RatioField, ...]:
    """Draw the request's fields; torch is imported here, on the first run, and not when the program starts."""
    from kirigami_studio.generator.sampler import draw_fields
    from kirigami_studio.generator.weights import load_model

    model = load_model(request.variant)
    return draw_fields(model, request.target, request.grid, request.k, request.seed, request.steps)


def scored(request: Request, fields: Sequence[RatioField], first: int, *, fitted: bool = False) -> list[Candidate]:
    """Decode fields exactly and score them against the request's target; their numbers count up from ``first``."""
    with one_blas_thread():
        scores = evaluate_many([deploy(field) for field in fields], request.target, request.phi)
    return [
        Candidate(field, score, request.seed, first + place, polished=fitted)
        for place, (field, score) in enumerate(zip(fields, scores, strict=True))
    ]


def polished(request: Request, candidate: Candidate) -> tuple[Candidate, int]:
    """Fit a candidate on the exact geometry.

    Returns
    -------
    candidate : Candidate
        The fitted one if it ranks before the given one, else the given one itself.
    evaluations : int
        Layouts decoded on the way.
    """
    with one_blas_thread():
        fit = polish(candidate.field, request.target, request.phi, request.polish, pose=candidate.score.transform)
    (better,) = scored(request, [fit.field], candidate.index, fitted=True)
    return (better if rank_key(better) < rank_key(candidate) else candidate), fit.evaluations + 1


def _stop_if(cancel: Callable[[], bool], sentence: str) -> None:
    if cancel():
        raise Cancelled(sentence)


def best_of(request: Request, cancel: Callable[[], bool] = never) -> Result:
    """Run to the end and return the result alone."""
    for event in run(request, cancel):
        if isinstance(event, Finished):
            return event.result
    raise Cancelled("The run ended without a result.")
