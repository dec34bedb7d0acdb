"""Cards, table, comparison and stage draw pinned designs as pieces, which a worker makes while panels are drawn."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QColor

from kirigami_studio.assembly.posed_pieces import PosedPieces
from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.fabricate.findings import Problem
from kirigami_studio.fabricate.material import Construction
from kirigami_studio.gui.gallery import card_delegate, design_table
from kirigami_studio.gui.gallery.gallery_model import MATCH_ROLE
from kirigami_studio.gui.stage.piece_items import colour_of
from kirigami_studio.gui.widgets.theme import DARK, LIGHT
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.project import store
from kirigami_studio.project.document import Document
from kirigami_studio.studio.assembling import assembled
from kirigami_studio.studio.making import CutRequest
from kirigami_studio.studio.verdict import Verdict
from tests.pinned_assemblies import plain_pinwheel

Until = Callable[[Callable[[], bool]], None]


@pytest.fixture(scope="module")
def pinwheels() -> Document:
    return plain_pinwheel(1.3)


@pytest.fixture
def pinned(window: MainWindow, pinwheels: Document, tmp_path: Path) -> MainWindow:
    """A window with two pinned designs, none of whose pieces are made yet."""
    store.save(pinwheels, tmp_path / "square.kiri")
    window.gallery.bar.filters.grouped.setChecked(False)
    window.services.project.open(tmp_path / "square.kiri")
    return window


def all_made(window: MainWindow) -> bool:
    """Whether the pieces of all designs are there."""
    pieces, candidates = window.services.pieces, window.session.document.candidates
    return bool(candidates) and all(pieces.of(candidate) is not None for candidate in candidates)


def test_that_cards_show_panels_until_pieces_are_there_and_then_pieces(
    pinned: MainWindow, until: Until, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[PosedPieces | None] = []
    draw = card_delegate.candidate_pixmap

    def noted(*arguments: object) -> object:
        drawn.append(arguments[-1])  # type: ignore[arg-type]
        return draw(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(card_delegate, "candidate_pixmap", noted)
    until(lambda: len({id(pieces) for pieces in drawn if pieces is not None}) == 2)
    assert drawn[:2] == [None, None]
    pieces = pinned.services.pieces
    small = [found.small for one in pinned.session.document.candidates if (found := pieces.of(one)) is not None]
    assert {id(one) for one in small} <= {id(one) for one in drawn}


def test_that_one_sheet_is_drawn_as_panels_at_once_and_pieces_come_back(pinned: MainWindow, until: Until) -> None:
    until(lambda: all_made(pinned))
    services, candidate = pinned.services, pinned.session.document.candidates[1]
    services.fabrication.change(construction=Construction.ONE_SHEET)
    assert services.pieces.of(candidate) is None
    services.fabrication.change(construction=None)
    assert services.pieces.of(candidate) is not None


def test_that_earlier_pieces_are_shown_until_those_of_another_size_are_there(pinned: MainWindow, until: Until) -> None:
    until(lambda: all_made(pinned))
    pieces, candidate = pinned.services.pieces, pinned.session.document.candidates[1]
    before = pieces.of(candidate)
    pinned.services.fabrication.change(width_mm=170.0)
    assert pieces.of(candidate) is before
    until(lambda: pieces.of(candidate) is not before)
    after = pieces.of(candidate)
    assert before is not None and after is not None and after.assembly.cell_mm > 1.03 * before.assembly.cell_mm


def test_that_table_and_comparison_show_the_same_pieces(
    pinned: MainWindow, until: Until, monkeypatch: pytest.MonkeyPatch
) -> None:
    until(lambda: all_made(pinned) and not pinned.services.pieces.busy)
    drawn: list[object] = []
    draw = design_table.states_pixmap

    def noted(*arguments: object, **options: object) -> object:
        drawn.append(options["pieces"])
        return draw(*arguments, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(design_table, "states_pixmap", noted)
    presenters, pieces = pinned.presenters, pinned.services.pieces
    presenters.all_designs.show(True)

    def shown() -> list[PosedPieces | None]:
        return [pieces.of(candidate) for candidate in pinned.session.document.candidates]

    # The chosen design's are made for its files as well, and then are those of its card: the table draws it again.
    until(lambda: {id(one.small) for one in shown() if one is not None} <= {id(one) for one in drawn})
    assert None not in drawn
    presenters.all_designs.show(False)
    presenters.comparison.show(True)
    until(lambda: [pane.view._pieces for pane in pinned.stage.compare.shown] == shown())


@pytest.mark.parametrize("degrees", [180.0, 95.0, 0.0])
def test_that_the_stage_shows_both_layers_in_the_colours_of_the_theme(
    pinned: MainWindow, until: Until, degrees: float
) -> None:
    until(lambda: pinned.stage.view._pieces is not None)
    pieces = pinned.stage.view._pieces
    assert pieces is not None
    pinned.stage.deployment.set_phi(math.radians(degrees))
    for palette in (LIGHT, DARK):
        pinned.stage.view.set_palette(palette)
        image = pinned.stage.view.grab().toImage()
        pixels = [image.pixelColor(x, y) for x in range(0, image.width(), 3) for y in range(0, image.height(), 3)]
        for place in range(2):
            face = colour_of(pieces.look.layer(place, 2), palette)
            assert sum(same(face, pixel) for pixel in pixels) > 0.02 * len(pixels)
    assert colour_of(pieces.look.face, DARK).lightness() < colour_of(pieces.look.face, LIGHT).lightness()


def test_that_fixes_of_pieces_are_tried_in_the_worker_and_told_with_their_verdict(
    pinned: MainWindow, until: Until
) -> None:
    keeper = pinned.services.verdict
    until(lambda: keeper.state.verdict is not None and keeper.state.verdict.ok)
    pinned.services.fabrication.change(ear_mm=15.0)
    until(lambda: keeper.state.advice is not None)
    advice, verdict = keeper.state.advice, keeper.state.verdict
    assert advice is not None and verdict is not None and not verdict.ok
    fix = advice.fixes[0]
    assert fix.verdict.ok and fix.line in keeper.state.lines
    pinned.session.apply(fix.edit(pinned.session.document))
    until(lambda: keeper.state.verdict is not None and not keeper.state.pending)
    assert keeper.state.verdict == fix.verdict and not keeper.state.searching


def same(one: QColor, other: QColor) -> bool:
    parts = zip(one.getRgb(), other.getRgb(), strict=True)
    return max(abs(a - b) for a, b in parts) <= 2  # type: ignore[operator]


def test_that_card_table_header_status_and_comparison_show_the_match_of_the_pieces(
    pinned: MainWindow, until: Until
) -> None:
    services, stage, model = pinned.services, pinned.stage, pinned.gallery.view.model_
    until(lambda: all_made(pinned) and len(services.estimates.verdicts) == 2)
    session, shown = pinned.session, pinned.session.stage
    assert shown is not None
    for candidate in session.document.candidates:
        made = assembled(candidate, session.document.fabrication, pinned.session.document.target)
        index = model.index(model.row_of(candidate), 0)
        assert index.data(MATCH_ROLE) == made.report.figures.match == model.verdict_of(candidate).match
        assert f"{100 * candidate.score.iou_exact:.2f} %" in index.data(Qt.ItemDataRole.ToolTipRole)
        assert f"{100 * made.report.figures.match:.1f} %" in index.data(Qt.ItemDataRole.AccessibleTextRole)
    figures = assembled(shown.candidate, session.document.fabrication, session.document.target).report.figures
    match, flat = f"{100 * figures.match:.1f} %", f"{100 * figures.flat_match:.1f} %"
    assert match != f"{100 * shown.candidate.match:.1f} %"
    assert all(match in text for text in stage._texts())
    assert match in stage.ends.target.accessibleName() and flat in stage.ends.start.accessibleName()
    assert match in pinned.facts.text()
    pinned.presenters.comparison.show(True)
    assert {pane.figures.values["match"].text() for pane in stage.compare.shown} >= {match}


def test_that_missing_and_extra_area_agree_with_the_match_of_the_pieces(pinned: MainWindow, until: Until) -> None:
    view, session = pinned.stage.view, pinned.session
    until(lambda: view._pieces is not None)
    assert session.stage is not None and session.document.target is not None
    view.grab()
    made = assembled(session.stage.candidate, session.document.fabrication, session.document.target)
    assert view.areas is not None
    found = (1.0 - view.areas.missing_share) / (1.0 + view.areas.extra_share)
    assert found == pytest.approx(made.report.figures.match, abs=1e-6)


def test_that_cards_are_ranked_by_the_match_that_they_show(pinned: MainWindow, until: Until) -> None:
    services, model = pinned.services, pinned.gallery.view.model_
    until(lambda: all_made(pinned) and len(services.estimates.verdicts) == 2)
    first, last = (entry.candidate for entry in model.all_entries)
    document, verdict = pinned.session.document, model.verdict_of(first)
    assert verdict.as_cut is not None

    def judge(candidate: Candidate, verdict: Verdict) -> None:
        request = CutRequest.of(replace(document, chosen=document.candidates.index(candidate)))
        services.estimates.take_verdict(request, verdict)

    judge(first, replace(verdict, as_cut=replace(verdict.as_cut, iou=0.9, ideal_iou=0.9), match=0.9))
    assert [entry.candidate for entry in model.all_entries] == [last, first] and model.match_of(first) == 0.9
    assert [model.ranking.made_match(one) for one in (last, first)] == pytest.approx(
        [model.match_of(one) for one in (last, first)]
    )
    broken = Problem.error("pinned.falls_apart", piece="A1", count=1)
    judge(last, replace(model.verdict_of(last), problems=(broken,)))
    assert [entry.candidate for entry in model.all_entries] == [first, last]
