"""A cut plan as the beam sees it: the sheet, every cut as wide as it burns, the moves between, the start.

While cuts are a pixel thin a layer is one path.  Wider ones are stroked one by one, out of the same cached paths: for
625 cuts Qt's raster engine needs 60 ms for one path that holds them all and 6 ms for the single ones.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPainterPath, QPen

from kirigami_studio.fabricate import timing
from kirigami_studio.fabricate.cut_plan import CutPlan, Layer
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.gui.widgets.paths import line_path, round_pen
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.widgets.view_transform import Bounds, ViewTransform

#: No cut is drawn thinner than this (pixels), whatever its kerf.
THINNEST = 1.0
#: Cuts that are still to come are this opaque while the job is played.
FAINT = 0.28
#: An arc that lies less than this (pixels) beside its chord is drawn as its chord.
SEEN = 0.25
#: Edge length (pixels) of the mark where the job starts.
START = 6.0
#: Opacity of the copies of a sheet.
COPY_OPACITY = 0.45


@dataclass(frozen=True, eq=False)
class CutDrawing:
    """What is drawn of a plan, in mm, y up; made once for each plan."""

    plan: CutPlan

    @cached_property
    def cuts(self) -> tuple[QPainterPath, ...]:
        """Every cut in the order of cutting."""
        return tuple(line_path(path.flattened, path.closed) for path in self.plan.paths)

    @cached_property
    def chords(self) -> tuple[QPainterPath, ...]:
        """Every cut with chords for its arcs: what is drawn while the arcs are too small to be seen."""
        return tuple(line_path(path.points, path.closed) for path in self.plan.paths)

    @cached_property
    def name(self) -> QPainterPath:
        """The strokes of the engraved name."""
        whole = QPainterPath()
        for line in () if self.plan.engraving is None else self.plan.engraving.lines:
            whole.addPath(line_path(line, closed=False))
        return whole

    @cached_property
    def largest_arc(self) -> float:
        """How far an arc of the plan lies beside its chord at most, mm."""
        arcs = [(path, path.bulges) for path in self.plan.paths if path.bulges is not None]
        if not arcs:
            return 0.0
        # After the last point of an open path comes no edge, whatever its bulge says.
        bulge = np.concatenate([bulges if path.closed else np.append(bulges[:-1], 0.0) for path, bulges in arcs])
        points = np.concatenate([path.points for path, _ in arcs])
        following = np.concatenate([part for path, _ in arcs for part in (path.points[1:], path.points[:1])])
        return float((0.5 * np.abs(bulge) * np.linalg.norm(following - points, axis=1)).max())

    @cached_property
    def boxes(self) -> FloatArray:
        """Left, bottom, right, top of every cut: (P, 4)."""
        lines = [path.flattened for path in self.plan.paths]
        points, starts = np.concatenate(lines), np.cumsum([0, *(len(line) for line in lines[:-1])])
        return np.hstack([np.minimum.reduceat(points, starts), np.maximum.reduceat(points, starts)])

    @cached_property
    def on_layer(self) -> dict[Layer, BoolArray]:
        """Which cuts lie on each layer that is used, in the order of cutting: (P,) bool."""
        paths = self.plan.paths
        return {layer: np.array([path.layer is layer for path in paths]) for layer in self.plan.layers}

    @cached_property
    def sheet(self) -> QPainterPath:
        """The finished sheet: the inside of its outline, tabs or not, less the holes."""
        sheet = line_path(_ring([path.flattened for path in self.plan.on_layer(Layer.OUTLINE)]), closed=True)
        for hole in self.plan.on_layer(Layer.HOLES):
            sheet.addPath(line_path(hole.flattened, closed=True))
        return sheet

    @cached_property
    def travel(self) -> FloatArray:
        """Start and end of the move before every cut: (P, 2, 2); the job starts at the origin."""
        travelled = [path.travelled for path in self.plan.paths]
        exits = [np.zeros(2), *(points[-1] for points in travelled[:-1])]
        moves: FloatArray = np.stack([exits, [points[0] for points in travelled]], axis=1)
        return moves

    @cached_property
    def bounds(self) -> Bounds:
        """Everything that is cut, and the origin."""
        width, height = self.plan.copies.spread_mm
        return Bounds(0.0, 0.0, width, height)

    def pen_width(self, transform: ViewTransform) -> float:
        """Width (pixels) of a cut as it is drawn: its kerf, or the thinnest that is well seen."""
        return max(self.plan.kerf_mm * transform.scale, THINNEST)


def layer_colour(layer: Layer, palette: Palette) -> str:
    """Colour of a layer's cuts."""
    return {
        Layer.SLITS: palette.slits,
        Layer.EDGE_SLITS: palette.edge_slits,
        Layer.HOLES: palette.text,
        Layer.OUTLINE: palette.text,
        Layer.RELIEF: palette.relief,
    }[layer]


def paint_cut_sheet(painter: QPainter, drawing: CutDrawing, transform: ViewTransform, palette: Palette) -> None:
    """Draw the material under the cuts."""
    with_transform(painter, transform)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(palette.cut_sheet))
    painter.drawPath(drawing.sheet)
    _paint_copies(painter, drawing, transform, palette)
    painter.restore()


def _paint_copies(painter: QPainter, drawing: CutDrawing, transform: ViewTransform, palette: Palette) -> None:
    """Draw the other sheets of the file faintly, by their outlines."""
    painter.setOpacity(COPY_OPACITY)
    painter.setPen(round_pen(palette.text, drawing.pen_width(transform) / transform.scale))
    for x, y in drawing.plan.copies.places[1:].tolist():
        painter.drawPath(drawing.sheet.translated(x, y))
    painter.setOpacity(1.0)


def paint_cuts(
    painter: QPainter, drawing: CutDrawing, transform: ViewTransform, palette: Palette, step: int, view: QRectF
) -> None:
    """Draw the first ``step`` cuts, the others faintly, and the last of the first ones as the one under way.

    Parameters
    ----------
    step : int
        0 to the number of cuts; when all are cut none is under way.
    view : QRectF, pixels
        What lies outside is left out.
    """
    last, seen = len(drawing.plan.paths), _in_view(drawing, transform, view)
    width = drawing.pen_width(transform) / transform.scale
    thin = width * transform.scale * painter.device().devicePixelRatio() <= THINNEST
    done = np.arange(last) < (step if step == last else step - 1)
    cuts = drawing.chords if drawing.largest_arc * transform.scale < SEEN else drawing.cuts
    with_transform(painter, transform)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    for layer, of_layer in reversed(drawing.on_layer.items()):
        painter.setPen(round_pen(layer_colour(layer, palette), width))
        for opacity, which in ((FAINT, seen & of_layer & ~done), (1.0, seen & of_layer & done)):
            painter.setOpacity(opacity)
            _stroke(painter, [cuts[index] for index in np.flatnonzero(which)], thin)
    painter.setOpacity(1.0)
    if 0 < step < last:
        painter.setPen(round_pen(palette.current_cut, width + 3.0 / transform.scale))
        painter.drawPath(drawing.cuts[step - 1])
    painter.restore()


def paint_name(painter: QPainter, drawing: CutDrawing, transform: ViewTransform, palette: Palette) -> None:
    """Draw the engraved name, fainter on the copies of the sheet."""
    if drawing.name.isEmpty():
        return
    with_transform(painter, transform)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(round_pen(palette.engraved, drawing.pen_width(transform) / transform.scale))
    for copy, (x, y) in enumerate(drawing.plan.copies.places.tolist()):
        painter.setOpacity(COPY_OPACITY if copy else 1.0)
        painter.drawPath(drawing.name.translated(x, y))
    painter.setOpacity(1.0)
    painter.restore()


def paint_travel(painter: QPainter, drawing: CutDrawing, transform: ViewTransform, palette: Palette, step: int) -> None:
    """Draw the moves with the beam off up to this step, dashed."""
    moves = transform.to_pixels(drawing.travel[:step])
    pen = QPen(QColor(palette.muted), 1.0, Qt.PenStyle.CustomDashLine)
    pen.setDashPattern([4.0, 3.0])
    painter.setPen(pen)
    painter.drawLines([QLineF(*start, *stop) for start, stop in moves.tolist()])


def paint_start(painter: QPainter, drawing: CutDrawing, transform: ViewTransform, palette: Palette) -> None:
    """Mark the first point of the first cut with a square, and the head's origin with a cross."""
    points = transform.to_pixels(np.stack([drawing.travel[0, 0], drawing.travel[0, 1]])).tolist()
    (x, y), first = points[0], QPointF(*points[1])
    painter.setPen(QPen(QColor(palette.text), 1.6))
    painter.drawLines([QLineF(x - START, y, x + START, y), QLineF(x, y - START, x, y + START)])
    painter.setBrush(QColor(palette.surface))
    painter.drawRect(QRectF(first - QPointF(START, START) / 2, first + QPointF(START, START) / 2))


def with_transform(painter: QPainter, transform: ViewTransform) -> None:
    """Let the painter draw in mm, y up, until its restore."""
    painter.save()
    painter.translate(*transform.origin)
    painter.scale(transform.scale, -transform.scale)


@dataclass(frozen=True, slots=True, eq=False)
class CutSteps:
    """The job as a row of steps: after step s the first s paths are cut."""

    seconds: FloatArray  #: (P + 1,); from the start of the job until a step is done; 0 first, ascending
    length_mm: FloatArray  #: (P + 1,); cut length so far

    def __post_init__(self) -> None:
        self.seconds.setflags(write=False)
        self.length_mm.setflags(write=False)

    @property
    def last(self) -> int:
        """The step after which everything is cut."""
        return len(self.seconds) - 1

    def at(self, seconds: float) -> int:
        """The step under way after so many seconds: its path is being reached or cut."""
        return min(int(np.searchsorted(self.seconds, seconds, side="right")), self.last)


def cut_steps(plan: CutPlan) -> CutSteps:
    """Return the steps of a plan, with the time model of the plan.

    What the model adds per job is shared out among the paths by their time, so that the last step ends when the
    plan's estimate does.
    """
    machine = plan.machine
    acceleration = machine.acceleration_mm_s2
    edges = timing.Edges.of(plan.paths)
    path, lengths = edges.runs(timing.FLOWING_TURN)
    runs = timing.run_seconds(lengths, machine.speed_mm_s(plan.material), acceleration)
    cutting = np.bincount(path, runs, len(plan.paths))
    moving = timing.run_seconds(timing.travel_lengths(plan.paths), machine.travel_mm_s, acceleration)
    seconds = np.concatenate([[0.0], np.cumsum(cutting + moving)])
    if seconds[-1] > 0.0:
        seconds = seconds * (plan.seconds_estimate / seconds[-1])
    return CutSteps(seconds, np.concatenate([[0.0], np.cumsum(np.bincount(edges.path, edges.length, len(plan.paths)))]))


def _stroke(painter: QPainter, cuts: list[QPainterPath], thin: bool) -> None:
    if thin and cuts:
        whole = QPainterPath()
        for cut in cuts:
            whole.addPath(cut)
        painter.drawPath(whole)
        return
    for cut in cuts:
        painter.drawPath(cut)


def _in_view(drawing: CutDrawing, transform: ViewTransform, view: QRectF) -> BoolArray:
    """Which cuts can be seen: (P,) bool."""
    left, top = transform.to_world(view.topLeft())
    right, bottom = transform.to_world(view.bottomRight())
    margin = drawing.pen_width(transform) / transform.scale
    boxes = drawing.boxes
    seen: BoolArray = (
        (boxes[:, 0] <= right + margin)
        & (boxes[:, 2] >= left - margin)
        & (boxes[:, 1] <= top + margin)
        & (boxes[:, 3] >= bottom - margin)
    )
    return seen


def _ring(pieces: list[FloatArray]) -> FloatArray:
    """Join the pieces of a parted outline, each to the nearest end of those before: (V, 2)."""
    ring, *rest = pieces
    while rest:
        ends = np.array([[piece[0], piece[-1]] for piece in rest])
        distance = np.linalg.norm(ends - ring[-1], axis=2)
        index, end = np.unravel_index(int(np.argmin(distance)), distance.shape)
        piece = rest.pop(int(index))
        ring = np.concatenate([ring, piece[::-1] if end else piece])
    return ring
