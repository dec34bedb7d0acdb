"""From world (y up) to pixels (y down) and back."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRectF

from kirigami_studio.foundation.arrays import FloatArray, ShapeRings, as_rings

#: Spans below this (world units) are treated as this, so that a degenerate box still gets a finite scale.
SMALLEST_SPAN = 1e-9


@dataclass(frozen=True, slots=True)
class Bounds:
    """An axis-parallel box in the world."""

    left: float
    bottom: float
    right: float
    top: float

    @classmethod
    def of(cls, points: FloatArray) -> Bounds:
        """Box of points (..., 2)."""
        flat = points.reshape(-1, 2)
        (left, bottom), (right, top) = flat.min(axis=0), flat.max(axis=0)
        return cls(float(left), float(bottom), float(right), float(top))

    def united(self, other: Bounds) -> Bounds:
        """The smallest box around both."""
        return Bounds(
            min(self.left, other.left),
            min(self.bottom, other.bottom),
            max(self.right, other.right),
            max(self.top, other.top),
        )


@dataclass(frozen=True, slots=True)
class ViewTransform:
    """Uniform scaling with the y axis turned over: ``px = (x, -y) * scale + origin``."""

    scale: float  #: pixels per world unit
    origin: tuple[float, float]  #: (x, y), pixels; where the world's origin appears

    @classmethod
    def fitting(cls, bounds: Bounds, rect: QRectF, margin: float = 0.0) -> ViewTransform:
        """Show ``bounds`` as large as possible, centred in ``rect`` less ``margin`` pixels on each side."""
        width = max(rect.width() - 2 * margin, 1.0)
        height = max(rect.height() - 2 * margin, 1.0)
        span_x = max(bounds.right - bounds.left, SMALLEST_SPAN)
        span_y = max(bounds.top - bounds.bottom, SMALLEST_SPAN)
        scale = min(width / span_x, height / span_y)
        middle = rect.center()
        x = middle.x() - scale * 0.5 * (bounds.left + bounds.right)
        y = middle.y() + scale * 0.5 * (bounds.bottom + bounds.top)
        return cls(scale, (x, y))

    def to_pixels(self, points: FloatArray) -> FloatArray:
        """Map world points (..., 2) to pixels."""
        pixels: FloatArray = points * (self.scale, -self.scale) + self.origin
        return pixels

    def rings_to_pixels(self, rings: ShapeRings) -> tuple[FloatArray, ...]:
        """Map the outer ring of a shape (L, 2), world, and its holes to pixels."""
        return tuple(map(self.to_pixels, as_rings(rings)))

    def to_world(self, pixel: QPointF) -> tuple[float, float]:
        """Map one pixel position to the world."""
        return (pixel.x() - self.origin[0]) / self.scale, (self.origin[1] - pixel.y()) / self.scale

    def zoomed(self, factor: float, about: QPointF) -> ViewTransform:
        """Enlarge by ``factor``, keeping the pixel ``about`` in place."""
        x = about.x() + (self.origin[0] - about.x()) * factor
        y = about.y() + (self.origin[1] - about.y()) * factor
        return ViewTransform(self.scale * factor, (x, y))

    def moved(self, dx: float, dy: float) -> ViewTransform:
        """Shift by pixels."""
        return ViewTransform(self.scale, (self.origin[0] + dx, self.origin[1] + dy))
