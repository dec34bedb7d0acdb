"""Pinned designs as they are made: pieces in two layers, checked, and closed by their exact motion."""

from __future__ import annotations

import math
from collections import OrderedDict
from dataclasses import dataclass, replace

import shapely
from shapely.errors import GEOSException

from kirigami_studio.assembly.checks import PinnedReport, body_of, check_pinned, placed_bodies
from kirigami_studio.assembly.options import PinOptions
from kirigami_studio.assembly.pieces import Assembly
from kirigami_studio.assembly.pinned import PinnedPlan, pinned
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.fabricate.findings import Problem
from kirigami_studio.fabricate.machine import Machine, MachineKind
from kirigami_studio.fabricate.material import Material
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.settings.fabrication import FabricationSettings, is_printed, machine_for, material_for, pin_sizes
from kirigami_studio.studio.as_cut import AsCut, motion_on_pins

#: Assemblies that are kept: a design that is chosen again, or exported, has its pieces at once.
MOST_KEPT = 16


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
        in_one_plane=printed,
    )


@dataclass(frozen=True, eq=False)
class Assembled:
    """The pieces of a design, and what their check found."""

    plan: PinnedPlan
    report: PinnedReport
    as_cut: AsCut  #: Its motion: exact, on pins that bend nothing

    @property
    def assembly(self) -> Assembly:
        """Pieces, pins and their motion."""
        return self.plan.assembly


def print_problems(plan: PinnedPlan, material: Material, machine: Machine) -> tuple[Problem, ...]:
    """Problems of printing the pieces of a plan at once."""
    if MachineKind.of(material.machine) is not MachineKind.PRINTER:
        return (Problem.error("printed.material_is_cut", material=material.name),)
    bodies = placed_bodies(plan.assembly, [body_of(piece) for piece in plan.assembly.pieces], math.pi)
    left, bottom, right, top = shapely.total_bounds(bodies).tolist()
    size, bed = (right - left, top - bottom), machine.reach_mm
    if not any(0.0 < most < side for side, most in zip(size, bed, strict=True)):
        return ()
    values = {"width_mm": size[0], "depth_mm": size[1], "bed_width_mm": bed[0], "bed_depth_mm": bed[1]}
    return (Problem.error("printed.assembly_larger_than_bed", **values),)


_KEPT: OrderedDict[tuple[object, ...], Assembled] = OrderedDict()


def assembled(candidate: Candidate, settings: FabricationSettings, target: Outline) -> Assembled:
    """Make and check the pieces of a design; what was made lately is not made again.

    Parameters
    ----------
    candidate : Candidate
        What trimming took of it is not looked at: pieces are trimmed by rules of their own.
    settings : FabricationSettings
    target : Outline

    Raises
    ------
    FabricationError
        No such material, or pieces that cannot be made.
    UsageError
        An ear that is no wider than its hole.
    """
    options = pin_options(settings)
    machine = machine_for(settings) if options.in_one_plane else None
    key = (candidate, target, settings.width_mm, options, machine)
    made = _KEPT.pop(key, None)
    if made is None:
        design = PosedDesign(deploy(candidate.sheet), candidate.score.transform, candidate.score.phi)
        try:
            plan = pinned(design, target, settings.width_mm, options)
            report = check_pinned(plan)
            if machine is not None:
                more = print_problems(plan, material_for(settings), machine)
                report = replace(report, problems=(*more, *report.problems))
        except GEOSException as error:  # floating point ended the geometry of this one design
            raise FabricationError("pinned.not_made", reason=error) from error
        made = Assembled(plan, report, motion_on_pins(candidate.score.phi, report.figures.match))
    _KEPT[key] = made
    while len(_KEPT) > MOST_KEPT:
        _KEPT.popitem(last=False)
    return made
