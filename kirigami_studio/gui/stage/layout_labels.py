"""What overlays say about a layout: ratios and openings as colours, numbers of panels and voids, the smallest parts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter, QPainterPath, QPen

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.gui.widgets.colour_scale import ColourScale
from kirigami_studio.gui.widgets.paths import ink, quad_paths
from kirigami_studio.gui.widgets.theme import Palette

#: Opacity of the panels' edges on the heat map.
EDGE_OPACITY = 0.35
#: Numbers are this much smaller than other text.
SMALL_PRINT = 0.82
#: Pixels around a number that belong to it.
AROUND = 3.0
#: How many are shown.
SHOWN = 5


def paint_heat(painter: QPainter, panels: FloatArray, ratio: FloatArray, scale: ColourScale, palette: Palette) -> None:
    """Fill the tiles of panels ((m + 1)(n + 1), 4, 2), pixels, with the colours of the ratios (m, n)."""
    rows, columns = ratio.shape
    paint_shaded(painter, heat_tiles(panels, rows, columns).reshape(-1, 4, 2), np.log10(ratio).ravel(), scale)
    line = QColor(palette.text)
    line.setAlphaF(EDGE_OPACITY)
    painter.setPen(QPen(line, 0.0))
    sides = np.stack([panels, np.roll(panels, -1, axis=1)], axis=2).reshape(-1, 4)
    painter.drawLines([QLineF(*side) for side in sides.tolist()])


def paint_shaded(painter: QPainter, quads: FloatArray, values: FloatArray, scale: ColourScale) -> None:
    """Fill quadrilaterals (K, 4, 2), pixels, with the colours of their values (K,).

    Without a pen and opaque: with them 576 take 50 ms instead of 6.
    """
    painter.setPen(Qt.PenStyle.NoPen)
    for path, colour in zip(quad_paths(quads), scale.shades(values), strict=True):
        painter.setBrush(colour)
        painter.drawPath(path)


def heat_tiles(panels: FloatArray, rows: int, columns: int) -> FloatArray:
    """One quadrilateral around each void: the middles of its four panels, so that closed voids have an area too.

    Parameters
    ----------
    panels : ((rows + 1)(columns + 1), 4, 2) float
        In any coordinates.

    Returns
    -------
    tiles : (rows, columns, 4, 2) float
    """
    middle = panels.mean(axis=1).reshape(rows + 1, columns + 1, 2)
    return np.stack([middle[:-1, :-1], middle[1:, :-1], middle[1:, 1:], middle[:-1, 1:]], axis=2)


def quad_areas(quads: FloatArray) -> FloatArray:
    """Area of quadrilaterals (..., 4, 2), without sign."""
    first, second = quads[..., 2, :] - quads[..., 0, :], quads[..., 3, :] - quads[..., 1, :]
    return np.asarray(0.5 * np.abs(first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]))


def paint_numbers(
    painter: QPainter, places: FloatArray, room: FloatArray, palette: Palette, framed: bool
) -> list[QRectF]:
    """Write ``row, column`` at places (m, n, 2), pixels, where there is ``room`` (m, n) pixels across.

    Parameters
    ----------
    framed : bool
        With a box around each, to tell voids from panels.

    Returns
    -------
    boxes : list of QRectF
        Where something was written.
    """
    painter.save()
    font = QFont(painter.font())
    font.setPointSizeF(font.pointSizeF() * SMALL_PRINT)
    painter.setFont(font)
    metrics = QFontMetricsF(font)
    seen = QRectF(painter.window())
    rows, columns = places.shape[:2]
    height = metrics.height()
    widest = metrics.horizontalAdvance(f"{rows - 1},{columns - 1}") + 2 * AROUND
    boxes = []
    back = QColor(palette.surface)
    back.setAlpha(215)
    for row, column in np.argwhere(room >= max(widest, height)).tolist():
        x, y = places[row, column].tolist()
        box = QRectF(x - 0.5 * widest, y - 0.5 * height, widest, height)
        if not seen.intersects(box):
            continue
        if framed:
            ink(painter, palette.accent, fill=back)
            painter.drawRoundedRect(box, 0.5 * height, 0.5 * height)
        painter.setPen(QColor(palette.text))
        painter.drawText(box, int(Qt.AlignmentFlag.AlignCenter), f"{row},{column}")
        boxes.append(box)
    painter.restore()
    return boxes


def room_in(quads: FloatArray) -> FloatArray:
    """The shorter of the two middle lines of quadrilaterals (..., 4, 2)."""
    middles = 0.5 * (quads + np.roll(quads, -1, axis=-2))
    across = np.linalg.norm(middles[..., 2, :] - middles[..., 0, :], axis=-1)
    along = np.linalg.norm(middles[..., 3, :] - middles[..., 1, :], axis=-1)
    shorter: FloatArray = np.minimum(across, along)
    return shorter


class PartKind(Enum):
    """What is small about a panel."""

    EDGE = "edge"
    NECK = "neck"


@dataclass(frozen=True, slots=True)
class SmallPart:
    """An edge or a neck of one panel; panels are rigid, so it stays the same at every angle."""

    kind: PartKind
    panel: int  #: row by row
    which: int  #: number of the edge or neck in the panel
    size: float  #: in the unit of the corners that it was found in

    def ends(self, panels: FloatArray) -> FloatArray:
        """Both ends (2, 2) of it in panels (K, 4, 2) in any coordinates that keep angles."""
        from kirigami_studio.fabricate.panel_sizes import edges_of, necks_of

        sizes = edges_of if self.kind is PartKind.EDGE else necks_of
        line: FloatArray = sizes(panels[self.panel : self.panel + 1]).lines[0, self.which]
        return line


def smallest_parts(panels: FloatArray, trimmed: frozenset[int] = frozenset()) -> list[SmallPart]:
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
    for panel in np.argsort(smallest, kind="stable")[:SHOWN].tolist():
        number, size = int(which[panel]), float(smallest[panel])
        if np.isfinite(size):
            kind = PartKind.EDGE if number < edges.shape[1] else PartKind.NECK
            found.append(SmallPart(kind, panel, number if kind is PartKind.EDGE else number - edges.shape[1], size))
    return found


def _off_shape(shape: QPainterPath | None, middle: QPointF, width: float, height: float) -> list[QRectF]:
    """Boxes that touch nothing of a shape, the nearest ones first."""
    if shape is None:
        return []
    found = []
    for reach in (0.0, 20.0, 45.0, 80.0):
        for turn in range(8):
            across, down = math.cos(0.25 * math.pi * turn), math.sin(0.25 * math.pi * turn)
            x = middle.x() + across * (reach + 10.0 + 0.5 * width)
            y = middle.y() + down * (reach + 10.0 + 0.5 * height)
            box = QRectF(x - 0.5 * width, y - 0.5 * height, width, height)
            if not shape.intersects(box):
                found.append(box)
    return found


def paint_dimension(
    painter: QPainter,
    ends: FloatArray,
    text: str,
    palette: Palette,
    occupied: list[QRectF],
    shape: QPainterPath | None = None,
) -> QRectF | None:
    """Mark a short length by a line between ``ends`` (2, 2), pixels, and write its size beside it.

    The text goes to the first free place around the line, which joins ``occupied``; None when there is none.  Where
    one is near enough it lies off a ``shape``, neither over it nor in its holes, and a thin line leads to it.
    """
    (ax, ay), (bx, by) = ends.tolist()
    start, stop = QPointF(ax, ay), QPointF(bx, by)
    for colour, width in ((palette.canvas, 6.0), (palette.text, 2.6)):
        painter.setPen(QPen(QColor(colour), width, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
        painter.drawLine(start, stop)
    metrics = QFontMetricsF(painter.font())
    width, height = metrics.horizontalAdvance(text) + 10.0, metrics.height() + 2.0
    middle = QPointF(0.5 * (ax + bx), 0.5 * (ay + by))
    beside = []
    for dx, dy in ((1, -1), (1, 1), (-1, -1), (-1, 1), (1, -3), (-1, 3)):
        left = middle.x() + (8.0 if dx > 0 else -8.0 - width)
        beside.append(QRectF(left, middle.y() + 0.5 * dy * height + (4.0 * dy) - 0.5 * height, width, height))
    for box in (*_off_shape(shape, middle, width, height), *beside):
        if not any(box.intersects(other) for other in occupied) and QRectF(painter.window()).contains(box):
            if box not in beside:
                painter.setPen(QPen(QColor(palette.text), 1.0))
                painter.drawLine(middle, box.center())
            ink(painter, palette.text, fill=palette.surface)
            painter.drawRoundedRect(box, 4.0, 4.0)
            painter.drawText(box, int(Qt.AlignmentFlag.AlignCenter), text)
            occupied.append(box)
            return box
    return None
