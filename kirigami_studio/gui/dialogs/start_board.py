"""A drawing board for the start, with the tools of the target's board; shapes that are too hollow are refused."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QKeySequence, QPainter, QShortcut
from PySide6.QtWidgets import QDialog, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import KirigamiError, SheetError
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.panels.card import ToolButton, muted_label
from kirigami_studio.gui.panels.drawing_tool_bar import DrawingToolBar
from kirigami_studio.gui.scene.target_items import paint_reach, paint_start_shape
from kirigami_studio.gui.scene.view_transform import ViewTransform
from kirigami_studio.gui.sketching.sketch_context import Change
from kirigami_studio.gui.views.target_view import TargetView, Tool
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.placed import Placed
from kirigami_studio.outlines.starts import StartShape, check_hollows, hollows

SIZE = QSize(680, 560)
#: Tools whose shapes have large hollows.
LEFT_OUT = (Tool.STAR, Tool.TEXT)
#: Keys of the tools, as on the target's board.
KEYS = {
    "N": Tool.POINTS,
    "V": Tool.POSE,
    "D": Tool.FREEHAND,
    "P": Tool.POLYGON,
    "R": Tool.RECTANGLE,
    "O": Tool.ELLIPSE,
    "G": Tool.REGULAR,
}
#: Starts of more points than this, such as circles, are not laid on the board: nobody drags 720 points.
MOST_POINTS = 200
EMPTY = tr("Draw what the sheet looks like while it is flat. Its size is the sheet's width.")
READY = tr("It can be the start; its size is the sheet's width.")


class StartBoard(QDialog):
    """Draws one outline; steps on the board are undone here, taking the shape is one step of the project."""

    taken = Signal(Outline)

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("startBoard")
        self.setWindowTitle(tr("Draw the start"))
        self.setModal(False)
        self.resize(SIZE)
        self._steps: list[Placed | None] = [None]
        self._at = 0
        self.view = StartView()
        self.tools = DrawingToolBar(self.view.context)
        for part in (*(self.tools.buttons[tool] for tool in LEFT_OUT), self.tools.mirror, self.tools.done_button):
            part.hide()
        self.undo = ToolButton("undoStart", "undo", tr("Undo on this board (Ctrl+Z)."))
        self.redo = ToolButton("redoStart", "redo", tr("Redo on this board (Ctrl+Shift+Z)."))
        self.about = QLabel(EMPTY)
        self.about.setWordWrap(True)
        self.hint = muted_label()
        self.take = QPushButton(tr("&Use as start"))
        self.take.setObjectName("primary")
        self.take.setToolTip(tr("Sheets start as this shape from now on."))
        self.take.setAutoDefault(False)
        self.cancel = QPushButton(tr("Cancel"))
        self.cancel.setToolTip(tr("Leave the start as it is (Esc)."))
        self.cancel.setAutoDefault(False)
        self._lay_out()
        self._connect()
        self.set_tool(Tool.LOOK)
        self.view.set_editing(True)
        self._show()

    def _lay_out(self) -> None:
        column, tools, below = QVBoxLayout(self), QHBoxLayout(), QHBoxLayout()
        column.setContentsMargins(14, 14, 14, 14)
        column.setSpacing(10)
        tools.setSpacing(2)
        tools.addWidget(self.tools, 1)
        tools.addWidget(self.undo)
        tools.addWidget(self.redo)
        column.addLayout(tools)
        column.addWidget(self.tools.options, 0, Qt.AlignmentFlag.AlignLeft)
        column.addWidget(self.view, 1)
        column.addWidget(self.hint)
        column.addWidget(self.about)
        below.addStretch(1)
        below.addWidget(self.cancel)
        below.addWidget(self.take)
        column.addLayout(below)

    def _connect(self) -> None:
        context = self.view.context
        context.changed.connect(self._change)
        self.view.hint.connect(self.hint.setText)
        self.view.tool_left.connect(lambda: self.set_tool(Tool.LOOK))
        self.view.editing_left.connect(self.reject)
        self.tools.tool_wanted.connect(self.set_tool)
        self.tools.grid_switched.connect(self._snap)
        self.undo.clicked.connect(lambda: self._step(-1))
        self.redo.clicked.connect(lambda: self._step(1))
        self.take.clicked.connect(self._take)
        self.cancel.clicked.connect(self.reject)
        for key, tool in KEYS.items():
            QShortcut(QKeySequence(key), self).activated.connect(partial(self._take_tool, tool))
        QShortcut(QKeySequence(QKeySequence.StandardKey.Undo), self).activated.connect(lambda: self._step(-1))
        QShortcut(QKeySequence("Ctrl+Shift+Z"), self).activated.connect(lambda: self._step(1))

    def begin(self, start: StartShape) -> None:
        """Open with the present start where its points can be dragged, else with the empty board."""
        outline = start.outline
        placed = None if outline is None or len(outline.points) > MOST_POINTS else Placed.on_board(outline)
        if placed is not None:
            self.view.context.remember(placed)
        self._steps, self._at = [placed], 0
        self._show()
        self.view.set_editing(True)
        self.set_tool(Tool.POLYGON if placed is None else Tool.POINTS)

    @property
    def placed(self) -> Placed | None:
        """What is on the board."""
        return self._steps[self._at]

    def set_tool(self, tool: Tool) -> None:
        """Change what the pointer does."""
        self.tools.show_tool(tool)
        self.view.set_tool(tool)

    def _take_tool(self, tool: Tool) -> None:
        if self.tools.buttons[tool].isEnabled():
            self.set_tool(tool)

    def _snap(self, on: bool) -> None:
        self.view.context.snapping = on
        self.view.update()

    def _change(self, change: Change) -> None:
        """Carry out a gesture, or say why it is impossible."""
        try:
            made = change.make()
        except KirigamiError as error:
            self._say(str(error), wrong=True)
            return
        self.view.context.remember(made)
        self._steps = [*self._steps[: self._at + 1], made]
        self._at += 1
        self._show()

    def _step(self, by: int) -> None:
        """Undo or redo one gesture."""
        if 0 <= self._at + by < len(self._steps):
            self._at += by
            self._show()

    def _show(self) -> None:
        """Show the shape, whether it can be a start, and where it is hollow if it cannot."""
        placed = self.placed
        self.view.show_outline(None if placed is None else placed.outline)
        self.view.show_hollows(())
        self.tools.show_target(placed is not None)
        self.tools.options.pose.show_placed(placed)
        self.undo.setEnabled(self._at > 0)
        self.redo.setEnabled(self._at + 1 < len(self._steps))
        self.take.setEnabled(False)
        if placed is None:
            self._say(EMPTY)
            return
        try:
            check_hollows(placed.outline)
        except SheetError as error:
            self.view.show_hollows(hollows(placed.outline))
            self._say(str(error), wrong=True)
        else:
            self._say(READY)
            self.take.setEnabled(True)

    def _say(self, sentence: str, wrong: bool = False) -> None:
        self.about.setObjectName("warning" if wrong else "muted")
        self.about.style().polish(self.about)
        self.about.setText(sentence)

    def _take(self) -> None:
        if self.placed is not None:
            self.taken.emit(self.placed.outline)
            self.accept()


class StartView(TargetView):
    """The target's board with another outline on it, and its hollows marked."""

    def __init__(self) -> None:
        super().__init__()
        self.hollows: tuple[FloatArray, ...] = ()
        self.setAcceptDrops(False)
        self.setAccessibleName(tr("Start outline"))
        self.setToolTip("")

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
