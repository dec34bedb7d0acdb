"""How short the travel between open cuts can be at best: the Held-Karp bound, which no order of cutting beats.

A tour through N cuts is a spanning tree of N + 1 things, the start and the cuts, joined by N moves, in which every end
of a cut meets exactly one move (the last end a free one, here a move of no length to a place "home").  Without the
condition on the ends the shortest tree is found exactly; a price on every end, changed until ends with several moves
get dear, brings the tree near a tour.  Whatever the prices, the priced tree less the prices is no longer than the
shortest tour.  (Held and Karp, The traveling-salesman problem and minimum spanning trees, 1970 and 1971.)
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import minimum_spanning_tree
from scipy.spatial import cKDTree

from kirigami_studio.lattice.ratio_field import FloatArray
from kirigami_studio.lattice.topology import IntArray

#: Moves to so many nearest ends are priced while prices are sought; the bound itself looks at all moves.
NEIGHBOURS = 12
ROUNDS = 300


def travel_bound(lines: FloatArray, start: FloatArray, known_mm: float) -> float:
    """Return a length (mm) that no travel through all cuts falls below.

    Parameters
    ----------
    lines : (N, 2, 2) float, mm
        Both ends of every cut; each may be cut in either direction.
    start : (2,) float, mm
    known_mm : float
        Length of some tour; sets the step by which prices change.
    """
    places = np.concatenate([lines.reshape(-1, 2), start[None]])
    price = np.zeros(len(places) + 1)
    near = _near_moves(places)
    best, best_price, step = -np.inf, price, 1.0
    for round_ in range(ROUNDS):
        bound, degree = _priced_tree(places, near, price)
        if bound > best:
            best, best_price = bound, price.copy()
        wrong = degree - 1.0
        if not np.any(wrong):
            break
        step = 1.0 * 0.985**round_
        price = price + step * max(known_mm - bound, 0.01 * known_mm) / float(wrong @ wrong) * wrong
    count = len(places)
    first, second = np.triu_indices(count, 1)
    return _priced_tree(places, np.stack([first, second]), best_price)[0]


def _near_moves(places: FloatArray) -> IntArray:
    """Pairs (2, M) of an end and one of its nearest others."""
    found = cKDTree(places).query(places, k=min(NEIGHBOURS + 1, len(places)))[1]
    pairs = np.stack([np.repeat(np.arange(len(places)), found.shape[1]), found.ravel()])
    return np.unique(np.sort(pairs[:, pairs[0] != pairs[1]], axis=0), axis=1)


def _priced_tree(places: FloatArray, moves: IntArray, price: FloatArray) -> tuple[float, npt.NDArray[np.float64]]:
    """Bound of these prices, and how many moves of the tree meet every end."""
    count = len(places)
    home = np.stack([np.arange(count - 1), np.full(count - 1, count)])
    first, second = np.concatenate([moves, home], axis=1)
    length = np.linalg.norm(places[moves[0]] - places[moves[1]], axis=1)
    cost = np.concatenate([length, np.zeros(count - 1)]) + price[first] + price[second]
    # Ends 2 k and 2 k + 1 are one cut; then comes the start, then home.
    one, two = first // 2, np.where(second == count, count // 2 + 1, second // 2)
    kept = one != two
    first, second, cost, one, two = first[kept], second[kept], cost[kept], one[kept], two[kept]
    # Of several moves between the same two things the tree takes the cheapest.
    order = np.lexsort((cost, two, one))
    keys = one[order] * (count + 2) + two[order]
    chosen = order[np.concatenate([[True], keys[1:] != keys[:-1]])]
    lowest = float(cost[chosen].min())
    shifted = cost[chosen] - lowest + 1.0  # the sparse form would drop moves of no cost
    things = count // 2 + 2
    tree = minimum_spanning_tree(coo_array((shifted, (one[chosen], two[chosen])), shape=(things, things)).tocsr())
    row, column = tree.tocoo().coords
    at = {(int(a), int(b)): int(k) for a, b, k in zip(one[chosen], two[chosen], chosen, strict=True)}
    used = np.array([at[(int(a), int(b))] for a, b in zip(row, column, strict=True)])
    degree = np.bincount(np.concatenate([first[used], second[used]]), minlength=count + 1).astype(np.float64)
    return float(cost[used].sum() - price.sum()), degree
