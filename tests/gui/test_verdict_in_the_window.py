"""The verdict in the window: one list in banner, panel, message and report; fixes are one click and one undo each."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from kirigami_studio.fabricate.material import Construction
from kirigami_studio.fabricate.options import ConnectorStyle
from kirigami_studio.gui.gallery.gallery_model import VERDICT_ROLE
from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.widgets.verdict_marks import badges_of, closing_text
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.studio.as_cut import Source
from kirigami_studio.studio.verdict import AnswerState, Level, Question

LEFT = Qt.MouseButton.LeftButton
STAR = Path(__file__).parents[1] / "data" / "projects" / "star_jams_at_143.kiri"
Until = Callable[[Callable[[], bool]], None]


def judged(window: MainWindow) -> bool:
    keeper = window.services.verdict
    return keeper.state.verdict is not None and not keeper.busy


@pytest.fixture
def ready(designed: MainWindow, until: Until) -> MainWindow:
    """A studio whose chosen design is ready to cut."""
    designed.resize(1440, 900)
    until(lambda: judged(designed))
    return designed


@pytest.fixture
def jamming(ready: MainWindow, until: Until) -> MainWindow:
    """The same on straight connectors that are too wide to close."""
    ready.services.fabrication.change(connector_mm=0.5)
    ready.services.fabrication.change_options(style=ConnectorStyle.STRAIGHT)
    until(lambda: judged(ready))
    return ready


def test_that_a_sheet_that_closes_is_ready_to_cut(ready: MainWindow) -> None:
    bar, state = ready.stage.verdict, ready.services.verdict.state
    assert state.verdict is not None and state.verdict.ok and bar.isVisible()
    assert bar.headline.text() == "Ready to cut" and bar.property("level") == "ready_to_cut"
    assert bar.buttons == [] and not bar.more.isVisible()
    assert bar.toolTip() == "\n".join(state.verdict.lines)
    assert ready.fabrication.warnings.text().startswith("Ready to cut: ")
    assert ready.fabrication.warnings.objectName() == "muted"


def test_that_a_jamming_sheet_is_never_green_and_one_click_mends_it(
    jamming: MainWindow, qtbot: QtBot, until: Until
) -> None:
    bar, services = jamming.stage.verdict, jamming.services
    verdict, before = services.verdict.state.verdict, services.session.document
    assert verdict is not None and verdict.level is Level.CARE
    assert bar.property("level") == "cut_with_care" and bar.headline.text().startswith("Cut with care")
    assert bar.sentence.text().startswith(verdict.problems[0].text[:30])
    assert jamming.fabrication.warnings.text().startswith(f"Cut with care: {verdict.problems[0].text}")
    assert jamming.fabrication.warnings.objectName() == "warning"
    (button,) = [one for one in bar.buttons if one.text() == "Use centred connectors"]
    assert button.isVisible() and "Ready to cut" in button.toolTip()
    height = bar.height()
    qtbot.mouseClick(button, LEFT)
    assert services.session.document.fabrication.options.style is ConnectorStyle.CENTRED
    assert services.session.history.undo_label == "Use centred connectors"
    until(lambda: judged(jamming))
    assert bar.headline.text() == "Ready to cut" and bar.buttons == [] and bar.height() == height
    jamming.commands["undo"].trigger()
    assert services.session.document == before
    until(lambda: judged(jamming))
    # What was found is remembered: nothing is tried again.
    assert [one.text() for one in bar.buttons] and bar.property("level") == "cut_with_care"


def test_that_nothing_is_called_ready_before_the_sheet_was_closed(ready: MainWindow) -> None:
    ready.services.fabrication.change(connector_mm=0.3)
    bar = ready.stage.verdict
    assert ready.services.verdict.state.pending
    assert bar.headline.text() == "Checking the sheet as cut …" and bar.property("level") == ""


def test_that_a_refused_plan_is_told_with_what_has_room(ready: MainWindow, until: Until) -> None:
    ready.services.fabrication.change(connector_mm=19.0)
    until(lambda: judged(ready) and not ready.fabrication.export.isEnabled())
    bar = ready.stage.verdict
    assert bar.property("level") == "will_not_work" and "connector" in ready.fabrication.warnings.text()
    advice = ready.services.verdict.state.advice
    assert advice is not None and advice.fixes[0].verdict.ok and bar.buttons


def test_that_a_narrow_banner_puts_fixes_into_a_menu(jamming: MainWindow) -> None:
    bar = jamming.stage.verdict
    jamming.resize(1000, 640)
    QApplication.processEvents()
    shown = [one.text() for one in bar.buttons if one.isVisible()]
    assert [*shown, *(action.text() for action in bar.menu.actions())] == [one.text() for one in bar.buttons]
    assert bar.sentence.text().endswith("…") or len(bar.sentence.text()) < 120
    if bar.menu.actions():
        assert bar.more.isVisible()
        wanted = []
        bar.fix_wanted.connect(wanted.append)
        bar.menu.actions()[0].trigger()
        assert len(wanted) == 1


def test_that_message_report_and_record_have_the_same_list(
    jamming: MainWindow, qtbot: QtBot, until: Until, tmp_path: Path
) -> None:
    verdict = jamming.services.verdict.state.verdict
    assert verdict is not None
    jamming.services.exporter.export_all(tmp_path / "all", "heart")
    until(lambda: jamming.dialogs.report is not None)
    report, message = jamming.dialogs.report, jamming.messages.messages[-1]
    assert report is not None and report.judged is not None
    assert report.judged.problems[: len(verdict.problems)] == verdict.problems
    assert report.verdict.text() == f"Cut with care: {verdict.problems[0].text}"
    assert report.findings.item(0).text() == f"Care: {verdict.problems[0].text}"
    assert report.text().startswith("\n".join(report.judged.lines))
    assert message.tone is Tone.WARNING and message.sentence.endswith(verdict.problems[0].text)
    record = json.loads((tmp_path / "all" / "heart.json").read_text())
    assert record["verdict"] == json.loads(json.dumps(report.judged.to_json()))


def test_that_an_export_tries_no_fixes_again(
    jamming: MainWindow, until: Until, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    keeper, started = jamming.services.verdict, []
    advice = keeper.state.advice
    assert advice is not None and advice.fixes
    monkeypatch.setattr(keeper, "_start", lambda name, *_: started.append(name))
    jamming.services.exporter.export(tmp_path / "cut.dxf")
    until(lambda: jamming.dialogs.report is not None)
    QApplication.processEvents()
    assert started == [] and not keeper.busy and keeper.state.advice is advice


def test_that_a_sentence_of_the_banner_ends_within_it(jamming: MainWindow) -> None:
    bar = jamming.stage.verdict
    for width in (250, 330, 460, *range(600, 660, 7)):
        bar.resize(width, bar.height())
        QApplication.processEvents()
        words = bar.sentence
        assert words.text() and words.heightForWidth(words.width()) <= words.height(), width


def test_that_a_ready_sheet_is_reported_as_verified(ready: MainWindow, until: Until, tmp_path: Path) -> None:
    ready.services.exporter.export(tmp_path / "cut.dxf")
    until(lambda: ready.dialogs.report is not None)
    report = ready.dialogs.report
    assert report is not None and report.judged is not None and report.judged.ok
    assert report.verdict.text().startswith("Verified")
    assert ready.messages.messages[-1].tone is Tone.DONE


def test_that_banner_and_card_answer_for_exported_files_until_the_cut_changes(
    ready: MainWindow, until: Until, tmp_path: Path
) -> None:
    services, model = ready.services, ready.gallery.view.model_
    verdict, chosen = services.verdict.state.verdict, services.session.document.candidate
    assert verdict is not None and not verdict.read and chosen is not None
    services.exporter.export(tmp_path / "cut.dxf")
    until(lambda: ready.dialogs.report is not None)
    told = services.verdict.state.verdict
    assert told is not None and told.read and told.answer(Question.FILES).state is AnswerState.GOOD
    assert told.answer(Question.FILES).word in ready.stage.verdict.sentence.text()
    assert model.verdict_of(chosen) == told
    services.fabrication.change(connector_mm=0.3)
    until(lambda: judged(ready))
    assert services.verdict.state.verdict is not None and not services.verdict.state.verdict.read


def test_that_card_table_stage_panel_report_and_record_tell_the_same_of_a_star_that_jams(
    window: MainWindow, until: Until, tmp_path: Path
) -> None:
    services, model = window.services, window.gallery.view.model_
    services.project.open(STAR)
    until(lambda: bool(services.estimates.known) and not services.estimates.busy)
    (candidate,) = services.session.document.candidates
    guessed = services.estimates.known[candidate]
    assert guessed.closes and guessed.source is Source.ESTIMATE, "the estimate does not see this jam"
    until(lambda: services.verdict.state.known and not services.verdict.state.pending)
    verdict, sheet = services.verdict.state.verdict, services.as_cut.state.sheet
    assert verdict is not None and sheet is not None and verdict.level is Level.FAILS
    assert verdict.as_cut == sheet.as_cut and not verdict.is_estimate
    word = f"jams at {verdict.as_cut.jam_deg:.0f}°"
    shown = model.index(0, 0).data(VERDICT_ROLE)
    assert shown == verdict and closing_text(shown) == word
    assert [badge.text for badge in badges_of(shown)][:1] == ["Will not work"] and word in {
        badge.text for badge in badges_of(shown)
    }
    tip = str(model.index(0, 0).data(Qt.ItemDataRole.ToolTipRole))
    assert word in tip and "(estimate)" not in tip and "cuttable" not in tip
    assert window.stage.as_cut.text().startswith(word.capitalize())
    assert window.stage.deployment.slider.jam == verdict.as_cut.jam_phi
    assert window.stage.verdict.headline.text().startswith("Will not work")
    assert window.fabrication.warnings.text().startswith("Will not work: ")
    services.exporter.export_all(tmp_path / "all", "star")
    until(lambda: window.dialogs.report is not None)
    report = window.dialogs.report
    assert report is not None and report.verdict.text().startswith("Will not work: ") and word in report.answers.text()
    record = json.loads((tmp_path / "all" / "star.json").read_text())["verdict"]
    assert (record["jam_deg"], record["jam_from"]) == (verdict.as_cut.jam_deg, "simulation")
    assert record["answers"]["closes"] == {"state": "bad", "word": word}
    assert [problem["code"] for problem in record["problems"]] == [problem.code for problem in verdict.problems]


def test_that_an_outdated_verdict_leaves_the_cards_at_once(ready: MainWindow, until: Until) -> None:
    services, model = ready.services, ready.gallery.view.model_
    candidate = services.session.document.candidates[0]
    assert model.verdict_of(candidate) == services.verdict.state.verdict
    services.fabrication.change(connector_mm=0.35)
    assert model.verdict_of(candidate).words == "Not checked yet"
    until(lambda: judged(ready))
    assert model.verdict_of(candidate) == services.verdict.state.verdict
    services.project.undo()
    until(lambda: judged(ready))
    assert model.verdict_of(candidate) == services.verdict.state.verdict


def test_that_each_problem_is_followed_by_the_fix_that_was_tried(jamming: MainWindow) -> None:
    state = jamming.services.verdict.state
    assert state.verdict is not None and state.advice is not None
    first = state.advice.fixes[0]
    assert set(first.solves) <= {problem.code for problem in state.verdict.problems}
    (solved, *_) = [problem for problem in state.verdict.problems if problem.code in first.solves]
    lines = list(state.lines)
    assert lines[lines.index(solved.text) + 1] == first.line
    assert all(lines.count(fix.line) == 1 for fix in state.advice.fixes)


def test_that_pieces_on_pins_are_judged_and_pins_without_room_refused(ready: MainWindow, until: Until) -> None:
    keeper, fabrication = ready.services.verdict, ready.services.fabrication
    fabrication.change(construction=Construction.PINNED, width_mm=200.0)
    until(lambda: judged(ready) and ready.fabrication.numbers["pieces"].text().endswith("pins"))
    assert keeper.state.verdict is not None and keeper.state.verdict.as_cut is not None
    assert keeper.state.verdict.as_cut.closes and not keeper.state.searching
    ready.commands["cuts"].trigger()
    assert ready.cuts.beds.isVisible() and not ready.cuts.view.isVisible()
    fabrication.change(pin_mm=9.0, ear_mm=9.0)
    until(lambda: judged(ready) and keeper.state.verdict is not None and keeper.state.verdict.level is Level.FAILS)
    until(lambda: keeper.state.advice is not None)
    assert not keeper.state.searching and keeper.state.advice is not None and keeper.state.advice.fixes == ()
    fabrication.change(construction=None, pin_mm=None, ear_mm=None)
    until(lambda: judged(ready) and keeper.state.verdict is not None and keeper.state.verdict.ok)
    assert ready.cuts.view.isVisible() and not ready.cuts.beds.isVisible()


def test_that_pieces_to_print_are_judged_and_shown_on_their_plate_and_leave_as_3mf(
    ready: MainWindow, until: Until
) -> None:
    fabrication, panel = ready.services.fabrication, ready.fabrication
    offered = [panel.construction.itemData(row) for row in range(panel.construction.count())]
    assert Construction.PRINTED in offered
    fabrication.change(construction=Construction.PRINTED)
    until(lambda: judged(ready) and panel.numbers["pieces"].text().endswith("pins"))
    assert ready.session.document.fabrication.material == "pla-print"
    assert panel.exports.extension == ".3mf" and panel.numbers["time"].text() == panel.numbers["length"].text()
    (bed,) = ready.cuts.beds._beds
    assert bed.title == "Plate 1" and len(bed.placed) == len({piece.id for piece, _ in bed.placed})
    ready.commands["cuts"].trigger()
    assert ready.cuts.beds.isVisible() and "plate" in ready.cuts.summary[0]
    ready.commands["undo"].trigger()
    until(lambda: judged(ready) and ready.cuts.view.isVisible())
    assert ready.session.document.fabrication.construction is None
