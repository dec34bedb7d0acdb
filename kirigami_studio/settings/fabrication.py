"""Settings of a cut: sheet, material, machine and files, beside the ``CutOptions``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal, TypeAlias, TypedDict

from kirigami_studio.export.paper import Paper
from kirigami_studio.export.profile import DxfVersion, find_profile
from kirigami_studio.fabricate.drive import DriveKind
from kirigami_studio.fabricate.fastener import (
    CLEARANCE_MM,
    LEAST_WALL_MM,
    NECK_IN_THICKNESSES,
    SIZES,
    Fastener,
    PrintedPins,
)
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.fabricate.hold import LEAST_WALL_MM as LEAST_HOLD_WALL_MM
from kirigami_studio.fabricate.hold import MOST_WALL_MM, HoldKind, HoldOptions, HoldWhen
from kirigami_studio.fabricate.machine import (
    Machine,
    MachineKind,
    cuttable,
    find_machine,
    machine_of,
    machines,
    material_on,
    usual_material,
)
from kirigami_studio.fabricate.material import (
    DEFAULT_PRESET,
    PRINTED_PRESET,
    Construction,
    Material,
    default_material,
    find_material,
    library,
)
from kirigami_studio.fabricate.options import BoardCut, ConnectorStyle, CutOptions, CutOrder
from kirigami_studio.foundation.errors import ExportError, FabricationError, UsageError
from kirigami_studio.foundation.settings import Choice, Setting, check, settings_of
from kirigami_studio.foundation.words import mark

LARGEST_SHEET_MM = 10_000.0


def _millimetres(about: str, label: str, undo: str, option: str, low: float, high: float) -> Mapping[str, Setting]:
    """Describe a length of a construction."""
    setting = Setting(
        about=about,
        label=label,
        option=option,
        low=low,
        high=high,
        least=low,
        most=high,
        code="settings.length_out_of_range",
        undo=undo,
        step=0.1,
        unit="mm",
    )
    return setting.metadata


@dataclass(frozen=True, slots=True)
class FabricationSettings:
    """How the chosen design is cut.

    Attributes
    ----------
    width_mm : float, > 0
        Width of the flat sheet.
    material : str
        Key of a material preset.
    machine : str
        Key of the machine that cuts it; "" for the one that the material is for.
    construction : Construction or None
        Way of making the sheet; None takes the one that suits the material.
    fastener : Fastener
        Pins of pinned sheets.
    pin_mm, ear_mm : float or None
        Diameters of the hole for a pin, or of a printed pin's neck, and of the ear round it; None takes those of the
        fastener, or the usual ones of printed pins.
    clearance_mm : float or None
        Between ears and pieces that pass each other in one layer, and between printed parts that turn; None takes that
        of the construction: 0.6 and 0.3 mm.
    gap_mm : float
        By which the tiles of backed sheets are smaller than their panels, all round.
    second_material : str
        Key of the other sheet of backed designs: hinge layer or board; "" for the one that suits the material.
    board_cut : BoardCut
        How their tiles are cut.
    held_by : HoldKind
        What keeps the sheet in an end state.
    held_when : HoldWhen
        In which.
    magnet_mm, magnet_height_mm : float
        Diameter and height of magnets that hold it.
    moved_by : DriveKind
        What turns a pinned sheet from behind.
    connector_mm : float or None
        Finished width of a connector; None takes the material's own.
    kerf_mm : float or None
        Width of the cut; None takes the material's own.
    options : CutOptions
    profile : str
        Key of the machine profile that cut files are written for.
    dxf_version : DxfVersion
        DXF dialect of cut files.
    paper : Paper
        Pages that PDFs are spread over.
    markers : bool
        Whether LightBurn projects mark the connectors, on a layer that LightBurn does not cut.
    engrave : bool
        Whether the design's name is engraved on the sheet.
    opened_mm : float or None
        Longer side of the opened shape, which ``width_mm`` follows; None where the width itself was asked for.
    own, own_machine : Material or Machine or None
        The numbers of ``material`` and ``machine`` where these are the user's own and not bundled.  No choices, so they
        take no part in comparisons.

    Raises
    ------
    UsageError
        With the number that does not fit.
    """

    width_mm: float = field(
        default=100.0,
        metadata=Setting(
            about=mark(
                "Width of the flat sheet, mm (5 to 3000). It follows the opened size; a width typed here stays."
            ),
            help="width of the flat sheet",
            least=0.0,
            above_least=True,
            most=LARGEST_SHEET_MM,
            code="settings.sheet_width",
            always_written=True,
            undo=mark("Change the sheet width"),
            label=mark("Flat &width, mm"),
            spoken=mark("Width of the flat sheet in millimetres"),
            low=5.0,
            high=3000.0,
            step=5.0,
            decimals=1,
            unit="mm",
            option="--width-mm",
        ).metadata,
    )
    machine: str = field(
        default="",
        metadata=Setting(
            help="machine, see 'kirigami-studio machines'; brings its profile, and a material that it cuts "
            "(default: the one that the material is for)",
            may_be_empty=True,
            code="settings.machine_not_a_name",
            undo=mark("Change the machine"),
            spoken=mark("Machine"),
            option="--machine",
        ).metadata,
    )
    material: str = field(
        default=DEFAULT_PRESET,
        metadata=Setting(
            help="material, see 'kirigami-studio materials'",
            code="settings.material_not_a_name",
            always_written=True,
            undo=mark("Change the material"),
            spoken=mark("Material preset"),
            option="--material",
        ).metadata,
    )
    construction: Construction | None = field(
        default=None,
        metadata=Setting(
            about=mark("How the sheet is made: out of one sheet, or of rigid pieces."),
            help="how the sheet is made (default: as suits the material)",
            code="settings.no_such_choice",
            undo=mark("Change the construction"),
            label=mark("Construction"),
            choices=(
                Choice(None, mark("As suits the material"), mark("The construction that works in the material.")),
                Choice(
                    Construction.ONE_SHEET,
                    mark("One sheet"),
                    mark("Narrow connectors of the sheet itself bend where panels turn."),
                ),
                Choice(
                    Construction.PINNED,
                    mark("Two layers on pins"),
                    mark("Rigid pieces in two layers turn on screws, brads or rivets: for plywood, acrylic and card."),
                ),
                Choice(
                    Construction.BACKED,
                    mark("Tiles on a soft sheet"),
                    mark(
                        "Tiles of board are glued on a soft sheet, which has the cuts: for boards, cloth, tape, film."
                    ),
                ),
                Choice(
                    Construction.PRINTED,
                    mark("Printed on pins"),
                    mark("A 3D printer makes pieces and pins at once, without support: they turn as they come off."),
                ),
            ),
            option="--construction",
        ).metadata,
    )
    fastener: Fastener = field(
        default=Fastener.BRAD,
        metadata=Setting(
            about=mark("What the pieces of pinned sheets turn on."),
            help="pins of pinned sheets: sets hole, ear and parts list",
            code="settings.no_such_choice",
            undo=mark("Change the pins"),
            label=mark("Pins"),
            choices=(
                Choice(Fastener.BRAD, mark("Brads")),
                Choice(Fastener.M2, mark("M2 screws")),
                Choice(Fastener.M3, mark("M3 screws")),
                Choice(Fastener.EYELET, mark("Eyelets")),
                Choice(Fastener.RIVET, mark("Rivets")),
            ),
            option="--fastener",
        ).metadata,
    )
    pin_mm: float | None = field(
        default=None,
        metadata=_millimetres(
            mark("Diameter of the holes that pins turn in, mm."),
            mark("Pin hole, mm"),
            mark("Change the pin holes"),
            "--pin-mm",
            0.5,
            50.0,
        ),
    )
    ear_mm: float | None = field(
        default=None,
        metadata=_millimetres(
            mark("Diameter of the ear round each pin, mm; neighbouring pins keep further apart."),
            mark("Ear, mm"),
            mark("Change the ears"),
            "--ear-mm",
            1.0,
            200.0,
        ),
    )
    clearance_mm: float | None = field(
        default=None,
        metadata=_millimetres(
            mark("Room between pieces that pass each other, mm."),
            mark("Clearance, mm"),
            mark("Change the clearance"),
            "--clearance-mm",
            0.0,
            20.0,
        ),
    )
    gap_mm: float = field(
        default=1.0,
        metadata=_millimetres(
            mark("Tiles on a soft sheet are smaller than their panels by this much all round, mm."),
            mark("Tile gap, mm"),
            mark("Change the gap of the tiles"),
            "--gap-mm",
            0.0,
            20.0,
        ),
    )
    second_material: str = field(
        default="",
        metadata=Setting(
            about=mark("The other material of tiles on a soft sheet: the soft sheet for a board, or the board."),
            help="the other material of backed sheets: hinge layer of a board, or board (default: cotton, or card)",
            may_be_empty=True,
            code="settings.material_not_a_name",
            undo=mark("Change the second material"),
            label=mark("Second material"),
            spoken=mark("Second material"),
            option="--second-material",
        ).metadata,
    )
    board_cut: BoardCut = field(
        default=BoardCut.THROUGH,
        metadata=Setting(
            about=mark("How the tiles on a soft sheet are cut out of their board."),
            help="how tiles of backed sheets are cut",
            code="settings.no_such_choice",
            undo=mark("Change the cut of the tiles"),
            label=mark("Tiles"),
            choices=(
                Choice(BoardCut.THROUGH, mark("Cut through"), mark("Tape over the board keeps the tiles in place.")),
                Choice(
                    BoardCut.KISS, mark("Kiss cut"), mark("The board is cut, not its liner; the rest is weeded off.")
                ),
            ),
            option="--board-cut",
        ).metadata,
    )
    held_by: HoldKind = field(
        default=HoldKind.NONE,
        metadata=Setting(
            about=mark("What keeps the sheet open, or flat, where panels meet in that state alone."),
            help="what keeps the sheet in its end state: holes or marks where panels meet in that state alone",
            code="settings.no_such_choice",
            undo=mark("Change what holds the sheet"),
            label=mark("Held by"),
            choices=(
                Choice(HoldKind.NONE, mark("Nothing"), mark("The sheet stays as friction lets it.")),
                Choice(HoldKind.MAGNETS, mark("Magnets"), mark("Discs in round holes; a list tells their poles.")),
                Choice(HoldKind.EYELETS, mark("Eyelets"), mark("Holes for a spare pin, a ring or a cord.")),
                Choice(HoldKind.STITCHES, mark("Stitches"), mark("Two small holes on either side of an edge.")),
                Choice(HoldKind.TABS, mark("Adhesive tabs"), mark("Engraved marks where tape goes over an edge.")),
            ),
            option="--hold",
        ).metadata,
    )
    held_when: HoldWhen = field(
        default=HoldWhen.OPEN,
        metadata=Setting(
            about=mark("The state that magnets, eyelets, stitches or tabs keep."),
            help="the state that --hold keeps",
            code="settings.no_such_choice",
            undo=mark("Change when the sheet is held"),
            label=mark("Held when"),
            choices=(
                Choice(HoldWhen.OPEN, mark("Open"), mark("As the target.")),
                Choice(HoldWhen.FLAT, mark("Flat"), mark("As it is cut.")),
                Choice(HoldWhen.BOTH, mark("Open and flat"), mark("Places for either.")),
            ),
            option="--hold-when",
        ).metadata,
    )
    magnet_mm: float = field(
        default=5.0,
        metadata=_millimetres(
            mark("Diameter of the disc magnets, mm."),
            mark("Magnet, mm"),
            mark("Change the magnets"),
            "--magnet-mm",
            1.0,
            30.0,
        ),
    )
    magnet_height_mm: float = field(
        default=2.0,
        metadata=_millimetres(
            mark("Height of the disc magnets, mm."),
            mark("Magnet height, mm"),
            mark("Change the height of the magnets"),
            "--magnet-height-mm",
            0.5,
            20.0,
        ),
    )
    moved_by: DriveKind = field(
        default=DriveKind.NONE,
        metadata=Setting(
            about=mark("A board behind two layers on pins, with arms that open and close them."),
            help="a board behind two layers on pins, with arms that open and close them",
            code="settings.no_such_choice",
            undo=mark("Change the drive"),
            label=mark("Moved by"),
            choices=(
                Choice(DriveKind.NONE, mark("Hand"), mark("No board.")),
                Choice(DriveKind.CRANK, mark("Crank"), mark("A handle behind the board turns an arm.")),
                Choice(DriveKind.SERVO, mark("Servo"), mark("A small servo (SG90) in the board turns an arm.")),
            ),
            option="--drive",
        ).metadata,
    )
    connector_mm: float | None = field(
        default=None,
        metadata=Setting(
            about=mark("Finished width of the material left at each hinge, mm."),
            help="finished connector width (default: the material's)",
            least=0.0,
            above_least=True,
            most=LARGEST_SHEET_MM,
            code="settings.connector_width",
            always_written=True,
            undo=mark("Change the connector width"),
            label=mark("&Connector, mm"),
            spoken=mark("Connector in millimetres"),
            low=0.02,
            high=20.0,
            step=0.05,
            unit="mm",
            option="--connector-mm",
        ).metadata,
    )
    kerf_mm: float | None = field(
        default=None,
        metadata=Setting(
            about=mark("Full width of the cut, mm; slits are shortened to match. 0 for a blade."),
            help="full width of the cut (default: the material's)",
            least=0.0,
            most=LARGEST_SHEET_MM,
            code="settings.kerf_width",
            always_written=True,
            undo=mark("Change the kerf"),
            label=mark("&Kerf, mm"),
            spoken=mark("Kerf in millimetres"),
            high=5.0,
            step=0.01,
            decimals=3,
            unit="mm",
            option="--kerf-mm",
        ).metadata,
    )
    options: CutOptions = field(
        default_factory=CutOptions,
        metadata=Setting(undo=mark("Change the cut options")).metadata,
    )
    profile: str = field(
        default="any",
        metadata=Setting(
            about=mark("Machine profile: the colours and layers your machine's software expects in cut files."),
            help="machine profile: any, lightburn, k40, single, layers, slots, cricut, silhouette, glowforge or xtool",
            code="settings.profile_not_a_name",
            always_written=True,
            undo=mark("Change the machine profile"),
            label=mark("Machine profile"),
            widget="machineProfile",
            option="--profile",
        ).metadata,
    )
    dxf_version: DxfVersion = field(
        default=DxfVersion.R2010,
        metadata=Setting(
            help="DXF version",
            code="settings.dxf_version_not_a_name",
            always_written=True,
            undo=mark("Change the DXF version"),
            label=mark("D&XF version"),
            spoken=mark("DXF version"),
            widget="dxfVersion",
            choices=(
                Choice(DxfVersion.R2010, "R2010", mark("Recommended. Stores mm as the unit and uses light polylines.")),
                Choice(DxfVersion.R12, "R12", mark("For old software. Stores no unit: import as mm.")),
            ),
            option="--dxf-version",
        ).metadata,
    )
    paper: Paper = field(
        default=Paper.NONE,
        metadata=Setting(
            help="spread a PDF over pages of this size",
            code="settings.paper_not_a_name",
            undo=mark("Change the paper of PDFs"),
            label=mark("PDF pages"),
            choices=(
                Choice(Paper.NONE, mark("One page"), mark("As large as the sheet, for plotters and print shops.")),
                Choice(
                    Paper.A4,
                    mark("A4 pages"),
                    mark("Spread over A4 pages that overlap, with crosses to lay them over."),
                ),
                Choice(
                    Paper.LETTER,
                    mark("Letter pages"),
                    mark("Spread over Letter pages that overlap, with crosses to lay them over."),
                ),
            ),
            option="--paper",
        ).metadata,
    )
    markers: bool = field(
        default=False,
        metadata=Setting(
            about=mark("Mark connectors in LightBurn projects, on a tool layer: MeerK40t would engrave it."),
            help="mark the connectors in LightBurn projects, on a layer that LightBurn does not cut",
            code="settings.markers_not_true_or_false",
            undo=mark("Change the connector markers"),
            label=mark("Mark connectors"),
            option="--markers",
        ).metadata,
    )
    engrave: bool = field(
        default=False,
        metadata=Setting(
            about=mark(
                "Engrave the design's name on one panel, before the cuts and on a layer of its own. Times and lengths "
                "do not count it."
            ),
            help="engrave the design's name on one panel, on layer NAME and before the cuts",
            code="settings.engrave_not_true_or_false",
            undo=mark("Change the engraving of the name"),
            label=mark("Engrave the name"),
            widget="engraveName",
            option="--engrave",
        ).metadata,
    )
    opened_mm: float | None = field(
        default=None,
        metadata=Setting(
            least=0.0,
            above_least=True,
            most=LARGEST_SHEET_MM,
            code="settings.opened_size",
            undo=mark("Change the size of the opened shape"),
        ).metadata,
    )
    own: Material | None = field(default=None, compare=False)
    own_machine: Machine | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        check(self)


#: Connector styles by name.
StyleName: TypeAlias = Literal["centred", "straight", "round", "teardrop", "arc", "double"]


class SheetChange(TypedDict, total=False):
    """Types of values for a sheet and its files; choices may be given by their words."""

    width_mm: float
    material: str
    machine: str
    construction: Construction | Literal["one-sheet", "pinned", "backed", "printed"] | None
    fastener: Fastener | Literal["brad", "m2", "m3", "eyelet", "rivet"]
    pin_mm: float | None
    ear_mm: float | None
    clearance_mm: float | None
    gap_mm: float
    second_material: str
    board_cut: BoardCut | Literal["kiss", "through"]
    held_by: HoldKind | Literal["none", "magnets", "eyelets", "stitches", "tabs"]
    held_when: HoldWhen | Literal["open", "flat", "both"]
    magnet_mm: float
    magnet_height_mm: float
    moved_by: DriveKind | Literal["none", "crank", "servo"]
    connector_mm: float | None
    kerf_mm: float | None
    profile: str
    dxf_version: DxfVersion | Literal["R2010", "R12"]
    paper: Paper | Literal["none", "a4", "letter"]
    markers: bool
    engrave: bool


class FabricationChange(SheetChange, total=False):
    """Values for fields of :class:`FabricationSettings`."""

    opened_mm: float | None
    options: CutOptions


class OptionsChange(TypedDict, total=False):
    """Values for those fields of :class:`CutOptions` that hold for the whole sheet."""

    style: ConnectorStyle | StyleName
    order: CutOrder | Literal["shortest", "rows", "inside-out", "spread"]
    tabs: int
    tab_mm: float
    copies: int
    copy_gap_mm: float


class CutChange(SheetChange, OptionsChange, total=False):
    """Values for settings of a sheet, of its files and of all its cuts."""


def stored_material(settings: FabricationSettings) -> Material | None:
    """Return the material's numbers as the project stores them; None for bundled materials."""
    return settings.own if settings.own is not None and settings.own.key == settings.material else None


def stored_machine(settings: FabricationSettings) -> Machine | None:
    """Return the machine's numbers as the project stores them; None for bundled machines."""
    own = settings.own_machine
    return own if own is not None and own.key == settings.machine else None


def stored_values(settings: FabricationSettings) -> Iterator[tuple[Machine | Material, Machine | Material | None]]:
    """Numbers that the project stores, each with those of its key in the library, if any."""
    if (machine := stored_machine(settings)) is not None:
        yield machine, machines().items.get(machine.key)
    if (material := stored_material(settings)) is not None:
        yield material, library().items.get(material.key)


def unlike(stored: Machine | Material, used: Machine | Material | None) -> Note | None:
    """Word on a machine or material in the place of another; names and notes do not count."""
    if used is None or used == replace(stored, name=used.name, note=used.note):
        return None
    return Note.of("plan.machine_differs" if isinstance(used, Machine) else "plan.material_differs", name=used.name)


def material_for(settings: FabricationSettings) -> Material:
    """Return the material of the settings as their machine cuts it, from library or project.

    Raises
    ------
    FabricationError
        Neither has it; the sentence lists the library.
    """
    stored = stored_material(settings)
    own = stored is not None and stored.key not in library().items
    material = stored if stored is not None and own else find_material(settings.material)
    machine = named_machine(settings)
    return material if machine is None else material_on(material, machine)


def construction_for(settings: FabricationSettings) -> Construction:
    """Return the construction of the settings, or else the one that suits their material.

    Raises
    ------
    FabricationError
        No such material.
    """
    return settings.construction or material_for(settings).construction


def is_pinned(settings: FabricationSettings) -> bool:
    """Whether the sheet is made of pieces on pins; an unknown material is not, unless asked for."""
    return _is_made(settings, Construction.PINNED, Construction.PRINTED)


def is_printed(settings: FabricationSettings) -> bool:
    """Whether a printer makes pieces and pins at once."""
    return _is_made(settings, Construction.PRINTED)


def _is_made(settings: FabricationSettings, *ways: Construction) -> bool:
    try:
        return construction_for(settings) in ways
    except FabricationError:
        return False


@dataclass(frozen=True, slots=True)
class PinSizes:
    """Measures of pins and ears.

    Attributes
    ----------
    hole_mm, ear_mm : float
        Diameters; of a printed pin that of its neck.
    clearance_mm : float
        Between pieces that pass each other.
    head_mm : float
        Diameter of the widest part of the pin that is outside of its ears; 0 for printed ones.
    neck_mm : float
        Least width of a piece.
    margin_mm : float
        Distance of the pins at the rim from both outlines: all of their ears lies inside.  Printed pieces cannot fill
        it, for their neighbours pass there: their ears stick out.
    """

    hole_mm: float
    ear_mm: float
    clearance_mm: float
    head_mm: float
    neck_mm: float
    margin_mm: float

    @property
    def apart_mm(self) -> float:
        """Least distance of pins in the closed states.

        Two ears of neighbours, and their clearance, leave a neck between them then.  Fits keep as much between the
        notches in two sides of a panel.
        """
        return self.ear_mm + 2.0 * self.clearance_mm + self.neck_mm


def pin_sizes(settings: FabricationSettings) -> PinSizes:
    """Measures of the pins of the settings, those that are left open by their fastener.

    Raises
    ------
    UsageError
        An ear that is no wider than its hole.
    FabricationError
        No such material.
    """
    material = material_for(settings)
    if is_printed(settings):
        pins = printed_pins(settings)
        return PinSizes(pins.pin_mm, pins.ear_mm, pins.clearance_mm, 0.0, material.min_ligament_mm, 0.0)
    size = SIZES[settings.fastener]
    hole = settings.pin_mm if settings.pin_mm is not None else size.hole_mm
    ear = settings.ear_mm if settings.ear_mm is not None else hole + 2.0 * max(hole, LEAST_WALL_MM)
    neck = max(material.min_ligament_mm, NECK_IN_THICKNESSES * material.thickness_mm)
    if ear <= hole:
        raise UsageError("settings.ear_within_hole", ear_mm=ear, pin_mm=hole)
    clearance = CLEARANCE_MM if settings.clearance_mm is None else settings.clearance_mm
    return PinSizes(hole, ear, clearance, size.head_mm, neck, 0.5 * ear)


def printed_pins(settings: FabricationSettings) -> PrintedPins:
    """Sizes of pins that are printed with their pieces.

    Raises
    ------
    FabricationError
        Sizes that make no sense.
    """
    return PrintedPins.of(settings.pin_mm, settings.ear_mm, settings.clearance_mm)


def hold_options(settings: FabricationSettings) -> HoldOptions:
    """Parts that hold the sheet, with the wall that its material needs round holes.

    Raises
    ------
    FabricationError
        No such material.
    """
    wall = min(max(material_for(settings).min_ligament_mm, LEAST_HOLD_WALL_MM), MOST_WALL_MM)
    return HoldOptions(settings.held_by, settings.held_when, settings.magnet_mm, settings.magnet_height_mm, wall)


def pin_gap_mm(settings: FabricationSettings) -> float:
    """Return how far apart pins have to stay in the closed states; 0 unless the sheet is pinned.

    In mm of a lattice as wide as the sheet: the pieces' own is narrower by the margin on either side.

    Raises
    ------
    UsageError
        An ear that is no wider than its hole, or a sheet that has no room for the margin.
    """
    if not is_pinned(settings):
        return 0.0
    sizes = pin_sizes(settings)
    inside = settings.width_mm - 2.0 * sizes.margin_mm
    if inside <= sizes.ear_mm:
        raise UsageError("pins.sheet_too_narrow", width_mm=settings.width_mm, margin_mm=sizes.margin_mm)
    return sizes.apart_mm * settings.width_mm / inside


def named_machine(settings: FabricationSettings) -> Machine | None:
    """Return the machine of the settings, from library or project; None if there is none."""
    return machines().items.get(settings.machine, stored_machine(settings)) if settings.machine else None


def machine_for(settings: FabricationSettings) -> Machine:
    """Return the machine of the settings, or else the one that their material is for.

    Raises
    ------
    FabricationError
        No such material.
    """
    return named_machine(settings) or machine_of(material_for(settings))


def machine_changes(settings: FabricationSettings, machine: Machine) -> FabricationChange:
    """The changes that come with a machine: its profile and, if need be, another material."""
    changes: FabricationChange = {"machine": machine.key, "profile": machine.profile}
    if machine.kind is not machine_for(settings).kind:
        changes |= {"connector_mm": None, "kerf_mm": None}  # those of the material on the other machine
    taken = cuttable(machine)
    if taken and settings.material not in taken:
        changes["material"] = usual_material(machine, taken)
    return changes


def material_changes(settings: FabricationSettings, key: str) -> FabricationChange:
    """Changes that come with a material: connector and kerf; a usual size becomes its own."""
    changes: FabricationChange = {"material": key, "connector_mm": None, "kerf_mm": None}
    try:
        before, after = material_for(settings), material_for(replace(settings, material=key))
    except FabricationError:
        return changes
    if settings.opened_mm == before.sheet_mm:
        changes["opened_mm"] = after.sheet_mm
    elif settings.opened_mm is None and settings.width_mm == before.sheet_mm:
        changes["width_mm"] = after.sheet_mm
    return changes


def construction_changes(settings: FabricationSettings, given: Mapping[str, Any]) -> FabricationChange:
    """Changes that come with a construction: sheets are printed of what printers take."""
    if given.get("construction") != Construction.PRINTED or given.get("material") is not None:
        return {}
    try:
        if MachineKind.of(material_for(settings).machine) is MachineKind.PRINTER:
            return {}
    except FabricationError:
        pass
    machine = named_machine(settings)
    keeps = machine is None or machine.kind is MachineKind.PRINTER
    return material_changes(settings, PRINTED_PRESET) | ({} if keeps else {"machine": "", "profile": "any"})


def new_settings(given: Mapping[str, Any]) -> FabricationSettings:
    """Settings without a project: the given material, or one that the machine cuts.

    The sheet is as wide as is usual in it, unless the width is given.

    What is ``given`` is read, and refused, as :func:`with_choices` does.
    """
    usual = FabricationSettings(material=default_material().key)
    if given.get("machine") is not None and given.get("material") is None:
        changes = machine_changes(usual, find_machine(given["machine"]))
        usual = replace(usual, material=changes.get("material", usual.material))
    if given.get("construction") == Construction.PRINTED and given.get("material") is None:
        usual = replace(usual, material=PRINTED_PRESET)
    material = material_for(with_choices(usual, given))
    own_style = replace(usual.options, style=material.style)
    return with_choices(replace(usual, width_mm=material.sheet_mm, options=own_style), given)


def with_choices(saved: FabricationSettings, given: Mapping[str, Any]) -> FabricationSettings:
    """The settings of a project with what the command line or a script asks for on top.

    Parameters
    ----------
    given : mapping of str to object
        Settings of the sheet and of its cuts by name, material, machine and profile as :func:`find_material`,
        :func:`find_machine` and :func:`find_profile` read them; widths of single connectors, ``hinge_mm`` (pairs of
        number and width), and those to be ``removed`` are added to the project's own.  Others are left alone.

    Raises
    ------
    UsageError
        A value that its setting does not take, or no such profile.
    FabricationError
        No such material or machine.
    """
    named = {name: given[name] for name in settings_of(FabricationSettings) if name in given and name != "options"}
    changes: dict[str, Any] = {**construction_changes(saved, named), **named}
    if "material" in given:
        changes["material"] = find_material(given["material"]).key
    if given.get("second_material"):
        changes["second_material"] = find_material(given["second_material"]).key
    if given.get("machine"):
        machine = find_machine(given["machine"])
        changes["machine"] = machine.key
        changes.setdefault("profile", machine.profile)
    try:
        if "profile" in given:
            changes["profile"] = find_profile(given["profile"]).key
        return replace(saved, **changes, options=_cut_options(saved.options, given))
    except (FabricationError, ExportError) as error:
        raise UsageError(error.code, **error.fields) from error


def _cut_options(saved: CutOptions, given: Mapping[str, Any]) -> CutOptions:
    """The project's choices about the cuts with others on top."""
    changes = {name: given[name] for name in settings_of(CutOptions) if name in given}
    widths = sorted(given.get("hinge_mm", ()))
    removed = sorted(given.get("removed", ()))
    CutOptions(hinge_mm=tuple(widths), removed=tuple(removed))  # refuses what contradicts itself
    named = {hinge for hinge, _ in widths} | set(removed)
    return replace(
        saved,
        **changes,
        hinge_mm=tuple(sorted([*(pair for pair in saved.hinge_mm if pair[0] not in named), *widths])),
        removed=tuple(sorted([*(hinge for hinge in saved.removed if hinge not in named), *removed])),
    )
