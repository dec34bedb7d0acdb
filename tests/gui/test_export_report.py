"""After an export: what two readers found, in words and symbols, and the machine that is remembered."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import ezdxf
import pytest
from PySide6.QtCore import QObject, Qt, QUrl, Slot
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from kirigami_studio.export.verification import Finding, Verification
from kirigami_studio.fabricate.material import DEFAULT_PRESET
from kirigami_studio.foundation import words
from kirigami_studio.foundation.errors import ProjectError
from kirigami_studio.gui.make.export_report import ExportReport, as_text, format_findings, verdict
from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.widgets.theme import LIGHT
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.project import edits, preferences
from kirigami_studio.project.document import Document
from kirigami_studio.project.preferences import Preferences

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton
GOOD = Verification(
    path=Path("sheet.dxf"),
    ok=True,
    size_mm=(100.0, 80.0),
    pieces=1,
    cut_length_mm=1234.0,
    seconds_low=20.0,
    seconds_high=30.0,
    findings=(
        Finding.judged(True, "verify.unit_is_mm"),
        Finding("verify.smallest_ligament", {"ligament_mm": 0.2, "planned_mm": 0.3}, ok=True, warning=True),
    ),
    warnings=(),
)
BAD = replace(GOOD, ok=False, findings=(*GOOD.findings, Finding.judged(False, "verify.point_count")))


def export(window: MainWindow, path: Path, until: Until) -> ExportReport:
    window.services.exporter.export(path)
    until(lambda: window.dialogs.report is not None)
    assert window.dialogs.report is not None
    return window.dialogs.report


def test_that_an_export_opens_a_report_that_blocks_nothing(
    designed: MainWindow, files: object, qtbot: QtBot, until: Until, tmp_path: Path
) -> None:
    files.answer = tmp_path / "cut.dxf"  # type: ignore[attr-defined]
    qtbot.mouseClick(designed.fabrication.export, LEFT)
    until(lambda: designed.dialogs.report is not None)
    report = designed.dialogs.report
    assert report is not None and report.isVisible() and not report.isModal()
    assert report.shown.ok and report.verdict.text().startswith("Verified")
    assert report.facts["Pieces"].text() == "1" and report.facts["Size with overcuts"].text().startswith("100.")
    designed.commands["cuts"].trigger()
    assert designed.cuts.isVisible()
    qtbot.mouseClick(report.shut, LEFT)
    assert not report.isVisible()


def test_that_a_second_export_replaces_the_report(designed: MainWindow, until: Until, tmp_path: Path) -> None:
    first = export(designed, tmp_path / "a.dxf", until)
    designed.services.exporter.export(tmp_path / "b.svg")
    until(lambda: designed.dialogs.report is not first)
    report = designed.dialogs.report
    assert report is not None and report.shown.path.name == "b.svg"


def test_that_a_picture_has_no_report(designed: MainWindow, until: Until, tmp_path: Path) -> None:
    designed.services.exporter.export(tmp_path / "a.png")
    until(lambda: bool(designed.messages.messages))
    assert designed.messages.messages[-1].tone is Tone.DONE and designed.dialogs.report is None


@pytest.mark.parametrize(
    ("report", "said"), [(GOOD, "Verified, with 1 note"), (BAD, "Do not cut this file: 1 check failed.")]
)
def test_that_the_verdict_is_said_in_words(report: Verification, said: str) -> None:
    assert verdict(report).startswith(said)


def test_that_a_bad_finding_comes_first_with_its_own_word_and_symbol(qtbot: QtBot, designed: MainWindow) -> None:
    assert [line[:2] for line in format_findings(BAD)] == [("Bad", "fault"), ("Note", "warning"), ("Good", "check")]
    dialog = ExportReport(designed, (BAD,), LIGHT)
    assert dialog.findings.item(0).text() == "Bad: The file holds another number of points than planned."
    good = ExportReport(designed, (GOOD,), LIGHT)
    assert dialog.symbol.pixmap().toImage() != good.symbol.pixmap().toImage()
    for one in (dialog, good):
        one.deleteLater()


def test_that_the_copied_report_holds_every_line(designed: MainWindow, qtbot: QtBot) -> None:
    dialog = ExportReport(designed, (BAD,), LIGHT)
    dialog.copy.click()
    text = QApplication.clipboard().text()
    assert text == as_text(BAD) and "Time: 20\N{EN DASH}30 s" in text
    assert "Bad: The file holds another number of points than planned." in text
    dialog.deleteLater()


class Desktop(QObject):
    """Stands for the desktop that opens folders."""

    def __init__(self) -> None:
        super().__init__()
        self.opened: list[str] = []

    @Slot(QUrl)
    def show(self, url: QUrl) -> None:
        self.opened.append(url.toLocalFile())


def test_that_show_in_folder_opens_the_files_folder(
    designed: MainWindow, qtbot: QtBot, until: Until, tmp_path: Path
) -> None:
    report, desktop = export(designed, tmp_path / "cut.dxf", until), Desktop()
    QDesktopServices.setUrlHandler("file", desktop, "show")
    try:
        qtbot.mouseClick(report.folder, LEFT)
    finally:
        QDesktopServices.unsetUrlHandler("file")
    assert desktop.opened == [str(tmp_path)]


def test_that_the_chosen_profile_and_version_reach_the_file(designed: MainWindow, until: Until, tmp_path: Path) -> None:
    designed.services.fabrication.change(profile="lightburn", dxf_version="R12")
    export(designed, tmp_path / "cut.dxf", until)
    drawing = ezdxf.readfile(tmp_path / "cut.dxf")
    assert drawing.dxfversion == "AC1009"
    assert len({entity.dxf.color for entity in drawing.modelspace()}) == 3


def test_that_one_file_for_each_layer_is_reported_as_its_folder(
    designed: MainWindow, until: Until, tmp_path: Path
) -> None:
    designed.services.fabrication.change(profile="layers")
    report = export(designed, tmp_path / "cut.dxf", until)
    assert report.shown.ok and report.shown.path == tmp_path / "cut"
    assert len(list((tmp_path / "cut").iterdir())) == 3


def test_that_a_new_project_starts_with_the_machine_material_and_size_of_the_last_one(
    designed: MainWindow, until: Until, tmp_path: Path
) -> None:
    kept = tmp_path / "preferences.toml"
    designed.services.preferences.use(kept)
    assert not kept.exists() and designed.session.document.candidates
    designed.services.fabrication.change(profile="lightburn")
    designed.services.fabrication.change(material="card-co2", connector_mm=None, kerf_mm=None)
    designed.services.fabrication.set_opened_size(140.0)
    wanted = Preferences("lightburn", material="card-co2", opened_mm=140.0)
    assert preferences.load(kept) == wanted
    designed.services.project.new()
    fabrication = designed.session.document.fabrication
    assert (fabrication.profile, fabrication.material, fabrication.opened_mm) == ("lightburn", "card-co2", 140.0)
    assert not designed.session.history.unsaved
    designed.services.fabrication.change(width_mm=90.0)
    designed.services.project.new()
    assert designed.session.document.fabrication.width_mm == 90.0
    assert designed.session.document.fabrication.opened_mm is None


def test_that_a_cut_file_makes_its_machine_that_of_new_projects(
    designed: MainWindow, until: Until, tmp_path: Path
) -> None:
    kept = tmp_path / "preferences.toml"
    designed.services.preferences.use(kept)
    change = edits.set_fabrication(designed.session.document, profile="lightburn")
    designed.session.apply(change)  # as in a project that was opened: nobody chose it here
    assert not kept.exists()
    export(designed, tmp_path / "cut.dxf", until)
    assert preferences.load(kept) == Preferences("lightburn", "R2010")


def test_that_a_material_that_is_gone_gives_way_to_the_usual_one(window: MainWindow, tmp_path: Path) -> None:
    preferences.save(Preferences(material="my-lost-film"), tmp_path / "preferences.toml")
    window.services.preferences.use(tmp_path / "preferences.toml")
    assert window.session.document.fabrication.material == DEFAULT_PRESET


def test_that_the_window_starts_with_the_preferences(window: MainWindow, tmp_path: Path) -> None:
    preferences.save(Preferences("lightburn", "R12"), tmp_path / "preferences.toml")
    window.services.preferences.use(tmp_path / "preferences.toml")
    assert window.session.document == Preferences("lightburn", "R12").new_document() != Document()
    assert window.fabrication.options.dxf_version.currentData() == "R12"


@pytest.mark.parametrize(
    "content",
    [
        "profile = 3",
        "profile = ",
        'colour = "red"',
        "opened_mm = -3.0",
        'size = "both"',
        "width_mm = nan",
        "opened_mm = " + 5000 * "9",
        "material = " + 3000 * "[",
    ],
    ids=lambda text: text[:20],
)
def test_that_damaged_preferences_are_told_and_left_alone(window: MainWindow, tmp_path: Path, content: str) -> None:
    path = tmp_path / "preferences.toml"
    path.write_text(content, encoding="utf-8")
    with pytest.raises(ProjectError):
        preferences.load(path)
    window.services.preferences.use(path)
    window.services.preferences.remember(Preferences("lightburn").new_document())
    assert window.messages.messages[-1].tone is Tone.WARNING and path.read_text(encoding="utf-8") == content


def test_that_everything_goes_into_one_folder_with_a_report_for_each_cut_file(
    designed: MainWindow, files: object, qtbot: QtBot, until: Until, tmp_path: Path
) -> None:
    files.answer = tmp_path / "all"  # type: ignore[attr-defined]
    designed.fabrication.exports.everything.trigger()
    until(lambda: designed.dialogs.report is not None)
    report = designed.dialogs.report
    assert report is not None and report.file.isVisible() and report.file.count() == 3
    assert all(one.ok for one in report.verifications)
    assert report.file.itemText(1) == "Verified  \N{MIDDLE DOT}  heart-A1_r12.dxf"
    report.file.setCurrentIndex(1)
    assert report.path.text().endswith("heart-A1_r12.dxf") and report.verdict.text().startswith("Verified")
    assert {path.suffix for path in (tmp_path / "all").iterdir()} >= {".dxf", ".svg", ".pdf", ".png", ".lbrn2"}


def test_that_the_file_that_must_not_be_cut_is_shown_first(designed: MainWindow) -> None:
    dialog = ExportReport(designed, (GOOD, BAD), LIGHT)
    assert dialog.shown is BAD and dialog.file.itemText(1).startswith("Do not cut")
    dialog.deleteLater()


def test_that_another_file_is_shown_after_the_language_has_changed(
    window: MainWindow, english_afterwards: None
) -> None:
    """Before, the figures were known by their captions, in the language that was spoken when the report opened."""
    report = ExportReport(window, (GOOD, replace(BAD, path=Path("other.dxf"), pieces=3)), LIGHT)
    report.show()
    words.choose("de")
    report.file.setCurrentIndex(0)
    assert report.facts["Pieces"].text() == "1" and "Teile: 1" in report.text()
    report.file.setCurrentIndex(1)
    assert report.facts["Pieces"].text() == "3"
    report.close()
    report.deleteLater()
