"""Opening a source: the checks that all readers share, and the file's name in every problem."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.files import read_at_most

MEGABYTE = 1_000_000
Decoded = TypeVar("Decoded")

#: Seconds of processor time that one source may take to be read.
MOST_SECONDS = 3.5


class TimeBudget:
    """What is left of the time that reading may take: a drawing can be small and unfold without end.

    Counted in the processor time of the thread, so that a busy machine refuses nothing that an idle one reads.
    """

    def __init__(self, seconds: float = MOST_SECONDS) -> None:
        self._seconds = seconds
        self._begun = time.thread_time()

    def check(self, share: float = 1.0) -> None:
        """Refuse to go on when more than a share of the time is used.

        Raises
        ------
        TargetError
            It is.
        """
        if time.thread_time() - self._begun > share * self._seconds:
            raise TargetError("source.too_slow", seconds=self._seconds)


def read_bytes(path: Path, most_megabytes: int = 20) -> bytes:
    """Return the content of a file.

    Raises
    ------
    TargetError
        Missing, a folder, empty, not readable, or larger than ``most_megabytes``.
    """
    try:
        if path.is_dir():
            raise TargetError("source.folder", path=path)
        size = path.stat().st_size
        if size > most_megabytes * MEGABYTE:
            raise TargetError("source.too_large", path=path, megabytes=size / MEGABYTE, limit=most_megabytes)
        content = read_at_most(path, most_megabytes * MEGABYTE)
    except FileNotFoundError:
        raise TargetError("source.missing", path=path) from None
    except OSError as error:
        raise TargetError("source.not_readable", path=path, reason=error.strerror or str(error)) from error
    except ValueError as error:  # a null character in the name
        raise TargetError("target.not_a_file_name", name=str(path)) from error
    if not content:
        raise TargetError("source.empty", name=path.name)
    return content


#: Bytes that a decoder quotes out of a file that is no text, themselves or as escapes.
UNREADABLE = re.compile(r"(?:\\x[0-9a-fA-F]{2}|\\[a-z0]|[^\x20-\x7e\s\u00a0-\uffff])+")


@contextmanager
def decoding(path: Path, damaged: str) -> Iterator[None]:
    """Name the file in every problem of a reader, and turn a decoder's own exceptions into one.

    Decoders of other libraries raise all sorts of exceptions on damaged files (struct.error, SyntaxError, KeyError,
    RecursionError ...), so no list of types would be complete.

    Parameters
    ----------
    damaged : str
        Code of the problem when a decoder fails, such as "source.dxf_damaged".

    Raises
    ------
    TargetError
        Instead of any exception raised inside; a problem raised inside is its ``__cause__``.
    """
    try:
        yield
    except TargetError as error:
        raise TargetError("source.not_usable", name=path.name, reason=error) from error
    except Exception as error:
        reason = " ".join(UNREADABLE.sub("…", str(error)).split())[:160] or type(error).__name__
        raise TargetError(damaged, name=path.name, reason=reason) from error


def decoded(
    path: str | Path, damaged: str, decode: Callable[[Path, bytes], Decoded], most_megabytes: int = 20
) -> Decoded:
    """Read a file and decode it, its name in every problem.

    Raises
    ------
    TargetError
        As :func:`read_bytes` and :func:`decoding`.
    """
    path = Path(path)
    content = read_bytes(path, most_megabytes)
    with decoding(path, damaged):
        return decode(path, content)
