"""The three pages of the window: any time, any order; one primary button each; nothing jumps and nothing is lost."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from itertools import permutations
from pathlib import Path

import pytest
from maker_actions import begun
from PySide6.QtCore import QEvent, QPoint, QRect, QSettings, Qt
from PySide6.QtGui import QHelpEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu, QPushButton, QToolTip, QWidget
from pytestqt.qtbot import QtBot

from kirigami_studio.fabricate.machine import find_machine
from kirigami_studio.foundation.words import ShownUnit
from kirigami_studio.gui.make.cut_view import CutOverlay
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.session.queue import JobCallbacks
from kirigami_studio.gui.widgets.fitted_text import BRIEF, CONTROLS, TOOLTIP_LINE, wrapped
from kirigami_studio.gui.widgets.theme import LIGHT
from kirigami_studio.gui.window.application import create_window
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.studio.cutting import expected_seconds

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton
KEYS = {WindowPage.SHAPE: Qt.Key.Key_1, WindowPage.DESIGN: Qt.Key.Key_2, WindowPage.MAKE: Qt.Key.Key_3}


def on_page(window: MainWindow) -> dict[str, bool]:
    """Which panels are in sight."""
    names = ("target", "welcome", "settings", "run", "stage", "gallery", "fabrication", "cuts")
    return {name: getattr(window, name).isVisible() for name in names}


def test_that_a_window_begins_with_the_shape(qtbot: QtBot) -> None:
    window = create_window(LIGHT)
    assert window.pages.page is WindowPage.SHAPE and window.target.editing
    assert window.close()
    window.deleteLater()


def test_that_keys_and_the_bar_turn_the_pages_in_any_order(designed: MainWindow, qtbot: QtBot) -> None:
    shown = {
        WindowPage.SHAPE: {"target", "welcome", "run"},
        WindowPage.DESIGN: {"target", "settings", "run", "stage", "gallery"},
        WindowPage.MAKE: {"fabrication", "stage", "cuts"},
    }
    before = designed.session.document
    for number, order in enumerate(permutations(WindowPage)):
        for page in order:
            if number % 2:
                qtbot.keyClick(designed, KEYS[page])
            else:
                qtbot.mouseClick(designed.page_buttons[page], LEFT)
            assert designed.pages.page is page
            assert {name for name, visible in on_page(designed).items() if visible} == shown[page]
            checked = [one for one in WindowPage if designed.commands[f"page_{one.value}"].isChecked()]
            assert checked == [page]
    assert designed.session.document is before and not designed.session.history.unsaved


@pytest.mark.parametrize("page", WindowPage)
def test_that_each_page_has_one_primary_button(page: WindowPage, designed: MainWindow) -> None:
    designed.pages.turn(page)
    primary = [one for one in designed.findChildren(QPushButton) if one.objectName() == "primary" and one.isVisible()]
    assert len(primary) == 1


def test_that_stage_and_slider_stay_as_they_are_from_designing_to_making(designed: MainWindow) -> None:
    designed.stage.deployment.set_phi(1.0)
    designed.pages.turn(WindowPage.MAKE)
    stage = designed.stage
    assert stage.view.isVisible() and stage.deployment.slider.isVisible()
    assert stage.view.phi == pytest.approx(1.0, abs=2e-3) and stage.view.design is not None
    stage.deployment.set_phi(2.0)
    designed.pages.turn(WindowPage.DESIGN)
    assert stage.view.phi == pytest.approx(2.0, abs=2e-3)


def test_that_digits_are_typed_where_numbers_are(designed: MainWindow) -> None:
    field = designed.settings.rows
    field.setFocus()
    field.selectAll()
    for key in (Qt.Key.Key_1, Qt.Key.Key_2):
        QTest.keyClick(field, key)
    assert designed.pages.page is WindowPage.DESIGN and field.text() == "12"
    designed.pages.turn(WindowPage.MAKE)
    designed.cuts.view.gestures.select(frozenset({3}))
    designed.cuts.view.setFocus()
    QTest.keyClick(designed.cuts.view, Qt.Key.Key_1)
    assert designed.pages.page is WindowPage.MAKE and designed.cuts.hinges.width_mm.hasFocus()


def test_that_what_plays_and_what_is_compared_belong_to_their_page(designed: MainWindow) -> None:
    designed.commands["cuts"].trigger()
    assert designed.pages.player is designed.cuts.bar
    designed.cuts.bar.play.setChecked(True)
    designed.pages.turn(WindowPage.DESIGN)
    assert not designed.cuts.bar.playing and designed.pages.player is designed.stage.deployment
    designed.commands["compare"].trigger()
    assert designed.stage.comparing
    designed.pages.turn(WindowPage.MAKE)
    assert not designed.stage.comparing and designed.stage.view.isVisible()
    designed.commands["compare"].trigger()
    assert designed.pages.page is WindowPage.DESIGN and designed.stage.comparing
    designed.commands["all_designs"].trigger()
    assert designed.presenters.all_designs.shown
    designed.pages.turn(WindowPage.MAKE)
    assert not designed.presenters.all_designs.shown and designed.cuts.isVisible()
    designed.commands["all_designs"].trigger()
    assert designed.pages.page is WindowPage.DESIGN and designed.presenters.all_designs.shown


def test_that_the_board_opens_the_first_page_and_leaves_to_the_one_before(designed: MainWindow) -> None:
    for page in (WindowPage.DESIGN, WindowPage.MAKE):
        designed.pages.turn(page)
        designed.commands["edit_target"].trigger()
        assert designed.pages.page is WindowPage.SHAPE and designed.target.editing
        QTest.keyClick(designed.target.view, Qt.Key.Key_Escape)
        assert designed.pages.page is page and not designed.target.editing


def test_that_moved_borders_are_those_of_their_page_and_last(designed: MainWindow, tmp_path: Path) -> None:
    designed.resize(1440, 900)
    designed.pages.turn(WindowPage.MAKE)
    designed.pages.splitter.setSizes([400, 500, 500])
    designed.pages.splitter.splitterMoved.emit(400, 1)
    moved = designed.pages.splitter.sizes()
    designed.pages.turn(WindowPage.DESIGN)
    assert designed.pages.splitter.sizes()[0] < moved[0] - 20
    state = QSettings(str(tmp_path / "state.ini"), QSettings.Format.IniFormat)
    designed.remember(state)
    state.sync()
    again = create_window(LIGHT)
    again.restore(QSettings(str(tmp_path / "state.ini"), QSettings.Format.IniFormat))
    again.resize(1440, 900)
    again.show()
    again.pages.turn(WindowPage.MAKE)
    assert again.pages.splitter.sizes()[0] == pytest.approx(moved[0], abs=8)
    assert again.close()
    again.deleteLater()


@pytest.fixture
def stuck(heart: MainWindow, monkeypatch: pytest.MonkeyPatch) -> Iterator[MainWindow]:
    """A studio whose worker is busy for two seconds, as it is while it loads the generator."""

    def loading(cancelled: Callable[[], bool]) -> Iterator[None]:
        time.sleep(2.0)
        yield

    heart.session.queue.start("loading", loading, JobCallbacks())
    yield heart


def places(window: MainWindow) -> dict[QWidget, QRect]:
    parts = (window.target, window.settings, window.stage, window.gallery, window.run, window.settings.regular)
    return {part: QRect(part.mapTo(window, QPoint(0, 0)), part.size()) for part in parts}


def test_that_nothing_jumps_when_a_run_begins_and_cancel_answers_while_the_worker_is_busy(
    stuck: MainWindow, qtbot: QtBot
) -> None:
    QApplication.processEvents()
    before, document = places(stuck), stuck.session.document
    qtbot.mouseClick(stuck.run.generate, LEFT)
    QApplication.processEvents()
    assert stuck.services.run.running and stuck.run.stop.isVisible() and places(stuck) == before
    qtbot.mouseClick(stuck.run.stop, LEFT)
    assert not stuck.services.run.running and not stuck.run.stop.isVisible() and stuck.run.generate.isEnabled()
    assert stuck.session.queue.busy, "the worker is not waited for"
    assert places(stuck) == before and stuck.session.document is document
    assert "stopped" in stuck.status_text.text()


def test_that_a_run_goes_to_the_designs_and_shows_their_target(heart: MainWindow) -> None:
    heart.pages.turn(WindowPage.SHAPE)
    heart.commands["generate"].trigger()
    assert heart.pages.page is WindowPage.DESIGN and heart.stage.view.design is None
    bounds, target = heart.stage.view.scene_bounds(), heart.session.document.target
    assert bounds is not None and target is not None
    assert (bounds.left, bounds.right) == pytest.approx((target.points[:, 0].min(), target.points[:, 0].max()))
    heart.commands["cancel"].trigger()
    assert not heart.services.run.running


@pytest.mark.torch
def test_that_a_heart_in_film_is_a_file_after_three_actions(
    window: MainWindow, until: Until, files: object, tmp_path: Path
) -> None:
    maker = begun(window, until, tmp_path)
    files.answer = tmp_path / "heart.dxf"  # type: ignore[attr-defined]
    maker.click(window.run.generate)
    until(lambda: window.fabrication.export.isEnabled() and not window.services.run.running)
    maker.click(window.page_buttons[WindowPage.MAKE])
    maker.click(window.fabrication.export)
    until((tmp_path / "heart.dxf").exists)
    assert maker.actions == 3


@pytest.mark.torch
def test_that_a_heart_in_plywood_is_files_after_four_actions(
    window: MainWindow, until: Until, files: object, tmp_path: Path
) -> None:
    maker = begun(window, until, tmp_path)
    files.answer = tmp_path / "heart.lbrn2"  # type: ignore[attr-defined]
    maker.line("diode-10w")
    maker.line("plywood-co2")
    maker.press("Ctrl+G")
    until(lambda: window.fabrication.export.isEnabled() and not window.services.run.running)
    maker.press("Ctrl+E")
    until(lambda: any(tmp_path.rglob("layer-1*")))
    assert maker.actions == 4
    assert files.to_folders == [True], "the question for a place says that it is one of several files"  # type: ignore[attr-defined]


def test_that_the_sheet_is_shown_on_the_bed_of_its_machine(designed: MainWindow) -> None:
    designed.services.fabrication.change(machine="k40", material="card-co2")
    designed.pages.turn(WindowPage.MAKE)
    cuts = designed.cuts
    alone = cuts.view.scene_bounds()
    cuts.toggles[CutOverlay.BED].click()
    bounds = cuts.view.scene_bounds()
    width, height = find_machine("k40").reach_mm
    assert alone is not None and bounds is not None
    assert (bounds.right, bounds.top) == pytest.approx((width, height), abs=1e-6) and bounds.right > alone.right
    assert any(f"{width:.0f}" in chip.text for chip in cuts.view._chips())


def test_that_a_success_goes_by_itself_and_a_warning_stays(designed: MainWindow) -> None:
    bar = designed.messages
    bar.dismiss(*Tone)
    bar.add(Message("Careful.", Tone.WARNING))
    assert not bar._fading.isActive()
    bar.add(Message("Exported heart.dxf.", Tone.DONE))
    assert bar._fading.isActive()
    bar._fading.timeout.emit()
    assert [one.sentence for one in bar.messages] == ["Careful."] and not bar._fading.isActive()


def test_that_tooltips_of_controls_are_two_short_lines(designed: MainWindow) -> None:
    controls = [one for one in designed.findChildren(QWidget) if isinstance(one, CONTROLS) and one.toolTip()]
    assert len(controls) > 60
    for control in controls:
        # Machine and material add notes from their files, of which two lines are shown.
        noted = control.objectName() in ("machine", "material")
        lines = wrapped(control.toolTip(), BRIEF if noted else None).split("\n")
        assert len(lines) <= 2 and max(map(len, lines)) <= TOOLTIP_LINE + 2, control.objectName()
    for control in (designed.settings.auto, designed.page_buttons[WindowPage.MAKE]):
        control.setToolTip("word " * 200)
        event = QHelpEvent(QEvent.Type.ToolTip, QPoint(4, 4), control.mapToGlobal(QPoint(4, 4)))
        QApplication.sendEvent(control, event)
        assert 0 < max(map(len, QToolTip.text().split("\n"))) <= TOOLTIP_LINE
        QToolTip.hideText()


def test_that_no_menu_is_higher_than_a_small_screen(designed: MainWindow) -> None:
    menus = [menu for menu in designed.menuBar().findChildren(QMenu) if menu.actions()]
    assert len(menus) > 8
    for menu in menus:
        assert menu.sizeHint().height() <= 720, menu.title()


@pytest.fixture
def millimetres_afterwards() -> Iterator[None]:
    """Show millimetres in the windows of other tests."""
    yield
    ShownUnit.inches = False


@pytest.mark.usefixtures("millimetres_afterwards")
def test_that_one_switch_shows_and_reads_inches_in_all_fields(designed: MainWindow, tmp_path: Path) -> None:
    designed.services.preferences.use(tmp_path / "preferences.toml")
    connector, width = designed.fabrication.lengths["connector_mm"], designed.target.refine.width_
    before, plain = connector.value(), (connector.text(), width.text())
    designed.commands["inches"].trigger()
    assert designed.commands["inches"].isChecked() and "in" in (tmp_path / "preferences.toml").read_text("utf-8")
    assert connector.text() == f'{before / 25.4:.4f}"' and width.text().endswith(" in")
    assert connector.value() == before and designed.session.document.fabrication.connector_mm is None
    flat = designed.fabrication.lengths["width_mm"]
    for typed, millimetres in (("5", 127.0), ("100 mm", 100.0), ("4", 101.6)):
        flat.setFocus()
        flat.selectAll()
        QTest.keyClicks(flat, typed)
        QTest.keyClick(flat, Qt.Key.Key_Return)
        assert flat.value() == pytest.approx(millimetres)
    designed.commands["inches"].trigger()
    assert (connector.text(), width.text().endswith(" mm")) == (plain[0], True)


def test_that_a_note_that_undo_answers_too_goes_by_itself_and_a_question_stays(designed: MainWindow) -> None:
    """Before, the note on designs of an old target lay over the header until it was closed."""
    bar = designed.messages
    bar.dismiss(*Tone)
    designed.services.targeting.clear()
    (said,) = [one for one in bar.messages if one.actions]
    assert said.passing and bar._fading.isActive()
    designed.services.project.undo()
    bar.add(Message("Keep these designs?", actions=(("Keep", lambda: None),)))
    assert not bar._fading.isActive()


def test_that_the_slider_stays_where_it_is_when_designs_and_their_verdict_come(
    heart: MainWindow, project_file: Path, until: Callable[[Callable[[], bool]], None]
) -> None:
    """Before, the first design moved it by the line below it, and the first verdict by 60 pixels more."""
    heart.resize(1440, 900)
    QApplication.processEvents()
    slider, verdict = heart.stage.deployment.slider, heart.services.verdict
    before = slider.mapTo(heart, QPoint(0, 0)).y()
    heart.services.project.open(project_file)
    until(lambda: heart.session.stage is not None and verdict.state.known)
    QApplication.processEvents()
    assert heart.stage.verdict.isVisible() and slider.mapTo(heart, QPoint(0, 0)).y() == before


def test_that_a_run_is_offered_on_the_page_make_where_there_is_nothing_to_cut(
    heart: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before, the page asked for a button that it did not have."""
    heart.pages.turn(WindowPage.MAKE)
    button, begun = heart.cuts.generate, []
    assert button.isVisible()
    monkeypatch.setattr(type(heart.services.run), "start", lambda *_: begun.append("run"))
    button.click()
    assert begun == ["run"]
    heart.services.targeting.clear()
    assert not button.isVisible()


def test_that_hours_of_cutting_are_told_before_the_run(heart: MainWindow) -> None:
    """Before, a laser of 10 W that takes hours for plywood said so after the run."""
    services, label = heart.services, heart.target.cutting
    assert label.isHidden(), "film takes minutes"
    services.fabrication.change(machine="diode-10w", material="plywood-co2", width_mm=380.0)
    expected = expected_seconds(services.session.document.fabrication)
    assert 5.0 < expected / 3600.0 < 10.0 and not label.isHidden() and label.toolTip()
    services.fabrication.change(width_mm=60.0)
    assert label.isHidden()


def test_that_a_size_too_small_for_the_connectors_is_told_before_the_run(heart: MainWindow) -> None:
    """Before, a logo of 92 mm in card was refused after the run: its sheet was to be made 1.6 times wider."""
    services, label = heart.services, heart.target.cutting
    services.settings.change(auto_grid=False)
    services.settings.change(grid=(16, 13))
    services.fabrication.change(machine="cricut-explore", material="card-co2", width_mm=64.8)
    assert not label.isHidden() and "1" in label.toolTip() and str(16) in label.toolTip()
    services.fabrication.change(width_mm=160.0)
    assert label.isHidden()
    services.settings.change(grid=(60, 60))
    assert not label.isHidden(), "it follows the grid"
