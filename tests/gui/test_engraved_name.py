"""A check box engraves the name of the design: in the cut view and in files, undone, saved, and after a renaming."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import ezdxf
import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QImage
from pytestqt.qtbot import QtBot

from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.gui.widgets.theme import LIGHT
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.project import candidate_edits, store

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def shown(designed: MainWindow, until: Until) -> MainWindow:
    """The page on which a design is made."""
    designed.resize(1440, 1000)
    designed.pages.turn(WindowPage.MAKE)
    until(lambda: plan_of(designed) is not None)
    return designed


def plan_of(window: MainWindow) -> CutPlan | None:
    """The plan that the cuts' page shows."""
    drawing = window.cuts.view._drawing
    return None if drawing is None else drawing.plan


def engraved_text(window: MainWindow) -> str:
    plan = plan_of(window)
    return "" if plan is None or plan.engraving is None else plan.engraving.text


def pixels_in(image: QImage, colour: str) -> int:
    wanted = QColor(colour).rgb()
    return sum(image.pixel(x, y) == wanted for x in range(image.width()) for y in range(image.height()))


def test_that_the_box_engraves_the_name_and_undo_takes_it_off(shown: MainWindow, until: Until) -> None:
    box = shown.fabrication.options.engrave
    assert not box.isChecked() and engraved_text(shown) == ""
    box.click()
    until(lambda: engraved_text(shown) == "A1")
    assert shown.session.document.fabrication.engrave
    shown.commands["undo"].trigger()
    until(lambda: engraved_text(shown) == "")
    assert not box.isChecked() and not shown.session.document.fabrication.engrave


def test_that_the_cut_view_shows_the_name_in_its_own_colour(shown: MainWindow, until: Until) -> None:
    view = shown.cuts.view
    before = [chip.text for chip in view._chips()]
    assert pixels_in(view.grab().toImage(), LIGHT.engraved) == 0
    shown.fabrication.options.engrave.click()
    until(lambda: engraved_text(shown) == "A1")
    assert [chip.text for chip in view._chips() if chip.text not in before] == ["engraved name"]
    assert pixels_in(view.grab().toImage(), LIGHT.engraved) > 10


def test_that_another_name_is_engraved_at_once_only_where_names_are(shown: MainWindow, until: Until) -> None:
    session = shown.session
    first = plan_of(shown)
    session.apply(candidate_edits.set_label(session.document, 0, "Ada", ""))
    assert not shown.services.cutting._timer.isActive() and plan_of(shown) is first
    shown.fabrication.options.engrave.click()
    until(lambda: engraved_text(shown) == "Ada")
    session.apply(candidate_edits.set_label(session.document, 0, "Grace", ""))
    until(lambda: engraved_text(shown) == "Grace")
    shown.commands["undo"].trigger()
    until(lambda: engraved_text(shown) == "Ada")


def test_that_the_choice_is_saved_and_in_the_file(shown: MainWindow, qtbot: QtBot, tmp_path: Path) -> None:
    services = shown.services
    shown.fabrication.options.engrave.click()
    with qtbot.waitSignal(services.exporter.exported, timeout=30_000) as written:
        services.exporter.export(tmp_path / "named.dxf")
    layers = [entity.dxf.layer for entity in ezdxf.readfile(tmp_path / "named.dxf").modelspace()]
    assert layers[0] == "NAME"
    (verification,) = written.args[0].verifications
    assert verification.ok and "verify.name" in [finding.code for finding in verification.findings]
    with qtbot.waitSignal(services.project.saved, timeout=30_000):
        services.project.save(tmp_path / "named.kiri")
    assert store.load(tmp_path / "named.kiri").fabrication.engrave
    assert store.load(tmp_path / "named.dxf").fabrication.engrave
