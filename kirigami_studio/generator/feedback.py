"""What the exact geometry says about the field on its way: where its outline stands against the target's.

The velocity network sees, beside z and the target, the outline that z would make if it were decoded now and the
displacements between the two boundaries, both ways.  Without it the network has to know the decoder by heart; with it,
it only has to know which ratios move which part of the outline.
"""

from __future__ import annotations

import torch
from torch import Tensor

from kirigami_studio.generator.conditioning import normalised
from kirigami_studio.lattice.batched import BatchedLattice

#: z is decoded within these bounds: early in the flow it still is noise.
Z_BOUND = 1.5
#: Displacements and positions are divided by these to come near unit variance.
GAP_SCALE = 0.05
PLACE_SCALE = 0.4


class Feedback:
    """Boundary displacements of fields against targets at phi = 0.

    Parameters
    ----------
    rows, columns : int
        Grid of the fields.
    device : torch.device
    """

    def __init__(self, rows: int, columns: int, device: torch.device) -> None:
        self.lattice = BatchedLattice(rows, columns, device)
        self.vertices = int(self.lattice.unzipped.numel())

    @staticmethod
    def width(rows: int, columns: int, loop_points: int) -> int:
        """Number of features for a grid and a target loop of ``loop_points`` points."""
        vertices = 2 * (rows + columns) + 4
        return 2 * vertices + 4 * vertices + loop_points

    def __call__(self, z: Tensor, loop: Tensor) -> Tensor:
        """Describe fields z (B, m * n) against target loops (B, S, 2): (B, width) without gradient.

        Outline vertices (where they are), displacements from vertices and edge middles to the target, and displacements
        from every second target point to the outline.
        """
        with torch.no_grad():
            field = z.clamp(-Z_BOUND, Z_BOUND).view(-1, self.lattice.rows, self.lattice.columns)
            outline = normalised(self.lattice.outline(torch.pow(10.0, field), 0.0)[:, self.lattice.unzipped])
            samples = torch.stack([outline, 0.5 * (outline + outline.roll(-1, dims=1))], dim=2).flatten(1, 2)
            squared = _squared_distances(samples, loop)
            out = _to_loop(samples, loop, squared.argmin(dim=2))
            back = _to_loop(loop[:, ::2], samples, squared[:, :, ::2].argmin(dim=1))
            return torch.cat(
                [outline.flatten(1) / PLACE_SCALE, out.flatten(1) / GAP_SCALE, back.flatten(1) / GAP_SCALE], dim=1
            )


def _squared_distances(points: Tensor, loop: Tensor) -> Tensor:
    """Squared distance of every point to every loop point: (B, Q, S)."""
    lengths = points.square().sum(dim=-1)[:, :, None] + loop.square().sum(dim=-1)[:, None]
    return lengths - 2 * points @ loop.transpose(1, 2)


def _to_loop(points: Tensor, loop: Tensor, nearest: Tensor) -> Tensor:
    """Displacement of points (B, Q, 2) to the closed polyline ``loop`` near its vertices ``nearest`` (B, Q)."""
    count = loop.shape[1]
    at, before, after = (
        loop.gather(1, ((nearest + shift) % count)[..., None].expand(-1, -1, 2)) for shift in (0, -1, 1)
    )
    gaps = [_to_segment(points, at, other) for other in (before, after)]
    first = gaps[0].square().sum(-1, keepdim=True) <= gaps[1].square().sum(-1, keepdim=True)
    return torch.where(first, gaps[0], gaps[1])


def _to_segment(points: Tensor, start: Tensor, end: Tensor) -> Tensor:
    """Displacement of each point to its own segment."""
    along = end - start
    share = ((points - start) * along).sum(-1, keepdim=True) / along.square().sum(-1, keepdim=True).clamp_min(1e-12)
    return start + share.clamp(0, 1) * along - points
