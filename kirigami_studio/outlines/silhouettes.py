"""The named silhouettes that ship with the program."""

from __future__ import annotations

import difflib
import json
from dataclasses import dataclass
from functools import cache

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.resources import resource
from kirigami_studio.outlines.outline import Outline


@dataclass(frozen=True, slots=True)
class LibraryEntry:
    """One line of the library list."""

    name: str  #: what ``load`` and the command line take, e.g. "six-point-star"
    title: str  #: for menus, e.g. "Six-point star"
    about: str  #: one sentence: what makes the shape easy or hard


@cache
def names() -> tuple[str, ...]:
    """Names of all bundled silhouettes, in alphabetical order."""
    return tuple(sorted(path.stem for path in resource("silhouettes").glob("*.json")))


def solid_names() -> tuple[str, ...]:
    """Names of those without holes."""
    return tuple(name for name in names() if not _stored(name)[1].holes)


@cache
def _stored(name: str) -> tuple[LibraryEntry, Outline]:
    path = resource("silhouettes", f"{name}.json")
    try:
        stored = json.loads(path.read_text(encoding="utf-8"))
        entry = LibraryEntry(stored["name"], stored["title"], stored["about"])
        points, holes = stored["points"], stored.get("holes", ())
    except (OSError, ValueError, KeyError, TypeError):
        raise TargetError("silhouette.damaged", path=path) from None
    return entry, Outline.from_points(points, name=entry.name, holes=holes)


def entry(name: str) -> LibraryEntry:
    """Title and description of a silhouette; raises like ``load``."""
    return _stored(known(name))[0]


def load(name: str) -> Outline:
    """Return a bundled silhouette by name; upper case, blanks and underscores are forgiven.

    Raises
    ------
    TargetError
        No silhouette has this name; the message names the nearest ones.
    """
    return _stored(known(name))[1]


def known(name: str) -> str:
    """Return the exact name of a bundled silhouette.

    Raises
    ------
    TargetError
        As ``load``.
    """
    wanted = "-".join(name.strip().lower().replace("_", " ").split())
    if wanted in names():
        return wanted
    near = difflib.get_close_matches(wanted, names(), n=3, cutoff=0.5)
    if near:
        raise TargetError("silhouette.unknown_but_near", name=name, near=", ".join(near))
    raise TargetError("silhouette.unknown", name=name, names=", ".join(names()))
