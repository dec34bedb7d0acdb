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

import numpy as np
from scipy.sparse import block_diag, csr_matrix

from kirigami_studio.foundation.arrays import FloatArray
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
    #: (E, N), sparse; reads the panel edges off the compact nodes, scaled so that the squares' sum is their mean in
    #: uniform edges
    difference: csr_matrix
    uniform: FloatArray  #: (E, 2); the same of the uniform sheet, unfolded where its start has hollows
    stiffness: csr_matrix  #: (2 N, 2 N), sparse; second derivative of the edges' part by the nodes' x, then their y
    #: edges and areas: Shares of edges and areas
    edges: float
    areas: float
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
        panels = topology(*sheet.grid).panel_nodes.reshape(-1, 4)
        start, end = panels.ravel(), np.roll(panels, -1, axis=1).ravel()
        nodes = deploy(unfolded(sheet.plain()) if model is None else model).compact
        length = np.sqrt(np.square(nodes[end] - nodes[start]).sum(axis=1).mean() * start.size)
        rows = np.arange(start.size)
        sign = np.ones(start.size) / length
        difference = csr_matrix(
            (np.concatenate([sign, -sign]), (np.concatenate([rows, rows]), np.concatenate([end, start]))),
            shape=(start.size, len(nodes)),
        )
        areas_asked = panel_areas(nodes, *sheet.grid).area
        mean = float(areas_asked.mean())
        asked = 1.0 if model is None else areas_asked / mean
        square = sheet.start is None and sheet.cell == (1.0, 1.0)
        edges, areas = (EDGES, AREAS) if square else (1.0, 0.0)
        along = 2.0 * edges * (difference.T @ difference)
        stiffness = csr_matrix(block_diag((along, along)))
        reference = difference @ nodes
        return cls(sheet.grid, difference, reference, stiffness, edges, areas, mean, asked, over_even(sheet))

    def value(self, nodes: FloatArray) -> float:
        """The shares' sum for compact ``nodes`` (N, 2): mean squares, in uniform edges and areas."""
        value = self.edges * float(np.square(self.difference @ nodes - self.uniform).sum())
        if self.areas:
            value += self.areas * float(np.square(self._panels(nodes).area - self.asked).mean())
        return value

    def pull(self, nodes: FloatArray) -> FloatArray:
        """Derivative (N, 2) of the value by the nodes."""
        pull: FloatArray = 2.0 * self.edges * (self.difference.T @ (self.difference @ nodes - self.uniform))
        if self.areas:
            panels = self._panels(nodes)
            by_area = 2.0 * self.areas / len(panels) * (panels.area - self.asked)
            pull += (by_area @ panels.growth(len(nodes))).reshape(2, len(nodes)).T
        return pull

    def curvature(self, nodes: FloatArray) -> csr_matrix:
        """Gauss-Newton approximation of the second derivative by the nodes' x, then their y: (2 N, 2 N)."""
        if not self.areas:
            return self.stiffness
        panels = self._panels(nodes)
        growth = panels.growth(len(nodes))
        return csr_matrix(self.stiffness + 2.0 * self.areas / len(panels) * (growth.T @ growth))

    def _panels(self, nodes: FloatArray) -> PanelAreas:
        return panel_areas(nodes, *self.grid, self.mean_area)
