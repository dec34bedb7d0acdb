"""Weights of the baselines on disk: one safetensors file, which names its kind and numbers itself."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from safetensors.torch import load as load_tensors
from safetensors.torch import save as save_tensors

from kirigami_studio.foundation.errors import ModelError, UsageError
from kirigami_studio.foundation.files import read_at_most, write_atomically
from kirigami_studio.generator.unet import UNetShape
from kirigami_studio.lab.baselines.cgan import Cgan
from kirigami_studio.lab.baselines.conditional import ConditionalGenerator, FieldPixels
from kirigami_studio.lab.baselines.cvae import Cvae
from kirigami_studio.lab.baselines.diffusion import Diffusion

#: The generators that the paper compares with its own, as the command line names them.
KINDS = ("cvae", "cgan", "diffusion")
#: Largest file that is read (bytes).
LARGEST_FILE = 2**30


@dataclass(frozen=True, slots=True)
class StoredGenerator:
    """A trained baseline.

    Attributes
    ----------
    kind : str
        One of ``KINDS``.
    network : ConditionalGenerator
        In evaluation mode.
    about : dict
        How it was trained and what it scored on validation.
    """

    kind: str
    network: ConditionalGenerator
    about: dict[str, Any]


def generator_of(kind: str, settings: dict[str, Any] | None = None) -> ConditionalGenerator:
    """A generator of random weights.

    Parameters
    ----------
    kind : str
    settings : dict, optional
        As its ``settings`` tells them; missing ones are the paper's.

    Raises
    ------
    UsageError
        No such kind, or numbers that make no network.
    """
    given = dict(settings or {})
    if kind == "diffusion":
        return Diffusion(UNetShape(**given))
    layers = {name: given.pop(name) for name in ("channels", "patches", "kl_weight") if name in given}
    if "channels" in layers:
        layers["channels"] = tuple(layers["channels"])
    if kind == "cvae":
        return Cvae(FieldPixels(**given), **layers)
    if kind == "cgan":
        return Cgan(FieldPixels(**given), **layers)
    raise UsageError("model.unknown_baseline", kind=kind, choices=", ".join(KINDS))


def store_generator(kind: str, network: ConditionalGenerator, path: Path, about: dict[str, Any]) -> Path:
    """Write weights in half precision, with everything that rebuilds the network; returns ``path``.

    Raises
    ------
    ExportError
        The file cannot be written.
    """
    tensors = {key: value.detach().cpu().half().contiguous() for key, value in network.state_dict().items()}
    metadata = {"kind": kind, "settings": json.dumps(network.settings()), "about": json.dumps(about)}
    write_atomically(path, save_tensors(tensors, metadata=metadata))
    return path


def load_generator(path: Path) -> StoredGenerator:
    """Read what :func:`store_generator` wrote; no code is run.

    Raises
    ------
    ModelError
        The file is missing, damaged, or holds no baseline.
    """
    try:
        content = read_at_most(path, LARGEST_FILE)
        # The header is JSON, behind its length in eight bytes; safetensors tells its metadata only of a path.
        metadata = json.loads(content[8 : 8 + int.from_bytes(content[:8], "little")])["__metadata__"]
        tensors = {name: value.float() for name, value in load_tensors(content).items()}
        kind, about = metadata["kind"], json.loads(metadata["about"])
        network = generator_of(kind, json.loads(metadata["settings"]))
        network.load_state_dict(tensors)
    except Exception as error:  # safetensors and torch raise many kinds; all mean the same to the user
        raise ModelError("model.baseline_unreadable", path=path) from error
    return StoredGenerator(kind, network.eval().requires_grad_(False), about)
