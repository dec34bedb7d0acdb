"""Which way up the network sees a target.

Fields know their sheet's pose, drawings come in any.  Silhouettes of square sheets are square-like within a few
degrees, so a target that already stands so is left alone (its exact pose is information) and any other is turned to
stand square.  Quarter turns need no choice: even x even grids have them as an exact symmetry.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor

from kirigami_studio.generator.conditioning import square_phase

#: Two standard deviations of the phase that structured designs show in their own sheet's pose (7.6 degrees).
UPRIGHT_WITHIN = math.radians(15.0)


def square_pose(polygons: Tensor) -> Tensor:
    """Angle (B,), radians, that the target is turned and that should be taken back; 0 where it stands upright."""
    phase = square_phase(polygons)
    return torch.where(phase.abs() <= UPRIGHT_WITHIN, torch.zeros_like(phase), phase)
