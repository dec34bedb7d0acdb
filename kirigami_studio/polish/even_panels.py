"""Even panels: every panel edge of the flat sheet pulled towards the one it has in the uniform sheet.

The term is like an elastic energy, ``w / E * sum over panel edges |e - e0|^2``, quadratic in the compact nodes.  It is
a taste, and a guide as well: a fit that begins stiff and softens takes the whole sheet along.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.topology import topology
from kirigami_studio.polish.large_panels import over_even, panel_areas
from kirigami_studio.polish.unfolding import unfolded

#: Weight in fits that want match and evenness alike, and how many decades the slider spans around it.
USUAL_WEIGHT, DECADES = 3e-4, 2.0


def even_weight(regular: float) -> float:
    """Weight of the term in fits: 0 for the match alone (0), 3e-4 half way (0.5), 3e-3 for regular sheets (1)."""
    return USUAL_WEIGHT * 10.0 ** (DECADES * (regular - 0.5)) if regular > 0.0 else 0.0


@dataclass(frozen=True, slots=True, eq=False)
class EvenPanels:
    """The term for one grid and start outline, with weight 1.

    Attributes
    ----------
    difference : (E, N) sparse
        Reads the panel edges off the compact nodes, scaled so that the squares' sum is their mean in uniform edges.
    uniform : (E, 2) float
        The same of the uniform sheet, unfolded where its start has hollows.
    stiffness : (N, N) sparse
        Second derivative of the value by the nodes' x, and by their y.
    mean_area : float, unit cells squared
        Of the panels of the uniform sheet.
    large : float
        Weight of large panels beside it, see ``large_panels``.
    """

    difference: csr_matrix
    uniform: FloatArray
    stiffness: csr_matrix
    mean_area: float
    large: float

    @classmethod
    def of(cls, sheet: Sheet) -> EvenPanels:
        """The term for a sheet's grid, start outline and cell; its ratios and rim do not matter."""
        panels = topology(*sheet.grid).panel_nodes.reshape(-1, 4)
        start, end = panels.ravel(), np.roll(panels, -1, axis=1).ravel()
        nodes = deploy(unfolded(sheet.plain())).compact
        length = np.sqrt(np.square(nodes[end] - nodes[start]).sum(axis=1).mean() * start.size)
        rows = np.arange(start.size)
        sign = np.ones(start.size) / length
        difference = csr_matrix(
            (np.concatenate([sign, -sign]), (np.concatenate([rows, rows]), np.concatenate([end, start]))),
            shape=(start.size, len(nodes)),
        )
        stiffness = 2.0 * (difference.T @ difference).tocsr()
        mean = float(panel_areas(nodes, *sheet.grid).area.mean())
        return cls(difference, difference @ nodes, stiffness, mean, over_even(sheet))

    def value(self, nodes: FloatArray) -> float:
        """Mean squared change of the panel edges of compact ``nodes`` (N, 2), in uniform edges squared."""
        return float(np.square(self.difference @ nodes - self.uniform).sum())

    def pull(self, nodes: FloatArray) -> FloatArray:
        """Derivative (N, 2) of the value by the nodes."""
        pull: FloatArray = 2.0 * (self.difference.T @ (self.difference @ nodes - self.uniform))
        return pull
