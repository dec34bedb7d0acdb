"""Finding, verifying and loading weights."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.foundation.errors import ModelError, UsageError
from kirigami_studio.generator import weights
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.generator.feedback import Feedback
from kirigami_studio.generator.network import VARIATION_COST, NetworkShape, TargetCode, VelocityNetwork
from kirigami_studio.generator.sampler import BATCH, posed, sample_fields
from kirigami_studio.generator.unet import UNetShape, UNetVelocity
from kirigami_studio.generator.weights import digest_of, load_model, model_folder, variants
from kirigami_studio.lab.trained_weights import store_model, store_variants
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.outlines.silhouettes import load
from tests.refusals import refused

pytestmark = pytest.mark.torch
SMALL = NetworkShape(4, 4, 32, 64, 2, 16, 24, 32, 48)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    torch.manual_seed(0)
    store_model("tiny", VelocityNetwork(SMALL), tmp_path, {"steps": 0})
    return tmp_path


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The bundled prior as three variants, by what they prefer."""
    place = tmp_path_factory.mktemp("pair")
    store_variants("prior", {"match": 0.0, "half": 0.5, "even": 1.0}, load_model("prior").network, place, {})
    return place


def test_that_stored_weights_come_back_in_half_precision(folder: Path) -> None:
    torch.manual_seed(0)
    original = VelocityNetwork(SMALL).state_dict()
    loaded = load_model("tiny", folder).network.state_dict()
    assert all(torch.equal(original[name].half().float(), loaded[name]) for name in original)


def test_that_a_manifest_without_a_backbone_means_the_perceptron(folder: Path) -> None:
    manifest = json.loads((folder / "manifest.json").read_text())
    assert manifest["variants"]["tiny"].pop("backbone") == "perceptron"
    (folder / "manifest.json").write_text(json.dumps(manifest))
    assert isinstance(load_model("tiny", folder).network, VelocityNetwork)


@pytest.mark.parametrize("steps", [1, 2, 5])
def test_that_networks_that_look_at_the_geometry_decode_once_a_step(
    folder: Path, monkeypatch: pytest.MonkeyPatch, steps: int
) -> None:
    store_model("blind", VelocityNetwork(replace(SMALL, loop_points=0)), folder, {})
    store_model("picture", UNetVelocity(UNetShape(4, 4, channels=(8, 16))), folder, {})
    store_model("corrector", VelocityNetwork(replace(SMALL, direction=True)), folder, {})
    looked: list[int] = []
    describe = Feedback._described

    def counted(self: Feedback, z: torch.Tensor, *others: object) -> object:
        looked.append(len(z))
        return describe(self, z, *others)  # type: ignore[arg-type]

    monkeypatch.setattr(Feedback, "_described", counted)
    for variant, expected in (("tiny", steps), ("corrector", steps), ("blind", 0), ("picture", 0)):
        looked.clear()
        model = load_model(variant, folder)
        sample_fields(model, load("heart"), (4, 4), k=BATCH, seed=0, steps=steps)
        assert model.decodings(steps) == expected == sum(looked) / BATCH, variant


def test_that_one_network_serves_variants_that_prefer_differently(folder: Path) -> None:
    network = VelocityNetwork(replace(SMALL, preference=True))
    path = store_variants("pair", {"match": 0.0, "even": 1.0}, network, folder, {"steps": 3})
    assert path == folder / "pair.safetensors" and path.exists()
    assert variants(folder) == ("tiny", "match", "even")
    match, even = (load_model(name, folder) for name in ("match", "even"))
    assert (match.variant, match.preference, even.variant, even.preference) == ("match", 0.0, "even", 1.0)
    assert match.digest == even.digest == digest_of("match", folder) != load_model("tiny", folder).digest
    entry = json.loads((folder / "manifest.json").read_text())["variants"]["even"]
    assert (entry["file"], entry["about"]) == ("pair.safetensors", {"steps": 3})
    polygon = posed(load("heart"), range(2))
    codes = [model.code(polygon, DeployedGrid(4, 4)) for model in (match, even)]
    assert all(isinstance(code, TargetCode) for code in codes)
    assert [code.variation_cost.tolist() for code in codes] == [[0.0, 0.0], pytest.approx([VARIATION_COST] * 2)]  # type: ignore[attr-defined]


def test_that_a_manifest_without_a_preference_means_the_match(folder: Path) -> None:
    manifest = json.loads((folder / "manifest.json").read_text())
    assert manifest["variants"]["tiny"].pop("preference") == 0.0
    (folder / "manifest.json").write_text(json.dumps(manifest))
    assert load_model("tiny", folder).preference == 0.0


@pytest.mark.parametrize("grid", [(10, 10), (12, 9)])
@pytest.mark.parametrize(("shape", "cost"), [("heart", 0.02), ("drop", 0.02), ("star", 0.05)])
def test_that_a_preference_for_regularity_gives_smoother_designs_at_a_small_cost_of_match(
    pair: Path, shape: str, cost: float, grid: tuple[int, int]
) -> None:
    def measured(variant: str) -> tuple[float, float]:
        fields = sample_fields(load_model(variant, pair), load(shape), grid, k=8, seed=0, steps=8)
        scores = [evaluate(deploy(field), load(shape)) for field in fields]
        return float(np.mean([score.tv for score in scores])), float(np.mean([score.iou_exact for score in scores]))

    match, even, half = (measured(variant) for variant in ("match", "even", "half"))
    assert even[0] < 0.85 * match[0]
    assert even[0] < half[0] < match[0]
    assert even[1] > match[1] - cost


def test_that_a_unet_comes_back_beside_a_perceptron(folder: Path) -> None:
    shape = UNetShape(4, 4, channels=(8, 16))
    original = UNetVelocity(shape)
    for value in original.parameters():
        torch.nn.init.normal_(value, std=0.1)
    store_model("picture", original, folder, {})
    assert json.loads((folder / "manifest.json").read_text())["variants"]["picture"]["backbone"] == "unet"
    loaded = load_model("picture", folder).network
    assert isinstance(loaded, UNetVelocity)
    assert (loaded.shape, loaded.training) == (shape, False)
    halves = {name: value.half().float() for name, value in original.state_dict().items()}
    assert all(torch.equal(halves[name], value) for name, value in loaded.state_dict().items())
    (drawn,) = sample_fields(load_model("picture", folder), load("heart"), (4, 4), k=1, seed=0, steps=2)
    (flat,) = sample_fields(load_model("tiny", folder), load("heart"), (4, 4), k=1, seed=0, steps=2)
    assert not np.allclose(drawn.log10, flat.log10)


def test_that_an_unknown_backbone_is_named(folder: Path) -> None:
    manifest = json.loads((folder / "manifest.json").read_text())
    manifest["variants"]["tiny"]["backbone"] = "oracle"
    (folder / "manifest.json").write_text(json.dumps(manifest))
    with refused(ModelError, "model.unknown_backbone", backbone="oracle"):
        load_model("tiny", folder)


def test_that_the_manifest_lists_variants_and_their_digests(folder: Path) -> None:
    assert variants(folder) == ("tiny",)
    assert digest_of("tiny", folder) == load_model("tiny", folder).digest


@pytest.mark.parametrize("backbone", [7, [1, 2], None, {"a": "b"}])
def test_that_a_backbone_that_is_no_name_is_refused_in_a_sentence(folder: Path, backbone: object) -> None:
    """Sentences shorten names; what is no name has no such form."""
    listed = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
    for entry in listed["variants"].values():
        entry["backbone"] = backbone
    (folder / "manifest.json").write_text(json.dumps(listed), encoding="utf-8")
    variant = next(iter(listed["variants"]))
    with pytest.raises(ModelError) as refusal:
        load_model(variant, folder)
    assert str(refusal.value).endswith(".")


def test_that_altered_weights_are_refused(folder: Path) -> None:
    path = folder / "tiny.safetensors"
    content = bytearray(path.read_bytes())
    content[-1] ^= 1
    path.write_bytes(content)
    with pytest.raises(ModelError) as caught:
        load_model("tiny", folder)
    assert caught.value.code == "model.weights_damaged"


def test_that_missing_weights_are_named(folder: Path) -> None:
    (folder / "tiny.safetensors").unlink()
    with refused(ModelError, "model.weights_missing", file="tiny.safetensors"):
        load_model("tiny", folder)


def test_that_weights_of_another_shape_are_refused(folder: Path) -> None:
    manifest = json.loads((folder / "manifest.json").read_text())
    manifest["variants"]["tiny"]["shape"]["width"] = 48
    (folder / "manifest.json").write_text(json.dumps(manifest))
    with pytest.raises(ModelError) as caught:
        load_model("tiny", folder)
    assert caught.value.code == "model.weights_do_not_fit"


def test_that_an_unknown_variant_lists_the_known_ones(folder: Path) -> None:
    with refused(UsageError, "model.unknown_variant", choices="tiny"):
        load_model("huge", folder)


@pytest.mark.parametrize("content", ["", "[]", '{"format": 99, "variants": {}}'])
def test_that_a_broken_manifest_is_refused(tmp_path: Path, content: str) -> None:
    (tmp_path / "manifest.json").write_text(content)
    with pytest.raises(ModelError):
        variants(tmp_path)


def test_that_every_bundled_variant_loads_and_is_small_enough_for_git() -> None:
    for variant in variants():
        model = load_model(variant)
        assert len(model.digest) == 64
    files = sorted(model_folder().glob("*.safetensors"))
    tuned = ["paper-accuracy", "paper-balanced", "paper-regularity"]
    assert [file.stem for file in files] == ["aligned", *tuned, "paper", "prior"]
    assert all(file.stat().st_size < 16_000_000 for file in files)


@pytest.mark.parametrize("fault", [MemoryError(), ImportError("no module"), FileNotFoundError("/proc")])
def test_that_a_fault_of_the_machine_is_not_blamed_on_the_file(
    fault: Exception, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def failing(_: object) -> None:
        raise fault

    monkeypatch.setattr(weights, "load_tensors", failing)
    with pytest.raises(type(fault)):
        load_model("tiny", folder)


def test_that_weights_of_another_shape_or_without_an_entry_are_those_of_another_network(folder: Path) -> None:
    manifest = json.loads((folder / "manifest.json").read_text())
    for change in ({"width": 8}, {"width": "wide"}, {"width": None}, {"width": -1}, {"width": 10**30}, {"depth": 1.5}):
        shape = manifest["variants"]["tiny"]["shape"] | change
        entry = manifest["variants"]["tiny"] | {"shape": shape}
        (folder / "manifest.json").write_text(json.dumps(manifest | {"variants": {"tiny": entry}}))
        load_model.cache_clear()
        with pytest.raises(ModelError):
            load_model("tiny", folder)
