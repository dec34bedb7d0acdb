"""The table of all designs: three states on every card, badges, keys, filters shared with the gallery, comparison."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QImage, QRegion
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.fabricate.material import Material, default_material
from kirigami_studio.gui.gallery import cards as card_list
from kirigami_studio.gui.gallery import design_table
from kirigami_studio.gui.gallery.all_designs import AllDesigns
from kirigami_studio.gui.gallery.cards import CardButton
from kirigami_studio.gui.gallery.gallery_model import NAME_ROLE, VERDICT_ROLE
from kirigami_studio.gui.gallery.gallery_selection import SortOrder
from kirigami_studio.gui.stage.layout_items import states_pixmap
from kirigami_studio.gui.widgets.theme import LIGHT
from kirigami_studio.gui.widgets.verdict_marks import ICONS, badges_of
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.project.document import Document, Mark
from kirigami_studio.studio.as_cut import AsCut, Outcome, Source, StrainFigure
from kirigami_studio.studio.verdict import Level, expected

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton
KEY = Qt.Key


@pytest.fixture
def table(designed: MainWindow) -> AllDesigns:
    """The three designs on the table, opened by its key."""
    QTest.keyClick(designed.stage.view, KEY.Key_A)
    page = designed.presenters.all_designs.page
    assert page is not None and page.isVisible() and not designed.pages.splitter.isVisible()
    page.filters.grouped.setChecked(False)
    return page


def press(page: AllDesigns, *keys: KEY) -> None:
    for key in keys:
        QTest.keyClick(QApplication.focusWidget() or page.table, key)
        QApplication.processEvents()


def names(page: AllDesigns) -> list[str]:
    model = page.table.model_
    return [model.index(row, 0).data(NAME_ROLE) for row in range(model.rowCount())]


def test_that_the_table_opens_at_the_chosen_design_and_closes_again(designed: MainWindow, table: AllDesigns) -> None:
    assert table.table.hasFocus() and table.table.current == designed.session.document.candidate
    press(table, KEY.Key_Escape)
    assert not designed.presenters.all_designs.shown and designed.pages.splitter.isVisible()
    QTest.mouseClick(designed.gallery.bar.all, LEFT)
    assert designed.presenters.all_designs.shown
    QTest.mouseClick(table.close_button, LEFT)
    assert designed.pages.splitter.isVisible() and designed.stage.view.hasFocus()


def test_that_arrows_move_and_enter_takes_the_design_to_the_stage(
    designed: MainWindow, table: AllDesigns, designs: Document
) -> None:
    press(table, KEY.Key_Right)
    assert table.table.current == designs.candidates[1] and designed.session.document.chosen == 0
    assert designed.session.history.undo_label is None, "looking at designs is no change"
    press(table, KEY.Key_Return)
    assert designed.session.document.chosen == 1 and not designed.presenters.all_designs.shown
    assert designed.stage.title.text() == "Design A2"


def test_that_a_double_click_takes_a_design_and_a_click_does_not(
    designed: MainWindow, table: AllDesigns, qtbot: QtBot
) -> None:
    view = table.table
    place = view.visualRect(view.model_.index(2, 0)).center()
    qtbot.mouseClick(view.viewport(), LEFT, pos=place)
    assert designed.session.document.chosen == 0 and view.current == designed.session.document.candidates[2]
    qtbot.mouseDClick(view.viewport(), LEFT, pos=place)
    assert designed.session.document.chosen == 2 and not designed.presenters.all_designs.shown


def test_that_letters_of_the_window_do_nothing_out_of_sight(designed: MainWindow, table: AllDesigns) -> None:
    overlays, page = designed.stage.view.overlays, designed.pages.page
    for key in (KEY.Key_T, KEY.Key_M, KEY.Key_E, KEY.Key_D, KEY.Key_J, KEY.Key_B):
        QTest.keyClick(table.table, key)
    assert designed.stage.view.overlays == overlays and designed.pages.page is page
    assert designed.presenters.all_designs.shown and not designed.target.editing


def test_that_a_design_is_pinned_rejected_and_renamed_by_keys(designed: MainWindow, table: AllDesigns) -> None:
    press(table, KEY.Key_I)
    assert designed.session.document.marks[0] is Mark.PINNED
    press(table, KEY.Key_Right, KEY.Key_Delete)
    assert designed.session.document.marks[1] is Mark.REJECTED and names(table) == ["A1", "A3"]
    QTest.keyClick(table.table, KEY.Key_F2)
    editor = designed.dialogs.label
    assert editor is not None and editor.isVisible()
    assert editor.name.text() == table.table.model_.name_of(table.table.current)
    editor.name.setText("The one")
    QTest.keyClick(editor.name, KEY.Key_Return)
    assert "The one" in names(table)


def test_that_buttons_of_a_card_pin_and_reject_it(designed: MainWindow, table: AllDesigns, qtbot: QtBot) -> None:
    view = table.table
    boxes = view.cards.button_boxes(view.visualRect(view.model_.index(1, 0)))
    qtbot.mouseClick(view.viewport(), LEFT, pos=boxes[CardButton.PIN].center())
    qtbot.mouseClick(view.viewport(), LEFT, pos=boxes[CardButton.REJECT].center())
    assert designed.session.document.marks[1] is Mark.REJECTED and designed.session.history.position == 2


def test_that_filters_and_order_are_those_of_the_gallery(designed: MainWindow, table: AllDesigns) -> None:
    matches = sorted(one.score.iou_exact for one in designed.session.document.candidates)
    table.filters.least.setValue(100 * matches[1] - 0.05)
    assert len(names(table)) == 2 and designed.gallery.bar.filters.least.value() == table.filters.least.value()
    assert table.show_all.isVisible() and table.count.text().startswith("2 of 3 shown")
    designed.gallery.bar.filters.pinned.setChecked(True)
    assert table.filters.pinned.isChecked() and names(table) == []
    assert table.table.hint().startswith("No design matches the filter")
    QTest.mouseClick(table.show_all, LEFT)
    assert len(names(table)) == 3 and not table.show_all.isVisible() and not table.filters.pinned.isChecked()
    row = table.order.findData(SortOrder.MATCH)
    table.order.setCurrentIndex(row)
    table.order.activated.emit(row)
    shown = [entry.candidate.score.iou_exact for entry in designed.gallery.view.model_.entries]
    assert shown == sorted(shown, reverse=True) and designed.gallery.bar.order.currentIndex() == row


def test_that_designs_are_filtered_by_least_feature_and_by_what_can_be_cut(
    designed: MainWindow, table: AllDesigns, until: Until
) -> None:
    document = designed.session.document
    sizes = [one.score.evenness.least_feature_mm(document.fabrication.width_mm) for one in document.candidates]
    least = round(float(np.mean(sorted(sizes)[1:])), 2)
    table.filters.feature.setValue(least)
    assert names(table) == [f"A{number + 1}" for number, size in enumerate(sizes) if size >= least]
    assert 0 < len(names(table)) < 3
    designed.fabrication.lengths["width_mm"].setValue(10 * document.fabrication.width_mm)
    assert len(names(table)) == 3, "larger sheets have larger features"
    table.filters.feature.setValue(0.0)
    table.filters.works.setChecked(True)
    model = table.table.model_
    works = [one for one in document.candidates if model.verdict_of(one).level is not Level.FAILS]
    assert len(names(table)) == len(works) > 0
    designed.services.fabrication.change(material="acrylic-co2", width_mm=20.0)
    until(lambda: not designed.services.estimates.busy)
    assert names(table) == [], "acrylic breaks"


def test_that_every_card_shows_flat_half_open_and_open(table: AllDesigns, until: Until) -> None:
    cards = table.table.cards
    until(lambda: len(cards._pictures) == 3 and not cards.pending)
    picture = next(iter(cards._pictures.values())).toImage()
    third = picture.width() // 3
    for place in range(3):
        assert coloured(picture, place * third, (place + 1) * third) > 0.05 * third * picture.height()
    orange = QColor(LIGHT.target)
    assert near(picture, orange, 2 * third, picture.width()) > 20 and near(picture, orange, 0, 2 * third) == 0


def coloured(picture: QImage, left: int, right: int) -> int:
    """Pixels that are drawn between two columns."""
    rows, columns = range(picture.height()), range(left, right)
    return sum(picture.pixelColor(column, row).alpha() > 128 for row in rows for column in columns)


def near(picture: QImage, colour: QColor, left: int, right: int) -> int:
    """Pixels of about a colour between two columns."""
    found = 0
    for row in range(picture.height()):
        for column in range(left, right):
            here = picture.pixelColor(column, row)
            apart = (
                abs(here.red() - colour.red()) + abs(here.green() - colour.green()) + abs(here.blue() - colour.blue())
            )
            found += here.alpha() > 200 and apart < 60
    return found


def test_that_the_smallest_feature_is_ringed_where_it_is_too_thin(designs: Document, qtbot: QtBot) -> None:
    view = QWidget()
    qtbot.addWidget(view)
    candidate, target = designs.candidates[0], designs.target
    design = PosedDesign(deploy(candidate.final_sheet), candidate.final_pose, candidate.final_phi)
    size = design_table.TableCards(view).size_for(430)
    pictures = [
        states_pixmap(design, target, size, 1.0, LIGHT, as_cut=True, ringed=ringed).toImage()
        for ringed in (False, True)
    ]
    yellow, third = QColor(LIGHT.fault), size.width() // 3
    assert near(pictures[0], yellow, 0, third) == 0 and near(pictures[1], yellow, 0, third) > 10
    assert near(pictures[1], yellow, third, size.width()) == 0


def test_that_pictures_wait_for_their_turn(designed: MainWindow, until: Until, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[int] = []
    turns: list[None] = []
    draw = design_table.states_pixmap

    def counted(*arguments: object, **options: object) -> object:
        drawn.append(len(turns))
        return draw(*arguments, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(card_list, "PAINT_SECONDS", 0.0)
    monkeypatch.setattr(design_table, "states_pixmap", counted)
    designed.gallery.bar.filters.grouped.setChecked(False)
    designed.presenters.all_designs.show(True)
    page = designed.presenters.all_designs.page
    assert page is not None
    begin = page.table.cards.begin

    def begun(region: QRegion) -> None:
        turns.append(None)
        begin(region)

    monkeypatch.setattr(page.table.cards, "begin", begun)
    until(lambda: len(drawn) == 3 and not page.table.cards.pending)
    assert len(set(drawn)) == 3, "one in each painting"


def test_that_designs_are_marked_and_a_number_gives_a_place(table: AllDesigns, designs: Document) -> None:
    view, (first, second, third) = table.table, designs.candidates
    press(table, KEY.Key_Space, KEY.Key_Right, KEY.Key_Space)
    assert view.compared == (first, second) and table.comparison.text() == "Compare 2"
    press(table, KEY.Key_Right, KEY.Key_1)
    assert view.compared == (third, second), "it takes the place of the one there"
    press(table, KEY.Key_1)
    assert view.compared == (second,), "the same key takes it out"
    press(table, KEY.Key_4)
    assert view.compared == (second, third), "places are filled from the first one on"
    press(table, KEY.Key_1, KEY.Key_1)
    QTest.keyClick(view, KEY.Key_A, Qt.KeyboardModifier.ControlModifier)
    assert view.compared == designs.candidates, "as many as can be compared"


def test_that_marked_designs_are_compared_at_one_angle_and_one_is_taken(
    designed: MainWindow, table: AllDesigns, designs: Document
) -> None:
    press(table, KEY.Key_1, KEY.Key_Right, KEY.Key_2, KEY.Key_Right, KEY.Key_3, KEY.Key_C)
    page = designed.stage.compare
    assert designed.stage.comparing and page.isVisible() and page.hasFocus() and len(page.shown) == 3
    assert [pane.view.design.deployment.sheet for pane in page.shown if pane.view.design is not None] == [
        one.final_sheet for one in designs.candidates
    ]
    press(table, KEY.Key_4)
    assert designed.stage.comparing, "there is no fourth one"
    press(table, KEY.Key_3)
    assert designed.session.document.chosen == 2 and not designed.presenters.all_designs.shown
    designed.presenters.all_designs.show(True)
    assert not designed.stage.comparing and table.table.compared == designs.candidates, "the marks stay"


def test_that_comparing_without_marks_takes_the_current_design_and_the_next(
    designed: MainWindow, table: AllDesigns, designs: Document
) -> None:
    press(table, KEY.Key_C)
    assert designed.stage.comparing and table.table.compared == designs.candidates[:2]
    press(table, KEY.Key_Escape)
    assert not designed.stage.comparing and designed.presenters.all_designs.shown and table.table.hasFocus()


def test_that_designs_that_are_gone_are_no_longer_compared(designed: MainWindow, table: AllDesigns) -> None:
    press(table, KEY.Key_1, KEY.Key_Right, KEY.Key_2, KEY.Key_C)
    designed.services.targeting.clear()
    assert table.table.compared == () and not designed.stage.comparing and table.table.current is None
    assert not table.use.isEnabled()


def test_that_the_drawing_board_and_the_stage_come_before_the_table(designed: MainWindow, table: AllDesigns) -> None:
    designed.commands["edit_target"].trigger()
    assert designed.target.editing and not designed.presenters.all_designs.shown
    designed.presenters.all_designs.show(True)
    assert designed.presenters.all_designs.shown and not designed.target.editing
    designed.commands["compare"].trigger()
    assert designed.stage.comparing and not designed.presenters.all_designs.shown


def test_that_the_nearness_is_one_control_in_two_places(designed: MainWindow, table: AllDesigns) -> None:
    bar = designed.gallery.bar
    table.nearness.setValue(10)
    assert bar.nearness.value() == 10 and bar.nearness_value == pytest.approx(0.9 - 0.8 * 0.1)
    bar.nearness.setValue(90)
    assert table.nearness.value() == 90


def test_that_cards_become_larger_and_smaller_by_keys(table: AllDesigns) -> None:
    before = table.table.cards.card
    press(table, KEY.Key_Plus)
    assert table.table.cards.card.width() >= before.width() and table.card_size.value() == 2
    press(table, KEY.Key_Minus, KEY.Key_Minus)
    assert table.card_size.value() == 0 and table.table.cards.card.width() < before.width()


def texts(candidate: Candidate, ranking: Ranking, as_cut: AsCut | None, material: Material | None = None) -> list[str]:
    return [badge.text for badge in badges_of(expected(candidate, ranking, as_cut, material))]


def test_that_badges_say_the_verdict_and_what_keeps_it_from_being_better(designs: Document) -> None:
    candidate = designs.candidates[0]
    candidate = replace(candidate, score=replace(candidate.score, iou_exact=0.95))
    wide, narrow = Ranking(width_mm=100.0), Ranking(width_mm=100.0, least_feature_mm=50.0)
    closing = AsCut(0.0, 0.0, Outcome.CLOSES, 0.1, 0.2, StrainFigure.IN_PLANE, source=Source.ESTIMATE)
    jamming = replace(closing, jam_phi=0.6, outcome=Outcome.STRETCHED)
    tough = default_material()
    breaking = replace(closing, strain_limit=0.1)
    fits, about = "fits the material", "\N{ALMOST EQUAL TO} "
    assert texts(candidate, wide, None) == ["Not checked yet", "matches", fits]
    assert texts(candidate, wide, closing, tough) == [f"{about}Ready to cut", "matches", fits, f"{about}closes"]
    misfit = [f"{about}Will not work", "does not fit the material", "matches", f"{about}closes"]
    assert texts(candidate, wide, breaking, tough) == misfit
    jammed = replace(jamming, strain_limit=0.1)
    found = badges_of(expected(candidate, narrow, jammed, tough))
    assert [badge.text for badge in found][:3] == [misfit[0], misfit[1], f"{about}jams at 34°"]
    assert [badge.state for badge in found] == ["will_not_work", "bad", "bad", "good"]
    assert "50.00 mm" in found[1].tip and [badge.is_level for badge in found] == [True, False, False, False]
    overlapping = replace(candidate, score=replace(candidate.score, feasible=False))
    assert texts(overlapping, wide, closing)[:2] == [f"{about}Will not work", f"{about}overlaps itself"]
    rough = replace(candidate, score=replace(candidate.score, iou_exact=0.85))
    # How well a design matches is an answer of its own; it is no reason not to cut it.
    assert texts(rough, wide, closing)[:2] == [f"{about}Ready to cut", "matches roughly"]


def test_that_no_badge_of_a_sheet_that_will_not_work_has_a_check_mark(designs: Document) -> None:
    verdict = expected(designs.candidates[0], Ranking(width_mm=100.0, least_feature_mm=50.0))
    jammed = AsCut(2.5, 0.0, Outcome.STRETCHED, 3.0, 0.1, StrainFigure.OUT_OF_PLANE, source=Source.ESTIMATE)
    for one in (verdict, expected(designs.candidates[0], Ranking(), jammed)):
        icons = [ICONS[badge.state] for badge in badges_of(one) if badge.is_level]
        assert icons == ["fault" if one.level is Level.FAILS else "warning"]


def test_that_badges_follow_the_material(designed: MainWindow, table: AllDesigns, until: Until) -> None:
    services = designed.services
    until(lambda: bool(services.estimates.known) and not services.estimates.busy)
    rows = [table.table.model_.index(row, 0) for row in range(table.table.model_.rowCount())]
    assert all("fits the material" in row.data(VERDICT_ROLE).summary for row in rows)
    services.fabrication.change(material="plywood-co2")
    # What was found in the other material goes at once, not once this one was looked at.
    assert not any(row.data(VERDICT_ROLE).as_cut for row in rows)
    until(lambda: not services.estimates.busy)
    assert all("does not fit the material" in row.data(VERDICT_ROLE).summary for row in rows)


def test_that_an_empty_window_says_what_to_do(window: MainWindow, tmp_path: Path) -> None:
    window.commands["all_designs"].trigger()
    page = window.presenters.all_designs.page
    assert page is not None and page.isVisible() and page.table.hint().startswith("No designs yet")
    assert not page.use.isEnabled() and not page.alike.isEnabled()
    press(page, KEY.Key_C, KEY.Key_Return, KEY.Key_1, KEY.Key_Escape)
    assert window.pages.isVisible()
