"""Everything that a person may want of one design, in one folder, each cut file verified."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from kirigami_studio.export.dxf import write_reference
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.profile import find_profile
from kirigami_studio.export.provenance import sidecar_path, write_sidecar
from kirigami_studio.export.registry import export
from kirigami_studio.export.svg import write_layout_svg
from kirigami_studio.export.verification import Verification, verify_export

R12 = "R12"
R2010 = "R2010"


@dataclass(frozen=True, slots=True)
class ExportSet:
    """What was written.

    Attributes
    ----------
    files : tuple of Path
        In the order of writing; a folder stands for its files.
    verifications : tuple of Verification
        One for each cut file that two readers can read.
    older : tuple of Path
        Cut files of the same name that lie beside these from an earlier export.
    """

    files: tuple[Path, ...]
    verifications: tuple[Verification, ...]
    older: tuple[Path, ...] = ()

    @property
    def ok(self) -> bool:
        """Every cut file passed."""
        return all(found.ok for found in self.verifications)


def export_all(
    job: ExportJob, folder: str | Path, name: str = "cut", sidecar: bool = True,
    on_written: Callable[[Path], None] | None = None,
) -> ExportSet:  # fmt: skip
    """Write the whole set into a folder; each file appears whole or not at all.

    Cut file as DXF R2010 and R12, as SVG and as LightBurn project, PDF on the job's paper, layout and preview, the
    record of the job and the reference drawing.

    Parameters
    ----------
    job : ExportJob
        With its plan.
    folder : str or Path
        Made if it is missing.
    name : str
        Of the cut files, without extension.
    sidecar : bool
        Also write the record.
    on_written : function, optional
        Is called with each path once it is written; may raise to stop.

    Raises
    ------
    ExportError
        No plan, an unwritable place, or a file that did not pass its own re-reading; files written before stay.
    """
    plan, home = job.required_plan, Path(folder)
    cut = home / f"{name}.dxf"
    written: list[Path] = []
    verified: list[Verification] = []

    def done(path: Path) -> None:
        written.append(path)
        if on_written is not None:
            on_written(path)

    for goal, version in ((cut, R2010), (home / f"{name}_r12.dxf", R12), (home / f"{name}.svg", R2010)):
        path = export(replace(job, dxf_version=version), goal)
        verified.append(verify_export(plan, path, job.profile, version, job.deployment))
        done(path)
    cut_files = tuple(written)
    if not find_profile(job.profile).slots:
        done(export(job, home / f"{name}.lbrn2"))
    for goal in (home / f"{name}.pdf", home / "preview.png"):
        done(export(job, goal))
    write_layout_svg(job, home / "layout.svg", plan.size_mm[0])
    done(home / "layout.svg")
    done(write_reference(plan, home / "reference.dxf"))
    if sidecar:
        done(write_sidecar(job, sidecar_path(cut), cut_files))
    known = (f"{name}{rest}" for rest in ("", ".dxf", ".lbrn2", ".json", f"_{R12.lower()}", f"_{R12.lower()}.dxf"))
    older = tuple(path for path in map(home.joinpath, known) if path.exists() and path not in written)
    return ExportSet(tuple(written), tuple(verified), older)
