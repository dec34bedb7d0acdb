"""Jobs on project files: save and open them with the picture behind the target, keep and recover unsaved work."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.errors import KirigamiError, ProjectError
from kirigami_studio.foundation.resources import resource
from kirigami_studio.foundation.steps import Cancel
from kirigami_studio.foundation.words import tr
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.read import PICTURES
from kirigami_studio.project import recovery
from kirigami_studio.project.document import Document
from kirigami_studio.project.picture_record import LARGEST_PICTURE, TracedPicture
from kirigami_studio.project.recovery import RecoveryNote
from kirigami_studio.studio import importing
from kirigami_studio.studio.targets import Picture, reduced_picture

if TYPE_CHECKING:
    from kirigami_studio.project.store import Opened


#: SHA-256 of project files as a window read or wrote them last; only its jobs write here, one after the other.
OnDisk = dict[Path, str]


@dataclass(frozen=True, slots=True)
class Saved:
    """A project file that was written; ``left_out`` says what could not be saved with it, a sentence, or ""."""

    path: Path
    left_out: str = ""


@dataclass(frozen=True, slots=True)
class ChangedOnDisk:
    """A project file that was not written: it is another one than this window read or wrote; ``digest`` is its own."""

    path: Path
    digest: str


@dataclass(frozen=True, slots=True, eq=False)
class Project:
    """A project that was read."""

    document: Document
    picture: Picture | None  #: behind its target
    notes: tuple[str, ...] = ()  #: what could not be read, a sentence each


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """A bundled project from one shape to another."""

    path: Path
    target: Outline
    candidate: Candidate
    design: PosedDesign


def reading_pairs(cancel: Cancel) -> Iterator[Pair]:
    """Read the bundled pairs one by one, in the order of their names."""
    for path in sorted(resource("pairs").glob("*.kiri")):
        if cancel():
            return
        yield from _finished(path)


def reading_sample(cancel: Cancel) -> Iterator[Pair]:
    """Read the design that is shown while there is none."""
    yield from _finished(resource("examples", "heart.kiri"))


def _finished(path: Path) -> Iterator[Pair]:
    """The chosen design of a bundled project."""
    from kirigami_studio.lattice.deployment import deploy
    from kirigami_studio.project import store

    document = store.load(path)
    candidate, target = document.candidate, document.target
    if candidate is not None and target is not None:
        design = PosedDesign(deploy(candidate.final_sheet), candidate.final_pose, candidate.final_phi, candidate.trim)
        yield Pair(path, target, candidate, design)


def saving(
    document: Document, picture: Picture | None, path: Path, on_disk: OnDisk, cancel: Cancel
) -> Iterator[Saved | ChangedOnDisk]:
    """Write the project file, unless somebody else has changed it since it was read or written here."""
    from kirigami_studio.project import store

    known, found = on_disk.get(path), store.digest_on_disk(path)
    if known and found and found != known:
        yield ChangedOnDisk(path, found)
        return
    kept, left_out = None, ""
    try:
        kept = stored(picture)
    except ProjectError as error:
        left_out = tr("The target's photo was not saved with the project. {reason}", reason=error)
    on_disk[path] = store.save(document, path, kept)
    yield Saved(path, left_out)


def loading(path: Path, folder: Path, on_disk: OnDisk, cancel: Cancel) -> Iterator[Project]:
    """Read a project file; its picture is written into a folder of its own inside ``folder``."""
    from kirigami_studio.project import store

    opened = store.load_all(path)
    on_disk[path] = opened.digest
    picture, notes = None, opened.notes
    try:
        picture = extracted_picture(opened, folder)
    except (OSError, ProjectError) as error:
        left_out = tr("The project's photo could not be loaded and was left out. {reason}", reason=error)
        notes = (*notes, left_out)
    importing.import_verdicts()
    yield Project(opened.document, picture, notes)


def stored(picture: Picture | None) -> TracedPicture | None:
    """A picture as a project file keeps it.

    Raises
    ------
    ProjectError
        It is not there any more, or too large.
    """
    if picture is None or picture.traced is None:
        return None
    traced, path = picture.traced, picture.path
    try:
        size = path.stat().st_size
        if size > LARGEST_PICTURE:
            raise ProjectError(
                "photo.too_large", name=path.name, size_mb=size / 2**20, most_mb=LARGEST_PICTURE // 2**20
            )
        content = path.read_bytes()
    except OSError as error:
        raise ProjectError("photo.not_read", name=path.name, reason=error.strerror or error) from error
    levels = (picture.automatic, picture.threshold)
    name = path.name if path.suffix.lower() in PICTURES else f"{path.name}.png"  # its content says what it is
    return TracedPicture(name, content, *levels, traced.scale, traced.centre, traced.picture)


def extracted_picture(opened: Opened, folder: Path) -> Picture | None:
    """The picture of a project as a file that can be traced again; None if it keeps none."""
    from kirigami_studio.outlines.read_image import Traced

    kept, target = opened.picture, opened.document.target
    if kept is None or target is None:
        return None
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / kept.name
    path.write_bytes(kept.content)
    traced = Traced(target, kept.scale, kept.centre, kept.size)
    return Picture(path, kept.automatic, kept.threshold, traced, reduced_picture(path))


@dataclass(frozen=True, slots=True)
class Leftover:
    """Unsaved work of a session that ended unexpectedly."""

    file: Path
    note: RecoveryNote | None  #: None if it cannot be read
    fault: str = ""  #: why it cannot be read, a sentence; else ""


def keeping(
    document: Document, picture: Picture | None, note: RecoveryNote, path: Path, cancel: Cancel
) -> Iterator[Document]:
    """Keep a document, and yield it once it is on disk; a picture that cannot be kept is reported when it is saved."""
    kept = None
    with suppress(ProjectError):
        kept = stored(picture)
    recovery.keep(document, note, path, kept)
    yield document


def reading_leftovers(files: tuple[Path, ...], cancel: Cancel) -> Iterator[Leftover]:
    """Find out what the files of earlier sessions keep."""
    for file in files:
        try:
            yield Leftover(file, recovery.read_note(file))
        except KirigamiError as error:
            yield Leftover(file, None, str(error))


def removing(file: Path, cancel: Cancel) -> Iterator[Path]:
    """Delete a kept file, in its turn after whatever still writes it."""
    with suppress(OSError):
        file.unlink(missing_ok=True)
    yield file
