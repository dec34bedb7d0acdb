"""What the exact geometry says about the field on its way: where its outline stands against the target's.

The velocity network sees, beside z and the target, the outline that z would make if it were decoded now, the
displacements between the two boundaries, both ways, and the Gauss-Newton direction: the change of z that would close
them if the outline moved in proportion.  Without it the network has to know the decoder by heart; with it, it only has
to know how far to trust a linear answer, and which of the many equivalent fields to make.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import torch
from torch import Tensor
from torch.nn.functional import pad

from kirigami_studio.generator.conditioning import normalised
from kirigami_studio.generator.deployed_grid import DeployedGrid, grid_transfer
from kirigami_studio.generator.gauss_newton import Residuals, gauss_newton_direction, variation_terms
from kirigami_studio.lattice.batched import BatchedLattice, BatchedSlopes
from kirigami_studio.lattice.symmetry import Symmetry

#: z is decoded within these bounds: early in the flow it still is noise.
Z_BOUND = 1.5
#: Displacements, positions and directions are divided by these to come near unit variance.
GAP_SCALE = 0.05
PLACE_SCALE = 0.4
DIRECTION_SCALE = 0.25
#: A direction longer than this in any ratio is far outside what its linear model can foresee.
DIRECTION_BOUND = 1.0
#: Fields looked at together: their derivatives stay in the processor's cache.
CHUNK = 32


@dataclass(frozen=True, slots=True)
class Observation:
    """What a network sees of fields."""

    #: (B, F); outline stations, displacements both ways and the direction on the network's grid, each near unit
    #: variance.
    features: Tensor
    direction: Tensor  #: (B, m * n + R); Gauss-Newton change of the designs; empty without it


class Feedback:
    """Boundary displacements of one grid's fields against targets.

    Parameters
    ----------
    own : (rows, columns)
        The network's grid.
    grid : DeployedGrid
        Where the fields lie.
    """

    def __init__(self, own: tuple[int, int], grid: DeployedGrid, device: torch.device) -> None:
        self.grid, self.device = grid, device
        self.lattice, self.slopes = _geometry(grid.rows, grid.columns, grid.zipped, device)
        self.transfer = grid_transfer(own, grid, device)
        self._basis = (
            None
            if grid.symmetry is None
            else _symmetric_designs(grid.rows, grid.columns, grid.cells + grid.mouths, grid.symmetry, device)
        )

    @staticmethod
    def width(rows: int, columns: int, loop_points: int, direction: bool) -> int:
        """Number of features for a network's grid and a target loop of ``loop_points`` points."""
        vertices = 2 * (rows + columns) + 4
        return 2 * vertices + 4 * vertices + loop_points + (rows * columns if direction else 0)

    def __call__(self, z: Tensor, loop: Tensor, direction: bool, variation_cost: Tensor | None = None) -> Observation:
        """Describe designs (B, m * n + R) of the grid against target loops (B, S, 2), without gradient.

        The Gauss-Newton direction takes most of the time and is left out where nobody asks for it;
        ``variation_cost`` (B,) is the cost of TV(x) / (m n) in it.
        """
        with torch.no_grad():
            if not direction or self.device.type != "cpu":
                return self._described(z, loop, direction, variation_cost)
            none = [None] * -(-len(z) // CHUNK)
            costs = none if variation_cost is None else torch.split(variation_cost, CHUNK)
            parts = zip(torch.split(z, CHUNK), torch.split(loop, CHUNK), costs, strict=True)
            seen = [self._described(field, target, direction, cost) for field, target, cost in parts]
            return Observation(torch.cat([one.features for one in seen]), torch.cat([one.direction for one in seen]))

    def _described(self, z: Tensor, loop: Tensor, wanted: bool, variation_cost: Tensor | None) -> Observation:
        cells = self.grid.cells
        field = z[:, :cells].clamp(-Z_BOUND, Z_BOUND).view(-1, self.grid.rows, self.grid.columns)
        outline, slopes = self._outline(field, z[:, cells:] if self.grid.free_rim else None, wanted)
        samples = _with_middles(outline)
        squared = squared_distances(samples, loop)
        out, _ = to_loop(samples, loop, squared.argmin(dim=2))
        back, place = to_loop(loop[:, ::2], samples, squared[:, :, ::2].argmin(dim=1))
        stations, away = self.transfer.stations(outline), out
        if not self.transfer.same_outline:
            read = _with_middles(stations)
            away, _ = to_loop(read, loop, squared_distances(read, loop).argmin(dim=2))
        seen = [stations.flatten(1) / PLACE_SCALE, away.flatten(1) / GAP_SCALE, back.flatten(1) / GAP_SCALE]
        if slopes is None:
            return Observation(torch.cat(seen, dim=1), z[:, :0])
        variation = (
            variation_terms(field, variation_cost)
            if variation_cost is not None and bool(variation_cost.any())
            else None
        )
        residuals = Residuals.of(outline, loop, out, back, 0.5 * place)
        direction = self._direction(residuals, slopes, variation)
        direction = direction.clamp(-DIRECTION_BOUND, DIRECTION_BOUND)
        seen.append(self.transfer.down(direction[:, :cells]) / DIRECTION_SCALE)
        return Observation(torch.cat(seen, dim=1), direction)

    def _direction(self, residuals: Residuals, slopes: Tensor, variation: tuple[Tensor, Tensor] | None) -> Tensor:
        """Gauss-Newton change of the designs, within their symmetry: (B, m * n + R)."""
        if variation is not None and self.grid.free_rim:
            room = self.grid.mouths
            variation = pad(variation[0], (0, room)), pad(variation[1], (0, room, 0, room))
        if self._basis is None:
            return gauss_newton_direction(residuals, slopes, variation)
        basis = self._basis
        if variation is not None:
            variation = variation[0] @ basis, basis.mT @ variation[1] @ basis
        return gauss_newton_direction(residuals, slopes @ basis, variation) @ basis.mT

    def _outline(self, field: Tensor, offsets: Tensor | None, wanted: bool) -> tuple[Tensor, Tensor | None]:
        """Outlines (B, L, 2) of unit area about the centroid, with derivatives if wanted.

        Fields are (B, m, n), mouths (B, R), derivatives (B, L, 2, m * n + R).
        """
        if wanted:
            decoded, slopes = self.slopes(field, self.grid.phi, offsets)
            return normalised(decoded), _normalised_slopes(decoded, slopes)
        decoded = self.lattice.outline(torch.pow(10.0, field), self.grid.phi, offsets)
        return normalised(decoded[:, self.lattice.unzipped] if self.grid.zipped else decoded), None


@lru_cache(maxsize=256)
def _geometry(rows: int, columns: int, zipped: bool, device: torch.device) -> tuple[BatchedLattice, BatchedSlopes]:
    """The tables of a grid, which take longer to build than to use: the same for every angle."""
    lattice = BatchedLattice(rows, columns, device)
    return lattice, BatchedSlopes(lattice, zipped)


@lru_cache(maxsize=256)
def _symmetric_designs(rows: int, columns: int, size: int, symmetry: Symmetry, device: torch.device) -> Tensor:
    """Basis (size, reduced) of the symmetric designs of a grid, of their first numbers."""
    designs = symmetry.on(rows, columns).basis[:size].toarray()
    return torch.tensor(designs[:, np.any(designs != 0.0, axis=0)], dtype=torch.float32, device=device)


def _normalised_slopes(outline: Tensor, slopes: Tensor) -> Tensor:
    """Derivatives (B, L, 2, C) of outlines (B, L, 2) scaled to unit area; a common shift is left out."""
    before, after = outline.roll(1, dims=1), outline.roll(-1, dims=1)
    x, y = outline[..., 0], outline[..., 1]
    area = 0.5 * (x * after[..., 1] - y * after[..., 0]).sum(dim=1)
    grows = 0.5 * torch.stack([after[..., 1] - before[..., 1], before[..., 0] - after[..., 0]], dim=-1)
    growth = (grows.flatten(1)[:, None] @ slopes.flatten(1, 2))[:, 0] / (2 * area[:, None])
    scaled = slopes - outline[..., None] * growth[:, None, None]
    return scaled / area.abs().sqrt()[:, None, None, None]


def _with_middles(outline: Tensor) -> Tensor:
    """Vertices and edge middles in turn: (B, 2 L, 2)."""
    return torch.stack([outline, 0.5 * (outline + outline.roll(-1, dims=1))], dim=2).flatten(1, 2)


def squared_distances(points: Tensor, loop: Tensor) -> Tensor:
    """Squared distance of every point to every loop point: (B, Q, S)."""
    lengths = points.square().sum(dim=-1)[:, :, None] + loop.square().sum(dim=-1)[:, None]
    return lengths - 2 * points @ loop.transpose(1, 2)


def to_loop(points: Tensor, loop: Tensor, nearest: Tensor) -> tuple[Tensor, Tensor]:
    """Closest places on the closed polyline ``loop`` to points (B, Q, 2), near its vertices ``nearest`` (B, Q).

    Returns
    -------
    gap : (B, Q, 2) tensor
        Displacement from each point to its place.
    place : (B, Q) tensor
        Where the place is, in vertices of the loop, at least 0 and less than their number.
    """
    count = loop.shape[1]
    at, before, after = (
        loop.gather(1, ((nearest + shift) % count)[..., None].expand(-1, -1, 2)) for shift in (0, -1, 1)
    )
    back, back_share = _to_segment(points, at, before)
    on, on_share = _to_segment(points, at, after)
    first = back.square().sum(-1, keepdim=True) <= on.square().sum(-1, keepdim=True)
    share = torch.where(first, -back_share, on_share)[..., 0]
    return torch.where(first, back, on), (nearest + share) % count


def _to_segment(points: Tensor, start: Tensor, end: Tensor) -> tuple[Tensor, Tensor]:
    """Displacement (B, Q, 2) of each point to its own segment, and how far along the place is, (B, Q, 1)."""
    along = end - start
    share = ((points - start) * along).sum(-1, keepdim=True) / along.square().sum(-1, keepdim=True).clamp_min(1e-12)
    share = share.clamp(0, 1)
    return start + share * along - points, share
