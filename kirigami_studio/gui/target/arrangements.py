"""What can be done with selected objects, as one table: the menu, the tool bar's menu and the keys are made of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from kirigami_studio.foundation.words import mark
from kirigami_studio.outlines.drawing import AlignedSide, Boolean, Drawing, Order


@dataclass(frozen=True, slots=True)
class Arrangement:
    """One change of selected objects.

    Attributes
    ----------
    id : str
    text, tip : str
        As in menus, and what it does.
    gesture : str
        As it follows the word Undo.
    make : callable
        The drawing after it.
    least : int
        So many objects have to be selected.
    key : str
        Key sequence, or "".
    gap : bool
        A separator comes before it.
    """

    id: str
    text: str
    tip: str
    gesture: str
    make: Callable[[Drawing], Drawing]
    least: int = 1
    key: str = ""
    gap: bool = False


ARRANGEMENTS = (
    Arrangement(
        "duplicate",
        mark("D&uplicate"),
        mark("Copy the selected objects"),
        mark("Duplicate"),
        Drawing.duplicated,
        key="Ctrl+D",
    ),
    Arrangement("delete", mark("D&elete"), mark("Remove the selected objects"), mark("Delete object"), Drawing.deleted),
    Arrangement(
        "union",
        mark("U&nion"),
        mark("Make one object of those that overlap"),
        mark("Unite objects"),
        lambda drawing: drawing.joined(Boolean.UNION),
        2,
        "Ctrl+Alt+U",
        gap=True,
    ),
    Arrangement(
        "difference",
        mark("&Subtract"),
        mark("Cut the upper objects out of the lowest one"),
        mark("Subtract objects"),
        lambda drawing: drawing.joined(Boolean.SUBTRACT),
        2,
        "Ctrl+Alt+S",
    ),
    Arrangement(
        "intersection",
        mark("&Intersect"),
        mark("Keep what all selected objects share"),
        mark("Intersect objects"),
        lambda drawing: drawing.joined(Boolean.INTERSECT),
        2,
        "Ctrl+Alt+I",
    ),
    Arrangement(
        "to_front",
        mark("Bring to &front"),
        mark("Put it above all others"),
        mark("Bring to front"),
        lambda drawing: drawing.ordered(Order.TOP),
        key="Ctrl+Shift+]",
        gap=True,
    ),
    Arrangement(
        "forward",
        mark("Bring f&orward"),
        mark("Put it above the next one"),
        mark("Bring forward"),
        lambda drawing: drawing.ordered(Order.UP),
        key="Ctrl+]",
    ),
    Arrangement(
        "backward",
        mark("Send back&ward"),
        mark("Put it below the next one"),
        mark("Send backward"),
        lambda drawing: drawing.ordered(Order.DOWN),
        key="Ctrl+[",
    ),
    Arrangement(
        "to_back",
        mark("Send to &back"),
        mark("Put it below all others"),
        mark("Send to back"),
        lambda drawing: drawing.ordered(Order.BOTTOM),
        key="Ctrl+Shift+[",
    ),
    Arrangement(
        "align_left",
        mark("Align &left"),
        mark("Line up the left sides"),
        mark("Align left"),
        lambda drawing: drawing.aligned(AlignedSide.LEFT),
        2,
        gap=True,
    ),
    Arrangement(
        "align_centre",
        mark("Align &centres"),
        mark("Line up the middles, left to right"),
        mark("Align centres"),
        lambda drawing: drawing.aligned(AlignedSide.CENTRE),
        2,
    ),
    Arrangement(
        "align_right",
        mark("Align &right"),
        mark("Line up the right sides"),
        mark("Align right"),
        lambda drawing: drawing.aligned(AlignedSide.RIGHT),
        2,
    ),
    Arrangement(
        "align_top",
        mark("Align &tops"),
        mark("Line up the upper sides"),
        mark("Align tops"),
        lambda drawing: drawing.aligned(AlignedSide.TOP),
        2,
    ),
    Arrangement(
        "align_middle",
        mark("Align &middles"),
        mark("Line up the middles, top to bottom"),
        mark("Align middles"),
        lambda drawing: drawing.aligned(AlignedSide.MIDDLE),
        2,
    ),
    Arrangement(
        "align_bottom",
        mark("Ali&gn bottoms"),
        mark("Line up the lower sides"),
        mark("Align bottoms"),
        lambda drawing: drawing.aligned(AlignedSide.BOTTOM),
        2,
    ),
    Arrangement(
        "distribute_across",
        mark("Distribute &horizontally"),
        mark("Make equal gaps from left to right"),
        mark("Distribute horizontally"),
        lambda drawing: drawing.distributed(0),
        3,
        gap=True,
    ),
    Arrangement(
        "distribute_up",
        mark("Distribute &vertically"),
        mark("Make equal gaps from bottom to top"),
        mark("Distribute vertically"),
        lambda drawing: drawing.distributed(1),
        3,
    ),
)
#: What is offered for objects that hang apart.
BRIDGE_LOOSE = Arrangement(
    "bridge",
    mark("Bridge loose ob&jects"),
    mark("Join what hangs apart by bridges, which are objects, too"),
    mark("Bridge objects"),
    Drawing.bridged,
    0,
    gap=True,
)
KEEP_LARGEST = Arrangement(
    "largest",
    mark("&Keep the largest"),
    mark("Remove what hangs apart from the largest piece"),
    mark("Keep the largest"),
    Drawing.largest,
    0,
)
EVERY = {one.id: one for one in (*ARRANGEMENTS, BRIDGE_LOOSE, KEEP_LARGEST)}
