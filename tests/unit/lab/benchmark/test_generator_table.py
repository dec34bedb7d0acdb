"""Table 2: rows, variety, storage, resumed tables."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from kirigami_studio.foundation.errors import ModelError, UsageError
from kirigami_studio.lab.baselines.cgan import Cgan
from kirigami_studio.lab.baselines.conditional import FieldPixels
from kirigami_studio.lab.baselines.stored import store_generator
from kirigami_studio.lab.benchmark.generator_table import (
    CLASSES,
    FamilyTable,
    FieldClasses,
    TableSettings,
    generator_named,
    mean_distance,
    measure_generators,
)
from kirigami_studio.lab.benchmark.run_store import RunStore
from kirigami_studio.lab.training.fields import mixed_fields
from kirigami_studio.outlines.silhouettes import load

pytestmark = pytest.mark.torch
SETTINGS = TableSettings(k=4)


@pytest.fixture(scope="module")
def reference() -> np.ndarray:
    return mixed_fields(256, 10, 10, np.random.default_rng(0)).reshape(256, -1)


@pytest.fixture(scope="module")
def weights(tmp_path_factory: pytest.TempPathFactory) -> str:
    torch.manual_seed(0)
    network = Cgan(FieldPixels(latent=8, mask=32), (8, 8), 8)
    return str(store_generator("cgan", network, tmp_path_factory.mktemp("weights") / "cgan.safetensors", {}))


def table(sources: list[str], reference: np.ndarray, store: RunStore, **options: object) -> FamilyTable:
    targets = {"library": [load("circle"), load("heart")]}
    figures = measure_generators(targets, sources, (0, 1), SETTINGS, reference, store, **options)  # type: ignore[arg-type]
    return figures.families["library"]


def test_that_the_bundled_prior_is_ahead_of_random_weights(reference: np.ndarray, weights: str) -> None:
    found = table(["prior", weights], reference, RunStore(SETTINGS.to_json()))
    assert list(found.rows) == ["prior", "cgan"]
    prior, random = found.rows.values()
    assert prior.siou > random.siou and prior.siou > found.uniform_siou and prior.success >= random.success
    assert prior.runs == random.runs == 4 and prior.by_steps == {}
    assert random.paper is not None and random.paper.siou == 0.876 and prior.paper is None
    assert prior.siou_interval[0] <= prior.siou <= prior.siou_interval[1]
    assert any("(87.6)" in line for line in found.sentences())


def test_that_a_table_goes_on_where_it_ended_and_repeats(reference: np.ndarray, weights: str, tmp_path: Path) -> None:
    path = tmp_path / "runs.jsonl"
    with RunStore.opened(SETTINGS.to_json(), path) as store:
        first = table([weights], reference, store)
    done: list[tuple[int, int]] = []
    with RunStore.opened(SETTINGS.to_json(), path) as store:
        again = table([weights], reference, store, report=lambda one, all_of: done.append((one, all_of)))
    assert done == [(4, 4)] and again == first
    fresh = table([weights], reference, RunStore(SETTINGS.to_json()))
    first_row, fresh_row = (replace(one.rows["cgan"], milliseconds=0.0) for one in (first, fresh))
    assert fresh_row == first_row


def test_that_a_sweep_measures_other_numbers_of_steps(reference: np.ndarray) -> None:
    found = table(["prior"], reference, RunStore(SETTINGS.to_json()), sweep={"prior": (1, 4)})
    by_steps = found.rows["prior"].by_steps
    assert list(by_steps) == [1, 4] and by_steps[1].siou <= by_steps[4].siou + 0.02


def test_that_like_samples_score_1_and_unlike_ones_more(reference: np.ndarray) -> None:
    classes = FieldClasses.of(reference)
    same = np.repeat(reference[:1], 8, axis=0)
    assert classes.inception_score(same) == pytest.approx(1.0)
    assert 1.5 < classes.inception_score(reference[:64]) <= CLASSES
    assert mean_distance(same) == 0.0 < mean_distance(reference[:8])


def test_that_unknown_generators_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError) as variant:
        generator_named("no-such-variant")
    assert variant.value.code == "model.unknown_variant"
    (tmp_path / "broken.safetensors").write_bytes(b"no weights")
    with pytest.raises(ModelError):
        generator_named(str(tmp_path / "broken.safetensors"))
    with pytest.raises(UsageError) as targets:
        measure_generators({}, ["prior"], (0,), SETTINGS, np.zeros((2, 4)), RunStore({}))
    assert targets.value.code == "benchmark.no_targets"


def test_that_two_rows_of_one_name_are_refused(reference: np.ndarray, weights: str) -> None:
    other = str(Path(weights).with_name("other.safetensors"))
    Path(other).write_bytes(Path(weights).read_bytes())
    with pytest.raises(UsageError) as caught:
        table([weights, other], reference, RunStore(SETTINGS.to_json()))
    assert caught.value.code == "benchmark.generators_alike"
