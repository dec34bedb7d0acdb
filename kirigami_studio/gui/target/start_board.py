"""The drawing board for the start: it says where a shape is too hollow to be one, or folds on the grid."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtGui import QPainter
from PySide6.QtWidgets import QWidget

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import SheetError
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.target.outline_board import BoardWords, OutlineBoard
from kirigami_studio.gui.target.target_view import TargetView, Tool
from kirigami_studio.gui.widgets.target_items import paint_reach, paint_start_shape
from kirigami_studio.gui.widgets.view_transform import ViewTransform
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.starts import check_hollows, hollows

#: Tools whose shapes have large hollows.
LEFT_OUT = (Tool.STAR, Tool.TEXT)
WORDS = BoardWords(
    mark("Draw the start"),
    mark("Draw what the sheet looks like while it is flat. Its size is the sheet's width."),
    mark("It can be the start; its size is the sheet's width."),
    mark("&Use as start"),
    mark("Sheets start as this shape from now on."),
)


class StartBoard(OutlineBoard):
    """Refuses shapes that are too hollow, warns of those that the next run would refuse, and marks what is missing."""

    check_wanted = Signal(Outline)  #: a shape with hollows, which :meth:`show_check` is to be told about
    view: StartView

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent, WORDS, StartView())
        self.setObjectName("startBoard")
        for tool in LEFT_OUT:
            self.tools.buttons[tool].hide()

    def refusal(self, outline: Outline) -> str | None:
        try:
            check_hollows(outline)
        except SheetError as error:
            self.view.show_hollows(hollows(outline))
            return str(error)
        self.view.show_hollows(())
        return None

    def ready(self, outline: Outline) -> str:
        if not hollows(outline):
            return super().ready(outline)
        self.check_wanted.emit(outline)
        return tr("Checking whether a sheet unfolds around the hollow …")

    def show_check(self, outline: Outline, refusal: str) -> None:
        """Say why the next run would refuse what is on the board, one sentence, or that it would not."""
        if self.placed is None or self.placed.outline != outline:
            return
        self.view.show_hollows(hollows(outline) if refusal else ())
        self.say(refusal or super().ready(outline), wrong=bool(refusal))


class StartView(TargetView):
    """The target's board with another outline on it, and its hollows marked."""

    def __init__(self) -> None:
        super().__init__()
        self.hollows: tuple[FloatArray, ...] = ()
        self.setAccessibleName(tr("Start outline"))

    def show_hollows(self, rings: tuple[FloatArray, ...]) -> None:
        """Mark what is missing to a shape without hollows: (P, 2) each, of unit area."""
        self.hollows = rings
        self.update()

    def paint_outline(self, painter: QPainter, points: FloatArray) -> None:
        paint_start_shape(painter, points, self.palette_)

    def paint_scene(self, painter: QPainter, transform: ViewTransform) -> None:
        super().paint_scene(painter, transform)
        placed = self.context.placed
        if placed is not None and self.hollows:
            rings = [transform.to_pixels(ring * placed.scale + placed.centre) for ring in self.hollows]
            paint_reach(painter, rings, [], self.palette_)
