"""The folded options: each a document edit that undoes and is saved."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QComboBox, QWidget
from pytestqt.qtbot import QtBot

from kirigami_studio.export.profile import PROFILES
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions, CutOrder
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.project import store
from kirigami_studio.settings.fabrication import FabricationSettings

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton


def pick(box: QComboBox, value: object) -> None:
    """Choose an entry as a person does."""
    index = next(row for row in range(box.count()) if box.itemData(row) == value)
    box.setCurrentIndex(index)
    box.activated.emit(index)


@pytest.fixture
def options(designed: MainWindow) -> MainWindow:
    designed.resize(1440, 1000)
    designed.pages.turn(WindowPage.MAKE)
    return designed


def test_that_all_options_are_in_sight_on_the_page_of_making(designed: MainWindow, qtbot: QtBot) -> None:
    designed.resize(1440, 1000)
    panel = designed.fabrication.options
    assert not panel.style_.isVisible()
    qtbot.keyClick(designed, Qt.Key.Key_3)
    assert panel.style_.isVisible() and panel.profile.isVisible() and panel.copies.isVisible()


def test_that_every_style_order_and_profile_is_on_offer(options: MainWindow) -> None:
    panel = options.fabrication.options
    for box, choices in ((panel.style_, ConnectorStyle), (panel.order, CutOrder)):
        assert {box.itemData(row) for row in range(box.count())} == set(choices)
    assert [panel.profile.itemData(row) for row in range(panel.profile.count())] == list(PROFILES)


def test_that_pieces_on_pins_are_asked_for_no_connectors_and_tabs(options: MainWindow) -> None:
    panel = options.fabrication.options
    of_sheets = (panel.style_, panel.tabs, panel.tab_mm)
    options.services.fabrication.change(material="plywood-co2")
    assert not any(field.isVisible() for field in of_sheets)
    assert panel.order.isVisible() and panel.dxf_version.isVisible(), "files of pieces have both"
    options.services.fabrication.change(material="card-co2")
    assert all(field.isVisible() for field in of_sheets)
    assert panel.style_.isEnabled() and not panel.tab_mm.isEnabled(), "no tabs, no length of them"


@pytest.mark.parametrize(
    ("name", "value"),
    [("style_", ConnectorStyle.TEARDROP), ("order", CutOrder.SPREAD), ("profile", "lightburn"), ("dxf_version", "R12")],
)
def test_that_each_choice_is_one_undo_step(options: MainWindow, name: str, value: object) -> None:
    box = getattr(options.fabrication.options, name)
    before = options.session.document.fabrication
    pick(box, value)
    after = options.session.document.fabrication
    assert value in (after.options.style, after.options.order, after.profile, after.dxf_version)
    options.commands["undo"].trigger()
    assert options.session.document.fabrication == before and box.currentData() != value


def test_that_dragging_the_tabs_is_one_undo_step(options: MainWindow) -> None:
    panel = options.fabrication.options
    assert not panel.tab_mm.isEnabled()
    for count in (1, 2, 4):
        panel.tabs.setValue(count)
    assert options.session.document.fabrication.options.tabs == 4 and panel.tab_mm.isEnabled()
    options.commands["undo"].trigger()
    assert panel.tabs.value() == 0


def test_that_the_choices_are_saved_with_the_project(options: MainWindow, until: Until, tmp_path: Path) -> None:
    pick(options.fabrication.options.style_, ConnectorStyle.ROUND)
    pick(options.fabrication.options.profile, "lightburn")
    options.fabrication.options.tabs.setValue(3)
    options.services.project.save(tmp_path / "options.kiri")
    until(lambda: not options.session.history.unsaved)
    kept = store.load(tmp_path / "options.kiri").fabrication
    assert kept.options == CutOptions(style=ConnectorStyle.ROUND, tabs=3) and kept.profile == "lightburn"


def test_that_a_profile_of_a_newer_program_is_shown_by_its_key(options: MainWindow) -> None:
    panel = options.fabrication.options
    panel.show_settings(FabricationSettings(profile="waterjet"))
    assert panel.profile.currentText() == "waterjet"


def test_that_every_control_has_a_name_and_a_tooltip(options: MainWindow) -> None:
    page = options.cuts
    parts: list[QWidget] = [
        *options.fabrication.options.findChildren(QComboBox),
        options.fabrication.options.tabs,
        options.fabrication.options.tab_mm,
        options.fabrication.options.copies,
        options.fabrication.options.copy_gap,
        *page.toggles.values(),
        page.hinges.rules,
        page.hinges.width_mm,
        page.hinges.remove,
        page.hinges.reset,
        page.bar.play,
        page.bar.slider,
    ]
    assert len(parts) == 25
    for part in parts:
        assert part.accessibleName() and part.toolTip(), part.objectName()
    for length in (options.fabrication.options.tab_mm, page.hinges.width_mm):
        assert "mm" in length.toolTip() and "millimetres" in length.accessibleName()


def test_that_a_short_window_scrolls_the_options_instead_of_squeezing_them(options: MainWindow, qtbot: QtBot) -> None:
    options.resize(1280, 720)
    panel = options.fabrication
    qtbot.waitUntil(lambda: panel.scrolled.verticalScrollBar().maximum() > 0)
    assert panel.options.style_.height() >= panel.options.style_.sizeHint().height() - 1
    assert panel.export.isVisible() and options.cuts.view.height() > 100


def test_that_copies_are_an_undo_step_fill_the_file_and_are_saved(
    options: MainWindow, until: Until, files: object, tmp_path: Path, qtbot: QtBot
) -> None:
    panel, services = options.fabrication.options, options.services
    assert panel.copies.value() == 1 and not panel.copy_gap.isEnabled()
    until(lambda: options.fabrication.numbers["pieces"].text() == "1")
    cuts = int(options.fabrication.numbers["slits"].text())
    panel.copies.setValue(3)
    until(lambda: options.fabrication.numbers["pieces"].text() == "3")
    assert options.commands["undo"].text() == "&Undo: Change the number of copies"
    assert int(options.fabrication.numbers["slits"].text()) == 3 * cuts
    assert panel.rows.text().startswith("3 copies") and "3 copies in the file" in panel.rows.toolTip()
    assert panel.copy_gap.isEnabled()
    bounds = options.cuts.view.scene_bounds()
    assert bounds is not None and bounds.right > 200.0 and bounds.top > 160.0
    with qtbot.waitSignal(services.exporter.exported, timeout=30_000) as written:
        services.exporter.export(tmp_path / "three.dxf")
    (verification,) = written.args[0].verifications
    assert verification.ok and verification.pieces == 3
    with qtbot.waitSignal(services.project.saved, timeout=30_000):
        services.project.save(tmp_path / "three.kiri")
    assert store.load(tmp_path / "three.kiri").fabrication.options.copies == 3
    options.commands["undo"].trigger()
    assert services.session.document.fabrication.options.copies == 1
    until(lambda: options.fabrication.numbers["pieces"].text() == "1")
    assert panel.rows.text() == ""


def test_that_as_many_copies_as_fit_follow_the_bed_and_the_sheet_is_not_closed_again(
    options: MainWindow, until: Until
) -> None:
    until(lambda: options.services.as_cut.state.sheet is not None)
    before = options.services.as_cut.state.sheet
    panel = options.fabrication.options
    panel.copies.setValue(0)
    assert panel.copies.text() == "Fit bed"
    until(lambda: panel.rows.text() != "")
    fitting = int(options.fabrication.numbers["pieces"].text())
    assert fitting > 1
    panel.copy_gap.setValue(120.0)
    until(lambda: int(options.fabrication.numbers["pieces"].text()) < fitting)
    panel.copy_gap.setValue(5.0)
    panel.copies.setValue(200)
    until(lambda: "copies" in options.fabrication.warnings.toolTip())
    assert "Of 200 copies" in options.fabrication.warnings.toolTip()
    until(lambda: not options.services.as_cut.state.busy)
    assert options.services.as_cut.state.sheet is before
