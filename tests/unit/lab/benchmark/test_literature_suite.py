"""Published targets are designed in both states, and set beside the published sheets of as many panels."""

from __future__ import annotations

from pathlib import Path

import pytest

from kirigami_studio.lab.benchmark.literature_suite import (
    PUBLISHED,
    design_literature,
    literature_figures,
    literature_sentences,
)
from kirigami_studio.outlines.read import read_target
from kirigami_studio.outlines.silhouettes import load

LITERATURE = Path(__file__).parents[3] / "data" / "literature"


def test_that_every_published_value_has_its_target() -> None:
    names = {path.stem for path in LITERATURE.glob("*.json")}
    assert len(names) == 14 and {target for target, _, _ in PUBLISHED} <= names


def test_that_a_half_open_circle_is_set_beside_the_published_one() -> None:
    circle = read_target(str(LITERATURE / "choi2019_circle.json"))
    rows = design_literature([circle], [5], ["closed", "half"], 2, 0)
    closed, half = rows
    assert closed.published is None and half.published == PUBLISHED["choi2019_circle", 5, "half"]
    assert closed.panels == half.panels == 36
    # A sheet that is closed again has no notches in its rim.
    assert 0.85 < half.most < closed.first <= closed.most <= 1.0
    assert closed.released == pytest.approx(closed.first, abs=0.01) and half.released is None
    assert closed.uniform < closed.first and half.uniform < half.first
    assert all(0.0 < row.first_rim_off < 0.04 for row in rows)
    figures = literature_figures(rows)
    assert figures["published"] == 1 and figures["most_ahead"] == int(half.most > 0.912)
    assert len(list(literature_sentences(rows))) == 4


def test_that_nodes_of_the_rim_lie_on_the_curve_where_the_match_is_whole() -> None:
    (square,) = design_literature([load("square")], [5], ["closed"], 1, 0)
    assert square.most == pytest.approx(1.0, abs=1e-6) and square.most_rim_off < 1e-5
    (open_square,) = design_literature([load("square")], [5], ["half"], 1, 0)
    assert open_square.most_rim_off > 100 * square.most_rim_off
