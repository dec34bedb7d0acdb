"""What a person used last and expects to find in the next new project, as a small TOML file."""

from __future__ import annotations

import tomllib
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import tomli_w

from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.project.document import Document


@dataclass(frozen=True, slots=True)
class Preferences:
    """Choices that outlive a project.

    Attributes
    ----------
    profile : str
        Key of the machine profile that was exported for last.
    dxf_version : str
        DXF dialect that was exported last.
    """

    profile: str = "any"
    dxf_version: str = "R2010"

    def __post_init__(self) -> None:
        for name, value in asdict(self).items():
            if not isinstance(value, str) or not value:
                raise ProjectError(f"The preference {name} must be a name, got {value!r}.")

    def new_document(self) -> Document:
        """An empty document with these choices."""
        empty = Document()
        return replace(empty, fabrication=replace(empty.fabrication, **asdict(self)))


def preferences_of(document: Document) -> Preferences:
    """What a document says about the machine that it is cut on."""
    return Preferences(document.fabrication.profile, document.fabrication.dxf_version)


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
        raise ProjectError(f"The preferences in {path} cannot be read: {error}. Correct or delete the file.") from error
    if unknown := entries.keys() - asdict(Preferences()).keys():
        raise ProjectError(f"The preferences in {path} have unknown entries {', '.join(sorted(unknown))}; drop them.")
    return Preferences(**entries)


def save(preferences: Preferences, path: Path) -> None:
    """Write the file.

    Raises
    ------
    ExportError
        It cannot be written.
    """
    write_atomically(path, tomli_w.dumps(asdict(preferences)).encode("utf-8"))
