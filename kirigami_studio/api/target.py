"""Targets of anything that holds a shape: names, files, points, masks, Shapely geometry."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy.typing as npt
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.api.pictures import target_picture
from kirigami_studio.api.values import read_only
from kirigami_studio.evaluate.silhouette import RasterFrame, rasterise, rasterise_in_frame
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.paper import MASK_SIZE
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.studio.targets import PartChoice, outline_of


@read_only
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Target:
    """A silhouette for sheets to show: simple, of area 1 about its centroid, maybe with holes.

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
        """Outer ring (L, 2), counter-clockwise, y up, area 1 about the origin; read-only."""
        return self.outline.points

    @property
    def polygon(self) -> Polygon:
        """The same as a Shapely polygon: what lies within the outer ring."""
        return Polygon(self.points)

    @property
    def holes(self) -> tuple[FloatArray, ...]:
        """Rings (H, 2) of what is missing within the outer ring, clockwise; read-only."""
        return self.outline.holes

    @property
    def region(self) -> Polygon:
        """The shape as a Shapely polygon with its holes."""
        return self.outline.polygon

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences about all that was left out or changed on the way from the source."""
        return self.outline.notes

    def mask(self, size: int = MASK_SIZE) -> BoolArray:
        """Its picture (size, size), row 0 on top; the longer side fills it."""
        mask = rasterise(self.points, size)
        frame = RasterFrame.around(self.points, size)
        for hole in self.holes:
            mask &= ~rasterise_in_frame(hole, frame)
        return mask

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Target) and self.outline == other.outline

    def __hash__(self) -> int:
        return hash(self.outline)

    def __repr__(self) -> str:
        holes = {0: "", 1: ", 1 hole"}.get(len(self.holes), f", {len(self.holes)} holes")
        return f"<Target {self.name!r}: {len(self.points)} points{holes}>"

    def _repr_svg_(self) -> str:
        return target_picture(self.outline.rings, self.name)


#: What :func:`load_target` reads.
TargetLike: TypeAlias = "Target | Outline | str | os.PathLike[str] | npt.ArrayLike | BaseGeometry"


def load_target(
    source: TargetLike,
    *,
    name: str | None = None,
    parts: str | None = None,
    join: Literal["union", "bridge", "hull", "tight"] | None = None,
    bridge: float | None = None,
    stroke: float | None = None,
    threshold: float | None = None,
    object_at: Sequence[tuple[float, float]] | None = None,
    not_object_at: Sequence[tuple[float, float]] | None = None,
    fill_holes: bool | None = None,
) -> Target:
    """Make a target of a library silhouette, a file, points, a mask or a Shapely geometry.

    Parameters
    ----------
    source : str, path, array or geometry
        A name out of :func:`target_names`; an image, SVG, DXF, PDF, AI or JSON file; vertices (L, 2), y up; a mask
        (H, W), row 0 on top, of which is inside what is above half of its highest value; a polygon or several, of which
        the largest piece counts, with its holes.
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
        Level that separates the shape of a picture from its background; found by itself unless given.  Grey level of
        pictures in grey, of others how much alike the background a pixel is.
    object_at, not_object_at : sequence of (x, y), optional
        Places on the object in a picture, which is taken instead of the largest shape, and places beside it; pixels
        from the upper left corner.
    fill_holes : bool, optional
        True fills all holes, False keeps all; by default those are filled around which only a line would stay.

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
    choice = PartChoice.of(parts, join, bridge, stroke, object_at, not_object_at)
    outline = outline_of(source.outline if isinstance(source, Target) else source, choice, threshold, fill_holes)
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
