"""A start that is left to the run: tried where a shape is hard, told, and fixed where it was named."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pytest

from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.outlines.starts import RECTANGLE, start_shape
from kirigami_studio.pipeline.auto_start import GAIN, TRIED, chosen_start
from kirigami_studio.pipeline.request import Request, provenance
from kirigami_studio.pipeline.run import with_grid
from kirigami_studio.pipeline.tasks import TrialTask
from kirigami_studio.project.codec import decode, encode
from kirigami_studio.project.document import Document

AUTO = start_shape("auto")


class Trials:
    """Answers short fits with a match for each start."""

    def __init__(self, **match: float) -> None:
        self.match, self.asked = match, []

    def __call__(self, request: Request, tasks: Sequence[TrialTask]) -> list[float]:
        self.asked.append(request.start.name)
        return [self.match.get(request.start.name, 0.5)]


def test_that_a_shape_of_few_corners_has_a_rectangle_without_trying() -> None:
    trials = Trials()
    choice = chosen_start(Request(load("heart"), None, start=AUTO), trials)
    assert choice.start == RECTANGLE and choice.code == "start.few_corners" and not trials.asked


@pytest.mark.parametrize(("gain", "name"), [(1.1 * GAIN, "hexagon"), (0.9 * GAIN, "rectangle")])
def test_that_another_start_has_to_be_clearly_better(gain: float, name: str) -> None:
    trials = Trials(rectangle=0.9, hexagon=0.9 + gain)
    request = Request(load("plus"), None, width_mm=100.0 + gain, start=replace(AUTO, weight=0.5))
    choice = chosen_start(request, trials)
    assert choice.start == replace(start_shape(name), weight=0.5)
    assert trials.asked == ["rectangle", *TRIED] and name in choice.reason
    again = Trials()
    assert chosen_start(request, again) is choice and not again.asked


def test_that_a_named_start_stays_and_an_open_one_is_chosen_and_told() -> None:
    fixed = Request(load("heart"), (6, 6), start=start_shape("circle"))
    assert with_grid(fixed) is fixed
    found = with_grid(Request(load("heart"), (6, 7), start=AUTO))
    assert found.start == RECTANGLE and found.start_chosen
    assert provenance(found, "ab" * 32)["start_choice"] == "auto"
    assert found.settings.start == AUTO


def test_that_a_project_keeps_that_the_start_is_left_to_the_run() -> None:
    settings = replace(Request(load("heart"), (6, 7)).settings, start=AUTO)
    document = Document(load("heart"), settings)
    assert decode(encode(document)).settings.start == AUTO


@pytest.mark.parametrize("name", ["gable", "notch"])
def test_that_gable_and_notch_have_a_corner_on_their_upright_axis(name: str) -> None:
    points = start_shape(name).outline.points  # type: ignore[union-attr]
    on_axis = points[abs(points[:, 0]) < 1e-9]
    assert len(on_axis) == 1 and start_shape(name).sides == len(points)
