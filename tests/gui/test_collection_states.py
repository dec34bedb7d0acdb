"""The states of the collection on the sheet of screenshots show what they are named after."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot
from shown_sheets import shown

from kirigami_studio.lab.demonstrations.offscreen_session import click
from kirigami_studio.lab.demonstrations.state_sheet import StateSheet
from kirigami_studio.project.document import Mark


class OneOfEach(StateSheet):
    """Takes every picture once, in the size and theme there is."""

    def all_sizes(self, name: str, ready: Callable[[], object] = lambda: None) -> None:
        ready()
        self.picture(name)


@pytest.fixture
def sheet(qtbot: QtBot, tmp_path: Path) -> Iterator[StateSheet]:
    yield from shown(OneOfEach(tmp_path), qtbot)


@pytest.mark.torch
def test_that_the_collections_states_are_pictured_and_taken_back(sheet: StateSheet) -> None:
    window = sheet.window
    for change in ({"grid": (6, 6)}, {"k": 5}, {"polish": 0}):
        window.services.settings.change(**change)  # type: ignore[arg-type]
    sheet.choose_heart()
    click(window.run.generate)
    sheet.until(lambda: not window.services.run.running and window.fabrication.export.isEnabled(), "no designs")
    before = window.session.document
    sheet.collection()
    assert window.session.document.candidates == before.candidates
    assert set(window.session.document.marks) == {Mark.NONE} and not window.stage.comparing
    names = {path.stem for path in sheet.files}
    assert {"gallery-sorted", "gallery-nothing", "gallery-alike", "gallery-more", "compare", "card-menu"} <= names
