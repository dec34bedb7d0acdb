"""What the polish prefers, the search, and what is told while both are at work."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from PySide6.QtCore import Qt
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.widgets.choice_box import TOOLTIP
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.polish.preferences import PREFERENCES

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton


def picked(window: MainWindow, name: str) -> None:
    box = window.settings.prefer
    box.setCurrentIndex(box.findData(name))
    box.activated.emit(box.currentIndex())


def test_that_the_window_offers_what_fits_can_prefer(window: MainWindow) -> None:
    box = window.settings.prefer
    assert [box.itemData(row) for row in range(box.count())] == list(PREFERENCES)
    assert all(box.itemData(row, TOOLTIP) for row in range(box.count()))
    assert box.currentData() == "balanced"


def test_that_preference_and_search_are_settings_that_can_be_undone(window: MainWindow, qtbot: QtBot) -> None:
    picked(window, "calm")
    window.settings.search.click()
    assert (window.session.document.settings.prefer, window.session.document.settings.search) == ("calm", 1)
    window.commands["undo"].trigger()
    assert not window.settings.search.isChecked()
    window.commands["undo"].trigger()
    assert window.settings.prefer.currentData() == "balanced"


def test_that_there_is_nothing_to_prefer_without_a_fit(window: MainWindow) -> None:
    window.services.settings.change(polish=0)
    assert not window.settings.prefer.isEnabled() and "Turn on Polish" in window.settings.prefer.toolTip()
    window.services.settings.change(polish=15)
    assert window.settings.prefer.isEnabled()


@pytest.mark.torch
def test_that_a_run_gets_the_preference_and_tells_how_far_polish_and_search_are(
    heart: MainWindow, qtbot: QtBot, until: Until
) -> None:
    heart.services.settings.change(grid=(4, 4), k=2, polish=5)
    picked(heart, "regularity")
    heart.settings.search.click()
    said: list[str] = []
    rises: list[float] = []
    results: list[object] = []
    heart.session.status_changed.connect(said.append)
    heart.session.display.candidate_found.connect(lambda entry: rises.append(entry.rise))
    heart.services.run.completed.connect(lambda result, _: results.append(result))
    qtbot.mouseClick(heart.run.generate, LEFT)
    until(lambda: not heart.services.run.running)
    (result,) = results
    assert result.request.prefer == "regularity" and result.request.search == 1  # type: ignore[attr-defined]
    told = [text for text in said if text.startswith("Polished")]
    assert told and all(re.fullmatch(r"Polished [12] of 2 \(best \d+\.\d %\)", text) for text in told)
    assert max(rises) > 0.0 and rises[0] == 0.0
    assert any(text.startswith("Search found a design") for text in said)
    candidates = heart.session.document.candidates
    assert sorted(candidate.index for candidate in candidates) == [0, 1, 2]
    assert all(entry.rise == 0.0 for entry in heart.gallery.view.model_.entries)
