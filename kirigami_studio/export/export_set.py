"""Everything that the user may want of one design, in one folder, each cut file verified."""

from __future__ import annotations

import hashlib
import json
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from kirigami_studio.export.artwork_files import ArtworkJob, write_artwork
from kirigami_studio.export.dxf import write_reference
from kirigami_studio.export.exporter import ExportJob
from kirigami_studio.export.profile import DxfVersion, find_profile
from kirigami_studio.export.provenance import sidecar_path, write_sidecar
from kirigami_studio.export.registry import export, written_path
from kirigami_studio.export.svg import write_layout_svg
from kirigami_studio.export.verification import Verification, verify_export
from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import folder_of_one_writer, write_atomically

#: A record larger than this (bytes) is none of ours.
LARGEST_RECORD = 50_000_000
#: Judges files by what was read back from them.
Judged = Callable[[Sequence[Verification]], Mapping[str, object]]


@dataclass(frozen=True, slots=True)
class ExportSet:
    """The written files."""

    files: tuple[Path, ...]  #: in the order of writing; a folder stands for its files
    verifications: tuple[Verification, ...]  #: one for each cut file that two readers can read
    older: tuple[Path, ...] = ()  #: cut files of the same name that an earlier export left and this one does not have
    #: Those of an earlier export, by its record, that nobody had changed since; they are gone.
    removed: tuple[Path, ...] = ()

    @property
    def ok(self) -> bool:
        """Every cut file passed."""
        return all(found.ok for found in self.verifications)


@dataclass(frozen=True, slots=True, eq=False)
class Draft:
    """A cut file that was written aside and read back by two readers."""

    job: ExportJob
    path: Path  #: where it is to appear
    written: Path  #: where it is: a file, or the folder of a profile with a file for each layer
    verification: Verification  #: what was found in it, under the name that it is to have

    def place(self) -> Path:
        """Put it in its place, whole or not at all; returns the path.

        Raises
        ------
        ExportError
            An unwritable place.
        """
        if self.written.is_dir():
            return export(self.job, self.path)  # the same bytes, in a folder that appears whole
        write_atomically(self.path, self.written.read_bytes())
        return self.path


@contextmanager
def drafted(job: ExportJob, path: Path) -> Iterator[Draft]:
    """Write a cut file aside and read it back; what is not placed before the end is gone.

    Raises
    ------
    ExportError
        As :func:`~kirigami_studio.export.registry.export`.
    """
    with tempfile.TemporaryDirectory(prefix="kirigami-", ignore_cleanup_errors=True) as folder:
        written = export(job, Path(folder) / path.name)
        found = verify_export(
            job.required_plan, written, job.profile, job.dxf_version, job.deployment, job.simulated_jam
        )
        yield Draft(job, path, written, replace(found, path=written_path(path, job.profile)))


def placed(
    job: ExportJob,
    goals: Sequence[tuple[Path, DxfVersion]],
    judged: Judged | None,
    done: Callable[[Path], None],
) -> tuple[ExportJob, list[Verification]]:
    """Write cut files aside, read all back, add their verdict, and put them in place.

    Parameters
    ----------
    goals : sequence of (Path, DxfVersion)
        Where they are to appear.
    judged : function or None
        As for :func:`export_all`.
    done : function
        Gets each path once it is there.

    Returns
    -------
    job : ExportJob
        With the level of the verdict.
    verifications : list of Verification

    Raises
    ------
    ExportError
        As :func:`~kirigami_studio.export.registry.export`.
    """
    level = _level(judged, ())
    while True:
        job = replace(job, verdict=level)
        with ExitStack() as stack:
            drafts = [stack.enter_context(drafted(replace(job, dxf_version=version), goal)) for goal, version in goals]
            verified = [draft.verification for draft in drafts]
            # What is judged does not depend on what the files say of it: they are written twice at most.
            before, level = level, _level(judged, verified)
            if level == before:
                for draft in drafts:
                    done(draft.place())
                return job, verified


def _level(judged: Judged | None, verifications: Sequence[Verification]) -> str:
    return "" if judged is None else str(judged(verifications)["level"])


def export_all(
    job: ExportJob, folder: str | Path, name: str = "cut", sidecar: bool = True,
    on_written: Callable[[Path], None] | None = None, judged: Judged | None = None,
) -> ExportSet:  # fmt: skip
    """Write the whole set into a folder; each file appears whole or not at all.

    Cut file as DXF R2010 and R12, as SVG and as LightBurn project, PDF on the job's paper, layout and preview, the
    printed sheet if it has artwork, the record of the job and the reference drawing.  Layout and preview show the sheet
    that is cut.  What an earlier export of the same name left, and this one does not have, is removed if that one's
    record names it and nobody changed it.

    Parameters
    ----------
    name : str
        Of the cut files, without extension.
    on_written : function, optional
        Is called with each path once it is written; may raise to stop.
    judged : function, optional
        Gets what was read back from the cut files and returns the verdict that the record is to have, as JSON.

    Raises
    ------
    ExportError
        No plan, an unwritable place, a folder that another export is writing into or that holds that of another name,
        or a file that did not pass its own re-reading; files written before stay.
    """
    home = Path(folder)
    _ = job.required_plan  # refused before a folder is made
    with folder_of_one_writer(home):
        _refuse_other_sets(home, name)
        return _written(job, home, name, sidecar, on_written, judged)


def _written(
    job: ExportJob,
    home: Path,
    name: str,
    sidecar: bool,
    on_written: Callable[[Path], None] | None,
    judged: Judged | None,
) -> ExportSet:
    plan = job.required_plan
    cut = home / f"{name}.dxf"
    before = _recorded(sidecar_path(cut))
    written: list[Path] = []

    def done(path: Path) -> None:
        written.append(path)
        if on_written is not None:
            on_written(path)

    goals = (
        (cut, DxfVersion.R2010),
        (home / f"{name}_r12.dxf", DxfVersion.R12),
        (home / f"{name}.svg", DxfVersion.R2010),
    )
    job, verified = placed(job, goals, judged, done)
    verdict = None if judged is None else judged(verified)
    if not find_profile(job.profile).slots:
        done(export(job, home / f"{name}.lbrn2"))
    for goal in (home / f"{name}.pdf", home / "preview.png"):
        done(export(job, goal))
    picture = home / f"{name}-picture.svg"
    write_layout_svg(job, picture, plan.size_mm[0])
    done(picture)
    if job.artwork is not None:
        for path in write_artwork(ArtworkJob.usual(job.artwork, job), home):
            done(path)
    done(write_reference(plan, home / "reference.dxf"))
    if sidecar:
        done(write_sidecar(job, sidecar_path(cut), written, verdict))
    known = (f"{name}{rest}" for rest in ("", ".dxf", ".lbrn2", ".json", "_r12", "_r12.dxf"))
    older = tuple(path for path in map(home.joinpath, known) if path.exists() and path not in written)
    return ExportSet(tuple(written), tuple(verified), older, _remove(home, before, written))


def _refuse_other_sets(home: Path, name: str) -> None:
    """Pictures and reference drawing have the same names in every set, so a folder holds one."""
    for path in sorted(home.glob("*.json")):
        if path.stem != name and "preview.png" in _recorded(path):
            raise ExportError("set.other_design", folder=home, other=path.stem)


def _recorded(path: Path) -> dict[str, str]:
    """SHA-256 of the files that a record names, by their paths; none without a record."""
    try:
        if path.stat().st_size > LARGEST_RECORD:
            return {}
        record = json.loads(path.read_bytes())
        if not str(record["application"]).startswith("kirigami-studio "):
            return {}
        return {str(name): str(digest) for name, digest in record["files"].items()}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return {}


def _remove(home: Path, before: Mapping[str, str], written: Sequence[Path]) -> tuple[Path, ...]:
    """Remove files of an earlier set that nobody changed; return files and folders."""
    removed = []
    for name, digest in before.items():
        path = home / name
        inside = Path(name).parts
        # Names of a record are not to lead out of the folder, nor into one that is written now.
        if not 1 <= len(inside) <= 2 or ".." in inside or Path(name).is_absolute():
            continue
        if path in written or home / inside[0] in written or path.is_symlink() or not path.is_file():
            continue
        try:
            if hashlib.sha256(path.read_bytes()).hexdigest() != digest:
                continue
            path.unlink()
            if len(inside) == 1:
                removed.append(path)
            elif not any(path.parent.iterdir()):
                path.parent.rmdir()
                removed.append(path.parent)
        except OSError:
            continue  # it stays, and is told among the older ones
    return tuple(removed)
