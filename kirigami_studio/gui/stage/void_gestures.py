"""Mouse and keyboard gestures on the voids of a layout view: point, drag, wheel, lock, move outline or edge cuts.

Pointing always works.  The rest belongs to the mode "edit by hand"; events that it does not use pan and zoom.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from PySide6.QtCore import QEvent, QObject, QPoint, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QContextMenuEvent, QKeyEvent, QMouseEvent, QPainter, QWheelEvent

from kirigami_studio.gui.stage.edge_cuts import ARROWS, RimHandles
from kirigami_studio.gui.stage.void_items import (
    VoidShapes,
    paint_band,
    paint_handles,
    paint_label,
    paint_locks,
    paint_marked,
)
from kirigami_studio.gui.widgets.canvas import Canvas
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.project.document import Void

#: log10 of the factor by which one notch of the wheel, or a press of + or -, changes a ratio: 5 %, or 0.5 % with Shift.
NOTCH, FINE_NOTCH = 0.0212, 0.00217
#: A press that moves less than this (pixels) is a click.
CLICK = 4.0
LEFT = Qt.MouseButton.LeftButton
_WALKS = {
    Qt.Key.Key_Left: (0, -1),
    Qt.Key.Key_Right: (0, 1),
    Qt.Key.Key_Up: (-1, 0),
    Qt.Key.Key_Down: (1, 0),
}
#: Shift is part of "+" on many keyboards, so that Alt asks for fine steps here.
_TURNS = {Qt.Key.Key_Plus: 1, Qt.Key.Key_Equal: 1, Qt.Key.Key_Minus: -1, Qt.Key.Key_Underscore: -1}


class VoidGestures(QObject):
    """Holds what is pointed at and selected, and turns events of one canvas into requests.

    Parameters
    ----------
    canvas : Canvas
        The view whose events are watched.
    shapes : callable
        The design as it is drawn now, or None.
    """

    hovered = Signal(object)  #: Void | None
    selection_changed = Signal(frozenset)  #: of Void
    nudged = Signal(frozenset, float)  #: of Void; change of log10 of their ratios
    pull_begun = Signal(tuple, tuple, float)  #: Void; place in the world; angle (radians)
    vertex_begun = Signal(int, float)  #: vertex of the outline; angle (radians)
    dragged = Signal(tuple)  #: place in the world that a void, a vertex or an edge cut is dragged to
    drag_ended = Signal()  #: of a void, a vertex or an edge cut
    drag_cancelled = Signal()  #: Esc while a void, a vertex or an edge cut is held
    lock_wanted = Signal(frozenset, bool)  #: of Void; whether they are to be locked
    menu_wanted = Signal(tuple, QPoint)  #: Void; place on the screen

    def __init__(self, canvas: Canvas, shapes: Callable[[], VoidShapes | None]) -> None:
        super().__init__(canvas)
        self._canvas, self._shapes = canvas, shapes
        self.rim = RimHandles(self)
        self.on, self.enabled = False, True
        self.locked: frozenset[Void] = frozenset()
        self.lines: tuple[str, ...] = ()  # of the label at the pointer
        self.selected: frozenset[Void] = frozenset()  #: acted on by the keyboard and the bar
        self.void: Void | None = None  #: pointed at
        self.vertex: int | None = None  #: of the outline, pointed at or held
        self._pointer = QPointF()
        self._pressed: QPointF | None = None
        self._grasp: Callable[[float], None] | None = None  # begins, at an angle, the drag that a press may become
        self.dragging = False  #: whether a void, a vertex or an edge cut is held
        self._band: QRectF | None = None
        canvas.setMouseTracking(True)
        canvas.installEventFilter(self)

    def switch(self, on: bool) -> None:
        """Begin or end editing by hand."""
        self.on = on
        self.drop()
        self.vertex = None
        if not on:
            self.select(frozenset())
            self.rim.select(None)
            self.rim.point(None, self._pointer)
        self._canvas.unsetCursor()
        self._canvas.update()

    def enable(self, enabled: bool) -> None:
        """Whether there is a design that may be changed now."""
        if enabled != self.enabled:
            self.enabled = enabled
            self.drop()
            self._canvas.update()

    @property
    def active(self) -> bool:
        """Whether gestures change the design."""
        return self.on and self.enabled

    def set_locked(self, locked: frozenset[Void]) -> None:
        """These voids are locked."""
        if locked != self.locked:
            self.locked = locked
            self._canvas.update()

    def select(self, voids: frozenset[Void]) -> None:
        """Select these and no others."""
        if voids:
            self.rim.select(None)
        if voids != self.selected:
            self.selected = voids
            self.selection_changed.emit(voids)
            self._canvas.update()

    def point_at(self, void: Void) -> None:
        """Point at a void without a mouse."""
        shapes = self._shapes()
        if shapes is not None:
            self._point(QPointF(*shapes.corners[void].mean(axis=0).tolist()))

    def follow(self) -> None:
        """Another design is shown: forget voids that it does not have, and look again what is under the pointer."""
        shapes = self._shapes()
        rows, columns = (0, 0) if shapes is None else shapes.corners.shape[:2]
        self.select(frozenset(void for void in self.selected if void[0] < rows and void[1] < columns))
        self.rim.follow(shapes)
        if shapes is None:
            self.drop()
        if not self.dragging and self._canvas.underMouse():
            self._point(self._pointer)
        elif shapes is None:
            self._leave()

    def drop(self) -> None:
        """End the gesture under way."""
        dragging = self.dragging
        self._pressed = self._grasp = self._band = None
        self.dragging = False
        if dragging:
            self.drag_ended.emit()

    # drawing -------------------------------------------------------------------------------------------------------

    def paint(self, painter: QPainter, palette: Palette) -> None:
        """Draw what is locked, selected, pointed at, and what can be held."""
        shapes = self._shapes()
        if shapes is None:
            return
        rows, columns = shapes.corners.shape[:2]
        paint_locks(painter, shapes, [void for void in self.locked if void[0] < rows and void[1] < columns], palette)
        if self.active and shapes.movable:
            paint_handles(painter, shapes, self.vertex, palette)
        if self.active:
            self.rim.paint(painter, shapes, palette)
        if self.active:
            paint_marked(painter, shapes, sorted(self.selected), palette, 3.0)
        if self.void is not None and self.void not in self.selected:
            paint_marked(painter, shapes, [self.void], palette, 2.0 if self.active else 1.4)
        if self._band is not None:
            paint_band(painter, self._band, palette)

    def paint_label(self, painter: QPainter, palette: Palette) -> None:
        """Draw the label at the pointer."""
        if self.lines and (self.void is not None or self.rim.meant is not None or self.dragging):
            paint_label(painter, self.lines, self._pointer, QRectF(self._canvas.rect()), palette)

    # events --------------------------------------------------------------------------------------------------------

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        kind = event.type()
        if isinstance(event, QKeyEvent):
            return self._on_key(event)
        if isinstance(event, QWheelEvent):
            return self._on_wheel(event)
        if isinstance(event, QContextMenuEvent):
            return self._request_menu(event)
        if kind == QEvent.Type.ToolTip:
            return self.void is not None or self.rim.meant is not None  # the label at the pointer tells
        if kind == QEvent.Type.Leave:
            self._leave()
        elif isinstance(event, QMouseEvent):
            if kind == QEvent.Type.MouseButtonPress:
                return self._press(event)
            if kind == QEvent.Type.MouseButtonDblClick:
                return self.active and self._hits(event.position())
            if kind == QEvent.Type.MouseMove:
                return self._move(event)
            if kind == QEvent.Type.MouseButtonRelease:
                return self._release(event)
        return False

    def _press(self, event: QMouseEvent) -> bool:
        shapes, place = self._shapes(), event.position()
        self._point(place)
        if not self.active or shapes is None or event.button() != LEFT:
            return False
        self._canvas.setFocus(Qt.FocusReason.MouseFocusReason)
        adding = bool(event.modifiers() & (Qt.KeyboardModifier.ShiftModifier | Qt.KeyboardModifier.ControlModifier))
        void, vertex, mouth = self.void, self.vertex, self.rim.meant
        if event.modifiers() & Qt.KeyboardModifier.AltModifier and void is not None:
            self.lock_wanted.emit(frozenset({void}), void not in self.locked)
            return True
        if adding:
            self._pressed = place
            return True
        if mouth is not None:
            self.select(frozenset())
            self.rim.select(mouth)
            self._grasp = partial(self.rim.grasped.emit, mouth, shapes.transform.to_world(place))
        elif vertex is not None:
            self._grasp = partial(self.vertex_begun.emit, vertex)
        elif void is not None:
            self.select(frozenset({void}))
            self._grasp = partial(self.pull_begun.emit, void, shapes.transform.to_world(place))
        else:
            return False
        self._pressed = place
        return True

    def _move(self, event: QMouseEvent) -> bool:
        shapes, place = self._shapes(), event.position()
        if self._pressed is None:
            if event.buttons() == Qt.MouseButton.NoButton:
                self._point(place)
            return False
        self._pointer = place
        far = (place - self._pressed).manhattanLength() >= CLICK
        if self._grasp is None and far:
            self._band = QRectF(self._pressed, place).normalized()
        elif self._grasp is not None and not self.dragging and far and shapes is not None:
            self._canvas.setCursor(Qt.CursorShape.ClosedHandCursor)
            self.dragging = True
            self._grasp(shapes.phi)
        if self.dragging and shapes is not None:
            self.dragged.emit(shapes.transform.to_world(place))
        self._canvas.update()
        return True

    def _release(self, event: QMouseEvent) -> bool:
        if self._pressed is None or event.button() != LEFT:
            return False
        shapes, band, grasped = self._shapes(), self._band, self._grasp is not None
        void = self.void
        self.drop()
        self._canvas.unsetCursor()
        if band is not None and shapes is not None:
            self.select(self.selected | shapes.voids_within(band.left(), band.top(), band.right(), band.bottom()))
        elif not grasped and void is not None:  # a click that adds
            self.select(self.selected ^ {void})
        self._point(event.position())
        return True

    def _on_wheel(self, event: QWheelEvent) -> bool:
        self._point(event.position())
        if not self.active or self.void is None or event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            return False
        delta = event.angleDelta()
        notches = (delta.y() or delta.x()) / 120.0
        fine = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
        if notches:
            if self.void not in self.selected:
                self.select(frozenset({self.void}))
            self.nudged.emit(self.selected, notches * (FINE_NOTCH if fine else NOTCH))
        event.accept()
        return True

    def _on_key(self, event: QKeyEvent) -> bool:
        """Arrows walk from void to void or move an edge cut, + and - change the ratio; the window has other keys."""
        if self.dragging and event.key() == Qt.Key.Key_Escape:
            self._cancel_drag(event)
            return True
        shapes = self._shapes()
        if self.active and shapes is not None and self.rim.selected is not None and _moves_mouth(event):
            self._move_mouth(event, shapes)
            return True
        step = step_of(event) if self.active else None
        if step is None or shapes is None:
            return False
        if event.type() == QEvent.Type.ShortcutOverride:
            event.accept()
            return True
        if event.type() != QEvent.Type.KeyPress:
            return False
        if step.direction:
            self.nudged.emit(self.selected, step.direction * (FINE_NOTCH if step.fine else NOTCH))
        else:
            self._walk(step, shapes)
        return True

    def _cancel_drag(self, event: QKeyEvent) -> None:
        """Esc cancels the drag: Qt asks first whose key it is (ShortcutOverride), then sends it."""
        event.accept()
        if event.type() == QEvent.Type.KeyPress:
            self._pressed = self._grasp = None
            self.dragging = False
            self._canvas.unsetCursor()
            self.drag_cancelled.emit()

    def _move_mouth(self, event: QKeyEvent, shapes: VoidShapes) -> None:
        event.accept()
        if event.type() == QEvent.Type.KeyPress:
            void = self.rim.take_key(event, shapes)
            if void is not None:
                self.select(frozenset({void}))

    def _walk(self, step: KeyStep, shapes: VoidShapes) -> None:
        rows, columns = shapes.corners.shape[:2]
        start = min(self.selected) if self.selected else self.void
        if start is not None and self.rim.enter(shapes, start, step.down, step.right):
            self.select(frozenset())
            return
        row, column = (0, 0) if start is None else (start[0] + step.down, start[1] + step.right)
        self.select(frozenset({(min(max(row, 0), rows - 1), min(max(column, 0), columns - 1))}))

    def _request_menu(self, event: QContextMenuEvent) -> bool:
        self._point(QPointF(event.pos()))
        if not self.active or self.void is None:
            return False
        if self.void not in self.selected:
            self.select(frozenset({self.void}))
        self.menu_wanted.emit(self.void, event.globalPos())
        return True

    # pointing ------------------------------------------------------------------------------------------------------

    def _hits(self, place: QPointF) -> bool:
        self._point(place)
        return self.void is not None or self.vertex is not None or self.rim.meant is not None

    def _point(self, place: QPointF) -> None:
        """Find what is under the pointer."""
        shapes = self._shapes()
        self._pointer = place
        on_rim = self.rim.point(shapes if self.active else None, place)
        vertex = shapes.vertex_at(place.x(), place.y()) if shapes is not None and self.active and not on_rim else None
        void = None if shapes is None or vertex is not None or on_rim else shapes.void_at(place.x(), place.y())
        if self.active and self._grasp is None:
            draggable = void is not None or vertex is not None or on_rim
            self._canvas.setCursor(Qt.CursorShape.OpenHandCursor if draggable else Qt.CursorShape.ArrowCursor)
        if vertex != self.vertex or void != self.void or void is not None:
            self.vertex, self.void = vertex, void
            self.hovered.emit(void)
            self._canvas.update()

    def _leave(self) -> None:
        if not self.dragging:
            self.rim.point(None, self._pointer)
        self.vertex = None if not self.dragging else self.vertex
        if self.void is not None:
            self.void = None
            self.hovered.emit(None)
        self._canvas.update()


def _moves_mouth(event: QKeyEvent) -> bool:
    """Whether a key is for the selected edge cut; Ctrl and Shift stay with the window."""
    mine = Qt.KeyboardModifier.AltModifier | Qt.KeyboardModifier.KeypadModifier
    return Qt.Key(event.key()) in ARROWS and not event.modifiers() & ~mine


@dataclass(frozen=True, slots=True)
class KeyStep:
    """A walk to another void, or a change of the ratio."""

    #: down, right: rows and columns to walk.
    down: int = 0
    right: int = 0
    direction: int = 0  #: 1 for a larger ratio, -1 for a smaller one, 0 for a walk
    fine: bool = False


def step_of(event: QKeyEvent) -> KeyStep | None:
    """What a key asks for, if anything; Ctrl and the keys of the window stay with the window."""
    key, modifiers = Qt.Key(event.key()), event.modifiers()
    if modifiers & Qt.KeyboardModifier.ControlModifier:
        return None
    fine = bool(modifiers & Qt.KeyboardModifier.AltModifier)
    if key in _WALKS and not fine:
        down, right = _WALKS[key]
        return KeyStep(down, right)
    if key in _TURNS:
        return KeyStep(direction=_TURNS[key], fine=fine)
    return None
