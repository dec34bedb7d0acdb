"""From noise to design: few-step integration of dz/dt = v(z, t, condition) (paper, Sec. 2.3), with corrections.

A predictor-corrector scheme (Song et al. 2021, arXiv 2011.13456): Euler steps take noise to a design, corrections bring
the design's exact outline nearer to the target's.
"""

from __future__ import annotations

from dataclasses import dataclass

from torch import Tensor, full

from kirigami_studio.generator.velocity import Code, Velocity


@dataclass(frozen=True, slots=True)
class LateStart:
    """A flow that starts near a design and not from noise alone (as SDEdit does, Meng et al. 2021, 2108.01073)."""

    time: float  #: in [0, 1); when it starts: the state is then the straight path's, (1 - time) noise + time design
    #: (1, m * n); what the sheet's design has and the network's own grid cannot hold, taken ``time`` times: it is added
    #: to the result unchanged.
    remainder: Tensor


def integrate(network: Velocity, start: Tensor, code: Code, steps: int, late: LateStart | None = None) -> Tensor:
    """Follow the velocity field from t = 0 to t = 1.

    Parameters
    ----------
    start : (B, cells) tensor
        Fields of the network's own grid at t = 0, or at the time of ``late``.
    code : Code of B targets, the network's own
    steps : int
        Evaluations of the network.  Where it has a corrector, half of them, rounded down, are corrections; the others
        are equal Euler steps.
    late : LateStart, optional
        Starts later than at t = 0.

    Returns
    -------
    design : (B, m * n + R) tensor at t = 1
        Fields of the sheet that the code is for, then the offsets of its mouths where they are free.
    """
    return trail(network, start, code, steps, late)[-1]


def trail(network: Velocity, start: Tensor, code: Code, steps: int, late: LateStart | None = None) -> list[Tensor]:
    """Like :func:`integrate`, but every design on the way: after the Euler steps and after each correction."""
    corrections = steps // 2 if network.corrects else 0
    euler = steps - corrections
    begin = 0.0 if late is None else late.time
    z = code.transfer.state(start)
    for step in range(euler):
        t = full((z.shape[0],), begin + (1.0 - begin) * step / euler, dtype=z.dtype, device=z.device)
        z = z + (1.0 - begin) * network(z, t, code) / euler
    z = code.transfer.on_grid(z)
    if late is not None:
        z = code.transfer.symmetric(z + late.remainder)
    designs = [z]
    for _ in range(corrections):
        z = code.transfer.bounded(z)
        z = z + network.correction(z, code)
        designs.append(z)
    return designs
