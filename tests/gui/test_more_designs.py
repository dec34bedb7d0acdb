"""Further runs: more from the next seed, more like one, and what Generate keeps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from PIL import Image
from PySide6.QtCore import Qt
from pytestqt.qtbot import QtBot

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.generator.weights import digest_of
from kirigami_studio.gui.gallery.gallery_model import FRESH_ROLE
from kirigami_studio.gui.gallery.gallery_selection import SortOrder
from kirigami_studio.gui.run.generation import next_seed
from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.outlines import silhouettes
from kirigami_studio.pipeline.events import Finished
from kirigami_studio.pipeline.variety import distances
from kirigami_studio.project.document import Document, Mark
from kirigami_studio.project.edits import Edit
from kirigami_studio.studio.designing import generating, ranking_of

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton
CONTROL, SHIFT = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier


def small(window: MainWindow) -> MainWindow:
    """Three unpolished designs of 6 x 6 voids at a time."""
    window.services.settings.change(grid=(6, 6))
    window.services.settings.change(k=3)
    window.services.settings.change(polish=0)
    return window


@pytest.fixture
def drawn(heart: MainWindow, until: Until) -> MainWindow:
    """A studio with three designs drawn from seed 0."""
    heart.gallery.bar.filters.grouped.setChecked(False)
    small(heart).commands["generate"].trigger()
    until(lambda: not heart.services.run.running and len(heart.session.document.candidates) == 3)
    return heart


def shown(window: MainWindow) -> list[Candidate]:
    return [entry.candidate for entry in window.gallery.view.model_.entries]


@pytest.mark.torch
def test_that_again_adds_designs_of_the_next_seed_and_keeps_choice_and_marks(
    drawn: MainWindow, qtbot: QtBot, until: Until
) -> None:
    services = drawn.services
    services.chosen.choose(services.session.document.candidates[2])
    services.marks.pin(services.session.document.candidates[1])
    before = services.session.document
    qtbot.mouseClick(drawn.gallery.bar.again, LEFT)
    assert services.run.running and len(shown(drawn)) == 3
    assert services.session.stage is not None and services.session.stage.candidate == before.candidate
    until(lambda: not services.run.running)
    after = services.session.document
    ranking = drawn.gallery.view.model_.ranking
    assert len(after.candidates) == 6 and after.candidates == ranking.ranked(after.candidates) == tuple(shown(drawn))
    assert replace(ranking, jam_phi={}, refusals={}, losses={}) == ranking_of(after)
    assert set(ranking.jam_phi) == set(after.candidates), "known of all as cut"
    assert {one.seed for one in after.candidates} == {0, 1} and set(before.candidates) < set(after.candidates)
    assert after.candidate == before.candidate and services.session.stage.candidate == before.candidate
    assert dict(zip(after.candidates, after.marks, strict=True))[before.candidates[1]] is Mark.PINNED
    assert after.marks.count(Mark.PINNED) == 1 and after.settings.seed == 0
    assert services.session.history.undo_label == "Add 3 designs" and "3 designs added" in drawn.status_text.text()
    assert drawn.stage.title.text() == "Design A3", "whatever its rank is now"
    model = drawn.gallery.view.model_
    assert [model.index(row, 0).data(FRESH_ROLE) for row in range(6)] == [one.seed == 1 for one in after.candidates]
    box = drawn.gallery.bar.order
    box.setCurrentIndex(box.findData(SortOrder.NEWEST))
    box.activated.emit(box.currentIndex())
    assert [one.seed for one in shown(drawn)] == [1, 1, 1, 0, 0, 0]
    assert shown(drawn)[:3] == [one for one in after.candidates if one.seed == 1]
    box.setCurrentIndex(0)
    box.activated.emit(0)
    drawn.commands["undo"].trigger()
    assert services.session.document == before
    until(lambda: tuple(shown(drawn)) == before.candidates)


@pytest.mark.torch
def test_that_designs_that_are_there_already_are_not_added_again(drawn: MainWindow, until: Until) -> None:
    services = drawn.services
    request = replace(services.generation.planner.more(silhouettes.load("heart")).request, seed=0)
    steps = generating(request, services.session.document.fabrication, (), True, lambda: False)
    found = [event.result for event in steps if isinstance(event, Finished)]
    assert found[0].candidates == services.session.document.candidates
    others = services.session.document.candidates[1:]
    steps = generating(request, services.session.document.fabrication, others, True, lambda: False)
    left = [event.result for event in steps if isinstance(event, Finished)]
    assert left[0].candidates == services.session.document.candidates[:1]
    before = services.session.document
    services.run.start(request, before.candidates, joins=True)
    until(lambda: not services.run.running)
    assert services.session.document is before and tuple(shown(drawn)) == before.candidates
    assert drawn.status_text.text() == "No new designs; 3 already in the gallery."


@pytest.mark.torch
@pytest.mark.parametrize(
    ("staying", "told"),
    [(1, "2 designs added, 1 already in the gallery. "), (2, "1 design added, 2 already in the gallery. ")],
)
def test_that_designs_that_were_there_already_are_counted(
    drawn: MainWindow, until: Until, staying: int, told: str
) -> None:
    services = drawn.services
    whole = services.session.document
    fewer = replace(whole, candidates=whole.candidates[:staying], marks=whole.marks[:staying], labels=(), chosen=0)
    services.session.history.apply(Edit("Leave some", fewer))
    request = replace(services.generation.planner.more(silhouettes.load("heart")).request, seed=0)
    services.run.start(request, fewer.candidates, joins=True)
    until(lambda: not services.run.running)
    assert services.session.document.candidates == whole.candidates
    assert drawn.status_text.text().startswith(told + "Best new match: ")


@pytest.mark.torch
def test_that_again_draws_on_the_designs_own_grid_with_the_chosen_model(drawn: MainWindow, until: Until) -> None:
    drawn.services.settings.change(grid=(8, 8))
    drawn.services.settings.change(variant="prior")
    drawn.commands["again"].trigger()
    until(lambda: not drawn.services.run.running)
    after = drawn.session.document
    assert len(after.candidates) == 6 and {one.variant for one in after.candidates} == {"balanced", "prior"}
    assert {one.sheet.grid for one in after.candidates} == {(6, 6)}
    assert after.provenance["model"] == "balanced; prior"
    tips = [str(drawn.gallery.view.model_.index(row, 0).data(Qt.ItemDataRole.ToolTipRole)) for row in range(6)]
    assert sum("Model: prior" in tip for tip in tips) == 3


@pytest.mark.torch
def test_that_exports_tell_the_settings_of_the_designs_own_run(drawn: MainWindow, until: Until, tmp_path: Path) -> None:
    services = drawn.services
    for changes in ({"polish": 1}, {"k": 2}, {"prefer": "calm"}, {"variant": "prior"}):
        services.settings.change(**changes)
    drawn.commands["again"].trigger()
    until(lambda: not services.run.running)
    assert services.session.document.provenance["k"] == "3; 2"
    told = {0: {"POLISH": "0", "K": "3", "MODEL": "balanced"}, 1: {"POLISH": "1", "K": "2", "MODEL": "prior"}}

    def check(name: str) -> None:
        for one in services.session.document.candidates:
            services.chosen.choose(one)
            until(lambda: drawn.fabrication.export.isEnabled())
            path = tmp_path / f"{name}-{one.seed}-{one.index}.png"
            services.exporter.export(path)
            until(path.exists)
            with Image.open(path) as read:
                facts = {key.removeprefix("FROM_"): text for key, text in read.text.items()}  # type: ignore[attr-defined]
            assert {key: facts[key] for key in told[one.seed]} == told[one.seed]
            assert facts.get("PREFER") == (None if one.seed == 0 else "calm")
            digest = digest_of(told[one.seed]["MODEL"])
            assert facts["MODEL_SHA256"] == digest

    check("drawn")
    services.project.save(tmp_path / "two-runs.kiri")
    until(lambda: not services.session.history.unsaved)
    drawn.commands["new"].trigger()
    services.project.open(tmp_path / "two-runs.kiri")
    until(lambda: len(services.session.document.candidates) == 5 and services.session.stage is not None)
    check("opened")


@pytest.mark.torch
def test_that_a_stopped_further_run_leaves_what_was_there(drawn: MainWindow, qtbot: QtBot, until: Until) -> None:
    drawn.services.settings.change(k=100)
    before = drawn.session.document
    qtbot.keyClick(drawn, Qt.Key.Key_R, CONTROL)
    until(lambda: drawn.gallery.view.model_.rowCount() > 5)
    qtbot.keyClick(drawn, Qt.Key.Key_Escape)
    until(lambda: not drawn.services.run.running)
    assert drawn.session.document is before and tuple(shown(drawn)) == before.candidates
    assert drawn.session.stage is not None and drawn.session.stage.candidate == before.candidate


@pytest.mark.torch
def test_that_more_like_this_adds_designs_near_the_chosen_one(drawn: MainWindow, qtbot: QtBot, until: Until) -> None:
    bar, services = drawn.gallery.bar, drawn.services
    chosen = services.session.document.candidates[1]
    services.chosen.choose(chosen)
    assert not bar.draw.isVisible()
    qtbot.mouseClick(bar.alike, LEFT)
    assert bar.draw.isVisible()
    qtbot.keyClick(bar.nearness, Qt.Key.Key_Home)
    qtbot.mouseClick(bar.draw, LEFT)
    until(lambda: not services.run.running)
    near = [one for one in services.session.document.candidates if one.origin is Origin.RESAMPLED]
    assert services.session.document.candidate == chosen and 1 <= len(near) <= 3
    others = [
        one.sheet for one in services.session.document.candidates if one.origin is Origin.SAMPLED and one != chosen
    ]
    far, close = (
        distances(chosen.sheet.field, [sheet.field for sheet in some]) for some in (others, [one.sheet for one in near])
    )
    assert close.max() < far.min()
    assert services.session.document.provenance["nearness"] == "0.9"
    assert {one.seed for one in near} == {1}
    tips = [str(drawn.gallery.view.model_.index(row, 0).data(Qt.ItemDataRole.ToolTipRole)) for row in range(4)]
    assert any("generated near another design" in tip for tip in tips)


@pytest.mark.torch
def test_that_generate_keeps_pinned_designs_of_the_same_grid_only(drawn: MainWindow, until: Until) -> None:
    services = drawn.services
    pinned = services.session.document.candidates[2]
    services.marks.pin(pinned)
    services.marks.reject(services.session.document.candidates[1], None)
    services.settings.change(seed=5)
    drawn.commands["generate"].trigger()
    assert shown(drawn) == [pinned]
    until(lambda: not services.run.running)
    after = services.session.document
    assert len(after.candidates) == 4 and after.chosen == 0
    assert [one for one, mark in zip(after.candidates, after.marks, strict=True) if mark is not Mark.NONE] == [pinned]
    services.settings.change(grid=(7, 7))
    drawn.commands["generate"].trigger()
    assert shown(drawn) == []
    until(lambda: not services.run.running)
    assert len(services.session.document.candidates) == 3 and set(services.session.document.marks) == {Mark.NONE}
    assert "removed" in drawn.messages.messages[-1].sentence


@pytest.mark.torch
def test_that_a_seed_that_is_not_kept_moves_on_with_every_run(drawn: MainWindow, qtbot: QtBot, until: Until) -> None:
    qtbot.mouseClick(drawn.settings.keep, LEFT)
    for action, seed, count in (("generate", 1, 3), ("again", 2, 6)):
        drawn.commands[action].trigger()
        until(lambda: not drawn.services.run.running)
        document = drawn.session.document
        assert document.settings.seed == seed == drawn.settings.seed.value() and len(document.candidates) == count
        assert seed in {one.seed for one in document.candidates} and 0 not in {one.seed for one in document.candidates}
    drawn.commands["undo"].trigger()
    assert drawn.settings.seed.value() == 1


def test_that_there_must_be_designs_to_add_to(heart: MainWindow) -> None:
    assert not heart.gallery.bar.again.isEnabled() and not heart.commands["more_like"].isEnabled()
    for wish in (heart.services.generation.again, lambda: heart.services.generation.more_like(0.5)):
        wish()
        message = heart.messages.messages[-1]
        assert (
            message.tone is Tone.ERROR and "Generate first" in message.sentence
        ) or "Choose a design" in message.sentence
        assert not heart.services.run.running


def test_that_the_next_seed_is_the_first_that_no_design_has(designs: Document) -> None:
    assert next_seed(designs) == 0
    assert next_seed(replace(designs, settings=replace(designs.settings, seed=7))) == 8


@pytest.mark.torch
def test_that_a_run_begun_at_once_after_another_is_not_ended_by_it(drawn: MainWindow, until: Until) -> None:
    services = drawn.services
    ends: list[bool] = []

    def again(completed: bool) -> None:
        ends.append(completed)
        if len(ends) == 1:
            services.settings.change(seed=6)
            drawn.commands["generate"].trigger()

    services.run.completed.connect(lambda *_: again(True))
    services.run.ended.connect(lambda completed: None if completed else again(False))
    services.settings.change(seed=5)
    drawn.commands["generate"].trigger()
    until(lambda: len(ends) == 2 and not services.run.running)
    assert ends == [True, True] and {one.seed for one in services.session.document.candidates} == {6}
