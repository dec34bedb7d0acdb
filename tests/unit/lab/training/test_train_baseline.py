"""Training the baselines: resumed runs, the log, the command."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from command_line import answer

from kirigami_studio.foundation.errors import ModelError, UsageError
from kirigami_studio.lab.baselines.cgan import Cgan
from kirigami_studio.lab.baselines.conditional import FieldPixels
from kirigami_studio.lab.baselines.cvae import Cvae
from kirigami_studio.lab.baselines.stored import KINDS, load_generator
from kirigami_studio.lab.training.corpus import TargetNoise
from kirigami_studio.lab.training.dataset import generate_split
from kirigami_studio.lab.training.train_baseline import (
    BaselineRun,
    BaselineSettings,
    train_baseline,
    trained_baseline,
)
from kirigami_studio.lab.training.validation import baseline_validator

pytestmark = pytest.mark.torch
CPU = torch.device("cpu")


def tiny(kind: str) -> BaselineSettings:
    network = {"rows": 4, "columns": 4, "latent": 8, "mask": 32, "channels": [8, 16]}
    if kind == "diffusion":
        network["residuals"] = 1
    return BaselineSettings(kind, network, steps=6, batch=8, chunk=64)


def train(settings: BaselineSettings, folder: Path, **options: float) -> list[dict[str, float]]:
    return list(train_baseline(settings, folder, CPU, lambda network: {}, validate_every=3, **options))


@pytest.mark.parametrize("kind", KINDS)
def test_that_a_resumed_run_equals_an_uninterrupted_one(tmp_path: Path, kind: str) -> None:
    settings = tiny(kind)
    records = train(settings, tmp_path / "whole")
    assert [record["step"] for record in records] == [3.0, 6.0]
    assert train(settings, tmp_path / "parts", seconds=0.0)[-1]["step"] < settings.steps
    train(settings, tmp_path / "parts")
    whole, parts = (trained_baseline(settings, tmp_path / name, CPU).state_dict() for name in ("whole", "parts"))
    assert all(torch.equal(whole[name], parts[name]) for name in whole)


def test_that_a_run_of_other_settings_is_not_gone_on_with(tmp_path: Path) -> None:
    settings = tiny("cgan")
    train(settings, tmp_path)
    with pytest.raises(ModelError) as caught:
        train(replace(settings, learning_rate=1e-3), tmp_path)
    assert caught.value.code == "training.checkpoint_differs"


@pytest.mark.parametrize("kind", KINDS)
def test_that_validation_scores_every_family(kind: str, tmp_path: Path) -> None:
    settings = tiny(kind)
    train(settings, tmp_path)
    figures = baseline_validator(4, CPU, steps=2)(trained_baseline(settings, tmp_path, CPU))
    assert set(figures) == {"structured_iou", "released_iou", "sobol_iou", "drawn_iou"}
    assert all(0.0 < figure <= 1.0 for figure in figures.values())


def test_that_a_run_visits_the_data_set_that_its_settings_name(tmp_path: Path) -> None:
    split = generate_split("released", 8, seed=0, grid=(4, 4))
    settings = replace(tiny("cvae"), family="released", designs=str(split.about["sha256"]))
    run = BaselineRun(settings, tmp_path / "none", CPU, split)
    known = torch.tensor(np.log10(split.ratios), dtype=torch.float32).flatten(1)
    assert torch.cdist(run.designs.at(5).z, known).min(dim=1).values.max() < 1e-5
    with pytest.raises(ModelError) as caught:
        train(settings, tmp_path / "run")
    assert caught.value.code == "training.other_start"


def test_that_masks_of_still_targets_are_those_of_the_designs_as_they_lie(tmp_path: Path) -> None:
    moving = BaselineRun(tiny("cgan"), tmp_path / "none", CPU)
    still = BaselineRun(replace(tiny("cgan"), vertex_noise=0.0, turn_noise=0.0), tmp_path / "none", CPU)
    seen = still.designs.at(9)
    polygons = TargetNoise(0.0, 0.0).seen(moving.designs.at(9).polygons, torch.Generator())
    assert torch.equal(seen.polygons, still.learner.network.pixels.masks(polygons))
    assert torch.equal(seen.z, moving.designs.at(9).z)
    assert still.advance()["loss"] != moving.advance()["loss"]


def test_that_baselines_draw_into_as_many_pixels_as_the_field_has() -> None:
    pixels = FieldPixels(latent=10, mask=120)
    masks = torch.ones(2, 1, 10, 10)
    for network in (Cgan(pixels), Cvae(pixels, (16, 32))):
        assert network.draw(masks, torch.Generator().manual_seed(0), 1).shape == (2, 100)
    with pytest.raises(UsageError) as caught:
        Cvae(pixels, (16, 32, 32))
    assert caught.value.code == "model.baseline_pixels"


def test_that_the_command_writes_weights_that_can_be_loaded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("kirigami_studio.lab.cli.learning.VALIDATION_COUNT", 4)
    small = ("--steps", 2, "--latent", 8, "--channels", "4,8", "--batch", 8, "--still")
    record = answer(capsys, "train", "cgan", *small, "--out", tmp_path / "run", "--json")
    assert record["record"]["step"] == 2.0
    stored = load_generator(Path(record["files"][0]))
    assert stored.kind == "cgan" and stored.about["settings"]["first_moment"] == 0.5
    assert stored.about["settings"]["turn_noise"] == stored.about["settings"]["vertex_noise"] == 0.0
    about = json.loads((tmp_path / "run" / "about.json").read_text())
    assert about["settings"] == stored.about["settings"]
    assert about["parameters"] == sum(weights.numel() for weights in stored.network.parameters())
