"""The transport map of the inside: where the flat sheet's places belong in the target.

The same panels tile both compact states, so seen from afar a design is a map from the flat sheet to the target that
keeps areas.  The canonical one is the optimal transport (Monge) map between the two uniform densities: it needs no
nearest boundary point, which is where fits get stuck.  Each panel's centroid in the target state is pulled to the
image of its centroid in the flat sheet.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import shapely
from scipy.sparse import csr_matrix
from scipy.spatial import KDTree
from scipy.spatial.distance import cdist

from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import even_panel_part, rotate
from kirigami_studio.lattice.sheet import Sheet, anchor_points
from kirigami_studio.lattice.topology import topology
from kirigami_studio.outlines.outline import Outline

#: Points that stand for each of the two densities.
POINTS = 450
#: Neighbours over which the map is smoothed, by an affine fit, and places along each side of the table of the result.
NEIGHBOURS, TABULATED = 12, 33
#: The plastic number's powers spread points evenly over the square (R2 sequence).
SPREAD = np.array([0.7548776662466927, 0.5698402909980532])


def even_points(polygon: shapely.Polygon, count: int = POINTS) -> FloatArray:
    """Points (count, 2) spread evenly over a polygon."""
    low, high = np.array(polygon.bounds).reshape(2, 2)
    box = float(np.prod(high - low))
    tried = 0
    found = np.zeros((0, 2))
    shapely.prepare(polygon)
    while len(found) < count:
        wanted = max(64, math.ceil(1.2 * (count - len(found)) * box / polygon.area))
        places = np.modf(0.5 + np.arange(tried, tried + wanted)[:, None] * SPREAD)[0]
        points = low + places * (high - low)
        found = np.concatenate([found, points[shapely.contains_xy(polygon, points)]])
        tried += wanted
    return found[:count]


@dataclass(frozen=True, slots=True, eq=False)
class TransportMap:
    """Where places of the flat sheet belong in the target."""

    low: FloatArray  #: (2,), unit cells; the lower left corner of what holds the flat sheet
    step: FloatArray  #: (2,), unit cells; from one tabulated place to the next
    table: FloatArray  #: (T, T, 2), unit-area lengths; images of tabulated places, by x, then y, in the target's frame

    @classmethod
    def of(cls, sheet: Sheet, target: Outline, angle: float) -> TransportMap:
        """The map of a sheet's flat outline, turned by ``angle`` (radians) into the target's frame."""
        # Imported when it is needed: it takes long, and the window starts without it.
        from scipy.optimize import linear_sum_assignment

        flat = shapely.Polygon(anchor_points(sheet))
        source = even_points(flat)
        middle = shapely.get_coordinates(flat.centroid)[0]
        turned = rotate((source - middle) / math.sqrt(flat.area), angle)
        points = _target_points(target)
        _, order = linear_sum_assignment(cdist(turned, points, "sqeuclidean"))
        low, high = np.array(flat.bounds).reshape(2, 2)
        step = (high - low) / (TABULATED - 1)
        number = np.arange(TABULATED)
        places = low + step * np.stack(np.meshgrid(number, number, indexing="ij"), axis=-1)
        table = _smoothed(source, points[order], places.reshape(-1, 2))
        return cls(low, step, table.reshape(TABULATED, TABULATED, 2))

    def at(self, places: FloatArray) -> FloatArray:
        """Images (P, 2) of places (P, 2) of the flat sheet, between the four that are tabulated round each."""
        along = (places - self.low) / self.step
        first = np.clip(along.astype(np.intp), 0, TABULATED - 2)
        share = along - first
        x, y = share[:, :1], share[:, 1:]
        i, j = first.T
        lower = (1.0 - y) * self.table[i, j] + y * self.table[i, j + 1]
        upper = (1.0 - y) * self.table[i + 1, j] + y * self.table[i + 1, j + 1]
        images: FloatArray = lower + x * (upper - lower)
        return images


def _smoothed(source: FloatArray, image: FloatArray, places: FloatArray) -> FloatArray:
    """Images (P, 2) of ``places`` (P, 2), by an affine fit to those (Q, 2) of the nearest of points (Q, 2)."""
    found = KDTree(source).query(places, NEIGHBOURS)
    distance, near = np.asarray(found[0]), np.asarray(found[1])
    weight = np.exp(-2.0 * np.square(distance / distance[:, -1:]))[..., None]
    total = weight.sum(axis=1)
    source, image = source[near], image[near]
    here, there = (weight * source).sum(axis=1) / total, (weight * image).sum(axis=1) / total
    source, image = source - here[:, None], image - there[:, None]
    spread = np.einsum("pki,pkj->pij", weight * source, source) + 1e-9 * np.eye(2)
    together = np.einsum("pki,pkj->pij", weight * source, image)
    slope = np.linalg.solve(spread, together)
    images: FloatArray = there + np.einsum("pi,pij->pj", places - here, slope)
    return images


@lru_cache(maxsize=32)
def _target_points(target: Outline) -> FloatArray:
    return even_points(shapely.Polygon(target.points))


@lru_cache(maxsize=8)
def centroid_matrices(rows: int, columns: int) -> tuple[csr_matrix, csr_matrix]:
    """Sparse matrices (P, N) from compact nodes to panel centroids: of the flat sheet, and of U."""
    tables = topology(rows, columns)
    panels = tables.panel_nodes.reshape(-1, 4)
    flat = np.zeros((len(panels), tables.node_count))
    flat[np.arange(len(panels))[:, None], panels] = 0.25
    return csr_matrix(flat), csr_matrix(flat @ even_panel_part(np.eye(tables.node_count), tables))


class TransportTerm:
    """The term of one fit: mean squared distance between panel centroids and their images.

    Parameters
    ----------
    sheet : Sheet
    phi : float, radians
    transport : TransportMap
    """

    def __init__(self, sheet: Sheet, phi: float, transport: TransportMap) -> None:
        self._flat, self._even = centroid_matrices(*sheet.grid)
        self._half = 0.5 * (math.pi - phi)
        self._transport = transport

    def gaps(self, nodes: FloatArray, pose: Similarity) -> FloatArray:
        """From each image to its centroid: (P, 2), unit-area lengths."""
        return pose.apply(self.centroids(nodes)) - self._transport.at(self._flat @ nodes)

    def centroids(self, nodes: FloatArray) -> FloatArray:
        """Panel centroids (P, 2) of the deployed layout with compact ``nodes`` (N, 2), unit cells."""
        return self._deployed(*nodes.T).T

    def slopes(self, slopes: FloatArray) -> FloatArray:
        """Derivative (P, 2, S) of the centroids by variables that move the nodes by ``slopes`` (2, N, S)."""
        return np.moveaxis(self._deployed(*slopes), 0, 1)

    def _deployed(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Deployed centroids (2, P, ...), or their motions, from those (N, ...) of compact nodes."""
        c, s = math.cos(self._half), math.sin(self._half)
        whole_x, whole_y = self._flat @ x - x[0], self._flat @ y - y[0]
        # U + V is the whole: R(-a) U + R(a) V = cos a (U + V) + sin a J (V - U), J a quarter turn.
        apart_x, apart_y = 2.0 * (self._even @ x) - whole_x, 2.0 * (self._even @ y) - whole_y
        return np.stack([c * whole_x + s * apart_y, c * whole_y - s * apart_x])
