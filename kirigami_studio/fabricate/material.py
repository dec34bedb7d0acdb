"""Materials: typed TOML files, bundled presets in ``resources/materials`` and own ones in a folder of the user.

Every bundled preset is a starting point until someone calibrates a copy of it (``material_copies``).  An own material
with the key of a preset wins over it.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from datetime import date
from functools import cache
from pathlib import Path
from types import MappingProxyType

import platformdirs

from kirigami_studio.fabricate.findings import Note
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.foundation.files import read_toml
from kirigami_studio.foundation.plain_text import plain_line, plain_lines
from kirigami_studio.foundation.resources import resource

#: The preset that a new project starts with: the film of the paper's specimens.
DEFAULT_PRESET = "film-uv"
#: The machine of materials that are cut with scissors or a knife.
BY_HAND = "by hand"
#: Names the folder of a person's own materials, if it is set.
FOLDER_VARIABLE = "KIRIGAMI_STUDIO_MATERIALS"
#: Numbers that may be 0; all others are above it.
MAY_BE_ZERO = frozenset(
    {"kerf_mm", "relief_radius_mm", "join_tolerance_mm", "on_delay_s", "off_delay_s", "power_percent", "bed_width_mm",
     "bed_height_mm", "min_panel_mm"}
)  # fmt: skip
#: Full power, percent.
LARGEST_POWER = 100.0


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
        A warning is given about finished ligaments below this.
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
        A warning is given about slits shorter than this; 0.1 in files without it.
    young_gpa : float
        Young's modulus; 3 in files without it, as many plastics have.
    power_percent : float
        Power of the laser while it cuts, 0 to 100; 0 for a blade, and where nobody knows it.
    bed_width_mm, bed_height_mm : float
        What the machine can reach; 0 in files without it, where nobody knows it.
    min_panel_mm : float
        A warning is given about panels narrower than this or than the smallest ligament; 0 in files without it.
    connectors_hold : bool
        False where no style, width and sheet size is known whose connectors survive opening.
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
    young_gpa: float = 3.0
    power_percent: float = 0.0
    bed_width_mm: float = 0.0
    bed_height_mm: float = 0.0
    min_panel_mm: float = 0.0
    connectors_hold: bool = True
    measured_on: str = ""
    measured_by: str = ""

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            # The key stays as it was given: whoever writes a file of that name checks it.
            if isinstance(value, str) and field.name != "key":
                plain = plain_lines(value) if field.name == "note" else plain_line(value)
                object.__setattr__(self, field.name, plain)
            if field.type == "float":
                self._check_number(field.name, value, zero_allowed=field.name in MAY_BE_ZERO)
            elif type(value).__name__ != field.type:
                raise FabricationError(
                    "material.wrong_type", key=self.key, name=field.name, kind=field.type, value=value
                )
        if self.passes < 1:
            raise FabricationError("material.no_passes", key=self.key, passes=self.passes)
        if self.power_percent > LARGEST_POWER:
            raise FabricationError("material.power_above_full", key=self.key, power_percent=self.power_percent)
        if self.measured_on:
            self._check_day()

    @property
    def by_hand(self) -> bool:
        """Whether it is cut with scissors or a knife."""
        return self.machine == BY_HAND

    def _check_day(self) -> None:
        try:
            date.fromisoformat(self.measured_on)
        except ValueError:
            raise FabricationError("material.not_a_day", key=self.key, value=self.measured_on) from None

    def _check_number(self, name: str, value: object, zero_allowed: bool) -> None:
        number = isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
        if not number or value < 0 or (value == 0 and not zero_allowed):  # type: ignore[operator]
            code = "material.number_negative" if zero_allowed else "material.number_not_positive"
            raise FabricationError(code, key=self.key, name=name, value=value)


@dataclass(frozen=True, slots=True)
class Library:
    """All materials that there are.

    Attributes
    ----------
    materials : mapping of str to Material
        By key: the default preset, the other presets in alphabetical order, then own materials with keys of their own.
    own : frozenset of str
        Keys of those that are not bundled, or that stand for the bundled ones of the same key.
    faults : tuple of Note
        One for each own file that cannot be used.
    """

    materials: Mapping[str, Material]
    own: frozenset[str]
    faults: tuple[Note, ...]


def presets() -> dict[str, Material]:
    """Return all bundled presets by key, the default one first, the rest in alphabetical order."""
    return dict(_bundled())


@cache
def _bundled() -> Mapping[str, Material]:
    """The presets; they come with the program, so one reading is enough."""
    found = {path.stem: read_preset(path) for path in sorted(resource("materials").glob("*.toml"))}
    return MappingProxyType(dict(sorted(found.items(), key=lambda item: (item[0] != DEFAULT_PRESET, item[0]))))


def own_folder() -> Path:
    """Where a person's own materials are: what the variable names, or the platform's place for settings."""
    named = os.environ.get(FOLDER_VARIABLE)
    if named:
        return Path(named)
    return platformdirs.user_config_path("kirigami-studio", appauthor=False) / "materials"


def library() -> Library:
    """Read presets and own materials; an own file that cannot be used is noted among the faults."""
    materials, own, faults = presets(), set[str](), list[Note]()
    folder = own_folder()
    try:
        files = sorted(folder.glob("*.toml"))
    except OSError as error:
        reason = error.strerror or str(error)
        files, faults = [], [Note.of("material.folder_not_readable", folder=folder, reason=reason)]
    for path in files:
        try:
            materials[path.stem] = read_preset(path)
            own.add(path.stem)
        except FabricationError as error:
            faults.append(Note(error.code, error.fields))
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
        raise FabricationError("material.unknown", name=name, known=", ".join(known))
    return found


def read_preset(path: Path) -> Material:
    """Read one file; its stem becomes the key.

    Raises
    ------
    FabricationError
        Unreadable, not TOML, or with missing, unknown or impossible entries.
    """
    try:
        entries = read_toml(path)
    except (OSError, ValueError) as error:
        raise FabricationError("material.file_not_readable", path=path, reason=str(error)) from error
    expected = {field.name: field.default is MISSING for field in fields(Material) if field.name != "key"}
    if missing := {name for name, needed in expected.items() if needed} - entries.keys():
        names = ", ".join(sorted(missing))
        raise FabricationError("material.entries_missing", path=path, names=names, count=len(missing))
    if unknown := entries.keys() - expected.keys():
        names = ", ".join(sorted(unknown))
        raise FabricationError("material.entries_unknown", path=path, names=names, count=len(unknown))
    return Material(key=plain_line(path.stem), **entries)
