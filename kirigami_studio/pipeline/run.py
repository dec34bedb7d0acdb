"""The whole way from request to ranked candidates, as an iterator of events."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.foundation.errors import Cancelled
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.pipeline.events import CandidateFound, Event, Finished, Progress, Result, Started
from kirigami_studio.pipeline.rank import ranked
from kirigami_studio.pipeline.request import Request


def never() -> bool:
    """A cancel flag that is never raised."""
    return False


def run(request: Request, cancel: Callable[[], bool] = never) -> Iterator[Event]:
    """Sample, decode, score and rank.

    Parameters
    ----------
    request : Request
    cancel : callable
        Asked between candidates; once true the run stops.

    Yields
    ------
    Event
        ``Started``, then ``Progress`` and ``CandidateFound`` in turn, then ``Finished``.

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
    for index, field in enumerate(fields):
        if cancel():
            raise Cancelled(f"Stopped after {index} of {request.k} candidates; nothing was changed.")
        found.append(scored(request, field, index))
        yield CandidateFound(index, found[-1])
        yield Progress(index + 1, request.k, f"Candidate {index + 1} of {request.k}")
    yield Finished(Result(request, ranked(found), len(found), time.perf_counter() - began))


def sample(request: Request) -> tuple[RatioField, ...]:
    """Draw the request's fields; torch is imported here, on the first run, and not when the program starts."""
    from kirigami_studio.generator.sampler import draw_fields
    from kirigami_studio.generator.weights import load_model

    model = load_model(request.variant)
    return draw_fields(model, request.target, request.grid, request.k, request.seed, request.steps)


def scored(request: Request, field: RatioField, index: int, *, polished: bool = False) -> Candidate:
    """Decode one field exactly and score it against the request's target."""
    score = evaluate(deploy(field), request.target, request.phi)
    return Candidate(field, score, request.seed, index, polished)


def best_of(request: Request, cancel: Callable[[], bool] = never) -> Result:
    """Run to the end and return the result alone."""
    for event in run(request, cancel):
        if isinstance(event, Finished):
            return event.result
    raise Cancelled("The run ended without a result.")
