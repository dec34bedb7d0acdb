"""Every way to a target: library, file, drop, stroke, polygon; and what happens when it fails."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.window.application import open_first
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.outlines import silhouettes

Until = Callable[[Callable[[], bool]], None]
LEFT = Qt.MouseButton.LeftButton


def at(x: float, y: float) -> QPoint:
    """A place in a widget, pixels."""
    return QPoint(round(x), round(y))


def test_that_a_silhouette_is_found_by_typing_its_name_in_the_library(
    window: MainWindow, qtbot: QtBot, until: Until
) -> None:
    qtbot.mouseClick(window.target.buttons["library"], LEFT)
    picker = window.dialogs.picker
    assert picker is not None and picker.list.count() == len(silhouettes.names()) >= 24
    qtbot.keyClicks(picker.search, "hexag")
    qtbot.keyClick(picker.search, Qt.Key.Key_Return)
    until(lambda: window.target.view.outline is not None)
    assert window.session.document.target == silhouettes.load("hexagon")
    assert window.run.generate.isEnabled()


@pytest.mark.parametrize(("typed", "found"), [("herz", "heart"), ("heart", "heart"), ("letter-l", "letter-l")])
def test_that_the_library_knows_its_names_in_german_and_those_of_the_command_line(
    typed: str, found: str, german: None, window: MainWindow, qtbot: QtBot, until: Until
) -> None:
    window.commands["library"].trigger()
    picker = window.dialogs.picker
    assert picker is not None
    qtbot.keyClicks(picker.search, typed)
    qtbot.keyClick(picker.search, Qt.Key.Key_Return)
    until(lambda: window.session.document.target == silhouettes.load(found))


def test_that_the_library_prefers_the_title_that_fits_best(window: MainWindow, qtbot: QtBot, until: Until) -> None:
    window.commands["library"].trigger()
    picker = window.dialogs.picker
    assert picker is not None
    qtbot.keyClicks(picker.search, "star")
    assert sum(not picker.list.item(row).isHidden() for row in range(picker.list.count())) > 1
    qtbot.keyClick(picker.search, Qt.Key.Key_Return)
    until(lambda: window.session.document.target is not None)
    assert window.session.document.target == silhouettes.load("star")


def test_that_the_key_that_opens_the_library_chooses_nothing_in_it(window: MainWindow, until: Until) -> None:
    window.dialogs.show_start_library(window.settings.start)
    picker = window.dialogs.picker
    assert picker is not None
    chosen: list[str] = []
    picker.chosen.connect(chosen.append)
    QTest.keyClick(picker, Qt.Key.Key_Return)  # on its way since the list of starts
    assert chosen == [] and picker.isVisible()
    QApplication.processEvents()
    QTest.keyClick(picker, Qt.Key.Key_Return)
    assert len(chosen) == 1
    until(lambda: not window.session.queue.busy)


def test_that_the_first_target_is_no_unsaved_change(window: MainWindow, until: Until) -> None:
    open_first(window, "heart")
    until(lambda: window.target.view.outline is not None)
    assert not window.session.history.unsaved and not window.commands["undo"].isEnabled()
    open_first(window, "star")
    until(lambda: window.session.document.target == silhouettes.load("star"))
    assert window.session.history.unsaved


def test_that_a_library_picture_is_chosen_by_click(window: MainWindow, qtbot: QtBot, until: Until) -> None:
    window.commands["library"].trigger()
    picker = window.dialogs.picker
    assert picker is not None
    item = picker.list.item(2)
    qtbot.mouseClick(picker.list.viewport(), LEFT, pos=picker.list.visualItemRect(item).center())
    until(lambda: window.session.document.target is not None)
    assert window.session.document.target == silhouettes.load(silhouettes.names()[2])


def test_that_an_image_file_becomes_the_target(window: MainWindow, files: object, tmp_path: Path, until: Until) -> None:
    path = tmp_path / "blob.png"
    y, x = np.mgrid[-1:1:96j, -1:1:96j]
    Image.fromarray(np.where(x**2 + (y / 0.6) ** 2 < 0.6, 0, 255).astype(np.uint8)).save(path)
    files.answer = path  # type: ignore[attr-defined]
    window.commands["open_target"].trigger()
    until(lambda: window.session.document.target is not None)
    width, height = np.ptp(window.session.document.target.points, axis=0)  # type: ignore[union-attr]
    assert width / height == pytest.approx(1 / 0.6, rel=0.05)
    assert "blob" in window.target.facts.text()


@pytest.mark.parametrize("on_target", [True, False])
def test_that_a_dropped_file_is_opened(window: MainWindow, tmp_path: Path, until: Until, on_target: bool) -> None:
    path = tmp_path / "square.json"
    path.write_text("[[0, 0], [2, 0], [2, 1], [0, 1]]", encoding="utf-8")
    mime = QMimeData()
    mime.setUrls([QUrl.fromLocalFile(str(path))])
    place, copy, plain = QPoint(30, 30), Qt.DropAction.CopyAction, Qt.KeyboardModifier.NoModifier
    receiver = window.target.view if on_target else window
    QApplication.sendEvent(receiver, QDragEnterEvent(place, copy, mime, LEFT, plain))
    QApplication.sendEvent(receiver, QDropEvent(QPointF(place), copy, mime, LEFT, plain))
    until(lambda: window.session.document.target is not None)
    assert len(window.session.document.target.points) == 4  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("name", "content"),
    [("empty.png", b""), ("text.svg", b"not an svg"), ("broken.dxf", b"0\nSECTION\n"), ("numbers.json", b"[1, 2]")],
)
def test_that_a_bad_file_leads_to_a_message_and_changes_nothing(
    heart: MainWindow, until: Until, tmp_path: Path, name: str, content: bytes
) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    before = heart.session.document
    heart.services.targeting.open(str(path))
    until(lambda: heart.messages.isVisible())
    message = heart.messages.messages[-1]
    assert message.tone is Tone.ERROR and message.sentence.endswith(".") and "Traceback" not in message.sentence
    assert "Traceback" in message.details
    assert heart.session.document is before


def test_that_messages_are_kept_until_closed_and_tell_details_on_demand(
    heart: MainWindow, until: Until, qtbot: QtBot
) -> None:
    for name in ("no such thing", "nor this one"):
        count = len(heart.messages.messages)
        heart.services.targeting.open(name)
        until(lambda count=count: len(heart.messages.messages) > count)  # type: ignore[misc]
    bar = heart.messages
    assert "nor this one" in bar.sentence.text() and bar.position.text() == "2 of 2"
    assert not bar.trace.isVisible()
    qtbot.mouseClick(bar.details, LEFT)
    assert bar.trace.isVisible() and "TargetError" in bar.trace.toPlainText()
    qtbot.mouseClick(bar.previous, LEFT)
    assert "no such thing" in bar.sentence.text()
    qtbot.mouseClick(bar.copy, LEFT)
    assert "no such thing" in QApplication.clipboard().text()
    qtbot.mouseClick(bar.close_button, LEFT)
    qtbot.mouseClick(bar.close_button, LEFT)
    assert bar.messages == () and not bar.isVisible()


def test_that_a_target_that_is_read_ends_what_was_said_of_those_that_were_not(
    heart: MainWindow, until: Until, tmp_path: Path
) -> None:
    bar = heart.messages
    bar.add(Message("The disk is full; free some space.", Tone.ERROR))
    (tmp_path / "nothing.svg").touch()
    for count, name in enumerate(("no such thing", str(tmp_path / "nothing.svg")), 2):
        heart.services.targeting.open(name)
        until(lambda count=count: len(bar.messages) == count)  # type: ignore[misc]
    assert bar.sentence.text().startswith("nothing.svg is empty")
    heart.services.targeting.open("star")
    until(lambda: len(bar.messages) == 1)
    assert bar.sentence.text().startswith("The disk is full")


def test_that_several_messages_are_closed_at_once(heart: MainWindow, qtbot: QtBot) -> None:
    bar = heart.messages
    bar.add(Message("The first did not succeed; try again.", Tone.ERROR))
    assert bar.isVisible() and not bar.close_all_button.isVisible()
    bar.add(Message("The second did not succeed; try again.", Tone.WARNING))
    qtbot.mouseClick(bar.close_all_button, LEFT)
    assert bar.messages == () and not bar.isVisible()


def test_that_a_stroke_of_the_mouse_becomes_a_smooth_target(window: MainWindow, qtbot: QtBot) -> None:
    view = window.target.view
    qtbot.keyClick(window, Qt.Key.Key_D)
    centre, radius = view.rect().center(), 0.35 * min(view.width(), view.height())
    angles = np.linspace(0, 1.97 * math.pi, 70)
    places = [at(centre.x() + radius * math.cos(a), centre.y() + 0.7 * radius * math.sin(a)) for a in angles]
    qtbot.mousePress(view, LEFT, pos=places[0])
    for place in places[1:]:
        qtbot.mouseMove(view, place)
    qtbot.mouseRelease(view, LEFT, pos=places[-1])
    target = window.session.document.target
    assert target is not None and target.name == "drawing"
    width, height = np.ptp(target.points, axis=0)
    assert width / height == pytest.approx(1 / 0.7, rel=0.08)
    assert not window.target.buttons["freehand"].isChecked() and window.target.editing


def test_that_clicked_corners_become_a_polygon_the_right_way_up(window: MainWindow, qtbot: QtBot) -> None:
    view = window.target.view
    qtbot.mouseClick(window.target.buttons["edit"], LEFT)
    qtbot.mouseClick(window.target.buttons["polygon"], LEFT)
    corners = [(60, 40), (60, 140), (140, 140), (150, 60)]
    for x, y in corners:
        qtbot.mouseClick(view, LEFT, pos=at(x, y))
    qtbot.keyClick(view, Qt.Key.Key_Backspace)
    qtbot.keyClick(view, Qt.Key.Key_Return)
    target = window.session.document.target
    assert target is not None and len(target.points) == 3
    # A right triangle with its right angle at the lower left: y is up in the target, down on the screen.
    lowest, leftmost = target.points[:, 1].min(), target.points[:, 0].min()
    assert np.any(np.all(np.isclose(target.points, (leftmost, lowest)), axis=1))


def test_that_a_polygon_closes_on_its_first_corner(window: MainWindow, qtbot: QtBot) -> None:
    view = window.target.view
    qtbot.keyClick(window, Qt.Key.Key_P)
    for x, y in [(60, 40), (60, 140), (160, 140), (63, 42)]:
        qtbot.mouseClick(view, LEFT, pos=at(x, y))
    target = window.session.document.target
    assert target is not None and len(target.points) == 3


def test_that_too_few_corners_are_refused_with_a_sentence(window: MainWindow, qtbot: QtBot) -> None:
    view = window.target.view
    qtbot.keyClick(window, Qt.Key.Key_P)
    for x, y in [(60, 40), (160, 40)]:
        qtbot.mouseClick(view, LEFT, pos=at(x, y))
    qtbot.keyClick(view, Qt.Key.Key_Return)
    assert window.messages.messages[-1].tone is Tone.ERROR
    assert window.session.document.target is None


def test_that_escape_leaves_a_sketch_without_a_trace(heart: MainWindow, qtbot: QtBot) -> None:
    before = heart.session.document
    view = heart.target.view
    qtbot.keyClick(heart, Qt.Key.Key_P)
    qtbot.mouseClick(view, LEFT, pos=at(60, 40))
    qtbot.keyClick(view, Qt.Key.Key_Escape)
    assert not view.active.busy and heart.target.buttons["polygon"].isChecked()
    qtbot.keyClick(view, Qt.Key.Key_Escape)
    assert not heart.target.buttons["polygon"].isChecked()
    assert heart.session.document is before


def test_that_clearing_a_target_can_be_undone(heart: MainWindow, qtbot: QtBot) -> None:
    qtbot.mouseClick(heart.target.buttons["clearTarget"], LEFT)
    assert heart.session.document.target is None and not heart.run.generate.isEnabled()
    heart.commands["undo"].trigger()
    assert heart.target.view.outline == silhouettes.load("heart")
