"""Sorting and filtering the gallery: what is in sight, never what is in the document."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from gallery_cards import decoded
from PySide6.QtCore import Qt
from pytestqt.modeltest import ModelTester
from pytestqt.qtbot import QtBot

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.fabricate.panel_sizes import least_panel_share
from kirigami_studio.gui.gallery.gallery_model import NAME_ROLE, VALUE_ROLE, GalleryModel
from kirigami_studio.gui.gallery.gallery_selection import Selection, SortOrder
from kirigami_studio.gui.session.session import Entry
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.pipeline.variety import distances
from kirigami_studio.project.document import Document, Mark

LEFT = Qt.MouseButton.LeftButton


def shown(window: MainWindow) -> list[Candidate]:
    return [entry.candidate for entry in window.gallery.view.model_.entries]


def sort_by(window: MainWindow, order: SortOrder) -> None:
    box = window.gallery.bar.order
    box.setCurrentIndex(box.findData(order))
    box.activated.emit(box.currentIndex())


def test_that_what_is_gained_is_match_over_a_sheet_of_equal_cuts(designed: MainWindow) -> None:
    sort_by(designed, SortOrder.GAIN)
    assert designed.gallery.bar.order.currentText() == "By gained match"
    assert "over a sheet of equal cuts" in designed.gallery.bar.order.toolTip()
    model = designed.gallery.view.model_
    for row, entry in enumerate(model.entries):
        score = entry.candidate.score
        assert model.index(row, 0).data(VALUE_ROLE) == f"gained {100 * (score.siou - score.uniform_siou):+.1f}"


def test_that_cards_are_sorted_by_what_was_asked(designed: MainWindow, designs: Document) -> None:
    for order in SortOrder:
        check_order(designed, designs, order)


def check_order(designed: MainWindow, designs: Document, order: SortOrder) -> None:
    before = designed.session.document
    sort_by(designed, order)
    chosen = designs.candidates[0].sheet.field
    values = {
        SortOrder.RANK: lambda one: designs.candidates.index(one),
        SortOrder.MATCH: lambda one: -one.score.iou_exact,
        SortOrder.EVENNESS: lambda one: one.score.evenness.area_cv,
        SortOrder.GAIN: lambda one: -one.score.siou_gain,
        SortOrder.TV: lambda one: one.score.tv,
        SortOrder.PANEL: lambda one: -least_panel_share(deploy(one.sheet.field)),
        SortOrder.NEWEST: lambda one: designs.candidates.index(one),
        SortOrder.UNLIKE: lambda one: -float(distances(chosen, [one.sheet.field])[0]),
    }[order]
    assert shown(designed) == sorted(designs.candidates, key=values)
    assert designed.session.document is before and not designed.session.history.unsaved
    model = designed.gallery.view.model_
    names = [model.data(model.index(row, 0), NAME_ROLE) for row in range(3)]
    assert names == [f"A{designs.candidates.index(one) + 1}" for one in shown(designed)]
    assert designed.gallery.view.currentIndex().row() == shown(designed).index(designs.candidates[0])


def test_that_the_smallest_panel_is_the_shortest_edge_or_neck_found_one_by_one(designs: Document) -> None:
    for candidate in designs.candidates:
        sheet = deploy(candidate.sheet.field)
        corners = sheet.compact[sheet.topology.panel_nodes.reshape(-1, 4)]
        sizes = []
        for panel in corners:
            for here in range(4):
                for edge in range(4):
                    start, end = panel[edge], panel[(edge + 1) % 4]
                    if here in (edge, (edge + 1) % 4):
                        continue
                    along = np.linspace(0.0, 1.0, 2001)[:, None]
                    sizes.append(np.linalg.norm(panel[here] - (start + along * (end - start)), axis=1).min())
            sizes.extend(np.linalg.norm(panel - np.roll(panel, 1, axis=0), axis=1))
        assert least_panel_share(sheet) == pytest.approx(min(sizes) / np.ptp(sheet.compact[:, 0]), rel=1e-5)


def test_that_cards_tell_the_number_they_are_sorted_by_at_the_sheets_width(
    designed: MainWindow, designs: Document
) -> None:
    model = designed.gallery.view.model_
    first = designs.candidates[0].score
    assert model.data(model.index(0, 0), VALUE_ROLE) == f"panels ±{100 * first.evenness.area_cv:.0f} %"
    sort_by(designed, SortOrder.TV)
    told = [str(model.data(model.index(row, 0), VALUE_ROLE)) for row in range(3)]
    assert told == [f"roughness {one.score.tv:.2f}" for one in shown(designed)]
    sort_by(designed, SortOrder.PANEL)
    designed.services.fabrication.change(width_mm=250.0)
    sizes = [250.0 * least_panel_share(deploy(one.sheet.field)) for one in shown(designed)]
    told = [model.data(model.index(row, 0), VALUE_ROLE) for row in range(3)]
    assert told == [f"smallest {size:.1f} mm" for size in sizes]
    tip = str(model.data(model.index(0, 0), Qt.ItemDataRole.ToolTipRole))
    assert f"{sizes[0]:.2f} mm on a sheet 250 mm wide" in tip


def test_that_unlike_stays_with_its_design_until_it_is_asked_for_again(designed: MainWindow, designs: Document) -> None:
    sort_by(designed, SortOrder.UNLIKE)
    first = shown(designed)
    assert first[-1] == designs.candidates[0] and "design A1" in designed.gallery.bar.order.currentText()
    designed.services.chosen.choose(designs.candidates[2])
    assert shown(designed) == first
    sort_by(designed, SortOrder.UNLIKE)
    assert shown(designed)[-1] == designs.candidates[2] and "design A3" in designed.gallery.bar.order.currentText()


def test_that_filters_leave_designs_out_and_the_head_counts_them(
    designed: MainWindow, designs: Document, qtbot: QtBot
) -> None:
    bar, best = designed.gallery.bar, designs.candidates[0]
    assert not bar.filters.least.isVisible()
    qtbot.mouseClick(bar.filter, LEFT)
    assert bar.filters.least.isVisible()
    matches = [one.score.iou_exact for one in designs.candidates]
    bar.filters.least.setValue(100 * sorted(matches)[1] - 0.05)
    taken = [one for one in designs.candidates if one.score.iou_exact >= 0.01 * bar.filters.least.value()]
    assert shown(designed) == taken and len(taken) == 2
    assert designed.gallery.count.text() == "2 of 3 shown"
    designed.services.marks.pin(best)
    bar.filters.pinned.setChecked(True)
    assert shown(designed) == [best]
    qtbot.mouseClick(bar.filter, LEFT)
    assert shown(designed) == [best] and not bar.filters.least.isVisible()


def test_that_designs_with_uneven_panels_can_be_left_out(designed: MainWindow, designs: Document) -> None:
    bar = designed.gallery.bar
    variations = sorted(100 * one.score.evenness.area_cv for one in designs.candidates)
    bar.filters.variation.setValue(math.ceil(variations[0]))
    assert shown(designed) == [
        one for one in designs.candidates if 100 * one.score.evenness.area_cv <= bar.filters.variation.value()
    ]
    assert 1 <= len(shown(designed)) < 3
    bar.show_all()
    assert len(shown(designed)) == 3 and bar.filters.variation.text() == "any"


def test_that_an_empty_gallery_offers_to_take_the_filter_off(designed: MainWindow, qtbot: QtBot) -> None:
    view, bar = designed.gallery.view, designed.gallery.bar
    bar.filters.pinned.setChecked(True)
    assert shown(designed) == [] and view.empty_text().startswith("No design matches the filter")
    assert designed.session.stage is not None and designed.session.document.chosen == 0
    qtbot.mouseClick(view.viewport(), LEFT, pos=view.viewport().rect().center())
    assert len(shown(designed)) == 3 and not bar.filters.pinned.isChecked()
    assert view.currentIndex().row() == 0


def test_that_designs_that_will_not_work_can_be_left_out(
    qtbot: QtBot, qtmodeltester: ModelTester, designs: Document
) -> None:
    model = GalleryModel()
    qtmodeltester.check(model)
    bad = replace(designs.candidates[1], score=replace(designs.candidates[1].score, feasible=False))
    good = [
        replace(one, score=replace(one.score, feasible=True, contact=None, iou_exact=0.8))
        for one in (designs.candidates[0], designs.candidates[2])
    ]
    model.select(Selection(works_only=True))
    model.replace([decoded(one) for one in (good[0], good[1], bad)])
    assert [entry.candidate for entry in model.entries] == good
    assert len(model.all_entries) == 3 and model.number_of(bad) == 3 and model.row_of(bad) == -1
    model.select(Selection())
    assert model.rowCount() == 3


@pytest.mark.parametrize("order", list(SortOrder))
def test_that_designs_that_arrive_one_by_one_lie_as_if_sorted_at_once(
    qtbot: QtBot, qtmodeltester: ModelTester, designs: Document, order: SortOrder
) -> None:
    grown, whole = GalleryModel(), GalleryModel()
    qtmodeltester.check(grown)
    selection = Selection(order=order, unlike=designs.candidates[1].sheet, pinned_first=True)
    marks = {designs.candidates[2]: Mark.PINNED}
    for model in (grown, whole):
        model.set_marks(marks)
        model.select(selection)
    entries = [decoded(one) for one in designs.candidates]
    rows = [grown.insert(entry) for entry in (entries[1], entries[2], entries[0])]
    whole.replace(entries)
    assert [one.candidate for one in grown.entries] == [one.candidate for one in whole.entries]
    assert grown.entries[0].candidate == designs.candidates[2] and rows[1] == 0


def test_that_a_design_of_an_earlier_run_is_no_state_of_a_new_sample(qtbot: QtBot, designs: Document) -> None:
    model = GalleryModel()
    before = [replace(decoded(one), kept=True) for one in designs.candidates]
    model.select(Selection(grouped=False))
    model.replace(before)
    twin = designs.candidates[2]  # the same seed and number, another field
    found = Entry(replace(twin, sheet=designs.candidates[0].sheet), before[0].design)
    model.insert(found)
    assert model.rowCount() == 4
    model.insert(Entry(replace(found.candidate, polished=True), before[0].design))
    assert model.rowCount() == 4 and twin in [entry.candidate for entry in model.entries]
    for other in (replace(twin, variant="prior"), replace(twin, seed=8)):
        model.insert(Entry(other, before[0].design))
    assert model.rowCount() == 6
