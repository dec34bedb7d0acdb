"""The pictures that are looked at show what they are named after."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from PIL import Image
from PySide6.QtCore import QSize
from pytestqt.qtbot import QtBot
from shown_sheets import shown

from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.lab.demonstrations.board_states import SIZES
from kirigami_studio.lab.demonstrations.state_sheet import StateSheet, contact_sheets


@pytest.fixture
def sheet(qtbot: QtBot, tmp_path: Path) -> Iterator[StateSheet]:
    yield from shown(StateSheet(tmp_path), qtbot)


def test_that_each_size_and_theme_gets_its_picture(sheet: StateSheet, tmp_path: Path) -> None:
    sheet.all_sizes("empty")
    assert len(sheet.files) == 2 * len(SIZES)
    for size in SIZES:
        shown = {}
        for theme in ("light", "dark"):
            with Image.open(tmp_path / f"empty-{size.width()}x{size.height()}-{theme}.png") as picture:
                assert picture.size == (size.width(), size.height())
                shown[theme] = picture.convert("L").resize((1, 1)).getpixel((0, 0))
        assert shown["light"] > 2 * shown["dark"]


def test_that_each_page_gets_its_picture(sheet: StateSheet, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kirigami_studio.lab.demonstrations.board_states.SIZES", SIZES[1:])
    sheet.all_pages("empty")
    for page in ("shape", "design", "make"):
        assert (tmp_path / f"{page}-empty-1280x720-dark.png").exists()
    assert sheet.window.pages.page is WindowPage.SHAPE


def test_that_the_refused_pages_leave_no_message_and_the_cuts_as_they_were(
    sheet: StateSheet, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kirigami_studio.lab.demonstrations.board_states.SIZES", SIZES[1:])
    sheet.window.files.open_sample()
    sheet.until(sheet.window.fabrication.export.isEnabled, "the sample was not opened")
    before = sheet.window.session.document
    sheet.refused()
    assert sheet.window.messages.messages == () and sheet.window.session.document == before
    assert (tmp_path / "make-refused-1280x720-dark.png").exists() and (tmp_path / "question-1280x720-dark.png").exists()


def test_that_a_contact_sheet_shows_every_picture_of_its_size_and_theme_with_a_caption(tmp_path: Path) -> None:
    pictures = []
    for number, theme in enumerate(("light",) * 5 + ("dark",)):
        path = tmp_path / f"state {number}-1280x720-{theme}.png"
        Image.new("RGB", (1280, 720), (10 + 40 * number, 0, 200)).save(path)
        pictures.append(path)
    Image.new("RGB", (300, 900), "white").save(tmp_path / "guide.png")
    pages = contact_sheets([*pictures, tmp_path / "guide.png"], tmp_path)
    assert [page.name for page in pages] == [
        "contact-1280x720-light.png", "contact-1280x720-dark.png", "contact-others.png",
    ]  # fmt: skip
    with Image.open(pages[0]) as page:
        colours = {colour for _, colour in page.getcolors(100_000) or ()}
        assert {(10 + 40 * number, 0, 200) for number in range(5)} <= colours
        assert page.width == 4 * 490 + 10 and page.height == 2 * (270 + 22 + 10) + 10
        blank = Image.new("RGB", (480, 22), "#8a94a0")
        assert page.crop((10, 10, 490, 32)).tobytes() != blank.tobytes()
    with Image.open(pages[2]) as page:
        assert page.height == 360 + 22 + 20


def test_that_the_photo_state_shows_a_threshold(sheet: StateSheet) -> None:
    sheet.picture_target()
    assert sheet.window.target.threshold.isVisible()


def test_that_the_start_states_show_the_board_the_pairs_and_an_opened_pair(
    sheet: StateSheet, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kirigami_studio.lab.demonstrations.board_states.SIZES", SIZES[1:])
    sheet.starts()
    for name in ("start-menu", "start-board-dark", "pairs-light", "pair-1280x720-dark"):
        assert (tmp_path / f"{name}.png").exists()
    assert sheet.window.target.start.name == "circle" and sheet.window.session.document.candidates


@pytest.mark.torch
def test_that_the_second_target_is_shown_at_its_angle(
    sheet: StateSheet, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kirigami_studio.lab.demonstrations.board_states.SIZES", (QSize(1440, 900),))
    sheet.window.resize(1440, 900)
    sheet.choose_heart()
    sheet.second_target()
    stage = sheet.window.stage
    assert stage.view.second is not None and stage.view.phi == stage.view.second[0] and stage.ends.passed.isVisible()
    for name in ("second-target-settings-1440x900-dark", "second-target-1440x900-light", "second-board"):
        assert (tmp_path / f"{name}.png").exists()


def test_that_the_project_states_offer_lost_work_and_leave_none(
    sheet: StateSheet, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kirigami_studio.lab.demonstrations.board_states.SIZES", SIZES[1:])
    sheet.window.services.fabrication.change(width_mm=88.0)
    sheet.project()
    assert sheet.window.messages.messages == () and not list((tmp_path / "recovery").glob("left*"))
    for name in ("recovery-1280x720-dark", "menu-recent-light", "menu-pictures-dark", "history-light"):
        assert (tmp_path / f"{name}.png").exists()


def test_that_the_editor_states_show_tools_and_a_marked_arm(
    sheet: StateSheet, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "kirigami_studio.lab.demonstrations.board_states.SIZES", SIZES[1:]
    )  # one is enough, each takes seconds
    sheet.editor()
    target = sheet.window.target
    assert target.editing and target.view.reach is not None and len(target.view.reach.arms) == 1
    assert (tmp_path / "editor-points-1280x720-dark.png").exists()


def test_that_the_part_states_show_the_picker_and_take_nothing(sheet: StateSheet, tmp_path: Path) -> None:
    before = sheet.window.session.document
    sheet.parts()
    assert sheet.window.session.document is before
    for name in ("parts-largest-dark", "parts-bridges-light", "parts-hull-light"):
        assert (tmp_path / f"{name}.png").exists()
