"""The start beside the target: its tile, the board it is drawn on, and the two ends that the slider runs between."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.foundation.errors import SheetError
from kirigami_studio.gui.gallery.gallery_model import START_ROLE
from kirigami_studio.gui.run.generation import own_start
from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.target.outline_board import StartBoard
from kirigami_studio.gui.target.sketch_context import Change
from kirigami_studio.gui.target.target_view import Tool
from kirigami_studio.gui.widgets.readable import TIMES
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.outlines import silhouettes
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.placed import Placed
from kirigami_studio.outlines.starts import RECTANGLE, StartShape, outline_start, start_shape
from kirigami_studio.polish.flat_sheet import first_sheet, uniform_sheet
from kirigami_studio.project import edits
from kirigami_studio.project.document import Document
from kirigami_studio.studio.two_states import size_words, start_words, starts_as

Until = Callable[[Callable[[], bool]], None]
HOLLOW = [(-40.0, -30.0), (40.0, -30.0), (40.0, 30.0), (0.0, -20.0), (-40.0, 30.0)]
SHALLOW = [(-40.0, -30.0), (40.0, -30.0), (40.0, 30.0), (0.0, 0.0), (-40.0, 30.0)]
#: A square with a slit from above, as wide as a twentieth of a side: 8 x 8 voids unfold around it, 6 x 6 do not.
SLOTTED = [(0.0, 0.0), (40.0, 0.0), (40.0, 40.0), (21.0, 40.0), (21.0, 10.0), (19.0, 10.0), (19.0, 40.0), (0.0, 40.0)]
HOUSE = [(-40.0, -30.0), (40.0, -30.0), (40.0, 30.0), (0.0, 50.0), (-40.0, 30.0)]


def draw(board: StartBoard, ring: list[tuple[float, float]]) -> None:
    """Draw a polygon as its tool does once it is closed."""
    board.view.context.changed.emit(Change("Draw polygon", lambda: Placed.from_ring(ring, "polygon")))


def drop(window: MainWindow, path: Path) -> None:
    """Let a file fall on the tile."""
    content = QMimeData()
    content.setUrls([QUrl.fromLocalFile(str(path))])
    copy, left, none = Qt.DropAction.CopyAction, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    tile = window.target.start
    QApplication.sendEvent(tile, QDragEnterEvent(QPoint(20, 20), copy, content, left, none))
    assert tile.drops.here
    QApplication.sendEvent(tile, QDropEvent(QPointF(20, 20), copy, content, left, none))
    assert not tile.drops.here


@pytest.fixture(scope="module")
def of_two_starts() -> Document:
    """Uniform sheets of 5 x 6 voids for the heart: one of a circle, one of a rectangle; the settings say hexagon."""
    target, found = silhouettes.load("heart"), []
    for number, name in enumerate(("circle", "rectangle")):
        sheet = uniform_sheet((5, 6), start_shape(name))
        run = () if name == "rectangle" else (("start", name),)
        found.append(Candidate(sheet, evaluate(deploy(sheet), target, 0.0), 0, number, made_with=run))
    begun = edits.set_target(Document(), target).document
    document = edits.set_candidates(begun, found, {}).document
    return edits.set_settings(replace(document, chosen=0), start=start_shape("hexagon")).document


def test_that_the_tile_names_the_start_and_its_size_and_goes_back_in_one_click(window: MainWindow) -> None:
    tile, services = window.target.start, window.services
    assert tile.isVisible() and tile.name == "rectangle" and not tile.back.isVisible()
    tile.entries["ellipse:3:2"].trigger()
    assert services.session.document.settings.start == start_shape("ellipse:3:2")
    assert (tile.name, tile.size_text) == ("ellipse 3:2", f"100 {TIMES} 66.7 mm")
    assert window.settings.start.currentText() == "Ellipse 3:2" and tile.back.isVisible()
    services.fabrication.change(width_mm=60.0)
    assert tile.size_text == f"60 {TIMES} 40 mm" and f"60 {TIMES} 40 mm" in tile.accessibleName()
    tile.back.click()
    assert services.session.document.settings.start == RECTANGLE and services.session.history.undo_label == (
        "Change the start outline"
    )
    window.commands["undo"].trigger()
    assert tile.name == "ellipse 3:2"
    tile.setFocus()
    QTest.keyClick(tile, Qt.Key.Key_Delete)
    assert tile.name == "rectangle" and not tile.back.isVisible()
    window.settings.rows.setValue(9)
    window.settings.columns.setValue(19)
    assert tile.size_text == f"60 {TIMES} 30 mm"  # ten cells by twenty


def test_that_the_tile_opens_its_list_by_mouse_and_keys_also_beside_the_board(window: MainWindow) -> None:
    tile = window.target.start
    tile.click()
    assert tile.menu.isVisible()
    tile.menu.close()
    tile.setFocus()
    QTest.keyClick(tile, Qt.Key.Key_Return)
    assert tile.menu.isVisible() and not tile.entries["circle"].icon().isNull()
    tile.menu.close()
    window.pages.turn(WindowPage.SHAPE)
    assert tile.isVisible() and window.target.view.width() > 4 * tile.width()
    tile.click()
    assert tile.menu.isVisible()
    tile.menu.close()


def test_that_a_file_that_falls_on_the_tile_is_the_start_and_a_hollow_one_is_refused(
    window: MainWindow, until: Until, tmp_path: Path
) -> None:
    drawn = tmp_path / "lens.svg"
    text = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 4 4"><path d="{}"/></svg>'
    drawn.write_text(text.format("M0 0H4V4H3V1H0Z"), encoding="utf-8")
    drop(window, drawn)
    until(lambda: bool(window.messages.messages))
    assert "'lens' is hollow" in window.messages.messages[-1].sentence
    assert window.messages.messages[-1].tone is Tone.ERROR and window.target.start.name == "rectangle"
    drawn.write_text(text.format("M0 0H4V2H0Z"), encoding="utf-8")
    drop(window, drawn)
    until(lambda: window.target.start.name == "lens")
    assert window.target.start.size_text == f"100 {TIMES} 50 mm" and window.target.view.outline is None


def test_that_a_start_is_drawn_on_its_own_board_which_says_where_it_is_hollow(window: MainWindow, until: Until) -> None:
    window.target.start.entries["draw"].trigger()
    board = window.dialogs.start_board
    assert board is not None and board.isVisible() and not board.take.isEnabled()
    assert board.view.tool is Tool.POLYGON and not board.tools.buttons[Tool.STAR].isVisible()
    draw(board, HOLLOW)
    assert not board.take.isEnabled()
    assert "deepest at 50 % of its width from the left and 17 % of its height from below" in board.about.text()
    (hollow,) = board.view.hollows
    assert shapely.Polygon(hollow).area == pytest.approx(2000.0 / 2800.0)  # of the area of what was drawn
    draw(board, SHALLOW)
    assert board.take.isEnabled() and board.view.hollows == ()
    draw(board, HOUSE)
    assert board.take.isEnabled() and board.view.hollows == ()
    board.undo.click()
    board.undo.click()
    assert not board.take.isEnabled() and window.session.history.steps == ()
    board.redo.click()
    board.redo.click()
    board.take.click()
    until(lambda: window.target.start.name == "polygon")
    assert window.target.start.size_text == f"100 {TIMES} 100 mm" and not board.isVisible()
    assert window.session.history.steps == ("Change the start outline",)
    assert window.session.document.target is None  # the target's board is another one
    window.settings.other_start_wanted.emit("draw")
    assert board.placed is not None and len(board.placed.outline.points) == 5  # to go on from
    board.cancel.click()
    assert window.target.start.name == "polygon"
    window.commands["undo"].trigger()
    assert window.target.start.name == "rectangle"


def test_that_board_and_panel_say_what_the_next_run_would_refuse(heart: MainWindow, until: Until) -> None:
    services = heart.services
    services.settings.change(grid=(6, 6))
    heart.target.start.entries["draw"].trigger()
    board = heart.dialogs.start_board
    assert board is not None
    draw(board, SLOTTED)
    assert board.about.text().startswith("Checking") and board.take.isEnabled()
    until(lambda: not board.about.text().startswith("Checking"))
    with pytest.raises(SheetError) as problem:
        first_sheet((6, 6), outline_start(Outline.from_points(SLOTTED, "polygon")))
    refusal = str(problem.value)
    assert board.about.text() == refusal and board.about.objectName() == "warning"
    assert "25 % of its height from below" in refusal and len(board.view.hollows) == 1
    assert board.take.isEnabled()  # another grid may do
    board.take.click()
    until(lambda: heart.target.start_refusal.isVisible())
    assert heart.target.start_refusal.text() == refusal
    assert heart.target.start_refusal.drawn_text() == "The start folds on this grid"
    services.settings.change(grid=(8, 8))
    until(lambda: heart.settings.auto.accessibleDescription() != "")  # it was read anew
    assert not heart.target.start_refusal.isVisible()
    heart.target.start.entries["draw"].trigger()
    until(lambda: board.about.text().startswith("It can be the start"))
    assert board.about.objectName() == "muted" and board.view.hollows == ()
    board.reject()


@pytest.mark.torch
def test_that_the_run_refuses_it_in_the_same_words(heart: MainWindow, until: Until) -> None:
    services = heart.services
    services.settings.change(grid=(4, 4))
    services.start.take(Outline.from_points(SLOTTED, "polygon"))
    until(lambda: heart.target.start_refusal.isVisible())
    heart.commands["generate"].trigger()
    until(lambda: bool(heart.messages.messages) and not services.run.running)
    assert heart.messages.messages[-1].sentence == heart.target.start_refusal.text()


def test_that_the_ends_of_the_slider_name_both_states_with_size_and_match(
    window: MainWindow, until: Until, of_two_starts: Document
) -> None:
    services, ends = window.services, window.stage.ends
    assert not ends.isVisible()
    window.resize(1600, 900)
    services.session.restart(of_two_starts, None)
    until(lambda: services.session.stage is not None)
    assert services.session.stage is not None and ends.isVisible()
    deployment, score = services.session.stage.design.deployment, services.session.stage.candidate.score

    flat = shapely.Polygon(deployment.compact[deployment.topology.outline_nodes])
    disk = shapely.Point(flat.centroid).buffer(math.sqrt(flat.area / math.pi), quad_segs=720)
    match = 100.0 * flat.intersection(disk).area / flat.union(disk).area
    low_x, low_y, high_x, high_y = flat.bounds
    height = 100.0 * (high_y - low_y) / (high_x - low_x)
    assert ends.start.drawn_text() == f"flat: circle  ·  100 {TIMES} {height:.0f} mm  ·  match {match:.1f} %"
    opened = np.ptp(deployment.nodes(0.0), axis=0) * 100.0 / (high_x - low_x)
    said = ends.target.accessibleName()
    assert said.startswith("open: heart") and said.endswith(f"match {100 * score.iou_exact:.1f} %")
    width_mm = float(said.split()[3])
    assert width_mm == pytest.approx(opened[0], rel=0.15)  # the heart's, which an unfitted sheet is near to
    assert "circle 9" in window.facts.text()

    ends.start.click()
    assert window.stage.deployment.slider.phi == math.pi
    ends.target.click()
    assert window.stage.deployment.slider.phi == 0.0
    services.fabrication.change(width_mm=50.0)
    assert f"50 {TIMES} {0.5 * height:.1f} mm" in ends.start.accessibleName()


def test_that_a_design_keeps_its_own_start_whatever_the_settings_say(
    window: MainWindow, until: Until, of_two_starts: Document
) -> None:
    services, model = window.services, window.gallery.view.model_
    services.session.restart(of_two_starts, None)
    until(lambda: services.session.stage is not None)
    assert window.target.start.name == "hexagon"  # of the next run
    for place, name in enumerate(("circle", "rectangle")):
        services.chosen.choose(of_two_starts.candidates[place])
        assert window.stage.ends.start.accessibleName().startswith(f"flat: {name}  ·  ")
        row = model.index(model.row_of(of_two_starts.candidates[place]), 0)
        assert row.data(START_ROLE) == name
        assert f"Flat: {name}, 100 {TIMES} " in row.data(Qt.ItemDataRole.ToolTipRole)
    services.session.restart(replace(of_two_starts, candidates=of_two_starts.candidates[:1], marks=(), labels=()), None)
    until(lambda: len(model.entries) == 1)
    assert model.index(0, 0).data(START_ROLE) == ""  # nothing to tell apart


def test_that_the_tile_tells_the_size_of_the_design_on_the_stage_where_it_starts_so(
    window: MainWindow, until: Until, of_two_starts: Document
) -> None:
    services, tile = window.services, window.target.start
    plain = edits.set_settings(of_two_starts, start=RECTANGLE).document
    services.session.restart(replace(plain, settings=replace(plain.settings, grid=(4, 14))), None)
    until(lambda: services.session.stage is not None)
    of_the_next = tile.size_text  # the circle is on the stage
    assert of_the_next == f"100 {TIMES} 33.3 mm" and "on the stage" not in tile.toolTip()
    services.chosen.choose(of_two_starts.candidates[1])
    assert services.session.stage is not None
    across, up = np.ptp(services.session.stage.design.deployment.compact, axis=0).tolist()
    assert tile.size_text == f"100 {TIMES} {100 * up / across:.3g} mm" != of_the_next
    assert tile.size_text in window.stage.ends.start.accessibleName() and "on the stage" in tile.toolTip()
    services.fabrication.change(width_mm=50.0)
    assert tile.size_text == f"50 {TIMES} {50 * up / across:.3g} mm"
    services.targeting.clear()
    until(lambda: services.session.stage is None)
    assert "on the stage" not in tile.toolTip()


@pytest.mark.torch
def test_that_a_pinned_design_keeps_its_start_beside_those_of_the_next_run(heart: MainWindow, until: Until) -> None:
    services, model = heart.services, heart.gallery.view.model_
    for changes in ({"grid": (4, 5)}, {"k": 2}, {"polish": 0}):
        services.settings.change(**changes)
    heart.target.start.entries["circle"].trigger()
    heart.commands["generate"].trigger()
    until(lambda: not services.run.running and len(services.session.document.candidates) == 2)
    pinned = services.session.document.candidates[0]
    services.marks.pin(pinned)
    heart.target.start.entries["hexagon"].trigger()
    heart.commands["generate"].trigger()
    until(lambda: not services.run.running and len(services.session.document.candidates) == 3)
    names = [model.index(row, 0).data(START_ROLE) for row in range(len(model.entries))]
    assert sorted(names) == ["circle", "hexagon", "hexagon"]
    services.chosen.choose(pinned)
    assert heart.stage.ends.start.accessibleName().startswith("flat: circle  ·  ")
    assert heart.target.start.name == "hexagon"


@pytest.mark.parametrize("name", ["circle", "rectangle", "rectangle:2:1", "hexagon"])
def test_that_designs_like_another_start_as_that_one(name: str) -> None:
    """They lie near its sheet, so that the settings' start would be a wrong name for theirs."""
    target, start = silhouettes.load("heart"), start_shape(name)
    sheet = uniform_sheet((5, 6), start)
    candidate = Candidate(sheet, evaluate(deploy(sheet), target, 0.0), 0, 0, made_with=(("start", name),))
    assert own_start(candidate, start) is start
    other = own_start(candidate, start_shape("triangle"))
    assert other.name == name
    again = uniform_sheet((5, 6), other)
    assert again.cell == pytest.approx(sheet.cell)
    assert (again.start is None) == (sheet.start is None)
    if sheet.start is not None and again.start is not None:
        one, two = (shapely.Polygon(points - points.mean(axis=0)) for points in (sheet.start, again.start))
        assert one.symmetric_difference(two).area < 1e-3 * one.area


@pytest.mark.parametrize(
    ("size", "words"),
    [
        ((100.0, 93.75), f"100 {TIMES} 93.8 mm"),
        ((130.31, 117.8), f"130 {TIMES} 118 mm"),
        ((1e4, 4.0), f"10000 {TIMES} 4 mm"),
    ],
)
def test_that_sizes_are_told_as_exactly_as_they_are_read(size: tuple[float, float], words: str) -> None:
    assert size_words(*size) == words


@pytest.mark.parametrize(
    ("name", "words"),
    [("ellipse:3:2", "ellipse 3:2"), ("polygon:5", "polygon 5"), ("egg", "egg")],
)
def test_that_names_of_starts_are_words(name: str, words: str) -> None:
    assert start_words(name) == words


def test_that_a_design_starts_as_its_own_outline_and_not_as_another_of_the_same_name(designed: MainWindow) -> None:
    candidate = designed.session.document.candidates[0]
    corners = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 4.0)]
    drawn, other = (
        StartShape("drawing", Outline.from_points([(side * x, y) for x, y in corners], name="drawing"))
        for side in (1.0, 2.0)
    )
    made = replace(candidate, made_with=(("start", "drawing"), ("start_sha256", drawn.digest)))
    assert starts_as(made, drawn) and not starts_as(made, other)
    assert starts_as(candidate, RECTANGLE) and not starts_as(made, RECTANGLE)
