"""Material presets: typed TOML files in ``resources/materials``, each a starting point until someone calibrates it."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass, fields
from pathlib import Path

from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.foundation.resources import resource

#: The preset that a new project starts with: the film of the paper's specimens.
DEFAULT_PRESET = "film-uv"


@dataclass(frozen=True, slots=True)
class Material:
    """One sheet material on one kind of machine.

    Attributes
    ----------
    key : str
        Short name for the command line and for project files (the preset's file name).
    name : str
        What a person reads.
    machine : str
        Kind of machine that the numbers are for.
    thickness_mm : float
    kerf_mm : float
        Full width of the cut, 0 for a blade.
    connector_mm : float
        Default finished connector width.
    min_ligament_mm : float
        Finished ligaments below this are warned about.
    relief_radius_mm : float
        Radius of a stress-relief slit end, 0 for none.
    speed_mm_s, travel_mm_s : float
        Speed with the beam on, and between cuts.
    acceleration_mm_s2 : float
    join_tolerance_mm : float
        Gaps below twice this may be closed by the program that imports the file.
    calibrated : bool
        False until the numbers were measured on a coupon.
    note : str
    """

    key: str
    name: str
    machine: str
    thickness_mm: float
    kerf_mm: float
    connector_mm: float
    min_ligament_mm: float
    relief_radius_mm: float
    speed_mm_s: float
    travel_mm_s: float
    acceleration_mm_s2: float
    join_tolerance_mm: float
    calibrated: bool
    note: str

    def __post_init__(self) -> None:
        may_be_zero = {"kerf_mm", "relief_radius_mm", "join_tolerance_mm"}
        for field in fields(self):
            value = getattr(self, field.name)
            if field.type == "float":
                self._check_number(field.name, value, zero_allowed=field.name in may_be_zero)
            elif type(value).__name__ != field.type:
                raise FabricationError(
                    f"Material {self.key!r}: {field.name} must be a {field.type}, got {value!r}; correct the preset."
                )

    def _check_number(self, name: str, value: object, zero_allowed: bool) -> None:
        number = isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
        if not number or value < 0 or (value == 0 and not zero_allowed):  # type: ignore[operator]
            bound = "0 or more" if zero_allowed else "above 0"
            raise FabricationError(
                f"Material {self.key!r}: {name} must be a number {bound}, got {value!r}; correct the preset."
            )


def presets() -> dict[str, Material]:
    """Return all bundled presets by key, the default one first, the rest in alphabetical order."""
    found = {path.stem: read_preset(path) for path in sorted(resource("materials").glob("*.toml"))}
    return dict(sorted(found.items(), key=lambda item: (item[0] != DEFAULT_PRESET, item[0])))


def default_material() -> Material:
    """Return the preset that applies when nobody chose one."""
    return find_material(DEFAULT_PRESET)


def find_material(name: str) -> Material:
    """Return the preset with this key or full name (capitals do not matter).

    Raises
    ------
    FabricationError
        No preset of that name; the sentence lists the known keys.
    """
    known = presets()
    wanted = str(name).strip().casefold()
    for key, material in known.items():
        if wanted in (key.casefold(), material.name.casefold()):
            return material
    raise FabricationError(f"There is no material {name!r}; choose one of {', '.join(known)}.")


def read_preset(path: Path) -> Material:
    """Read one preset file; the file's stem becomes its key.

    Raises
    ------
    FabricationError
        Unreadable, not TOML, or with missing, unknown or impossible entries.
    """
    try:
        entries = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise FabricationError(f"The material file {path} cannot be read: {error}.") from error
    expected = {field.name for field in fields(Material)} - {"key"}
    if missing := expected - entries.keys():
        raise FabricationError(f"The material file {path} lacks {', '.join(sorted(missing))}; add them.")
    if unknown := entries.keys() - expected:
        raise FabricationError(f"The material file {path} has unknown entries {', '.join(sorted(unknown))}; drop them.")
    return Material(key=path.stem, **entries)
