"""Scores in a file are those of its designs, or the designs are scored again on opening."""

from __future__ import annotations

import json
import math
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from kirigami_studio.evaluate import score as scoring
from kirigami_studio.evaluate.score import Score, confirmed, evaluate
from kirigami_studio.evaluate.second_target import SecondMatch, SecondTarget, second_matches
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.outlines.silhouettes import load as silhouette
from kirigami_studio.project import store
from kirigami_studio.project.document import Document

ATTACKS = Path(__file__).parents[2] / "data" / "attacks"


def true_scores(document: Document) -> list[Score]:
    assert document.target is not None
    return [evaluate(deploy(one.sheet), document.target, one.score.phi) for one in document.candidates]


def changed(document: Document, path: Path, change: Callable[[dict[str, Any]], None]) -> Document:
    """The document after its file was changed by hand."""
    store.save(document, path)
    with zipfile.ZipFile(path) as packed:
        members = {name: packed.read(name) for name in packed.namelist()}
    design = json.loads(members["design.json"])
    change(design)
    with zipfile.ZipFile(path, "w") as packed:
        for name, content in (members | {"design.json": json.dumps(design).encode()}).items():
            packed.writestr(name, content)
    return store.load(path)


@pytest.mark.parametrize("case", ["iou5.kiri", "scalehuge.kiri"])
def test_that_a_project_from_outside_shows_the_scores_of_its_designs(case: str) -> None:
    document = store.load(ATTACKS / case)
    for candidate, true in zip(document.candidates, true_scores(document), strict=True):
        assert candidate.score.iou_exact == pytest.approx(true.iou_exact, abs=1e-4) != 5.0
        assert candidate.score.transform.scale == pytest.approx(true.transform.scale, rel=0.02)


LIES: tuple[dict[str, Any], ...] = (
    {"iou_exact": 0.999},
    {"iou_exact": -1.0},
    {"siou": 0.99},
    {"siou_gain": 0.9},
    {"uniform_siou": -3.0},
    {"uniform_iou": 2.0},
    {"tv": 0.0},
    {"overlap_ratio": 0.5},
    {"feasible": False},
    {"n_invalid": 7},
    {"contact": {"phi": 0.2, "where": [1.0, 2.0]}},
    {"transform": {"scale": 1e-9, "angle": 0.0, "shift": [0.0, 0.0]}},
    {"transform": {"scale": 0.2, "angle": 0.0, "shift": [1e250, 0.0]}},
    {"transform": {"scale": 1e250, "angle": 0.0, "shift": [0.0, 0.0]}},
)


@pytest.mark.parametrize("lie", LIES)
def test_that_a_design_with_a_false_score_is_scored_again(
    lie: dict[str, Any], document: Document, tmp_path: Path
) -> None:
    def change(design: dict[str, Any]) -> None:
        design["candidates"][1]["score"] |= lie

    opened = changed(document, tmp_path / "lying.kiri", change)
    assert [one.score for one in opened.candidates] == true_scores(document)


def test_that_a_design_whose_panels_are_told_to_be_even_is_measured(document: Document, tmp_path: Path) -> None:
    def change(design: dict[str, Any]) -> None:
        design["candidates"][0]["score"]["evenness"]["area_cv"] = 0.0

    opened = changed(document, tmp_path / "lying.kiri", change)
    assert opened.candidates[0].score == true_scores(document)[0]


def test_that_a_false_match_of_a_second_target_is_matched_again(document: Document, tmp_path: Path) -> None:
    target = SecondTarget(silhouette("heart"), math.radians(60.0), 0.3)
    (true,) = second_matches([deploy(document.candidates[0].sheet)], target)
    assert true is not None
    with_second = replace(document, candidates=(replace(document.candidates[0], second=true), *document.candidates[1:]))

    def change(design: dict[str, Any]) -> None:
        design["candidates"][0]["second"]["iou_exact"] = 1.0

    opened = changed(with_second, tmp_path / "lying.kiri", change)
    assert opened.candidates[0].second == SecondMatch(target, true.match)


def test_that_true_scores_are_kept_as_they_are_read_without_scoring_anew(
    document: Document, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(*_: object, **__: object) -> None:
        raise AssertionError("scored again")

    monkeypatch.setattr(scoring, "siou_of_many", refused)
    scores = [candidate.score for candidate in document.candidates]
    assert document.target is not None
    kept = confirmed([deploy(one.sheet) for one in document.candidates], scores, document.target)
    assert all(one is other for one, other in zip(kept, scores, strict=True))
