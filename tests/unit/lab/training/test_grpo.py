"""GRPO: its equations by hand, exact counting and resuming, and what its switches do."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from kirigami_studio.foundation.errors import ExportError, ModelError, UsageError
from kirigami_studio.generator.network import NetworkShape
from kirigami_studio.generator.unet import UNetShape, UNetVelocity
from kirigami_studio.generator.velocity import Network
from kirigami_studio.generator.weights import Model, load_model
from kirigami_studio.lab.trained_weights import load_weights, store_model, variants_about
from kirigami_studio.lab.training.corpus import Corpus, FixedDesigns
from kirigami_studio.lab.training.dataset import generate_split
from kirigami_studio.lab.training.fields import mixed_fields, structured_fields
from kirigami_studio.lab.training.grpo import (
    GrpoRun,
    GrpoSettings,
    advantages,
    aligned_network,
    group_weights,
    train_grpo,
)
from kirigami_studio.lab.training.train_flow import FlowSettings, train_flow, trained_network
from kirigami_studio.lab.training.validation import VALIDATION_SEED, group_figures
from tests.refusals import refused

pytestmark = pytest.mark.torch
CPU = torch.device("cpu")
SHAPE = NetworkShape(4, 4, 32, 64, 1, 16, 24, 32, 48)


@pytest.fixture(scope="module")
def start(tmp_path_factory: pytest.TempPathFactory) -> Model:
    return trained(SHAPE, tmp_path_factory.mktemp("prior"))


def trained(shape: NetworkShape, folder: Path) -> Model:
    settings = FlowSettings(steps=60, batch=16, noises=2, chunk=64, shape=shape, learning_rate=3e-3)
    list(train_flow(settings, folder, CPU, lambda network: {}, validate_every=60))
    store_model("prior", trained_network(settings, folder, CPU), folder, {})
    return load_model("prior", folder)


@pytest.fixture(scope="module")
def tiny(start: Model) -> GrpoSettings:
    """Five whole steps of 2 x 3 designs and one of a single group; 1 call too few for another."""
    return GrpoSettings(
        start=start.digest, calls=34, group=3, batch=2, rollout_steps=2, learning_rate=1e-3, average_decay=0.5
    )


def align(settings: GrpoSettings, folder: Path, start: Model, **options: object) -> list[dict[str, float]]:
    return list(train_grpo(settings, folder, CPU, lambda network: {}, start, validate_every=2, **options))  # type: ignore[arg-type]


def same(first: Network, second: Network) -> bool:
    other = second.state_dict()
    return all(torch.equal(value, other[name]) for name, value in first.state_dict().items())


def test_that_advantages_are_those_of_the_equation() -> None:
    rewards = torch.tensor([[1.0, 2.0, 3.0, 6.0], [0.5, 0.5, 0.5, 0.5]], dtype=torch.float64)
    # Mean 3, deviations -2 -1 0 3, variance (4 + 1 + 0 + 9) / 4 = 3.5.
    expected = torch.tensor([-2.0, -1.0, 0.0, 3.0], dtype=torch.float64) / (math.sqrt(3.5) + 1e-6)
    torch.testing.assert_close(advantages(rewards)[0], expected)
    torch.testing.assert_close(advantages(rewards, "centred")[0], rewards[0] - 3.0)
    assert not advantages(rewards)[1].any()


def test_that_weights_are_those_of_the_equation() -> None:
    advantage = torch.tensor([[0.0, 0.2 * math.log(2.0), 0.2 * math.log(5.0)]], dtype=torch.float64)
    # exp(A / 0.2) = 1, 2, 5; their mean is 8 / 3.
    torch.testing.assert_close(group_weights(advantage, 0.2)[0], torch.tensor([3.0, 6.0, 15.0]).double() / 8.0)
    torch.testing.assert_close(group_weights(advantage, 0.2, 1.5)[0], torch.tensor([0.375, 0.75, 1.5]).double())
    torch.testing.assert_close(group_weights(advantage, 1e6)[0], torch.ones(3).double(), atol=1e-5, rtol=0.0)
    assert torch.isfinite(group_weights(torch.tensor([[-5.0, 900.0]]), 0.2)).all()


def test_that_environment_calls_are_counted_exactly(tmp_path: Path, start: Model, tiny: GrpoSettings) -> None:
    records = align(tiny, tmp_path, start)
    assert [record["calls"] for record in records] == [0.0, 12.0, 24.0, 33.0]
    assert records[-1]["step"] == 6.0
    logged = [json.loads(line) for line in (tmp_path / "log.jsonl").read_text().splitlines()]
    assert logged == records
    assert all(0.3 < record["siou"] <= 1.0 for record in records[1:])
    assert all(record["reward"] == pytest.approx(record["siou"]) for record in records[1:])
    assert all(record["used"] == 1.0 and record["infeasible"] == 0.0 for record in records[1:])
    assert all(record["spread"] > 0.0 < record["tv"] for record in records[1:])


@pytest.mark.parametrize("reward", ["accuracy", "balanced"])
def test_that_a_resumed_run_equals_an_uninterrupted_one(
    tmp_path: Path, start: Model, tiny: GrpoSettings, reward: str
) -> None:
    settings = replace(tiny, reward=reward, calls=34 if reward == "accuracy" else 48)
    whole = align(settings, tmp_path / "whole", start)
    stopped = align(settings, tmp_path / "parts", start, seconds=0.0)
    assert 0.0 < stopped[-1]["calls"] < whole[-1]["calls"]
    parts = align(settings, tmp_path / "parts", start)
    assert (parts[-1]["calls"], parts[-1]["step"]) == (whole[-1]["calls"], whole[-1]["step"])
    aligned = aligned_network(tmp_path / "whole", start)
    assert same(aligned, aligned_network(tmp_path / "parts", start))
    assert not same(aligned, start.network)


def test_that_the_scales_of_the_balanced_reward_are_measured_by_counted_calls(
    tmp_path: Path, start: Model, tiny: GrpoSettings
) -> None:
    records = align(replace(tiny, reward="balanced", calls=36), tmp_path, start)
    assert [record["calls"] for record in records] == [24.0, 36.0]
    more = torch.load(tmp_path / "checkpoint.pt", weights_only=True)["more"]
    assert 0.0 < more["siou_scale"] < 0.2 and 0.0 < more["tv_scale"] < 5.0


def test_that_the_prior_is_not_written_to(tmp_path: Path, start: Model, tiny: GrpoSettings) -> None:
    before = {name: value.clone() for name, value in start.network.state_dict().items()}
    align(tiny, tmp_path, start)
    assert all(torch.equal(value, before[name]) for name, value in start.network.state_dict().items())


def test_that_a_strong_reference_keeps_the_network_at_the_prior(
    tmp_path: Path, start: Model, tiny: GrpoSettings
) -> None:
    generator = torch.Generator().manual_seed(3)
    z, t = 0.5 * torch.randn((64, 16), generator=generator), torch.rand(64, generator=generator)
    code = start.network.code(Corpus(mixed_fields, 4, 4, 77, 64, CPU).chunk(0).polygons)

    def moved(reference: float) -> float:
        settings = replace(tiny, calls=120, reference=reference, average_decay=0.9)
        folder = tmp_path / f"{reference}"
        align(settings, folder, start)
        with torch.no_grad():
            change = aligned_network(folder, start)(z, t, code) - start.network(z, t, code)
        return float(change.square().mean().sqrt())

    free, held = moved(0.0), moved(1e4)
    assert held < 0.3 * free


def test_that_groups_of_equal_rewards_can_be_left_out(tmp_path: Path, start: Model, tiny: GrpoSettings) -> None:
    records = align(replace(tiny, least_spread=10.0), tmp_path, start)
    assert records[-1]["used"] == 0.0 and "loss" not in records[-1]
    assert records[-1]["calls"] == 33.0
    assert same(aligned_network(tmp_path, start), start.network)


def test_that_the_regularity_reward_smooths_the_designs(tmp_path: Path, tiny: GrpoSettings) -> None:
    # As in the paper, Euler steps only: corrections would follow the target and undo what the velocity has learnt.
    # Any network that looks at the exact geometry corrects by it, so this one does not look.
    start = trained(replace(SHAPE, loop_points=0), tmp_path)
    assert not start.network.corrects
    settings = replace(
        tiny,
        start=start.digest,
        reward="regularity",
        calls=320,
        group=4,
        batch=8,
        learning_rate=6e-3,
        average_decay=0.0,
    )
    before = group_figures(start.network, 8, 2)
    list(train_grpo(settings, tmp_path / "run", CPU, lambda network: {}, start, validate_every=100))
    assert group_figures(aligned_network(tmp_path / "run", start), 8, 2)["tv"] < 0.9 * before["tv"]


def test_that_a_finished_run_is_validated_again_and_stays_as_it_is(
    tmp_path: Path, start: Model, tiny: GrpoSettings
) -> None:
    align(tiny, tmp_path, start)
    before = aligned_network(tmp_path, start)
    (again,) = align(tiny, tmp_path, start)
    assert again["calls"] == 33.0
    assert same(before, aligned_network(tmp_path, start))


def test_that_targets_are_silhouettes_of_the_data_set_that_the_settings_name(
    tmp_path: Path, start: Model, tiny: GrpoSettings
) -> None:
    split = generate_split("released", 6, seed=0, grid=(4, 4))
    settings = replace(tiny, family="released", designs=str(split.about["sha256"]))
    known = FixedDesigns(split.ratios, 4, 4, 0, CPU).chunk(0).polygons.flatten(1)
    run = GrpoRun(settings, tmp_path / "none", CPU, start, split)
    drawn = torch.stack([run.batches.at(step).polygons for step in range(4)]).flatten(0, 1).flatten(1)
    assert torch.cdist(drawn, known).min(dim=1).values.max() < 1e-4
    assert align(settings, tmp_path / "run", start, designs=split)[-1]["calls"] == 33.0
    with pytest.raises(ModelError) as caught:
        align(settings, tmp_path / "other", start)
    assert caught.value.code == "training.other_start"


def test_that_training_targets_are_not_the_validation_ones() -> None:
    # The one seed of a run at which both could be drawn from the same stream.
    drawn = Corpus(mixed_fields, 4, 4, VALIDATION_SEED, 200, CPU).chunk(0).z
    watched = structured_fields(200, 4, 4, np.random.default_rng(VALIDATION_SEED)).reshape(200, 16)
    assert torch.cdist(drawn.double(), torch.tensor(watched)).min() > 1e-3


def test_that_other_settings_weights_or_folders_are_refused(tmp_path: Path, start: Model, tiny: GrpoSettings) -> None:
    align(replace(tiny, calls=6), tmp_path, start)
    with refused(ModelError, "training.checkpoint_differs", settings="calls, temperature"):
        align(replace(tiny, temperature=1.0), tmp_path, start)
    with pytest.raises(ModelError) as caught:
        align(replace(tiny, start="other"), tmp_path, start)
    assert caught.value.code == "training.other_start"
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(ExportError) as blocked:
        align(tiny, tmp_path / "file" / "run", start)
    assert blocked.value.code == "training.folder_not_made"


def test_that_a_network_that_diverged_says_so(tmp_path: Path, start: Model, tiny: GrpoSettings) -> None:
    with pytest.raises(ModelError) as caught:
        align(replace(tiny, learning_rate=1e30), tmp_path, start)
    assert caught.value.code == "training.diverged"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"reward": "beauty"}, "balanced"), ({"advantages": "odd"}, "centred"), ({"group": 1}, "at least 2"),
        ({"batch": 0}, "1 or more"), ({"temperature": 0.0}, "above 0"), ({"average_decay": 1.0}, "below 1"),
        ({"reference": -1.0}, "0 or more"), ({"calls": 3}, "at least 4"),
        ({"reward": "balanced", "calls": 128}, "at least 132"),
    ],
)  # fmt: skip
def test_that_impossible_settings_are_refused(change: dict[str, object], said: str) -> None:
    with pytest.raises(UsageError, match=said):
        GrpoSettings(**change)  # type: ignore[arg-type]


def test_that_weights_are_kept_at_chosen_calls_and_the_same_after_a_break(
    tmp_path: Path, start: Model, tiny: GrpoSettings
) -> None:
    kept_at = (0, 12, 20, 34)
    align(tiny, tmp_path / "whole", start, keep_at=kept_at)
    align(tiny, tmp_path / "parts", start, keep_at=kept_at, seconds=0.0)
    align(tiny, tmp_path / "parts", start, keep_at=kept_at)
    about = variants_about(tmp_path / "whole")
    # 12 is the end of a step, 20 within one, 34 is one call more than there are.
    assert {name: one["calls"] for name, one in about.items()} == {
        "calls-0": 0, "calls-12": 12, "calls-20": 24, "calls-34": 33,
    }  # fmt: skip
    assert about["calls-12"]["settings"] == tiny.to_json()
    for name in about:
        whole, parts = (load_weights(tmp_path / run / f"{name}.safetensors") for run in ("whole", "parts"))
        assert whole.digest == parts.digest
    first, last = (load_weights(tmp_path / "whole" / f"calls-{calls}.safetensors").network for calls in (0, 34))
    assert same(first, start.network) and not same(last, first)
    with pytest.raises(UsageError) as late:
        align(tiny, tmp_path / "whole", start, keep_at=(16,))
    assert late.value.code == "training.kept_too_late"
    with pytest.raises(UsageError) as after:
        align(tiny, tmp_path / "whole", start, keep_at=(35,))
    assert after.value.code == "training.kept_after_end"


def test_that_the_control_sees_the_same_designs_and_weighs_them_alike(
    tmp_path: Path, start: Model, tiny: GrpoSettings, monkeypatch: pytest.MonkeyPatch
) -> None:
    rewarded, control = (align(replace(tiny, calls=6, reward=reward), tmp_path / reward, start)[-1]
                         for reward in ("accuracy", "none"))  # fmt: skip
    assert all(rewarded[name] == control[name] for name in ("siou", "tv", "spread", "infeasible"))
    assert control["reward"] == 0.0 < rewarded["reward"] and control["loss"] != rewarded["loss"]
    # With the weights of a control, a run with a reward is the control.
    monkeypatch.setattr(
        "kirigami_studio.lab.training.grpo.group_weights", lambda advantage, *options: torch.ones_like(advantage)
    )
    equal = align(replace(tiny, calls=6), tmp_path / "equal", start)[-1]
    assert equal["loss"] == control["loss"]
    assert same(aligned_network(tmp_path / "equal", start), aligned_network(tmp_path / "none", start))


def test_that_the_start_is_asked_by_counted_calls_where_a_reward_compares(
    tmp_path: Path, start: Model, tiny: GrpoSettings
) -> None:
    records = align(replace(tiny, reward="fabrication"), tmp_path, start)
    # Two targets of three designs and the start's three cost 12 calls a step; one target takes 6 of the last 10.
    assert [record["calls"] for record in records] == [0.0, 24.0, 30.0]
    assert records[-1]["reward"] < 0.0


def test_that_a_unet_prior_can_be_aligned(tmp_path: Path, tiny: GrpoSettings) -> None:
    torch.manual_seed(0)
    shape = UNetShape(4, 4, channels=(8, 8), residuals=1, latent=8, mask=32)
    store_model("prior", UNetVelocity(shape), tmp_path, {})
    prior = load_weights(tmp_path / "prior.safetensors")
    record = align(replace(tiny, start=prior.digest, calls=12), tmp_path / "run", prior)[-1]
    aligned = aligned_network(tmp_path / "run", prior)
    assert record["calls"] == 12.0 and 0.3 < record["siou"] <= 1.0
    assert isinstance(aligned, UNetVelocity) and not same(aligned, prior.network)
