"""Beds with sheets of several designs -> one cut file for each, read back twice."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from kirigami_studio.export.dxf import check_written, strokes_dxf
from kirigami_studio.export.layer_files import OWN_NAME, fill_layer_folder, layer_folder, whole_folder
from kirigami_studio.export.lightburn import strokes_lightburn, write_project
from kirigami_studio.export.paper import Paper
from kirigami_studio.export.pdf import write_bed_pdf
from kirigami_studio.export.profile import DEFAULT_PROFILE, DxfVersion, Profile, find_profile
from kirigami_studio.export.sheet_bed import SheetBed
from kirigami_studio.export.strokes import extent
from kirigami_studio.export.svg import strokes_svg, write_svg
from kirigami_studio.export.verification import Verification, verify_bed
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import write_atomically

#: Kinds of cut files that hold sheets of several designs.
KINDS = (".dxf", ".svg", ".pdf", ".lbrn2")


@dataclass(frozen=True, slots=True, eq=False)
class BedFile:
    """How the files of beds are made."""

    profile: str = DEFAULT_PROFILE  #: key of the machine profile
    dxf_version: DxfVersion = DxfVersion.R2010
    paper: str = Paper.NONE  #: of PDFs
    record: bytes = b""  #: the designs as a packed project, which the first DXF and SVG carry; empty for none

    def profile_of(self, kind: str) -> Profile:
        """The profile of a kind of file; a LightBurn project has its own layers."""
        return find_profile("lightburn" if kind == ".lbrn2" else self.profile)


@dataclass(frozen=True, slots=True)
class BedFiles:
    """The written files."""

    files: tuple[Path, ...]  #: one for each bed; a folder stands for the files of its layers
    #: One for each sheet, in the order in which sheets were given; PDFs, which are no cut files, have none.
    verifications: tuple[Verification, ...]


def bed_path(path: Path, number: int) -> Path:
    """Where the file of a bed appears: ``cut.dxf``, ``cut-b2.dxf``."""
    return path if number == 1 else path.with_stem(f"{path.stem}-b{number}")


def write_beds(
    beds: Sequence[SheetBed], path: Path, how: BedFile, judged: Callable[[Sequence[Verification]], str]
) -> BedFiles:
    """Write the files aside, read all back, add the verdict, and put them in place.

    Parameters
    ----------
    path : Path
        Of the first file; its extension says of which kind all are.
    judged : function
        Gets what was found of every sheet, in the order in which sheets were given, none before there are files; and
        returns the level of the verdict, which the files repeat.

    Raises
    ------
    ExportError
        A kind of file that does not hold several sheets, a profile that cannot show them, or an unwritable place.
    """
    kind = path.suffix.lower()
    if kind not in KINDS:
        raise ExportError("parts.no_such_file", extension=kind, known=", ".join(KINDS))
    if kind == ".lbrn2" and find_profile(how.profile).slots:
        raise ExportError("lightburn.open_cuts_only")
    level = judged(())
    if kind == ".pdf":
        for bed in beds:
            write_bed_pdf(bed, bed_path(path, bed.number), how.paper, level)
        return BedFiles(tuple(bed_path(path, bed.number) for bed in beds), ())
    while True:
        with tempfile.TemporaryDirectory(prefix="kirigami-", ignore_cleanup_errors=True) as folder:
            drafts = [_written(bed, bed_path(Path(folder) / path.name, bed.number), how, level) for bed in beds]
            found = {
                number: replace(one, path=_place(bed_path(path, bed.number), kind, how))
                for bed, (_, verifications) in zip(beds, drafts, strict=True)
                for number, one in zip(bed.numbers, verifications, strict=True)
            }
            verified = tuple(found[number] for number in sorted(found))
            # What is judged does not depend on what the files say of it: they are written twice at most.
            before, level = level, judged(verified)
            if level == before:
                files = [
                    _put(draft, _place(bed_path(path, bed.number), kind, how))
                    for bed, (draft, _) in zip(beds, drafts, strict=True)
                ]
                return BedFiles(tuple(files), verified)


def _place(path: Path, kind: str, how: BedFile) -> Path:
    """Where a file is found: a profile may make a folder of a DXF."""
    return layer_folder(path) if kind == ".dxf" and find_profile(how.profile).file_per_layer else path


def _put(draft: Path, goal: Path) -> Path:
    if not draft.is_dir():
        write_atomically(goal, draft.read_bytes())
        return goal
    with whole_folder(goal, OWN_NAME) as fresh:
        for part in draft.iterdir():
            write_atomically(fresh / part.name, part.read_bytes())
    return goal


def bed_project(bed: SheetBed, verdict: str) -> bytes:
    """The LightBurn project of a bed."""
    profile, plan = find_profile("lightburn"), bed.sheets[0].plan
    return strokes_lightburn(bed.strokes(profile), plan.material, plan.machine, bed.facts(profile, verdict))


def _written(bed: SheetBed, path: Path, how: BedFile, verdict: str) -> tuple[Path, tuple[Verification, ...]]:
    """Write the file of a bed, and read it back twice."""
    kind = path.suffix.lower()
    profile = how.profile_of(kind)
    strokes, facts = bed.strokes(profile), bed.facts(profile, verdict)
    record = how.record if bed.number == 1 else b""
    size, project = extent(strokes), b""
    if kind == ".lbrn2":
        project = bed_project(bed, verdict)
        write_project(project, strokes, path)
    elif kind == ".svg":
        title = f"Kirigami cut plan, {len(bed.sheets)} sheets, {size[0]:g} x {size[1]:g} mm"
        write_svg(strokes_svg(strokes, title, facts, profile.svg_dpi, record), path, len(strokes), size)
    elif profile.file_per_layer:
        folder = layer_folder(path)
        folder.mkdir()
        fill_layer_folder(folder, strokes, how.dxf_version, facts, record)
        return folder, verify_bed(bed, path, profile.key, how.dxf_version)
    else:
        content = strokes_dxf(strokes, size, how.dxf_version, facts, record=record)
        write_atomically(path, content, lambda one: check_written(one, strokes, size, how.dxf_version))
    version = how.dxf_version if kind == ".dxf" else DxfVersion.R2010
    return path, verify_bed(bed, path, profile.key, version, project)
