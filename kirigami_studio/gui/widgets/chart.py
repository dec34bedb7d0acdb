"""One chart over the deployment angle: curves, a draggable line at the present angle, the values there."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyqtgraph
from PySide6.QtCore import QEvent, QObject, Qt, Signal
from PySide6.QtGui import QColor, QPen, QResizeEvent, QTextDocument
from PySide6.QtWidgets import QLabel, QSizePolicy, QWidget

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.words import decimal_sign, number, tr
from kirigami_studio.gui.widgets.card import own_markup
from kirigami_studio.gui.widgets.layouts import column
from kirigami_studio.gui.widgets.theme import LIGHT, Palette

pg: Any = pyqtgraph  # it has types for a part of itself only


#: Degrees between the numbers of the angle axis.
TICKS = (180, 135, 90, 45, 0)
#: Pixels that the numbers at the left take.
AXIS_WIDTH = 50


@dataclass(frozen=True, slots=True, eq=False)
class Series:
    """Curves over common angles: degrees (K,), and values (K,) for each."""

    degrees: FloatArray
    values: tuple[FloatArray, ...]


class Chart(QWidget):
    """Draws what it is given; the flat sheet is on the left, as on the slider."""

    phi_wanted = Signal(float)  #: radians
    pointed = Signal(float)  #: radians, negative when the mouse has left

    def __init__(self, title: str, unit: str, names: tuple[str, ...], from_zero: bool = False) -> None:
        super().__init__()
        self._title, self._names, self._from_zero = title, names, from_zero
        self._nearest: int | None = None
        self._palette: Palette = LIGHT
        self._series = Series(np.zeros(0), tuple(np.zeros(0) for _ in names))
        self.set_unit(unit)
        self.numbers = QLabel()
        own_markup(self.numbers)
        self.numbers.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        # Moves that follow each other closely must not be dropped: the last one says where the line is to stay.
        pg.setConfigOptions(mouseRateLimit=0)
        self.plot: Any = pg.PlotWidget(axisItems={"left": _axis()})
        self.plot.setMenuEnabled(False)
        self.plot.hideButtons()
        self.plot.setMouseEnabled(False, False)
        self.plot.setFrameShape(self.plot.Shape.NoFrame)
        self.plot.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.plot.invertX(True)
        self.plot.setXRange(0.0, 180.0, padding=0.07)
        self.plot.getAxis("left").setWidth(AXIS_WIDTH)
        self.plot.getAxis("left").enableAutoSIPrefix(False)
        self.plot.getAxis("bottom").setTicks([[(tick, f"{tick}°") for tick in TICKS]])
        self.curves: list[Any] = [self.plot.plot() for _ in names]
        self.dots: Any = pg.ScatterPlotItem(size=7)
        self.plot.addItem(self.dots)
        self.target: Any = pg.InfiniteLine(pos=0.0, angle=90, movable=False)
        self.plot.addItem(self.target)
        self.line: Any = pg.InfiniteLine(pos=180.0, angle=90, movable=True, bounds=(0.0, 180.0))
        self.plot.addItem(self.line)
        self.line.sigDragged.connect(lambda line: self.phi_wanted.emit(math.radians(line.value())))
        self.plot.scene().sigMouseClicked.connect(self._click)
        self.plot.scene().sigMouseMoved.connect(self._move)
        self.plot.viewport().installEventFilter(self)
        column(self.numbers, (self.plot, 1), on=self, spacing=0)

    def set_series(self, series: Series) -> None:
        """Draw other values; those that are not numbers leave a gap."""
        self._series = series
        for curve, values in zip(self.curves, series.values, strict=True):
            curve.setData(series.degrees, values, connect="finite")
        known = np.concatenate(series.values)
        known = known[np.isfinite(known)]
        if known.size:
            low, high = float(known.min()), float(known.max())
            low = 0.0 if self._from_zero else low
            self.plot.setYRange(low, high if high > low else low + 1.0, padding=0.08)

    def set_phi(self, phi: float) -> None:
        """Move the line, radians, without a signal."""
        self.line.setValue(math.degrees(phi))

    def set_target(self, phi: float) -> None:
        """Mark the target angle, radians."""
        self.target.setValue(math.degrees(phi))

    def show_angles(self, shown: bool) -> None:
        """Whether the angle axis has numbers."""
        self.plot.getAxis("bottom").setStyle(showValues=shown)
        self.plot.getAxis("bottom").setHeight(None if shown else 6)

    def set_unit(self, unit: str) -> None:
        """Set the unit that is read out with the numbers."""
        self._unit = unit
        self.setAccessibleName(tr("{title}, {unit}", title=self._title, unit=unit))

    def set_palette(self, palette: Palette) -> None:
        self._palette = palette
        self.plot.setBackground(QColor(palette.surface))
        for side in ("left", "bottom"):
            axis = self.plot.getAxis(side)
            axis.setPen(QPen(QColor(palette.strong_border), 1.0))
            axis.setTextPen(QColor(palette.muted))
        self.plot.showGrid(x=True, y=True, alpha=0.25)
        for curve, colour, style in zip(self.curves, self._colours(), _STYLES, strict=False):
            curve.setPen(_pen(colour, 2.0, style))
        self.target.setPen(_pen(palette.target, 1.4, Qt.PenStyle.DotLine))
        self.line.setPen(_pen(palette.text, 1.4, Qt.PenStyle.SolidLine))
        self.line.setHoverPen(_pen(palette.accent, 3.0, Qt.PenStyle.SolidLine))
        self.dots.setPen(_pen(palette.surface, 1.0, Qt.PenStyle.SolidLine))
        self.dots.setBrush(QColor(palette.text))
        self._write()

    def _colours(self) -> tuple[str, ...]:
        return self._palette.accent, self._palette.target

    def read_out(self, phi: float) -> None:
        """Write the values at the angle that was read nearest to ``phi`` (radians), and mark them."""
        self._nearest = None
        if self._series.degrees.size:
            self._nearest = int(np.argmin(np.abs(self._series.degrees - math.degrees(phi))))
        self._write()

    @property
    def nearest(self) -> tuple[float, tuple[float, ...]] | None:
        """Angle (degrees) and values that are written."""
        if self._nearest is None:
            return None
        degrees = float(self._series.degrees[self._nearest])
        return degrees, tuple(float(values[self._nearest]) for values in self._series.values)

    def _write(self) -> None:
        read = self.nearest
        if read is None:
            self.numbers.setText("")
            self.dots.setData([], [])
            return
        degrees, values = read
        self.numbers.setText(self._readout(degrees, values))
        known = [value for value in values if math.isfinite(value)]
        self.dots.setData([degrees] * len(known), known)

    def _readout(self, degrees: float, values: tuple[float, ...]) -> str:
        """The values in the longest form that fits; the angle, which the slider shows too, goes first."""
        muted = f'<span style="color:{self._palette.muted}">{number(degrees, ".1f")}°</span>'
        text = ""
        for decimals, tail in ((2, [muted]), (2, []), (1, []), (0, [])):
            parts = []
            for name, colour, sign, value in zip(self._names, self._colours(), ("━", "┅"), values, strict=False):
                figure = _readable(value, self._unit, decimals)
                parts.append(f'<span style="color:{colour}">{sign}</span> {name} <b>{figure}</b>')
            text = "&nbsp; ".join([*parts, *tail])
            if self._text_width(text) <= self.width():
                break
        return text

    def _text_width(self, text: str) -> float:
        """Pixels that the numbers take in one line."""
        page = QTextDocument()
        page.setDocumentMargin(0.0)
        page.setDefaultFont(self.numbers.font())
        page.setHtml(text)
        return page.idealWidth()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        self._write()

    def _click(self, event: Any) -> None:
        if event.button() == Qt.MouseButton.LeftButton and not event.isAccepted():
            self.phi_wanted.emit(self._phi_under(event.scenePos()))

    def _move(self, place: Any) -> None:
        self.pointed.emit(self._phi_under(place))

    def _phi_under(self, place: Any) -> float:
        degrees = self.plot.getPlotItem().vb.mapSceneToView(place).x()
        return math.radians(min(max(degrees, 0.0), 180.0))

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        if event.type() == QEvent.Type.Leave:
            self.pointed.emit(-1.0)
        return super().eventFilter(watched, event)


_STYLES = (Qt.PenStyle.SolidLine, Qt.PenStyle.DashLine)


def _axis() -> Any:
    """An axis that writes the decimal sign of the language."""

    def ticks(values: Any, scale: float, spacing: float) -> list[str]:
        return [text.replace(".", decimal_sign()) for text in english(values, scale, spacing)]

    axis = pg.AxisItem("left")
    english, axis.tickStrings = axis.tickStrings, ticks
    return axis


def _pen(colour: str, width: float, style: Qt.PenStyle) -> QPen:
    pen = QPen(QColor(colour), width, style)
    pen.setCosmetic(True)  # else it would be as wide in the chart's units
    return pen


def _readable(value: float, unit: str, decimals: int) -> str:
    if not math.isfinite(value):
        return tr("none")
    return f"{number(value, f'.{0 if abs(value) >= 1000 else decimals}f')} {unit}"
