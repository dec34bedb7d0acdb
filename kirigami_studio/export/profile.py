"""How a machine's program wants the layers coloured (AutoCAD colour index, ACI).

Programs choose the operation by colour: MeerK40t cuts pure red only and engraves blue; K40 Whisperer engraves blue;
LightBurn makes one cut setting for each colour.  No scheme suits them all, so a person picks one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from kirigami_studio.fabricate.cut_plan import Layer
from kirigami_studio.foundation.errors import ExportError

RED, GREEN, BLUE, MAGENTA = 1, 3, 5, 6


@dataclass(frozen=True, slots=True)
class Profile:
    """One colour scheme.

    Attributes
    ----------
    key, name : str
        For the command line, and for a person.
    colour : mapping of Layer to int
        AutoCAD colour index.
    """

    key: str
    name: str
    colour: Mapping[Layer, int]


_ALL_RED = MappingProxyType(dict.fromkeys(Layer, RED))
_BY_LAYER = MappingProxyType({Layer.RELIEF: MAGENTA, Layer.SLITS: RED, Layer.EDGE_SLITS: GREEN, Layer.OUTLINE: BLUE})
PROFILES: Mapping[str, Profile] = MappingProxyType(
    {
        "any": Profile("any", "Any machine: everything red, cut in file order (MeerK40t, K40 Whisperer)", _ALL_RED),
        "lightburn": Profile("lightburn", "LightBurn: one colour for each layer", _BY_LAYER),
    }
)
DEFAULT_PROFILE = "any"


def find_profile(name: str) -> Profile:
    """Return a profile by its key.

    Raises
    ------
    ExportError
        No such profile; the sentence lists the known ones.
    """
    found = PROFILES.get(str(name).strip().casefold())
    if found is None:
        raise ExportError(f"There is no machine profile {name!r}; choose one of {', '.join(PROFILES)}.")
    return found
