"""Connectors as markers: coloured by finished width and picked by the mouse, or coloured by their stretch as cut."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF

from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.widgets.colour_scale import ColourScale
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.widgets.view_transform import ViewTransform

#: Smallest and largest radius (pixels) of a marker with its rim, and how far from its middle it still takes a click.
RADII, REACH = (1.2, 4.0), 9.0
#: A marker is as wide as this share of the short side of a small panel, of which this share are smaller.
SHARE, SMALL = 1.0 / 3.0, 0.1
#: Width of a rim, in radii.
RIM = 0.2
#: Widths closer than this (mm) get one colour.
SAME_MM = 2e-3
STRETCH_TITLE = mark("connector stretch, widths")
#: Smallest and largest radius (pixels) of a dot with its rim, and its share of the usual distance between two.
STRETCH_RADII, STRETCH_SHARE = (1.6, 5.0), 0.2
#: How much larger the dots of connectors that stretch too far are, in radii.
LARGER = 1.5
#: Colours that dots have, from no stretch to what is tolerated.
STRETCH_SHADES = 10


@dataclass(frozen=True, eq=False)
class Connectors:
    """The markers of a plan; made once for each plan."""

    plan: CutPlan

    def __len__(self) -> int:
        return len(self.plan.hinges)

    @cached_property
    def removed(self) -> BoolArray:
        """Which hinges have no connector: (H,) bool."""
        removed = self.plan.hinges.lost.copy()
        removed[[hinge for hinge in self.plan.options.removed if hinge < len(self)]] = True
        return removed

    @cached_property
    def span_mm(self) -> tuple[float, float]:
        """Smallest and largest finished width of those that are there."""
        there = self.plan.hinges.finished_mm[~self.removed]
        return (float(there.min()), float(there.max())) if there.size else (0.0, 0.0)

    @property
    def varied(self) -> bool:
        """Whether they are not all of one width."""
        low, high = self.span_mm
        return high - low >= SAME_MM

    def shade(self, count: int) -> IntArray:
        """Which of ``count`` colours, narrow to wide, each hinge gets: (H,) int."""
        low, high = self.span_mm
        if not self.varied:
            return np.zeros(len(self), dtype=np.intp)
        share = np.clip((np.nan_to_num(self.plan.hinges.finished_mm) - low) / (high - low), 0.0, 1.0)
        shade: IntArray = np.minimum((share * count).astype(np.intp), count - 1)
        return shade

    @cached_property
    def short_side_mm(self) -> float:
        """Short side of a panel smaller than most; without panels, as if the sheet were cut into squares."""
        kept = [panel for panel in self.plan.panels if len(panel)]  # panels in a hole are given up
        sides = [np.linalg.norm(panel - np.roll(panel, 1, axis=0), axis=1).min() for panel in kept]
        if sides:
            return float(np.quantile(sides, SMALL))
        width, height = self.plan.size_mm
        return math.sqrt(2.0 * width * height / max(len(self), 1))

    def radius(self, transform: ViewTransform) -> float:
        """Pixels, the rim included; smaller where the markers would hide the cuts."""
        return min(max(0.5 * SHARE * transform.scale * self.short_side_mm, RADII[0]), RADII[1])

    def asked_mm(self, hinge: int) -> float:
        """Finished width that is asked for, mm; not a number where the connector was removed."""
        return math.nan if self.removed[hinge] else float(self.plan.hinges.asked_mm[hinge])

    def described(self, hinge: int) -> str:
        """Text for one hinge, for tooltips."""
        hinges = self.plan.hinges
        if hinges.lost[hinge]:
            return tr("Connector {hinge}: trimmed off", hinge=hinge)
        if self.removed[hinge]:
            return tr("Connector {hinge}: cut through", hinge=hinge)
        asked, finished = hinges.asked_mm[hinge], hinges.finished_mm[hinge]
        return tr(
            "Connector {hinge}: {asked:.3f} mm requested, {finished:.3f} mm finished",
            hinge=hinge,
            asked=asked,
            finished=finished,
        )

    def nearest(self, place: QPointF, transform: ViewTransform) -> int | None:
        """The hinge under a pixel, if any."""
        away = np.linalg.norm(transform.to_pixels(self.plan.hinges.position) - (place.x(), place.y()), axis=1)
        hinge = int(np.argmin(away))
        return hinge if away[hinge] <= REACH else None

    def within(self, box: QRectF, transform: ViewTransform) -> frozenset[int]:
        """The hinges inside a box of pixels."""
        x, y = transform.to_pixels(self.plan.hinges.position).T
        inside = (x >= box.left()) & (x <= box.right()) & (y >= box.top()) & (y <= box.bottom())
        return frozenset(np.flatnonzero(inside).tolist())


def paint_connectors(
    painter: QPainter, connectors: Connectors, transform: ViewTransform, palette: Palette, selected: frozenset[int]
) -> None:
    """Draw a dot for each connector, a cross where one was removed, and a ring around the selected ones."""
    pixels, radius = transform.to_pixels(connectors.plan.hinges.position), connectors.radius(transform)
    colours = palette.widths
    shade = connectors.shade(len(colours))
    # A rim, so that the palest width stands out from the sheet.
    _paint_dots(painter, pixels[~connectors.removed], palette.muted, 2.0 * radius)
    for index, colour in enumerate(colours):
        _paint_dots(painter, pixels[(shade == index) & ~connectors.removed], colour, 2.0 * (1.0 - RIM) * radius)
    painter.setPen(QPen(QColor(palette.text), 1.6))
    painter.drawLines(_crosses(pixels[connectors.removed & ~connectors.plan.hinges.lost], radius + 1.0))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    for colour, width in ((palette.surface, 4.4), (palette.accent, 2.2)):
        painter.setPen(QPen(QColor(colour), width))
        for hinge in sorted(selected):
            painter.drawEllipse(QPointF(*pixels[hinge].tolist()), radius + 3.5, radius + 3.5)


def _paint_dots(painter: QPainter, pixels: FloatArray, colour: str, width: float) -> None:
    pen = QPen(QColor(colour), width)
    pen.setCapStyle(Qt.PenCapStyle.RoundCap)
    painter.setPen(pen)
    painter.drawPoints(QPolygonF([QPointF(x, y) for x, y in pixels.tolist()]))


def _crosses(pixels: FloatArray, arm: float) -> list[QLineF]:
    arms = ((-arm, -arm), (-arm, arm))
    return [QLineF(x + dx, y + dy, x - dx, y - dy) for x, y in pixels.tolist() for dx, dy in arms]


def stretch_scale(tolerated: float, palette: Palette) -> ColourScale:
    """The scale of stretch, from none to what a connector tolerates; more than that has a sign of its own."""
    ticks = ((0.0, "0"), (tolerated, tr("{most:g} tolerated", most=tolerated)))
    return ColourScale(tr(STRETCH_TITLE), 0.0, tolerated, palette.sequential, ticks)


def paint_stretch(
    painter: QPainter, pixels: FloatArray, stretch: FloatArray, tolerated: float, scale: ColourScale, palette: Palette
) -> None:
    """Draw a dot for each connector.

    Parameters
    ----------
    pixels : (H, 2) float
    stretch : (H,) float
        In widths of the connectors.
    tolerated : float
        Those above it get a larger dot in the colour of faults with a dark rim.
    """
    if not len(pixels):
        return
    apart = math.sqrt(float(np.prod(np.ptp(pixels, axis=0))) / len(pixels))
    radius = min(max(STRETCH_SHARE * apart, STRETCH_RADII[0]), STRETCH_RADII[1])
    within = stretch <= tolerated
    # Dots of one colour are drawn at once, over their rims.
    step = np.rint(scale.share(stretch) * (STRETCH_SHADES - 1)).astype(np.intp)
    _paint_dots(painter, pixels[within], palette.muted, 2.0 * radius)
    colours = scale.shades(np.linspace(scale.low, scale.high, STRETCH_SHADES))
    for number, colour in enumerate(colours):
        _paint_dots(painter, pixels[within & (step == number)], colour.name(), 2.0 * (1.0 - RIM) * radius)
    _paint_dots(painter, pixels[~within], palette.fault_line, 2.0 * LARGER * radius)
    _paint_dots(painter, pixels[~within], palette.fault, 2.0 * LARGER * (1.0 - RIM) * radius)
