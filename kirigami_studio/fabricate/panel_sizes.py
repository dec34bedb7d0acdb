"""How small the panels of the finished sheet get: their edges and their necks.

A neck is the distance from a panel's corner to an edge that does not meet it (as in the fit's preference for large
panels).  Cuts along a panel's sides take half a kerf off each, so that a finished edge or neck is a kerf smaller than
between the centre lines.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import shapely
from shapely.geometry import Polygon

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import Deployment

#: Parts of a trimmed panel below this share of it are rounding.
PART_SHARE = 1e-3


@dataclass(frozen=True, slots=True)
class SmallPlace:
    """A size of a panel, and where."""

    size_mm: float
    where: tuple[float, float]  #: (x, y), mm


def panels_in_mm(
    deployment: Deployment, kept: Sequence[FloatArray | None], width_mm: float, origin: FloatArray
) -> tuple[FloatArray, ...]:
    """Panels of the compact sheet, trimmed where they are, row by row, in a frame that has ``origin`` (2,) at zero.

    Parameters
    ----------
    kept : sequence of (P, 2) float or None, unit cells
        What stays of every panel, no points where nothing does; empty for an untrimmed sheet.
    width_mm : float
        Width of the untrimmed sheet.
    origin : (2,) float, mm
    """
    corners = deployment.compact[deployment.topology.panel_nodes.reshape(-1, 4)]
    low, high = deployment.compact.min(axis=0), deployment.compact.max(axis=0)
    scale = width_mm / (high[0] - low[0])
    parts = kept or [None] * len(corners)
    panels = [(whole if part is None else part) - low for part, whole in zip(parts, corners, strict=True)]
    placed = tuple(panel * scale - origin for panel in panels)
    for panel in placed:
        panel.setflags(write=False)
    return placed


@dataclass(frozen=True, slots=True, eq=False)
class CutPanelSizes:
    """Sizes (K, S) of panels between the centre lines of their cuts, and the lines (K, S, 2, 2) that have them."""

    sizes: FloatArray
    lines: FloatArray


def edges_of(corners: FloatArray) -> CutPanelSizes:
    """The four edges of panels (K, 4, 2), in any unit."""
    lines = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2)
    return CutPanelSizes(np.linalg.norm(lines[:, :, 1] - lines[:, :, 0], axis=-1), lines)


def necks_of(corners: FloatArray) -> CutPanelSizes:
    """The eight necks of panels (K, 4, 2), in any unit: from each corner to the nearest place of both far edges."""
    corner = np.concatenate([corners, corners], axis=1)
    start = np.concatenate([np.roll(corners, -1, axis=1), np.roll(corners, -2, axis=1)], axis=1)
    stop = np.concatenate([np.roll(corners, -2, axis=1), np.roll(corners, -3, axis=1)], axis=1)
    run = stop - start
    squared = np.maximum(np.sum(run * run, axis=2), 1e-24)
    share = np.clip(np.sum((corner - start) * run, axis=2) / squared, 0.0, 1.0)
    foot = start + share[..., None] * run
    return CutPanelSizes(np.linalg.norm(corner - foot, axis=2), np.stack([corner, foot], axis=2))


def smallest_edge(panels: Sequence[FloatArray], kerf_mm: float) -> SmallPlace | None:
    """The shortest finished edge of all untrimmed panels; None without any."""
    corners = _whole(panels)
    return _smallest(edges_of(corners), kerf_mm) if len(corners) else None


def smallest_neck(panels: Sequence[FloatArray], kerf_mm: float) -> SmallPlace | None:
    """The narrowest finished neck of all untrimmed panels; None without any."""
    corners = _whole(panels)
    return _smallest(necks_of(corners), kerf_mm) if len(corners) else None


@lru_cache(maxsize=2048)
def least_panel_share(deployment: Deployment) -> float:
    """The smallest edge or neck of all panels as a share of the sheet's width, before any trimming.

    About 0.3 ms for 10 x 10 voids, so it is measured when a design is decoded and kept.
    """
    corners = list(deployment.compact[deployment.topology.panel_nodes.reshape(-1, 4)])
    sizes = [place.size_mm for place in (smallest_edge(corners, 0.0), smallest_neck(corners, 0.0)) if place is not None]
    return min(sizes) / float(np.ptp(deployment.compact[:, 0]))


def trimmed_neck_below(panels: Sequence[FloatArray], kerf_mm: float, least_mm: float) -> tuple[float, float] | None:
    """A place where a trimmed panel is narrower than ``least_mm``; None if there is none.

    The panel is shrunk by half the least width and half a kerf on all sides; where it falls apart, it had a neck.
    """
    trimmed = [Polygon(panel) for panel in panels if len(panel) not in (0, 4)]
    for panel, shrunk in zip(trimmed, shapely.buffer(trimmed, -0.5 * (least_mm + kerf_mm)), strict=True):
        parts = [part for part in shapely.get_parts(shrunk) if part.area > PART_SHARE * panel.area]
        if len(parts) > 1:
            x, y = shapely.get_coordinates(shapely.shortest_line(parts[0], parts[1])).mean(axis=0)
            return float(x), float(y)
    return None


def _whole(panels: Sequence[FloatArray]) -> FloatArray:
    """The untrimmed ones (K, 4, 2)."""
    return np.array([panel for panel in panels if len(panel) == 4]).reshape(-1, 4, 2)


def _smallest(found: CutPanelSizes, kerf_mm: float) -> SmallPlace:
    worst = np.unravel_index(int(np.argmin(found.sizes)), found.sizes.shape)
    x, y = found.lines[worst].mean(axis=0)
    return SmallPlace(float(found.sizes[worst]) - kerf_mm, (float(x), float(y)))
