"""Curves of one design over the deployment angle: match, area, porosity, size, gaps; force and energy as cut."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QButtonGroup, QSizePolicy, QToolButton, QWidget

from kirigami_studio.foundation.words import ShownUnit, tr
from kirigami_studio.gui.stage.curves import ANGLES, Curves
from kirigami_studio.gui.widgets.layouts import column, label, plain_pane, row
from kirigami_studio.gui.widgets.theme import LIGHT, Palette

if TYPE_CHECKING:
    from kirigami_studio.gui.widgets.chart import Chart
    from kirigami_studio.mechanics.closing import Closing
    from kirigami_studio.studio.as_cut import SimulatedSheet

#: Height of a chart that is alone (pixels), and with which all are shown; with less they are shown one at a time.
CHART_HEIGHT, ALL_CHARTS_HEIGHT = 132, 528


@dataclass(frozen=True, slots=True)
class _Row:
    """One chart: its button's text, its tooltip, its unit, and what it draws.

    Of the ideal motion that is a number of each reading and the mm of a cell, of the sheet as cut an array of its
    closing.
    """

    text: str
    tip: str
    unit: str
    series: tuple[tuple[str, Callable[[Any, float], Any]], ...]
    from_zero: bool = False
    as_cut: bool = False


def _rows() -> tuple[_Row, ...]:
    # Against an angle the slope of the energy is a moment: what a lever of one panel's size needs at its end.
    force = tr("Force at the edge of a panel that holds the sheet at each angle as cut, N")
    return (
        _Row(tr("Match"), tr("Match of the whole sheet with the target at each angle, in its best pose, %"), "%", (
            ("sIoU", lambda reading, mm: 100.0 * reading.siou),
            (tr("exact IoU"), lambda reading, mm: 100.0 * reading.iou),
        )),
        _Row(tr("Area"), tr("Area inside the sheet's outline, voids included"), "mm²", (
            (tr("area"), lambda reading, mm: reading.area * mm * mm),
        )),
        _Row(tr("Porosity"), tr("Share of the area inside the sheet's outline that is voids, %"), "%", (
            (tr("porosity"), lambda reading, mm: 100.0 * reading.porosity),
        ), True),
        _Row(tr("Size"), tr("Width and height of the sheet as shown"), "mm", (
            (tr("width"), lambda reading, mm: reading.width * mm),
            (tr("height"), lambda reading, mm: reading.height * mm),
        )),
        _Row(tr("Gap"), tr("Narrowest gap between parts of the outline; 0 means contact"), "mm", (
            (tr("gap"), lambda reading, mm: reading.gap * mm),
        ), True),
        _Row(tr("Force"), force, "N", (
            (tr("force"), lambda found, _: found.path.force / found.sheet.network.panel_size),
        ), as_cut=True),
        _Row(tr("Energy"), tr("Energy in the connectors at each angle as cut, mJ"), "mJ", (
            (tr("energy"), lambda found, _: found.path.energy),
        ), as_cut=True),
    )  # fmt: skip


class PlotsPanel(QWidget):
    """Charts below each other where there is room, else one of them; nothing is drawn before the first curve comes.

    Making a chart takes 30 ms and drawing its curve with its axes 15 ms, so that of charts which are new, or whose
    curves grow, one comes in each turn of the event loop.
    """

    phi_wanted = Signal(float)  #: radians

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._palette: Palette = LIGHT
        self._curves: Curves | None = None
        self._width_mm = 100.0
        self._phi, self._target, self._pointed = math.pi, 0.0, -1.0
        self._rows = _rows()
        self._closing: Closing | None = None
        self._made: list[Chart] = []
        self._stale: list[int] = []  # charts whose curves are to be drawn
        self._turn = QTimer(self, singleShot=True, interval=0)
        self._turn.timeout.connect(self._go_on)
        self.setObjectName("plain")
        self.setAccessibleName(tr("Plots by deployment angle"))
        self.empty_message = label(wraps=True)
        self.empty_message.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._add_choice()
        self._column = column(self.choice, (self.empty_message, 1), on=self, spacing=2)
        self.setMinimumSize(200, CHART_HEIGHT + 34)
        self.show_curves(None)

    def _add_choice(self) -> None:
        self.choice = plain_pane()
        self.buttons = QButtonGroup(self)
        for number, shown in enumerate(self._rows):
            button = QToolButton()
            button.setText(shown.text)
            button.setToolTip(shown.tip)
            button.setAccessibleName(shown.tip)
            button.setCheckable(True)
            button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
            button.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
            self.buttons.addButton(button, number)
        self.buttons.button(0).setChecked(True)
        self.buttons.idToggled.connect(lambda _number, _on: self._share_room())
        row(*self.buttons.buttons(), on=self.choice, spacing=2)

    @property
    def complete(self) -> bool:
        """Whether every angle has been read and is seen."""
        return self._curves is not None and self._curves.complete and not self._turn.isActive()

    def show_curves(self, curves: Curves | None) -> None:
        """Draw what is known so far; None when nothing is."""
        growing = self._curves is not None and not self._curves.complete
        self._curves = curves
        known = bool(curves is not None and curves.readings)
        if known and (growing or not self._built):
            ideal = [number for number, shown in enumerate(self._rows) if not shown.as_cut]
            self._stale = [*self._stale, *(number for number in ideal if number not in self._stale)]
            self._turn.start()
        else:
            self._stale.clear()
            self._turn.stop()
            self._draw()
        self._arrange()

    def show_as_cut(self, sheet: SimulatedSheet | None) -> None:
        """Draw what the sheet does as cut; None where that is not known."""
        before, self._closing = self._closing, None if sheet is None else sheet.closing
        if self._built and before is not self._closing:
            self._draw_as_cut()
            self._share_room()

    def _draw_as_cut(self) -> None:
        from kirigami_studio.gui.widgets.chart import Series

        found = self._closing
        if found is None:
            return
        for shown, chart in zip(self._rows, self._made, strict=True):
            if shown.as_cut:
                chart.set_series(Series(np.degrees(found.phi), tuple(take(found, 1.0) for _, take in shown.series)))
                chart.read_out(self._angle)

    @property
    def charts(self) -> list[Chart]:
        """Those of the ideal motion."""
        return [chart for shown, chart in zip(self._rows, self._made, strict=False) if not shown.as_cut]

    @property
    def cut_charts(self) -> list[Chart]:
        """Those of the sheet as cut."""
        return [chart for shown, chart in zip(self._rows, self._made, strict=False) if shown.as_cut]

    @property
    def _built(self) -> bool:
        return len(self._made) == len(self._rows)

    def _go_on(self) -> None:
        """Make one chart, or redraw one."""
        if not self._built:
            self._build()
            if self._built:
                self._draw_as_cut()
            self._turn.start()
            return
        if self._stale:
            number = self._stale.pop(0)
            self._draw_chart(number)
            self._made[number].read_out(self._angle)
        if self._stale:
            self._turn.start()
        else:
            self._arrange()

    def _arrange(self) -> None:
        """Show the charts, or say why there are none."""
        curves = self._curves
        shown = self._built and curves is not None and bool(curves.readings)
        waiting = tr("Measuring the design at {count} angles …", count=ANGLES)
        self.empty_message.setText("" if shown else waiting if curves is not None else tr("No design yet."))
        self.empty_message.setVisible(not shown)
        self._share_room()

    def set_sheet_width(self, width_mm: float) -> None:
        """Set the width of the flat sheet, mm."""
        if width_mm != self._width_mm:
            self._width_mm = width_mm
            self._draw()

    def set_phi(self, phi: float) -> None:
        """Another angle is shown, radians."""
        self._phi = phi
        for chart in self._made:
            chart.set_phi(phi)
        self._read_out()

    def set_target(self, phi: float) -> None:
        """Mark the target angle, radians."""
        self._target = phi
        for chart in self._made:
            chart.set_target(phi)

    def set_palette(self, palette: Palette) -> None:
        """Draw the charts to come in other colours."""
        self._palette = palette

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        self._share_room()

    def _build(self) -> None:
        from kirigami_studio.gui.widgets.chart import Chart  # the worker has imported what it draws with

        shown = self._rows[len(self._made)]
        chart = Chart(shown.text, shown.unit, tuple(name for name, _ in shown.series), shown.from_zero)
        chart.setToolTip(tr("{what}\nDrag the line or click to jump to an angle.", what=shown.tip))
        chart.set_palette(self._palette)
        chart.phi_wanted.connect(self.phi_wanted)
        chart.pointed.connect(self._point)
        chart.set_phi(self._phi)
        chart.set_target(self._target)
        chart.hide()
        self._column.addWidget(chart, 1)
        self._made.append(chart)

    def _share_room(self) -> None:
        """All charts where they fit; one of them, and the choice, where they do not."""
        everything = self.height() >= ALL_CHARTS_HEIGHT
        self.choice.setVisible(not everything)
        known = self._built and self._curves is not None and bool(self._curves.readings)
        closed = self._closing is not None
        for number, shown in enumerate(self._rows):
            if shown.as_cut:
                self.buttons.button(number).setEnabled(closed)
                if not closed and number == self.buttons.checkedId():
                    self.buttons.button(0).setChecked(True)
        last = max(number for number, shown in enumerate(self._rows) if closed or not shown.as_cut)
        for number, (shown, chart) in enumerate(zip(self._rows, self._made, strict=False)):
            there = known and (closed or not shown.as_cut)
            chart.setVisible(there and (everything or number == self.buttons.checkedId()))
            chart.show_angles(not everything or number == last)

    def show_unit(self) -> None:
        """Draw lengths in another unit."""
        self._draw()

    def _draw(self) -> None:
        if self._curves is not None and self._built:
            for number, shown in enumerate(self._rows):
                if not shown.as_cut:
                    self._draw_chart(number)
            self._read_out()

    def _draw_chart(self, number: int) -> None:
        from kirigami_studio.gui.widgets.chart import Series

        if self._curves is None:
            return
        readings, mm = self._curves.readings, self._curves.cell_share * self._width_mm
        degrees = np.degrees([reading.phi for reading in readings])
        row = self._rows[number]
        unit = ShownUnit.mm() ** {"mm": 1, "mm²": 2}.get(row.unit, 0)
        values = [np.array([take(reading, mm) / unit for reading in readings]) for _, take in row.series]
        self._made[number].set_unit(ShownUnit.words(row.unit))
        self._made[number].set_series(Series(degrees, tuple(values)))

    def _point(self, phi: float) -> None:
        self._pointed = phi
        self._read_out()

    def _read_out(self) -> None:
        """Say the numbers where the mouse points, or where the sheet is, at the nearest angle that was read."""
        for chart in self.charts if self._closing is None else self._made:
            chart.read_out(self._angle)

    @property
    def _angle(self) -> float:
        return self._pointed if self._pointed >= 0.0 else self._phi
