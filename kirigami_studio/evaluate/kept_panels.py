"""What stays of each trimmed panel: the target's part, and material around every hinge.

All panels are looked at together, each in the compact sheet's own frame (the target is carried there by the panel's
rigid motion), so that the sides of untouched panels stay exactly where the cuts are.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cache
from itertools import combinations

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.lattice.topology import topology

GeometryArray = npt.NDArray[np.object_]

#: Vertices are snapped to this grid (unit cells), so that neighbours share them.
GRID = 1e-9
#: Removed parts thinner than this (unit cells) are not worth a cut and stay.
SLIVER = 0.01
#: Material narrower than twice this share of ``keep`` does not count as a connection.  The widest disc in the material
#: that is kept around a hinge alone has a radius of at least 0.41 ``keep``.
NECK = 0.3
#: Corners sharper than 2 asin(1 / MITRE) = 23 degrees are blunted where necks are looked for.
MITRE = 5.0
#: A hinge keeps material as far as ``keep / sin`` of its corner angle, at most so many times ``keep``.
FARTHEST = 4.0


@dataclass(frozen=True, slots=True, eq=False)
class PanelTable:
    """Panels of a grid, row by row."""

    index: IntArray  #: (E,); number of each in the row-major order of all panels
    corners: IntArray  #: (E, 4); nodes: top, left, bottom, right
    hinged: BoolArray  #: (E, 4); corners that are shared with a neighbour
    even: BoolArray  #: (E,); panels with I + J even: they turn by -a when the sheet opens, the others by +a
    #: (E, 4); nodes that may rest on the side after each corner, from beyond the slit there; -1 at the sheet's edge
    guests: IntArray

    def at(self, places: IntArray, hinged: BoolArray) -> PanelTable:
        """Panels of some places, with other shared corners (E, 4)."""
        other = replace(self, hinged=hinged)
        return PanelTable(*(getattr(other, one.name)[places] for one in fields(self)))


@cache
def all_panels(rows: int, columns: int) -> PanelTable:
    """The (cached) panels of an m x n grid."""
    line, place = (axis.ravel() for axis in np.indices((rows + 1, columns + 1)))
    hinged = np.stack([line > 0, place > 0, line < rows, place < columns], axis=1)
    corners = topology(rows, columns).panel_nodes.reshape(-1, 4)
    return PanelTable(np.arange(line.size), corners, hinged, (line + place) % 2 == 0, _guests(rows, columns))


@cache
def edge_panels(rows: int, columns: int) -> PanelTable:
    """The (cached) panels along the edge of an m x n grid."""
    every = all_panels(rows, columns)
    index = np.flatnonzero(~every.hinged.all(axis=1))
    return every.at(index, every.hinged)


def _guests(rows: int, columns: int) -> IntArray:
    """Nodes (P, 4) across the slits along the sides of all panels."""
    tables = topology(rows, columns)
    nodes, even = tables.void_nodes.reshape(-1, 4), tables.even_void.ravel()
    # From its ends the slit of a void goes along one of the two other nodes, with the other one beyond.
    nodes = np.where(even[:, None], np.roll(nodes, 1, axis=1), nodes)
    sides = np.concatenate([nodes[:, [0, 1]], nodes[:, [0, 3]], nodes[:, [2, 1]], nodes[:, [2, 3]]])
    beyond = np.concatenate([nodes[:, 3], nodes[:, 1], nodes[:, 3], nodes[:, 1]])
    corners = tables.panel_nodes.reshape(-1, 4)
    keys = [np.sort(pairs, axis=-1) @ (tables.node_count, 1) for pairs in (sides, _sides(corners))]
    order = np.argsort(keys[0])
    place = order[np.searchsorted(keys[0][order], keys[1]).clip(max=len(order) - 1)]
    found: IntArray = np.where(keys[0][place] == keys[1], beyond[place], -1)
    return found


def _sides(corners: IntArray) -> IntArray:
    """Both nodes of every side of panels: (E, 4, 2)."""
    return np.stack([corners, np.roll(corners, -1, axis=1)], axis=-1)


@dataclass(frozen=True, slots=True, eq=False)
class KeptPanels:
    """What stays of some panels, in the compact sheet's frame."""

    shapes: GeometryArray  #: (E,) Polygon; None where a panel stays whole, an empty one where nothing of it stays
    removed: FloatArray  #: (E,), unit cells squared
    lost: FloatArray  #: (E,), unit cells squared; removed area that lies on the target: pieces without a hinge


def kept_panels(corners: FloatArray, hinged: BoolArray, targets: GeometryArray, keep: float) -> KeptPanels:
    """Trim panels to a target and keep their hinges together.

    Parameters
    ----------
    corners : (E, 4, 2) float, unit cells
    hinged : (E, 4) bool
    targets : (E,) Polygon
        The target in each panel's frame.
    keep : float, unit cells
        Depth of the material that stays at every hinge.
    """
    panels = polygons(corners)
    common = shared_parts(panels, targets)
    shapes = np.full(len(panels), None, dtype=object)
    for k in np.flatnonzero(shapely.area(common) < shapely.area(panels) - SLIVER * SLIVER):
        shapes[k] = kept_part(panels[k], common[k], corners[k], hinged[k], keep)
    return measured(panels, common, shapes)


def kept_part(
    panel: Polygon, common: BaseGeometry, corners: FloatArray, hinged: BoolArray, keep: float
) -> Polygon | None:
    """What stays of one panel, of which ``common`` is the target's part; None where it stays whole."""
    around = _around_hinges(panel, corners, hinged, keep)
    wanted = _without_slivers(panel, _united(common, around.all))
    return None if wanted is None else _in_one_piece(panel, wanted, around, keep)


def moved_off(
    panel: Polygon, part: Polygon, corners: FloatArray, hinged: BoolArray, guests: FloatArray, keep: float
) -> list[Polygon]:
    """Versions of a part whose edge keeps off connectors that rest on the panel's sides.

    The edge of a part is a rim; a connector beyond it needs ``keep`` of one side alone.  The first version has the
    material around them, the second one is without it, if it is as well in one piece with its hinges.

    Parameters
    ----------
    guests : (G, 2) float, unit cells
        Those connectors.
    """
    side = shapely.LineString(corners[[0, 1, 2, 3, 0]])
    discs: GeometryArray = np.asarray(shapely.buffer(shapely.points(guests), keep), dtype=object)
    near = shapely.intersection(side, shapely.buffer(shapely.points(guests), keep, quad_segs=2))
    along = shapely.length(shapely.intersection(near, shapely.buffer(part, GRID, join_style="mitre")))
    halved = (along > SLIVER * keep) & (along < shapely.length(near) - SLIVER * keep)
    if not halved.any():
        return []
    around = _shared(shapely.union_all(discs[halved]), panel)
    filled = _solid(_united(part, around))
    hinges, less = _around_hinges(panel, corners, hinged, keep), _less(part, around)
    holding = _holding(less, hinges, keep) if less.area > 0.0 else np.zeros(0)
    if len(holding) != 1 or not shapely.covers(shapely.buffer(less, GRID), hinges.all):
        return [filled]
    return [filled, _solid(less)]


def measured(panels: GeometryArray, common: GeometryArray, shapes: GeometryArray) -> KeptPanels:
    """What stays of panels (E,), with the areas that are cut off; ``common`` (E,) are the target's parts of them."""
    area, inside = shapely.area(panels), shapely.area(common)
    removed, lost = np.zeros(len(panels)), np.zeros(len(panels))
    cut = np.flatnonzero([shape is not None for shape in shapes])
    if len(cut):
        removed[cut] = area[cut] - shapely.area(shapes[cut])
        lost[cut] = inside[cut] - shapely.area(shapely.intersection(shapes[cut], common[cut], grid_size=GRID))
    return KeptPanels(shapes, removed, np.maximum(lost, 0.0))


def polygons(corners: FloatArray, holes: Sequence[FloatArray] = ()) -> GeometryArray:
    """Polygons (E,) with the given vertices (E, P, 2) and holes (E, H, 2), snapped to the grid."""
    inner = np.stack([np.asarray(shapely.linearrings(hole), dtype=object) for hole in holes], axis=1) if holes else None
    made = shapely.polygons(corners if inner is None else shapely.linearrings(corners), inner)
    snapped: GeometryArray = shapely.set_precision(np.asarray(made, dtype=object), GRID)
    return snapped


def with_pockets(
    kept: KeptPanels, corners: FloatArray, targets: GeometryArray, whole: BaseGeometry, most: float = math.inf
) -> KeptPanels:
    """Give back what no cut along one outline can take: places that the kept parts enclose in the compact sheet.

    Parameters
    ----------
    corners, targets
        As for :func:`kept_panels`.
    whole : geometry
        The rest of the sheet.
    most : float, unit cells squared
        Larger places stay open.
    """
    panels = polygons(corners)
    present = [shape if shape is not None else panel for shape, panel in zip(kept.shapes, panels, strict=True)]
    pockets = [pocket for pocket in enclosed([*present, whole]) if pocket.area < most]
    if not pockets:
        return kept
    filling = _united(*pockets)
    shapes = kept.shapes.copy()
    for k in np.flatnonzero([shape is not None and shape.distance(filling) < GRID for shape in shapes]):
        shapes[k] = _solid(_united(shapes[k], _shared(panels[k], filling)))
    return measured(panels, shared_parts(panels, targets), shapes)


def enclosed(parts: Sequence[BaseGeometry] | GeometryArray) -> list[Polygon]:
    """Places that parts of one sheet enclose."""
    outer = max(shapely.get_parts(_united(*parts)), key=lambda part: float(part.area))
    return [Polygon(ring) for ring in outer.interiors if Polygon(ring).area > GRID]


def largest_part(shape: BaseGeometry, other: BaseGeometry) -> Polygon:
    """The largest part of a shape without another."""
    return _solid(_less(shape, other))


def shared_parts(panels: GeometryArray, targets: GeometryArray) -> GeometryArray:
    """Each panel's part in its own target (E,)."""
    common = shapely.intersection(panels, targets, grid_size=GRID)
    areas: GeometryArray = np.array([_areas(shape) for shape in common], dtype=object)
    return areas


def _united(*shapes: BaseGeometry) -> BaseGeometry:
    return _areas(shapely.union_all(np.array(shapes, dtype=object), grid_size=GRID))


def _shared(shape: BaseGeometry, other: BaseGeometry) -> BaseGeometry:
    return _areas(shape.intersection(other, grid_size=GRID))


def _less(shape: BaseGeometry, other: BaseGeometry) -> BaseGeometry:
    return _areas(shape.difference(other, grid_size=GRID))


def _areas(shape: BaseGeometry) -> BaseGeometry:
    """The shape without the points and lines in which two areas touch."""
    if shape.geom_type != "GeometryCollection":
        return shape if shape.area > 0.0 else Polygon()
    parts = shapely.get_parts(shape)
    return MultiPolygon(list(parts[shapely.area(parts) > 0.0]))


@dataclass(frozen=True, slots=True, eq=False)
class _Around:
    """Material around the hinges of one panel: one part for each, and all of it; ``points`` (H, 2) are the hinges.

    ``cores`` (H,) are what is left of the parts when they shrink as necks do.
    """

    points: FloatArray
    parts: GeometryArray
    all: BaseGeometry
    cores: GeometryArray


def _around_hinges(panel: Polygon, corners: FloatArray, hinged: BoolArray, keep: float) -> _Around:
    before, after = np.roll(corners, 1, axis=0) - corners, np.roll(corners, -1, axis=0) - corners
    cross = np.abs(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0])
    sine = cross / np.maximum(np.hypot(*before.T) * np.hypot(*after.T), GRID)
    reach = keep * np.minimum(FARTHEST, 1.0 / np.maximum(sine, GRID))
    points = corners[hinged]
    discs = shapely.buffer(shapely.points(points), reach[hinged])
    parts = shared_parts(discs, np.full(len(discs), panel))
    return _Around(points, parts, _united(*parts), _core(parts, keep))


def _without_slivers(panel: Polygon, wanted: BaseGeometry) -> BaseGeometry | None:
    """``wanted`` with the thin rests of the panel given back, or None when nothing thicker is to be removed."""
    rests = shapely.get_parts(_less(panel, wanted))
    thin = shapely.is_empty(shapely.buffer(rests, -0.5 * SLIVER))
    if np.all(thin):
        return None
    return _united(wanted, *rests[thin]) if thin.any() else wanted


def _in_one_piece(panel: Polygon, wanted: BaseGeometry, around: _Around, keep: float) -> Polygon | None:
    """The piece with all hinges on it, strips added between them if need be; None where the panel is too thin."""
    if np.any(shapely.is_empty(around.cores)):
        return None
    holding = _holding(wanted, around, keep)
    for strip in _strips(panel, wanted, around, keep) if len(holding) > 1 else ():
        wanted = _united(wanted, _shared(strip, panel))
        holding = _holding(wanted, around, keep)
        if len(holding) == 1:
            break
    grown = shapely.union_all(shapely.buffer(holding, 1.001 * NECK * keep, join_style="mitre", mitre_limit=MITRE))
    return _solid(_united(_shared(wanted, grown), around.all))


def _strips(panel: Polygon, wanted: BaseGeometry, around: _Around, keep: float) -> GeometryArray:
    """Straight connections between hinges, least added area first.

    They may reach beyond the panel.
    """
    pairs = list(combinations(range(len(around.points)), 2))
    strips: GeometryArray = np.asarray(shapely.buffer(shapely.linestrings(around.points[pairs]), keep), dtype=object)
    within = shapely.intersection(strips, panel)
    added = shapely.area(within) - shapely.area(shapely.intersection(within, wanted))
    return strips[np.argsort(added, kind="stable")]


def _core(shapes: GeometryArray, keep: float) -> GeometryArray:
    """What is left when necks and slivers have shrunk to nothing."""
    core: GeometryArray = shapely.buffer(shapes, -NECK * keep, join_style="mitre", mitre_limit=MITRE)
    return core


def _holding(wanted: BaseGeometry, around: _Around, keep: float) -> GeometryArray:
    """Pieces of the core of ``wanted`` that hold hinges."""
    pieces = shapely.get_parts(_core(np.array([wanted], dtype=object), keep))
    held: GeometryArray = pieces[shapely.intersects(pieces[:, None], around.cores).any(axis=1)]
    return held


def _solid(shape: BaseGeometry) -> Polygon:
    """The largest part without its holes."""
    largest = max(shapely.get_parts(shape), key=lambda part: float(part.area))
    return shapely.set_precision(Polygon(largest.exterior), GRID)
