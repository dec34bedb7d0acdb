"""Find and mark the places where a design is not physical."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QPainter, QPainterPath, QPen

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.score import Score
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.gui.widgets.paths import ink
from kirigami_studio.gui.widgets.theme import Palette

#: Panels below this part of the median panel area count as collapsed; far below what any cutter can hold.
COLLAPSED_SHARE = 1e-6


class FaultKind(Enum):
    """What is wrong at a place."""

    INVERTED = "inverted"  #: a panel is turned inside out or has no area
    CONTACT = "contact"  #: the sheet first touches itself while it opens
    CROSSING = "crossing"  #: the sheet overlaps itself


@dataclass(frozen=True, slots=True)
class Fault:
    """One place, in world units; ``where`` belongs to the angle it was asked for.

    ``phi`` (radians) is the angle at which the fault can be seen, None where it can be seen at every angle.
    """

    kind: FaultKind
    where: tuple[float, float]
    phi: float | None = None


def inverted_panels(panels: FloatArray) -> BoolArray:
    """Which panels (K, 4, 2) have turned inside out or lost their area; the same at every angle, panels are rigid."""
    diagonals = panels[:, 2] - panels[:, 0], panels[:, 3] - panels[:, 1]
    area = 0.5 * (diagonals[0][:, 0] * diagonals[1][:, 1] - diagonals[0][:, 1] * diagonals[1][:, 0])
    median = float(np.median(np.abs(area))) if area.size else 0.0
    return area <= COLLAPSED_SHARE * median


def faults(panels: FloatArray, inverted: BoolArray, contact: FloatArray | None) -> tuple[Fault, ...]:
    """Return all faults to be shown: inverted panels where they are now, the contact where it happens.

    Parameters
    ----------
    panels : (K, 4, 2) float, world
        At the angle that is shown.
    inverted : (K,) bool
        From :func:`inverted_panels`.
    contact : (2,) float, world, or None
        From :func:`contact_place`.
    """
    found = [Fault(FaultKind.INVERTED, (x, y)) for x, y in panels[inverted].mean(axis=1).tolist()]
    if contact is not None:
        found.append(Fault(FaultKind.CONTACT, (float(contact[0]), float(contact[1]))))
    return tuple(found)


def contact_place(design: PosedDesign, score: Score) -> FloatArray | None:
    """Where the sheet first touches itself, (2,) world; None when it never does."""
    contact = score.contact
    return None if contact is None else design.to_world(contact.where, contact.phi)


def crossing_place(design: PosedDesign, phi: float) -> FloatArray | None:
    """Where the outline crosses itself most deeply at an angle (radians), (2,) world; None when it does not."""
    from kirigami_studio.evaluate.boundary import as_plane
    from kirigami_studio.evaluate.crossing import deepest_crossing

    place = deepest_crossing(as_plane(design.deployment.outline(phi)))
    return None if place is None else design.to_world((place.real, place.imag), phi)


def paint_fault(painter: QPainter, where: FloatArray, kind: FaultKind, palette: Palette, size: float = 9.0) -> None:
    """Draw one marker at ``where`` (2,) pixels: a diamond for a bad panel, a disc for a contact."""
    middle = QPointF(float(where[0]), float(where[1]))
    ink(painter, palette.fault_line, 1.8, fill=palette.fault)
    if kind is not FaultKind.INVERTED:
        painter.drawEllipse(middle, size, size)
    else:
        painter.drawPath(_diamond(middle, size * 1.15))
    painter.setPen(QPen(QColor(palette.fault_line), 2.2, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
    painter.drawLine(middle + QPointF(0, -0.45 * size), middle + QPointF(0, 0.1 * size))
    painter.drawPoint(middle + QPointF(0, 0.5 * size))


def _diamond(middle: QPointF, size: float) -> QPainterPath:
    path = QPainterPath(middle + QPointF(0, -size))
    for dx, dy in ((size, 0), (0, size), (-size, 0)):
        path.lineTo(middle + QPointF(dx, dy))
    path.closeSubpath()
    return path
