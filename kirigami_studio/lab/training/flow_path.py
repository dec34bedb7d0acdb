"""Conditional flow matching: the path from noise to designs, the CFM loss (paper, Sec. 2.3, Eq. 3), couplings.

Couplings of noise and designs:

*independent* keeps the conditional unbiased.  *ot* is the paper's minibatch optimal transport; because it looks at the
design and not at the target, noise leaks the answer in training that it cannot know when sampling.  *conditional-ot*
adds the distance between targets to the transport cost, so noise moves only between designs of like silhouettes
(the idea of C2OT, arXiv 2503.10636).
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from scipy.optimize import linear_sum_assignment
from torch import Tensor

from kirigami_studio.foundation.errors import UsageError

COUPLINGS = ("independent", "ot", "conditional-ot")
#: What a squared distance between targets costs beside one between noise and design.
CONDITION_WEIGHT = 10.0


@dataclass(frozen=True, slots=True)
class PathSample:
    """Points of conditional paths, one of each.

    Attributes
    ----------
    x_t : (B, C) tensor
        Where the paths are at their times.
    dx_t : (B, C) tensor
        Their velocities there: what the network is to say.
    """

    x_t: Tensor
    dx_t: Tensor


class ConditionalPath:
    """The straight path from noise x_0 to a design x_1 of conditional flow matching (paper, Sec. 2.3, above Eq. 3)."""

    @staticmethod
    def sample(noise: Tensor, data: Tensor, t: Tensor) -> PathSample:
        """x_t = (1 - t) x_0 + t x_1 and dx_t / dt = x_1 - x_0.

        Parameters
        ----------
        noise, data : (B, C) tensors
            x_0 and x_1.
        t : (B,) tensor in [0, 1]
        """
        velocity = data - noise
        return PathSample(noise + t[:, None] * velocity, velocity)

    @staticmethod
    def predicted_data(x_t: Tensor, velocity: Tensor, t: Tensor) -> Tensor:
        """Where a path that is at ``x_t`` (B, C) at times t (B,) ends if its velocity (B, C) is the one given."""
        return x_t + (1 - t[:, None]) * velocity


def cfm_loss(velocity: Tensor, sample: PathSample) -> Tensor:
    """CFM loss (paper, Eq. 3): E |v(x_t, t, y) - (x_1 - x_0)|^2, the mean over batch and cells.

    Parameters
    ----------
    velocity : (B, C) tensor
        v at the points ``x_t`` of ``sample``.
    sample : PathSample
    """
    return (velocity - sample.dx_t).square().mean()


def cfm_errors(velocity: Tensor, sample: PathSample) -> Tensor:
    """The squared error inside the CFM loss (paper, Eq. 3) of every sample, mean over cells: (B,)."""
    return (velocity - sample.dx_t).square().mean(dim=1)


def pairing_cost(coupling: str, noise: Tensor, z: Tensor, conditions: Tensor) -> Tensor:
    """Cost (B, B) of pairing designs and their conditions with rows of noise.

    Raises
    ------
    UsageError
        A coupling that pairs nothing, or none of ``COUPLINGS``.
    """
    if coupling not in COUPLINGS[1:]:
        raise UsageError("training.unknown_coupling", coupling=coupling, choices=", ".join(COUPLINGS))
    cost = torch.cdist(z, noise).square()
    if coupling == "ot":
        return cost
    # Noise b was drawn for target b: moving it to another target costs the squared distance between the two.
    return cost + CONDITION_WEIGHT * torch.cdist(conditions, conditions).square()


def paired_noise(noise: Tensor, cost: Tensor) -> Tensor:
    """``noise`` (B, D) in the order of least cost: row b belongs to design b."""
    _, columns = linear_sum_assignment(cost.cpu().numpy())
    return noise[torch.as_tensor(columns, device=noise.device)]
