"""One design, every kind of file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from PIL import Image
from PySide6.QtWidgets import QFileDialog
from pytestqt.qtbot import QtBot

from kirigami_studio.export.registry import exporters
from kirigami_studio.gui.dialogs.files import follow_filter
from kirigami_studio.gui.file_kinds import FILE_KINDS, kind_of
from kirigami_studio.gui.main_window import MainWindow
from kirigami_studio.gui.messages import Tone

Until = Callable[[Callable[[], bool]], None]
FIRST_BYTES = {
    ".dxf": b"  0\n",
    ".svg": b"<?xml",
    ".pdf": b"%PDF",
    ".png": b"\x89PNG",
    ".gif": b"GIF8",
    ".lbrn2": b"<?xml",
}


def test_that_the_window_offers_what_the_exporters_write() -> None:
    assert [kind.extension for kind in FILE_KINDS] == list(exporters())


@pytest.mark.parametrize("extension", [kind.extension for kind in FILE_KINDS])
def test_that_the_menu_writes_each_kind(
    designed: MainWindow, files: object, until: Until, tmp_path: Path, extension: str
) -> None:
    files.answer = tmp_path / f"sheet{extension}"  # type: ignore[attr-defined]
    designed.fabrication.kinds[extension].trigger()
    until(lambda: bool(designed.messages.messages))
    assert designed.messages.messages[-1].tone is Tone.DONE
    assert files.proposals == [f"heart{extension}"]  # type: ignore[attr-defined]
    written = (tmp_path / f"sheet{extension}").read_bytes().replace(b"\r\n", b"\n")
    assert written.startswith(FIRST_BYTES[extension])


def test_that_a_refused_plan_still_leaves_pictures(designed: MainWindow, until: Until) -> None:
    designed.fabrication.lengths["connector_mm"].setValue(20.0)
    until(lambda: not designed.fabrication.export.isEnabled())
    allowed = {extension: action.isEnabled() for extension, action in designed.fabrication.kinds.items()}
    assert allowed == {".dxf": False, ".svg": False, ".pdf": False, ".png": True, ".gif": True, ".lbrn2": False}
    assert designed.fabrication.more.isEnabled()


def test_that_the_animation_shows_the_sheet_as_cut_unless_the_ideal_motion_is_asked_for(
    designed: MainWindow, files: object, qtbot: QtBot, tmp_path: Path
) -> None:
    sentences = []
    for name, action in (
        ("heart.gif", designed.commands["animation"]),
        ("heart-ideal.gif", designed.fabrication.exports.ideal),
    ):
        files.answer = tmp_path / name  # type: ignore[attr-defined]
        with qtbot.waitSignal(designed.controller.cutting.exported, timeout=30_000):
            action.trigger()
        sentences.append(designed.messages.messages[-1].sentence)
    assert sentences == [
        "heart.gif exported: as cut, to 0°.",
        "heart-ideal.gif exported: the ideal motion, with connectors of no width.",
    ]
    assert files.proposals == ["heart.gif", "heart-ideal.gif"]  # type: ignore[attr-defined]
    for name, said in (("heart.gif", True), ("heart-ideal.gif", False)):
        with Image.open(tmp_path / name) as image:
            assert (b"MOTION As cut" in image.info["comment"]) is said, name


def test_that_an_animation_of_cuts_that_cannot_be_planned_is_ideal_and_says_why(
    designed: MainWindow, files: object, until: Until, tmp_path: Path
) -> None:
    designed.fabrication.lengths["connector_mm"].setValue(20.0)
    until(lambda: not designed.fabrication.export.isEnabled())
    files.answer = tmp_path / "heart.gif"  # type: ignore[attr-defined]
    designed.fabrication.kinds[".gif"].trigger()
    until(lambda: any("heart.gif" in message.sentence for message in designed.messages.messages))
    sentence = designed.messages.messages[-1].sentence
    assert "the ideal motion" in sentence and "Not as cut: " in sentence


def test_that_an_unknown_extension_is_refused_with_the_known_ones(
    designed: MainWindow, files: object, until: Until, tmp_path: Path
) -> None:
    files.answer = tmp_path / "sheet.stl"  # type: ignore[attr-defined]
    designed.commands["export"].trigger()
    until(lambda: bool(designed.messages.messages))
    message = designed.messages.messages[-1]
    assert message.tone is Tone.ERROR and ".stl" in message.sentence and ".svg" in message.sentence
    assert list(tmp_path.glob("sheet*")) == []


def test_that_picking_a_file_type_renames_the_proposal(qtbot: QtBot, tmp_path: Path) -> None:
    dialog = QFileDialog(None, "Export", str(tmp_path))
    dialog.setOption(QFileDialog.Option.DontUseNativeDialog)
    qtbot.addWidget(dialog)
    dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
    dialog.selectFile("heart.dxf")
    follow_filter(dialog, kind_of(".svg").filter)
    assert [Path(name).name for name in dialog.selectedFiles()] == ["heart.svg"]
    assert dialog.defaultSuffix() == "svg"
