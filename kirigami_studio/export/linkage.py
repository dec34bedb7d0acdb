"""A design as rigid parts and the hinges between them, as other programs take it.

Pieces on pins are an assembly already.  A sheet becomes one: what there is of every panel is a part, every node that
two of them share a hinge, all of it in mm, in the flat sheet's frame with its lower left corner at (0, 0).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kirigami_studio.assembly.pieces import Assembly, Hinge, Piece
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.lattice.left_corners import left_corners


def linkage_of(job: ExportJob) -> Assembly:
    """The parts and hinges of a job: its pieces, or the panels of the sheet that is cut."""
    if job.pieces is not None:
        return job.pieces.assembly
    posed = job.posed
    sheet = posed.deployment
    low = sheet.compact.min(axis=0)
    sheet = Deployment.of(sheet.sheet, sheet.compact - low)
    cell_mm = job.width_mm / float(np.ptp(sheet.compact[:, 0]))
    kept = [None] * sheet.topology.panel_nodes[..., 0].size if posed.trim is None else posed.trim.kept
    return Assembly(sheet, cell_mm, posed.phi_target, *_parts(sheet, kept, low, cell_mm))


def _parts(
    sheet: Deployment, kept: Sequence[FloatArray | None], low: FloatArray, cell_mm: float
) -> tuple[tuple[Piece, ...], tuple[Hinge, ...]]:
    """The parts of all panels, row by row, and hinges where two of them reach a node."""
    nodes = sheet.topology.panel_nodes
    columns = nodes.shape[1]
    left = left_corners(kept, sheet.compact[nodes.reshape(-1, 4)] + low)
    pieces: list[Piece] = []
    reached: dict[int, list[Piece]] = {}
    for number, (corners, part) in enumerate(zip(nodes.reshape(-1, 4), kept, strict=True)):
        outline = sheet.compact[corners] if part is None else part - low
        if not len(outline):
            continue
        origin = sheet.compact[corners].mean(axis=0)
        row, column = divmod(number, columns)
        piece = Piece(f"P{row + 1}.{column + 1}", 1, (row, column), (outline - origin) * cell_mm)
        pieces.append(piece)
        for node in corners[left[number]].tolist():
            reached.setdefault(node, []).append(piece)

    def own(piece: Piece, node: int) -> FloatArray:
        """Where a node is in the frame of a part, mm."""
        at: FloatArray = (sheet.compact[node] - sheet.compact[nodes[piece.panel]].mean(axis=0)) * cell_mm
        return at

    hinges = [
        Hinge((pair[0].id, pair[1].id), (own(pair[0], node), own(pair[1], node)), node)
        for node, pair in sorted(reached.items())
        if len(pair) == 2
    ]
    return tuple(pieces), tuple(hinges)
