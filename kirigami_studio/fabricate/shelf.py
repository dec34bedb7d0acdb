"""Values in typed TOML files, bundled ones and the user's own.

Bundled ones lie in a folder of ``resources``, own ones in a folder of the user's settings.  Materials and machines are
kept this way.  The stem of a file is the key; an own value with the key of a bundled one wins over it.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping
from dataclasses import MISSING, asdict, dataclass, fields
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar, Generic, Protocol, TypeVar

import platformdirs
import tomli_w

from kirigami_studio.fabricate.findings import Note
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.foundation.files import read_toml, write_atomically
from kirigami_studio.foundation.plain_text import plain_line
from kirigami_studio.foundation.resources import resource

#: Numbers above 0 are at least so large and all at most so large: farther out arithmetic overflows.
LEAST_NUMBER, LARGEST_NUMBER = 1e-6, 1e9
#: Keys are file names on every platform: lower case, so that no two differ by capitals only.
KEY = re.compile(r"[a-z0-9][a-z0-9_-]{0,39}")
#: Files of these names cannot exist on Windows.
RESERVED = frozenset({"con", "prn", "aux", "nul", *(f"{port}{n}" for port in ("com", "lpt") for n in range(10))})


class Kept(Protocol):
    """A frozen dataclass of texts, numbers and flags with a key and a name."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def key(self) -> str:
        """Name of its file, without extension."""

    @property
    def name(self) -> str:
        """Shown name."""


Item = TypeVar("Item", bound=Kept)


@dataclass(frozen=True, slots=True)
class Contents(Generic[Item]):
    """All values of a shelf that there are."""

    #: By key: the first, the other bundled ones in alphabetical order, then own ones with keys of their own
    items: Mapping[str, Item]
    own: frozenset[str]  #: Keys of those that are not bundled, or that stand for the bundled ones of the same key
    faults: tuple[Note, ...]  #: One for each own file that cannot be used


@dataclass(frozen=True, slots=True, eq=False)
class Shelf(Generic[Item]):
    """Where values of one kind are kept."""

    kind: type[Item]  #: A frozen dataclass; its field ``key`` is the file's name
    folder: str  #: Of ``resources``, and beside the user's settings
    variable: str  #: Environment variable that names another folder of the user's own
    first: str  #: Key of the bundled one that is listed first
    codes: Mapping[str, str]  #: Codes of the problems, by what they are about
    judged: frozenset[str] = frozenset({"key"})  #: Fields that nobody changes by name
    #: Makes entries of today's files of those that older files have
    now: Callable[[Mapping[str, Any]], Mapping[str, Any]] = lambda entries: entries

    def bundled(self) -> dict[str, Item]:
        """Return the bundled values by key, the first one first, the rest in alphabetical order."""
        return dict(_bundled(self))

    def own_folder(self) -> Path:
        """Folder of the user's own: the one in the variable, or the platform's for settings."""
        named = os.environ.get(self.variable)
        if named:
            return Path(named)
        return platformdirs.user_config_path("kirigami-studio", appauthor=False) / self.folder

    def contents(self) -> Contents[Item]:
        """Read bundled and own values; an own file that cannot be used is noted among the faults."""
        items, own, faults = self.bundled(), set[str](), list[Note]()
        folder = self.own_folder()
        try:
            files = sorted(folder.glob("*.toml"))
        except OSError as error:
            reason = error.strerror or str(error)
            files, faults = [], [Note(self.codes["folder"], {"folder": folder, "reason": reason})]
        for path in files:
            try:
                item = self.read(path)
                items[item.key] = item
                own.add(item.key)
            except FabricationError as error:
                faults.append(Note(error.code, error.fields))
        return Contents(items, frozenset(own), tuple(faults))

    def find(self, name: str) -> Item:
        """Return the value with this key, or else with this key or full name in any case.

        Raises
        ------
        FabricationError
            None of that name; the sentence lists the known keys.
        """
        known = self.contents().items
        if (exact := str(name)) in known:
            return known[exact]
        wanted = exact.strip().casefold()
        by_key = {key.casefold(): item for key, item in known.items()}
        by_name = {item.name.casefold(): item for item in list(known.values())[::-1]}
        found = by_key.get(wanted) or by_name.get(wanted)
        if found is None:
            raise FabricationError(self.codes["unknown"], name=name, known=", ".join(known))
        return found

    def read(self, path: Path) -> Item:
        """Read one file; its stem becomes the key.

        Raises
        ------
        FabricationError
            Unreadable, not TOML, or with missing, unknown or impossible entries.
        """
        try:
            entries = read_toml(path)
        except (OSError, ValueError) as error:
            reason = (error.strerror if isinstance(error, OSError) else None) or str(error)
            raise FabricationError(self.codes["unreadable"], path=path, reason=reason) from error
        entries = dict(self.now(entries))
        expected = {
            one.name: one.default is MISSING and one.default_factory is MISSING
            for one in fields(self.kind)
            if one.name != "key"
        }
        if missing := {name for name, needed in expected.items() if needed} - entries.keys():
            names = ", ".join(sorted(missing))
            raise FabricationError(self.codes["missing"], path=path, names=names, count=len(missing))
        if unknown := entries.keys() - expected.keys():
            names = ", ".join(sorted(unknown))
            raise FabricationError(self.codes["not_known"], path=path, names=names, count=len(unknown))
        make: Callable[..., Item] = self.kind
        return make(key=plain_line(path.stem), **entries)

    def check_key(self, key: str) -> str:
        """Return a key that can be a file's name, or refuse it.

        Raises
        ------
        FabricationError
            Empty, too long, with other characters than a-z, 0-9, - and _, or reserved by a platform.
        """
        if not isinstance(key, str) or KEY.fullmatch(key) is None or key in RESERVED:
            raise FabricationError(self.codes["key"], key=key)
        return key

    def save(self, item: Item) -> Path:
        """Save an own value under its key, in the place of an own one and before a bundled one.

        Raises
        ------
        FabricationError
            A key that cannot be a file's name, or the folder of the bundled ones.
        ExportError
            The file cannot be written.
        """
        path = self._own_file(item.key)
        entries = {name: value for name, value in asdict(item).items() if name != "key" and value is not None}
        write_atomically(path, tomli_w.dumps(entries).encode("utf-8"))
        return path

    def delete(self, key: str) -> None:
        """Delete an own value; a bundled one of that key comes back.

        Raises
        ------
        FabricationError
            There is no own one of that key.
        """
        path = self._own_file(key)
        try:
            path.unlink()
        except FileNotFoundError:
            if key in self.bundled():
                raise FabricationError(self.codes["bundled"], key=key) from None
            own = ", ".join(sorted(self.contents().own))
            if not own:
                raise FabricationError(self.codes["none_own"], key=key) from None
            raise FabricationError(self.codes["not_own"], key=key, own=own) from None
        except OSError as error:
            reason = error.strerror or str(error)
            raise FabricationError(self.codes["not_deleted"], path=path, reason=reason) from error

    def typed(self, changes: Mapping[str, object]) -> dict[str, Any]:
        """Changes by the names of fields, text read as the fields' types.

        Raises
        ------
        FabricationError
            No such field, or a text that is no number.
        """
        kinds = {one.name: str(one.type).partition(" ")[0] for one in fields(self.kind) if one.name not in self.judged}
        for name in changes:
            if name not in kinds:
                raise FabricationError(self.codes["no_entry"], name=name, known=", ".join(kinds))
        return {name: _typed(name, kinds[name], value) for name, value in changes.items()}

    def _own_file(self, key: str) -> Path:
        folder = self.own_folder()
        if folder.resolve() == resource(self.folder).resolve():
            raise FabricationError(self.codes["folder_bundled"], folder=folder)
        return folder / f"{self.check_key(key)}.toml"


@cache
def _bundled(shelf: Shelf[Any]) -> Mapping[str, Any]:
    """The bundled ones; they come with the program, so one reading is enough."""
    found = {path.stem: shelf.read(path) for path in sorted(resource(shelf.folder).glob("*.toml"))}
    return MappingProxyType(dict(sorted(found.items(), key=lambda item: (item[0] != shelf.first, item[0]))))


def _typed(name: str, kind: str, value: object) -> object:
    """A value as typed on a command line, as float, int or text."""
    if not isinstance(value, str) or kind not in ("int", "float"):
        return value
    try:
        return int(value) if kind == "int" else float(value)
    except ValueError:
        code = "material.not_a_whole_number" if kind == "int" else "material.not_a_number"
        raise FabricationError(code, name=name, value=value) from None
