"""Matches of a layout that will be trimmed: what sticks out costs little, except at hinges, which cannot be cut off."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.lattice.deployment import ZIPPED_BELOW
from kirigami_studio.lattice.topology import topology
from kirigami_studio.polish.boundary_target import BoundaryTarget, unit_normals
from kirigami_studio.polish.matching import Matching

#: Boundary length that an outer hinge stands for, as a share of the mean outline edge's.
HINGE_SHARE = 0.5


def outer_hinges(rows: int, columns: int, phi: float) -> BoolArray:
    """Which vertices of the outline at ``phi`` are hinges, where two panels meet: (L,) bool."""
    tables = topology(rows, columns)
    hinges = np.concatenate([tables.h[1:-1].ravel(), tables.v[:, 1:-1].ravel()])
    loop = tables.outline_at_zero if phi < ZIPPED_BELOW else tables.outline_nodes
    return np.isin(loop, hinges)


def check_excess(excess: float) -> float:
    """The weight of what sticks out, once it makes sense.

    Raises
    ------
    UsageError
        Not a number from 0 to 1.
    """
    if not 0.0 <= excess <= 1.0:
        raise UsageError(f"The weight of what sticks out must be a number from 0 to 1, got {excess!r}.")
    return float(excess)


@dataclass(frozen=True, slots=True, eq=False)
class OneSided:
    """How a layout that will be trimmed is weighed.

    Attributes
    ----------
    excess : float, 0..1
        Weight of what sticks out of the target, relative to what is missed.
    hinges : (L,) bool
        Outline vertices where sticking out costs fully.
    """

    excess: float
    hinges: BoolArray

    def weighed(self, matching: Matching, outline: FloatArray, target: BoundaryTarget) -> Matching:
        """The same matches, those that stick out with less weight, and one more for every outer hinge."""
        normals = unit_normals(outline)
        out = np.einsum("rk,rk->r", matching.gap, normals[matching.edge]) > 0.0
        vertex = np.flatnonzero(self.hinges)
        # A hinge looks half way between its two edges.
        looks = normals[vertex] + normals[vertex - 1]
        looks /= np.maximum(np.hypot(*looks.T), 1e-12)[:, None]
        gap = outline[vertex] - target.nearest(outline[vertex], looks)
        boundary = target.weight * len(target.samples)
        beyond = np.einsum("hk,hk->h", gap, looks) > 0.0
        return replace(
            matching,
            edge=np.concatenate([matching.edge, vertex]),
            share=np.concatenate([matching.share, np.zeros(len(vertex))]),
            gap=np.concatenate([matching.gap, gap]),
            distance=np.concatenate([matching.distance, np.hypot(*gap.T)]),
            weight=np.concatenate(
                [
                    matching.weight * np.where(out, self.excess, 1.0),
                    HINGE_SHARE * boundary / len(outline) * beyond,
                ]
            ),
        )
