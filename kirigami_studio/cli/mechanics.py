"""``mechanics``: what a cut sheet, or a given network of panels, does on its elastic connectors."""

from __future__ import annotations

import argparse
import math
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from kirigami_studio.cli.console import print_json, say
from kirigami_studio.cli.fabrication import overridden
from kirigami_studio.cli.inputs import read_sheets
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.siou import siou_of_many
from kirigami_studio.fabricate.panel_sizes import panels_in_mm
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import MechanicsError, UsageError
from kirigami_studio.foundation.words import tr
from kirigami_studio.lattice.deployment import Deployment, deploy
from kirigami_studio.mechanics.closing import (
    CLOSED,
    STEPS,
    Closing,
    carried_on,
    closing,
    even_closing,
    ideal_motion,
    silhouette,
)
from kirigami_studio.mechanics.connectors import ElasticSheet, cut_connectors, junctions
from kirigami_studio.mechanics.drive import Drive, clamped_ends
from kirigami_studio.mechanics.equilibrium import EquilibriumPath, follow
from kirigami_studio.mechanics.estimate import estimate_stretch
from kirigami_studio.mechanics.gripping import Gripping, find_grips, grips
from kirigami_studio.mechanics.network_files import NetworkFile, SpringConstants, morpher_drive, read_network
from kirigami_studio.mechanics.sheet_network import SheetNetwork, polygons_as_rows, sheet_network
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.cutting import plan_sheet
from kirigami_studio.project.settings import FabricationSettings
from kirigami_studio.project.store import SUFFIX as PROJECT
from kirigami_studio.project.store import load

MPA_PER_GPA = 1e3
FLAT_DEG = 180.0
LEAST_STEPS, NETWORK_STEPS = 3, 100
#: A sheet within this (radians) of being closed has closed.
CLOSE_TO = math.radians(1.0)
#: A connector counts as longer than a straight one above this (mm); coordinates are rounded to a tenth of it.
LONGER_MM = 1e-3
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
    """A sheet as it is cut.

    Attributes
    ----------
    deployment : Deployment
    sheet : SheetNetwork
    settings : FabricationSettings
    target : Outline or None
    phi : float, radians
        At which the sheet is meant to show the target.
    """

    deployment: Deployment
    sheet: SheetNetwork
    settings: FabricationSettings
    target: Outline | None
    phi: float


@dataclass(frozen=True, slots=True, eq=False)
class _Overlap:
    """Angles (degrees) that the sheet comes to, by itself and forced, and its IoU there and as designed."""

    reached_deg: float
    iou_as_cut: float
    forced_deg: float
    iou_forced: float
    iou_ideal: float


def _close_sheet(arguments: argparse.Namespace) -> int:
    cut = _cut(arguments)
    if (arguments.hold is None) != (arguments.move is None):
        raise UsageError("mechanics.hold_and_move")
    if arguments.end_deg >= FLAT_DEG:
        raise UsageError("mechanics.end_angle", angle=arguments.end_deg)
    end, width, gripping = math.radians(arguments.end_deg), cut.settings.width_mm, None
    if arguments.hold is not None:
        drive = grips(cut.deployment, cut.sheet, width, arguments.hold, arguments.move, end, arguments.steps)
        found = closing(cut.sheet, drive)
    elif arguments.find_grips:
        gripping = find_grips(cut.deployment, cut.sheet, width, end, arguments.steps)
        found = gripping.closing
    else:
        found = closing(cut.sheet, even_closing(cut.sheet, end, arguments.steps))
    gripped, tolerated = arguments.hold is not None or arguments.find_grips, arguments.tolerance
    jam = None if _ended_early(found, tolerated) else math.degrees(found.jam_phi(tolerated))
    estimate = math.degrees(estimate_stretch(cut.deployment, cut.sheet, width).jam_phi(tolerated))
    overlap = None if cut.target is None else _overlap(cut, found, found.jam_phi(tolerated), cut.target)
    # Against an angle the slope of the energy is a moment: what a lever of one panel's size needs at its end.
    force = found.path.force / (1.0 if gripped else cut.sheet.network.panel_size)
    if arguments.json:
        answer = _steps(cut, found, gripped) | {"force_n": force, "tolerated_stretch_widths": tolerated}
        answer |= {"jam_deg": jam, "estimated_jam_deg": estimate}
        if gripping is not None:
            answer |= {"hold": gripping.held, "move": gripping.moved, "follows": gripping.follows}
        print_json(answer if overlap is None else answer | asdict(overlap))
        return 0
    _tell_steps(found, force)
    _tell_jam(jam, estimate, tolerated)
    stable = ", ".join(f"{angle:.0f}" for angle in np.degrees(found.stable_phi))
    say(tr("Rests by itself at (degrees): {angles}.", angles=stable or tr("nowhere on this path")))
    if gripping is not None:
        _tell_grips(gripping)
    if overlap is not None:
        _tell_overlap(overlap)
    say(tr("Friction, plastic set and motion out of the plane are not modelled."))
    return 0


def _cut(arguments: argparse.Namespace) -> _Cut:
    """The sheet that the command line names, with the material, widths and kerf that apply."""
    path, target, phi, kept = Path(arguments.source), None, 0.0, None
    if path.suffix.lower() == PROJECT:
        document = load(path)
        candidate = _chosen(document.candidate, path)
        deployment, saved = deploy(candidate.final_sheet), document.fabrication
        target, phi = document.target, candidate.final_phi
        kept = None if candidate.trim is None else candidate.trim.kept
    else:
        named = list(read_sheets([arguments.source]))
        if len(named) != 1:
            raise UsageError("mechanics.one_sheet", name=arguments.source, found=len(named))
        deployment, saved = deploy(named[0].read()), FabricationSettings()
    settings = overridden(saved, arguments)
    plan = plan_sheet(deployment, settings, kept)
    hinges = plan.hinges
    found = junctions(deployment, settings.width_mm, cut_table(*deployment.sheet.grid).hinge_node)
    # A straight slit's connector bends over a span; arcs and bars make it longer.
    longer = np.where(hinges.removed, 0.0, hinges.flexure_mm - hinges.requested_mm - plan.kerf_mm)
    polygons = panels_in_mm(deployment, () if kept is None else kept, settings.width_mm, np.zeros(2))
    centres = None
    if arguments.centres == "node":
        centres = found.place
    elif plan.centres is not None:
        # The plan has its own origin.
        centres = plan.centres + (polygons[0][0] - plan.panels[0][0])
    connectors = cut_connectors(
        found,
        np.maximum(hinges.finished_mm, 0.0),
        plan.kerf_mm,
        centres,
        np.where(longer > LONGER_MM, longer, 0.0),
    )
    young = plan.material.young_gpa if arguments.young_gpa is None else arguments.young_gpa
    elastic = ElasticSheet(MPA_PER_GPA * young, plan.material.thickness_mm)
    sheet = sheet_network(polygons_as_rows(polygons), connectors, elastic)
    return _Cut(deployment, sheet, settings, target, phi)


def _chosen(candidate: Candidate | None, path: Path) -> Candidate:
    if candidate is None:
        raise MechanicsError("mechanics.no_design_chosen", path=path)
    return candidate


def _steps(cut: _Cut, found: Closing, gripped: bool) -> dict[str, object]:
    """What the JSON tells of every step, and of the sheet."""
    connectors = cut.sheet.connectors
    opening = np.degrees(cut.sheet.opening(found.path.motion))
    thin = cut.sheet.sheet.thickness_mm < float(connectors.width_mm.min())
    return {
        "panels": cut.sheet.network.panel_count,
        "connectors": len(connectors),
        "width_mm": cut.settings.width_mm,
        "connector_mm": float(connectors.width_mm.min()),
        "phi_deg": np.degrees(found.phi),
        "least_phi_deg": FLAT_DEG - opening.max(axis=1),
        "most_phi_deg": FLAT_DEG - opening.min(axis=1),
        "energy_mj": found.path.energy,
        "displacement": found.path.drive.displacement,
        "displacement_unit": "mm" if gripped else "rad",
        "max_stretch_widths": found.stretch.max(axis=1),
        "max_strain": found.in_plane.max(axis=1),
        "max_strain_out_of_plane": found.out_of_plane.max(axis=1),
        "strain_believed": "out_of_plane" if thin else "in_plane",
        "least_eigenvalue_n_mm": found.path.least,
        "snap_deg": np.degrees(found.phi[found.path.snapped]),
        "stuck": len(found.phi) < found.asked,
        "stable_deg": np.degrees(found.stable_phi),
        "stretch_at_end_widths": found.stretch[-1],
    }


def _ended_early(found: Closing, tolerated: float) -> bool:
    """Whether the sheet was not driven as far as it would go, so that nothing is known about where it jams."""
    free = len(found.phi) == found.asked and float(found.stretch.max()) <= tolerated
    return free and float(found.phi[-1]) > CLOSED + CLOSE_TO


def _overlap(cut: _Cut, found: Closing, jam: float, target: Outline) -> _Overlap:
    """IoU with the target of the sheet as cut, where it comes to, and as designed."""
    width, network = cut.settings.width_mm, cut.sheet.network
    # A sheet that came to the last step goes on to the angle that it is meant for.
    closed = len(found.phi) == found.asked and found.phi.min() <= CLOSED + CLOSE_TO
    forced = cut.phi if closed else max(cut.phi, float(found.phi.min()))
    reached = max(forced, jam)
    motions = (
        carried_on(found, cut.deployment, width, reached),
        carried_on(found, cut.deployment, width, forced),
        ideal_motion(cut.deployment, network, width, cut.phi),
    )
    rings = [silhouette(cut.deployment, network, width, motion) for motion in motions]
    as_cut, shut, ideal = (siou_of_many([ring], target)[0].iou_exact for ring in rings)
    return _Overlap(math.degrees(reached), as_cut, math.degrees(forced), shut, ideal)


def _tell_steps(found: Closing, force: FloatArray) -> None:
    """Some of the steps as a table."""
    say(tr("   phi   energy mJ     force N  stretch  strain in plane, out of plane"))
    stretch, inner, outer = (100.0 * part.max(axis=1) for part in (found.stretch, found.in_plane, found.out_of_plane))
    for step in _shown(len(found.phi)):
        phi, energy = math.degrees(found.phi[step]), found.path.energy[step]
        say(
            f"{phi:6.1f}  {energy:10.4g}  {force[step]:10.4g}  {0.01 * stretch[step]:6.3f}w  {inner[step]:8.1f} % "
            f"{outer[step]:8.1f} %"
        )


def _tell_jam(jam: float | None, estimate: float, tolerated: float) -> None:
    if jam is None:
        say(tr("As far as it was driven no connector is stretched by more than {w:g} of its width.", w=tolerated))
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
    say(tr("Fast estimate of the same angle: {jam:.0f} degrees.", jam=estimate))


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


def _tell_overlap(overlap: _Overlap) -> None:
    say(
        tr(
            "IoU as cut, at {phi:.0f} degrees: {cut:.4f}; forced to {end:.0f} degrees: {forced:.4f}; as designed: "
            "{ideal:.4f}.",
            phi=overlap.reached_deg,
            cut=overlap.iou_as_cut,
            end=overlap.forced_deg,
            forced=overlap.iou_forced,
            ideal=overlap.iou_ideal,
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
