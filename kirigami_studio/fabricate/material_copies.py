"""Own materials: copies of presets, saved beside them, changed, calibrated and deleted; presets stay as they are."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import fields, replace
from datetime import date
from pathlib import Path
from typing import Any

import tomli_w

from kirigami_studio.fabricate.material import (
    OLD_LIMIT,
    Construction,
    Material,
    find_material,
    library,
    own_folder,
    presets,
    strains_of_old,
)
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.foundation.resources import resource

#: Keys are file names on every platform: lower case, so that no two differ by capitals only.
KEY = re.compile(r"[a-z0-9][a-z0-9_-]{0,39}")
#: Entries that are no numbers or words of the user's own.
JUDGED = frozenset({"key", "calibrated", "connectors_hold", "construction", "backing", "style", "sources"})
#: Files of these names cannot exist on Windows.
RESERVED = frozenset({"con", "prn", "aux", "nul", *(f"{port}{n}" for port in ("com", "lpt") for n in range(10))})


def check_key(key: str) -> str:
    """Return a key that can be a file's name, or refuse it.

    Raises
    ------
    FabricationError
        Empty, too long, with other characters than a-z, 0-9, - and _, or reserved by a platform.
    """
    if not isinstance(key, str) or KEY.fullmatch(key) is None or key in RESERVED:
        raise FabricationError("material.key_not_usable", key=key)
    return key


def save_copy(material: Material) -> Path:
    """Save an own material under its key; one of the same key is replaced, a preset of that key stays and is hidden.

    Raises
    ------
    FabricationError
        A key that cannot be a file's name, or the folder of the presets.
    ExportError
        The file cannot be written.
    """
    path = _own_file(material.key)
    write_atomically(path, tomli_w.dumps(material.entries).encode("utf-8"))
    return path


def delete_copy(key: str) -> None:
    """Delete an own material; a preset of that key comes back.

    Raises
    ------
    FabricationError
        There is no own material of that key.
    """
    path = _own_file(key)
    try:
        path.unlink()
    except FileNotFoundError:
        if key in presets():
            raise FabricationError("material.bundled_not_deleted", key=key) from None
        own = ", ".join(sorted(library().own))
        if not own:
            raise FabricationError("material.none_own", key=key) from None
        raise FabricationError("material.not_own", key=key, own=own) from None
    except OSError as error:
        raise FabricationError("material.not_deleted", path=path, reason=error.strerror or str(error)) from error


def changed_copy(source: str, key: str, changes: Mapping[str, object]) -> Material:
    """An uncalibrated copy of a material under a new key (or the same) with some entries changed; not saved yet.

    Parameters
    ----------
    source : str
        Key or name of the material to copy.
    key : str
    changes : mapping of field name to value
        Text is read as the field's type.

    Raises
    ------
    FabricationError
        No such material or field, or a value that makes no sense.
    """
    original = find_material(source)
    kinds = {field.name: str(field.type) for field in fields(Material) if field.name not in JUDGED}
    if OLD_LIMIT in changes:  # as scripts call it that were written before bending and tension were told apart
        limit = _typed(OLD_LIMIT, "float", changes[OLD_LIMIT])
        changes = {**{name: limit for name in strains_of_old(0.0)}, **changes}
        del changes[OLD_LIMIT]
    for name in changes:
        if name not in kinds:
            raise FabricationError("material.no_such_entry", name=name, known=", ".join(kinds))
    values = {name: _typed(name, kinds[name], value) for name, value in changes.items()}
    if key != original.key and "name" not in values:
        values["name"] = f"{original.name} ({key})"
    clean: dict[str, Any] = {"calibrated": False, "measured_on": "", "measured_by": ""}
    if any(kinds[name] != "str" for name in changes):
        # What was known of the original is not known of other numbers.
        clean |= {"connectors_hold": True, "construction": Construction.ONE_SHEET}
    clean["sources"] = tuple(pair for pair in original.sources if pair[0] not in changes)
    return replace(original, key=check_key(key), **(clean | values))


def mark_calibrated(
    material: Material,
    on: date,
    by: str,
    kerf_mm: float | None = None,
    min_ligament_mm: float | None = None,
) -> Material:
    """Save and return an own copy that counts as calibrated.

    Parameters
    ----------
    material : Material
    on : date
        Day of the measurement.
    by : str
        Who measured.
    kerf_mm, min_ligament_mm : float, optional
        As measured on the coupon; the material's own unless given.

    Raises
    ------
    FabricationError
        A value that makes no sense, or nobody's name.
    """
    if not by.strip():
        raise FabricationError("material.no_author")
    measured = replace(
        material,
        calibrated=True,
        measured_on=on.isoformat(),
        measured_by=by.strip(),
        kerf_mm=material.kerf_mm if kerf_mm is None else kerf_mm,
        min_ligament_mm=material.min_ligament_mm if min_ligament_mm is None else min_ligament_mm,
    )
    save_copy(measured)
    return measured


def _typed(name: str, kind: str, value: object) -> object:
    """A value as typed on a command line, as float, int or text."""
    if not isinstance(value, str) or kind == "str":
        return value
    try:
        return int(value) if kind == "int" else float(value)
    except ValueError:
        code = "material.not_a_whole_number" if kind == "int" else "material.not_a_number"
        raise FabricationError(code, name=name, value=value) from None


def _own_file(key: str) -> Path:
    folder = own_folder()
    if folder.resolve() == resource("materials").resolve():
        raise FabricationError("material.folder_is_bundled", folder=folder)
    return folder / f"{check_key(key)}.toml"
