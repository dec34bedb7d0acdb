"""Materials: typed TOML files, bundled presets in ``resources/materials`` and own ones in a folder of the user.

Every bundled preset is a starting point until someone calibrates a copy of it (``material_copies``).  An own material
with the key of a preset wins over it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import date
from enum import StrEnum
from pathlib import Path
from typing import Any

from kirigami_studio.fabricate.findings import Note
from kirigami_studio.fabricate.options import ConnectorStyle
from kirigami_studio.fabricate.shelf import LARGEST_NUMBER, LEAST_NUMBER, Contents, Shelf
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.foundation.frozen_mapping import FrozenMapping
from kirigami_studio.foundation.plain_text import LONGEST_NOTE, plain_line, plain_lines
from kirigami_studio.foundation.settings import Setting, check
from kirigami_studio.foundation.words import mark

#: The preset that a new project starts with.
DEFAULT_PRESET = "film-uv"
#: The preset of sheets that are to be printed, where none is named.
PRINTED_PRESET = "pla-print"
#: The machine of materials that are cut with scissors or a knife.
BY_HAND = "by hand"
#: The machine of materials that are printed.
PRINTER = "3D printer"
#: Names the folder of the user's own materials, if it is set.
FOLDER_VARIABLE = "KIRIGAMI_STUDIO_MATERIALS"
#: Full power, percent.
LARGEST_POWER = 100.0
#: Entry of files from before tension and bending were told apart: the strain at which connectors were taken to break.
OLD_LIMIT = "strain_limit"
_FLAG = Setting(code="material.wrong_type", error=FabricationError).metadata
_WORD = Setting(code="material.no_such_word", error=FabricationError).metadata


class Construction(StrEnum):
    """Way of making a sheet; the values stand in files."""

    ONE_SHEET = "one-sheet"  #: bridges of the sheet itself turn
    PINNED = "pinned"  #: two layers of rigid panels turn on pins
    BACKED = "backed"  #: tiles are glued on a hinge layer
    PRINTED = "printed"  #: a 3D printer makes the sheet, its tiles, or panels with their pins in place


#: Codes of notes on materials whose connectors break, by the construction that works.
BETTER_MADE = {
    Construction.BACKED: "plan.material_needs_backing",
    Construction.PRINTED: "plan.material_needs_printed_pins",
}


def _text(label: str = "", about: str = "") -> Mapping[str, Setting]:
    setting = Setting(about=about, label=label, may_be_empty=True, code="material.wrong_type", error=FabricationError)
    return setting.metadata


def _number(
    label: str,
    about: str,
    unit: str,
    low: float,
    high: float,
    step: float,
    decimals: int = 3,
    scale: float = 1.0,
    zero: bool = False,
) -> Mapping[str, Setting]:
    """Describe a number, above 0 unless it may be ``zero``; the editor shows ``scale`` times it."""
    setting = Setting(
        about=about,
        label=label,
        unit=unit,
        low=low,
        high=high,
        step=step,
        decimals=decimals,
        scale=scale,
        least=0.0 if zero else LEAST_NUMBER,
        most=LARGEST_NUMBER,
        code="material.number_negative" if zero else "material.number_not_positive",
        error=FabricationError,
    )
    return setting.metadata


def _machine_number(zero: bool = False) -> Mapping[str, Setting]:
    """Describe a number that older files have; no editor shows it."""
    return _number("", "", "", 0.0, 1.0, 1.0, zero=zero)


def _strain(label: str, about: str, zero: bool = False) -> Mapping[str, Setting]:
    """Describe a strain, which the editor shows in percent."""
    return _number(label, about, "%", 0.0 if zero else 0.01, 1000.0, 0.5, decimals=2, scale=100.0, zero=zero)


@dataclass(frozen=True, slots=True)
class Material:
    """One sheet material on one kind of machine."""

    #: Short name for the command line and for project files (the preset's file name)
    key: str = field(metadata=_text())
    name: str = field(metadata=_text(mark("Name"), mark("Name shown in the material list.")))  #: Shown name
    #: Kind of machine that the numbers are for
    machine: str = field(metadata=_text(mark("Machine"), mark("Machine these values were measured on.")))
    thickness_mm: float = field(metadata=_number(mark("Thickness"), mark("Sheet thickness."), "mm", 0.005, 50.0, 0.05))
    #: Full width of the cut, 0 for a blade
    kerf_mm: float = field(
        metadata=_number(mark("Kerf"), mark("Full width of the cut; 0 for a blade."), "mm", 0.0, 5.0, 0.01, zero=True)
    )
    #: Default finished connector width
    connector_mm: float = field(
        metadata=_number(mark("Connector"), mark("Default finished connector width."), "mm", 0.02, 20.0, 0.05)
    )
    #: A warning is given about finished ligaments below this
    min_ligament_mm: float = field(
        metadata=_number(
            mark("Smallest ligament"), mark("Warn about ligaments narrower than this."), "mm", 0.005, 20.0, 0.01
        )
    )
    #: Radius of a stress-relief slit end, 0 for none
    relief_radius_mm: float = field(
        metadata=_number(
            mark("Relief radius"), mark("Radius of the relief hole at a slit's end."), "mm", 0.0, 5.0, 0.05, zero=True
        )
    )
    #: Speed with the beam on
    speed_mm_s: float = field(
        metadata=_number(mark("Cutting speed"), mark("Speed with the beam on."), "mm/s", 0.01, 10000.0, 5.0, decimals=2)
    )
    #: Gaps below twice this may be closed by the program that imports the file
    join_tolerance_mm: float = field(
        metadata=_number(
            mark("Joins gaps below"), mark("Gaps that the machine software may close."), "mm", 0.0, 2.0, 0.01, zero=True
        )
    )
    calibrated: bool = field(metadata=_FLAG)  #: False until the numbers were measured on a coupon
    note: str = field(metadata=_text(mark("Note"), mark("Anything worth knowing.")))
    #: Strain (0.05 = 5 %) above which it stays bent; 0 for what springs back until it breaks, and where nobody knows
    yield_strain: float = field(
        default=0.0,
        metadata=_strain(mark("Yield strain"), mark("Strain above which it stays bent; 0: none."), zero=True),
    )
    #: Elongation at which it tears when pulled; files without it get that of a brittle sheet
    break_strain: float = field(
        default=0.05, metadata=_strain(mark("Breaking strain"), mark("Strain at which it tears when pulled."))
    )
    #: Strain of the outer fibre at which a bend breaks; larger than ``break_strain`` in what delaminates or folds
    bend_strain: float = field(
        default=0.05,
        metadata=_strain(mark("Bending strain"), mark("Strain of the outer fibre at which a bend breaks.")),
    )
    #: How many times the job is cut; 1 in files without it
    passes: int = field(
        default=1,
        metadata=Setting(
            about=mark("How many times the job is cut (1 to 100)."),
            label=mark("Passes"),
            widget="passes",
            high=100.0,
            low=1.0,
            code="material.wrong_type",
            error=FabricationError,
        ).metadata,
    )
    #: A warning is given about slits shorter than this; 0.1 in files without it
    min_slit_mm: float = field(
        default=0.1,
        metadata=_number(mark("Shortest slit"), mark("Shortest slit for this material."), "mm", 0.005, 20.0, 0.05),
    )
    #: Young's modulus; 3 in files without it, as many plastics have
    young_gpa: float = field(
        default=3.0,
        metadata=_number(
            mark("Stiffness"), mark("Young's modulus of the material."), "GPa", 0.0001, 1000.0, 0.5, decimals=4
        ),
    )
    #: Power of the laser while it cuts, 0 to 100; 0 for a blade, and where nobody knows it
    power_percent: float = field(
        default=0.0,
        metadata=_number(
            mark("Power"),
            mark("Laser power while cutting; 0 for a blade."),
            "%",
            0.0,
            100.0,
            5.0,
            decimals=1,
            zero=True,
        ),
    )
    #: A warning is given about panels narrower than this or than the smallest ligament; 0 in files without it
    min_panel_mm: float = field(
        default=0.0,
        metadata=_number(
            mark("Smallest panel"), mark("Warn about panels narrower than this."), "mm", 0.0, 100.0, 0.5, zero=True
        ),
    )
    #: False where no style, width and sheet size is known whose connectors survive opening
    connectors_hold: bool = field(default=True, metadata=_FLAG)
    #: Way of making sheets that works best in it
    construction: Construction = field(default=Construction.ONE_SHEET, metadata=_WORD)
    backing: bool = field(default=False, metadata=_FLAG)  #: Whether it is meant as the hinge layer under tiles
    #: Usual width of the flat sheet
    sheet_mm: float = field(
        default=100.0,
        metadata=_number(mark("Usual width"), mark("Usual width of the flat sheet."), "mm", 5.0, 3000.0, 10.0, 1),
    )
    style: ConnectorStyle = field(default=ConnectorStyle.CENTRED, metadata=_WORD)  #: Style that works at that width
    #: Where the figures of entries are from, or that they are an estimate; no part of comparisons
    sources: Mapping[str, str] = field(default_factory=FrozenMapping, compare=False)
    #: measured_on and measured_by: Day (ISO 8601) and author of the calibration, both may be empty
    measured_on: str = field(default="", metadata=_text())
    measured_by: str = field(default="", metadata=_text())
    #: travel_mm_s, acceleration_mm_s2, on_delay_s, off_delay_s, bed_width_mm and bed_height_mm: The machine's, in files
    #: from before machines stood apart; None in others, see ``machine.machine_of``
    travel_mm_s: float | None = field(default=None, metadata=_machine_number())
    acceleration_mm_s2: float | None = field(default=None, metadata=_machine_number())
    on_delay_s: float | None = field(default=None, metadata=_machine_number(zero=True))
    off_delay_s: float | None = field(default=None, metadata=_machine_number(zero=True))
    bed_width_mm: float | None = field(default=None, metadata=_machine_number(zero=True))
    bed_height_mm: float | None = field(default=None, metadata=_machine_number(zero=True))

    def __post_init__(self) -> None:
        check(self, key=self.key)
        for name in ("name", "machine", "measured_on", "measured_by"):  # the key names a file, which its writer checks
            object.__setattr__(self, name, plain_line(getattr(self, name)))
        object.__setattr__(self, "note", plain_lines(self.note))
        self._check_sources()
        if self.passes < 1:
            raise FabricationError("material.no_passes", key=self.key, passes=self.passes)
        if self.power_percent > LARGEST_POWER:
            raise FabricationError("material.power_above_full", key=self.key, power_percent=self.power_percent)
        if self.measured_on:
            self._check_day()

    @property
    def limits_note(self) -> Note | None:
        """Word before a run that one sheet of it does not work, or hardly, and what does."""
        if self.backing:
            return Note.of("plan.material_is_hinge_layer", material=self.name)
        if self.connectors_hold:
            if self.construction is Construction.ONE_SHEET:
                return None
            return Note.of("material.near_its_limit", material=self.name, least_mm=self.min_ligament_mm)
        return Note.of(BETTER_MADE.get(self.construction, "plan.material_does_not_hold"), material=self.name)

    @property
    def by_hand(self) -> bool:
        """Whether it is cut with scissors or a knife."""
        return self.machine == BY_HAND

    def _check_sources(self) -> None:
        found = self.sources
        if not isinstance(found, Mapping) or not all(isinstance(text, str) for text in found.values()):
            values = {"key": self.key, "name": "sources", "kind": "a table of texts", "value": found}
            raise FabricationError("material.wrong_type", **values)
        clean = {plain_line(name): plain_line(text, LONGEST_NOTE) for name, text in found.items()}
        object.__setattr__(self, "sources", FrozenMapping(clean))

    def _check_day(self) -> None:
        try:
            date.fromisoformat(self.measured_on)
        except ValueError:
            raise FabricationError("material.not_a_day", key=self.key, value=self.measured_on) from None


def with_entries_of_now(entries: Mapping[str, Any]) -> dict[str, Any]:
    """Entries of a file or of changes, those of older programs under their present names."""
    now = dict(entries)
    if OLD_LIMIT in now:
        limit = now.pop(OLD_LIMIT)
        now = {"break_strain": limit, "bend_strain": limit} | now
    return now


#: The bundled presets and the user's own materials.
SHELF: Shelf[Material] = Shelf(
    Material,
    "materials",
    FOLDER_VARIABLE,
    DEFAULT_PRESET,
    FrozenMapping(
        {
            "folder": "material.folder_not_readable",
            "unknown": "material.unknown",
            "unreadable": "material.file_not_readable",
            "missing": "material.entries_missing",
            "not_known": "material.entries_unknown",
            "key": "material.key_not_usable",
            "bundled": "material.bundled_not_deleted",
            "none_own": "material.none_own",
            "not_own": "material.not_own",
            "not_deleted": "material.not_deleted",
            "no_entry": "material.no_such_entry",
            "folder_bundled": "material.folder_is_bundled",
        }
    ),
    frozenset({"key", "calibrated", "connectors_hold", "construction", "backing", "style", "sources"}),
    with_entries_of_now,
)


def presets() -> dict[str, Material]:
    """Return all bundled presets by key, the default one first, the rest in alphabetical order."""
    return SHELF.bundled()


def own_folder() -> Path:
    """Folder of the user's own materials: the one in the variable, or the platform's for settings."""
    return SHELF.own_folder()


def library() -> Contents[Material]:
    """Read presets and own materials; an own file that cannot be used is noted among the faults."""
    return SHELF.contents()


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
    return SHELF.find(name)


def read_preset(path: Path) -> Material:
    """Read one file; its stem becomes the key.

    Raises
    ------
    FabricationError
        Unreadable, not TOML, or with missing, unknown or impossible entries.
    """
    return SHELF.read(path)
