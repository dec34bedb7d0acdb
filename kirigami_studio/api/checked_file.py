"""Cut files that are read again: their content, and whether it is that of their design."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from kirigami_studio.api.design import Design
from kirigami_studio.api.values import read_only
from kirigami_studio.export.file_record import FileRecord
from kirigami_studio.studio.checking import Checked, checked


@read_only
@dataclass(frozen=True, slots=True, eq=False, repr=False)
class CheckedFile(Checked):
    """Content of a cut file.

    Attributes
    ----------
    report : FileReport
        Units, layers, lengths, pieces, narrowest ligament, problems, and how the file says it was made.
    verification : Verification or None
        Beside the cuts of its design, where one was named.
    verdict : Verdict or None
        On the sheet of that design.
    """

    @property
    def record(self) -> FileRecord | None:
        """The file's own account of its making; None in files of other programs."""
        return self.report.record

    @property
    def problems(self) -> tuple[str, ...]:
        """In sentences, those of the verdict included."""
        found = [problem.text for problem in self.report.problems]
        found += [] if self.verdict is None else [problem.text for problem in self.verdict.problems]
        return tuple(dict.fromkeys(found))

    def __repr__(self) -> str:
        told = "sound" if self.sound else "not sound"
        if self.verdict is not None:
            told += f", {self.verdict.level_words}"
        return f"<CheckedFile {self.report.path.name}: {told}{'' if self.ok else ': ' + ' '.join(self.problems)}>"


def check(path: str | os.PathLike[str], design: Design | None = None) -> CheckedFile:
    """Read a DXF of any origin or a cut file of this program: units, duplicates, ligaments.

    Parameters
    ----------
    path : path
        A file, or a folder of layer files.
    design : Design, optional
        That it should be a cut file of: the file is compared with its cuts, made as the file says, and the sheet is
        judged.

    Raises
    ------
    ExportError
        Missing, damaged, or of another kind.
    """
    found = checked(Path(path), None if design is None else design.document)
    return CheckedFile(found.report, found.verification, found.verdict)
