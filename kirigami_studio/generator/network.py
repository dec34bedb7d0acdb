"""The velocity network: residual multilayer perceptron with the condition added inside every block."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace

import torch
from torch import Tensor, nn

from kirigami_studio.generator.conditioning import ConditionLayout, condition, smoothed_points
from kirigami_studio.generator.deployed_grid import DeployedGrid, GridTransfer, grid_transfer
from kirigami_studio.generator.feedback import Feedback

#: What corrections take TV(x) / (m n) to cost at full preference for regularity, in squared unit-area lengths: a third
#: less variation for half a point of match or less (tried once on 40 structured and 40 Sobol outlines with the prior);
#: drawn shapes with arms lose more.
VARIATION_COST = 1.5e-4
#: Numbers that describe a grid and its angle; one more says whether the rim is free.
GRID_FEATURES = 5


@dataclass(frozen=True, slots=True)
class NetworkShape:
    """Everything needed to rebuild a network for its weights."""

    #: rows, columns: grid of the ratio fields it draws.
    rows: int = 10
    columns: int = 10
    width: int = 384  #: channels of the residual stream
    hidden: int = 768  #: channels inside a block
    blocks: int = 6
    time_features: int = 64  #: Fourier features of t (even)
    #: contour_points, rays: see :class:`ConditionLayout`.
    contour_points: int = 96
    rays: int = 128
    #: Points of the target boundary that feedback measures against, see ``feedback``; 0 leaves feedback out.
    loop_points: int = 192
    z_scale: float = 0.5  #: standard deviation of the source noise; z is divided by it at the input
    #: Feedback, where there is any, gives the Gauss-Newton direction too, and the network says how far corrections
    #: follow it; without, they follow it all the way.
    direction: bool = False
    preference: bool = False  #: the network takes a preference between match (0) and regularity (1)
    sheets: bool = False  #: the network is given the sheet's grid and angle, which it may have met in training
    rims: bool = False  #: it is also given whether the rim is free, and has met free rims in training

    @property
    def feedback_width(self) -> int:
        """Number of feedback features."""
        return Feedback.width(self.rows, self.columns, self.loop_points, self.direction) if self.loop_points else 0

    @property
    def condition_layout(self) -> ConditionLayout:
        return ConditionLayout(self.contour_points, self.rays)

    def to_json(self) -> dict[str, int | float]:
        return asdict(self)


@dataclass(frozen=True, slots=True)
class TargetCode:
    """A batch of targets as the network uses them, computed once for all samples and steps."""

    encoded: Tensor  #: (B, blocks * hidden)
    loop: Tensor  #: (B, loop_points, 2); target boundary for feedback
    transfer: GridTransfer  #: between the network's grid and the grid that all of them are for
    feedback: Feedback | None  #: the exact geometry of that grid; missing where the network does not look at it
    variation_cost: Tensor  #: (B,); what corrections take TV(x) / (m n) to cost, see ``gauss_newton``

    def picked(self, rows: slice) -> TargetCode:
        """Some of the targets."""
        return replace(self, encoded=self.encoded[rows], loop=self.loop[rows], variation_cost=self.variation_cost[rows])

    def repeated(self, count: int) -> TargetCode:
        """Every target ``count`` times in a row."""
        return replace(
            self,
            encoded=self.encoded.repeat_interleave(count, dim=0),
            loop=self.loop.repeat_interleave(count, dim=0),
            variation_cost=self.variation_cost.repeat_interleave(count),
        )


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
    """v(z_t, t, condition) of the flow (paper, Eq. 3), on flattened fields."""

    def __init__(self, shape: NetworkShape) -> None:
        super().__init__()
        self.shape = shape
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
        self.prefer = nn.Linear(1, shape.hidden * shape.blocks, bias=False) if shape.preference else None
        # What it knows of the sheet: its grid and angle.
        told = GRID_FEATURES + shape.rims
        self.lie = nn.Linear(told, shape.hidden * shape.blocks, bias=False) if shape.sheets else None
        for layer in (self.prefer, self.lie):
            if layer is not None:
                nn.init.zeros_(layer.weight)
        self.blocks = nn.ModuleList(_Block(shape.width, shape.hidden) for _ in range(shape.blocks))
        self.norm = nn.LayerNorm(shape.width)
        self.leave = nn.Linear(shape.width, cells)
        nn.init.zeros_(self.leave.weight)
        nn.init.zeros_(self.leave.bias)
        self.follow, self.amend = None, None
        if shape.direction and shape.loop_points:
            self.follow, self.amend = nn.Linear(shape.width, cells), nn.Linear(shape.width, cells)
            for layer in (self.follow, self.amend):
                nn.init.zeros_(layer.weight)
                nn.init.zeros_(layer.bias)

    def code(
        self,
        polygons: Tensor,
        shift: Tensor | None = None,
        preference: Tensor | None = None,
        grid: DeployedGrid | None = None,
    ) -> TargetCode:
        """Prepare targets.

        Parameters
        ----------
        polygons : (B, L, 2) tensor
            Normalised, in the pose that the network is to see.
        shift : (B,) tensor, optional
            Moves the contour's start.
        preference : (B,) tensor, optional
            0 for match, 1 for regularity, 0 when missing.  Corrections follow it in any network; those with
            ``preference`` also draw by it.
        grid : DeployedGrid, optional
            What is to show them; the network's own grid at phi = 0 when missing.
        """
        shape = self.shape
        described = condition(polygons, shape.condition_layout, shift)
        encoded = self.condition_per_block(self.encode(described))
        if preference is None:
            preference = polygons.new_zeros(len(polygons))
        if self.prefer is not None:
            encoded = encoded + self.prefer(preference[:, None])
        variation_cost = VARIATION_COST * preference.square()
        grid = grid or DeployedGrid(shape.rows, shape.columns)
        if self.lie is not None:
            encoded = encoded + self.lie(_grid_features(grid, shape, polygons))
        own, device = (shape.rows, shape.columns), polygons.device
        if not shape.loop_points:
            return TargetCode(encoded, polygons[:, :0], grid_transfer(own, grid, device), None, variation_cost)
        feedback = Feedback(own, grid, device)
        return TargetCode(
            encoded, smoothed_points(polygons, shape.loop_points), feedback.transfer, feedback, variation_cost
        )

    def forward(self, z: Tensor, t: Tensor, code: TargetCode) -> Tensor:
        """Velocity.

        Parameters
        ----------
        z : (B, cells) tensor
            State of the flow, see ``GridTransfer.state``.
        t : (B,) tensor in [0, 1]
        code : TargetCode of B targets

        Returns
        -------
        (B, cells) tensor, dz / dt
        """
        features = z[:, :0]
        if code.feedback is not None:
            features = code.feedback(code.transfer.on_grid(z), code.loop, self.shape.direction).features
        transfer = code.transfer
        return transfer.state_change(self.leave(self._hidden(transfer.seen(z), t, code, features)))

    @property
    def corrects(self) -> bool:
        """Whether the network looks at the exact geometry, which then can correct the fields that the flow ends at."""
        return self.shape.loop_points > 0

    def correction(self, z: Tensor, code: TargetCode) -> Tensor:
        """Change (B, m * n + R) of designs that brings their outlines nearer.

        The Gauss-Newton direction; a network that was trained to correct takes it as far in each ratio as it thinks
        fit, and adds to it.  Mouths follow it all the way.
        """
        if code.feedback is None:
            return torch.zeros_like(z)
        observed = code.feedback(z, code.loop, True, code.variation_cost)
        if self.follow is None or self.amend is None:
            return observed.direction
        transfer = code.transfer
        field, mouths = observed.direction.tensor_split((transfer.cells,), dim=1)
        x = self._hidden(transfer.down(z[:, : transfer.cells]), torch.ones_like(z[:, 0]), code, observed.features)
        change = (1.0 + transfer.up(self.follow(x))) * field + transfer.up(self.amend(x))
        return transfer.symmetric(torch.cat([change, mouths], dim=1))

    def _hidden(self, z: Tensor, t: Tensor, code: TargetCode, features: Tensor) -> Tensor:
        """What the last block makes of a state: (B, width)."""
        time = time_features(t, self.shape.time_features)
        conditions = (code.encoded + self.time_per_block(time)).chunk(self.shape.blocks, dim=-1)
        x: Tensor = self.enter(torch.cat([z / self.shape.z_scale, time, features], dim=-1))
        for block, bias in zip(self.blocks, conditions, strict=True):
            x = block(x, bias)
        hidden: Tensor = self.norm(x)
        return hidden


def _grid_features(grid: DeployedGrid, shape: NetworkShape, like: Tensor) -> Tensor:
    """Input of a network that describes the sheet: zero on its own grid with an even rim."""
    told = [
        math.log(grid.rows / shape.rows),
        math.log(grid.columns / shape.columns),
        math.sin(grid.phi),
        1.0 - math.cos(grid.phi),
        float(not grid.zipped),
    ]
    return like.new_tensor([told + [float(grid.free_rim)] * shape.rims])


def time_features(t: Tensor, count: int) -> Tensor:
    """Cosines and sines of t at geometrically spaced frequencies 0.5 .. 64 pi: (B, count)."""
    frequency = 0.5 * math.pi * torch.logspace(0, math.log10(64), count // 2, dtype=t.dtype, device=t.device)
    phase = t[:, None] * frequency
    return torch.cat([torch.cos(phase), torch.sin(phase)], dim=-1)
