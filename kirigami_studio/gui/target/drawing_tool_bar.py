"""The tools of the drawing board: a button for each, and the options of the one that is held."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QAction, QActionGroup, QFont
from PySide6.QtWidgets import QButtonGroup, QFontComboBox, QFrame, QLineEdit, QMenu, QSpinBox, QToolButton, QWidget

from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.target.arrangements import ARRANGEMENTS, BRIDGE_LOOSE, KEEP_LARGEST
from kirigami_studio.gui.target.sketch_context import Change, SketchContext
from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.widgets.card import TOOL_ICON, ToolButton
from kirigami_studio.gui.widgets.layouts import Part, label, push_button, row
from kirigami_studio.gui.widgets.number_field import DecimalField, LengthField, decimal_field, number_field
from kirigami_studio.gui.widgets.theme import LIGHT, Palette
from kirigami_studio.outlines.combining import Combine
from kirigami_studio.outlines.drawing import Drawing, about
from kirigami_studio.outlines.figures import FEWEST_CORNERS, MOST_CORNERS, NARROWEST_WAIST, WIDEST_WAIST
from kirigami_studio.outlines.mirroring import Axis
from kirigami_studio.outlines.nodes import Kind
from kirigami_studio.outlines.placed import LARGEST_MM


class ToolOptions(QWidget):
    """Corners of a polygon, tips and waist of a star, letters of a text, kinds of points, place of the target."""

    def __init__(self, context: SketchContext) -> None:
        super().__init__()
        self.corners = QSpinBox()
        self.corners.setRange(FEWEST_CORNERS, MOST_CORNERS)
        self.corners.setValue(context.corners)
        self.corners.setAccessibleName(tr("Number of corners or tips"))
        self.corners.setToolTip(tr("Corners of the polygon, tips of the star"))
        number_field(self.corners)
        self.waist = decimal_field(
            DecimalField,
            "",
            100 * NARROWEST_WAIST,
            100 * WIDEST_WAIST,
            decimals=0,
            suffix=" %",
            accessible=tr("Star waist"),
            tip=tr("Inner radius of the star as a share of its outer radius"),
        )
        self.waist.setKeyboardTracking(True)
        self.waist.setValue(100 * context.waist)
        self.text = QLineEdit(context.text)
        self.text.setAccessibleName(tr("Text to draw"))
        self.text.setPlaceholderText(tr("Text"))
        self.text.setMaxLength(24)
        self.text.setMaximumWidth(150)
        self.nodes, self.pose, self.font_ = NodeOptions(context), PoseOptions(context), FontOptions(context)
        corners, waist = label(tr("&Corners"), self.corners), label(tr("Wai&st"), self.waist)
        text = label(tr("Te&xt"), self.text)
        self._parts: tuple[tuple[frozenset[Tool], tuple[QWidget, ...]], ...] = (
            (frozenset({Tool.REGULAR, Tool.STAR}), (corners, self.corners)),
            (frozenset({Tool.STAR}), (waist, self.waist)),
            (frozenset({Tool.TEXT}), (text, self.text)),
            (frozenset({Tool.POINTS}), (self.nodes,)),
            (frozenset({Tool.POSE}), (self.pose,)),
            (frozenset({Tool.TEXT}), (self.font_,)),
        )
        widgets = [widget for _, widgets in self._parts for widget in widgets]
        row(*widgets, on=self, spacing=6, margins=(8, 0, 8, 0))
        self.corners.valueChanged.connect(lambda corners: setattr(context, "corners", corners))
        self.waist.valueChanged.connect(lambda percent: setattr(context, "waist", percent / 100))
        self.text.textChanged.connect(lambda text: setattr(context, "text", text))
        self.show_tool(Tool.LOOK)

    def show_tool(self, tool: Tool) -> None:
        """Show the numbers that a tool has."""
        if tool is Tool.TEXT:
            self.font_.fill()
        for tools, widgets in self._parts:
            for widget in widgets:
                widget.setVisible(tool in tools)


class NodeOptions(QWidget):
    """One button for each kind; those of the selected points are down."""

    def __init__(self, context: SketchContext) -> None:
        super().__init__()
        self.buttons: dict[Kind, QToolButton] = {}
        for kind, tip in (
            (
                Kind.CORNER,
                tr("Corner (Shift+C). Handles move independently, as with Alt+drag. Press again to remove them."),
            ),
            (Kind.SMOOTH, tr("Smooth (Shift+S). Both handles stay in line.")),
            (Kind.SYMMETRIC, tr("Symmetric (Shift+Y). Handles stay in line and equally long, as with Shift+drag.")),
            (Kind.AUTO, tr("Automatic (Shift+A). Neighbouring points set the handles.")),
        ):
            button = ToolButton(f"node{kind.value.capitalize()}", f"node-{kind.value}", tip, checkable=True)
            button.clicked.connect(lambda _=False, kind=kind: context.kind_wanted.emit(kind))
            self.buttons[kind] = button
        row(*self.buttons.values(), on=self, spacing=2)
        context.kinds_shown.connect(self.show_kinds)
        self.show_kinds(frozenset())

    def show_kinds(self, kinds: frozenset[Kind]) -> None:
        """Show which kinds the selected points have; without one there is nothing to change."""
        for kind, button in self.buttons.items():
            button.setEnabled(bool(kinds))
            button.setChecked(kind in kinds)


class PoseOptions(QWidget):
    """Two lengths and an angle; the steps of one visit to a field undo together."""

    def __init__(self, context: SketchContext) -> None:
        super().__init__()
        self._context = context
        self._visit = 0
        field = partial(decimal_field, LengthField, "", -LARGEST_MM, LARGEST_MM, suffix=tr(" mm"))
        x, y = tr("X of the target's middle on the board, mm"), tr("Y of the target's middle on the board, mm")
        turn = tr("Rotate the target by this angle, degrees counter-clockwise")
        self.x_, self.y_ = field(accessible=x, tip=x), field(accessible=y, tip=y)
        self.turn = decimal_field(DecimalField, "", -360.0, 360.0, suffix="°", accessible=turn, tip=turn)
        parts: list[Part] = []
        for caption, number in ((tr("&X"), self.x_), (tr("&Y"), self.y_), (tr("T&urn by"), self.turn)):
            number.setMaximumWidth(96)
            number.editingFinished.connect(self._leave)
            parts += [label(caption, number), number]
        row(*parts, on=self, spacing=6)
        self.x_.valueChanged.connect(self._move)
        self.y_.valueChanged.connect(self._move)
        self.turn.valueChanged.connect(self._turn)

    def _leave(self) -> None:
        self._visit += 1

    def show_drawing(self, drawing: Drawing) -> None:
        """Show where the middle of what is selected lies."""
        self.setEnabled(bool(drawing.chosen))
        if not drawing.chosen:
            return
        for field, value in zip((self.x_, self.y_), _middle(drawing), strict=True):
            with QSignalBlocker(field):
                field.setValue(value)
        with QSignalBlocker(self.turn):
            self.turn.setValue(0.0)

    def _move(self) -> None:
        drawing = self._context.drawing
        if drawing.chosen:
            middle = _middle(drawing)
            # Only the field that was changed: the other one shows a rounded number.
            fields = zip((self.x_, self.y_), middle, strict=True)
            x, y = (field.value() - old if self.sender() is field else 0.0 for field, old in fields)
            self._change(tr("Move target"), lambda: drawing.moved((x, y)))

    def _turn(self, degrees: float) -> None:
        drawing = self._context.drawing
        if drawing.chosen and degrees:
            alone = len(drawing.chosen) == 1
            centre = np.array(drawing.objects[drawing.chosen[0]].centre if alone else _middle(drawing))
            angle = math.radians(degrees)
            self._change(tr("Rotate target"), lambda: drawing.changed(lambda each: about(each, angle, centre)))

    def _change(self, gesture: str, make: Callable[[], Drawing]) -> None:
        self._context.changed.emit(Change(gesture, make, f"typed {gesture} {self._visit}"))


def _middle(drawing: Drawing) -> tuple[float, float]:
    """The middle of the box around what is selected, mm."""
    low, high = drawing.box(drawing.chosen)
    x, y = (0.5 * (low + high)).tolist()
    return x, y


class FontOptions(QWidget):
    """Families of this computer that can be scaled; the list is filled when it is shown for the first time."""

    def __init__(self, context: SketchContext) -> None:
        super().__init__()
        self._context = context
        self.family: QFontComboBox | None = None
        self.bold = ToolButton("fontBold", "bold", tr("Bold letters. Thick strokes work better than thin ones."), True)
        self.italic = ToolButton("fontItalic", "italic", tr("Italic letters."), True)
        self.bold.setChecked(context.bold)
        self.bold.toggled.connect(self._on_style)
        self.italic.toggled.connect(self._on_style)
        self._row = row(self.bold, self.italic, on=self, spacing=2)

    def fill(self) -> None:
        """List the families: reading them takes a while, so only when the text tool is taken."""
        if self.family is not None:
            return
        self.family = QFontComboBox()
        self.family.setFontFilters(QFontComboBox.FontFilter.ScalableFonts)
        self.family.setAccessibleName(tr("Font"))
        self.family.setToolTip(tr("Font. Letters are moved together into one piece."))
        self.family.setMaximumWidth(190)
        with QSignalBlocker(self.family):
            self.family.setCurrentFont(QFont(self._context.family) if self._context.family else self.font())
        self.family.currentFontChanged.connect(self._on_family)
        self._row.insertWidget(0, self.family)

    def _on_style(self) -> None:
        self._context.bold, self._context.italic = self.bold.isChecked(), self.italic.isChecked()

    def _on_family(self, font: QFont) -> None:
        self._context.family = font.family()


class AxisButton(QToolButton):
    """Shows the axes in use; its menu and Shift+M change them."""

    def __init__(self, context: SketchContext, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._context = context
        self._palette: Palette = LIGHT
        self.setObjectName("axis")
        self.setIconSize(TOOL_ICON)
        self.setAccessibleName(tr("Mirror while drawing"))
        self.setToolTip(
            tr(
                "Mirror while drawing (Shift+M). Reflects shapes, strokes and points about the dashed "
                "axis through the target's middle."
            )
        )
        self.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.setCheckable(True)
        menu = QMenu(self)
        group = QActionGroup(self)
        self.choices: dict[Axis, QAction] = {}
        for axis, text in (
            (Axis.NONE, tr("&No mirror")),
            (Axis.UPRIGHT, tr("&Left and right")),
            (Axis.LEVEL, tr("&Top and bottom")),
            (Axis.BOTH, tr("&Both")),
        ):
            choice = menu.addAction(text)
            choice.setCheckable(True)
            choice.triggered.connect(lambda _=False, axis=axis: self.set_axis(axis))
            group.addAction(choice)
            self.choices[axis] = choice
        self.setMenu(menu)
        self.choices[context.mirror.axis].setChecked(True)

    def set_axis(self, axis: Axis) -> None:
        """Mirror about these axes from now on."""
        self._context.set_axis(axis)
        self.choices[axis].setChecked(True)
        self.setChecked(axis is not Axis.NONE)
        self._update_icons()

    def cycle(self) -> None:
        """Go on to the next choice."""
        axes = list(Axis)
        self.set_axis(axes[(axes.index(self._context.mirror.axis) + 1) % len(axes)])

    def set_palette(self, palette: Palette) -> None:
        self._palette = palette
        self._update_icons()

    def _update_icons(self) -> None:
        axis = self._context.mirror.axis
        self.setIcon(icons.icon(f"axis-{axis.value}", self._palette))
        for choice, action in self.choices.items():
            action.setIcon(icons.icon(f"axis-{choice.value}", self._palette))


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
#: Tools that draw nothing.
IDLE = frozenset({Tool.LOOK, Tool.POINTS, Tool.POSE})
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
        self._tool, self._draws = Tool.LOOK, Tool.RECTANGLE  # in use; the last one that draws
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
            button.clicked.connect(lambda _=False, mode=mode: self.take_mode(mode))
            group.addButton(button)
            yield button
        self.modes[self._context.combine].setChecked(True)

    def take_mode(self, mode: Combine) -> None:
        """Set what happens with the next shape, and take the tool of the last one where none that draws is held."""
        self.set_mode(mode)
        if mode is not Combine.NEW and self._tool in IDLE:
            self.tool_wanted.emit(self._draws)

    def set_mode(self, mode: Combine) -> None:
        """What happens with the next shape."""
        self._context.combine = mode
        self.modes[mode].setChecked(True)
        self._context.repaint.emit()

    def show_tool(self, tool: Tool) -> None:
        """Mark the tool in use and show its numbers."""
        self._tool = tool
        if tool not in IDLE:
            self._draws = tool
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
