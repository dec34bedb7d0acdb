"""Where to hold a sheet and where to pull it: a pin on every gripped panel, and an arrow along the way it has to go."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QLineF, QPointF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.gui.widgets.theme import Palette

#: Radius (pixels) of a pin, length of the longest arrow and of the shortest, and of an arrow's head.
PIN, LONGEST, SHORTEST, HEAD = 6.0, 52.0, 22.0, 10.0
#: Width (pixels) of an arrow and of the rim that sets it off from the panels.
SHAFT, RIM = 3.0, 2.2
#: The way to go is that of the next so many radians.
AHEAD = math.radians(3.0)


@dataclass(frozen=True, slots=True, eq=False)
class GripPlaces:
    """Gripped panels at one angle.

    Attributes
    ----------
    held, moved : (K, 2) float
        Middles of the panels.
    way : (K, 2) float
        Where the moved ones go next, seen from those that are held; zeros at the end of the way.
    """

    held: FloatArray
    moved: FloatArray
    way: FloatArray


def grip_places(
    design: PosedDesign, held: tuple[int, ...], moved: tuple[int, ...], phi: float, end: float
) -> GripPlaces:
    """Places of the gripped panels in the target's frame.

    Parameters
    ----------
    design : PosedDesign
    held, moved : tuple of int
        Panels, row by row.
    phi : float, radians
    end : float, radians
        Angle that the sheet is led to.
    """
    panels = np.array([*held, *moved])
    here, there = (_middles(design, panels, angle) for angle in (phi, max(min(phi, math.pi) - AHEAD, min(end, phi))))
    count = len(held)
    way = there - here
    way = way[count:] - way[:count].mean(axis=0)
    return GripPlaces(here[:count], here[count:], way)


def _middles(design: PosedDesign, panels: np.ndarray[tuple[int], np.dtype[np.intp]], phi: float) -> FloatArray:
    nodes = design.nodes(phi)
    middles: FloatArray = design.panels(nodes)[panels].mean(axis=1)
    kept = design.kept(nodes, phi)
    for row, panel in enumerate(panels.tolist()):
        if panel in kept:
            middles[row] = kept[panel].mean(axis=0)
    return middles


def paint_grips(painter: QPainter, places: GripPlaces, way: FloatArray, palette: Palette) -> None:
    """Draw pins and arrows.

    Parameters
    ----------
    painter : QPainter
    places : GripPlaces
        In pixels.
    way : (K, 2) float, pixels
        As ``places.way``; the longest one gets the longest arrow.
    palette : Palette
    """
    lengths = np.linalg.norm(way, axis=1)
    longest = float(lengths.max(initial=0.0))
    for start, towards, length in zip(places.moved, way, lengths.tolist(), strict=True):
        if longest > 0.0 and length > 1e-6 * longest:
            reach = max(SHORTEST, LONGEST * length / longest)
            _paint_arrow(painter, start, start + reach / length * towards, palette)
    _paint_pins(painter, places.moved, palette.good, palette)
    _paint_pins(painter, places.held, palette.text, palette)


def _paint_arrow(painter: QPainter, start: FloatArray, tip: FloatArray, palette: Palette) -> None:
    """An arrow between two points (2,), pixels."""
    along = (tip - start) / np.linalg.norm(tip - start)
    across, foot = np.array([-along[1], along[0]]), tip - HEAD * along
    corners = (tip, foot + 0.55 * HEAD * across, foot - 0.55 * HEAD * across)
    head = QPolygonF([QPointF(x, y) for x, y in np.array(corners).tolist()])
    line = QLineF(*start.tolist(), *(foot + 0.2 * HEAD * along).tolist())
    for colour, wider in ((palette.surface, RIM), (palette.good, 0.0)):
        pen = QPen(QColor(colour), SHAFT + 2.0 * wider)
        pen.setCapStyle(Qt.PenCapStyle.RoundCap)
        painter.setPen(pen)
        painter.drawLine(line)
        painter.setPen(QPen(QColor(colour), max(2.0 * wider, 1.0)))
        painter.setBrush(QColor(colour))
        painter.drawPolygon(head)


def _paint_pins(painter: QPainter, pixels: FloatArray, colour: str, palette: Palette) -> None:
    painter.setPen(QPen(QColor(palette.surface), RIM))
    painter.setBrush(QColor(colour))
    for x, y in pixels.tolist():
        painter.drawEllipse(QPointF(x, y), PIN, PIN)
