"""Targets out of whatever holds a shape: library names, files, points, masks, Shapely geometry."""

from __future__ import annotations

import os
import reprlib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.api.pictures import target_picture
from kirigami_studio.evaluate.silhouette import rasterise
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.errors import KirigamiError, TargetError, UsageError
from kirigami_studio.foundation.paper import MASK_SIZE
from kirigami_studio.foundation.words import tr
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.merging import Join, Merging, merged
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.parts import ALL, LARGEST
from kirigami_studio.outlines.pieces import largest_piece
from kirigami_studio.outlines.read import PART_READERS, read_parts, read_target
from kirigami_studio.outlines.read_image import image_parts, outline_of_mask, read_image
from kirigami_studio.project.store import CUT_FILES, load

IMAGE_SUFFIXES = (".png", ".jpg", ".jpeg", ".bmp")
#: Problems of drawings whose lines may be meant as they are painted.
OPEN_LINES = ("lines.open_at", "lines.not_closed")


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Target:
    """A silhouette that sheets are to show: closed, simple, of area 1 about its centroid.

    In a notebook it shows itself.

    Attributes
    ----------
    outline : Outline
        The value of the program that it wraps.
    """

    outline: Outline

    @property
    def name(self) -> str:
        return self.outline.name

    @property
    def points(self) -> FloatArray:
        """Vertices (L, 2), counter-clockwise, y up, area 1, centroid at the origin; read-only."""
        return self.outline.points

    @property
    def polygon(self) -> Polygon:
        """The same as a Shapely polygon."""
        return self.outline.polygon

    @property
    def notes(self) -> tuple[str, ...]:
        """What was left out or changed on the way from the source, one sentence each."""
        return self.outline.notes

    def mask(self, size: int = MASK_SIZE) -> BoolArray:
        """Its picture (size, size), row 0 on top; the longer side fills it."""
        return rasterise(self.points, size)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Target) and self.outline == other.outline

    def __hash__(self) -> int:
        return hash(self.outline)

    def __repr__(self) -> str:
        return f"<Target {self.name!r}: {len(self.points)} points>"

    def _repr_svg_(self) -> str:
        return target_picture(self.points, self.name)


#: What :func:`load_target` reads.
TargetLike: TypeAlias = "Target | Outline | str | os.PathLike[str] | npt.ArrayLike | BaseGeometry"


def load_target(
    source: TargetLike,
    *,
    name: str | None = None,
    parts: str | None = None,
    join: str | None = None,
    bridge: float | None = None,
    stroke: float | None = None,
    threshold: float | None = None,
) -> Target:
    """Make a target of a library silhouette, a file, points, a mask or a Shapely geometry.

    Parameters
    ----------
    source : str, path, array or geometry
        A name out of :func:`target_names`; an image, SVG, DXF or JSON file; vertices (L, 2), y up; a mask (H, W), row 0
        on top, of which is inside what is above half of its highest value; a polygon or several, of which the largest
        piece counts, its holes filled.
    name : str, optional
        What it is called; by default as its source.
    parts : str, optional
        Of a drawing or picture: ``all``, ``largest``, or names, numbers, layers or colours, joined by commas.
    join : str, optional
        How parts become one outline: ``union``, ``bridge``, ``hull`` or ``tight``.
    bridge : float, optional
        Width of bridges, in the file's unit.
    stroke : float, optional
        Takes lines as they are painted, with their own width, or this one where they have none (0: 2 % of the size).
    threshold : float, 0..1, optional
        Grey level that separates the shape of a picture from its background; found by itself unless given.

    Raises
    ------
    TargetError
        Nothing that holds one closed shape.
    UsageError
        Options that this source does not have.

    Examples
    --------
    >>> import kirigami_studio as ks
    >>> ks.load_target("heart")
    <Target 'heart': 114 points>
    >>> ks.load_target([(0, 0), (4, 0), (0, 3)], name="triangle")
    <Target 'triangle': 3 points>
    """
    if threshold is not None and not 0.0 < threshold < 1.0:
        raise UsageError("option.threshold", value=threshold)
    choice = PartChoice.of(parts, join, bridge, stroke)
    outline = _outline(source, choice, threshold)
    return Target(outline if name is None else replace(outline, name=str(name)))


def target_names() -> tuple[str, ...]:
    """Names of the silhouettes in the library, as the command line's ``targets`` lists them.

    Examples
    --------
    >>> import kirigami_studio as ks
    >>> "butterfly" in ks.target_names()
    True
    """
    return silhouettes.names()


def _outline(source: object, choice: PartChoice | None, threshold: float | None) -> Outline:
    if isinstance(source, (str, os.PathLike)):
        return _read(source, choice, threshold)
    if choice is not None:
        raise UsageError("parts.not_a_drawing", source=type(source).__name__, kinds=", ".join(PART_READERS))
    if isinstance(source, Target):
        return source.outline
    if isinstance(source, Outline):
        return source
    if isinstance(source, Polygon) and not source.is_empty and not source.is_valid:
        return Outline.from_points(source.exterior.coords)  # crossings are undone where it is clear what is meant
    if isinstance(source, BaseGeometry):
        ring, notes = largest_piece(source)
        return Outline.from_points(ring, notes=notes)
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
    if path.suffix.lower() in PART_READERS:
        return read_drawing(path, choice, threshold)
    if choice is not None:
        raise UsageError("parts.not_a_drawing", source=str(source), kinds=", ".join(PART_READERS))
    return read_target(source if isinstance(source, str) else path)


@dataclass(frozen=True, slots=True)
class PartChoice:
    """Which parts of a drawing are meant, and how they become one outline.

    Attributes
    ----------
    words : str
        ``all``, ``largest``, or names, numbers and layers.
    merging : Merging
    """

    words: str
    merging: Merging

    @classmethod
    def of(cls, parts: str | None, join: str | None, bridge: float | None, stroke: float | None) -> PartChoice | None:
        """What was said about parts; None where nothing was.

        Raises
        ------
        UsageError
            A width of bridges with another way to join, or no such way.
        """
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

    def outline(self, path: Path, threshold: float | None = None) -> Outline:
        """The outline of the chosen parts of a file; ``threshold`` is that of a picture."""
        is_picture = path.suffix.lower() in IMAGE_SUFFIXES
        source = image_parts(path, threshold) if is_picture else read_parts(path)
        try:
            return merged(source, source.chosen(self.words), self.merging).outline
        except TargetError as error:
            raise TargetError("source.not_usable", name=path.name, reason=error) from error


def read_drawing(path: Path, choice: PartChoice | None, threshold: float | None = None) -> Outline:
    """The outline of a file: of its parts as chosen, or as it is read by itself.

    A cut file of this program stands for the target of its design.
    """
    if threshold is not None and choice is None and path.suffix.lower() in IMAGE_SUFFIXES:
        return read_image(path, threshold)
    if choice is not None and path.suffix.lower() in PART_READERS:
        return choice.outline(path, threshold)
    if path.suffix.lower() in CUT_FILES and (target := _own_target(path)) is not None:
        return target
    try:
        return read_target(path)
    except TargetError as error:
        if isinstance(error.__cause__, TargetError) and error.__cause__.code in OPEN_LINES:
            raise TargetError("parts.or_as_painted", reason=error) from error
        raise


def _own_target(path: Path) -> Outline | None:
    """The target of the design that a cut file of this program carries; None for any other file."""
    try:
        document = load(path)
    except KirigamiError:
        return None  # another program's drawing, or one that cannot be read: its reader says so
    if document.target is None:
        return None
    said = tr("This is a cut file of Kirigami Studio: its design's target was taken.")
    return replace(document.target, notes=(*document.target.notes, said))


def mask_outline(mask: npt.NDArray[np.generic], name: str) -> Outline:
    """The outline of a mask (H, W) of truth values or levels.

    Raises
    ------
    TargetError
        A level that is not finite, or no shape; the sentence names the input.
    """
    try:
        levels = np.asarray(mask, dtype=np.float64)
        if not np.all(np.isfinite(levels)):
            row, column = np.argwhere(~np.isfinite(levels))[0]
            raise TargetError("input.mask_not_finite", row=int(row), column=int(column))
        return outline_of_mask(inside_of(levels), name)
    except KirigamiError as error:
        raise TargetError("input.not_valid", name=name, reason=error) from error


def inside_of(levels: npt.NDArray[Any]) -> BoolArray:
    """Pixels above half of the highest level; of a bool mask or 0 and 1, those that are set."""
    highest = max(float(levels.max(initial=0.0)), 0.0)
    inside: BoolArray = levels > 0.5 * highest
    return inside
