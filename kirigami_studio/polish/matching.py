"""Which place of the layout's outline belongs to which place of the target's boundary, both ways, and its weight."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.sparse import csr_matrix

from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lattice.deployment import ZIPPED_BELOW
from kirigami_studio.lattice.topology import topology
from kirigami_studio.polish.boundary_target import NORMAL_LENGTH, BoundaryTarget, normals_of, unit_normals

#: Where on each layout edge distances are taken.
EDGE_SHARES = np.array([1 / 6, 1 / 2, 5 / 6])

#: Boundary length that an outer hinge stands for, as a share of the mean outline edge's.
HINGE_SHARE = 0.5

#: The same of a vertex of a sheet that starts as another shape than a rectangle.  Horns at corners are short edges far
#: out, which the match hardly counts: from a circle to a square, 12 x 12, the longest falls from 0.040 to 0.007
#: unit-area lengths at an exact IoU of 0.993 instead of 0.995, from a circle to a star from 0.081 to 0.034 at 0.968
#: instead of 0.962; with a share of 0.5 to 0.035 and 0.052.
TIP_SHARE = 2.0


@dataclass(frozen=True, slots=True, eq=False)
class Matching:
    """Residuals of one outline (L, 2), the 3 L outward ones first, then one for each target sample.

    Each sits on a layout edge, between vertex ``edge`` and the next one, ``share`` of the way.
    """

    edge: IntArray  #: (R,)
    share: FloatArray  #: (R,)
    gap: FloatArray  #: (R, 2), unit-area lengths; from the place on the target to the place on the layout
    distance: FloatArray  #: (R,); lengths of ``gap``
    weight: FloatArray  #: (R,); boundary length that each residual stands for

    def cost(self, trust: float) -> float:
        """Sum of the residuals, each counted linearly beyond the distance ``trust`` (unit-area lengths)."""
        return float((self.weight * _robust(self.distance, trust)).sum())

    def slope(self, outline: FloatArray, trust: float) -> FloatArray:
        """Derivative (2 L,) of the cost by the vertices of the outline (L, 2) that was matched."""
        force = 2.0 * self.weight * self.distance / np.sqrt(1.0 + np.square(self.distance / trust))
        slope: FloatArray = self.pull(force, len(outline)) + self._stretching(outline, trust)
        return slope

    def curvature(self, count: int, trust: float) -> csr_matrix:
        """Gauss-Newton second derivative of the cost by the vertices: (2 count, 2 count), sparse."""
        return self.spread(2.0 * self.weight / np.sqrt(1.0 + np.square(self.distance / trust)), count)

    def _stretching(self, outline: FloatArray, trust: float) -> FloatArray:
        """Derivative (2 L,) of the cost by vertices through the edge lengths that weight the outward distances."""
        edge = np.concatenate([outline[1:], outline[:1]]) - outline
        length = np.maximum(np.hypot(edge[:, 0], edge[:, 1]), 1e-12)
        outward = slice(0, len(outline) * EDGE_SHARES.size)
        cost = (self.weight[outward] * _robust(self.distance[outward], trust)).reshape(len(outline), -1)
        pull = (cost.sum(axis=1) / np.square(length))[:, None] * edge
        slope: FloatArray = (np.concatenate([pull[-1:], pull[:-1]]) - pull).ravel()
        return slope

    def pull(self, force: FloatArray, count: int) -> FloatArray:
        """Derivative (2 count,) by the outline's vertices, x and y in turn, from that by the distances (R,)."""
        along = (force / np.maximum(self.distance, 1e-12))[:, None] * self.gap
        later = along * self.share[:, None]
        along -= later
        edge = np.concatenate([self.edge, self.edge + 1])
        pull = np.empty((count, 2))
        for axis in (0, 1):
            each = np.bincount(edge, np.concatenate([along[:, axis], later[:, axis]]), count + 1)
            each[0] += each[count]
            pull[:, axis] = each[:count]
        return pull.ravel()

    def spread(self, stiffness: FloatArray, count: int) -> csr_matrix:
        """Second derivative (2 count, 2 count), sparse, by the vertices from that by distances (R,).

        A vertex and its two neighbours move a distance.
        """
        stiff = stiffness / np.square(np.maximum(self.distance, 1e-12))
        x, y, share, rest = self.gap[:, 0], self.gap[:, 1], self.share, 1.0 - self.share
        # By edge, the squares xx, xy, yy at its start, then of start and end together, then at its end.
        squares = np.empty((3, len(stiff)))
        squares[0], squares[2] = stiff * x, stiff * y
        np.multiply(squares[0], y, out=squares[1])
        squares[0] *= x
        squares[2] *= y
        parts = np.empty((3, 3, len(stiff)))
        for number, weight in enumerate((rest * rest, rest * share, share * share)):
            np.multiply(weight, squares, out=parts[number])
        place = np.arange(9)[:, None] * count + self.edge
        first, both, last = np.bincount(place.ravel(), parts.ravel(), 9 * count).reshape(3, 3, count)[:, [0, 1, 1, 2]]
        blocks = np.empty((count, 2, 3, 2))
        before = np.arange(-1, count - 1)
        for number, block in enumerate((both[:, before], first + last[:, before], both)):
            blocks[:, :, number] = block.T.reshape(count, 2, 2)
        column, start = _neighbouring(count)
        return csr_matrix((blocks.ravel(), column, start), shape=(2 * count, 2 * count))


@lru_cache(maxsize=64)
def _neighbouring(count: int) -> tuple[IntArray, IntArray]:
    """Columns of the coordinates of each vertex of a closed polygon and of its neighbours.

    For both rows of a vertex, and where each row begins.
    """
    vertex = (np.arange(count)[:, None] + np.arange(-1, 2)) % count
    columns = (2 * vertex[:, :, None] + np.arange(2)).reshape(count, 1, 6)
    return np.repeat(columns, 2, axis=1).ravel().astype(np.int32), np.arange(0, 12 * count + 1, 6, dtype=np.int32)


def _robust(distance: FloatArray, trust: float) -> FloatArray:
    """Squared distance near the target, linear far from it (pseudo-Huber), with derivative 2 d / sqrt(1 + (d/c)^2)."""
    cost: FloatArray = 2.0 * trust**2 * (np.sqrt(1.0 + np.square(distance / trust)) - 1.0)
    return cost


def matched(outline: FloatArray, target: BoundaryTarget) -> Matching:
    """Match an outline (L, 2), counter-clockwise, with the target in whose frame it lies."""
    count = len(outline)
    edges = outline[np.arange(1, count + 1) % count] - outline
    length = np.hypot(edges[:, 0], edges[:, 1])
    normals = normals_of(edges, length)
    edge, share = _places_on_edges(count)
    points = outline[edge] + share[:, None] * edges[edge]
    back_edge, back_share, back = _nearest_on(outline, edges, normals, target)
    gap = np.concatenate([points - target.nearest(points, normals[edge]), back])
    return Matching(
        edge=np.concatenate([edge, back_edge]),
        share=np.concatenate([share, back_share]),
        gap=gap,
        distance=np.hypot(gap[:, 0], gap[:, 1]),
        weight=np.concatenate([(length / EDGE_SHARES.size)[edge], np.full(len(back), target.weight)]),
    )


@lru_cache(maxsize=64)
def _places_on_edges(count: int) -> tuple[IntArray, FloatArray]:
    """Edge and share of all places on an outline where distances are taken: (3 count,) each."""
    return np.repeat(np.arange(count), EDGE_SHARES.size), np.tile(EDGE_SHARES, count)


def _nearest_on(
    start: FloatArray, edges: FloatArray, normals: FloatArray, target: BoundaryTarget
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Closest place that looks the same way on the polyline, for each target sample: edge, share, vector to it."""
    samples = target.samples
    squared = np.maximum(np.square(edges).sum(axis=1), 1e-24)
    # Along each edge, then the squared distance less what is the same for all edges of a sample.
    along = samples @ edges.T
    along -= (start * edges).sum(axis=1)
    share = along / squared
    np.clip(share, 0.0, 1.0, out=share)
    away = share * squared
    along *= 2.0
    away -= along
    away *= share
    away += np.square(start).sum(axis=1)
    places = np.concatenate([start, NORMAL_LENGTH**2 * normals], axis=1)
    away -= 2.0 * (np.concatenate([samples, target.normals], axis=1) @ places.T)
    edge = away.argmin(axis=1)
    share = share[np.arange(len(samples)), edge]
    return edge, share, start[edge] + share[:, None] * edges[edge] - samples


@dataclass(frozen=True, slots=True, eq=False)
class OneSided:
    """Weights of places outside the target: little before trimming, much at horns."""

    excess: float  #: 0..1; weight of what sticks out of the target, relative to what is missed
    vertices: BoolArray  #: (L,); outline vertices where sticking out costs beside that
    share: float = HINGE_SHARE  #: Boundary length that each of them stands for, of the mean outline edge's

    @classmethod
    def trimmed(cls, excess: float, rows: int, columns: int, phi: float) -> OneSided:
        """That of a layout that will be trimmed, but for its outer hinges."""
        return cls(excess, outer_hinges(rows, columns, phi))

    @classmethod
    def without_horns(cls, rows: int, columns: int, phi: float) -> OneSided:
        """That of a layout whose tips do not stick out far."""
        return cls(1.0, np.ones_like(outer_hinges(rows, columns, phi)), TIP_SHARE)

    def weighed(self, matching: Matching, outline: FloatArray, target: BoundaryTarget) -> Matching:
        """The same matches with these weights, and one more at each of the vertices."""
        normals = unit_normals(outline)
        out = np.einsum("rk,rk->r", matching.gap, normals[matching.edge]) > 0.0
        vertex = np.flatnonzero(self.vertices)
        # A vertex looks half way between its two edges.
        looks = normals[vertex] + normals[vertex - 1]
        looks /= np.maximum(np.hypot(*looks.T), 1e-12)[:, None]
        gap = outline[vertex] - target.nearest(outline[vertex], looks)
        boundary = target.weight * len(target.samples)
        beyond = np.einsum("hk,hk->h", gap, looks) > 0.0
        return replace(
            matching,
            edge=np.concatenate([matching.edge, vertex]),
            share=np.concatenate([matching.share, np.zeros(len(vertex))]),
            gap=np.concatenate([matching.gap, gap]),
            distance=np.concatenate([matching.distance, np.hypot(*gap.T)]),
            weight=np.concatenate(
                [
                    matching.weight * np.where(out, self.excess, 1.0),
                    self.share * boundary / len(outline) * beyond,
                ]
            ),
        )


def outer_hinges(rows: int, columns: int, phi: float) -> BoolArray:
    """Which vertices of the outline at ``phi`` are hinges, where two panels meet: (L,) bool."""
    tables = topology(rows, columns)
    hinges = np.concatenate([tables.h[1:-1].ravel(), tables.v[:, 1:-1].ravel()])
    loop = tables.outline_at_zero if phi < ZIPPED_BELOW else tables.outline_nodes
    return np.isin(loop, hinges)


def check_excess(excess: float) -> float:
    """The weight of what sticks out, checked.

    Raises
    ------
    UsageError
        Not a number from 0 to 1.
    """
    if not 0.0 <= excess <= 1.0:
        raise UsageError("fit.excess_out_of_range", excess=excess)
    return float(excess)
