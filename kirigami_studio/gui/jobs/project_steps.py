"""What the worker does about project files: write and read them with the picture that the target was traced from."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.jobs.picture_reading import reduced_picture
from kirigami_studio.gui.jobs.queue import Cancel
from kirigami_studio.gui.jobs.steps import Picture
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.document import Document
from kirigami_studio.project.picture_record import LARGEST_PICTURE, TracedPicture

if TYPE_CHECKING:
    from kirigami_studio.project.store import Opened
from contextlib import suppress

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.project import recovery
from kirigami_studio.project.recovery import Note


@dataclass(frozen=True, slots=True)
class Left:
    """Something that is not in the project file, or could not be read from it: one sentence."""

    sentence: str


@dataclass(frozen=True, slots=True, eq=False)
class Project:
    """A project that was read."""

    document: Document
    picture: Picture | None


def saving(document: Document, picture: Picture | None, path: Path, cancel: Cancel) -> Iterator[Left | Path]:
    """Write the project file."""
    from kirigami_studio.project import store

    try:
        kept = stored(picture)
    except ProjectError as error:
        kept = None
        yield Left(tr("The target's photo was not saved with the project: {reason}.", reason=error))
    store.save(document, path, kept)
    yield path


def loading(path: Path, folder: Path, cancel: Cancel) -> Iterator[Left | Project]:
    """Read a project file; its picture is laid into a folder of its own inside ``folder``."""
    from kirigami_studio.project import store

    opened = store.load_all(path)
    for note in opened.notes:
        yield Left(note)
    picture = None
    try:
        picture = laid_out(opened, folder)
    except (OSError, ProjectError) as error:
        yield Left(tr("The project's photo could not be loaded and was left out: {reason}.", reason=error))
    yield Project(opened.document, picture)


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
                tr(
                    "{name} is {size:.0f} MB; the limit is {most} MB",
                    name=path.name,
                    size=size / 2**20,
                    most=LARGEST_PICTURE // 2**20,
                )
            )
        content = path.read_bytes()
    except OSError as error:
        raise ProjectError(f"{path.name}: {error.strerror or error}") from error
    levels = (picture.automatic, picture.threshold)
    return TracedPicture(path.name, content, *levels, traced.scale, traced.centre, traced.picture)


def laid_out(opened: Opened, folder: Path) -> Picture | None:
    """The picture of a project as a file that can be traced again; None if it keeps none."""
    from kirigami_studio.outlines.read_image import Traced

    kept, target = opened.picture, opened.document.target
    if kept is None or not isinstance(target, Outline):
        return None
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / kept.name
    path.write_bytes(kept.content)
    traced = Traced(target, kept.scale, kept.centre, kept.size)
    return Picture(path, kept.automatic, kept.threshold, traced, reduced_picture(path))


@dataclass(frozen=True, slots=True)
class Leftover:
    """Work that a session kept which has not ended as it should.

    Attributes
    ----------
    file : Path
    note : Note or None
        None if it cannot be read.
    fault : str
        Why it cannot be read, a sentence; else "".
    """

    file: Path
    note: Note | None
    fault: str = ""


def keeping(document: Document, picture: Picture | None, note: Note, path: Path, cancel: Cancel) -> Iterator[Document]:
    """Keep a document, and yield it once it is on disk; a picture that cannot be kept is told when it is saved."""
    kept = None
    with suppress(ProjectError):
        kept = stored(picture)
    recovery.keep(document, note, path, kept)
    yield document


def looking(files: tuple[Path, ...], cancel: Cancel) -> Iterator[Leftover]:
    """Find out what the files of earlier sessions keep."""
    for file in files:
        try:
            yield Leftover(file, recovery.read_note(file))
        except KirigamiError as error:
            yield Leftover(file, None, str(error))


def recovering(leftover: Leftover, folder: Path, cancel: Cancel) -> Iterator[Left | Project]:
    """Read the work that was kept; its picture is laid into a folder."""
    yield from loading(leftover.file, folder, cancel)


def removing(file: Path, cancel: Cancel) -> Iterator[Path]:
    """Delete a kept file, in its turn after whatever still writes it."""
    with suppress(OSError):
        file.unlink(missing_ok=True)
    yield file
