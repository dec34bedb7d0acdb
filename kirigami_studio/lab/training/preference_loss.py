"""What an aligned sample should be: a good match, smooth when asked for, and near the sample that the prior draws.

All are differentiable through the exact decoder.

* *match*: distances between the boundaries both ways, each weighted by the boundary length it stands for: for small
  gaps the area by which the silhouettes differ, a soft 1 - IoU.
* *variation*: the paper's TV(x) per void.
* *unevenness*: the coefficient of variation of panel areas, by which sheets are judged.
* *anchor*: squared distance of z to what the frozen prior draws from the same noise (reference regression).  Outlines
  fix only some of the directions of z; along the others the anchor keeps every sample where it was, and with it the
  spread of samples of one target.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.generator.conditioning import normalised
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.generator.feedback import squared_distances, to_loop
from kirigami_studio.lab.training.corpus import outline_of_nodes
from kirigami_studio.lattice.batched import BatchedLattice
from kirigami_studio.lattice.sheet import RIM_REACH

#: Distance (unit-area lengths) above which a gap counts linearly; below, its square over twice this.
SOFTNESS = 0.002
#: z beyond +-1 (x outside [0.1, 10]) is clipped when sampled; the square of the excess costs this much.
RANGE_WEIGHT = 1.0
#: Variances of relative panel areas below this count linearly: the root has no slope at the uniform sheet.
LEAST_VARIANCE = 1e-6
#: Weight of the gaps before the last correction.
EARLY_WEIGHT = 0.5


@dataclass(frozen=True, slots=True)
class PreferenceTerms:
    """The parts of the loss, one of each a sample.

    Attributes
    ----------
    match : (B,) tensor, unit area
    variation : (B,) tensor, paper's TV(x) / (m n)
    unevenness : (B,) tensor
        Coefficient of variation of panel areas.
    excess : (B,) tensor
        Mean squared excess of z over its bounds.
    """

    match: Tensor
    variation: Tensor
    unevenness: Tensor
    excess: Tensor


def preference_terms(lattice: BatchedLattice, grid: DeployedGrid, z: Tensor, loop: Tensor) -> PreferenceTerms:
    """Measure designs z (B, m * n + R) of a grid against target boundaries (B, S, 2); differentiable.

    Both have unit area about the centroid and lie in the same pose.
    """
    field = z[:, : grid.cells].view(-1, lattice.rows, lattice.columns)
    inside = field.clamp(-LOG_RATIO_LIMIT, LOG_RATIO_LIMIT)
    offsets = z[:, grid.cells :].clamp(-RIM_REACH, RIM_REACH) if grid.free_rim else None
    ratio = torch.pow(10.0, inside)
    nodes = lattice.compact(ratio, offsets)
    # Bounded where it counts, but with a way back for what lies outside.
    return PreferenceTerms(
        boundary_gap(normalised(outline_of_nodes(lattice, grid, nodes)), loop),
        total_variation(ratio),
        area_variation(lattice, nodes),
        (field - inside).square().mean(dim=(1, 2)) * RANGE_WEIGHT,
    )


def trail_gap(
    lattice: BatchedLattice, grid: DeployedGrid, designs: list[Tensor], loop: Tensor
) -> tuple[PreferenceTerms, Tensor]:
    """Terms of the last of several designs of a sampler, and the mean gap of those before it, 0 if there are none.

    A correction is not differentiated through, so the designs that corrections start from have a loss of their own,
    with the mouths that the last one has.
    """
    last = designs[-1]
    terms = preference_terms(lattice, grid, last, loop)
    if len(designs) == 1:
        return terms, torch.zeros_like(terms.match).mean()
    rim = last[:, grid.cells :].detach()
    early = [preference_terms(lattice, grid, torch.cat([z[:, : grid.cells], rim], dim=1), loop) for z in designs[:-1]]
    return terms, torch.stack([one.match + one.excess for one in early]).mean()


def boundary_gap(outline: Tensor, loop: Tensor) -> Tensor:
    """Length-weighted soft distances between outlines (B, L, 2) and target loops (B, S, 2), both ways, halved: (B,)."""
    following = outline.roll(-1, dims=1)
    # The vertices are among the samples, so that the line through them cuts no corner.
    shares = outline.new_tensor([0.0, 1 / 3, 2 / 3])[:, None]
    samples = (outline[:, :, None] * (1 - shares) + following[:, :, None] * shares).flatten(1, 2)
    with torch.no_grad():
        squared = squared_distances(samples, loop)
        nearest, nearest_back = squared.argmin(dim=2), squared.argmin(dim=1)
    out, _ = to_loop(samples, loop, nearest)
    back, _ = to_loop(loop, samples, nearest_back)
    third = (following - outline).norm(dim=-1) / 3
    # A vertex stands for half a third of the edges on both sides.
    length = torch.stack([0.5 * (third + third.roll(1, dims=1)), third, third], dim=2).flatten(1)
    perimeter = (loop.roll(-1, dims=1) - loop).norm(dim=-1).sum(dim=1) / loop.shape[1]
    outward = (length * _soft_length(out)).sum(dim=1)
    return 0.5 * (outward + perimeter * _soft_length(back).sum(dim=1))


def _soft_length(gap: Tensor) -> Tensor:
    """Lengths of vectors (..., 2), rounded off near zero."""
    return torch.sqrt(gap.square().sum(dim=-1) + SOFTNESS**2) - SOFTNESS


def total_variation(x: Tensor) -> Tensor:
    """The paper's TV(x) / (m n) of ratios (B, m, n): (B,), differentiable."""
    down, right = x.diff(dim=1).abs().sum(dim=(1, 2)), x.diff(dim=2).abs().sum(dim=(1, 2))
    return (down + right) / x[0].numel()


def area_variation(lattice: BatchedLattice, nodes: Tensor) -> Tensor:
    """Coefficient of variation (B,) of panel areas of compact nodes, differentiable.

    The same as ``evaluate.evenness`` has of one sheet.
    """
    corners = nodes[:, lattice.panel_nodes]
    x, y = corners[..., 0], corners[..., 1]
    area = (
        0.5
        * ((x[..., 2] - x[..., 0]) * (y[..., 3] - y[..., 1]) - (y[..., 2] - y[..., 0]) * (x[..., 3] - x[..., 1])).abs()
    )
    share = area / area.mean(dim=1, keepdim=True)
    return (share.var(dim=1, unbiased=False) + LEAST_VARIANCE).sqrt()
