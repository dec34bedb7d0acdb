"""``benchmark`` on the command line: suites that compare variants."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from kirigami_studio.cli import main

pytestmark = pytest.mark.torch


def figures(capsys: pytest.CaptureFixture[str], *words: str) -> Any:
    assert main(["benchmark", *words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_that_variants_are_measured_on_both_families_of_either_split(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    out = tmp_path / "figures.json"
    words = ("variants", "--count", "1", "--seeds", "0")
    test = figures(capsys, *words, "--out", str(out))
    assert json.loads(out.read_text()) == test
    assert list(test) == ["structured", "sobol"]
    assert "prior" in test["sobol"]["variants"]
    validation = figures(capsys, *words, "--split", "validation", "--variants", "prior")
    for family in test:
        found = [split[family]["variants"]["prior"]["uniform_siou"] for split in (test, validation)]
        assert found[0] != found[1]


def test_that_spread_and_robustness_take_named_targets(capsys: pytest.CaptureFixture[str]) -> None:
    spread = figures(capsys, "spread", "--targets", "heart", "--k", "2", "--variants", "prior")
    assert spread["targets"]["variants"]["prior"]["own_poses"]["std_rms"]["mean"] > 0.0
    robust = figures(capsys, "robustness", "--targets", "heart", "--seeds", "0", "--variants", "prior")
    assert robust["targets"]["prior"]["clean"]["siou"] > 0.9
    assert robust["targets"]["prior"]["together_64"]["siou_difference"] != 0.0


def test_that_a_picture_can_show_the_worst_only(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    sizes = []
    for worst in ((), ("--worst", "1")):
        path = tmp_path / f"picture{len(sizes)}.png"
        names = ["letter-l", "heart", "star", "egg", "circle", "square", "drop"]
        figures(capsys, "designs", "--targets", *names, "--steps", "1", "--picture", str(path), *worst)
        with Image.open(path) as picture:
            sizes.append(picture.height)
    assert sizes[0] > 1.5 * sizes[1]  # two rows of tiles, and one


def test_that_an_unknown_variant_is_wrong_usage_before_anything_is_measured(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for suite in ("variants", "spread", "robustness", "generation-speed"):
        assert main(["benchmark", suite, "--variants", "prior,none", "--count", "1"]) == 2
        captured = capsys.readouterr()
        assert captured.out == "" and "no generator variant 'none'" in captured.err
