"""The drawing board and the panel tell one size of the target: that of the opened shape as it will be cut."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.project.sheet_size import size_of

Until = Callable[[Callable[[], bool]], None]
LOGO = """<svg xmlns="http://www.w3.org/2000/svg" width="160mm" height="100mm" viewBox="0 0 160 100">
<path d="M0 0H160V100H60V40H0Z"/></svg>"""


def told(window: MainWindow) -> list[tuple[float, float]]:
    """Width and height by the panel, by the board's fields and by what lies on the board, mm."""
    placed = window.target.view.context.placed
    assert placed is not None
    width, height = np.ptp(placed.ring, axis=0).tolist()
    row, board = window.target.opened, window.target.refine
    fields = [(field.width_.value(), field.height_.value()) for field in (row, board)]
    return [*fields, (width, height)]


def assert_one_size(window: MainWindow) -> tuple[float, float]:
    """Check that all of them agree with the sheet, and return it."""
    size = size_of(window.session.document)
    assert size is not None
    for one in told(window):
        assert one == pytest.approx(size.opened, abs=0.051)
    return size.opened


def test_that_a_shape_of_the_library_lies_on_the_board_as_large_as_it_opens(heart: MainWindow) -> None:
    heart.services.fabrication.change(opened_mm=150.0)
    heart.services.targeting.open("star")
    assert max(assert_one_size(heart)) == pytest.approx(150.0)


def test_that_the_board_follows_a_flat_width_that_is_typed_and_the_chosen_design(designed: MainWindow) -> None:
    services, sizes = designed.services, set()
    for width, chosen in ((60.0, 0), (240.0, 0), (240.0, 2)):
        services.fabrication.change(width_mm=width)
        services.chosen.choose(services.session.document.candidates[chosen])
        sizes.add(round(max(assert_one_size(designed)), 2))
    assert len(sizes) == 3


def test_that_moving_a_shape_leaves_its_size_and_its_designs(designed: MainWindow) -> None:
    designed.services.fabrication.change(width_mm=240.0)
    before = assert_one_size(designed)
    designed.target.set_tool(Tool.POSE)
    designed.target.tools.options.pose.x_.setValue(12.0)
    assert designed.session.document.fabrication.width_mm == 240.0 and designed.session.document.candidates
    assert assert_one_size(designed) == pytest.approx(before)


def test_that_a_size_typed_on_the_board_is_that_of_the_opened_shape(designed: MainWindow) -> None:
    designed.services.fabrication.change(width_mm=240.0)
    designed.target.set_tool(Tool.POSE)
    designed.target.refine.width_.setValue(80.0)
    assert assert_one_size(designed)[0] == pytest.approx(80.0)
    assert designed.session.document.fabrication.opened_mm == pytest.approx(max(assert_one_size(designed)))


def test_that_several_objects_keep_their_places_to_one_another(heart: MainWindow, qtbot: QtBot) -> None:
    context = heart.target.view.context
    heart.target.set_tool(Tool.POSE)
    context.arrange("duplicate")
    assert len(context.drawing.objects) == 2
    assert_one_size(heart)

    def apart() -> float:
        one, other = (np.array(each.centre) for each in context.drawing.objects)
        return float(np.linalg.norm(one - other)) / context.drawing.objects[0].size[0]

    before = apart()
    heart.services.fabrication.change(width_mm=55.0)
    assert_one_size(heart)
    assert apart() == pytest.approx(before)


def test_that_a_picture_at_another_threshold_is_as_large_as_it_opens(
    window: MainWindow, photo: Path, until: Until
) -> None:
    window.services.fabrication.change(opened_mm=130.0)
    window.services.targeting.open(str(photo))
    until(lambda: window.target.threshold.isVisible())
    assert max(assert_one_size(window)) == pytest.approx(130.0)
    before = window.session.document.target
    window.target.threshold.slider.setValue(160)
    until(lambda: window.session.document.target != before and not window.session.queue.busy)
    assert max(assert_one_size(window)) == pytest.approx(130.0)
    under, placed = window.target.view.underlay, window.target.view.context.placed
    picture = window.services.targeting.tracer.picture_of(window.session.document.target)
    assert under is not None and placed is not None and picture is not None and picture.traced is not None
    assert under.place(picture.traced).scale == pytest.approx(placed.scale)  # the picture lies under its contour


def test_that_a_contour_that_grows_on_a_picture_on_the_open_board_makes_the_sheet_grow(
    window: MainWindow, photo: Path, until: Until
) -> None:
    window.services.fabrication.change(opened_mm=130.0)
    window.services.targeting.open(str(photo))
    until(lambda: window.target.threshold.isVisible())
    window.target.set_editing(True)
    under, found = window.target.view.underlay, window.session.document.target
    window.target.threshold.slider.setValue(100)  # the disc without its ear
    until(lambda: window.session.document.target != found and not window.session.queue.busy)
    before, small = window.session.document.target, max(assert_one_size(window))
    window.target.threshold.slider.setValue(160)
    until(lambda: window.session.document.target != before and not window.session.queue.busy)
    assert window.target.view.underlay is under and max(assert_one_size(window)) > small + 1.0
    window.commands["undo"].trigger()
    assert window.target.view.underlay is under and max(assert_one_size(window)) == pytest.approx(small)


def test_that_a_drawing_in_mm_given_at_the_start_is_as_large_as_drawn(
    window: MainWindow, tmp_path: Path, until: Until
) -> None:
    logo = tmp_path / "logo.svg"
    logo.write_text(LOGO, encoding="utf-8")
    window.services.preferences.use(tmp_path / "preferences.toml")
    window.services.targeting.start_with(str(logo))
    until(lambda: window.session.document.target is not None)
    assert assert_one_size(window) == pytest.approx((160.0, 100.0))
