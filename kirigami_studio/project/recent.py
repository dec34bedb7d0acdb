"""Projects and targets that were used last, as a small TOML file beside the preferences."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from pathlib import Path

import tomli_w

from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.foundation.files import read_toml, write_atomically

#: Files of each kind that are remembered.
MOST = 10
#: Letters of a path: more than systems take.
LONGEST_PATH = 4096


@dataclass(frozen=True, slots=True)
class Recent:
    """The files that were used last, the newest first.

    Raises
    ------
    ProjectError
        Something else than a list of paths.
    """

    #: projects, targets: absolute paths.
    projects: tuple[str, ...] = ()
    targets: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name, entries in (("projects", self.projects), ("targets", self.targets)):
            if not isinstance(entries, tuple | list) or not all(isinstance(entry, str) and entry for entry in entries):
                raise ProjectError("recent.not_paths", name=name, value=entries)
            # A path cannot be changed to be shown, so those that cannot be shown as they are are not remembered.
            shown = [entry for entry in entries if entry.isprintable() and len(entry) <= LONGEST_PATH]
            object.__setattr__(self, name, tuple(shown[:MOST]))

    def with_project(self, path: Path) -> Recent:
        """The same with this project first."""
        return replace(self, projects=_first(path, self.projects))

    def with_target(self, path: Path) -> Recent:
        """The same with this target first."""
        return replace(self, targets=_first(path, self.targets))


def _first(path: Path, known: tuple[str, ...]) -> tuple[str, ...]:
    name = str(path.absolute())
    return (name, *(entry for entry in known if entry != name))


def load(path: Path) -> Recent:
    """Read the file; without one nothing was used.

    Raises
    ------
    ProjectError
        Unreadable, not TOML, or with other entries.
    """
    try:
        entries = read_toml(path)
    except FileNotFoundError:
        return Recent()
    except (OSError, ValueError) as error:
        raise ProjectError("recent.not_readable", path=path, reason=str(error)) from error
    if unknown := entries.keys() - {"projects", "targets"}:
        raise ProjectError("recent.unknown_entries", path=path, names=", ".join(sorted(unknown)))
    return Recent(**entries)


def save(recent: Recent, path: Path) -> None:
    """Write the file.

    Raises
    ------
    ExportError
        It cannot be written.
    """
    write_atomically(path, tomli_w.dumps({name: list(paths) for name, paths in asdict(recent).items()}).encode("utf-8"))
