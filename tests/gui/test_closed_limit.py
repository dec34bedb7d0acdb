"""Beside the score stands what no closed sheet shows of the target: above the cards, in the header, on the board."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.project import edits
from kirigami_studio.project.document import Document
from kirigami_studio.studio.designing import limit_of

Until = Callable[[Callable[[], bool]], None]


@pytest.fixture
def keyhole() -> Outline:
    points = [(-5, -5), (5, -5), (5, 5), (0.8, 5), (1.8, -1), (-1.8, -1), (-0.8, 5), (-5, 5)]
    return Outline.from_points(points, "keyhole")


def told(window: MainWindow) -> list[str]:
    """What stands above the cards, in the tooltip of the score, and on the page of the shape."""
    panel, limit = window.gallery, window.target.limit
    return [panel.why.text(), window.stage.numbers.toolTip().splitlines()[-1], limit.toolTip()]


def test_that_a_target_says_before_any_run_what_no_closed_sheet_shows(window: MainWindow, keyhole: Outline) -> None:
    session = window.session
    session.apply(edits.set_target(session.document, keyhole))
    window.pages.turn(WindowPage.SHAPE)
    note = limit_of(session.document)
    assert note is not None and note.code == "covers.turns_back_ahead"
    assert window.target.limit.isVisible() and window.target.limit.toolTip() == note.text
    session.apply(edits.set_target(session.document, load("heart")))
    assert not window.target.limit.isVisible()


def test_that_designs_say_it_with_the_most_that_was_found(window: MainWindow, keyhole: Outline, until: Until) -> None:
    session = window.session
    field = RatioField.from_log10(0.1 * np.random.default_rng(1).normal(size=(4, 4)))
    found = Candidate(Sheet(field), evaluate(deploy(field), keyhole, 0.0), seed=1, index=0)
    start = edits.set_target(session.document, keyhole).document
    session.apply(edits.set_candidates(start, [found], {}))
    until(lambda: session.stage is not None)
    note = limit_of(session.document)
    assert note is not None and note.code == "covers.turns_back_closed"
    assert f"{100 * found.match:.1f} %" in note.text
    assert told(window) == [note.text] * 3
    session.apply(edits.set_target(session.document, load("heart")))
    assert window.gallery.why.text() == "" and not window.target.limit.isVisible()


def test_that_why_holes_stay_filled_stands_above_the_cards(
    designed: MainWindow, designs: Document, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before, it stood in the tooltip of a card alone."""
    assert designed.gallery.why.text() == ""
    why = Note.of("rank.holes_filled", why="panels would touch.")
    monkeypatch.setattr(Ranking, "why_filled", lambda ranking, ranked: why if ranked == designs.candidates else None)
    designed.presenters.designs.show_document(designed.session.document)
    assert designed.gallery.why.text() == why.text and designed.gallery.why.isVisible()
