"""Write a file, read it back, and only then put it in its place; an older file survives every failure."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path

from kirigami_studio.foundation.errors import ExportError


def write_verified(path: Path, content: bytes, verify: Callable[[Path], None]) -> None:
    """Write ``content`` to a temporary file beside ``path``, let ``verify`` read it, then rename it.

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
        The folder cannot be written, or ``verify`` refused the file; nothing is left behind.
    """
    temporary: Path | None = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.is_dir():
            raise ExportError(f"Cannot write {path}: it is a folder. Give a file name.")
        handle, name = tempfile.mkstemp(prefix=f".{path.stem}.", suffix=path.suffix, dir=path.parent)
        temporary = Path(name)
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        verify(temporary)
        temporary.chmod(0o644)
        temporary.replace(path)
        temporary = None
    except OSError as error:
        reason = error.strerror or str(error)
        raise ExportError(f"Cannot write {path}: {reason}. Choose another folder or free some space.") from error
    finally:
        if temporary is not None:
            with contextlib.suppress(OSError):
                temporary.unlink()
