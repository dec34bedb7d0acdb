"""The diffusion model of the paper's comparison: denoising on the shared U-Net backbone, sampled by DDIM.

Noise is added in 1000 steps of a scaled linear schedule, and the network says which (Ho et al. 2020); sampling takes a
few of these steps without new noise (DDIM: Song et al. 2021).  Backbone as of the flow, see ``generator.unet``.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor
from torch.nn import functional

from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.generator.deployed_grid import DeployedGrid, grid_transfer
from kirigami_studio.generator.unet import LARGEST_TIME, MaskCode, UNetShape, UNetVelocity
from kirigami_studio.lab.baselines.conditional import ConditionalGenerator, FieldPixels, normal

#: Variance added by the first and by the last of all noise steps (paper, scaled linear: their roots grow linearly).
FIRST_VARIANCE, LAST_VARIANCE = 5e-4, 1.95e-2
NOISE_STEPS = 1000


def kept_signal() -> Tensor:
    """Share of the design's variance that is left after each noise step: (1000,), float64, falling from near 1."""
    roots = torch.linspace(FIRST_VARIANCE**0.5, LAST_VARIANCE**0.5, NOISE_STEPS, dtype=torch.float64)
    return torch.cumprod(1.0 - roots.square(), dim=0)


class Diffusion(ConditionalGenerator):
    """The diffusion model.

    Parameters
    ----------
    shape : UNetShape, optional
        Of the backbone; the paper's by default.
    """

    usual_steps = 25

    def __init__(self, shape: UNetShape | None = None) -> None:
        super().__init__()
        self.shape = shape or UNetShape()
        self.pixels = FieldPixels(
            self.shape.rows, self.shape.columns, self.shape.latent, self.shape.mask, self.shape.z_scale
        )
        self.network = UNetVelocity(self.shape)
        self.signal: Tensor
        self.register_buffer("signal", kept_signal().float(), persistent=False)

    def settings(self) -> dict[str, Any]:
        return self.shape.to_json()

    def loss(self, z: Tensor, masks: Tensor, draws: torch.Generator) -> Tensor:
        """Mean squared error of the predicted noise, at random noise steps."""
        step = torch.randint(NOISE_STEPS, (len(z),), generator=draws, device=draws.device)
        noise = normal(tuple(z.shape), draws)
        kept = self.signal[step][:, None]
        noisy = kept.sqrt() * z / self.pixels.z_scale + (1.0 - kept).sqrt() * noise
        return functional.mse_loss(self._noise(noisy, step, self._code(masks)), noise)

    def draw(self, masks: Tensor, draws: torch.Generator, steps: int) -> Tensor:
        """DDIM without new noise; the design that is expected at each step is held within the ratios' limits.

        Raises
        ------
        UsageError
            Fewer than 1 or more than 1000 steps.
        """
        if not 1 <= steps <= NOISE_STEPS:
            raise UsageError("model.diffusion_steps", steps=steps, most=NOISE_STEPS)
        code, limit = self._code(masks), LOG_RATIO_LIMIT / self.pixels.z_scale
        x = normal((len(masks), self.pixels.rows * self.pixels.columns), draws)
        taken = torch.linspace(NOISE_STEPS - 1, 0, steps + 1).round().long()[:-1]
        # What is left of the signal before the first and after each of these steps; after the last nothing is noise.
        left = torch.cat([self.signal[taken], self.signal.new_ones(1)])
        for place, step in enumerate(taken):
            now, then = left[place], left[place + 1]
            noise = self._noise(x, step.expand(len(x)).to(x.device), code)
            expected = ((x - (1.0 - now).sqrt() * noise) / now.sqrt()).clamp(-limit, limit)
            noise = (x - now.sqrt() * expected) / (1.0 - now).sqrt()
            x = then.sqrt() * expected + (1.0 - then).sqrt() * noise
        return self.pixels.z_scale * x

    def _code(self, masks: Tensor) -> MaskCode:
        own = self.shape.rows, self.shape.columns
        return MaskCode(self.network.hint(masks), grid_transfer(own, DeployedGrid(*own), masks.device))

    def _noise(self, x: Tensor, step: Tensor, code: MaskCode) -> Tensor:
        """Predicted noise in states x (B, m * n) after noise steps (B,)."""
        noise: Tensor = self.network(self.pixels.z_scale * x, step.to(x.dtype) / LARGEST_TIME, code)
        return noise
