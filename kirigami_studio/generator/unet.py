"""The paper's network: a U-Net on the resized field, which gets the target's mask through a ControlNet branch.

A field of m x n is resized to 32 x 32, passes a U-Net of four levels (64, 128, 256, 384 channels, two residual blocks
each, attention in the last three, 32 groups, residual up and down sampling) and is resized back (paper, Appendix
"Shared U-Net backbone").  The target is drawn into a mask of 128 x 128 and averaged down to 32 x 32.  A second copy of
the U-Net's downward half sees the field and the mask and adds its features, through convolutions that begin at zero, to
what the U-Net's upward half takes over (ControlNet: Zhang et al. 2023).

Readings where the text is open: attention is one multi-head layer after each residual block, with two heads (the
paper's head widths are half the channels), not the "12 transformer layers" of the paper's table, which would add about
270 million weights to these 64 million; nothing is frozen, both branches train together from random weights.

The paper's hyper-parameters as a command, 400 epochs of 5000 targets::

    kirigami-studio train prior --backbone unet --coupling ot --batch 64 --noises 1 --learning-rate 2e-5
        --weight-decay 0.05 --outline-weight 0 --steps 31250 --out runs/unet

and eight Euler steps when sampling.  ``--designs`` visits 5000 designs over and over as the paper does; without it they
are drawn endlessly.  The learning rate follows a cosine, and an exponential average of the weights stands for the
paper's stochastic weight averaging.  The bundled ``paper`` has one pixel for each ratio instead of resized fields
(``--latent 10``): resizing 10 x 10 to 16 x 16 and back keeps a sixth of the checkerboard mode, which moves outlines
most.

Built from ``torch.nn``.  ``diffusers`` and MONAI offer the same network ready-made, but neither is among this
program's dependencies, and each brings far more than one network (model hubs, imaging formats, schedulers).
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import torch
from torch import Tensor, nn
from torch.nn import functional

from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.paper import MASK_SIZE
from kirigami_studio.generator.conditioning import ConditionLayout
from kirigami_studio.generator.deployed_grid import DeployedGrid, GridTransfer, grid_transfer


def filled_masks(polygons: Tensor, size: int = MASK_SIZE) -> Tensor:
    """Fill each polygon into its own square mask: the picture of a target that the network sees.  No gradient.

    The same pixels as ``evaluate.silhouette.rasterise``, which fills one polygon at a time in NumPy, where training
    needs a whole batch on the device it runs on.  All edges cut every row of pixel centres; where the sum of their
    directions from the left is not 0, the pixel is inside (winding number, so a sheet that overlaps itself is still
    filled).

    Parameters
    ----------
    polygons : (B, L, 2) float tensor
        y up, any place and size, either direction.
    size : int
        Pixels each way; the longer side of the bounding box fills it, the other is centred (paper, Appendix: recentred
        by the bounding-box midpoint).

    Returns
    -------
    masks : (B, size, size) tensor of the polygons' type
        1 where the pixel's centre is inside, 0 elsewhere; row 0 on top.
    """
    with torch.no_grad():
        low, high = polygons.amin(dim=1), polygons.amax(dim=1)
        corner = 0.5 * (low + high) - 0.5 * (high - low).amax(dim=1, keepdim=True)
        pixel = (high - low).amax(dim=1) / size
        # In pixels, with pixel centres at whole numbers and the first row at the bottom.
        x, y = ((polygons - corner[:, None]) / pixel[:, None, None] - 0.5).unbind(dim=-1)
        next_x, next_y = x.roll(-1, dims=1), y.roll(-1, dims=1)
        row = torch.arange(size, dtype=y.dtype, device=y.device)
        above, next_above = y[..., None] > row, next_y[..., None] > row
        crosses = above != next_above
        rise = torch.where(crosses, (next_y - y)[..., None], torch.ones_like(y)[..., None])
        crossing = x[..., None] + (row - y[..., None]) / rise * (next_x - x)[..., None]
        # Pixels from the crossing on get +1 where the edge goes down and -1 where it goes up.
        column = crossing.ceil().clamp(0, size).long()
        direction = torch.where(crosses, above.to(y.dtype) - next_above.to(y.dtype), torch.zeros_like(crossing))
        change = torch.zeros((len(y), size, size + 1), dtype=y.dtype, device=y.device)
        change.scatter_add_(2, column.transpose(1, 2), direction.transpose(1, 2))
        winding = change[..., :-1].cumsum(dim=2)
        return (winding.round() != 0).to(y.dtype).flip(1)


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


class UNetStage(nn.Module):
    """A residual block, followed by self-attention where the level has it."""

    def __init__(self, block: Residual, attention: SelfAttention | None) -> None:
        super().__init__()
        self.block = block
        self.attention = attention or nn.Identity()

    def forward(self, x: Tensor, time: Tensor) -> Tensor:
        """(B, inside, H, W) and (B, time) -> (B, outside, H', W')."""
        result: Tensor = self.attention(self.block(x, time))
        return result


#: Most groups of a group normalisation; narrow networks have fewer.
GROUPS = 32
HEADS = 2


@dataclass(frozen=True, slots=True)
class UNetShape:
    """Everything needed to rebuild a U-Net for its weights; the paper's by default.

    Raises
    ------
    UsageError
        Numbers that make no network.
    """

    #: rows, columns: grid of the ratio fields it draws.
    rows: int = 10
    columns: int = 10
    channels: tuple[int, ...] = (64, 128, 256, 384)  #: of each level, finest first; even numbers of at least 4
    residuals: int = 2  #: residual blocks a level
    latent: int = 32  #: pixels each way of the finest level; every further level halves them
    mask: int = MASK_SIZE  #: pixels each way of the target's mask; a multiple of ``latent``
    dropout: float = 0.1  #: of attention weights, in training
    z_scale: float = 0.5  #: standard deviation of the source noise; z is divided by it at the input

    def __post_init__(self) -> None:
        object.__setattr__(self, "channels", tuple(self.channels))
        if not self.channels or any(width < 4 or width % 2 for width in self.channels):
            raise UsageError("model.unet_channels", channels=", ".join(str(width) for width in self.channels) or "none")
        if self.latent < 1 or self.latent % 2 ** (len(self.channels) - 1) or self.mask % self.latent:
            raise UsageError(
                "model.unet_levels",
                levels=len(self.channels),
                halvings=len(self.channels) - 1,
                latent=self.latent,
                mask=self.mask,
            )

    @property
    def groups(self) -> int:
        """Groups of the normalisations: the most, up to 32, that divide every level's channels."""
        return math.gcd(GROUPS, *self.channels)

    @property
    def condition_layout(self) -> ConditionLayout:
        """The numbers by which conditional pairing compares targets; the network itself sees masks."""
        return ConditionLayout()

    def to_json(self) -> dict[str, Any]:
        return {**asdict(self), "channels": list(self.channels)}


@dataclass(frozen=True, slots=True)
class MaskCode:
    """A batch of targets as the U-Net uses them, computed once for all samples and steps."""

    hint: Tensor  #: (B, channels[0], latent, latent); the encoded mask, which the ControlNet branch adds to the field
    transfer: GridTransfer  #: between the network's grid and the grid that the targets are for

    def repeated(self, count: int) -> MaskCode:
        """Every target ``count`` times in a row."""
        return MaskCode(self.hint.repeat_interleave(count, dim=0), self.transfer)

    def picked(self, rows: slice) -> MaskCode:
        """Some of the targets."""
        return MaskCode(self.hint[rows], self.transfer)


def _attention(shape: UNetShape, level: int) -> SelfAttention | None:
    """Attention of every level but the finest."""
    return SelfAttention(shape.channels[level], HEADS, shape.groups, shape.dropout) if level else None


class DownwardHalf(nn.Module):
    """The field at every resolution, down to the middle; a ControlNet branch is a second one of these."""

    def __init__(self, shape: UNetShape) -> None:
        super().__init__()
        time = 4 * shape.channels[0]
        self.time = TimeEmbedding(shape.channels[0], time)
        self.enter = nn.Conv2d(1, shape.channels[0], 3, padding=1)
        self.stages = nn.ModuleList()
        #: Channels of the features that the upward half takes over, in the order in which they arise.
        self.skips = [shape.channels[0]]
        for level, width in enumerate(shape.channels):
            for _ in range(shape.residuals):
                block = Residual(self.skips[-1], width, time, shape.groups)
                self.stages.append(UNetStage(block, _attention(shape, level)))
                self.skips.append(width)
            if level + 1 < len(shape.channels):
                halved = Residual(width, width, time, shape.groups, nn.AvgPool2d(2))
                self.stages.append(UNetStage(halved, None))
                self.skips.append(width)
        last = self.skips[-1]
        attention = SelfAttention(last, HEADS, shape.groups, shape.dropout)
        self.middle_in = UNetStage(Residual(last, last, time, shape.groups), attention)
        self.middle_out = Residual(last, last, time, shape.groups)

    def forward(self, image: Tensor, t: Tensor, hint: Tensor | None = None) -> tuple[list[Tensor], Tensor, Tensor]:
        """Image (B, 1, latent, latent), times (B,) -> features for the upward half, the middle, the time embedding."""
        time = self.time(t)
        x = self.enter(image) if hint is None else self.enter(image) + hint
        features = [x]
        for stage in self.stages:
            x = stage(x, time)
            features.append(x)
        return features, self.middle_out(self.middle_in(x, time), time), time


class UpwardHalf(nn.Module):
    """From the middle back to the finest resolution, taking over the downward half's features on the way."""

    def __init__(self, shape: UNetShape, skips: list[int]) -> None:
        super().__init__()
        time, below, left = 4 * shape.channels[0], shape.channels[-1], list(skips)
        self.stages = nn.ModuleList()
        #: For every stage, whether it takes over a feature (or doubles the resolution).
        self.takes: list[bool] = []
        for level in reversed(range(len(shape.channels))):
            width = shape.channels[level]
            for _ in range(shape.residuals + 1):
                block = Residual(below + left.pop(), width, time, shape.groups)
                self.stages.append(UNetStage(block, _attention(shape, level)))
                self.takes.append(True)
                below = width
            if level:
                doubled = Residual(width, width, time, shape.groups, nn.Upsample(scale_factor=2.0, mode="nearest"))
                self.stages.append(UNetStage(doubled, None))
                self.takes.append(False)
        last = nn.Conv2d(below, 1, 3, padding=1)
        self.leave = nn.Sequential(nn.GroupNorm(shape.groups, below), nn.SiLU(), zeroed(last))

    def forward(self, x: Tensor, time: Tensor, features: list[Tensor]) -> Tensor:
        """The middle (B, channels[-1], h, w), the time embedding and the features -> (B, 1, latent, latent)."""
        left = list(features)
        for stage, takes in zip(self.stages, self.takes, strict=True):
            x = stage(torch.cat([x, left.pop()], dim=1) if takes else x, time)
        image: Tensor = self.leave(x)
        return image


class UNetVelocity(nn.Module):
    """v(z_t, t, mask) of the flow (paper, Eq. 3), on flattened fields."""

    def __init__(self, shape: UNetShape) -> None:
        super().__init__()
        self.shape = shape
        self.down = DownwardHalf(shape)
        self.up = UpwardHalf(shape, self.down.skips)
        self.control = DownwardHalf(shape)
        self.control.load_state_dict(self.down.state_dict())
        first = shape.channels[0]
        self.hint = nn.Sequential(
            nn.Conv2d(1, first, 3, padding=1),
            nn.SiLU(),
            nn.Conv2d(first, first, 3, padding=1),
            nn.SiLU(),
            zeroed(nn.Conv2d(first, first, 3, padding=1)),
        )
        self.gates = nn.ModuleList(zeroed(nn.Conv2d(width, width, 1)) for width in self.down.skips)
        self.middle_gate = zeroed(nn.Conv2d(shape.channels[-1], shape.channels[-1], 1))

    @property
    def corrects(self) -> bool:
        """The paper's network knows nothing of the exact geometry and corrects nothing."""
        return False

    def correction(self, z: Tensor, code: MaskCode) -> Tensor:
        """No change."""
        return torch.zeros_like(z)

    def code(
        self,
        polygons: Tensor,
        shift: Tensor | None = None,
        preference: Tensor | None = None,
        grid: DeployedGrid | None = None,
    ) -> MaskCode:
        """Prepare normalised, posed target polygons (B, L, 2) for a grid, the network's own when missing.

        A mask does not know where the contour starts, and the network has no preference.
        """
        masks = filled_masks(polygons, self.shape.mask)[:, None]
        own = self.shape.rows, self.shape.columns
        transfer = grid_transfer(own, grid or DeployedGrid(*own), polygons.device)
        return MaskCode(self.hint(functional.avg_pool2d(masks, self.shape.mask // self.shape.latent)), transfer)

    def forward(self, z: Tensor, t: Tensor, code: MaskCode) -> Tensor:
        """Velocity.

        Parameters
        ----------
        z : (B, cells) tensor
            State of the flow, see ``GridTransfer.state``.
        t : (B,) tensor in [0, 1]
        code : MaskCode of B targets

        Returns
        -------
        (B, cells) tensor, dz / dt
        """
        shape = self.shape
        field = (code.transfer.seen(z) / shape.z_scale).view(-1, 1, shape.rows, shape.columns)
        image = functional.interpolate(field, size=(shape.latent, shape.latent), mode="bilinear", align_corners=False)
        features, middle, time = self.down(image, t)
        controls, control, _ = self.control(image, t, code.hint)
        features = [own + gate(added) for own, gate, added in zip(features, self.gates, controls, strict=True)]
        velocity: Tensor = self.up(middle + self.middle_gate(control), time, features)
        # Averaged over each cell's pixels: plain bilinear sampling would look at four of about ten.
        cells = functional.interpolate(
            velocity, size=(shape.rows, shape.columns), mode="bilinear", align_corners=False, antialias=True
        )
        return code.transfer.state_change(cells.flatten(1))
