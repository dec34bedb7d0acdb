"""What a new user meets: a sample that moves by itself, and one question, for machine and material."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication, QProxyStyle, QStyle, QWidget
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.stage.empty_stage import moves
from kirigami_studio.gui.window.main_window import MainWindow
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
    window.first_start.begin()
    until(lambda: window.stage.empty.ready and window.session.document.target is not None)
    return window


def test_that_the_sample_moves_until_the_user_acts(begun: MainWindow, qtbot: QtBot, until: Until) -> None:
    empty = begun.stage.empty
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
    assert not begun.stage.empty.moving and begun.commands["still"].isChecked()
    assert preferences.load(tmp_path / "preferences.toml").motion == "still"
    begun.commands["still"].trigger()
    assert begun.stage.empty.moving and not begun.commands["still"].isChecked()
    style = Motionless()
    assert not moves("system", style) and moves("system", begun.style()) and not moves("still", begun.style())


def test_that_the_sample_gives_way_to_a_design_and_comes_back_without_one(
    begun: MainWindow, project_file: Path, until: Until
) -> None:
    stage = begun.stage
    begun.services.project.open(project_file)
    until(lambda: begun.session.stage is not None)
    assert stage.split.isVisible() and not stage.empty.isVisible() and not stage.empty.moving
    until(lambda: begun.fabrication.export.isEnabled())
    begun.services.project.new()
    until(lambda: begun.session.stage is None)
    assert stage.empty.isVisible() and "target" in stage.empty.hint.text().lower() + stage.empty.headline.text()


@pytest.mark.parametrize("key", ["paper-hand", "card-co2"])
def test_that_the_question_is_asked_once_and_its_answer_holds_for_new_projects(
    key: str, begun: MainWindow, qtbot: QtBot, tmp_path: Path
) -> None:
    question = begun.stage.empty.question
    assert question.isVisible() and len(question.buttons) == 4
    if key == "paper-hand":
        qtbot.mouseClick(question.buttons["by hand"], LEFT)
    else:
        actions = question.buttons["CO2 laser"].menu().actions()
        next(action for action in actions if action.text().startswith("Card")).trigger()
    assert not question.isVisible()
    kept = preferences.load(tmp_path / "preferences.toml")
    assert kept.machine_asked and kept.material == key
    fabrication = begun.session.document.fabrication
    assert fabrication.material == key and not begun.session.history.unsaved
    assert begun.fabrication.material.currentData() == key
    by_hand = key == "paper-hand"
    assert (fabrication.paper in ("a4", "letter")) is by_hand
    assert begun.fabrication.export.text() == ("Export PDF" if by_hand else "Export DXF")
    begun.services.project.new()
    assert begun.session.document.fabrication.material == key
    begun.first_start.begin()
    assert not question.isVisible()


def test_that_declining_is_an_answer_too(begun: MainWindow, qtbot: QtBot, tmp_path: Path) -> None:
    qtbot.mouseClick(begun.stage.empty.question.later, LEFT)
    assert preferences.load(tmp_path / "preferences.toml") == Preferences(machine_asked=True)
    assert begun.session.document.fabrication.material == Preferences().material


def test_that_an_answer_after_work_has_begun_is_one_step_back(
    begun: MainWindow, project_file: Path, until: Until
) -> None:
    begun.services.project.open(project_file)
    until(lambda: begun.session.stage is not None)
    before = begun.session.document.fabrication.material
    begun.first_start.choose("drag-knife")
    assert begun.session.document.fabrication.material == "drag-knife" and begun.session.document.candidates
    begun.commands["undo"].trigger()
    assert begun.session.document.fabrication.material == before


@pytest.mark.parametrize(("width", "height"), [(1000, 640), (1280, 720), (1440, 900)])
def test_that_every_part_of_the_empty_stage_fits(begun: MainWindow, width: int, height: int) -> None:
    begun.resize(width, height)
    for _ in range(3):
        QApplication.processEvents()
    empty = begun.stage.empty
    parts: list[QWidget] = [*empty.question.buttons.values(), empty.question.later, empty.tour, begun.target.opened]
    for part in parts:
        assert part.isVisible() and part.width() >= part.minimumSizeHint().width(), part.objectName()
        corner = part.mapTo(begun, part.rect().bottomRight())
        assert begun.rect().contains(corner)
    for button in empty.question.buttons.values():
        assert button.fontMetrics().horizontalAdvance(button.text()) < button.width() - 8
    assert empty.view.height() >= 140


def test_that_the_question_is_answered_by_keys(begun: MainWindow, qtbot: QtBot) -> None:
    button = begun.stage.empty.question.buttons["by hand"]
    button.setFocus(Qt.FocusReason.TabFocusReason)
    qtbot.keyClick(button, Qt.Key.Key_Space)
    assert begun.session.document.fabrication.material == "paper-hand"
