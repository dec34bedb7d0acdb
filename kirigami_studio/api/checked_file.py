"""Cut files that are read again: their content, and whether it is that of their design."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from kirigami_studio.api.design import Design
from kirigami_studio.export.dxf_check import FileReport, check_file
from kirigami_studio.export.verification import Verification
from kirigami_studio.studio.making import judged_file
from kirigami_studio.studio.verdict import Verdict


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class CheckedFile:
    """Content of a cut file.

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
    """Read a DXF of any origin or a cut SVG of this program: units, duplicates, gaps, ligaments.

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
    return CheckedFile(report, *judged_file(Path(path), design.document))
