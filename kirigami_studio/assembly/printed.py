"""Solids to print: one-sheet designs and tiles, extruded.

Outlines are on a grid of a tenth of a micrometre: no two vertices fall together in single precision, which STL has.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from manifold3d import CrossSection, Error, FillRule, Manifold
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.assembly.backed import BackedSheet
from kirigami_studio.assembly.solids import Plate, PrintForm, Printing, Solid, on_plates
from kirigami_studio.fabricate.checks import finished_pieces
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment

#: Coordinates of outlines are multiples of the first (mm), and of the second beyond ``LARGE_MM``.
GRID_MM, COARSE_GRID_MM, LARGE_MM = 1e-4, 1e-3, 1000.0
#: Width (mm) of slits that take no material away, as blades cut them: something has to be between both sides.
LEAST_SLIT_MM = 0.01


def print_plates(plan: CutPlan, design: Deployment, phi: float, printing: Printing) -> tuple[Plate, ...]:
    """Make the solids of a design, as many plates of them as the bed asks for.

    Parameters
    ----------
    plan : CutPlan
        Of the sheet; of the hinge layer for tiles.
    design : Deployment
    phi : float, radians
        Target angle.
    printing : Printing

    Raises
    ------
    FabricationError
        A sheet that falls apart, a body larger than the bed, or one whose surface does not close.
    """
    thickness = plan.material.thickness_mm if printing.thickness_mm is None else printing.thickness_mm
    if printing.form is PrintForm.TILES:
        solids = tile_solids(BackedSheet.of(plan, design, phi, printing.tile_sizes), thickness)
    else:
        solids = sheet_solids(plan, thickness)
    return on_plates(solids, printing.bed_mm)


def sheet_solids(plan: CutPlan, thickness_mm: float) -> Plate:
    """The finished sheet with its slits as wide as they are cut, and its copies.

    Raises
    ------
    FabricationError
        The sheet is not in one piece.
    """
    pieces = finished_pieces(plan, max(plan.kerf_mm, LEAST_SLIT_MM))
    if len(pieces) != 1:
        raise FabricationError("printed.falls_apart", pieces=len(pieces))
    solid = extruded("sheet", 1, pieces[0], thickness_mm)
    return tuple(
        replace(solid.moved(np.array([x, y, 0.0])), name=f"sheet {number}" if number > 1 else "sheet")
        for number, (x, y) in enumerate(plan.copies.places.tolist(), start=1)
    )


def tile_solids(backed: BackedSheet, thickness_mm: float) -> Plate:
    """Tiles as they lie on the flat hinge layer, one body each, named by their numbers.

    Raises
    ------
    FabricationError
        There are none.
    """
    if not backed.flat_tiles:
        raise FabricationError("printed.no_tiles", gap_mm=backed.tile_sizes.gap_mm)
    columns = zip(backed.assembly.pieces, backed.flat_tiles.values(), strict=True)
    return tuple(extruded(piece.id, 1 + sum(piece.panel) % 2, tile, thickness_mm) for piece, tile in columns)


def extruded(name: str, layer: int, region: Polygon, thickness_mm: float) -> Solid:
    """Extrude an area (mm) from z = 0.

    Raises
    ------
    FabricationError
        The surface does not close.
    """
    return solid_of(name, layer, prism(region, thickness_mm), region.area * thickness_mm)


def prism(region: Polygon, thickness_mm: float) -> Manifold:
    """The body over an area (mm), from z = 0."""
    grid = COARSE_GRID_MM if max(map(abs, region.bounds)) > LARGE_MM else GRID_MM
    rings = _rings(region, grid)
    if len(np.unique(np.concatenate(rings), axis=0)) < sum(map(len, rings)):
        # Where the area hangs together in a point alone, four walls would meet in one edge.
        parted = shapely.buffer(shapely.buffer(region, -2.0 * grid, join_style="mitre"), 2.0 * grid, join_style="mitre")
        rings = _rings(parted, grid)
    return Manifold.extrude(CrossSection(rings, FillRule.Positive), thickness_mm)


def _rings(region: BaseGeometry, grid: float) -> list[FloatArray]:
    """Rings (P, 2) of an area on a grid, holes clockwise."""
    tidy = shapely.orient_polygons(shapely.set_precision(region, grid))
    rings = [ring for part in shapely.get_parts(tidy) for ring in (part.exterior, *part.interiors)]
    return [shapely.get_coordinates(ring)[:-1] for ring in rings]


def solid_of(name: str, layer: int, body: Manifold, volume_mm3: float) -> Solid:
    """Turn a body into vertices and faces.

    Raises
    ------
    FabricationError
        Its surface does not close, or it is in several pieces, or in none.
    """
    pieces = 0 if body.status() != Error.NoError else len(body.decompose())
    if pieces != 1:
        raise FabricationError("printed.not_one_body", name=name, pieces=pieces)
    mesh = body.to_mesh64()
    vertices = np.ascontiguousarray(np.asarray(mesh.vert_properties, dtype=np.float64)[:, :3])
    return Solid(name, layer, vertices, np.asarray(mesh.tri_verts, dtype=np.int64), volume_mm3)
