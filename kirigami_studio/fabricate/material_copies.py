"""Own materials: copies of presets, saved beside them, changed, calibrated and deleted; presets stay as they are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from datetime import date
from typing import Any

from kirigami_studio.fabricate.machine import Machine, material_on
from kirigami_studio.fabricate.material import SHELF, Construction, Material, find_material, with_entries_of_now
from kirigami_studio.foundation.errors import FabricationError


def changed_copy(source: str, key: str, changes: Mapping[str, object], machine: Machine | None = None) -> Material:
    """An uncalibrated copy of a material under a new key (or the same) with some entries changed; not saved yet.

    Parameters
    ----------
    source : str
        Key or name of the material to copy.
    key : str
    changes : mapping of field name to value
        Text is read as the field's type.
    machine : Machine, optional
        Whose kind the copy gets its figures for; those that the material has by itself unless given.

    Raises
    ------
    FabricationError
        No such material or field, or a value that makes no sense.
    """
    original = find_material(source)
    original = original if machine is None else material_on(original, machine)
    values = SHELF.typed(with_entries_of_now(changes))
    if key != original.key and "name" not in values:
        values["name"] = f"{original.name} ({key})"
    clean: dict[str, Any] = {"calibrated": False, "measured_on": "", "measured_by": ""}
    if any(not isinstance(value, str) for value in values.values()):
        # What was known of the original is not known of other numbers.
        clean |= {"connectors_hold": True, "construction": Construction.ONE_SHEET}
        clean["sources"] = {name: text for name, text in original.sources.items() if name not in values}
    return replace(original, key=SHELF.check_key(key), **(clean | values))


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
    SHELF.save(measured)
    return measured
