"""Two designs side by side: picked, linked, swapped, left."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.fabricate.panel_sizes import least_panel_share
from kirigami_studio.gui.session.overlays import Overlay
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.project.document import Document
from kirigami_studio.project.sheet_size import cut_for

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton


def pair(window: MainWindow) -> tuple[Candidate, Candidate]:
    left, right = window.stage.compare.entries
    assert left is not None and right is not None
    return left.candidate, right.candidate


def compare(window: MainWindow, qtbot: QtBot, row: int) -> None:
    view = window.gallery.view
    place = view.visualRect(view.model_.index(row, 0)).center() - QPoint(0, 30)
    qtbot.mouseClick(view.viewport(), LEFT, Qt.KeyboardModifier.ControlModifier, place)


def test_that_ctrl_click_compares_a_card_with_the_chosen_design(
    designed: MainWindow, designs: Document, qtbot: QtBot
) -> None:
    compare(designed, qtbot, 2)
    assert designed.stage.comparing and designed.session.document.chosen == 0
    assert pair(designed) == (designs.candidates[0], designs.candidates[2])
    page, before = designed.stage.compare, designed.session.history.undo_label
    assert page.left.title.text().endswith("A1, chosen") and page.right.title.text() == "Design A3"
    assert designed.gallery.bar.compare.isChecked() and designed.commands["compare"].isChecked()
    assert before is None and not designed.session.history.unsaved


def test_that_the_numbers_below_are_those_of_the_designs_and_their_differences(
    designed: MainWindow, designs: Document, qtbot: QtBot
) -> None:
    compare(designed, qtbot, 1)
    one, other = pair(designed)
    page = designed.stage.compare
    width = designed.session.document.fabrication.width_mm
    for side, mine, theirs in ((page.left, one, other), (page.right, other, one)):
        sizes = [width * least_panel_share(deploy(each.sheet.field)) for each in (mine, theirs)]
        values = [label.text() for label in side.values]
        assert values[:5] == [
            f"{100 * mine.score.iou_exact:.1f} %", f"±{100 * mine.score.evenness.area_cv:.0f} %",
            f"{sizes[0]:.2f} mm", f"{100 * mine.score.siou_gain:+.1f}", f"{mine.score.tv:.2f}",
        ]  # fmt: skip
        assert values[5:] == ["no", "even", "yes" if mine.score.feasible else "no"]
        assert side.gaps[0].text() == f"{100 * (mine.score.iou_exact - theirs.score.iou_exact):+.1f}"
        apart = 100 * (mine.score.evenness.area_cv - theirs.score.evenness.area_cv)
        assert side.gaps[1].text() == f"{apart:+.0f}"
        assert side.gaps[2].text() == f"{sizes[0] - sizes[1]:+.2f}"
        assert side.gaps[4].text() == f"{mine.score.tv - theirs.score.tv:+.2f}"
    designed.services.fabrication.change(width_mm=2 * width)
    assert page.left.values[2].text() == f"{2 * width * least_panel_share(deploy(one.sheet.field)):.2f} mm"


def test_that_zoom_and_place_of_one_view_are_those_of_the_other(designed: MainWindow, qtbot: QtBot) -> None:
    compare(designed, qtbot, 1)
    left, right = (side.view for side in designed.stage.compare.sides)
    QApplication.processEvents()
    assert left.size() == right.size() and left.transform() == right.transform()
    place = QPointF(40.0, 60.0)
    still, none = Qt.MouseButton.NoButton, Qt.KeyboardModifier.NoModifier
    wheel = QWheelEvent(
        place, right.mapToGlobal(place), QPoint(), QPoint(0, 240), still, none, Qt.ScrollPhase.NoScrollPhase, False
    )
    before = left.transform()
    QApplication.sendEvent(right, wheel)
    assert left.transform() == right.transform() != before
    before = left.transform()
    qtbot.mousePress(left, LEFT, pos=QPoint(50, 50))
    qtbot.mouseMove(left, QPoint(75, 42))
    qtbot.mouseRelease(left, LEFT, pos=QPoint(75, 42))
    assert left.transform() == right.transform() != before
    qtbot.keyClick(designed, Qt.Key.Key_0)
    assert left.transform() == right.transform()


def test_that_one_slider_moves_both_and_playing_goes_on(designed: MainWindow, qtbot: QtBot, until: Until) -> None:
    designed.stage.deployment.set_phi(1.0)
    compare(designed, qtbot, 1)
    page = designed.stage.compare
    assert page.left.view.phi == page.right.view.phi == pytest.approx(1.0, abs=2e-3)
    page.bar.slider.setFocus()
    qtbot.keyClick(page.bar.slider, Qt.Key.Key_Home)
    assert page.left.view.phi == page.right.view.phi == pytest.approx(math.pi)
    assert designed.stage.deployment.slider.phi == pytest.approx(math.pi)
    qtbot.keyClick(designed, Qt.Key.Key_Space)
    until(lambda: page.right.view.phi < 3.0)
    assert page.bar.playing and not designed.stage.deployment.playing
    assert page.left.view.phi == page.right.view.phi
    qtbot.keyClick(designed, Qt.Key.Key_K)
    assert not page.bar.playing and not designed.stage.comparing
    assert designed.stage.view.phi == page.left.view.phi


def test_that_swapping_chooses_the_other_design_and_undo_swaps_back(
    designed: MainWindow, designs: Document, qtbot: QtBot
) -> None:
    one, other, third = designs.candidates
    compare(designed, qtbot, 1)
    qtbot.mouseClick(designed.stage.compare.swap, LEFT)
    assert pair(designed) == (other, one) and designed.session.document.chosen == 1
    qtbot.keyClick(designed, Qt.Key.Key_K, Qt.KeyboardModifier.ShiftModifier)
    assert pair(designed) == (one, other)
    designed.commands["undo"].trigger()
    assert pair(designed) == (other, one)
    designed.services.chosen.choose(third)
    assert pair(designed) == (third, one)


def test_that_the_key_compares_with_the_next_card_and_leaves_again(
    designed: MainWindow, designs: Document, qtbot: QtBot
) -> None:
    qtbot.keyClick(designed, Qt.Key.Key_K)
    assert pair(designed) == designs.candidates[:2] and designed.stage.compare.isVisible()
    qtbot.keyClick(designed, Qt.Key.Key_C)
    assert designed.stage.showing_cuts and not designed.stage.comparing and not designed.gallery.bar.compare.isChecked()
    qtbot.mouseClick(designed.gallery.bar.compare, LEFT)
    assert designed.stage.comparing and not designed.stage.showing_cuts and not designed.stage.cuts_switch.isChecked()
    qtbot.mouseClick(designed.stage.compare.leave, LEFT)
    assert designed.stage.view.isVisible() and not designed.commands["compare"].isChecked()


def test_that_overlays_belong_to_both(designed: MainWindow, qtbot: QtBot) -> None:
    compare(designed, qtbot, 1)
    qtbot.mouseClick(designed.stage.toggles[Overlay.TARGET], LEFT)
    for side in designed.stage.compare.sides:
        assert Overlay.TARGET not in side.view.overlays and Overlay.MISMATCH in side.view.overlays


def test_that_the_comparison_ends_with_its_design(designed: MainWindow, qtbot: QtBot, until: Until) -> None:
    compare(designed, qtbot, 1)
    designed.services.project.new()
    until(lambda: not designed.stage.comparing)
    qtbot.keyClick(designed, Qt.Key.Key_K)
    assert not designed.stage.comparing and not designed.commands["compare"].isChecked()
    assert "needs two designs" in designed.messages.messages[-1].sentence


def test_that_the_chosen_card_is_not_compared_with_itself(designed: MainWindow, qtbot: QtBot) -> None:
    compare(designed, qtbot, 0)
    assert not designed.stage.comparing and "is the chosen design" in designed.messages.messages[-1].sentence


@pytest.mark.parametrize("page", ["compare", "cuts"])
def test_that_closing_ends_what_plays_on_every_page(page: str, designed: MainWindow) -> None:
    designed.commands[page].trigger()
    designed.stage.player.play.setChecked(True)
    assert designed.stage.player is not designed.stage.deployment and designed.stage.player.play.isChecked()
    # the fixture closes the window and looks for timers


def test_that_a_narrow_side_names_its_design_in_fewer_words(designed: MainWindow) -> None:
    designed.commands["compare"].trigger()
    QApplication.processEvents()
    side = designed.stage.compare.left
    side.resize(400, side.height())
    assert side.title.text() == "Design A1, chosen"
    side.resize(side.title.fontMetrics().horizontalAdvance("Design A1, chose") + 40, side.height())
    assert side.title.text() == "A1, chosen"
    side.resize(side.title.fontMetrics().horizontalAdvance("A1, chose") + 40, side.height())
    assert side.title.text() in ("Design A1", "")


def test_that_sizes_are_those_of_the_sheet_that_each_design_is_cut_from(
    designed: MainWindow, designs: Document, qtbot: QtBot, until: Until
) -> None:
    """Before, both drawings had lengths of a sheet 100 mm wide, and "Smallest" was that of the chosen one."""
    designed.services.fabrication.set_opened_size(230.0)
    document = designed.session.document
    widths = [cut_for(document, candidate).width_mm for candidate in document.candidates]
    assert len({round(width, 3) for width in widths}) == 3 and 100.0 not in widths
    compare(designed, qtbot, 2)
    page = designed.stage.compare
    for side, candidate, entry in zip((page.left, page.right), pair(designed), page.entries, strict=True):
        assert entry is not None
        width = widths[document.candidates.index(candidate)]
        assert side.view.mm_per_unit == pytest.approx(entry.design.mm_per_world(width))
        assert side.values[2].text() == f"{width * least_panel_share(entry.design.deployment):.2f} mm"
    designed.presenters.all_designs.show(True)
    table = designed.presenters.all_designs.page
    assert table is not None
    for candidate in document.candidates[:2]:
        table.table.toggle_compared(candidate)
    table.show_comparison(True)
    QApplication.processEvents()
    for side, candidate in zip(table.compare.sides, table.table.compared, strict=False):
        assert side.view.design is not None
        width = widths[document.candidates.index(candidate)]
        assert side.view.mm_per_unit == pytest.approx(side.view.design.mm_per_world(width))
