"""The curves beside the layout: true at the target angle, read in the worker, a line to scrub by."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import shapely
from PySide6.QtCore import QEvent, QPoint, QPointF, QSettings, QSize, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot
from stopwatch import paced

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.gui.stage.curves import ANGLES, Reading, batches, plotting
from kirigami_studio.gui.widgets.theme import DARK, LIGHT
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines import silhouettes

Until = Callable[[Callable[[], bool]], None]
#: Processor seconds in which the curves of a 10 x 10 design are complete; found: a third of a second.
CURVES_S = 4.0


@pytest.fixture
def plotted(designed: MainWindow, until: Until) -> MainWindow:
    """A studio with the plots open and read to the end."""
    designed.resize(1440, 900)
    designed.commands["plots"].trigger()
    until(lambda: designed.stage.plots.complete)
    return designed


def read(design: PosedDesign) -> list[Reading]:
    return [reading for some in plotting(design, silhouettes.load("heart"), lambda: False) for reading in some]


@pytest.mark.parametrize("phi", [0.0, math.radians(40.7)])
def test_that_the_curves_meet_the_score_at_the_target_angle(phi: float) -> None:
    field, target = (
        RatioField.from_log10(np.random.default_rng(3).normal(size=(4, 6)) * 0.15),
        silhouettes.load("heart"),
    )
    sheet = deploy(field)
    score = evaluate(sheet, target, phi)
    at_target = {reading.phi: reading for reading in read(PosedDesign(sheet, score.transform, phi))}[phi]
    assert (at_target.siou, at_target.iou) == (score.siou, score.iou_exact)
    assert at_target.area == pytest.approx(shapely.Polygon(sheet.outline(phi)).area)
    voids = shapely.area(shapely.polygons(sheet.voids(phi).reshape(-1, 4, 2))).sum()
    assert at_target.porosity == pytest.approx(voids / at_target.area, abs=1e-12)
    posed = score.transform.apply(sheet.outline(phi)) / score.transform.scale
    assert (at_target.width, at_target.height) == pytest.approx(tuple(np.ptp(posed, axis=0)))


def test_that_every_angle_is_read_once_and_the_coarse_picture_comes_first() -> None:
    for phi in (0.0, 0.5, math.radians(90.0)):
        order = [angle for some in batches(phi) for angle in some]
        assert len(order) == len(set(order)) and set(np.linspace(math.pi, 0.0, ANGLES).tolist()) <= set(order)
        assert phi in order[:2]
        assert max(np.diff(np.sort(order[:10]))) < math.radians(30.0)


def test_that_the_curves_of_100_voids_are_read_while_one_looks() -> None:
    target = silhouettes.load("heart")
    sheet = deploy(RatioField.from_log10(np.random.default_rng(1).normal(size=(10, 10)) * 0.1))
    design = PosedDesign(sheet, evaluate(sheet, target, 0.0).transform, 0.0)
    next(plotting(design, target, lambda: False))  # what is imported and tabulated once
    seconds = paced(lambda: list(plotting(design, target, lambda: False)), 1)
    assert seconds < CURVES_S


def test_that_nothing_is_read_while_the_plots_are_closed(designed: MainWindow, until: Until) -> None:
    plotting_, stage = designed.services.curves, designed.stage
    assert not plotting_.busy and not stage.plots.isVisible() and not stage.plots.charts
    designed.commands["plots"].trigger()
    assert plotting_.busy and stage.plots.isVisible()
    designed.commands["plots"].trigger()
    assert not plotting_.busy and not stage.plots.isVisible()
    until(lambda: not designed.session.queue.busy)
    assert not stage.plots.complete


def test_that_charts_are_made_one_in_each_turn_and_then_drawn(designed: MainWindow, until: Until) -> None:
    plots, made = designed.stage.plots, []
    plots._turn.timeout.connect(lambda: made.append(len(plots.charts)))
    designed.resize(1440, 1000)
    designed.commands["plots"].trigger()
    until(lambda: plots.complete)
    assert made[:5] == [1, 2, 3, 4, 5] and set(made[5:]) == {5}
    for chart in plots.charts:
        assert len(chart.curves[0].getData()[0]) >= ANGLES and chart.nearest is not None


def test_that_another_design_gets_curves_of_its_own_and_old_ones_are_kept(plotted: MainWindow, until: Until) -> None:
    stage, first = plotted.stage, plotted.stage.plots.charts[0].curves[0].getData()[1].copy()
    plotted.commands["next"].trigger()
    assert not stage.plots.complete and plotted.services.curves.busy
    until(lambda: stage.plots.complete)
    assert not np.allclose(stage.plots.charts[0].curves[0].getData()[1], first)
    plotted.commands["previous"].trigger()
    assert stage.plots.complete and not plotted.services.curves.busy
    assert stage.plots.charts[0].curves[0].getData()[1] == pytest.approx(first)


def test_that_the_line_follows_the_slider_and_the_slider_the_line(plotted: MainWindow) -> None:
    stage = plotted.stage
    stage.deployment.set_phi(math.radians(60.0))
    for chart in stage.plots.charts:
        assert chart.line.value() == pytest.approx(60.0)
    chart = stage.plots.charts[1]
    chart.line.setValue(120.0)
    chart.line.sigDragged.emit(chart.line)
    assert math.degrees(stage.view.phi) == pytest.approx(120.0, abs=0.051)
    assert stage.plots.charts[0].line.value() == pytest.approx(120.0, abs=0.051)


def test_that_a_mouse_drags_the_line_and_a_click_moves_it(plotted: MainWindow, qtbot: QtBot) -> None:
    stage = plotted.stage
    stage.deployment.set_phi(math.radians(90.0))
    QApplication.processEvents()
    chart = stage.plots.charts[0]
    box, pane = chart.plot.getPlotItem().vb, chart.plot.viewport()

    def pixel(degrees: float) -> QPointF:
        place = box.mapViewToScene(QPointF(degrees, sum(box.viewRange()[1]) / 2))
        return QPointF(chart.plot.mapFromScene(place))

    def send(kind: QEvent.Type, degrees: float, held: bool) -> None:
        left, none = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton
        place = pixel(degrees)
        button = none if kind == QEvent.Type.MouseMove else left
        event = QMouseEvent(
            kind, place, pane.mapToGlobal(place), button, left if held else none, Qt.KeyboardModifier.NoModifier
        )
        QApplication.sendEvent(pane, event)

    send(QEvent.Type.MouseMove, 90.0, False)
    send(QEvent.Type.MouseButtonPress, 90.0, True)
    for degrees in (80.0, 60.0, 40.0, 30.0):
        send(QEvent.Type.MouseMove, degrees, True)
    send(QEvent.Type.MouseButtonRelease, 30.0, False)
    assert math.degrees(stage.view.phi) == pytest.approx(30.0, abs=2.0)
    send(QEvent.Type.MouseButtonPress, 150.0, True)
    send(QEvent.Type.MouseButtonRelease, 150.0, False)
    assert math.degrees(stage.view.phi) == pytest.approx(150.0, abs=2.0)
    send(QEvent.Type.MouseMove, 110.0, False)
    read_out = chart.nearest
    assert read_out is not None and read_out[0] == pytest.approx(110.0, abs=3.0)
    QApplication.sendEvent(pane, QEvent(QEvent.Type.Leave))
    read_out = chart.nearest
    assert read_out is not None and read_out[0] == pytest.approx(150.0, abs=3.0)


def test_that_numbers_are_those_of_the_angle_they_name_and_in_mm(plotted: MainWindow) -> None:
    stage, entry = plotted.stage, plotted.session.stage
    assert entry is not None
    stage.deployment.set_phi(math.radians(61.0))
    degrees, (area,) = stage.plots.charts[1].nearest or (0.0, (0.0,))
    assert degrees == pytest.approx(60.0)
    cell = 100.0 / (entry.design.deployment.field.columns + 1)
    assert area == pytest.approx(entry.design.deployment.area(math.radians(60.0)) * cell**2)
    assert f"{area:.0f} mm²" in stage.plots.charts[1].numbers.text() and "60.0°" in stage.plots.charts[1].numbers.text()
    plotted.services.fabrication.change(width_mm=200.0)
    assert (stage.plots.charts[1].nearest or (0, (0,)))[1][0] == pytest.approx(4 * area)


def test_that_a_narrow_stage_shows_one_chart_of_choice_below(plotted: MainWindow) -> None:
    stage = plotted.stage
    assert stage.split.orientation() is Qt.Orientation.Horizontal
    assert all(chart.isVisible() for chart in stage.plots.charts) and not stage.plots.choice.isVisible()
    plotted.resize(QSize(1000, 640))
    QApplication.processEvents()
    assert stage.split.orientation() is Qt.Orientation.Vertical and stage.plots.choice.isVisible()
    stage.plots.buttons.button(2).click()
    assert [chart.isVisible() for chart in stage.plots.charts] == [False, False, True, False, False]


def test_that_the_charts_follow_the_theme_and_open_plots_are_remembered(plotted: MainWindow, tmp_path: Path) -> None:
    chart = plotted.stage.plots.charts[0]
    corner = QPoint(chart.width() - 2, chart.height() - 2)
    for palette in (LIGHT, DARK):
        plotted.appearance.set_theme(palette)
        assert chart.grab().toImage().pixelColor(corner).name() == palette.surface
    state = QSettings(str(tmp_path / "state.ini"), QSettings.Format.IniFormat)
    plotted.remember(state)
    plotted.commands["plots"].trigger()
    assert not plotted.stage.plots.isVisible()
    plotted.stage.restore(state)
    assert plotted.stage.plots.isVisible() and plotted.commands["plots"].isChecked()


@pytest.mark.parametrize("width", [250, 400])
def test_that_the_numbers_above_a_curve_are_never_cut_off(plotted: MainWindow, width: int) -> None:
    for chart in plotted.stage.plots.charts:
        chart.resize(width, chart.height())
        assert chart.numbers.text()
        assert chart.numbers.sizeHint().width() <= width
    last = plotted.stage.plots.charts[0]
    assert last.nearest is not None
    assert (f"{last.nearest[0]:.1f}°" in last.numbers.text()) == (width == 400), "the angle goes first"
