"""``mechanics``: a cut sheet, or a given network of panels, on its elastic connectors."""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kirigami_studio.cli.console import print_json, say
from kirigami_studio.cli.fabrication import overridden
from kirigami_studio.cli.inputs import PROJECTS, read_sheets
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.fabricate.material import Material
from kirigami_studio.fabricate.strain import StrainFigure, Survival, strain_note, survival
from kirigami_studio.foundation.errors import MechanicsError, UsageError
from kirigami_studio.foundation.words import tr
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.mechanics.closing import STEPS, Closing, closing
from kirigami_studio.mechanics.drive import Drive, clamped_ends
from kirigami_studio.mechanics.equilibrium import EquilibriumPath, follow
from kirigami_studio.mechanics.gripping import Gripping, find_grips
from kirigami_studio.mechanics.loads import Loads, loads
from kirigami_studio.mechanics.network_files import NetworkFile, SpringConstants, morpher_drive, read_network
from kirigami_studio.mechanics.sheet_network import SheetNetwork
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.store import load
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.as_cut import (
    LEAST_STEPS,
    Leading,
    Overlap,
    Source,
    breaking_phi,
    jam_of,
    overlap,
    planned_sheet,
)
from kirigami_studio.studio.cutting import plan_sheet

FLAT_DEG = 180.0
NETWORK_STEPS = 100
#: Rows of the table for a person.
SHOWN_ROWS = 11
AXES = {"x": (0, 0), "y": (1, 1), "xx": (0, 0), "yy": (1, 1), "xy": (0, 1), "yx": (1, 0)}


def mechanics(arguments: argparse.Namespace) -> int:
    """Close a sheet, or drive a network, and print force, energy, strain and stability."""
    if (arguments.source is None) == (arguments.network is None):
        raise UsageError("mechanics.one_source")
    if arguments.steps is None:
        arguments.steps = STEPS if arguments.network is None else NETWORK_STEPS
    if arguments.steps < LEAST_STEPS:
        raise UsageError("drive.too_few_steps", found=arguments.steps, least=LEAST_STEPS)
    return _drive_network(arguments) if arguments.network is not None else _close_sheet(arguments)


@dataclass(frozen=True, slots=True, eq=False)
class _Cut:
    """A sheet as it is cut."""

    #: design, deployment: as designed, and as it is cut.
    design: Deployment
    deployment: Deployment
    sheet: SheetNetwork
    settings: FabricationSettings
    target: Outline | None
    phi: float  #: radians; at which the sheet is meant to show the target
    material: Material
    pose: Similarity | None  #: Of the design at that angle over the target


def _close_sheet(arguments: argparse.Namespace) -> int:
    cut = _cut(arguments)
    hold, move = (tuple(panels or ()) for panels in (arguments.hold, arguments.move))
    lead = Leading(hold, move, math.radians(arguments.end_deg), arguments.steps)
    width, gripping = cut.settings.width_mm, None
    if arguments.find_grips and not hold:
        gripping = find_grips(cut.deployment, cut.sheet, width, lead.end, lead.steps)
        found = gripping.closing
    else:
        found = closing(cut.sheet, lead.drive(cut.deployment, cut.sheet, width))
    gripped, tolerated = bool(hold) or arguments.find_grips, arguments.tolerance
    jams_at, source = jam_of(found, cut.deployment, width, tolerated)
    jam = math.degrees(jams_at)
    lap = None
    if cut.target is not None:
        jam_phi = found.jam_phi(tolerated)
        lap = overlap(cut.deployment, found, width, cut.phi, jam_phi, cut.target, design=cut.design, pose=cut.pose)
    load = loads(found, cut.material.yield_strain)
    breaks = breaking_phi(cut.material, found)
    judged = survival(cut.material, cut.sheet.connectors.width_mm, found.in_plane, found.out_of_plane)
    if arguments.json:
        answer = _steps(cut, found, gripped) | load.in_plane.to_json() | {"tolerated_stretch_widths": tolerated}
        answer |= {name: getattr(load, name).to_json() for name in ("in_plane_yielding", "out_of_plane")}
        answer |= {"lever_mm": None if gripped else cut.sheet.network.panel_size, "material": cut.material.key}
        answer |= {"strain_believed": judged.figure.value, "strain_limit": judged.limit, "strain_why": judged.why.text}
        answer |= {"breaks": breaks is not None, "breaks_deg": None if breaks is None else math.degrees(breaks)}
        answer |= {"jam_deg": jam, "jam_from": source.value}
        if gripping is not None:
            answer |= {"hold": gripping.held, "move": gripping.moved, "follows": gripping.follows}
        print_json(answer if lap is None else answer | _overlap_json(lap))
        return 0
    _tell_steps(found, load)
    _tell_loads(load, judged)
    if breaks is not None:
        say(tr("Its connectors break at {angle:.0f} degrees.", angle=math.degrees(breaks)))
    say(strain_note(cut.material, judged).text)
    _tell_jam(jam, source, tolerated, breaks is not None)
    stable = ", ".join(f"{angle:.0f}" for angle in np.degrees(found.stable_phi))
    say(tr("Rests by itself at (degrees): {angles}.", angles=stable or tr("nowhere on this path")))
    if gripping is not None:
        _tell_grips(gripping)
    if lap is not None:
        _tell_overlap(lap)
    say(tr("Friction is not modelled, and the path is that of connectors that are elastic in the plane."))
    return 0


def _cut(arguments: argparse.Namespace) -> _Cut:
    """The sheet that the command line names, with the material, widths and kerf that apply."""
    path, target, phi, pose, kept = Path(arguments.source), None, 0.0, None, None
    if path.suffix.lower() in PROJECTS:
        document = load(path)
        if (candidate := document.candidate) is None:
            raise MechanicsError("mechanics.no_design_chosen", path=path)
        deployment, saved = deploy(candidate.final_sheet), document.fabrication
        target, phi, pose = document.target, candidate.final_phi, candidate.final_pose
        kept = None if candidate.trim is None else candidate.trim.kept
    else:
        named = list(read_sheets([arguments.source]))
        if len(named) != 1:
            raise UsageError("mechanics.one_sheet", name=arguments.source, found=len(named))
        deployment, saved = deploy(named[0].read()), FabricationSettings()
    settings = overridden(saved, arguments)
    plan = plan_sheet(deployment, settings, kept)
    on_nodes = arguments.centres == "node"
    sheet = planned_sheet(deployment, plan, settings.width_mm, kept, on_nodes, arguments.young_gpa)
    return _Cut(deployment, plan.cut_from(deployment), sheet, settings, target, phi, plan.material, pose)


def _steps(cut: _Cut, found: Closing, gripped: bool) -> dict[str, object]:
    """The JSON of every step, and of the sheet."""
    connectors = cut.sheet.connectors
    opening = np.degrees(cut.sheet.opening(found.path.motion))
    return {
        "panels": cut.sheet.network.panel_count,
        "connectors": len(connectors),
        "width_mm": cut.settings.width_mm,
        "connector_mm": float(connectors.width_mm.min()),
        "phi_deg": np.degrees(found.phi),
        "least_phi_deg": FLAT_DEG - opening.max(axis=1),
        "most_phi_deg": FLAT_DEG - opening.min(axis=1),
        "displacement": found.path.drive.displacement,
        "displacement_unit": "mm" if gripped else "rad",
        "max_stretch_widths": found.stretch.max(axis=1),
        "max_strain": found.in_plane.max(axis=1),
        "max_strain_out_of_plane": found.out_of_plane.max(axis=1),
        "least_eigenvalue_n_mm": found.path.least,
        "snap_deg": np.degrees(found.phi[found.path.snapped]),
        "stuck": len(found.phi) < found.asked,
        "stable_deg": np.degrees(found.stable_phi),
        "stretch_at_end_widths": found.stretch[-1],
    }


def _tell_steps(found: Closing, load: Loads) -> None:
    """Some of the steps as a table."""
    force = load.in_plane.force_n
    say(tr("   phi   energy mJ     force N  stretch  strain in plane, out of plane"))
    stretch, inner, outer = (100.0 * part.max(axis=1) for part in (found.stretch, found.in_plane, found.out_of_plane))
    for step in _shown(len(found.phi)):
        phi, energy = math.degrees(found.phi[step]), found.path.energy[step]
        say(
            f"{phi:6.1f}  {energy:10.4g}  {force[step]:10.4g}  {0.01 * stretch[step]:6.3f}w  {inner[step]:8.1f} % "
            f"{outer[step]:8.1f} %"
        )


def _tell_loads(load: Loads, judged: Survival) -> None:
    """Energy and force by all figures, the one first that is believed."""
    named = [
        (tr("bent out of the plane"), load.out_of_plane),
        (tr("in the plane, yielding"), load.in_plane_yielding),
        (tr("in the plane, elastic"), load.in_plane),
    ]
    for name, one in named if judged.figure is StrainFigure.OUT_OF_PLANE else [*named[1:], named[0]]:
        energy, force = one.energy_mj[-1], np.abs(one.force_n).max()
        if one.torque_nmm is None:
            say(tr("{name}: {energy:.4g} mJ at the end, at most {force:.4g} N.", name=name, energy=energy, force=force))
        else:
            say(
                tr(
                    "{name}: {energy:.4g} mJ at the end, at most {torque:.4g} N mm, or {force:.4g} N at a lever as "
                    "long as a panel.",
                    name=name,
                    energy=energy,
                    torque=np.abs(one.torque_nmm).max(),
                    force=force,
                )
            )


def _tell_jam(jam: float, source: Source, tolerated: float, breaks: bool) -> None:
    if source is Source.ESTIMATE:
        say(tr("As far as it was driven no connector is stretched by more than {w:g} of its width.", w=tolerated))
        jams = tr("It jams at {jam:.0f} degrees (estimate).", jam=jam)
        say(jams if jam > 0.0 else tr("Beyond that it closes (estimate)."))
    elif jam == 0.0 and breaks:
        say(tr("It would close if they held: none is stretched by more than {w:g} of its width.", w=tolerated))
    elif jam == 0.0:
        say(tr("Closes: no connector is stretched by more than {w:g} of its width.", w=tolerated))
    else:
        say(
            tr(
                "Jams at {jam:.0f} degrees: a connector would be stretched by more than {w:g} of its width, or panels "
                "touch.",
                jam=jam,
                w=tolerated,
            )
        )


def _tell_grips(gripping: Gripping) -> None:
    hold, move = (", ".join(str(panel) for panel in panels) for panels in (gripping.held, gripping.moved))
    if gripping.follows:
        say(tr("Hold panel {hold} and lead panels {move}: the sheet follows its path.", hold=hold, move=move))
    else:
        say(
            tr(
                "Not even by holding panel {hold} and leading panels {move} does the sheet follow its path.",
                hold=hold,
                move=move,
            )
        )


def _overlap_json(lap: Overlap) -> dict[str, float]:
    """The angles in degrees, and the IoU."""
    return {
        "reached_deg": math.degrees(lap.reached),
        "iou_as_cut": lap.iou_as_cut,
        "forced_deg": math.degrees(lap.forced),
        "iou_forced": lap.iou_forced,
        "iou_ideal": lap.iou_ideal,
    }


def _tell_overlap(lap: Overlap) -> None:
    say(
        tr(
            "IoU as cut, at {phi:.0f} degrees: {cut:.4f}; forced to {end:.0f} degrees: {forced:.4f}; as designed: "
            "{ideal:.4f}.",
            phi=math.degrees(lap.reached),
            cut=lap.iou_as_cut,
            end=math.degrees(lap.forced),
            forced=lap.iou_forced,
            ideal=lap.iou_ideal,
        )
    )


def _shown(steps: int) -> list[int]:
    """Numbers of the steps that the table shows."""
    numbers: list[int] = np.unique(np.linspace(0, steps - 1, SHOWN_ROWS).round().astype(int)).tolist()
    return numbers


def _drive_network(arguments: argparse.Namespace) -> int:
    given = {"--ka": arguments.ka, "--ks": arguments.ks, "--kt": arguments.kt}
    if missing := [name for name, value in given.items() if value is None]:
        raise UsageError("mechanics.constant_missing", option=missing[0])
    constants = SpringConstants(arguments.ka, arguments.ks, arguments.kt, arguments.contact)
    file = read_network(Path(arguments.network), constants)
    drive = _network_drive(file, arguments.drive, arguments.steps)
    found = follow(file.network, drive)
    if arguments.json:
        print_json(
            {
                "panels": file.network.panel_count,
                "ligaments": len(file.network.ligaments),
                "displacement_mm": drive.displacement,
                "force_n": found.force,
                "energy_mj": found.energy,
                "least_eigenvalue_n_mm": found.least,
                "snap_mm": drive.displacement[found.snapped],
                "stable_mm": found.stable,
            }
        )
        return 0
    _tell_network(found)
    return 0


def _tell_network(found: EquilibriumPath) -> None:
    say(tr("displacement mm     force N   energy mJ"))
    at = found.drive.displacement
    for step in _shown(len(at)):
        say(f"{at[step]:15.3f}  {found.force[step]:10.4g}  {found.energy[step]:10.4g}")
    stable = ", ".join(f"{place:.2f}" for place in found.stable)
    say(tr("Rests by itself at (mm): {places}.", places=stable or tr("nowhere on this path")))


def _network_drive(file: NetworkFile, text: str, steps: int) -> Drive:
    """``morpher``, or ``clamped:AXIS:MM``."""
    if text == "morpher":
        return morpher_drive(file, steps)
    kind, _, rest = text.partition(":")
    axis, _, distance = rest.partition(":")
    try:
        length = float(distance)
    except ValueError:
        length = math.nan
    if kind != "clamped" or axis not in AXES or not math.isfinite(length) or length == 0.0:
        raise UsageError("mechanics.unknown_drive", text=text)
    ends, direction = AXES[axis]
    return clamped_ends(file.network, ends, direction, length, steps)
