"""The smallest features of a design: its shortest panel edges and narrowest necks, one for each panel."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray

#: How many are shown.
SHOWN = 5


class PartKind(Enum):
    """What is small about a panel."""

    EDGE = "edge"
    NECK = "neck"


@dataclass(frozen=True, slots=True)
class SmallPart:
    """An edge or a neck of one panel; panels are rigid, so it stays the same at every angle.

    Attributes
    ----------
    kind : PartKind
    panel : int
        Row by row.
    which : int
        Number of the edge or neck in the panel.
    size : float
        In the unit of the corners that it was found in.
    """

    kind: PartKind
    panel: int
    which: int
    size: float

    def ends(self, panels: FloatArray) -> FloatArray:
        """Both ends (2, 2) of it in panels (K, 4, 2) of any frame that keeps angles."""
        from kirigami_studio.fabricate.panel_sizes import edges_of, necks_of

        sizes = edges_of if self.kind is PartKind.EDGE else necks_of
        line: FloatArray = sizes(panels[self.panel : self.panel + 1]).lines[0, self.which]
        return line


def smallest_parts(panels: FloatArray, trimmed: frozenset[int] = frozenset(), count: int = SHOWN) -> list[SmallPart]:
    """Find the smallest part of each panel, and return the smallest of them all, smallest first.

    Parameters
    ----------
    panels : (K, 4, 2) float
    trimmed : frozenset of int
        Panels that are not looked at: trimming has changed their shape.
    """
    from kirigami_studio.fabricate.panel_sizes import edges_of, necks_of

    edges, necks = edges_of(panels).sizes, necks_of(panels).sizes
    sizes = np.concatenate([edges, necks], axis=1)
    sizes[sorted(trimmed)] = np.inf
    which = np.argmin(sizes, axis=1)
    smallest = sizes[np.arange(len(sizes)), which]
    found = []
    for panel in np.argsort(smallest, kind="stable")[:count].tolist():
        number, size = int(which[panel]), float(smallest[panel])
        if np.isfinite(size):
            kind = PartKind.EDGE if number < edges.shape[1] else PartKind.NECK
            found.append(SmallPart(kind, panel, number if kind is PartKind.EDGE else number - edges.shape[1], size))
    return found
