"""Targets for losses on whole samples: silhouettes of random fields and drawn shapes, in any pose.

Such a loss looks at what comes out of the sampler and needs no field that made the target, so it can also learn from
drawings, and from poses that no sheet was in.  Some targets arrive as a picture brings them: filled into pixels, turned
by any angle and traced again as a file is read.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
import torch
from torch import Tensor

from kirigami_studio.evaluate.silhouette import RasterFrame, rasterise
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.generator.conditioning import contour_points, normalised, square_pose, turned
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.generator.velocity import Code, Network, joined
from kirigami_studio.lab.training.drawn_shapes import SMALLEST_COMPACTNESS, drawn_shape
from kirigami_studio.lattice.symmetry import Symmetry
from kirigami_studio.outlines.editing import resampled
from kirigami_studio.outlines.pieces import rings_of
from kirigami_studio.outlines.trace import trace

#: Points of drawn shapes, at equal arc length.
DRAWN_POINTS = 256
#: Fewest and most pixels of a picture along its longer side.
PIXELS = 48, 256


def drawn_polygons(count: int, seed: int) -> Tensor:
    """Shapes that people would draw, as polygons of equally many points: (count, L, 2)."""
    shapes = [resampled(drawn_shape(seed, number), DRAWN_POINTS) for number in range(count)]
    return torch.tensor(np.stack(shapes), dtype=torch.float32)


def symmetric_polygons(polygons: Tensor, symmetry: Symmetry) -> Tensor:
    """Each shape (N, L, 2) united with its images, where that is one compact shape: (N', L, 2), unit area."""
    moves = [move.matrix for move in symmetry.moves]
    found = []
    for points in polygons.cpu().double().numpy():
        images = [shapely.make_valid(shapely.Polygon(points @ move)) for move in (np.eye(2), *moves)]
        whole = shapely.union_all(images)
        if isinstance(whole, shapely.Polygon):
            whole = shapely.Polygon(whole.exterior)
            if 4.0 * math.pi * whole.area >= SMALLEST_COMPACTNESS * whole.length**2:
                ring = torch.tensor(shapely.get_coordinates(shapely.orient_polygons(whole))[:-1])
                found.append(contour_points(ring[None], polygons.shape[1])[0])
    return normalised(torch.stack(found)).to(polygons)


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
    traced = []
    for polygon, size, turn in zip(polygons.cpu().double().numpy(), sizes, chosen[1], strict=True):
        ring = torch.tensor(_redrawn(polygon, int(size), 2.0 * math.pi * float(turn)), dtype=torch.float32)
        traced.append(contour_points(normalised(ring[None]), count))
    return torch.cat(traced).to(polygons.device)


def _redrawn(polygon: FloatArray, size: int, angle: float) -> FloatArray:
    """One polygon (L, 2), turned, filled, traced and turned back; as it was where too little of it is left."""
    c, s = math.cos(angle), math.sin(angle)
    there = np.array([[c, s], [-s, c]])
    placed = polygon @ there
    frame = RasterFrame.around(placed, size)
    try:
        ring = rings_of(trace(np.where(rasterise(placed, size), 0.5, -0.5))[0])[0]
    except TargetError:
        return polygon
    corner = np.array([frame.left + 0.5 * frame.pixel, frame.top - (size - 0.5) * frame.pixel])
    area = 0.5 * np.sum(ring[:, 0] * np.roll(ring[:, 1], -1) - np.roll(ring[:, 0], -1) * ring[:, 1])
    points: FloatArray = (ring * frame.pixel + corner) @ there.T
    return points if area > 0 else points[::-1].copy()


#: Points of the target boundary that a loss measures against; the network sees fewer.
LOSS_POINTS = 384
#: Contour points of a target as it arrives, about a pixel apart on a mask of 128.
SEEN_POINTS = 384
#: Drawn shapes that are made symmetric, most of all.
SYMMETRIC_SHAPES = 2000
#: Shares of the rows that stand upright and in another quarter turn; the rest lie in any pose.
UPRIGHT, QUARTERS = 0.5, 0.25


@dataclass(frozen=True, slots=True)
class SampledTargets:
    """Some rows of a batch, as parts of equally many vertices.

    Attributes
    ----------
    seen : tuple of (B_i, L_i, 2) tensors
        As they arrive: contour points a little off.
    shifts : tuple of (B_i,) tensors
        How far their contours' starts are moved, in point spacings.
    loop : (B, 384, 2) tensor
        The undisturbed boundaries.
    """

    seen: tuple[Tensor, ...]
    shifts: tuple[Tensor, ...]
    loop: Tensor

    def code(self, network: Network, grid: DeployedGrid, preference: Tensor | None = None) -> Code:
        """The targets for a network and a sheet, with a preference (B,) for each where it takes one."""
        if preference is None:
            chosen: list[Tensor | None] = [None] * len(self.seen)
        else:
            chosen = list(torch.split(preference, [len(part) for part in self.seen]))
        return joined([network.code(*part, grid) for part in zip(self.seen, self.shifts, chosen, strict=True)])


class TargetSource:
    """Draws targets with the generator of a training run.

    Parameters
    ----------
    drawn : int
        How many drawn shapes to make; 0 for random fields only.
    seed : int
    vertex_noise : float
        Largest standard deviation of contour points, unit-area lengths.
    shift_noise : float
        Standard deviation of the contour's start, point spacings.
    pictured_share : float
        Share of the rows that arrive from a picture, see :func:`pictured`; the others with noise on their points.
    generator : torch.Generator
    device : torch.device
    """

    def __init__(
        self,
        drawn: int,
        seed: int,
        vertex_noise: float,
        shift_noise: float,
        pictured_share: float,
        generator: torch.Generator,
        device: torch.device,
    ) -> None:
        self.vertex_noise, self.shift_noise, self.pictured_share = vertex_noise, shift_noise, pictured_share
        self.generator, self.device = generator, device
        self.drawn = normalised(drawn_polygons(drawn, seed)).to(device) if drawn else None
        self._pools: dict[Symmetry, Tensor] = {}

    def targets(self, silhouettes: Tensor, drawn: int, symmetry: Symmetry | None = None) -> SampledTargets:
        """All of ``silhouettes`` (B, L, 2), unit area about the centroid, and ``drawn`` drawn shapes, if any.

        Where a ``symmetry`` is named, the silhouettes have it as they lie, and drawn shapes are made to.
        """
        pools = [silhouettes]
        if self.drawn is not None and drawn:
            pool = self.drawn if symmetry is None else self._symmetric(symmetry)
            pools.append(pool[self._indices(len(pool), drawn)])
        clean = [self._posed(pool) if symmetry is None else self._turned(pool, symmetry) for pool in pools]
        return self._as_seen(clean)

    def lying(self, polygons: Tensor, turn_noise: float) -> SampledTargets:
        """``polygons`` (B, L, 2) as they lie, but for a turn of this standard deviation (radians)."""
        return self._as_seen([turned(polygons, turn_noise * self._normal(polygons.shape[:1]))])

    def _as_seen(self, clean: Sequence[Tensor]) -> SampledTargets:
        return SampledTargets(
            tuple(self._disturbed(part) for part in clean),
            tuple(self.shift_noise * self._normal(part.shape[:1]) for part in clean),
            torch.cat([contour_points(part, LOSS_POINTS) for part in clean]),
        )

    def _disturbed(self, polygons: Tensor) -> Tensor:
        """As a hand draws them, with a noise of its own size on every outline, or as they are read from a picture."""
        points = contour_points(polygons, SEEN_POINTS)
        scale = self.vertex_noise * self._uniform(len(points))
        points = points + scale[:, None, None] * self._normal(points.shape)
        read = self._uniform(len(points)) < self.pictured_share
        if bool(read.any()):
            points[read] = pictured(polygons[read], SEEN_POINTS, self.generator)
        return points

    def _posed(self, polygons: Tensor) -> Tensor:
        """As candidates see a target: upright, in another quarter turn, or in any pose."""
        upright = turned(polygons, -square_pose(polygons))
        kind, angle = self._uniform(len(polygons)), 2 * math.pi * self._uniform(len(polygons))
        quarter = (angle / (0.5 * math.pi)).floor() * (0.5 * math.pi)
        other = torch.where(kind < UPRIGHT + QUARTERS, quarter, angle)
        return turned(upright, torch.where(kind < UPRIGHT, torch.zeros_like(angle), other))

    def _symmetric(self, symmetry: Symmetry) -> Tensor:
        """The pool of drawn shapes of a symmetry, made when it is first asked for."""
        assert self.drawn is not None
        if symmetry not in self._pools:
            self._pools[symmetry] = symmetric_polygons(self.drawn[:SYMMETRIC_SHAPES], symmetry)
        return self._pools[symmetry]

    def _turned(self, polygons: Tensor, symmetry: Symmetry) -> Tensor:
        """As candidates that keep a symmetry see a target: either way up along an axis, in any pose about a centre."""
        if not symmetry.mirrors:
            return self._posed(polygons)
        other = 0.5 * math.pi if symmetry is Symmetry.TWO_MIRRORS else math.pi
        return turned(polygons, other * (self._uniform(len(polygons)) < 0.5))

    def _indices(self, size: int, count: int) -> Tensor:
        return torch.randint(size, (count,), generator=self.generator, device=self.device)

    def _uniform(self, count: int) -> Tensor:
        return torch.rand(count, generator=self.generator, device=self.device)

    def _normal(self, shape: torch.Size) -> Tensor:
        return torch.randn(shape, generator=self.generator, device=self.device)
