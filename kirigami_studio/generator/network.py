"""The velocity network: residual multilayer perceptron with the condition added inside every block."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass

import torch
from torch import Tensor, nn

from kirigami_studio.generator.conditioning import ConditionLayout, condition, contour_points
from kirigami_studio.generator.feedback import Feedback


@dataclass(frozen=True, slots=True)
class NetworkShape:
    """Everything needed to rebuild a network for its weights.

    Attributes
    ----------
    rows, columns : int
        Grid of the ratio fields it draws.
    width : int
        Channels of the residual stream.
    hidden : int
        Channels inside a block.
    blocks : int
    time_features : int
        Fourier features of t (even).
    contour_points, rays : int
        See :class:`ConditionLayout`.
    loop_points : int
        Points of the target boundary that feedback measures against, see ``feedback``; 0 leaves feedback out.
    z_scale : float
        Standard deviation of the source noise; z is divided by it at the input.
    """

    rows: int = 10
    columns: int = 10
    width: int = 384
    hidden: int = 768
    blocks: int = 6
    time_features: int = 64
    contour_points: int = 96
    rays: int = 128
    loop_points: int = 192
    z_scale: float = 0.5

    @property
    def feedback_width(self) -> int:
        """Number of feedback features."""
        return Feedback.width(self.rows, self.columns, self.loop_points) if self.loop_points else 0

    @property
    def condition_layout(self) -> ConditionLayout:
        return ConditionLayout(self.contour_points, self.rays)

    def to_json(self) -> dict[str, int | float]:
        return asdict(self)


@dataclass(frozen=True, slots=True)
class TargetCode:
    """A batch of targets as the network uses them, computed once for all samples and steps.

    Attributes
    ----------
    encoded : (B, blocks * hidden) tensor
    loop : (B, loop_points, 2) tensor
        Target boundary for feedback.
    """

    encoded: Tensor
    loop: Tensor

    def repeated(self, count: int) -> TargetCode:
        """Every target ``count`` times in a row."""
        return TargetCode(self.encoded.repeat_interleave(count, dim=0), self.loop.repeat_interleave(count, dim=0))


class _Block(nn.Module):
    """x + W2 silu(W1 norm(x) + condition)."""

    def __init__(self, width: int, hidden: int) -> None:
        super().__init__()
        self.norm = nn.LayerNorm(width)
        self.expand = nn.Linear(width, hidden)
        self.contract = nn.Linear(hidden, width)
        nn.init.zeros_(self.contract.weight)
        nn.init.zeros_(self.contract.bias)

    def forward(self, x: Tensor, condition: Tensor) -> Tensor:
        update: Tensor = self.contract(nn.functional.silu(self.expand(self.norm(x)) + condition))
        return x + update


class VelocityNetwork(nn.Module):
    """v(z_t, t, condition) of the flow (paper, Eq. CFM), on flattened fields."""

    def __init__(self, shape: NetworkShape) -> None:
        super().__init__()
        self.shape = shape
        self._decoder: Feedback | None = None
        cells = shape.rows * shape.columns
        self.encode = nn.Sequential(
            nn.Linear(shape.condition_layout.width, shape.width * 2),
            nn.SiLU(),
            nn.Linear(shape.width * 2, shape.width),
            nn.SiLU(),
        )
        self.condition_per_block = nn.Linear(shape.width, shape.hidden * shape.blocks)
        self.enter = nn.Linear(cells + shape.time_features + shape.feedback_width, shape.width)
        self.time_per_block = nn.Linear(shape.time_features, shape.hidden * shape.blocks, bias=False)
        self.blocks = nn.ModuleList(_Block(shape.width, shape.hidden) for _ in range(shape.blocks))
        self.norm = nn.LayerNorm(shape.width)
        self.leave = nn.Linear(shape.width, cells)
        nn.init.zeros_(self.leave.weight)
        nn.init.zeros_(self.leave.bias)

    def code(self, polygons: Tensor, shift: Tensor | None = None) -> TargetCode:
        """Prepare normalised, posed target polygons (B, L, 2); ``shift`` (B,) moves the contour's start."""
        described = condition(polygons, self.shape.condition_layout, shift)
        loop = contour_points(polygons, self.shape.loop_points) if self.shape.loop_points else polygons[:, :0]
        return TargetCode(self.condition_per_block(self.encode(described)), loop)

    def forward(self, z: Tensor, t: Tensor, code: TargetCode) -> Tensor:
        """Velocity.

        Parameters
        ----------
        z : (B, m * n) tensor
        t : (B,) tensor in [0, 1]
        code : TargetCode of B targets

        Returns
        -------
        (B, m * n) tensor, dz / dt
        """
        time = time_features(t, self.shape.time_features)
        conditions = (code.encoded + self.time_per_block(time)).chunk(self.shape.blocks, dim=-1)
        seen = [z / self.shape.z_scale, time]
        if self.shape.loop_points:
            seen.append(self._feedback(z.device)(z, code.loop))
        x: Tensor = self.enter(torch.cat(seen, dim=-1))
        for block, bias in zip(self.blocks, conditions, strict=True):
            x = block(x, bias)
        velocity: Tensor = self.leave(self.norm(x))
        return velocity

    def _feedback(self, device: torch.device) -> Feedback:
        """The decoder on the device in use, built at the first call."""
        if self._decoder is None or self._decoder.lattice.device != device:
            self._decoder = Feedback(self.shape.rows, self.shape.columns, device)
        return self._decoder


def time_features(t: Tensor, count: int) -> Tensor:
    """Cosines and sines of t at geometrically spaced frequencies 0.5 .. 64 pi: (B, count)."""
    frequency = 0.5 * math.pi * torch.logspace(0, math.log10(64), count // 2, dtype=t.dtype, device=t.device)
    phase = t[:, None] * frequency
    return torch.cat([torch.cos(phase), torch.sin(phase)], dim=-1)
