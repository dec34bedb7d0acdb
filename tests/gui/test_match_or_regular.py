"""The choices above Generate: grid auto, symmetry, and the balance of match and regularity over what is there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.pipeline import auto_grid
from kirigami_studio.pipeline.auto_grid import choose_grid
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.project import store
from kirigami_studio.project.document import Document, Mark

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton


def shown(window: MainWindow) -> list[Candidate]:
    return [entry.candidate for entry in window.gallery.view.model_.entries]


def wheel(widget: QWidget) -> None:
    place = QPointF(widget.rect().center())
    none, nothing = Qt.MouseButton.NoButton, Qt.KeyboardModifier.NoModifier
    where, phase = widget.mapToGlobal(place), Qt.ScrollPhase.NoScrollPhase
    QApplication.sendEvent(widget, QWheelEvent(place, where, QPoint(), QPoint(0, 240), none, nothing, phase, False))


def test_that_an_opened_project_shows_the_grid_that_was_chosen_for_its_designs(
    window: MainWindow, designs: Document, tmp_path: Path, until: Until
) -> None:
    settings, path = window.settings, tmp_path / "auto.kiri"
    store.save(replace(designs, settings=replace(designs.settings, auto_grid=True, grid=(4, 5))), path)
    for _ in range(2):  # opening it again changes nothing
        window.services.project.open(path)
        until(lambda: window.session.stage is not None and not window.session.queue.busy)
        until(lambda: settings.auto.accessibleDescription() != "" and not window.session.queue.busy)
        assert (settings.rows.value(), settings.columns.value()) == (4, 5)
        assert "4 x 5" in settings.auto.accessibleDescription()
    window.services.settings.change(symmetry="none")  # another run, which would choose a grid by itself
    until(lambda: "Expected match" in settings.auto.accessibleDescription())
    assert (settings.rows.value(), settings.columns.value()) != (4, 5)
    window.commands["undo"].trigger()
    until(lambda: "4 x 5" in settings.auto.accessibleDescription())
    assert (settings.rows.value(), settings.columns.value()) == (4, 5)


def test_that_the_grid_is_chosen_by_the_target_until_a_number_is_given(
    heart: MainWindow, until: Until, qtbot: QtBot
) -> None:
    settings, target = heart.settings, heart.session.document.target
    assert target is not None and settings.auto.isChecked() and heart.session.document.settings.auto_grid
    wanted = choose_grid(target, "auto", 100.0, Ranking().least_feature_mm)
    until(lambda: settings.auto.accessibleDescription() != "")
    grid = (settings.rows.value(), settings.columns.value())
    assert grid[1] % 2 == 1 and f"{grid[0]} x {grid[1]}" in settings.auto.toolTip() and wanted.grid[1] % 2 == 1
    settings.rows.setValue(7)
    assert not settings.auto.isChecked()
    assert heart.session.document.settings.grid == (7, grid[1])
    qtbot.mouseClick(settings.auto, LEFT)
    assert heart.session.document.settings.auto_grid and settings.rows.value() == grid[0]
    qtbot.mouseClick(settings.auto, LEFT)
    fixed = heart.session.document.settings
    assert not fixed.auto_grid and fixed.grid == grid
    heart.commands["undo"].trigger()
    assert settings.auto.isChecked()


def test_that_a_grid_that_a_run_chose_by_trying_is_the_one_shown(
    window: MainWindow, until: Until, monkeypatch: pytest.MonkeyPatch
) -> None:
    def worth(request, grids, trials) -> dict:
        return {one: 0.9 + 0.001 * place for place, one in enumerate(grids)}  # the least likely one is the best

    monkeypatch.setattr(auto_grid, "_CHOSEN", {})
    monkeypatch.setattr(auto_grid, "_worth", worth)
    settings, services = window.settings, window.services
    services.targeting.open("star")
    until(lambda: settings.auto.accessibleDescription() != "")
    expected = (settings.rows.value(), settings.columns.value())
    services.settings.change(k=1, polish=0)
    window.run.generate.click()
    until(lambda: len(services.session.document.candidates) == 1 and not services.run.running)
    grid = services.session.document.candidates[0].sheet.grid
    assert grid != expected, "trying has chosen another grid than was expected"
    until(lambda: (settings.rows.value(), settings.columns.value()) == grid)
    assert "short fits" in settings.auto.accessibleDescription()


def test_that_symmetry_is_a_choice_that_tells_what_the_target_has(heart: MainWindow, until: Until) -> None:
    box = heart.settings.symmetry
    assert [box.itemText(row) for row in range(box.count())] == ["Auto", "Off", "Mirror", "Turn"]
    until(lambda: "with a mirror axis" in box.toolTip())
    assert "100.0 %" in box.toolTip()
    box.setCurrentIndex(2)
    box.activated.emit(2)
    assert heart.session.document.settings.symmetry == "mirror"
    assert heart.session.history.undo_label == "Change the symmetry"
    until(lambda: heart.settings.auto.accessibleDescription() != "")
    heart.settings.symmetry.setCurrentIndex(3)
    heart.settings.symmetry.activated.emit(3)
    until(lambda: "turn" in heart.settings.auto.accessibleDescription())  # a heart has none: the reason says so


def test_that_seldom_wanted_settings_are_folded_away_and_that_lasts(window: MainWindow, qtbot: QtBot) -> None:
    settings = window.settings
    hidden = (settings.seed, settings.variant, settings.polish, settings.prefer, settings.rim, settings.search)
    assert not any(one.isVisible() for one in hidden) and settings.symmetry.isVisible()
    qtbot.mouseClick(settings.more, LEFT)
    assert all(one.isVisible() for one in hidden)
    settings.rim.setCurrentIndex(1)
    settings.rim.activated.emit(1)
    assert window.session.document.settings.rim == "even"


def test_that_the_wheel_over_the_panel_changes_no_choice(window: MainWindow) -> None:
    before = window.session.document
    window.setFocus()
    for one in (window.settings.regular, window.settings.symmetry, window.settings.rim):
        wheel(one)
    assert window.session.document == before and window.settings.regular.value() == 50


def uneven(document: Document) -> Document:
    """Three designs of which the one that matches best has the least even panels."""
    figures = ((0.99, 0.9), (0.98, 0.5), (0.97, 0.2))
    found = tuple(
        replace(
            one,
            score=replace(
                one.score,
                iou_exact=match,
                feasible=True,
                contact=None,
                evenness=replace(one.score.evenness, area_cv=variation, at_limit=0.0),
            ),
        )
        for one, (match, variation) in zip(document.candidates, figures, strict=True)
    )
    return replace(document, candidates=found, marks=(Mark.NONE, Mark.PINNED, Mark.NONE), labels=())


@pytest.fixture
def balanced(designed: MainWindow, until: Until) -> MainWindow:
    """Three designs, ranked by match alone."""
    document = uneven(designed.session.document)
    document = replace(document, settings=replace(document.settings, regular=0.0))
    designed.session.restart(document, None)
    until(lambda: tuple(shown(designed)) == document.candidates)
    return designed


def test_that_moving_the_balance_ranks_the_cards_at_once_and_changes_nothing_else(balanced: MainWindow) -> None:
    first = shown(balanced)
    document, slider = balanced.session.document, balanced.settings.regular
    slider.setSliderDown(True)
    slider.setValue(100)
    assert shown(balanced) == first[::-1] and balanced.session.document is document
    assert balanced.gallery.view.currentIndex().row() == 2
    slider.setValue(0)
    assert shown(balanced) == first
    slider.setSliderDown(False)
    assert balanced.session.document is document and not balanced.services.regularity.busy


def test_that_letting_go_ranks_fits_again_and_is_one_undo_step(balanced: MainWindow, until: Until) -> None:
    before, slider = balanced.session.document, balanced.settings.regular
    slider.setSliderDown(True)
    slider.setValue(100)
    slider.setSliderDown(False)
    assert balanced.services.regularity.busy and balanced.run.stop.isVisible()
    now = balanced.session.document
    assert now.settings.regular == 1.0 and now.candidates == before.candidates[::-1]
    assert now.chosen == 0 and now.marks[1] is Mark.PINNED
    until(lambda: not balanced.services.regularity.busy)
    assert balanced.status_text.text().startswith("Ranked again")
    assert not balanced.run.stop.isVisible() and balanced.run.generate.isEnabled()
    ranking = Ranking(1.0, now.fabrication.width_mm)
    fitted = balanced.session.document.candidates
    assert list(fitted) == sorted(fitted, key=lambda one: -ranking.worth(one))
    assert balanced.session.history.steps == ("Change match or regular",)
    balanced.commands["undo"].trigger()
    assert balanced.session.document == before and slider.value() == 0


def test_that_fitting_again_can_be_stopped_and_leaves_the_new_order(balanced: MainWindow, until: Until) -> None:
    slider = balanced.settings.regular
    slider.setSliderDown(True)
    slider.setValue(80)
    slider.setSliderDown(False)
    assert balanced.services.regularity.busy
    balanced.commands["cancel"].trigger()
    assert not balanced.services.regularity.busy and not balanced.run.stop.isVisible()
    assert balanced.session.document.settings.regular == 0.8


def test_that_keys_move_the_balance_and_the_last_one_counts(balanced: MainWindow, until: Until) -> None:
    slider = balanced.settings.regular
    slider.setFocus()
    for _ in range(3):
        QTest.keyClick(slider, Qt.Key.Key_Right)
    assert slider.value() == 15 and balanced.session.document.settings.regular == 0.0
    until(lambda: balanced.session.document.settings.regular == 0.15)
    until(lambda: not balanced.services.regularity.busy)
    assert len(balanced.session.history.steps) == 1


def test_that_without_designs_the_balance_is_a_setting(window: MainWindow) -> None:
    slider = window.settings.regular
    slider.setSliderDown(True)
    slider.setValue(75)
    slider.setSliderDown(False)
    assert window.session.document.settings.regular == 0.75
    assert not window.services.regularity.busy


@pytest.mark.torch
def test_that_the_balance_also_ranks_what_a_run_has_found_so_far_and_what_comes_of_it(
    heart: MainWindow, until: Until
) -> None:
    services, model = heart.services, heart.gallery.view.model_
    services.settings.change(grid=(5, 5), k=12, polish=0, symmetry="none")
    services.generation.generate()
    until(lambda: len(model.all_entries) > 4)
    slider = heart.settings.regular
    slider.setSliderDown(True)
    slider.setValue(0)
    assert services.run.running
    found = [entry.candidate for entry in model.all_entries]
    ranking = Ranking(0.0, services.session.document.fabrication.width_mm, model.ranking.least_feature_mm)
    assert found == list(ranking.ranked(found))
    slider.setSliderDown(False)
    until(lambda: not services.run.running)
    assert services.session.document.settings.regular == 0.0
    assert services.session.document.candidates == ranking.ranked(services.session.document.candidates)
