"""Feasibility of many designs at once: the checks of ``feasibility``, shared between all designs of a grid."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kirigami_studio.evaluate.boundary import as_plane
from kirigami_studio.evaluate.clearance import stays_clear
from kirigami_studio.evaluate.feasibility import (
    PATH_ANGLES,
    TAU_OVERLAP,
    Contact,
    bad_quads,
    overlap_ratio,
    path_contact,
)
from kirigami_studio.foundation.arrays import ComplexArray
from kirigami_studio.lattice.deployment import ZIPPED_BELOW, Deployment


@dataclass(frozen=True, slots=True)
class Soundness:
    """What ``invalid_quads``, ``overlap_ratio`` and ``path_contact`` say about one design at one angle."""

    n_invalid: int
    overlap_ratio: float
    contact: Contact | None

    @property
    def feasible(self) -> bool:
        return self.n_invalid == 0 and self.overlap_ratio <= TAU_OVERLAP and self.contact is None


def soundness_of_many(deployments: Sequence[Deployment], phi: float) -> list[Soundness]:
    """Check designs of one grid at an angle in [0, pi]."""
    sheets = _Sheets(deployments)
    n_invalid = np.count_nonzero(bad_quads(sheets.quads(phi)), axis=1)
    loop = deployments[0].topology.outline_nodes
    clear = stays_clear(sheets.even[:, loop], sheets.odd[:, loop], phi, PATH_ANGLES)
    return [
        # What is not certainly clear is looked at again one by one.
        Soundness(int(count), 0.0, None)
        if free
        else Soundness(int(count), overlap_ratio(deployment, phi), path_contact(deployment, phi))
        for deployment, count, free in zip(deployments, n_invalid, clear, strict=True)
    ]


class _Sheets:
    """Nodes of several designs of one grid."""

    def __init__(self, deployments: Sequence[Deployment]) -> None:
        self.deployments = deployments
        self.even = as_plane(np.stack([deployment.even_part for deployment in deployments]))
        self.odd = as_plane(np.stack([deployment.odd_part for deployment in deployments]))

    def quads(self, phi: float) -> ComplexArray:
        """The quads that count at an angle, see ``feasibility.quads_that_count``: (B, Q, 4) complex."""
        tables = self.deployments[0].topology
        nodes = tables.panel_nodes.reshape(-1, 4)
        if ZIPPED_BELOW < phi < math.pi - ZIPPED_BELOW:
            nodes = np.concatenate([nodes, tables.void_nodes.reshape(-1, 4)])
        turn = cmath.exp(0.5j * (math.pi - phi))
        places: ComplexArray = (turn.conjugate() * self.even + turn * self.odd)[:, nodes]
        return places
