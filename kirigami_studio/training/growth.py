"""Weights for a network that sees more than the one they were trained for."""

from __future__ import annotations

from dataclasses import replace

import torch
from torch import Tensor

from kirigami_studio.foundation.errors import ModelError
from kirigami_studio.generator.backbones import Network, Shape, network_of
from kirigami_studio.generator.network import NetworkShape


def grown_state(network: Network, shape: Shape) -> dict[str, Tensor]:
    """Weights of ``network`` for a network of ``shape``: what is new counts for nothing at first.

    Raises
    ------
    ModelError
        The shapes differ in more than their inputs, or the new one sees less.
    """
    state = dict(network.state_dict())
    if network.shape == shape:
        return state
    if not isinstance(shape, NetworkShape) or not _sees_more(network.shape, shape):
        raise ModelError("The weights to begin with belong to a network of another shape.")
    grown = network_of(shape).state_dict()
    for name, value in grown.items():
        old = state.get(name)
        if old is None:
            state[name] = torch.zeros_like(value)
        elif old.shape != value.shape:
            state[name] = torch.cat([old, old.new_zeros(len(old), value.shape[1] - old.shape[1])], dim=1)
    return {name: state[name] for name in grown}


def _sees_more(old: Shape, new: NetworkShape) -> bool:
    if not isinstance(old, NetworkShape):
        return False
    senses = {"direction": new.direction, "preference": new.preference, "sheets": new.sheets}
    lost = any(getattr(old, name) and not value for name, value in senses.items())
    return replace(old, **senses) == new and not lost
