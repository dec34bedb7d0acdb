"""What sheets look like while they are flat: the box, the designs that a run then makes, and their cut file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytestqt.qtbot import QtBot

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.stage.edge_cuts import moved, room_of
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.laying import laid_sheet
from kirigami_studio.lattice.sheet import RimPath, Sheet, anchor_points
from kirigami_studio.outlines.starts import RECTANGLE, start_shape
from kirigami_studio.pipeline.auto_grid import predicted_for
from kirigami_studio.project import edits, store
from kirigami_studio.project.document import Document
from kirigami_studio.studio.designing import request_for

Until = Callable[[Callable[[], bool]], None]
LISTED = ["auto", "rectangle", "square", "circle", "ellipse:3:2", "triangle", "hexagon"]


def choose(window: MainWindow, value: str) -> None:
    """Choose an entry of the box as the mouse does."""
    box = window.settings.start
    box.setCurrentIndex(box.findData(value))
    box.activated.emit(box.currentIndex())


def roundness(sheet: Sheet) -> float:
    """Largest over smallest distance of the flat sheet's corners and mouths from their middle."""
    assert sheet.start is not None
    radii = np.hypot(*(anchor_points(sheet) - 0.5 * (sheet.start.min(axis=0) + sheet.start.max(axis=0))).T)
    return float(radii.max() / radii.min())


def test_that_the_start_is_a_choice_of_named_outlines_and_one_undo_step(window: MainWindow) -> None:
    settings, session = window.settings, window.session
    assert [settings.start.itemData(row) for row in range(len(LISTED))] == LISTED
    assert settings.start.isVisible() and settings.start.currentText() == "Rectangle"
    names = ["rectangle", *LISTED[2:], "auto"]
    for name in names[1:]:
        choose(window, name)
        assert session.document.settings.start == start_shape(name)
        assert settings.start.currentData() == name and settings.start.itemData(LISTED.index(name), 3)
    assert session.history.undo_label == "Change the start outline"
    for name in reversed(names[:-1]):
        window.commands["undo"].trigger()
        assert settings.start.currentData() == name
    assert session.document.settings.start == RECTANGLE


def test_that_a_start_that_is_not_a_rectangle_can_be_held_more_softly(window: MainWindow) -> None:
    settings, session = window.settings, window.session
    settings.more.setChecked(True)
    weight = settings.start_weight
    assert not weight.isEnabled() and weight.value() == 1.0
    choose(window, "circle")
    assert weight.isEnabled()
    weight.setValue(0.05)
    weight.editingFinished.emit()
    assert session.document.settings.start == replace(start_shape("circle"), weight=0.05)
    assert settings.start.currentData() == "circle", "a listed start stays one at another weight"
    choose(window, "hexagon")
    assert session.document.settings.start == replace(start_shape("hexagon"), weight=0.05)
    window.commands["undo"].trigger()
    window.commands["undo"].trigger()
    assert session.document.settings.start == start_shape("circle") and weight.value() == 1.0
    window.commands["redo"].trigger()
    assert weight.value() == 0.05


def test_that_the_grid_to_be_chosen_follows_the_start(heart: MainWindow, until: Until) -> None:
    settings, session = heart.settings, heart.session
    until(lambda: settings.auto.accessibleDescription() != "")
    choose(heart, "ellipse:3:2")
    assert settings.auto.accessibleDescription() == ""  # it is being chosen again
    until(lambda: settings.auto.accessibleDescription() != "")
    document = session.document
    assert document.target is not None
    wanted = predicted_for(request_for(document.target, document.settings, document.fabrication))
    assert (settings.rows.value(), settings.columns.value()) == wanted.grid
    assert settings.auto.accessibleDescription() == wanted.reason


@pytest.mark.torch
def test_that_a_circle_gives_round_sheets_that_are_saved_and_cut(
    heart: MainWindow, files: object, qtbot: QtBot, until: Until, tmp_path: Path
) -> None:
    services = heart.services
    services.settings.change(grid=(4, 5))
    services.settings.change(k=2)
    services.settings.change(polish=3)
    choose(heart, "circle")
    heart.commands["generate"].trigger()
    until(lambda: not services.run.running and len(services.session.document.candidates) == 2)
    for candidate in services.session.document.candidates:
        assert roundness(candidate.final_sheet) < 1.0001
        assert candidate.final_sheet.grid == (4, 5)
    assert services.session.document.provenance["start"] == "circle"
    until(lambda: heart.fabrication.export.isEnabled())

    with qtbot.waitSignal(services.exporter.exported, timeout=60_000) as waited:
        services.exporter.export(tmp_path / "disk.dxf")
    (verification,) = waited.args[0].verifications
    width, height = verification.size_mm
    assert verification.ok and verification.path == tmp_path / "disk.dxf"
    assert abs(width - 100.0) < 0.5 and abs(height - 100.0) < 3.0  # as cuts meet the rim, its polygon is not as high

    files.answer = tmp_path / "disk.kiri"  # type: ignore[attr-defined]
    heart.commands["save_as"].trigger()
    until(lambda: not services.session.history.unsaved)
    saved = services.session.document
    assert store.load(tmp_path / "disk.kiri") == saved
    heart.commands["new"].trigger()
    assert heart.settings.start.currentText() == "Rectangle"
    services.project.open(tmp_path / "disk.kiri")
    until(lambda: services.session.stage is not None)
    assert services.session.document == saved and heart.settings.start.currentText() == "Circle"


def test_that_a_shape_of_the_library_is_a_start_under_its_own_name(window: MainWindow, until: Until) -> None:
    settings, session = window.settings, window.session
    choose(window, "library")
    assert settings.start.currentText() == "Rectangle"  # until one is chosen
    picker = window.dialogs.picker
    assert picker is not None and picker.isVisible()
    picker.chosen.emit("egg")
    picker.close()
    until(lambda: session.document.settings.start.name == "egg")
    assert settings.start.currentText() == "egg" and "egg" in settings.start.toolTip()
    choose(window, "loaded")
    assert session.document.settings.start.name == "egg" and len(session.history.steps) == 1
    choose(window, "hexagon")
    assert settings.start.findData("loaded") < 0
    window.commands["undo"].trigger()
    assert settings.start.currentText() == "egg"
    window.commands["undo"].trigger()
    assert settings.start.currentText() == "Rectangle"


def test_that_a_hollow_start_is_refused_with_the_place_and_changes_nothing(
    window: MainWindow, files: object, until: Until, tmp_path: Path
) -> None:
    before = window.session.document
    corner = tmp_path / "corner.svg"
    corner.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 4 4"><path d="M0 0H4V1H1V4H0Z"/></svg>', encoding="utf-8"
    )
    files.answer = corner  # type: ignore[attr-defined]
    choose(window, "file")
    until(lambda: bool(window.messages.messages))
    message = window.messages.messages[-1]
    assert message.tone is Tone.ERROR and "'corner' is hollow" in message.sentence
    assert window.session.document is before and window.settings.start.currentText() == "Rectangle"
    corner.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 4 4"><path d="M0 0H4V2L2 4H0Z"/></svg>', encoding="utf-8"
    )
    choose(window, "file")
    until(lambda: window.settings.start.currentText() == "corner")
    assert window.messages.messages == ()  # what was wrong no longer applies


@pytest.mark.parametrize("name", ["triangle", "hexagon", "circle"])
def test_that_edge_cuts_slide_between_the_corners_of_the_start(name: str) -> None:
    outline = start_shape(name).outline
    assert outline is not None
    sheet = laid_sheet(outline.points, 7, 7)
    held, here = RimPath(*sheet.grid, sheet.start).held, sheet.rim.positions
    assert held.any() == (name != "circle")
    for mouth in range(here.size):
        low, high = room_of(sheet, mouth)
        assert (low == here[mouth] == high) if held[mouth] else (low < here[mouth] < high)
        for far in (-9.0, 9.0):
            positions = moved(sheet, mouth, far).rim.positions  # a sheet whose cuts are out of order is refused
            assert np.array_equal(positions[held], here[held])


def test_that_an_edge_cut_at_a_corner_of_the_start_stays_there(heart: MainWindow, until: Until) -> None:
    services, target = heart.services, heart.session.document.target
    outline = start_shape("triangle").outline
    assert target is not None and outline is not None
    sheet = laid_sheet(outline.points, 6, 7)
    held = RimPath(*sheet.grid, sheet.start).held
    assert held.any() and not held.all()
    candidate = Candidate(sheet, evaluate(deploy(sheet), target, 0.0), seed=0, index=0)
    document = edits.set_candidates(Document(target), [candidate], {}).document
    services.session.restart(replace(document, chosen=0), None)
    until(lambda: services.session.stage is not None)
    services.hand.nudge_mouth(int(np.flatnonzero(held)[0]), 0.3)
    services.hand.commit()
    assert "holds a corner of the flat sheet" in heart.status_text.text()
    assert services.session.history.steps == () and services.session.document.candidates == (candidate,)
    free = int(np.flatnonzero(~held)[0])
    services.hand.nudge_mouth(free, 0.1)
    services.hand.commit()
    until(lambda: services.session.history.steps == ("Move edge cut",))
    moved = services.session.document.candidates[0].sheet
    assert abs(moved.rim.positions[free] - sheet.rim.positions[free] - 0.1) < 1e-9
