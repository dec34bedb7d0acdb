"""Atomic writing: a file appears whole or not at all, and an old one survives a failure."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path

from kirigami_studio.foundation.errors import ExportError


def write_atomically(path: Path, content: bytes) -> None:
    """Write ``content`` beside ``path``, flush it to disk, then rename it into place.

    A symbolic link at ``path`` stays; the file that it leads to is replaced.

    Raises
    ------
    ExportError
        The folder is missing or cannot be written, the disk is full, or ``path`` is a link that leads to no file; an
        older file at ``path`` is untouched.
    """
    temporary: str | None = None
    try:
        place = linked_file(path)
        place.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(prefix=f".{place.name}.", dir=place.parent)
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        Path(temporary).chmod(0o644)
        Path(temporary).replace(place)
    except OSError as error:
        if temporary is not None:
            with contextlib.suppress(OSError):
                Path(temporary).unlink()
        reason = error.strerror or str(error)
        raise ExportError("file.not_written", path=path, reason=reason) from error


def linked_file(path: Path) -> Path:
    """The file that a symbolic link leads to, over any number of links; any other path as it is.

    Raises
    ------
    ExportError
        The link leads to nothing, or in a circle.
    """
    if not path.is_symlink():
        return path
    try:
        return path.resolve(strict=True)
    except FileNotFoundError as error:
        to = path.readlink()
        raise ExportError("file.link_to_nothing", path=path, target=to) from error
    except (OSError, RuntimeError) as error:  # RuntimeError: pathlib's word for a circle
        raise ExportError("file.link_in_circle", path=path) from error


def check_folder(folder: Path) -> None:
    """Refuse a folder that cannot be made or written, before any work is done for it; creates nothing.

    Raises
    ------
    ExportError
        A file stands where the folder should be, or there is no right to write.
    """
    try:
        nearest = next(place for place in (folder, *folder.absolute().parents) if place.exists())
        usable = nearest.is_dir() and os.access(nearest, os.W_OK | os.X_OK)
    except (OSError, ValueError, StopIteration):
        usable = False
    if not usable:
        raise ExportError("file.folder_not_writable", folder=folder)
