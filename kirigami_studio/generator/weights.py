"""Bundled weights: find, verify, load.

``resources/models/manifest.json`` names each variant's file, its SHA-256, the network's kind (``backbone``, a
perceptron where it is not said) and shape; the file is safetensors in half precision, so loading runs no code.
Training hands over exactly these two things.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path, PurePath
from typing import Any

import torch
from safetensors import SafetensorError
from safetensors.torch import load as load_tensors
from torch import Tensor

from kirigami_studio.foundation.errors import ModelError, UsageError
from kirigami_studio.foundation.files import read_at_most
from kirigami_studio.foundation.resources import resource
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.generator.network import NetworkShape
from kirigami_studio.generator.velocity import PERCEPTRON, Code, Network, network_of, shape_from_json

MANIFEST = "manifest.json"
FORMAT = 1
#: Largest files that are read (bytes).
LARGEST_MANIFEST, LARGEST_WEIGHTS = 4 * 2**20, 2**30
#: What safetensors and torch raise for files of other networks and shapes that none has; a lack of memory, of a library
#: or of a file of the system is no fault of the weights.
UNFIT = (SafetensorError, ArithmeticError, LookupError, RuntimeError, TypeError, ValueError)


@dataclass(frozen=True, slots=True)
class Model:
    """A network ready to sample."""

    variant: str
    network: Network  #: in evaluation mode, float32
    digest: str  #: SHA-256 of the weight file, recorded in every project and export
    #: What the variant prefers, from match (0) to regularity (1), where its network has the choice.
    preference: float = 0.0

    @property
    def moves_mouths(self) -> bool:
        """Whether it was trained to draw sheets with a free rim."""
        shape = self.network.shape
        return isinstance(shape, NetworkShape) and shape.rims

    def decodings(self, steps: int) -> int:
        """How often one sample of ``steps`` network evaluations decodes a layout: comparable with the paper's #F."""
        return steps if self.network.corrects else 0

    def code(self, polygons: Tensor, grid: DeployedGrid) -> Code:
        """Prepare normalised, posed target polygons (B, L, 2) for a grid and angle."""
        preference = torch.full((len(polygons),), self.preference)
        return self.network.code(polygons, preference=preference, grid=grid)


def model_folder() -> Path:
    """Folder of the bundled weights."""
    return resource("models")


def variants(folder: Path | None = None) -> tuple[str, ...]:
    """Names of the variants that the manifest offers, in its order; reads no weights.

    Raises
    ------
    ModelError
        The manifest is missing or damaged.
    """
    return tuple(manifest_of(folder or model_folder())["variants"])


def digest_of(variant: str, folder: Path | None = None) -> str:
    """SHA-256 that the manifest promises for a variant."""
    return str(_entry(variant, folder or model_folder())["sha256"])


@cache
def load_model(variant: str, folder: Path | None = None) -> Model:
    """Load a variant once per process.

    Raises
    ------
    UsageError
        No such variant.
    ModelError
        The weights are missing, altered, not finite, or of another shape than the manifest says.
    """
    place = folder or model_folder()
    entry = _entry(variant, place)
    path = place / str(entry["file"])
    try:
        content = read_at_most(path, LARGEST_WEIGHTS)
    except OSError as error:
        raise ModelError("model.weights_missing", file=path.name, variant=variant) from error
    digest = hashlib.sha256(content).hexdigest()
    if digest != entry["sha256"]:
        raise ModelError("model.weights_damaged", file=path.name, found=digest[:12], expected=str(entry["sha256"])[:12])
    try:
        network = network_of(shape_from_json(entry.get("backbone", PERCEPTRON), entry["shape"]))
        network.load_state_dict({name: value.float() for name, value in load_tensors(content).items()})
        if not all(bool(torch.isfinite(value).all()) for value in network.parameters()):
            raise ModelError("model.weights_not_finite", file=path.name)
    except ModelError:
        raise
    except UNFIT as error:
        raise ModelError("model.weights_do_not_fit", file=path.name) from error
    return Model(variant, network.eval().requires_grad_(False), digest, float(entry.get("preference", 0.0)))


def manifest_of(folder: Path) -> dict[str, Any]:
    """The manifest of a folder.

    Raises
    ------
    ModelError
        It is missing, damaged or of another format.
    """
    try:
        manifest = json.loads(read_at_most(folder / MANIFEST, LARGEST_MANIFEST))
    except (OSError, ValueError, RecursionError) as error:
        raise ModelError("model.list_unreadable", folder=folder) from error
    if not isinstance(manifest, dict) or manifest.get("format") != FORMAT or "variants" not in manifest:
        raise ModelError("model.list_of_other_format", folder=folder)
    variants = manifest["variants"]
    if not isinstance(variants, dict) or not all(map(_is_entry, variants.values())):
        raise ModelError("model.list_unreadable", folder=folder)
    return manifest


def _is_entry(entry: object) -> bool:
    """Whether an entry of the manifest says what is needed to load and name a variant."""
    if not isinstance(entry, dict):
        return False
    file, preference = entry.get("file"), entry.get("preference", 0.0)
    return (
        # A name, not a path that leads elsewhere.
        isinstance(file, str)
        and 0 < len(file) <= 100
        and "\0" not in file
        and file == PurePath(file).name
        and isinstance(entry.get("sha256"), str)
        and isinstance(entry.get("shape"), dict)
        and isinstance(entry.get("about"), dict)
        and isinstance(preference, (int, float))
        and 0.0 <= preference <= 1.0
    )


def _entry(variant: str, folder: Path) -> dict[str, Any]:
    offered: dict[str, dict[str, Any]] = manifest_of(folder)["variants"]
    if variant not in offered:
        raise UsageError("model.unknown_variant", variant=variant, choices=", ".join(offered))
    return offered[variant]
