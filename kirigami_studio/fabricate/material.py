"""Materials: typed TOML files, bundled presets in ``resources/materials`` and own ones in a folder of the user.

Every bundled preset is a starting point until someone calibrates a copy of it (``material_copies``).  An own material
with the key of a preset wins over it.
"""

from __future__ import annotations

import math
import os
import tomllib
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from datetime import date
from pathlib import Path

import platformdirs

from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.foundation.resources import resource

#: The preset that a new project starts with: the film of the paper's specimens.
DEFAULT_PRESET = "film-uv"
#: Names the folder of a person's own materials, if it is set.
FOLDER_VARIABLE = "KIRIGAMI_STUDIO_MATERIALS"


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
    strain_limit : float
        Strain at which the material breaks (0.05 = 5 %); files without it get that of a brittle sheet.
    on_delay_s, off_delay_s : float
        What the machine waits at the start and at the end of every path; 0 in files without it.
    passes : int
        How many times the job is cut; 1 in files without it.
    min_slit_mm : float
        Slits shorter than this are warned about; 0.1 in files without it.
    measured_on, measured_by : str
        Day (ISO 8601) and author of the calibration, both may be empty.
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
    strain_limit: float = 0.05
    on_delay_s: float = 0.0
    off_delay_s: float = 0.0
    passes: int = 1
    min_slit_mm: float = 0.1
    measured_on: str = ""
    measured_by: str = ""

    def __post_init__(self) -> None:
        may_be_zero = {"kerf_mm", "relief_radius_mm", "join_tolerance_mm", "on_delay_s", "off_delay_s"}
        for field in fields(self):
            value = getattr(self, field.name)
            if field.type == "float":
                self._check_number(field.name, value, zero_allowed=field.name in may_be_zero)
            elif type(value).__name__ != field.type:
                raise FabricationError(
                    f"Material {self.key!r}: {field.name} must be a {field.type}, got {value!r}; correct the preset."
                )
        if self.passes < 1:
            raise FabricationError(f"Material {self.key!r}: passes must be 1 or more, got {self.passes}.")
        if self.measured_on:
            self._check_day()

    def _check_day(self) -> None:
        try:
            date.fromisoformat(self.measured_on)
        except ValueError:
            raise FabricationError(
                f"Material {self.key!r}: measured_on must be a day like 2026-11-21, got {self.measured_on!r}."
            ) from None

    def _check_number(self, name: str, value: object, zero_allowed: bool) -> None:
        number = isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
        if not number or value < 0 or (value == 0 and not zero_allowed):  # type: ignore[operator]
            bound = "0 or more" if zero_allowed else "above 0"
            raise FabricationError(
                f"Material {self.key!r}: {name} must be a number {bound}, got {value!r}; correct the preset."
            )


@dataclass(frozen=True, slots=True)
class Library:
    """All materials that there are.

    Attributes
    ----------
    materials : mapping of str to Material
        By key: the default preset, the other presets in alphabetical order, then own materials with keys of their own.
    own : frozenset of str
        Keys of those that are not bundled, or that stand for the bundled ones of the same key.
    faults : tuple of str
        One sentence for each own file that cannot be used.
    """

    materials: Mapping[str, Material]
    own: frozenset[str]
    faults: tuple[str, ...]


def presets() -> dict[str, Material]:
    """Return all bundled presets by key, the default one first, the rest in alphabetical order."""
    found = {path.stem: read_preset(path) for path in sorted(resource("materials").glob("*.toml"))}
    return dict(sorted(found.items(), key=lambda item: (item[0] != DEFAULT_PRESET, item[0])))


def own_folder() -> Path:
    """Where a person's own materials are: what the variable names, or the platform's place for settings."""
    named = os.environ.get(FOLDER_VARIABLE)
    if named:
        return Path(named)
    return platformdirs.user_config_path("kirigami-studio", appauthor=False) / "materials"


def library() -> Library:
    """Read presets and own materials; an own file that cannot be used becomes a sentence among the faults."""
    materials, own, faults = presets(), set[str](), list[str]()
    folder = own_folder()
    try:
        files = sorted(folder.glob("*.toml"))
    except OSError as error:
        files, faults = [], [f"The folder of own materials {folder} cannot be read: {error.strerror or error}."]
    for path in files:
        try:
            materials[path.stem] = read_preset(path)
            own.add(path.stem)
        except FabricationError as error:
            faults.append(str(error))
    return Library(materials, frozenset(own), tuple(faults))


def default_material() -> Material:
    """Return the preset that applies when nobody chose one, or the own copy that stands for it."""
    return find_material(DEFAULT_PRESET)


def find_material(name: str) -> Material:
    """Return the material with this key or full name (capitals do not matter); a key wins over a name.

    Raises
    ------
    FabricationError
        No material of that name; the sentence lists the known keys.
    """
    known = library().materials
    wanted = str(name).strip().casefold()
    by_key = {key.casefold(): material for key, material in known.items()}
    by_name = {material.name.casefold(): material for material in list(known.values())[::-1]}
    found = by_key.get(wanted) or by_name.get(wanted)
    if found is None:
        raise FabricationError(f"There is no material {name!r}; choose one of {', '.join(known)}.")
    return found


def read_preset(path: Path) -> Material:
    """Read one file; its stem becomes the key.

    Raises
    ------
    FabricationError
        Unreadable, not TOML, or with missing, unknown or impossible entries.
    """
    try:
        entries = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise FabricationError(f"The material file {path} cannot be read: {error}.") from error
    expected = {field.name: field.default is MISSING for field in fields(Material) if field.name != "key"}
    if missing := {name for name, needed in expected.items() if needed} - entries.keys():
        raise FabricationError(f"The material file {path} lacks {', '.join(sorted(missing))}; add them.")
    if unknown := entries.keys() - expected.keys():
        raise FabricationError(f"The material file {path} has unknown entries {', '.join(sorted(unknown))}; drop them.")
    return Material(key=path.stem, **entries)
