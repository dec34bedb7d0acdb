"""Panels of pinned designs that are cut away, in holes or by a deep trim.

What stays are voids that hang together from hinge to hinge, each with its four panels and pins, so that the pieces keep
their one motion (:mod:`kirigami_studio.evaluate.notches`).  Pieces may be extended to the rim of a hole but not cut to
it where their pins are: a void goes if its pins in the hole show more than what its panels would be missed for.
"""

from __future__ import annotations

import math

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.assembly.motion import GeometryArray, LayerMotion, discs, freedom, polygons
from kirigami_studio.assembly.options import PinOptions
from kirigami_studio.evaluate.boundary import as_plane
from kirigami_studio.evaluate.kept_panels import PanelTable, all_panels
from kirigami_studio.evaluate.notches import hinges_of, largest_set
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.trimming import Trim
from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.lattice.left_corners import left_corners
from kirigami_studio.lattice.symmetry import symmetry_of
from kirigami_studio.lattice.topology import topology

#: Pieces fill what is within this share of their reach, in the mean over rings, letters and frames.
FILLED = 0.5
#: What pins show in holes counts so much more than what is missed beside them: it looks worse.
SHOWN = 2.0
#: Voids of which the panels lie in holes by this share go at first.
MOSTLY = 0.5
#: A change has to gain this, mm2, and so often all voids are looked at twice.
LEAST_GAIN_MM2, ROUNDS = 1.0, 3
#: A symmetric sheet keeps its symmetry where panels lie in holes by shares that differ by no more from their images'.
ALIKE = 0.1
#: Panels of which the target shows no more than this share go where they can: links beside the outline.
HARDLY_SHOWN = 0.2


def panels_left(design: PosedDesign, shown: Polygon, cell_mm: float, options: PinOptions) -> PanelTable:
    """Panels that pieces are made of, with the corners that have pins.

    Parameters
    ----------
    design : PosedDesign
    shown : Polygon
        The target with its holes, frame of the deployment at the target angle, mm.
    cell_mm : float
        Of a unit cell of the lattice.
    options : PinOptions
    """
    grid = design.deployment.sheet.grid
    if design.trim is not None and design.trim.given_up:
        return _left_by(design.trim, design.deployment)
    if not shown.interiors:
        return all_panels(*grid)
    return _panels_of(_OpenHoles(design, shown, cell_mm, options).voids(), grid)


def pins_in_holes(deployment: Deployment, panels: PanelTable, phi: float, shown: Polygon, cell_mm: float) -> list[int]:
    """Nodes of pins of panels that are in holes of the target at ``phi``, the farthest in first."""
    if not shown.interiors:
        return []
    holes = shapely.union_all([Polygon(ring) for ring in shown.interiors])
    nodes = np.unique(panels.corners[panels.hinged])
    places: GeometryArray = np.asarray(shapely.points(deployment.nodes(phi)[nodes] * cell_mm), dtype=object)
    inside = shapely.contains(holes, places)
    deep = np.asarray(shapely.distance(places[inside], shown))
    found: list[int] = nodes[inside][np.argsort(-deep, kind="stable")].tolist()
    return found


def without_hardly_shown(
    deployment: Deployment,
    panels: PanelTable,
    phi: float,
    shown: Polygon,
    cell_mm: float,
    spare: float,
    stay: IntArray,
) -> PanelTable:
    """Leave out panels that show next to nothing of the target.

    They go as long as the others keep their one motion.  All that would stay of them is walls round pins beside the
    outline, and necks between these.

    Parameters
    ----------
    deployment : Deployment
    panels : PanelTable
    phi : float, radians
        The target angle.
    shown : Polygon
        The target, frame of the deployment at ``phi``, mm.
    cell_mm : float
    spare : float, mm2
        How much of the flat sheet may go.
    stay : (S,) int
        Numbers of panels that stay in any case.
    """
    flat, placed = (polygons(as_plane(deployment.nodes(at))[panels.corners] * cell_mm) for at in (math.pi, phi))
    area = shapely.area(flat)
    share = shapely.area(shapely.intersection(placed, Polygon(shown.exterior))) / area
    stays = np.ones(len(area), dtype=np.bool_)
    for index in np.argsort(share, kind="stable"):
        if share[index] > HARDLY_SHOWN or area[index] > spare or panels.index[index] in stay:
            continue
        stays[index] = False
        if freedom(LayerMotion.of(deployment, cell_mm, phi, panels=_some(panels, stays))) == 1:
            spare -= float(area[index])
        else:
            stays[index] = True
    return panels if stays.all() else _some(panels, stays)


def _some(panels: PanelTable, stays: BoolArray) -> PanelTable:
    """Panels that stay, with the pins that both of their panels have."""
    return panels.at(np.flatnonzero(stays), _in_pairs(panels, panels.hinged & stays[:, None]))


def _in_pairs(panels: PanelTable, hinged: BoolArray) -> BoolArray:
    """Corners (P, 4), of some, whose node another panel has there, too."""
    return hinged & (np.bincount(panels.corners.ravel(), hinged.ravel())[panels.corners] > 1.0)


def kept_voids(panels: PanelTable, grid: tuple[int, int]) -> BoolArray:
    """Voids (m, n) with all four panels and pins."""
    kept = np.isin(topology(*grid).void_nodes, panels.corners[panels.hinged])
    return np.asarray(kept.all(axis=-1))


def rim_loops(panels: PanelTable) -> list[IntArray]:
    """Sides of panels along the sheet's outline, and around places that are cut away.

    Returns
    -------
    loops : list of (L, 2) int
        Place of a panel in the table, and the corner at which a side of it begins; the outline counter-clockwise.
    """
    owners: dict[int, list[tuple[int, int]]] = {}
    for place, corner in np.argwhere(panels.hinged).tolist():
        owners.setdefault(int(panels.corners[place, corner]), []).append((place, corner))

    def following(side: tuple[int, int]) -> tuple[int, int]:
        place, end = side[0], (side[1] + 1) % 4
        if not panels.hinged[place, end]:
            return place, end
        return next(one for one in owners[int(panels.corners[place, end])] if one[0] != place)

    loops, seen = [], set()
    for first in np.ndindex(*panels.corners.shape):
        loop = []
        side = (int(first[0]), int(first[1]))
        while side not in seen:
            seen.add(side)
            loop.append(side)
            side = following(side)
        around_void = len(loop) == 4 and all(panels.hinged[one] for one in loop)
        if loop and not around_void:
            loops.append(np.array(loop))
    return loops


def _panels_of(voids: BoolArray, grid: tuple[int, int]) -> PanelTable:
    """Panels and pins of voids (m, n)."""
    every, hinged = all_panels(*grid), hinges_of(voids)
    return every.at(np.flatnonzero(hinged.any(axis=1)), hinged)


def _left_by(trim: Trim, deployment: Deployment) -> PanelTable:
    """Panels of which a trim left something, and pins that both parts reach."""
    every = all_panels(*deployment.sheet.grid)
    reached = every.hinged & left_corners(trim.kept, deployment.compact[every.corners])
    hinged = _in_pairs(every, reached)
    return every.at(np.flatnonzero(hinged.any(axis=1)), hinged)


class _OpenHoles:
    """One design over a target with holes: the area that it misses with some of its voids, mm2."""

    def __init__(self, design: PosedDesign, shown: Polygon, cell_mm: float, options: PinOptions) -> None:
        deployment = design.deployment
        self._grid, self._options, self._reach_mm = deployment.sheet.grid, options, options.reach * cell_mm
        self._corners = as_plane(deployment.nodes(design.phi_target))[all_panels(*self._grid).corners] * cell_mm
        self._panels = polygons(self._corners)
        self._holes = shapely.union_all([Polygon(ring) for ring in shown.interiors])
        self._beside = shapely.intersection(shapely.buffer(self._holes, self._reach_mm + cell_mm), shown)
        self._near = shapely.intersects(self._panels, shapely.buffer(self._holes, self._reach_mm))
        self._inside = shapely.intersection(self._panels, shown)
        share = shapely.area(shapely.intersection(self._panels, self._holes)) / shapely.area(self._panels)
        self._share = _mean_around(share.reshape(self._grid[0] + 1, -1))
        symmetry = symmetry_of(deployment.sheet)
        count = self._share.size
        self._orbits = self._orbits_of(None if symmetry is None else symmetry.on(*self._grid).source[:, :count])
        self._known: dict[tuple[int, bytes], tuple[BaseGeometry, float]] = {}

    def _orbits_of(self, images: IntArray | None) -> IntArray:
        """Voids with their images (m n, G + 1), if the holes have the sheet's symmetry."""
        alone, share = np.arange(self._share.size)[:, None], self._share.ravel()
        if images is None or np.abs(share[images] - share).max() > ALIKE:
            return alone
        return np.concatenate([alone, images.T], axis=1)

    def voids(self) -> BoolArray:
        """The voids (m, n) that miss least of the target, and show least in its holes."""
        near = _mean_around(self._near.reshape(self._grid[0] + 1, -1).astype(np.float64)) > 0.0
        best = largest_set(self._share < MOSTLY)
        missed = self._missed(best)
        # Single voids first: those that others hang on go only where that is worth more.
        for alone in (True, False) * ROUNDS:
            before = best
            for void in np.flatnonzero(near):
                other = best.copy()
                other.flat[self._orbits[void]] = not best.flat[void]
                whole = largest_set(other)
                if not whole.any() or (alone and not np.array_equal(whole, other)):
                    continue
                if (found := self._missed(whole)) < missed - LEAST_GAIN_MM2:
                    best, missed = whole, found
            if not alone and best is before:
                break
        return best

    def _missed(self, voids: BoolArray) -> float:
        """Area beside holes that pieces are too far away to fill, and area in holes that they take."""
        hinged = hinges_of(voids)
        parts = [self._part(index, hinged[index]) for index in np.flatnonzero(self._near & hinged.any(axis=1)).tolist()]
        far = np.flatnonzero(~self._near & hinged.any(axis=1))
        whole = shapely.union_all([*(shape for shape, _ in parts), *self._inside[far]])
        return float(self._beside.difference(whole).area) + SHOWN * sum(taken for _, taken in parts)

    def _part(self, index: int, hinged: BoolArray) -> tuple[BaseGeometry, float]:
        """A panel with what it may be extended by, and how much of a hole its pins take."""
        key = index, hinged.tobytes()
        if key not in self._known:
            options, inside = self._options, self._inside[index]
            walls = discs(self._corners[index][hinged], options.keep_mm)
            needed: BaseGeometry = shapely.union_all([inside, *walls])
            if needed.geom_type != "Polygon":
                middle = inside if inside.area > 0.0 else walls[0]
                ways = [LineString(shapely.get_coordinates(shapely.shortest_line(wall, middle))) for wall in walls]
                needed = shapely.union_all([needed, *shapely.buffer(ways, 0.5 * options.neck_mm)])
            grown = shapely.buffer(inside, FILLED * self._reach_mm, join_style="mitre")
            self._known[key] = grown, float(shapely.intersection(needed, self._holes).area)
        return self._known[key]


def _mean_around(values: FloatArray) -> FloatArray:
    """Mean (m, n) of the panels' values (m + 1, n + 1) around each void."""
    return np.asarray(0.25 * (values[:-1, :-1] + values[1:, :-1] + values[:-1, 1:] + values[1:, 1:]))
