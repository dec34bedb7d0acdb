"""A chart of a few curves as SVG, drawn by reportlab, which the program needs for PDF anyway."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import kirigami_studio.export.pdf_library  # noqa: F401  (before reportlab's own modules)

# isort: split
from reportlab.graphics import renderSVG
from reportlab.graphics.charts.axes import LogXValueAxis
from reportlab.graphics.charts.lineplots import LinePlot
from reportlab.graphics.shapes import Drawing, Line, Rect, String
from reportlab.lib.colors import HexColor, white

#: Colours that people with colour blindness tell apart (Okabe and Ito 2008).
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
WIDTH, HEIGHT = 560.0, 300.0


@dataclass(frozen=True, slots=True)
class Curve:
    """A named line through points (x, y)."""

    name: str
    points: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class LineChart:
    """Curves over one pair of axes.

    Attributes
    ----------
    x, y : str
        What the axes say.
    curves : sequence of Curve
    logarithmic : bool
        The x axis; all x are positive then.
    """

    x: str
    y: str
    curves: Sequence[Curve]
    logarithmic: bool = False

    def svg(self) -> bytes:
        """The picture; the same chart gives the same bytes."""
        drawing = Drawing(WIDTH, HEIGHT)
        drawing.add(Rect(0, 0, WIDTH, HEIGHT, fillColor=white, strokeColor=None))
        # reportlab carries no types, and its defaults are narrower than what it takes.
        plot: Any = LinePlot()
        plot.x, plot.y, plot.width, plot.height = 54, 44, WIDTH - 190, HEIGHT - 74
        plot.data = [list(curve.points) for curve in self.curves]
        if self.logarithmic:
            plot.xValueAxis = LogXValueAxis()
            plot.xValueAxis.valueSteps = sorted({x for curve in self.curves for x, _ in curve.points})
            plot.xValueAxis.labelTextFormat = "%g"
        low, high = self._range()
        plot.yValueAxis.valueMin, plot.yValueAxis.valueMax = low, high
        plot.yValueAxis.labelTextFormat = "%g"
        plot.yValueAxis.visibleGrid = True
        plot.yValueAxis.gridStrokeColor = HexColor("#dddddd")
        for number, curve in enumerate(self.curves):
            colour = HexColor(COLOURS[number % len(COLOURS)])
            plot.lines[number].strokeColor, plot.lines[number].strokeWidth = colour, 1.6
            height = HEIGHT - 34 - 18 * number
            drawing.add(Line(WIDTH - 120, height + 4, WIDTH - 98, height + 4, strokeColor=colour, strokeWidth=1.6))
            drawing.add(String(WIDTH - 92, height, curve.name, fontName="Helvetica", fontSize=11))
        drawing.add(plot)
        middle = plot.x + 0.5 * plot.width
        drawing.add(String(middle, 10, self.x, fontName="Helvetica", fontSize=11, textAnchor="middle"))
        drawing.add(String(6, HEIGHT - 14, self.y, fontName="Helvetica", fontSize=11))
        text: str = renderSVG.drawToString(drawing)
        # CSS knows "None" as it knows "none", but not every reader of SVG does.
        return text.replace("fill: None", "fill: none").encode()

    def _range(self) -> tuple[float, float]:
        """Round limits of the y axis."""
        values = [y for curve in self.curves for _, y in curve.points]
        low, high = min(values), max(values)
        step = 10.0 ** math.floor(math.log10(max(high - low, 1e-9)))
        return step * math.floor(low / step), step * math.ceil(high / step + 1e-9)
