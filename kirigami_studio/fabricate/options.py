"""Choices about the cuts beyond their widths: connector style, order, tabs, single hinges."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from itertools import pairwise

from kirigami_studio.fabricate.cut_path import check_length
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.foundation.settings import Choice, Setting, SpecialValue, check
from kirigami_studio.foundation.words import mark

#: Finished width (mm) of a tab unless given: common for thin sheet.
TAB_MM = 0.5
#: More tabs than this on one outline are a typing error.
MOST_TABS = 200
#: In place of a number of copies.
AS_MANY_AS_FIT = 0
#: More copies than this in one file are a typing error.
MOST_COPIES = 200
#: Distance (mm) between copies unless given.
COPY_GAP_MM = 5.0


class ConnectorStyle(StrEnum):
    """Ends of slits before their hinge; the values stand on the command line and in files."""

    CENTRED = "centred"
    STRAIGHT = "straight"
    ROUND = "round"
    TEARDROP = "teardrop"
    ARC = "arc"
    DOUBLE = "double"


class CutOrder(StrEnum):
    """Order of the slits; its values stand on the command line and in files."""

    SHORTEST = "shortest"
    ROWS = "rows"
    INSIDE_OUT = "inside-out"
    SPREAD = "spread"


class BoardCut(StrEnum):
    """How the tiles of backed sheets are cut; the values stand on the command line and in files."""

    KISS = "kiss"  #: through the board, not its liner: tiles stay in place, what is between them is weeded
    THROUGH = "through"  #: all through: tape over the board keeps tiles in place


@dataclass(frozen=True, slots=True)
class CutOptions:
    """Choices about the cuts.

    Attributes
    ----------
    style : ConnectorStyle
        How slits end at their connectors.
    order : CutOrder
        Order of the slits.
    tabs : int
        Uncut places of the outline that hold the sheet until it is taken out; 0 for none.
    tab_mm : float
        Finished width of a tab.
    hinge_mm : tuple of (hinge, width)
        Finished widths of single connectors, numbered as in ``slits.CutTable``, in ascending order of the hinges.
    removed : tuple of int
        Hinges without a connector, in ascending order: their slits are cut through.
    copies : int
        Of the sheet in one file, in rows; 0 for as many as fit on the bed.
    copy_gap_mm : float
        Between the cuts of neighbouring copies.

    Raises
    ------
    FabricationError
        With the number that does not fit.
    """

    style: ConnectorStyle = field(
        default=ConnectorStyle.CENTRED,
        metadata=Setting(
            help="how slits end at their connectors",
            code="settings.no_such_choice",
            always_written=True,
            undo=mark("Change the connector style"),
            label=mark("Connector st&yle"),
            spoken=mark("Connector style"),
            widget="connectorStyle",
            choices=(
                Choice(
                    ConnectorStyle.CENTRED,
                    mark("Centred"),
                    mark("The cut that a slit ends on makes way, so that the connector turns exactly on its corner."),
                ),
                Choice(ConnectorStyle.STRAIGHT, mark("Straight"), mark("The slit ends in a plain tip.")),
                Choice(ConnectorStyle.ROUND, mark("Round"), mark("A round hole at the slit's end relieves stress.")),
                Choice(
                    ConnectorStyle.TEARDROP,
                    mark("Teardrop"),
                    mark("A drop-shaped hole at the slit's end: rounded, with no step."),
                ),
                Choice(
                    ConnectorStyle.ARC, mark("Arc"), mark("A short arc across the slit's end guides the connector.")
                ),
                Choice(
                    ConnectorStyle.DOUBLE,
                    mark("Double"),
                    mark("Two narrow connectors side by side that twist like a hinge."),
                ),
            ),
            option="--style",
        ).metadata,
    )
    order: CutOrder = field(
        default=CutOrder.SHORTEST,
        metadata=Setting(
            help="cutting order",
            code="settings.no_such_choice",
            always_written=True,
            undo=mark("Change the cutting order"),
            label=mark("&Order"),
            spoken=mark("Cutting order"),
            widget="cutOrder",
            choices=(
                Choice(CutOrder.SHORTEST, mark("Shortest way"), mark("The shortest travel found.")),
                Choice(CutOrder.ROWS, mark("Row by row"), mark("Rows from one side to the other.")),
                Choice(
                    CutOrder.INSIDE_OUT,
                    mark("Inside out"),
                    mark("From the middle outwards; keeps the sheet flat longest."),
                ),
                Choice(CutOrder.SPREAD, mark("Spread"), mark("Successive cuts far apart, to spread the heat.")),
            ),
            option="--order",
        ).metadata,
    )
    tabs: int = field(
        default=0,
        metadata=Setting(
            about=mark("Uncut bridges in the outline that hold the sheet until you remove it (0 to {most})."),
            help="number of uncut places in the outline that hold the sheet",
            least=0,
            most=MOST_TABS,
            code="tabs.too_many",
            error=FabricationError,
            always_written=True,
            undo=mark("Change the number of tabs"),
            label=mark("&Tabs"),
            spoken=mark("Number of tabs"),
            special=SpecialValue(0, "", mark("Off")),
            option="--tabs",
        ).metadata,
    )
    tab_mm: float = field(
        default=TAB_MM,
        metadata=Setting(
            about=mark("Finished width of a tab, mm (0.05 to 20)."),
            help="finished width of a tab",
            least=0.0,
            above_least=True,
            code="tabs.width_not_positive",
            error=FabricationError,
            always_written=True,
            undo=mark("Change the tab width"),
            label=mark("Tab, mm"),
            spoken=mark("Tab width in millimetres"),
            widget="tabWidth",
            low=0.05,
            high=20.0,
            step=0.1,
            unit="mm",
            option="--tab-mm",
        ).metadata,
    )
    hinge_mm: tuple[tuple[int, float], ...] = ()
    removed: tuple[int, ...] = ()
    copies: int = field(
        default=1,
        metadata=Setting(
            about=mark(
                "Copies of the sheet in one file, in rows (1 to {most}); below 1: as many as fit on the machine's bed."
            ),
            help="copies of the sheet in one file, in rows; fit: as many as fit on the machine's bed",
            least=AS_MANY_AS_FIT,
            most=MOST_COPIES,
            code="copies.number",
            error=FabricationError,
            undo=mark("Change the number of copies"),
            label=mark("Copies"),
            spoken=mark("Number of copies"),
            special=SpecialValue(AS_MANY_AS_FIT, "fit", mark("Fit bed")),
            option="--copies",
            metavar="N|fit",
        ).metadata,
    )
    copy_gap_mm: float = field(
        default=COPY_GAP_MM,
        metadata=Setting(
            about=mark("Gap between the cuts of neighbouring copies, mm (0.1 to 500)."),
            help="gap between copies",
            least=0.0,
            above_least=True,
            code="copies.gap_not_positive",
            error=FabricationError,
            undo=mark("Change the gap between copies"),
            label=mark("Gap, mm"),
            spoken=mark("Gap between copies in millimetres"),
            widget="copyGap",
            low=0.1,
            high=500.0,
            decimals=1,
            unit="mm",
            option="--copy-gap-mm",
        ).metadata,
    )

    def __post_init__(self) -> None:
        check(self)
        hinges = [hinge for hinge, _ in self.hinge_mm]
        if not (_ascending(hinges) and _ascending(self.removed)):
            raise FabricationError("hinge.named_twice")
        for hinge, width in self.hinge_mm:
            check_length("hinge.width_not_positive", width, hinge=hinge)
        if both := set(hinges) & set(self.removed):
            raise FabricationError("hinge.width_and_removed", hinge=min(both))

    def without(self, hinges: Collection[int]) -> CutOptions:
        """The same without choices for these connectors."""
        widths = tuple(pair for pair in self.hinge_mm if pair[0] not in hinges)
        return replace(self, hinge_mm=widths, removed=tuple(one for one in self.removed if one not in hinges))

    def cut_through(self, hinges: Collection[int]) -> CutOptions:
        """The same with these connectors removed, whatever width was asked for them."""
        return replace(self.without(hinges), removed=tuple(sorted({*self.removed, *hinges})))


def _ascending(numbers: Sequence[int]) -> bool:
    return all(number >= 0 for number in numbers) and all(a < b for a, b in pairwise(numbers))


#: Plain slits between connectors of one width.
STRAIGHT = CutOptions(ConnectorStyle.STRAIGHT)
