"""A design as it is cut: the angle at which the sheet jams, its silhouette and IoU there, what its connectors bear.

There are two ways to know.  :func:`estimate` needs the design, the material and the widths only and takes milliseconds:
it is for all designs.  :func:`simulate` closes the sheet on the connectors of its planned cuts, step by step: it is for
the one that is about to be cut.
"""

from __future__ import annotations

import math
from collections.abc import Generator, Iterable, Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
import shapely

from kirigami_studio.assembly.backed import BackedSheet
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.evaluate.siou import iou_of_area, pose_of_area
from kirigami_studio.export.cut_motion import CutMotion
from kirigami_studio.fabricate.centres import bending_lengths, void_hinges
from kirigami_studio.fabricate.connectors import hinge_widths
from kirigami_studio.fabricate.cut_panels import CutPanels, PanelLines, cut_panels
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.endings import BAR_SPANS, HALF_ANGLES
from kirigami_studio.fabricate.hinged_cuts import HOLED
from kirigami_studio.fabricate.making_room import long_enough
from kirigami_studio.fabricate.material import Material
from kirigami_studio.fabricate.options import ConnectorStyle
from kirigami_studio.fabricate.panel_sizes import panels_in_mm
from kirigami_studio.fabricate.slits import SHEET_EDGE, cut_table, sheet_lines
from kirigami_studio.fabricate.strain import RigidPanels, StrainFigure, Survival, survival, used_up
from kirigami_studio.fabricate.tiles import TileSizes
from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.foundation.errors import KirigamiError, UsageError
from kirigami_studio.foundation.steps import result_of
from kirigami_studio.foundation.words import tr
from kirigami_studio.lattice.deployment import Deployment, check_phi, deploy
from kirigami_studio.mechanics.bow_contacts import NONE as NO_CONNECTOR
from kirigami_studio.mechanics.bow_contacts import Meetings, meetings
from kirigami_studio.mechanics.closing import (
    CLOSED,
    STEPS,
    TOLERATED_STRETCH,
    Closing,
    carried_on,
    closing_steps,
    covered_area,
    even_closing,
    ideal_motion,
)
from kirigami_studio.mechanics.connectors import (
    ElasticSheet,
    SheetConnectors,
    cut_connectors,
    flexure_length,
    junctions,
    tip_asides,
)
from kirigami_studio.mechanics.drive import Drive
from kirigami_studio.mechanics.estimate import StretchEstimate, estimate_stretch
from kirigami_studio.mechanics.gripping import SoftMotions, grips
from kirigami_studio.mechanics.path_contacts import contacts_on_way
from kirigami_studio.mechanics.sheet_network import SheetNetwork, polygons_as_rows, sheet_network
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.settings.fabrication import FabricationSettings, is_pinned, material_for
from kirigami_studio.settings.layers import hinge_layer, sheet_material

MPA_PER_GPA = 1e3
#: A sheet within this (radians) of being closed has closed.
CLOSE_TO = math.radians(1.0)
#: A connector counts as longer than a straight one above this (mm); coordinates are rounded to a tenth of it.
LONGER_MM = 1e-3
#: Fewest equilibria of a closing.
LEAST_STEPS = 3
#: A sheet is closed so many times at most, each time with the contacts that the last time showed.
MOST_CLOSINGS = 4
#: Of a motion that nobody draws.
NO_PANELS = CutPanels(PanelLines.of([]), PanelLines.of([]))
#: The estimate's jam angles below this (radians) are those of contacts that close further: the sheet closes.
ESTIMATE_CLOSES = math.radians(6.0)


class Outcome(Enum):
    """Whether a sheet comes to the angle that it is designed for, and what stops it."""

    CLOSES = "closes"
    STRETCHED = "stretched"  #: a connector would be stretched by more than it tolerates
    TOUCHING = "touching"  #: panels run into each other


class Source(Enum):
    """How something is known of a sheet as cut; the values are the names in JSON."""

    ESTIMATE = "estimate"  #: from the design, the material and the widths
    SIMULATION = "simulation"  #: closed step by step on the connectors of its planned cuts


@dataclass(frozen=True, slots=True)
class AsCut:
    """What is expected of a cut sheet.

    Raises
    ------
    AngleError
        A jam outside of 0 to pi.
    """

    jam_phi: float  #: radians; angle at which it jams, from 0 for a sheet that closes to pi for one that stays flat
    phi: float  #: radians; at which it is meant to show the target
    outcome: Outcome
    stretch: float  #: Largest stretch of a connector on the way to ``phi``, in its widths; tolerated or not
    #: Strain, of the figure that is believed, of the connector nearest to breaking on the way to where the sheet comes
    #: to
    strain: float
    figure: StrainFigure
    #: iou and ideal_iou: Exact IoU with the target where the sheet comes to, and of the ideal motion at ``phi``; None
    #: in an estimate, and without a target
    iou: float | None = None
    ideal_iou: float | None = None
    source: Source = Source.SIMULATION
    #: strain_limit, thinness and yields_at: Of that connector, see :class:`Survival`
    strain_limit: float = math.inf
    thinness: float = 0.0
    yields_at: float = 0.0
    flat_iou: float | None = None  #: Exact IoU of flat pieces with their start; None where there are no pieces

    def __post_init__(self) -> None:
        check_phi(self.jam_phi)

    @property
    def survival(self) -> Survival:
        """Whether its connectors survive, and by which figure."""
        return Survival(self.strain, self.figure, self.thinness, self.strain_limit, self.yields_at)

    @property
    def closes(self) -> bool:
        """Whether the sheet comes to the angle that it is meant for."""
        return self.outcome is Outcome.CLOSES

    @property
    def of_pieces(self) -> bool:
        """Whether its match is that of pieces put together."""
        return self.iou is not None and self.flat_iou is not None

    @property
    def nearly_closes(self) -> bool:
        """Whether it ends within a few degrees of that angle."""
        return not self.closes and self.jam_phi <= self.phi + ESTIMATE_CLOSES

    @property
    def reached(self) -> float:
        """The angle (radians) nearest to ``phi`` that the sheet comes to."""
        return self.phi if self.closes else max(self.jam_phi, self.phi)

    @property
    def jam_deg(self) -> float:
        """The angle at which it jams, degrees in [0, 180]: the one figure that everything shows."""
        return math.degrees(self.jam_phi)

    @property
    def opened(self) -> float:
        """Share (0..1) of its way from flat to its angle that the sheet comes."""
        return 1.0 if self.closes else min((math.pi - self.jam_phi) / (math.pi - self.phi), 1.0)

    @property
    def lost(self) -> float | None:
        """Match (IoU) that is lost by being cut; None where that is not known."""
        return None if self.iou is None or self.ideal_iou is None else max(0.0, self.ideal_iou - self.iou)

    @property
    def word(self) -> str:
        """Whether it comes to its angle, in the words that everything shows."""
        if self.nearly_closes:
            return tr("comes to {jam:.0f}°", jam=self.jam_deg)
        if not self.closes:
            return tr("jams at {jam:.0f}°", jam=self.jam_deg)
        return tr("closes") if self.phi < CLOSE_TO else tr("opens to {phi:.0f}°", phi=math.degrees(self.phi))

    def to_json(self) -> dict[str, object]:
        """For the command line: jam, match as cut (null where it is not known), largest strain."""
        return {**jam_json(self), "iou": self.iou, "max_strain": self.strain}


def jam_json(found: AsCut | None) -> dict[str, object]:
    """Where a sheet jams and how that is known, for every JSON; nulls where nothing is known."""
    if found is None:
        return {"jam_deg": None, "jam_from": None}
    return {"jam_deg": found.jam_deg, "jam_from": found.source.value}


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedSheet:
    """A sheet that was closed on its connectors."""

    as_cut: AsCut
    closing: Closing
    node: IntArray  #: (H,); node of the lattice at which each connector is
    width_mm: float  #: Width of the flat sheet
    panels: CutPanels  #: As the cuts leave them, in the frame of the closing's network
    made: Deployment | None = None  #: The sheet that is cut where that is not quite the design
    #: Lays it where it comes to upon the target, from the network's frame (mm): the pose of its match as cut
    laid: Similarity | None = None
    covered: shapely.Polygon | None = None  #: Its area there, see ``closing.covered_area``

    def stretch_at(self, phi: float) -> FloatArray:
        """Stretch (H,) of the connectors at an angle (radians), in their widths; the last that was found beyond it."""
        phis = np.minimum.accumulate(self.closing.phi)
        stretch = self.closing.stretch
        after = int(np.clip(np.searchsorted(-phis, -phi), 1, len(phis) - 1)) if len(phis) > 1 else 0
        before = max(after - 1, 0)
        run = float(phis[before] - phis[after])
        share = float(np.clip((phis[before] - phi) / run, 0.0, 1.0)) if run > 0.0 else 1.0
        found: FloatArray = (1.0 - share) * stretch[before] + share * stretch[after]
        return found

    @property
    def motion(self) -> CutMotion:
        """What pictures and animations show of it."""
        found = self.as_cut
        return CutMotion(
            self.closing, self.width_mm, found.jam_phi, found.reached, self.panels, self.laid, self.made, self.covered
        )


@dataclass(frozen=True, slots=True, eq=False)
class Overlap:
    """Angles (radians) that a sheet comes to, by itself and forced, and its IoU there and as designed."""

    reached: float
    iou_as_cut: float
    forced: float
    iou_forced: float
    iou_ideal: float
    laid: Similarity  #: pose (mm to the target's frame) of the first
    covered: shapely.Polygon  #: mm; area of the sheet there


# the sheet as a network -----------------------------------------------------------------------------------------------


def planned_sheet(
    deployment: Deployment,
    plan: CutPlan,
    width_mm: float,
    kept: Sequence[FloatArray | None] | None = None,
    on_nodes: bool = False,
    young_gpa: float | None = None,
) -> SheetNetwork:
    """The panels and connectors of planned cuts.

    Parameters
    ----------
    deployment : Deployment
    plan : CutPlan
        Of its cuts.
    width_mm : float
        Width of the flat sheet.
    kept : sequence of (P, 2) float or None, unit cells, optional
        What stays of every panel of a trimmed sheet.
    on_nodes : bool
        Whether connectors turn on their nodes whatever the plan says.
    young_gpa : float, optional
        Young's modulus; the material's unless given.
    """
    hinges, deployment = plan.hinges, plan.cut_from(deployment)
    found = junctions(deployment, width_mm, cut_table(*deployment.sheet.grid).hinge_node)
    if plan.options.style is ConnectorStyle.CENTRED:
        finished = np.maximum(hinges.finished_mm, 0.0)
        longer = np.where(hinges.removed, 0.0, _longer_by_bows(hinges.flexure_mm, finished, plan.kerf_mm))
    else:
        # A straight slit's connector bends over a span; arcs and bars make it longer.
        longer = np.where(hinges.removed, 0.0, hinges.flexure_mm - hinges.requested_mm - plan.kerf_mm)
    polygons = panels_in_mm(deployment, () if kept is None else kept, width_mm, np.zeros(2))
    shift = _shift_of(plan, polygons)
    centres = None
    if on_nodes:
        centres = found.place
    elif plan.centres is not None:
        centres = plan.centres + shift
    connectors = cut_connectors(
        found,
        np.maximum(hinges.finished_mm, 0.0),
        plan.kerf_mm,
        centres,
        np.where(longer > LONGER_MM, longer, 0.0),
        hinges.aside,
    )
    if plan.tiles is not None:  # soft flanks give way: tiles alone run into each other
        connectors = replace(connectors, touch=np.minimum(connectors.touch, 0.0))
        bows: Meetings | None = _meetings_of_tiles(connectors, plan, deployment, shift)
    else:
        bows = None if centres is None or on_nodes else _meetings(connectors, plan, deployment, shift)
    young = plan.material.young_gpa if young_gpa is None else young_gpa
    elastic = ElasticSheet(MPA_PER_GPA * young, plan.material.thickness_mm)
    return sheet_network(polygons_as_rows(polygons), connectors, elastic, bows)


def _shift_of(plan: CutPlan, polygons: Sequence[FloatArray]) -> FloatArray:
    """From the frame of a plan to that of the flat sheet's panels (2,), mm: the plan has an origin of its own."""
    return next(one[0] - other[0] for one, other in zip(polygons, plan.panels, strict=True) if len(one))


def _meetings(connectors: SheetConnectors, plan: CutPlan, deployment: Deployment, shift: FloatArray) -> Meetings:
    """Where panels with the bows of a plan run into each other."""
    panels = cut_panels(plan).moved(shift).numbered(len(plan.panels))
    return meetings(panels, connectors, _at_voids(plan, deployment), plan.kerf_mm)


def _meetings_of_tiles(
    connectors: SheetConnectors, plan: CutPlan, deployment: Deployment, shift: FloatArray
) -> Meetings:
    """The same of the tiles on a hinge layer, as they are finished."""
    tiles = _tiled(plan, deployment).moved(shift).numbered(len(plan.panels))
    return meetings(tiles, connectors, _at_voids(plan, deployment), 0.0)


def _tiled(plan: CutPlan, deployment: Deployment) -> CutPanels:
    """Tiles in the place of the panels that they are glued on."""
    columns = deployment.topology.columns + 1
    rings = [
        (row * columns + column, shapely.get_coordinates(tile.exterior)[:-1])
        for (row, column), tile in BackedSheet(plan, deployment, 0.0, plan.tiles or TileSizes()).flat_tiles.items()
    ]
    return CutPanels(PanelLines.of(rings), PanelLines.of([]))


def _at_voids(plan: CutPlan, deployment: Deployment) -> IntArray:
    """Connectors (V, 4) at the corners of every void, counted among those that there are."""
    table = cut_table(*deployment.sheet.grid)
    there = np.flatnonzero(plan.hinges.finished_mm > 0.0)
    number = np.full(table.hinge_count + 1, NO_CONNECTOR)  # the last one for corners without a hinge
    number[there] = np.arange(len(there))
    found: IntArray = number[void_hinges(table)]
    return found


def _longer_by_bows(flexure_mm: FloatArray, width_mm: FloatArray, kerf_mm: float) -> FloatArray:
    """By how much (H,), mm, connectors bend over a longer strip than beside a straight flank; 0 where none bows."""
    longer = flexure_mm - flexure_length(width_mm, kerf_mm)
    bows = (width_mm > 0.0) & (flexure_mm > width_mm + kerf_mm + LONGER_MM)
    found: FloatArray = np.where(bows, np.maximum(longer, 0.0), 0.0)
    return found


def _unplanned_sheet(deployment: Deployment, settings: FabricationSettings, material: Material) -> SheetNetwork:
    """The same without a plan: untrimmed, every connector as wide as asked for and as its style would make it."""
    table, options = cut_table(*deployment.sheet.grid), settings.options
    kerf = material.kerf_mm if settings.kerf_mm is None else settings.kerf_mm
    asked = material.connector_mm if settings.connector_mm is None else settings.connector_mm
    widths = hinge_widths(table.hinge_count, asked, dict(options.hinge_mm), options.removed)
    found = junctions(deployment, settings.width_mm, table.hinge_node)
    span = np.where(widths > 0.0, widths + kerf, 0.0)
    longer = span * {
        ConnectorStyle.ARC: 2.0 * math.tan(math.radians(HALF_ANGLES[0])) - 1.0,
        ConnectorStyle.DOUBLE: 2.0 * BAR_SPANS[0] - 1.0,
    }.get(options.style, 0.0)
    centres = None
    if options.style is ConnectorStyle.CENTRED:
        # Sheets make room for connectors where slits are long enough.
        lines, _ = sheet_lines(deployment, settings.width_mm)
        slits = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1)
        crowded = ~long_enough(slits[table.hinge_through], span) & (table.hinge_through != SHEET_EDGE)
        height = np.where(crowded, 0.5 * span, 0.0)
        longer = _longer_by_bows(bending_lengths(span, kerf, height), widths, kerf)
        off = height / found.sine
        centres = found.place + off[:, None] * found.along
    aside = tip_asides(found, widths, kerf, material.relief_radius_mm if options.style in HOLED else 0.0)
    aside *= options.style is not ConnectorStyle.ARC  # arcs lie around their junction
    connectors = cut_connectors(found, widths, kerf, centres, longer, aside)
    elastic = ElasticSheet(MPA_PER_GPA * material.young_gpa, material.thickness_mm)
    return sheet_network(found.corners, connectors, elastic)


# two ways to know -----------------------------------------------------------------------------------------------------


def estimate(
    deployment: Deployment, settings: FabricationSettings, phi: float, material: Material | None = None
) -> AsCut:
    """Estimate where a sheet jams, without planning its cuts.

    Parameters
    ----------
    deployment : Deployment
    settings : FabricationSettings
    phi : float, radians
        At which it is meant to show the target.
    material : Material, optional
        Of the settings, if it is known already.

    Raises
    ------
    FabricationError
        No such material, or widths that make no sense.
    """
    settings = hinge_layer(settings)
    chosen = material_for(settings) if material is None else material
    if is_pinned(settings):
        return motion_on_pins(phi)
    sheet = _unplanned_sheet(deployment, settings, chosen)
    found = estimate_stretch(deployment, sheet, settings.width_mm)
    jam = estimated_jam(found)
    largest = float(found.stretch[: max(1, int(np.sum(found.phi >= phi)))].max())
    blame = Outcome.STRETCHED if float(found.stretch.max()) > TOLERATED_STRETCH else Outcome.TOUCHING
    outcome = Outcome.CLOSES if jam <= phi + CLOSE_TO else blame
    figures = _both_figures(sheet, phi if outcome is Outcome.CLOSES else max(jam, phi))
    judged = survival(chosen, sheet.connectors.width_mm, *figures)
    return _made(jam, phi, outcome, largest, judged, Source.ESTIMATE)


def grips_on_pins(deployment: Deployment, settings: FabricationSettings, among: Sequence[int]) -> tuple[int, int]:
    """Panels to hold and to pull: where the softest motions of a pinned sheet are largest, of some panels.

    Pins bend nothing and leave one motion, so that one of each is enough.

    Raises
    ------
    FabricationError
        No such material.
    """
    held, pulled = motions_on_pins(deployment, settings).order(2, among)
    return held, pulled


def motions_on_pins(deployment: Deployment, settings: FabricationSettings) -> SoftMotions:
    """The softest motions of a pinned sheet, by which grips and drives are chosen.

    Raises
    ------
    FabricationError
        No such material.
    """
    sheet = _unplanned_sheet(deployment, settings, material_for(settings))
    return SoftMotions.of(deployment, sheet, settings.width_mm, 2)


def grips_on_tiles(
    candidate: Candidate, deployment: Deployment, plan: CutPlan, width_mm: float, tiles: Sequence[int]
) -> tuple[int, int]:
    """Panels with tiles to hold and to pull first, as the search for grips begins.

    Raises
    ------
    MechanicsError
        Panels that do not hang together.
    """
    kept, made = None if candidate.trim is None else candidate.trim.kept, plan.cut_from(deployment)
    motions = SoftMotions.for_grips(made, planned_sheet(made, plan, width_mm, kept), width_mm)
    held, pulled = motions.order(2, tiles)
    return held, pulled


def motion_on_pins(phi: float, iou: float | None = None, flat_iou: float | None = None) -> AsCut:
    """Tell how a pinned design moves: all the way to ``phi`` (radians), without strain.

    Both numbers are those of its checked pieces with target and start; without them the motion counts as estimated.
    """
    source = Source.ESTIMATE if iou is None else Source.SIMULATION
    return AsCut(0.0, phi, Outcome.CLOSES, 0.0, 0.0, StrainFigure.IN_PLANE, iou, iou, source, flat_iou=flat_iou)


def estimated_jam(found: StretchEstimate, tolerated: float = TOLERATED_STRETCH) -> float:
    """Angle (radians) at which a sheet is estimated to jam; 0 where its contacts give."""
    jam = found.jam_phi(tolerated)
    return 0.0 if jam <= ESTIMATE_CLOSES else jam


def all_break(deployment: Deployment, settings: FabricationSettings, phi: float, material: Material) -> bool:
    """Whether all connectors break at an angle (radians), without planning the cuts."""
    sheet = _unplanned_sheet(deployment, hinge_layer(settings), material)
    return bool(np.all(used_up(material, sheet.connectors.width_mm, *_both_figures(sheet, phi)) > 1.0))


def _both_figures(sheet: SheetNetwork, phi: float) -> tuple[FloatArray, FloatArray]:
    """Strains (H,), in the plane and out of it, of connectors bent to an angle (radians), not pulled."""
    turn = np.full(len(sheet.connectors), math.pi - phi)
    return sheet.strains(turn, np.zeros(len(turn)))


def _made(
    jam: float,
    phi: float,
    outcome: Outcome,
    stretch: float,
    judged: Survival,
    source: Source,
    lap: Overlap | None = None,
) -> AsCut:
    iou, ideal = (None, None) if lap is None else (lap.iou_as_cut, lap.iou_ideal)
    known = judged.strain, judged.figure, iou, ideal, source, judged.limit, judged.thinness, judged.yields_at
    return AsCut(jam, phi, outcome, stretch, *known)


def estimates(candidates: Iterable[Candidate], settings: FabricationSettings) -> dict[Candidate, AsCut]:
    """Estimate where designs jam; those that cannot be cut at all are left out.

    Raises
    ------
    FabricationError
        No such material.
    """
    material, found = sheet_material(settings), {}
    for candidate in candidates:
        try:
            found[candidate] = estimate(deploy(candidate.final_sheet), settings, candidate.final_phi, material)
        except KirigamiError:
            continue  # widths that make no sense on this sheet, which planning its cuts explains
    return found


@dataclass(frozen=True, slots=True)
class Leading:
    """How a sheet is closed: gripped panels, how far, in how many steps.

    Attributes
    ----------
    hold, move : tuple of int
        Panels that pins hold, and those that they lead along the ideal path, row by row; nothing is gripped without
        any, and the mean angle is driven.
    end : float, radians
        Mean angle to close to.
    steps : int
        Equilibria on the way, the flat sheet among them.
    young_gpa : float or None
        Young's modulus; None takes the material's.

    Raises
    ------
    UsageError
        Panels to hold without others to move, or the reverse; an end that is flat; too few steps.
    """

    hold: tuple[int, ...] = ()
    move: tuple[int, ...] = ()
    end: float = CLOSED
    steps: int = STEPS
    young_gpa: float | None = None

    def __post_init__(self) -> None:
        if bool(self.hold) != bool(self.move):
            raise UsageError("mechanics.hold_and_move")
        if self.end >= math.pi:
            raise UsageError("mechanics.end_angle", angle=math.degrees(self.end))
        if self.steps < LEAST_STEPS:
            raise UsageError("drive.too_few_steps", found=self.steps, least=LEAST_STEPS)

    def drive(self, deployment: Deployment, sheet: SheetNetwork, width_mm: float) -> Drive:
        """The drive of a sheet.

        Raises
        ------
        MechanicsError
            Panels that it does not have.
        """
        if self.hold:
            return grips(deployment, sheet, width_mm, self.hold, self.move, self.end, self.steps)
        return even_closing(sheet, self.end, self.steps)


def jam_of(
    found: Closing, deployment: Deployment, width_mm: float, tolerated: float = TOLERATED_STRETCH
) -> tuple[float, Source]:
    """Angle (radians) at which a sheet jams; an estimate where it was not driven to its end."""
    free = len(found.phi) == found.asked and float(found.stretch.max()) <= tolerated
    if free and float(found.phi[-1]) > CLOSED + CLOSE_TO:
        return estimated_jam(estimate_stretch(deployment, found.sheet, width_mm), tolerated), Source.ESTIMATE
    return found.jam_phi(tolerated), Source.SIMULATION


def simulate(
    deployment: Deployment,
    plan: CutPlan,
    width_mm: float,
    phi: float,
    target: Outline | None = None,
    kept: Sequence[FloatArray | None] | None = None,
    lead: Leading | None = None,
    pose: Similarity | None = None,
) -> Generator[None, None, SimulatedSheet]:
    """Close a sheet on the connectors of its planned cuts; yields between the steps, for others to have their turn.

    Parameters
    ----------
    deployment : Deployment
    plan : CutPlan
        Of its cuts.
    width_mm : float
        Width of the flat sheet.
    phi : float, radians
        At which it is meant to show the target.
    target : Outline, optional
    kept : sequence of (P, 2) float or None, unit cells, optional
        What stays of every panel of a trimmed sheet.
    lead : Leading, optional
        How it is closed; all the way by its mean angle unless given.
    pose : Similarity, optional
        Of the design at ``phi`` over the target: of poses that are as good as cut, the one nearby counts.

    Raises
    ------
    MechanicsError
        Panels that do not hang together, because too many connectors were removed, or grips on panels that are not
        there.
    """
    lead = lead or Leading()
    design, deployment = deployment, plan.cut_from(deployment)
    sheet = planned_sheet(deployment, plan, width_mm, kept, young_gpa=lead.young_gpa)
    yield
    found = yield from _closed_with_contacts(sheet, plan, deployment, width_mm, kept, lead)
    jam, source = jam_of(found, deployment, width_mm)
    lap = None
    if target is not None:
        yield
        lap = overlap(deployment, found, width_mm, phi, found.jam_phi(), target, False, design, pose)
    table = cut_table(*deployment.sheet.grid)
    node = table.hinge_node[plan.hinges.finished_mm > 0.0]
    panels = cut_panels(plan).moved(_shift_of(plan, panels_in_mm(deployment, kept or (), width_mm, np.zeros(2))))
    as_cut = replace(_simulated(plan, found, jam, phi, lap), source=source)
    shown = (None, None) if lap is None else (lap.laid, lap.covered)
    return SimulatedSheet(as_cut, found, node, width_mm, panels, plan.made, *shown)


def _closed_with_contacts(
    sheet: SheetNetwork,
    plan: CutPlan,
    deployment: Deployment,
    width_mm: float,
    kept: Sequence[FloatArray | None] | None,
    lead: Leading,
) -> Generator[None, None, Closing]:
    """Close a sheet, and close it again as long as panels ran through each other on the way."""
    shift = _shift_of(plan, panels_in_mm(deployment, kept or (), width_mm, np.zeros(2)))
    bodies, kerf = (cut_panels(plan), plan.kerf_mm) if plan.tiles is None else (_tiled(plan, deployment), 0.0)
    panels = bodies.moved(shift).numbered(len(plan.panels))
    found = yield from closing_steps(sheet, lead.drive(deployment, sheet, width_mm))
    for _ in range(MOST_CLOSINGS - 1):
        more = contacts_on_way(panels, found, kerf)
        if not len(more):
            break
        yield
        sheet = sheet.with_meetings(more)
        found = yield from closing_steps(sheet, lead.drive(deployment, sheet, width_mm))
    return found


def simulated(
    candidate: Candidate,
    plan: CutPlan,
    width_mm: float,
    target: Outline | None = None,
    deployment: Deployment | None = None,
    lead: Leading | None = None,
) -> SimulatedSheet:
    """Close a design on the connectors of its planned cuts, all in one go; see :func:`simulate`.

    Raises
    ------
    MechanicsError
        Panels that do not hang together.
    """
    motion, kept = deployment or deploy(candidate.final_sheet), None if candidate.trim is None else candidate.trim.kept
    return result_of(simulate(motion, plan, width_mm, candidate.final_phi, target, kept, lead, candidate.final_pose))


def _simulated(plan: CutPlan, found: Closing, jam: float, phi: float, lap: Overlap | None) -> AsCut:
    closes = jam <= phi + CLOSE_TO
    reached = phi if closes else jam
    worst = found.stretch.max(axis=1)
    largest = float(worst[_until(found, phi)].max())
    blame = Outcome.STRETCHED if float(worst.max()) > TOLERATED_STRETCH else Outcome.TOUCHING
    until = _until(found, reached)
    connectors = found.sheet.connectors
    rigid: RigidPanels | None = None
    if plan.tiles is not None:
        there = np.flatnonzero(plan.hinges.finished_mm > 0.0)
        free = plan.tiles.rigid_panels(plan.hinges, plan.kerf_mm, reached).of(there)
        rigid = replace(free, flexure_mm=connectors.flexure_mm)
    figures = found.in_plane[until], found.out_of_plane[until]
    judged = survival(plan.material, connectors.width_mm, *figures, rigid)
    return _made(jam, phi, Outcome.CLOSES if closes else blame, largest, judged, Source.SIMULATION, lap)


def breaking_phi(material: Material, found: Closing) -> float | None:
    """Angle (radians) of a closing at which its first connector breaks; None where all survive."""
    widths = found.sheet.connectors.width_mm
    shares = used_up(material, widths, found.in_plane, found.out_of_plane).max(axis=1)
    over = np.flatnonzero(shares > 1.0)
    if not over.size:
        return None
    last = int(over[0])
    if last == 0:
        return float(found.phi[0])
    share = (1.0 - shares[last - 1]) / (shares[last] - shares[last - 1])
    return float(found.phi[last - 1] + share * (found.phi[last] - found.phi[last - 1]))


def _until(found: Closing, phi: float) -> slice:
    """The steps of a closing up to an angle (radians)."""
    return slice(max(1, int(np.sum(found.phi >= phi - CLOSE_TO))))


def overlap(
    deployment: Deployment,
    found: Closing,
    width_mm: float,
    phi: float,
    jam: float,
    target: Outline,
    forced: bool = True,
    design: Deployment | None = None,
    pose: Similarity | None = None,
) -> Overlap:
    """IoU with the target of the sheet as cut, where it comes to, and as designed.

    Parameters
    ----------
    deployment : Deployment
        The sheet that is cut.
    found : Closing
    width_mm : float
    phi, jam : float, radians
        At which the sheet is meant to show the target, and at which it jams.
    target : Outline
    forced : bool
        Whether it is also measured where the sheet can be forced to; not a number if not.
    design : Deployment, optional
        What it was made from; the sheet that is cut unless given.
    pose : Similarity, optional
        Of the design over the target, see :func:`simulate`.
    """
    network = found.sheet.network
    # A sheet that came to the last step goes on to the angle that it is meant for.
    closed = len(found.phi) == found.asked and found.phi.min() <= CLOSED + CLOSE_TO
    end = phi if closed else max(phi, float(found.phi.min()))
    reached = max(end, jam)
    motions = [carried_on(found, deployment, width_mm, reached), ideal_motion(deployment, network, width_mm, phi)]
    if forced:
        motions.append(carried_on(found, deployment, width_mm, end))
    areas = [covered_area(deployment, network, width_mm, motion) for motion in motions]
    if design is not None and design is not deployment:
        areas[1] = shapely.Polygon(design.outline(phi))
    near = None
    if pose is not None:
        posed = PosedDesign(deployment if design is None else design, pose, phi)
        posed = posed if posed.deployment is deployment else posed.laid_over(deployment)
        near = CutMotion(found, width_mm, jam, reached, NO_PANELS).nearest(posed, reached)
    as_cut, laid = pose_of_area(areas[0], target, near)
    ideal, *shut = (iou_of_area(area, target) for area in areas[1:])
    return Overlap(reached, as_cut, end, shut[0] if shut else math.nan, ideal, laid, areas[0])
