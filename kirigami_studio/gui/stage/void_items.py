"""Voids and outline vertices that can be edited: picking, facts, highlight, locks, handles, the pointer's label."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSizeF, Qt
from PySide6.QtGui import QBrush, QColor, QPainter

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.words import number, tr
from kirigami_studio.gui.widgets.legends import paint_chip
from kirigami_studio.gui.widgets.mismatch_items import stripes
from kirigami_studio.gui.widgets.paths import ink, line_path, round_pen
from kirigami_studio.gui.widgets.readable import TIMES, in_unit, readable_width
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.widgets.view_transform import Bounds, ViewTransform
from kirigami_studio.lattice.deployment import Deployment
from kirigami_studio.project.document import Void

#: Distance (pixels) from a closed slit, or from the edge of an open void, that still means the void.
VOID_REACH = 7.0
#: Distance (pixels) from a vertex of the outline that still means the vertex.
VERTEX_REACH = 8.0
#: Closer than this (radians) to the flat sheet, which is a rectangle whatever the ratios, the outline cannot be moved.
STIFF_WITHIN = 0.02
#: While a design is edited by hand, the picture keeps its place until its box has changed by this share.
STEADY = 0.08
#: Edge length (pixels) of a handle on a vertex, and of the one that is meant.
HANDLE, HELD = 5.0, 9.0
#: Handles closer together than this (pixels) would hide the outline: they get smaller.
CROWDED = 14.0
#: A lock's sign is drawn where a void's longer diagonal has at least this many pixels.
ROOM_FOR_SIGN = 24.0
#: Pixels between the pointer and its label.
BESIDE = QPointF(16.0, 18.0)


@dataclass(frozen=True, slots=True, eq=False)
class VoidShapes:
    """One design at one angle, in pixels."""

    design: PosedDesign
    phi: float  #: radians
    transform: ViewTransform  #: world -> pixels
    corners: FloatArray  #: (m, n, 4, 2), pixels; p0..p3 of every void
    vertices: FloatArray  #: (L, 2), pixels; the outline, as :meth:`PosedDesign.outline` goes round

    @classmethod
    def of(cls, design: PosedDesign, phi: float, transform: ViewTransform) -> VoidShapes:
        """Place a design."""
        nodes = design.nodes(phi)
        corners = transform.to_pixels(nodes[design.deployment.topology.void_nodes])
        return cls(design, phi, transform, corners, transform.to_pixels(design.outline(nodes, phi)))

    @property
    def movable(self) -> bool:
        """Whether a ratio can move the outline at this angle."""
        return self.phi < math.pi - STIFF_WITHIN

    def void_at(self, x: float, y: float) -> Void | None:
        """The void that pixel (x, y) lies in; else the nearest one in reach: closed ones are slits."""
        quads = self.corners.reshape(-1, 4, 2)
        distance = edge_distance(quads, np.array((x, y)))
        distance[inside(quads, np.array((x, y)))] = -1.0
        nearest = int(distance.argmin())
        if distance[nearest] > VOID_REACH:
            return None
        row, column = divmod(nearest, self.corners.shape[1])
        return row, column

    def vertex_at(self, x: float, y: float) -> int | None:
        """The vertex of the outline that is nearest to pixel (x, y), if in reach; none that cannot move."""
        if not self.movable:
            return None
        distance = np.hypot(*(self.vertices - (x, y)).T)
        nearest = int(distance.argmin())
        return nearest if distance[nearest] <= VERTEX_REACH else None

    def voids_within(self, left: float, top: float, right: float, bottom: float) -> frozenset[Void]:
        """Voids whose middle lies in a box of pixels."""
        middle = self.corners.mean(axis=2)
        hit = np.all((middle >= (left, top)) & (middle <= (right, bottom)), axis=-1)
        return frozenset((int(row), int(column)) for row, column in np.argwhere(hit))


def inside(quads: FloatArray, place: FloatArray) -> BoolArray:
    """Which convex quadrilaterals (K, 4, 2), turning either way, a place (2,) lies strictly in: (K,)."""
    edge = np.roll(quads, -1, axis=1) - quads
    offset = place - quads
    side = edge[..., 0] * offset[..., 1] - edge[..., 1] * offset[..., 0]
    found: BoolArray = np.all(side > 0.0, axis=1) | np.all(side < 0.0, axis=1)
    return found


def edge_distance(quads: FloatArray, place: FloatArray) -> FloatArray:
    """Distance of a place (2,) from the edges of quadrilaterals (K, 4, 2): (K,)."""
    edge = np.roll(quads, -1, axis=1) - quads
    offset = place - quads
    squared = np.maximum(np.square(edge).sum(axis=-1), 1e-12)
    share = np.clip((offset * edge).sum(axis=-1) / squared, 0.0, 1.0)
    gap = offset - share[..., None] * edge
    distance: FloatArray = np.hypot(gap[..., 0], gap[..., 1]).min(axis=1)
    return distance


def steady(before: Bounds, now: Bounds) -> Bounds:
    """The box that was shown before, as long as the one that is to be shown now has hardly changed."""
    span = max(before.right - before.left, before.top - before.bottom)
    moved = np.subtract(
        (before.left, before.bottom, before.right, before.top), (now.left, now.bottom, now.right, now.top)
    )
    return before if float(np.abs(moved).max()) <= STEADY * span else now


@dataclass(frozen=True, slots=True)
class VoidFacts:
    """One void at one angle of the motion."""

    void: Void
    ratio: float  #: x = |p1 - p0| / |p3 - p0|
    #: radians; interior angle at the left corner p0 (paper, Eq. 1); the one at the bottom is its supplement.
    angle: float
    edges_mm: tuple[float, float, float, float]  #: mm; lengths p0p1, p1p2, p2p3, p3p0 on the sheet as it is cut
    locked: bool

    @classmethod
    def of(cls, deployment: Deployment, void: Void, phi: float, width_mm: float, locked: bool) -> VoidFacts:
        """Measure a void of a sheet that is ``width_mm`` wide, at angle ``phi`` (radians)."""
        scale = width_mm / float(np.ptp(deployment.compact[:, 0]))
        corners = deployment.compact[deployment.topology.void_nodes[void]]
        one, two, three, four = (scale * np.hypot(*(np.roll(corners, -1, axis=0) - corners).T)).tolist()
        even = sum(void) % 2 == 0
        ratio = float(deployment.field.ratio[void])
        return cls(void, ratio, phi if even else math.pi - phi, (one, two, three, four), locked)

    def lines(self) -> tuple[str, str]:
        """The lines of the label at the pointer."""
        row, column = self.void
        if self.locked:
            first = tr("Row {row}, column {column}   x {ratio:.3f}   locked", row=row, column=column, ratio=self.ratio)
        else:
            first = tr("Row {row}, column {column}   x {ratio:.3f}", row=row, column=column, ratio=self.ratio)
        angle, edges = math.degrees(self.angle), self._edges()
        return first, f"{number(angle, '.1f')}°   {edges}"

    def sentence(self) -> str:
        """The text for the status line."""
        (row, column), angle, edges = self.void, math.degrees(self.angle), self._edges()
        if self.locked:
            return tr(
                "Void in row {row}, column {column}: ratio x {ratio:.3f}, angle {angle:.1f}° at its left corner, edges "
                "{edges}, locked.",
                row=row,
                column=column,
                ratio=self.ratio,
                angle=angle,
                edges=edges,
            )
        return tr(
            "Void in row {row}, column {column}: ratio x {ratio:.3f}, angle {angle:.1f}° at its left corner, edges "
            "{edges}.",
            row=row,
            column=column,
            ratio=self.ratio,
            angle=angle,
            edges=edges,
        )

    def _edges(self) -> str:
        """Opposite edges are equal: a void is a parallelogram."""
        return f"{in_unit(self.edges_mm[0], 2)} {TIMES} {readable_width(self.edges_mm[1])}"


def paint_marked(painter: QPainter, shapes: VoidShapes, voids: Iterable[Void], palette: Palette, width: float) -> None:
    """Outline voids in the accent's colour over a rim that sets it off from the panels."""
    for void in voids:
        path = line_path(shapes.corners[void], closed=True)
        ink(painter, round_pen(palette.canvas, width + 3.5), fill=palette.accent, alpha=60)
        painter.drawPath(path)
        ink(painter, round_pen(palette.accent_hover, width))
        painter.drawPath(path)


def paint_locks(painter: QPainter, shapes: VoidShapes, voids: Iterable[Void], palette: Palette) -> None:
    """Hatch locked voids, and put a small padlock on those that have room for it."""
    ratio = painter.device().devicePixelRatio()
    for void in voids:
        corners = shapes.corners[void]
        ink(painter, round_pen(palette.text, 1.6), fill=QBrush(stripes(palette.text, True, ratio)))
        painter.drawPath(line_path(corners, closed=True))
        room = max(float(np.hypot(*(corners[2] - corners[0]))), float(np.hypot(*(corners[3] - corners[1]))))
        if room >= ROOM_FOR_SIGN:
            x, y = corners.mean(axis=0).tolist()
            _paint_padlock(painter, QPointF(x, y), palette)


def _paint_padlock(painter: QPainter, middle: QPointF, palette: Palette) -> None:
    body = QRectF(middle.x() - 4.5, middle.y() - 1.5, 9.0, 7.0)
    arch = QRectF(middle.x() - 2.8, middle.y() - 6.0, 5.6, 8.0)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    for colour, width in ((palette.surface, 4.0), (palette.text, 1.6)):
        painter.setPen(round_pen(colour, width))
        painter.drawArc(arch, 0, 180 * 16)
        painter.drawRoundedRect(body, 1.5, 1.5)
    ink(painter, None, fill=palette.text)
    painter.drawRoundedRect(body, 1.5, 1.5)


def paint_handles(painter: QPainter, shapes: VoidShapes, meant: int | None, palette: Palette) -> None:
    """Small squares on the outline's vertices, and a large one on the vertex that is meant."""
    steps = np.hypot(*(np.roll(shapes.vertices, -1, axis=0) - shapes.vertices).T)
    size = HANDLE if float(np.median(steps)) >= CROWDED else 0.6 * HANDLE
    ink(painter, palette.accent, 1.2, fill=palette.surface)
    for x, y in shapes.vertices.tolist():
        painter.drawRect(QRectF(QPointF(x, y) - QPointF(size, size) / 2, QSizeF(size, size)))
    if meant is not None and meant < len(shapes.vertices):
        x, y = shapes.vertices[meant].tolist()
        ink(painter, palette.canvas, 1.5, fill=palette.accent)
        painter.drawRect(QRectF(QPointF(x, y) - QPointF(HELD, HELD) / 2, QSizeF(HELD, HELD)))


def paint_label(painter: QPainter, lines: tuple[str, ...], pointer: QPointF, area: QRectF, palette: Palette) -> None:
    """A label of a few lines beside the pointer, moved so that it stays inside ``area`` (pixels)."""
    metrics = painter.fontMetrics()
    width = max(metrics.horizontalAdvance(line) for line in lines) + 18.0
    height = len(lines) * metrics.height() + 10.0
    place = pointer + BESIDE
    if place.x() + width > area.right() - 4.0:
        place.setX(pointer.x() - BESIDE.x() - width)
    if place.y() + height > area.bottom() - 4.0:
        place.setY(pointer.y() - BESIDE.y() - height)
    box = QRectF(max(place.x(), area.left() + 4.0), max(place.y(), area.top() + 4.0), width, height)
    paint_chip(painter, box, palette)
    painter.setPen(QColor(palette.text))
    inner = box.adjusted(9.0, 5.0, -9.0, -5.0)
    painter.drawText(inner, int(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop), "\n".join(lines))


def paint_band(painter: QPainter, band: QRectF, palette: Palette) -> None:
    """The band that is drawn around many voids."""
    ink(painter, palette.accent, 1.2, dashed=True)
    painter.drawRect(band)
