"""Weights of trained networks for the program: one file, and its entry in a manifest."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from safetensors.torch import save as save_tensors

from kirigami_studio.foundation.errors import ModelError
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.generator.velocity import Network, backbone_of
from kirigami_studio.generator.weights import FORMAT, MANIFEST, Model, load_model, manifest_of


def variants_about(folder: Path) -> dict[str, dict[str, Any]]:
    """Records of how the variants in a folder were trained, by name; none without a manifest.

    Raises
    ------
    ModelError
        The manifest is damaged.
    """
    if not (folder / MANIFEST).exists():
        return {}
    return {variant: entry["about"] for variant, entry in manifest_of(folder)["variants"].items()}


def load_weights(path: Path) -> Model:
    """Load a weights file that lies beside its manifest, as the first variant that it serves.

    Raises
    ------
    ModelError
        The manifest does not know the file; else as :func:`load_model`.
    """
    for variant, entry in manifest_of(path.parent)["variants"].items():
        if entry["file"] == path.name:
            return load_model(variant, path.parent)
    raise ModelError("model.weights_not_listed", folder=path.parent, file=path.name)


def store_model(variant: str, network: Network, folder: Path, about: dict[str, object]) -> Path:
    """Write weights in half precision and enter them in the folder's manifest as one variant.

    Parameters
    ----------
    about : dict
        What the model card's table needs: how it was trained, what it scored.

    Returns
    -------
    path : Path
        The safetensors file.
    """
    return store_variants(variant, {variant: 0.0}, network, folder, about)


def store_variants(
    name: str, preferences: Mapping[str, float], network: Network, folder: Path, about: dict[str, object]
) -> Path:
    """Store one network that serves several variants by its preference, as :func:`store_model`.

    Parameters
    ----------
    name : str
        Of the file, without its ending.
    preferences : mapping of str to float
        Variants and what they prefer, from match (0) to regularity (1).
    network, folder, about
        As in :func:`store_model`.
    """
    tensors = {key: value.detach().cpu().half().contiguous() for key, value in network.state_dict().items()}
    content = save_tensors(tensors, metadata={"format": str(FORMAT)})
    path = folder / f"{name}.safetensors"
    write_atomically(path, content)
    empty: dict[str, Any] = {"format": FORMAT, "variants": {}}
    manifest = manifest_of(folder) if (folder / MANIFEST).exists() else empty
    for variant, preference in preferences.items():
        manifest["variants"][variant] = {
            "file": path.name,
            "sha256": hashlib.sha256(content).hexdigest(),
            "backbone": backbone_of(network.shape),
            "preference": preference,
            "shape": network.shape.to_json(),
            "about": about,
        }
    write_atomically(folder / MANIFEST, (json.dumps(manifest, indent=2) + "\n").encode())
    return path
