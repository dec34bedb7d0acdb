"""Choices of scripts as the program's own values: plain numbers in the place of NumPy's, pairs in that of mappings."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from kirigami_studio.foundation.errors import UsageError

#: Choices that are numbers, and those of them that are whole ones.
LENGTHS, COUNTS = ("width_mm", "connector_mm", "kerf_mm", "tab_mm", "copy_gap_mm"), ("tabs", "copies")


def checked_choices(given: Mapping[str, Any]) -> dict[str, Any]:
    """Choices with Python's own numbers in the place of NumPy's, connectors as pairs of number and width.

    Raises
    ------
    UsageError
        Something else where numbers belong.
    """
    found = dict(given)
    for name in (*LENGTHS, *COUNTS):
        if name in found:
            found[name] = number(name, found[name], whole=name in COUNTS)
    if "hinge_mm" in found:
        widths = found["hinge_mm"]
        if not isinstance(widths, Mapping):
            raise UsageError("api.not_connector_widths", value=reprlib.repr(widths))
        found["hinge_mm"] = [
            (number("hinge_mm", one, whole=True), number("hinge_mm", width)) for one, width in widths.items()
        ]
    if "removed" in found:
        removed = found["removed"]
        if isinstance(removed, str) or not isinstance(removed, (Sequence, np.ndarray)):
            raise UsageError("api.not_connectors", value=reprlib.repr(removed))
        found["removed"] = [number("removed", one, whole=True) for one in removed]
    return found


def number(name: str, value: object, *, whole: bool = False) -> Any:
    """A finite number as Python's own.

    Raises
    ------
    UsageError
        No number, or not a whole one where that is asked for; the sentence has the name.
    """
    plain = value.item() if isinstance(value, np.generic) else value
    if isinstance(plain, bool) or not isinstance(plain, int if whole else (int, float)) or not math.isfinite(plain):
        raise UsageError("api.not_whole" if whole else "api.not_a_number", name=name, value=reprlib.repr(value))
    return plain
