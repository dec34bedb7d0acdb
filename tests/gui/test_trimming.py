"""Before and after polish, and the switch that trims a design."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication, QLabel
from pytestqt.qtbot import QtBot
from trimmed_panels import deployed_parts

from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.widgets.mismatch_items import mismatch
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.polish.levenberg import polish
from kirigami_studio.project import store
from kirigami_studio.project.document import Document

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton
CONTROL = Qt.KeyboardModifier.ControlModifier


@pytest.fixture(scope="session")
def polished(designs: Document) -> Document:
    """The same designs, the first one fitted to the heart from what was drawn."""
    target, first = designs.target, designs.candidates[0]
    assert target is not None
    fit = polish(first.sheet.field, target, 0.0, 8, pose=first.score.transform)
    sheet = first.sheet.with_field(fit.field)
    score = evaluate(deploy(sheet), target, 0.0)
    better = replace(first, sheet=sheet, score=score, polished=True, sampled_sheet=first.sheet)
    assert better.score.siou > first.score.siou
    return replace(designs, candidates=(better, *designs.candidates[1:]))


@pytest.fixture
def studio(window: MainWindow, polished: Document, until: Until, tmp_path: Path) -> MainWindow:
    """A studio with that project open and its cuts planned."""
    store.save(polished, tmp_path / "polished.kiri")
    window.resize(1440, 900)
    window.services.project.open(tmp_path / "polished.kiri")
    until(lambda: window.session.stage is not None and window.fabrication.export.isEnabled())
    return window


@pytest.fixture
def trimmed(studio: MainWindow, qtbot: QtBot, until: Until) -> MainWindow:
    """That studio with the first design trimmed."""
    qtbot.mouseClick(studio.stage.trim, LEFT)
    until(lambda: not studio.services.chosen.trimming.busy)
    until(lambda: "trimmed" in studio.fabrication.summary.text())
    return studio


def test_that_before_shows_the_design_as_it_was_drawn_and_after_brings_it_back(
    studio: MainWindow, designs: Document, qtbot: QtBot, until: Until
) -> None:
    studio.resize(1800, 900)  # room for the whole sentence beside the buttons
    after = studio.stage.view.grab().toImage()
    qtbot.keyClick(studio, Qt.Key.Key_B)
    until(lambda: studio.stage.showing_before)
    assert studio.stage.view.grab().toImage() != after
    drawn, fitted = designs.candidates[0].score, studio.session.document.candidates[0].score
    text = studio.stage.numbers.text()
    assert text == f"before polish: match {100 * drawn.iou_exact:.1f} %  ·  after: {100 * fitted.iou_exact:.1f} %"
    studio.stage.view.grab()
    areas = studio.stage.view.areas
    assert areas is not None
    assert (1 - areas.missing_share) / (1 + areas.extra_share) == pytest.approx(drawn.iou_exact, abs=1e-3)
    assert studio.commands["before"].isChecked()
    qtbot.mouseClick(studio.stage.before, LEFT)
    assert not studio.stage.showing_before and studio.stage.view.grab().toImage() == after
    assert "before" not in studio.stage.numbers.text()
    assert not studio.session.history.unsaved


def test_that_a_design_that_was_not_polished_has_nothing_to_compare(studio: MainWindow, qtbot: QtBot) -> None:
    qtbot.mouseClick(studio.stage.before, LEFT)
    studio.commands["next"].trigger()
    assert not studio.stage.before.isEnabled() and not studio.stage.before.isChecked()
    assert "Nothing to compare" in studio.stage.before.toolTip()
    assert not studio.commands["before"].isEnabled()
    studio.commands["previous"].trigger()
    assert studio.stage.before.isEnabled()


def test_that_trimming_is_one_named_edit_that_can_be_undone_redone_and_taken_off(
    trimmed: MainWindow, until: Until, qtbot: QtBot
) -> None:
    session, stage = trimmed.session, trimmed.stage
    assert session.history.undo_label == "Trim design A1"
    candidate = session.document.candidates[0]
    assert candidate.trim is not None and stage.trim.isChecked() and trimmed.commands["trim"].isChecked()
    trimmed.commands["undo"].trigger()
    assert session.document.candidates[0].trim is None and not stage.trim.isChecked()
    until(lambda: trimmed.fabrication.export.isEnabled() and "trimmed" not in trimmed.fabrication.summary.text())
    trimmed.commands["redo"].trigger()
    assert session.document.candidates[0] == candidate and stage.trim.isChecked()
    qtbot.keyClick(trimmed, Qt.Key.Key_T, CONTROL)
    assert session.history.undo_label == "Untrim design A1"
    assert session.document.candidates[0] == replace(candidate, trim=None) and not stage.trim.isChecked()


def test_that_both_figures_of_a_trimmed_design_stay_apart(trimmed: MainWindow) -> None:
    candidate = trimmed.session.document.candidates[0]
    trim, whole = candidate.trim, f"{100 * candidate.score.iou_exact:.1f} %"
    assert trim is not None and trim.iou > candidate.score.iou_exact
    assert trimmed.stage.numbers.text() == f"match {100 * trim.iou:.1f} %  ·  {whole} untrimmed"
    assert f"trimmed match {100 * trim.iou:.1f} %" in trimmed.facts.text() and f"match {whole}" in trimmed.facts.text()
    model = trimmed.gallery.view.model_
    assert [entry.candidate for entry in model.entries] == list(trimmed.session.document.candidates)
    card = str(model.data(model.index(0, 0), Qt.ItemDataRole.AccessibleDescriptionRole))
    assert f"sIoU {100 * candidate.score.siou:.2f} %" in card and f"Trimmed: IoU {100 * trim.iou:.2f} %" in card
    trimmed.resize(1000, 640)
    QApplication.processEvents()
    assert trimmed.stage.numbers.text() == "" and "untrimmed" in trimmed.stage.view.caption


def test_that_nothing_says_trimmed_once_the_trim_is_taken_off(trimmed: MainWindow, until: Until) -> None:
    def said() -> list[str]:
        labels = [part.text() for part in trimmed.findChildren(QLabel) if part.isVisible()]
        model, caption = trimmed.gallery.view.model_, trimmed.stage.view.caption
        cards = [str(model.data(model.index(row, 0), Qt.ItemDataRole.AccessibleTextRole)) for row in range(2)]
        return [text for text in (*labels, caption, *cards) if "trimmed" in text.lower()]

    assert len(said()) > 2
    trimmed.commands["trim"].trigger()
    until(lambda: trimmed.fabrication.export.isEnabled() and not trimmed.services.chosen.trimming.busy)
    for page in WindowPage:
        trimmed.pages.turn(page)
        QApplication.processEvents()
        assert said() == [], page


def test_that_a_trimmed_design_is_drawn_and_compared_as_it_is_cut(trimmed: MainWindow) -> None:
    stage = trimmed.session.stage
    target = trimmed.session.document.target
    assert stage is not None and stage.candidate.trim is not None and target is not None
    trim, design = stage.candidate.trim, stage.design
    for phi in (math.pi, 1.0, 0.0):
        nodes = design.nodes(phi)
        pose = design.pose_at(phi)
        assert pose.scale == trim.pose.scale and (pose.matrix == pytest.approx(trim.pose.matrix) or phi > 0.0)
        slow = deployed_parts(trim, design.deployment, phi)
        kept = design.kept(nodes, phi)
        assert sorted(kept) == [row for row, part in enumerate(trim.kept) if part is not None]
        for row, part in kept.items():
            np.testing.assert_allclose(part, pose.apply(slow[row]), atol=1e-12)
    nodes = design.nodes(0.0)
    areas = mismatch(target.points, design.outline(nodes, 0.0), design.removed(nodes, 0.0))
    assert (1 - areas.missing_share) / (1 + areas.extra_share) == pytest.approx(trim.iou, abs=1e-6)


def test_that_a_trimmed_design_exports_one_closed_outline_that_is_no_rectangle(
    trimmed: MainWindow, files: object, qtbot: QtBot, until: Until, tmp_path: Path
) -> None:
    files.answer = tmp_path / "trimmed.dxf"  # type: ignore[attr-defined]
    qtbot.mouseClick(trimmed.fabrication.export, LEFT)
    until(lambda: bool(trimmed.messages.messages))
    message = trimmed.messages.messages[-1]
    assert message.tone is Tone.DONE and "trimmed outline" in message.sentence
    drawing = ezdxf.readfile(tmp_path / "trimmed.dxf")
    outlines = [entity for entity in drawing.modelspace() if entity.dxf.layer == "OUTLINE"]
    assert len(outlines) == 1 and outlines[0].closed
    x, y = np.array([point[:2] for point in outlines[0].get_points()]).T
    area = 0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))
    assert len(x) > 4 and area < 0.995 * np.ptp(x) * np.ptp(y)


def test_that_a_trim_without_room_is_refused_in_one_sentence_and_the_switch_goes_back(
    studio: MainWindow, qtbot: QtBot, until: Until
) -> None:
    studio.services.fabrication.change(connector_mm=15.0)
    before = studio.session.document
    qtbot.mouseClick(studio.stage.trim, LEFT)
    assert studio.stage.trim.isChecked() and studio.services.chosen.trimming.busy
    until(lambda: not studio.services.chosen.trimming.busy)
    message = studio.messages.messages[-1]
    assert message.tone is Tone.ERROR and "wide" in message.sentence
    assert studio.session.document is before and not studio.stage.trim.isChecked()


def test_that_widths_that_the_trim_has_no_room_for_are_refused_with_a_way_out(
    trimmed: MainWindow, until: Until, qtbot: QtBot
) -> None:
    # With 4.5 mm an edge cut is 0.16 mm too short once it is trimmed again: only a wider sheet helps then.
    trimmed.services.fabrication.change(connector_mm=4.4)
    until(lambda: not trimmed.fabrication.export.isEnabled())
    assert "trimming again" in trimmed.fabrication.warnings.text() and trimmed.fabrication.summary.text() == ""
    qtbot.mouseClick(trimmed.stage.trim, LEFT)
    qtbot.mouseClick(trimmed.stage.trim, LEFT)
    until(lambda: not trimmed.services.chosen.trimming.busy)
    until(lambda: trimmed.fabrication.export.isEnabled() and "trimmed" in trimmed.fabrication.summary.text())


def test_that_another_choice_forgets_the_trim_that_was_on_its_way(
    studio: MainWindow, qtbot: QtBot, until: Until
) -> None:
    qtbot.mouseClick(studio.stage.trim, LEFT)
    studio.commands["next"].trigger()
    assert not studio.services.chosen.trimming.busy and not studio.stage.trim.isChecked()
    until(lambda: not studio.session.queue.busy)
    assert all(candidate.trim is None for candidate in studio.session.document.candidates)
    assert studio.session.document.chosen == 1


@pytest.mark.parametrize("way", ["button", "escape"])
def test_that_trimming_can_be_stopped(studio: MainWindow, qtbot: QtBot, until: Until, way: str) -> None:
    before = studio.session.document
    qtbot.mouseClick(studio.stage.trim, LEFT)
    if way == "button":
        qtbot.mouseClick(studio.stage.trim, LEFT)
    else:
        qtbot.keyClick(studio, Qt.Key.Key_Escape)
    assert not studio.services.chosen.trimming.busy and not studio.stage.trim.isChecked()
    until(lambda: not studio.session.queue.busy)
    assert studio.session.document is before and "stopped" in studio.status_text.text()
