"""What may be drawn over the panels of a design."""

from __future__ import annotations

from enum import Enum


class Overlay(Enum):
    """Something that is drawn over the panels."""

    TARGET = "target"
    MISMATCH = "mismatch"
    FAULTS = "faults"
    STRETCH = "stretch"
    GRIPS = "grips"
    RATIOS = "ratios"
    OPENINGS = "openings"
    SMALL_PARTS = "small_parts"
    PANEL_NUMBERS = "panel_numbers"
    VOID_NUMBERS = "void_numbers"


#: What is shown until something else is asked for.
USUAL = frozenset({Overlay.TARGET, Overlay.MISMATCH, Overlay.FAULTS})
