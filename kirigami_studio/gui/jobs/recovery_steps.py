"""What the worker does so that a crash loses little: keep the present work, look at what an earlier session kept."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from kirigami_studio.foundation.errors import KirigamiError, ProjectError
from kirigami_studio.gui.jobs.project_steps import Left, Project, loading, stored
from kirigami_studio.gui.jobs.steps import Picture
from kirigami_studio.gui.jobs.worker import Cancel
from kirigami_studio.project import recovery
from kirigami_studio.project.document import Document
from kirigami_studio.project.recovery import Note


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
