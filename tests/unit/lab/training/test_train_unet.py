"""Training the paper's network, in a tiny configuration."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from kirigami_studio.foundation.errors import ModelError
from kirigami_studio.generator.unet import UNetShape, UNetVelocity
from kirigami_studio.generator.weights import load_model
from kirigami_studio.lab.trained_weights import store_model
from kirigami_studio.lab.training.fitted_fields import fitted_block
from kirigami_studio.lab.training.train_flow import FlowRun, FlowSettings, Sources, train_flow, trained_network
from kirigami_studio.lab.training.validation import validator

pytestmark = pytest.mark.torch
CPU = torch.device("cpu")
TINY = FlowSettings(
    steps=8,
    batch=8,
    noises=1,
    chunk=64,
    coupling="ot",
    outline_weight=0.0,
    weight_decay=0.05,
    learning_rate=3e-3,
    shape=UNetShape(4, 4, channels=(8, 16), residuals=1, latent=8, mask=32),
)


def train(
    settings: FlowSettings, folder: Path, sources: Sources | None = None, **options: float
) -> list[dict[str, float]]:
    return list(train_flow(settings, folder, CPU, lambda network: {}, validate_every=4, sources=sources, **options))


@pytest.mark.parametrize(("coupling", "outline_weight"), [("ot", 0.0), ("conditional-ot", 50.0)])
def test_that_a_resumed_run_equals_an_uninterrupted_one(tmp_path: Path, coupling: str, outline_weight: float) -> None:
    settings = replace(TINY, coupling=coupling, outline_weight=outline_weight)
    train(settings, tmp_path / "whole")
    assert train(settings, tmp_path / "parts", seconds=0.0)[-1]["step"] < settings.steps
    train(settings, tmp_path / "parts")
    whole, parts = (trained_network(settings, tmp_path / name, CPU).state_dict() for name in ("whole", "parts"))
    assert all(torch.equal(whole[name], parts[name]) for name in whole)


def test_that_dropout_takes_part_in_training(tmp_path: Path) -> None:
    without = replace(TINY, shape=replace(TINY.shape, dropout=0.0))
    train(TINY, tmp_path / "with")
    train(without, tmp_path / "without")
    ours, theirs = (
        trained_network(s, tmp_path / n, CPU).state_dict() for s, n in ((TINY, "with"), (without, "without"))
    )
    assert not all(torch.equal(ours[name], theirs[name]) for name in ours)


def test_that_the_loss_falls_and_the_control_branch_moves(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    # The learning rate takes 200 steps to rise by default; wide noise leaves more to learn in the first steps.
    monkeypatch.setattr("kirigami_studio.lab.training.train_flow.WARM_UP_STEPS", 4)
    settings = replace(TINY, steps=24, learning_rate=1e-2, shape=replace(TINY.shape, z_scale=2.0))
    run = FlowRun(settings, tmp_path / "checkpoint.pt", CPU, Sources())
    losses = [run.advance()["loss"] for _ in range(settings.steps)]
    assert np.mean(losses[-8:]) < 0.75 * np.mean(losses[:8])
    network = run.averaged()
    assert isinstance(network, UNetVelocity)
    assert all(gate.weight.abs().max() > 0 for gate in [*network.gates, network.middle_gate])


def test_that_validation_draws_from_it(tmp_path: Path) -> None:
    (record,) = train_flow(replace(TINY, steps=1), tmp_path, CPU, validator(8, CPU))
    assert 0.3 < record["structured_iou"] <= 1.0


def test_that_fits_take_part_and_a_warm_start_begins_with_its_weights(tmp_path: Path) -> None:
    train(TINY, tmp_path / "first")
    store_model("prior", trained_network(TINY, tmp_path / "first", CPU), tmp_path / "first", {})
    start = load_model("prior", tmp_path / "first")
    fits = fitted_block(0, seed=1, grid=(4, 4), size=2)
    settings = replace(TINY, steps=4, learning_rate=1e-12, warm_start=start.digest, fits=fits.digest)
    train(settings, tmp_path / "second", Sources(start, fits))
    ended = trained_network(settings, tmp_path / "second", CPU).state_dict()
    for name, value in start.network.state_dict().items():
        torch.testing.assert_close(ended[name], value, atol=1e-6, rtol=1e-6)


def test_that_weights_of_another_backbone_are_no_start() -> None:
    start = load_model("prior")
    with pytest.raises(ModelError) as caught:
        Sources(start).check(replace(TINY, warm_start=start.digest))
    assert caught.value.code == "training.other_network"
