"""Pictures of cards are drawn a few at a time, so that a large gallery does not hold the window up."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtGui import QRegion

from kirigami_studio.gui.gallery import card_delegate
from kirigami_studio.gui.gallery import cards as card_list
from kirigami_studio.gui.window.main_window import MainWindow

Until = Callable[[Callable[[], bool]], None]


def test_that_cards_wait_for_their_pictures_and_get_them(
    window: MainWindow, project_file: Path, until: Until, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[int] = []
    owed: list[bool] = []
    draw, cards = card_delegate.candidate_pixmap, window.gallery.view.cards
    begin = cards.begin

    def counted(*arguments: object) -> object:
        drawn.append(len(owed))
        return draw(*arguments)  # type: ignore[arg-type]

    def begun(region: QRegion) -> None:
        owed.append(cards.pending)
        begin(region)

    monkeypatch.setattr(card_list, "PAINT_SECONDS", 0.0)
    monkeypatch.setattr(card_delegate, "candidate_pixmap", counted)
    monkeypatch.setattr(cards, "begin", begun)
    window.services.project.open(project_file)
    until(lambda: len(drawn) == 3)
    assert len(set(drawn)) == 3  # one in each painting
    until(lambda: not cards.pending)
    assert True in owed


def test_that_no_card_waits_in_a_usual_window(designed: MainWindow, until: Until) -> None:
    view = designed.gallery.view
    until(lambda: not view.cards.pending and len(view.cards._pictures) == 3)
    picture = view.viewport().grab()
    assert not view.cards.pending and picture.width() == view.viewport().width()


def test_that_pictures_outlive_a_change_and_go_with_their_designs(designed: MainWindow, until: Until) -> None:
    cards = designed.gallery.view.cards
    until(lambda: not cards.pending and len(cards._pictures) == 3)
    before = dict(cards._pictures)
    designed.commands["pin"].trigger()
    designed.commands["next"].trigger()
    designed.commands["undo"].trigger()
    assert cards._pictures == before
    designed.services.targeting.open("star")
    until(lambda: designed.session.document.target is not None and designed.session.document.target.name == "star")
    assert not cards._pictures.keys() & before.keys()
