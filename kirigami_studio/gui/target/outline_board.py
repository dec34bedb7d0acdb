"""A drawing board in a dialog of its own, with the tools of the target's board: for the start, or a second target."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from PySide6.QtCore import QPoint, QPointF, QSize, Qt, Signal
from PySide6.QtGui import QKeySequence, QPainter, QShortcut
from PySide6.QtWidgets import QDialog, QPushButton, QWidget

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import KirigamiError, SheetError
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.target.arrangements import ARRANGEMENTS
from kirigami_studio.gui.target.drawing_tool_bar import DrawingToolBar, LooseRow
from kirigami_studio.gui.target.sketch_context import Change
from kirigami_studio.gui.target.target_view import TargetView, Tool
from kirigami_studio.gui.widgets.card import ToolButton, muted_label
from kirigami_studio.gui.widgets.layouts import column, label, row
from kirigami_studio.gui.widgets.target_items import paint_reach, paint_start_shape
from kirigami_studio.gui.widgets.view_transform import ViewTransform
from kirigami_studio.outlines.drawing import Drawing
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.placed import Placed
from kirigami_studio.outlines.starts import check_hollows, hollows

SIZE = QSize(680, 560)
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
#: Outlines of more points than this, such as circles, are not laid on the board: nobody drags 720 points.
MOST_POINTS = 200


@dataclass(frozen=True, slots=True)
class BoardWords:
    """What a board says."""

    title: str  #: of the dialog
    #: empty, ready: while nothing is drawn, and of a shape that can be taken.
    empty: str
    ready: str
    #: take, taken: the button that takes the shape, and what that means.
    take: str
    taken: str


SECOND_WORDS = BoardWords(
    mark("Draw the second target"),
    mark("Draw what the sheet should also show on its way. Size and rotation do not matter."),
    mark("It can be the second target; size and rotation do not matter."),
    mark("&Use as second target"),
    mark("The next designs pass this shape on their way."),
)


class OutlineBoard(QDialog):
    """Draws one outline; steps on the board are undone here, taking the shape is one step of the project."""

    taken = Signal(Outline)

    def __init__(self, parent: QWidget, words: BoardWords, view: TargetView | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(tr(words.title))
        self.setModal(False)
        self.resize(SIZE)
        self._words = words
        self._steps = [Drawing()]
        self._at = 0
        self.view = TargetView() if view is None else view
        self.view.setAcceptDrops(False)
        self.view.setToolTip("")
        self.tools = DrawingToolBar(self.view.context)
        for part in (self.tools.mirror, self.tools.done_button):
            part.hide()
        self.undo = ToolButton("undoBoard", "undo", tr("Undo on this board (Ctrl+Z)."))
        self.redo = ToolButton("redoBoard", "redo", tr("Redo on this board (Ctrl+Shift+Z)."))
        self.about = label(tr(words.empty), wraps=True)
        self.loose = LooseRow(self.view.context)
        self.hint = muted_label()
        self.take, self.cancel = QPushButton(tr(words.take)), QPushButton(tr("Cancel"))
        self.take.setObjectName("primary")
        self.take.setToolTip(tr(words.taken))
        self.cancel.setToolTip(tr("Leave everything as it is (Esc)."))
        for button in (self.take, self.cancel):
            button.setAutoDefault(False)
        tools, below = row((self.tools, 1), self.undo, self.redo, spacing=2), row(..., self.cancel, self.take)
        parts = ((self.view, 1), self.hint, self.about, self.loose, below)
        column(tools, row(self.tools.options, ...), *parts, on=self, spacing=10, margins=(14, 14, 14, 14))
        self._connect()
        self.set_tool(Tool.POSE)
        self.view.set_editing(True)
        self._show()

    def _connect(self) -> None:
        context = self.view.context
        context.changed.connect(self._change)
        context.selection_changed.connect(self._show_selection)
        self.view.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        self.view.customContextMenuRequested.connect(self._open_menu)
        self.view.hint.connect(self.hint.setText)
        self.view.tool_left.connect(lambda: self.set_tool(Tool.POSE))
        self.view.editing_left.connect(self.reject)
        self.tools.tool_wanted.connect(self.set_tool)
        self.tools.grid_switched.connect(self._snap)
        self.undo.clicked.connect(lambda: self._step(-1))
        self.redo.clicked.connect(lambda: self._step(1))
        self.take.clicked.connect(self._on_accept)
        self.cancel.clicked.connect(self.reject)
        keys: dict[str | QKeySequence.StandardKey, Callable[[], object]] = {
            QKeySequence.StandardKey.Undo: lambda: self._step(-1),
            "Ctrl+Shift+Z": lambda: self._step(1),
            **{key: partial(self._on_tool, tool) for key, tool in KEYS.items()},
            **{one.key: partial(context.arrange, one.id) for one in ARRANGEMENTS if one.key},
        }
        for key, act in keys.items():
            QShortcut(QKeySequence(key), self).activated.connect(act)

    def begin(self, outline: Outline | None) -> None:
        """Open with an outline where its points can be dragged, else with the empty board."""
        placed = None if outline is None or len(outline.points) > MOST_POINTS else Placed.on_board(outline)
        if placed is not None:
            self.view.context.remember(placed)
        self._steps, self._at = [Drawing(() if placed is None else (placed,))], 0
        self._show()
        self.view.set_editing(True)
        self.set_tool(Tool.POLYGON if placed is None else Tool.POINTS)

    @property
    def placed(self) -> Placed | None:
        """The outline that the objects on the board make."""
        drawing = self._steps[self._at]
        return drawing.united().target if drawing.objects else None

    def set_tool(self, tool: Tool) -> None:
        """Change what the pointer does."""
        tool = Tool.POSE if tool is Tool.LOOK else tool
        self.tools.show_tool(tool)
        self.view.set_tool(tool)

    def _on_tool(self, tool: Tool) -> None:
        if self.tools.buttons[tool].isEnabled():
            self.set_tool(tool)

    def _snap(self, on: bool) -> None:
        self.view.context.snapping = on
        self.view.update()

    def _change(self, change: Change) -> None:
        """Carry out a gesture, or say why it is impossible."""
        context = self.view.context
        try:
            made = change.make()
            drawing = made if isinstance(made, Drawing) else context.drawing.with_active(made)
            targets = (drawing.united().target,) if drawing.objects else ()
        except KirigamiError as error:
            self.say(str(error), wrong=True)
            return
        for each in (*drawing.objects, *targets):
            context.remember(each)
        self._steps = [*self._steps[: self._at + 1], drawing]
        self._at += 1
        self._show()
        context.select(drawing.selected)

    def _open_menu(self, place: QPoint) -> None:
        """The menu of the right button: what can be done with the object there."""
        self.view.select_at(QPointF(place))
        self.tools.arrange.menu().popup(self.view.mapToGlobal(place))

    def _show_selection(self) -> None:
        self.tools.options.pose.show_drawing(self.view.context.drawing)
        self.loose.setVisible(bool(self.view.context.loose))

    def _step(self, by: int) -> None:
        """Undo or redo one gesture."""
        if 0 <= self._at + by < len(self._steps):
            self._at += by
            self._show()

    def _show(self) -> None:
        """Show the shape, and whether it can be taken."""
        placed = self.placed
        objects = tuple(each.outline for each in self._steps[self._at].objects)
        if placed is not None:
            self.view.context.remember(placed)
        self.view.show_outline(None if placed is None else placed.outline, None, objects)
        self.tools.show_target(placed is not None)
        self._show_selection()
        self.undo.setEnabled(self._at > 0)
        self.redo.setEnabled(self._at + 1 < len(self._steps))
        refusal = None if placed is None else self.refusal(placed.outline)
        self.take.setEnabled(placed is not None and refusal is None)
        if placed is None:
            self.say(tr(self._words.empty))
        else:
            self.say(refusal or self.ready(placed.outline), wrong=refusal is not None)

    def refusal(self, outline: Outline) -> str | None:
        """Why a shape cannot be taken, one sentence; None where it can."""
        return None

    def ready(self, outline: Outline) -> str:
        """What is said of a shape that can be taken."""
        return tr(self._words.ready)

    def say(self, sentence: str, wrong: bool = False) -> None:
        """Show a sentence below the board."""
        self.about.setObjectName("warning" if wrong else "muted")
        self.about.style().polish(self.about)
        self.about.setText(sentence)

    def _on_accept(self) -> None:
        if self.placed is not None:
            self.taken.emit(self.placed.outline)
            self.accept()


#: Tools whose shapes have large hollows.
LEFT_OUT = (Tool.STAR, Tool.TEXT)
START_WORDS = BoardWords(
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
        super().__init__(parent, START_WORDS, StartView())
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

    def paint_outline(self, painter: QPainter, rings: tuple[FloatArray, ...]) -> None:
        paint_start_shape(painter, rings, self.palette_)

    def paint_scene(self, painter: QPainter, transform: ViewTransform) -> None:
        super().paint_scene(painter, transform)
        placed = self.context.placed
        if placed is not None and self.hollows:
            rings = [transform.to_pixels(ring * placed.scale + placed.centre) for ring in self.hollows]
            paint_reach(painter, rings, [], self.palette_)
