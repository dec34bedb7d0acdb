"""``export``, ``check`` and ``animate``: from saved projects to files, and back from files."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

from kirigami_studio.cli.console import print_json, say
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.export.animation import FRAMES, write_animation
from kirigami_studio.export.dxf_check import check_file
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.profile import DEFAULT_PROFILE, find_profile
from kirigami_studio.export.registry import export as export_file
from kirigami_studio.export.registry import find_exporter
from kirigami_studio.fabricate.checks import Report, Severity, check_plan
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.material import default_material, find_material
from kirigami_studio.foundation.errors import FabricationError, ProjectError, UsageError
from kirigami_studio.project.cutting import plan_of
from kirigami_studio.project.document import Document
from kirigami_studio.project.settings import FabricationSettings
from kirigami_studio.project.store import load


def material_settings(arguments: argparse.Namespace) -> FabricationSettings:
    """Fabrication settings from the width options; unknown materials are refused here, before any work."""
    material = default_material() if arguments.material is None else find_material(arguments.material)
    return _overridden(FabricationSettings(material=material.key), arguments)


def checked_plan(candidate: Candidate, fabrication: FabricationSettings) -> tuple[CutPlan, Report]:
    """The cut plan of a design, trimmed if it is, with these settings, and what the physics check says about it.

    Raises
    ------
    FabricationError
        The plan cannot be made, or the sheet would not survive it.
    """
    plan = plan_of(candidate, fabrication)
    report = check_plan(plan)
    for problem in report.problems:
        if problem.severity is Severity.ERROR:
            raise FabricationError(problem.text)
    return plan, report


def export(arguments: argparse.Namespace) -> int:
    """Write one cut or picture file from a project and report what is in it."""
    profile = find_profile(arguments.profile or DEFAULT_PROFILE)
    find_exporter(arguments.out)
    document = load(arguments.project)
    plan, report = checked_plan(_chosen(document), _overridden(document.fabrication, arguments))
    job = replace(_job(document), plan=plan, dxf_version=arguments.dxf_version, profile=profile.key)
    path = export_file(job, arguments.out)
    warnings = [*plan.notes, *(problem.text for problem in report.problems)]
    if arguments.json:
        print_json(
            {
                "files": [str(path)],
                "size_mm": plan.size_mm,
                "cut_length_mm": plan.cut_length_mm,
                "travel_mm": plan.travel_mm,
                "seconds_estimate": plan.seconds_estimate,
                "pieces": report.pieces,
                "min_connector_mm": plan.min_connector_mm,
                "warnings": warnings,
            }
        )
        return 0
    say(
        f"{path}: {plan.size_mm[0]:.2f} x {plan.size_mm[1]:.2f} mm, cut {plan.cut_length_mm:.1f} mm, travel "
        f"{plan.travel_mm:.1f} mm, about {plan.seconds_estimate:.0f} s, {report.pieces} piece(s), smallest connector "
        f"{plan.min_connector_mm:.3f} mm"
    )
    for warning in warnings:
        say(f"  note: {warning}")
    return 0


def check(arguments: argparse.Namespace) -> int:
    """Re-read a cut file; exit code 1 when something is wrong with it."""
    report = check_file(Path(arguments.file))
    problems = [problem.text for problem in report.problems]
    if arguments.json:
        print_json(
            {
                "ok": report.ok,
                "problems": problems,
                "unit": report.unit,
                "layers": report.layers,
                "paths": report.path_count,
                "size_mm": report.bounds_mm,
                "cut_length_mm": report.cut_length_mm,
                "overlap_mm": report.overlap_mm,
                "pieces": report.pieces,
                "min_ligament_mm": report.min_ligament_mm,
            }
        )
    else:
        say(f"{arguments.file}: {'ready to cut' if report.ok else 'not ready to cut'}")
        for problem in problems:
            say(f"  {problem}")
    return 0 if report.ok else 1


def animate(arguments: argparse.Namespace) -> int:
    """Write the deployment as an animated GIF."""
    path = Path(arguments.out)
    if path.suffix.lower() != ".gif":
        raise UsageError(f"animate writes .gif files, got {path.name}.")
    document = load(arguments.project)
    frames = write_animation(_job(document), path, FRAMES)
    if arguments.json:
        print_json({"frames": frames, "files": [str(path)]})
    else:
        say(f"{path}: {frames} frames")
    return 0


def _chosen(document: Document) -> Candidate:
    candidate = document.candidate
    if candidate is None or document.target is None:
        raise ProjectError("This project has no chosen design yet; generate candidates and choose one first.")
    return candidate


def _job(document: Document) -> ExportJob:
    return ExportJob.of(_chosen(document), None if document.target is None else document.target.points)


def _overridden(saved: FabricationSettings, arguments: argparse.Namespace) -> FabricationSettings:
    """The project's settings with the command line's on top."""
    changes = {
        name: value
        for name in ("width_mm", "connector_mm", "kerf_mm")
        if (value := getattr(arguments, name)) is not None
    }
    if arguments.material is not None:
        changes["material"] = find_material(arguments.material).key
    return replace(saved, **changes)
