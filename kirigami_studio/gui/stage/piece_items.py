"""Paint the pieces of a pinned design, two layers and pins, or the tiles on a hinge layer."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QPainter, QPainterPath, QPen

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.gui.widgets.paths import line_path
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.widgets.view_transform import ViewTransform
from kirigami_studio.lattice.deployment import rotate

if TYPE_CHECKING:
    from kirigami_studio.assembly.pieces import Assembly, Piece
    from kirigami_studio.export.assembly_files import AssemblyJob
    from kirigami_studio.studio.making import MadePieces

#: Of the upper layer: the lower one shows through.
UPPER_ALPHA = 205
#: Pins narrower than this (pixels) are dots.
DOT = 1.2
LAYERS = (1, 2)


@dataclass(frozen=True, eq=False)
class ShownPieces:
    """The pieces of a design, as the stage shows them over its target."""

    assembly: Assembly
    design: PosedDesign  #: The lattice of the pieces: smaller than that of the design by the margin of pins
    head_mm: float = 0.0  #: Diameter of the heads of pins
    tiles: bool = False  #: Whether they lie on the panels of a hinge layer, which is drawn below them

    @classmethod
    def of(cls, made: MadePieces, design: PosedDesign) -> ShownPieces:
        """The pieces of the design on the stage."""
        plan = made.made.plan
        shown = PosedDesign(plan.assembly.deployment, plan.pose, design.phi_target)
        return cls(plan.assembly, shown, plan.options.head_mm)

    @classmethod
    def of_tiles(cls, layers: AssemblyJob, design: PosedDesign) -> ShownPieces:
        """The tiles of the design on the stage."""
        made = layers.assembly.deployment
        return cls(layers.assembly, design if made is design.deployment else design.laid_over(made), tiles=True)

    @property
    def mm_per_world(self) -> float:
        """Millimetres of one world unit."""
        return self.assembly.cell_mm / self.design.pose.scale

    @cached_property
    def extent(self) -> FloatArray:
        """Corners of all pieces at both ends of the motion, (P, 2) float, world."""
        ends = (np.pi, self.design.phi_target)
        return np.concatenate([ring for phi in ends for ring in self.outlines(phi)])

    def outlines(self, phi: float) -> list[FloatArray]:
        """Outlines (L, 2) of all pieces at an angle, world."""
        return self._placed(phi, [piece.outline for piece in self.assembly.pieces])

    def _placed(self, phi: float, points: list[FloatArray]) -> list[FloatArray]:
        """Points (L, 2) of each piece's frame in the world."""
        pose, cell_mm = self.design.pose_at(phi), self.assembly.cell_mm
        poses = self.assembly.poses(phi).tolist()
        return [
            pose.apply((rotate(part, turn) + (x, y)) / cell_mm)  # noqa: RUF005 - sums of arrays
            for part, (x, y, turn) in zip(points, poses, strict=True)
        ]

    def paint(self, painter: QPainter, phi: float, transform: ViewTransform, palette: Palette) -> None:
        """Draw both layers and the pins at an angle (radians)."""
        pieces = self.assembly.pieces
        rings = [transform.to_pixels(ring) for ring in self.outlines(phi)]
        holes = [np.array([hole.centre for hole in piece.holes]).reshape(-1, 2) for piece in pieces]
        centres = [transform.to_pixels(one) for one in self._placed(phi, holes)]
        per_mm = transform.scale / self.mm_per_world
        for layer in LAYERS:
            for piece, ring, places in zip(pieces, rings, centres, strict=True):
                if piece.layer == layer:
                    paint_piece(painter, piece, ring, places, per_mm, palette)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(palette.panel_line))
        head = max(0.5 * per_mm * self.head_mm, DOT)
        for piece, places in zip(pieces, centres, strict=True):
            if piece.layer == LAYERS[-1]:
                for x, y in places.tolist():
                    painter.drawEllipse(QPointF(x, y), head, head)


def paint_piece(
    painter: QPainter, piece: Piece, ring: FloatArray, centres: FloatArray, per_mm: float, palette: Palette
) -> None:
    """Draw a piece with its holes.

    Parameters
    ----------
    ring : (L, 2) float, pixels
        Its outline.
    centres : (H, 2) float, pixels
        Of its holes.
    per_mm : float
        Pixels of a millimetre.
    """
    path = QPainterPath(line_path(ring, closed=True))
    path.setFillRule(Qt.FillRule.OddEvenFill)
    for (x, y), hole in zip(centres.tolist(), piece.holes, strict=True):
        radius = 0.5 * per_mm * hole.diameter_mm
        path.addEllipse(QPointF(x, y), radius, radius)
    colour = QColor(palette.panel_even if piece.layer == LAYERS[0] else palette.panel_odd)
    if piece.layer == LAYERS[-1]:
        colour.setAlpha(UPPER_ALPHA)
    painter.setPen(QPen(QColor(palette.panel_line), 1.0 if per_mm > 1.0 else 0.5))
    painter.setBrush(colour)
    painter.drawPath(path)
