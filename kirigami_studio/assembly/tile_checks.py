"""Findings on tiles: whether all panels have one, how wide they are, and that they pass each other at every angle.

Over the motion nothing is sampled.  Seen from a tile, each other one moves by (1 - R(t)) w, t = pi - phi, and turns by
t where it has the other colour: no point of it faster than |w| and, if it turns, its distance from the tile's origin.
So two tiles that are farther apart at an angle than this speed allows in an interval about it are apart all through
the interval; intervals are halved until this holds.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry import Polygon

from kirigami_studio.assembly.backed import BackedSheet, Board, core
from kirigami_studio.assembly.motion import GeometryArray
from kirigami_studio.assembly.pieces import Assembly
from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.fabricate.checks import fits_on, place_of
from kirigami_studio.fabricate.findings import Problem
from kirigami_studio.foundation.arrays import ComplexArray

#: Tiles nearer than this (mm) meet.
TOUCH_MM = 0.1
#: Share of the least distance that is found that tiles have to keep for certain in every interval; nearer to 1 it
#: takes long.
SURE = 0.3
#: Tiles whose circles are farther apart than this (mm) are not looked at closely.
CLOSE_MM = 1.0
#: Intervals of the motion to begin with.
INTERVALS = 16
#: Halvings when the narrowest place of a tile is looked for.
HALVINGS = 8


@dataclass(frozen=True, slots=True)
class TileFigures:
    """Measures of the tiles of a board."""

    tiles: int
    missing: int  #: panels that have none
    covered: float  #: 0..1; share of the panels' area
    narrowest_mm: float  #: least width of a tile at its narrowest place
    apart_mm: (
        float  #: distance that tiles keep for certain over the motion, of those beyond their panels; 0 where two meet
    )
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
    apart, pair = apart_mm(backed.assembly)
    opening = Polygon(board.pieces[-1].openings[0] + (board.places[-1] - board.layer_at)).exterior
    others = np.array([*tiles, opening], dtype=object)
    near = [float(shapely.distance(tile, np.delete(others, at)).min()) for at, tile in enumerate(tiles)]
    web = min(near, default=math.inf) - 2.0 * kerf_mm
    figures = TileFigures(
        len(tiles), backed.missing, backed.covered, min(widths, default=0.0), apart, web if tiles else 0.0
    )
    problems = []
    if pair is not None:
        one, other = (backed.assembly.pieces[at].id for at in pair)
        problems.append(Problem.error("backed.tiles_collide", place_of(tiles[pair[0]].centroid), one=one, other=other))
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
    """Width of a tile at its narrowest place; of one that is nowhere narrower than asked for, at its widest."""
    if core(tile, least_mm)[1]:
        return 2.0 * float(shapely.length(shapely.maximum_inscribed_circle(tile, tolerance=0.05)))
    low, high = 0.0, least_mm
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if core(tile, middle)[1] else (low, middle)
    return low


def apart_mm(assembly: Assembly) -> tuple[float, tuple[int, int] | None]:
    """Distance that pieces keep over the motion, mm, and two that meet, by number; None if none do.

    Proved, not sampled, see the module: the distance is a lower bound.  Pairs whose pieces both lie within the panels
    of the lattice are left out: these pass each other, or the design is not feasible.
    """
    pieces, opening = assembly.pieces, math.pi - assembly.phi_target
    deployment, cell_mm = assembly.deployment, assembly.cell_mm
    own = np.array([deployment.topology.panel_nodes[piece.panel] for piece in pieces]).reshape(-1, 4)
    # An origin is R(-a) u + R(a) v, the mean of its panel's corners.
    even_part, odd_part = (as_plane(part)[own] * cell_mm for part in (deployment.even_part, deployment.odd_part))
    u, v = even_part.mean(axis=1), odd_part.mean(axis=1)
    even = np.array([sum(piece.panel) % 2 == 0 for piece in pieces], dtype=np.bool_)
    shapes = np.array([Polygon(piece.outline) for piece in pieces], dtype=object)
    panels = shapely.polygons(as_points(even_part + odd_part - (u + v)[:, None]))
    beyond = ~shapely.covers(panels, shapes)
    reach = np.array([float(np.linalg.norm(piece.outline, axis=1).max()) for piece in pieces])
    one, other = np.triu_indices(len(pieces), 1)
    away_u, away_v = u[other] - u[one], v[other] - v[one]
    # Origins are apart by ||u| - |v|| at least, whatever the angle; where circles round tiles do not meet, no tiles do.
    near = np.abs(np.abs(away_u) - np.abs(away_v)) <= reach[one] + reach[other]
    near &= beyond[one] | beyond[other]
    one, other, away_u, away_v = one[near], other[near], away_u[near], away_v[near]
    # In the frame of one the other's origin is still + R(+-t) turning; it turns by +-t where the colours differ.
    still, turning = np.where(even[one], away_u, away_v), np.where(even[one], away_v, away_u)
    sense, turns = np.where(even[one], 1.0, -1.0), even[one] != even[other]
    speed = np.abs(turning) + np.where(turns, reach[other], 0.0)
    step = opening / (2.0 * INTERVALS)
    pair = np.repeat(np.arange(len(one)), INTERVALS)
    at = np.tile(step * (1.0 + 2.0 * np.arange(INTERVALS)), len(one))
    least = proved = math.inf
    while len(pair):
        turned = np.exp(1j * sense[pair] * at)
        shift = still[pair] + turning[pair] * turned
        # Circles round both are quicker to compare, and mostly enough.
        away = np.abs(shift) - reach[one[pair]] - reach[other[pair]]
        close = away <= CLOSE_MM
        here = pair[close]
        rotation = np.where(turns[here], turned[close], 1.0)
        away[close] = shapely.distance(shapes[one[here]], _moved(shapes[other[here]], rotation, shift[close]))
        nearest = float(away[close].min(initial=math.inf))
        if nearest <= TOUCH_MM:
            worst = here[int(np.argmin(away[close]))]
            return 0.0, (int(one[worst]), int(other[worst]))
        least = min(least, nearest)
        way = speed[pair] * step
        bound = away - way
        clear = (bound > SURE * least) | ((way < 0.5 * TOUCH_MM) & (bound > 0.0))
        proved = min(proved, float(bound[clear].min(initial=math.inf)))
        step *= 0.5
        pair, at = np.repeat(pair[~clear], 2), (at[~clear, None] + (-step, step)).ravel()
    return proved, None


def _moved(shapes: GeometryArray, rotation: ComplexArray, shift: ComplexArray) -> GeometryArray:
    points, owner = shapely.get_coordinates(shapes, return_index=True)
    moved = as_points(as_plane(points) * rotation[owner] + shift[owner])
    found: GeometryArray = shapely.set_coordinates(shapes.copy(), moved)
    return found
