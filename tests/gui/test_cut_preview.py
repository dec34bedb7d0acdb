"""The cuts as they will burn: kerf, steps, play, problems, and speed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from paint_counter import PaintCounter
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QColor, QImage
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from kirigami_studio.fabricate.checks import check_plan
from kirigami_studio.fabricate.cut_plan import CutPath, CutPlan, Layer, plan_cuts
from kirigami_studio.gui.make.cut_items import SEEN, THINNEST, CutDrawing, cut_steps
from kirigami_studio.gui.make.cut_view import CutOverlay, CutView
from kirigami_studio.gui.widgets.legends import round_length
from kirigami_studio.gui.widgets.theme import LIGHT
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton


def plan_of(rows: int, columns: int, **changes: float) -> CutPlan:
    field = RatioField.from_log10(np.random.default_rng(1).normal(size=(rows, columns)) * 0.05)
    return plan_cuts(deploy(field), width_mm=10.0 * columns, **changes)


@pytest.fixture
def cutting(designed: MainWindow, qtbot: QtBot) -> MainWindow:
    """A studio that shows the cuts of its design."""
    designed.commands["cuts"].trigger()
    QApplication.processEvents()
    return designed


def show(qtbot: QtBot, plan: CutPlan, size: tuple[int, int] = (700, 700)) -> CutView:
    view = CutView()
    qtbot.addWidget(view)
    view.resize(*size)
    view.show_plan(plan, check_plan(plan).problems)
    with qtbot.waitExposed(view):
        view.show()
    return view


def burnt(image: QImage, view: CutView, place: tuple[float, float], along: tuple[float, float]) -> int:
    """Pixels across a cut at a place (mm) that are not the sheet's colour."""
    transform = view.transform()
    assert transform is not None
    x, y = transform.to_pixels(np.array(place)).tolist()
    normal = np.array([along[1], along[0]]) / np.hypot(*along)  # the picture's y axis points down
    sheet = QColor(LIGHT.cut_sheet)
    shifts = np.arange(-30, 31)
    colours = [image.pixelColor(round(x + s * normal[0]), round(y + s * normal[1])) for s in shifts]
    return sum(abs(colour.red() - sheet.red()) > 60 for colour in colours)


def test_that_a_key_goes_to_the_sheet_as_it_is_cut_and_back(designed: MainWindow, qtbot: QtBot) -> None:
    stage, cuts = designed.stage, designed.cuts
    assert stage.view.isVisible() and not cuts.view.isVisible()
    qtbot.keyClick(designed, Qt.Key.Key_C)
    assert (
        designed.pages.page is WindowPage.MAKE and cuts.view.hasFocus() and cuts.toggles[CutOverlay.TRAVEL].isVisible()
    )
    assert stage.view.isVisible() and stage.deployment.isVisible(), "stage and slider stay in view"
    qtbot.keyClick(designed, Qt.Key.Key_C)
    assert designed.pages.page is WindowPage.DESIGN and stage.view.hasFocus() and not cuts.isVisible()


@pytest.mark.parametrize("kerf", [0.5, 2.0])
def test_that_a_cut_is_drawn_as_wide_as_it_burns(qtbot: QtBot, kerf: float) -> None:
    plan = plan_of(3, 3, kerf_mm=kerf, connector_mm=1.0)
    view = show(qtbot, plan)
    view.set_overlays(frozenset())
    transform = view.transform()
    assert transform is not None
    path = plan.on_layer(Layer.SLITS)[4]
    along = path.points[-1] - path.points[0]
    beside_the_junctions = path.points[0] + 0.3 * along
    found = burnt(view.grab().toImage(), view, tuple(beside_the_junctions), tuple(along))
    assert found == pytest.approx(kerf * transform.scale, abs=2.0)


def test_that_the_cut_of_a_blade_is_still_seen(qtbot: QtBot) -> None:
    plan = plan_of(3, 3, kerf_mm=0.0, connector_mm=1.0)
    view = show(qtbot, plan)
    transform = view.transform()
    assert transform is not None and CutDrawing(plan).pen_width(transform) == THINNEST
    view.set_overlays(frozenset())
    path = plan.on_layer(Layer.SLITS)[4]
    along = path.points[-1] - path.points[0]
    assert burnt(view.grab().toImage(), view, tuple(path.points.mean(axis=0)), tuple(along)) >= 1


def test_that_the_last_step_ends_with_the_plans_own_time_and_length() -> None:
    plan = plan_of(4, 5)
    steps = cut_steps(plan)
    assert steps.last == len(plan.paths)
    assert steps.seconds[0] == 0.0 and np.all(np.diff(steps.seconds) > 0.0)
    assert steps.seconds[-1] == pytest.approx(plan.seconds_estimate)
    assert steps.length_mm[-1] == pytest.approx(plan.cut_length_mm)
    assert steps.at(0.0) == 1 and steps.at(1e9) == steps.last


def test_that_a_step_shows_the_cuts_so_far_and_the_one_under_way(cutting: MainWindow, qtbot: QtBot) -> None:
    bar, view = cutting.cuts.bar, cutting.cuts.view
    whole = view.grab().toImage()
    assert bar.count.text() == f"{bar.slider.maximum()} / {bar.slider.maximum()}"
    bar.slider.setFocus()
    qtbot.keyClick(bar.slider, Qt.Key.Key_Home)
    assert view.step == 0 and bar.so_far.text() == "0 s  ·  0 mm"
    qtbot.keyClick(bar.slider, Qt.Key.Key_Right)
    first = view.grab().toImage()
    assert view.step == 1 and first != whole
    shown = {first.pixelColor(x, y).name() for x in range(first.width()) for y in range(first.height())}
    assert LIGHT.current_cut in shown
    qtbot.keyClick(bar.slider, Qt.Key.Key_End)
    assert view.grab().toImage() == whole


def test_that_space_plays_the_cutting_while_it_is_shown(cutting: MainWindow, qtbot: QtBot, until: Until) -> None:
    bar = cutting.cuts.bar
    qtbot.keyClick(cutting.cuts.view, Qt.Key.Key_Space)
    assert bar.playing and not cutting.stage.deployment.playing
    until(lambda: 0 < bar.slider.value() < bar.slider.maximum())
    qtbot.keyClick(cutting, Qt.Key.Key_C)
    assert not bar.playing


def test_that_travel_is_drawn_when_asked_for(cutting: MainWindow, qtbot: QtBot) -> None:
    page = cutting.cuts
    without = page.view.grab().toImage()
    qtbot.mouseClick(page.toggles[CutOverlay.TRAVEL], LEFT)
    assert CutOverlay.TRAVEL in page.view.overlays
    assert page.view.grab().toImage() != without


def test_that_a_problem_in_the_list_leads_to_its_place_and_back(
    cutting: MainWindow, qtbot: QtBot, until: Until
) -> None:
    page = cutting.cuts
    assert not page.problems.isVisible()
    cutting.services.fabrication.change(connector_mm=0.03)
    until(lambda: page.problems.isVisible())
    assert page.problems.item(0).text().startswith("Warning: ")
    before = page.view.transform()
    page.problems.setCurrentRow(0)
    transform = page.view.transform()
    planned = check_plan(page.view._drawing.plan)  # type: ignore[union-attr]
    assert before is not None and transform is not None and transform.scale > 3.0 * before.scale
    place = transform.to_pixels(np.array(planned.problems[0].where))
    assert place == pytest.approx([page.view.scene_box().center().x(), page.view.scene_box().center().y()], abs=1.0)
    page.problems.setCurrentRow(-1)
    page.view.fit()
    spot = page.view.transform().to_pixels(np.array(planned.problems[0].where))  # type: ignore[union-attr]
    qtbot.mouseClick(page.view, LEFT, pos=QPointF(*spot.tolist()).toPoint())
    assert page.problems.currentRow() == 0


def test_that_a_refused_plan_leaves_the_last_picture_and_says_so(cutting: MainWindow, until: Until) -> None:
    view = cutting.cuts.view
    before = view.grab().toImage()
    cutting.fabrication.lengths["connector_mm"].setValue(19.0)
    until(lambda: not cutting.fabrication.export.isEnabled())
    assert view.scene_bounds() is not None and view.grab().toImage() != before
    cutting.commands["undo"].trigger()
    until(cutting.fabrication.export.isEnabled)
    assert view.grab().toImage() == before


def test_that_a_parted_outline_still_bounds_one_sheet() -> None:
    plan = plan_of(3, 3)
    outline = plan.on_layer(Layer.OUTLINE)[0]
    ring = np.concatenate([outline.points, outline.points[:1]])
    pieces = [replace(outline, points=part.copy(), closed=False) for part in (ring[:3], ring[2:][::-1])]
    parted = replace(plan, paths=(*plan.paths[:-1], *pieces))
    box = CutDrawing(parted).sheet.boundingRect()
    assert (box.width(), box.height()) == pytest.approx(plan.size_mm, abs=0.1)


@pytest.mark.parametrize(("width", "bent"), [(700, True), (24, False)])
def test_that_an_arc_is_drawn_bent_where_it_can_be_seen(qtbot: QtBot, width: int, bent: bool) -> None:
    plan = plan_of(3, 3, kerf_mm=0.0, connector_mm=1.0)
    arc = CutPath(np.array([[8.0, 15.0], [9.0, 15.0]]), Layer.SLITS, False, 0, np.array([1.0, 0.0]))
    alone = replace(plan, paths=(arc, plan.paths[-1]))
    drawing, view = CutDrawing(alone), show(qtbot, alone, (width, width))
    assert drawing.largest_arc == pytest.approx(0.5)
    transform = view.transform()
    assert transform is not None and (drawing.largest_arc * transform.scale >= SEEN) is bent
    view.set_overlays(frozenset())
    if bent:
        assert burnt(view.grab().toImage(), view, (8.5, 14.5), (1.0, 0.0)) >= 1
        assert drawing.chords[0].boundingRect().height() == 0.0


def test_that_the_scale_bar_has_a_round_length() -> None:
    assert [round_length(x) for x in (0.9, 1.0, 4.9, 5.0, 37.0, 120.0)] == [0.5, 1.0, 2.0, 5.0, 20.0, 100.0]


def test_that_every_step_of_a_large_job_is_drawn(qtbot: QtBot) -> None:
    plan = plan_of(24, 24)
    view = show(qtbot, plan, (800, 700))
    view.set_overlays(frozenset(CutOverlay))
    painted: list[int] = []
    paints = PaintCounter(view)
    for step in range(0, len(plan.paths), len(plan.paths) // 40):
        before = paints.count
        view.show_step(step)
        view.repaint()
        painted.append(paints.count - before)
    assert len(painted) >= 40 and set(painted) == {1}


def test_that_the_wheel_and_zero_work_as_in_the_layout(cutting: MainWindow, qtbot: QtBot) -> None:
    view = cutting.cuts.view
    before = view.transform()
    view.zoom(3.0, QPointF(QPoint(50, 60)))
    assert view.transform() != before
    qtbot.keyClick(cutting, Qt.Key.Key_0)
    assert view.transform() == before
