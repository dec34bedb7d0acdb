"""One design, every kind of file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from PIL import Image
from PySide6.QtWidgets import QFileDialog
from pytestqt.qtbot import QtBot

from kirigami_studio.export.pdf import read_pages
from kirigami_studio.export.registry import WRITERS
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.files.file_dialogs import FileToOpen, SystemFileDialogs, follow_filter
from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.project import store
from kirigami_studio.studio.file_kinds import FILE_KINDS, kind_of

Until = Callable[[Callable[[], bool]], None]
FIRST_BYTES = {
    ".dxf": b"  0\n",
    ".svg": b"<?xml",
    ".pdf": b"%PDF",
    ".png": b"\x89PNG",
    ".gif": b"GIF8",
    ".html": b"<!doctype html>",
    ".lbrn2": b"<?xml",
    ".stl": b"Kirigami Studio",
    ".3mf": b"PK",
    ".obj": b"# Kirigami Studio",
    ".inp": b"** Kirigami Studio",
    ".fold": b'{"file_spec":1.2',
    ".xml": b"<mujoco",
    ".csv": b"part,layer,",
}


def test_that_the_window_offers_what_the_exporters_write() -> None:
    assert [kind.extension for kind in FILE_KINDS] == list(WRITERS)


@pytest.mark.parametrize("extension", [kind.extension for kind in FILE_KINDS])
def test_that_the_menu_writes_each_kind(
    designed: MainWindow, files: object, until: Until, tmp_path: Path, extension: str
) -> None:
    files.answer = tmp_path / f"sheet{extension}"  # type: ignore[attr-defined]
    designed.fabrication.kinds[extension].trigger()
    until(lambda: bool(designed.messages.messages))
    assert designed.messages.messages[-1].tone is Tone.DONE
    assert files.proposals == [f"heart-A1{extension}"]  # type: ignore[attr-defined]
    assert files.to_folders == [False]  # type: ignore[attr-defined]
    written = (tmp_path / f"sheet{extension}").read_bytes().replace(b"\r\n", b"\n")
    assert written.startswith(FIRST_BYTES[extension])


@pytest.fixture
def places(window: MainWindow, monkeypatch: pytest.MonkeyPatch) -> list[QFileDialog]:
    """Dialogs that ask for a place to write to, each accepted as it is."""
    shown: list[QFileDialog] = []

    def accept(dialog: QFileDialog) -> int:
        shown.append(dialog)
        return int(QFileDialog.DialogCode.Accepted)

    monkeypatch.setattr(QFileDialog, "exec", accept)
    return shown


def test_that_files_are_written_beside_the_last_one_whatever_was_opened_since(
    window: MainWindow, places: list[QFileDialog], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    drawings, cuts = tmp_path / "drawings", tmp_path / "cuts"
    for folder in (drawings, cuts):
        folder.mkdir()
    ask = SystemFileDialogs(window)
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(drawings / "logo.svg"), ""))
    assert ask.open(FileToOpen.TARGET) == drawings / "logo.svg"
    assert ask.export("logo.svg") == drawings / "logo.svg", "nothing was written before"
    monkeypatch.setattr(QFileDialog, "getExistingDirectory", lambda *_: str(cuts / "set"))
    assert ask.folder() == cuts / "set"
    assert ask.open(FileToOpen.TARGET) == drawings / "logo.svg"
    assert ask.export("logo.dxf") == cuts / "logo.dxf"


def test_that_the_question_for_a_place_says_where_it_is_a_folder(window: MainWindow, places: list[QFileDialog]) -> None:
    ask = SystemFileDialogs(window)
    ask.export("heart.lbrn2")
    ask.export("heart.lbrn2", to_folder=True)
    assert [dialog.windowTitle() for dialog in places] == [
        tr("Export {upper}", upper="LBRN2"),
        tr("Export {upper} to a folder of this name", upper="LBRN2"),
    ]


def test_that_a_refused_plan_still_leaves_pictures(designed: MainWindow, until: Until) -> None:
    designed.fabrication.lengths["connector_mm"].setValue(20.0)
    until(lambda: not designed.fabrication.export.isEnabled())
    allowed = {extension: action.isEnabled() for extension, action in designed.fabrication.kinds.items()}
    assert {extension for extension, enabled in allowed.items() if enabled} == {
        kind.extension for kind in FILE_KINDS if not kind.cuts
    }
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
        with qtbot.waitSignal(designed.services.exporter.exported, timeout=30_000):
            action.trigger()
        sentences.append(designed.messages.messages[-1].sentence)
    assert sentences == [
        "heart.gif exported: as cut, to 0°.",
        "heart-ideal.gif exported: the ideal motion, with connectors of no width.",
    ]
    assert files.proposals == ["heart-A1.gif", "heart-A1-ideal.gif"]  # type: ignore[attr-defined]
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
    files.answer = tmp_path / "sheet.dwg"  # type: ignore[attr-defined]
    designed.commands["export"].trigger()
    until(lambda: bool(designed.messages.messages))
    message = designed.messages.messages[-1]
    assert message.tone is Tone.ERROR and ".dwg" in message.sentence and ".svg" in message.sentence
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


def test_that_a_pdf_of_many_pages_is_written_only_after_asking(
    designed: MainWindow, qtbot: QtBot, until: Until, tmp_path: Path
) -> None:
    services, exporter = designed.services, designed.services.exporter
    pick = designed.fabrication.options.paper
    pick.setCurrentIndex(pick.findData("a4"))
    pick.activated.emit(pick.currentIndex())
    assert services.session.document.fabrication.paper == "a4"
    with qtbot.waitSignal(exporter.exported, timeout=30_000):
        exporter.export(tmp_path / "small.pdf")
    services.fabrication.change(width_mm=1500.0)
    exporter.export(tmp_path / "large.pdf")
    until(lambda: any(message.tone is Tone.WARNING for message in designed.messages.messages))
    asked = next(message for message in designed.messages.messages if message.tone is Tone.WARNING)
    assert asked.actions and "pages of a4" in asked.sentence
    assert not (tmp_path / "large.pdf").exists()
    ((words, write),) = asked.actions
    assert words == "Write all pages"
    with qtbot.waitSignal(exporter.exported, timeout=60_000):
        write()
    assert len(read_pages(tmp_path / "large.pdf")) > 20
    assert len(read_pages(tmp_path / "small.pdf")) == 1
    designed.commands["undo"].trigger()
    designed.commands["undo"].trigger()
    assert services.session.document.fabrication.paper == "none"


def test_that_markers_of_connectors_are_a_choice_that_is_saved(
    designed: MainWindow, qtbot: QtBot, tmp_path: Path
) -> None:
    services = designed.services
    for name, marked in (("plain", False), ("marked", True)):
        if marked:
            designed.fabrication.options.markers.click()
        with qtbot.waitSignal(services.exporter.exported, timeout=30_000):
            services.exporter.export(tmp_path / f"{name}.lbrn2")
        assert ("Ellipse" in (tmp_path / f"{name}.lbrn2").read_text()) is marked
    with qtbot.waitSignal(services.project.saved, timeout=30_000):
        services.project.save(tmp_path / "marked.kiri")
    assert store.load(tmp_path / "marked.kiri").fabrication.markers


def test_that_files_of_an_earlier_export_which_are_gone_are_told(
    designed: MainWindow, qtbot: QtBot, tmp_path: Path
) -> None:
    services = designed.services
    for profile in ("any", "slots"):  # no LightBurn project holds slots
        services.fabrication.change(profile=profile)
        with qtbot.waitSignal(services.exporter.exported, timeout=60_000):
            services.exporter.export_all(tmp_path, "cut")
    told = [message.sentence for message in designed.messages.messages]
    assert "Removed files of an earlier export that this one does not have: cut.lbrn2." in told
    assert not (tmp_path / "cut.lbrn2").exists()
    (tmp_path / "cut.lbrn2").write_text("another program's")
    with qtbot.waitSignal(services.exporter.exported, timeout=60_000):
        services.exporter.export_all(tmp_path, "cut")
    told = [message.sentence for message in designed.messages.messages]
    assert any("files of an earlier export: cut.lbrn2. Delete" in sentence for sentence in told)
    assert (tmp_path / "cut.lbrn2").exists()


@pytest.mark.parametrize("name", ["cut.dxf", "cut.svg"])
def test_that_an_exported_cut_file_opens_as_its_design(
    name: str, designed: MainWindow, until: Callable[[Callable[[], bool]], None], tmp_path: Path
) -> None:
    services, path = designed.services, tmp_path / name
    chosen = services.session.document.candidate
    services.exporter.export(path)
    until(path.exists)
    until(lambda: not services.session.queue.busy)
    services.project.new()
    designed.files.open(str(path))
    until(lambda: services.session.document.candidate is not None)
    assert services.session.document.candidate == chosen and services.session.document.target is not None
    assert services.session.path is None and services.session.history.unsaved
    assert designed.status_text.text() == f"Opened the design that {name} was cut from."
    services.session.history.mark_saved()
    until(lambda: not services.session.queue.busy)
