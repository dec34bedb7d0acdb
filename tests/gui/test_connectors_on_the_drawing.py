"""Single connectors: picked in the drawing or by rule, given a width, cut through, reset; each one undo step."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QColor, QImage, QPainter
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from kirigami_studio.fabricate.cut_plan import Layer
from kirigami_studio.fabricate.slits import SHEET_EDGE
from kirigami_studio.gui.make.cuts_page import CutsPage
from kirigami_studio.gui.make.hinge_bar import RULES
from kirigami_studio.gui.make.hinge_gestures import HingeDrag
from kirigami_studio.gui.stage.connector_items import Connectors, paint_connectors
from kirigami_studio.gui.widgets.theme import LIGHT
from kirigami_studio.gui.widgets.view_transform import ViewTransform
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.settings.fabrication import FabricationSettings
from tests.gui.test_cut_preview import plan_of

Until = Callable[[Callable[[], bool]], None]
LEFT, SHIFT = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.ShiftModifier


@pytest.fixture
def cutting(designed: MainWindow, qtbot: QtBot) -> MainWindow:
    designed.resize(1440, 900)
    designed.resize(1440, 900)
    designed.commands["cuts"].trigger()
    QApplication.processEvents()
    return designed


def place(page: CutsPage, hinge: int) -> QPoint:
    transform = page.view.transform()
    assert transform is not None and page._plan is not None
    return QPointF(*transform.to_pixels(page._plan.hinges.position[hinge]).tolist()).toPoint()


def lonely(page: CutsPage, count: int) -> list[int]:
    """Hinges with no other near them, so that a click can only mean them."""
    assert page._plan is not None
    at = page._plan.hinges.position
    away = np.linalg.norm(at[:, None] - at[None], axis=2) + 1e9 * np.eye(len(at))
    return np.argsort(-away.min(axis=1))[:count].tolist()


def fabrication(window: MainWindow) -> FabricationSettings:
    return window.session.document.fabrication


def test_that_clicks_select_one_connector_or_more(cutting: MainWindow, qtbot: QtBot) -> None:
    page = cutting.cuts
    first, second = lonely(page, 2)
    qtbot.mouseClick(page.view, LEFT, pos=place(page, first))
    assert page.view.selected == {first} and page.hinges.selection_text.text() == f"Connector {first}"
    qtbot.mouseClick(page.view, LEFT, SHIFT, place(page, second))
    assert page.view.selected == {first, second} and page.hinges.selection_text.text() == "2 connectors"
    qtbot.mouseClick(page.view, LEFT, SHIFT, place(page, first))
    assert page.view.selected == {second}
    qtbot.mouseClick(page.view, LEFT, pos=QPoint(3, 3))
    assert page.view.selected == frozenset() and not page.hinges.remove.isEnabled()


def test_that_a_band_selects_what_is_inside(cutting: MainWindow, qtbot: QtBot) -> None:
    page = cutting.cuts
    transform = page.view.transform()
    assert transform is not None and page._plan is not None
    low, high = np.array([12.0, 12.0]), np.array([61.0, 55.0])
    start, stop = (QPointF(*transform.to_pixels(corner).tolist()).toPoint() for corner in (low, high))
    qtbot.mousePress(page.view, LEFT, SHIFT, start)
    qtbot.mouseMove(page.view, stop)
    page.view.gestures.move(QPointF(stop))
    page.view.grab()
    qtbot.mouseRelease(page.view, LEFT, SHIFT, stop)
    inside = np.all((page._plan.hinges.position > low) & (page._plan.hinges.position < high), axis=1)
    assert page.view.selected == set(np.flatnonzero(inside).tolist()) and page.view.gestures.band is None
    assert page.view.transform() == transform


def test_that_a_drag_without_shift_moves_the_picture_and_keeps_the_selection(cutting: MainWindow, qtbot: QtBot) -> None:
    page = cutting.cuts
    page.view.gestures.select(frozenset({2}))
    before = page.view.transform()
    qtbot.mousePress(page.view, LEFT, pos=QPoint(4, 4))
    qtbot.mouseMove(page.view, QPoint(40, 30))
    qtbot.mouseRelease(page.view, LEFT, pos=QPoint(40, 30))
    assert page.view.selected == {2} and page.view.transform() != before


def test_that_a_typed_width_reaches_the_plan_and_undoes_in_one_step(
    cutting: MainWindow, qtbot: QtBot, until: Until
) -> None:
    page = cutting.cuts
    page.view.setFocus()
    page.view.gestures.select(frozenset({3, 7}))
    for letter in "0.3":
        qtbot.keyClicks(QApplication.focusWidget(), letter)
    assert QApplication.focusWidget() is page.hinges.width_mm
    qtbot.keyClick(page.hinges.width_mm, Qt.Key.Key_Return)
    assert fabrication(cutting).options.hinge_mm == ((3, 0.3), (7, 0.3))
    until(lambda: page._plan is not None and page._plan.options.hinge_mm != ())
    assert page._plan is not None
    assert page._plan.hinges.finished_mm[[3, 7]] == pytest.approx(0.3, abs=2e-3)
    assert page.view.selected == {3, 7}
    assert cutting.session.history.undo_label == "Set 2 connectors to 0.3 mm"
    cutting.commands["undo"].trigger()
    assert fabrication(cutting).options.hinge_mm == () and cutting.session.history.undo_label is None


def test_that_steps_of_the_number_are_one_undo_step(cutting: MainWindow) -> None:
    page = cutting.cuts
    page.view.gestures.select(frozenset({5}))
    for _ in range(4):
        page.hinges.width_mm.stepUp()
    assert fabrication(cutting).options.hinge_mm == ((5, 0.4),)
    cutting.commands["undo"].trigger()
    assert fabrication(cutting).options.hinge_mm == ()


def test_that_delete_cuts_through_and_reset_brings_the_usual_width_back(cutting: MainWindow, qtbot: QtBot) -> None:
    page = cutting.cuts
    cutting.services.fabrication.set_hinge_width(frozenset({4, 9}), 0.5)
    page.view.setFocus()
    page.view.gestures.select(frozenset({4}))
    qtbot.keyClick(page.view, Qt.Key.Key_Delete)
    options = fabrication(cutting).options
    assert options.removed == (4,) and options.hinge_mm == ((9, 0.5),)
    assert cutting.session.history.undo_label == "Cut through connector 4"
    cutting.services.fabrication.reset_hinges(frozenset({4, 9}))
    assert fabrication(cutting).options.removed == () and fabrication(cutting).options.hinge_mm == ()
    cutting.commands["undo"].trigger()
    assert fabrication(cutting).options.removed == (4,)


def test_that_delete_without_a_selection_changes_nothing(cutting: MainWindow, qtbot: QtBot) -> None:
    cutting.cuts.view.setFocus()
    qtbot.keyClick(cutting.cuts.view, Qt.Key.Key_Delete)
    assert cutting.session.history.undo_label is None


def test_that_zero_still_fits_while_nothing_is_selected(cutting: MainWindow, qtbot: QtBot) -> None:
    view = cutting.cuts.view
    view.setFocus()
    before = view.transform()
    view.zoom(2.0)
    qtbot.keyClick(view, Qt.Key.Key_0)
    assert view.transform() == before


def test_that_escape_forgets_the_selection_and_arrows_walk(cutting: MainWindow, qtbot: QtBot) -> None:
    view = cutting.cuts.view
    view.setFocus()
    qtbot.keyClick(view, Qt.Key.Key_Right)
    assert view.selected == {0}
    qtbot.keyClick(view, Qt.Key.Key_Right)
    qtbot.keyClick(view, Qt.Key.Key_Right)
    qtbot.keyClick(view, Qt.Key.Key_Left)
    assert view.selected == {1}
    qtbot.keyClick(view, Qt.Key.Key_Escape)
    assert view.selected == frozenset()


def test_that_rules_select_what_they_name(cutting: MainWindow) -> None:
    page = cutting.cuts
    plan = page._plan
    assert plan is not None
    found = {}
    for (name, _, _), action in zip(RULES, page.hinges.choices, strict=True):
        action.trigger()
        found[name.replace("&", "")] = page.view.selected
    assert found["All connectors"] == set(range(len(plan.hinges)))
    opening = {path.cut for path in plan.on_layer(Layer.EDGE_SLITS)}
    assert found["Edge connectors"] == {
        hinge
        for hinge in range(len(plan.hinges))
        if plan.hinges.through[hinge] == SHEET_EDGE or int(plan.hinges.cut[hinge]) in opening
    }
    lengths = {path.cut: path.length for path in plan.paths}
    short, long = ([lengths[int(plan.hinges.cut[h])] for h in found[f"On {word} cuts"]] for word in ("short", "long"))
    assert max(short) < min(long) and min(len(short), len(long)) >= len(plan.hinges) // 5


def test_that_hovering_tells_number_and_widths(cutting: MainWindow) -> None:
    page = cutting.cuts
    hinge = lonely(page, 1)[0]
    told = page.view._hover(QPointF(place(page, hinge)))
    assert told == f"Connector {hinge}: 0.200 mm requested, 0.200 mm finished"


def test_that_hidden_connectors_take_no_clicks(cutting: MainWindow, qtbot: QtBot) -> None:
    page = cutting.cuts
    hinge = lonely(page, 1)[0]
    page.toggles[list(page.toggles)[1]].setChecked(False)
    qtbot.mouseClick(page.view, LEFT, pos=place(page, hinge))
    assert page.view.selected == frozenset()


def drag(page: CutsPage, qtbot: QtBot, start: QPoint, way: QPoint, steps: int = 5) -> None:
    qtbot.mousePress(page.view, LEFT, pos=start)
    for step in range(1, steps + 1):
        qtbot.mouseMove(page.view, start + way * step / steps)
        page.view.gestures.move(QPointF(start + way * step / steps))
    page.view.grab()


def test_that_a_drag_makes_connectors_wider_and_is_one_undo_step(cutting: MainWindow, qtbot: QtBot) -> None:
    page = cutting.cuts
    first, second = lonely(page, 2)
    usual = float(page._plan.hinges.requested_mm[first])  # type: ignore[union-attr]
    qtbot.mouseClick(page.view, LEFT, pos=place(page, first))
    qtbot.mouseClick(page.view, LEFT, SHIFT, place(page, second))
    drag(page, qtbot, place(page, first), QPoint(70, 0))
    assert page.view.gestures.dragged_mm == pytest.approx(2 * usual, abs=0.01)
    qtbot.mouseRelease(page.view, LEFT, pos=place(page, first) + QPoint(70, 0))
    widths = dict(fabrication(cutting).options.hinge_mm)
    assert widths.keys() == {first, second} and widths[second] == pytest.approx(2 * usual, abs=0.01)
    assert page.view.gestures.dragged_mm is None and page.view.selected == {first, second}
    drag(page, qtbot, place(page, second), QPoint(0, 70))
    qtbot.mouseRelease(page.view, LEFT, pos=place(page, second) + QPoint(0, 70))
    assert dict(fabrication(cutting).options.hinge_mm)[first] == pytest.approx(usual, abs=0.011)
    cutting.commands["undo"].trigger()
    assert dict(fabrication(cutting).options.hinge_mm) == widths
    cutting.commands["undo"].trigger()
    assert fabrication(cutting).options.hinge_mm == ()


def test_that_a_click_on_one_of_many_selects_that_one(cutting: MainWindow, qtbot: QtBot) -> None:
    page = cutting.cuts
    first, second = lonely(page, 2)
    page.view.gestures.select(frozenset({first, second}))
    qtbot.mouseClick(page.view, LEFT, pos=place(page, second))
    assert page.view.selected == {second} and fabrication(cutting).options.hinge_mm == ()


def test_that_a_double_click_cuts_a_connector_through_and_brings_it_back(
    cutting: MainWindow, qtbot: QtBot, until: Until
) -> None:
    page = cutting.cuts
    (hinge,) = lonely(page, 1)
    transform = page.view.transform()
    for removed in ((hinge,), ()):
        qtbot.mouseDClick(page.view, LEFT, pos=place(page, hinge))
        assert fabrication(cutting).options.removed == removed
        until(lambda removed=removed: page._plan is not None and page._plan.options.removed == removed)  # type: ignore[misc]
    assert page.view.transform() == transform, (
        "a double click beside all connectors shows everything, one on them does not"
    )


@pytest.mark.parametrize(("fine", "way", "width"), [(False, 1e5, 20.0), (False, -1e5, 0.02), (True, 70.0, 0.429)])
def test_that_a_drag_stays_within_the_widths_that_there_are(fine: bool, way: float, width: float) -> None:
    held = HingeDrag(0, QPointF(0.0, 0.0), 0.4)
    assert held.width_at(QPointF(way, 0.0), fine) == pytest.approx(width, abs=1e-9)


def test_that_ctrl_a_selects_every_connector_while_they_are_shown(cutting: MainWindow, qtbot: QtBot) -> None:
    page = cutting.cuts
    every = frozenset(range(len(page._plan.hinges))) if page._plan is not None else frozenset()
    page.view.setFocus()
    qtbot.keyClick(page.view, Qt.Key.Key_A, Qt.KeyboardModifier.ControlModifier)
    assert every and page.view.selected == every


def test_that_a_connector_that_is_cut_through_is_called_so(cutting: MainWindow, qtbot: QtBot, until: Until) -> None:
    page = cutting.cuts
    first, second = lonely(page, 2)
    page.view.gestures.select(frozenset({first}))
    qtbot.keyClick(page.view, Qt.Key.Key_Delete)
    until(lambda: page.hinges.selection_text.text() == f"Connector {first}: cut through")
    assert not page.hinges.remove.isEnabled() and page.hinges.reset.isEnabled()
    page.view.gestures.select(frozenset({first, second}))
    assert page.hinges.selection_text.text() == "1 of 2 cut through" and page.hinges.remove.isEnabled()
    cutting.commands["undo"].trigger()
    until(lambda: page.hinges.selection_text.text() == "2 connectors")


@pytest.mark.parametrize("size", [(260, 260), (700, 700), (1600, 1200)])
@pytest.mark.parametrize("cells", [3, 8, 20])
def test_that_a_dot_is_no_wider_than_a_third_of_nine_panels_in_ten(cells: int, size: tuple[int, int]) -> None:
    plan = plan_of(cells, cells)
    connectors, transform = Connectors(plan), ViewTransform(size[1] / plan.size_mm[1], (0.0, size[1]))
    sides = [np.linalg.norm(panel - np.roll(panel, 1, axis=0), axis=1).min() for panel in plan.panels]
    width = 2.0 * connectors.radius(transform)
    too_small = [side for side in sides if transform.scale * side < 3.0 * width - 1e-9]
    assert 2.4 <= width <= 8.0
    assert width == pytest.approx(2.4) or len(too_small) <= 0.1 * len(sides)


def test_that_dots_are_drawn_as_wide_as_they_are_said_to_be() -> None:
    plan = plan_of(4, 4)
    connectors, transform = Connectors(plan), ViewTransform(1.0, (20.0, plan.size_mm[1] + 20.0))
    picture = QImage(round(plan.size_mm[0]) + 40, round(plan.size_mm[1]) + 40, QImage.Format.Format_RGB32)
    picture.fill(QColor("white"))
    painter = QPainter(picture)
    paint_connectors(painter, connectors, transform, LIGHT, frozenset())
    painter.end()
    x, y = np.rint(transform.to_pixels(plan.hinges.position)[0]).astype(int).tolist()
    inked = sum(picture.pixelColor(x + step, y).lightness() < 200 for step in range(-15, 16))
    assert abs(inked - 2.0 * connectors.radius(transform)) <= 1.5
