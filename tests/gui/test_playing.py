"""The slider's way and marks, and how the deployment is played."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QSettings, Qt
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.stage.deployment_bar import SPEEDS, DeploymentBar, PlayMode, phase_of, phi_at
from kirigami_studio.gui.stage.phi_slider import MarkKind, PhiSlider, TrackPart, track_parts
from kirigami_studio.gui.window.main_window import MainWindow

LEFT = Qt.MouseButton.LeftButton
Until = Callable[[Callable[[], bool]], None]


@pytest.fixture
def bar(qtbot: QtBot) -> DeploymentBar:
    made = DeploymentBar()
    qtbot.addWidget(made)
    made.resize(700, 60)
    made.set_ready(True)
    made.set_marks(0.6, 1.3)
    with qtbot.waitExposed(made):
        made.show()
    return made


def place_of(slider: PhiSlider, phi: float) -> int:
    return round(14 + (slider.width() - 28) * (1 - phi / math.pi))


def test_that_the_way_is_free_then_in_contact_then_past_the_target() -> None:
    assert track_parts(0.0, None) == ((TrackPart.FREE, math.pi, 0.0),)
    assert [kind for kind, _, _ in track_parts(0.6, None)] == [TrackPart.FREE, TrackPart.PAST]
    parts = track_parts(0.6, 1.3)
    assert [kind for kind, _, _ in parts] == [TrackPart.FREE, TrackPart.CONTACT, TrackPart.PAST]
    assert [first for _, first, _ in parts] == [math.pi, 1.3, 0.6] and parts[-1][2] == 0.0


def test_that_the_three_stretches_differ_in_brightness_and_in_shape(bar: DeploymentBar) -> None:
    bar.set_phi(math.pi)
    slider = bar.slider
    picture = slider.grab().toImage()
    columns = {}
    for kind, first, last in track_parts(0.6, 1.3):
        x = place_of(slider, 0.5 * (first + last))
        columns[kind] = [
            [picture.pixelColor(x + step, y).lightness() for y in range(8, 23)] for step in range(8)
        ]  # fmt: skip
    heights = {kind: np.ptp(np.array(rows), axis=1) for kind, rows in columns.items()}
    along = {kind: np.ptp(np.array(rows)[:, 7]) for kind, rows in columns.items()}
    assert along[TrackPart.FREE] < 10  # plain
    assert along[TrackPart.CONTACT] > 60 and along[TrackPart.PAST] > 60  # stripes, dashes
    assert min(heights[TrackPart.FREE]) > 10
    thick = [
        sum(abs(np.array(columns[kind][0]) - columns[kind][0][0]) > 20) for kind in (TrackPart.CONTACT, TrackPart.PAST)
    ]
    assert thick[0] > thick[1] + 3


def test_that_a_click_on_a_mark_goes_to_its_exact_angle(bar: DeploymentBar, qtbot: QtBot) -> None:
    slider = bar.slider
    for kind, phi in ((MarkKind.CONTACT, 1.3), (MarkKind.TARGET, 0.6), (MarkKind.FLAT, math.pi), (MarkKind.TURNED, 0)):
        place = QPoint(min(max(place_of(slider, phi), 4), slider.width() - 4), 34)
        found = slider.mark_at(place.toPointF())
        assert found is not None and found.kind is kind
        qtbot.mouseClick(slider, LEFT, pos=place)
        assert slider.phi == phi
        assert not slider.isSliderDown()
    assert "stripes" in slider.toolTip() and "First contact at 74.5°" in slider.toolTip()


def test_that_labels_never_overlap(bar: DeploymentBar) -> None:
    for target, contact in ((0.0, None), (0.0, 0.05), (1.0, 1.1), (3.0, 3.1), (0.2, 0.25)):
        for width in (110, 240, 700):
            bar.slider.set_marks(target, contact)
            bar.slider.resize(width, 44)
            boxes = [box for _, box, text in bar.slider._placed_marks() if text]
            assert len(boxes) >= 2
            assert not any(a.intersects(b) for i, a in enumerate(boxes) for b in boxes[i + 1 :])


@pytest.mark.parametrize("jam", [0.05, 0.2, 0.35, 1.0])
def test_that_a_jam_near_the_target_hides_neither(bar: DeploymentBar, jam: float) -> None:
    for width in (240, 320, 700):
        bar.slider.set_marks(0.0, None)
        bar.slider.set_jam(jam)
        bar.slider.resize(width, 44)
        told = {mark.kind: text for mark, _, text in bar.slider._placed_marks()}
        assert told[MarkKind.JAM] and told[MarkKind.TARGET], width
        boxes = [box for _, box, text in bar.slider._placed_marks() if text]
        assert not any(a.intersects(b) for i, a in enumerate(boxes) for b in boxes[i + 1 :])
    bar.slider.set_jam(None)


@pytest.mark.parametrize("mode", list(PlayMode))
@pytest.mark.parametrize("last", [0.0, 1.2])
def test_that_every_mode_opens_from_flat_to_the_last_angle(mode: PlayMode, last: float) -> None:
    angles = [phi_at(phase, mode, last) for phase in np.linspace(0, 0.999, 200)]
    assert max(angles) == math.pi and min(angles) == pytest.approx(last)
    assert (angles[-1] > 3.0) == (mode is PlayMode.SWING)
    for phi in (1.3, 2.0, 3.0):
        assert phi_at(phase_of(phi, mode, last), mode, last) == pytest.approx(phi)


def test_that_playing_once_stops_open_and_begins_anew(bar: DeploymentBar, until: Until) -> None:
    bar.options.modes[PlayMode.ONCE].setChecked(True)
    bar.options.speeds[4.0].setChecked(True)
    bar.options.to_target.setChecked(True)
    bar.set_phi(0.7)
    bar.play.setChecked(True)
    until(lambda: not bar.playing)
    assert bar.slider.phi == 0.6 and not bar.play.isChecked()
    bar.play.setChecked(True)
    until(lambda: bar.slider.phi > 2.0)
    bar.play.setChecked(False)
    assert not bar.playing


def test_that_a_loop_begins_again_at_the_flat_sheet(bar: DeploymentBar, until: Until) -> None:
    bar.options.modes[PlayMode.LOOP].setChecked(True)
    bar.options.speeds[4.0].setChecked(True)
    bar.set_phi(0.2)
    seen: list[float] = []
    bar.phi_changed.connect(seen.append)
    bar.play.setChecked(True)
    until(lambda: bool(seen) and seen[-1] > 2.5)
    assert bar.playing and min(seen) < 0.2
    bar.play.setChecked(False)


def test_that_keys_change_mode_and_speed_and_the_choice_is_remembered(
    designed: MainWindow, qtbot: QtBot, tmp_path: Path
) -> None:
    options = designed.stage.deployment.options
    for _ in range(9):
        qtbot.keyClick(designed, Qt.Key.Key_Greater)
    assert options.speed == SPEEDS[-1] and options.text().startswith("4")
    qtbot.keyClick(designed, Qt.Key.Key_P, Qt.KeyboardModifier.ShiftModifier)
    assert options.mode is PlayMode.LOOP and options.toolTip().startswith("Loop at")
    state = QSettings(str(tmp_path / "state.ini"), QSettings.Format.IniFormat)
    designed.remember(state)
    for _ in range(9):
        qtbot.keyClick(designed, Qt.Key.Key_Less)
    assert options.speed == SPEEDS[0]
    options.next_mode()
    designed.stage.restore(state)
    assert options.speed == SPEEDS[-1] and options.mode is PlayMode.LOOP
