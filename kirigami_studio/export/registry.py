"""Writers of files by extension."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

from kirigami_studio.export.animation import write_animation
from kirigami_studio.export.dxf import write_dxf
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.finite_elements import write_elements
from kirigami_studio.export.fold import write_fold
from kirigami_studio.export.layer_files import layer_folder, write_layer_files
from kirigami_studio.export.lightburn import write_lightburn
from kirigami_studio.export.mjcf import write_mjcf
from kirigami_studio.export.pdf import write_pdf
from kirigami_studio.export.picture import write_png
from kirigami_studio.export.profile import find_profile
from kirigami_studio.export.share_page import write_page
from kirigami_studio.export.svg import write_cut_svg
from kirigami_studio.export.tables import write_tables
from kirigami_studio.foundation.errors import ExportError

#: Writes a job's file and reads it back; raises ExportError and leaves an older file alone when that fails.
Writer = Callable[[ExportJob, Path], object]


def _dxf(job: ExportJob, path: Path) -> None:
    """Write the job's cut plan in its DXF version and profile: one file, or a folder of them."""
    profile = find_profile(job.profile)
    if profile.file_per_layer:
        write_layer_files(job.required_plan, path, job.dxf_version, profile, job.record)
    else:
        write_dxf(job.required_plan, path, job.dxf_version, profile, job.record)


def _lightburn(job: ExportJob, path: Path) -> None:
    """Write the job's cut plan in LightBurn's own layers, whatever the profile."""
    if find_profile(job.profile).slots:
        raise ExportError("lightburn.open_cuts_only")
    write_lightburn(job.required_plan, path, job.markers)


def _meshes(job: ExportJob, path: Path) -> tuple[Path, ...]:
    """Write the job's solids, a file for each plate."""
    from kirigami_studio.export.meshes import write_meshes  # with libraries that few need

    return write_meshes(job, path)


#: Writers by extension (lower case, with the dot); of GIF from phi = pi to the job's angle, or as far as it comes.
WRITERS: Mapping[str, Writer] = MappingProxyType(
    {
        ".dxf": _dxf,
        ".svg": lambda job, path: write_cut_svg(job.required_plan, path, find_profile(job.profile), job.record),
        ".pdf": lambda job, path: write_pdf(job.required_plan, path, job.paper),
        ".png": write_png,
        ".gif": write_animation,
        ".html": write_page,
        ".lbrn2": _lightburn,
        ".stl": _meshes,
        ".3mf": _meshes,
        ".obj": _meshes,
        ".fold": write_fold,
        ".xml": write_mjcf,
        ".inp": write_elements,
        ".csv": write_tables,
    }
)


def find_writer(path: str | Path) -> Writer:
    """Return the writer for a file name.

    Raises
    ------
    ExportError
        Unknown or missing extension; the sentence lists the known ones.
    """
    extension = Path(path).suffix.lower()
    if extension not in WRITERS:
        names = ", ".join(WRITERS)
        if not extension:
            raise ExportError("export.no_extension", path=path, known=names)
        raise ExportError("export.unknown_kind", extension=extension, path=path, known=names)
    return WRITERS[extension]


def export(job: ExportJob, path: str | Path) -> Path:
    """Write one file of the kind of its extension; return its path, or its folder.

    Raises
    ------
    ExportError
        As :func:`export_files`.
    """
    return export_files(job, path)[0]


def export_files(job: ExportJob, path: str | Path) -> tuple[Path, ...]:
    """Write one file, the folder of its layers, or a file for each plate; return their paths.

    Raises
    ------
    ExportError
        Unknown extension, missing plan, unwritable place, or a file that did not pass its own re-reading.
    """
    goal = Path(path)
    written = find_writer(goal)(job, goal)
    return written if isinstance(written, tuple) else (written_path(goal, job.profile),)


def written_path(path: Path, profile_key: str) -> Path:
    """Where a file of this name is found: a profile may make a folder of a DXF."""
    in_folder = path.suffix.lower() == ".dxf" and find_profile(profile_key).file_per_layer
    return layer_folder(path) if in_folder else path
