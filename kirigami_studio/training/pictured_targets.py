"""Outlines as a picture brings them: filled into pixels, turned anyhow, and traced again as a file is read."""

from __future__ import annotations

import math

import numpy as np
import torch
from torch import Tensor

from kirigami_studio.evaluate.silhouette import RasterFrame, rasterise
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.generator.conditioning import contour_points, normalised
from kirigami_studio.outlines.trace import trace

#: Fewest and most pixels along the longer side.
PIXELS = 48, 256


def pictured(polygons: Tensor, count: int, generator: torch.Generator) -> Tensor:
    """Draw every polygon into a picture of its own and read it from there.

    Parameters
    ----------
    polygons : (B, L, 2) tensor
        Unit area about the centroid.
    count : int
        Contour points of the result.
    generator : torch.Generator
        Draws the number of pixels, evenly on a logarithmic scale, and the angle in which the shape is drawn.

    Returns
    -------
    points : (B, count, 2) tensor
        At equal arc length, unit area about the centroid, in the pose of the given polygons.
    """
    chosen = torch.rand((2, len(polygons)), generator=generator, device=generator.device).cpu().numpy()
    sizes = np.round(PIXELS[0] * (PIXELS[1] / PIXELS[0]) ** chosen[0]).astype(int)
    drawn = []
    for polygon, size, turn in zip(polygons.cpu().double().numpy(), sizes, chosen[1], strict=True):
        ring = torch.tensor(_redrawn(polygon, int(size), 2.0 * math.pi * float(turn)), dtype=torch.float32)
        drawn.append(contour_points(normalised(ring[None]), count))
    return torch.cat(drawn).to(polygons.device)


def _redrawn(polygon: FloatArray, size: int, angle: float) -> FloatArray:
    """One polygon (L, 2), turned, filled, traced and turned back; as it was where too little of it is left."""
    c, s = math.cos(angle), math.sin(angle)
    there = np.array([[c, s], [-s, c]])
    placed = polygon @ there
    frame = RasterFrame.around(placed, size)
    try:
        ring, _ = trace(np.where(rasterise(placed, size), 0.5, -0.5))
    except TargetError:
        return polygon
    corner = np.array([frame.left + 0.5 * frame.pixel, frame.top - (size - 0.5) * frame.pixel])
    area = 0.5 * np.sum(ring[:, 0] * np.roll(ring[:, 1], -1) - np.roll(ring[:, 0], -1) * ring[:, 1])
    points: FloatArray = (ring * frame.pixel + corner) @ there.T
    return points if area > 0 else points[::-1].copy()
