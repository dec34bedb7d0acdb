"""A run can be repeated from what is said of it."""

from __future__ import annotations

import math

from kirigami_studio.evaluate.second_target import SecondTarget
from kirigami_studio.outlines import silhouettes
from kirigami_studio.pipeline.request import Request, provenance


def test_that_model_number_steps_and_fit_of_a_run_are_told() -> None:
    request = Request(
        silhouettes.load("heart"), (4, 5), k=7, steps=3, polish=9, prefer="calm", search=2, variant="calm"
    )
    told = provenance(request, "ab" * 32)
    wanted = {"model": "calm", "model_sha256": "ab" * 32, "k": "7", "steps": "3", "polish": "9", "prefer": "calm"}
    assert told.items() >= {**wanted, "search": "2"}.items()


def test_that_a_second_target_is_told_with_its_angle_weight_and_shape() -> None:
    second = SecondTarget(silhouettes.load("circle"), math.radians(45.0), 0.3)
    told = provenance(Request(silhouettes.load("heart"), (4, 5), second=second, polish=0), "")
    wanted = {"second_target": "circle", "second_target_deg": "45", "second_target_weight": "0.3"}
    assert told.items() >= wanted.items() and told["second_target_sha256"] == second.digest
    assert not any(
        name.startswith("second") for name in provenance(Request(silhouettes.load("heart"), (4, 5), polish=0), "")
    )
