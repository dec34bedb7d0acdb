"""Training, resuming and pairing."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from kirigami_studio.foundation.errors import ModelError, UsageError
from kirigami_studio.generator.network import NetworkShape
from kirigami_studio.generator.weights import Model, load_model
from kirigami_studio.lab.trained_weights import store_model
from kirigami_studio.lab.training.dataset import generate_split
from kirigami_studio.lab.training.fitted_fields import FittedFields, fitted_block
from kirigami_studio.lab.training.flow_path import paired_noise, pairing_cost
from kirigami_studio.lab.training.learner import training_device
from kirigami_studio.lab.training.train_flow import FlowRun, FlowSettings, Sources, train_flow, trained_network
from kirigami_studio.lab.training.validation import validator

pytestmark = pytest.mark.torch
CPU = torch.device("cpu")
TINY = FlowSettings(
    steps=12, batch=16, noises=2, chunk=64, shape=NetworkShape(4, 4, 32, 64, 2, 16, 24, 32, 48), learning_rate=3e-3
)


def train(
    settings: FlowSettings, folder: Path, sources: Sources | None = None, **options: float
) -> list[dict[str, float]]:
    return list(train_flow(settings, folder, CPU, lambda network: {}, validate_every=4, sources=sources, **options))


@pytest.fixture(scope="module")
def fits() -> FittedFields:
    return fitted_block(0, seed=1, grid=(4, 4), size=4)


@pytest.fixture(scope="module")
def start(tmp_path_factory: pytest.TempPathFactory) -> Model:
    folder = tmp_path_factory.mktemp("start")
    train(replace(TINY, steps=8, seed=9), folder)
    store_model("prior", trained_network(replace(TINY, steps=8, seed=9), folder, CPU), folder, {})
    return load_model("prior", folder)


def test_that_a_resumed_run_equals_an_uninterrupted_one(tmp_path: Path) -> None:
    train(TINY, tmp_path / "whole")
    stopped = train(TINY, tmp_path / "parts", seconds=0.0)
    assert stopped[-1]["step"] < TINY.steps
    train(TINY, tmp_path / "parts")
    whole, parts = (trained_network(TINY, tmp_path / name, CPU).state_dict() for name in ("whole", "parts"))
    assert all(torch.equal(whole[name], parts[name]) for name in whole)


def test_that_the_loss_falls(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    # The learning rate takes 200 steps to rise by default.
    monkeypatch.setattr("kirigami_studio.lab.training.train_flow.WARM_UP_STEPS", 4)
    run = FlowRun(replace(TINY, steps=70, learning_rate=6e-3), tmp_path / "checkpoint.pt", CPU, Sources())
    losses = [run.advance()["loss"] for _ in range(70)]
    assert np.mean(losses[-10:]) < 0.85 * np.mean(losses[:10])


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
    with pytest.raises(ModelError) as caught:
        train(TINY, tmp_path)
    assert caught.value.code == "training.checkpoint_unreadable"


def test_that_the_log_keeps_a_line_for_each_validation(tmp_path: Path) -> None:
    records = list(train_flow(TINY, tmp_path, CPU, validator(8, CPU), validate_every=6))
    assert len((tmp_path / "log.jsonl").read_text().splitlines()) == len(records) == 2
    assert 0.3 < records[-1]["structured_iou"] <= 1.0


@pytest.mark.parametrize("coupling", ["ot", "conditional-ot"])
def test_that_transport_pairs_noise_with_nearer_designs(coupling: str) -> None:
    generator = torch.Generator().manual_seed(0)
    noise, z = torch.randn((2, 64, 9), generator=generator)
    paired = paired_noise(noise, pairing_cost(coupling, noise, z, torch.zeros(64, 3)))
    assert (paired - z).square().sum() < (noise - z).square().sum()
    assert torch.equal(paired.sort(dim=0).values, noise.sort(dim=0).values)


def test_that_conditional_transport_keeps_noise_with_its_own_far_away_target() -> None:
    generator = torch.Generator().manual_seed(0)
    noise, z = torch.randn((2, 16, 9), generator=generator)
    conditions = 100.0 * torch.eye(16)
    assert torch.equal(paired_noise(noise, pairing_cost("conditional-ot", noise, z, conditions)), noise)


def test_that_a_run_visits_the_data_set_that_its_settings_name(tmp_path: Path) -> None:
    split = generate_split("released", 20, seed=0, grid=(4, 4))
    settings = replace(TINY, family="released", designs=str(split.about["sha256"]))
    run = FlowRun(settings, tmp_path / "none", CPU, Sources(designs=split))
    known = torch.tensor(np.log10(split.ratios), dtype=torch.float32).flatten(1)
    for step in range(3):
        assert torch.cdist(run.random.at(step).z, known).min(dim=1).values.max() < 1e-5
    train(settings, tmp_path / "run", Sources(designs=split))
    with pytest.raises(ModelError) as caught:
        train(settings, tmp_path / "other")
    assert caught.value.code == "training.other_start"


def test_that_unknown_couplings_and_devices_are_refused() -> None:
    with pytest.raises(UsageError, match="conditional-ot"):
        pairing_cost("magic", torch.zeros(2, 1), torch.zeros(2, 1), torch.zeros(2, 1))
    with pytest.raises(UsageError):
        training_device("abacus")
    with pytest.raises(UsageError):
        training_device("cpu", threads=0)


def test_that_a_warm_start_begins_with_the_given_weights(tmp_path: Path, start: Model) -> None:
    settings = replace(TINY, steps=4, learning_rate=1e-12, warm_start=start.digest)
    train(settings, tmp_path, Sources(start))
    ended = trained_network(settings, tmp_path, CPU).state_dict()
    for name, value in start.network.state_dict().items():
        torch.testing.assert_close(ended[name], value, atol=1e-6, rtol=1e-6)


def test_that_the_weights_of_a_warm_start_are_not_written_to(tmp_path: Path, start: Model) -> None:
    before = {name: value.clone() for name, value in start.network.state_dict().items()}
    train(replace(TINY, steps=4, warm_start=start.digest), tmp_path, Sources(start))
    assert all(torch.equal(value, before[name]) for name, value in start.network.state_dict().items())


@pytest.mark.parametrize("coupling", ["independent", "conditional-ot"])
def test_that_a_resumed_run_with_fits_equals_an_uninterrupted_one(
    tmp_path: Path, start: Model, fits: FittedFields, coupling: str
) -> None:
    settings = replace(TINY, warm_start=start.digest, fits=fits.digest, coupling=coupling)
    sources = Sources(start, fits)
    train(settings, tmp_path / "whole", sources)
    assert train(settings, tmp_path / "parts", sources, seconds=0.0)[-1]["step"] < TINY.steps
    train(settings, tmp_path / "parts", sources)
    whole, parts = (trained_network(settings, tmp_path / name, CPU).state_dict() for name in ("whole", "parts"))
    assert all(torch.equal(whole[name], parts[name]) for name in whole)
    train(replace(TINY, warm_start=start.digest, coupling=coupling), tmp_path / "without", Sources(start))
    without = torch.load(tmp_path / "without" / "checkpoint.pt", weights_only=True)["network"]
    withs = torch.load(tmp_path / "whole" / "checkpoint.pt", weights_only=True)["network"]
    assert not all(torch.equal(withs[name], without[name]) for name in withs)


def test_that_sources_are_those_that_the_settings_name(tmp_path: Path, start: Model, fits: FittedFields) -> None:
    for settings, sources in (
        (TINY, Sources(start)),
        (replace(TINY, fits=fits.digest), None),
        (replace(TINY, fits="other"), Sources(None, fits)),
    ):
        with pytest.raises(ModelError) as caught:
            train(settings, tmp_path, sources)
        assert caught.value.code == "training.other_start"
    wide = replace(TINY, warm_start=start.digest, shape=replace(TINY.shape, width=40))
    with pytest.raises(ModelError) as caught:
        train(wide, tmp_path, Sources(start))
    assert caught.value.code == "training.other_network"
