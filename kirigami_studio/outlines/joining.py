"""Loose lines -> closed regions: ends that meet are joined, small gaps bridged, open contours refused."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import number, tr_n

#: Ends nearer than this share of the drawing's size are one point: the rounding of coordinates in a file.
SAME_END = 1e-6


#: More places where lines may cross, or lie near each other, are a scribble: finding them takes minutes and gigabytes.
MOST_CROSSINGS, MOST_NEAR = 200_000, 2_000_000
MOST_VERTICES = 200_000
#: Pieces of lines that stand for all of them when crossings are estimated.
SAMPLED = 400


#: Gaps of an open contour are looked for up to this share of the drawing's size.
WIDEST_OPENING = 0.2


class Gap(NamedTuple):
    """Two loose ends: their distance and the point midway, in source units."""

    width: float
    x: float
    y: float


@dataclass(frozen=True, slots=True, eq=False)
class Joined:
    """Lines after their ends were joined."""

    lines: BaseGeometry  #: all of them, bridges too, cut where they meet; source units
    bridged: list[Gap]  #: gaps that were closed
    size: float  #: source units; the longer side of all lines


def joined(chains: Sequence[FloatArray], widest_gap: float) -> Joined:
    """Join the ends of lines and close small gaps.

    Raises
    ------
    TargetError
        There are no lines.
    """
    chains = [chain for chain in chains if len(chain) >= 2 and np.ptp(chain, axis=0).any()]
    if not chains:
        raise TargetError("lines.none")
    corners = np.concatenate(chains)
    size = float(np.max(np.ptp(corners, axis=0)))
    chains, loose = _meeting(chains, SAME_END * size)
    gaps = _gaps(loose)
    bridged = [gap for gap in gaps if gap.length <= widest_gap * size]
    lines = shapely.unary_union([*(LineString(chain) for chain in chains), *bridged])
    return Joined(lines, [_described(gap) for gap in bridged], size)


def opening(chains: Sequence[FloatArray], size: float) -> Gap:
    """The widest gap between ends of lines (P, 2) that meet no other; of no width without one."""
    _, loose = _meeting([chain for chain in chains if np.ptp(chain, axis=0).any()], SAME_END * size)
    gaps = _gaps(loose)
    return _described(max(gaps, key=lambda gap: float(gap.length))) if gaps else Gap(0.0, 0.0, 0.0)


def held(chains: Sequence[FloatArray], inside: BaseGeometry, size: float) -> Gap | None:
    """The widest gap of lines that surround something once their nearest ends are joined.

    Parameters
    ----------
    chains : sequence of (P, 2) float, source units
    inside : shapely geometry, source units
        All of this has to lie in the contour.
    size : float, source units
        Of the drawing.
    """
    chains, loose = _meeting([chain for chain in chains if np.ptp(chain, axis=0).any()], SAME_END * size)
    bridges = [gap for gap in _gaps(loose) if gap.length <= WIDEST_OPENING * size]
    if not bridges:
        return None
    lines = shapely.unary_union([*(LineString(chain) for chain in chains), *bridges])
    contour = shapely.unary_union(shapely.get_parts(shapely.polygonize([lines])))
    shells = [Polygon(piece.exterior) for piece in shapely.get_parts(contour) if isinstance(piece, Polygon)]
    around = [piece for piece in shells if piece.contains_properly(inside)]
    gaps = [gap for gap in bridges if any(piece.boundary.intersects(gap) for piece in around)]
    return _described(max(gaps, key=lambda gap: float(gap.length))) if gaps else None


def closed_gaps(net: Joined, unit: str) -> list[str]:
    """A sentence on the gaps that were closed, if there are any."""
    if not net.bridged:
        return []
    widest = max(net.bridged)
    return [
        tr_n(
            "A gap was closed: {width} near ({x:.4g}, {y:.4g}).",
            "{count} gaps were closed, the widest {width} near ({x:.4g}, {y:.4g}).",
            len(net.bridged),
            width=_length(widest.width, unit),
            x=widest.x,
            y=widest.y,
        )
    ]


def refuse_scribbles(chains: Sequence[FloatArray]) -> None:
    """Refuse lines that are so many, or cross each other so often, that nothing could be made of them.

    Raises
    ------
    TargetError
        They are, by a sample of their pieces.
    """
    if (vertices := sum(len(chain) for chain in chains)) > MOST_VERTICES:
        raise TargetError("drawing.too_many_vertices", vertices=vertices, limit=MOST_VERTICES)
    starts = [chain[:-1] for chain in chains if len(chain) > 1]
    if sum(len(start) for start in starts) < SAMPLED:
        return
    ends = np.concatenate([chain[1:] for chain in chains if len(chain) > 1])
    begins = np.concatenate(starts)
    low, high = np.minimum(begins, ends), np.maximum(begins, ends)
    picked = np.linspace(0, len(low) - 1, SAMPLED).astype(int)
    met = near = 0
    for index in picked.tolist():
        meets = np.all((low <= high[index]) & (high >= low[index]), axis=1)
        one, other = begins[index], ends[index]
        along, off, far = other - one, begins[meets] - one, ends[meets] - one
        sides = (along[0] * off[:, 1] - along[1] * off[:, 0]) * (along[0] * far[:, 1] - along[1] * far[:, 0])
        near += int(np.sum(meets))
        met += int(np.sum(sides < 0))
    pairs = len(low) / (2 * SAMPLED)
    if met * pairs > MOST_CROSSINGS or near * pairs > MOST_NEAR:
        raise TargetError("contour.too_many_crossings", limit=MOST_CROSSINGS)


def _meeting(chains: Sequence[FloatArray], tolerance: float) -> tuple[list[FloatArray], FloatArray]:
    """Make ends within ``tolerance`` coincide; return the chains and the ends that meet no other, (E, 2)."""
    ends = np.array([(chain[0], chain[-1]) for chain in chains]).reshape(-1, 2)
    pairs = cKDTree(ends).query_pairs(tolerance, output_type="ndarray")
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(ends), len(ends)))
    count, group = connected_components(links, directed=False)
    members = np.bincount(group, minlength=count)
    centre = np.column_stack([np.bincount(group, ends[:, axis], count) / members for axis in (0, 1)])
    met = centre[group].reshape(-1, 2, 2)
    joined = [np.concatenate([[first], chain[1:-1], [last]]) for chain, (first, last) in zip(chains, met, strict=True)]
    return joined, ends[members[group] == 1]


def _gaps(loose: FloatArray) -> list[LineString]:
    """Bridges between loose ends, each end used once, nearest pairs first."""
    if len(loose) < 2:
        return []
    neighbours = min(len(loose), 6)
    distance, partner = (np.asarray(found) for found in cKDTree(loose).query(loose, k=neighbours))
    order = np.argsort(distance, axis=None)
    used: set[int] = set()
    bridges = []
    for one, other in zip((order // neighbours).tolist(), partner.ravel()[order].tolist(), strict=True):
        if one != other and one not in used and other not in used:
            used |= {one, other}
            bridges.append(LineString(loose[[one, other]]))
    return bridges


def _described(bridge: LineString) -> Gap:
    middle = bridge.interpolate(0.5, normalized=True)
    return Gap(bridge.length, middle.x, middle.y)


def open_contour(gaps: Sequence[Gap], bridged: float, unit: str) -> TargetError:
    """The problem of an open contour: its widest gap, and the width up to which gaps are closed."""
    if not gaps:
        return TargetError("lines.not_closed")
    gap = max(gaps)
    return TargetError("lines.open_at", width=_length(gap.width, unit), x=gap.x, y=gap.y, closed=_length(bridged, unit))


def _length(length: float, unit: str) -> str:
    """A length with its unit, as far as that is known."""
    return f"{number(length, '.4g')} {unit}".strip()
