"""Figures of the whole program, the picture of all designs, and what regularity costs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.evaluate.trimming import trim
from kirigami_studio.lab.benchmark.design_suite import Made, design_figures, make_designs, worst_of, write_contact_sheet
from kirigami_studio.lab.benchmark.polish_suite import measure_regularity
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline.auto_grid import predicted_for
from kirigami_studio.pipeline.request import Request
from kirigami_studio.polish.levenberg import polish
from kirigami_studio.polish.preferences import PREFERENCES

pytestmark = pytest.mark.torch


def test_that_every_target_gets_its_best_grid_its_line_and_its_pictures(tmp_path: Path) -> None:
    requests = [[Request(load(name), grid, k=1, polish=3) for grid in ((4, 4), (6, 6))] for name in ("heart", "egg")]
    told: list[tuple[int, int]] = []
    made = make_designs(requests, lambda *counts: told.append(counts))
    assert told == [(1, 2), (2, 2)]
    figures = design_figures(made)
    shapes = figures["shapes"]
    assert isinstance(shapes, dict) and list(shapes) == ["heart", "egg"]
    assert figures["iou_exact"] == pytest.approx(np.mean([line["iou_exact"] for line in shapes.values()]))
    assert figures["iou_exact_worst"] == min(line["iou_exact"] for line in shapes.values())
    assert all(line["iou_exact"] > line["uniform_iou"] for line in shapes.values())
    assert "trimmed_iou" not in figures and "expected_off" not in figures
    assert figures["siou_gain"] == pytest.approx(figures["siou"] - figures["uniform_siou"])  # type: ignore[operator]
    path = tmp_path / "all.png"
    write_contact_sheet(made, path)
    with Image.open(path) as picture:
        assert picture.width > 1000
        assert len(picture.convert("RGB").getcolors(1 << 24) or []) > 50
    write_contact_sheet(made, path, states=True)
    with Image.open(path) as picture:
        assert picture.width > 1500
        assert len(picture.convert("RGB").getcolors(1 << 24) or []) > 50


def test_that_the_expected_match_is_held_against_the_one_that_was_reached() -> None:
    made = make_designs([[Request(load("hexagon"), None, k=1, polish=5)]])
    figures = design_figures(made)
    expected = predicted_for(replace(made[0].request, grid=None)).predicted_match
    assert figures["expected_off"] == pytest.approx(abs(made[0].best.score.iou_exact - expected))
    assert figures["expected_within_5_points"] == float(figures["expected_off"] < 0.05)  # type: ignore[operator]
    assert figures["shapes"]["hexagon"]["expected_iou"] == expected  # type: ignore[index]


def test_that_the_best_match_stands_beside_the_first_design() -> None:
    (made,) = make_designs([[Request(load("heart"), (6, 6), k=6, polish=0)]])
    assert len(made.candidates) == 6 and made.best == made.candidates[0]
    one = replace(made, best=made.candidates[-1])
    most = max(candidate.score.iou_exact for candidate in one.candidates)
    assert one.best_match.score.iou_exact == most > one.best.score.iou_exact
    figures = design_figures([one])
    assert figures["panel_area_cv"] == one.best.score.evenness.area_cv
    assert figures["best_match"]["iou_exact"] == most  # type: ignore[index]
    assert figures["best_match"]["panel_area_cv"] == one.best_match.score.evenness.area_cv  # type: ignore[index]


def test_that_both_families_are_measured_and_drawn(tmp_path: Path) -> None:
    target = load("heart")
    (made,) = make_designs([[Request(target, (6, 6), k=2, polish=0)]])
    closed = made.best
    cut = trim(deploy(closed.sheet), target, 0.0, closed.score.transform)
    cover = replace(closed, index=9, origin=Origin.COVERED, trim=replace(cut, iou=0.99, removed_share=0.11))
    one = replace(made, best=cover, candidates=(cover, *made.candidates))
    assert one.closed == closed and one.covers == (cover,) and one.best_of_families == cover
    figures = design_figures([one])
    assert figures["iou_exact"] == closed.score.iou_exact and "trimmed_iou" not in figures
    both = figures["best_of_families"]
    assert isinstance(both, dict) and both["match"] == 0.99 and both["match_worst_name"] == "heart"
    assert both["covered"] == {"heart": {"match": 0.99, "given_up": 0.11}}
    write_contact_sheet([one], tmp_path / "both.png", states=True)
    write_contact_sheet([made], tmp_path / "one.png", states=True)
    drawn = [np.asarray(Image.open(tmp_path / name).convert("L")) for name in ("both.png", "one.png")]
    assert np.count_nonzero(drawn[0] < 200) > 1.5 * np.count_nonzero(drawn[1] < 200)


def test_that_designs_below_the_uniform_sheet_and_the_worst_are_named() -> None:
    jagged = RatioField.from_log10(np.random.default_rng(0).uniform(-1, 1, (6, 6)))
    fields = {"square": jagged, "heart": polish(RatioField.uniform(6, 6), load("heart"), steps=5).field}
    made = []
    for name, field in fields.items():
        target = load(name)
        best = Candidate(Sheet(field), evaluate(deploy(field), target), 0, 0)
        made.append(Made(target, Request(target, (6, 6), k=1, polish=0), best, 0.1, 1))
    figures = design_figures(made)
    assert figures["below_uniform"] == figures["below_uniform_exact"] == ["square"]
    assert figures["worst"] == ["square", "heart"]
    assert worst_of(made, 1) == [made[0]]


def test_that_trimmed_figures_stand_beside_the_untrimmed_ones(tmp_path: Path) -> None:
    made = make_designs([[Request(load("heart"), (6, 6), k=1, polish=5, trim=True)]])
    figures = design_figures(made)
    assert figures["trimmed_iou"] > figures["iou_exact"]  # type: ignore[operator]
    write_contact_sheet(made, tmp_path / "both.png")


def test_that_each_preference_is_calmer_than_the_one_before() -> None:
    figures = measure_regularity([load("heart"), load("circle")], "prior", polish=8, grid=(6, 6))
    variation = [figures[name]["tv"] for name in PREFERENCES]  # type: ignore[index]
    assert variation == sorted(variation, reverse=True)
    assert figures["unpolished"]["siou"] < figures["balanced"]["siou"]  # type: ignore[index]
