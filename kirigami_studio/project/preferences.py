"""What a person used last and expects to find in the next new project, as a small TOML file."""

from __future__ import annotations

import tomllib
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import tomli_w

from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.project.document import Document

#: The desktop's own look, or one of the two palettes.
THEMES = ("system", "light", "dark")


@dataclass(frozen=True, slots=True)
class Preferences:
    """Choices that outlive a project.

    Attributes
    ----------
    profile : str
        Key of the machine profile that was exported for last.
    dxf_version : str
        DXF dialect that was exported last.
    theme : str
        Look of the window, one of :data:`THEMES`.
    tour_seen : bool
        Whether the guided tour was offered before.
    """

    profile: str = "any"
    dxf_version: str = "R2010"
    theme: str = "system"
    tour_seen: bool = False

    def __post_init__(self) -> None:
        for name, value in (("profile", self.profile), ("dxf_version", self.dxf_version), ("theme", self.theme)):
            if not isinstance(value, str) or not value:
                raise ProjectError("preferences.not_a_name", name=name, value=value)
        if self.theme not in THEMES:
            raise ProjectError("preferences.unknown_theme", themes=", ".join(THEMES), value=self.theme)
        if not isinstance(self.tour_seen, bool):
            raise ProjectError("preferences.not_true_or_false", name="tour_seen", value=self.tour_seen)

    def new_document(self) -> Document:
        """An empty document with these choices."""
        empty = Document()
        machine = replace(empty.fabrication, profile=self.profile, dxf_version=self.dxf_version)
        return replace(empty, fabrication=machine)

    def on_machine_of(self, document: Document) -> Preferences:
        """The same with what a document says about the machine that it is cut on."""
        return replace(self, profile=document.fabrication.profile, dxf_version=document.fabrication.dxf_version)


def load(path: Path) -> Preferences:
    """Read the file; without one the defaults hold.

    Raises
    ------
    ProjectError
        Unreadable, not TOML, or with entries that are no preferences.
    """
    try:
        entries = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return Preferences()
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
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
