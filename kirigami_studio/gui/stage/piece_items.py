"""Paint pieces in layers: faces in the colours of the material, shadows, heads of pins."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QColor, QPainter, QPainterPath, QPen, QTransform

from kirigami_studio.assembly.posed_pieces import GLINT, HEAD_RIM, rings_of, shaded
from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.fabricate.hold import HeldState
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.gui.stage.artwork_painting import ShownPrint, paint_patches
from kirigami_studio.gui.widgets.paths import line_path
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.widgets.view_transform import ViewTransform

if TYPE_CHECKING:
    from kirigami_studio.assembly.pieces import Assembly
    from kirigami_studio.assembly.posed_pieces import PosedPieces, Shade

#: Designs whose outlines are kept as paths: those of a gallery and of a comparison.
KEPT_PATHS = 128
#: Width of a line of artwork, mm.
DRAWN_MM = 0.3
#: Faces in the dark theme, against the light one.
DIMMED = 0.86
#: A shadow is drawn so many times, each farther off, and so dark (of 255) each time.
STEPS, DARKNESS = 3, 34
#: Shadows fall so far (pixels) at least and at most.
SHORTEST, LONGEST = 0.6, 12.0
#: Heads smaller than this (pixels) are dots; from the second on they have a rim and a spot of light.
DOT, ROUND = 1.2, 2.4
#: Within so many radians of an end state, places that hold the sheet there are numbered.
SAME_ANGLE = 1e-3


@lru_cache(maxsize=KEPT_PATHS)
def _paths(assembly: Assembly) -> tuple[QPainterPath, ...]:
    """Outlines with openings and holes in the frames of the pieces, mm."""
    return tuple(piece_path(rings_of(piece)) for piece in assembly.pieces)


@lru_cache(maxsize=KEPT_PATHS)
def _drawn_paths(assembly: Assembly) -> tuple[QPainterPath, ...]:
    """Lines of artwork in the frames of the pieces, mm."""
    found = []
    for piece in assembly.pieces:
        path = QPainterPath()
        for line in piece.drawn:
            path.addPath(line_path(line, closed=False))
        found.append(path)
    return tuple(found)


def piece_path(rings: Sequence[FloatArray]) -> QPainterPath:
    """An outline with openings and holes, each ring (L, 2)."""
    path = QPainterPath()
    for ring in rings:
        path.addPath(line_path(ring, closed=True))
    path.setFillRule(Qt.FillRule.OddEvenFill)
    return path


def colour_of(shade: Shade, palette: Palette) -> QColor:
    """A colour of pieces in a theme."""
    return QColor(*(shaded(shade, DIMMED) if palette.dark else shade))


def paint_pieces(
    painter: QPainter,
    pieces: PosedPieces,
    phi: float,
    transform: ViewTransform,
    palette: Palette,
    shown_print: ShownPrint | None = None,
) -> None:
    """Draw all layers, what is printed on them, and the heads of pins at an angle (radians)."""
    places = [(complex(factor), complex(shift)) for factor, shift in zip(*pieces.places(phi), strict=True)]
    to_pixels = _to_pixels(places, transform)
    shown = [to_pixel.map(path) for to_pixel, path in zip(to_pixels, _paths(pieces.assembly), strict=True)]
    drawn = _drawn_paths(pieces.assembly)
    fall = min(max(pieces.shadow * transform.scale, SHORTEST), LONGEST)
    per_mm = transform.scale / pieces.mm_per_world
    pen = QPen(colour_of(pieces.look.line, palette), 1.0 if per_mm > 1.0 else 0.5)
    pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
    for place, layer in enumerate(pieces.layers):
        _paint_shadow(painter, [shown[number] for number in layer], fall)
        painter.setPen(pen)
        painter.setBrush(colour_of(pieces.look.layer(place, len(pieces.layers)), palette))
        for number in layer:
            painter.drawPath(shown[number])
        for number in () if shown_print is None else layer:
            patches = shown_print.patches.get(pieces.assembly.pieces[number].id, ()) if shown_print else ()
            paint_patches(painter, patches, places[number], to_pixels[number], transform)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(colour_of(pieces.look.number, palette), max(1.0, DRAWN_MM * per_mm)))
        for number in layer:
            if not drawn[number].isEmpty():
                painter.drawPath(to_pixels[number].map(drawn[number]))
    heads = transform.to_pixels(pieces.heads(phi))
    if len(heads):
        middles = [QPointF(x, y) for x, y in heads.tolist()]
        _paint_heads(painter, middles, 0.5 * pieces.head_mm * per_mm, fall, pieces.look.head, palette)
    _paint_holds(painter, pieces, phi, transform, palette)


def _paint_holds(
    painter: QPainter, pieces: PosedPieces, phi: float, transform: ViewTransform, palette: Palette
) -> None:
    """Draw places that hold the sheet, those of a state with their numbers there."""
    place_of = {piece.id: number for number, piece in enumerate(pieces.assembly.pieces)}
    factors, shifts = pieces.places(phi)
    for hold in pieces.holds:
        here = abs(phi - (pieces.design.phi_target if hold.state is HeldState.OPEN else math.pi)) < SAME_ANGLE
        painter.setPen(QPen(QColor(palette.accent), 1.5 if here else 0.75))
        painter.setBrush(QColor(palette.accent) if here else Qt.BrushStyle.NoBrush)
        numbers = [place_of[name] for name in hold.parts]
        rings = [
            transform.to_pixels(as_points(factors[number] * as_plane(points) + shifts[number]))
            for number, points in zip(numbers, hold.at, strict=True)
        ]
        radius = max(0.5 * hold.hole_mm * transform.scale / pieces.mm_per_world, DOT)
        for ring in rings:
            if hold.hole_mm:
                for x, y in ring.tolist():
                    painter.drawEllipse(QPointF(x, y), radius, radius)
            else:
                painter.drawPath(line_path(ring, closed=True))
        if here:
            x, y = np.concatenate(rings).max(axis=0).tolist()
            painter.setPen(QColor(palette.text))
            painter.drawText(QPointF(x + radius, y), f"{hold.number}")


def _to_pixels(places: Sequence[tuple[complex, complex]], transform: ViewTransform) -> list[QTransform]:
    """From the frames of pieces, by their factors and shifts into the world, to pixels."""
    scale, (left, top) = transform.scale, transform.origin
    placed = [(scale * factor, scale * shift) for factor, shift in places]
    return [QTransform(a.real, -a.imag, -a.imag, -a.real, left + b.real, top - b.imag) for a, b in placed]


def _paint_shadow(painter: QPainter, paths: list[QPainterPath], fall: float) -> None:
    """Darken what lies below pieces of one layer, to their lower right."""
    painter.save()
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(0, 0, 0, DARKNESS))
    for _ in range(STEPS):
        painter.translate(0.5 * fall / STEPS, fall / STEPS)
        for path in paths:  # one by one: Qt takes several times as long for one large path
            painter.drawPath(path)
    painter.restore()


def _paint_heads(
    painter: QPainter, places: list[QPointF], radius: float, fall: float, shade: Shade, palette: Palette
) -> None:
    """Draw the heads of pins, larger ones with a rim, a spot of light and a shadow."""
    painter.setPen(Qt.PenStyle.NoPen)
    large, radius = radius >= ROUND, max(radius, DOT)
    discs = [(0.0, radius, colour_of(shaded(shade, HEAD_RIM), palette))]
    if large:
        shadow = QColor(0, 0, 0, 2 * DARKNESS)
        light = colour_of(shaded(shade, GLINT), palette)
        discs = [
            (min(0.4 * fall, 0.5 * radius), radius, shadow),
            *discs,
            (0.0, 0.78 * radius, colour_of(shade, palette)),
            (-0.22 * radius, 0.26 * radius, light),
        ]
    for shift, size, colour in discs:
        painter.setBrush(colour)
        for place in places:
            painter.drawEllipse(place + QPointF(shift, shift), size, size)
