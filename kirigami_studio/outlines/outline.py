"""The one value that all sources become: a closed, simple, oriented, centred silhouette of unit area."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from shapely.geometry import Polygon

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.plain_text import LONGEST_NOTE, plain_line
from kirigami_studio.outlines.contour import area_and_centroid, as_contour, tidy, unit_frame
from kirigami_studio.outlines.crossings import untangled
from kirigami_studio.outlines.nodes import Nodes

#: Deviation of area and centroid that construction tolerates: float64 rounding over 10^5 vertices stays below it.
NORMALISATION_TOLERANCE = 1e-9
#: Notes of one outline: sources give a few.
MOST_NOTES = 100


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """A target silhouette in its normal frame.

    Two outlines are equal when their vertices are: name, notes, place and nodes do not change what a generator sees.

    Raises
    ------
    TargetError
        ``points`` is not such a polygon; ``from_points`` makes one from raw vertices.
    """

    #: (L, 2); vertices of a simple polygon, counter-clockwise, y up, first vertex not repeated, area centroid at the
    #: origin, area 1 (dimensionless); read-only.
    points: FloatArray
    name: str = "target"  #: name shown to the user, one plain line whatever the source has
    #: What was changed on the way from the source, one sentence each; at most :data:`MOST_NOTES`.
    notes: tuple[str, ...] = ()
    size: tuple[float, float] | None = None  #: (float, float); width and height in ``unit`` before normalising
    unit: str = ""  #: unit of ``size``: "mm", "px", or "" when the source has none
    #: (x, y), mm; of its area centroid on the drawing board, y up; None for an outline that was not drawn there.
    place: tuple[float, float] | None = None
    nodes: Nodes | None = None  #: its points and handles, when it was drawn with them

    def __post_init__(self) -> None:
        # Adding 0.0 turns -0.0 into 0.0, so equal outlines also have equal bytes, hence equal hashes.
        points = as_contour(self.points) + 0.0
        area, centroid = area_and_centroid(points)
        if abs(area - 1.0) > NORMALISATION_TOLERANCE or np.max(np.abs(centroid)) > NORMALISATION_TOLERANCE:
            raise TargetError("outline.not_normalised", area=area, x=float(centroid[0]), y=float(centroid[1]))
        if not Polygon(points).is_valid:
            raise TargetError("outline.crosses_itself")
        if self.nodes is not None and int(self.nodes.at.max()) >= len(points):
            raise TargetError("outline.no_such_vertex", vertices=len(points), index=int(self.nodes.at.max()))
        points.setflags(write=False)
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "name", plain_line(self.name))
        object.__setattr__(self, "notes", tuple(plain_line(note, LONGEST_NOTE) for note in self.notes[:MOST_NOTES]))

    @classmethod
    def from_points(
        cls, points: npt.ArrayLike, name: str = "target", notes: Iterable[str] = (), unit: str = ""
    ) -> Outline:
        """Clean, orient, centre and normalise raw vertices (y up).

        Parameters
        ----------
        points : (L, 2) float, in ``unit``
            Vertices in order; either orientation, the first may be repeated at the end.
        name, notes, unit
            Kept on the outline; what had to be repaired is added to ``notes``.

        Raises
        ------
        TargetError
            Not an (L, 2) table of finite numbers, fewer than three different vertices, no area, or a
            contour that crosses itself so much that no single shape is meant.
        """
        contour = tidy(as_contour(points))
        ring, origin, span = unit_frame(contour)
        ring, repairs = untangled(ring, origin, span)
        width, height = np.ptp(ring, axis=0) * span
        return cls(_normalised(ring), name, (*notes, *repairs), (float(width), float(height)), unit)

    @property
    def polygon(self) -> Polygon:
        """The same shape as a shapely polygon."""
        return Polygon(self.points)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Outline) and np.array_equal(self.points, other.points)

    def __hash__(self) -> int:
        return hash(self.points.tobytes())

    def __reduce__(self) -> tuple[type[Outline], tuple[Any, ...]]:
        # Through the constructor: numpy forgets the read-only flag when it unpickles.
        return Outline, (self.points, self.name, self.notes, self.size, self.unit, self.place, self.nodes)


def _normalised(ring: FloatArray) -> FloatArray:
    """Orient counter-clockwise, centre and scale to area 1; the second pass removes the rounding of the first."""
    for _ in range(2):
        area, centroid = area_and_centroid(ring)
        ring = (ring - centroid) / np.sqrt(abs(area))
        if area < 0:
            ring = ring[::-1]
    return ring
