"""How the outlines of many designs move when their ratios change: exact derivatives by one adjoint sweep each.

With A P = b, changing the ratio of one void touches the two rows of the nodes that rest on its slit, so
dP = A^-1 g with g_f = x ln 10 / (1 + x)^2 (P[first end] - P[second end]) per unit of z = log10 x.  The outline is a
constant matrix times P: one transposed sweep with the outline's rows gives all derivatives, at any angle.
"""

from __future__ import annotations

import math

import numpy as np
import torch
from torch import Tensor

from kirigami_studio.lattice.batched import BatchedLattice, block_sweep, deployed
from kirigami_studio.lattice.compact import barycentric_stencil

LN10 = math.log(10.0)


class BatchedSlopes:
    """Outline and derivative of batches of fields on one grid.

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

    def __call__(self, z: Tensor, phi: float | Tensor = 0.0) -> tuple[Tensor, Tensor]:
        """Decode and differentiate.

        Parameters
        ----------
        z : (B, m, n) tensor, log10 of ratios
        phi : float or (B,) tensor, radians

        Returns
        -------
        outline : (B, L, 2) tensor, unit cells
        slopes : (B, L, 2, m * n) tensor
            Derivative of the outline by z.
        """
        lattice = self.lattice
        ratio = torch.pow(10.0, z)
        weight = lattice._weights(ratio)
        nodes = lattice._complete(lattice._sweep(weight), weight)
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
        slopes = moved.view(len(z), 2, 2, -1, self.count).sum(dim=2)
        return deployed(even, whole - even, phi), slopes.permute(0, 3, 1, 2)

    def _adjoint(self, weight: Tensor) -> Tensor:
        """Outline rows times A^-1, on the free nodes void by void: (B, K, 2 L)."""
        lattice, batch = self.lattice, weight.shape[0]
        m, width = lattice.rows, lattice.columns + 1
        to_h, to_v = self._carry(weight, self._v_on_h), self._carry(weight, self._h_on_v)
        seen = self._reach_h + self._reach_v @ to_h
        coupling = lattice._coupling(weight)
        none = weight.new_zeros(batch, 1, width, width)
        before = torch.cat([none, coupling[:, 1, :-1].mT], dim=1)
        after = torch.cat([coupling[:, 0, 1:].mT, none], dim=1)
        through_h = block_sweep(before, after, seen.mT.reshape(batch, m, width, -1)).flatten(1, 2)
        through_v = self._reach_v.mT + to_v @ through_h
        return torch.cat([through_h, through_v], dim=1).index_select(1, self._free)

    def _carry(self, weight: Tensor, table: tuple[Tensor, Tensor]) -> Tensor:
        """Stencil weights as matrices (B, V, H): how free v nodes and h rows rest on each other."""
        entry, slot = table
        flat = weight.new_zeros(weight.shape[0], len(self._v_numbers) * self._h_count)
        return flat.index_copy(1, slot, weight[:, entry]).view(-1, len(self._v_numbers), self._h_count)

    def _build_tables(self) -> None:
        lattice = self.lattice
        node, ends, void = barycentric_stencil(lattice.rows, lattice.columns)
        h_numbers = lattice.tables.h[1:-1].ravel()
        h_place = {int(number): k for k, number in enumerate(h_numbers)}
        v_numbers = [int(number) for number in node if int(number) not in h_place]
        v_place = {number: k for k, number in enumerate(v_numbers)}
        self._h_count, self._v_numbers = len(h_numbers), v_numbers
        on_h: list[tuple[int, int]] = []
        on_v: list[tuple[int, int]] = []
        for k, number in enumerate(node):
            for side, end in enumerate(ends[k]):
                if int(number) in v_place and int(end) in h_place:
                    on_h.append((2 * k + side, v_place[int(number)] * self._h_count + h_place[int(end)]))
                if int(number) in h_place and int(end) in v_place:
                    on_v.append((2 * k + side, v_place[int(end)] * self._h_count + h_place[int(number)]))
        self._v_on_h, self._h_on_v = self._table(on_h), self._table(on_v)
        place = np.array([h_place[int(k)] if int(k) in h_place else self._h_count + v_place[int(k)] for k in node])
        # The two free nodes of each void: all first ones, then all second ones.
        pair = np.argsort(void, kind="stable").reshape(-1, 2).T.ravel()
        self._free = lattice._index(place[pair])
        self._first, self._second = lattice._index(ends[pair, 0]), lattice._index(ends[pair, 1])
        self._reach_h = self._reach[:, lattice._index(h_numbers)]
        self._reach_v = self._reach[:, lattice._index(np.array(v_numbers))]

    def _table(self, entries: list[tuple[int, int]]) -> tuple[Tensor, Tensor]:
        pairs = np.array(entries).reshape(-1, 2)
        return self.lattice._index(pairs[:, 0]), self.lattice._index(pairs[:, 1])
