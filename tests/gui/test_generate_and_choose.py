"""Generate with the bundled model; cancel; choose; undo."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.gallery.gallery_model import described
from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline.rank import USUAL
from kirigami_studio.project.document import Document
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.designing import request_for

Until = Callable[[Callable[[], bool]], None]
#: Designs of a run that a test stops after the first ones.
MANY = 100
#: Voids of a grid on which each design is made in milliseconds; nothing here depends on how well it matches.
SMALL = (4, 5)
LEFT = Qt.MouseButton.LeftButton


def test_that_a_run_has_as_many_designs_as_the_settings_say() -> None:
    request = request_for(load("heart"), DesignSettings(k=32, polish=15), FabricationSettings())
    assert request.k == 32 and request.fitted_starts == 8 and request.k - request.fitted_starts == 24


@pytest.mark.torch
def test_that_generating_fills_the_gallery_best_first_and_is_one_undo_step(
    heart: MainWindow, qtbot: QtBot, until: Until
) -> None:
    heart.settings.rows.setValue(4)
    heart.settings.columns.setValue(5)
    heart.settings.candidates.setValue(3)
    before = heart.session.document
    qtbot.mouseClick(heart.run.generate, LEFT)
    assert heart.services.run.running and heart.run.stop.isVisible() and not heart.run.generate.isEnabled()
    until(lambda: not heart.services.run.running)
    found = heart.session.document.candidates
    assert found == USUAL.ranked(found) and len(found) == 3 and found[0].sheet.grid == SMALL
    assert [entry.candidate for entry in heart.gallery.view.model_.entries] == list(found)
    assert heart.session.stage is not None and heart.session.stage.candidate == found[0]
    assert heart.stage.view.phi == pytest.approx(0.0)
    provenance = heart.session.document.provenance
    assert provenance["model"] == "balanced" and len(provenance["model_sha256"]) == 64
    assert any(candidate.polished for candidate in found)
    assert not heart.run.stop.isVisible()
    heart.commands["undo"].trigger()
    assert heart.session.document == before and heart.gallery.view.model_.rowCount() == 0
    heart.commands["redo"].trigger()
    assert heart.session.document.candidates == found


@pytest.mark.torch
def test_that_a_run_given_up_for_the_same_target_leaves_nothing_in_sight(heart: MainWindow, until: Until) -> None:
    heart.services.settings.change(grid=SMALL)
    heart.settings.candidates.setValue(MANY)
    before = heart.session.document
    heart.commands["generate"].trigger()
    until(lambda: len(heart.gallery.view.model_.all_entries) > 2)
    heart.services.targeting.open("heart")
    until(lambda: not heart.services.run.running)
    assert heart.session.document is before
    assert heart.gallery.view.model_.rowCount() == 0 and heart.session.stage is None


@pytest.mark.torch
def test_that_designs_still_being_decoded_do_not_mix_with_those_of_a_run(
    window: MainWindow, project_file: Path, until: Until
) -> None:
    services, view = window.services, window.gallery.view
    shown: list[int] = []

    def generate_at_once(said: str) -> None:
        if said.startswith("Opened"):  # the designs are being decoded from now on
            assert services.session.document.candidates and services.session.stage is None
            services.settings.change(k=2)
            services.settings.change(polish=0)
            services.session.display.gallery_reset.connect(lambda _: shown.append(view.model_.rowCount()))
            services.generation.generate()

    services.session.status_changed.connect(generate_at_once)
    services.project.open(project_file)
    until(lambda: not services.run.running and services.session.stage is not None)
    assert shown == [0, 2]


@pytest.mark.torch
def test_that_a_cancelled_run_leaves_the_document_unchanged(heart: MainWindow, qtbot: QtBot, until: Until) -> None:
    heart.services.settings.change(grid=SMALL)
    heart.settings.candidates.setValue(MANY)
    before = heart.session.document
    qtbot.keyClick(heart, Qt.Key.Key_G, Qt.KeyboardModifier.ControlModifier)
    until(lambda: len(heart.gallery.view.model_.all_entries) > 2)
    qtbot.keyClick(heart, Qt.Key.Key_Escape)
    until(lambda: not heart.services.run.running)
    assert heart.session.document is before
    assert heart.gallery.view.model_.rowCount() == 0
    assert heart.session.stage is None
    assert "nothing changed" in heart.status_text.text()


def stop_early(heart: MainWindow, until: Until, count: int = MANY) -> None:
    """Begin a run of many designs and stop it by Esc after the first few."""
    heart.services.settings.change(grid=SMALL)
    heart.settings.candidates.setValue(count)
    heart.commands["generate"].trigger()
    until(lambda: len(heart.gallery.view.model_.all_entries) > 2)
    heart.commands["cancel"].trigger()
    until(lambda: not heart.services.run.running)


@pytest.mark.torch
def test_that_designs_of_a_stopped_run_can_be_kept_as_one_undo_step(heart: MainWindow, until: Until) -> None:
    before = heart.session.document
    stop_early(heart, until)
    (message,) = heart.messages.messages
    ((label, keep),) = message.actions
    assert message.tone is Tone.HINT and label == "Keep these designs"
    keep()
    kept = heart.session.document
    assert kept.candidates == USUAL.ranked(kept.candidates) and 2 < len(kept.candidates) < MANY
    assert f"after {len(kept.candidates)} designs" in message.sentence
    assert kept.provenance["model"] == "balanced" and heart.messages.messages == ()
    until(lambda: heart.fabrication.export.isEnabled())
    assert len(heart.gallery.view.model_.all_entries) == len(kept.candidates)
    keep()  # a click that came too late
    assert heart.session.document is kept
    heart.commands["undo"].trigger()
    assert heart.session.document.candidates == before.candidates == ()


@pytest.mark.torch
def test_that_designs_of_a_stopped_run_are_offered_for_their_own_target_only(heart: MainWindow, until: Until) -> None:
    stop_early(heart, until)
    ((_, keep),) = heart.messages.messages[0].actions
    heart.services.targeting.open("star")
    until(lambda: heart.session.document.target.name == "star")  # type: ignore[union-attr]
    assert heart.messages.messages == ()
    keep()
    assert heart.session.document.candidates == ()


@pytest.mark.torch
def test_that_designs_of_a_stopped_further_run_join_those_that_are_there(heart: MainWindow, until: Until) -> None:
    heart.services.settings.change(grid=SMALL)
    heart.settings.candidates.setValue(2)
    heart.commands["generate"].trigger()
    until(lambda: not heart.services.run.running)
    first = heart.session.document
    heart.settings.candidates.setValue(MANY)
    heart.commands["again"].trigger()
    until(lambda: len(heart.gallery.view.model_.all_entries) > len(first.candidates) + 2)
    heart.commands["cancel"].trigger()
    until(lambda: not heart.services.run.running)
    assert heart.session.document.candidates is first.candidates
    ((_, keep),) = heart.messages.messages[-1].actions
    keep()
    found = heart.session.document.candidates
    assert set(first.candidates) < set(found) and len(found) > len(first.candidates) + 2


@pytest.mark.torch
def test_that_the_same_designs_again_are_no_undo_step_and_can_still_be_cut(heart: MainWindow, until: Until) -> None:
    heart.services.settings.change(grid=SMALL)
    heart.settings.candidates.setValue(1)
    heart.services.settings.change(polish=0)
    heart.commands["generate"].trigger()
    until(lambda: heart.fabrication.export.isEnabled() and not heart.services.run.running)
    found = heart.session.document
    heart.commands["generate"].trigger()
    assert heart.services.run.running and not heart.fabrication.export.isEnabled()
    until(lambda: heart.fabrication.export.isEnabled() and not heart.services.run.running)
    assert heart.session.document is found
    heart.commands["undo"].trigger()
    assert heart.session.document.candidates == ()


@pytest.mark.torch
def test_that_another_target_ends_the_run_for_the_old_one(heart: MainWindow, until: Until) -> None:
    heart.services.settings.change(grid=SMALL)
    heart.settings.candidates.setValue(MANY)
    heart.commands["generate"].trigger()
    until(lambda: heart.gallery.view.model_.rowCount() > 0)
    heart.services.targeting.open("star")
    until(lambda: heart.session.document.target is not None and heart.session.document.target.name == "star")
    assert not heart.services.run.running
    until(lambda: not heart.session.queue.busy)
    assert heart.session.document.candidates == () and heart.gallery.view.model_.rowCount() == 0


def test_that_an_unknown_model_is_refused_with_a_sentence(heart: MainWindow, until: Until) -> None:
    heart.services.settings.change(variant="of-tomorrow")
    before = heart.session.document
    heart.commands["generate"].trigger()
    until(lambda: not heart.services.run.running)
    message = heart.messages.messages[-1]
    assert message.tone is Tone.ERROR and "of-tomorrow" in message.sentence
    assert heart.session.document is before and heart.run.generate.isEnabled()


def test_that_generate_without_a_target_says_what_to_do_first(window: MainWindow) -> None:
    assert not window.run.generate.isEnabled() and not window.commands["generate"].isEnabled()
    window.services.generation.generate()
    assert "target first" in window.messages.messages[-1].sentence
    assert not window.services.run.running


def test_that_a_click_on_a_card_chooses_its_design(designed: MainWindow, qtbot: QtBot) -> None:
    view = designed.gallery.view
    place = view.visualRect(view.model_.index(1, 0)).center()
    qtbot.mouseClick(view.viewport(), LEFT, pos=place)
    assert designed.session.document.chosen == 1
    assert designed.stage.title.text() == "Design A2"


def test_that_arrow_keys_walk_through_the_gallery(designed: MainWindow, qtbot: QtBot) -> None:
    view = designed.gallery.view
    view.setFocus()
    qtbot.keyClick(view, Qt.Key.Key_Right)
    assert designed.session.document.chosen == 1
    qtbot.keyClick(view, Qt.Key.Key_Left)
    assert designed.session.document.chosen == 0
    qtbot.keyClick(designed, Qt.Key.Key_PageDown)
    assert designed.session.document.chosen == 1
    designed.commands["undo"].trigger()
    assert designed.session.document.chosen == 0 and view.currentIndex().row() == 0


def test_that_a_card_tells_its_numbers_to_screen_readers(designed: MainWindow, designs: Document) -> None:
    model = designed.gallery.view.model_
    line = model.data(model.index(0, 0), Qt.ItemDataRole.AccessibleTextRole)
    assert line.startswith(f"Design A1: match {100 * designs.candidates[0].match:.1f} %, ")
    text = model.data(model.index(0, 0), Qt.ItemDataRole.AccessibleDescriptionRole)
    assert text.startswith(described(designs.candidates[0], "A1"))
    assert f"{100 * designs.candidates[0].score.siou:.2f} %" in str(text)


def test_that_a_changed_setting_shows_in_the_document_and_back(heart: MainWindow, qtbot: QtBot) -> None:
    heart.settings.angle.setValue(30.0)
    heart.settings.columns.setValue(12)
    assert heart.session.document.settings.grid == (10, 12)
    assert heart.session.document.settings.phi == pytest.approx(0.5235987)
    heart.commands["undo"].trigger()
    heart.commands["undo"].trigger()
    assert (heart.settings.angle.value(), heart.settings.columns.value()) == (0.0, 10)
    seed = heart.settings.seed.value()
    qtbot.mouseClick(heart.settings.dice, LEFT)
    assert heart.session.document.settings.seed == heart.settings.seed.value() != seed


@pytest.mark.torch
def test_that_polish_off_leaves_designs_as_drawn(heart: MainWindow, qtbot: QtBot, until: Until) -> None:
    heart.services.settings.change(grid=SMALL)
    heart.settings.candidates.setValue(1)
    heart.settings.polish.setFocus()
    qtbot.keyClick(heart.settings.polish, Qt.Key.Key_Home)
    heart.settings.polish.activated.emit(heart.settings.polish.currentIndex())
    assert heart.session.document.settings.polish == 0
    qtbot.mouseClick(heart.run.generate, LEFT)
    until(lambda: not heart.services.run.running)
    (drawn,) = heart.session.document.candidates
    assert not drawn.polished
    assert heart.session.document.provenance["polish"] == "0"
