"""Where a picture is fitted so that no legend lies on it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
from PySide6.QtCore import QPointF, QRectF

from kirigami_studio.gui.scene.view_transform import Bounds, ViewTransform

#: Pixels that stay between the picture and a legend.
AWAY = 8.0
#: Less of the view's height or width than this is not worth a free legend.
LEAST_SHARE = 0.4


def clear_box(bounds: Bounds, view: QRectF, margin: float, legends: Sequence[QRectF]) -> QRectF:
    """The box in which ``bounds`` appear largest beside all ``legends``, or below or above them.

    Parameters
    ----------
    bounds : Bounds, world
    view : QRectF, pixels
    margin : float, pixels
        What is left free on each side within the box.
    legends : sequence of QRectF, pixels
        Boxes at the edges of the view.

    Returns
    -------
    box : QRectF, pixels
        The view itself where nothing would be covered, or where so little would be left that a covered picture is
        better.
    """
    inner = view.adjusted(margin, margin, -margin, -margin)
    tops = [inner.top(), *(legend.bottom() + AWAY for legend in legends if legend.center().y() < view.center().y())]
    rights = [inner.right(), *(legend.left() - AWAY for legend in legends if legend.left() > view.center().x())]
    bottoms = [inner.bottom(), *(legend.top() - AWAY for legend in legends if legend.center().y() > view.center().y())]
    best, largest = view, 0.0
    for top, right, bottom in product(tops, rights, bottoms):
        corner = QPointF(min(right, inner.right()), min(bottom, inner.bottom()))
        room = QRectF(QPointF(inner.left(), max(top, inner.top())), corner)
        if room.width() < LEAST_SHARE * view.width() or room.height() < LEAST_SHARE * view.height():
            continue
        transform = ViewTransform.fitting(bounds, room)
        if transform.scale > largest and not any(legend.intersects(_shown(bounds, transform)) for legend in legends):
            best, largest = room.adjusted(-margin, -margin, margin, margin), transform.scale
    return best


def _shown(bounds: Bounds, transform: ViewTransform) -> QRectF:
    """Pixels around ``bounds`` that a legend must leave free."""
    corners = np.array([(bounds.left, bounds.top), (bounds.right, bounds.bottom)])
    (left, top), (right, bottom) = transform.to_pixels(corners).tolist()
    free = AWAY - 0.5  # the picture may come up to the distance itself
    return QRectF(QPointF(left, top), QPointF(right, bottom)).adjusted(-free, -free, free, free)
