"""From noise to design: few-step integration of dz/dt = v(z, t, condition) (paper, Sec. 2.3), with correctors.

Predictor-corrector sampling (the scheme of Song et al. 2021, arXiv 2011.13456): Euler steps carry noise to a design,
correctors bring the finished design's exact outline nearer to the target's.
"""

from __future__ import annotations

from torch import Tensor, full

from kirigami_studio.generator.velocity import Code, Velocity

#: Fields stay where the training data are: x in [0.1, 10].
Z_LIMIT = 1.0


def integrate(network: Velocity, noise: Tensor, code: Code, steps: int) -> Tensor:
    """Follow the velocity field from t = 0 to t = 1.

    Parameters
    ----------
    network : Velocity
    noise : (B, m * n) tensor
        z at t = 0.
    code : Code of B targets, the network's own
    steps : int
        Evaluations of the network.  Where it has a corrector, half of them, rounded down, are corrections; the others
        are equal Euler steps.

    Returns
    -------
    z : (B, m * n) tensor at t = 1
        Fields of the sheet that the code is for.
    """
    return trail(network, noise, code, steps)[-1]


def trail(network: Velocity, noise: Tensor, code: Code, steps: int) -> list[Tensor]:
    """Like :func:`integrate`, but every finished field: after the Euler steps and after each correction."""
    corrections = steps // 2 if network.corrects else 0
    euler = steps - corrections
    z = noise
    for step in range(euler):
        t = full((z.shape[0],), step / euler, dtype=z.dtype, device=z.device)
        z = z + network(z, t, code) / euler
    z = code.on_sheet(z)
    finished = [z]
    for _ in range(corrections):
        z = z.clamp(-Z_LIMIT, Z_LIMIT)
        z = z + network.correction(z, code)
        finished.append(z)
    return finished
