"""Finding, verifying and loading weights."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import torch

from kirigami_studio.foundation.errors import ModelError, UsageError
from kirigami_studio.generator.network import NetworkShape, VelocityNetwork
from kirigami_studio.generator.sampler import draw_fields
from kirigami_studio.generator.unet import UNetShape, UNetVelocity
from kirigami_studio.generator.weights import digest_of, load_model, model_folder, store_model, variants
from kirigami_studio.target.silhouettes import load

pytestmark = pytest.mark.torch
SMALL = NetworkShape(4, 4, 32, 64, 2, 16, 24, 32, 48)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    torch.manual_seed(0)
    store_model("tiny", VelocityNetwork(SMALL), tmp_path, {"steps": 0})
    return tmp_path


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
    (drawn,) = draw_fields(load_model("picture", folder), load("heart"), (4, 4), k=1, seed=0, steps=2)
    (flat,) = draw_fields(load_model("tiny", folder), load("heart"), (4, 4), k=1, seed=0, steps=2)
    assert not np.allclose(drawn.log10, flat.log10)


def test_that_an_unknown_backbone_is_named(folder: Path) -> None:
    manifest = json.loads((folder / "manifest.json").read_text())
    manifest["variants"]["tiny"]["backbone"] = "oracle"
    (folder / "manifest.json").write_text(json.dumps(manifest))
    with pytest.raises(ModelError, match="'oracle'"):
        load_model("tiny", folder)


def test_that_the_manifest_lists_variants_and_their_digests(folder: Path) -> None:
    assert variants(folder) == ("tiny",)
    assert digest_of("tiny", folder) == load_model("tiny", folder).digest


def test_that_altered_weights_are_refused(folder: Path) -> None:
    path = folder / "tiny.safetensors"
    content = bytearray(path.read_bytes())
    content[-1] ^= 1
    path.write_bytes(content)
    with pytest.raises(ModelError, match="damaged"):
        load_model("tiny", folder)


def test_that_missing_weights_are_named(folder: Path) -> None:
    (folder / "tiny.safetensors").unlink()
    with pytest.raises(ModelError, match=r"tiny\.safetensors"):
        load_model("tiny", folder)


def test_that_weights_of_another_shape_are_refused(folder: Path) -> None:
    manifest = json.loads((folder / "manifest.json").read_text())
    manifest["variants"]["tiny"]["shape"]["width"] = 48
    (folder / "manifest.json").write_text(json.dumps(manifest))
    with pytest.raises(ModelError, match="do not fit"):
        load_model("tiny", folder)


def test_that_an_unknown_variant_lists_the_known_ones(folder: Path) -> None:
    with pytest.raises(UsageError, match="tiny"):
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
        assert (model_folder() / f"{variant}.safetensors").stat().st_size < 16_000_000
