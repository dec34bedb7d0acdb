"""Findings on tiles: missing ones, their widths, and whether their board can be cut.

Tiles never meet: each lies within its panel of the lattice, and panels of a feasible design pass each other.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry import Polygon

from kirigami_studio.assembly.backed import BackedSheet, Board, core
from kirigami_studio.fabricate.checks import fits_on, place_of
from kirigami_studio.fabricate.findings import Problem

#: Halvings when the narrowest place of a tile is looked for.
HALVINGS = 8


@dataclass(frozen=True, slots=True)
class TileFigures:
    """Measures of the tiles of a board."""

    tiles: int
    missing: int  #: panels that have none
    covered: float  #: 0..1; share of the panels' area
    narrowest_mm: float  #: least width of a tile at its narrowest place
    web_mm: float  #: what is left between the cuts of two tiles, or of a tile and the frame


@dataclass(frozen=True, slots=True)
class TileReport:
    """Figures and problems of the tiles; places are in the frame of the hinge layer's plan, mm."""

    figures: TileFigures
    problems: tuple[Problem, ...]


def check_tiles(
    backed: BackedSheet, board: Board, kerf_mm: float, least_mm: float, beds: Sequence[tuple[str, tuple[float, float]]]
) -> TileReport:
    """Measure tiles and their board.

    Parameters
    ----------
    backed : BackedSheet
    board : Board
    kerf_mm : float
        Of the cuts in the board.
    least_mm : float
        Width that a tile should have everywhere.
    beds : sequence of (name, (width, height)), mm
        Of the machines of both layers; 0 for any size.
    """
    tiles = list(backed.flat_tiles.values())
    widths = [_width_mm(tile, least_mm) for tile in tiles]
    opening = Polygon(board.pieces[-1].openings[0] + (board.places[-1] - board.layer_at)).exterior
    _, near = shapely.STRtree([*tiles, opening]).query_nearest(
        np.array(tiles, dtype=object), return_distance=True, all_matches=False, exclusive=True
    )
    web = float(near.min(initial=math.inf)) - 2.0 * kerf_mm
    figures = TileFigures(len(tiles), backed.missing, backed.covered, min(widths, default=0.0), web if tiles else 0.0)
    problems = []
    if not tiles:
        problems.append(Problem.error("printed.no_tiles", gap_mm=backed.tile_sizes.gap_mm))
    elif web <= 0.0:
        where = place_of(tiles[int(np.argmin(near))].centroid)
        problems.append(Problem.error("backed.cuts_merge", where, gap_mm=backed.tile_sizes.gap_mm, kerf_mm=kerf_mm))
    if tiles and figures.missing:
        problems.append(Problem.warning("backed.tiles_missing", count=figures.missing))
    narrow = [at for at, width in enumerate(widths) if width < least_mm]
    if narrow:
        worst = min(narrow, key=widths.__getitem__)
        values = {"count": len(narrow), "width_mm": widths[worst], "least_mm": least_mm}
        name = backed.assembly.pieces[worst].id
        problems.append(Problem.warning("backed.tile_narrow", place_of(tiles[worst].centroid), piece=name, **values))
    for machine, bed in beds:
        if not fits_on(bed, board.size_mm) and fits_on(bed, backed.plan.bounds_mm):
            sizes = dict(zip(("width_mm", "height_mm"), board.size_mm, strict=True))
            problems.append(Problem.warning("backed.frame_larger_than_bed", machine=machine, **sizes))
    return TileReport(figures, tuple(problems))


def _width_mm(tile: Polygon, least_mm: float) -> float:
    """Width of a tile at its narrowest place, or at its widest where that is enough."""
    if core(tile, least_mm)[1]:
        return 2.0 * float(shapely.length(shapely.maximum_inscribed_circle(tile, tolerance=0.05)))
    low, high = 0.0, least_mm
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if core(tile, middle)[1] else (low, middle)
    return low
