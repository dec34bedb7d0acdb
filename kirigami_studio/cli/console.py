"""Output of the commands: JSON on standard output, sentences, progress on standard error.

Sentences go where :func:`sentences_to` says, and a file that stands for standard input or output is called ``-``.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Literal

import numpy as np

#: What a command line and its answers call standard input or output.
STREAM = "-"

#: Stream of sentences; None drops them.
_sentences: ContextVar[Literal["stdout", "stderr"] | None] = ContextVar("sentences", default="stdout")
#: Files that stand for a stream while a command runs.
_stand_ins: ContextVar[tuple[str, ...]] = ContextVar("stand_ins", default=())


@contextmanager
def sentences_to(stream: Literal["stdout", "stderr"] | None) -> Iterator[None]:
    """Print sentences on this stream; None drops them, notes and progress, too."""
    token = _sentences.set(stream)
    try:
        yield
    finally:
        _sentences.reset(token)


@contextmanager
def standing_in(path: Path) -> Iterator[None]:
    """Call a file ``-`` in everything that is printed."""
    token = _stand_ins.set((*_stand_ins.get(), str(path), path.name))
    try:
        yield
    finally:
        _stand_ins.reset(token)


def as_typed(text: str) -> str:
    """A text with stand-ins called as on the command line."""
    for path in _stand_ins.get():
        text = text.replace(path, STREAM)
    return text


def is_quiet() -> bool:
    """Whether sentences are dropped."""
    return _sentences.get() is None


def plain(value: object) -> object:
    """Turn arrays, tuples and NumPy numbers into JSON; non-finite numbers become null."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, str):
        return as_typed(value)
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value


def print_json(value: object) -> None:
    """One JSON object on one line."""
    sys.stdout.write(json.dumps(plain(value), allow_nan=False) + "\n")
    sys.stdout.flush()


def say(sentence: str) -> None:
    """Print one line for people, on standard output unless sentences go elsewhere."""
    stream = _sentences.get()
    if stream is not None:
        getattr(sys, stream).write(as_typed(sentence) + "\n")


def remark(sentence: str) -> None:
    """Print one line beside the answer, on standard error."""
    if not is_quiet():
        sys.stderr.write(f"kirigami-studio: {as_typed(sentence)}\n")


class ProgressLine:
    """A line on standard error that is rewritten in place; silent where that is no terminal."""

    def __init__(self) -> None:
        self.active = sys.stderr.isatty() and not is_quiet()

    def show(self, message: str) -> None:
        if self.active:
            sys.stderr.write(f"\r\x1b[K{message}")
            sys.stderr.flush()

    def clear(self) -> None:
        if self.active:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()
