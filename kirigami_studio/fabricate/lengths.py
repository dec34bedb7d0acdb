"""Lengths that a person typed, in mm: a number, or a sentence that says what is wrong with it."""

from __future__ import annotations

import math

from kirigami_studio.foundation.errors import FabricationError


def check_length(what: str, value: float, zero_allowed: bool = False) -> float:
    """Return a length in mm as float, or refuse it by name.

    Raises
    ------
    FabricationError
        Not a number, not finite, negative, or zero where that makes no sense.
    """
    try:
        length = float(value)
    except (TypeError, ValueError):
        raise FabricationError(f"{what} must be a number of millimetres, got {value!r}.") from None
    if not math.isfinite(length) or length < 0 or (length == 0 and not zero_allowed):
        bound = "0 mm or more" if zero_allowed else "above 0 mm"
        raise FabricationError(f"{what} must be {bound}, got {length:g} mm; type a positive width in millimetres.")
    return length
