"""Designs are called A1, A2, ... until a person renames them; a note stays with its design."""

from __future__ import annotations

from dataclasses import replace

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from kirigami_studio.gui.gallery.gallery_model import NAME_ROLE
from kirigami_studio.gui.gallery.label_editor import LabelEditor
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.pipeline.events import Result
from kirigami_studio.project.document import Document
from kirigami_studio.project.labels import Label


def opened(window: MainWindow) -> LabelEditor:
    """The editor of the chosen design, opened by its key."""
    QTest.keyClick(window, Qt.Key.Key_F2)
    QApplication.processEvents()
    editor = window.dialogs.label
    assert editor is not None and editor.isVisible()
    return editor


def type_into(editor: LabelEditor, text: str) -> None:
    editor.name.selectAll()
    QTest.keyClicks(editor.name, text)


def names(window: MainWindow) -> list[str]:
    model = window.gallery.view.model_
    return [model.data(model.index(row, 0), NAME_ROLE) for row in range(model.rowCount())]


def test_that_the_key_renames_the_chosen_design_on_card_stage_and_files(designed: MainWindow, files: object) -> None:
    assert names(designed) == ["A1", "A2", "A3"] and designed.stage.title.text() == "Design A1"
    editor = opened(designed)
    assert editor.name.text() == editor.name.selectedText() == "A1"
    type_into(editor, "Wide heart")
    editor.note.setPlainText("For the fair.")
    QTest.keyClick(editor.name, Qt.Key.Key_Return)
    assert designed.dialogs.label is None or not designed.dialogs.label.isVisible()
    assert names(designed) == ["Wide heart", "A2", "A3"] and designed.stage.title.text() == "Design Wide heart"
    assert designed.session.history.undo_label == "Rename design A1"
    tip = designed.gallery.view.model_.index(0, 0).data(Qt.ItemDataRole.ToolTipRole)
    assert "Design Wide heart:" in tip and "Note: For the fair." in tip
    designed.commands["export"].trigger()
    assert files.proposals == ["heart-Wide-heart.dxf"]  # type: ignore[attr-defined]
    designed.commands["undo"].trigger()
    assert names(designed)[0] == "A1" and designed.stage.title.text() == "Design A1"


def test_that_escape_leaves_name_and_note_as_they_were(designed: MainWindow, designs: Document) -> None:
    editor = opened(designed)
    type_into(editor, "Nothing")
    QTest.keyClick(editor.name, Qt.Key.Key_Escape)
    assert designed.session.document == designs and designed.session.history.undo_label is None


def test_that_a_click_elsewhere_keeps_what_was_typed(designed: MainWindow) -> None:
    editor = opened(designed)
    editor.note.setPlainText("Too thin at the top.")
    editor.close()  # as Qt does with a popup
    assert designed.session.document.labels[0] == Label("A1", "", "Too thin at the top.")
    assert designed.session.history.undo_label == "Note on design A1"


def test_that_a_name_that_is_taken_is_told_and_nothing_typed_is_lost(designed: MainWindow, designs: Document) -> None:
    editor = opened(designed)
    type_into(editor, "a3")
    QTest.keyClick(editor.name, Qt.Key.Key_Return)
    assert editor.isVisible() and editor.problem.text() == "Another design is already called a3."
    assert designed.session.document == designs and editor.name.text() == "a3"
    QTest.keyClick(editor.name, Qt.Key.Key_Escape)
    assert not editor.isVisible()


def test_that_every_run_draws_from_a_seed_of_its_own_unless_it_is_kept(designed: MainWindow) -> None:
    planner, document = designed.services.generation.planner, designed.session.document
    assert document.target is not None
    planner.keeps_seed = True
    assert {planner.anew(document.target).request.seed for _ in range(3)} == {document.settings.seed}
    planner.keeps_seed = False
    seeds = [planner.anew(document.target).request.seed for _ in range(3)]
    seeds += [planner.more(document.target).request.seed, planner.alike(document.target, 0.5).request.seed]
    assert len(set(seeds)) == 5, "also where earlier runs were stopped or undone"
    assert designed.session.document == document


@pytest.mark.parametrize(("apart", "told"), [(1.001, True), (4.0, False)])
def test_that_designs_that_came_too_near_are_told_with_the_way_out(
    designed: MainWindow, apart: float, told: bool
) -> None:
    session, planner = designed.session, designed.services.generation.planner
    before, origin = session.document, session.document.candidates[0]
    assert before.target is not None
    request = planner.alike(before.target, 0.9).request
    fields = [RatioField(origin.sheet.field.ratio * apart ** (-1.0) ** k * (1.0 + 0.002 * k)) for k in range(4)]
    found = tuple(replace(origin, seed=8, index=k, sheet=Sheet(field)) for k, field in enumerate(fields))
    result = Result(request, found, 4, 1.0)
    session.apply(planner.edit_for(result, {}, None))
    sentence = planner.summary(result, before)
    assert sentence.startswith("4 designs added") and ("4 look the same. Move the slider" in sentence) is told
