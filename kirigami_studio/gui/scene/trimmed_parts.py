"""What trimming leaves of the edge panels and what it took, carried along by the panels at any angle."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.trimming import Trim
from kirigami_studio.foundation.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from kirigami_studio.lattice.deployment import Deployment

#: Vertices are snapped to this grid (unit cells) where parts are taken from panels.
GRID = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Rings:
    """Polygons that each ride on one panel.

    Attributes
    ----------
    panel : (R,) int
        Number of the panel, row by row.
    anchor : (R,) int
        Its top node.
    even : (R,) bool
        Panels with I + J even turn by -a while the sheet opens, the others by +a.
    ends : (R,) int
        Where each ring ends in ``offsets``.
    offsets : (P,) complex, unit cells
        Vertices seen from the anchor, in the compact sheet.
    """

    panel: IntArray
    anchor: IntArray
    even: BoolArray
    ends: IntArray
    offsets: ComplexArray

    @classmethod
    def of(cls, deployment: Deployment, numbered: list[tuple[int, FloatArray]]) -> Rings:
        """Rings (P, 2) in the compact sheet with the number of the panel that each rides on."""
        panel = np.array([number for number, _ in numbered], dtype=np.int64)
        line, place = np.divmod(panel, deployment.field.columns + 1)
        anchor = deployment.topology.panel_nodes.reshape(-1, 4)[panel, 0]
        lengths = np.array([len(ring) for _, ring in numbered], dtype=np.int64)
        points = np.concatenate([ring for _, ring in numbered]) if numbered else np.zeros((0, 2))
        offsets = _plane(points) - np.repeat(_plane(deployment.compact)[anchor], lengths)
        return cls(panel, anchor, (line + place) % 2 == 0, np.cumsum(lengths), offsets)

    def at(self, nodes: FloatArray, pose: Similarity, phi: float) -> list[FloatArray]:
        """The rings (P, 2) in the world, where ``nodes`` (N, 2) are the sheet's at ``phi`` in a pose."""
        half = 0.5 * (math.pi - phi)
        turn = pose.factor * np.exp(1j * np.where(self.even, -half, half))
        lengths = np.diff(self.ends, prepend=0)
        points = self.offsets * np.repeat(turn, lengths) + np.repeat(_plane(nodes)[self.anchor], lengths)
        return np.split(np.stack([points.real, points.imag], axis=1), self.ends[:-1]) if len(lengths) else []


@dataclass(frozen=True, slots=True, eq=False)
class TrimmedParts:
    """Both sides of the cut: ``kept`` has one ring for each trimmed panel, ``removed`` one for each piece."""

    kept: Rings
    removed: Rings

    @classmethod
    def of(cls, deployment: Deployment, trim: Trim) -> TrimmedParts:
        """Divide the panels of a trimmed design."""
        import shapely  # 70 ms that the empty window need not pay

        corners = deployment.compact[deployment.topology.panel_nodes.reshape(-1, 4)]
        kept = [(number, part) for number, part in enumerate(trim.kept) if part is not None]
        removed = []
        for number, part in kept:
            rest = shapely.difference(shapely.Polygon(corners[number]), shapely.Polygon(part), grid_size=GRID)
            pieces = [piece for piece in shapely.get_parts(rest) if piece.area > 0.0]
            removed += [(number, shapely.get_coordinates(piece.exterior)[:-1]) for piece in pieces]
        return cls(Rings.of(deployment, kept), Rings.of(deployment, removed))


def _plane(points: FloatArray) -> ComplexArray:
    plane: ComplexArray = points[..., 0] + 1j * points[..., 1]
    return plane
