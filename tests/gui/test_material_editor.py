"""Own materials: copied, changed, calibrated and deleted beside the window; the plan follows."""

from __future__ import annotations

from collections.abc import Callable
from datetime import date
from pathlib import Path

import ezdxf
import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QDoubleSpinBox
from pytestqt.qtbot import QtBot

from kirigami_studio.fabricate.coupon import kerf_from_gaps
from kirigami_studio.fabricate.material import library, presets
from kirigami_studio.gui.make.material_form import NUMBERS, MaterialForm
from kirigami_studio.gui.make.shelf_editors import MaterialEditor
from kirigami_studio.gui.window.main_window import MainWindow

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def editor(designed: MainWindow, qtbot: QtBot) -> MaterialEditor:
    qtbot.mouseClick(designed.fabrication.edit_materials, LEFT)
    made = designed.dialogs.materials
    assert made is not None and made.isVisible() and not made.isModal()
    return made


def press(editor: MaterialEditor, qtbot: QtBot, name: str) -> None:
    assert editor.buttons[name].isEnabled(), name
    qtbot.mouseClick(editor.buttons[name], LEFT)


def test_that_a_preset_can_be_copied_but_not_changed(editor: MaterialEditor, qtbot: QtBot, own_materials: Path) -> None:
    assert editor.chosen.key == "film-uv" and not editor.form.numbers["kerf_mm"].isEnabled()
    assert not editor.buttons["save"].isEnabled() and not editor.buttons["delete"].isEnabled()
    press(editor, qtbot, "copy")
    assert editor.chosen.key == "film-uv-2" and editor.form.numbers["kerf_mm"].isEnabled()
    assert [path.name for path in own_materials.iterdir()] == ["film-uv-2.toml"]
    assert presets()["film-uv"] == library().items["film-uv"]


@pytest.mark.usefixtures("german")
def test_that_a_german_window_tells_of_presets_in_german(editor: MaterialEditor, designed: MainWindow) -> None:
    english = editor.chosen.note
    assert editor.form.texts["note"].text().startswith("Schnittfuge nach") and english.startswith("Kerf from")
    assert editor.form.changes() == {}
    assert "Schnittfuge nach" in designed.fabrication.material.toolTip()


def test_that_saved_numbers_reach_the_plan(
    designed: MainWindow, editor: MaterialEditor, qtbot: QtBot, until: Until
) -> None:
    press(editor, qtbot, "copy")
    designed.services.fabrication.change(material="film-uv-2", connector_mm=None, kerf_mm=None)
    editor.form.numbers["connector_mm"].setValue(0.44)
    press(editor, qtbot, "save")
    assert library().items["film-uv-2"].connector_mm == 0.44 and not editor.buttons["save"].isEnabled()
    until(lambda: designed.fabrication.numbers["ligament"].text() == "0.44 mm")
    assert designed.fabrication.lengths["connector_mm"].value() == 0.44
    assert designed.fabrication.material.currentText().endswith("(copy)")


def test_that_a_material_is_calibrated_by_somebody_and_uncalibrated_by_new_numbers(
    editor: MaterialEditor, qtbot: QtBot
) -> None:
    press(editor, qtbot, "copy")
    assert not editor.buttons["calibrate"].isEnabled()
    editor.author.setText("Ada")
    editor.form.numbers["kerf_mm"].setValue(0.031)
    press(editor, qtbot, "calibrate")
    kept = library().items["film-uv-2"]
    assert kept.calibrated and kept.kerf_mm == 0.031 and kept.measured_by == "Ada"
    assert kept.measured_on == date.today().isoformat() and "Calibrated on" in editor.about.text()
    editor.form.texts["name"].setText("My film")
    editor.form.texts["name"].textEdited.emit("My film")
    press(editor, qtbot, "save")
    assert library().items["film-uv-2"].calibrated and library().items["film-uv-2"].name == "My film"
    editor.form.numbers["kerf_mm"].setValue(0.05)
    press(editor, qtbot, "save")
    assert not library().items["film-uv-2"].calibrated


def test_that_a_deleted_material_that_is_in_use_is_told(
    designed: MainWindow, editor: MaterialEditor, qtbot: QtBot, until: Until, own_materials: Path
) -> None:
    press(editor, qtbot, "copy")
    designed.services.fabrication.change(material="film-uv-2")
    until(designed.fabrication.export.isEnabled)
    press(editor, qtbot, "delete")
    assert list(own_materials.iterdir()) == [] and editor.chosen.key == "film-uv"
    until(lambda: not designed.fabrication.export.isEnabled())
    assert "film-uv-2" in designed.fabrication.warnings.text()


def test_that_what_the_library_refuses_is_said_in_the_editor(editor: MaterialEditor, qtbot: QtBot) -> None:
    press(editor, qtbot, "copy")
    editor.form.texts["name"].setText("x")
    editor.author.setText("   ")
    editor.attempt(editor.calibrate)
    assert "author" in editor.status.text()


def test_that_the_coupon_is_written_and_reported(
    designed: MainWindow, editor: MaterialEditor, files: object, qtbot: QtBot, until: Until, tmp_path: Path
) -> None:
    files.answer = tmp_path / "coupon.dxf"  # type: ignore[attr-defined]
    press(editor, qtbot, "coupon")
    until(lambda: designed.dialogs.report is not None)
    assert files.proposals == ["coupon-film-uv.dxf"]  # type: ignore[attr-defined]
    assert designed.dialogs.report is not None and designed.dialogs.report.shown.ok
    assert len(ezdxf.readfile(tmp_path / "coupon.dxf").modelspace()) > 20


def test_that_a_form_that_nobody_touched_changes_nothing(qtbot: QtBot) -> None:
    form = MaterialForm()
    qtbot.addWidget(form)
    for material in presets().values():
        form.show_value(material, editable=True)
        assert form.changes() == {}, material.key
    form.numbers["break_strain"].setValue(12.5)
    assert form.changes() == {"break_strain": 0.125}


def test_that_every_number_says_its_unit(editor: MaterialEditor) -> None:
    for name in NUMBERS:
        box, unit = editor.form.numbers[name], editor.form.fields.settings[name].setting.unit
        assert isinstance(box, QDoubleSpinBox) and unit
        assert box.suffix() == f" {unit}" and unit in box.toolTip() and unit in box.accessibleName()


def test_that_a_measured_coupon_sets_the_kerf(editor: MaterialEditor, qtbot: QtBot) -> None:
    assert not editor.gaps.gaps.isEnabled(), "a preset cannot be changed"
    press(editor, qtbot, "copy")
    qtbot.keyClicks(editor.gaps.gaps, "0.29 0,31")
    qtbot.mouseClick(editor.gaps.button, LEFT)
    expected = kerf_from_gaps([0.29, 0.31])
    assert f"{expected.kerf_mm:.3f}" in editor.status.text() and f"{expected.doubt_mm:.3f}" in editor.status.text()
    press(editor, qtbot, "save")
    assert library().items[editor.chosen.key].kerf_mm == pytest.approx(expected.kerf_mm, abs=5e-4)


@pytest.mark.parametrize(("typed", "said"), [("wide", "gaps in mm"), ("-1", "gap beside the comb")])
def test_that_a_gap_that_cannot_be_is_a_sentence(editor: MaterialEditor, qtbot: QtBot, typed: str, said: str) -> None:
    press(editor, qtbot, "copy")
    before = editor.form.numbers["kerf_mm"].value()
    qtbot.keyClicks(editor.gaps.gaps, typed)
    qtbot.keyClick(editor.gaps.gaps, Qt.Key.Key_Return)
    assert said in editor.status.text() and editor.form.numbers["kerf_mm"].value() == before
