"""How short the travel between open cuts can be at best: the Held-Karp bound, which no order of cutting beats.

A tour through N cuts is a spanning tree of N + 2 things, the start, the cuts and a place "home", joined by N + 1 moves
in which the start, home and every end of a cut meet exactly one move; moves to home have no length, since a tour may
end anywhere.  Without the condition on the ends the shortest tree is found exactly.  A price on every end, raised where
several moves meet and lowered where none does, brings the tree near a tour.  Whatever the prices, the priced tree less
all prices is no longer than the shortest tour.  (Held and Karp, The traveling-salesman problem and minimum spanning
trees, 1970 and 1971.)
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import minimum_spanning_tree
from scipy.spatial import cKDTree

from kirigami_studio.foundation.arrays import FloatArray, IntArray

#: Moves to so many nearest ends are priced while prices are sought; the bound itself looks at all moves.
NEIGHBOURS = 12
ROUNDS = 400
#: Share of the missing length by which prices change: at first, and from one round to the next.
FIRST_STEP, STEP_FACTOR = 1.0, 0.99


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
    near = _near_moves(places)
    price = np.zeros(len(places) + 1)
    best, best_price = -np.inf, price
    for round_ in range(ROUNDS):
        bound, degree = _priced_tree(places, near, price)
        if bound > best:
            best, best_price = bound, price
        wrong = degree - 1.0
        if not np.any(wrong):
            break
        step = FIRST_STEP * STEP_FACTOR**round_ * max(known_mm - bound, 0.01 * known_mm)
        price = price + step / float(wrong @ wrong) * wrong
    return _priced_tree(places, np.stack(np.triu_indices(len(places), 1)), best_price)[0]


def _near_moves(places: FloatArray) -> IntArray:
    """Pairs (2, M) of an end and one of its nearest others."""
    found = cKDTree(places).query(places, k=min(NEIGHBOURS + 1, len(places)))[1]
    pairs = np.stack([np.repeat(np.arange(len(places)), found.shape[1]), found.ravel()])
    return np.unique(np.sort(pairs[:, pairs[0] != pairs[1]], axis=0), axis=1)


def _priced_tree(places: FloatArray, moves: IntArray, price: FloatArray) -> tuple[float, FloatArray]:
    """Bound of these prices, and how many moves of the tree meet every end, the start and home."""
    home = len(places)
    first = np.concatenate([moves[0], np.arange(home - 1)])
    second = np.concatenate([moves[1], np.full(home - 1, home)])
    length = np.concatenate([np.linalg.norm(places[moves[0]] - places[moves[1]], axis=1), np.zeros(home - 1)])
    # Ends 2 k and 2 k + 1 are one cut; then come the start and home.
    thing = np.append(np.arange(home) // 2, home // 2 + 1)
    kept = thing[first] != thing[second]
    first, second = first[kept], second[kept]
    cost = length[kept] + price[first] + price[second]
    # Of several moves between the same two things the tree takes the cheapest.
    key = thing[first] * len(thing) + thing[second]
    order = np.lexsort((cost, key))
    chosen = order[np.concatenate([[True], np.diff(key[order]) > 0])]
    one, two = thing[first[chosen]], thing[second[chosen]]
    above_zero = cost[chosen] - cost[chosen].min() + 1.0  # the sparse form would drop a move of no cost
    size = int(thing[-1]) + 1
    tree = minimum_spanning_tree(coo_array((above_zero, (one, two)), shape=(size, size)).tocsr()).tocoo()
    used = chosen[np.searchsorted(key[chosen], tree.coords[0].astype(np.int64) * len(thing) + tree.coords[1])]
    ends = np.concatenate([first[used], second[used]])
    return float(cost[used].sum() - price.sum()), np.bincount(ends, minlength=home + 1).astype(np.float64)
