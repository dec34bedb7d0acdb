"""The editor's tools, modes and grid in one row."""

from __future__ import annotations

from collections.abc import Iterator

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QButtonGroup, QFrame, QMenu, QToolButton, QWidget

from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.target.arrangements import ARRANGEMENTS, BRIDGE_LOOSE, KEEP_LARGEST
from kirigami_studio.gui.target.sketch_context import SketchContext
from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.target.tool_options import AxisButton, ToolOptions
from kirigami_studio.gui.widgets.card import ToolButton
from kirigami_studio.gui.widgets.layouts import Part, push_button, row
from kirigami_studio.outlines.combining import Combine

#: Tool, icon, tooltip; None for a gap.
TOOLS: tuple[tuple[Tool, str, str] | None, ...] = (
    (Tool.POINTS, "points", mark("Move points (N). Select, drag, Delete; handles bend the lines.")),
    (Tool.POSE, "pose", mark("Move, resize and rotate (V). Drag the shape or the handles around it.")),
    None,
    (Tool.FREEHAND, "draw", mark("Draw freehand (D). One stroke, smoothed and closed.")),
    (Tool.POLYGON, "polygon", mark("Pen (P). Click corners, drag to pull curves; Enter closes the line.")),
    (Tool.RECTANGLE, "rectangle", mark("Draw a rectangle (R). Shift makes a square.")),
    (Tool.ELLIPSE, "ellipse", mark("Draw an ellipse (O). Shift makes a circle.")),
    (Tool.REGULAR, "regular", mark("Draw a regular polygon (G). Shift keeps it regular.")),
    (Tool.STAR, "star", mark("Draw a star (S). Shift keeps it regular.")),
    (Tool.TEXT, "text", mark("Draw text (X). Letters are moved together into one piece.")),
)
#: Mode, icon, tooltip.
MODES = (
    (Combine.NEW, "replace", mark("New (Alt+1). What you draw is another object.")),
    (Combine.ADD, "add", mark("Add (Alt+2). What you draw is added to the objects it overlaps.")),
    (Combine.SUBTRACT, "subtract", mark("Subtract (Alt+3). What you draw is cut out of the objects it overlaps.")),
    (Combine.INTERSECT, "intersect", mark("Intersect (Alt+4). Of the objects it overlaps, what lies in it stays.")),
)
MIRRORS = (
    ("left", mark("Keep &left half")),
    ("right", mark("Keep &right half")),
    ("top", mark("Keep &top half")),
    ("bottom", mark("Keep &bottom half")),
    ("across", mark("Flip horizontally")),
    ("over", mark("Flip vertically")),
)


class DrawingToolBar(QWidget):
    """Tools, modes, mirror, grid; Done ends editing."""

    tool_wanted = Signal(Tool)
    mirror_wanted = Signal(str)
    grid_switched = Signal(bool)
    done = Signal()

    def __init__(self, context: SketchContext, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._context = context
        self.buttons: dict[Tool, QToolButton] = {}
        self.modes: dict[Combine, QToolButton] = {}
        parts: list[Part] = [*self._made_tools(), _rule(), *self._made_modes(), _rule()]
        self.mirror = ToolButton("mirror", "mirror", tr("Mirror. Reflect one half of the target, or flip it."))
        self.mirror.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        menu = QMenu(self)
        for how, text in MIRRORS:
            menu.addAction(tr(text)).triggered.connect(lambda _=False, how=how: self.mirror_wanted.emit(how))
        self.mirror.setMenu(menu)
        self.grid = ToolButton("grid", "grid", tr("Snap to the grid (Ctrl+Shift+G). Hold Ctrl to ignore it."), True)
        self.grid.setChecked(context.snapping)
        self.grid.toggled.connect(self.grid_switched)
        self.axis = AxisButton(context)
        self.axis.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.arrange = ToolButton("arrange", "arrange", tr("Arrange. Duplicate, combine, order and align objects."))
        self.arrange.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.arrange.setMenu(ArrangeMenu(context, self))
        self.done_button = push_button(tr("Done"), tr("Leave the drawing board (E)"))
        self.done_button.clicked.connect(self.done)
        parts += [self.arrange, self.mirror, self.axis, self.grid, ..., self.done_button]
        row(*parts, on=self, spacing=0)  # the least window has room for all tools, and no more
        self.options = ToolOptions(context)

    def _made_tools(self) -> Iterator[QWidget]:
        for entry in TOOLS:
            if entry is None:
                yield _rule()
                continue
            tool, icon, tip = entry
            button = self.buttons[tool] = ToolButton(tool.value, icon, tr(tip), True)
            button.clicked.connect(lambda down, tool=tool: self.tool_wanted.emit(tool if down else Tool.LOOK))
            yield button

    def _made_modes(self) -> Iterator[QWidget]:
        group = QButtonGroup(self)
        for mode, icon, tip in MODES:
            button = self.modes[mode] = ToolButton(mode.value, icon, tr(tip), True)
            button.clicked.connect(lambda _=False, mode=mode: self.set_mode(mode))
            group.addButton(button)
            yield button
        self.modes[self._context.combine].setChecked(True)

    def set_mode(self, mode: Combine) -> None:
        """What happens with the next shape."""
        self._context.combine = mode
        self.modes[mode].setChecked(True)
        self._context.repaint.emit()

    def show_tool(self, tool: Tool) -> None:
        """Mark the tool in use and show its numbers."""
        for own, button in self.buttons.items():
            button.setChecked(own is tool)
        self.options.show_tool(tool)

    def show_target(self, present: bool) -> None:
        """Without a target there is nothing to move, mirror or take from."""
        for button in (self.buttons[Tool.POINTS], self.buttons[Tool.POSE], self.mirror, self.arrange):
            button.setEnabled(present)
        for mode in (Combine.ADD, Combine.SUBTRACT, Combine.INTERSECT):
            self.modes[mode].setEnabled(present)


class ArrangeMenu(QMenu):
    """What can be done with the selected objects; what needs more of them is grey."""

    def __init__(self, context: SketchContext, parent: QWidget) -> None:
        super().__init__(parent)
        self._context = context
        self._entries = []
        for one in (*ARRANGEMENTS, BRIDGE_LOOSE, KEEP_LARGEST):
            if one.gap:
                self.addSeparator()
            action = self.addAction(tr(one.text))
            action.setObjectName(one.id)
            action.setToolTip(tr(one.tip))
            action.triggered.connect(lambda _=False, name=one.id: context.arrange(name))
            self._entries.append(action)
        self.aboutToShow.connect(self.refresh)

    def refresh(self) -> None:
        """Offer what is possible with what is selected."""
        for action in self._entries:
            action.setEnabled(self._context.can_arrange(action.objectName()))


class LooseRow(QWidget):
    """Shown while objects hang apart: what can be done about it."""

    def __init__(self, context: SketchContext) -> None:
        super().__init__()
        self.buttons = {}
        for one in (BRIDGE_LOOSE, KEEP_LARGEST):
            button = self.buttons[one.id] = push_button(tr(one.text), tr(one.tip))
            button.clicked.connect(lambda _=False, name=one.id: context.arrange(name))
        row(*self.buttons.values(), ..., on=self, spacing=8)
        self.hide()


def _rule() -> QFrame:
    """A thin upright line between groups."""
    line = QFrame()
    line.setObjectName("upright")
    line.setFixedWidth(1)
    line.setFixedHeight(20)
    return line
