"""Output of the commands: JSON on standard output, sentences, progress on standard error."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping

import numpy as np


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
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value


def print_json(value: object) -> None:
    """One JSON object on one line."""
    sys.stdout.write(json.dumps(plain(value), allow_nan=False) + "\n")
    sys.stdout.flush()


def say(sentence: str) -> None:
    """Print one line for people on standard output."""
    sys.stdout.write(sentence + "\n")


class ProgressLine:
    """A line on standard error that is rewritten in place; silent where that is no terminal."""

    def __init__(self) -> None:
        self.active = sys.stderr.isatty()

    def show(self, message: str) -> None:
        if self.active:
            sys.stderr.write(f"\r\x1b[K{message}")
            sys.stderr.flush()

    def clear(self) -> None:
        if self.active:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()
