"""Trimming: cut the edge panels along the target in the deployed state, and carry what stays back to the sheet.

Panels are rigid, so a cut along the target at the target angle is a cut in the compact sheet.  Hinges cannot be cut:
around each of them material stays, and a panel stays in one piece with all its hinges.  Panels inside the sheet are
never touched, unless the trim is a deep one: then notches go through them, and panels and hinges in a notch are given
up, see ``notches``.  A trimmed score is another number than an untrimmed one; both are kept apart.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from dataclasses import field as attribute

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.evaluate.kept_panels import (
    GRID,
    GeometryArray,
    KeptPanels,
    PanelTable,
    all_panels,
    edge_panels,
    kept_panels,
    polygons,
    with_pockets,
)
from kirigami_studio.evaluate.notches import STICKING_OUT, deep_cut
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from kirigami_studio.foundation.errors import KirigamiError, UsageError
from kirigami_studio.lattice.deployment import Deployment, check_phi
from kirigami_studio.lattice.ratio_field import frozen
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.lattice.symmetry import nearly_symmetric
from kirigami_studio.outlines.outline import Outline

#: Depth (unit cells) of the material that stays at every hinge unless something else is asked for.
KEEP = 0.15
#: The same of holes and notches: what stays at hinges in one is seen, of an edge hardly.
DEEP_KEEP = 0.1
#: A hole of which less is open counts as closed; and below this area (unit cells squared) that is for its size.
MOSTLY_OPEN, SMALL_HOLE = 0.5, 1.0
#: Room for connectors takes ratios off their images by less than this (log10); it leaves designs symmetric to the eye.
NEARLY = 0.2
#: Between these depths hinges hold and panels can still be trimmed.
SMALLEST_KEEP, LARGEST_KEEP = 0.02, 0.4


@dataclass(frozen=True, slots=True)
class TrimmedHole:
    """How a trimmed design shows a hole of its target."""

    open: float  #: 0..1; share of it that is open
    cells: float  #: its area, unit cells squared
    place: tuple[float, float]  #: (x, y), unit cells; in the compact sheet, where most of it is covered

    @property
    def is_small(self) -> bool:
        """Whether it is smaller than the panels around it."""
        return self.cells < SMALL_HOLE


@dataclass(frozen=True, slots=True)
class Trim:
    """A trimmed design, equal to another of the same sheet, angle, pose, depth and match."""

    sheet: Sheet
    phi: float  #: radians; the angle at which the panels were cut
    pose: Similarity  #: layout frame at ``phi`` to target frame
    keep: float  #: unit cells; depth of the material that stays at every hinge
    deep: bool  #: whether panels inside the sheet were cut too, and panels and hinges given up
    #: tuple of (P, 2) float or None, unit cells; what stays of every panel, row by row, in the compact sheet's frame,
    #: counter-clockwise; None for a whole one, no points for one that was given up.
    kept: tuple[FloatArray | None, ...] = attribute(compare=False, repr=False)
    iou: float  #: 0..1; exact IoU of the trimmed silhouette with the target
    untrimmed_iou: float = attribute(compare=False)  #: 0..1; the same of the whole silhouette in the same pose
    removed_share: float = attribute(compare=False)  #: 0..1; removed part of the sheet's area
    holes: tuple[TrimmedHole, ...] = attribute(default=(), compare=False)  #: those of the target, in its order

    @property
    def given_up(self) -> int:
        """Number of panels of which nothing stays."""
        return sum(part is not None and not len(part) for part in self.kept)

    @property
    def closed_holes(self) -> tuple[TrimmedHole, ...]:
        """Holes of the target that stay closed for the most part."""
        return tuple(hole for hole in self.holes if hole.open < MOSTLY_OPEN)


def trim(
    deployment: Deployment,
    target: Outline,
    phi: float,
    pose: Similarity,
    keep: float = KEEP,
    deep: bool = False,
) -> Trim:
    """Trim a design to a target.

    Parameters
    ----------
    phi : float, radians, in [0, pi]
    pose : Similarity
        Layout frame at ``phi`` to target frame.
    keep : float, unit cells, 0.02 to 0.4
        Depth of the material that stays at every hinge, square to the cut that the hinge rests on.
    deep : bool
        Whether notches may go through panels inside the sheet.

    Raises
    ------
    AngleError, UsageError
        The angle or the depth is out of range.
    KirigamiError
        The outline crosses itself at ``phi``, so that it has no outside; or nothing is left of a deep cut.
    """
    phi, keep = check_phi(phi), check_keep(keep)
    silhouette = Polygon(deployment.outline(phi))
    if not silhouette.is_valid:
        raise KirigamiError("trim.crosses_itself")
    deep = deep or bool(target.holes)
    place: Polygon = shapely.transform(target.polygon, pose.inverse().apply)
    shared, parts = silhouette.intersection(place).area, _deep_parts if deep else _edge_parts
    cut = parts(deployment, place, phi, keep)
    kept: list[FloatArray | None] = [None] * deployment.topology.panel_nodes[..., 0].size
    for index, shape in zip(cut.index, cut.kept.shapes, strict=True):
        kept[index] = None if shape is None else frozen(_ring(shape))
    removed = float(cut.kept.removed.sum())
    both = shared - float(cut.kept.lost.sum()) - cut.open_shared
    return Trim(
        sheet=deployment.sheet,
        phi=phi,
        pose=pose,
        keep=keep,
        deep=deep,
        kept=tuple(kept),
        # Of the outline less what was removed: interior voids count as filled, as in every silhouette.
        iou=float(both / (place.area + silhouette.area - removed - cut.open_area - both)),
        untrimmed_iou=float(shared / (silhouette.area + place.area - shared)),
        removed_share=removed / deployment.area(math.pi),
        holes=cut.holes,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Parts:
    """What stays of some panels, numbered ``index`` (E,), and area of the voids that now lie open, and on the target.

    Unit cells squared.
    """

    index: IntArray
    kept: KeptPanels
    open_area: float = 0.0
    open_shared: float = 0.0
    holes: tuple[TrimmedHole, ...] = ()


def _edge_parts(deployment: Deployment, place: Polygon, phi: float, keep: float) -> _Parts:
    """The panels at the edge cut along the target, all hinges kept."""
    panels = edge_panels(deployment.field.rows, deployment.field.columns)
    corners = deployment.compact[panels.corners]
    targets = _brought_back(deployment, panels, phi, place)
    kept = kept_panels(corners, panels.hinged, targets, keep)
    return _Parts(panels.index, with_pockets(kept, corners, targets, _inside(deployment, panels)))


def _deep_parts(deployment: Deployment, place: Polygon, phi: float, keep: float) -> _Parts:
    """All panels cut along the target, those in its notches given up."""
    grid = deployment.field.rows, deployment.field.columns
    panels = all_panels(*grid)
    targets = _brought_back(deployment, panels, phi, place)
    tables = deployment.topology
    voids = polygons(deployment.nodes(phi)[tables.void_nodes].reshape(-1, 4, 2))
    ends = np.where(tables.even_void[..., None], tables.void_nodes[..., [3, 1]], tables.void_nodes[..., [0, 2]])
    area, shared = shapely.area(voids).reshape(grid), shapely.area(shapely.intersection(voids, place)).reshape(grid)
    symmetry = nearly_symmetric(deployment.sheet, NEARLY)
    images = None if symmetry is None else symmetry.on(*grid).source[:, : area.size]
    gain = shared - STICKING_OUT * (area - shared)
    open_inside = bool(place.interiors)
    kept, stay = deep_cut(
        deployment.compact[panels.corners], targets, deployment.compact[ends], gain, keep, images, open_inside
    )
    left_out = ~stay
    shown = (voids[stay.ravel()], kept)
    holes = tuple(_trimmed_hole(deployment, panels, phi, Polygon(hole), *shown) for hole in place.interiors)
    return _Parts(panels.index, kept, float(area[left_out].sum()), float(shared[left_out].sum()), holes)


def _trimmed_hole(
    deployment: Deployment, panels: PanelTable, phi: float, hole: Polygon, voids: GeometryArray, kept: KeptPanels
) -> TrimmedHole:
    """How much of a hole the kept panels and the voids between them leave open."""
    whole = polygons(deployment.compact[panels.corners])
    parts = np.where([shape is None for shape in kept.shapes], whole, kept.shapes)
    common = shapely.area(shapely.intersection(parts, _brought_back(deployment, panels, phi, hole)))
    covered = float(common.sum() + shapely.area(shapely.intersection(voids, hole)).sum())
    middle = whole[int(np.argmax(common))].centroid
    return TrimmedHole(1.0 - covered / hole.area, float(hole.area), (float(middle.x), float(middle.y)))


def check_keep(keep: float) -> float:
    """Return the depth as a float, or refuse it.

    Raises
    ------
    UsageError
        Not a number from 0.02 to 0.4 cells.
    """
    try:
        depth = float(keep)
    except (TypeError, ValueError):
        depth = math.nan
    if not SMALLEST_KEEP <= depth <= LARGEST_KEEP:
        raise UsageError("trim.keep_out_of_range", least=SMALLEST_KEEP, most=LARGEST_KEEP, keep=keep)
    return depth


def _turn(even: BoolArray, phi: float) -> ComplexArray:
    """By what panels turn on the way from the compact sheet, as complex factors."""
    half = 0.5 * (math.pi - phi)
    turn: ComplexArray = np.exp(1j * np.where(even, -half, half))
    return turn


def _brought_back(deployment: Deployment, panels: PanelTable, phi: float, place: Polygon) -> GeometryArray:
    """The target (E,) as each panel carries it from the layout at ``phi`` to the compact sheet."""
    anchors = panels.corners[:, 0]
    start, end = as_plane(deployment.nodes(phi))[anchors], as_plane(deployment.compact)[anchors]
    back = np.conj(_turn(panels.even, phi))

    def carried(ring: BaseGeometry) -> FloatArray:
        points = as_plane(shapely.get_coordinates(ring)[:-1])
        return as_points((points - start[:, None]) * back[:, None] + end[:, None])

    return polygons(carried(place.exterior), [carried(hole) for hole in place.interiors])


def _inside(deployment: Deployment, panels: PanelTable) -> BaseGeometry:
    """All panels that are not at the edge, as one area of the compact sheet."""
    corners = deployment.compact[deployment.topology.panel_nodes.reshape(-1, 4)]
    rest = np.delete(corners, panels.index, axis=0)
    united: BaseGeometry = shapely.union_all(polygons(rest), grid_size=GRID)
    return united


def _ring(shape: Polygon) -> FloatArray:
    """Vertices (P, 2), counter-clockwise, first not repeated; none of an empty shape."""
    return np.zeros((0, 2)) if shape.is_empty else shapely.get_coordinates(shapely.orient_polygons(shape).exterior)[:-1]
