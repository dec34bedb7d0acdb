"""Lift project files of older formats: one function per version, applied one after the other.

``MIGRATIONS[v]`` takes the members of a version ``v`` file and returns those of version ``v + 1``.  A change of the
format raises :data:`CURRENT_VERSION` by one and adds one entry; entries that were released never change.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.project.labels import letters_of

#: The members of a project file by name; the manifest is not among them.
Members = Mapping[str, bytes]
Migration = Callable[[Members], Members]

#: The member that holds everything but arrays.
DESIGN = "design.json"


def _with_sheet_settings(members: Members) -> Members:
    """Format 2 says whether a run chooses its grid, and how sheets may be: designs so far had a fixed grid, an even rim
    and no symmetry asked for.  That every sheet had an even rim is what designs without an entry for it mean.
    """
    if DESIGN not in members:
        return members
    try:
        design = json.loads(members[DESIGN])
        design["settings"] |= {"auto_grid": False, "symmetry": "none", "rim": "even", "regular": 0.5}
    except (ValueError, TypeError, KeyError, RecursionError):
        return members  # reading says what is wrong with it
    return {**members, DESIGN: json.dumps(design).encode()}


def _with_labels(members: Members) -> Members:
    """Format 3 names designs: those of the run that the best one comes from A1, A2, ..., those of others B1, ..."""
    if DESIGN not in members:
        return members
    try:
        design = json.loads(members[DESIGN])
        runs: dict[object, int] = {}
        counts: dict[object, int] = {}
        labels = []
        for entry in design["candidates"]:
            run = entry.get("run")
            counts[run] = counts.get(run, 0) + 1
            code = f"{letters_of(runs.setdefault(run, len(runs)))}{counts[run]}"
            labels.append({"code": code, "name": "", "note": ""})
        design |= {"labels": labels, "naming_runs": len(runs)}
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return members  # reading says what is wrong with it
    return {**members, DESIGN: json.dumps(design).encode()}


CURRENT_VERSION = 3
MIGRATIONS: Mapping[int, Migration] = MappingProxyType({1: _with_sheet_settings, 2: _with_labels})


def migrate(members: Members, version: int, path: Path) -> Members:
    """Return the members as the current version has them.

    Parameters
    ----------
    version : int
        Format of the file, by its manifest.

    Raises
    ------
    ProjectError
        The file is newer than this program, or older than its oldest migration.
    """
    if version > CURRENT_VERSION:
        raise ProjectError("project.newer_format", path=path, version=version, current=CURRENT_VERSION)
    for step in range(version, CURRENT_VERSION):
        if step not in MIGRATIONS:
            raise ProjectError("project.format_too_old", path=path, version=step)
        members = MIGRATIONS[step](members)
    return members
