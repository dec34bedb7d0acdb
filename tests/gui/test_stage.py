"""The layout view: scrub, play, overlays, zoom."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from paint_counter import PaintCounter
from PySide6.QtCore import QPoint, QPointF, QRectF, Qt
from PySide6.QtGui import QPainter, QPainterPath, QPixmap, QWheelEvent
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.session.overlays import Overlay
from kirigami_studio.gui.stage.deployment_bar import phase_of, phi_at
from kirigami_studio.gui.stage.layout_labels import paint_dimension
from kirigami_studio.gui.widgets.theme import DARK, LIGHT
from kirigami_studio.gui.window.main_window import MainWindow

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton


def test_that_the_slider_the_number_and_the_view_show_one_angle(designed: MainWindow, qtbot: QtBot) -> None:
    bar, view = designed.stage.deployment, designed.stage.view
    qtbot.mousePress(bar.slider, LEFT, pos=QPoint(bar.slider.width() // 2, 15))
    qtbot.mouseRelease(bar.slider, LEFT, pos=QPoint(bar.slider.width() // 2, 15))
    assert math.degrees(view.phi) == pytest.approx(90.0, abs=1.0)
    assert bar.number.value() == pytest.approx(math.degrees(view.phi), abs=0.051)
    qtbot.keyClick(bar.slider, Qt.Key.Key_Right)
    assert math.degrees(view.phi) == pytest.approx(bar.number.value(), abs=0.051)
    bar.number.setValue(45.0)
    assert math.degrees(view.phi) == pytest.approx(45.0, abs=0.051)
    designed.commands["to_flat"].trigger()
    assert view.phi == math.pi
    designed.commands["to_target"].trigger()
    assert view.phi == 0.0


def test_that_a_storm_of_slider_moves_is_painted_once(designed: MainWindow) -> None:
    view, slider = designed.stage.view, designed.stage.deployment.slider
    QApplication.processEvents()
    paints = PaintCounter(view)
    for value in range(0, 1800, 10):
        slider.setValue(value)
    QApplication.processEvents()
    assert 1 <= paints.count <= 3


def test_that_the_picture_changes_with_the_angle(designed: MainWindow) -> None:
    view = designed.stage.view
    pictures = []
    for phi in (math.pi, 1.5, 0.0):
        designed.stage.deployment.set_phi(phi)
        pictures.append(view.grab().toImage())
    assert pictures[0] != pictures[1] != pictures[2] != pictures[0]


def test_that_space_plays_and_pauses(designed: MainWindow, qtbot: QtBot, until: Until) -> None:
    bar = designed.stage.deployment
    designed.stage.view.setFocus()
    start = bar.slider.value()
    qtbot.keyClick(designed.stage.view, Qt.Key.Key_Space)
    assert bar.playing
    until(lambda: bar.slider.value() != start)
    qtbot.keyClick(designed.stage.view, Qt.Key.Key_Space)
    assert not bar.playing


def test_that_space_still_presses_the_focused_button(designed: MainWindow, qtbot: QtBot) -> None:
    designed.resize(1440, 900)  # in a narrow stage the button gives way
    button = designed.stage.toggles[Overlay.TARGET]
    button.setFocus()
    qtbot.keyClick(button, Qt.Key.Key_Space)
    assert not button.isChecked() and not designed.stage.deployment.playing


def test_that_playing_swings_between_flat_and_turned() -> None:
    angles = [phi_at(phase) for phase in np.linspace(0, 1, 101)]
    assert max(angles) == math.pi and min(angles) == 0.0
    assert angles[0] == angles[100] == math.pi and angles[50] == 0.0
    for phi in (0.3, 1.0, 3.0):
        assert phi_at(phase_of(phi)) == pytest.approx(phi)


def test_that_overlays_follow_buttons_menu_and_keys(designed: MainWindow, qtbot: QtBot) -> None:
    view, toggles = designed.stage.view, designed.stage.toggles
    whole = view.grab().toImage()
    assert view.areas is not None
    qtbot.keyClick(designed, Qt.Key.Key_M)
    assert Overlay.MISMATCH not in view.overlays and not toggles[Overlay.MISMATCH].isChecked()
    without = view.grab().toImage()
    assert without != whole and view.areas is None
    qtbot.mouseClick(toggles[Overlay.TARGET], LEFT)
    assert not designed.commands["show_target"].isChecked()
    assert view.grab().toImage() != without
    qtbot.keyClick(designed, Qt.Key.Key_M)
    qtbot.keyClick(designed, Qt.Key.Key_T)
    assert view.grab().toImage() == whole


def test_that_missing_and_extra_area_agree_with_the_exact_iou(designed: MainWindow) -> None:
    designed.stage.view.grab()
    areas = designed.stage.view.areas
    assert areas is not None and designed.session.stage is not None
    overlap = 1.0 - areas.missing_share
    expected = designed.session.stage.candidate.score.iou_exact
    assert overlap / (1.0 + areas.extra_share) == pytest.approx(expected, abs=1e-6)


def test_that_the_mismatch_is_not_drawn_far_from_the_target_angle(designed: MainWindow) -> None:
    designed.stage.deployment.set_phi(1.5)
    designed.stage.view.grab()
    assert designed.stage.view.areas is None


def test_that_the_wheel_zooms_about_the_pointer_and_zero_fits(designed: MainWindow, qtbot: QtBot) -> None:
    view = designed.stage.view
    place = QPointF(120, 150)
    before = view.transform()
    assert before is not None
    none = Qt.MouseButton.NoButton
    wheel = QWheelEvent(
        place, view.mapToGlobal(place), QPoint(), QPoint(0, 240), none, Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase, False,
    )  # fmt: skip
    QApplication.sendEvent(view, wheel)
    after = view.transform()
    assert after is not None and after.scale == pytest.approx(1.44 * before.scale)
    assert after.to_world(place) == pytest.approx(before.to_world(place))
    qtbot.keyClick(designed, Qt.Key.Key_0)
    assert view.transform() == before


def test_that_the_theme_changes_every_drawing(designed: MainWindow) -> None:
    light = designed.grab().toImage()
    designed.commands["theme"].trigger()
    assert designed.appearance.palette is DARK
    dark = designed.grab().toImage()
    for area in (designed.stage.view, designed.target.view, designed.gallery.view):
        place = area.mapTo(designed, area.rect().center())
        spot = place if area is not designed.stage.view else area.mapTo(designed, QPoint(12, 12))
        assert light.pixelColor(spot) != dark.pixelColor(spot)
    designed.commands["theme"].trigger()
    assert designed.appearance.palette is LIGHT


@pytest.mark.parametrize(("place", "is_near"), [((290.0, 150.0), True), ((200.0, 200.0), False)])
def test_that_a_length_is_written_off_the_shape_where_there_is_room_nearby(
    qtbot: QtBot, place: tuple[float, float], is_near: bool
) -> None:
    """Before, the label of the greatest distance lay over the drawing, or in a hole of it."""
    picture, shape, occupied = QPixmap(400, 400), QPainterPath(), list[QRectF]()
    shape.addRect(QRectF(100.0, 100.0, 200.0, 200.0))
    painter = QPainter(picture)
    ends = np.array([place, (place[0] + 8.0, place[1])])
    box = paint_dimension(painter, ends, "12.95 mm", LIGHT, occupied, shape)
    painter.end()
    assert box is not None and occupied == [box]
    assert shape.intersects(box) is not is_near
    assert math.dist((box.center().x(), box.center().y()), place) < 120.0
