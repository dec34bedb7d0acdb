"""Even panels: every panel edge and every panel's area of the flat sheet pulled towards those of the uniform sheet.

The term is ``w (a / E * sum over panel edges |e - e0|^2 + b / P * sum over panels (A - A0)^2)``, in uniform edges and
areas.  The first sum is like an elastic energy, quadratic in the compact nodes.  It is a taste, and a guide as well: a
fit that begins stiff and softens takes the whole sheet along.  The second is the square of what sheets are judged by,
the coefficient of variation of panel areas, and asks for no shape of the panels.

First designs of the 36 drawn shapes (grid auto): with halves of both instead of edges alone, that coefficient falls
from 0.45 to 0.40 at a mean exact IoU of 0.9850 instead of 0.9852.  Of 7 shapes, 8 instead of 9 % of the cuts meet at
shallow angles.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.sparse import csr_matrix

from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.topology import topology
from kirigami_studio.polish.large_panels import PanelAreas, over_even, panel_areas
from kirigami_studio.polish.unfolding import unfolded

#: Weight in fits that want match and evenness alike, and how many decades the slider spans around it.
USUAL_WEIGHT, DECADES = 3e-4, 2.0
#: Shares of edges and of areas in it.  More for areas leaves splinters: with 0.3 and 1 more than
#: twice as many cuts of a heart meet at shallow angles.
EDGES, AREAS = 0.5, 0.5


def even_weight(regular: float) -> float:
    """Weight of the term in fits: 0 for the match alone (0), 3e-4 half way (0.5), 3e-3 for regular sheets (1)."""
    return USUAL_WEIGHT * 10.0 ** (DECADES * (regular - 0.5)) if regular > 0.0 else 0.0


@dataclass(frozen=True, slots=True, eq=False)
class EvenPanels:
    """The term for one grid and start outline, with weight 1."""

    grid: tuple[int, int]  #: (rows, columns)
    uniform: FloatArray  #: (N, 2), unit cells; nodes of the uniform sheet, unfolded where its start has hollows
    #: (N, N), sparse; second derivative of the edges' part by the nodes' x, and by their y
    elastic: csr_matrix
    pattern: PanelPattern  #: Where its entries and those of the areas' part stand in the second derivative
    areas: float  #: Share of areas
    mean_area: float  #: unit cells squared; of the panels of the uniform sheet
    #: a number or (P,); areas that panels are pulled to, as multiples of the mean: 1, or those of a pinwheel
    asked: float | FloatArray
    large: float  #: Weight of large panels beside it, see ``large_panels``

    @classmethod
    def of(cls, sheet: Sheet, model: Sheet | None = None) -> EvenPanels:
        """The term for a sheet's grid, start outline and cell; its ratios and rim do not matter.

        Another sheet of that start takes the place of the uniform one where it is given, as ``model``.

        Areas count in the paper's rectangle alone, where uniform panels have one area; in other starts
        ``large_panels`` looks after them.
        """
        square = sheet.start is None and sheet.cell == (1.0, 1.0)
        if model is None and square:
            return _of_rectangle(sheet.grid, EDGES, AREAS)
        edges, areas = (EDGES, AREAS) if square else (1.0, 0.0)
        return cls._of_shares(sheet, model, edges, areas)

    @classmethod
    def _of_shares(cls, sheet: Sheet, model: Sheet | None, edges: float, areas: float) -> EvenPanels:
        panels = topology(*sheet.grid).panel_nodes.reshape(-1, 4)
        start, end = panels.ravel(), np.roll(panels, -1, axis=1).ravel()
        nodes = deploy(unfolded(sheet.plain()) if model is None else model).compact
        scale = 1.0 / np.sqrt(np.square(nodes[end] - nodes[start]).sum(axis=1).mean() * start.size)
        rows = np.concatenate([np.arange(start.size)] * 2)
        sign = np.repeat([scale, -scale], start.size)
        difference = csr_matrix((sign, (rows, np.concatenate([end, start]))), shape=(start.size, len(nodes)))
        areas_asked = panel_areas(nodes, *sheet.grid).area
        mean = float(areas_asked.mean())
        asked = 1.0 if model is None else areas_asked / mean
        elastic = csr_matrix(2.0 * edges * (difference.T @ difference))
        pattern = PanelPattern.of(elastic, panels)
        return cls(sheet.grid, nodes, elastic, pattern, areas, mean, asked, over_even(sheet))

    def at(self, nodes: FloatArray) -> EvenPanelsAt:
        """The term at compact ``nodes`` (N, 2), unit cells."""
        away = nodes - self.uniform
        force = self.elastic @ away
        value = 0.5 * float((away * force).sum())
        if not self.areas:
            return EvenPanelsAt(self, value, force, None)
        panels = panel_areas(nodes, *self.grid, self.mean_area)
        return EvenPanelsAt(self, value + self.areas * float(np.square(panels.area - self.asked).mean()), force, panels)


@lru_cache(maxsize=16)
def _of_rectangle(grid: tuple[int, int], edges: float, areas: float) -> EvenPanels:
    """The term for the paper's rectangle, kept for the last few grids."""
    return EvenPanels._of_shares(Sheet.uniform(*grid), None, edges, areas)


@dataclass(frozen=True, slots=True, eq=False)
class EvenPanelsAt:
    """The term at one layout."""

    term: EvenPanels
    value: float  #: The shares' sum: mean squares, in uniform edges and areas
    _force: FloatArray
    _panels: PanelAreas | None

    def pull(self) -> FloatArray:
        """Derivative (N, 2) of the value by the nodes."""
        if self._panels is None:
            return self._force
        by_area = 2.0 * self.term.areas / len(self._panels) * (self._panels.area - self.term.asked)
        return self._force + self._panels.pulled(by_area, len(self._force))

    def curvature(self) -> csr_matrix:
        """Gauss-Newton approximation of the second derivative by the nodes' x, then their y: (2 N, 2 N)."""
        panels = self._panels
        weight = 0.0 if panels is None else 2.0 * self.term.areas / len(panels)
        return self.term.pattern.filled(weight, None if panels is None else panels.slope)


@dataclass(frozen=True, slots=True, eq=False)
class PanelPattern:
    """Places of entries in a matrix (2 N, 2 N) on the nodes' x and y that couples panels' nodes."""

    base: FloatArray  #: (E,); entries that do not change
    column: IntArray  #: (E,)
    first: IntArray  #: (2 N + 1,); where each row begins
    place: IntArray  #: (64 P,); the entry of each pair of coordinates of each panel: the corners' x, then their y

    @classmethod
    def of(cls, elastic: csr_matrix, panels: IntArray) -> PanelPattern:
        """The pattern of ``panels`` (P, 4), with a matrix (N, N) for x and for y in it."""
        count = elastic.shape[0]
        still = elastic.tocoo()
        corners = np.concatenate([panels, panels + count], axis=1)
        pairs = (corners[:, :, None] * 2 * count + corners[:, None, :]).ravel()
        along_x = still.row.astype(np.intp) * 2 * count + still.col
        entries, place = np.unique(
            np.concatenate([pairs, along_x, along_x + 2 * count * count + count]), return_inverse=True
        )
        base = np.bincount(place[pairs.size :], np.tile(still.data, 2), entries.size).astype(np.float64)
        row, column = np.divmod(entries, 2 * count)
        first = np.searchsorted(row, np.arange(2 * count + 1))
        return cls(base, column.astype(np.int32), first.astype(np.int32), place[: pairs.size])

    def filled(self, weight: float, slope: FloatArray | None) -> csr_matrix:
        """The matrix, with ``weight`` times the products of slopes (P, 4, 2) of one panel."""
        data = self.base
        if slope is not None:
            each = np.swapaxes(slope, 1, 2).reshape(len(slope), 8)
            products = (weight * each)[:, :, None] * each[:, None, :]
            data = data + np.bincount(self.place, products.ravel(), data.size)
        return csr_matrix((data, self.column, self.first), shape=(len(self.first) - 1,) * 2)
