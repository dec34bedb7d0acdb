"""Both layers of a backed sheet: which material is the board, and how each is cut."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from kirigami_studio.fabricate.fastener import SIZES
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.fabricate.machine import cuttable
from kirigami_studio.fabricate.material import Construction, Material, find_material
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.foundation.words import tr
from kirigami_studio.settings.fabrication import FabricationSettings, construction_for, material_for, named_machine

#: The other material where none is named, the first that the machine cuts: of a board, and of a hinge layer.
HINGE_LAYERS = ("cotton-co2", "ripstop-co2", "tape-knife")
BOARDS = ("card-05-co2", "card-co2")
#: From this stiffness (see :func:`stiffness`) a material is a board by itself: card of 0.3 mm has 0.27, felt of 2 mm
#: 0.04, paper of 0.17 mm 0.09.
STIFF = 0.2
#: Tabs that hold a hinge layer in its frame while tiles are glued on, unless others are asked for.
TABS = 4


def is_backed(settings: FabricationSettings) -> bool:
    """Whether the sheet is made of tiles on a hinge layer."""
    try:
        return construction_for(settings) is Construction.BACKED
    except FabricationError:
        return False


def stiffness(material: Material) -> float:
    """Geometric mean of stiffness in tension, E h, and in bending, E h^3: GPa mm^2."""
    return material.young_gpa * material.thickness_mm**2


def layers_of(settings: FabricationSettings) -> tuple[Material, Material]:
    """The hinge layer and the board of a backed sheet.

    Of two materials the one that is meant as a hinge layer is it, else the softer one.  Of a single one its own place
    is known: a board is stiff, or works on pins or as tiles only.

    Raises
    ------
    FabricationError
        No such material.
    """
    return layers_with(material_for(settings), settings)


def layers_with(one: Material, settings: FabricationSettings) -> tuple[Material, Material]:
    """Return the same for a material that is known, whatever the settings name."""
    if settings.second_material:
        other = find_material(settings.second_material)
        if other.key != one.key:
            if one.backing != other.backing:
                return (one, other) if one.backing else (other, one)
            return (one, other) if stiffness(one) < stiffness(other) else (other, one)
    alone = Construction.ONE_SHEET, Construction.PRINTED
    if one.backing or (one.construction in alone and stiffness(one) < STIFF):
        return one, _first_that_is_cut(settings, BOARDS)
    return _first_that_is_cut(settings, HINGE_LAYERS), one


def _first_that_is_cut(settings: FabricationSettings, keys: Sequence[str]) -> Material:
    machine = named_machine(settings)
    known = {} if machine is None else cuttable(machine)
    return find_material(next((key for key in keys if key in known), keys[0]))


def hinge_layer(settings: FabricationSettings) -> FabricationSettings:
    """Settings of the sheet with connectors: of a backed sheet, its hinge layer.

    It is one sheet, and hangs on tabs in what is left over round it.

    Raises
    ------
    FabricationError
        No such material.
    """
    if not is_backed(settings):
        return settings
    hinge, board = layers_of(settings)
    options = replace(settings.options, copies=1, tabs=settings.options.tabs or TABS)
    return replace(_of_layer(settings, hinge, board), options=options, engrave=False)


def board_layer(settings: FabricationSettings) -> FabricationSettings:
    """How the board of a backed sheet is cut.

    Raises
    ------
    FabricationError
        No such material.
    """
    return _of_layer(settings, *reversed(layers_of(settings)))


def _of_layer(settings: FabricationSettings, material: Material, other: Material) -> FabricationSettings:
    """Settings of one layer; chosen kerf and machine hold for their own material."""
    found = replace(
        settings, construction=Construction.BACKED, material=material.key, second_material=other.key, opened_mm=None
    )
    machine = named_machine(settings)
    if machine is not None and material.key != settings.material and material.key not in cuttable(machine):
        found = replace(found, machine="")
    return found if material.key == settings.material else replace(found, kerf_mm=None)


def sheet_material(settings: FabricationSettings) -> Material:
    """The material of the sheet with the connectors.

    Raises
    ------
    FabricationError
        No such material.
    """
    return material_for(hinge_layer(settings))


def note_before_run(settings: FabricationSettings) -> Note | None:
    """Return a note on the construction, or on the limits of one sheet, or None.

    Raises
    ------
    FabricationError
        No such material.
    """
    return note_on(material_for(settings), settings)


def note_on(material: Material, settings: FabricationSettings) -> Note | None:
    """Return the same note for a material that is known, whatever the settings name."""
    construction = settings.construction or material.construction
    if construction is Construction.PRINTED:
        return Note.of("construction.printed", material=tr(material.name))
    if construction is Construction.PINNED:
        fastener = tr(SIZES[settings.fastener].name)
        return Note.of("construction.pinned", material=tr(material.name), fastener=fastener)
    if construction is Construction.BACKED:
        try:
            hinge, board = layers_with(material, settings)
        except FabricationError:  # the other material is gone, which planning tells
            return None
        return Note.of("construction.backed", hinge=tr(hinge.name), board=tr(board.name))
    return material.limits_note
