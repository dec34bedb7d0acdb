"""From noise to design: few-step Euler integration of dz/dt = v(z, t, condition) (paper, Sec. 2.3)."""

from __future__ import annotations

from torch import Tensor, full

from kirigami_studio.generator.network import TargetCode, VelocityNetwork


def integrate(network: VelocityNetwork, noise: Tensor, code: TargetCode, steps: int) -> Tensor:
    """Follow the velocity field from t = 0 to t = 1.

    Parameters
    ----------
    network : VelocityNetwork
    noise : (B, m * n) tensor
        z at t = 0.
    code : TargetCode of B targets
    steps : int
        Equal Euler steps.

    Returns
    -------
    z : (B, m * n) tensor at t = 1
    """
    z = noise
    for step in range(steps):
        t = full((z.shape[0],), step / steps, dtype=z.dtype, device=z.device)
        z = z + network(z, t, code) / steps
    return z
