"""What a person used last and expects to find in the next new project, as a small TOML file."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from pathlib import Path

import tomli_w

from kirigami_studio.export.paper import NO_PAPER
from kirigami_studio.fabricate.material import DEFAULT_PRESET, library
from kirigami_studio.foundation.errors import ProjectError, UsageError
from kirigami_studio.foundation.files import read_toml, write_atomically
from kirigami_studio.foundation.plain_text import plain_line
from kirigami_studio.project.document import Document
from kirigami_studio.project.settings import FabricationSettings

#: The desktop's own look, or one of the two palettes.
THEMES = ("system", "light", "dark")
#: Which length of a sheet was typed last: the longer side of the opened shape, or the width of the flat sheet.
SIZES = ("opened", "flat")
#: Whether what moves by itself follows the desktop's setting for animations, or stands still.
MOTIONS = ("system", "still")


@dataclass(frozen=True, slots=True)
class Preferences:
    """Choices that outlive a project.

    Attributes
    ----------
    profile : str
        Key of the machine profile that was chosen last.
    dxf_version : str
        DXF dialect that was chosen last.
    theme : str
        Look of the window, one of :data:`THEMES`.
    language : str
        Code of the window's language, or "system" for the desktop's.
    tour_seen : bool
        Whether the guided tour was taken before.
    material : str
        Key of the material that was chosen last.
    paper : str
        Key of the paper that PDFs are spread over.
    size : str
        Which length was typed last, one of :data:`SIZES`; the other one follows.
    opened_mm, width_mm : float
        Longer side of the opened shape, and width of the flat sheet.
    machine_asked : bool
        Whether the question for machine and material was answered, or declined.
    motion : str
        One of :data:`MOTIONS`.
    """

    profile: str = "any"
    dxf_version: str = "R2010"
    theme: str = "system"
    language: str = "system"
    tour_seen: bool = False
    material: str = DEFAULT_PRESET
    paper: str = NO_PAPER
    size: str = "opened"
    opened_mm: float = 100.0
    width_mm: float = 100.0
    machine_asked: bool = False
    motion: str = "system"

    def __post_init__(self) -> None:
        for name in ("profile", "dxf_version", "theme", "language", "material", "paper", "size", "motion"):
            value = getattr(self, name)
            if not isinstance(value, str) or not value:
                raise ProjectError("preferences.not_a_name", name=name, value=value)
            object.__setattr__(self, name, plain_line(value))
        if self.theme not in THEMES:
            raise ProjectError("preferences.unknown_theme", themes=", ".join(THEMES), value=self.theme)
        for name, choices in (("size", SIZES), ("motion", MOTIONS)):
            if getattr(self, name) not in choices:
                listed = ", ".join(choices)
                raise ProjectError("preferences.unknown_choice", name=name, choices=listed, value=getattr(self, name))
        for name in ("tour_seen", "machine_asked"):
            if not isinstance(getattr(self, name), bool):
                raise ProjectError("preferences.not_true_or_false", name=name, value=getattr(self, name))
        try:
            FabricationSettings(width_mm=self.width_mm, opened_mm=self.opened_mm)
        except UsageError as error:
            raise ProjectError("preferences.not_a_length", reason=str(error)) from error

    def new_document(self) -> Document:
        """An empty document with these choices; a material that is gone gives way to the usual one."""
        empty = Document()
        machine = replace(
            empty.fabrication,
            material=self.material if self.material in library().materials else DEFAULT_PRESET,
            profile=self.profile,
            dxf_version=self.dxf_version,
            paper=self.paper,
            width_mm=self.width_mm,
            opened_mm=self.opened_mm if self.size == "opened" else None,
        )
        return replace(empty, fabrication=machine)

    def on_machine_of(self, document: Document) -> Preferences:
        """The same with what a document says about the machine that it is cut on, and the material."""
        cut = document.fabrication
        return replace(self, profile=cut.profile, dxf_version=cut.dxf_version, material=cut.material, paper=cut.paper)

    def with_size_of(self, document: Document) -> Preferences:
        """The same with the length that was typed for a document."""
        cut = document.fabrication
        if cut.opened_mm is None:
            return replace(self, size="flat", width_mm=cut.width_mm)
        return replace(self, size="opened", opened_mm=cut.opened_mm)


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
