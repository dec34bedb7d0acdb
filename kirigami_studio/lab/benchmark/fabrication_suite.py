"""From designs to cut files: how long it takes, what the orders of cutting travel, and whether the sheets hold.

All designs are random fields of ratios between 10^-spread and 10^spread, drawn with a given seed.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import minimum_spanning_tree
from scipy.spatial import cKDTree

from kirigami_studio.export.dxf import dxf_bytes
from kirigami_studio.export.profile import DEFAULT_PROFILE, find_profile
from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.cut_path import CutPath, Layer
from kirigami_studio.fabricate.cut_plan import CutPlan, plan_cuts
from kirigami_studio.fabricate.options import STRAIGHT, CutOrder
from kirigami_studio.fabricate.ordering import in_cutting_order
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.fabricate.timing import travel_lengths
from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.lattice.ratio_field import RatioField

TIMED_GRIDS = ((10, 10), (24, 24))
ORDERED_GRIDS = ((12, 12), (20, 20), (25, 24))
#: Sheet width (mm) of what is timed and ordered, and how far its ratios spread.
WIDTH_MM, SPREADS = 300.0, (0.3, 0.7)
REPEATS = 3
#: A connector counts as off above this difference (mm).
OFF_MM = 1e-3

Report = Callable[[int, int], None]


def measure_fabrication(designs: int, seed: int, report: Report) -> dict[str, object]:
    """Run all parts of the suite.

    Parameters
    ----------
    designs : int
        Random designs that are planned and checked.
    seed : int
    report : callable
        Gets the designs done and their number.
    """
    return {
        "seconds": [_stage_seconds(grid, seed) for grid in TIMED_GRIDS],
        "orders": [_order_figures(grid, spread, seed) for grid in ORDERED_GRIDS for spread in SPREADS],
        "random_designs": check_designs(designs, seed, report),
    }


def random_design(grid: tuple[int, int], spread: float, seed: int) -> Deployment:
    """The exact layout of a random field."""
    return deploy(RatioField.from_log10(np.random.default_rng(seed).uniform(-spread, spread, grid)))


def _stage_seconds(grid: tuple[int, int], seed: int) -> dict[str, object]:
    """Seconds for plan, check and DXF, the best of a few runs each."""
    design = random_design(grid, SPREADS[1], seed)
    plan = plan_cuts(design, WIDTH_MM)
    profile = find_profile(DEFAULT_PROFILE)
    return {
        "grid": f"{grid[0]}x{grid[1]}",
        "plan": _best_seconds(lambda: plan_cuts(design, WIDTH_MM)),
        "check": _best_seconds(lambda: check_plan(plan)),
        "dxf": _best_seconds(lambda: dxf_bytes(plan, "R2010", profile)),
    }


def _best_seconds(work: Callable[[], object]) -> float:
    seconds = []
    for _ in range(REPEATS):
        began = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - began)
    return min(seconds)


def _order_figures(grid: tuple[int, int], spread: float, seed: int) -> dict[str, object]:
    """Travel and time of every order on one design, and how short the travel between its slits can be at best."""
    design = random_design(grid, spread, seed)
    plans = {order: plan_cuts(design, WIDTH_MM, options=replace(STRAIGHT, order=order)) for order in CutOrder}
    rows = plans[CutOrder.ROWS]
    table = cut_table(*grid)
    slits = rows.on_layer(Layer.SLITS)
    rows_mm = _slit_travel(rows)
    shortest_mm = _slit_travel(plans[CutOrder.SHORTEST])
    ends = np.array([path.points[[0, -1]] for path in slits])
    return {
        "grid": f"{grid[0]}x{grid[1]}",
        "spread": spread,
        "orders": {
            order.value: {
                "travel_mm": plan.travel_mm,
                "to_rows": plan.travel_mm / rows.travel_mm,
                "slits_to_rows": _slit_travel(plan) / rows_mm,
                "job_seconds": plan.times.total,
                "ordering_seconds": _best_seconds(
                    lambda plan=plan, order=order: in_cutting_order(plan.paths, order, table)  # type: ignore[misc]
                ),
            }
            for order, plan in plans.items()
        },
        "slits": {
            "rows_mm": rows_mm,
            "rows_all_one_way_mm": _one_way_travel(slits),
            "shortest_mm": shortest_mm,
            "no_order_below_mm": travel_bound(ends, np.zeros(2), shortest_mm),
        },
    }


def _slit_travel(plan: CutPlan) -> float:
    """Travel from the origin through the slits, mm."""
    return float(travel_lengths(plan.on_layer(Layer.SLITS)).sum())


def _one_way_travel(slits: tuple[CutPath, ...]) -> float:
    """Travel through slits in this order, every one cut from its left or lower end, mm."""
    turned = [_from_left(path.points[[0, -1]]) for path in slits]
    exits = np.concatenate([np.zeros((1, 2)), np.array([ends[1] for ends in turned])[:-1]])
    return float(np.linalg.norm(np.array([ends[0] for ends in turned]) - exits, axis=1).sum())


def _from_left(ends: FloatArray) -> FloatArray:
    return ends if tuple(ends[0]) <= tuple(ends[1]) else ends[::-1]


@dataclass(slots=True)
class _Tally:
    """What is counted over many designs."""

    planned: int = 0
    refused: int = 0
    connectors: int = 0
    wider: int = 0
    narrower_mm: float = 0.0
    wider_mm: float = 0.0
    off_where_not_wider_mm: float = 0.0
    overlap_mm: float = 0.0
    most_pieces: int = 0


def check_designs(count: int, seed: int, report: Report) -> dict[str, object]:
    """Plan and check random designs of 4 to 12 cells a side, with random widths, kerfs and connectors.

    Returns
    -------
    figures : dict
        ``narrower_mm`` and ``wider_mm`` are the largest differences between finished and requested connectors either
        way; connectors come out ``wider`` where the slit they rest on ends before them.
    """
    generator = np.random.default_rng(seed)
    tally = _Tally()
    for number in range(count):
        rows, columns = (int(size) for size in generator.integers(4, 13, 2))
        spread, width = float(generator.uniform(0.1, 1.0)), float(generator.uniform(60.0, 300.0))
        kerf, connector = float(generator.uniform(0.0, 0.2)), float(generator.uniform(0.1, 0.8))
        design = random_design((rows, columns), spread, int(generator.integers(2**31)))
        try:
            plan = plan_cuts(design, width, connector, kerf)
        except FabricationError:
            tally.refused += 1
        else:
            _count(tally, plan)
        report(number + 1, count)
    return {name: getattr(tally, name) for name in tally.__slots__}


def _count(tally: _Tally, plan: CutPlan) -> None:
    off = plan.hinges.finished_mm - plan.hinges.requested_mm
    found = check_plan(plan)
    tally.planned += 1
    tally.connectors += len(off)
    tally.wider += int(np.sum(off > OFF_MM))
    tally.narrower_mm = max(tally.narrower_mm, float(-off.min()))
    tally.wider_mm = max(tally.wider_mm, float(off.max()))
    tally.off_where_not_wider_mm = max(tally.off_where_not_wider_mm, float(np.abs(off[off <= OFF_MM]).max(initial=0.0)))
    tally.overlap_mm = max(tally.overlap_mm, found.overlap_mm)
    tally.most_pieces = max(tally.most_pieces, found.pieces)


#: Moves to so many nearest ends are priced while prices are sought; the bound itself looks at all moves.
NEIGHBOURS = 12
ROUNDS = 400
#: Share of the missing length by which prices change: at first, and from one round to the next.
FIRST_STEP, STEP_FACTOR = 1.0, 0.99


def travel_bound(lines: FloatArray, start: FloatArray, known_mm: float) -> float:
    """Return a length (mm) that no travel through all cuts falls below: the Held-Karp bound.

    A tour through N cuts is a spanning tree of N + 2 things, the start, the cuts and a place "home", joined by N + 1
    moves in which the start, home and every end of a cut meet exactly one move; moves to home have no length, since a
    tour may end anywhere.  Without the condition on the ends the shortest tree is found exactly.  A price on every end,
    raised where several moves meet and lowered where none does, brings the tree near a tour.  Whatever the prices, the
    priced tree less all prices is no longer than the shortest tour.  (Held and Karp, The traveling-salesman problem and
    minimum spanning trees, 1970 and 1971.)

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
