"""The conditional variational autoencoder of the paper's comparison (Appendix "Other model details").

An encoder compresses the field to 4 latent channels at a quarter of the resolution; the decoder builds the field from
them, its normalisations scaled and shifted by the mask at every resolution (SPADE: Park et al. 2019).  Loss: L1 of the
field + 1e-4 KL; the mean over fields, KL summed over latent numbers.  Sampling draws the latent numbers from the prior.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import torch
from torch import Tensor, nn
from torch.nn import functional

from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lab.baselines.conditional import ConditionalGenerator, FieldPixels, normal

LATENT_CHANNELS = 4
#: Weight of the Kullback-Leibler divergence from the prior (paper).
KL_WEIGHT = 1e-4
#: Hidden channels of the layers that turn masks into scales and shifts.
MASK_CHANNELS = 32


class Spade(nn.Module):
    """Normalise each channel over the image, then scale and shift every pixel as the mask says."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.norm = nn.InstanceNorm2d(channels)
        self.shared = nn.Sequential(nn.Conv2d(1, MASK_CHANNELS, 3, padding=1), nn.ReLU())
        self.scale = nn.Conv2d(MASK_CHANNELS, channels, 3, padding=1)
        self.shift = nn.Conv2d(MASK_CHANNELS, channels, 3, padding=1)

    def forward(self, x: Tensor, masks: Tensor) -> Tensor:
        """(B, channels, h, w) and masks (B, 1, latent, latent) -> (B, channels, h, w)."""
        seen = self.shared(functional.adaptive_avg_pool2d(masks, (x.shape[-2], x.shape[-1])))
        result: Tensor = self.norm(x) * (1 + self.scale(seen)) + self.shift(seen)
        return result


class SpadeBlock(nn.Module):
    """x + two convolutions, each after a SPADE normalisation."""

    def __init__(self, inside: int, outside: int) -> None:
        super().__init__()
        self.first_norm, self.second_norm = Spade(inside), Spade(outside)
        self.first = nn.Conv2d(inside, outside, 3, padding=1)
        self.second = nn.Conv2d(outside, outside, 3, padding=1)
        self.past = nn.Identity() if inside == outside else nn.Conv2d(inside, outside, 1)

    def forward(self, x: Tensor, masks: Tensor) -> Tensor:
        """(B, inside, h, w) and masks -> (B, outside, h, w)."""
        update = self.first(functional.silu(self.first_norm(x, masks)))
        result: Tensor = self.past(x) + self.second(functional.silu(self.second_norm(update, masks)))
        return result


class Encoder(nn.Module):
    """Field image -> mean and log variance of the latent numbers."""

    def __init__(self, channels: tuple[int, ...]) -> None:
        super().__init__()
        layers: list[nn.Module] = [nn.Conv2d(1, channels[0], 3, padding=1)]
        for inside, outside in pairwise(channels):
            layers += [nn.SiLU(), nn.Conv2d(inside, outside, 4, 2, padding=1), nn.InstanceNorm2d(outside)]
        layers += [nn.SiLU(), nn.Conv2d(channels[-1], 2 * LATENT_CHANNELS, 3, padding=1)]
        self.layers = nn.Sequential(*layers)

    def forward(self, image: Tensor) -> tuple[Tensor, Tensor]:
        """(B, 1, latent, latent) -> two times (B, 4, h, w)."""
        mean, log_variance = self.layers(image).chunk(2, dim=1)
        return mean, log_variance.clamp(-20.0, 10.0)


class Decoder(nn.Module):
    """Latent numbers and mask -> field image."""

    def __init__(self, channels: tuple[int, ...]) -> None:
        super().__init__()
        self.enter = nn.Conv2d(LATENT_CHANNELS, channels[-1], 3, padding=1)
        backwards = channels[::-1]
        self.middle = SpadeBlock(channels[-1], channels[-1])
        self.blocks = nn.ModuleList(SpadeBlock(inside, outside) for inside, outside in pairwise(backwards))
        self.leave = nn.Sequential(nn.SiLU(), nn.Conv2d(channels[0], 1, 3, padding=1))

    def forward(self, latent: Tensor, masks: Tensor) -> Tensor:
        """(B, 4, h, w) and masks (B, 1, latent, latent) -> (B, 1, latent, latent)."""
        x = self.middle(self.enter(latent), masks)
        for block in self.blocks:
            x = block(functional.interpolate(x, scale_factor=2.0, mode="nearest"), masks)
        image: Tensor = self.leave(x)
        return image


class Cvae(ConditionalGenerator):
    """The conditional variational autoencoder.

    Parameters
    ----------
    pixels : FieldPixels
    channels : tuple of int
        Of each level, finest first; every further level halves the resolution.
    kl_weight : float
        Weight of the Kullback-Leibler divergence from the prior in the loss.
    """

    def __init__(
        self,
        pixels: FieldPixels | None = None,
        channels: tuple[int, ...] = (32, 64, 64),
        kl_weight: float = KL_WEIGHT,
    ) -> None:
        super().__init__()
        self.pixels = pixels or FieldPixels()
        if self.pixels.latent % 2 ** (len(channels) - 1):
            raise UsageError("model.baseline_pixels", latent=self.pixels.latent, mask=self.pixels.mask)
        self.channels, self.kl_weight = tuple(channels), kl_weight
        self.encoder, self.decoder = Encoder(self.channels), Decoder(self.channels)

    def settings(self) -> dict[str, Any]:
        return {**super().settings(), "channels": list(self.channels), "kl_weight": self.kl_weight}

    def loss(self, z: Tensor, masks: Tensor, draws: torch.Generator) -> Tensor:
        mean, log_variance = self.encoder(self.pixels.image(z))
        latent = mean + torch.exp(0.5 * log_variance) * normal(tuple(mean.shape), draws)
        made = self.pixels.field(self.decoder(latent, masks))
        divergence = 0.5 * (mean.square() + log_variance.exp() - 1.0 - log_variance).flatten(1).sum(dim=1)
        loss: Tensor = functional.l1_loss(made, z) / self.pixels.z_scale + self.kl_weight * divergence.mean()
        return loss

    def draw(self, masks: Tensor, draws: torch.Generator, steps: int) -> Tensor:
        pixels = self.pixels.latent // 2 ** (len(self.channels) - 1)
        latent = normal((len(masks), LATENT_CHANNELS, pixels, pixels), draws)
        return self.pixels.field(self.decoder(latent, masks))
