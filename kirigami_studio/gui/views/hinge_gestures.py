"""What the mouse and the keyboard do to the connectors of a cut view: pick one, add more, draw a band around many."""

from __future__ import annotations

from PySide6.QtCore import QObject, QPointF, QRectF, Qt, Signal

from kirigami_studio.gui.scene.connector_items import Connectors
from kirigami_studio.gui.scene.frame import Frame

#: A press that moves less than this (pixels) is a click.
CLICK = 4.0


class HingeGestures(QObject):
    """Holds which connectors are selected, and the band that is being drawn."""

    changed = Signal()  #: selection or band

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.connectors: Connectors | None = None
        self._selected: frozenset[int] = frozenset()
        self._pressed: QPointF | None = None
        self._adding = False
        self._band: QRectF | None = None

    @property
    def selected(self) -> frozenset[int]:
        return self._selected

    @property
    def band(self) -> QRectF | None:
        """The rubber band, pixels."""
        return self._band

    def take(self, connectors: Connectors | None) -> None:
        """Another plan: the selection stays as far as its hinges are still there."""
        self.connectors = connectors
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

    def press(self, place: QPointF, frame: Frame, adding: bool) -> bool:
        """The left button went down; whether the press belongs to the connectors."""
        self._pressed, self._adding = place, adding
        hinge = None if self.connectors is None else self.connectors.nearest(place, frame)
        if hinge is None:
            return adding
        self.select(self._selected ^ {hinge} if adding else frozenset({hinge}))
        self._pressed = None
        return True

    def move(self, place: QPointF) -> bool:
        """The mouse moved with the button down; whether a band is being drawn."""
        if self._pressed is None or not self._adding:
            return False
        self._band = QRectF(self._pressed, place).normalized()
        self.changed.emit()
        return True

    def release(self, place: QPointF, frame: Frame) -> None:
        """The button came up: the band selects; a click beside all connectors forgets the selection."""
        pressed, band = self._pressed, self._band
        self._pressed, self._band = None, None
        if band is not None and self.connectors is not None:
            self.select(self._selected | self.connectors.within(band, frame))
            self.changed.emit()
        elif pressed is not None and not self._adding and (place - pressed).manhattanLength() < CLICK:
            self.select(frozenset())


def adds(modifiers: Qt.KeyboardModifier) -> bool:
    """Whether a press adds to what is selected."""
    return bool(modifiers & (Qt.KeyboardModifier.ShiftModifier | Qt.KeyboardModifier.ControlModifier))
