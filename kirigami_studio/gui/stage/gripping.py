"""Where to hold the design on the stage and where to pull it: found out in the worker, drawn as pins and arrows."""

from __future__ import annotations

import math
from collections import OrderedDict
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QLineF, QObject, QPointF, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.queue import JobCallbacks, LatestJob
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.stage.as_cut import AsCutReader, AsCutState
from kirigami_studio.gui.widgets.paths import ink
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.widgets.view_transform import ViewTransform
from kirigami_studio.studio.making import gripping

if TYPE_CHECKING:
    from kirigami_studio.mechanics.gripping import Gripping
    from kirigami_studio.studio.as_cut import SimulatedSheet

#: Sheets whose grips are kept.
CAPACITY = 32


@dataclass(frozen=True, slots=True, eq=False)
class GripState:
    """What is known of the grips of the design on the stage."""

    found: Gripping | None = None
    sheet: SimulatedSheet | None = None  #: that they were found for
    busy: bool = False  #: whether they are looked for
    problem: str = ""  #: why there are none, "" if that is not so


UNKNOWN = GripState()


class GripFinder(QObject):
    """Looks for the grips of one sheet at a time, and only while they are wanted."""

    changed = Signal(GripState)

    def __init__(self, session: Session, as_cut: AsCutReader, parent: QObject) -> None:
        super().__init__(parent)
        self._session, self._as_cut = session, as_cut
        self._job = LatestJob["Gripping | None"](session.queue)
        self._known: OrderedDict[SimulatedSheet, Gripping] = OrderedDict()
        self._wanted = False
        self.state = UNKNOWN
        as_cut.changed.connect(self._follow)

    def want(self, wanted: bool) -> None:
        """Whether they are shown."""
        if wanted != self._wanted:
            self._wanted = wanted
            self._follow(self._as_cut.state)

    def _follow(self, state: AsCutState) -> None:
        """The sheet as cut is another one, or is about to be."""
        self._job.stop()
        stage, sheet = self._session.stage, state.sheet
        if not self._wanted:
            self._say(UNKNOWN)
        elif sheet is None or stage is None:
            self._say(GripState(busy=state.busy, problem=state.problem))
        elif sheet in self._known:
            self._known.move_to_end(sheet)
            self._say(GripState(self._known[sheet], sheet))
        else:
            width = self._session.document.fabrication.width_mm
            steps = partial(gripping, sheet, stage.design.deployment, width)
            callbacks = JobCallbacks(partial(self._on_result, sheet), on_failed=self._fail)
            self._job.start(tr("looking for grips"), steps, callbacks)
            self._say(GripState(sheet=sheet, busy=True))

    def _on_result(self, sheet: SimulatedSheet, found: Gripping | None) -> None:
        if found is None:
            return
        self._known[sheet] = found
        while len(self._known) > CAPACITY:
            self._known.popitem(last=False)
        self._say(GripState(found, sheet))

    def _fail(self, sentence: str, trace: str) -> None:
        self._say(GripState(problem=sentence))

    def _say(self, state: GripState) -> None:
        self.state = state
        self.changed.emit(state)


#: Radius (pixels) of a pin, length of the longest arrow and of the shortest, and of an arrow's head.
PIN, LONGEST, SHORTEST, HEAD = 6.0, 52.0, 22.0, 10.0
#: Width (pixels) of an arrow and of the rim that sets it off from the panels.
SHAFT, RIM = 3.0, 2.2
#: The way to go is that of the next so many radians.
AHEAD = math.radians(3.0)


@dataclass(frozen=True, slots=True, eq=False)
class GripPlaces:
    """Gripped panels at one angle."""

    #: held, moved: (K, 2); middles of the panels.
    held: FloatArray
    moved: FloatArray
    way: FloatArray  #: (K, 2); where the moved ones go next, seen from those that are held; zeros at the end of the way


def grip_places(
    design: PosedDesign, held: tuple[int, ...], moved: tuple[int, ...], phi: float, end: float
) -> GripPlaces:
    """Places of the gripped panels in the target's frame.

    Parameters
    ----------
    held, moved : tuple of int
        Panels, row by row.
    phi : float, radians
    end : float, radians
        Angle that the sheet is led to.
    """
    panels = np.array([*held, *moved])
    here, there = (_middles(design, panels, angle) for angle in (phi, max(min(phi, math.pi) - AHEAD, min(end, phi))))
    count = len(held)
    way = there - here
    way = way[count:] - way[:count].mean(axis=0)
    return GripPlaces(here[:count], here[count:], way)


def _middles(design: PosedDesign, panels: np.ndarray[tuple[int], np.dtype[np.intp]], phi: float) -> FloatArray:
    nodes = design.nodes(phi)
    middles: FloatArray = design.panels(nodes)[panels].mean(axis=1)
    kept = design.kept(nodes, phi)
    for row, panel in enumerate(panels.tolist()):
        if panel in kept:
            middles[row] = kept[panel].mean(axis=0)
    return middles


def paint_grips(painter: QPainter, places: GripPlaces, transform: ViewTransform, palette: Palette) -> None:
    """Draw pins and arrows; the longest way gets the longest arrow."""
    held, moved = transform.to_pixels(places.held), transform.to_pixels(places.moved)
    way = places.way * (transform.scale, -transform.scale)  # pixels count downwards
    lengths = np.linalg.norm(way, axis=1)
    longest = float(lengths.max(initial=0.0))
    for start, towards, length in zip(moved, way, lengths.tolist(), strict=True):
        if longest > 0.0 and length > 1e-6 * longest:
            reach = max(SHORTEST, LONGEST * length / longest)
            _paint_arrow(painter, start, start + reach / length * towards, palette)
    _paint_pins(painter, moved, palette.good, palette)
    _paint_pins(painter, held, palette.text, palette)


def _paint_arrow(painter: QPainter, start: FloatArray, tip: FloatArray, palette: Palette) -> None:
    """An arrow between two points (2,), pixels."""
    along = (tip - start) / np.linalg.norm(tip - start)
    across, foot = np.array([-along[1], along[0]]), tip - HEAD * along
    corners = (tip, foot + 0.55 * HEAD * across, foot - 0.55 * HEAD * across)
    head = QPolygonF([QPointF(x, y) for x, y in np.array(corners).tolist()])
    line = QLineF(*start.tolist(), *(foot + 0.2 * HEAD * along).tolist())
    for colour, wider in ((palette.surface, RIM), (palette.good, 0.0)):
        pen = QPen(QColor(colour), SHAFT + 2.0 * wider)
        pen.setCapStyle(Qt.PenCapStyle.RoundCap)
        painter.setPen(pen)
        painter.drawLine(line)
        ink(painter, colour, max(2.0 * wider, 1.0), fill=colour)
        painter.drawPolygon(head)


def _paint_pins(painter: QPainter, pixels: FloatArray, colour: str, palette: Palette) -> None:
    ink(painter, palette.surface, RIM, fill=colour)
    for x, y in pixels.tolist():
        painter.drawEllipse(QPointF(x, y), PIN, PIN)
