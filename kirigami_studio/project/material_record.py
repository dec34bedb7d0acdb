"""A person's own material travels with the project: its numbers, for a machine on which nobody has it in stock."""

from __future__ import annotations

from dataclasses import asdict, fields, replace
from typing import Any

from kirigami_studio.fabricate.material import Material, find_material, library
from kirigami_studio.project.document import Document
from kirigami_studio.project.json_record import Record
from kirigami_studio.project.settings import FabricationSettings


def material_for(settings: FabricationSettings) -> Material:
    """The material that the settings name: from stock, else as the project carries it.

    Raises
    ------
    FabricationError
        Neither knows it; the sentence lists what is in stock.
    """
    carried = carried_material(settings)
    if carried is not None and carried.key not in library().materials:
        return carried
    return find_material(settings.material)


def carried_material(settings: FabricationSettings) -> Material | None:
    """What the project itself knows of the material that it is cut from; None for bundled ones."""
    return settings.own if settings.own is not None and settings.own.key == settings.material else None


def with_material(document: Document) -> Document:
    """The document as it is stored: with the numbers of its material, if that is a person's own."""
    settings, stock = document.fabrication, library()
    numbers = carried_material(settings)
    if settings.material in stock.materials:
        numbers = stock.materials[settings.material] if settings.material in stock.own else None
    if numbers == settings.own:
        return document
    return replace(document, fabrication=replace(settings, own=numbers))


def material_json(material: Material) -> dict[str, object]:
    """What a project file says of an own material."""
    return asdict(material)


def material_of(record: Record) -> Material:
    """Rebuild the material.

    Raises
    ------
    KirigamiError
        An entry is missing, or holds what no material can hold.
    """
    read = {"str": record.text, "float": record.number, "int": record.whole, "bool": record.flag}
    values: dict[str, Any] = {entry.name: read[str(entry.type)](entry.name) for entry in fields(Material)}
    return Material(**values)
