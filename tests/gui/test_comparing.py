"""Designs side by side: picked, linked, swapped, used, left; their figures and how these differ."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.fabricate.panel_sizes import least_panel_share
from kirigami_studio.gui.gallery.compare_page import MOST, ComparedDesign
from kirigami_studio.gui.session.overlays import Overlay
from kirigami_studio.gui.widgets.readable import readable_feature
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.project import edits
from kirigami_studio.project.document import Document
from kirigami_studio.project.edits import Edit
from kirigami_studio.project.sheet_size import cut_for
from kirigami_studio.studio.making import CutRequest, planned

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton


def pair(window: MainWindow) -> tuple[Candidate, Candidate]:
    left, right = window.stage.compare.designs
    return left.entry.candidate, right.entry.candidate


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
    QApplication.processEvents()
    titles = [pane.title.drawn_text() for pane in page.shown]
    assert titles[0].endswith("A1, chosen") and titles[1] == "2   Design A3"
    assert designed.gallery.bar.compare.isChecked() and designed.commands["compare"].isChecked()
    assert before is None and not designed.session.history.unsaved


def test_that_the_numbers_below_are_those_of_the_designs_and_their_differences(
    designed: MainWindow, designs: Document, qtbot: QtBot
) -> None:
    compare(designed, qtbot, 1)
    one, other = pair(designed)
    page = designed.stage.compare
    width = designed.session.document.fabrication.width_mm
    sizes = [width * least_panel_share(deploy(each.sheet.field)) for each in (one, other)]
    for pane, mine, size in zip(page.shown, (one, other), sizes, strict=True):
        values = {name: label.text() for name, label in pane.figures.values.items()}
        assert values["match"] == f"{100 * mine.score.iou_exact:.1f} %"
        assert values["panels"] == f"±{100 * mine.score.evenness.area_cv:.0f} %"
        assert values["smallest"] == f"{size:.1f} mm" and values["roughness"] == f"{mine.score.tv:.2f}"
        assert values["gain"] == f"{100 * mine.score.siou_gain:+.1f}"
        assert (values["symmetric"], values["rim"]) == ("no", "even")
        assert (values["as_cut"] == "overlaps itself") == (not mine.score.feasible)
    first, second = (pane.figures.gaps for pane in page.shown)
    assert {label.text() for label in first.values()} == {""}
    assert second["match"].text() == f"{100 * (other.score.iou_exact - one.score.iou_exact):+.1f}"
    assert second["panels"].text() == f"{100 * (other.score.evenness.area_cv - one.score.evenness.area_cv):+.0f}"
    assert second["smallest"].text() == f"{sizes[1] - sizes[0]:+.2f}"
    assert second["roughness"].text() == f"{other.score.tv - one.score.tv:+.2f}"
    designed.services.fabrication.change(width_mm=2 * width)
    assert page.shown[0].figures.values["smallest"].text() == f"{2 * sizes[0]:.1f} mm"


def test_that_strain_jam_and_cut_time_stand_below_and_follow_the_material(
    designed: MainWindow, qtbot: QtBot, until: Until
) -> None:
    services, page = designed.services, designed.stage.compare
    compare(designed, qtbot, 1)

    def known() -> bool:
        rows = [pane.figures.values[name].text() for pane in page.shown for name in ("as_cut", "strain", "time")]
        return "\N{EN DASH}" not in rows and not services.session.queue.busy

    until(known)
    found, estimated = page.designs[0].as_cut, page.designs[1].as_cut
    simulated = services.as_cut.state.sheet
    assert simulated is not None and found == simulated.as_cut
    assert estimated == services.estimates.known[page.designs[1].entry.candidate]
    rows = [pane.figures.values["strain"].text() for pane in page.shown]
    assert rows[0] == f"{100 * found.strain:.0f} %" and rows[1] == f"\N{ALMOST EQUAL TO} {100 * estimated.strain:.0f} %"
    assert page.shown[1].figures.gaps["strain"].text() == "", "a simulation and an estimate are not subtracted"
    for design in page.designs:
        made = planned(
            CutRequest.of(edits.choose(services.session.document, place(services.session.document, design)).document)
        )
        assert design.seconds == pytest.approx(made.plan.times.total)
    seconds = [design.seconds or 0.0 for design in page.designs]
    gap = seconds[1] - seconds[0]
    assert page.shown[1].figures.gaps["time"].text() in (f"{gap:+.0f}", "=")
    before = [design.seconds for design in page.designs]
    services.fabrication.change(material="card-co2")
    assert {pane.figures.values["time"].text() for pane in page.shown} == {"\N{EN DASH}"}
    until(known)
    assert [design.seconds for design in page.designs] != before


def place(document: Document, design: ComparedDesign) -> int:
    return document.candidates.index(design.entry.candidate)


@pytest.mark.parametrize(("width", "height"), [(1000, 640), (1440, 900), (2560, 1440)])
def test_that_labels_stand_beside_their_figures(designed: MainWindow, width: int, height: int, qtbot: QtBot) -> None:
    designed.resize(width, height)
    compare(designed, qtbot, 1)
    QApplication.processEvents()
    for pane in designed.stage.compare.shown:
        figures = pane.figures
        for name, caption in figures.captions.items():
            value = figures.values[name]
            assert caption.isVisible() and caption.drawn_text() == caption.text()
            end = caption.x() + caption.fontMetrics().horizontalAdvance(caption.text())
            start = value.x() + value.width() - value.fontMetrics().horizontalAdvance(value.text())
            assert 0 <= start - end <= 160 and caption.y() == value.y()
            assert figures.gaps[name].isVisible() is (width > 1000)
    gap, tip = (label["match"] for label in (figures.gaps, figures.values))
    assert gap.text() and gap.text() in tip.toolTip(), "what has no room can be pointed at"


def test_that_zoom_and_place_of_one_view_are_those_of_the_other(designed: MainWindow, qtbot: QtBot) -> None:
    compare(designed, qtbot, 1)
    left, right = (pane.view for pane in designed.stage.compare.shown)
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
    left, right = (pane.view for pane in page.shown)
    assert left.phi == right.phi == pytest.approx(1.0, abs=2e-3)
    page.bar.slider.setFocus()
    qtbot.keyClick(page.bar.slider, Qt.Key.Key_Home)
    assert left.phi == right.phi == pytest.approx(math.pi)
    assert designed.stage.deployment.slider.phi == pytest.approx(math.pi)
    qtbot.keyClick(designed, Qt.Key.Key_Space)
    until(lambda: right.phi < 3.0)
    assert page.bar.playing and not designed.stage.deployment.playing
    assert left.phi == right.phi
    qtbot.keyClick(designed, Qt.Key.Key_K)
    assert not page.bar.playing and not designed.stage.comparing
    assert designed.stage.view.phi == left.phi


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
    assert designed.cuts.isVisible() and not designed.stage.comparing and not designed.gallery.bar.compare.isChecked()
    qtbot.mouseClick(designed.gallery.bar.compare, LEFT)
    assert designed.stage.comparing and not designed.cuts.isVisible() and designed.gallery.isVisible()
    qtbot.mouseClick(designed.stage.compare.leave, LEFT)
    assert designed.stage.view.isVisible() and not designed.commands["compare"].isChecked()


def test_that_overlays_belong_to_both(designed: MainWindow, qtbot: QtBot) -> None:
    compare(designed, qtbot, 1)
    qtbot.mouseClick(designed.stage.toggles[Overlay.TARGET], LEFT)
    for side in designed.stage.compare.shown:
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
    player = designed.pages.player
    player.play.setChecked(True)
    assert player is not designed.stage.deployment and player.play.isChecked()
    designed.stage.view.setFocus()  # what plays need not have the keyboard
    # the fixture closes the window and looks for timers


def test_that_a_narrow_side_names_its_design_in_fewer_words(designed: MainWindow) -> None:
    designed.commands["compare"].trigger()
    QApplication.processEvents()
    side = designed.stage.compare.shown[0]
    for room, said in (
        (400, "1   Design A1, chosen"),
        ("1   Design A1, chose", "1   A1, chosen"),
        ("1   A1, c", "1   A1"),
    ):
        width = room if isinstance(room, int) else side.title.fontMetrics().horizontalAdvance(room)
        side.title.resize(width, side.title.height())
        assert side.title.drawn_text() == said


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
    for pane, one in zip(page.shown, page.designs, strict=True):
        width = widths[document.candidates.index(one.entry.candidate)]
        assert pane.view.mm_per_unit == pytest.approx(one.entry.design.mm_per_world(width))
        smallest = width * least_panel_share(one.entry.design.deployment)
        assert pane.figures.values["smallest"].text() == readable_feature(smallest)


# three and more -------------------------------------------------------------------------------------------------------


@pytest.fixture
def marked(designed: MainWindow) -> MainWindow:
    """All three designs marked in the table and compared."""
    designed.presenters.all_designs.show(True)
    table = designed.presenters.all_designs.page
    assert table is not None
    table.filters.grouped.setChecked(False)
    qtbot_key(table.table, Qt.Key.Key_A, Qt.KeyboardModifier.ControlModifier)
    assert len(table.table.compared) == 3
    qtbot_key(table.table, Qt.Key.Key_C)
    return designed


def qtbot_key(widget: QWidget, key: Qt.Key, modifiers: Qt.KeyboardModifier = Qt.KeyboardModifier.NoModifier) -> None:
    QTest.keyClick(widget, key, modifiers)
    QApplication.processEvents()


def test_that_three_designs_take_the_place_of_the_other_columns_at_one_angle(
    marked: MainWindow, designs: Document
) -> None:
    page = marked.stage.compare
    assert marked.stage.comparing and page.hasFocus() and not marked.presenters.all_designs.shown
    assert not marked.gallery.isVisible() and not marked.target.isVisible()
    assert tuple(one.entry.candidate for one in page.designs) == designs.candidates
    assert all(pane.isVisible() for pane in page.shown) and not page.swap.isVisible()
    widths = [pane.view.width() for pane in page.shown]
    assert max(widths) - min(widths) <= 1 and len({pane.view.height() for pane in page.shown}) == 1
    page.bar.set_phi(1.0)
    assert [pane.view.phi for pane in page.shown] == pytest.approx([1.0] * 3, abs=1e-3)
    scales = [transform.scale for pane in page.shown if (transform := pane.view.transform()) is not None]
    assert scales == pytest.approx([scales[0]] * 3, rel=0.01)
    assert [pane.figures.gaps["match"].text() == "" for pane in page.shown] == [True, False, False]
    qtbot_key(marked, Qt.Key.Key_Space)
    assert page.bar.playing
    page.bar.play.setChecked(False)


def test_that_a_number_uses_a_design_and_shows_it_alone(marked: MainWindow) -> None:
    qtbot_key(marked.stage.compare, Qt.Key.Key_3)
    assert marked.session.document.chosen == 2 and not marked.stage.comparing
    assert marked.gallery.isVisible() and marked.target.isVisible() and not marked.presenters.all_designs.shown
    qtbot_key(marked, Qt.Key.Key_K)
    assert pair(marked)[0] == marked.session.document.candidates[2], "the next comparison is one with the chosen"


def test_that_a_button_uses_a_design(marked: MainWindow, qtbot: QtBot) -> None:
    qtbot.mouseClick(marked.stage.compare.shown[1].use, LEFT)
    assert marked.session.document.chosen == 1 and not marked.stage.comparing


@pytest.mark.parametrize("key", [Qt.Key.Key_Escape, Qt.Key.Key_K])
def test_that_leaving_leads_back_to_the_table(marked: MainWindow, key: Qt.Key) -> None:
    qtbot_key(marked.stage.compare, key)
    table = marked.presenters.all_designs
    assert table.shown and table.page is not None and table.page.table.hasFocus() and not marked.stage.comparing
    qtbot_key(table.page.table, Qt.Key.Key_Escape)
    assert marked.gallery.isVisible() and marked.target.isVisible() and marked.pages.isVisible()


def test_that_the_columns_come_back_as_they_were(designed: MainWindow, designs: Document) -> None:
    designed.pages.splitter.setSizes([300, 700, 400])
    designed.pages._keep_sizes()  # as the user has left them
    before = designed.pages.splitter.sizes()
    designed.presenters.comparison.compare(designs.candidates)
    QApplication.processEvents()
    assert designed.pages.splitter.sizes()[0] == designed.pages.splitter.sizes()[2] == 0
    designed.target.set_editing(True)
    assert designed.target.isVisible() and not designed.stage.comparing
    designed.target.set_editing(False)
    QApplication.processEvents()
    assert designed.pages.splitter.sizes() == before


def test_that_three_designs_lose_one_that_is_gone(marked: MainWindow, designs: Document) -> None:
    document = marked.session.document
    fewer = replace(document, candidates=document.candidates[:2], marks=(), labels=document.labels[:2])
    marked.session.apply(Edit("Lose one", fewer))
    assert pair(marked) == designs.candidates[:2] and marked.gallery.isVisible()


@pytest.mark.parametrize("width", [1000, 1440])
def test_that_nine_designs_are_in_rows_that_are_scrolled(
    marked: MainWindow, width: int, designs: Document, until: Until
) -> None:
    until(lambda: not marked.session.queue.busy)
    marked.resize(width, 640)
    page, known = marked.stage.compare, marked.stage.compare.designs
    page.show_designs(known * 4, designs.target)
    QApplication.processEvents()
    assert len(page.shown) == MOST == 9
    viewport = page.panes_area.viewport()
    for pane in page.shown:
        right = pane.mapTo(viewport, pane.rect().bottomRight()).x()
        assert right <= viewport.width() and pane.view.height() >= 140
    assert page.panes_area.verticalScrollBar().maximum() > 0
