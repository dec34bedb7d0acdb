"""A run that adds to designs that are there, as a Qt-free generator."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.gui.jobs.queue import Cancel
from kirigami_studio.gui.jobs.steps import Decoded, ModelFound, generating
from kirigami_studio.pipeline.events import Event, Finished
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.variety import distinct


def adding(request: Request, others: tuple[Candidate, ...], cancel: Cancel) -> Iterator[Event | ModelFound | Decoded]:
    """Run the pipeline; of its result only designs stay that are neither among ``others`` nor each other's.

    Comparing a thousand designs with a thousand takes a second, which the window's thread does not have.
    """
    for report in generating(request, cancel):
        if isinstance(report, Finished):
            found = report.result.candidates
            new = distinct(found, others)
            yield Finished(replace(report.result, candidates=new, repeats=len(found) - len(new)))
        else:
            yield report
