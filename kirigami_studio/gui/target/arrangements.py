"""What can be done with selected objects, as one table: the menu, the tool bar's menu and the keys are made of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.outlines.drawing import AlignedSide, Boolean, Drawing, Order


@dataclass(frozen=True, slots=True)
class Arrangement:
    """One change of selected objects."""

    id: str
    #: text, tip: as in menus, and what it does.
    text: str
    tip: str
    make: Callable[[Drawing], Drawing]  #: the drawing after it
    least: int = 1  #: so many objects have to be selected
    key: str = ""  #: key sequence, or ""
    gap: bool = False  #: a separator comes before it
    undone: str = ""  #: as it follows the word Undo, "" for as in menus

    @property
    def gesture(self) -> str:
        """As it follows the word Undo, in the user's language."""
        return tr(self.undone) if self.undone else tr(self.text).replace("&", "")


def _joined(how: Boolean) -> Callable[[Drawing], Drawing]:
    return lambda drawing: drawing.joined(how)


def _ordered(order: Order) -> Callable[[Drawing], Drawing]:
    return lambda drawing: drawing.ordered(order)


def _aligned(side: AlignedSide) -> Callable[[Drawing], Drawing]:
    return lambda drawing: drawing.aligned(side)


def _distributed(axis: int) -> Callable[[Drawing], Drawing]:
    return lambda drawing: drawing.distributed(axis)


def _table() -> tuple[Arrangement, ...]:
    one, pair, several = Arrangement, partial(Arrangement, least=2), partial(Arrangement, least=3)
    join, cut = mark("Make one object of those that overlap"), mark("Cut the upper objects out of the lowest one")
    share, above = mark("Keep what all selected objects share"), mark("Put it above all others")
    uniting, cutting, sharing = mark("Unite objects"), mark("Subtract objects"), mark("Intersect objects")
    union, difference, intersection = (_joined(how) for how in (Boolean.UNION, Boolean.SUBTRACT, Boolean.INTERSECT))
    top, up, down, bottom = (_ordered(order) for order in (Order.TOP, Order.UP, Order.DOWN, Order.BOTTOM))
    across, upright = mark("Make equal gaps from left to right"), mark("Make equal gaps from bottom to top")
    centres, middles = mark("Line up the middles, left to right"), mark("Line up the middles, top to bottom")
    left, centre, right = (_aligned(side) for side in (AlignedSide.LEFT, AlignedSide.CENTRE, AlignedSide.RIGHT))
    tops, middle, bottoms = (_aligned(side) for side in (AlignedSide.TOP, AlignedSide.MIDDLE, AlignedSide.BOTTOM))
    copy, delete = mark("Copy the selected objects"), mark("Remove the selected objects")
    return (
        one("duplicate", mark("D&uplicate"), copy, Drawing.duplicated, key="Ctrl+D"),
        one("delete", mark("D&elete"), delete, Drawing.deleted, undone=mark("Delete object")),
        pair("union", mark("U&nion"), join, union, key="Ctrl+Alt+U", gap=True, undone=uniting),
        pair("difference", mark("&Subtract"), cut, difference, key="Ctrl+Alt+S", undone=cutting),
        pair("intersection", mark("&Intersect"), share, intersection, key="Ctrl+Alt+I", undone=sharing),
        one("to_front", mark("Bring to &front"), above, top, key="Ctrl+Shift+]", gap=True),
        one("forward", mark("Bring f&orward"), mark("Put it above the next one"), up, key="Ctrl+]"),
        one("backward", mark("Send back&ward"), mark("Put it below the next one"), down, key="Ctrl+["),
        one("to_back", mark("Send to &back"), mark("Put it below all others"), bottom, key="Ctrl+Shift+["),
        pair("align_left", mark("Align &left"), mark("Line up the left sides"), left, gap=True),
        pair("align_centre", mark("Align &centres"), centres, centre),
        pair("align_right", mark("Align &right"), mark("Line up the right sides"), right),
        pair("align_top", mark("Align &tops"), mark("Line up the upper sides"), tops),
        pair("align_middle", mark("Align &middles"), middles, middle),
        pair("align_bottom", mark("Ali&gn bottoms"), mark("Line up the lower sides"), bottoms),
        several("distribute_across", mark("Distribute &horizontally"), across, _distributed(0), gap=True),
        several("distribute_up", mark("Distribute &vertically"), upright, _distributed(1)),
    )


ARRANGEMENTS = _table()
#: Offered for objects that hang apart.
BRIDGE_LOOSE = Arrangement(
    "bridge",
    mark("Bridge loose ob&jects"),
    mark("Join what hangs apart by bridges, which are objects, too"),
    Drawing.bridged,
    0,
    gap=True,
    undone=mark("Bridge objects"),
)
KEEP_LARGEST = Arrangement(
    "largest",
    mark("&Keep the largest"),
    mark("Remove what hangs apart from the largest piece"),
    Drawing.largest,
    0,
)
EVERY = {one.id: one for one in (*ARRANGEMENTS, BRIDGE_LOOSE, KEEP_LARGEST)}
