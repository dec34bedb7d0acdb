"""The cuts of a design in a material: planned, checked, simulated, judged and written."""

from __future__ import annotations

import html
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from kirigami_studio.api.design import Design
from kirigami_studio.api.pictures import cuts_picture
from kirigami_studio.api.simulation import Simulation
from kirigami_studio.export.export_set import ExportSet, export_all
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.provenance import sidecar_path, write_sidecar
from kirigami_studio.export.registry import export
from kirigami_studio.export.verification import FORMATS, Verification, verify_export
from kirigami_studio.fabricate.checks import Report, check_plan
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.steps import result_of
from kirigami_studio.project.export_job import cut_job
from kirigami_studio.project.settings import FabricationSettings, with_choices
from kirigami_studio.studio.as_cut import simulate
from kirigami_studio.studio.cutting import check_connectors, plan_of, refuse_errors
from kirigami_studio.studio.verdict import Level, Verdict, judge

#: Colours of the levels of a verdict, on white and on black.
LEVELS = {Level.READY: "#30a46c", Level.CARE: "#d9730d", Level.FAILS: "#e5484d"}


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Cuts:
    """All cuts of a design in mm, in a material, and what is to be expected of the sheet.

    In a notebook it shows the cuts and the verdict.

    Attributes
    ----------
    design : Design
    settings : FabricationSettings
        Material, sizes, connectors, machine.
    plan : CutPlan
        The value of the program: paths in cutting order, connectors, notes.
    report : Report
        What the check of the plan found.
    """

    design: Design
    settings: FabricationSettings
    plan: CutPlan
    report: Report

    @property
    def material(self) -> str:
        """Key of the material."""
        return self.plan.material.key

    @property
    def size_mm(self) -> tuple[float, float]:
        """Width and height of the flat sheet."""
        return self.plan.size_mm

    @property
    def cut_length_mm(self) -> float:
        return self.plan.cut_length_mm

    @property
    def seconds(self) -> float:
        """Estimated time of cutting one sheet."""
        return self.plan.seconds_estimate

    @property
    def pieces(self) -> int:
        """Pieces that the sheet is in after cutting: 1 unless something is wrong."""
        return self.report.pieces

    @property
    def min_connector_mm(self) -> float:
        """Smallest finished connector."""
        return self.plan.min_connector_mm

    @property
    def verdict(self) -> Verdict:
        """Whether it is ready to cut, and why not: ``level``, ``ok``, ``problems``, ``notes``, ``lines``.

        Made of the check of the plan, the simulation and the material; the sheet is closed when first asked for.
        """
        return _judged(self)

    def simulate(self) -> Simulation:
        """Close the sheet on its connectors; done once.

        Raises
        ------
        MechanicsError
            Panels that do not hang together.
        """
        return _simulated(self)

    def export(self, path: str | os.PathLike[str], *, record: bool = False) -> Exported:
        """Write one file, by its extension; a GIF shows the sheet as cut.

        Parameters
        ----------
        path : path
            ``.dxf``, ``.svg``, ``.pdf``, ``.lbrn2``, ``.png`` or ``.gif``.
        record : bool
            Whether all settings are written as .json beside it.

        Raises
        ------
        FabricationError
            The sheet would not survive these cuts.
        ExportError
            An unknown extension, or a place that cannot be written.
        """
        refuse_errors(self.report)
        job = self._job()
        if Path(path).suffix.lower() == ".gif":
            job = replace(job, motion=self.simulate().simulated.motion(self.settings.width_mm))
        return self._exported(write_file(job, path, self._judge, record=record))

    def export_all(self, folder: str | os.PathLike[str]) -> Exported:
        """Write every kind of file and the record of all settings to a folder, cut files verified.

        Raises
        ------
        FabricationError, ExportError
            As :meth:`export`.
        """
        refuse_errors(self.report)
        return self._exported(export_all(self._job(), Path(folder), judged=lambda found: self._judge(found).to_json()))

    def _job(self) -> ExportJob:
        return cut_job(self.design.document, self.plan, self.settings)

    def _judge(self, verifications: Sequence[Verification] = ()) -> Verdict:
        try:
            as_cut: Any = self.simulate().as_cut
        except KirigamiError as error:
            as_cut = str(error)
        return judge(self.design.candidate, self.plan, self.report, as_cut, verifications)

    def _exported(self, written: ExportSet) -> Exported:
        return Exported(tuple(written.files), tuple(written.verifications), self)

    def __repr__(self) -> str:
        width, height = self.size_mm
        told = "" if self.report.ok else ", cannot be cut"
        return f"<Cuts of {self.design.name} in {self.material}: {width:.1f} x {height:.1f} mm{told}>"

    def _repr_html_(self) -> str:
        width, height = self.size_mm
        verdict = self.verdict
        metres = self.cut_length_mm / 1000.0
        heading = f"{self.plan.material.name}: {width:.1f} × {height:.1f} mm, {metres:.2f} m of cuts"
        if len(self.plan.copies) > 1:
            heading += f", {len(self.plan.copies)} copies"
        level, *lines = (html.escape(line) for line in verdict.lines)
        told = "".join(f"<li>{line}</li>" for line in lines)
        chip = f'<b style="color:{LEVELS[verdict.level]}">{level}</b>'
        below = f'<ul style="margin:2px 0 0;padding-left:20px">{told}</ul>' if told else ""
        style = "font-family:system-ui,sans-serif;font-size:13px;line-height:1.5"
        return f'<div>{cuts_picture(self.plan, heading)}<div style="{style}">{chip}{below}</div></div>'


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Exported:
    """Files that were written.

    Attributes
    ----------
    files : tuple of Path
    verifications : tuple of Verification
        What two readers found in each DXF and SVG.
    cuts : Cuts or None
        That the files were written of; None for pictures.
    """

    files: tuple[Path, ...]
    verifications: tuple[Verification, ...] = ()
    cuts: Cuts | None = field(default=None)

    @property
    def path(self) -> Path:
        """The first file."""
        return self.files[0]

    @property
    def ok(self) -> bool:
        """Whether every file that was read back is as planned."""
        return all(found.ok for found in self.verifications)

    @property
    def verdict(self) -> Verdict | None:
        """On the sheet, with what was found in the files; None for pictures."""
        return None if self.cuts is None else self.cuts._judge(self.verifications)

    def __repr__(self) -> str:
        names = ", ".join(path.name for path in self.files)
        read = "" if not self.verifications else ", verified by two readers" if self.ok else ", NOT as planned"
        return f"<Exported {names}{read}>"


def plan_cuts(design: Design, given: Mapping[str, Any]) -> Cuts:
    """Plan and check the cuts of a design, with choices, by name, on top of those of its project.

    Raises
    ------
    FabricationError, UsageError
        No such material or choice, or cuts that cannot be planned.
    """
    candidate = design.candidate
    settings = with_choices(design.document.fabrication, given)
    check_connectors(candidate, settings.options)
    plan = plan_of(candidate, settings, name=design.name)
    return Cuts(design, settings, plan, check_plan(plan, phi=candidate.final_phi))


def write_file(
    job: ExportJob,
    path: str | os.PathLike[str],
    judged: Callable[[Sequence[Verification]], Verdict],
    *,
    record: bool = False,
) -> ExportSet:
    """Write one file; cut files that can be are read back, and the record of all settings is written where asked for.

    Raises
    ------
    ExportError
        Unknown extension, unwritable place, or a file that did not pass its own re-reading.
    """
    goal = Path(path)
    written = export(job, goal)
    files, verified = [written], []
    if goal.suffix.lower() in FORMATS:
        verified.append(verify_export(job.required_plan, written, job.profile, job.dxf_version, job.deployment))
    if record:
        beside = sidecar_path(goal)
        files.append(write_sidecar(job, beside, [written], judged(verified).to_json()))
    return ExportSet(tuple(files), tuple(verified))


@lru_cache(maxsize=32)
def _simulated(cuts: Cuts) -> Simulation:
    design, candidate = cuts.design, cuts.design.candidate
    kept = None if candidate.trim is None else candidate.trim.kept
    width, motion = cuts.settings.width_mm, design.sheet.deployment
    target = design.target.outline
    found = result_of(simulate(motion, cuts.plan, width, candidate.final_phi, target, kept))
    made = design.posed if found.made is None else design.posed.laid_over(found.made)
    return Simulation(found, made, width)


@lru_cache(maxsize=32)
def _judged(cuts: Cuts) -> Verdict:
    return cuts._judge()
