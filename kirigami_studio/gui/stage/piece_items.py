"""Paint the pieces of a pinned design: two layers, the upper one translucent, and pins."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QPainter, QPainterPath, QPen

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.fabricate.hold import HeldState
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.gui.widgets.paths import line_path
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.widgets.view_transform import ViewTransform
from kirigami_studio.lattice.deployment import rotate

if TYPE_CHECKING:
    from kirigami_studio.assembly.pieces import Assembly, Piece
    from kirigami_studio.studio.making import MadePieces

#: Of the upper layer: the lower one shows through.
UPPER_ALPHA = 205
#: Pins narrower than this (pixels) are dots.
DOT = 1.2
LAYERS = (1, 2)
#: Within so many radians of an end state, what holds the sheet there is numbered.
SAME_ANGLE = 1e-3


@dataclass(frozen=True, eq=False)
class ShownPieces:
    """The pieces of a design, as the stage shows them over its target."""

    made: MadePieces
    design: PosedDesign  #: The lattice of the pieces: smaller than that of the design by their margin

    @classmethod
    def of(cls, made: MadePieces, design: PosedDesign) -> ShownPieces:
        """The pieces of the design on the stage."""
        plan = made.made.plan
        return cls(made, PosedDesign(plan.assembly.deployment, plan.pose, design.phi_target))

    @property
    def assembly(self) -> Assembly:
        return self.made.made.assembly

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
        head = max(0.5 * per_mm * self.made.made.plan.options.head_mm, DOT)
        pins: dict[str, list[FloatArray]] = {piece.id: [] for piece in pieces}
        for hinge in self.assembly.hinges:
            pins[hinge.pieces[1]].append(hinge.at[1])
        for places in self._placed(phi, [np.reshape(at, (-1, 2)) for at in pins.values()]):
            for x, y in transform.to_pixels(places).tolist():
                painter.drawEllipse(QPointF(x, y), head, head)
        self._paint_holds(painter, phi, transform, palette)

    def _paint_holds(self, painter: QPainter, phi: float, transform: ViewTransform, palette: Palette) -> None:
        """Draw places that hold the sheet, those of a state with their numbers there."""
        names = [piece.id for piece in self.assembly.pieces]
        for place in self.made.made.held.places:
            here = abs(phi - (self.design.phi_target if place.state is HeldState.OPEN else np.pi)) < SAME_ANGLE
            painter.setPen(QPen(QColor(palette.accent), 1.5 if here else 0.75))
            painter.setBrush(QColor(palette.accent) if here else Qt.BrushStyle.NoBrush)
            by_name = dict(zip(place.parts, place.at, strict=True))
            empty = np.zeros((0, 2))
            placed = self._placed(phi, [by_name.get(name, empty) for name in names])
            rings = [transform.to_pixels(points) for points in placed if len(points)]
            radius = max(0.5 * place.hole_mm * transform.scale / self.mm_per_world, DOT)
            for ring in rings:
                if place.hole_mm:
                    for x, y in ring.tolist():
                        painter.drawEllipse(QPointF(x, y), radius, radius)
                else:
                    painter.drawPath(line_path(ring, closed=True))
            if here:
                corner = np.concatenate(rings).max(axis=0) + radius * np.array([1.0, 0.0])
                painter.setPen(QColor(palette.text))
                painter.drawText(QPointF(*corner.tolist()), f"{place.number}")


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
