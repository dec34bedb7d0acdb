"""Machines in the window: chosen before the material, which they decide; copied, changed and deleted beside it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QComboBox, QDoubleSpinBox
from pytestqt.qtbot import QtBot

from kirigami_studio.fabricate.machine import cuttable, find_machine, machines
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.make.shelf_editors import NUMBERS, MachineEditor
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.studio.making import Planned

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton


def keys(box: QComboBox) -> list[str]:
    return [box.itemData(row) for row in range(box.count())]


def pick(box: QComboBox, key: str) -> None:
    """Choose an entry as a click in the list does."""
    box.setCurrentIndex(box.findData(key))
    box.activated.emit(box.currentIndex())


def names(box: QComboBox) -> list[str]:
    return [box.itemText(row).casefold() for row in range(box.count())]


def too_large(made: Planned) -> bool:
    """Whether the sheet is larger than a bed of 60 mm."""
    codes = [problem.code for problem in made.report.problems]
    return made.plan.machine.reach_mm == (60.0, 60.0) and "plan.larger_than_bed" in codes


@pytest.fixture
def editor(designed: MainWindow, qtbot: QtBot) -> MachineEditor:
    pick(designed.fabrication.machine, "co2-laser")
    qtbot.mouseClick(designed.fabrication.edit_machines, LEFT)
    made = designed.findChild(MachineEditor)
    assert made is not None and made.isVisible() and not made.isModal()
    return made


def test_that_without_a_machine_every_material_is_offered_in_the_order_of_names(designed: MainWindow) -> None:
    panel = designed.fabrication
    assert panel.machine.currentData() == "" and keys(panel.machine)[1:] != []
    assert len(keys(panel.material)) >= 12 and names(panel.material) == sorted(names(panel.material))
    assert names(panel.machine)[1:] == sorted(names(panel.machine)[1:])


def test_that_a_machine_decides_materials_profile_and_file(designed: MainWindow) -> None:
    panel, services = designed.fabrication, designed.services
    pick(panel.machine, "cricut-maker")
    cut = services.session.document.fabrication
    assert (cut.machine, cut.material, cut.profile) == ("cricut-maker", "drag-knife", "cricut")
    assert set(keys(panel.material)) == set(cuttable(find_machine("cricut-maker")))
    assert panel.material.currentData() == "drag-knife" and names(panel.material) == sorted(names(panel.material))
    assert panel.exports.extension == ".svg" and panel.export.text() == tr("Export SVG")
    pick(panel.material, "card-co2")
    assert panel.material.currentText() == "Card 0.3 mm, drag knife" and panel.lengths["kerf_mm"].value() == 0.0
    services.project.undo()
    services.project.undo()
    assert services.session.document.fabrication.machine == "" and panel.machine.currentData() == ""


def test_that_a_material_that_the_new_machine_cuts_stays(designed: MainWindow) -> None:
    panel, services = designed.fabrication, designed.services
    pick(panel.material, "card-co2")
    pick(panel.machine, "xtool-s1")
    assert services.session.document.fabrication.material == "card-co2" and panel.lengths["kerf_mm"].value() == 0.15
    pick(panel.machine, "")
    assert services.session.document.fabrication.machine == "" and len(keys(panel.material)) >= 12


def test_that_a_bundled_machine_is_copied_changed_and_reaches_the_plan(
    designed: MainWindow, editor: MachineEditor, qtbot: QtBot, until: Until, own_machines: Path
) -> None:
    assert editor.chosen.key == "co2-laser" and not editor.form.numbers["bed_width_mm"].isEnabled()
    qtbot.mouseClick(editor.buttons["copy"], LEFT)
    assert [path.name for path in own_machines.iterdir()] == ["co2-laser-2.toml"]
    pick(designed.fabrication.machine, "co2-laser-2")
    until(lambda: designed.fabrication.export.isEnabled())
    seen: list[object] = []
    designed.services.cutting.planned.connect(seen.append)
    editor.form.numbers["bed_width_mm"].setValue(60.0)
    editor.form.numbers["bed_height_mm"].setValue(60.0)
    qtbot.mouseClick(editor.buttons["save"], LEFT)
    assert machines().items["co2-laser-2"].reach_mm == (60.0, 60.0) and not editor.buttons["save"].isEnabled()
    until(lambda: any(isinstance(one, Planned) and too_large(one) for one in seen))
    qtbot.mouseClick(editor.buttons["delete"], LEFT)
    assert machines().own == frozenset() and list(own_machines.iterdir()) == []


def test_that_an_untouched_form_changes_nothing_and_every_number_says_its_unit(editor: MachineEditor) -> None:
    for machine in machines().items.values():
        editor.form.show_value(machine, editable=True)
        assert editor.form.changes() == {}, machine.key
    for name in NUMBERS:
        box, unit = editor.form.numbers[name], editor.form.fields.settings[name].setting.unit
        assert isinstance(box, QDoubleSpinBox) and box.suffix() == f" {unit}" and unit in box.accessibleName()


@pytest.mark.usefixtures("german")
def test_that_a_german_window_names_machines_and_what_they_cut_in_german(designed: MainWindow) -> None:
    panel = designed.fabrication
    pick(panel.machine, "diode-10w")
    assert panel.machine.currentText() == "Diodenlaser, 10 W"
    assert "Karton 0,3 mm, Diodenlaser" in [panel.material.itemText(row) for row in range(panel.material.count())]
    assert names(panel.material) == sorted(names(panel.material))
