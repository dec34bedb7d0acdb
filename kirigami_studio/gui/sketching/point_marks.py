"""Paint the points of a target: selected ones filled, with their handles; the field that selects; a dragged place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.look.theme import Palette
from kirigami_studio.gui.scene.target_items import paint_label, paint_proposal
from kirigami_studio.gui.scene.view_transform import ViewTransform
from kirigami_studio.outlines.anchors import Anchors
from kirigami_studio.outlines.nodes import Kind

#: Half the side of a point's mark and the radius of a handle's end, pixels.
MARK, KNOB = 4.5, 3.5


@dataclass(frozen=True, slots=True)
class Marks:
    """What is to be shown.

    Attributes
    ----------
    anchors : Anchors
    selected, images : frozenset of int
        Selected points, and those that mirror them.
    dragged : bool
        Whether the line is the one that would come.
    told : int or None
        A point whose place is written beside it.
    field : (QPointF, QPointF) or None
        Corners of the field that selects, pixels.
    """

    anchors: Anchors
    selected: frozenset[int]
    images: frozenset[int]
    dragged: bool
    told: int | None
    field: tuple[QPointF, QPointF] | None


def paint_marks(painter: QPainter, transform: ViewTransform, palette: Palette, marks: Marks) -> None:
    """Draw the points of a target and what is about to happen to them."""
    anchors = marks.anchors
    if marks.dragged:
        paint_proposal(painter, transform.to_pixels(anchors.ring), palette)
    _paint_handles(painter, transform, palette, marks)
    for index, (x, y) in enumerate(transform.to_pixels(anchors.places).tolist()):
        chosen = index in marks.selected
        painter.setPen(QPen(QColor(palette.accent), 2.4 if index in marks.images else 1.6))
        painter.setBrush(QColor(palette.accent if chosen else palette.canvas))
        _paint_point(painter, QPointF(x, y), anchors.kinds[index])
    if marks.told is not None:
        place = anchors.places[marks.told]
        x, y = transform.to_pixels(place).tolist()
        paint_label(
            painter, QPointF(x, y), tr("{place:.4g}, {place_2:.4g} mm", place=place[0], place_2=place[1]), palette
        )
    if marks.field is not None:
        fill = QColor(palette.accent)
        fill.setAlpha(28)
        painter.setPen(QPen(QColor(palette.accent), 1.0, Qt.PenStyle.DashLine))
        painter.setBrush(fill)
        painter.drawRect(QRectF(*marks.field).normalized())


def _paint_point(painter: QPainter, pointer: QPointF, kind: Kind) -> None:
    """A square for a corner, a circle for what is smooth; automatic ones are diamonds."""
    box = QRectF(pointer.x() - MARK, pointer.y() - MARK, 2 * MARK, 2 * MARK)
    if kind is Kind.CORNER:
        painter.drawRect(box)
    elif kind is Kind.AUTO:
        far = 1.3 * MARK
        painter.drawPolygon([pointer + QPointF(*way) for way in ((0, -far), (far, 0), (0, far), (-far, 0))])
    else:
        painter.drawEllipse(box)


def _paint_handles(painter: QPainter, transform: ViewTransform, palette: Palette, marks: Marks) -> None:
    anchors = marks.anchors
    for index in marks.selected:
        start = QPointF(*transform.to_pixels(anchors.places[index]).tolist())
        for offset in anchors.handles[index]:
            if not np.any(offset):
                continue
            end = QPointF(*transform.to_pixels(anchors.places[index] + offset).tolist())
            painter.setPen(QPen(QColor(palette.muted), 1.2))
            painter.drawLine(start, end)
            painter.setPen(QPen(QColor(palette.accent), 1.4))
            painter.setBrush(QColor(palette.canvas))
            painter.drawEllipse(end, KNOB, KNOB)
