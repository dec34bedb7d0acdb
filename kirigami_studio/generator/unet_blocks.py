"""Parts of the U-Net: residual blocks, which also change the resolution, attention over pixels, time embedding."""

from __future__ import annotations

import math

import torch
from torch import Tensor, nn

#: The paper's times run from 0 to 1000.
LARGEST_TIME = 1000.0


def zeroed(layer: nn.Conv2d) -> nn.Conv2d:
    """The same convolution with all weights 0: what it feeds begins without it."""
    nn.init.zeros_(layer.weight)
    if layer.bias is not None:
        nn.init.zeros_(layer.bias)
    return layer


class TimeEmbedding(nn.Module):
    """t in [0, 1] -> (B, width), from ``features`` sinusoids of 1000 t (wave lengths 2 pi .. 20000 pi)."""

    def __init__(self, features: int, width: int) -> None:
        super().__init__()
        self.features = features
        self.mix = nn.Sequential(nn.Linear(features, width), nn.SiLU(), nn.Linear(width, width))

    def forward(self, t: Tensor) -> Tensor:
        half = self.features // 2
        frequency = torch.exp(torch.arange(half, dtype=t.dtype, device=t.device) * (-math.log(10_000.0) / half))
        phase = LARGEST_TIME * t[:, None] * frequency
        embedded: Tensor = self.mix(torch.cat([torch.cos(phase), torch.sin(phase)], dim=-1))
        return embedded


class Residual(nn.Module):
    """x + convolutions(x, time), at the same, half or twice the resolution.

    Parameters
    ----------
    inside, outside : int
        Channels of the input and of the output.
    time : int
        Width of the time embedding.
    groups : int
        Of the group normalisations.
    resample : module, optional
        Changes the resolution of both ways through the block ("residual up and down sampling" of the paper).
    """

    def __init__(self, inside: int, outside: int, time: int, groups: int, resample: nn.Module | None = None) -> None:
        super().__init__()
        self.resample = resample or nn.Identity()
        self.enter = nn.Sequential(nn.GroupNorm(groups, inside), nn.SiLU())
        self.first = nn.Conv2d(inside, outside, 3, padding=1)
        self.time = nn.Sequential(nn.SiLU(), nn.Linear(time, outside))
        self.second = nn.Sequential(
            nn.GroupNorm(groups, outside), nn.SiLU(), zeroed(nn.Conv2d(outside, outside, 3, padding=1))
        )
        self.past = nn.Identity() if inside == outside else nn.Conv2d(inside, outside, 1)

    def forward(self, x: Tensor, time: Tensor) -> Tensor:
        """(B, inside, H, W) and (B, time) -> (B, outside, H', W')."""
        update = self.first(self.resample(self.enter(x))) + self.time(time)[:, :, None, None]
        result: Tensor = self.past(self.resample(x)) + self.second(update)
        return result


class SelfAttention(nn.Module):
    """x + attention of every pixel to all pixels."""

    def __init__(self, channels: int, heads: int, groups: int, dropout: float) -> None:
        super().__init__()
        self.norm = nn.GroupNorm(groups, channels)
        self.attend = nn.MultiheadAttention(channels, heads, dropout, batch_first=True)

    def forward(self, x: Tensor) -> Tensor:
        """(B, channels, H, W) -> the same shape."""
        pixels = self.norm(x).flatten(2).transpose(1, 2)
        update, _ = self.attend(pixels, pixels, pixels, need_weights=False)
        result: Tensor = x + update.transpose(1, 2).reshape(x.shape)
        return result


class Stage(nn.Module):
    """A residual block, followed by self-attention where the level has it."""

    def __init__(self, block: Residual, attention: SelfAttention | None) -> None:
        super().__init__()
        self.block = block
        self.attention = attention or nn.Identity()

    def forward(self, x: Tensor, time: Tensor) -> Tensor:
        """(B, inside, H, W) and (B, time) -> (B, outside, H', W')."""
        result: Tensor = self.attention(self.block(x, time))
        return result
