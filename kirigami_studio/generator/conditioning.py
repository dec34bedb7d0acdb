"""Outline polygons -> condition vectors: the same numbers in training and in the studio.

A silhouette is described twice, both in unit-area coordinates about its centroid: by contour points at equal arc length
(they know thin arms and notches) and by the outer radius along equally spaced rays (they stay in register on jagged
outlines, where arc length drifts).  Everything is batched torch.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor

#: Points averaged to one by :func:`smoothed_points`.
SUBSAMPLES = 6


@dataclass(frozen=True, slots=True)
class ConditionLayout:
    """How many numbers describe a target."""

    #: Points at equal arc length, two coordinates each, counter-clockwise from the positive x axis.
    contour_points: int = 96
    rays: int = 128  #: outer radii at equal angles, counter-clockwise from the positive x axis

    @property
    def width(self) -> int:
        """Length of a condition vector."""
        return 2 * self.contour_points + self.rays


def normalised(polygons: Tensor) -> Tensor:
    """Move the area centroid of each polygon (B, L, 2) to the origin and scale it to unit area."""
    following = polygons.roll(-1, dims=1)
    cross = polygons[..., 0] * following[..., 1] - polygons[..., 1] * following[..., 0]
    area = 0.5 * cross.sum(dim=1)
    centroid = ((polygons + following) * cross[..., None]).sum(dim=1) / (6 * area[:, None])
    return (polygons - centroid[:, None]) / area.abs().sqrt()[:, None, None]


def square_phase(polygons: Tensor) -> Tensor:
    """Angle (radians, within +-pi/4) by which each normalised polygon is turned away from an axis-parallel square.

    It is the phase of the moment of (x + i y)^4 over the area, as the boundary integral (1 / 2i) of w^4 conj(w) dw,
    which three-point Gauss quadrature evaluates exactly on every edge.  A quarter turn leaves it unchanged, as it
    leaves the design space of even x even grids (z -> -rot90 z).
    """
    start = torch.view_as_complex(polygons.contiguous())
    edge = start.roll(-1, dims=1) - start
    moment = torch.zeros_like(start[:, 0])
    for place, weight in ((0.5 - 0.15**0.5, 5 / 18), (0.5, 8 / 18), (0.5 + 0.15**0.5, 5 / 18)):
        w = start + place * edge
        moment = moment + weight * (w**4 * w.conj() * edge).sum(dim=1)
    moment = moment / 2j
    # A square with sides along the axes has a negative real fourth moment: its corners stand at odd multiples of pi/4.
    return torch.angle(-moment) / 4


def turned(polygons: Tensor, angle: Tensor) -> Tensor:
    """Rotate each polygon (B, L, 2) counter-clockwise by its own angle (B,), radians."""
    c, s = torch.cos(angle)[:, None], torch.sin(angle)[:, None]
    x, y = polygons[..., 0], polygons[..., 1]
    return torch.stack([c * x - s * y, s * x + c * y], dim=-1)


def outer_radius(polygons: Tensor, rays: int) -> Tensor:
    """Largest distance from the origin at which each ray meets the outline: (B, rays), 0 where it never does."""
    angle = torch.arange(rays, dtype=polygons.dtype, device=polygons.device) * (2 * math.pi / rays)
    c, s = torch.cos(angle), torch.sin(angle)
    across = (
        polygons[..., 1, None] * c - polygons[..., 0, None] * s
    )  # (B, L, rays): signed distance from the ray's line
    along = polygons[..., 0, None] * c + polygons[..., 1, None] * s
    next_across, next_along = across.roll(-1, dims=1), along.roll(-1, dims=1)
    meets = (across > 0) != (next_across > 0)
    gap = torch.where(meets, across - next_across, torch.ones_like(across))
    reach = along + (next_along - along) * across / gap
    return torch.where(meets, reach, torch.zeros_like(reach)).amax(dim=1).clamp_min(0.0)


def contour_points(polygons: Tensor, count: int, shift: Tensor | None = None) -> Tensor:
    """Resample each outline at equal arc length: (B, count, 2).

    The first point is where the outline last crosses the positive x axis; ``shift`` (B,), in units of the point
    spacing, moves it along the outline (training jitter).
    """
    following = polygons.roll(-1, dims=1)
    length = (following - polygons).norm(dim=-1)
    end = length.cumsum(dim=1)
    total = end[:, -1:]
    start = _start_arc(polygons, following, end - length, length)
    if shift is not None:
        start = start + shift[:, None] * total / count
    wanted = (start + torch.arange(count, dtype=total.dtype, device=total.device) * total / count) % total
    edge = torch.searchsorted(end.contiguous(), wanted.contiguous(), right=True).clamp_max(polygons.shape[1] - 1)
    picked_length = length.gather(1, edge)
    fraction = (wanted - (end - length).gather(1, edge)) / picked_length.clamp_min(1e-12)
    a = polygons.gather(1, edge[..., None].expand(-1, -1, 2))
    b = following.gather(1, edge[..., None].expand(-1, -1, 2))
    points: Tensor = a + fraction.clamp(0, 1)[..., None] * (b - a)
    return points


def smoothed_points(polygons: Tensor, count: int) -> Tensor:
    """Like :func:`contour_points`, every point the mean of the boundary within half a spacing: (B, count, 2).

    Jitter of single contour points, by pixels or by a hand, averages out; what is longer than a spacing stays.
    """
    fine = contour_points(polygons, SUBSAMPLES * count)
    windows = fine.roll(SUBSAMPLES // 2, dims=1).view(len(fine), count, SUBSAMPLES, 2)
    # Half of the first and of the one after the last make the window symmetric about its point.
    following = windows.roll(-1, dims=1)[:, :, 0]
    mean: Tensor = (windows.sum(dim=2) - 0.5 * windows[:, :, 0] + 0.5 * following) / SUBSAMPLES
    return mean


def _start_arc(polygons: Tensor, following: Tensor, begin: Tensor, length: Tensor) -> Tensor:
    """Arc length (B, 1) of the crossing of the positive x axis that lies farthest out."""
    y, next_y = polygons[..., 1], following[..., 1]
    meets = (y > 0) != (next_y > 0)
    fraction = torch.where(meets, y / torch.where(meets, y - next_y, torch.ones_like(y)), torch.zeros_like(y))
    x = polygons[..., 0] + fraction * (following[..., 0] - polygons[..., 0])
    edge = torch.where(meets, x, torch.full_like(x, -math.inf)).argmax(dim=1, keepdim=True)
    return (begin + fraction * length).gather(1, edge)


def condition(polygons: Tensor, layout: ConditionLayout, shift: Tensor | None = None) -> Tensor:
    """Describe normalised polygons (B, L, 2) to the network: (B, layout.width), scaled to about unit variance."""
    points = contour_points(polygons, layout.contour_points, shift).flatten(1)
    radius = outer_radius(polygons, layout.rays)
    return torch.cat([points / 0.4, (radius - 0.56) / 0.1], dim=1)


#: Two standard deviations of the phase that structured designs show in their own sheet's pose (7.6 degrees).
UPRIGHT_WITHIN = math.radians(15.0)


def square_pose(polygons: Tensor) -> Tensor:
    """Angle by which a target is turned away from upright, and which is taken back before the network sees it.

    Fields know their sheet's pose, drawings come in any.  Silhouettes of square sheets are square-like within a few
    degrees, so a target that already stands so is left alone (its exact pose is information) and any other is turned
    to stand square.  Quarter turns need no choice: even x even grids have them as an exact symmetry.

    Parameters
    ----------
    polygons : (B, L, 2) tensor
        Unit area about the centroid.

    Returns
    -------
    angle : (B,) tensor, radians
        0 where the target stands upright.
    """
    phase = square_phase(polygons)
    return torch.where(phase.abs() <= UPRIGHT_WITHIN, torch.zeros_like(phase), phase)
