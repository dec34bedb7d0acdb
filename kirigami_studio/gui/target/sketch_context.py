"""What the tools of the target view share: the board, the grid, the mode, pointer events and finished changes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QObject, QPointF, Qt, Signal
from PySide6.QtGui import QKeyEvent, QPainter

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.words import ShownUnit, mark, tr
from kirigami_studio.gui.target.arrangements import EVERY
from kirigami_studio.gui.widgets.readable import round_step
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.widgets.view_transform import Bounds, ViewTransform
from kirigami_studio.outlines.combining import Combine
from kirigami_studio.outlines.drawing import NO_GUIDES, Drawing, Guides
from kirigami_studio.outlines.figures import USUAL_WAIST, Figure
from kirigami_studio.outlines.mirroring import Axis, Mirror
from kirigami_studio.outlines.nodes import Kind
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.placed import BOARD_MM, Placed

Place = tuple[float, float]
#: The empty board, mm.
BOARD = Bounds(-0.5 * BOARD_MM, -0.5 * BOARD_MM, 0.5 * BOARD_MM, 0.5 * BOARD_MM)
#: Lines of the grid are at least this far apart, pixels.
CLOSEST_LINES = 14.0
#: Guides catch what comes this near, pixels.
GUIDE_REACH = 7.0
#: Placed outlines that are remembered, so that undo puts a target back where it was.
CAPACITY = 256
#: What a target is called that was drawn in one stroke, corner by corner, or as text.
FREEHAND, POLYGON, TEXT = "drawing", "polygon", "text"
#: What the Undo menu says when a shape is drawn, added or subtracted, by the shape's name.
SHAPE_LABELS = {
    FREEHAND: (mark("Draw freehand"), mark("Add freehand shape"), mark("Subtract freehand shape")),
    POLYGON: (mark("Draw polygon"), mark("Add polygon"), mark("Subtract polygon")),
    TEXT: (mark("Draw text"), mark("Add text"), mark("Subtract text")),
    Figure.RECTANGLE.value: (mark("Draw rectangle"), mark("Add rectangle"), mark("Subtract rectangle")),
    Figure.ELLIPSE.value: (mark("Draw ellipse"), mark("Add ellipse"), mark("Subtract ellipse")),
    Figure.REGULAR.value: (mark("Draw regular polygon"), mark("Add regular polygon"), mark("Subtract regular polygon")),
    Figure.STAR.value: (mark("Draw star"), mark("Add star"), mark("Subtract star")),
}
SHIFT, ALT = Qt.KeyboardModifier.ShiftModifier, Qt.KeyboardModifier.AltModifier
#: Arrow keys move by the first, with Shift by the second, with Alt by the third, mm.
NUDGE_MM, FAR_MM, NEAR_MM = 1.0, 10.0, 0.1
ARROWS = {
    Qt.Key.Key_Left: (-1, 0),
    Qt.Key.Key_Right: (1, 0),
    Qt.Key.Key_Up: (0, 1),
    Qt.Key.Key_Down: (0, -1),
}


@dataclass(frozen=True, slots=True)
class PointerEvent:
    """Where the pointer is."""

    pixel: QPointF
    #: free, place: (x, y), mm; there, and at the nearest crossing of the grid when snapping holds.
    free: Place
    place: Place
    #: shift, alt: whether these keys are held.
    shift: bool
    alt: bool = False
    snaps: bool = False  #: whether snapping holds


@dataclass(frozen=True, slots=True)
class Change:
    """A finished gesture."""

    gesture: str  #: as it follows the word Undo: "Add star"
    #: Returns the shape that takes the place of the active object, or the whole new drawing; raises a TargetError when
    #: there can be none.
    make: Callable[[], Placed | Drawing]
    merge_key: str | None = None  #: changes of one key that follow each other undo together


class SketchContext(QObject):
    """The drawing board with its target; tools read it and report to it."""

    changed = Signal(Change)
    repaint = Signal()
    tool_done = Signal()
    mirror_changed = Signal()
    kind_wanted = Signal(Kind)  #: that the selected points shall have
    kinds_shown = Signal(frozenset)  #: kinds of the selected points
    guides_changed = Signal(str)  #: by a finished gesture, as it follows the word Undo
    selection_changed = Signal()  #: other objects are selected, or others are there

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.transform = ViewTransform(1.0, (0.0, 0.0))
        self.placed: Placed | None = None
        self.drawing = Drawing()
        self.loose: frozenset[int] = frozenset()
        self.combine = Combine.NEW
        self.snapping = True
        self.corners = 5
        self.waist = USUAL_WAIST
        self.text = "K"
        self.family, self.bold, self.italic = "", True, False
        self.mirror = Mirror()
        self.guides = NO_GUIDES
        self.guides_shown = 0  # how often others were laid on the board, as by an undo
        self._nudges = 0
        self._places: dict[tuple[object, ...], Placed] = {}

    @property
    def active(self) -> Placed | None:
        """The object whose points are edited."""
        index = self.drawing.active
        return None if index is None else self.drawing.objects[index]

    def show(self, target: Placed | None, objects: tuple[Placed, ...]) -> None:
        """Lay a target and its objects on the board; what was selected stays so while the objects are as many."""
        same = len(objects) == len(self.drawing.objects)
        self.placed, self.drawing = target, Drawing(objects, self.drawing.selected if same else frozenset())
        self.loose = self.drawing.united().loose if len(objects) > 1 else frozenset()
        self.selection_changed.emit()

    def show_guides(self, guides: Guides) -> None:
        """Lay other guides on the board."""
        self.guides_shown += 1
        if guides != self.guides:
            self.guides = guides
            self.repaint.emit()

    def select(self, indices: Iterable[int]) -> None:
        """Select objects."""
        wanted = self.drawing.select(indices)
        if wanted.selected != self.drawing.selected:
            self.drawing = wanted
            self.selection_changed.emit()
            self.repaint.emit()

    def remember(self, placed: Placed) -> None:
        """Keep where an outline lies on the board."""
        key = _key(placed.outline)
        self._places.pop(key, None)
        self._places[key] = placed
        while len(self._places) > CAPACITY:
            del self._places[next(iter(self._places))]

    def recall(self, outline: Outline) -> Placed | None:
        """Where an outline was drawn; None for one that came from elsewhere."""
        return self._places.get(_key(outline))

    @property
    def step(self) -> float:
        """Distance of the grid's lines, mm: 1, 2 or 5 times a power of ten mm or inches."""
        return round_step(CLOSEST_LINES / self.transform.scale, ShownUnit.mm())

    def pointer(self, pixel: QPointF, modifiers: Qt.KeyboardModifier) -> PointerEvent:
        """Where a pixel lies on the board; Ctrl suspends snapping."""
        free = self.transform.to_world(pixel)
        snaps = self.snapping and not modifiers & Qt.KeyboardModifier.ControlModifier
        place = (self._caught(free[0], 0), self._caught(free[1], 1)) if snaps else free
        shift, alt = (bool(modifiers & key) for key in (SHIFT, ALT))
        return PointerEvent(pixel, free, place, shift, alt, snaps)

    def _caught(self, length: float, axis: int) -> float:
        """The guide nearby along an axis, else the nearest line of the grid, mm."""
        guide = min(self.guides[axis], key=lambda at: abs(at - length), default=None)
        if guide is not None and abs(guide - length) * self.transform.scale <= GUIDE_REACH:
            return guide
        return self.snapped(length)

    def snapped(self, length: float) -> float:
        """The nearest line of the grid, mm."""
        step = self.step
        return round(length / step) * step

    def snapped_way(self, low: FloatArray, high: FloatArray, way: FloatArray) -> FloatArray:
        """A way (2,), mm, after which a side or the middle of a box lies on a guide nearby, else its lower left corner
        on the grid.
        """
        caught = []
        for axis in (0, 1):
            sides = [float(side[axis]) for side in (low, 0.5 * (low + high), high)]
            ways = [at - side for at in self.guides[axis] for side in sides]
            nearest = min(ways, key=lambda each: abs(each - way[axis]), default=math.inf)
            near = abs(nearest - way[axis]) * self.transform.scale <= GUIDE_REACH
            caught.append(nearest if near else self.snapped(float(low[axis] + way[axis])) - float(low[axis]))
        return np.array(caught)

    def can_arrange(self, name: str) -> bool:
        """Whether an arrangement has enough objects."""
        needed = EVERY[name].least
        return bool(self.loose) if needed == 0 else len(self.drawing.chosen) >= needed

    def arrange(self, name: str) -> None:
        """Change the selected objects by an arrangement of the table."""
        one, drawing = EVERY[name], self.drawing
        if self.can_arrange(name):
            self.changed.emit(Change(one.gesture, lambda: one.make(drawing)))

    def set_axis(self, axis: Axis) -> None:
        """Mirror what is drawn from now on about axes through the middle of the target, or of the empty board."""
        self.mirror = Mirror(axis, (0.0, 0.0) if self.placed is None else middle_of(self.placed))
        self.mirror_changed.emit()
        self.repaint.emit()

    def nudge(self, event: QKeyEvent) -> tuple[FloatArray, str] | None:
        """The shift (2,), mm, that an arrow key stands for, and the key of its undo step; None for another key.

        A key that is held down is one step.
        """
        direction = ARROWS.get(Qt.Key(event.key()))
        if direction is None or event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            return None
        if not event.isAutoRepeat():
            self._nudges += 1
        length = FAR_MM if event.modifiers() & SHIFT else NEAR_MM if event.modifiers() & ALT else NUDGE_MM
        return np.array(direction) * length, f"nudge {self._nudges}"

    def draw(self, make: Callable[[], Placed], name: str) -> None:
        """Let a new shape be another object, or join those that it overlaps; another object ends the tool."""
        how, drawing, mirror = self.combine, self.drawing, self.mirror
        new = how is Combine.NEW or not drawing.objects
        gesture = _change_name(Combine.NEW if new else how, name)
        if mirror.axis is not Axis.NONE:
            gesture = tr("{gesture}, mirrored", gesture=gesture)
        self.changed.emit(Change(gesture, lambda: drawing.with_drawn(make(), how, name, mirror)))
        if new:
            self.tool_done.emit()


class SketchTool:
    """A tool that does nothing; subclasses override what they need."""

    hint = ""  #: what to do, one or two sentences for the status line
    cursor = Qt.CursorShape.CrossCursor

    def __init__(self, context: SketchContext) -> None:
        self.context = context

    def press(self, pointer: PointerEvent) -> None:
        """The left button goes down."""

    def move(self, pointer: PointerEvent, held: bool) -> None:
        """The pointer moves, with the left button held or not."""

    def release(self, pointer: PointerEvent) -> None:
        """The left button goes up."""

    def double_click(self, pointer: PointerEvent) -> None:
        """The left button goes down for the second time."""

    def key(self, event: QKeyEvent) -> bool:
        """A key goes down; whether the tool had a use for it."""
        return False

    @property
    def busy(self) -> bool:
        """Whether a gesture is under way that :meth:`drop` would cancel."""
        return False

    def drop(self) -> None:
        """Cancel the gesture under way."""

    def deselect(self) -> bool:
        """Select nothing; whether anything was selected."""
        return False

    def select_at(self, pixel: QPointF) -> None:
        """Select what is there, before its menu opens."""

    def selected_box(self) -> Bounds | None:
        """The box around what is selected, else around the target, mm."""
        return None if self.context.placed is None else Bounds.of(self.context.placed.ring)

    def sync(self) -> None:
        """The target is another one now."""
        self.drop()

    def paint(self, painter: QPainter, transform: ViewTransform, palette: Palette) -> None:
        """Draw what the tool is about to do."""


def middle_of(placed: Placed) -> tuple[float, float]:
    """The middle of a target's box, mm."""
    ring = placed.ring
    x, y = (0.5 * (ring.min(axis=0) + ring.max(axis=0))).tolist()
    return x, y


def distance(one: QPointF, other: QPointF) -> float:
    """Pixels between two positions."""
    return math.hypot(one.x() - other.x(), one.y() - other.y())


def _change_name(how: Combine, name: str) -> str:
    """What the Undo menu says of a drawn shape."""
    if how is Combine.INTERSECT:
        return tr("Intersect with a shape")
    draw, add, subtract = (tr(label) for label in SHAPE_LABELS[name])
    return {Combine.NEW: draw, Combine.ADD: add, Combine.SUBTRACT: subtract}[how]


def _key(outline: Outline) -> tuple[object, ...]:
    """The key of a drawn outline; equal outlines at other places have other keys."""
    return outline, outline.size, outline.place, outline.nodes
