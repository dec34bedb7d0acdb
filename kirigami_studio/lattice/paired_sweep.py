"""Block-tridiagonal systems of half-rank couplings, solved for many designs in torch.

Two neighbours in a row of h nodes rest on one v node before and on one after, and these on two neighbours of the next
row each.  So rows of w unknowns see each other through w / 2 sums only; the block Thomas algorithm solves for these,
O(m (w / 2)^3); it needs no pivoting between blocks, as the system is an M-matrix.  Blocks of at most 32 x 32 stay clear
of the batched dense solve that stalls in torch 2.13 for n > 150 with two MKL threads.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import torch
from torch import Tensor
from torch.nn.functional import pad

from kirigami_studio.foundation.arrays import IntArray


def paired_sweep(coupling: Tensor, right: Tensor, first: int = 0) -> Tensor:
    """Solve h_i = E_i F_i h_{i-1} + G_i H_i h_{i+1} + right_i by the block Thomas algorithm.

    For row i columns are paired, from the first or from the second on, by turns.  F_i and H_i add up the two of a pair,
    weighted, in the row before and the one after; E_i and G_i give the sum to the same two columns of row i, weighted
    as well.  The unknowns of the sweep are the sums.

    Parameters
    ----------
    coupling : (B, 4, m, w) tensor
        Weights of columns in E, F, G and H; 0 in E_0, F_0, G_{m-1} and H_{m-1}.
    right : (B, m, w, R) tensor
    first : 0 or 1
        Column that pairs of row 0 begin with.

    Returns
    -------
    h : (B, m, w, R) tensor
    """
    batch, rows, width, count = right.shape
    tables = _pair_tables(rows, width, first, right.device)
    pairs = width // 2
    dense, offsets = _of_pairs(coupling, right, tables)
    # F h of the row before, from H h of this row for it: what each adds, then the offset.
    before = torch.cat([dense[:, 0, 1, 1], offsets[:, 0, 1]], dim=-1)
    identity = torch.eye(pairs, dtype=right.dtype, device=right.device)
    passed: list[Tensor] = []
    solved: list[Tensor] = []
    for i in range(1, rows):
        passed.append(before)
        both = dense[:, i, 0].flatten(1, 2) @ before
        offset = both[..., pairs:] + offsets[:, i].flatten(1, 2)
        factors, pivots, _ = torch.linalg.lu_factor_ex(identity - both[:, :pairs, :pairs])
        known = torch.cat([dense[:, i, 1, 0], offset[:, :pairs]], dim=-1)
        solved.append(torch.linalg.lu_solve(factors, pivots, known))
        rest = torch.cat([dense[:, i, 1, 1], offset[:, pairs:]], dim=-1)
        before = torch.baddbmm(rest, both[:, pairs:, :pairs], solved[-1])
    none = right.new_zeros(batch, pairs, count)
    of_before, of_after = [none], [none]
    for transfer in solved[::-1]:
        of_after.append(torch.baddbmm(transfer[..., pairs:], transfer[..., :pairs], of_after[-1]))
    of_after.reverse()
    for transfer, after in zip(passed, of_after, strict=False):
        of_before.append(torch.baddbmm(transfer[..., pairs:], transfer[..., :pairs], after))
    sums = torch.stack([*of_before, *of_after, none], dim=1).flatten(1, 2)
    shares = coupling[:, ::2].reshape(batch, 2, rows, width, 1)
    given = sums.index_select(1, tables.spread).view(batch, 2, rows, width, count)
    return right + (shares * given).sum(dim=1)


def transposed(coupling: Tensor) -> Tensor:
    """Weights (B, 4, m, w) of the transposed system; its row 0 begins with the other column."""
    to_before, of_before, to_after, of_after = coupling.unbind(1)
    return torch.stack([of_after.roll(1, 1), to_after.roll(1, 1), of_before.roll(-1, 1), to_before.roll(-1, 1)], dim=1)


@dataclass(frozen=True, slots=True)
class _PairTables:
    """Places of the columns and pairs of ``paired_sweep`` in flat tensors.

    Attributes
    ----------
    products : (m * 2 * 2 * K * K) tensor
        By row, E or G, H or F, sum in the row beside, sum in this one: the product of weights that carries one to the
        other, or the 0 behind all products.
    weights, columns : (2 * m * 2 * K) tensors
        The two columns of a pair, by row and H or F: their weights, or the 0 behind, and places.
    spread : (2 * m * w) tensor
        The sum that a column is given, by E or G.
    """

    products: Tensor
    weights: Tensor
    columns: Tensor
    spread: Tensor


@lru_cache(maxsize=32)
def _pair_tables(rows: int, width: int, first: int, device: torch.device) -> _PairTables:
    pairs, size, none = width // 2, rows * width, -1
    row, column = np.arange(rows)[:, None], np.arange(width)

    def pair_of(begin: IntArray) -> IntArray:
        pair = np.where(column < begin, none, (column - begin) // 2)
        return np.where(pair < (width - begin) // 2, pair, none)

    begin = (first + row) % 2
    own, beside = pair_of(begin), pair_of(1 - begin)
    products = np.full((rows, 2, 2, pairs, pairs), 4 * size)
    i, j = np.nonzero((own != none) & (beside != none))
    products[i, :, :, beside[i, j], own[i, j]] = (size * np.arange(4).reshape(2, 2)) + (i * width + j)[:, None, None]
    one = 1 - begin + 2 * np.arange(pairs)
    both = np.stack([one, one + 1])
    places = np.where(both[1] < width, row * width + both, 2 * size)[:, :, None]
    weights = np.where(places < size, places + size * np.arange(2)[:, None], 2 * size)
    columns = np.broadcast_to(np.where(places < size, places, 0), weights.shape)
    spread = np.maximum(row * pairs + own, 0) + rows * pairs * np.arange(2)[:, None, None]
    # Tables made under inference_mode could not be used in training afterwards.
    with torch.inference_mode(False):
        return _PairTables(*(torch.tensor(t.ravel(), device=device) for t in (products, weights, columns, spread)))


def _of_pairs(coupling: Tensor, right: Tensor, tables: _PairTables) -> tuple[Tensor, Tensor]:
    """Sums H_{i-1} and F_{i+1} of row i: their dependence on E_i and G_i, and their offsets.

    Returns (B, m, 2, 2, K, K), by E or G and by H or F, and (B, m, 2, K, R).
    """
    batch, rows, width, count = right.shape
    pairs = width // 2
    of = torch.stack([coupling[:, 3].roll(1, 1), coupling[:, 1].roll(-1, 1)], dim=1)
    products = pad((coupling[:, ::2, None] * of[:, None]).flatten(1), (0, 1))
    dense = products.index_select(1, tables.products).view(batch, rows, 2, 2, pairs, pairs)
    weights = pad(of.flatten(1), (0, 1)).index_select(1, tables.weights)
    columns = right.flatten(1, 2).index_select(1, tables.columns)
    one, other = (weights[..., None] * columns).view(batch, 2, rows, 2, pairs, count).unbind(1)
    return dense, one + other
