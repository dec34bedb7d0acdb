"""Cut files that are read again: what is in them, and whether that is what their design asks for."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from kirigami_studio.api.design import Design
from kirigami_studio.export.dxf_check import FileReport, check_file
from kirigami_studio.export.verification import Verification, verify_export
from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.project.document import Document
from kirigami_studio.project.export_job import chosen_candidate
from kirigami_studio.studio.cutting import plan_of
from kirigami_studio.studio.verdict import Verdict, closed_as_cut, judge


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class CheckedFile:
    """What is in a cut file.

    Attributes
    ----------
    report : FileReport
        Units, layers, lengths, pieces, narrowest ligament, problems.
    verification : Verification or None
        Beside the cuts of its design, where one was named.
    verdict : Verdict or None
        On the sheet of that design.
    """

    report: FileReport
    verification: Verification | None = None
    verdict: Verdict | None = None

    @property
    def ok(self) -> bool:
        """Whether it is ready to cut."""
        return self.report.ok and (self.verdict is None or self.verdict.ok)

    @property
    def problems(self) -> tuple[str, ...]:
        """In sentences, those of the verdict included."""
        found = [problem.text for problem in self.report.problems]
        found += [] if self.verdict is None else [problem.text for problem in self.verdict.problems]
        return tuple(dict.fromkeys(found))

    def __repr__(self) -> str:
        name, told = self.report.path.name, "ready to cut" if self.ok else "not ready to cut"
        return f"<CheckedFile {name}: {told}{'' if self.ok else ': ' + ' '.join(self.problems)}>"


def check(path: str | os.PathLike[str], design: Design | None = None) -> CheckedFile:
    """Read a DXF of any origin: units, duplicates, gaps, pieces, ligaments.

    Parameters
    ----------
    path : path
        A file, or a folder of layer files.
    design : Design, optional
        That it should be a cut file of, with the choices of its project: the file is compared with its cuts, and the
        sheet is judged.

    Raises
    ------
    ExportError
        Missing, damaged, or of another kind.
    """
    report = check_file(Path(path))
    if design is None:
        return CheckedFile(report)
    return CheckedFile(report, *judged_by_design(Path(path), design.document))


def judged_by_design(path: Path, document: Document) -> tuple[Verification, Verdict]:
    """Compare a file with the chosen design of a project as the project would cut it, and judge the sheet."""
    candidate, settings = chosen_candidate(document), document.fabrication
    plan = plan_of(candidate, settings, name=document.name_of(candidate))
    report = check_plan(plan, phi=candidate.final_phi)
    motion = deploy(candidate.final_sheet)
    found = verify_export(plan, path, settings.profile, settings.dxf_version, motion)
    as_cut = closed_as_cut(candidate, motion, plan, settings.width_mm)
    return found, judge(candidate, plan, report, as_cut, [found])
