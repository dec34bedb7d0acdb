"""Opening a source: the checks every reader shares, and the file's name in every sentence."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from kirigami_studio.foundation.errors import TargetError

MEGABYTE = 1_000_000


def read_bytes(path: Path, most_megabytes: int = 20) -> bytes:
    """Return the content of a file.

    Raises
    ------
    TargetError
        Missing, a folder, empty, not readable, or larger than ``most_megabytes``.
    """
    try:
        if path.is_dir():
            raise TargetError(f"{path} is a folder; choose one file in it.")
        size = path.stat().st_size
        if size > most_megabytes * MEGABYTE:
            raise TargetError(
                f"{path} has {size / MEGABYTE:.1f} MB, more than {most_megabytes} MB; save a simpler version of it."
            )
        content = path.read_bytes()
    except FileNotFoundError:
        raise TargetError(f"There is no file {path}; check the name and the folder.") from None
    except (OSError, ValueError) as error:
        raise TargetError(f"{path} cannot be read: {getattr(error, 'strerror', None) or error}.") from error
    if not content:
        raise TargetError(f"{path.name} is empty; save it again from the program that made it.")
    return content


#: Bytes that a decoder quotes out of a file that is no text, themselves or as escapes.
UNREADABLE = re.compile(r"(?:\\x[0-9a-fA-F]{2}|\\[a-z0]|[^\x20-\x7e\s\u00a0-\uffff])+")


@contextmanager
def decoding(path: Path, kind: str) -> Iterator[None]:
    """Name the file in every error of a reader, and turn a decoder's own exceptions into a sentence.

    Decoders of foreign libraries raise whatever a damaged file makes them stumble over (struct.error,
    SyntaxError, KeyError, RecursionError ...), so no list of types would be complete.

    Parameters
    ----------
    path : Path
    kind : str
        What the file should be, e.g. "a picture (PNG, JPG or BMP)".

    Raises
    ------
    TargetError
        Instead of any exception raised inside.
    """
    try:
        yield
    except TargetError as error:
        sentence = str(error)
        raise TargetError(sentence if str(path) in sentence else f"{path.name}: {sentence}") from error
    except Exception as error:
        reason = " ".join(UNREADABLE.sub("…", str(error)).split())[:160] or type(error).__name__
        raise TargetError(
            f"{path.name} is damaged or not {kind} ({reason}); open it in the program that made it and save it again."
        ) from error
