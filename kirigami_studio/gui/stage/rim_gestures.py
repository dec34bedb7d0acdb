"""The handles of edge cuts in a layout view: which one is pointed at or selected, and what keys do to it.

:class:`~kirigami_studio.gui.stage.void_gestures.VoidGestures` owns the mouse; it asks here first.
"""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QObject, QPointF, Qt, Signal
from PySide6.QtGui import QKeyEvent, QPainter

from kirigami_studio.gui.stage.rim_items import RimShapes, paint_mouths
from kirigami_studio.gui.stage.void_items import VoidShapes
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.lattice.sheet import rim_table
from kirigami_studio.project.document import Void

#: Unit cells by which an arrow key moves an edge cut, and with Alt.
KEY_STEP, FINE_STEP = 0.05, 0.005
#: For each side (top, right, bottom, left): the keys that move a cut to lower and higher positions, and the key
#: that leaves it for the voids.
_KEYS = (
    (Qt.Key.Key_Left, Qt.Key.Key_Right, Qt.Key.Key_Down),
    (Qt.Key.Key_Up, Qt.Key.Key_Down, Qt.Key.Key_Left),
    (Qt.Key.Key_Left, Qt.Key.Key_Right, Qt.Key.Key_Up),
    (Qt.Key.Key_Up, Qt.Key.Key_Down, Qt.Key.Key_Right),
)
ARROWS = frozenset({Qt.Key.Key_Left, Qt.Key.Key_Right, Qt.Key.Key_Up, Qt.Key.Key_Down})


class RimHandles(QObject):
    """Edge cuts by their number in :class:`~kirigami_studio.lattice.sheet.RimTable`."""

    hovered = Signal(object)  #: int | None
    selection_changed = Signal()
    grasped = Signal(int, tuple, float)  #: edge cut; place in the world; angle (radians)
    pulled = Signal(tuple)  #: place in the world
    nudged = Signal(int, float)  #: edge cut; change of its position, unit cells

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.meant: int | None = None  #: pointed at or held
        self.selected: int | None = None  #: acted on by the keyboard

    def select(self, mouth: int | None) -> None:
        """Select this edge cut, or none."""
        if mouth != self.selected:
            self.selected = mouth
            self.selection_changed.emit()

    def point(self, shapes: VoidShapes | None, place: QPointF) -> bool:
        """Find the handle under the pointer; whether there is one.  Without shapes there is none."""
        mouth = None if shapes is None else _rim(shapes).mouth_at(place.x(), place.y())
        if mouth != self.meant:
            self.meant = mouth
            self.hovered.emit(mouth)
        return mouth is not None

    def follow(self, shapes: VoidShapes | None) -> None:
        """Another design is shown: forget an edge cut that it does not have."""
        count = 0 if shapes is None else len(rim_table(*shapes.design.deployment.sheet.grid).mouths)
        if self.selected is not None and self.selected >= count:
            self.select(None)

    def enter(self, shapes: VoidShapes, void: Void, down: int, right: int) -> bool:
        """Select the edge cut nearest to a void when a walk leaves the voids at a side; whether it did."""
        rows, columns = shapes.corners.shape[:2]
        row, column = void[0] + down, void[1] + right
        leaves = (row < 0, column >= columns, row >= rows, column < 0)
        if not any(leaves):
            return False
        mouths = np.flatnonzero(rim_table(rows, columns).side == leaves.index(True))
        if not mouths.size:
            return False
        middle = shapes.corners[void].mean(axis=0)
        distance = np.hypot(*(_rim(shapes).feet[mouths] - middle).T)
        self.select(int(mouths[distance.argmin()]))
        return True

    def take_key(self, event: QKeyEvent, shapes: VoidShapes) -> Void | None:
        """Move the selected edge cut by an arrow key; the void to go on with where the key leads back to the voids."""
        rows, columns = shapes.corners.shape[:2]
        mouth = self.selected
        if mouth is None:
            return None
        side = int(rim_table(rows, columns).side[mouth])
        lower, higher, leave = _KEYS[side]
        key = Qt.Key(event.key())
        step = FINE_STEP if event.modifiers() & Qt.KeyboardModifier.AltModifier else KEY_STEP
        if key in (lower, higher):
            self.nudged.emit(mouth, step if key is higher else -step)
        if key is not leave:
            return None
        middles = shapes.corners.mean(axis=2)
        line = ((0, slice(None)), (slice(None), columns - 1), (rows - 1, slice(None)), (slice(None), 0))[side]
        near = int(np.hypot(*(middles[line] - _rim(shapes).feet[mouth]).T).argmin())
        return ((0, near), (near, columns - 1), (rows - 1, near), (near, 0))[side]

    def paint(self, painter: QPainter, shapes: VoidShapes, palette: Palette) -> None:
        """Draw all handles."""
        paint_mouths(painter, _rim(shapes), self.meant, self.selected, palette)


def _rim(shapes: VoidShapes) -> RimShapes:
    return RimShapes.of(shapes.design, shapes.phi, shapes.transform)
