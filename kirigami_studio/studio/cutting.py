"""From a design and its fabrication settings to the cut plan, and the room that its material and connectors need."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from kirigami_studio.assembly.backed import LEAST_TILE_MM
from kirigami_studio.assembly.checks import PinnedReport
from kirigami_studio.assembly.sheet_marks import with_marks
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.fabricate.checks import PlanReport
from kirigami_studio.fabricate.cut_plan import CutPlan, plan_cuts
from kirigami_studio.fabricate.drive import DriveKind
from kirigami_studio.fabricate.engraving import engraved
from kirigami_studio.fabricate.findings import Note, Severity
from kirigami_studio.fabricate.hold import HoldKind
from kirigami_studio.fabricate.machine import MachineKind
from kirigami_studio.fabricate.material import Material
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.fabricate.tiles import TileSizes
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import FabricationError, KirigamiError, UsageError
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.mechanics.connectors import flexure_length
from kirigami_studio.outlines.starts import RECTANGLE, StartShape
from kirigami_studio.polish.flat_sheet import width_in_cells
from kirigami_studio.settings.design import USUAL_GRID
from kirigami_studio.settings.fabrication import (
    FabricationSettings,
    hold_options,
    is_pinned,
    machine_for,
    material_for,
    named_machine,
    stored_values,
    unlike,
)
from kirigami_studio.settings.layers import board_layer, hinge_layer, is_backed

#: Length of the cuts of pieces on pins and of tiles, over that of plain panels: ears, holes of pins, relief.  Pieces of
#: a heart, 8 x 8 voids and 380 mm wide, have 1.4 times as much.
ROUND_PANELS = 1.4
#: Panels on average that leave connectors room everywhere, in the least of one: they differ in size.
ROOMY = 1.3
#: Stops of the head in one cut, at its ends and where it goes round connectors.
STOPS = 4


def expected_seconds(settings: FabricationSettings, grid: tuple[int, int] = USUAL_GRID) -> float:
    """Rough time of cutting a sheet before it is designed.

    Returns
    -------
    float
        Seconds; 0 where nothing is cut by a machine, and for an unknown material.
    """
    try:
        material, machine = material_for(settings), machine_for(settings)
    except FabricationError:
        return 0.0
    if machine.kind in (MachineKind.HAND, MachineKind.PRINTER):
        return 0.0
    rows, columns = grid
    width, height = settings.width_mm, settings.width_mm * (rows + 1) / (columns + 1)
    between, rim = columns * height + rows * width, 2.0 * (width + height)
    panels = ROUND_PANELS * (2.0 * between + rim)
    length = panels if is_pinned(settings) else between + rim + (panels if is_backed(settings) else 0.0)
    speed, cuts = machine.speed_mm_s(material), rows * columns + 2 * (rows + columns)
    switching = machine.on_delay_s + machine.off_delay_s + STOPS * machine.corner_delay_s
    moving = width / columns / machine.travel_mm_s + STOPS * speed / machine.acceleration_mm_s2
    return material.passes * (length / speed + cuts * (switching + moving))


def times_too_small(settings: FabricationSettings, grid: tuple[int, int], start: StartShape) -> float:
    """How many times larger a sheet has to be for its connectors before it is designed.

    Returns
    -------
    float
        At most 1 where it is large enough, on pins, and where that cannot be said: for an unknown material, or a start
        that folds.
    """
    if is_pinned(settings):
        return 0.0
    try:
        cells = width_in_cells(grid, RECTANGLE if start.is_auto else start)
        return ROOMY * room_mm(settings) * cells / settings.width_mm
    except KirigamiError:
        return 0.0


def plan_of(
    candidate: Candidate,
    settings: FabricationSettings,
    deployment: Deployment | None = None,
    cancel: Callable[[], bool] = lambda: False,
    name: str = "",
) -> CutPlan:
    """Plan the cuts of a design; a trimmed one gets its trimmed outline.

    Parameters
    ----------
    deployment : Deployment, optional
        Of the candidate's final sheet, if it is known already.
    cancel : function
        Asked between the steps of planning.
    name : str
        What the design is called, which the sheet gets engraved if the settings say so.

    Raises
    ------
    Cancelled
        ``cancel`` returned true.
    FabricationError
        No such material, or a plan that cannot be made.
    """
    trim, is_one_sheet, settings = candidate.trim, not is_backed(settings), hinge_layer(settings)
    kept = None if trim is None else trim.kept
    motion = deployment or deploy(candidate.final_sheet)
    plan = plan_sheet(motion, settings, kept, cancel)
    if settings.engrave and name:
        plan = replace(engraved(plan, name), name=name)
    if is_one_sheet and settings.held_by is not HoldKind.NONE:
        plan = with_marks(plan, motion, candidate.final_phi, hold_options(settings))
    return plan


def plan_sheet(
    deployment: Deployment,
    settings: FabricationSettings,
    kept: Sequence[FloatArray | None] | None = None,
    cancel: Callable[[], bool] = lambda: False,
) -> CutPlan:
    """Plan the cuts of any sheet, or of the hinge layer of a backed one.

    ``kept`` is what stays of every panel of a trimmed one, as in a trim.

    Raises
    ------
    Cancelled
        ``cancel``, which is asked between the steps of planning, returned true.
    FabricationError
        No such material, or a plan that cannot be made.
    """
    tiles = None
    if is_backed(settings):
        tiles = TileSizes(settings.gap_mm, least_mm=_board_tile_mm(settings))
    settings = hinge_layer(settings)
    machine = named_machine(settings)
    plan = plan_cuts(
        deployment,
        width_mm=settings.width_mm,
        connector_mm=settings.connector_mm,
        kerf_mm=settings.kerf_mm,
        material=material_for(settings),
        options=settings.options,
        kept=kept,
        cancel=cancel,
        machine=machine,
    )
    told = [note for pair in stored_values(settings) if (note := unlike(*pair)) is not None]
    told += [
        Note.of(code) for code, wanted in (("drive.only_on_pins", settings.moved_by is not DriveKind.NONE),) if wanted
    ]
    if settings.machine and machine is None:
        told.append(Note.of("plan.machine_unknown", name=settings.machine, machine=plan.machine.name))
    return replace(plan, notes=(*plan.notes, *told), tiles=tiles) if told or tiles is not None else plan


def refuse_errors(report: PlanReport | PinnedReport) -> None:
    """Refuse cuts that the sheet would not survive.

    Raises
    ------
    FabricationError
        With the first of the errors.
    """
    for problem in report.problems:
        if problem.severity is Severity.ERROR:
            raise FabricationError("export.cannot_be_cut", reason=problem.text)


def check_connectors(candidate: Candidate, options: CutOptions) -> None:
    """Refuse numbers of connectors that a design does not have.

    Raises
    ------
    UsageError
        With the largest number that it has.
    """
    count = cut_table(*candidate.sheet.grid).hinge_count
    beyond = [hinge for hinge in (*(hinge for hinge, _ in options.hinge_mm), *options.removed) if hinge >= count]
    if beyond:
        raise UsageError("export.no_such_connector", number=beyond[0], last=count - 1)


#: Edges and necks that fits leave to panels, in widths of their connectors.  Connectors on shorter edges get narrower
#: or stretch: at 1 mm on sheets of 100 mm, designs of a heart, a butterfly and a gear cannot be cut without this room,
#: and close with it.
ROOM_IN_WIDTHS = 2.75
#: Panels have room for their least tile times this: bows reach into panels, and tiles with narrower necks are left out.
TILE_ROOM = 1.1


def least_feature_mm(settings: FabricationSettings) -> float:
    """Least panel edge and neck, between centre lines of cuts, that the settings' materials allow.

    Where tiles are left out round connectors, an edge between two of them has room for the least tile.

    Raises
    ------
    FabricationError
        No such material.
    """
    cut = hinge_layer(settings)
    material = material_for(cut)
    least = max(material.min_ligament_mm, material.min_panel_mm)
    if is_backed(settings):
        relief = float(flexure_length(np.array(_connector_mm(cut, material)), kerf_mm(cut, material)))
        inset, tile = TileSizes(settings.gap_mm).inset_mm(kerf_mm(cut, material)), _board_tile_mm(settings)
        least = max(least, tile + 2.0 * relief, TILE_ROOM * tile + 2.0 * inset)
    return least + kerf_mm(cut, material)


def _board_tile_mm(settings: FabricationSettings) -> float:
    return least_tile_mm(material_for(board_layer(settings)))


def least_tile_mm(board: Material) -> float:
    """Least width of a tile."""
    return max(board.min_panel_mm, board.min_ligament_mm, LEAST_TILE_MM)


def room_mm(settings: FabricationSettings) -> float:
    """Panel edge and neck, between centre lines of cuts, that leaves connectors their full width.

    Raises
    ------
    FabricationError
        No such material.
    """
    cut = hinge_layer(settings)
    material = material_for(cut)
    return ROOM_IN_WIDTHS * _connector_mm(cut, material) + kerf_mm(cut, material)


def span_mm(settings: FabricationSettings) -> float:
    """Width of a connector and of the cut where connectors bow; 0 for others.

    Raises
    ------
    FabricationError
        No such material.
    """
    cut = hinge_layer(settings)
    if cut.options.style is not ConnectorStyle.CENTRED:
        return 0.0
    material = material_for(cut)
    return _connector_mm(cut, material) + kerf_mm(cut, material)


def _connector_mm(settings: FabricationSettings, material: Material) -> float:
    return material.connector_mm if settings.connector_mm is None else settings.connector_mm


def kerf_mm(settings: FabricationSettings, material: Material) -> float:
    """Width of the cut: of the settings, or of the material."""
    return material.kerf_mm if settings.kerf_mm is None else settings.kerf_mm
