"""Where bows and tips of centred connectors come too near to each other or to other cuts, and what parts them.

Conditions along one slit are in ``making_room``.  Here are those across a panel: two cuts that meet at a sharp angle
leave a wedge between them, into which the bow on one of them reaches towards the other cut or the bow on that; a tip
comes near the outline or the next cut.  For circles of radius BULGE_SPANS R around bows and points for tips, no two may
be nearer than a span R, and none nearer than that to a straight cut.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from kirigami_studio.fabricate.centres import BULGE_SPANS
from kirigami_studio.fabricate.connectors import directions
from kirigami_studio.fabricate.slits import SHEET_EDGE, CutTable
from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray

#: A bow is the part of its circle within this cosine of the direction away from its connector.
BOW_COSINE = 1.0 - 0.5 / BULGE_SPANS
#: What is farther apart than it has to be by so many spans is left out.
NEAR_SPANS = 1.5


@dataclass(frozen=True, slots=True, eq=False)
class SparseJacobian:
    """By how much lengths fall, or angles, as nodes move: each is a sum of shares of what a few nodes move."""

    nodes: IntArray  #: (K, M)
    shares: FloatArray  #: (K, M, 2); of the moves of those nodes in x and y

    def along(self, slopes: FloatArray) -> FloatArray:
        """The falls (K, V) where the nodes move by ``slopes`` (2, N, V)."""
        (count, width), (_, total, columns) = self.nodes.shape, slopes.shape
        rows = np.repeat(np.arange(count), 2 * width)
        places = (self.nodes[:, :, None] + [0, total]).ravel()
        table = csr_array((self.shares.ravel(), (rows, places)), shape=(count, 2 * total))
        falls: FloatArray = table @ slopes.reshape(2 * total, columns)
        return falls

    def times(self, factor: FloatArray) -> SparseJacobian:
        """Every fall times its factor (K,)."""
        return SparseJacobian(self.nodes, factor[:, None, None] * self.shares)

    def taken(self, which: IntArray) -> SparseJacobian:
        """Those of these numbers."""
        return SparseJacobian(self.nodes[which], self.shares[which])

    def beside(self, other: SparseJacobian) -> SparseJacobian:
        """The sums of as many falls and these."""
        return SparseJacobian(np.hstack([self.nodes, other.nodes]), np.hstack([self.shares, other.shares]))

    def then(self, other: SparseJacobian) -> SparseJacobian:
        """These falls and others after them."""
        width = max(self.nodes.shape[1], other.nodes.shape[1])
        one, two = self._as_wide(width), other._as_wide(width)
        return SparseJacobian(np.concatenate([one.nodes, two.nodes]), np.concatenate([one.shares, two.shares]))

    def _as_wide(self, width: int) -> SparseJacobian:
        """The same falls with nodes without a share, (K, width)."""
        more = width - self.nodes.shape[1]
        return SparseJacobian(np.pad(self.nodes, ((0, 0), (0, more))), np.pad(self.shares, ((0, 0), (0, more), (0, 0))))


@dataclass(frozen=True, slots=True, eq=False)
class Clearances:
    """The distances of one design that are short or nearly so."""

    missing: FloatArray  #: (K,), mm; by how much each is too short; negative where there is room
    falls: SparseJacobian  #: by how much that falls (K,) as nodes move


class _Features:
    """Circles of bows, then tips, of all hinges with a connector, and how they move with the nodes."""

    def __init__(self, nodes: FloatArray, table: CutTable, spans: FloatArray, rim: FloatArray) -> None:
        self.hinge = np.tile(np.flatnonzero(spans > 0.0), 2)
        count = self.hinge.size // 2
        self.bow = np.arange(2 * count) < count
        span = spans[self.hinge]
        self.radius = np.where(self.bow, BULGE_SPANS * span, 0.0)
        self.cut, self.through = table.hinge_cut[self.hinge], table.hinge_through[self.hinge]
        own = np.where(self.through == SHEET_EDGE, self.cut, self.through)
        inner = self.through != SHEET_EDGE
        run = nodes[table.ends[own, 1]] - nodes[table.ends[own, 0]]
        along = np.where(inner[:, None], directions(nodes[table.ends])[own], rim[self.hinge])
        self.normal = np.stack([-along[:, 1], along[:, 0]], axis=1)
        node = table.hinge_node[self.hinge]
        far = nodes[table.ends[self.cut, 1 - table.hinge_end[self.hinge]]] - nodes[node]
        self.normal *= np.sign(np.sum(self.normal * far, axis=1))[:, None]
        off = np.where(self.bow, (BULGE_SPANS - 0.5) * span, 0.5 * span)
        self.place = nodes[node] + off[:, None] * self.normal
        # The normal turns with the cut that the hinge rests on.
        lever = np.where(inner, off / np.linalg.norm(run, axis=1), 0.0)[:, None, None]
        turned = -lever * along[:, :, None] * self.normal[:, None, :]
        self.nodes = np.stack([node, table.ends[own, 1], table.ends[own, 0]], axis=1)
        self.moves = np.stack([np.broadcast_to(np.eye(2), turned.shape), turned, -turned], axis=1)

    def reaches(self, feature: IntArray, heading: FloatArray) -> BoolArray:
        """Whether a feature's own part of its circle lies that way (K, 2)."""
        towards = -np.sum(self.normal[feature] * heading, axis=1)
        reached: BoolArray = ~self.bow[feature] | (towards > BOW_COSINE)
        return reached

    def shares(self, feature: IntArray, heading: FloatArray) -> FloatArray:
        """How the place of a feature along headings (K, 2) moves with its nodes: (K, 3, 2)."""
        found: FloatArray = np.einsum("kd,kndx->knx", heading, self.moves[feature])
        return found


def clearances(
    nodes: FloatArray, table: CutTable, spans: FloatArray, rim: FloatArray, outline: IntArray, spare_mm: float
) -> Clearances:
    """Find what comes too near to what across a panel, or nearly so.

    Parameters
    ----------
    nodes : (N, 2) float, mm
        Of the flat sheet.
    spans : (H,) float, mm
        Finished widths and kerf, 0 for hinges without a connector.
    rim : (H, 2) float
        Unit vectors along the sheet's edge, for the hinges on it.
    outline : (L,) int
        Nodes of the sheet's outline in order.
    spare_mm : float
        By how much more than a span things are to be apart.
    """
    features = _Features(nodes, table, spans, rim)
    if not features.hinge.size:
        return Clearances(np.empty(0), SparseJacobian(np.empty((0, 6), dtype=np.intp), np.empty((0, 6, 2))))
    least = float(spans[spans > 0.0].min())
    parts = [_pairs(features, least, spare_mm), _lines(features, nodes, table, outline, least, spare_mm)]
    missing, numbers, shares = (np.concatenate(column) for column in zip(*parts, strict=True))
    return Clearances(missing, SparseJacobian(numbers, shares))


#: What is missing (K,), nodes (K, 6) and the shares (K, 6, 2) of their moves in the distance.
_Rows = tuple[FloatArray, IntArray, FloatArray]


def _pairs(features: _Features, least: float, spare_mm: float) -> _Rows:
    """Features of different cuts that face each other."""
    largest = float(features.radius.max())
    found = cKDTree(features.place).query_pairs(2.0 * largest + (1.0 + NEAR_SPANS) * least, output_type="ndarray")
    one, other = found.reshape(-1, 2).T
    cut, through, other_cut, other_through = (
        values[which] for which in (one, other) for values in (features.cut, features.through)
    )
    apart = (cut != other_cut) & (cut != other_through) & (through != other_cut)
    apart &= (through != other_through) | (through == SHEET_EDGE)
    one, other = one[apart], other[apart]
    between = features.place[one] - features.place[other]
    distance = np.linalg.norm(between, axis=1)
    heading = between / np.maximum(distance, spare_mm)[:, None]
    missing = features.radius[one] + features.radius[other] + least + spare_mm - distance
    kept = (missing > -NEAR_SPANS * least) & features.reaches(one, -heading) & features.reaches(other, heading)
    one, other, heading = one[kept], other[kept], heading[kept]
    shares = np.concatenate([features.shares(one, heading), -features.shares(other, heading)], axis=1)
    return missing[kept], np.concatenate([features.nodes[one], features.nodes[other]], axis=1), shares


def _lines(
    features: _Features, nodes: FloatArray, table: CutTable, outline: IntArray, least: float, spare_mm: float
) -> _Rows:
    """Features and straight cuts or sides of the sheet beside them."""
    ends = np.concatenate([table.ends, np.stack([outline, np.roll(outline, -1)], axis=1)])
    largest = float(features.radius.max()) + (1.0 + NEAR_SPANS) * least
    tree = shapely.STRtree(shapely.linestrings(nodes[ends]))
    one, line = tree.query(shapely.points(features.place), "dwithin", largest)
    through = features.through[one]
    side = line >= table.cut_count
    own = (line == features.cut[one]) | (line == through) | (side & (through == SHEET_EDGE))
    # An edge cut begins at the outline.
    own |= side & (features.cut[one] >= table.slit_count)
    facing = np.zeros_like(own)
    for end in (0, 1):
        rests = np.full(table.cut_count + outline.size, SHEET_EDGE - 1)
        of_end = table.hinge_end == end
        rests[table.hinge_cut[of_end]] = table.hinge_through[of_end]
        facing |= (rests[line] == through) & (through != SHEET_EDGE)
    one, line = one[~own & ~facing], line[~own & ~facing]
    start, run = nodes[ends[line, 0]], nodes[ends[line, 1]] - nodes[ends[line, 0]]
    length = np.linalg.norm(run, axis=1)
    away = features.place[one] - start
    share = np.sum(away * run, axis=1) / np.maximum(length, spare_mm) ** 2
    distance = np.linalg.norm(away - share[:, None] * run, axis=1)
    heading = (away - share[:, None] * run) / np.maximum(distance, spare_mm)[:, None]
    missing = features.radius[one] + least + spare_mm - distance
    margin = np.where(line >= table.cut_count, 0.0, least)
    beside = (share * length >= margin) & ((1.0 - share) * length >= margin)
    kept = beside & (missing > -NEAR_SPANS * least) & features.reaches(one, -heading)
    one, line, heading, share = one[kept], line[kept], heading[kept], share[kept]
    weights = np.stack([1.0 - share, share, np.zeros_like(share)], axis=1)
    shares = np.concatenate([features.shares(one, heading), -weights[:, :, None] * heading[:, None]], axis=1)
    numbers = np.concatenate([features.nodes[one], ends[line], ends[line, :1]], axis=1)
    return missing[kept], numbers, shares
