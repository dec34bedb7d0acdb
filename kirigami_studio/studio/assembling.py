"""Pinned designs as they are made: pieces in two layers, checked, and closed by their exact motion."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, field, replace
from functools import partial

from shapely.errors import GEOSException

from kirigami_studio.assembly.checks import PinnedReport, bed_problems, check_pinned
from kirigami_studio.assembly.driving import DriveParts, driven
from kirigami_studio.assembly.holding import HeldPlaces, held, with_places
from kirigami_studio.assembly.options import PinOptions
from kirigami_studio.assembly.pieces import Assembly
from kirigami_studio.assembly.pinned import PinnedPlan, pinned
from kirigami_studio.assembly.plates import flat_bounds, parts_for, seams, size_of
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.fabricate.drive import DriveKind
from kirigami_studio.fabricate.findings import Problem
from kirigami_studio.fabricate.machine import Machine, MachineKind
from kirigami_studio.fabricate.material import Material
from kirigami_studio.foundation.errors import FabricationError, KirigamiError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.settings.fabrication import (
    FabricationSettings,
    hold_options,
    is_printed,
    machine_for,
    material_for,
    pin_sizes,
)
from kirigami_studio.studio.as_cut import AsCut, motion_on_pins, motions_on_pins
from kirigami_studio.studio.cutting import kerf_mm

#: Weight of the target against the flat outline: pieces stick out of that one for it where it has area to spare.
#: Printed sheets have none: gaps between their pieces take it.
TARGET_FIRST = 0.75
#: Assemblies that are kept: a design that is chosen again, or exported, has its pieces at once.
MOST_KEPT = 48


def pin_options(settings: FabricationSettings) -> PinOptions:
    """Sizes for the pieces of a pinned sheet; a piece is nowhere narrower than its material allows.

    Raises
    ------
    FabricationError
        No such material.
    UsageError
        An ear that is no wider than its hole.
    """
    sizes, printed = pin_sizes(settings), is_printed(settings)
    return PinOptions(
        pin_mm=sizes.hole_mm,
        ear_mm=sizes.ear_mm,
        clearance_mm=sizes.clearance_mm,
        neck_mm=sizes.neck_mm,
        wall_mm=0.5 * (sizes.ear_mm - sizes.hole_mm) if printed else None,  # a joint needs all of its ear
        head_mm=sizes.head_mm,
        margin_mm=sizes.margin_mm,
        weight=0.5 if printed else TARGET_FIRST,
        in_one_plane=printed,
    )


@dataclass(frozen=True, eq=False)
class Assembled:
    """The pieces of a design, and what their check found."""

    plan: PinnedPlan
    report: PinnedReport
    as_cut: AsCut  #: Its motion: exact, on pins that bend nothing
    #: Places that hold it in its end states; their holes are in the pieces.
    held: HeldPlaces = field(default_factory=HeldPlaces)
    drive: DriveParts | None = None  #: board and arms that move it

    @property
    def assembly(self) -> Assembly:
        """Pieces, pins and their motion."""
        return self.plan.assembly


def print_problems(plan: PinnedPlan, material: Material, machine: Machine) -> tuple[Problem, ...]:
    """Problems of printing the pieces of a plan at once."""
    if MachineKind.of(material.machine) is not MachineKind.PRINTER:
        return (Problem.error("printed.material_is_cut", material=material.name),)
    parts = parts_for(plan.assembly, machine.reach_mm)
    if parts is None:
        size, bed = size_of(flat_bounds(plan.assembly)), machine.reach_mm
        values = {"width_mm": size[0], "depth_mm": size[1], "bed_width_mm": bed[0], "bed_depth_mm": bed[1]}
        return (Problem.error("printed.assembly_larger_than_bed", **values),)
    if len(parts) == 1:
        return ()
    values = {"count": len(parts), "caps": len(seams(plan.assembly, parts))}
    return (Problem.warning("printed.joined_by_hand", **values),)


_KEPT: OrderedDict[tuple[object, ...], Assembled] = OrderedDict()


def assembled(
    candidate: Candidate, settings: FabricationSettings, target: Outline, only_whole: bool = False
) -> Assembled:
    """Make and check the pieces of a design; what was made lately is not made again.

    Parameters
    ----------
    candidate : Candidate
        Of a trim only the panels count that a cover gives up: pieces are trimmed by rules of their own.
    settings : FabricationSettings
    target : Outline
    only_whole : bool
        Stop where a piece falls apart, before rims are shaped.

    Raises
    ------
    FabricationError
        No such material, or pieces that cannot be made, or fall apart where only whole ones are
        wanted.
    UsageError
        An ear that is no wider than its hole.
    """
    key = _key(candidate, settings, target)
    made = _KEPT.get(key) or _made(candidate, settings, target, only_whole)
    _keep(key, made)
    return made


def kept(candidate: Candidate, settings: FabricationSettings, target: Outline) -> Assembled | None:
    """Find the pieces of a design if they were made lately.

    None without any, and by settings that none can be made by.
    """
    try:
        return _KEPT.get(_key(candidate, settings, target))
    except KirigamiError:
        return None


def keep(candidate: Candidate, settings: FabricationSettings, target: Outline, made: Assembled) -> None:
    """Keep the pieces that another process has made."""
    _keep(_key(candidate, settings, target), made)


def _keep(key: tuple[object, ...], made: Assembled) -> None:
    _KEPT[key] = made
    _KEPT.move_to_end(key)
    while len(_KEPT) > MOST_KEPT:
        _KEPT.popitem(last=False)


def _key(candidate: Candidate, settings: FabricationSettings, target: Outline) -> tuple[object, ...]:
    """All that pieces depend on."""
    options, hold = pin_options(settings), hold_options(settings)
    machine = machine_for(settings) if options.in_one_plane else None
    return candidate, target, settings.width_mm, options, machine, hold, settings.moved_by


def _made(candidate: Candidate, settings: FabricationSettings, target: Outline, only_whole: bool) -> Assembled:
    options, hold = pin_options(settings), hold_options(settings)
    machine = machine_for(settings) if options.in_one_plane else None
    design = _posed(candidate)
    try:
        plan = pinned(design, target, settings.width_mm, options, only_whole)
        report = check_pinned(plan)
        if machine is not None:
            more = print_problems(plan, material_for(settings), machine)
            report = replace(report, problems=(*more, *report.problems))
        places = held(plan, hold)
    except GEOSException as error:  # floating point ended the geometry of this one design
        raise FabricationError("pinned.not_made", reason=error) from error
    plan = replace(plan, assembly=with_places(plan.assembly, places.places))
    moved_by = settings.moved_by if machine is None else DriveKind.NONE
    drive, refused = driven(plan, moved_by, partial(motions_on_pins, plan.assembly.deployment, settings))
    report = replace(report, problems=(*report.problems, *places.problems, *refused))
    figures = report.figures
    motion = motion_on_pins(candidate.score.phi, figures.match, figures.flat_match)
    return Assembled(plan, report, motion, places, drive)


def _posed(candidate: Candidate) -> PosedDesign:
    """The design over its target: a cover with its trim, others as they were before it."""
    trim = candidate.trim
    if trim is not None and trim.sheet == candidate.sheet:
        return PosedDesign(deploy(trim.sheet), trim.pose, trim.phi, trim)
    return PosedDesign(deploy(candidate.sheet), candidate.score.transform, candidate.score.phi)


def beyond_the_bed(made: Assembled, settings: FabricationSettings) -> list[Problem]:
    """Problems of cut pieces that are larger than the bed of the machine; printed ones have their own.

    Raises
    ------
    FabricationError
        No such material.
    """
    if is_printed(settings):
        return []
    bed, kerf = machine_for(settings).reach_mm, kerf_mm(settings, material_for(settings))
    return bed_problems(made.assembly, bed, kerf, settings.width_mm, pin_sizes(settings).ear_mm)
