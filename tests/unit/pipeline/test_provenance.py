"""A run can be repeated from what is said of it."""

from __future__ import annotations

from kirigami_studio.outlines import silhouettes
from kirigami_studio.pipeline.request import Request, provenance


def test_that_model_number_steps_and_fit_of_a_run_are_told() -> None:
    request = Request(
        silhouettes.load("heart"), (4, 5), k=7, steps=3, polish=9, prefer="calm", search=2, variant="calm"
    )
    told = provenance(request, "ab" * 32)
    wanted = {"model": "calm", "model_sha256": "ab" * 32, "k": "7", "steps": "3", "polish": "9", "prefer": "calm"}
    assert told.items() >= {**wanted, "search": "2"}.items()
