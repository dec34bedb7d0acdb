"""Write a file, read it back, and only then put it in its place; an older file survives every failure."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path

from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.foundation.files import linked_file


def write_verified(path: Path, content: bytes, verify: Callable[[Path], None]) -> None:
    """Write ``content`` to a temporary file beside ``path``, let ``verify`` read it, then rename it.

    A symbolic link at ``path`` stays; the file that it leads to is replaced.

    Parameters
    ----------
    path : Path
        Where the file shall appear; missing folders are made.
    content : bytes
    verify : callable
        Gets the temporary file's path and raises ExportError when the file is not what was meant.

    Raises
    ------
    ExportError
        The folder cannot be written, ``path`` is a link that leads to no file, or ``verify`` refused the
        file; nothing is left behind.
    """
    temporary: Path | None = None
    try:
        place = linked_file(path)
        place.parent.mkdir(parents=True, exist_ok=True)
        if place.is_dir():
            raise ExportError(f"Cannot write {path}: it is a folder. Give a file name.")
        handle, name = tempfile.mkstemp(prefix=f".{path.stem}.", suffix=path.suffix, dir=place.parent)
        temporary = Path(name)
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        verify(temporary)
        temporary.chmod(0o644)
        temporary.replace(place)
        temporary = None
    except OSError as error:
        reason = error.strerror or str(error)
        raise ExportError(f"Cannot write {path}: {reason}. Choose another folder or free some space.") from error
    finally:
        if temporary is not None:
            with contextlib.suppress(OSError):
                temporary.unlink()
