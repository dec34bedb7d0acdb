"""The page of an empty stage: a sheet that moves, ways to begin, first steps, and one question."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import Qt, QTimer
from PySide6.QtWidgets import QApplication, QLabel, QProxyStyle, QStyle, QWidget
from pytestqt.qtbot import QtBot

from kirigami_studio.fabricate.machine import MachineKind, cuttable, find_machine
from kirigami_studio.gui.make.machine_question import KINDS, CuttingQuestion
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.welcome_page import OFFERS, STEPS, moves
from kirigami_studio.project import preferences
from kirigami_studio.project.preferences import Preferences

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton


class Motionless(QProxyStyle):
    """A desktop whose animations are off."""

    def styleHint(self, hint: QStyle.StyleHint, *rest: object) -> int:  # type: ignore[override]  # noqa: N802
        return 0 if hint is QStyle.StyleHint.SH_Widget_Animate else super().styleHint(hint, *rest)  # type: ignore[arg-type]


@pytest.fixture
def begun(window: MainWindow, until: Until, tmp_path: Path) -> MainWindow:
    """The first start, with the heart and its sample."""
    window.services.preferences.use(tmp_path / "preferences.toml")
    window.services.targeting.start_with("heart")
    window.presenters.welcome.begin()
    until(lambda: window.stage.welcome.ready and window.session.document.target is not None)
    return window


def answer(question: CuttingQuestion, machine: str, material: str) -> None:
    """Choose a machine and a material in the menus."""
    found = find_machine(machine)
    menu = question.buttons[found.kind].menu()
    inner = [action.menu() for action in menu.actions() if action.text() == found.name]
    offered = (inner[0] if inner else menu).actions()
    next(action for action in offered if action.text() == cuttable(found)[material].name).trigger()


def test_that_the_sample_moves_until_the_user_acts(begun: MainWindow, qtbot: QtBot, until: Until) -> None:
    empty = begun.stage.welcome
    assert empty.isVisible() and empty.moving and not begun.stage.split.isVisible()
    before = empty.view.phi
    until(lambda: empty.view.phi != before)
    qtbot.mouseClick(begun.target, LEFT)
    assert not empty.moving and empty.isVisible()
    stood = empty.view.phi
    QApplication.processEvents()
    assert empty.view.phi == stood
    assert begun.session.stage is None and begun.session.document.candidates == ()  # it is no design


def test_that_the_sample_stands_still_where_motion_is_reduced(begun: MainWindow, tmp_path: Path) -> None:
    begun.commands["still"].trigger()
    assert not begun.stage.welcome.moving and begun.commands["still"].isChecked()
    assert preferences.load(tmp_path / "preferences.toml").motion == "still"
    begun.commands["still"].trigger()
    assert begun.stage.welcome.moving and not begun.commands["still"].isChecked()
    style = Motionless()
    assert not moves("system", style) and moves("system", begun.style()) and not moves("still", begun.style())


def test_that_the_sample_gives_way_to_a_design_and_comes_back_without_one(
    begun: MainWindow, project_file: Path, until: Until
) -> None:
    stage = begun.stage
    begun.services.project.open(project_file)
    until(lambda: begun.session.stage is not None)
    assert stage.split.isVisible() and not stage.welcome.isVisible() and not stage.welcome.moving
    until(lambda: begun.fabrication.export.isEnabled())
    begun.services.project.new()
    until(lambda: begun.session.stage is None)
    assert stage.welcome.isVisible() and "target" in stage.welcome.hint.text().lower() + stage.welcome.headline.text()


@pytest.mark.parametrize("key", ["paper-hand", "card-co2"])
def test_that_the_question_is_asked_once_and_its_answer_holds_for_new_projects(
    key: str, begun: MainWindow, qtbot: QtBot, tmp_path: Path
) -> None:
    question = begun.stage.welcome.question
    assert question.isVisible() and list(question.buttons) == [kind for kind, _, _ in KINDS]
    answer(question, "hand" if key == "paper-hand" else "co2-laser", key)
    assert not question.isVisible()
    kept = preferences.load(tmp_path / "preferences.toml")
    assert kept.machine_asked and kept.material == key
    fabrication = begun.session.document.fabrication
    assert fabrication.machine == kept.machine == ("hand" if key == "paper-hand" else "co2-laser")
    assert fabrication.material == key and not begun.session.history.unsaved
    assert begun.fabrication.material.currentData() == key
    by_hand = key == "paper-hand"
    assert (fabrication.paper in ("a4", "letter")) is by_hand
    assert begun.fabrication.export.text() == ("Export PDF" if by_hand else "Export for LightBurn")
    begun.services.project.new()
    assert begun.session.document.fabrication.material == key
    begun.presenters.welcome.begin()
    assert not question.isVisible()


def test_that_declining_is_an_answer_too(begun: MainWindow, qtbot: QtBot, tmp_path: Path) -> None:
    qtbot.mouseClick(begun.stage.welcome.question.later, LEFT)
    assert preferences.load(tmp_path / "preferences.toml") == Preferences(machine_asked=True)
    assert begun.session.document.fabrication.material == Preferences().material


def test_that_an_answer_after_work_has_begun_is_one_step_back(
    begun: MainWindow, project_file: Path, until: Until
) -> None:
    begun.services.project.open(project_file)
    until(lambda: begun.session.stage is not None)
    before = begun.session.document.fabrication.material
    begun.presenters.welcome.choose("cricut-maker", "drag-knife")
    assert begun.session.document.fabrication.material == "drag-knife" and begun.session.document.candidates
    begun.commands["undo"].trigger()
    assert begun.session.document.fabrication.material == before


@pytest.mark.parametrize(("width", "height"), [(1000, 640), (1280, 720), (1440, 900)])
def test_that_every_part_of_the_empty_stage_fits(begun: MainWindow, width: int, height: int) -> None:
    begun.resize(width, height)
    for _ in range(3):
        QApplication.processEvents()
    empty = begun.stage.welcome
    parts: list[QWidget] = [*empty.question.buttons.values(), empty.question.later, empty.guide, begun.target.opened]
    parts += empty.offers.values()
    for part in parts:
        assert part.isVisible() and part.width() >= part.minimumSizeHint().width(), part.objectName()
        corner = part.mapTo(begun, part.rect().bottomRight())
        assert begun.rect().contains(corner)
    for button in empty.question.buttons.values():
        assert button.fontMetrics().horizontalAdvance(button.text()) < button.width() - 8
    for offer in empty.offers.values():
        assert offer.fontMetrics().horizontalAdvance(offer.text()) + offer.iconSize().width() < offer.width() - 8
    assert empty.view.height() >= 140
    if empty.steps.isVisible():
        rows = [label for label in empty.steps.findChildren(QLabel) if label.wordWrap()]
        assert len(rows) == len(STEPS) and all(row.height() >= row.heightForWidth(row.width()) for row in rows)
    else:
        assert height < 900, "there is room for the steps"


def test_that_the_question_is_answered_by_keys(begun: MainWindow, qtbot: QtBot, until: Until) -> None:
    button = begun.stage.welcome.question.buttons[MachineKind.HAND]
    menu = button.menu()
    button.setFocus(Qt.FocusReason.TabFocusReason)
    QTimer.singleShot(0, lambda: qtbot.keyClick(menu, Qt.Key.Key_Down))
    QTimer.singleShot(0, lambda: qtbot.keyClick(menu, Qt.Key.Key_Return))
    qtbot.keyClick(button, Qt.Key.Key_Space)
    until(lambda: begun.session.document.fabrication.machine == "hand")
    assert not begun.stage.welcome.question.isVisible()


def test_that_the_page_is_there_before_its_sample(window: MainWindow) -> None:
    page = window.stage.welcome
    assert page.isVisible() and not page.ready and not page.view.isVisible() and not window.stage.split.isVisible()
    assert not window.stage.deployment.isVisible(), "there is nothing to open yet"
    assert page.isAncestorOf(window.focusWidget() or window) or page.hasFocus()


def test_that_every_offer_does_what_its_command_does(window: MainWindow, qtbot: QtBot) -> None:
    done = []
    assert list(window.stage.welcome.offers) == [name for name, _, _ in OFFERS]
    window.target.set_editing(False)
    for name, offer in [*window.stage.welcome.offers.items(), ("guide", window.stage.welcome.guide)]:
        action = window.commands[name]
        action.triggered.disconnect()
        action.triggered.connect(lambda _=False, name=name: done.append(name))
        qtbot.mouseClick(offer, LEFT)
        assert done[-1] == name and offer.toolTip() == action.toolTip()
    assert len(done) == 7


def test_that_the_offers_lead_to_a_design(window: MainWindow, qtbot: QtBot, until: Until) -> None:
    qtbot.mouseClick(window.stage.welcome.offers["edit_target"], LEFT)
    assert window.target.editing and not window.stage.isVisible()
    window.target.set_editing(False)
    assert window.stage.welcome.isVisible()
    qtbot.mouseClick(window.stage.welcome.offers["sample"], LEFT)
    until(lambda: window.session.stage is not None)
    assert not window.stage.welcome.isVisible() and window.stage.deployment.isVisible()


def test_that_a_run_takes_the_place_of_the_page_until_it_is_cancelled(heart: MainWindow, until: Until) -> None:
    heart.services.generation.generate()
    assert not heart.stage.welcome.isVisible() and heart.stage.view.isVisible()
    heart.commands["cancel"].trigger()
    until(lambda: not heart.services.run.running)
    assert heart.stage.welcome.isVisible() is (heart.session.stage is None)


def test_that_the_page_of_a_german_window_fits(german: None, begun: MainWindow) -> None:
    begun.resize(1000, 640)
    QApplication.processEvents()
    for offer in begun.stage.welcome.offers.values():
        assert offer.fontMetrics().horizontalAdvance(offer.text()) + offer.iconSize().width() < offer.width() - 8
