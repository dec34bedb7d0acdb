"""Many designs at once in torch: block-tridiagonal barycentric solve, exact derivative.

Eliminating the v family of nodes leaves one block row per row of h nodes,

    h_i = L_i h_{i-1} + U_i h_{i+1} + c_i,        L_i, U_i : (n+1) x (n+1), two entries a row,

which ``paired_sweep`` solves.

:class:`BatchedLattice` decodes and lets gradients through; :class:`BatchedSlopes` gives the whole derivative of the
outline by an adjoint sweep, as ``polish.sensitivity`` does for one design.  Both take rim offsets: the given nodes are
linear in them.  The flat sheet is the rectangle of unit cells.
"""

from __future__ import annotations

import math

import numpy as np
import torch
from torch import Tensor

from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.foundation.errors import RatioError, SheetError
from kirigami_studio.lattice.compact import barycentric_stencil
from kirigami_studio.lattice.deployment import even_part_of_outline
from kirigami_studio.lattice.paired_sweep import paired_sweep, transposed
from kirigami_studio.lattice.sheet import RimPath, rim_table
from kirigami_studio.lattice.topology import topology

LN10 = math.log(10.0)


class BatchedLattice:
    """Decoder of one grid size for batches of ratio fields and, where they are given, rims.

    Parameters
    ----------
    rows, columns : int
        Voids each way, 2..64.
    device : torch.device or str
    dtype : torch.dtype
        float64 for checks, float32 for training (error about 5e-6 at 10 x 10).
    """

    def __init__(
        self, rows: int, columns: int, device: torch.device | str = "cpu", dtype: torch.dtype = torch.float32
    ) -> None:
        self.tables = topology(rows, columns)
        self.rows, self.columns = rows, columns
        self.device, self.dtype = torch.device(device), dtype
        self._build_stencil()
        self._build_rim()
        self._build_outline()

    def compact(self, ratio: Tensor, offsets: Tensor | None = None) -> Tensor:
        """Compact node positions.

        Parameters
        ----------
        ratio : (B, m, n) tensor, > 0
        offsets : (B, R) tensor, optional, unit cells
            How far the mouths are from their even places, in the order of ``sheet.rim_table``; none for an even rim.

        Returns
        -------
        nodes : (B, N, 2) tensor, unit cells
            Numbered as in :class:`kirigami_studio.lattice.topology.Topology`.
        """
        weight = self._weights(ratio)
        given = self._given(offsets)
        return self._complete(self._sweep(weight, given), weight, given)

    def outline_parts(self, nodes: Tensor) -> tuple[Tensor, Tensor]:
        """U and V of the outline loop, (B, L, 2) each, L = 4 (m + n) + 4, for every angle.

        The outline at phi is ``R(-a) U + R(+a) V`` with 2a = pi - phi, see ``deployment``.
        """
        even = torch.einsum("ln,bnd->bld", self._even, nodes)
        whole = nodes[:, self._loop] - nodes[:, :1]
        return even, whole - even

    def outline(self, ratio: Tensor, phi: float | Tensor = 0.0, offsets: Tensor | None = None) -> Tensor:
        """Outline loop (B, L, 2), unit cells, at ``phi`` (number or (B,), radians).

        Select ``[:, self.unzipped]`` at phi = 0, where the edge hinges have zipped shut.
        """
        return deployed(*self.outline_parts(self.compact(ratio, offsets)), phi)

    def _given(self, offsets: Tensor | None) -> Tensor:
        """All nodes (1 or B, N, 2), of which those on the rim are where the offsets put them."""
        if offsets is None:
            return self._uniform[None]
        if offsets.ndim != 2 or offsets.shape[1] != self.mouths:
            raise SheetError("rim.wrong_batch_shape", mouths=self.mouths, shape=tuple(offsets.shape))
        moved = offsets.to(self.device, self.dtype) @ self._by_offset.flatten(1)
        return self._uniform + moved.view(len(offsets), -1, 2)

    def _sweep(self, weight: Tensor, given: Tensor) -> Tensor:
        """Positions of the h rows: (B, m, n + 1, 2)."""
        batch, width = len(weight), self.columns + 1
        known = weight.index_select(1, self._known_weight).view(batch, 2, -1, 1)
        places = given.index_select(1, self._known_node).view(len(given), 2, -1, 2)
        constant = (known * places).sum(dim=1).view(batch, self.rows, width, 2)
        return paired_sweep(self._coupling(weight), constant)

    def _coupling(self, weight: Tensor) -> Tensor:
        """Weights of ``paired_sweep``: (B, 4, m, n + 1)."""
        return weight.index_select(1, self._pair).view(-1, 4, self.rows, self.columns + 1)

    def _weights(self, ratio: Tensor) -> Tensor:
        """Stencil weights of designs (B, m, n), of first and second ends, 0 and 1: (B, 2 m n + 2)."""
        if ratio.ndim != 3 or tuple(ratio.shape[1:]) != (self.rows, self.columns):
            raise RatioError("ratios.wrong_batch_shape", rows=self.rows, columns=self.columns, shape=tuple(ratio.shape))
        x = ratio.to(self.device, self.dtype).flatten(1)
        second = 1 / (1 + x)
        return torch.cat([x * second, second, self._constants.expand(len(x), -1)], dim=1)

    def _complete(self, h: Tensor, weight: Tensor, given: Tensor) -> Tensor:
        """Add the edge nodes and the v family, which rests on the h family."""
        batch = h.shape[0]
        held = torch.cat([h.flatten(1, 2), given.index_select(1, self._rim).expand(batch, -1, -1)], dim=1)
        ends = held.index_select(1, self._v_ends).view(batch, 2, -1, 2)
        weights = weight.index_select(1, self._v_weight).view(batch, 2, -1, 1)
        return torch.cat([held, (weights * ends).sum(dim=1)], dim=1).index_select(1, self._place)

    def _build_stencil(self) -> None:
        tables, (rows, width), voids = self.tables, (self.rows, self.columns + 1), self.rows * self.columns
        node, ends, void = barycentric_stencil(self.rows, self.columns)
        none, whole = 2 * voids, 2 * voids + 1
        inner_h = tables.h[1:-1].ravel()
        weight = np.stack([void, void + voids], axis=1)
        stencil = {int(number): (ends[k], weight[k]) for k, number in enumerate(node)}
        place_of = {int(number): divmod(k, width) for k, number in enumerate(inner_h)}
        pair = np.full((4, rows, width), none)
        known_weight = np.full((2, rows, width), none)
        known_node = np.zeros_like(known_weight)
        for number, (row, column) in place_of.items():
            if number not in stencil:
                known_weight[0, row, column], known_node[0, row, column] = whole, number
                continue
            for side, (v_end, share) in enumerate(zip(*stencil[number], strict=True)):
                if int(v_end) not in stencil:
                    known_weight[side, row, column], known_node[side, row, column] = share, v_end
                    continue
                for h_end, part in zip(*stencil[int(v_end)], strict=True):
                    end_row, end_column = place_of[int(h_end)]
                    way = 0 if end_row < row else 2
                    pair[way, row, column] = share
                    pair[way + 1, row, end_column] = part
        free_v = np.array([k for k, number in enumerate(node) if int(number) not in place_of])
        # Nodes in the order h rows, rest of the rim, free v nodes: where each number of the topology stands.
        rim = np.setdiff1d(np.arange(tables.node_count), np.concatenate([inner_h, node[free_v]]))
        place = np.argsort(np.concatenate([inner_h, rim, node[free_v]]))
        self._pair = self._index(pair.ravel())
        self._known_weight, self._known_node = self._index(known_weight.ravel()), self._index(known_node.ravel())
        self._uniform = self._float(tables.uniform_nodes)
        self._constants = self._float(np.array([[0.0, 1.0]]))
        self._rim, self._place = self._index(rim), self._index(place)
        self._v_ends = self._index(place[ends[free_v]].T.ravel())
        self._v_weight = self._index(weight[free_v].T.ravel())

    def _build_rim(self) -> None:
        """How the given nodes follow each mouth: (R, N, 2)."""
        table = rim_table(self.rows, self.columns)
        along = RimPath(self.rows, self.columns).slopes(rim_table(self.rows, self.columns).even)
        self.mouths = table.mouths.size
        by_offset = np.zeros((self.mouths, self.tables.node_count, 2))
        by_offset[:, table.node] = table.share[:, table.mouths].T[..., None] * along[:, None]
        self._by_offset = self._float(by_offset)

    def _build_outline(self) -> None:
        """The constant matrix that maps compact nodes to U on the outline loop."""
        tables = self.tables
        loop = tables.outline_nodes
        self._even = self._float(even_part_of_outline(self.rows, self.columns))
        self._loop = self._index(loop)
        self.unzipped = self._index(np.flatnonzero(np.isin(loop, tables.outline_at_zero)))
        self.panel_nodes = self._index(tables.panel_nodes.reshape(-1, 4))

    def _index(self, values: IntArray) -> Tensor:
        return torch.tensor(values, dtype=torch.long, device=self.device)

    def _float(self, values: FloatArray) -> Tensor:
        return torch.tensor(values, dtype=self.dtype, device=self.device)


class BatchedSlopes:
    """Outline and derivative of batches of fields, and rims if given, on one grid.

    Parameters
    ----------
    lattice : BatchedLattice
    zipped : bool
        Leave out the edge hinges, which have zipped shut at phi = 0.
    """

    def __init__(self, lattice: BatchedLattice, zipped: bool) -> None:
        self.lattice = lattice
        loop = lattice.unzipped if zipped else torch.arange(len(lattice._loop), device=lattice.device)
        self.count = len(loop)
        whole = torch.zeros(self.count, lattice.tables.node_count, device=lattice.device, dtype=lattice.dtype)
        whole[torch.arange(self.count), lattice._loop[loop]] = 1.0
        whole[:, 0] -= 1.0
        self._reach = torch.cat([lattice._even[loop], whole])
        self._build_tables()

    def __call__(self, z: Tensor, phi: float | Tensor = 0.0, offsets: Tensor | None = None) -> tuple[Tensor, Tensor]:
        """Decode and differentiate.

        Parameters
        ----------
        z : (B, m, n) tensor, log10 of ratios
        phi : float or (B,) tensor, radians
        offsets : (B, R) tensor, optional, unit cells
            How far the mouths are from their even places.

        Returns
        -------
        outline : (B, L, 2) tensor, unit cells
        slopes : (B, L, 2, m * n) or (B, L, 2, m * n + R) tensor
            Derivative of the outline by z, then by the offsets where they are given.
        """
        lattice = self.lattice
        ratio = torch.pow(10.0, z)
        weight = lattice._weights(ratio)
        given = lattice._given(offsets)
        nodes = lattice._complete(lattice._sweep(weight, given), weight, given)
        even, whole = torch.split(self._reach @ nodes, self.count, dim=1)
        x = ratio.flatten(1).repeat(1, 2)
        pull = (x * LN10 / (1 + x).square())[..., None] * (nodes[:, self._first] - nodes[:, self._second])
        # A free node that moves by ``pull`` takes U and V along: their parts turn opposite ways.
        still = torch.zeros_like(pull)
        by_odd = deployed(still, pull, phi)
        by_even = deployed(pull, still, phi) - by_odd
        through_even, through_whole = torch.split(self._adjoint(weight), self.count, dim=2)
        moved = torch.stack(
            [
                torch.addcmul(through_even * by_even[:, :, None, axis], through_whole, by_odd[:, :, None, axis])
                for axis in (0, 1)
            ],
            dim=1,
        )
        slopes = moved.view(len(z), 2, 2, -1, self.count).sum(dim=2).permute(0, 3, 1, 2)
        if offsets is not None:
            slopes = torch.cat([slopes, self._by_offsets(x, through_even, through_whole, phi)], dim=-1)
        return deployed(even, whole - even, phi), slopes

    def _by_offsets(self, x: Tensor, through_even: Tensor, through_whole: Tensor, phi: float | Tensor) -> Tensor:
        """Derivative of the outline by rim offsets: (B, L, 2, R).

        A mouth takes given nodes along, and the free nodes that rest on them.
        """
        batch, moved = len(x), self.lattice._by_offset.permute(1, 0, 2)
        share = (x / (1 + x))[..., None, None]
        pull = share * moved[self._first] + (1 - share) * moved[self._second]
        still = (self._reach @ moved.flatten(1)).view(2, self.count, -1)
        even, whole = (
            (through.mT @ pull.flatten(2) + own).view(batch, -1, 2)
            for through, own in ((through_even, still[0]), (through_whole, still[1]))
        )
        return deployed(even, whole - even, phi).view(batch, self.count, -1, 2).mT

    def _adjoint(self, weight: Tensor) -> Tensor:
        """Outline rows times A^-1, on the free nodes void by void: (B, K, 2 L)."""
        lattice = self.lattice
        seen = self._reach_h + _carried(weight, self._v_on_h, self._reach_v[None])
        rows = seen.view(len(weight), lattice.rows, lattice.columns + 1, -1)
        through_h = paired_sweep(transposed(lattice._coupling(weight)), rows, first=1).flatten(1, 2)
        through_v = self._reach_v + _carried(weight, self._h_on_v, through_h)
        return torch.cat([through_h, through_v], dim=1).index_select(1, self._free)

    def _build_tables(self) -> None:
        lattice = self.lattice
        node, ends, void = barycentric_stencil(lattice.rows, lattice.columns)
        h_numbers = lattice.tables.h[1:-1].ravel()
        h_place = {int(number): k for k, number in enumerate(h_numbers)}
        v_numbers = [int(number) for number in node if int(number) not in h_place]
        v_place = {number: k for k, number in enumerate(v_numbers)}
        on_h: list[list[tuple[int, int]]] = [[] for _ in h_place]
        on_v: list[list[tuple[int, int]]] = [[] for _ in v_place]
        for number, resting, owner in zip(node, ends, void, strict=True):
            for end, share in zip(resting, (owner, owner + lattice.rows * lattice.columns), strict=True):
                if int(number) in v_place and int(end) in h_place:
                    on_h[h_place[int(end)]].append((v_place[int(number)], share))
                if int(number) in h_place and int(end) in v_place:
                    on_v[v_place[int(end)]].append((h_place[int(number)], share))
        self._v_on_h, self._h_on_v = self._table(on_h), self._table(on_v)
        place = np.array([h_place[int(k)] if int(k) in h_place else len(h_place) + v_place[int(k)] for k in node])
        # The two free nodes of each void: all first ones, then all second ones.
        pair = np.argsort(void, kind="stable").reshape(-1, 2).T.ravel()
        self._free = lattice._index(place[pair])
        self._first, self._second = lattice._index(ends[pair, 0]), lattice._index(ends[pair, 1])
        self._reach_h = self._reach[:, lattice._index(h_numbers)].T.contiguous()
        self._reach_v = self._reach[:, lattice._index(np.array(v_numbers))].T.contiguous()

    def _table(self, resting: list[list[tuple[int, int]]]) -> Tensor:
        """The two nodes that rest on each, and their weights: (2, 2, n), 0 of a lacking one."""
        lacking = (0, 2 * self.lattice.rows * self.lattice.columns)
        return self.lattice._index(np.array([[*nodes, lacking, lacking][:2] for nodes in resting]).transpose(2, 1, 0))


def _carried(weight: Tensor, table: Tensor, rows: Tensor) -> Tensor:
    """Rows (1 or B, ., R) of the nodes that rest on each of ``table``, weighted: (B, n, R)."""
    (one, other), (of_one, of_other) = table
    return torch.addcmul(
        weight.index_select(1, of_one)[..., None] * rows.index_select(1, one),
        weight.index_select(1, of_other)[..., None],
        rows.index_select(1, other),
    )


def deployed(even: Tensor, odd: Tensor, phi: float | Tensor) -> Tensor:
    """Combine parts U, V (B, L, 2) at ``phi`` (number or (B,), radians) into positions."""
    half = 0.5 * (math.pi - torch.as_tensor(phi, dtype=even.dtype, device=even.device)).reshape(-1, 1)
    c, s = torch.cos(half), torch.sin(half)
    total, spread = even + odd, even - odd
    return torch.stack([c * total[..., 0] + s * spread[..., 1], c * total[..., 1] - s * spread[..., 0]], dim=-1)
