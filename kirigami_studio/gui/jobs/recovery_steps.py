"""What the worker does so that a crash loses little: keep the present work, look at what an earlier session kept."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.gui.jobs.worker import Cancel
from kirigami_studio.project import recovery, store
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


def keeping(document: Document, note: Note, path: Path, cancel: Cancel) -> Iterator[Document]:
    """Keep a document, and yield it once it is on disk."""
    recovery.keep(document, note, path)
    yield document


def looking(files: tuple[Path, ...], cancel: Cancel) -> Iterator[Leftover]:
    """Find out what the files of earlier sessions keep."""
    for file in files:
        try:
            yield Leftover(file, recovery.read_note(file))
        except KirigamiError as error:
            yield Leftover(file, None, str(error))


def recovering(leftover: Leftover, cancel: Cancel) -> Iterator[Document]:
    """Read the work that was kept."""
    yield store.load(leftover.file)


def removing(file: Path, cancel: Cancel) -> Iterator[Path]:
    """Delete a kept file, in its turn after whatever still writes it."""
    with suppress(OSError):
        file.unlink(missing_ok=True)
    yield file
