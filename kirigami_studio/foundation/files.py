"""Atomic writing: a file appears whole or not at all, and an old one survives a failure."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path

from kirigami_studio.foundation.errors import ExportError


def write_atomically(path: Path, content: bytes) -> None:
    """Write ``content`` beside ``path``, flush it to disk, then rename it into place.

    Raises
    ------
    ExportError
        The folder is missing or cannot be written, or the disk is full; an older file at ``path`` is untouched.
    """
    temporary: str | None = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        Path(temporary).chmod(0o644)
        Path(temporary).replace(path)
    except OSError as error:
        if temporary is not None:
            with contextlib.suppress(OSError):
                Path(temporary).unlink()
        reason = error.strerror or str(error)
        raise ExportError(f"Cannot write {path}: {reason}. Choose another folder or free some space.") from error
