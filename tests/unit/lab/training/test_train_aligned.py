"""Alignment through the sampler: lower losses, exact resuming, sheets by the step."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import torch
from small_networks import SMALL, random_fields, random_network, silhouettes

from kirigami_studio.foundation.errors import ExportError, ModelError
from kirigami_studio.generator.conditioning import contour_points
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.generator.flow import trail
from kirigami_studio.generator.network import VelocityNetwork
from kirigami_studio.generator.weights import Model, load_model
from kirigami_studio.lab.trained_weights import store_model
from kirigami_studio.lab.training.first_designs import MOST_VOIDS, FirstDesigns
from kirigami_studio.lab.training.preference_loss import PreferenceTerms, trail_gap
from kirigami_studio.lab.training.train_aligned import GRIDS, LARGEST_PHI, AlignRun, AlignSettings, train_aligned
from kirigami_studio.lattice.batched import BatchedLattice
from kirigami_studio.lattice.symmetry import Symmetry
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
        evenness_weight=0.3, free_rims=0.5, symmetric_share=0.3,
        shape=replace(SMALL, preference=True, sheets=True, rims=True),
    )  # fmt: skip


@pytest.fixture(scope="module")
def plain(tiny: AlignSettings) -> AlignSettings:
    """Even rims, no symmetry, nothing but slopes."""
    return replace(tiny, free_rims=0.0, symmetric_share=0.0, evenness_weight=0.0)


def align(settings: AlignSettings, folder: Path, prior: Model, **options: Any) -> list[dict[str, float]]:
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
    tmp_path: Path, prior: Model, plain: AlignSettings
) -> None:
    settings = replace(
        plain,
        steps=30,
        batch=16,
        drawn=0,
        other_sheets=0.0,
        learning_rate=0.02,
        average_decay=0.0,
        variation_weight=0.0,
    )
    run = run_of(settings, tmp_path, prior)
    before = measured(run.averaged(), 0.0)
    losses = [run.advance()["loss"] for _ in range(30)]
    after = measured(run.averaged(), 0.0)
    assert float(after[0].match.mean()) < 0.85 * float(before[0].match.mean())
    assert after[1] < 0.75 * before[1]
    assert np.mean(losses[-6:]) < 0.9 * np.mean(losses[:6])


def test_that_asking_for_regularity_gives_smoother_fields(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, prior: Model, plain: AlignSettings
) -> None:
    # The learning rate takes 200 steps to rise by default.
    monkeypatch.setattr("kirigami_studio.lab.training.train_flow.WARM_UP_STEPS", 4)

    def variation(asked: float, even: bool = False) -> float:
        return float(measured(run.averaged(), asked, even)[0].variation.mean())

    settings = replace(
        plain,
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


def test_that_the_anchor_holds_samples_near_the_priors(tmp_path: Path, prior: Model, plain: AlignSettings) -> None:
    def moved(weight: float) -> float:
        settings = replace(plain, steps=10, other_sheets=0.0, average_decay=0.0, anchor_weight=weight, anchored_every=1)
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


def test_that_sheets_follow_from_seed_and_step(tmp_path: Path, prior: Model, plain: AlignSettings) -> None:
    def sheets(settings: AlignSettings, steps: range) -> list[DeployedGrid]:
        run = run_of(settings, tmp_path, prior)
        drawn = []
        for run.learner.step in steps:
            drawn.append(run._grid())
        return drawn

    many = sheets(plain, range(400))
    assert sheets(plain, range(200, 210)) == many[200:210]
    assert sheets(replace(plain, seed=1), range(10)) != many[:10]
    own, other = [one for one in many if one == OWN], [one for one in many if one != OWN]
    assert len(other) / len(many) == pytest.approx(plain.other_sheets, abs=0.08)
    assert len(own) + len(other) == 400
    assert {one.rows for one in other} == {one.columns for one in other} == set(range(GRIDS[0], GRIDS[1] + 1))
    flat = [one for one in other if one.phi == 0.0]
    assert len(flat) / len(other) == pytest.approx(0.6, abs=0.1)
    assert 0.9 * LARGEST_PHI < max(one.phi for one in other) < LARGEST_PHI
    assert set(sheets(replace(plain, other_sheets=0.0), range(50))) == {OWN}
    assert OWN not in sheets(replace(plain, other_sheets=1.0), range(50))


def test_that_free_rims_and_symmetries_of_the_grid_come_as_often_as_asked_for(
    tmp_path: Path, prior: Model, plain: AlignSettings
) -> None:
    run = run_of(replace(plain, free_rims=0.3, symmetric_share=0.6, other_sheets=1.0), tmp_path, prior)
    drawn = []
    for run.learner.step in range(300):
        drawn.append(run._grid())
    assert np.mean([one.free_rim for one in drawn]) == pytest.approx(0.3, abs=0.08)
    possible = [one for one in drawn if any(symmetry.fits(one.rows, one.columns) for symmetry in Symmetry)]
    assert np.mean([one.symmetry is not None for one in possible]) == pytest.approx(0.6, abs=0.08)
    assert {one.symmetry for one in drawn} == {None, *Symmetry}
    assert all(one.symmetry is None or one.symmetry.fits(one.rows, one.columns) for one in drawn)


@pytest.mark.parametrize("phi", [0.0, 0.6])
def test_that_silhouettes_of_symmetric_sheets_are_symmetric(
    tmp_path: Path, prior: Model, plain: AlignSettings, phi: float
) -> None:
    grid = DeployedGrid(4, 5, phi, Symmetry.LEFT_RIGHT)
    made = run_of(plain, tmp_path, prior)._silhouettes(grid, 3).double().numpy()
    for one in made:
        ours, mirrored = (shapely.Polygon(points).buffer(0.0) for points in (one, one * [-1.0, 1.0]))
        assert ours.intersection(mirrored).area > 0.999


def test_that_asking_for_regularity_gives_evener_panels(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, prior: Model, plain: AlignSettings
) -> None:
    monkeypatch.setattr("kirigami_studio.lab.training.train_flow.WARM_UP_STEPS", 4)
    settings = replace(
        plain, steps=30, batch=16, drawn=0, other_sheets=0.0, learning_rate=0.008, average_decay=0.0,
        variation_weight=0.0, anchor_weight=0.0, evenness_weight=0.5,
    )  # fmt: skip
    run = run_of(settings, tmp_path, prior)

    def unevenness(asked: float) -> float:
        return float(measured(run.averaged(), asked, even=False)[0].unevenness.mean())

    before = unevenness(1.0)
    assert unevenness(0.0) == pytest.approx(before, rel=1e-4)
    records = [run.advance() for _ in range(30)]
    assert unevenness(1.0) < 0.9 * before
    assert records[-1]["unevenness"] > 0.0


def test_that_steps_on_free_rims_within_symmetries_are_finite(
    tmp_path: Path, prior: Model, tiny: AlignSettings
) -> None:
    run = run_of(replace(tiny, other_sheets=1.0, symmetric_share=1.0, free_rims=1.0, batch=4), tmp_path, prior)
    records = [run.advance() for _ in range(3)]
    assert all(np.isfinite(list(record.values())).all() for record in records)


def test_that_even_panels_count_as_much_as_regularity_is_preferred(
    tmp_path: Path, prior: Model, plain: AlignSettings
) -> None:
    run = run_of(replace(plain, evenness_weight=0.4, variation_weight=0.0), tmp_path, prior)
    terms, _ = measured(run.averaged(), 0.0)
    none, full = (run._loss(terms, torch.tensor(0.0), torch.full((48,), asked)) for asked in (0.0, 1.0))
    assert float(full - none) == pytest.approx(0.4 * float(terms.unevenness.mean()), rel=1e-4)
    assert float(terms.unevenness.mean()) > 0.1


@pytest.fixture(scope="module")
def designs() -> FirstDesigns:
    """One field for all targets, which are its silhouette."""
    z = random_fields(OWN, 1, 0.4, seed=21).expand(12, -1)
    padded = np.zeros((12, MOST_VOIDS), dtype=np.float32)
    padded[:, :16] = z.numpy()
    requested = contour_points(silhouettes(z, OWN), 160).numpy()
    none, number = np.zeros(12, dtype=np.float32), np.arange(12)
    names = np.full(12, "", dtype="<U16")
    return FirstDesigns(padded, requested, np.full((12, 2), 4), names, none, none, none, number, number, {})


def test_that_distilling_brings_samples_and_flow_to_the_designs(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, prior: Model, tiny: AlignSettings, designs: FirstDesigns
) -> None:
    monkeypatch.setattr("kirigami_studio.lab.training.train_flow.WARM_UP_STEPS", 4)
    settings = replace(
        tiny, steps=24, drawn=0, learning_rate=0.02, designs=designs.digest, design_share=1.0,
        flow_weight=1.0, likeness_weight=3.0,
    )  # fmt: skip
    run = AlignRun(settings, tmp_path / "checkpoint.pt", CPU, prior, designs=designs)
    found = [run.advance() for _ in range(24)]
    for part in ("flow", "likeness"):
        values = [one[part] for one in found]
        assert np.mean(values[-6:]) < 0.85 * np.mean(values[:6])
    assert "anchor" not in found[0]


def test_that_distilling_resumes_and_asks_for_the_designs_of_its_settings(
    tmp_path: Path, prior: Model, tiny: AlignSettings, designs: FirstDesigns
) -> None:
    with pytest.raises(ModelError) as caught:
        align(tiny, tmp_path / "none", prior, designs=designs)
    assert caught.value.code == "training.other_start"
    settings = replace(tiny, steps=4, designs=designs.digest, design_share=0.5)
    align(settings, tmp_path / "whole", prior, designs=designs)
    align(settings, tmp_path / "parts", prior, designs=designs, seconds=0.0)
    align(settings, tmp_path / "parts", prior, designs=designs)
    ended = [AlignRun(settings, tmp_path / name / "checkpoint.pt", CPU, prior, designs=designs) for name in PLACES]
    assert same(ended[0].network, ended[1].network)


PLACES = ("whole", "parts")
