"""Alignment through the sampler: lower losses, exact resuming, sheets by the step."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from small_networks import SMALL, random_fields, random_network, silhouettes

from kirigami_studio.foundation.errors import ExportError, ModelError
from kirigami_studio.generator.conditioning import contour_points
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.generator.flow import trail
from kirigami_studio.generator.network import VelocityNetwork
from kirigami_studio.generator.weights import Model, load_model, store_model
from kirigami_studio.lab.training.preference_loss import PreferenceTerms, trail_gap
from kirigami_studio.lab.training.train_aligned import GRIDS, LARGEST_PHI, AlignRun, AlignSettings, train_aligned
from kirigami_studio.lattice.batched import BatchedLattice
from tests.refusals import refused

pytestmark = pytest.mark.torch
CPU = torch.device("cpu")
OWN = DeployedGrid(4, 4)


@pytest.fixture(scope="module")
def prior(tmp_path_factory: pytest.TempPathFactory) -> Model:
    """A prior that sees no direction, whose samples are noise bent by random weights."""
    folder = tmp_path_factory.mktemp("prior")
    store_model("prior", random_network(direction=False), folder, {})
    return load_model("prior", folder)


@pytest.fixture(scope="module")
def tiny(prior: Model) -> AlignSettings:
    return AlignSettings(
        prior=prior.digest, steps=6, batch=8, drawn=4, learning_rate=0.01, average_decay=0.5,
        shape=replace(SMALL, preference=True, sheets=True),
    )  # fmt: skip


def align(settings: AlignSettings, folder: Path, prior: Model, **options: float) -> list[dict[str, float]]:
    return list(train_aligned(settings, folder, CPU, lambda network: {}, prior, validate_every=2, **options))


def run_of(settings: AlignSettings, folder: Path, prior: Model) -> AlignRun:
    return AlignRun(settings, folder / "checkpoint.pt", CPU, prior)


def same(first: VelocityNetwork, second: VelocityNetwork) -> bool:
    other = second.state_dict()
    return all(torch.equal(value, other[name]) for name, value in first.state_dict().items())


def measured(network: VelocityNetwork, preference: float, even: bool = True) -> tuple[PreferenceTerms, float]:
    """Terms of samples for silhouettes that training does not draw, and the gap before the last correction.

    Corrections count the variation only if ``even``.
    """
    targets = silhouettes(random_fields(OWN, 48, 0.4, seed=11), OWN)
    noise = random_fields(OWN, 48, SMALL.z_scale, seed=12)
    with torch.no_grad():
        code = network.code(targets, preference=torch.full((48,), preference))
        finished = trail(network, noise, code if even else replace(code, variation_cost=torch.zeros(48)), 4)
        terms, early = trail_gap(BatchedLattice(4, 4), OWN, finished, contour_points(targets, 384))
    return terms, float(early)


def test_that_alignment_lowers_the_loss_on_targets_that_it_has_not_seen(
    tmp_path: Path, prior: Model, tiny: AlignSettings
) -> None:
    settings = replace(
        tiny, steps=30, batch=16, drawn=0, other_sheets=0.0, learning_rate=0.02, average_decay=0.0, variation_weight=0.0
    )
    run = run_of(settings, tmp_path, prior)
    before = measured(run.averaged(), 0.0)
    losses = [run.advance()["loss"] for _ in range(30)]
    after = measured(run.averaged(), 0.0)
    assert float(after[0].match.mean()) < 0.85 * float(before[0].match.mean())
    assert after[1] < 0.75 * before[1]
    assert np.mean(losses[-6:]) < 0.9 * np.mean(losses[:6])


def test_that_asking_for_regularity_gives_smoother_fields(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, prior: Model, tiny: AlignSettings
) -> None:
    # The learning rate takes 200 steps to rise by default.
    monkeypatch.setattr("kirigami_studio.lab.training.train_flow.WARM_UP_STEPS", 4)

    def variation(asked: float, even: bool = False) -> float:
        return float(measured(run.averaged(), asked, even)[0].variation.mean())

    settings = replace(
        tiny,
        steps=30,
        batch=16,
        drawn=0,
        other_sheets=0.0,
        pictured_share=0.0,
        learning_rate=0.008,
        average_decay=0.0,
        variation_weight=0.3,
    )
    run = run_of(settings, tmp_path, prior)
    assert variation(0.0) == pytest.approx(variation(1.0), rel=1e-4)
    # Corrections follow the preference from the beginning; what is learnt comes on top.
    untrained = variation(1.0, even=True)
    assert untrained < 0.85 * variation(0.0)
    for _ in range(30):
        run.advance()
    assert variation(1.0) < 0.85 * variation(0.0)
    assert variation(1.0, even=True) < untrained


def test_that_the_anchor_holds_samples_near_the_priors(tmp_path: Path, prior: Model, tiny: AlignSettings) -> None:
    def moved(weight: float) -> float:
        settings = replace(tiny, steps=10, other_sheets=0.0, average_decay=0.0, anchor_weight=weight, anchored_every=1)
        run = run_of(settings, tmp_path, prior)
        last = [run.advance()["anchor"] for _ in range(10)]
        return float(np.mean(last[-4:]))

    assert moved(1e3) < moved(0.0)


def test_that_a_resumed_run_equals_an_uninterrupted_one(tmp_path: Path, prior: Model, tiny: AlignSettings) -> None:
    whole = align(tiny, tmp_path / "whole", prior)
    assert [record["step"] for record in whole] == [2.0, 4.0, 6.0]
    stopped = align(tiny, tmp_path / "parts", prior, seconds=0.0)
    assert stopped[-1]["step"] == 1.0
    parts = align(tiny, tmp_path / "parts", prior)
    assert parts[-1]["step"] == 6.0
    ended = [run_of(tiny, tmp_path / name, prior) for name in ("whole", "parts")]
    assert same(ended[0].network, ended[1].network)
    assert same(ended[0].averaged(), ended[1].averaged())
    assert not same(ended[0].network, ended[0].averaged())
    assert ended[0].step == ended[1].step == 6
    assert len((tmp_path / "parts" / "log.jsonl").read_text().splitlines()) == len(stopped) + len(parts)


def test_that_records_tell_the_parts_of_the_loss(tmp_path: Path, prior: Model, tiny: AlignSettings) -> None:
    asked: list[VelocityNetwork] = []

    def validate(network: VelocityNetwork) -> dict[str, float]:
        asked.append(network)
        return {"iou": 0.5}

    records = list(train_aligned(tiny, tmp_path, CPU, validate, prior, validate_every=3))
    assert [json.loads(line) for line in (tmp_path / "log.jsonl").read_text().splitlines()] == records
    assert all({"loss", "match", "variation", "anchor", "seconds", "iou"} <= record.keys() for record in records)
    assert all(0.0 < record["match"] < record["loss"] for record in records)
    assert same(asked[-1], run_of(tiny, tmp_path, prior).averaged())


def test_that_the_prior_is_not_written_to(tmp_path: Path, prior: Model, tiny: AlignSettings) -> None:
    before = {name: value.clone() for name, value in prior.network.state_dict().items()}
    align(replace(tiny, steps=2), tmp_path, prior)
    assert all(torch.equal(value, before[name]) for name, value in prior.network.state_dict().items())


def test_that_another_prior_other_settings_or_folders_are_refused(
    tmp_path: Path, prior: Model, tiny: AlignSettings
) -> None:
    with pytest.raises(ModelError) as caught:
        align(replace(tiny, prior="other"), tmp_path / "none", prior)
    assert caught.value.code == "training.other_start"
    assert not (tmp_path / "none").exists()
    align(replace(tiny, steps=1), tmp_path, prior)
    with refused(ModelError, "training.checkpoint_differs", settings="steps, anchor_weight"):
        align(replace(tiny, anchor_weight=1.0), tmp_path, prior)
    with pytest.raises(ModelError) as caught:
        align(replace(tiny, shape=replace(tiny.shape, width=40)), tmp_path / "wide", prior)
    assert caught.value.code == "training.other_network"
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(ExportError) as blocked:
        align(tiny, tmp_path / "file" / "run", prior)
    assert blocked.value.code == "training.folder_not_made"


def test_that_sheets_follow_from_seed_and_step(tmp_path: Path, prior: Model, tiny: AlignSettings) -> None:
    def sheets(settings: AlignSettings, steps: range) -> list[DeployedGrid]:
        run = run_of(settings, tmp_path, prior)
        drawn = []
        for run.learner.step in steps:
            drawn.append(run._grid())
        return drawn

    many = sheets(tiny, range(400))
    assert sheets(tiny, range(200, 210)) == many[200:210]
    assert sheets(replace(tiny, seed=1), range(10)) != many[:10]
    own, other = [one for one in many if one == OWN], [one for one in many if one != OWN]
    assert len(other) / len(many) == pytest.approx(tiny.other_sheets, abs=0.08)
    assert len(own) + len(other) == 400
    assert {one.rows for one in other} == {one.columns for one in other} == set(range(GRIDS[0], GRIDS[1] + 1))
    flat = [one for one in other if one.phi == 0.0]
    assert len(flat) / len(other) == pytest.approx(0.6, abs=0.1)
    assert 0.9 * LARGEST_PHI < max(one.phi for one in other) < LARGEST_PHI
    assert set(sheets(replace(tiny, other_sheets=0.0), range(50))) == {OWN}
    assert OWN not in sheets(replace(tiny, other_sheets=1.0), range(50))
