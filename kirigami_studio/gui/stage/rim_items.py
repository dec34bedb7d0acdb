"""Places where cuts meet the rim of a sheet, as handles: picking, facts, drawing.

The handle of an edge cut stands a little outside the sheet, beside the middle of the two corners that lie together
there while the sheet is flat, so that it never covers a vertex of the outline.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from PySide6.QtCore import QPointF
from PySide6.QtGui import QColor, QPainter, QPen

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.widgets.paths import round_pen
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.widgets.view_transform import ViewTransform
from kirigami_studio.lattice.sheet import Sheet, anchor_points, rim_table

#: Pixels from the rim to the middle of a handle, and from there to the pointer that still means it.
OUTSIDE, REACH = 13.0, 8.0
#: Radius (pixels) of a handle, and of the one that is meant or selected.
RADIUS, MEANT_RADIUS = 3.6, 5.6


@cache
def twins(rows: int, columns: int) -> IntArray:
    """The two nodes at each edge cut, which lie together while the sheet is flat: (R, 2) int, as in ``RimTable``."""
    table = rim_table(rows, columns)
    pairs: IntArray = np.array([table.node[table.share[:, anchor] == 1.0] for anchor in table.mouths]).reshape(-1, 2)
    pairs.setflags(write=False)
    return pairs


def mouth_places(design: PosedDesign, phi: float) -> FloatArray:
    """Middle of the two nodes at each edge cut at an angle: (R, 2) float, world."""
    places: FloatArray = design.nodes(phi)[twins(*design.deployment.sheet.grid)].mean(axis=1)
    return places


def outward(sheet: Sheet) -> FloatArray:
    """Unit vectors (R, 2) that point out of the flat sheet at its edge cuts."""
    table, anchors = rim_table(*sheet.grid), anchor_points(sheet)
    along = np.roll(anchors, -1, axis=0)[table.mouths] - anchors[table.mouths - 1]
    along /= np.maximum(np.hypot(*along.T), 1e-12)[:, None]
    return np.stack([-along[:, 1], along[:, 0]], axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class RimShapes:
    """Handles of one design at one angle, in pixels.

    Attributes
    ----------
    feet, handles : (R, 2) float, pixels
        Where the edge cuts are, and the handles beside them; in the order of
        :class:`~kirigami_studio.lattice.sheet.RimTable`.
    """

    feet: FloatArray
    handles: FloatArray

    @classmethod
    def of(cls, design: PosedDesign, phi: float, transform: ViewTransform) -> RimShapes:
        """Place the handles of a design."""
        feet = transform.to_pixels(mouth_places(design, phi))
        # Panels on both sides of a cut turn by the same angle, one either way: the way out of the sheet stays.
        turned = outward(design.deployment.sheet) @ (design.pose_at(phi).matrix[:, :2].T / design.pose.scale)
        return cls(feet, feet + OUTSIDE * turned * (1.0, -1.0))

    def mouth_at(self, x: float, y: float) -> int | None:
        """The edge cut whose handle is nearest to pixel (x, y), if in reach."""
        if not len(self.handles):
            return None
        distance = np.hypot(*(self.handles - (x, y)).T)
        nearest = int(distance.argmin())
        return nearest if distance[nearest] <= REACH else None


@dataclass(frozen=True, slots=True)
class MouthFacts:
    """One edge cut on the sheet as it is cut.

    Attributes
    ----------
    side : int
        0 top, 1 right, 2 bottom, 3 left.
    number, count : int
        Its number on that side from 1, from the left or from the top, and how many there are.
    position : float, unit cells
        From the left or upper corner of that side.
    offset : float, unit cells
        From its place on an even rim.
    position_mm : float, mm
    """

    side: int
    number: int
    count: int
    position: float
    offset: float
    position_mm: float

    @classmethod
    def of(cls, sheet: Sheet, mouth: int, width_mm: float) -> MouthFacts:
        """Measure an edge cut of a sheet that is ``width_mm`` wide."""
        table, anchors = rim_table(*sheet.grid), anchor_points(sheet)
        side = int(table.side[mouth])
        same = np.flatnonzero(table.side == side)
        position = float(sheet.rim.positions[mouth])
        corners = np.flatnonzero(np.isin(np.arange(len(anchors)), table.mouths, invert=True))
        # Positions count along with the rim on the first two sides and against it on the others.
        start = anchors[corners[side if side < 2 else (side + 1) % 4]]
        length = float(np.hypot(*(anchors[table.mouths[mouth]] - start)))
        scale = width_mm / float(np.ptp(anchors[:, 0]))
        offset = position - float(table.even[mouth])
        return cls(side, int(mouth - same[0]) + 1, same.size, position, offset, length * scale)

    @property
    def name(self) -> str:
        """Which one it is, for short texts."""
        templates = (
            tr("Edge cut {number} of {count}, top"),
            tr("Edge cut {number} of {count}, right"),
            tr("Edge cut {number} of {count}, bottom"),
            tr("Edge cut {number} of {count}, left"),
        )
        return templates[self.side].format(number=self.number, count=self.count)

    @property
    def short_name(self) -> str:
        """The same where there is little room."""
        return tr("Cut {number}", number=self.number)

    def lines(self) -> tuple[str, str]:
        """The lines of the label at the pointer."""
        place = tr("{mm:.2f} mm   {cells:.2f} cells", mm=self.position_mm, cells=self.position)
        return self.name, place

    def sentence(self) -> str:
        """The text for the status line."""
        if self.side % 2 == 0:
            return tr(
                "{name}: {mm:.2f} mm from the left corner, {cells:.2f} cells ({offset:+.2f} from even).",
                name=self.name,
                mm=self.position_mm,
                cells=self.position,
                offset=self.offset,
            )
        return tr(
            "{name}: {mm:.2f} mm from the upper corner, {cells:.2f} cells ({offset:+.2f} from even).",
            name=self.name,
            mm=self.position_mm,
            cells=self.position,
            offset=self.offset,
        )


def paint_mouths(
    painter: QPainter, shapes: RimShapes, meant: int | None, selected: int | None, palette: Palette
) -> None:
    """Draw a small disc on a stem at every edge cut; larger where it is pointed at, filled where it is selected."""
    for mouth, (foot, handle) in enumerate(zip(shapes.feet.tolist(), shapes.handles.tolist(), strict=True)):
        marked = mouth in (meant, selected)
        painter.setPen(round_pen(palette.canvas, 3.6))
        painter.drawLine(QPointF(*foot), QPointF(*handle))
        painter.setPen(round_pen(palette.accent, 1.4))
        painter.drawLine(QPointF(*foot), QPointF(*handle))
        painter.setPen(QPen(QColor(palette.accent), 1.6))
        painter.setBrush(QColor(palette.accent if mouth == selected else palette.surface))
        radius = MEANT_RADIUS if marked else RADIUS
        painter.drawEllipse(QPointF(*handle), radius, radius)
