"""Velocity networks: what integration, sampling and validation ask of one, and which there are to train and load."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import torch
from torch import Tensor

from kirigami_studio.foundation.errors import ModelError
from kirigami_studio.generator.conditioning import ConditionLayout
from kirigami_studio.generator.deployed_grid import DeployedGrid, GridTransfer
from kirigami_studio.generator.network import NetworkShape, VelocityNetwork
from kirigami_studio.generator.unet import UNetShape, UNetVelocity

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

    Coded = TypeVar("Coded", bound=DataclassInstance)


class VelocityShape(Protocol):
    """Everything needed to rebuild a network for its weights.

    Attributes
    ----------
    rows, columns : int
        Grid of the ratio fields it draws.
    z_scale : float
        Standard deviation of the source noise.
    condition_layout : ConditionLayout
        The numbers by which pairing compares targets.
    """

    @property
    def rows(self) -> int: ...

    @property
    def columns(self) -> int: ...

    @property
    def z_scale(self) -> float: ...

    @property
    def condition_layout(self) -> ConditionLayout: ...

    def to_json(self) -> dict[str, Any]: ...


class Code(Protocol):
    """A batch of targets as a network uses them, computed once for all samples and steps.

    It is a dataclass whose tensors have the targets as rows; what else it holds is the same for all of them.
    """

    @property
    def transfer(self) -> GridTransfer:
        """Between the network's grid and that of the sheet, where a flow's states live."""
        ...

    def repeated(self, count: int) -> Code:
        """Every target ``count`` times in a row."""
        ...

    def picked(self, rows: slice) -> Code:
        """Some of the targets."""
        ...


class Velocity(Protocol):
    """v(z_t, t, target) of the flow (paper, Eq. 3)."""

    @property
    def shape(self) -> VelocityShape: ...

    @property
    def corrects(self) -> bool:
        """Whether the network can also correct the fields that the flow ends at."""
        ...

    def code(
        self,
        polygons: Tensor,
        shift: Tensor | None = None,
        preference: Tensor | None = None,
        grid: DeployedGrid | None = None,
    ) -> Code:
        """Prepare normalised, posed target polygons (B, L, 2) for a grid, the network's own when missing.

        ``shift`` (B,) moves the contour's start; ``preference`` (B,) runs from match, 0, to regularity, 1.
        """
        ...

    def correction(self, z: Tensor, code: Any) -> Tensor:
        """Change (B, m * n + R) of designs that brings their outlines nearer."""
        ...

    def __call__(self, z: Tensor, t: Tensor, code: Any) -> Tensor:
        """dz / dt of states z of the flow (B, cells) at times t (B,), for the B targets of its own ``code``."""
        ...


def joined(codes: Sequence[Coded]) -> Coded:
    """One code of all targets of several codes of one network for one grid, in order."""

    def merged(values: list[Any]) -> Any:
        return torch.cat(values) if isinstance(values[0], Tensor) else values[0]

    return type(codes[0])(*(merged([getattr(code, field.name) for code in codes]) for field in fields(codes[0])))


#: The networks that can be trained and loaded, by the name under which manifests and the command line know them.
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
        raise ModelError("model.unknown_backbone", backbone=backbone)
    return SHAPES[backbone](**record)
