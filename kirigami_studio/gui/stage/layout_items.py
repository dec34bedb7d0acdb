"""Paint the sheet, large and as a small picture: panels in two blues show which way each one turns."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, QSizeF, Qt
from PySide6.QtGui import QColor, QPaintEngine, QPainter, QPen, QPixmap

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.fabricate.panel_sizes import smallest_edge, smallest_neck
from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.gui.stage.piece_items import paint_pieces
from kirigami_studio.gui.widgets.paths import (
    DOZEN,
    blank,
    ink,
    line_path,
    painter_on,
    paths_of_lines,
    paths_of_quads,
    rings_path,
    round_pen,
)
from kirigami_studio.gui.widgets.target_items import paint_target_line, paint_target_shape
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.widgets.view_transform import Bounds, ViewTransform
from kirigami_studio.outlines.outline import Outline

if TYPE_CHECKING:
    from kirigami_studio.assembly.posed_pieces import PosedPieces
    from kirigami_studio.export.cut_motion import CutPose

#: Panels smaller than this (pixels) get no line: it would swallow them.
SMALLEST_LINED_PANEL = 3.6
#: Pixels around the picture of a target, and around the pictures on a card.
MARGIN, CARD_MARGIN = 6.0, 3.5
#: Radius (pixels) of the ring around the smallest edge or neck.
RING = 7.0
#: Share of a card's picture that the sheet over its target gets; the rest shows it flat.
TARGET_SHARE = 0.56


def paint_panels(
    painter: QPainter,
    panels: FloatArray,
    turns_left: BoolArray,
    palette: Palette,
    trimmed: Mapping[int, FloatArray] | None = None,
) -> None:
    """Fill all panels.

    Parameters
    ----------
    panels : (K, 4, 2) float, pixels
    turns_left : (K,) bool
        Panels that turn counter-clockwise while the sheet opens get the lighter blue.
    trimmed : mapping of row to (P, 2) float, pixels, optional
        What trimming has left of panels, drawn instead of them.
    """
    trimmed = trimmed or {}
    whole = np.ones(len(panels), dtype=np.bool_)
    whole[list(trimmed)] = False
    line = _panel_pen(panels, palette)
    together = _together(painter)
    for chosen, colour in ((~turns_left, palette.panel_even), (turns_left, palette.panel_odd)):
        # A pen in the fill's colour keeps hairline gaps of antialiasing from showing between closed panels.
        ink(painter, line if line.style() != Qt.PenStyle.NoPen else QPen(QColor(colour), 0.5), fill=colour)
        for path in paths_of_quads(panels[chosen & whole], together):
            painter.drawPath(path)
        for row, part in trimmed.items():
            if chosen[row] and len(part):
                painter.drawPath(line_path(part, closed=True))


def paint_cut_panels(
    painter: QPainter,
    pose: CutPose,
    transform: ViewTransform,
    quads: FloatArray,
    turns_left: BoolArray,
    palette: Palette,
) -> None:
    """Fill the panels as the cuts leave them, and draw the cuts; where connectors are, panels go on into each other.

    Parameters
    ----------
    quads : (K, 4, 2) float, pixels
        The ideal panels, whose size decides how wide lines are.
    turns_left : (K,) bool
        As for :func:`paint_panels`.
    """
    together = _together(painter)
    panels = _in_pixels(pose.panels, transform)
    for left, colour in ((False, palette.panel_even), (True, palette.panel_odd)):
        ink(painter, colour, 0.5, fill=colour)
        chosen = np.flatnonzero(turns_left[pose.numbers] == left).tolist()
        for path in paths_of_lines([panels[place] for place in chosen], True, together):
            painter.drawPath(path)
    ink(painter, _panel_pen(quads, palette))
    for path in paths_of_lines(_in_pixels(pose.cuts, transform), False, together):
        painter.drawPath(path)


def _in_pixels(lines: Sequence[FloatArray], transform: ViewTransform) -> list[FloatArray]:
    """Lines (L, 2) of the world in pixels, all at once."""
    ends = np.cumsum([len(line) for line in lines])
    return np.split(transform.to_pixels(np.concatenate(lines)), ends[:-1]) if len(lines) else []


def _panel_pen(quads: FloatArray, palette: Palette) -> QPen:
    """The line around panels (K, 4, 2), pixels; none around tiny ones."""
    size = np.median(np.linalg.norm(quads[:, 2] - quads[:, 0], axis=-1)) if len(quads) else 0.0
    if size < SMALLEST_LINED_PANEL:
        return QPen(Qt.PenStyle.NoPen)
    line = QPen(QColor(palette.panel_line), 1.0 if size > 14 else 0.6 if size > 6 else 0.4)
    line.setJoinStyle(Qt.PenJoinStyle.MiterJoin)
    return line


def _together(painter: QPainter) -> int:
    """How many panels are one path; in a drawing that is saved, each is a shape of its own."""
    return 1 if painter.paintEngine().type() is QPaintEngine.Type.SVG else DOZEN


def turning_left(rows: int, columns: int) -> BoolArray:
    """Which of the (rows + 1)(columns + 1) panels turn counter-clockwise: those with I + J odd."""
    odd: BoolArray = np.add.outer(np.arange(rows + 1), np.arange(columns + 1)) % 2 == 1
    return odd.reshape(-1)


def paint_candidate(
    painter: QPainter, rect: QRectF, design: PosedDesign, target: Outline | None, palette: Palette
) -> None:
    """Draw one design and its target into ``rect``."""
    nodes = design.nodes(design.phi_target)
    bounds = Bounds.of(nodes)
    if target is not None:
        bounds = bounds.united(Bounds.of(target.points))
    transform = ViewTransform.fitting(bounds, rect, CARD_MARGIN)
    field = design.deployment.field
    trimmed = {row: transform.to_pixels(part) for row, part in design.kept(nodes, design.phi_target).items()}
    panels = transform.to_pixels(design.panels(nodes))
    paint_panels(painter, panels, turning_left(field.rows, field.columns), palette, trimmed)
    if target is not None:
        paint_target_line(painter, transform.rings_to_pixels(target.rings), palette, width=1.4)


def paint_flat(painter: QPainter, rect: QRectF, design: PosedDesign, palette: Palette) -> None:
    """Draw the sheet as it is cut, upright, into ``rect``."""
    flat = PosedDesign(design.deployment, Similarity(), math.pi, design.trim)
    nodes = flat.nodes(math.pi)
    transform = ViewTransform.fitting(Bounds.of(nodes), rect, CARD_MARGIN)
    trimmed = {row: transform.to_pixels(part) for row, part in flat.kept(nodes, math.pi).items()}
    turning = turning_left(*design.deployment.sheet.grid)
    paint_panels(painter, transform.to_pixels(flat.panels(nodes)), turning, palette, trimmed)


def candidate_pixmap(
    design: PosedDesign,
    target: Outline | None,
    size: QSize,
    ratio: float,
    palette: Palette,
    pieces: PosedPieces | None = None,
) -> QPixmap:
    """Return the picture for a gallery card: the sheet over its target, and flat.

    ``size`` is in logical pixels; ``pieces`` are drawn in the place of panels.
    """
    pixmap = blank(size, ratio)
    painter = painter_on(pixmap)
    width, height = TARGET_SHARE * size.width(), float(size.height())
    over, beside = QRectF(0.0, 0.0, width, height), QRectF(width, 0.0, size.width() - width, height)
    if pieces is None:
        paint_candidate(painter, over, design, target, palette)
        paint_flat(painter, beside, design, palette)
    else:
        paint_opened_pieces(painter, over, pieces, target, palette)
        upright = pieces.upright()
        transform = ViewTransform.fitting(Bounds.of(upright.points(math.pi)), beside, CARD_MARGIN)
        paint_pieces(painter, upright, math.pi, transform, palette)
    painter.end()
    return pixmap


def paint_opened_pieces(
    painter: QPainter, rect: QRectF, pieces: PosedPieces, target: Outline | None, palette: Palette
) -> None:
    """Draw pieces at their target angle, and their target, into ``rect``."""
    phi = pieces.design.phi_target
    bounds = Bounds.of(pieces.points(phi))
    if target is not None:
        bounds = bounds.united(Bounds.of(target.points))
    transform = ViewTransform.fitting(bounds, rect, CARD_MARGIN)
    paint_pieces(painter, pieces, phi, transform, palette)
    if target is not None:
        paint_target_line(painter, transform.rings_to_pixels(target.rings), palette, width=1.4)


def states_pixmap(
    design: PosedDesign,
    target: Outline | None,
    size: QSize,
    ratio: float,
    palette: Palette,
    as_cut: bool = False,
    ringed: bool = False,
    pieces: PosedPieces | None = None,
) -> QPixmap:
    """Return a design flat, half way and over its target side by side, to one scale; ``size`` in logical pixels.

    ``as_cut`` lays the flat sheet upright, ``ringed`` marks its smallest edge or neck, ``pieces`` are drawn in the
    place of panels.
    """
    pixmap = blank(size, ratio)
    painter = painter_on(pixmap)
    angles = (math.pi, 0.5 * (math.pi + design.phi_target), design.phi_target)
    upright = PosedDesign(design.deployment, Similarity(design.pose.scale), math.pi, design.trim)
    poses = (upright if as_cut else design, design, design)
    shown = [posed.nodes(phi) for posed, phi in zip(poses, angles, strict=True)]
    made = () if pieces is None else (pieces.upright() if as_cut else pieces, pieces, pieces)
    boxes = [Bounds.of(nodes) for nodes in shown]
    if made:
        boxes = [Bounds.of(one.points(phi)) for one, phi in zip(made, angles, strict=True)]
    if target is not None:
        boxes[-1] = boxes[-1].united(Bounds.of(target.points))
    spans = [max(box.right - box.left, box.top - box.bottom) for box in boxes]
    side, turning = size.width() / len(angles), turning_left(*design.deployment.sheet.grid)
    for number, (posed, phi, nodes, box, span) in enumerate(zip(poses, angles, shown, boxes, spans, strict=True)):
        edge = (min(side, size.height()) - 2 * CARD_MARGIN) * span / max(spans)
        middle = QPointF((number + 0.5) * side, 0.5 * size.height())
        transform = ViewTransform.fitting(box, QRectF(middle - QPointF(edge, edge) / 2, QSizeF(edge, edge)))
        if made:
            paint_pieces(painter, made[number], phi, transform, palette)
            continue
        trimmed = {row: transform.to_pixels(part) for row, part in posed.kept(nodes, phi).items()}
        panels = transform.to_pixels(posed.panels(nodes))
        paint_panels(painter, panels, turning, palette, trimmed)
        if ringed and number == 0:
            _paint_ring(painter, panels[[row for row in range(len(panels)) if row not in trimmed]], palette)
    if target is not None:
        painter.setPen(round_pen(palette.target, 1.2))  # no halo: in so small a picture it would hide the rim's panels
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawPath(rings_path(transform.rings_to_pixels(target.rings)))
    painter.end()
    return pixmap


def _paint_ring(painter: QPainter, panels: FloatArray, palette: Palette) -> None:
    """Ring the smallest edge or neck of panels (K, 4, 2), pixels."""
    found = [smallest_edge(list(panels), 0.0), smallest_neck(list(panels), 0.0)]
    places = [place for place in found if place is not None]
    if places:
        x, y = min(places, key=lambda place: place.size_mm).where
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for colour, width in ((palette.fault_line, 4.0), (palette.fault, 2.0)):
            painter.setPen(QPen(QColor(colour), width))
            painter.drawEllipse(QPointF(x, y), RING, RING)


def target_pixmap(
    target: Outline, size: QSize, ratio: float, palette: Palette, margin: float = MARGIN, line: float = 2.0
) -> QPixmap:
    """Return a target's picture for lists; ``size``, ``margin`` and width of the ``line`` in logical pixels."""
    pixmap = blank(size, ratio)
    painter = painter_on(pixmap)
    transform = ViewTransform.fitting(Bounds.of(target.points), QRectF(0, 0, size.width(), size.height()), margin)
    paint_target_shape(painter, transform.rings_to_pixels(target.rings), palette, line)
    painter.end()
    return pixmap
