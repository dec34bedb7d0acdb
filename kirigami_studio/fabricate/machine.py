"""Machines: reach and speeds of cutters and printers, their materials, and the files of their programs.

A material's figures hold for one kind of machine.  ``resources/figures`` has those of bundled materials on other kinds,
a file for each kind with a table for each material: :func:`material_on` puts them together.  Bundled machines stand in
``resources/machines``, the user's own in a folder beside their materials.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cache
from types import MappingProxyType
from typing import Any

from kirigami_studio.fabricate.material import BY_HAND, DEFAULT_PRESET, PRINTER, Material, library
from kirigami_studio.fabricate.shelf import LARGEST_NUMBER, LEAST_NUMBER, Contents, Shelf
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.foundation.frozen_mapping import FrozenMapping
from kirigami_studio.foundation.plain_text import plain_line, plain_lines
from kirigami_studio.foundation.resources import resource
from kirigami_studio.foundation.settings import Setting, check
from kirigami_studio.foundation.words import mark

#: Names the folder of the user's own machines, if it is set.
FOLDER_VARIABLE = "KIRIGAMI_STUDIO_MACHINES"


class MachineKind(StrEnum):
    """Kinds of machines; the values stand in files."""

    UV = "uv"
    CO2 = "co2"
    DIODE = "diode"
    KNIFE = "knife"
    HAND = "hand"
    PRINTER = "printer"
    OTHER = "other"  #: of materials whose machine has another name

    @classmethod
    def of(cls, words: str) -> MachineKind:
        """The kind that a material's machine is of, by what it is called."""
        lower = words.casefold()
        return next((kind for kind, signs in _SIGNS.items() if any(sign in lower for sign in signs)), cls.OTHER)

    @property
    def words(self) -> str:
        """Name of this kind, as materials call their machine."""
        return _WORDS[self]


_WORDS = {
    MachineKind.UV: mark("UV or green pulsed laser"),
    MachineKind.CO2: mark("CO2 laser"),
    MachineKind.DIODE: mark("diode laser"),
    MachineKind.KNIFE: mark("cutting plotter"),
    MachineKind.HAND: BY_HAND,
    MachineKind.PRINTER: PRINTER,
    MachineKind.OTHER: mark("another machine"),
}
#: What the names of machines of a kind have in them; the first that fits decides.
_SIGNS = {
    MachineKind.HAND: ("by hand", "scissors"),
    MachineKind.PRINTER: ("3d print", "fdm", "fff"),
    MachineKind.DIODE: ("diode",),
    MachineKind.CO2: ("co2", "co₂"),
    MachineKind.UV: ("uv ", "uv-", "ultraviolet", "green"),
    MachineKind.KNIFE: ("plotter", "knife", "blade", "cricut", "silhouette"),
}
#: The machine of its kind that applies where only a material was named.
USUAL = {
    MachineKind.UV: "uv-laser",
    MachineKind.CO2: "co2-laser",
    MachineKind.DIODE: "diode-10w",
    MachineKind.KNIFE: "cutting-plotter",
    MachineKind.HAND: "hand",
    MachineKind.PRINTER: "fdm-220",
}
#: Profiles that machines may name (``export.profile`` has them) and kinds of files.
PROFILES = ("any", "lightburn", "k40", "single", "layers", "slots", "cricut", "silhouette", "glowforge", "xtool")
FILES = (".dxf", ".svg", ".pdf", ".lbrn2", ".3mf")
#: Numbers of the machine that older files of materials have.
OLDER_ENTRIES = (
    "travel_mm_s", "acceleration_mm_s2", "on_delay_s", "off_delay_s", "bed_width_mm", "bed_height_mm",
)  # fmt: skip


def _number(
    label: str, about: str, unit: str, high: float, step: float, decimals: int = 1, scale: float = 1.0
) -> Mapping[str, Setting]:
    """Describe a number of 0 or more; the editor shows ``scale`` times it."""
    return Setting(
        about=about,
        label=label,
        unit=unit,
        low=0.0,
        high=high,
        step=step,
        decimals=decimals,
        scale=scale,
        least=0.0,
        most=LARGEST_NUMBER,
        code="machine.number_negative",
        error=FabricationError,
    ).metadata


def _moving(label: str, about: str, unit: str, high: float, step: float) -> Mapping[str, Setting]:
    """Describe a number above 0."""
    return Setting(
        about=about,
        label=label,
        unit=unit,
        low=0.01,
        high=high,
        step=step,
        decimals=2,
        least=LEAST_NUMBER,
        most=LARGEST_NUMBER,
        code="machine.number_not_positive",
        error=FabricationError,
    ).metadata


def _text(label: str = "", about: str = "") -> Mapping[str, Setting]:
    return Setting(
        about=about, label=label, may_be_empty=True, code="machine.wrong_type", error=FabricationError
    ).metadata


@dataclass(frozen=True, slots=True)
class Machine:
    """A cutter or a printer and the program that drives it."""

    key: str = field(metadata=_text())  #: Short name for the command line and for project files (the file's name)
    name: str = field(metadata=_text(mark("Name"), mark("Name shown in the list of machines.")))  #: Shown name
    kind: MachineKind = field(
        metadata=Setting(label=mark("Kind"), code="machine.no_such_kind", error=FabricationError).metadata
    )
    #: bed_width_mm and bed_height_mm: What it reaches; 0 for any size
    bed_width_mm: float = field(
        default=0.0, metadata=_number(mark("Bed width"), mark("Width that the machine reaches; 0: any."), "mm", 5e3, 10)
    )
    bed_height_mm: float = field(
        default=0.0,
        metadata=_number(mark("Bed height"), mark("Height that the machine reaches; 0: any."), "mm", 5e3, 10),
    )
    #: Speed between cuts
    travel_mm_s: float = field(
        default=200.0, metadata=_moving(mark("Travel speed"), mark("Speed between cuts."), "mm/s", 2e4, 20.0)
    )
    acceleration_mm_s2: float = field(
        default=1500.0,
        metadata=_moving(mark("Acceleration"), mark("How fast the head accelerates."), "mm/s²", 2e5, 100.0),
    )
    #: It cuts no faster, whatever a material asks for; 0 where no limit is known
    largest_speed_mm_s: float = field(
        default=0.0,
        metadata=_number(
            mark("Largest speed"), mark("It cuts no faster than this; 0: no limit known."), "mm/s", 2e4, 10
        ),
    )
    #: on_delay_s and off_delay_s: What it waits at the start of every path (piercing, lowering the blade) and at its
    #: end
    on_delay_s: float = field(
        default=0.0,
        metadata=_number(
            mark("Delay before a cut"), mark("Pause before each cut, with piercing."), "ms", 1e4, 5, scale=1000.0
        ),
    )
    off_delay_s: float = field(
        default=0.0,
        metadata=_number(mark("Delay after a cut"), mark("Pause after each cut."), "ms", 1e4, 5, scale=1000.0),
    )
    #: What it waits at every sharp corner (a scanner that settles, a blade that swivels)
    corner_delay_s: float = field(
        default=0.0,
        metadata=_number(mark("Delay at a corner"), mark("Pause at each sharp corner."), "ms", 1e4, 1, scale=1000.0),
    )
    #: The thickest sheet that it takes; 0 where no limit is known
    thickest_mm: float = field(
        default=0.0,
        metadata=_number(
            mark("Thickest sheet"), mark("Thickest sheet that it takes; 0: no limit known."), "mm", 50, 0.1
        ),
    )
    #: canvas_width_mm and canvas_height_mm: The largest drawing that its program cuts; 0 where that is the bed
    canvas_width_mm: float = field(
        default=0.0,
        metadata=_number(
            mark("Canvas width"), mark("Widest drawing that its program cuts; 0: the bed."), "mm", 5e3, 10
        ),
    )
    canvas_height_mm: float = field(
        default=0.0,
        metadata=_number(
            mark("Canvas height"), mark("Highest drawing that its program cuts; 0: the bed."), "mm", 5e3, 10
        ),
    )
    profile: str = field(default="any", metadata=_text())  #: Key of the profile that its program wants cut files in
    file: str = field(default=".dxf", metadata=_text())  #: Extension of the file that its program takes best
    #: Where the numbers come from
    note: str = field(default="", metadata=_text(mark("Note"), mark("Anything worth knowing.")))

    def __post_init__(self) -> None:
        check(self, key=self.key)
        for code, value, known in (
            ("machine.no_such_profile", self.profile, PROFILES),
            ("machine.no_such_file", self.file, FILES),
        ):
            if value not in known:
                raise FabricationError(code, key=self.key, value=value, choices=", ".join(known))
        object.__setattr__(self, "name", plain_line(self.name))
        object.__setattr__(self, "note", plain_lines(self.note))

    @property
    def reach_mm(self) -> tuple[float, float]:
        """Width and height that machine and program allow; 0 for any."""
        pairs = ((self.bed_width_mm, self.canvas_width_mm), (self.bed_height_mm, self.canvas_height_mm))
        width, height = (min((one for one in pair if one > 0.0), default=0.0) for pair in pairs)
        return width, height

    def speed_mm_s(self, material: Material) -> float:
        """Speed at which it cuts a material."""
        wanted = material.speed_mm_s
        return min(wanted, self.largest_speed_mm_s) if self.largest_speed_mm_s > 0.0 else wanted

    def takes(self, material: Material) -> bool:
        """Whether it is known to cut a material: one with figures for its kind, thin enough."""
        known = self.kind in kinds_for(material)
        return known and not (0.0 < self.thickest_mm < material.thickness_mm)


SHELF: Shelf[Machine] = Shelf(
    Machine,
    "machines",
    FOLDER_VARIABLE,
    USUAL[MachineKind.UV],
    FrozenMapping(
        {
            "folder": "machine.folder_not_readable",
            "unknown": "machine.unknown",
            "unreadable": "machine.file_not_readable",
            "missing": "machine.entries_missing",
            "not_known": "machine.entries_unknown",
            "key": "machine.key_not_usable",
            "bundled": "machine.bundled_not_deleted",
            "none_own": "machine.none_own",
            "not_own": "machine.not_own",
            "not_deleted": "material.not_deleted",
            "no_entry": "machine.no_such_entry",
            "folder_bundled": "machine.folder_is_bundled",
        }
    ),
)


def machines() -> Contents[Machine]:
    """Read bundled machines and the user's own."""
    return SHELF.contents()


def find_machine(name: str) -> Machine:
    """Return the machine with this key or full name (capitals do not matter).

    Raises
    ------
    FabricationError
        No machine of that name; the sentence lists the known keys.
    """
    return SHELF.find(name)


def changed_machine(source: str, key: str, changes: Mapping[str, object]) -> Machine:
    """A copy of a machine under a new key (or the same), changed and not saved yet.

    Raises
    ------
    FabricationError
        No such machine or entry, or a value that makes no sense.
    """
    original = find_machine(source)
    values = SHELF.typed(changes)
    if key != original.key and "name" not in values:
        values["name"] = f"{original.name} ({key})"
    return replace(original, key=SHELF.check_key(key), **values)


def machine_of(material: Material) -> Machine:
    """The usual machine of the kind that a material is for, with the numbers of an older file."""
    kind = MachineKind.of(material.machine)
    usual = SHELF.bundled()[USUAL[kind]] if kind in USUAL else Machine("", material.machine, kind)
    older = {name: getattr(material, name) for name in OLDER_ENTRIES}
    given = {name: value for name, value in older.items() if value is not None}
    return replace(usual, key="", name=material.machine, **given) if given else usual


@cache
def _figures() -> Mapping[MachineKind, Mapping[str, Mapping[str, Any]]]:
    """Entries of bundled materials on other kinds of machines than their own."""
    found = {}
    for path in sorted(resource("figures").glob("*.toml")):
        found[MachineKind(path.stem)] = tomllib.loads(path.read_text(encoding="utf-8"))
    return MappingProxyType(found)


def kinds_for(material: Material) -> tuple[MachineKind, ...]:
    """The kinds of machines that a material has figures for, its own first."""
    own = MachineKind.of(material.machine)
    return (own, *(kind for kind, tables in _figures().items() if kind is not own and material.key in tables))


def material_on(material: Material, machine: Machine) -> Material:
    """A material with its figures on a machine's kind; as it is where there are none."""
    if machine.kind is MachineKind.of(material.machine) or machine.kind not in kinds_for(material):
        return material
    return replace(material, machine=machine.kind.words, calibrated=False, **_figures()[machine.kind][material.key])


def usual_material(machine: Machine, taken: Mapping[str, Material]) -> str:
    """Key of the material to begin with, of those that a machine takes."""
    known = library().items

    def order(key: str) -> tuple[bool, bool, bool]:
        made_for = MachineKind.of(known[key].machine) is machine.kind
        return key != DEFAULT_PRESET, not made_for, taken[key].limits_note is not None

    return min(taken, key=order)


def cuttable(machine: Machine) -> dict[str, Material]:
    """The materials that a machine cuts, by key, with their figures on it, sorted by name."""
    found = {key: material_on(material, machine) for key, material in library().items.items()}
    taken = {key: material for key, material in found.items() if machine.takes(material)}
    return dict(sorted(taken.items(), key=lambda item: item[1].name.casefold()))
