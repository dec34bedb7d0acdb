"""The conditional GAN of the paper's comparison (Table of generators; Appendix "Other model details").

The generator is a U-Net of two levels with {32, 64} channels, stride 2, one residual unit a level, PReLU and instance
normalisation; it sees the mask and one channel of noise.  The discriminator looks at patches of mask and field through
one layer of 32 channels (Isola et al. 2017).  Loss: non-saturating adversarial loss + 10 L1.

Reading: both players move at the same time, in one optimiser step, so that a run is resumed from one state.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor, nn
from torch.func import functional_call
from torch.nn import functional

from kirigami_studio.lab.baselines.conditional import ConditionalGenerator, FieldPixels, normal

#: Weight of the L1 distance to the training design (paper, lambda_L1).
L1_WEIGHT = 10.0


class ResidualUnit(nn.Module):
    """x + two convolutions with instance normalisation and PReLU; ``stride`` 2 halves the resolution."""

    def __init__(self, inside: int, outside: int, stride: int = 1) -> None:
        super().__init__()
        self.convolutions = nn.Sequential(
            nn.Conv2d(inside, outside, 3, stride, padding=1),
            nn.InstanceNorm2d(outside),
            nn.PReLU(),
            nn.Conv2d(outside, outside, 3, padding=1),
            nn.InstanceNorm2d(outside),
            nn.PReLU(),
        )
        self.past = nn.Conv2d(inside, outside, 3, stride, padding=1)

    def forward(self, x: Tensor) -> Tensor:
        """(B, inside, h, w) -> (B, outside, h / stride, w / stride)."""
        result: Tensor = self.past(x) + self.convolutions(x)
        return result


class FieldGenerator(nn.Module):
    """Mask and noise -> field image."""

    def __init__(self, channels: tuple[int, int]) -> None:
        super().__init__()
        first, second = channels
        self.down = ResidualUnit(2, first, stride=2)
        self.middle = ResidualUnit(first, second)
        self.up = nn.Sequential(nn.ConvTranspose2d(first + second, first, 4, 2, padding=1), nn.InstanceNorm2d(first))
        self.leave = nn.Sequential(nn.PReLU(), ResidualUnit(first, first), nn.Conv2d(first, 1, 3, padding=1))

    def forward(self, masks: Tensor, noise: Tensor) -> Tensor:
        """Two times (B, 1, latent, latent) -> (B, 1, latent, latent)."""
        half = self.down(torch.cat([masks, noise], dim=1))
        image: Tensor = self.leave(self.up(torch.cat([half, self.middle(half)], dim=1)))
        return image


class PatchDiscriminator(nn.Module):
    """Whether patches of (mask, field image) look like training pairs: logits."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.layers = nn.Sequential(
            nn.Conv2d(2, width, 4, 2, padding=1), nn.LeakyReLU(0.2), nn.Conv2d(width, 1, 4, padding=1)
        )

    def forward(self, masks: Tensor, images: Tensor) -> Tensor:
        """Two times (B, 1, latent, latent) -> (B, 1, h, w)."""
        logits: Tensor = self.layers(torch.cat([masks, images], dim=1))
        return logits


class Cgan(ConditionalGenerator):
    """The conditional GAN.

    Parameters
    ----------
    pixels : FieldPixels
    channels : (int, int)
        Of the generator's two levels.
    patches : int
        Channels of the discriminator.
    """

    def __init__(
        self, pixels: FieldPixels | None = None, channels: tuple[int, int] = (32, 64), patches: int = 32
    ) -> None:
        super().__init__()
        self.pixels = pixels or FieldPixels()
        self.channels, self.patches = (channels[0], channels[1]), patches
        self.generator = FieldGenerator(self.channels)
        self.discriminator = PatchDiscriminator(patches)

    def settings(self) -> dict[str, Any]:
        return {**super().settings(), "channels": list(self.channels), "patches": self.patches}

    def loss(self, z: Tensor, masks: Tensor, draws: torch.Generator) -> Tensor:
        """Both players' losses; neither moves the other's weights."""
        made = self.generator(masks, normal(tuple(masks.shape), draws))
        fields = self.pixels.field(made)
        # The discriminator sees both fields alike: resized from the grid.
        fake, real = self.pixels.image(fields), self.pixels.image(z)
        judged_real = self.discriminator(masks, real)
        judged_fake = self.discriminator(masks, fake.detach())
        discriminator = 0.5 * (_cross_entropy(judged_real, 1.0) + _cross_entropy(judged_fake, 0.0))
        fixed = {name: value.detach() for name, value in self.discriminator.named_parameters()}
        fooled = _cross_entropy(functional_call(self.discriminator, fixed, (masks, fake)), 1.0)
        distance = functional.l1_loss(fields, z) / self.pixels.z_scale
        return discriminator + fooled + L1_WEIGHT * distance

    def draw(self, masks: Tensor, draws: torch.Generator, steps: int) -> Tensor:
        return self.pixels.field(self.generator(masks, normal(tuple(masks.shape), draws)))


def _cross_entropy(logits: Tensor, wanted: float) -> Tensor:
    return functional.binary_cross_entropy_with_logits(logits, torch.full_like(logits, wanted))
