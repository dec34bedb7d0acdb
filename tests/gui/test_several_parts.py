"""A logo of two parts in the window: chosen, designed, shown, saved and exported as two sheets in one cut file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot

from kirigami_studio.export.dxf_check import check_file
from kirigami_studio.gui.run.part_bar import text_of
from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.target.part_picker import PartPicker
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.outlines.merging import Join
from kirigami_studio.pipeline.events import Result
from kirigami_studio.project import edits
from kirigami_studio.project.sheet_size import size_of
from kirigami_studio.project.target_parts import parts_as_cut
from kirigami_studio.settings.design import DesignSettings
from kirigami_studio.studio.making import ExportedFiles

Until = Callable[[Callable[[], bool]], None]
#: A stroke with a dot above it, as an "i", 20 mm and 12 mm wide.
LETTER = '<circle id="dot" cx="20" cy="16" r="6"/><rect id="stem" x="10" y="30" width="20" height="24"/>'


@pytest.fixture
def letter(tmp_path: Path) -> Path:
    path = tmp_path / "letter.svg"
    size = 'width="40mm" height="60mm" viewBox="0 0 40 60"'
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{LETTER}</svg>', encoding="utf-8")
    return path


def picker_of(window: MainWindow, until: Until) -> PartPicker:
    until(lambda: window.dialogs.parts is not None and window.dialogs.parts.isVisible())
    picker = window.dialogs.parts
    assert picker is not None
    until(lambda: not picker._job.busy)
    return picker


@pytest.fixture
def taken(window: MainWindow, letter: Path, until: Until) -> MainWindow:
    """A window with both parts of the letter as its target."""
    window.files.open(str(letter))
    picker = picker_of(window, until)
    picker.all.click()
    picker.join.choose(Join.EACH)
    until(lambda: not picker._job.busy)
    assert picker.size_.text() == "The target will be 2 sheets: dot, stem."
    assert picker.view.transform is not None  # both are drawn
    picker.take.click()
    until(lambda: window.session.document.target is not None)
    return window


@pytest.fixture
def both(taken: MainWindow, until: Until) -> MainWindow:
    """The same with designs for both parts, from one press of Generate."""
    session = taken.session
    settings = DesignSettings((3, 3), auto_grid=False, k=2, polish=0, search=0)
    session.apply(edits.Edit("", replace(session.document, settings=settings)))
    taken.run.generate.click()
    assert not taken.pages.parts.isEnabled()
    until(lambda: not taken.services.run.running and all(part.candidates for part in session.document.parts))
    return taken


def test_that_all_parts_are_one_target_in_one_step_and_the_bar_names_them(taken: MainWindow) -> None:
    document = taken.session.document
    assert [part.target.name for part in document.parts if part.target] == ["dot", "stem"]
    assert document.part == 0 and len(taken.session.history.steps) == 1
    bar = taken.pages.parts
    assert bar.isVisible() and [bar.tabText(at) for at in range(bar.count())] == [
        "dot  ·  no design yet",
        "stem  ·  no design yet",
    ]
    taken.services.project.undo()
    assert taken.session.document.target is None and not bar.isVisible()


def test_that_a_tab_shows_its_part_at_the_scale_of_all(taken: MainWindow) -> None:
    taken.pages.parts.setCurrentIndex(1)
    document = taken.session.document
    assert document.target is not None and document.target.name == "stem" and document.part == 1
    assert taken.target.view.outline is not None
    sizes = [max(size_of(part).opened) for part in parts_as_cut(document)]
    assert sizes == pytest.approx([12.0, 24.0], rel=1e-3)
    taken.services.fabrication.set_opened_size(48.0)
    wider = [max(size_of(part).opened) for part in parts_as_cut(taken.session.document)]
    assert wider == pytest.approx([24.0, 48.0], rel=1e-3)
    taken.services.project.undo()
    taken.services.project.undo()
    assert taken.pages.parts.currentIndex() == 0


def test_that_starts_and_second_targets_are_never_several(window: MainWindow, letter: Path, until: Until) -> None:
    window.target.start.drops.file_dropped.emit(str(letter))
    picker = picker_of(window, until)
    assert picker.join.row_of(Join.EACH) < 0
    picker.reject()
    window.files.open(str(letter))
    assert picker_of(window, until).join.row_of(Join.EACH) >= 0


@pytest.mark.torch
def test_that_one_press_designs_every_part_and_one_export_cuts_them_all(
    both: MainWindow, tmp_path: Path, until: Until, qtbot: QtBot
) -> None:
    session, bar = both.session, both.pages.parts
    document = session.document
    assert document.part == 0 and bar.isEnabled() and bar.currentIndex() == 0
    assert [len(part.candidates) for part in document.parts] == [2, 2]
    assert [bar.tabText(at) for at in range(2)] == [text_of(part) for part in document.parts]
    assert session.stage is not None and session.stage.candidate == document.candidate
    until(lambda: both.fabrication.export.isEnabled())
    path, found = tmp_path / "letter.dxf", list[ExportedFiles]()
    both.services.exporter.exported.connect(found.append)
    both.services.exporter.export(path)
    until(lambda: bool(found))
    (exported,) = found
    assert [part.part for part in exported.parts] == ["dot", "stem"] and exported.ok
    report = check_file(path)
    assert report.ok and report.pieces == 2 and len(report.sheets) == 2
    assert both.dialogs.report is not None
    names = [both.dialogs.report.file.itemText(row) for row in range(both.dialogs.report.file.count())]
    assert [name.endswith(part) for name, part in zip(names, ("dot", "stem"), strict=True)] == [True, True]
    assert any(message.tone in (Tone.DONE, Tone.WARNING) for message in both.messages.messages)
    # The cut file opens as the project of both.
    both.dialogs.close_report()
    project = tmp_path / "letter.kiri"
    both.services.project.save(project)
    until(lambda: not session.history.unsaved)
    both.services.project.open(path)
    until(lambda: session.path != project or len(session.document.candidates) == 1)
    assert [len(part.candidates) for part in session.document.parts] == [1, 1]


@pytest.mark.torch
@pytest.mark.parametrize("kind", ["png", "gif", "html"])
def test_that_a_picture_from_the_window_shows_all_parts(
    both: MainWindow, tmp_path: Path, until: Until, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    shown: list[int] = []
    module = {"png": "picture", "gif": "animation", "html": "share_page"}[kind]
    name = {"png": "png", "gif": "animation", "html": "page"}[kind]
    monkeypatch.setattr(
        f"kirigami_studio.export.{module}.write_parts_{name}",
        lambda parts, path: (shown.append(len(parts)), path.write_bytes(b"-")),
    )
    found = list[ExportedFiles]()
    both.services.exporter.exported.connect(found.append)
    until(lambda: both.fabrication.export.isEnabled())
    both.services.exporter.export(tmp_path / f"letter.{kind}")
    until(lambda: bool(found))
    assert shown == [2] and found[0].files == (tmp_path / f"letter.{kind}",)
    assert both.messages.messages[-1].tone is Tone.DONE


@pytest.mark.torch
def test_that_generate_again_is_for_the_part_that_is_shown_alone(both: MainWindow, until: Until) -> None:
    session = both.session
    before = session.document.parts
    both.pages.parts.setCurrentIndex(1)
    both.services.settings.change(seed=77)
    both.services.generation.generate()
    until(lambda: not both.services.run.running and session.document.candidates != before[1].candidates)
    assert session.document.part == 1
    assert session.document.parts[0].candidates == before[0].candidates


@pytest.mark.torch
def test_that_a_stopped_run_leaves_the_other_parts_for_the_next_one(taken: MainWindow, until: Until) -> None:
    session = taken.session
    settings = DesignSettings((3, 3), auto_grid=False, k=100, polish=0, search=0)
    session.apply(edits.Edit("", replace(session.document, settings=settings)))
    taken.services.generation.generate()
    until(lambda: taken.services.run.so_far() is not None)
    taken.services.generation.cancel()
    assert not taken.services.run.running and session.document.part == 0
    assert not any(part.candidates for part in session.document.parts)
    assert taken.pages.parts.isEnabled()


@pytest.mark.torch
def test_that_parts_of_one_shape_and_size_are_designed_once(window: MainWindow, tmp_path: Path, until: Until) -> None:
    dots = "".join(f'<rect id="d{at}" x="{20 * at}" y="0" width="12" height="12"/>' for at in range(3))
    path = tmp_path / "dots.svg"
    size = 'width="60mm" height="12mm" viewBox="0 0 60 12"'
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{dots}</svg>', encoding="utf-8")
    window.files.open(str(path))
    picker = picker_of(window, until)
    picker.all.click()
    picker.join.choose(Join.EACH)
    until(lambda: not picker._job.busy)
    picker.take.click()
    session, runs = window.session, list[Result]()
    until(lambda: len(session.document.parts) == 3)
    settings = DesignSettings((3, 3), auto_grid=False, k=2, polish=0, search=0)
    session.apply(edits.Edit("", replace(session.document, settings=settings)))
    window.services.generation.run.completed.connect(lambda result, _: runs.append(result))
    window.run.generate.click()
    until(lambda: not window.services.run.running and all(part.candidates for part in session.document.parts))
    assert len(runs) == 1 and session.document.part == 0
    assert {part.candidates for part in session.document.parts} == {session.document.candidates}
    assert [part.target.name for part in session.document.parts if part.target] == ["d0", "d1", "d2"]
    # One step back, and none of them has designs.
    window.services.project.undo()
    assert not any(part.candidates for part in session.document.parts)
