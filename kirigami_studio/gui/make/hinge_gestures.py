"""Mouse gestures on the connectors of a cut view: select, rubber band, drag a width, cut through."""

from __future__ import annotations

import math
from dataclasses import dataclass

from PySide6.QtCore import QObject, QPointF, QRectF, Qt, Signal

from kirigami_studio.gui.stage.connector_items import Connectors
from kirigami_studio.gui.widgets.view_transform import ViewTransform

#: Finished widths that a drag can reach, mm: those of the number field.
LIMITS_MM = (0.02, 20.0)
#: Pixels of a drag that make a connector twice as wide.
DOUBLING = 70.0
#: Widths snap to this, mm; with fine control to a tenth of it.
STEP_MM = 0.01
#: A press that moves less than this (pixels) is a click.
CLICK = 4.0


class HingeGestures(QObject):
    """Holds which connectors are selected, and the band that is being drawn."""

    changed = Signal()  #: selection, band or drag
    width_wanted = Signal(float)  #: mm, for the selection; step by step while one of them is dragged
    drag_ended = Signal()
    removal_wanted = Signal(bool)  #: whether to remove the selection, or to bring it back

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.connectors: Connectors | None = None
        self._selected: frozenset[int] = frozenset()
        self._pressed: QPointF | None = None
        self._adding = False
        self._band: QRectF | None = None
        self._held: HingeDrag | None = None
        self._width_mm: float | None = None
        self._asked_mm: dict[int, float] = {}  # widths that were asked for since the plan was made

    @property
    def dragged_mm(self) -> float | None:
        """The width that the drag has come to, mm; None without a drag."""
        return self._width_mm

    @property
    def selected(self) -> frozenset[int]:
        return self._selected

    @property
    def band(self) -> QRectF | None:
        """The rubber band, pixels."""
        return self._band

    def set_connectors(self, connectors: Connectors | None) -> None:
        """Another plan: the selection stays as far as its hinges are still there."""
        self.connectors = connectors
        self._asked_mm.clear()
        there = 0 if connectors is None else len(connectors)
        self.select(frozenset(hinge for hinge in self._selected if hinge < there))

    def select(self, hinges: frozenset[int]) -> None:
        """Select these and no others."""
        if hinges != self._selected:
            self._selected = hinges
            self.changed.emit()

    def walk(self, step: int) -> None:
        """Select the next connector by number, or the one before."""
        if self.connectors is not None and len(self.connectors):
            start = max(self._selected, default=-1) if step > 0 else min(self._selected, default=0)
            self.select(frozenset({(start + step) % len(self.connectors)}))

    def press(self, place: QPointF, transform: ViewTransform, adding: bool) -> bool:
        """The left button went down; whether the press belongs to the connectors."""
        self._pressed, self._adding = place, adding
        hinge = None if self.connectors is None else self.connectors.nearest(place, transform)
        if hinge is None:
            return adding
        self._pressed = None
        if adding:
            self.select(self._selected ^ {hinge})
            return True
        if hinge not in self._selected:
            self.select(frozenset({hinge}))
        if self.connectors is not None:
            self._held = HingeDrag(hinge, place, self._asked_mm.get(hinge, self.connectors.asked_mm(hinge)))
        return True

    def double_click(self, place: QPointF, transform: ViewTransform) -> bool:
        """A double click; on a connector it is cut through, or brought back where it was."""
        hinge = None if self.connectors is None else self.connectors.nearest(place, transform)
        if hinge is None or self.connectors is None:
            return False
        self._held = None
        self.select(frozenset({hinge}))
        self.removal_wanted.emit(not self.connectors.removed[hinge])
        return True

    def move(self, place: QPointF, fine: bool = False) -> bool:
        """The mouse moved with the button down; whether a band is being drawn or a connector dragged."""
        if self._held is not None:
            self._drag(self._held, place, fine)
            return True
        if self._pressed is None or not self._adding:
            return False
        self._band = QRectF(self._pressed, place).normalized()
        self.changed.emit()
        return True

    def _drag(self, drag: HingeDrag, place: QPointF, fine: bool) -> None:
        far = (place - drag.start).manhattanLength() >= CLICK
        if math.isnan(drag.width_mm) or not (far or self._width_mm is not None):
            return
        width = drag.width_at(place, fine)
        if width != self._width_mm:
            self._width_mm = width
            self._asked_mm.update(dict.fromkeys(self._selected, width))
            self.width_wanted.emit(width)
            self.changed.emit()

    def _end_drag(self, drag: HingeDrag) -> None:
        """A drag is over; a click on one of many selects that one."""
        self._held = None
        if self._width_mm is None:
            self.select(frozenset({drag.hinge}))
        else:
            self._width_mm = None
            self.drag_ended.emit()
            self.changed.emit()

    def release(self, place: QPointF, transform: ViewTransform) -> None:
        """The button came up: the band selects; a click beside all connectors forgets the selection."""
        if self._held is not None:
            self._end_drag(self._held)
            return
        pressed, band = self._pressed, self._band
        self._pressed, self._band = None, None
        if band is not None and self.connectors is not None:
            self.select(self._selected | self.connectors.within(band, transform))
            self.changed.emit()
        elif pressed is not None and not self._adding and (place - pressed).manhattanLength() < CLICK:
            self.select(frozenset())


@dataclass(frozen=True, slots=True)
class HingeDrag:
    """Where the drag began."""

    hinge: int
    start: QPointF
    width_mm: float  #: Finished width there; not a number where the connector was removed

    def width_at(self, place: QPointF, fine: bool) -> float:
        """Width in mm that a place of the mouse asks for; ``fine`` makes steps and distances a tenth."""
        moved = (place.x() - self.start.x()) - (place.y() - self.start.y())
        step, doubling = (0.1 * STEP_MM, 10.0 * DOUBLING) if fine else (STEP_MM, DOUBLING)
        wanted = self.width_mm * math.pow(2.0, min(max(moved / doubling, -20.0), 20.0))
        low, high = LIMITS_MM
        return min(max(round(wanted / step) * step, low), high)


def adds(modifiers: Qt.KeyboardModifier) -> bool:
    """Whether a press adds to what is selected."""
    return bool(modifiers & (Qt.KeyboardModifier.ShiftModifier | Qt.KeyboardModifier.ControlModifier))
