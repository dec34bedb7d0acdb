"""Targets: read whatever holds a shape, trace a picture at a threshold, measure a shape."""

from __future__ import annotations

import os
import reprlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import BoolArray
from kirigami_studio.foundation.errors import KirigamiError, TargetError, UsageError
from kirigami_studio.foundation.steps import Cancel
from kirigami_studio.foundation.words import tr
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.merging import Join, Merged, Merging, merged, usual_outline
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.parts import ALL, LARGEST, SourceParts, Strokes
from kirigami_studio.outlines.pieces import largest_piece, rings_of
from kirigami_studio.outlines.read import PART_READERS, PICTURES, has_parts, is_picture, read_parts, read_target
from kirigami_studio.outlines.source_file import decoding, read_bytes
from kirigami_studio.outlines.starts import StartShape, outline_start
from kirigami_studio.pipeline.request import Request
from kirigami_studio.project.document import Document
from kirigami_studio.project.store import CUT_FILES, load
from kirigami_studio.settings.design import DesignSettings

if TYPE_CHECKING:
    from kirigami_studio.outlines.read_image import Traced
    from kirigami_studio.outlines.symmetry import TargetSymmetry

#: Problems of drawings whose lines may be meant as they are painted.
OPEN_LINES = ("lines.open_at", "lines.not_closed")
#: Longer side of the picture as it is kept for drawing, pixels.
LARGEST_SIDE = 1600


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture that a target is traced from; grey levels run from 0 (black) to 1 (white)."""

    path: Path
    #: automatic, threshold: 0..1; the grey level that suits the picture best, and the one it is traced at.
    automatic: float
    threshold: float
    traced: Traced | None = None  #: where the target lies in it
    #: (H, W, 4) uint8; the picture reduced for drawing: red, green, blue, opacity.
    seen: NDArray[np.uint8] | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class TargetRead:
    """A target that was read, with the picture that it was traced from, if it was."""

    outline: Outline
    picture: Picture | None = None


def outline_of(
    source: object,
    choice: PartChoice | None = None,
    threshold: float | None = None,
    fill_holes: bool | None = None,
) -> Outline:
    """The outline of a library silhouette, a file, points, a mask or a Shapely geometry.

    Parameters
    ----------
    choice : PartChoice, optional
        Of the parts of a drawing.
    threshold : float, 0..1, optional
        Grey level of a picture.
    fill_holes : bool, optional
        Whether holes are filled; by default those around which only a line would stay.

    Raises
    ------
    TargetError
        Nothing that holds one closed shape.
    UsageError
        Parts of what is no drawing.
    """
    return _seen(source, choice, threshold).with_holes(fill_holes)


def _seen(source: object, choice: PartChoice | None, threshold: float | None) -> Outline:
    """The outline with the holes that are seen as such."""
    if isinstance(source, (str, os.PathLike)):
        return _read(source, choice, threshold)
    if choice is not None:
        raise UsageError("parts.not_a_drawing", source=type(source).__name__, kinds=", ".join(PART_READERS))
    if isinstance(source, Outline):
        return source
    if isinstance(source, Polygon) and not source.is_empty and not source.is_valid:
        return Outline.from_points(source.exterior.coords)  # crossings are undone where it is clear what is meant
    if isinstance(source, BaseGeometry):
        piece, notes = largest_piece(source)
        ring, holes = rings_of(piece)
        return Outline.from_points(ring, notes=notes, holes=holes)
    try:
        values = np.asarray(source)
    except (TypeError, ValueError):  # rows of unequal lengths
        values = np.empty(0, dtype=object)
    if values.dtype.kind not in "biuf" or values.ndim != 2:
        raise TargetError("api.not_a_target", value=reprlib.repr(source))
    # No picture has three rows or columns: these are points with a height, or the wrong way round.
    is_mask = values.dtype.kind == "b" or min(values.shape) > 3
    return mask_outline(values, "mask") if is_mask else Outline.from_points(values)


def _read(source: str | os.PathLike[str], choice: PartChoice | None, threshold: float | None) -> Outline:
    """A library silhouette or a file, as the command line reads them."""
    if str(source) in silhouettes.names() and choice is None:
        return silhouettes.load(str(source))
    path = Path(source)
    if has_parts(path):
        return read_drawing(path, choice, threshold)
    if choice is not None:
        raise UsageError("parts.not_a_drawing", source=str(source), kinds=", ".join(PART_READERS))
    return read_target(source if isinstance(source, str) else path)


@dataclass(frozen=True, slots=True)
class PartChoice:
    """Which parts of a drawing are meant, and how they become one outline."""

    words: str  #: ``all``, ``largest``, or names, numbers and layers
    merging: Merging
    strokes: Strokes | None = None  #: places on the object in a picture, which is taken instead of parts

    @classmethod
    def of(
        cls,
        parts: str | None,
        join: str | None,
        bridge: float | None,
        stroke: float | None,
        taken: Sequence[tuple[float, float]] | None = None,
        left: Sequence[tuple[float, float]] | None = None,
    ) -> PartChoice | None:
        """What was said about parts, or of places on and beside an object; None where nothing was.

        Raises
        ------
        UsageError
            A width of bridges with another way to join, no such way, or parts and an object.
        """
        if taken or left:
            if (parts, join, bridge, stroke) != (None, None, None, None):
                raise UsageError("option.object_with_parts")
            return cls(LARGEST, Merging(), Strokes(tuple(taken or ()), tuple(left or ())))
        if parts is None and join is None and bridge is None and stroke is None:
            return None
        way = Join.UNION if bridge is None else Join.BRIDGE
        if join is not None:
            try:
                way = Join(join)
            except ValueError:
                choices = ", ".join(str(one.value) for one in Join)
                raise UsageError("settings.no_such_choice", name="join", value=join, choices=choices) from None
        if bridge is not None and way is not Join.BRIDGE:
            raise UsageError("option.bridge_without_join")
        several = way is not Join.UNION or stroke is not None
        words = parts if parts is not None else ALL if several else LARGEST
        return cls(words, Merging(way, bridge, stroke is not None, stroke or None))

    @property
    def is_each(self) -> bool:
        """Whether every piece is to be a sheet of its own."""
        return self.merging.join is Join.EACH

    def outline(self, path: Path, threshold: float | None = None) -> Outline:
        """The outline of the chosen parts of a file, or of the object; ``threshold`` is that of a picture.

        Raises
        ------
        UsageError
            They are several pieces, each to be a sheet of its own.
        """
        pieces = self.pieces(path, threshold)
        if len(pieces) > 1:
            raise UsageError("parts.several_targets", count=len(pieces))
        return pieces[0].outline

    def pieces(self, path: Path, threshold: float | None = None) -> tuple[PieceRead, ...]:
        """The outline, or that of each piece which is to be a sheet of its own."""
        if self.strokes is not None:
            return (PieceRead(_object(path, self.strokes)),)
        from kirigami_studio.outlines.read_image import image_parts

        source = image_parts(path, threshold) if is_picture(path) else read_parts(path)
        if not is_picture(path) and self == PartChoice(LARGEST, Merging()):
            return (PieceRead(usual_target(path, source)),)
        chosen = source.chosen(self.words)
        with decoding(path, "source.image_damaged"):
            found = merged(source, chosen, self.merging)
        return pieces_of(found)


@dataclass(frozen=True, slots=True)
class PieceRead:
    """A piece of a drawing that is a target by itself."""

    outline: Outline
    place: tuple[float, float] | None = None  #: of its area centroid in the drawing, source units, y up


def pieces_of(found: Merged) -> tuple[PieceRead, ...]:
    """The pieces of merged parts; one alone has no place."""
    if not found.others:
        return (PieceRead(found.outline),)
    return tuple(PieceRead(one.outline, one.place) for one in found.all)


def _object(path: Path, strokes: Strokes) -> Outline:
    """The outline of the object at some places of a picture."""
    from kirigami_studio.outlines.picked import picked_part

    if not is_picture(path):
        raise UsageError("object.no_picture", source=str(path), kinds=", ".join(PICTURES))
    source = SourceParts(path.stem, (replace(picked_part(path, strokes), number=1),), unit="px")
    return merged(source, source.parts, Merging()).outline


def usual_target(path: Path, source: SourceParts) -> Outline:
    """What is taken of the parts of a drawing without asking, as if the file was read as a target."""
    with decoding(path, "source.svg_damaged"):
        return usual_outline(source)


def read_drawing(path: Path, choice: PartChoice | None, threshold: float | None = None) -> Outline:
    """The outline of a file: of its parts as chosen, or as it is read by itself.

    A cut file of this program stands for the target of its design.
    """
    if threshold is not None and choice is None and is_picture(path):
        from kirigami_studio.outlines.read_image import read_image

        return read_image(path, threshold)
    if choice is not None and has_parts(path):
        return choice.outline(path, threshold)
    document = design_of(path)
    if document is not None and (target := document.target) is not None:
        said = tr("This is a cut file of Kirigami Studio: its design's target was taken.")
        return replace(target, notes=(*target.notes, said))
    try:
        return read_target(path)
    except TargetError as error:
        if isinstance(error.__cause__, TargetError) and error.__cause__.code in OPEN_LINES:
            raise TargetError("parts.or_as_painted", reason=error) from error
        raise


def design_of(path: Path) -> Document | None:
    """Project of the design in a cut file of this program; None for any other file."""
    if path.suffix.lower() not in CUT_FILES:
        return None
    try:
        return load(path)
    except KirigamiError:
        return None  # another program's drawing, or one that cannot be read: its reader says so


def mask_outline(mask: NDArray[np.generic], name: str) -> Outline:
    """The outline of a mask (H, W) of truth values or levels.

    Raises
    ------
    TargetError
        A level that is not finite, or no shape; the sentence names the input.
    """
    from kirigami_studio.outlines.read_image import outline_of_mask

    try:
        levels = np.asarray(mask, dtype=np.float64)
        if not np.all(np.isfinite(levels)):
            row, column = np.argwhere(~np.isfinite(levels))[0]
            raise TargetError("input.mask_not_finite", row=int(row), column=int(column))
        return outline_of_mask(inside_of(levels), name)
    except KirigamiError as error:
        raise TargetError("input.not_valid", name=name, reason=error) from error


def inside_of(levels: NDArray[Any]) -> BoolArray:
    """Pixels above half of the highest level; of a bool mask or 0 and 1, those that are set."""
    highest = max(float(levels.max(initial=0.0)), 0.0)
    inside: BoolArray = levels > 0.5 * highest
    return inside


# jobs -----------------------------------------------------------------------------------------------------------------


def reading_target(source: str, cancel: Cancel) -> Iterator[TargetRead]:
    """Read a file or a library silhouette."""
    path = Path(source)
    if is_picture(path):
        from kirigami_studio.outlines.read_image import automatic_threshold, trace_image

        level = automatic_threshold(path)
        traced = trace_image(path)
        yield TargetRead(traced.outline, Picture(path, level, level, traced, reduced_picture(path)))
    else:
        yield TargetRead(read_target(source))


def making_start(outline: Outline, cancel: Cancel) -> Iterator[StartShape]:
    """Make a drawn shape a start outline; one that is too hollow is refused."""
    yield outline_start(outline)


def checking_start(
    outline: Outline, settings: DesignSettings, request: Request | None, cancel: Cancel
) -> Iterator[str]:
    """Find out why the next run would refuse a drawn start, one sentence, or "" where it would not.

    The run is the ``request`` with another start; without one, as there is no target yet, its grid is the settings'.
    """
    from kirigami_studio.pipeline.auto_grid import predicted_for

    start, grid = outline_start(outline), settings.grid
    try:
        if request is not None:
            asked = replace(request, start=start)
            grid = predicted_for(asked).grid if asked.grid is None else asked.grid
    except KirigamiError as error:  # such as a symmetry that the start cannot have
        yield str(error)
    else:
        yield start_refusal(start, grid, settings.rim)


def start_refusal(start: StartShape, grid: tuple[int, int], rim: str) -> str:
    """Why a run on a grid would refuse a start, one sentence; "" where it would not."""
    from kirigami_studio.polish.flat_sheet import first_sheet

    try:
        first_sheet(grid, start, free_rim=rim == "free")
    except KirigamiError as error:
        return str(error)
    return ""


def tracing(picture: Picture, cancel: Cancel) -> Iterator[Traced]:
    """Trace a picture at its threshold."""
    from kirigami_studio.outlines.read_image import trace_image

    yield trace_image(picture.path, picture.threshold)


def reduced_picture(path: Path) -> NDArray[np.uint8] | None:
    """Return a picture turned upright and reduced; None when it cannot be read.

    A large photo takes a third of a second to read, hence this is done in a worker.

    Returns
    -------
    (H, W, 4) uint8 or None
        Red, green, blue, opacity, row 0 on top; the longer side is at most ``LARGEST_SIDE`` pixels.
    """
    from PIL import Image, ImageOps

    from kirigami_studio.outlines.read_image import opened_image, stretched

    try:
        with decoding(path, "source.image_damaged"):
            image = ImageOps.exif_transpose(opened_image(read_bytes(path)))
            if image.mode.startswith(("I", "F")):
                levels = stretched(np.asarray(image, dtype=np.float64))
                image = Image.fromarray((255.0 * levels).astype(np.uint8))
            image = image.convert("RGBA")
            image.thumbnail((LARGEST_SIDE, LARGEST_SIDE))
    except KirigamiError:
        return None
    return np.asarray(image)


@dataclass(frozen=True, slots=True)
class TargetReading:
    """What a target's shape says."""

    symmetry: str  #: how symmetric it is, in one or two sentences
    #: (rows, columns); what a run would choose, as far as that is known without trying; None where the settings ask for
    #: a symmetry that the target is far from.
    grid: tuple[int, int] | None
    reason: str  #: why, in one sentence
    start_refusal: str = ""  #: why the run would refuse the start on that grid, in one sentence; "" where it would not


def reading_shape(request: Request, chosen: tuple[int, int] | None, cancel: Cancel) -> Iterator[TargetReading]:
    """Measure how symmetric a request's target is; take the ``chosen`` grid, or choose one."""
    from kirigami_studio.outlines.symmetry import symmetry_of
    from kirigami_studio.pipeline.auto_grid import known_for

    found = _symmetry_sentence(symmetry_of(request.target))
    try:
        choice = known_for(request)
    except KirigamiError as error:
        yield TargetReading(found, None, str(error))
    else:
        expected, reason = choice.grid, choice.reason
        if chosen is not None:
            rows, columns = expected = chosen
            reason = tr(
                "It chose {rows} x {columns} voids for this target.",
                rows=rows,
                columns=columns,
            )
        grid = expected if request.grid is None else request.grid
        yield TargetReading(found, expected, reason, start_refusal(request.start, grid, request.rim))


def _symmetry_sentence(found: TargetSymmetry) -> str:
    """The best axis and turn of a target, with what counts as symmetric."""
    from kirigami_studio.outlines.symmetry import TOLERANCE

    mirror, turn = found.axes[0].overlap, max(found.half_turn, found.quarter_turn)
    numbers = {"mirror": 100.0 * mirror, "turn": 100.0 * turn, "least": 100.0 * TOLERANCE}
    if mirror >= TOLERANCE and turn >= TOLERANCE:
        return tr("Symmetric target: {mirror:.1f} % alike mirrored, {turn:.1f} % turned.", **numbers)
    if mirror >= TOLERANCE:
        return tr("Target with a mirror axis: {mirror:.1f} % alike mirrored.", **numbers)
    if turn >= TOLERANCE:
        return tr("Target that can be turned: {turn:.1f} % alike.", **numbers)
    return tr(
        "The target is not symmetric: {mirror:.1f} % alike mirrored, {turn:.1f} % turned ({least:.1f} % count).",
        **numbers,
    )
