"""The shape that a sheet has while it is flat: a rectangle, a circle, a polygon, or a silhouette, hollows and all."""

from __future__ import annotations

import hashlib
import math
import re
from dataclasses import dataclass, field, replace

import numpy as np
import shapely

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import SheetError, UsageError
from kirigami_studio.foundation.plain_text import plain_line
from kirigami_studio.foundation.settings import Setting, check
from kirigami_studio.foundation.words import mark
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.proportions import Proportions
from kirigami_studio.outlines.read import read_target
from kirigami_studio.outlines.symmetry import TOLERANCE, symmetry_of, turned
from kirigami_studio.outlines.turning import sides_needed, turn_back

#: Vertices of circles and ellipses: their areas are within 0.002 % of the true ones.
ROUND_VERTICES = 720
#: Shapes that are longer by this share are as long.
ROUNDING = 1e-3
FEWEST_SIDES, MOST_SIDES = 3, 64
#: Longest start over its width.
LONGEST = 5.0
#: Proportions of an ellipse without any.
USUAL_ELLIPSE = 1.5
#: Hollows of a loaded shape up to this share of its hull are filled: traced pictures have such edges.
FILLED = 0.01
#: A shape of which more than this share of its hull is missing is no start.  Of all other shapes of the library, an
#: unfolded sheet was found at 11 x 11 and at 14 x 15 voids.
MOST_HOLLOW = 0.35
#: Points of a loaded shape may move by this (unit-area lengths).
ACCURACY = 1e-4
#: A mirror axis within this (radians) of upright or level stays where it is.
UPRIGHT = 1e-3
#: Weight of a start unless another is asked for.
USUAL_WEIGHT = 1.0
#: Weight at most of a start that is held loosely.
LOOSE = 0.01
#: What :func:`start_shape` reads beside files and library names.
KINDS = ("auto", "rectangle", "square", "circle", "ellipse", "triangle", "hexagon", "gable", "notch")
#: Rectangles with a fifth corner on the axis, and with a notch there.
GABLE = ((-1.0, -1.0), (1.0, -1.0), (1.0, 0.7), (0.0, 1.3), (-1.0, 0.7))
NOTCH = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (0.35, 1.0), (0.0, 0.3), (-0.35, 1.0), (-1.0, 1.0))


@dataclass(frozen=True, slots=True)
class StartShape:
    """What flat sheets look like, whatever their grid.

    Attributes
    ----------
    name : str
        As the command line takes it, e.g. "ellipse:3:2", or the name of a file or of a library silhouette.
    outline : Outline or None
        Its mirror axis is upright if it has one; None for a rectangle.
    aspect : float or None
        Width over height of a rectangle; None for square cells, whatever the grid.
    weight : float, above 0, up to 10
        How firmly fits hold round parts and hollows of the outline, see ``polish.chords``: below 1 the flat sheet may
        be a little off its start for a better match.  Straight sides between sharp corners are met at any weight.

    Raises
    ------
    UsageError
        A weight out of range.
    """

    name: str = "rectangle"
    outline: Outline | None = None
    aspect: float | None = None
    weight: float = field(
        default=USUAL_WEIGHT,
        metadata=Setting(
            about=mark(
                "How firmly the flat sheet is held to a round or hollow start ({low:g} to {most:g}). Below 1 the "
                "target is matched more closely and the start less."
            ),
            least=0.0,
            above_least=True,
            most=10.0,
            code="start.weight_out_of_range",
            help="how firmly round parts and hollows of the start are held: at 0.01, say, the flat sheet may be a "
            "little off for a better match",
            label=mark("Start weight"),
            spoken=mark("Weight of the start"),
            widget="startWeight",
            low=0.01,
            step=0.1,
            option="--start-weight",
            keyword="start_weight",
            metavar="WEIGHT",
        ).metadata,
    )

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", plain_line(self.name))
        check(self)

    def held_loosely(self) -> StartShape:
        """Lower the weight, for sheets whose pieces are cut to the start; rectangles are met at any weight."""
        return self if self.outline is None else replace(self, weight=min(self.weight, LOOSE))

    @property
    def is_plain(self) -> bool:
        """Whether it is the paper's rectangle of square cells, or left to the run."""
        return self.outline is None and self.aspect is None

    @property
    def is_auto(self) -> bool:
        """Whether runs choose it."""
        return self.is_plain and self.name == AUTO

    def proportion(self, rows: int, columns: int) -> float:
        """Logarithm of height over width of a sheet of so many voids; of other shapes than rectangles by moments."""
        if self.outline is not None:
            return Proportions.of(self.outline).along(0.5 * math.pi)
        return math.log((rows + 1) / (columns + 1)) if self.aspect is None else -math.log(self.aspect)

    @property
    def sides(self) -> float:
        """Number of its straight sides; endless where it is round."""
        if self.outline is None:
            return 4
        count = len(self.outline.points)
        return count if count <= MOST_SIDES else math.inf

    @property
    def digest(self) -> str:
        """The start of the SHA-256 of its points, or nothing for a rectangle: names of files say little."""
        return "" if self.outline is None else hashlib.sha256(self.outline.points.tobytes()).hexdigest()[:16]


RECTANGLE = StartShape()
#: Name of a start that runs choose.
AUTO = "auto"

#: Closed sheets show a notch badly that turns back by this (radians), and not at all from half a turn on.
TURNS_BACK = math.radians(170.0)


def no_closed_sheet_shows(target: Outline, start: StartShape = RECTANGLE) -> bool:
    """Whether a target turns back too far, or has more arms than a start has sides."""
    return turn_back(target).angle >= TURNS_BACK or sides_needed(target) > start.sides


def start_shape(text: str) -> StartShape:
    """The shape that a text names.

    Parameters
    ----------
    text : str
        ``auto`` (runs choose it), ``rectangle`` (of square cells), ``rectangle:W:H``, ``square``, ``circle``,
        ``ellipse`` (3:2), ``ellipse:W:H``, ``triangle``, ``hexagon``, ``polygon:N``, ``gable``, ``notch``, a file that
        holds a shape, or the name of a library silhouette.

    Raises
    ------
    UsageError
        Numbers that no such shape has.
    SheetError
        A shape that is too long, or whose hollows are too large.
    TargetError
        Neither such a name nor a file or silhouette that can be read.
    """
    kind, *numbers = text.strip().lower().split(":")
    match (kind, len(numbers)):
        case ("rectangle", 0):
            return RECTANGLE
        case ("auto", 0):
            return StartShape(AUTO)
        case ("gable", 0):
            return StartShape("gable", Outline.from_points(np.array(GABLE), "gable"))
        case ("notch", 0):
            return StartShape("notch", Outline.from_points(np.array(NOTCH), "notch"))
        case ("square", 0):
            return StartShape("square", None, 1.0)
        case ("rectangle", 2):
            return StartShape(f"rectangle:{numbers[0]}:{numbers[1]}", None, _aspect(text, numbers))
        case ("circle", 0):
            return _round("circle", 1.0)
        case ("ellipse", 0):
            return _round("ellipse", USUAL_ELLIPSE)
        case ("ellipse", 2):
            return _round(f"ellipse:{numbers[0]}:{numbers[1]}", _aspect(text, numbers))
        case ("triangle", 0):
            return _polygon("triangle", 3)
        case ("hexagon", 0):
            return _polygon("hexagon", 6)
        case ("polygon", 1):
            return _polygon(f"polygon:{numbers[0]}", _sides(text, numbers[0]))
        case ("rectangle" | "ellipse" | "polygon", _):
            raise UsageError("start.wrong_numbers", text=text, longest=LONGEST, most=MOST_SIDES)
        case _:
            return outline_start(read_target(text.strip()))


def outline_start(outline: Outline) -> StartShape:
    """A shape that was drawn, loaded or taken from the library as a start; small hollows are filled.

    Raises
    ------
    SheetError
        It is too long, or too much of its hull is missing; the sentence says where the deepest hollow is.
    """
    outline = outline.filled
    length = math.exp(Proportions.of(outline).longest)
    if length > LONGEST * (1.0 + ROUNDING):
        raise SheetError("start.too_long", name=outline.name, length=length, longest=LONGEST)
    check_hollows(outline)
    hull = outline.polygon.convex_hull
    shape = hull if hull.area <= 1.0 + FILLED else outline.polygon
    points = shapely.get_coordinates(shapely.boundary(shape).simplify(ACCURACY))[:-1]
    return StartShape(outline.name, _upright(Outline.from_points(points, outline.name)))


def check_hollows(outline: Outline) -> None:
    """Refuse a shape that is missing too much of its hull.

    Raises
    ------
    SheetError
        The sentence says where the deepest hollow is.
    """
    hull = outline.polygon.convex_hull
    if 1.0 - 1.0 / hull.area > MOST_HOLLOW:
        deepest = int(np.argmax(shapely.distance(shapely.boundary(hull), shapely.points(outline.points))))
        low, high = outline.points.min(axis=0), outline.points.max(axis=0)
        across, up = 100.0 * (outline.points[deepest] - low) / (high - low)
        raise SheetError(
            "start.hollow", name=outline.name, percent=100.0 * (1.0 - 1.0 / hull.area), across=across, up=up
        )


def hollows(outline: Outline) -> tuple[FloatArray, ...]:
    """What is missing to a convex shape, (P, 2) each; nothing where so little is missing that it will be filled."""
    shape = outline.filled.polygon
    hull = shape.convex_hull
    if hull.area <= 1.0 + FILLED:
        return ()
    parts = shapely.get_parts(hull.difference(shape))
    return tuple(shapely.get_coordinates(part.exterior)[:-1] for part in parts if part.area > 0.1 * FILLED)


def _upright(outline: Outline) -> Outline:
    """The shape turned so that its best mirror axis is upright, unless it has one that is upright or level."""
    axes = symmetry_of(outline).mirrors(TOLERANCE)
    if not axes or any(abs(math.remainder(axis.angle, 0.5 * math.pi)) < UPRIGHT for axis in axes):
        return outline
    return Outline.from_points(turned(outline.points, 0.5 * math.pi - axes[0].angle), outline.name)


def _round(name: str, aspect: float) -> StartShape:
    """An ellipse; no vertex lies on an axis, so that both halves have the same."""
    angle = 2.0 * math.pi * (np.arange(ROUND_VERTICES) + 0.5) / ROUND_VERTICES
    return StartShape(name, Outline.from_points(np.column_stack([aspect * np.cos(angle), np.sin(angle)]), name))


def _polygon(name: str, sides: int) -> StartShape:
    """A regular polygon: a corner on top, or a side where there is one below it too."""
    first = 0.5 * math.pi + (math.pi / sides if sides % 4 == 0 else 0.0)
    angle = first + 2.0 * math.pi * np.arange(sides) / sides
    return StartShape(name, Outline.from_points(np.column_stack([np.cos(angle), np.sin(angle)]), name))


def _aspect(text: str, numbers: list[str]) -> float:
    """Width over height of two positive numbers."""
    if all(re.fullmatch(r"\d+(\.\d+)?", number) for number in numbers):
        width, height = (float(number) for number in numbers)
        if min(width, height) > 0.0 and 1.0 / LONGEST <= width / height <= LONGEST:
            return width / height
    raise UsageError("start.wrong_numbers", text=text, longest=LONGEST, most=MOST_SIDES)


def _sides(text: str, number: str) -> int:
    if re.fullmatch(r"\d{1,3}", number) and FEWEST_SIDES <= int(number) <= MOST_SIDES:
        return int(number)
    raise UsageError("start.wrong_numbers", text=text, longest=LONGEST, most=MOST_SIDES)
