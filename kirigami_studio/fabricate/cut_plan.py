"""The cut plan: every path of the job in mm, in the order of cutting, with what is known about the finished sheet."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon

from kirigami_studio.fabricate import timing
from kirigami_studio.fabricate.centred import Arranged, StraightSheet, Trimming, centred_cuts, least_widths
from kirigami_studio.fabricate.centres import void_misses
from kirigami_studio.fabricate.connectors import OVERCUT_MM, Hinges, edge_cut_paths, hinge_widths, outline_path, shorten
from kirigami_studio.fabricate.copies import Copies, lay_out
from kirigami_studio.fabricate.cut_path import MEASURED_CHORD_MM, check_length, flattened
from kirigami_studio.fabricate.cut_path import CutPath as CutPath
from kirigami_studio.fabricate.cut_path import Layer as Layer
from kirigami_studio.fabricate.endings import seats
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.fabricate.fitting import Obstacle
from kirigami_studio.fabricate.hinged_cuts import HingedCuts, hinged_cuts, relief_radius
from kirigami_studio.fabricate.lettering import Engraving
from kirigami_studio.fabricate.machine import Machine, machine_of
from kirigami_studio.fabricate.making_room import CHANGED_SHARE, has_room, with_room
from kirigami_studio.fabricate.material import Material, default_material
from kirigami_studio.fabricate.options import STRAIGHT, ConnectorStyle, CutOptions
from kirigami_studio.fabricate.ordering import in_cutting_order
from kirigami_studio.fabricate.panel_sizes import panels_in_mm
from kirigami_studio.fabricate.slits import SHEET_EDGE, CutTable, cut_table, edge_sides, sheet_lines
from kirigami_studio.fabricate.tabs import joined_ring, tabbed
from kirigami_studio.fabricate.tiles import TileSizes
from kirigami_studio.fabricate.trimmed_sheet import (
    STRAIGHT_MM,
    UNTRIMMED_STRAIGHT_MM,
    CutPiece,
    kept_area,
    lost_hinges,
    trimmed_cuts,
)
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import Cancelled, FabricationError
from kirigami_studio.foundation.frozen_mapping import FrozenMapping
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.lattice.ratio_field import frozen

SMALLEST_SHEET_MM = 5.0
LARGEST_SHEET_MM = 3000.0
#: Coordinates are rounded to this many decimals (mm), so that equal points are equal in every file.
DECIMALS = 4
#: A connector counts as wider than asked above this difference (mm).
WIDER_MM = 1e-3
#: Cuts along the edge of the material; all others are within it.
RIMS = (Layer.HOLES, Layer.OUTLINE)
#: The note about slit ends that an obstacle kept straight.
WHY_STRAIGHT = {
    Obstacle.SLANT: "plan.straight_because_slanted",
    Obstacle.LENGTH: "plan.straight_because_short",
    Obstacle.NEIGHBOUR: "plan.straight_because_crowded",
}


@dataclass(frozen=True, eq=False)
class CutPlan:
    """A job for the cutter."""

    #: In the order of cutting: relief holes, slits, edge cuts, holes of the silhouette, outline (one closed path, or as
    #: many open ones as there are tabs).  Smallest coordinates are 0, y up.
    paths: tuple[CutPath, ...]
    size_mm: tuple[float, float]  #: (width, height); the finished sheet; of a trimmed one, what it was before
    #: connector_mm, kerf_mm, overcut_mm: finished connector width asked for, full cut width, reach of edge cuts beyond
    #: the outline.
    connector_mm: float
    kerf_mm: float
    overcut_mm: float
    hinges: Hinges
    material: Material
    design_hash: str  #: identifies the sheet that the plan was made from, and what was trimmed off it
    options: CutOptions = STRAIGHT
    notes: tuple[Note, ...] = ()  #: notes to read before cutting
    #: tuple of (P, 2) float, mm; panels between the centre lines of the cuts, row by row; four corners each unless
    #: trimmed.
    panels: tuple[FloatArray, ...] = ()
    centres: FloatArray | None = None  #: (H, 2), mm; where the connectors turn; None for styles that do not place them.
    #: By how much a void misses being a parallelogram of its centres, at most; None without centres.
    void_miss_mm: float | None = None
    #: The sheet that is cut where that is not quite the design: with room for its connectors, the silhouette kept.
    made: Deployment | None = None
    #: Where the design comes from, repeated in every file of the plan; decides nothing.
    origin: Mapping[str, str] = field(default_factory=FrozenMapping)
    #: A name on the sheet, which is engraved before anything is cut and counts as no cut.
    engraving: Engraving | None = None
    name: str = ""  #: that was to be engraved, "" for none; the sheet may have no room for it
    trimmed: int = 0  #: panels of which something was trimmed off
    verdict: str = ""  #: level of the verdict on the sheet, repeated in every file of the plan; decides nothing
    chosen_machine: Machine | None = None  #: That was asked for; None for the one that the material is for.
    tiles: TileSizes | None = None  #: of tiles that are glued on it; None for a sheet that is made by itself

    @cached_property
    def machine(self) -> Machine:
        """The machine that cuts it."""
        return machine_of(self.material) if self.chosen_machine is None else self.chosen_machine

    @cached_property
    def cut_length_mm(self) -> float:
        return sum(path.length for path in self.paths)

    @cached_property
    def travel_mm(self) -> float:
        """Way with the beam off, from the origin to the first cut and between cuts."""
        return float(timing.travel_lengths(self.paths).sum())

    @cached_property
    def times(self) -> timing.CutTimes:
        """Seconds for cutting, travel and switching, and the range that the job may take."""
        return timing.cut_times(self.paths, self.material, self.machine)

    @property
    def seconds_estimate(self) -> float:
        return self.times.total

    @property
    def min_connector_mm(self) -> float:
        """Smallest finished connector, removed ones left out (0 if all are); as asked for in a plan without hinges."""
        if not len(self.hinges):
            return self.connector_mm
        finished = self.hinges.finished_mm[~self.hinges.removed]
        return float(finished.min()) if finished.size else 0.0

    @property
    def outline(self) -> FloatArray:
        """Centre line of the outline as one ring (P, 2), mm, tabs closed; the first point is not repeated."""
        return joined_ring([_finely(path) for path in self.on_layer(Layer.OUTLINE)])

    @property
    def boundary(self) -> Polygon:
        """Area within the centre line of the outline, tabs closed, less the holes, mm."""
        return Polygon(self.outline, [_finely(path) for path in self.on_layer(Layer.HOLES)])

    @property
    def inner(self) -> list[CutPath]:
        """The cuts within the sheet: all but the outline and the holes."""
        return [path for path in self.paths if path.layer not in RIMS]

    @property
    def bounds_mm(self) -> tuple[float, float]:
        """Width and height of everything the head cuts, overcuts included; the lower corner is (0, 0)."""
        corner = np.concatenate([path.flattened for path in self.paths]).max(axis=0)
        return float(corner[0]), float(corner[1])

    @cached_property
    def copies(self) -> Copies:
        """Where the sheets lie that a file of this plan holds; the plan itself is that of the first."""
        return lay_out(self.bounds_mm, self.machine.reach_mm, self.options, self.kerf_mm)

    @property
    def layers(self) -> tuple[Layer, ...]:
        """The layers that hold paths, in the order of cutting."""
        used = {path.layer for path in self.paths}
        return tuple(layer for layer in Layer if layer in used)

    def cut_from(self, design: Deployment) -> Deployment:
        """The sheet that is cut, of the design that the plan was made from."""
        return design if self.made is None else self.made

    def on_layer(self, layer: Layer) -> tuple[CutPath, ...]:
        """The paths of one layer, in the order of cutting."""
        return tuple(path for path in self.paths if path.layer is layer)


def plan_cuts(
    deployment: Deployment,
    width_mm: float = 100.0,
    connector_mm: float | None = None,
    kerf_mm: float | None = None,
    material: Material | None = None,
    options: CutOptions = STRAIGHT,
    overcut_mm: float = OVERCUT_MM,
    kept: Sequence[FloatArray | None] | None = None,
    cancel: Callable[[], bool] = lambda: False,
    machine: Machine | None = None,
) -> CutPlan:
    """Turn a design into a job for the cutter.

    Parameters
    ----------
    width_mm : float
        Width of the finished sheet, 5 to 3000 mm; the height follows from its shape.
    connector_mm, kerf_mm : float, optional
        Finished connector width and full cut width; the material's values unless given.
    material : Material, optional
        The default preset unless given.
    options : CutOptions
        Not those of new projects: plain slits unless given.
    overcut_mm : float
        Reach of edge cuts beyond the outline.
    kept : sequence of (P, 2) float or None, unit cells, optional
        What stays of every trimmed panel, row by row, in the compact sheet's frame; None for a whole one.  The width
        stays that of the untrimmed sheet.
    cancel : function
        Asked between the steps of planning, and while room is made for centred connectors.
    machine : Machine, optional
        The one that the material is for unless given.

    Raises
    ------
    Cancelled
        ``cancel`` returned true.
    FabricationError
        A size, width or kerf that makes no sense, a cut without room for its connectors, or too little material kept
        at a hinge.
    """

    def go_on() -> None:
        if cancel():
            raise Cancelled("plan.stopped")

    material = material or default_material()
    width = check_length("sheet.width_not_positive", width_mm)
    asked = material.connector_mm if connector_mm is None else connector_mm
    connector = check_length("connector.width_not_positive", asked)
    kerf = check_length("kerf.negative", material.kerf_mm if kerf_mm is None else kerf_mm, zero_allowed=True)
    overcut = check_length("overcut.not_positive", overcut_mm)
    table = cut_table(*deployment.sheet.grid)
    parts = () if kept is None or all(part is None for part in kept) else tuple(kept)
    identity = design_hash(deployment, parts)
    lost = lost_hinges(deployment, parts, table) if parts else ()
    left = options.cut_through(lost)
    widths = hinge_widths(table.hinge_count, connector, dict(left.hinge_mm), left.removed)
    _check_size(sheet_lines(deployment, width)[1])
    relief_radius(options.style, material)
    design, made, crowded = deployment, None, False
    if options.style is ConnectorStyle.CENTRED and parts:
        # What stays of the panels is that of the design's.
        crowded = not has_room(design, width, widths + kerf, table, left.removed)
    elif options.style is ConnectorStyle.CENTRED:
        deployment = with_room(design, width, widths + kerf, table, options.removed, go_on)
        made = None if deployment is design else deployment
    lines, size = sheet_lines(deployment, width)
    sides = edge_sides(deployment, width)
    go_on()
    shortened = shorten(lines, table, sides, widths, kerf)
    trimming = _trimming(deployment, parts, table, width, size, kerf, overcut, lost)
    arranged = None
    if options.style is ConnectorStyle.CENTRED:
        least = least_widths(widths, material.min_ligament_mm, dict(left.hinge_mm))
        arranged = centred_cuts(
            StraightSheet(lines, table, sides, widths, least, kerf, overcut, left.removed, options.removed, trimming)
        )
        if arranged is not None and parts and arranged.pieces(kerf) > 1 + len(options.removed):
            arranged = None
    if arranged is None:
        outline, pieces = trimming(shortened)
        cuts = hinged_cuts(
            pieces,
            shortened[table.hinge_cut, table.hinge_end],
            seats(lines, shortened, table, sides, widths, kerf),
            table,
            outline,
            left,
            material,
            kerf,
            overcut,
        )
        arranged = Arranged.without_centres(cuts, outline)
    origin = arranged.lowest
    cuts = arranged.cuts.moved(lambda points: _on_grid(points - origin))
    ring, *holes = (
        CutPath(_on_grid(rim.points - origin), Layer.HOLES if number else Layer.OUTLINE, True, bulges=rim.bulges)
        for number, rim in enumerate(arranged.rims)
    )
    boundary = Polygon(_finely(ring), [_finely(hole) for hole in holes])
    planned = widths if arranged.widths is None else arranged.widths
    go_on()
    finished = cuts.widths(table, left.removed, boundary, kerf)
    if parts or deployment.sheet.start is not None:
        planned = _left_by_outline(planned, finished)
    hinges = _hinges(cuts, table, widths, planned, finished, lost)
    plan = CutPlan(
        paths=in_cutting_order(
            [*holes, *_paths(cuts.pieces, ring, hinges.position[hinges.through == SHEET_EDGE], options, kerf)],
            options.order,
            table,
        ),
        size_mm=size,
        connector_mm=connector,
        kerf_mm=kerf,
        overcut_mm=overcut,
        hinges=hinges,
        material=material,
        design_hash=identity,
        trimmed=sum(part is not None for part in parts),
        options=options,
        notes=(
            *plan_notes(hinges, material, connector, kerf, options.style, cuts.straight),
            *_room_notes(design, made, width),
            *([Note.of("plan.no_room_made_in_trimmed")] if crowded else []),
            *_centring_notes(arranged, left, table),
            *_narrowing_notes(hinges),
        ),
        panels=panels_in_mm(deployment, parts, width, origin),
        centres=None if arranged.centres is None else frozen(arranged.centres - origin),
        void_miss_mm=_void_miss(arranged, left, table),
        made=made,
        chosen_machine=machine,
    )
    return replace(plan, notes=(*plan.notes, *plan.copies.notes))


def _finely(path: CutPath) -> FloatArray:
    """Points of a path with chords for arcs so fine that widths can be measured on them."""
    return path.points if path.bulges is None else flattened(path.points, path.bulges, path.closed, MEASURED_CHORD_MM)


def _check_size(size: tuple[float, float]) -> None:
    if min(size) < SMALLEST_SHEET_MM or max(size) > LARGEST_SHEET_MM:
        raise FabricationError(
            "sheet.size_out_of_range",
            width_mm=size[0],
            height_mm=size[1],
            smallest_mm=SMALLEST_SHEET_MM,
            largest_mm=LARGEST_SHEET_MM,
        )


def _trimming(
    deployment: Deployment,
    parts: Sequence[FloatArray | None],
    table: CutTable,
    width: float,
    size: tuple[float, float],
    kerf: float,
    overcut: float,
    lost: Sequence[int],
) -> Trimming:
    """How straight cuts become outline and remaining cuts of this sheet."""
    if not parts and deployment.sheet.start is None:
        return lambda pulled: _plain_cuts(pulled, table, size, kerf, overcut)
    area = kept_area(deployment, parts or (None,) * len(deployment.topology.panel_nodes.reshape(-1, 4)), width)
    straight = STRAIGHT_MM if parts else UNTRIMMED_STRAIGHT_MM
    sides = sheet_lines(deployment, width)[0]
    return lambda pulled: trimmed_cuts(area, pulled, table, kerf, overcut, straight, lost, sides)


def _plain_cuts(
    shortened: FloatArray, table: CutTable, size: tuple[float, float], kerf: float, overcut: float
) -> tuple[Polygon, list[CutPiece]]:
    """Outline and cuts of a rectangle that is not trimmed."""
    lines = [*shortened[: table.slit_count], *edge_cut_paths(shortened, table, size, kerf, overcut)]
    pieces = [CutPiece(cut, points, cut >= table.slit_count) for cut, points in enumerate(lines)]
    return Polygon(outline_path(size, kerf)), pieces


def _left_by_outline(planned: FloatArray, finished: FloatArray) -> FloatArray:
    """Widths (H,), mm, where the outline is no rectangle and leaves less of a connector."""
    left = (finished > 0.0) & (finished < planned - WIDER_MM)
    widths: FloatArray = np.where(left, finished, planned)
    return widths


def _hinges(
    cuts: HingedCuts,
    table: CutTable,
    asked: FloatArray,
    planned: FloatArray,
    finished: FloatArray,
    lost: Sequence[int],
) -> Hinges:
    return Hinges(
        position=np.array([seat.junction for seat in cuts.seats]),
        cut=table.hinge_cut,
        end=table.hinge_end,
        through=table.hinge_through,
        requested_mm=planned,
        finished_mm=finished,
        asked_mm=asked,
        flexure_mm=cuts.flexure_mm,
        aside=cuts.aside,
        lost=np.isin(np.arange(table.hinge_count), lost),
    )


def _paths(
    pieces: Sequence[CutPiece], ring: CutPath, on_edge: FloatArray, options: CutOptions, kerf: float
) -> list[CutPath]:
    """All cuts on their layers, the outline last: one ring, or the open paths between its tabs.

    Tabs keep clear of connectors ``on_edge`` (E, 2), mm, which would be as wide as the tab is deep, and tear with it.
    """
    paths = []
    for piece in pieces:
        layer = Layer.RELIEF if piece.closed else Layer.EDGE_SLITS if piece.opens else Layer.SLITS
        paths.append(CutPath(piece.points, layer, piece.closed, piece.cut, piece.bulges))
    if options.tabs == 0:
        return [*paths, ring]
    line = _finely(ring)
    exterior = Polygon(line).exterior
    over = [shapely.intersection(LineString(p.points), exterior) for p in paths if p.layer is Layer.EDGE_SLITS]
    busy = np.concatenate([shapely.get_coordinates(over), on_edge])
    parts = tabbed(line, options.tabs, options.tab_mm + kerf, busy)
    return [*paths, *(CutPath(_on_grid(part), Layer.OUTLINE, False) for part in parts)]


def _on_grid(points: FloatArray) -> FloatArray:
    """Round coordinates, and make every zero a positive one."""
    rounded: FloatArray = np.round(points, DECIMALS) + 0.0
    return rounded


def design_hash(deployment: Deployment, kept: Sequence[FloatArray | None]) -> str:
    """Identify a sheet and its trim; ``kept`` as for :func:`plan_cuts`, empty for none."""
    sheet, ratio = deployment.sheet, deployment.field.ratio
    content = f"{ratio.shape}".encode() + np.ascontiguousarray(ratio, dtype="<f8").tobytes()
    if not sheet.is_default:
        others = [sheet.rim.positions, np.array(sheet.cell), np.zeros(0) if sheet.start is None else sheet.start]
        others.append(sheet.rim.hinges)
        content += b"".join(np.ascontiguousarray(part, dtype="<f8").tobytes() for part in others)
    for index, part in enumerate(kept):
        if part is not None:
            content += f"{index}".encode() + np.ascontiguousarray(part, dtype="<f8").tobytes()
    return hashlib.sha256(content).hexdigest()[:16]


def _centring_notes(arranged: Arranged, options: CutOptions, table: CutTable) -> list[Note]:
    """Where connectors that were to be centred are not."""
    if options.style is not ConnectorStyle.CENTRED:
        return []
    if arranged.centres is None:
        return [Note.of("plan.no_room_to_centre")]
    if not arranged.off_centre:
        return []
    miss = _void_miss(arranged, options, table)
    return [Note.of("plan.off_centre", count=arranged.off_centre, total=table.hinge_count, miss_mm=miss)]


def _room_notes(design: Deployment, made: Deployment | None, width_mm: float) -> list[Note]:
    """By how much the panels that are cut are not quite those of the design."""
    if made is None:
        return []
    moved = largest_move(design, made, width_mm)
    return [Note.of("plan.room_made", moved_mm=moved, share_percent=100.0 * CHANGED_SHARE)]


def largest_move(design: Deployment, made: Deployment, width_mm: float) -> float:
    """How far (mm) a corner of a panel lies from where the design has it, at most, on flat sheets of one width."""
    flat = [nodes * (width_mm / float(np.ptp(nodes[:, 0]))) for nodes in (design.compact, made.compact)]
    one, other = (nodes - nodes.mean(axis=0) for nodes in flat)
    return float(np.linalg.norm(other - one, axis=1).max())


def _narrowing_notes(hinges: Hinges) -> list[Note]:
    """How many connectors are narrower than asked for; :attr:`Hinges.narrowed` has them all."""
    narrowed = hinges.narrowed
    if not narrowed.size:
        return []
    narrowest = int(narrowed[np.argmin(hinges.requested_mm[narrowed])])
    x, y = hinges.position[narrowest]
    widths = {"width_mm": float(hinges.requested_mm[narrowest]), "asked_mm": float(hinges.asked_mm[narrowest])}
    return [Note.of("plan.connectors_narrowed", count=int(narrowed.size), total=len(hinges), x=x, y=y, **widths)]


def _void_miss(arranged: Arranged, options: CutOptions, table: CutTable) -> float | None:
    if arranged.centres is None:
        return None
    return float(void_misses(arranged.centres, table, options.removed).max(initial=0.0))


def plan_notes(
    hinges: Hinges,
    material: Material,
    connector_mm: float,
    kerf_mm: float,
    style: ConnectorStyle,
    straight: Counter[Obstacle],
) -> tuple[Note, ...]:
    """What is worth knowing about a plan before it is cut.

    Parameters
    ----------
    connector_mm, kerf_mm : float
        Finished width asked for, and full cut width.
    straight : Counter of Obstacle
        How many hinges stayed straight although a style was asked for, by what was in the way.
    """
    notes = []
    if not material.calibrated:
        notes.append(Note.of("plan.material_uncalibrated", material=material.name))
    narrowest = float(hinges.requested_mm[~hinges.removed].min(initial=np.inf))
    least = material.min_ligament_mm
    if narrowest < least:
        notes.append(Note.of("plan.connectors_may_tear", width_mm=narrowest, material=material.name, least_mm=least))
    for obstacle, count in sorted(straight.items(), key=lambda item: item[0].value):
        notes.append(Note.of(WHY_STRAIGHT[obstacle], count=count, total=len(hinges), style=style.value))
    more = np.where(hinges.removed, 0.0, hinges.finished_mm - hinges.requested_mm)
    wider = more > WIDER_MM
    if np.any(wider):
        x, y = hinges.position[int(np.argmax(more))]
        widest = float(hinges.finished_mm[wider].max())
        count = int(wider.sum())
        notes.append(Note.of("plan.connectors_wider", count=count, total=len(hinges), widest_mm=widest, x=x, y=y))
    gap, tolerance = connector_mm + kerf_mm, material.join_tolerance_mm
    if gap < 2.0 * tolerance:
        notes.append(Note.of("plan.gaps_may_be_joined", gap_mm=gap, tolerance_mm=tolerance))
    return tuple(notes)
