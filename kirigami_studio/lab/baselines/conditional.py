"""Conditional generators of ratio fields from masks: what training, sampling and scoring ask of one.

All see what the paper's backbone sees (Appendix "Shared U-Net backbone"): the target's mask of 128 x 128, averaged down
to ``latent`` x ``latent`` pixels, and fields of z = log10 x that are resized to the same pixels and back.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import asdict, dataclass
from typing import Any

import torch
from torch import Tensor, nn
from torch.nn import functional

from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.paper import MASK_SIZE
from kirigami_studio.generator.unet import filled_masks


@dataclass(frozen=True, slots=True)
class FieldPixels:
    """Fields and masks as square images of one size.

    Attributes
    ----------
    rows, columns : int
        Grid of the ratio fields.
    latent : int
        Pixels each way.
    mask : int
        Pixels each way into which a target is first drawn; a multiple of ``latent``.
    z_scale : float
        z is divided by this at the input and multiplied at the output, so that images have values of order 1.

    Raises
    ------
    UsageError
        A mask that does not divide into the pixels, or nothing to draw.
    """

    rows: int = 10
    columns: int = 10
    latent: int = 32
    mask: int = MASK_SIZE
    z_scale: float = 0.5

    def __post_init__(self) -> None:
        if self.rows < 1 or self.columns < 1 or self.latent < 4 or self.latent % 2 or self.mask % self.latent:
            raise UsageError("model.baseline_pixels", latent=self.latent, mask=self.mask)

    def to_json(self) -> dict[str, Any]:
        return asdict(self)

    def masks(self, polygons: Tensor) -> Tensor:
        """Masks of normalised, posed polygons (B, L, 2): share of each pixel that is inside, (B, 1, latent, latent)."""
        return functional.avg_pool2d(filled_masks(polygons, self.mask)[:, None], self.mask // self.latent)

    def image(self, z: Tensor) -> Tensor:
        """Fields z (B, m * n) as images (B, 1, latent, latent)."""
        field = (z / self.z_scale).view(-1, 1, self.rows, self.columns)
        return functional.interpolate(field, size=(self.latent, self.latent), mode="bilinear", align_corners=False)

    def field(self, image: Tensor) -> Tensor:
        """Images (B, 1, h, w) as fields z (B, m * n): averaged over each cell's pixels."""
        cells = functional.interpolate(
            image, size=(self.rows, self.columns), mode="bilinear", align_corners=False, antialias=True
        )
        return self.z_scale * cells.flatten(1)


class ConditionalGenerator(nn.Module, ABC):
    """A network that draws fields for masks, and the loss that trains it.

    Attributes
    ----------
    pixels : FieldPixels
    usual_steps : int
        Network evaluations of one sample that the paper uses.
    """

    pixels: FieldPixels
    usual_steps: int = 1

    @abstractmethod
    def loss(self, z: Tensor, masks: Tensor, draws: torch.Generator) -> Tensor:
        """What training lowers.

        Parameters
        ----------
        z : (B, m * n) tensor
            Training designs.
        masks : (B, 1, latent, latent) tensor
            Their silhouettes.
        draws : torch.Generator
            Of all noise, on the device of ``z``.

        Returns
        -------
        scalar tensor
        """

    @abstractmethod
    def draw(self, masks: Tensor, draws: torch.Generator, steps: int) -> Tensor:
        """One field for every mask (B, 1, latent, latent): z (B, m * n), not yet held within its limits.

        ``steps`` counts network evaluations; generators of one evaluation ignore it.
        """

    def settings(self) -> dict[str, Any]:
        """Numbers that rebuild the network for its weights."""
        return self.pixels.to_json()


def normal(like: tuple[int, ...], draws: torch.Generator) -> Tensor:
    """Standard normal numbers of a shape, on the generator's device."""
    return torch.randn(like, generator=draws, device=draws.device)
