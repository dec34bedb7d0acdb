"""The target beside its start: file, library, board, sizes, simplify and smooth, a traced picture's threshold."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QCheckBox, QSizePolicy, QSlider, QStyle, QStyleOptionSlider, QWidget

from kirigami_studio.evaluate.opened_size import OpenedSize
from kirigami_studio.foundation.words import mark, tr, tr_n
from kirigami_studio.gui.run.start_tile import StartTile
from kirigami_studio.gui.target.arrangements import EVERY
from kirigami_studio.gui.target.drawing_tool_bar import DrawingToolBar, LooseRow
from kirigami_studio.gui.target.target_view import TargetView, Tool
from kirigami_studio.gui.widgets.card import Card, ElidedLabel, ToolButton, compact
from kirigami_studio.gui.widgets.layouts import TOUCH, Part, label, push_button, row, slider
from kirigami_studio.gui.widgets.number_field import LengthField, decimal_field, names_length
from kirigami_studio.gui.widgets.readable import TIMES, UNKNOWN, readable_size
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.placed import LARGEST_MM, Placed
from kirigami_studio.outlines.reach import reach_of, reach_texts
from kirigami_studio.studio.previewing import Preview
from kirigami_studio.studio.targets import Picture

OPENED_SIZE = mark("Size of the opened shape, mm; 3 in or 8.5 cm work too.")
FOLLOWED = mark("The flat width follows; it can be typed on the page Make instead.")
TYPED_WIDTH = mark("It follows from the flat width that was typed on the page Make.")


class OpenedSizeRow(QWidget):
    """Two sides that keep the target's proportions; reports the longer one."""

    size_wanted = Signal(float)  #: longer side, mm
    drawn_wanted = Signal(float)  #: the same, as drawn
    edited = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._size: OpenedSize | None = None
        self._folded = False
        self.width_ = _side("openedWidth", tr("Width of the opened shape in millimetres"))
        self.height_ = _side("openedHeight", tr("Height of the opened shape in millimetres"))
        self.caption = label(tr("&Opened size"), self.width_)
        self.caption.setMinimumWidth(self.caption.sizeHint().width())
        self.drawn = ToolButton("drawnSize", "chain", tr("Back to the drawn size."))
        self.drawn.setFixedSize(TOUCH, TOUCH)
        self.unit = label(tr("mm"))
        names_length(self.unit)
        sides = ((self.width_, 1), label(TIMES), (self.height_, 1), self.unit)
        row(self.caption, 4, *sides, self.drawn, on=self, spacing=4)
        self.width_.valueChanged.connect(lambda width: self._report(width, 0))
        self.height_.valueChanged.connect(lambda height: self._report(height, 1))
        for field in (self.width_, self.height_):
            field.editingFinished.connect(self.edited)
        self.drawn.clicked.connect(self._on_drawn)
        self.show_size(None, follows=False)

    def show_size(self, size: OpenedSize | None, *, follows: bool) -> None:
        """Show the size, and whether the flat width ``follows`` it or the other way round; nothing without a target."""
        self._size = size
        self.fold(self._folded)
        if size is None:
            return
        about = FOLLOWED if follows else TYPED_WIDTH
        for field, side in zip((self.width_, self.height_), size.opened, strict=True):
            with QSignalBlocker(field):
                field.setValue(side)
            field.setToolTip(f"{tr(OPENED_SIZE)}\n{tr(about)}")
        self.drawn.setVisible(size.drawn is not None and not size.agrees)
        if size.drawn is not None:
            self.drawn.setToolTip(tr("Back to the drawn size, {size}.", size=readable_size(*size.drawn)))

    def fold(self, folded: bool) -> None:
        """Give the room to the drawing board, which has sizes of its own."""
        self._folded = folded
        self.setVisible(self._size is not None and not folded)

    def _report(self, side: float, which: int) -> None:
        if self._size is not None:
            self.size_wanted.emit(side * max(self._size.opened) / self._size.opened[which])

    def _on_drawn(self) -> None:
        if self._size is not None and self._size.drawn is not None:
            self.drawn_wanted.emit(max(self._size.drawn))
            self.edited.emit()


def _side(name: str, accessible: str) -> LengthField:
    field = decimal_field(LengthField, name, 1.0, LARGEST_MM, step=5.0, accessible=accessible)
    compact(field, 56)  # without buttons, in the style sheet: their room is the numbers'
    return field


#: Slider steps from nothing to most.
REFINE_STEPS = 100
#: Slider steps from black to white; the ends would leave no shape.
GREY_LEVELS = 200
#: Name, caption, accessible name, tooltip.
SLIDERS = (
    (
        "simplify",
        mark("S&implify"),
        mark("Simplify the target"),
        mark("Remove points; further right keeps fewer corners"),
    ),
    (
        "smooth",
        mark("S&mooth"),
        mark("Smooth the target"),
        mark("Round corners and smooth edges; the area stays the same"),
    ),
)
#: Tool button name, icon, tooltip, whether it stays down.
BUTTONS = (
    ("openTarget", "open", mark("Open a target file (Ctrl+O). PNG, JPG, BMP, SVG, DXF or JSON."), False),
    ("library", "library", mark("Choose a silhouette from the library (Ctrl+L)."), False),
    ("edit", "edit", mark("Draw and edit the target (E). Shapes, points, add and subtract."), True),
    ("clearTarget", "clear", mark("Clear the target. Undo restores it."), False),
)
#: Said when the editor is left.
DONE_HINT = mark("Press Generate (Ctrl+G) to design a sheet for this target.")


class TargetPanel(Card):
    """The target view with its tools and the reader's notes."""

    editing_changed = Signal(bool)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(tr("Target"), parent)
        self.view = TargetView()
        self.editing = False
        self._reach_texts, self._turns_back = ("", ""), False
        self.tools = DrawingToolBar(self.view.context)
        self.refine = RefineBar()
        self.header.addWidget(self.tools.options)
        self.buttons = {tool.value: button for tool, button in self.tools.buttons.items()}
        for name, icon, tip, checkable in BUTTONS:
            self.buttons[name] = ToolButton(name, icon, tr(tip), checkable)
            self.header.addWidget(self.buttons[name])
        self.facts, self.size_ = ElidedLabel(), label()
        self.notes = label(name="warning", wraps=True)
        self.notes.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        labels = (ElidedLabel(Qt.TextElideMode.ElideRight) for _ in range(4))
        self.reach, self.start_refusal, self.limit, self.cutting = labels
        self.reach.setAccessibleDescription(tr("Details that the grid may miss"))
        self.start_refusal.setAccessibleDescription(tr("Why the next run would refuse the start"))
        self.limit.setAccessibleDescription(tr("What no closed sheet shows of the target"))
        self.cutting.setAccessibleDescription(tr("Whether the sheet can be cut at this size, and for how long"))
        for warning in (self.reach, self.start_refusal, self.limit, self.cutting):
            warning.setObjectName("warning")
            warning.setVisible(False)
        self.threshold, self.start, self.opened = ThresholdBar(), StartTile(), OpenedSizeRow()
        self.loose = LooseRow(self.view.context)
        self.fill = QCheckBox()
        self.fill.setObjectName("fillHoles")
        self.fill.setToolTip(tr("A sheet shows the shape without its holes; they can be opened again."))
        self.body.addWidget(self.tools)
        self.body.addLayout(row(self.start, (self.view, 1), spacing=8), 1)
        self.preview = label()
        self.preview.setAccessibleDescription(tr("Preview of a design, no design of a run"))
        self.body.addLayout(row((self.facts, 1), self.preview, self.size_, spacing=14))
        warnings = (self.start_refusal, self.reach, self.limit, self.cutting)
        for part in (self.opened, *warnings, self.fill, self.refine, self.threshold, self.notes, self.loose):
            self.body.addWidget(part)
        self.view.context.selection_changed.connect(self._show_selection)
        self.buttons["edit"].clicked.connect(self.set_editing)
        self.tools.tool_wanted.connect(self.set_tool)
        self.tools.grid_switched.connect(self.set_snapping)
        self.tools.done.connect(lambda: self.set_editing(False))
        self.view.tool_left.connect(lambda: self.set_tool(Tool.POSE))
        self.view.editing_left.connect(lambda: self.set_editing(False))
        self.view.typed.connect(self._begin_text)
        self.tools.options.text.returnPressed.connect(self.view.lay_text)
        self.set_editing(False)
        self.show_target(None)

    def set_tool(self, tool: Tool) -> None:
        """Change what clicks on the target do; every tool but looking opens the editor, which stays with one."""
        if tool is not Tool.LOOK:
            self.set_editing(True)
        elif self.editing:
            tool = Tool.POSE
        self.tools.show_tool(tool)
        self.view.set_tool(tool)
        if tool is Tool.TEXT:
            self._begin_text()

    def _begin_text(self, letter: str = "") -> None:
        """Have the text typed before its box is dragged, from a first letter on that was typed on the board."""
        field = self.tools.options.text
        field.setFocus()
        field.selectAll()
        if letter:
            field.insert(letter)

    def set_editing(self, on: bool) -> None:
        """Show the tools and the board, or the target alone."""
        opens = on and not self.editing
        self.buttons["edit"].setChecked(on)
        for part in (self.tools, self.refine):
            part.setVisible(on)
        self.buttons["edit"].setVisible(not on)  # Done leaves the board
        self.opened.fold(on)
        if on != self.editing:
            self.editing = on
            self._show_reach_text()
            self.view.set_editing(on)
            self.editing_changed.emit(on)
            if not on and self.view.outline is not None:
                self.view.hint.emit(tr(DONE_HINT))
        self._show_selection()
        if opens or not on:
            self.set_tool(Tool.POSE if on else Tool.LOOK)

    def set_snapping(self, on: bool) -> None:
        """Show the grid and snap to it, or neither."""
        self.view.context.snapping = on
        self.tools.grid.setChecked(on)
        self.view.update()

    def show_target(
        self,
        outline: Outline | None,
        picture: Picture | None = None,
        objects: tuple[Outline, ...] = (),
        source: Outline | None = None,
    ) -> None:
        """Show the target in the size it is cut in, and the threshold of a traced picture.

        ``source`` is the same target as it was read, if its size was in pixels or unknown.
        """
        self.threshold.setVisible(picture is not None)
        if picture is not None:
            self.threshold.show_levels(picture.threshold, picture.automatic)
        elsewhere = outline is None or self.view.context.recall(outline) is None
        if elsewhere:
            self.set_tool(Tool.LOOK)
        under = self.view.underlay
        retraced = picture is not None and under is not None and under.path == picture.path
        self.view.show_outline(outline, picture, objects)
        if elsewhere and not retraced:  # the axes go through the middle of what is drawn on
            self.view.context.set_axis(self.view.context.mirror.axis)
        self.tools.show_target(outline is not None)
        self.refine.show_placed(self.view.context.placed)
        self._show_selection()
        self.buttons["clearTarget"].setEnabled(outline is not None)
        self.facts.setVisible(outline is not None)
        self.size_.setVisible(outline is not None)
        self._show_holes(outline)
        notes = outline.notes if outline is not None else ()
        self.notes.setText(notes[0] if len(notes) == 1 else "\n".join(f"• {note}" for note in notes[:3]))
        self.notes.setToolTip("\n".join(notes))
        self.notes.setVisible(bool(notes))
        if outline is not None:
            self.facts.setText(tr(outline.name))
            self.size_.setText(measured(outline if source is None or source.unit == "mm" else source))

    def _show_holes(self, outline: Outline | None) -> None:
        holes, filled = (0, 0) if outline is None else (len(outline.holes), len(outline.filled_holes))
        self.fill.setVisible(holes + filled > 0)
        with QSignalBlocker(self.fill):
            self.fill.setChecked(holes == 0)
        words = tr_n("{count} hole", "{count} holes", holes + filled)
        self.fill.setText(tr("Fi&ll holes ({holes})", holes=words))

    def arrangements(self) -> frozenset[str]:
        """What can be done with the selected objects while the board is open."""
        context = self.view.context
        return frozenset(name for name in EVERY if self.editing and context.can_arrange(name))

    def _show_selection(self) -> None:
        self.tools.options.pose.show_drawing(self.view.context.drawing)
        self.loose.setVisible(self.editing and bool(self.view.context.loose))

    def show_reach(self, grid: tuple[int, int]) -> None:
        """Mark on the drawing, and say, what a grid (rows, columns) can hardly show of the target."""
        placed = self.view.context.placed
        reach = None if placed is None else reach_of(placed.outline, grid)
        self.view.show_reach(reach)
        known = placed is not None and placed.outline.unit == "mm"
        self._reach_texts, self._turns_back = ("", ""), reach is not None and reach.turns_back > 0.0
        if placed is not None and reach is not None:
            self._reach_texts = reach_texts(reach, placed.outline, placed.scale if known else None)
        self._show_reach_text()

    def show_preview(self, preview: Preview | None) -> None:
        """Show a quick fit over the target, or none."""
        self.view.show_preview(None if preview is None else preview.design)
        if preview is None:
            self.preview.setText("")
            self.preview.setToolTip("")
            return
        rows, columns = preview.grid
        self.preview.setText(tr("Preview: match {percent:.1f} %", percent=100.0 * preview.match))
        self.preview.setToolTip(
            tr(
                "A quick fit on {rows} \N{MULTIPLICATION SIGN} {columns} voids, not checked as cut. Press Generate for "
                "designs.",
                rows=rows,
                columns=columns,
            )
        )

    def show_no_preview(self, sentence: str) -> None:
        """Say why there is no preview."""
        self.preview.setText(tr("No preview"))
        self.preview.setToolTip(sentence)

    def show_start_refusal(self, sentence: str) -> None:
        """Say why the next run would refuse the start; nothing where it would not, or that is not known."""
        self.start_refusal.setText(sentence, tr("The start folds on this grid"))
        self.start_refusal.setVisible(bool(sentence))

    def show_limit(self, sentence: str) -> None:
        """Say what no closed sheet shows of the target; "" for nothing."""
        self.limit.setText(sentence)
        self.limit.setToolTip(sentence)
        self.limit.setVisible(bool(sentence))
        self._show_reach_text()

    def show_cutting_time(self, sentence: str, brief: str) -> None:
        """Say before a run that cutting takes hours, or that the sheet is too small; "" for neither."""
        self.cutting.setText(sentence, brief)
        self.cutting.setToolTip(sentence)
        self.cutting.setVisible(bool(sentence))

    def _show_reach_text(self) -> None:
        whole, brief = self._reach_texts
        self.reach.setText(whole if self.editing else brief)
        self.reach.setToolTip(whole)
        said = self._turns_back and not self.limit.isHidden()  # the limit says the same of that notch
        self.reach.setVisible(bool(whole) and not said)

    def minimumSizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return QSize(250, 195)


def measured(outline: Outline) -> str:
    """Source size when it has a unit, else the number of corners."""
    if outline.size is None or not outline.unit:
        return tr_n("{count} point", "{count} points", len(outline.points))
    width, height = outline.size
    return tr("{width:.4g} \N{MULTIPLICATION SIGN} {height:.4g} {unit}", width=width, height=height, unit=outline.unit)


class RefineBar(QWidget):
    """Two sliders with a live preview, two lengths in mm."""

    proposed = Signal(str, float)  #: name of the slider, strength 0..1
    refined = Signal(str, float)
    size_wanted = Signal(float, float)  #: width and height, mm

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._ratio = 1.0
        self._size = (0.0, 0.0)
        self.sliders: dict[str, QSlider] = {}
        parts: list[Part] = []
        for name, caption, accessible, tip in SLIDERS:
            own = JumpSlider()
            own.setObjectName("threshold")
            own.setRange(0, REFINE_STEPS)
            own.setPageStep(REFINE_STEPS // 10)
            own.setAccessibleName(tr(accessible))
            own.setToolTip(tr(tip))
            own.setMinimumWidth(60)
            own.valueChanged.connect(lambda value, name=name: self._slide(name, value))
            own.sliderReleased.connect(lambda name=name: self._settle(name))
            self.sliders[name] = own
            parts += [label(tr(caption), own), (own, 1)]
        width = tr("Target width in mm; 3 in or 8.5 cm work too. The chain keeps proportions.")
        height = tr("Target height in mm; 3 in or 8.5 cm work too. The chain keeps proportions.")
        length = partial(decimal_field, LengthField, "", 0.1, LARGEST_MM, suffix=tr(" mm"), width=116)
        self.width_ = length(accessible=tr("Target width"), tip=width)
        self.height_ = length(accessible=tr("Target height"), tip=height)
        parts += [label(tr("Size"), self.width_), self.width_]
        parts += [label("\N{MULTIPLICATION SIGN}", self.height_), self.height_]
        self.proportions = ToolButton(
            "keepProportions", "chain", tr("Keep proportions. Off: change width and height separately."), True
        )
        self.proportions.setChecked(True)
        row(*parts, self.proportions, on=self, spacing=8)
        self.width_.valueChanged.connect(self._on_width)
        self.height_.valueChanged.connect(self._on_height)

    def _on_width(self, width: float) -> None:
        self.size_wanted.emit(width, width / self._ratio if self.proportions.isChecked() else self._size[1])

    def _on_height(self, height: float) -> None:
        self.size_wanted.emit(height * self._ratio if self.proportions.isChecked() else self._size[0], height)

    def show_placed(self, placed: Placed | None) -> None:
        """Show the target's size on the board."""
        self.setEnabled(placed is not None)
        for field in (self.width_, self.height_):
            field.setSpecialValueText("" if placed is not None else UNKNOWN)  # at the least value
        if placed is None:
            for field in (self.width_, self.height_):
                with QSignalBlocker(field):
                    field.setValue(field.minimum())
            return
        width, height = self._size = placed.size
        self._ratio = width / height
        for field, value in ((self.width_, width), (self.height_, height)):
            with QSignalBlocker(field):
                field.setValue(value)

    def restart(self) -> None:
        """The sliders stand for another target: nothing is simplified or smoothed yet."""
        for own in self.sliders.values():
            with QSignalBlocker(own):
                own.setValue(0)

    def _slide(self, name: str, value: int) -> None:
        for other, own in self.sliders.items():
            if other != name:
                with QSignalBlocker(own):
                    own.setValue(0)
        if self.sliders[name].isSliderDown():
            self.proposed.emit(name, value / REFINE_STEPS)
        else:
            self.refined.emit(name, value / REFINE_STEPS)

    def _settle(self, name: str) -> None:
        self.refined.emit(name, self.sliders[name].value() / REFINE_STEPS)


class JumpSlider(QSlider):
    """Goes to the pointer at once and stays down until the button is let go, so that a click shows before it counts."""

    def __init__(self) -> None:
        super().__init__(Qt.Orientation.Horizontal)

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        if event.button() is not Qt.MouseButton.LeftButton:
            event.ignore()
            return
        option = QStyleOptionSlider()
        self.initStyleOption(option)
        part = QStyle.SubControl.SC_SliderHandle
        handle = self.style().subControlRect(QStyle.ComplexControl.CC_Slider, option, part, self)
        self.setSliderDown(True)
        if not handle.contains(event.position().toPoint()):
            middle = Qt.MouseButton.MiddleButton  # with which sliders go to the pointer
            event = QMouseEvent(
                event.type(), event.position(), event.globalPosition(), middle, middle, event.modifiers()
            )
        super().mousePressEvent(event)


class ThresholdBar(QWidget):
    """Shown for targets that came from a picture; grey levels run from 0 (black) to 1 (white)."""

    changed = Signal(float)  #: grey level 0..1
    edited = Signal()  #: the drag is over

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        accessible = tr("Threshold between shape and background, from black to white")
        tip = tr("Grey level that separates shape from background: 0 % is black, 100 % white (arrow keys: 0.5 %)")
        self.slider = slider("threshold", accessible, tip, GREY_LEVELS - 1, GREY_LEVELS // 20, first=1)
        self.number = label()
        self.number.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self.number.setMinimumWidth(self.number.fontMetrics().horizontalAdvance("99.5 %"))
        self.automatic = push_button(tr("Auto"), tr("Reset to the automatic threshold"))
        caption = label(tr("&Threshold"), self.slider)
        row(caption, (self.slider, 1), self.number, self.automatic, on=self, spacing=8)
        self.slider.valueChanged.connect(self._on_level)
        self.slider.sliderReleased.connect(self.edited)

    def show_levels(self, threshold: float, automatic: float) -> None:
        """Show the level that holds, 0..1; a slider that is being dragged is left where it is."""
        if not self.slider.isSliderDown():
            with QSignalBlocker(self.slider):
                self.slider.setValue(round(GREY_LEVELS * threshold))
            self.number.setText(tr("{percent:.1f} %", percent=100 * threshold))
        self.automatic.setEnabled(threshold != automatic)

    def _on_level(self, value: int) -> None:
        self.number.setText(tr("{percent:.1f} %", percent=100 * value / GREY_LEVELS))
        self.changed.emit(value / GREY_LEVELS)
        if not self.slider.isSliderDown():
            self.edited.emit()
