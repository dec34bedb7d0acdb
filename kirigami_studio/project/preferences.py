"""Choices that the next new project begins with, as a small TOML file."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, replace
from enum import StrEnum
from pathlib import Path

import tomli_w

from kirigami_studio.export.paper import Paper
from kirigami_studio.export.profile import DxfVersion
from kirigami_studio.fabricate.machine import machines
from kirigami_studio.fabricate.material import DEFAULT_PRESET, library
from kirigami_studio.foundation.errors import ProjectError, UsageError
from kirigami_studio.foundation.files import read_toml, write_atomically
from kirigami_studio.foundation.plain_text import plain_line
from kirigami_studio.foundation.settings import Setting, check
from kirigami_studio.project.document import Document
from kirigami_studio.settings.fabrication import FabricationSettings


class Theme(StrEnum):
    """Look of the window: the desktop's own, or one of the two palettes."""

    SYSTEM = "system"
    LIGHT = "light"
    DARK = "dark"


class TypedSize(StrEnum):
    """Which length of a sheet was typed last; the other one follows."""

    OPENED = "opened"  #: longer side of the opened shape
    FLAT = "flat"  #: width of the flat sheet


class LengthUnit(StrEnum):
    """Unit that fields for lengths show, and assume where none is typed."""

    MILLIMETRES = "mm"
    INCHES = "in"


class MotionPreference(StrEnum):
    """Whether moving parts follow the desktop's setting for animations, or stand still."""

    SYSTEM = "system"
    STILL = "still"


#: Entries of earlier versions that mean nothing now.
RETIRED = ("tour_seen",)
_NAME = Setting(code="preferences.not_a_name", error=ProjectError).metadata
_NAME_OR_NONE = Setting(may_be_empty=True, code="preferences.not_a_name", error=ProjectError).metadata
_CHOICE = Setting(code="preferences.unknown_choice", error=ProjectError).metadata
_FLAG = Setting(code="preferences.not_true_or_false", error=ProjectError).metadata


@dataclass(frozen=True, slots=True)
class Preferences:
    """Choices that outlive a project."""

    profile: str = field(default="any", metadata=_NAME)  #: key of the machine profile that was chosen last
    dxf_version: DxfVersion = field(default=DxfVersion.R2010, metadata=_CHOICE)  #: DXF dialect that was chosen last
    theme: Theme = field(default=Theme.SYSTEM, metadata=_CHOICE)
    #: Code of the window's language, or "system" for the desktop's.
    language: str = field(default="system", metadata=_NAME)
    material: str = field(default=DEFAULT_PRESET, metadata=_NAME)  #: key of the material that was chosen last
    #: Key of the machine that was chosen last; "" for the one that the material is for.
    machine: str = field(default="", metadata=_NAME_OR_NONE)
    paper: Paper = field(default=Paper.NONE, metadata=_CHOICE)  #: that PDFs are spread over
    size: TypedSize = field(default=TypedSize.OPENED, metadata=_CHOICE)
    #: opened_mm, width_mm: longer side of the opened shape, and width of the flat sheet.
    opened_mm: float = 100.0
    width_mm: float = 100.0
    #: Whether the question for machine and material was answered, or declined.
    machine_asked: bool = field(default=False, metadata=_FLAG)
    preview: bool = field(default=True, metadata=_FLAG)  #: Whether a design is previewed while the target changes
    motion: MotionPreference = field(default=MotionPreference.SYSTEM, metadata=_CHOICE)
    unit: LengthUnit = field(default=LengthUnit.MILLIMETRES, metadata=_CHOICE)

    def __post_init__(self) -> None:
        check(self)
        for name in ("profile", "language", "material", "machine"):
            object.__setattr__(self, name, plain_line(getattr(self, name)))
        try:
            FabricationSettings(width_mm=self.width_mm, opened_mm=self.opened_mm)
        except UsageError as error:
            raise ProjectError("preferences.not_a_length", reason=str(error)) from error

    def new_document(self) -> Document:
        """An empty document with these choices; a material that is gone gives way to the usual one."""
        empty = Document()
        machine = replace(
            empty.fabrication,
            material=self.material if self.material in library().items else DEFAULT_PRESET,
            machine=self.machine if self.machine in machines().items else "",
            profile=self.profile,
            dxf_version=self.dxf_version,
            paper=self.paper,
            width_mm=self.width_mm,
            opened_mm=self.opened_mm if self.size is TypedSize.OPENED else None,
        )
        return replace(empty, fabrication=machine)

    def on_machine_of(self, document: Document) -> Preferences:
        """The same with what a document says about the machine that it is cut on, and the material."""
        cut = document.fabrication
        return replace(
            self,
            profile=cut.profile,
            dxf_version=cut.dxf_version,
            material=cut.material,
            machine=cut.machine,
            paper=cut.paper,
        )

    def with_size_of(self, document: Document) -> Preferences:
        """The same with the length that was typed for a document."""
        cut = document.fabrication
        if cut.opened_mm is None:
            return replace(self, size=TypedSize.FLAT, width_mm=cut.width_mm)
        return replace(self, size=TypedSize.OPENED, opened_mm=cut.opened_mm)


def load(path: Path) -> Preferences:
    """Read the file; without one the defaults hold.

    Raises
    ------
    ProjectError
        Unreadable, not TOML, or with entries that are no preferences.
    """
    try:
        entries = read_toml(path)
    except FileNotFoundError:
        return Preferences()
    except (OSError, ValueError) as error:
        raise ProjectError("preferences.not_readable", path=path, reason=str(error)) from error
    for name in RETIRED:
        entries.pop(name, None)
    if unknown := entries.keys() - asdict(Preferences()).keys():
        raise ProjectError("preferences.unknown_entries", path=path, names=", ".join(sorted(unknown)))
    return Preferences(**entries)


def save(preferences: Preferences, path: Path) -> None:
    """Write the file.

    Raises
    ------
    ExportError
        It cannot be written.
    """
    write_atomically(path, tomli_w.dumps(asdict(preferences)).encode("utf-8"))
