"""What the tools of the target view share: the board, the grid, the mode, and where finished changes go."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from PySide6.QtCore import QObject, QPointF, Qt, Signal
from PySide6.QtGui import QKeyEvent, QPainter

from kirigami_studio.gui.scene.frame import Bounds, Frame
from kirigami_studio.gui.theme import Palette
from kirigami_studio.target.combining import Combine, combined
from kirigami_studio.target.figures import USUAL_WAIST
from kirigami_studio.target.outline import Outline
from kirigami_studio.target.placed import BOARD_MM, Placed

FloatArray = npt.NDArray[np.float64]
Place = tuple[float, float]

#: The empty board, mm.
BOARD = Bounds(-0.5 * BOARD_MM, -0.5 * BOARD_MM, 0.5 * BOARD_MM, 0.5 * BOARD_MM)
#: Lines of the grid are at least this far apart, pixels.
CLOSEST_LINES = 14.0
#: Placed outlines that are remembered, so that undo puts a target back where it was.
CAPACITY = 256


@dataclass(frozen=True, slots=True)
class Change:
    """A finished gesture.

    Attributes
    ----------
    gesture : str
        As it follows the word Undo: "Add star".
    make : callable
        Returns the target as it shall be; raises a TargetError when that cannot be.
    """

    gesture: str
    make: Callable[[], Placed]


@dataclass(frozen=True, slots=True)
class Spot:
    """Where the pointer is.

    Attributes
    ----------
    pixel : QPointF
    free, place : (x, y) float, mm
        There, and at the nearest crossing of the grid when snapping holds.
    shift : bool
    """

    pixel: QPointF
    free: Place
    place: Place
    shift: bool


class Easel(QObject):
    """The board with its target; tools read it and report to it."""

    changed = Signal(object)  #: Change
    repaint = Signal()
    tool_done = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.frame = Frame(1.0, (0.0, 0.0))
        self.placed: Placed | None = None
        self.combine = Combine.REPLACE
        self.snapping = True
        self.corners = 5
        self.waist = USUAL_WAIST
        self.text = "K"
        self._places: dict[tuple[Outline, object], Placed] = {}

    def remember(self, placed: Placed) -> None:
        """Keep where an outline lies on the board."""
        key = (placed.outline, placed.outline.size)
        self._places.pop(key, None)
        self._places[key] = placed
        while len(self._places) > CAPACITY:
            del self._places[next(iter(self._places))]

    def recall(self, outline: Outline) -> Placed | None:
        """Where an outline was drawn; None for one that came from elsewhere."""
        return self._places.get((outline, outline.size))

    @property
    def step(self) -> float:
        """Distance of the grid's lines, mm: 1, 2 or 5 times a power of ten."""
        least = CLOSEST_LINES / self.frame.scale
        power = 10.0 ** math.floor(math.log10(least))
        return next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= least * (1 - 1e-9))

    def spot(self, pixel: QPointF, modifiers: Qt.KeyboardModifier) -> Spot:
        """Where a pixel lies on the board; Ctrl suspends snapping."""
        free = self.frame.to_world(pixel)
        snaps = self.snapping and not modifiers & Qt.KeyboardModifier.ControlModifier
        place = (self.snapped(free[0]), self.snapped(free[1])) if snaps else free
        return Spot(pixel, free, place, bool(modifiers & Qt.KeyboardModifier.ShiftModifier))

    def snapped(self, length: float) -> float:
        """The nearest line of the grid, mm."""
        step = self.step
        return round(length / step) * step

    def draw(self, make: Callable[[], Placed], name: str) -> None:
        """Let a new shape replace the target, join it or be taken from it; a replacing tool is then put away."""
        how, target = self.combine, self.placed
        if how is Combine.REPLACE or target is None:
            self.changed.emit(Change(f"Draw {name}", make))
            self.tool_done.emit()
            return

        def join() -> Placed:
            drawn = make()
            return combined(target, drawn.ring, how, name, drawn.outline.notes)

        self.changed.emit(Change(f"{'Add' if how is Combine.ADD else 'Take away'} {name}", join))


class SketchTool:
    """A tool that does nothing; subclasses override what they need.

    Attributes
    ----------
    hint : str
        What to do, one or two sentences for the status line.
    cursor : Qt.CursorShape
    """

    hint = ""
    cursor = Qt.CursorShape.CrossCursor

    def __init__(self, easel: Easel) -> None:
        self.easel = easel

    def press(self, spot: Spot) -> None:
        """The left button goes down."""

    def move(self, spot: Spot, held: bool) -> None:
        """The pointer moves, with the left button held or not."""

    def release(self, spot: Spot) -> None:
        """The left button goes up."""

    def double_click(self, spot: Spot) -> None:
        """The left button goes down for the second time."""

    def key(self, event: QKeyEvent) -> bool:
        """A key goes down; whether the tool had a use for it."""
        return False

    def drop(self) -> None:
        """Forget a gesture that is under way."""

    def sync(self) -> None:
        """The easel's target is another one now."""
        self.drop()

    def paint(self, painter: QPainter, frame: Frame, palette: Palette) -> None:
        """Draw what the tool is about to do."""
