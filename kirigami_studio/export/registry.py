"""Which exporter writes which extension."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from kirigami_studio.export.animation import GifExporter
from kirigami_studio.export.dxf import write_dxf
from kirigami_studio.export.exporter import Exporter, ExportJob
from kirigami_studio.export.layer_files import layer_folder, write_layer_files
from kirigami_studio.export.lightburn import LightBurnExporter
from kirigami_studio.export.pdf import PdfExporter
from kirigami_studio.export.picture import PngExporter
from kirigami_studio.export.profile import find_profile
from kirigami_studio.export.svg import SvgExporter
from kirigami_studio.foundation.errors import ExportError


@dataclass(frozen=True, slots=True)
class DxfExporter:
    """Cut plan as DXF."""

    extension: str = ".dxf"
    name: str = "DXF cut file"

    def write(self, job: ExportJob, path: Path) -> None:
        """Write the job's cut plan in its DXF version and profile: one file, or a folder of them."""
        profile = find_profile(job.profile)
        if profile.file_per_layer:
            write_layer_files(job.required_plan, path, job.dxf_version, profile, job.record)
        else:
            write_dxf(job.required_plan, path, job.dxf_version, profile, job.record)


def exporters() -> Mapping[str, Exporter]:
    """Return all exporters by extension (lower case, with the dot)."""
    known: tuple[Exporter, ...] = (
        DxfExporter(), SvgExporter(), PdfExporter(), PngExporter(), GifExporter(), LightBurnExporter(),
    )  # fmt: skip
    return {exporter.extension: exporter for exporter in known}


def find_exporter(path: str | Path) -> Exporter:
    """Return the exporter for a file name.

    Raises
    ------
    ExportError
        Unknown or missing extension; the sentence lists the known ones.
    """
    known = exporters()
    extension = Path(path).suffix.lower()
    if extension not in known:
        names = ", ".join(known)
        if not extension:
            raise ExportError("export.no_extension", path=path, known=names)
        raise ExportError("export.unknown_kind", extension=extension, path=path, known=names)
    return known[extension]


def export(job: ExportJob, path: str | Path) -> Path:
    """Write one file of the kind that its extension names, and return its path (of a folder for files per layer).

    Raises
    ------
    ExportError
        Unknown extension, missing plan, unwritable place, or a file that did not pass its own re-reading.
    """
    goal = Path(path)
    find_exporter(goal).write(job, goal)
    return written_path(goal, job.profile)


def written_path(path: Path, profile_key: str) -> Path:
    """Where a file of this name is found: a profile may make a folder of a DXF."""
    in_folder = path.suffix.lower() == ".dxf" and find_profile(profile_key).file_per_layer
    return layer_folder(path) if in_folder else path
