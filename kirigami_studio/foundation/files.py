"""Atomic writing: a file appears whole or not at all.  Folders for one writer.

Reading with limits: regular files only, because a pipe or a device may have no end, and no more than can be meant.
"""

from __future__ import annotations

import contextlib
import errno
import os
import re
import stat
import sys
import tempfile
import time
import tomllib
from codecs import BOM_UTF8
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, BinaryIO

from kirigami_studio.foundation.errors import ExportError

#: Permissions of files that did not exist before: everybody may read them.
NEW_FILE_MODE = 0o644
#: Part of the names of files that are being written, and seconds after which nobody is writing one any more.
PART, STALE_SECONDS = ".kirigami-part", 3600.0
LEFT_BEHIND = re.compile(r"\..*\.[a-z0-9_]{8}" + re.escape(PART) + r"(\.\w+)?", re.DOTALL)
#: Largest settings file (bytes), and dots of a line: Python's reader needs a gigabyte for a key of 20 000 parts.
LARGEST_SETTINGS, MOST_DOTS = 100_000, 200


@contextlib.contextmanager
def opened_file(path: Path, most_bytes: int) -> Iterator[BinaryIO]:
    """Open a regular file, or the one that a link leads to, for reading.

    Raises
    ------
    OSError
        It is missing, a folder, a pipe or a device, larger than ``most_bytes``, or cannot be read.
    ValueError
        A null character in the name.
    """
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0) | getattr(os, "O_BINARY", 0)
    handle = os.open(path, flags)
    try:
        found = os.fstat(handle)
        if stat.S_ISDIR(found.st_mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
        if not stat.S_ISREG(found.st_mode):
            raise OSError(errno.EINVAL, "it is a pipe or a device, not a file", str(path))
        if found.st_size > most_bytes:
            raise OSError(errno.EFBIG, os.strerror(errno.EFBIG), str(path))
        with open(handle, "rb", closefd=False) as stream:
            yield stream
    finally:
        os.close(handle)


def read_at_most(path: Path, most_bytes: int) -> bytes:
    """Return the content of a regular file.

    Raises
    ------
    OSError, ValueError
        As :func:`opened_file`.
    """
    with opened_file(path, most_bytes) as stream:
        # A read takes memory for all that it asks for, however short the file is: no more than there is to read.
        return stream.read(os.fstat(stream.fileno()).st_size)


def read_toml(path: Path) -> dict[str, Any]:
    """Return the entries of a settings file.

    Raises
    ------
    OSError
        As :func:`read_at_most`.
    ValueError
        It is not TOML in UTF-8, or one that is nested too deep or holds too long numbers.
    """
    content = read_at_most(path, LARGEST_SETTINGS)
    if any(line.count(b".") > MOST_DOTS for line in content.splitlines()):
        raise ValueError(f"a line of it holds more than {MOST_DOTS} dots")
    try:
        entries = tomllib.loads(content.removeprefix(BOM_UTF8).decode())  # editors of Windows write a mark first
        _check_whole_numbers(entries)
    except RecursionError as error:
        raise ValueError("it is nested too deep") from error
    return entries


def _check_whole_numbers(entry: object) -> None:
    """Refuse whole numbers of more than TOML's 64 bits, which Python's reader takes."""
    if isinstance(entry, dict):
        entry = list(entry.values())
    if isinstance(entry, list):
        for part in entry:
            _check_whole_numbers(part)
    elif isinstance(entry, int) and not -(2**63) <= entry < 2**63:
        raise ValueError("it holds a number of more than 64 bits")


def write_atomically(path: Path, content: bytes, verify: Callable[[Path], None] | None = None) -> None:
    """Write ``content`` beside ``path``, flush it to disk, then rename it into place.

    A symbolic link at ``path`` stays; the file that it leads to is replaced.  A file that exists keeps its permissions.

    Parameters
    ----------
    path : Path
        Where the file shall appear; missing folders are made.
    verify : callable, optional
        Reads the temporary file, which has the same extension, before it is renamed; raises ExportError when the file
        is not what was meant.

    Raises
    ------
    ExportError
        The folder is missing or cannot be written, the disk is full, ``path`` is a device, a pipe or a socket or a link
        that leads to no file, or ``verify`` refused the file; an older file at ``path`` is untouched and nothing else
        is left behind.
    """
    temporary: Path | None = None
    try:
        place = linked_file(path)
        place.parent.mkdir(parents=True, exist_ok=True)
        if place.is_dir():
            raise ExportError("file.is_a_folder", path=path)
        mode = NEW_FILE_MODE
        if place.exists():
            found = place.stat().st_mode
            # Renaming a file over a device or a pipe would take it away from all who use it.
            if not stat.S_ISREG(found):
                raise ExportError("file.not_a_file", path=path)
            mode = stat.S_IMODE(found)
        # Part of the name, since that of the file may already be as long as a name can be.
        # Only a reader that judges by the ending gets it: what a killed writer leaves must not look like a real file.
        ending = PART + (place.suffix if verify is not None else "")
        _sweep(place.parent)
        handle, name = tempfile.mkstemp(prefix=f".{place.stem[:40]}.", suffix=ending, dir=place.parent)
        temporary = Path(name)
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        if verify is not None:
            verify(temporary)
        temporary.chmod(mode)
        temporary.replace(place)
        temporary = None
    except OSError as error:
        raise ExportError("file.not_written", path=path, reason=error.strerror or str(error)) from error
    finally:
        if temporary is not None:
            with contextlib.suppress(OSError):
                temporary.unlink()


def _sweep(folder: Path) -> None:
    """Remove what writers left in a folder that were killed long ago."""
    with contextlib.suppress(OSError), os.scandir(folder) as entries:
        latest = time.time() - STALE_SECONDS
        for entry in entries:
            if LEFT_BEHIND.fullmatch(entry.name) and entry.is_file(follow_symlinks=False):
                with contextlib.suppress(OSError):
                    if entry.stat(follow_symlinks=False).st_mtime < latest:
                        Path(entry.path).unlink()


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


@contextlib.contextmanager
def folder_of_one_writer(folder: Path) -> Iterator[None]:
    """Make a folder and keep other writers out of it; a writer that is killed lets go of it.

    Where the file system knows no locks, everybody is let in.

    Raises
    ------
    ExportError
        Somebody else is writing there, or the folder cannot be made.
    """
    handle = None
    try:
        folder.mkdir(parents=True, exist_ok=True)
        handle = _lock(folder)
    except BlockingIOError as error:
        raise ExportError("file.folder_in_use", folder=folder) from error
    except OSError as error:
        raise ExportError("file.not_written", path=folder, reason=error.strerror or str(error)) from error
    try:
        yield
    finally:
        if handle is not None:
            os.close(handle)


if sys.platform == "win32":

    def _lock(folder: Path) -> int | None:
        """A file that only one process can make, and that disappears with its handle."""
        flags = os.O_CREAT | os.O_EXCL | os.O_RDWR | os.O_TEMPORARY
        try:
            return os.open(folder / ".kirigami-studio.lock", flags)
        except FileExistsError as error:
            raise BlockingIOError from error

else:
    import fcntl

    def _lock(folder: Path) -> int | None:
        """A lock on the folder itself, which leaves no file behind."""
        handle = os.open(folder, os.O_RDONLY)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(handle)
            raise
        except OSError:  # a file system without locks
            os.close(handle)
            return None
        return handle


def check_folder(folder: Path) -> None:
    """Refuse a folder that cannot be made or written; create nothing.

    Raises
    ------
    ExportError
        A file stands where the folder should be, or the folder cannot be written to.
    """
    try:
        nearest = next(place for place in (folder, *folder.absolute().parents) if place.exists())
        usable = nearest.is_dir() and os.access(nearest, os.W_OK | os.X_OK)
    except (OSError, ValueError, StopIteration):
        usable = False
    if not usable:
        raise ExportError("file.folder_not_writable", folder=folder)
