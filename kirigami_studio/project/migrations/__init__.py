"""Lift project files of older versions: one function per version, applied one after the other.

``MIGRATIONS[v]`` takes the members of a version ``v`` file and returns those of version ``v + 1``.  A change of the
format raises :data:`CURRENT_VERSION` and adds one entry, never edits one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.project.migrations.from_1 import with_preference
from kirigami_studio.project.migrations.from_2 import with_cut_options
from kirigami_studio.project.migrations.from_3 import with_marks
from kirigami_studio.project.migrations.from_4 import with_runs

#: The members of a project file by name; the manifest is not among them.
Members = Mapping[str, bytes]
Migration = Callable[[Members], Members]

CURRENT_VERSION = 5
MIGRATIONS: Mapping[int, Migration] = MappingProxyType(
    {1: with_preference, 2: with_cut_options, 3: with_marks, 4: with_runs}
)


def migrate(
    members: Members, version: int, current: int = CURRENT_VERSION, table: Mapping[int, Migration] = MIGRATIONS
) -> Members:
    """Return the members as the current version has them.

    Raises
    ------
    ProjectError
        The file is newer than this program, or older than its oldest migration.
    """
    if version > current:
        raise ProjectError(
            f"it was saved by a newer Kirigami Studio (format {version}, this one reads up to {current}); "
            "update the program"
        )
    for step in range(version, current):
        if step not in table:
            raise ProjectError(f"its format {version} is older than anything this program can read")
        members = table[step](members)
    return members
