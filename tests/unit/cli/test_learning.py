"""``dataset drawn`` and ``train`` with what it makes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from kirigami_studio.cli import main
from kirigami_studio.training.fitted_fields import FittedFields, fitted_block

pytestmark = pytest.mark.torch


@pytest.fixture(scope="module")
def fits(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("fits") / "drawn.npz"
    fitted_block(0, seed=2, grid=(10, 10), variant="prior", size=3).save(path)
    return path


def test_that_fits_of_drawn_shapes_are_written(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    words = ["dataset", "drawn", "--grid", "4x4", "--count", "1", "--seed", "8", "--out", str(tmp_path), "--json"]
    assert main(words) == 0
    answered = json.loads(capsys.readouterr().out)
    written = FittedFields.load(Path(answered["files"]["train"]))
    assert len(written.z) == answered["fits"] >= 1
    assert written.iou.min() >= 0.85


def test_that_training_begins_with_the_bundled_weights_and_sees_the_fits(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, fits: Path
) -> None:
    words = ["train", "prior", "--steps", "1", "--learning-rate", "1e-9", "--warm-start", "bundled"]
    assert main([*words, "--fits", str(fits), "--device", "cpu", "--json", "--out", str(tmp_path / "a")]) == 0
    first = json.loads(capsys.readouterr().out)
    assert first["record"]["structured_iou"] > 0.9
    settings = json.loads((tmp_path / "a" / "manifest.json").read_text())["variants"]["prior"]["about"]["settings"]
    assert settings["fits"] == FittedFields.load(fits).digest
    weights = first["files"][0]
    words[-1] = weights
    assert main([*words, "--device", "cpu", "--json", "--out", str(tmp_path / "b")]) == 0
    second = json.loads(capsys.readouterr().out)
    assert second["record"]["drawn_iou"] == pytest.approx(first["record"]["drawn_iou"], abs=1e-3)


@pytest.mark.parametrize(
    ("code", "words", "said"),
    [
        (2, ["dataset", "drawn", "--split", "test"], "training only"),
        (2, ["train", "prior", "--fit-share", "1"], "--fit-share"),
        (1, ["train", "prior", "--fits", "nowhere.npz"], "nowhere.npz"),
        (1, ["train", "prior", "--warm-start", "nowhere/prior.safetensors"], "nowhere"),
    ],
)
def test_that_what_is_missing_or_makes_no_sense_is_refused(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, code: int, words: list[str], said: str
) -> None:
    assert main([*words, "--out", str(tmp_path / "out")]) == code
    assert said in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_that_fits_of_another_grid_are_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path, fits: Path) -> None:
    whole = FittedFields.load(fits)
    smaller = FittedFields(
        np.ascontiguousarray(whole.z[:, :8, :8]), whole.requested, whole.iou, whole.shape, whole.candidate,
        whole.block, {},
    )  # fmt: skip
    smaller.save(tmp_path / "small.npz")
    assert main(["train", "prior", "--fits", str(tmp_path / "small.npz"), "--out", str(tmp_path / "out")]) == 2
    assert "8x8" in capsys.readouterr().err
