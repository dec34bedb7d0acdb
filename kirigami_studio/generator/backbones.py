"""The networks that can be trained and loaded, by the name under which manifests and the command line know them."""

from __future__ import annotations

from typing import Any

from kirigami_studio.foundation.errors import ModelError
from kirigami_studio.generator.network import NetworkShape, VelocityNetwork
from kirigami_studio.generator.unet import UNetShape, UNetVelocity

Shape = NetworkShape | UNetShape
Network = VelocityNetwork | UNetVelocity

PERCEPTRON = "perceptron"
UNET = "unet"
SHAPES: dict[str, type[Shape]] = {PERCEPTRON: NetworkShape, UNET: UNetShape}


def backbone_of(shape: Shape) -> str:
    """Name of the kind of network that a shape describes."""
    return next(name for name, kind in SHAPES.items() if isinstance(shape, kind))


def network_of(shape: Shape) -> Network:
    """A network of random weights."""
    return UNetVelocity(shape) if isinstance(shape, UNetShape) else VelocityNetwork(shape)


def shape_from_json(backbone: str, record: dict[str, Any]) -> Shape:
    """The shape that ``to_json`` of a backbone wrote.

    Raises
    ------
    ModelError
        A backbone that this version does not know.
    """
    if backbone not in SHAPES:
        raise ModelError(f"These weights are of a kind of network, '{backbone}', that this version does not know.")
    return SHAPES[backbone](**record)
