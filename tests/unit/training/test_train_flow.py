"""Training, resuming and pairing."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
import torch

from kirigami_studio.foundation.errors import ModelError, UsageError
from kirigami_studio.generator.network import NetworkShape
from kirigami_studio.training.coupling import pair_noise
from kirigami_studio.training.device import training_device
from kirigami_studio.training.train_flow import FlowSettings, finished_network, train_flow
from kirigami_studio.training.validation import validator

pytestmark = pytest.mark.torch
CPU = torch.device("cpu")
TINY = FlowSettings(
    steps=12, batch=16, noises=2, chunk=64, shape=NetworkShape(4, 4, 32, 64, 2, 16, 24, 32, 48), learning_rate=3e-3
)


def train(settings: FlowSettings, folder: Path, **options: float) -> list[dict[str, float]]:
    return list(train_flow(settings, folder, CPU, lambda network: {}, validate_every=4, **options))


def test_that_a_resumed_run_equals_an_uninterrupted_one(tmp_path: Path) -> None:
    train(TINY, tmp_path / "whole")
    stopped = train(TINY, tmp_path / "parts", seconds=0.0)
    assert stopped[-1]["step"] < TINY.steps
    train(TINY, tmp_path / "parts")
    whole, parts = (finished_network(TINY, tmp_path / name, CPU).state_dict() for name in ("whole", "parts"))
    assert all(torch.equal(whole[name], parts[name]) for name in whole)


def test_that_the_loss_falls(tmp_path: Path) -> None:
    records = train(replace(TINY, steps=160), tmp_path)
    assert records[-1]["loss"] < 0.85 * records[0]["loss"]


def test_that_another_run_does_not_continue_a_checkpoint(tmp_path: Path) -> None:
    train(replace(TINY, steps=4), tmp_path)
    with pytest.raises(ModelError, match=r"other settings \([a-z_]+.*\)"):
        train(replace(TINY, steps=4, seed=1), tmp_path)


def test_that_the_logged_loss_goes_on_where_it_stopped(tmp_path: Path) -> None:
    (stopped,) = train(TINY, tmp_path, seconds=0.0)
    (resumed,) = train(TINY, tmp_path, seconds=0.0)
    assert resumed["step"] == stopped["step"] + 1
    assert resumed["loss"] > 0.5 * stopped["loss"]


def test_that_a_damaged_checkpoint_is_named(tmp_path: Path) -> None:
    (tmp_path / "checkpoint.pt").write_bytes(b"not a checkpoint")
    with pytest.raises(ModelError, match="cannot be read"):
        train(TINY, tmp_path)


def test_that_the_log_keeps_a_line_for_each_validation(tmp_path: Path) -> None:
    records = list(train_flow(TINY, tmp_path, CPU, validator(8, CPU), validate_every=6))
    assert len((tmp_path / "log.jsonl").read_text().splitlines()) == len(records) == 2
    assert 0.3 < records[-1]["structured_iou"] <= 1.0


@pytest.mark.parametrize("coupling", ["ot", "conditional-ot"])
def test_that_transport_pairs_noise_with_nearer_designs(coupling: str) -> None:
    generator = torch.Generator().manual_seed(0)
    noise, z = torch.randn((2, 64, 9), generator=generator)
    conditions = torch.zeros(64, 3)
    paired = pair_noise(coupling, noise, z, conditions)
    assert (paired - z).square().sum() < (noise - z).square().sum()
    assert torch.equal(paired.sort(dim=0).values, noise.sort(dim=0).values)


def test_that_conditional_transport_keeps_noise_with_its_own_far_away_target() -> None:
    generator = torch.Generator().manual_seed(0)
    noise, z = torch.randn((2, 16, 9), generator=generator)
    conditions = 100.0 * torch.eye(16)
    assert torch.equal(pair_noise("conditional-ot", noise, z, conditions), noise)


def test_that_independent_pairing_changes_nothing() -> None:
    noise = torch.randn(4, 9)
    assert pair_noise("independent", noise, torch.zeros(4, 9), torch.zeros(4, 1)) is noise


def test_that_unknown_couplings_and_devices_are_refused() -> None:
    with pytest.raises(UsageError, match="conditional-ot"):
        pair_noise("magic", torch.zeros(2, 1), torch.zeros(2, 1), torch.zeros(2, 1))
    with pytest.raises(UsageError):
        training_device("abacus")
    with pytest.raises(UsageError):
        training_device("cpu", threads=0)
