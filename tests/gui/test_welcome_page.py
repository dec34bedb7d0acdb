"""The first page: a sheet that moves, one question, ways to begin, finished pairs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QListWidgetItem, QProxyStyle, QStyle, QWidget
from pytestqt.qtbot import QtBot

from kirigami_studio.fabricate.machine import cuttable, find_machine, machines
from kirigami_studio.gui.make.machine_question import KINDS, CuttingQuestion
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.gui.window.welcome_page import OFFERS, moves
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
    window.pages.turn(WindowPage.SHAPE)
    window.presenters.welcome.begin()
    until(lambda: window.welcome.ready and window.session.document.target is not None)
    return window


def item_of(question: CuttingQuestion, key: str) -> QListWidgetItem:
    """The line of a machine or a material."""
    lines = (question.list.item(row) for row in range(question.list.count()))
    return next(line for line in lines if line.data(Qt.ItemDataRole.UserRole) == key)


def click_on(question: CuttingQuestion, key: str) -> None:
    """Click the line of a machine or a material."""
    box = question.list.visualItemRect(item_of(question, key))
    if not question.list.viewport().rect().contains(box):
        question.list.scrollToItem(item_of(question, key))
        box = question.list.visualItemRect(item_of(question, key))
    QTest.mouseClick(question.list.viewport(), LEFT, pos=box.center())


def answer(question: CuttingQuestion, machine: str, material: str) -> None:
    """Choose a machine, and a material that it cuts."""
    click_on(question, machine)
    assert question.list.count() == len(cuttable(find_machine(machine)))
    click_on(question, material)


def test_that_the_sample_moves_until_the_user_acts(begun: MainWindow, qtbot: QtBot, until: Until) -> None:
    empty = begun.welcome
    assert empty.isVisible() and empty.moving and not begun.stage.isVisible()
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
    assert not begun.welcome.moving and begun.commands["still"].isChecked()
    assert preferences.load(tmp_path / "preferences.toml").motion == "still"
    begun.commands["still"].trigger()
    assert begun.welcome.moving and not begun.commands["still"].isChecked()
    style = Motionless()
    assert not moves("system", style) and moves("system", begun.style()) and not moves("still", begun.style())


@pytest.mark.parametrize("key", ["paper-hand", "card-co2"])
def test_that_the_question_is_asked_once_and_its_answer_holds_for_new_projects(
    key: str, begun: MainWindow, qtbot: QtBot, tmp_path: Path
) -> None:
    question = begun.welcome.question
    assert question.isVisible() and question.list.count() == len(machines().items)
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


@pytest.mark.parametrize("machine", ["cricut-maker", "diode-10w"])
def test_that_the_answer_is_repeated_by_its_name_in_the_list_with_the_width(begun: MainWindow, machine: str) -> None:
    for key, material in cuttable(find_machine(machine)).items():
        begun.presenters.welcome.choose(machine, key)
        said = begun.status_text.text()
        assert material.name in said and f"{material.sheet_mm:g} mm" in said, said


def test_that_declining_is_an_answer_too(begun: MainWindow, qtbot: QtBot, tmp_path: Path) -> None:
    qtbot.mouseClick(begun.welcome.question.later, LEFT)
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


def test_that_each_material_has_a_picture_of_what_it_becomes_and_its_words(begun: MainWindow) -> None:
    question = begun.welcome.question
    click_on(question, "co2-laser")
    for key, construction in (("card-co2", "One sheet"), ("plywood-co2", "Two layers on pins"), ("felt-co2", "Tiles")):
        line = item_of(question, key)
        assert construction in line.text() and not line.icon().isNull() and line.toolTip()
    question.back.click()
    assert question.list.count() == len(machines().items) and not question.back.isVisible()


def test_that_a_machine_of_every_kind_is_seen_without_scrolling(begun: MainWindow) -> None:
    """Before, lasers were below five machines with a blade."""
    begun.resize(1280, 720)
    QApplication.processEvents()
    listed = begun.welcome.question.list
    seen = [listed.item(row) for row in range(listed.count())]
    seen = [item for item in seen if listed.viewport().rect().contains(listed.visualItemRect(item))]
    assert {find_machine(item.data(Qt.ItemDataRole.UserRole)).kind for item in seen} == {kind for kind, _ in KINDS}


def test_that_materials_say_how_long_the_machine_will_cut_their_sheet(begun: MainWindow) -> None:
    question = begun.welcome.question
    click_on(question, "diode-10w")
    assert " h" in item_of(question, "plywood-co2").text() and " min" in item_of(question, "card-co2").text()
    question.back.click()
    click_on(question, "hand")
    assert " min" not in item_of(question, "paper-hand").text()


def test_that_recovering_is_offered_only_where_an_earlier_session_left_work(
    begun: MainWindow, project_file: Path, tmp_path: Path
) -> None:
    """Before, the first start offered to recover what there was not."""
    offer, folder = begun.welcome.offers["recover"], tmp_path / "recovery"
    assert not offer.isVisible()
    begun.services.project.recovery.use(folder)
    assert not offer.isVisible()
    folder.mkdir(exist_ok=True)
    (folder / "1-left.kiri").write_bytes(project_file.read_bytes())
    begun.services.project.recovery.use(folder)
    assert offer.isVisible()


@pytest.mark.parametrize(("width", "height"), [(1000, 640), (1280, 720), (1440, 900)])
def test_that_every_part_of_the_first_page_fits(begun: MainWindow, width: int, height: int) -> None:
    begun.resize(width, height)
    page = begun.welcome
    page.offer_recovery(True)
    for _ in range(3):
        QApplication.processEvents()
    parts: list[QWidget] = [page.question.list, page.question.later, *page.offers.values(), page.pairs.list]
    for part in (*parts, begun.target.view, begun.target.start, begun.settings.second, begun.run.generate):
        assert part.isVisible() and part.width() >= part.minimumSizeHint().width(), part.objectName()
        assert begun.rect().contains(part.mapTo(begun, part.rect().bottomRight()))
    for offer in page.offers.values():
        assert offer.fontMetrics().horizontalAdvance(offer.text()) + offer.iconSize().width() < offer.width() - 8
    assert page.view.isVisible() is (height >= 900) and (height < 900 or page.view.height() >= 100)
    begun.presenters.welcome.decline()
    assert page.view.isVisible(), "without the question there is room"


def test_that_the_question_is_answered_by_keys(begun: MainWindow, qtbot: QtBot, until: Until) -> None:
    listed = begun.welcome.question.list
    listed.setFocus(Qt.FocusReason.TabFocusReason)
    listed.setCurrentRow(0)
    qtbot.keyClick(listed, Qt.Key.Key_Return)
    qtbot.keyClick(listed, Qt.Key.Key_Return)
    until(lambda: begun.session.document.fabrication.machine == "hand")
    assert not begun.welcome.question.isVisible()


def test_that_the_page_is_there_before_its_sample(window: MainWindow) -> None:
    window.pages.turn(WindowPage.SHAPE)
    page = window.welcome
    assert page.isVisible() and not page.ready and not page.view.isVisible() and not window.stage.isVisible()


def test_that_every_offer_does_what_its_command_does(window: MainWindow, qtbot: QtBot) -> None:
    done = []
    window.pages.turn(WindowPage.SHAPE)
    assert list(window.welcome.offers) == [name for name, _, _ in OFFERS]
    for name, offer in window.welcome.offers.items():
        action = window.commands[name]
        action.triggered.disconnect()
        action.triggered.connect(lambda _=False, name=name: done.append(name))
        qtbot.mouseClick(offer, LEFT)
        assert done[-1] == name and offer.toolTip() == action.toolTip()
    assert len(done) == 4


def test_that_the_offers_lead_to_a_design(window: MainWindow, qtbot: QtBot, until: Until) -> None:
    window.pages.turn(WindowPage.SHAPE)
    qtbot.mouseClick(window.welcome.offers["sample"], LEFT)
    until(lambda: window.session.stage is not None)
    assert not window.welcome.isVisible() and window.stage.deployment.isVisible()


def test_that_the_page_of_a_german_window_fits(german: None, begun: MainWindow) -> None:
    begun.resize(1000, 640)
    QApplication.processEvents()
    for offer in begun.welcome.offers.values():
        assert offer.fontMetrics().horizontalAdvance(offer.text()) + offer.iconSize().width() < offer.width() - 8
