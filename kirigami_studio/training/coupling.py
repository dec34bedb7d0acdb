"""How noise is paired with designs in a training batch.

*independent* keeps the conditional unbiased.  *ot* is the paper's minibatch optimal transport; because it looks at the
design and not at the target, noise leaks the answer in training that it cannot know when sampling.  *conditional-ot*
adds the distance between targets to the transport cost, so noise moves only between designs of like silhouettes
(the idea of C2OT, arXiv 2503.10636).
"""

from __future__ import annotations

import torch
from scipy.optimize import linear_sum_assignment
from torch import Tensor

from kirigami_studio.foundation.errors import UsageError

COUPLINGS = ("independent", "ot", "conditional-ot")


def pair_noise(coupling: str, noise: Tensor, z: Tensor, conditions: Tensor, condition_weight: float = 10.0) -> Tensor:
    """Reorder ``noise`` (B, D) so that row b belongs to design ``z[b]`` with condition ``conditions[b]``."""
    if coupling == "independent":
        return noise
    if coupling not in COUPLINGS:
        raise UsageError(f"Unknown coupling '{coupling}'; choose one of {', '.join(COUPLINGS)}.")
    cost = torch.cdist(z, noise).square()
    if coupling == "conditional-ot":
        # Noise b was drawn for target b: moving it to another target costs the squared distance between the two.
        cost = cost + condition_weight * torch.cdist(conditions, conditions).square()
    _, columns = linear_sum_assignment(cost.cpu().numpy())
    return noise[torch.as_tensor(columns, device=noise.device)]
