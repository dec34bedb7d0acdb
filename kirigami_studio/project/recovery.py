"""Recovery files: what survives a crash, a project file with a note of where the work belongs.

A recovery file is a whole project, so it can also be opened by hand; the note is one more member of it, so project and
note are written together or not at all.
"""

from __future__ import annotations

import io
import json
import zipfile
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path

from kirigami_studio.foundation.errors import KirigamiError, ProjectError
from kirigami_studio.foundation.files import opened_file, write_atomically
from kirigami_studio.project.document import Document
from kirigami_studio.project.json_record import Record, read_json
from kirigami_studio.project.picture_record import TracedPicture

NOTE = "recovery.json"
#: A note is a few hundred bytes; whatever is longer is none.
LONGEST_NOTE = 64 * 2**10
#: Largest recovery file, the picture that it traces included (bytes).
LARGEST_FILE = 256 * 2**20


@dataclass(frozen=True, slots=True)
class RecoveryNote:
    """Whose work a recovery file holds."""

    name: str  #: what the user calls the project: its file's name, or what the target is called
    path: str  #: where the project was saved last, absolute; "" if it never was
    changed: str  #: when the latest change was made, ISO 8601 with the offset of its time zone
    digest: str = ""  #: SHA-256 of the project's file as it was read or written last; "" if that is not known

    @property
    def when(self) -> datetime:
        """The time of the change."""
        return datetime.fromisoformat(self.changed)


def now() -> str:
    """The present time as a note has it."""
    return datetime.now(UTC).astimezone().isoformat(timespec="seconds")


def keep(document: Document, note: RecoveryNote, path: Path, picture: TracedPicture | None = None) -> None:
    """Write document, picture and note in one go; an older file at ``path`` survives any failure.

    Raises
    ------
    ExportError
        The file cannot be written.
    """
    # Imported here, so that reading notes does not slow the start of the window.
    from kirigami_studio.project import store
    from kirigami_studio.project.store import with_stored_values

    stream = io.BytesIO(store.pack(with_stored_values(document), picture))
    with zipfile.ZipFile(stream, "a", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(NOTE, json.dumps(asdict(note), indent=1))
    write_atomically(path, stream.getvalue())


def read_note(path: Path) -> RecoveryNote:
    """Read whose work a recovery file holds, without reading the work.

    Raises
    ------
    ProjectError
        Unreadable, damaged, or not a recovery file.
    """
    try:
        with (
            opened_file(path, LARGEST_FILE) as packed,
            zipfile.ZipFile(packed) as archive,
            archive.open(NOTE) as stream,
        ):
            content = stream.read(LONGEST_NOTE)
    except OSError as error:
        raise ProjectError("recovery.not_readable", path=path, reason=error.strerror or str(error)) from error
    except Exception as error:  # zipfile and its decoders raise a dozen kinds on damaged files
        raise ProjectError("recovery.damaged", path=path, reason=str(error)) from error
    try:
        record = Record(read_json(content, NOTE), NOTE)
        digest = record.text("digest") if record.holds("digest") else ""
        note = RecoveryNote(record.text("name"), record.verbatim("path"), record.text("changed"), digest)
        if note.when.tzinfo is None:
            raise ProjectError("recovery.no_time_zone", name=NOTE)
    except (KirigamiError, ValueError) as error:
        raise ProjectError("recovery.damaged", path=path, reason=str(error)) from error
    return note
