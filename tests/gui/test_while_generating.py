"""What the stage shows while designs are on their way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from kirigami_studio.fabricate.findings import Note
from kirigami_studio.gui.gallery.gallery_model import UNCHECKED_ROLE
from kirigami_studio.gui.run import generate_bar
from kirigami_studio.gui.stage.layout_view import CAPTION_HEIGHT
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.pipeline.events import Result
from kirigami_studio.project.document import Document
from kirigami_studio.studio.as_cut import AsCut, Outcome, StrainFigure
from kirigami_studio.studio.designing import Judged

Until = Callable[[Callable[[], bool]], None]


def begin_run(window: MainWindow, joins: bool = False) -> None:
    """What Generate does before the first report comes."""
    services = window.services
    kept = services.session.document.candidates if joins else ()
    services.session.display.begin_run(kept, joins)
    services.run.started.emit(3)


def test_that_a_run_shows_its_target_and_no_older_design(designed: MainWindow) -> None:
    """Before, the design of the run before stayed on the stage, of an older grid and perhaps for another target."""
    stage = designed.stage
    assert stage.view.design is not None
    begin_run(designed)
    assert designed.session.stage is None and stage.view.design is None
    bounds, target = stage.view.scene_bounds(), designed.session.document.target
    assert bounds is not None and target is not None
    assert (bounds.left, bounds.right) == pytest.approx((target.points[:, 0].min(), target.points[:, 0].max()))
    assert not stage.deployment.isEnabled() or not stage.deployment.play.isEnabled()


def test_that_the_target_is_shown_before_a_run_during_it_and_when_it_found_nothing(heart: MainWindow) -> None:
    bounds = heart.stage.view.scene_bounds()
    assert bounds is not None
    begin_run(heart)
    assert heart.stage.view.scene_bounds() == bounds
    heart.services.run.ended.emit(False)
    assert heart.stage.view.scene_bounds() == bounds


def test_that_the_angle_stays_from_one_run_to_the_next(designed: MainWindow, designs: Document) -> None:
    display = designed.session.display
    designed.stage.deployment.set_phi(1.0)
    begin_run(designed)
    display.add(designed.session.cache.entry(designs.candidates[1]))
    assert designed.stage.view.design is not None and designed.stage.view.phi == pytest.approx(1.0, abs=2e-3)


def test_that_a_run_that_adds_designs_leaves_the_chosen_one_on_the_stage(designed: MainWindow) -> None:
    before = designed.session.stage
    begin_run(designed, joins=True)
    assert designed.session.stage is before and designed.stage.view.design is not None


def test_that_the_ends_of_a_design_found_meanwhile_have_the_size_asked_for(
    designed: MainWindow, designs: Document
) -> None:
    """Before, they had the size of a sheet as wide as the one before the run, or as an empty project expects."""
    session = designed.session
    designed.services.fabrication.set_opened_size(230.0)
    for candidate in designs.candidates[1:]:
        begin_run(designed)
        session.display.add(session.cache.entry(candidate))
        opened = designed.stage.ends.target
        assert "230 " in opened.toolTip() or " 230 mm" in opened.toolTip(), opened.toolTip()


def test_that_words_and_target_do_not_lie_over_each_other(designed: MainWindow) -> None:
    begin_run(designed)
    view, target = designed.stage.view, designed.session.document.target
    transform = view.transform()
    assert transform is not None and target is not None
    assert transform.to_pixels(target.points)[:, 1].min() >= CAPTION_HEIGHT


def test_that_a_design_that_nobody_has_checked_says_so_on_its_card_until_the_run_has(
    heart: MainWindow, designs: Document
) -> None:
    """Before, it had its match and an icon without a word, as one that is ready."""
    services, model, first = heart.services, heart.gallery.view.model_, designs.candidates[0]
    begin_run(heart)
    services.session.display.add(services.session.cache.entry(first))
    card = model.index(0, 0)
    assert card.data(UNCHECKED_ROLE) == "Not checked yet"
    found = AsCut(0.0, 0.0, Outcome.CLOSES, 0.0, 0.01, StrainFigure.OUT_OF_PLANE, 0.9, 0.9)
    services.run.judged.emit(Judged(first, None, 0.0, found))
    assert card.data(UNCHECKED_ROLE) == "" and model.verdict_of(first).is_checked
    services.run.judged.emit(Judged(first, Note.of("rank.jams", own=20.0), 0.0, None))
    assert services.session.display.ranking.refusals.keys() == {first}
    services.run.ended.emit(False)


def test_that_the_times_of_designing_and_of_checking_are_both_said(designed: MainWindow, designs: Document) -> None:
    """Before, eight designs "in 8.6 s" after minutes of waiting."""
    planner, target = designed.services.generation.planner, designs.target
    assert target is not None
    request = planner.anew(target).request
    result = Result(request, designs.candidates, 3, 8.0, judging_seconds=100.0)
    said = planner.summary(result, designs, "", 109.0)
    assert "9 s" in said and "100 s" in said and "Best" in said
    none = replace(result, refusals=dict.fromkeys(designs.candidates, Note.of("rank.not_feasible")))
    said = planner.summary(none, designs, "", 109.0)
    assert "100 s" in said and "None can be cut" in said and "Best" not in said


def test_that_a_step_that_takes_long_shows_its_seconds_until_the_run_ends(
    heart: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before, nothing moved while one design was checked for half a minute."""
    begin_run(heart)
    bar, timer = heart.run, heart.run._seconds
    bar.show_progress(500, 1000, "Checking 1 of 8")
    assert timer.isActive()
    bar.show_seconds()
    assert bar.progress_text.text() == "Checking 1 of 8"
    monkeypatch.setattr(generate_bar, "WORTH_COUNTING", 0.0)
    bar.show_seconds()
    assert bar.progress_text.text().startswith("Checking 1 of 8") and bar.progress_text.text().endswith("0 s")
    heart.services.run.ended.emit(False)
    assert not timer.isActive()
