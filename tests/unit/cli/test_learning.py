"""``dataset drawn`` and ``train`` with what it makes."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from kirigami_studio.cli import main
from kirigami_studio.generator.unet import UNetShape
from kirigami_studio.generator.weights import load_model
from kirigami_studio.lab.training import first_designs
from kirigami_studio.lab.training.fitted_fields import FittedFields, fit_shapes, fitted_block
from kirigami_studio.lab.training.train_flow import FlowSettings

pytestmark = pytest.mark.torch


@pytest.fixture
def small_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few validation targets and designs: 200 and 32 768 of them take most of a minute."""
    monkeypatch.setattr("kirigami_studio.lab.cli.learning.VALIDATION_COUNT", 12)
    monkeypatch.setattr("kirigami_studio.lab.training.train_flow.FlowSettings", partial(FlowSettings, chunk=128))


@pytest.fixture(scope="module")
def fits(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("fits") / "drawn.npz"
    fitted_block(0, seed=2, grid=(10, 10), size=3).save(path)
    return path


def test_that_fits_of_drawn_shapes_are_written(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("kirigami_studio.lab.training.fitted_fields.fit_shapes", partial(fit_shapes, block_size=3))
    words = ["dataset", "drawn", "--grid", "4x4", "--count", "1", "--seed", "8", "--out", str(tmp_path), "--json"]
    assert main(words) == 0
    answered = json.loads(capsys.readouterr().out)
    written = FittedFields.load(Path(answered["files"]["train"]))
    assert len(written.z) == answered["fits"] >= 1
    assert written.iou.min() >= 0.85


@pytest.mark.usefixtures("small_runs")
def test_that_first_designs_are_written_and_distilled(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    for name, value in {"DESIGNS": 2, "STEPS": 4, "SMALLEST_IOU": 0.7}.items():
        monkeypatch.setattr(first_designs, name, value)
    monkeypatch.setattr(first_designs, "design_shapes", partial(first_designs.design_shapes, block_size=1))
    assert main(["dataset", "first-designs", "--count", "1", "--seed", "5", "--out", str(tmp_path), "--json"]) == 0
    answered = json.loads(capsys.readouterr().out)
    written = Path(answered["files"]["train"])
    assert answered["shapes"] == 1 <= answered["designs"] and 0.7 <= answered["mean_iou"] <= 1.0
    words = ["train", "align", "--steps", "1", "--batch", "4", "--drawn", "2", "--device", "cpu", "--json"]
    words += ["--designs", str(written), "--design-share", "1", "--out", str(tmp_path / "run")]
    assert main(words) == 0
    record = json.loads(capsys.readouterr().out)["record"]
    assert record["flow"] > 0.0 and record["likeness"] > 0.0
    manifest = json.loads((tmp_path / "run" / "manifest.json").read_text())
    settings = manifest["variants"]["balanced"]["about"]["settings"]
    assert settings["designs"] == first_designs.FirstDesigns.load(written).digest


def test_that_weights_of_distilling_need_designs(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    words = ["train", "align", "--design-share", "0.5", "--flow-weight", "1", "--out", str(tmp_path / "run")]
    assert main(words) == 2
    assert "with --designs, or leave out --design-share, --flow-weight." in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


@pytest.mark.usefixtures("small_runs")
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


@pytest.mark.usefixtures("small_runs")
def test_that_the_papers_network_is_trained_at_the_fields_own_pixels_on_a_data_set(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert main(["dataset", "released", "--split", "train", "--count", "9", "--out", str(tmp_path), "--json"]) == 0
    made = json.loads(capsys.readouterr().out)
    words = ["train", "prior", "--backbone", "unet", "--channels", "8,16", "--latent", "10", "--residuals", "1"]
    words += ["--batch", "8", "--noises", "1", "--outline-weight", "0", "--average-decay", "0.5", "--steps", "1"]
    words += ["--designs", made["files"]["train"], "--device", "cpu", "--out", str(tmp_path / "run"), "--json"]
    assert main(words) == 0
    entry = json.loads((tmp_path / "run" / "manifest.json").read_text())["variants"]["prior"]
    assert (entry["shape"]["latent"], entry["shape"]["mask"]) == (10, 120)
    settings = entry["about"]["settings"]
    assert (settings["family"], settings["average_decay"]) == ("released", 0.5)
    assert settings["designs"] == made["splits"]["train"]["sha256"]


@pytest.mark.usefixtures("small_runs")
def test_that_a_unet_is_trained_stored_and_gone_on_with(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    words = ["train", "prior", "--backbone", "unet", "--channels", "8,16", "--coupling", "ot", "--batch", "16"]
    words += ["--noises", "1", "--learning-rate", "2e-5", "--weight-decay", "0.05", "--outline-weight", "0"]
    words += ["--steps", "1", "--device", "cpu", "--out", str(tmp_path / "run")]
    assert main([*words, "--json"]) == 0
    answered = json.loads(capsys.readouterr().out)
    assert answered["record"]["step"] == 1
    entry = json.loads((tmp_path / "run" / "manifest.json").read_text())["variants"]["prior"]
    assert (entry["backbone"], entry["shape"]["channels"]) == ("unet", [8, 16])
    assert (entry["about"]["settings"]["weight_decay"], entry["about"]["settings"]["noises"]) == (0.05, 1)
    assert load_model("prior", tmp_path / "run").network.shape == UNetShape(channels=(8, 16))
    about = json.loads((tmp_path / "run" / "about.json").read_text())
    assert about["settings"]["coupling"] == "ot" and about["parameters"] > 1000
    assert main(words) == 0  # finished already: stored again
    assert main([*words, "--channels", "8,8"]) == 1
    assert "other settings (shape)" in capsys.readouterr().err
    assert main(["train", "prior", "--steps", "1", "--device", "cpu", "--out", str(tmp_path / "run")]) == 1
    assert "shape" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("code", "words", "said"),
    [
        (2, ["dataset", "drawn", "--split", "test"], "training only"),
        (2, ["dataset", "first-designs", "--split", "test"], "training only"),
        (2, ["dataset", "first-designs", "--grid", "6x6"], "Leave out --grid"),
        (1, ["train", "align", "--designs", "nowhere.npz"], "nowhere.npz"),
        (2, ["train", "align", "--design-share", "1.5"], "--design-share"),
        (2, ["train", "prior", "--fit-share", "1"], "--fit-share"),
        (2, ["train", "prior", "--channels", "8,16"], "--backbone unet"),
        (2, ["train", "prior", "--backbone", "unet", "--feedback"], "--feedback belongs to the perceptron"),
        (2, ["train", "prior", "--backbone", "unet", "--channels", "8;16"], "--channels must be whole numbers"),
        (2, ["train", "prior", "--backbone", "unet", "--channels", "8,15"], "even numbers"),
        (2, ["train", "prior", "--backbone", "unet", "--channels", "4,4,4,4,4,4,4"], "7 levels"),
        (1, ["train", "prior", "--backbone", "unet", "--channels", "8,16", "--warm-start", "bundled"], "another shape"),
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
    assert "8 x 8" in capsys.readouterr().err
