"""The second target: chosen among the settings, shown on the stage near its angle, told, saved, undone, removed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
import shapely
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.evaluate.second_target import SecondTarget, second_matches
from kirigami_studio.gui.run.settings_panel import PRESENT
from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.session.overlays import Overlay
from kirigami_studio.gui.stage.phi_slider import MarkKind
from kirigami_studio.gui.target.sketch_context import Change
from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.placed import Placed
from kirigami_studio.outlines.starts import start_shape
from kirigami_studio.polish.flat_sheet import uniform_sheet
from kirigami_studio.project import edits, store
from kirigami_studio.project.document import Document

Until = Callable[[Callable[[], bool]], None]
HEXAGON = SecondTarget(silhouettes.load("hexagon"), math.radians(60.0), 0.5)
HOUSE = [(-40.0, -30.0), (40.0, -30.0), (40.0, 30.0), (0.0, 50.0), (-40.0, 30.0)]


def choose(window: MainWindow, value: str) -> None:
    """Choose an entry of the box as the mouse does."""
    box = window.settings.second.shape
    box.setCurrentIndex(box.row_of(value))
    box.activated.emit(box.currentIndex())


def take(window: MainWindow, until: Until, name: str) -> None:
    """Choose a silhouette of the library."""
    choose(window, "library")
    picker = window.dialogs.picker
    assert picker is not None and picker.isVisible()
    picker.chosen.emit(name)
    picker.close()
    until(lambda: window.settings.second.shape.currentText() == name)


def present(window: MainWindow) -> SecondTarget:
    second = window.session.document.settings.second
    assert second is not None
    return second


@pytest.fixture(scope="module")
def passing() -> Document:
    """A disk of 5 x 6 voids for the heart that passes a hexagon, beside one that was not made for it."""
    target, sheet = silhouettes.load("heart"), uniform_sheet((5, 6), start_shape("circle"))
    deployment = deploy(sheet)
    (match,) = second_matches([deployment], HEXAGON)
    score = evaluate(deployment, target, 0.0)
    found = [Candidate(sheet, score, 0, 0, second=match), Candidate(sheet, score, 0, 1)]
    begun = edits.set_target(Document(), target).document
    return replace(edits.set_candidates(begun, found, {}).document, chosen=0)


@pytest.fixture
def shown(window: MainWindow, passing: Document, until: Until) -> MainWindow:
    """A studio with these designs, large enough for the line below the slider."""
    window.resize(1440, 900)
    window.session.restart(passing, None)
    until(lambda: window.session.stage is not None and window.fabrication.export.isEnabled())
    return window


def test_that_it_lies_below_the_drawing_board(window: MainWindow, until: Until, qtbot: QtBot) -> None:
    settings = window.settings
    assert not settings.second.isVisible()
    qtbot.keyClick(window, Qt.Key.Key_1)
    row = settings.second
    assert row.isVisible() and row.shape.currentText() == "None"
    assert not row.angle.isEnabled() and not row.weight.isEnabled() and not row.remove.isVisible()
    take(window, until, "hexagon")
    assert (present(window).phi, present(window).weight) == (math.radians(45.0), 0.3)  # as on the command line
    assert row.shape.currentData() == PRESENT and not row.shape.itemIcon(row.shape.currentIndex()).isNull()
    assert (row.angle.value(), row.weight.value()) == (45.0, 0.3) and row.angle.isEnabled()
    qtbot.mouseClick(row.remove, Qt.MouseButton.LeftButton)
    assert window.session.document.settings.second is None and not row.remove.isVisible()
    assert window.session.history.undo_label == "Remove the second target"


def test_that_shape_angle_and_weight_are_one_undo_step_each(window: MainWindow, until: Until) -> None:
    row, session = window.settings.second, window.session
    window.pages.turn(WindowPage.SHAPE)
    take(window, until, "hexagon")
    for value in (50.0, 60.0, 70.0):
        row.angle.setValue(value)
    row.angle.editingFinished.emit()
    row.weight.setValue(1.5)
    row.weight.editingFinished.emit()
    take(window, until, "egg")  # angle and weight stay
    assert (present(window).outline.name, present(window).weight) == ("egg", 1.5)
    assert math.degrees(present(window).phi) == pytest.approx(70.0)
    assert session.history.steps == ("Change the second target",) * 4
    names = []
    for _ in range(4):
        second = session.document.settings.second
        assert second is not None
        names.append((second.outline.name, round(math.degrees(second.phi)), second.weight))
        window.commands["undo"].trigger()
    assert names == [("egg", 70, 1.5), ("hexagon", 70, 1.5), ("hexagon", 70, 0.3), ("hexagon", 45, 0.3)]
    assert row.shape.currentText() == "None" and row.angle.value() == 45.0 and not row.angle.isEnabled()


def test_that_it_lies_between_the_flat_sheet_and_the_target(heart: MainWindow, until: Until) -> None:
    row, settings, session = heart.settings.second, heart.settings, heart.session
    heart.pages.turn(WindowPage.SHAPE)
    settings.angle.setValue(80.0)
    take(heart, until, "hexagon")
    assert row.angle.value() == 130.0  # halfway, as the usual angle is not passed
    row.angle.setValue(1.0)
    assert row.angle.value() == pytest.approx(80.1) and session.document.settings.phi < present(heart).phi
    settings.angle.setValue(120.0)
    assert heart.messages.messages[-1].tone is Tone.ERROR
    assert "not at 80.1 degrees on its way" in heart.messages.messages[-1].sentence
    assert settings.angle.value() == 80.0
    row.weight.setValue(9.0)
    assert present(heart).weight == row.weight.value() == 4.0


def test_that_a_file_falls_on_the_row_or_is_opened_and_a_bad_one_changes_nothing(
    window: MainWindow, files: object, until: Until, tmp_path: Path
) -> None:
    window.pages.turn(WindowPage.SHAPE)
    row, drawn = window.settings.second, tmp_path / "kite.json"
    drawn.write_text("[[0, 0], [2, 1], [0, 4], [-2, 1]]", encoding="utf-8")
    content = QMimeData()
    content.setUrls([QUrl.fromLocalFile(str(drawn))])
    copy, left, none = Qt.DropAction.CopyAction, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    QApplication.sendEvent(row, QDragEnterEvent(QPoint(9, 9), copy, content, left, none))
    assert row.drops.here
    QApplication.sendEvent(row, QDropEvent(QPointF(9, 9), copy, content, left, none))
    until(lambda: row.shape.currentText() == "kite")
    assert window.session.document.target is None
    before = window.session.document
    files.answer = tmp_path / "bad.json"  # type: ignore[attr-defined]
    files.answer.write_text("[1]", encoding="utf-8")  # type: ignore[attr-defined]
    choose(window, "file")
    assert row.shape.currentText() == "kite"  # until another one was read
    until(lambda: bool(window.messages.messages))
    assert window.messages.messages[-1].tone is Tone.ERROR and window.session.document is before
    files.answer = drawn  # type: ignore[attr-defined]
    choose(window, "file")
    until(lambda: window.messages.messages == ())  # what was wrong no longer applies


def test_that_it_is_drawn_on_a_board_of_its_own(window: MainWindow) -> None:
    window.pages.turn(WindowPage.SHAPE)
    choose(window, "draw")
    board = window.dialogs.second_board
    assert board is not None and board.isVisible() and not board.take.isEnabled()
    assert board.view.tool is Tool.POLYGON and board.tools.buttons[Tool.STAR].isVisible()
    board.view.context.changed.emit(Change("Draw polygon", lambda: Placed.from_ring(HOUSE, "house")))
    assert board.take.isEnabled() and window.session.history.steps == ()
    board.take.click()
    assert not board.isVisible() and present(window).outline.name == "house"
    assert window.settings.second.shape.currentText() == "house"
    choose(window, "draw")
    assert board.placed is not None and len(board.placed.ring) == 5  # goes on with the present one
    board.reject()


def test_that_the_stage_shows_it_near_its_angle(shown: MainWindow) -> None:
    view, candidate = shown.stage.view, shown.session.document.candidates[0]
    design, second = view.design, candidate.second
    assert design is not None and second is not None and view.second is not None
    angle, line = view.second
    assert angle == HEXAGON.phi
    sheet, drawn = shapely.Polygon(design.outline(design.nodes(angle), angle)), shapely.Polygon(line)
    share = sheet.intersection(drawn).area / sheet.union(drawn).area
    assert share == pytest.approx(second.match.iou_exact, abs=1e-6)
    view.set_overlays(frozenset({Overlay.TARGET}))
    same = {}
    for degrees in (60.0, 66.0, 75.0):
        view.set_phi(math.radians(degrees))
        view.show_design(design, None, shown.session.document.target, second)
        with_line = view.grab().toImage()
        view.show_draft(design)  # nothing else changes but that the line goes: it is that of the design before
        assert view.second is None
        same[degrees] = with_line == view.grab().toImage()
    assert same == {60.0: False, 66.0: False, 75.0: True}


def test_that_slider_line_status_and_cards_tell_it(shown: MainWindow, qtbot: QtBot) -> None:
    stage, second = shown.stage, shown.session.document.candidates[0].second
    assert second is not None
    (mark,) = [mark for mark in stage.deployment.slider.marks() if mark.kind is MarkKind.SECOND]
    assert mark.phi == HEXAGON.phi and mark.words == "60° second"
    share = 100.0 * second.match.iou_exact
    assert stage.ends.passed.isVisible() and f"{share:.1f} %" in stage.ends.passed.accessibleName()
    assert f"hexagon {share:.1f} % at 60°" in shown.facts.text()
    qtbot.mouseClick(stage.ends.passed, Qt.MouseButton.LeftButton)
    assert stage.deployment.slider.phi == HEXAGON.phi
    card = shown.gallery.view.model_.index(0, 0).data(Qt.ItemDataRole.ToolTipRole)
    assert "On its way, at 60°: hexagon, " in card and f"match {share:.2f} %" in card
    shown.services.chosen.choose(shown.session.document.candidates[1])
    assert not stage.ends.passed.isVisible() and "hexagon" not in shown.facts.text()
    assert all(mark.kind is not MarkKind.SECOND for mark in stage.deployment.slider.marks())


def test_that_a_trimmed_design_is_told_as_it_is_untrimmed(shown: MainWindow, until: Until) -> None:
    shown.services.chosen.trim(True)
    until(lambda: not shown.services.chosen.trimming.busy)
    stage = shown.session.stage
    assert stage is not None and stage.candidate.trim is not None and stage.candidate.second is not None
    assert shown.stage.ends.passed.accessibleName().endswith("% untrimmed") and shown.stage.view.second is None
    assert "untrimmed" in shown.facts.text()


@pytest.mark.torch
def test_that_generate_uses_it_and_the_project_keeps_it(
    heart: MainWindow, files: object, until: Until, tmp_path: Path
) -> None:
    services = heart.services
    for change in ({"grid": (4, 5)}, {"k": 2}, {"polish": 2}):
        services.settings.change(**change)  # type: ignore[arg-type]
    heart.pages.turn(WindowPage.SHAPE)
    take(heart, until, "hexagon")
    heart.settings.second.angle.setValue(60.0)
    QTest.keyClick(heart.settings.second.angle, Qt.Key.Key_Return)
    heart.commands["generate"].trigger()
    until(lambda: not services.run.running and len(services.session.document.candidates) == 2)
    wanted = present(heart)
    for candidate in services.session.document.candidates:
        assert candidate.second is not None and candidate.second.target == wanted
        (again,) = second_matches([deploy(candidate.sheet)], wanted)
        assert again is not None and again.match.iou_exact == pytest.approx(candidate.second.match.iou_exact, abs=1e-9)
    files.answer = tmp_path / "passing.kiri"  # type: ignore[attr-defined]
    heart.commands["save_as"].trigger()
    until(lambda: not services.session.history.unsaved)
    saved = services.session.document
    assert store.load(tmp_path / "passing.kiri") == saved
    heart.commands["new"].trigger()
    assert not heart.settings.second.remove.isVisible()
    services.project.open(tmp_path / "passing.kiri")
    until(lambda: services.session.stage is not None)
    assert services.session.document == saved and heart.settings.second.shape.currentText() == "hexagon"
    assert heart.settings.second.angle.value() == pytest.approx(60.0)
