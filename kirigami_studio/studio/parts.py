"""Jobs on the parts of a drawing: find out whether there is a choice, and make one outline of chosen parts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from enum import Enum
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import NDArray

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import KirigamiError, TargetError
from kirigami_studio.foundation.steps import Cancel
from kirigami_studio.outlines.merging import Join, Merged, Merging, merged
from kirigami_studio.outlines.parts import SourceParts, Strokes
from kirigami_studio.outlines.read import has_parts, is_picture, read_parts, read_target
from kirigami_studio.outlines.starts import StartShape, outline_start
from kirigami_studio.project.document import Document
from kirigami_studio.studio.targets import TargetRead, design_of, reading_target, reduced_picture, usual_target

#: Deviation of drawn parts from the true ones, share of the drawing's size: less than a pixel.
DRAWN = 1.0 / 3000.0
#: Share of its convex hull from which on painted strokes surround an area, and are not only lines.
MOST_OF_HULL = 0.5


class Purpose(Enum):
    """What chosen parts of a drawing become."""

    TARGET = "target"
    START = "start"
    SECOND = "second"


@dataclass(frozen=True, slots=True, eq=False)
class Photo:
    """A picture in which an object can be taken by clicks."""

    path: Path
    seen: NDArray[np.uint8]  #: (H, W, 4); red, green, blue, opacity, reduced for drawing
    size: tuple[float, float]  #: (width, height), source pixels
    found: SourceParts  #: the parts that it has by itself
    strokes: Strokes = field(default_factory=Strokes)  #: where the object was taken; it is the last part then


@dataclass(frozen=True, slots=True, eq=False)
class PartsRead:
    """A drawing that holds several parts, and how they are drawn."""

    source: SourceParts
    #: tuple of tuple of (P, 2) float, source units; for each part its rings, or its lines where it encloses nothing;
    #: fewer vertices than the part itself.
    sketches: tuple[tuple[FloatArray, ...], ...]
    photo: Photo | None = None  #: the picture that holds them; None for drawings
    #: How all parts but letters become the silhouette of strokes, where that is meant; None where the usual one is.
    strokes: Merging | None = None


@dataclass(frozen=True, slots=True, eq=False)
class DesignRead:
    """The project of the design that a cut file of this program carries."""

    document: Document


def reading_source(source: str, cancel: Cancel) -> Iterator[TargetRead | PartsRead | DesignRead]:
    """Read a target, the parts of a drawing that has several to choose from, or the design of a cut file."""
    document = design_of(Path(source))
    if document is not None:
        yield DesignRead(document)
    else:
        yield from _reading_outline(source, cancel)


def reading_second(source: str, cancel: Cancel) -> Iterator[TargetRead | PartsRead]:
    """Read a second target, or the parts that it may be; of a cut file it is the target of the design there."""
    document = design_of(Path(source))
    if document is not None and document.target is not None:
        yield TargetRead(document.target)
    else:
        yield from _reading_outline(source, cancel)


def reading_start(source: str, cancel: Cancel) -> Iterator[StartShape | PartsRead]:
    """Read a start outline, or the parts that it may be; of a cut file it is the outline of the sheet.

    One that is too hollow is refused.
    """
    if design_of(Path(source)) is not None:
        yield outline_start(read_target(source))
        return
    for found in _reading_outline(source, cancel):
        yield outline_start(found.outline) if isinstance(found, TargetRead) else found


def _reading_outline(source: str, cancel: Cancel) -> Iterator[TargetRead | PartsRead]:
    """Read an outline, or the parts of a drawing that has several to choose from."""
    path = Path(source)
    if has_parts(path) and not is_picture(path):
        found = read_parts(source)
        yield sketched(found) if found.is_ambiguous else TargetRead(usual_target(path, found))
    elif is_picture(path) and _asks(source):
        yield photographed(path)
    else:
        yield from reading_target(source, cancel)


def _asks(source: str) -> bool:
    """Whether a picture has no plain shape, or several large ones; one of specks is refused by its reader."""
    from PIL import Image

    from kirigami_studio.outlines.read_image import MOST_PIXELS_IN_COLOUR, image_parts, is_alone, is_plain_picture

    try:
        with Image.open(source) as picture:
            width, height = picture.size
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError):
        return False  # its reader says what is wrong with it
    if width * height > MOST_PIXELS_IN_COLOUR:
        return False  # it takes seconds to read
    try:
        parts = image_parts(source, in_colour=False).parts
        if not is_plain_picture(source):
            return True
    except KirigamiError:
        return False
    return not is_alone([part.worth for part in parts])


def reading_parts(source: str, cancel: Cancel) -> Iterator[PartsRead]:
    """Read the parts of a drawing, whether there is a choice or not."""
    yield photographed(Path(source)) if is_picture(Path(source)) else sketched(read_parts(source))


def photographed(path: Path) -> PartsRead:
    """The parts of a picture on the picture itself."""
    from kirigami_studio.outlines.read_image import picture_size

    source = read_parts(path)
    seen = reduced_picture(path)
    photo = None if seen is None else Photo(path, seen, picture_size(path), source)
    return replace(sketched(source), photo=photo)


def picking_object(read: PartsRead, strokes: Strokes, cancel: Cancel) -> Iterator[PartsRead]:
    """Take the object at some places of a picture as another part, the last one; without places none."""
    from kirigami_studio.outlines.picked import picked_part

    photo = read.photo
    assert photo is not None
    parts = photo.found.parts
    if strokes.taken:
        parts += (replace(picked_part(photo.path, strokes), number=parts[-1].number + 1),)
    yield replace(sketched(replace(photo.found, parts=parts)), photo=replace(photo, strokes=strokes))


def places_in(read: PartsRead, numbers: frozenset[int]) -> tuple[tuple[float, float], ...]:
    """A place well inside each of some parts of a picture, pixels from its upper left corner."""
    assert read.photo is not None
    height = read.photo.size[1]
    inside = [part.region.representative_point() for part in read.source.parts if part.number in numbers]
    return tuple((point.x, height - point.y) for point in inside)


def silhouette_of_strokes(source: SourceParts) -> Merging | None:
    """Way to join strokes that stand open around everything that is closed.

    A house of open lines is not its window.
    """
    if source.choice.open_at is None or not any(part.is_closed for part in source.parts):
        return None
    merging = Merging(Join.BRIDGE, as_painted=True)
    inside = shapely.union_all([part.region for part in source.parts if part.is_closed])
    try:
        shape = merged(source, [part for part in source.parts if not part.is_letter], merging).shape
    except TargetError:
        return None
    around = shapely.Polygon(shape.exterior)
    encloses = around.contains(inside) and around.area > MOST_OF_HULL * around.convex_hull.area
    return merging if encloses else Merging(Join.TIGHT, as_painted=True)


def sketched(source: SourceParts) -> PartsRead:
    """The parts with what is drawn of them."""
    tolerance = DRAWN * source.size
    sketches = []
    for part in source.parts:
        if part.is_closed:
            rings = shapely.get_rings(part.region.simplify(tolerance))
            sketches.append(tuple(shapely.get_coordinates(ring) for ring in rings))
        else:
            lines = [shapely.linestrings(line) for line in part.lines]
            sketches.append(tuple(shapely.get_coordinates(shapely.simplify(line, tolerance)) for line in lines))
    return PartsRead(source, tuple(sketches), strokes=silhouette_of_strokes(source))


def merging_parts(source: SourceParts, numbers: frozenset[int], merging: Merging, cancel: Cancel) -> Iterator[Merged]:
    """Make one outline of some parts."""
    yield merged(source, source.of(numbers), merging)


def part_at(read: PartsRead, place: tuple[float, float], reach: float) -> int:
    """The number of the smallest part at a place, source units; 0 where there is none within ``reach``."""
    point = shapely.points(place)
    found = [
        part
        for part in read.source.parts
        # On a picture colours are not clicked on: they are where objects are taken.
        if not (read.photo is not None and part.is_aside)
        and (
            shapely.intersects_xy(part.region, *place)
            if part.is_closed
            else any(shapely.distance(shapely.linestrings(line), point) <= reach for line in part.lines)
        )
    ]
    return min(found, key=lambda part: part.worth).number if found else 0


def bounds_of(read: PartsRead) -> tuple[float, float, float, float]:
    """Left, bottom, right, top of all parts with their strokes, or of the picture, source units."""
    if read.photo is not None:
        return 0.0, 0.0, *read.photo.size
    boxes = np.array([part.bounds for part in read.source.parts])
    pen = 0.5 * max(part.pen.width for part in read.source.parts)
    left, bottom = (boxes[:, :2].min(axis=0) - pen).tolist()
    right, top = (boxes[:, 2:].max(axis=0) + pen).tolist()
    return left, bottom, right, top
