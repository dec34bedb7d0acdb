"""Tools that make a new shape: a stroke, a polygon, a figure or a text in a box."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QFont, QFontMetricsF, QKeyEvent, QPainter, QPainterPath

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import mark
from kirigami_studio.gui.target.sketch_context import (
    FREEHAND,
    POLYGON,
    TEXT,
    Place,
    PointerEvent,
    SketchContext,
    SketchTool,
    distance,
)
from kirigami_studio.gui.widgets.target_items import paint_pen_points, paint_proposal, paint_size, paint_sketch
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.widgets.view_transform import ViewTransform
from kirigami_studio.outlines import bezier
from kirigami_studio.outlines.anchors import Anchors, with_anchors
from kirigami_studio.outlines.figures import BoundingBox, Figure, placed_figure
from kirigami_studio.outlines.lettering import lettered
from kirigami_studio.outlines.mirroring import Mirror
from kirigami_studio.outlines.nodes import FEWEST_NODES, Kind
from kirigami_studio.outlines.placed import Placed

#: A click this near (pixels) to the first corner closes the polygon.
CLOSING_REACH = 10.0
#: Freehand points nearer than this (pixels) to the last one are dropped: hands and mice jitter.
SMALLEST_STEP = 2.0
#: A mirrored stroke ends this near to its start, as a share of its last piece.
CLOSING_SHARE = 0.01
#: A box smaller than this (pixels) was a click, not a drag.
LEAST_DRAG = 4.0
#: Half of the side (mm) of the box whose middle half Enter fills on an empty board.
EMPTY_MM = 60.0
#: With Shift the pen goes in these steps, radians.
PEN_STEP = math.radians(45.0)
#: Size in which letters are outlined, pixels: flattened curves are then exact to a thousandth.
LETTER_SIZE = 400
#: No mirror.
PLAIN = Mirror()


class Freehand(SketchTool):
    """One stroke; it is smoothed and closes itself."""

    hint = mark("Draw the silhouette in one stroke; it closes when you release.")

    def __init__(self, context: SketchContext) -> None:
        super().__init__(context)
        self._pointers: list[PointerEvent] = []

    def press(self, pointer: PointerEvent) -> None:
        self._pointers = [pointer]

    def move(self, pointer: PointerEvent, held: bool) -> None:
        if held and self._pointers and distance(pointer.pixel, self._pointers[-1].pixel) >= SMALLEST_STEP:
            self._pointers.append(pointer)

    def release(self, pointer: PointerEvent) -> None:
        points, mirror = np.array([pointer.free for pointer in self._pointers]), self.context.mirror
        self.drop()
        if len(points) > 1:
            self.context.draw(lambda: stroke_of(points, mirror), FREEHAND)

    @property
    def busy(self) -> bool:
        return bool(self._pointers)

    def drop(self) -> None:
        self._pointers = []

    def paint(self, painter: QPainter, transform: ViewTransform, palette: Palette) -> None:
        if self._pointers:
            points = transform.to_pixels(np.array([pointer.free for pointer in self._pointers]))
            paint_sketch(painter, points, palette)
            _paint_images(painter, transform, palette, self.context, [pointer.free for pointer in self._pointers])


def stroke_of(points: FloatArray, mirror: Mirror = PLAIN) -> Placed:
    """Smooth a stroke (P, 2), mm, from axis to axis together with its images.

    SciPy is loaded at the first one, not when the window opens.
    """
    from kirigami_studio.outlines.refining import stroked

    whole = mirror.completed(points)
    if whole is None:
        return stroked(points)
    closing = whole[:1] + CLOSING_SHARE * (whole[-1:] - whole[:1])  # almost closed: a gap too small to be reported
    return mirror.evened(stroked(np.concatenate([whole, closing])))


@dataclass(frozen=True, slots=True)
class PenPoint:
    """A point that the pen has set."""

    pointer: PointerEvent  #: where the button went down
    place: Place  #: (x, y), mm
    #: into, out: (x, y), mm; from the point to its handles, towards the one before and the next; zero for a corner.
    into: Place = (0.0, 0.0)
    out: Place = (0.0, 0.0)
    kind: Kind = Kind.CORNER

    def pulled(self, pointer: PointerEvent) -> PenPoint:
        """The point whose handle was pulled to the pointer; with Alt the other handle stays as it is."""
        x, y = pointer.place[0] - self.place[0], pointer.place[1] - self.place[1]
        if pointer.alt:
            return replace(self, out=(x, y), kind=Kind.CORNER)
        return replace(self, into=(-x, -y), out=(x, y), kind=Kind.SYMMETRIC)


class Pen(SketchTool):
    """Points one by one: a click sets a corner, a drag pulls the handles of a curve."""

    hint = mark(
        "Click corners, drag to pull curves (Alt: one handle, Shift: 45° steps). "
        "Enter or a click on the first point closes; Backspace removes the last."
    )

    def __init__(self, context: SketchContext) -> None:
        super().__init__(context)
        self._points: list[PenPoint] = []
        self._pulled: int | None = None  # the point whose handles follow the pointer
        self._closes = False
        self._pointer: PointerEvent | None = None

    def press(self, pointer: PointerEvent) -> None:
        if self._at_first(pointer):
            self._closes, self._pulled = True, 0
            return
        place = self._placed(pointer)
        if not self._points or place != self._points[-1].place:
            self._points.append(PenPoint(pointer, place))
            self._pulled = len(self._points) - 1

    def move(self, pointer: PointerEvent, held: bool) -> None:
        self._pointer = pointer
        if held and self._pulled is not None:
            start = self._points[self._pulled]
            pressed = self._points[0].pointer if self._closes else start.pointer
            if distance(pointer.pixel, pressed.pixel) >= LEAST_DRAG:
                self._points[self._pulled] = start.pulled(pointer)

    def release(self, pointer: PointerEvent) -> None:
        closes = self._closes
        self._pulled, self._closes = None, False
        if closes:
            self._finish()

    def double_click(self, pointer: PointerEvent) -> None:
        self._finish()

    def key(self, event: QKeyEvent) -> bool:
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self._finish()
        elif event.key() == Qt.Key.Key_Backspace and self._points:
            self._points.pop()
            self._pulled, self._closes = None, False
        else:
            return False
        return True

    @property
    def busy(self) -> bool:
        return bool(self._points)

    def drop(self) -> None:
        self._points, self._pulled, self._closes = [], None, False

    def _at_first(self, pointer: PointerEvent) -> bool:
        return len(self._points) >= 3 and distance(pointer.pixel, self._points[0].pointer.pixel) <= CLOSING_REACH

    def _placed(self, pointer: PointerEvent) -> Place:
        """Where the next point would be set; with Shift in steps of 45 degrees from the last one."""
        if not (pointer.shift and self._points):
            return pointer.place
        (x, y), (x0, y0) = pointer.place, self._points[-1].place
        angle = round(math.atan2(y - y0, x - x0) / PEN_STEP) * PEN_STEP
        length = (x - x0) * math.cos(angle) + (y - y0) * math.sin(angle)
        return x0 + length * math.cos(angle), y0 + length * math.sin(angle)

    def _line(self, points: Sequence[PenPoint]) -> FloatArray:
        """(P, 2) float, mm: the curve through points, from the first to the last."""
        ends = [np.array([point.place, point.out, point.into]) for point in points]
        line = [ends[0][:1]]
        for one, other in itertools.pairwise(ends):
            line += [bezier.curve(one[0], one[1], other[2], other[0]), other[:1]]
        return np.concatenate(line)

    def _finish(self) -> None:
        points, mirror = tuple(self._points), self.context.mirror
        self.drop()
        if not points:
            return
        whole = mirror.completed(self._line(points))
        if whole is not None:
            self.context.draw(lambda: Placed.from_ring(whole, POLYGON), POLYGON)
        else:
            self.context.draw(lambda: _pen_shape(points), POLYGON)

    def paint(self, painter: QPainter, transform: ViewTransform, palette: Palette) -> None:
        if not self._points:
            return
        points = list(self._points)
        if self._closes:
            points.append(points[0])
        elif self._pointer is not None and self._pulled is None:
            there = self._points[0].place if self._at_first(self._pointer) else self._placed(self._pointer)
            points.append(PenPoint(self._pointer, there))
        line = self._line(points)
        paint_sketch(painter, transform.to_pixels(line), palette)
        closing = self._closes or (self._pointer is not None and self._at_first(self._pointer))
        shown = len(self._points) - 1 if self._pulled is None else self._pulled
        handles = [
            np.add(self._points[shown].place, way)
            for way in (self._points[shown].into, self._points[shown].out)
            if any(way)
        ]
        places = transform.to_pixels(np.array([point.place for point in self._points]))
        ends = transform.to_pixels(np.array(handles)) if handles else np.empty((0, 2))
        paint_pen_points(painter, places, shown, ends, palette, closing)
        _paint_images(painter, transform, palette, self.context, [(x, y) for x, y in line.tolist()])


def _pen_shape(points: Sequence[PenPoint]) -> Placed:
    """What closed points of the pen enclose; with curves it keeps them as its nodes.

    Raises
    ------
    TargetError
        They enclose nothing.
    """
    places = np.array([point.place for point in points])
    if not any((*point.into, *point.out) != (0.0,) * 4 for point in points) or len(points) < FEWEST_NODES:
        return Placed.from_ring(places, POLYGON)
    handles = np.array([[point.into, point.out] for point in points])
    anchors = Anchors.drawn(places, tuple(point.kind for point in points), handles)
    return with_anchors(Placed.from_ring(anchors.ring, POLYGON), anchors)


class BoxTool(SketchTool):
    """Drags a box for a shape.

    Parameters
    ----------
    name : str
        Of the shape, for the document and the name of the change.
    shape : callable
        What fills a box; raises a TargetError where nothing can.
    """

    def __init__(self, context: SketchContext, name: str, shape: Callable[[BoundingBox], Placed], hint: str) -> None:
        super().__init__(context)
        self._name, self._shape, self.hint = name, shape, hint
        self._start: PointerEvent | None = None
        self._end: PointerEvent | None = None

    def press(self, pointer: PointerEvent) -> None:
        self._start = self._end = pointer

    def move(self, pointer: PointerEvent, held: bool) -> None:
        if held and self._start is not None:
            self._end = pointer

    def release(self, pointer: PointerEvent) -> None:
        start = self._start
        self.drop()
        if start is not None and distance(start.pixel, pointer.pixel) >= LEAST_DRAG:
            self._fill(BoundingBox.spanned(start.place, pointer.place, pointer.shift))

    def key(self, event: QKeyEvent) -> bool:
        if event.key() not in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            return False
        self.lay()
        return True

    def lay(self) -> None:
        """Lay the shape in the middle of the target, half as large; arrows move it from there."""
        placed = self.context.placed
        low, high = (np.full(2, side) for side in (-EMPTY_MM, EMPTY_MM))
        if placed is not None:
            low, high = placed.ring.min(axis=0), placed.ring.max(axis=0)
        (left, bottom), (right, top) = (0.75 * low + 0.25 * high).tolist(), (0.25 * low + 0.75 * high).tolist()
        self.drop()
        self._fill(BoundingBox(left, bottom, right, top))

    def _fill(self, box: BoundingBox) -> None:
        self.context.draw(lambda: self._shape(box), self._name)

    @property
    def busy(self) -> bool:
        return self._start is not None

    def drop(self) -> None:
        self._start = self._end = None

    def paint(self, painter: QPainter, transform: ViewTransform, palette: Palette) -> None:
        if self._start is None or self._end is None:
            return
        box = BoundingBox.spanned(self._start.place, self._end.place, self._end.shift)
        try:
            rings = self._shape(box).rings
        except TargetError:  # too flat so far; said when the button is let go
            return
        for image in (*zip(*map(self.context.mirror.all_images, rings), strict=True), rings):
            paint_proposal(painter, transform.rings_to_pixels(image), palette)
        paint_size(painter, self._end.pixel, box.size, palette)


def figure_tool(context: SketchContext, kind: Figure) -> BoxTool:
    """Return the tool for a rectangle, ellipse, regular polygon or star."""
    hint = mark("Drag a box for the shape, or press Enter. Shift keeps it regular, Ctrl ignores the grid.")
    return BoxTool(context, kind.value, lambda box: placed_figure(kind, box, context.corners, context.waist), hint)


def text_tool(context: SketchContext) -> BoxTool:
    """Return the tool for a word whose letters hang together."""

    def shape(box: BoundingBox) -> Placed:
        text = context.text.strip()
        word, notes = lettered(letters(text, context.family, context.bold, context.italic), box)
        return Placed.from_polygon(word, text or TEXT, notes)

    hint = mark(
        "Type the text above, then drag a box for it or press Enter. Letters are moved together into one piece."
    )
    return BoxTool(context, TEXT, shape, hint)


def letters(text: str, family: str = "", bold: bool = True, italic: bool = False) -> list[list[FloatArray]]:
    """Outlines of the letters of a text, each where it stands in the line; without a family in the window's own.

    Returns
    -------
    letters : list of lists of (L, 2) float, pixels, y up
        One list of rings for each character that has an outline.
    """
    font = QFont(family) if family else QFont()
    font.setPixelSize(LETTER_SIZE)
    font.setBold(bold)
    font.setItalic(italic)
    font.setHintingPreference(QFont.HintingPreference.PreferNoHinting)
    metrics = QFontMetricsF(font)
    found = []
    for index, letter in enumerate(text):
        path = QPainterPath()
        path.addText(metrics.horizontalAdvance(text[:index]), 0.0, font, letter)
        rings = [np.array([(point.x(), -point.y()) for point in part.toList()]) for part in path.toSubpathPolygons()]
        if rings:
            found.append(rings)
    return found


def _paint_images(
    painter: QPainter, transform: ViewTransform, palette: Palette, context: SketchContext, places: list[Place]
) -> None:
    """Draw what the mirror makes of an unfinished line."""
    for image in context.mirror.all_images(np.array(places)):
        paint_sketch(painter, transform.to_pixels(image), palette)
