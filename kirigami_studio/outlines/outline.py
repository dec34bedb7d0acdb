"""The target of every source: a closed, simple, centred silhouette of area 1 with its holes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.plain_text import LONGEST_NOTE, plain_line
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.outlines.contour import SMALLEST_AREA, area_and_centroid, as_contour, tidy, unit_frame
from kirigami_studio.outlines.crossings import untangled
from kirigami_studio.outlines.nodes import Nodes

#: Deviation of area and centroid that construction tolerates: float64 rounding over 10^5 vertices stays below it.
NORMALISATION_TOLERANCE = 1e-9
#: Notes of one outline: sources give a few.
MOST_NOTES = 100
#: Holes of one outline; and the smallest, as a share of the area within the outer ring: no panel is so small.
MOST_HOLES, SMALLEST_HOLE = 100, 2e-4


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """A target silhouette in its normal frame: an outer ring, and the holes in it.

    Two outlines are equal when their vertices are: name, notes, place, nodes and holes that are filled do not change
    what a generator sees.

    Raises
    ------
    TargetError
        ``points`` and ``holes`` are not such a polygon; ``from_points`` makes one from raw vertices.
    """

    #: (L, 2); vertices of the outer ring, a simple polygon, counter-clockwise, y up, first vertex not repeated, area
    #: centroid at the origin, area 1 (dimensionless); read-only.
    points: FloatArray
    name: str = "target"  #: name shown to the user, one plain line whatever the source has
    #: What was changed on the way from the source, one sentence each; at most :data:`MOST_NOTES`.
    notes: tuple[str, ...] = ()
    size: tuple[float, float] | None = None  #: (float, float); width and height in ``unit`` before normalising
    unit: str = ""  #: unit of ``size``: "mm", "px", or "" when the source has none
    #: (x, y), mm; of its area centroid on the drawing board, y up; None for an outline that was not drawn there.
    place: tuple[float, float] | None = None
    nodes: Nodes | None = None  #: its points and handles, when it was drawn with them
    #: (H, 2) each; simple rings within the outer one, clockwise, apart from each other and from it; same frame.
    holes: tuple[FloatArray, ...] = ()
    #: (H, 2) each; holes of the source that count as filled, and can be opened again; like ``holes``.
    filled_holes: tuple[FloatArray, ...] = ()

    def __post_init__(self) -> None:
        # Adding 0.0 turns -0.0 into 0.0, so equal outlines also have equal bytes, hence equal hashes.
        points = as_contour(self.points) + 0.0
        area, centroid = area_and_centroid(points)
        if abs(area - 1.0) > NORMALISATION_TOLERANCE or np.max(np.abs(centroid)) > NORMALISATION_TOLERANCE:
            raise TargetError("outline.not_normalised", area=area, x=float(centroid[0]), y=float(centroid[1]))
        holes, filled_holes = (
            tuple(as_contour(hole) + 0.0 for hole in some) for some in (self.holes, self.filled_holes)
        )
        inner = (*holes, *filled_holes)
        if not Polygon(points, inner).is_valid:
            raise TargetError("outline.crosses_itself")
        if len(inner) > MOST_HOLES:
            raise TargetError("outline.too_many_holes", holes=len(inner), limit=MOST_HOLES)
        if self.nodes is not None and int(self.nodes.at.max()) >= len(points):
            raise TargetError("outline.no_such_vertex", vertices=len(points), index=int(self.nodes.at.max()))
        for ring in (points, *inner):
            ring.setflags(write=False)
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "holes", holes)
        object.__setattr__(self, "filled_holes", filled_holes)
        object.__setattr__(self, "name", plain_line(self.name))
        object.__setattr__(self, "notes", tuple(plain_line(note, LONGEST_NOTE) for note in self.notes[:MOST_NOTES]))

    @classmethod
    def from_points(
        cls,
        points: npt.ArrayLike,
        name: str = "target",
        notes: Iterable[str] = (),
        unit: str = "",
        holes: Sequence[npt.ArrayLike] = (),
        filled_holes: Sequence[npt.ArrayLike] = (),
    ) -> Outline:
        """Clean, orient, centre and normalise raw vertices (y up).

        Parameters
        ----------
        points : (L, 2) float, in ``unit``
            Vertices of the outer ring in order; either orientation, the first may be repeated at the end.
        name, notes, unit
            Kept on the outline; what had to be repaired is added to ``notes``.
        holes : sequence of (H, 2) float, in ``unit``
            Rings of what is missing; those that overlap become one, small ones are filled.
        filled_holes : sequence of (H, 2) float, in ``unit``
            Rings that count as filled; those that are not wholly inside are forgotten.

        Raises
        ------
        TargetError
            Not an (L, 2) table of finite numbers, fewer than three different vertices, no area, or a
            contour that crosses itself so much that no single shape is meant.
        """
        contour = tidy(as_contour(points))
        ring, origin, span = unit_frame(contour)
        ring, repairs = untangled(ring, origin, span)
        inner: list[FloatArray] = []
        if len(holes):
            ring, inner, dropped = cut_out(ring, [(as_contour(hole) - origin) / span for hole in holes])
            repairs = (*repairs, *dropped)
        aside = _inside(Polygon(ring, inner), [(as_contour(hole) - origin) / span for hole in filled_holes])
        width, height = np.ptp(ring, axis=0) * span
        normal, *inner = _normalised(ring, [*inner, *aside])
        opened, filled = tuple(inner[: len(inner) - len(aside)]), tuple(inner[len(inner) - len(aside) :])
        said = (*notes, *repairs, *_fill_note(filled))
        return cls(normal, name, said, (float(width), float(height)), unit, holes=opened, filled_holes=filled)

    @property
    def rings(self) -> tuple[FloatArray, ...]:
        """The outer ring, then the holes."""
        return self.points, *self.holes

    @property
    def polygon(self) -> Polygon:
        """The same shape as a shapely polygon, with its holes."""
        return Polygon(self.points, self.holes)

    @property
    def filled(self) -> Outline:
        """The same outline with its holes filled and kept aside: all that a whole sheet can show."""
        return self._with(holes=(), filled_holes=(*self.filled_holes, *self.holes)) if self.holes else self

    @property
    def opened(self) -> Outline:
        """The same outline with the holes open that were filled."""
        return self._with(holes=(*self.holes, *self.filled_holes), filled_holes=()) if self.filled_holes else self

    def with_holes(self, filled: bool | None) -> Outline:
        """The same outline with all holes filled or open; as they are seen by themselves for None."""
        return self if filled is None else self.filled if filled else self.opened

    def without_hole(self, index: int) -> Outline:
        """The same outline with one of its holes filled."""
        rest = (*self.holes[:index], *self.holes[index + 1 :])
        return self._with(holes=rest, filled_holes=(*self.filled_holes, self.holes[index]))

    def _with(self, holes: tuple[FloatArray, ...], filled_holes: tuple[FloatArray, ...]) -> Outline:
        """The same outline with other holes open, and the note on those that are filled."""
        before = _fill_note(self.filled_holes)
        notes = (*(note for note in self.notes if note not in before), *_fill_note(filled_holes))
        return replace(self, holes=holes, filled_holes=filled_holes, notes=notes)

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, Outline)
            and len(self.holes) == len(other.holes)
            and all(map(np.array_equal, self.rings, other.rings))
        )

    def __hash__(self) -> int:
        return hash(tuple(ring.tobytes() for ring in self.rings))

    def __reduce__(self) -> tuple[type[Outline], tuple[Any, ...]]:
        # Through the constructor: numpy forgets the read-only flag when it unpickles.
        place, nodes, holes = self.place, self.nodes, self.holes
        return Outline, (
            self.points,
            self.name,
            self.notes,
            self.size,
            self.unit,
            place,
            nodes,
            holes,
            self.filled_holes,
        )


def _normalised(ring: FloatArray, holes: Sequence[FloatArray] = ()) -> list[FloatArray]:
    """Orient the outer ring counter-clockwise, holes clockwise; centre and scale to area 1."""
    # The second pass removes the rounding of the first.
    for _ in range(2):
        area, centroid = area_and_centroid(ring)
        ring, *holes = [(each - centroid) / np.sqrt(abs(area)) for each in (ring, *holes)]
        if area < 0:
            ring = ring[::-1]
    return [ring, *(hole[::-1] if area_and_centroid(hole)[0] > 0 else hole for hole in holes)]


def cut_out(ring: FloatArray, holes: Sequence[FloatArray]) -> tuple[FloatArray, list[FloatArray], tuple[str, ...]]:
    """The ring less the holes at its rim, the holes within it, and notes on tiny ones.

    Parameters
    ----------
    ring : (L, 2) float
        Simple; longer side of the bounding box 1.
    holes : sequence of (H, 2) float

    Raises
    ------
    TargetError
        The holes leave nothing.
    """
    region = Polygon(ring)
    missing = shapely.union_all([shapely.make_valid(Polygon(hole)) for hole in holes])
    rest = max(shapely.get_parts(region.difference(missing)), key=lambda part: float(part.area), default=None)
    if not isinstance(rest, Polygon) or rest.area < SMALLEST_AREA:
        raise TargetError("contour.no_area", area=0.0, length=1.0)
    least = SMALLEST_HOLE * Polygon(rest.exterior).area
    kept = [hole for hole in rest.interiors if Polygon(hole).area >= least]
    kept = sorted(kept, key=lambda hole: -Polygon(hole).area)[:MOST_HOLES]
    filled = len(rest.interiors) - len(kept)
    notes = (tr_n("{count} tiny hole was filled.", "{count} tiny holes were filled.", filled),) if filled else ()
    # A ring that no hole opens stays as it is, vertex by vertex.
    outer = ring if shapely.equals(Polygon(rest.exterior), region) else tidy(np.asarray(rest.exterior.coords))
    return outer, [tidy(np.asarray(hole.coords)) for hole in kept], notes


def _inside(region: Polygon, holes: Sequence[FloatArray]) -> list[FloatArray]:
    """The simple ones of some rings that lie wholly in a region and apart from each other."""
    kept: list[FloatArray] = []
    rest: BaseGeometry = region
    for hole in holes:
        shape = Polygon(hole)
        if shape.is_valid and rest.contains_properly(shape):
            kept.append(tidy(hole))
            rest = rest.difference(shape)
    return kept


def _fill_note(holes: Sequence[FloatArray]) -> tuple[str, ...]:
    """A sentence on holes that are filled, in the frame of the outline; none without them."""
    share = sum(abs(area_and_centroid(hole)[0]) for hole in holes)
    return (tr("Holes were filled ({percent:.2g} % of the area).", percent=100 * share),) if holes else ()
