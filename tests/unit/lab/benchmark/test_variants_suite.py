"""Variants side by side, and how much their samples differ."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.generator import weights
from kirigami_studio.generator.network import VelocityNetwork
from kirigami_studio.lab.benchmark.generator_suite import bootstrap_ratio_interval, measure_generator
from kirigami_studio.lab.benchmark.variants_suite import (
    clusters_of,
    difference,
    measure_spread,
    measure_variants,
    spread_of,
    with_reference,
)
from kirigami_studio.lab.trained_weights import store_model
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline.variety import turns

pytestmark = pytest.mark.torch


@pytest.fixture
def untrained(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A second variant beside the prior: the same network before any training, whose samples stay noise."""
    for name in (weights.MANIFEST, "prior.safetensors"):
        shutil.copy(weights.model_folder() / name, tmp_path / name)
    torch.manual_seed(0)
    network = VelocityNetwork(weights.load_model("prior").network.shape)
    store_model("untrained", network, tmp_path, {})
    monkeypatch.setattr(weights, "model_folder", lambda: tmp_path)
    return "untrained"


def candidates(*fields: RatioField) -> list[Candidate]:
    target = load("heart")
    return [Candidate(Sheet(field), evaluate(deploy(field), target), 0, place) for place, field in enumerate(fields)]


def random_field(seed: int) -> RatioField:
    return RatioField.from_log10(np.random.default_rng(seed).uniform(-0.6, 0.6, (6, 6)))


def test_that_every_variant_is_measured_as_alone_and_beside_the_prior(untrained: str) -> None:
    targets = [load("circle"), load("heart")]
    told: list[tuple[int, int]] = []
    figures: Any = measure_variants(targets, [untrained], seeds=(0, 1), report=lambda *counts: told.append(counts))
    assert list(figures["variants"]) == ["prior", untrained]
    assert told == [(2, 8), (4, 8), (6, 8), (8, 8)]
    prior, other = figures["variants"]["prior"], figures["variants"][untrained]
    alone = measure_generator(targets, "prior", seeds=(0, 1))
    assert {name: alone[name] for name in ("siou", "siou_interval", "tv", "infeasible")}.items() <= prior.items()
    assert prior["over_prior"]["siou"] == {"mean": 0.0, "interval": (0.0, 0.0)}
    assert other["over_prior"]["siou"]["mean"] == pytest.approx(other["siou"] - prior["siou"])
    assert other["over_prior"]["siou"]["interval"][1] < 0.0


def test_that_noise_is_a_wider_spread_than_samples(untrained: str) -> None:
    figures: Any = measure_spread([load("heart")], [untrained], k=4)
    prior, other = (figures["variants"][name]["one_pose"] for name in ("prior", untrained))
    assert prior["std_rms"]["ratio"] == 1.0 and prior["siou_best"]["difference"] == 0.0
    assert other["std_rms"]["ratio"] == pytest.approx(other["std_rms"]["mean"] / prior["std_rms"]["mean"])
    assert other["std_rms"]["ratio"] > 1.0 > other["siou_best"]["mean"] - other["siou_best"]["difference"]
    own = figures["variants"]["prior"]["own_poses"]
    assert own["std_rms"]["mean"] > prior["std_rms"]["mean"]
    assert own["siou_first"]["mean"] == pytest.approx(prior["siou_first"]["mean"], abs=1e-3)


def test_that_spreads_of_two_samples_follow_from_their_distance() -> None:
    first, second = random_field(0), random_field(1)
    pair = candidates(first, second)
    figures = spread_of(pair)
    gap = first.log10 - second.log10
    assert figures["distance"] == pytest.approx(np.sqrt(np.square(gap).mean()))
    assert figures["std_rms"] == pytest.approx(figures["distance"] / np.sqrt(2.0))
    assert figures["std_mean"] == pytest.approx(np.abs(gap).mean() / np.sqrt(2.0))
    assert figures["siou_first"] == pair[0].score.siou
    assert figures["siou_best"] == max(candidate.score.siou for candidate in pair)


def test_that_a_turned_sheet_adds_no_cluster_and_no_sheet_distance() -> None:
    first, other = random_field(0), random_field(1)
    same = RatioField.from_log10(turns(first)[1][: first.ratio.size].reshape(first.ratio.shape))
    assert clusters_of([first, same, first]) == 1
    assert clusters_of([first, same, other]) == 2
    figures = spread_of(candidates(first, same))
    assert figures["sheet_distance"] == pytest.approx(0.0, abs=1e-9)
    assert figures["distance"] > 0.3


def test_that_paired_figures_ignore_what_targets_share() -> None:
    rng = np.random.default_rng(0)
    hard = rng.uniform(0.2, 1.0, 200)
    gap: Any = difference(hard + 0.01, hard)
    assert gap["mean"] == pytest.approx(0.01)
    assert gap["interval"] == pytest.approx((0.01, 0.01))
    assert bootstrap_ratio_interval(0.8 * hard, hard) == pytest.approx((0.8, 0.8))
    low, high = bootstrap_ratio_interval(hard + rng.normal(0.0, 0.1, 200), hard)
    assert low < 1.0 < high


def test_that_the_prior_comes_first_and_names_come_once() -> None:
    assert with_reference(["a", "prior", "a"]) == ("prior", "a")


def test_that_comparisons_of_nothing_are_sentences() -> None:
    with pytest.raises(UsageError) as caught:
        measure_variants([], ["prior"])
    assert caught.value.code == "benchmark.no_targets"
    with pytest.raises(UsageError) as caught:
        measure_variants([load("heart")], ["none"], seeds=(0,))
    assert caught.value.code == "model.unknown_variant"
    with pytest.raises(UsageError) as caught:
        measure_spread([load("heart")], ["prior"], k=1)
    assert caught.value.code == "benchmark.spread_of_one"
