"""What a person may choose about the cuts beyond their widths: connector style, order, tabs, single hinges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import pairwise

from kirigami_studio.fabricate.cut_path import check_length
from kirigami_studio.foundation.errors import FabricationError

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


class ConnectorStyle(Enum):
    """How a slit ends before its hinge; the values are the names on the command line and in files."""

    CENTRED = "centred"
    STRAIGHT = "straight"
    ROUND = "round"
    TEARDROP = "teardrop"
    ARC = "arc"
    DOUBLE = "double"


class CutOrder(Enum):
    """In which order the slits are cut; the values are the names on the command line and in files."""

    SHORTEST = "shortest"
    ROWS = "rows"
    INSIDE_OUT = "inside-out"
    SPREAD = "spread"


@dataclass(frozen=True, slots=True)
class CutOptions:
    """Choices about the cuts.

    Attributes
    ----------
    style : ConnectorStyle
    order : CutOrder
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

    style: ConnectorStyle = ConnectorStyle.STRAIGHT
    order: CutOrder = CutOrder.SHORTEST
    tabs: int = 0
    tab_mm: float = TAB_MM
    hinge_mm: tuple[tuple[int, float], ...] = ()
    removed: tuple[int, ...] = ()
    copies: int = 1
    copy_gap_mm: float = COPY_GAP_MM

    def __post_init__(self) -> None:
        if not 0 <= self.tabs <= MOST_TABS:
            raise FabricationError("tabs.too_many", most=MOST_TABS, tabs=self.tabs)
        check_length("tabs.width_not_positive", self.tab_mm)
        if isinstance(self.copies, bool) or not isinstance(self.copies, int) or not 0 <= self.copies <= MOST_COPIES:
            raise FabricationError("copies.number", most=MOST_COPIES, copies=self.copies)
        check_length("copies.gap_not_positive", self.copy_gap_mm)
        hinges = [hinge for hinge, _ in self.hinge_mm]
        if not (_ascending(hinges) and _ascending(self.removed)):
            raise FabricationError("hinge.named_twice")
        for hinge, width in self.hinge_mm:
            check_length("hinge.width_not_positive", width, hinge=hinge)
        if both := set(hinges) & set(self.removed):
            raise FabricationError("hinge.width_and_removed", hinge=min(both))


def _ascending(numbers: Sequence[int]) -> bool:
    return all(number >= 0 for number in numbers) and all(a < b for a, b in pairwise(numbers))
