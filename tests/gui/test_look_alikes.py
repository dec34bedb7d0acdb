"""Designs that look the same are one card: opened, chosen, pinned, rejected and compared as one expects."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gallery_cards import decoded
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from pytestqt.modeltest import ModelTester
from pytestqt.qtbot import QtBot

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.gui.gallery.gallery_model import ALIKE_ROLE, OPEN_ROLE, GalleryModel
from kirigami_studio.gui.gallery.gallery_selection import SortOrder
from kirigami_studio.gui.run import look_alikes
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.project.document import Document, Mark

Until = Callable[[Callable[[], bool]], None]
LEFT, NONE = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier


@pytest.fixture(scope="module")
def similar(designs: Document) -> Document:
    """Three designs, and two that look like the best of them."""
    ranking, target = Ranking(), designs.target
    assert target is not None
    best = ranking.ranked(designs.candidates)[0]
    draw = np.random.default_rng(3)
    near = []
    for index in (10, 11):
        field = RatioField.from_log10(best.sheet.field.log10 + 0.01 * draw.normal(size=(4, 5)))
        sheet = Sheet(field)
        near.append(replace(best, sheet=sheet, score=evaluate(deploy(sheet), target, 0.0), index=index))
    found = ranking.ranked((*designs.candidates, *near))
    return replace(designs, candidates=found, chosen=0, marks=(), labels=())


@pytest.fixture
def stacked(window: MainWindow, similar: Document, until: Until) -> MainWindow:
    window.session.restart(similar, None)
    until(lambda: len(window.gallery.view.model_.all_entries) == 5)
    return window


def shown(window: MainWindow) -> list[Candidate]:
    return [entry.candidate for entry in window.gallery.view.model_.entries]


def head(window: MainWindow) -> int:
    """Row of the card that others lie under."""
    model = window.gallery.view.model_
    (row,) = [row for row in range(model.rowCount()) if model.index(row, 0).data(ALIKE_ROLE)]
    return row


def mark_of_alike(window: MainWindow) -> QPoint:
    view = window.gallery.view
    index = view.model_.index(head(window), 0)
    view.scrollTo(index)
    return view.cards.alike_box(view.visualRect(index), index).center()


def test_that_look_alikes_are_one_card_that_opens_and_closes_by_a_click(stacked: MainWindow, similar: Document) -> None:
    view, model = stacked.gallery.view, stacked.gallery.view.model_
    assert len(shown(stacked)) == 3 and model.index(head(stacked), 0).data(ALIKE_ROLE) == 2
    tip = str(model.index(head(stacked), 0).data(Qt.ItemDataRole.ToolTipRole))
    assert "2 more designs look the same" in tip and "Rank: " in tip
    assert stacked.gallery.count.text() == "5 designs"
    row, document = head(stacked), stacked.session.document
    QTest.mouseClick(view.viewport(), LEFT, NONE, mark_of_alike(stacked))
    assert len(shown(stacked)) == 5 and model.index(row, 0).data(OPEN_ROLE)
    alike = shown(stacked)[row : row + 3]
    assert {one.index for one in alike} >= {10, 11} or {one.index for one in alike[1:]} & {10, 11}
    QTest.mouseClick(view.viewport(), LEFT, NONE, mark_of_alike(stacked))
    assert len(shown(stacked)) == 3 and stacked.session.document is document


def test_that_enter_opens_the_stack_and_arrows_walk_through_it(stacked: MainWindow, qtbot: QtBot) -> None:
    view = stacked.gallery.view
    view.setFocus()
    view.setCurrentIndex(view.model_.index(head(stacked), 0))
    row = head(stacked)
    qtbot.keyClick(view, Qt.Key.Key_Return)
    assert len(shown(stacked)) == 5
    qtbot.keyClick(view, Qt.Key.Key_Right)
    member = shown(stacked)[row + 1]
    assert stacked.session.document.candidate == member
    view.toggle_alike(shown(stacked)[row])  # what was chosen under it gives way to the card
    assert len(shown(stacked)) == 3 and stacked.session.document.candidate == shown(stacked)[row]
    assert view.currentIndex().row() == row


def test_that_a_hidden_design_shows_when_it_is_chosen_or_compared(stacked: MainWindow) -> None:
    model = stacked.gallery.view.model_
    hidden = next(one for one in stacked.session.document.candidates if model.row_of(one) < 0)
    stacked.services.chosen.choose(hidden)
    assert model.row_of(hidden) >= 0 and stacked.gallery.view.currentIndex().row() == model.row_of(hidden)
    stacked.commands["undo"].trigger()
    stacked.gallery.view.toggle_alike(shown(stacked)[head(stacked)])
    assert model.row_of(hidden) < 0
    stacked.gallery.view.show_compared(hidden)
    assert model.row_of(hidden) >= 0


def test_that_pinning_and_rejecting_mean_the_card_alone(stacked: MainWindow) -> None:
    model = stacked.gallery.view.model_
    first = shown(stacked)[head(stacked)]
    stacked.services.marks.pin(first)
    marks = dict(zip(stacked.session.document.candidates, stacked.session.document.marks, strict=True))
    assert marks[first] is Mark.PINNED and list(marks.values()).count(Mark.PINNED) == 1
    stacked.services.marks.reject(first, None)
    assert first not in shown(stacked) and model.index(head(stacked), 0).data(ALIKE_ROLE) == 1
    assert len(shown(stacked)) == 3
    stacked.commands["undo"].trigger()
    assert shown(stacked)[head(stacked)] == first and model.index(head(stacked), 0).data(ALIKE_ROLE) == 2


def test_that_grouping_can_be_switched_off_and_keeps_to_any_order(stacked: MainWindow) -> None:
    bar = stacked.gallery.bar
    box = bar.order
    for order in (SortOrder.MATCH, SortOrder.EVENNESS):
        box.setCurrentIndex(box.findData(order))
        box.activated.emit(box.currentIndex())
        assert len(shown(stacked)) == 3
    bar.filters.grouped.setChecked(False)
    assert len(shown(stacked)) == 5
    values = [one.score.evenness.area_cv for one in shown(stacked)]
    assert values == sorted(values)
    bar.filters.grouped.setChecked(True)
    assert len(shown(stacked)) == 3


def test_that_card_header_and_exported_file_are_of_one_design_whatever_the_order_and_the_groups(
    stacked: MainWindow, files: object, until: Until, tmp_path: Path
) -> None:
    window, model, bar = stacked, stacked.gallery.view.model_, stacked.gallery.bar
    hidden = next(one for one in window.session.document.candidates if model.row_of(one) < 0)
    window.services.chosen.choose(hidden)
    label = window.session.document.label_of(hidden)
    assert label is not None

    def agree() -> None:
        card = model.index(window.gallery.view.currentIndex().row(), 0)
        assert model.entries[card.row()].candidate == hidden == window.session.document.candidate
        assert str(card.data(Qt.ItemDataRole.AccessibleTextRole)).startswith(f"Design {label.text}: ")
        assert window.session.stage is not None and window.session.stage.candidate == hidden
        assert window.stage.title.text() == f"Design {label.text}"

    agree()
    for order in (SortOrder.PANEL, SortOrder.MATCH, SortOrder.RANK):
        bar.order.setCurrentIndex(bar.order.findData(order))
        bar.order.activated.emit(bar.order.currentIndex())
        agree()
    for grouped in (False, True):
        bar.filters.grouped.setChecked(grouped)
        agree()
    for page in (WindowPage.MAKE, WindowPage.DESIGN):
        window.pages.turn(page)
        agree()
    until(window.fabrication.export.isEnabled)
    files.answer = tmp_path / "cut.dxf"  # type: ignore[attr-defined]
    window.commands["export"].trigger()
    until(lambda: window.dialogs.report is not None)
    assert files.proposals[-1].endswith(f"-{label.text}.dxf")  # type: ignore[attr-defined]
    window.services.project.open(tmp_path / "cut.dxf")  # which holds the one design that it was made of
    until(lambda: len(window.session.document.candidates) == 1)
    assert window.session.document.candidates[0].sheet.field == hidden.sheet.field


def test_that_designs_join_their_stack_while_they_arrive(
    qtbot: QtBot, qtmodeltester: ModelTester, similar: Document
) -> None:
    model = GalleryModel()
    qtmodeltester.check(model)
    for candidate in reversed(similar.candidates):
        model.insert(decoded(candidate))
        assert model.rowCount() <= 3 and model.number_of(candidate) > 0
    assert model.rowCount() == 3 and len(model.all_entries) == 5 and len(model.taken) == 5


def test_that_many_designs_are_compared_in_the_worker(
    window: MainWindow, similar: Document, until: Until, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(look_alikes, "COMPARED_AT_ONCE", 2)
    window.session.restart(similar, None)
    model = window.gallery.view.model_
    until(lambda: len(model.all_entries) == 5)
    until(lambda: model.rowCount() == 3)
    assert model.index(head(window), 0).data(ALIKE_ROLE) == 2


@pytest.mark.usefixtures("german")
def test_that_the_mark_of_look_alikes_has_room_for_its_words_in_german(stacked: MainWindow) -> None:
    stacked.commands["all_designs"].trigger()
    page = stacked.presenters.all_designs.page
    assert page is not None
    table = page.table
    index = next(at for row in range(table.model_.rowCount()) if (at := table.model_.index(row, 0)).data(ALIKE_ROLE))
    box = table.cards.alike_box(table.visualRect(index), index)
    assert box.width() >= table.fontMetrics().horizontalAdvance("+2 gleiche") + 8
