"""Panels over a target as an antialiased bitmap: what the preview and every frame of the animation show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw

from kirigami_studio.export import palette
from kirigami_studio.foundation.arrays import FloatArray

#: Pictures are drawn this many times larger and then reduced.
SUPERSAMPLING = 3


@dataclass(frozen=True, slots=True)
class PictureFrame:
    """Which part of the plane a picture shows.

    Attributes
    ----------
    low : (x, y)
        Lower left corner, in the frame of the drawing.
    scale : float
        Pixels per unit.
    pixels : (width, height)
    """

    low: tuple[float, float]
    scale: float
    pixels: tuple[int, int]

    @classmethod
    def around(cls, clouds: Sequence[FloatArray], longest: int, margin: float = 0.05) -> PictureFrame:
        """Fit all points (each (P, 2)) into a picture whose longer side has ``longest`` pixels."""
        points = np.concatenate([cloud.reshape(-1, 2) for cloud in clouds])
        extent = np.ptp(points, axis=0)
        room = margin * float(extent.max())
        low = points.min(axis=0) - room
        size = extent + 2.0 * room
        scale = longest / float(size.max())
        width, height = (max(1, round(float(side) * scale)) for side in size)
        return cls((float(low[0]), float(low[1])), scale, (width, height))

    def pixel(self, points: FloatArray, factor: int) -> list[tuple[float, float]]:
        """Coordinates (P, 2) -> pixels of a picture ``factor`` times as large, y down."""
        scale = self.scale * factor
        x = (points[:, 0] - self.low[0]) * scale
        y = self.pixels[1] * factor - (points[:, 1] - self.low[1]) * scale
        return list(zip(x.tolist(), y.tolist(), strict=True))


def draw_polygons(polygons: Sequence[FloatArray], frame: PictureFrame, target: FloatArray | None = None) -> Image.Image:
    """Draw panels, each (P, 2), over a target outline (L, 2); the target's outline is repeated on top."""
    factor = SUPERSAMPLING
    size = (frame.pixels[0] * factor, frame.pixels[1] * factor)
    image = Image.new("RGB", size, palette.PAPER)
    draw = ImageDraw.Draw(image)
    if target is not None:
        draw.polygon(frame.pixel(target, factor), fill=palette.TARGET_FILL)
    for polygon in polygons:
        corners = frame.pixel(polygon, factor)
        draw.polygon(corners, fill=palette.PANEL)
        draw.line([*corners, corners[0]], fill=palette.PANEL_EDGE, width=factor, joint="curve")
    if target is not None:
        loop = frame.pixel(target, factor)
        draw.line([*loop, loop[0]], fill=palette.TARGET_EDGE, width=2 * factor, joint="curve")
    return image.resize(frame.pixels, Image.Resampling.BOX)
