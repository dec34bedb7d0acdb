"""What a request may ask for, and what becomes of a grid that is left to the run."""

from __future__ import annotations

import math
from typing import Any

import pytest

from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline.request import Request, as_in_paper, provenance
from kirigami_studio.pipeline.run import with_grid


@pytest.mark.parametrize(
    ("code", "changes"),
    [
        ("request.unknown_symmetry", {"symmetry": "left"}),
        ("request.unknown_rim", {"rim": "wavy"}),
        ("request.regular_out_of_range", {"regular": 1.1}),
        ("request.regular_out_of_range", {"regular": math.nan}),
        ("request.width_not_positive", {"width_mm": 0.0}),
        ("request.width_not_positive", {"width_mm": math.inf}),
        ("request.least_feature_out_of_range", {"least_feature_mm": -0.1}),
    ],
)
def test_that_what_no_run_can_do_is_refused(code: str, changes: dict[str, Any]) -> None:
    with pytest.raises(UsageError) as caught:
        Request(load("heart"), **changes)
    assert caught.value.code == code


def test_that_an_open_grid_is_chosen_once_and_a_given_one_stays() -> None:
    request = Request(load("heart"), None, polish=0)
    with pytest.raises(UsageError) as caught:
        _ = request.chosen_grid
    assert caught.value.code == "request.grid_not_chosen"
    chosen = with_grid(request)
    assert chosen.grid == chosen.chosen_grid and chosen.grid_chosen and with_grid(chosen) == chosen
    given = Request(load("heart"), (4, 6), polish=0)
    assert with_grid(given) is given and given.resolved((8, 8)) is given and not given.grid_chosen


def test_that_a_run_tells_how_its_sheets_had_to_be() -> None:
    request = Request(load("heart"), (4, 6), symmetry="mirror", rim="even", regular=0.25, polish=0)
    told = provenance(request, "ab" * 32)
    assert told.items() >= {"symmetry": "mirror", "rim": "even", "regular": "0.25"}.items()
    assert "grid_choice" not in told
    assert provenance(Request(load("heart"), None, polish=0).resolved((4, 6)), "ab" * 32)["grid_choice"] == "auto"


def test_that_the_papers_setting_has_an_even_rim_and_ranks_by_match() -> None:
    request = as_in_paper(Request(load("heart"), (4, 6), k=3, polish=0))
    assert (request.rim, request.symmetry, request.regular, request.k) == ("even", "none", 0.0, 3)
