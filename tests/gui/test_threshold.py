"""A target from a picture follows its threshold; other targets have none."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.target.sketch_context import Change
from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.outlines.placed import Placed
from kirigami_studio.outlines.read_image import automatic_threshold, read_image
from kirigami_studio.studio.targets import reading_target
from tests.gui.test_replacing import answer

Until = Callable[[Callable[[], bool]], None]


@pytest.fixture
def traced(window: MainWindow, photo: Path, until: Until) -> MainWindow:
    window.services.targeting.open(str(photo))
    until(lambda: window.target.threshold.isVisible())
    return window


def test_that_a_picture_starts_at_its_automatic_threshold(traced: MainWindow, photo: Path) -> None:
    shown = traced.target.threshold
    assert shown.slider.value() == round(200 * automatic_threshold(photo))
    assert not shown.automatic.isEnabled()
    assert traced.session.document.target == read_image(photo)


def test_that_a_library_silhouette_has_no_threshold(heart: MainWindow) -> None:
    assert not heart.target.threshold.isVisible()


def test_that_the_contour_follows_and_one_drag_undoes_at_once(
    traced: MainWindow, photo: Path, until: Until, qtbot: QtBot
) -> None:
    bar, session = traced.target.threshold, traced.session
    before = session.document.target
    bar.slider.setSliderDown(True)
    for value in range(100, 161):
        bar.slider.setValue(value)
    bar.slider.setSliderDown(False)
    until(lambda: session.document.target == read_image(photo, 0.8))
    until(lambda: not session.queue.busy)
    assert bar.slider.value() == 160 and bar.number.text() == "80.0 %"
    assert session.history.undo_label == "Change threshold"
    qtbot.keyClick(traced, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert session.document.target == before
    assert bar.slider.value() == round(200 * automatic_threshold(photo))


def test_that_each_key_press_is_a_step_of_its_own(traced: MainWindow, photo: Path, until: Until) -> None:
    bar, services = traced.target.threshold, traced.services
    for value in (150, 160):
        bar.slider.setValue(value)
        until(lambda value=value: services.session.document.target == read_image(photo, value / 200))  # type: ignore[misc]
        until(lambda: not services.session.queue.busy)
    services.project.undo()
    assert services.session.document.target == read_image(photo, 0.75)


def test_that_auto_brings_the_found_threshold_back(traced: MainWindow, photo: Path, until: Until, qtbot: QtBot) -> None:
    bar, session = traced.target.threshold, traced.session
    bar.slider.setValue(160)
    until(lambda: bar.automatic.isEnabled() and not session.queue.busy)
    qtbot.mouseClick(bar.automatic, Qt.MouseButton.LeftButton)
    until(lambda: session.document.target == read_image(photo))
    assert not bar.automatic.isEnabled()


def test_that_a_threshold_without_shape_keeps_the_target_and_says_so(traced: MainWindow, until: Until) -> None:
    before = traced.session.document.target
    traced.target.threshold.slider.setValue(1)
    until(lambda: "one colour" in traced.status_text.text())
    assert traced.session.document.target is before
    assert not traced.messages.messages


def test_that_a_new_target_ends_the_tracing_of_the_old_one(traced: MainWindow, until: Until) -> None:
    for value in (120, 140, 160):
        traced.target.threshold.slider.setValue(value)
    traced.services.targeting.open("heart")
    until(lambda: traced.session.document.target is not None and traced.session.document.target.name == "heart")
    until(lambda: not traced.session.queue.busy)
    assert traced.session.document.target is not None and traced.session.document.target.name == "heart"
    assert not traced.target.threshold.isVisible()


def test_that_a_drawing_wins_over_a_file_that_is_still_being_read(
    window: MainWindow, photo: Path, until: Until
) -> None:
    window.services.targeting.open(str(photo))
    corners = np.array([[0.0, 0.0], [3.0, 0.0], [1.0, 2.0]])
    window.presenters.target.reshaping.take(Change("Draw polygon", lambda: Placed.from_ring(corners, "polygon")))
    until(lambda: not window.session.queue.busy)
    assert window.session.document.target is not None and window.session.document.target.name == "polygon"


def test_that_the_contour_lies_on_the_picture_and_the_picture_lies_still(
    traced: MainWindow, photo: Path, until: Until
) -> None:
    view, session = traced.target.view, traced.session
    under = view.underlay
    assert under is not None and under.path == photo and under.size == (120, 100)
    traced.target.set_editing(True)
    QApplication.processEvents()

    def box() -> list[float]:
        """The contour's box in pixels of the picture, y up."""
        assert view.context.placed is not None
        ring = (view.context.placed.ring - under.corner) / under.pixel
        return [*ring.min(axis=0).tolist(), *ring.max(axis=0).tolist()]

    # Pillow's ellipses hold both ends: x 40..100 are the pixels from 40.0 to 101.0; rows are counted from the top.
    assert box() == pytest.approx([10, 100 - 81, 101, 100 - 20], abs=1)
    before = view.transform()
    traced.target.threshold.slider.setValue(100)
    until(lambda: session.document.target == read_image(photo, 0.5))
    assert view.underlay is under and view.transform() == before
    # On the left the lighter ear begins, into which the smoothed edge is drawn.
    assert box()[1:] == pytest.approx([100 - 81, 101, 100 - 20], abs=0.6) and box()[0] == pytest.approx(40, abs=2)


def test_that_the_picture_stays_while_it_is_drawn_over_and_goes_with_another_target(
    traced: MainWindow, until: Until
) -> None:
    traced.target.set_editing(True)
    traced.target.refine.sliders["smooth"].setValue(30)
    assert traced.target.view.underlay is not None and not traced.target.threshold.isVisible()
    shown = traced.target.view.grab().toImage()
    traced.services.targeting.open("heart")
    until(lambda: bool(traced.messages.messages))  # it was smoothed by hand: the window asks
    answer(traced, "Replace", until)
    until(lambda: traced.session.document.target is not None and traced.session.document.target.name == "heart")
    assert traced.target.view.underlay is None and traced.target.view.grab().toImage() != shown


def test_that_a_picture_goes_along_when_its_contour_is_moved_and_enlarged(
    traced: MainWindow, until: Until, qtbot: QtBot
) -> None:
    view = traced.target.view
    traced.target.set_tool(Tool.POSE)
    assert view.underlay is not None and view.context.placed is not None
    corner, start, pixel = view.underlay.corner, view.context.placed.centre, view.underlay.pixel
    qtbot.keyClick(view, Qt.Key.Key_Up, Qt.KeyboardModifier.ShiftModifier)
    assert view.context.placed.centre == pytest.approx((start[0], start[1] + 10))
    assert view.underlay.corner == pytest.approx((corner[0], corner[1] + 10))
    width, height = view.context.placed.size
    traced.target.refine.width_.setValue(50.0)
    assert view.underlay.pixel == pytest.approx(pixel * 50.0 / width)
    before = traced.session.document.target
    traced.target.threshold.slider.setValue(140)
    until(lambda: traced.session.document.target is not before)
    # The new contour of the picture lies where the picture lies now.
    assert view.context.placed.scale == pytest.approx(
        view.underlay.pixel * traced.services.targeting.tracer.picture_of(view.outline).traced.scale  # type: ignore
    )
    for _ in range(3):
        traced.commands["undo"].trigger()
    assert view.underlay.corner == pytest.approx(corner) and view.context.placed.size == pytest.approx((width, height))


def test_that_the_worker_reduces_a_large_photo_for_drawing(tmp_path: Path) -> None:
    path = tmp_path / "large.png"
    grey = np.full((1200, 2400), 230, dtype=np.uint8)
    grey[300:900, 600:1800] = 20
    Image.fromarray(grey).save(path)
    (found,) = reading_target(str(path), lambda: False)
    picture = found.picture
    assert picture is not None and picture.seen is not None
    assert picture.seen.shape == (800, 1600, 4)
    assert picture.traced is not None and picture.traced.picture == (2400, 1200)
    assert picture == replace(picture, seen=None), "what is drawn does not make it another picture"
