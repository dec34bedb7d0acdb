"""An outline at its place on the drawing board: where shapes are drawn, added and subtracted."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import Polygon

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines.contour import area_and_centroid, as_contour, tidy, unit_frame
from kirigami_studio.outlines.crossings import untangled
from kirigami_studio.outlines.nodes import Nodes
from kirigami_studio.outlines.outline import Outline, cut_out
from kirigami_studio.outlines.pieces import rings_of

#: Longer side (mm) that an outline without a real size is given on the board.
BOARD_MM = 100.0
LARGEST_MM = 10_000.0


@dataclass(frozen=True, slots=True)
class Placed:
    """An outline, its size in mm and its place.

    Raises
    ------
    TargetError
        A scale that is not above 0, or numbers that are not finite.
    """

    outline: Outline
    scale: float  #: mm; length on the board of one unit of the outline
    centre: tuple[float, float] = (0.0, 0.0)  #: (x, y), mm; of the outline's area centroid, y up

    def __post_init__(self) -> None:
        numbers = (self.scale, *self.centre)
        if not all(math.isfinite(number) for number in numbers) or self.scale <= 0:
            raise TargetError("placed.no_size", scale=self.scale, centre=self.centre)

    @classmethod
    def on_board(cls, outline: Outline) -> Placed:
        """Where it was drawn, else in the middle of the board; in its own size if known in mm, else 100 mm long."""
        span = np.ptp(outline.points, axis=0)
        if outline.size is not None and outline.unit == "mm":
            scale = outline.size[0] / float(span[0])
        else:
            scale = BOARD_MM / float(np.max(span))
        if outline.place is not None:
            return cls(outline, scale, outline.place)
        low, high = outline.points.min(axis=0), outline.points.max(axis=0)
        x, y = (-0.5 * scale * (low + high)).tolist()
        return cls(outline, scale, (x, y))

    @classmethod
    def from_ring(
        cls,
        ring: npt.ArrayLike,
        name: str,
        notes: Iterable[str] = (),
        holes: Sequence[npt.ArrayLike] = (),
        filled_holes: Sequence[npt.ArrayLike] = (),
    ) -> Placed:
        """Make raw vertices an outline in their place.

        Parameters
        ----------
        ring : (L, 2) float, mm, y up
        holes, filled_holes : sequence of (H, 2) float, mm
            As of :meth:`Outline.from_points`.

        Raises
        ------
        TargetError
            As :meth:`Outline.from_points`, or larger than 10 m.
        """
        contour, origin, span = unit_frame(tidy(as_contour(ring)))
        clean, repairs = untangled(contour, origin, span)
        if len(holes):  # those at the rim change its middle
            clean, inner, dropped = cut_out(clean, [(as_contour(hole) - origin) / span for hole in holes])
            holes, repairs = [hole * span + origin for hole in inner], (*repairs, *dropped)
        clean = clean * span + origin
        length = float(np.max(np.ptp(clean, axis=0)))
        if length > LARGEST_MM:
            raise TargetError("placed.too_large", limit=LARGEST_MM, length=length)
        area, centroid = area_and_centroid(clean)
        place = (float(centroid[0]), float(centroid[1]))
        outline = Outline.from_points(clean, name, (*notes, *repairs), "mm", holes, filled_holes)
        return cls(replace(outline, place=place), math.sqrt(abs(area)), place)

    @classmethod
    def from_polygon(cls, polygon: Polygon, name: str, notes: Iterable[str] = ()) -> Placed:
        """Make a polygon, mm, an outline with its holes.

        Raises
        ------
        TargetError
            As :meth:`from_ring`.
        """
        ring, holes = rings_of(polygon)
        return cls.from_ring(tidy(as_contour(ring)), name, notes, holes)

    @property
    def ring(self) -> FloatArray:
        """(L, 2) float, mm: the outer ring on the board."""
        return self._on_board(self.outline.points)

    @property
    def holes(self) -> tuple[FloatArray, ...]:
        """(H, 2) float, mm, each: the holes on the board."""
        return tuple(map(self._on_board, self.outline.holes))

    @property
    def rings(self) -> tuple[FloatArray, ...]:
        """The outer ring, then the holes, mm."""
        return self.ring, *self.holes

    @property
    def polygon(self) -> Polygon:
        """The same as a shapely polygon with its holes, mm."""
        return Polygon(self.ring, self.holes)

    def _on_board(self, points: FloatArray) -> FloatArray:
        return points * self.scale + self.centre

    @property
    def size(self) -> tuple[float, float]:
        """Width and height, mm."""
        width, height = (self.scale * np.ptp(self.outline.points, axis=0)).tolist()
        return width, height

    def reshaped(self, ring: npt.ArrayLike, notes: Iterable[str] = ()) -> Placed:
        """The same target with another outer ring (L, 2), mm; notes on the old one are dropped.

        Its holes stay where they are; one that reaches out of the ring becomes a notch.
        """
        filled = map(self._on_board, self.outline.filled_holes)
        return Placed.from_ring(ring, self.outline.name, notes, self.holes, tuple(filled))

    def with_polygon(self, polygon: Polygon, notes: Iterable[str] = ()) -> Placed:
        """The same target as another polygon with its holes, mm; filled ones stay."""
        ring, holes = rings_of(polygon)
        filled = map(self._on_board, self.outline.filled_holes)
        return Placed.from_ring(tidy(as_contour(ring)), self.outline.name, notes, holes, tuple(filled))

    def with_holes(self, filled: bool) -> Placed:
        """The same target with all holes filled or open."""
        return replace(self, outline=self.outline.with_holes(filled))

    def without_hole_at(self, place: tuple[float, float]) -> Placed | None:
        """The same target with the hole around a place, mm, filled; None where there is none."""
        for index, hole in enumerate(self.holes):
            if shapely.contains_xy(Polygon(hole), *place):
                return replace(self, outline=self.outline.without_hole(index))
        return None

    def mapped(self, matrix: npt.ArrayLike, shift: npt.ArrayLike) -> Placed:
        """The same target with every point ``p`` (mm) at ``p @ matrix + shift``; its nodes and handles go along.

        Raises
        ------
        TargetError
            As :meth:`from_ring`.
        """
        linear, way = np.asarray(matrix, dtype=np.float64), np.asarray(shift, dtype=np.float64)
        holes, filled = (
            [self._on_board(hole) @ linear + way for hole in some]
            for some in (self.outline.holes, self.outline.filled_holes)
        )
        made = Placed.from_ring(self.ring @ linear + way, self.outline.name, (), holes, filled)
        nodes, count = self.outline.nodes, len(self.outline.points)
        if nodes is None or len(made.outline.points) != count:
            return made
        return made.with_nodes(nodes.mapped(linear * (self.scale / made.scale), count))

    def with_nodes(self, nodes: Nodes | None) -> Placed:
        """The same target with other nodes."""
        return replace(self, outline=replace(self.outline, nodes=nodes))

    def moved(self, by: tuple[float, float]) -> Placed:
        """The same target elsewhere on the board, ``by`` mm: the very same shape, so that its designs stay right.

        Raises
        ------
        TargetError
            A way that is not finite.
        """
        return self._put(1.0, (self.centre[0] + by[0], self.centre[1] + by[1]))

    def enlarged(self, factor: float, fixed: tuple[float, float]) -> Placed:
        """The very same shape ``factor`` times as large; the place ``fixed``, mm, stays.

        Raises
        ------
        TargetError
            A factor that is not above 0, or not finite.
        """
        x, y = (stay + factor * (own - stay) for own, stay in zip(self.centre, fixed, strict=True))
        return self._put(factor, (x, y))

    def _put(self, factor: float, centre: tuple[float, float]) -> Placed:
        there = Placed(self.outline, factor * self.scale, centre)
        known = self.outline.size if self.outline.unit == "mm" else None
        size = there.size if known is None else (factor * known[0], factor * known[1])
        return replace(there, outline=replace(self.outline, place=centre, size=size, unit="mm"))
