"""The printed sheet, panel by panel: each panel takes what lies below it of a picture on the flat or the opened sheet.

A panel is rigid: between the flat sheet and any angle it turns and shifts, all of it alike, and the pose over the
target scales.  So what a panel shows comes from its picture by one similarity, and a printed sheet is a list of
patches: a region of the flat sheet, a picture, and the similarity that brings the one to the other.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.evaluate.posed_design import PosedDesign, polygons_of
from kirigami_studio.export.artwork import ArtPicture, Artwork, Laid, SheetState
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.fabricate.panel_sizes import panels_in_mm
from kirigami_studio.foundation.arrays import ComplexArray, FloatArray, ShapeRings, as_rings
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


@dataclass(frozen=True, slots=True, eq=False)
class PrintedSheet:
    """A sheet as it is printed and as it opens."""

    design: PosedDesign  #: the sheet that is cut, over its target
    target: ShapeRings  #: (L, 2), and its holes, world
    corners: FloatArray  #: (K, 4, 2), mm; whole panels of the flat sheet, row by row, in the frame of the cuts
    #: tuple of (P, 2) float, mm; what there is of them, between the centre lines of the cuts; no points where nothing
    #: is.
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
    def uncut(cls, design: PosedDesign, target: ShapeRings, width_mm: float) -> PrintedSheet:
        """The sheet of a design whose cuts are not planned, its lower left corner at (0, 0)."""
        parts = () if design.trim is None else design.trim.kept
        cells = panels_in_mm(design.deployment, parts, width_mm, np.zeros(2))
        return cls(design, target, np.array(panels_in_mm(design.deployment, (), width_mm, np.zeros(2))), cells)

    @property
    def phi_target(self) -> float:
        """Angle of the opened sheet, radians."""
        return self.design.phi_target

    def bands(self, artwork: Artwork) -> BaseGeometry | None:
        """Stripes of the flat sheet that show the second picture; None without one."""
        return None if artwork.second is None else bands_across(self.corners.reshape(-1, 2), artwork.stripes)

    def motion(self, phi: float) -> PanelSimilarities:
        """How the panels come from the flat sheet (mm) to the world at an angle."""
        flat = as_plane(self.corners)
        there = as_plane(self.design.panels(self.design.nodes(phi)))
        flat_middle, there_middle = flat.mean(axis=1), there.mean(axis=1)
        arms = flat - flat_middle[:, None]
        weight = np.maximum(np.sum(np.abs(arms) ** 2, axis=1), 1e-300)
        factor = np.sum((there - there_middle[:, None]) * np.conj(arms), axis=1) / weight
        return PanelSimilarities(factor, there_middle - factor * flat_middle)

    def box(self, state: SheetState) -> FloatArray:
        """Lower left and upper right corner (2, 2) of what pictures are laid on: world, or mm of the flat sheet."""
        if state is SheetState.FLAT:
            points = np.concatenate(self.cells)
        else:
            opened = self.design.parts(self.design.phi_target)
            points = np.concatenate([*opened, *as_rings(self.target)])
        return np.stack([points.min(axis=0), points.max(axis=0)])


@dataclass(frozen=True, slots=True, eq=False)
class PanelSimilarities:
    """One similarity for each panel: flat mm -> world, ``factor * z + shift``."""

    factor: ComplexArray  #: (K,)
    shift: ComplexArray  #: (K,)


@dataclass(frozen=True, slots=True, eq=False)
class Patch:
    """A region that shows a part of a picture."""

    panel: int  #: number of the panel that it moves with
    region: BaseGeometry  #: mm; of the flat sheet, or of the opened one
    picture: ArtPicture
    #: factor, shift: the picture's map into the region's frame.
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


def check_bleed(bleed_mm: float) -> None:
    """Refuse a bleed that is negative or wider than 20 mm.

    Raises
    ------
    ExportError
        It is.
    """
    if not 0.0 <= bleed_mm <= MOST_BLEED_MM:
        raise ExportError("artwork.impossible_bleed", bleed_mm=bleed_mm, most=MOST_BLEED_MM)


def printed_patches(artwork: Artwork, sheet: PrintedSheet, bleed_mm: float, kerf_mm: float) -> tuple[Patch, ...]:
    """The print on the flat sheet, to be painted in this order.

    Parameters
    ----------
    bleed_mm : float
        How far panels at the edge are printed beyond it, and into gaps that trimming has left.
    kerf_mm : float
        Panels go on under the next one by half of it, where the beam takes them away.

    Raises
    ------
    ExportError
        A bleed that is negative or wider than 20 mm.
    """
    check_bleed(bleed_mm)
    regions = _regions(sheet.cells, bleed_mm, max(0.5 * kerf_mm, LEAST_OVERLAP_MM))
    return patches_of(artwork, sheet, regions)


def opened_patches(artwork: Artwork, sheet: PrintedSheet, phi: float, overlap_mm: float = 0.0) -> tuple[Patch, ...]:
    """What the printed sheet shows at an angle, in mm: the panels, grown by ``overlap_mm`` on all sides."""
    cells = polygons_of(sheet.cells)
    regions = shapely.buffer(cells, overlap_mm, join_style="mitre", mitre_limit=MITRE) if overlap_mm else cells
    scale = sheet.design.mm_per_world(float(np.ptp(sheet.corners[..., 0])))
    motion = sheet.motion(phi)
    return tuple(
        patch.moved(complex(motion.factor[patch.panel]) * scale, complex(motion.shift[patch.panel]) * scale)
        for patch in patches_of(artwork, sheet, list(regions))
    )


class Printable(Protocol):
    """Rigid parts that pictures are laid on: the panels of a sheet, or pieces."""

    @property
    def phi_target(self) -> float: ...

    @property
    def cells(self) -> tuple[FloatArray, ...]: ...

    def motion(self, phi: float) -> PanelSimilarities: ...

    def box(self, state: SheetState) -> FloatArray: ...

    def bands(self, artwork: Artwork) -> BaseGeometry | None: ...


def patches_of(artwork: Artwork, sheet: Printable, regions: Sequence[BaseGeometry]) -> tuple[Patch, ...]:
    """The first picture in regions (flat, mm), the second one over it in every other stripe."""
    bands = sheet.bands(artwork)
    shown = [(laid.picture, _maps(laid, sheet)) for laid in artwork.laid]
    found = []
    for number, region in enumerate(regions):
        shares = [region] if bands is None else [region, _polygons(shapely.intersection(region, bands))]
        for share, (picture, maps) in zip(shares, shown, strict=True):
            if not share.is_empty:
                found.append(Patch(number, share, picture, complex(maps.factor[number]), complex(maps.shift[number])))
    return tuple(found)


def bands_across(points: FloatArray, stripes: int) -> BaseGeometry:
    """Every other one of upright stripes of one width across points (P, 2), mm."""
    low, high = points.min(axis=0), points.max(axis=0)
    width = float(high[0] - low[0]) / stripes
    beyond = 2 * math.ceil(MOST_BLEED_MM / (2.0 * width))
    left = low[0] + width * np.arange(1 - beyond, stripes + beyond, 2)
    room = MOST_BLEED_MM * MITRE
    return MultiPolygon(list(shapely.box(left, low[1] - room, left + width, high[1] + room)))


def _maps(laid: Laid, sheet: Printable) -> PanelSimilarities:
    """The picture's map into the flat sheet, for each panel."""
    low, high = sheet.box(laid.state)
    factor, shift = laid.map_into(low, high)
    if laid.state is SheetState.FLAT:
        return PanelSimilarities(np.full(len(sheet.cells), factor), np.full(len(sheet.cells), shift))
    there = sheet.motion(sheet.phi_target)
    return PanelSimilarities(factor / there.factor, (shift - there.shift) / there.factor)


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
