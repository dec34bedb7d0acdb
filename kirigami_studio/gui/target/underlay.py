"""The picture under the drawing board: it lies still while its contour follows the threshold."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QImage, QPainter

from kirigami_studio.gui.widgets.view_transform import ViewTransform
from kirigami_studio.outlines.placed import Placed

if TYPE_CHECKING:
    from kirigami_studio.outlines.read_image import Traced

#: How much of the picture shines through.
OPACITY = 0.5


def picture_image(levels: NDArray[np.uint8]) -> QImage:
    """Return a picture to draw, made of (H, W, 4) levels: red, green, blue, opacity."""
    height, width = levels.shape[:2]
    return QImage(levels.tobytes(), width, height, 4 * width, QImage.Format.Format_RGBA8888).copy()


@dataclass(frozen=True, slots=True, eq=False)
class Underlay:
    """A picture at its place on the board.

    Attributes
    ----------
    path : Path
    image : QImage
        Reduced for drawing.
    corner : (x, y) float, mm
        Its lower left corner.
    pixel : float, mm
        Side of one source pixel.
    size : (width, height) int, source pixels
    """

    path: Path
    image: QImage
    corner: tuple[float, float]
    pixel: float
    size: tuple[int, int]

    @classmethod
    def under(cls, placed: Placed, path: Path, image: QImage, traced: Traced) -> Underlay:
        """Lay a picture under the target that was traced from it."""
        return cls(path, image, (0.0, 0.0), 1.0, traced.picture).laid_under(placed, traced)

    def laid_under(self, placed: Placed, traced: Traced) -> Underlay:
        """The same picture where its contour lies as the target does."""
        pixel = placed.scale / traced.scale
        x, y = (centre - pixel * own for centre, own in zip(placed.centre, traced.centre, strict=True))
        return replace(self, corner=(x, y), pixel=pixel)

    def place(self, traced: Traced) -> Placed:
        """Where another contour of the same picture lies on the board."""
        x, y = (corner + self.pixel * own for corner, own in zip(self.corner, traced.centre, strict=True))
        return Placed(traced.outline, self.pixel * traced.scale, (x, y))

    def paint(self, painter: QPainter, transform: ViewTransform) -> None:
        """Draw the picture, half transparent."""
        width, height = (self.pixel * count * transform.scale for count in self.size)
        left = transform.origin[0] + transform.scale * self.corner[0]
        bottom = transform.origin[1] - transform.scale * self.corner[1]
        painter.save()
        painter.setOpacity(OPACITY)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        painter.drawImage(QRectF(QPointF(left, bottom - height), QPointF(left + width, bottom)), self.image)
        painter.restore()
