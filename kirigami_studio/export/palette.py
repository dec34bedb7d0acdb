"""Colours of exported pictures and drawings, as red, green, blue from 0 to 255."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from kirigami_studio.fabricate.cut_plan import Layer

Colour = tuple[int, int, int]

PAPER: Colour = (255, 255, 255)
PANEL: Colour = (176, 200, 226)
PANEL_EDGE: Colour = (44, 72, 105)
VOID: Colour = (250, 250, 247)
TARGET_FILL: Colour = (255, 232, 204)
TARGET_EDGE: Colour = (217, 95, 2)
INK: Colour = (40, 40, 40)
LAYER_COLOUR: Mapping[Layer, Colour] = MappingProxyType(
    {Layer.RELIEF: (220, 120, 0), Layer.SLITS: (255, 0, 0), Layer.EDGE_SLITS: (0, 160, 0), Layer.OUTLINE: (0, 0, 255)}
)


def hexadecimal(colour: Colour) -> str:
    """Return ``#rrggbb``."""
    return "#{:02x}{:02x}{:02x}".format(*colour)
