"""Pictures printed on a sheet: laid on the flat sheet or on the opened one, each panel takes what lies below it.

A panel is rigid: between the flat sheet and any angle it turns and shifts, all of it alike, and the pose over the
target scales.  So what a panel shows comes from its picture by one similarity, and a printed sheet is a list of
patches: a region of the flat sheet, a picture, and the similarity that brings the one to the other.

Points of the plane are complex numbers x + iy with y up, pixels are u + iv with v down from the picture's upper left
corner; a picture with the map (a, b) shows its pixel p at a conj(p) + b.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.evaluate.posed_design import PosedDesign, polygons_of
from kirigami_studio.export.artwork_picture import ArtPicture
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.fabricate.panel_sizes import panels_in_mm
from kirigami_studio.foundation.arrays import ComplexArray, FloatArray
from kirigami_studio.foundation.errors import ExportError

#: Panels overlap under the next one by half a kerf, and by this (mm) at least, so that no paper shines through.
LEAST_OVERLAP_MM = 0.1
#: Vertices are snapped to this grid (mm).
GRID_MM = 1e-5
#: Smaller pieces (mm^2) are rounding.
DUST_MM2 = 1e-6
#: Corners of bleeds are sharp up to this many times their width.
MITRE = 3.0
MOST_BLEED_MM = 20.0
#: A picture that fills the box also covers so much around it, in longer sides of the box: room for the bleed.
BEYOND = 0.02
SMALLEST_SCALE, LARGEST_SCALE = 0.01, 100.0


class State(Enum):
    """Where a picture is seen whole."""

    TARGET = "target"
    FLAT = "flat"


class Fitting(Enum):
    """How large a picture is laid: all of it inside the box of the state, or all of the box covered."""

    FIT = "fit"
    FILL = "fill"


@dataclass(frozen=True, slots=True)
class Laid:
    """A picture and where it lies.

    Attributes
    ----------
    picture : ArtPicture
    state : State
        On the target, or on the flat sheet.
    fitting : Fitting
        Into the box around the target, or around the flat sheet.
    scale : float
        Times the size that ``fitting`` gives, above 0.
    turn : float, radians
        Counter-clockwise, about the picture's middle.
    shift : (x, y)
        Of the picture's middle from the box's, in widths and heights of the box.

    Raises
    ------
    ExportError
        Numbers that no placed picture has.
    """

    picture: ArtPicture
    state: State = State.TARGET
    fitting: Fitting = Fitting.FILL
    scale: float = 1.0
    turn: float = 0.0
    shift: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        numbers = (self.scale, self.turn, *self.shift)
        if not all(map(math.isfinite, numbers)) or not SMALLEST_SCALE <= self.scale <= LARGEST_SCALE:
            raise ExportError(
                "artwork.impossible_place", scale=self.scale, smallest=SMALLEST_SCALE, largest=LARGEST_SCALE
            )

    def map_into(self, low: FloatArray, high: FloatArray) -> tuple[complex, complex]:
        """The picture's map (a, b) into the frame of a box from ``low`` (2,) to ``high`` (2,)."""
        size = high - low
        if self.fitting is Fitting.FILL:
            size = size + 2.0 * BEYOND * float(size.max())
        width, height = self.picture.size
        ratios = (float(size[0]) / width, float(size[1]) / height)
        length = min(ratios) if self.fitting is Fitting.FIT else max(ratios)
        factor = self.scale * length * cmath.exp(1j * self.turn)
        x, y = (0.5 * (low + high) + np.array(self.shift) * (high - low)).tolist()
        return factor, complex(x, y) - factor * complex(0.5 * width, -0.5 * height)


@dataclass(frozen=True, slots=True)
class Artwork:
    """What is printed on a sheet.

    Attributes
    ----------
    first : Laid
    """

    first: Laid


@dataclass(frozen=True, slots=True, eq=False)
class PrintedSheet:
    """A sheet as it is printed and as it opens.

    Attributes
    ----------
    design : PosedDesign
        The sheet that is cut, over its target.
    target : (L, 2) float or None, world
    corners : (K, 4, 2) float, mm
        Whole panels of the flat sheet, row by row, in the frame of the cuts.
    cells : tuple of (P, 2) float, mm
        What there is of them, between the centre lines of the cuts; no points where nothing is.
    """

    design: PosedDesign
    target: FloatArray | None
    corners: FloatArray
    cells: tuple[FloatArray, ...]

    @classmethod
    def of(cls, job: ExportJob) -> PrintedSheet:
        """The sheet of a job's cut plan.

        Raises
        ------
        ExportError
            The job has no plan.
        """
        plan, design = job.required_plan, job.posed
        parts = () if job.trim is None else job.trim.kept
        width = plan.size_mm[0]
        unmoved = panels_in_mm(design.deployment, parts, width, np.zeros(2))
        place = next(number for number, cell in enumerate(plan.panels) if len(cell))
        origin = unmoved[place][0] - plan.panels[place][0]
        corners = np.array(panels_in_mm(design.deployment, (), width, origin))
        return cls(design, job.target, corners, plan.panels)

    @classmethod
    def uncut(cls, design: PosedDesign, target: FloatArray | None, width_mm: float) -> PrintedSheet:
        """The sheet of a design whose cuts are not planned, its lower left corner at (0, 0)."""
        parts = () if design.trim is None else design.trim.kept
        cells = panels_in_mm(design.deployment, parts, width_mm, np.zeros(2))
        return cls(design, target, np.array(panels_in_mm(design.deployment, (), width_mm, np.zeros(2))), cells)

    def motion(self, phi: float) -> Motion:
        """How the panels come from the flat sheet (mm) to the world at an angle."""
        flat = as_plane(self.corners)
        there = as_plane(self.design.panels(self.design.nodes(phi)))
        flat_middle, there_middle = flat.mean(axis=1), there.mean(axis=1)
        arms = flat - flat_middle[:, None]
        weight = np.maximum(np.sum(np.abs(arms) ** 2, axis=1), 1e-300)
        factor = np.sum((there - there_middle[:, None]) * np.conj(arms), axis=1) / weight
        return Motion(factor, there_middle - factor * flat_middle)

    def box(self, state: State) -> FloatArray:
        """Lower left and upper right corner (2, 2) of what pictures are laid on: world, or mm of the flat sheet."""
        if state is State.FLAT:
            points = np.concatenate(self.cells)
        else:
            opened = self.design.parts(self.design.phi_target)
            points = np.concatenate(opened if self.target is None else [*opened, self.target])
        return np.stack([points.min(axis=0), points.max(axis=0)])


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """One similarity for each panel: flat mm -> world, ``factor * z + shift``.

    Attributes
    ----------
    factor, shift : (K,) complex
    """

    factor: ComplexArray
    shift: ComplexArray


@dataclass(frozen=True, slots=True, eq=False)
class Patch:
    """A region that shows a part of a picture.

    Attributes
    ----------
    panel : int
        Number of the panel that it moves with.
    region : Polygon or MultiPolygon, mm
        Of the flat sheet, or of the opened one.
    picture : ArtPicture
    factor, shift : complex
        The picture's map into the region's frame.
    """

    panel: int
    region: BaseGeometry
    picture: ArtPicture
    factor: complex
    shift: complex

    @property
    def dots_per_mm(self) -> float:
        """Pixels of the picture on a millimetre."""
        return 1.0 / abs(self.factor)

    def moved(self, factor: complex, shift: complex) -> Patch:
        """The patch in another frame: z -> factor z + shift."""
        region = shapely.transform(self.region, lambda points: as_points(as_plane(points) * factor + shift))
        return Patch(self.panel, region, self.picture, self.factor * factor, self.shift * factor + shift)


def printed_patches(artwork: Artwork, sheet: PrintedSheet, bleed_mm: float, kerf_mm: float) -> tuple[Patch, ...]:
    """What is printed on the flat sheet, to be painted in this order.

    Parameters
    ----------
    artwork : Artwork
    sheet : PrintedSheet
    bleed_mm : float
        How far panels at the edge are printed beyond it, and into gaps that trimming has left.
    kerf_mm : float
        Panels go on under the next one by half of it, where the beam takes them away.

    Raises
    ------
    ExportError
        A bleed that is negative or wider than 20 mm.
    """
    if not 0.0 <= bleed_mm <= MOST_BLEED_MM:
        raise ExportError("artwork.impossible_bleed", bleed_mm=bleed_mm, most=MOST_BLEED_MM)
    regions = _regions(sheet.cells, bleed_mm, max(0.5 * kerf_mm, LEAST_OVERLAP_MM))
    return _patches(artwork, sheet, regions)


def opened_patches(artwork: Artwork, sheet: PrintedSheet, phi: float, overlap_mm: float = 0.0) -> tuple[Patch, ...]:
    """What the printed sheet shows at an angle, in mm: the panels, grown by ``overlap_mm`` on all sides."""
    cells = polygons_of(sheet.cells)
    regions = shapely.buffer(cells, overlap_mm, join_style="mitre", mitre_limit=MITRE) if overlap_mm else cells
    scale = sheet.design.mm_per_world(float(np.ptp(sheet.corners[..., 0])))
    motion = sheet.motion(phi)
    return tuple(
        patch.moved(complex(motion.factor[patch.panel]) * scale, complex(motion.shift[patch.panel]) * scale)
        for patch in _patches(artwork, sheet, list(regions))
    )


def _patches(artwork: Artwork, sheet: PrintedSheet, regions: Sequence[BaseGeometry]) -> tuple[Patch, ...]:
    maps = _maps(artwork.first, sheet)
    return tuple(
        Patch(number, region, artwork.first.picture, complex(maps.factor[number]), complex(maps.shift[number]))
        for number, region in enumerate(regions)
        if not region.is_empty
    )


def _maps(laid: Laid, sheet: PrintedSheet) -> Motion:
    """The picture's map into the flat sheet, for each panel."""
    low, high = sheet.box(laid.state)
    factor, shift = laid.map_into(low, high)
    if laid.state is State.FLAT:
        return Motion(np.full(len(sheet.cells), factor), np.full(len(sheet.cells), shift))
    there = sheet.motion(sheet.design.phi_target)
    return Motion(factor / there.factor, (shift - there.shift) / there.factor)


def _regions(cells: Sequence[FloatArray], bleed_mm: float, overlap_mm: float) -> list[BaseGeometry]:
    """What is printed of each panel: its cell, the bleed where no other panel is, and a little under later ones."""
    whole = shapely.set_precision(polygons_of(cells), GRID_MM)
    material = shapely.union_all(whole, grid_size=GRID_MM)
    below = shapely.buffer(whole, overlap_mm, join_style="mitre", mitre_limit=MITRE)
    grown = shapely.buffer(whole, max(bleed_mm, overlap_mm), join_style="mitre", mitre_limit=MITRE)
    tree = shapely.STRtree(whole)
    later, earlier = tree.query(grown, predicate="intersects")
    found = []
    for number, (own, large) in enumerate(zip(below.tolist(), grown.tolist(), strict=True)):
        near = earlier[later == number]
        outside = shapely.difference(large, material, grid_size=GRID_MM)
        region = shapely.union(own, _polygons(outside), grid_size=GRID_MM)
        before = shapely.union_all(whole[near[near < number]])
        found.append(_polygons(shapely.difference(_polygons(region), before, grid_size=GRID_MM)))
    return found


def _polygons(shape: BaseGeometry) -> BaseGeometry:
    """The areas of a shape, without lines, points and dust."""
    parts = [part for part in shapely.get_parts(shape) if isinstance(part, Polygon) and part.area > DUST_MM2]
    return parts[0] if len(parts) == 1 else MultiPolygon(parts)


def rings_of(region: BaseGeometry) -> list[FloatArray]:
    """Closed lines (L, 2) around a region and around its holes; the first point is not repeated."""
    return [
        shapely.get_coordinates(ring)[:-1]
        for part in shapely.get_parts(region)
        for ring in (part.exterior, *part.interiors)
    ]
