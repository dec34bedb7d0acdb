"""Backed designs as they are made: a hinge layer, and tiles in a board, checked."""

from __future__ import annotations

from dataclasses import dataclass, replace

from shapely.errors import GEOSException

from kirigami_studio.assembly.backed import BackedSheet, Board, Jig
from kirigami_studio.assembly.holding import HeldPlaces, held_tiles, with_places
from kirigami_studio.assembly.pieces import Assembly
from kirigami_studio.assembly.tile_checks import TileReport, check_tiles
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.fabricate.checks import PlanReport, check_plan, machine_problems
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.machine import Machine
from kirigami_studio.fabricate.material import Material
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.settings.fabrication import (
    FabricationSettings,
    hold_options,
    machine_for,
    material_for,
    named_machine,
)
from kirigami_studio.settings.layers import board_layer
from kirigami_studio.studio.cutting import least_tile_mm


@dataclass(frozen=True, eq=False)
class Backing:
    """The tiles of a planned hinge layer in their board, and what their check found."""

    sheet: BackedSheet
    jig: Jig
    board: Board
    material: Material  #: of the board, as its machine cuts it
    machine: Machine
    kerf_mm: float
    report: TileReport
    assembly: Assembly  #: tiles with the holes of the places that hold them
    held: HeldPlaces


def backing_of(plan: CutPlan, deployment: Deployment, phi: float, settings: FabricationSettings) -> Backing:
    """Make the tiles of a planned hinge layer, and check them.

    Parameters
    ----------
    plan : CutPlan
        Of the hinge layer.
    deployment : Deployment
        The design of the plan.
    phi : float, radians
        Its target angle.
    settings : FabricationSettings
        Of the whole design.

    Raises
    ------
    FabricationError
        No such material, or geometry that cannot be made.
    """
    cut = board_layer(settings)
    material, machine = material_for(cut), machine_for(cut)
    kerf = material.kerf_mm if cut.kerf_mm is None else cut.kerf_mm
    beds = [(one.name, one.reach_mm) for one in (plan.machine, machine)]
    try:
        sheet = BackedSheet.of(plan, deployment, phi, plan.tiles)
        jig = sheet.jig(settings.board_cut, [bed for _, bed in beds])
        held = held_tiles(sheet.assembly, hold_options(cut), sheet.between_mm)
        assembly = with_places(sheet.assembly, held.places)
        board = sheet.board(jig, assembly)
        report = check_tiles(sheet, board, kerf, least_tile_mm(material), list(dict.fromkeys(beds)))
    except GEOSException as error:  # floating point ended the geometry of this one design
        raise FabricationError("pinned.not_made", reason=error) from error
    problems = (*report.problems, *machine_problems(named_machine(cut), material), *held.problems)
    return Backing(sheet, jig, board, material, machine, kerf, replace(report, problems=problems), assembly, held)


def checked_plan(
    candidate: Candidate, plan: CutPlan, deployment: Deployment, settings: FabricationSettings
) -> tuple[PlanReport, Backing | None]:
    """Check the cuts of a design, and the tiles on them if it is backed.

    Raises
    ------
    FabricationError
        As :func:`backing_of`.
    """
    report = check_plan(plan, phi=candidate.final_phi)
    if plan.tiles is None:
        return report, None
    backing = backing_of(plan, deployment, candidate.final_phi, settings)
    return replace(report, problems=(*report.problems, *backing.report.problems)), backing
