"""Drawing with a mirror: axes through one place, the images of what is drawn, and one ring of all of them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from functools import partial

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import Polygon, box

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines.combining import SNAP, Combine, combined
from kirigami_studio.outlines.pieces import largest_piece
from kirigami_studio.outlines.placed import LARGEST_MM, Placed

#: A line that ends this near to an axis, as a share of its size, is meant to end on it.
AXIS_REACH = 0.08


class Axis(Enum):
    """Which axes mirror what is drawn."""

    NONE = "none"
    UPRIGHT = "upright"
    LEVEL = "level"
    BOTH = "both"


#: Factors along x and y of the images, the drawn half or quarter itself left out.
IMAGES: dict[Axis, tuple[tuple[int, int], ...]] = {
    Axis.NONE: (),
    Axis.UPRIGHT: ((-1, 1),),
    Axis.LEVEL: ((1, -1),),
    Axis.BOTH: ((1, -1), (-1, -1), (-1, 1)),
}


@dataclass(frozen=True, slots=True)
class Mirror:
    """Axes through one place."""

    axis: Axis = Axis.NONE
    at: tuple[float, float] = (0.0, 0.0)  #: (x, y), mm

    @property
    def images(self) -> tuple[tuple[int, int], ...]:
        """Factors along x and y of each image."""
        return IMAGES[self.axis]

    def image(self, points: npt.ArrayLike, factors: tuple[int, int]) -> FloatArray:
        """Points (..., 2), mm, in one of the images."""
        reflected: FloatArray = (np.asarray(points, dtype=np.float64) - self.at) * factors + self.at
        return reflected

    def all_images(self, ring: FloatArray) -> list[FloatArray]:
        """The ring (L, 2), mm, in all images."""
        return [self.image(ring, factors) for factors in self.images]

    def completed(self, line: npt.ArrayLike) -> FloatArray | None:
        """The closed line (L, 2), mm, of an open one and its images, when both its ends are meant to lie on an axis.

        With both axes one end belongs on each of them.  None when the line is a shape of its own.
        """
        points = np.array(line, dtype=np.float64)
        if self.axis is Axis.NONE or len(points) < 2:
            return None
        reach = AXIS_REACH * float(np.max(np.ptp(points, axis=0)))
        first, last = (np.abs(points[end] - self.at) for end in (0, -1))
        if self.axis is not Axis.BOTH:
            along = 0 if self.axis is Axis.UPRIGHT else 1
            if first[along] > reach or last[along] > reach:
                return None
            points[[0, -1], along] = self.at[along]
            return np.concatenate([points, self.image(points, self.images[0])[-2:0:-1]])
        if first[1] < first[0]:  # from the upright axis to the level one
            points, first, last = points[::-1].copy(), last, first
        if first[0] > reach or last[1] > reach:
            return None
        points[0, 0], points[-1, 1] = self.at
        down, across, back = self.all_images(points)
        return np.concatenate([points, down[-2::-1], across[1:], back[-2:0:-1]])

    def united(self, shapes: Iterable[Polygon]) -> list[Polygon]:
        """Everything that shapes, mm, and their images cover, as separate pieces without slivers."""
        own = list(shapes)
        size = max(float(np.max(np.ptp(shapely.get_coordinates(shape), axis=0))) for shape in own)
        every = [shapely.transform(shape, partial(self.image, factors=one)) for one in self.images for shape in own]
        whole = shapely.union_all([*map(shapely.make_valid, (*own, *every))], grid_size=SNAP * size)
        return [part for part in shapely.get_parts(whole) if isinstance(part, Polygon) and part.area > 0]

    def evened(self, drawn: Placed) -> Placed:
        """The part of a target on the one side of the axes and its images: nearly symmetric before, exactly after.

        Raises
        ------
        TargetError
            Nothing of it is there.
        """
        if self.axis is Axis.NONE:
            return drawn
        x, y = self.at
        far = 2.0 * LARGEST_MM
        right = x if self.axis is not Axis.LEVEL else x - far
        top = y if self.axis is not Axis.UPRIGHT else y - far
        side = drawn.polygon.intersection(box(right, top, x + far, y + far))
        parts = [part for part in shapely.get_parts(side) if isinstance(part, Polygon)]
        if not parts:
            raise TargetError("mirror.nothing_on_side")
        piece, notes = largest_piece(shapely.union_all(self.united(parts)))
        return drawn.with_polygon(piece, (*drawn.outline.notes, *notes))


def mirrored(target: Placed | None, drawn: Placed, how: Combine, name: str, mirror: Mirror) -> Placed:
    """Join a drawn shape and its images with the target; without a mirror just the shape.

    Raises
    ------
    TargetError
        As :func:`combined`, or a new shape that hangs apart from its images.
    """
    notes = drawn.outline.notes
    if mirror.axis is Axis.NONE:
        return combined(target, drawn, how, notes)
    pieces = mirror.united([drawn.polygon])
    if how is Combine.NEW or target is None:
        if len(pieces) > 1:
            raise TargetError("mirror.images_apart")
        piece, more = largest_piece(pieces[0])
        return Placed.from_polygon(piece, drawn.outline.name, (*notes, *more))
    for piece in pieces:
        target = combined(target, Placed.from_polygon(piece, name, notes), how, notes)
    return target
