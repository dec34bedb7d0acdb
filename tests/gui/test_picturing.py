"""A picture shows what the view shows, as large as wanted, and says where the design comes from."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QGuiApplication, QImage, QPainter
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot

from kirigami_studio.export.svg_reading import read_with_svgelements
from kirigami_studio.gui.files import picture_jobs
from kirigami_studio.gui.files.picturing import PictureMaker
from kirigami_studio.gui.widgets.canvas import Canvas
from kirigami_studio.gui.window.main_window import MainWindow

Until = Callable[[Callable[[], bool]], None]
#: Views in sight on the pages Design and Make.
NAMES = {
    "page_design": {"Target silhouette", "Layout of the chosen design", "Design gallery", "Whole window"},
    "page_make": {"Cut preview", "Layout of the chosen design", "Whole window"},
}
SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture
def picturing(designed: MainWindow) -> Iterator[PictureMaker]:
    yield designed.picturing
    QGuiApplication.clipboard().clear()  # Qt's off-screen clipboard outlives the application otherwise, and falls


def written(designed: MainWindow, view: QWidget, path: Path, qtbot: QtBot) -> Path:
    with qtbot.waitSignal(designed.picturing.written, timeout=30_000):
        designed.picturing.write(view, path)
    return path


def pixels(image: QImage) -> np.ndarray:
    image = image.convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : 3 * image.width()].reshape(image.height(), image.width(), 3).astype(int)


@pytest.mark.parametrize("scale", [1, 2, 4])
def test_that_a_png_is_as_large_as_asked_and_names_the_origin(
    scale: int, designed: MainWindow, picturing: PictureMaker, tmp_path: Path, qtbot: QtBot
) -> None:
    view = designed.stage.view
    picturing.scale = scale
    with Image.open(written(designed, view, tmp_path / "layout.png", qtbot)) as read:
        assert read.size == (view.width() * scale, view.height() * scale)
        assert read.text["FROM_SEED"] == "7" and read.text["FROM_GRID"] == "4 x 5"  # type: ignore[attr-defined]
        found = np.asarray(read.convert("RGB")).astype(int)
    # The screen's own picture is the oracle: inside the border, away from the dots, the colours are the same.
    screen = pixels(view.grab().toImage())
    middle = found[scale // 2 :: scale, scale // 2 :: scale]
    same = np.abs(middle - screen).max(axis=2) < 24
    assert same.mean() > 0.94


def test_that_an_svg_draws_in_lines_and_agrees_with_the_screen(
    designed: MainWindow, tmp_path: Path, qtbot: QtBot
) -> None:
    from PySide6.QtSvg import QSvgRenderer

    view = designed.stage.view
    path = written(designed, view, tmp_path / "layout.svg", qtbot)
    root = ElementTree.parse(path).getroot()
    assert (
        len(root.findall(f".//{SVG}path")) >= 30
        and len(root.findall(f".//{SVG}pattern")) == len(root.findall(f".//{SVG}image")) == 2
    )
    assert root.get("viewBox") == f"0 0 {view.width()} {view.height()}"
    assert "seed 7" in (root.findtext(f"{SVG}desc") or "")
    renderer = QSvgRenderer(str(path))
    drawn = QImage(view.size(), QImage.Format.Format_RGB32)
    painter = QPainter(drawn)
    renderer.render(painter, QRectF(drawn.rect()))
    painter.end()
    same = np.abs(pixels(drawn) - pixels(view.grab().toImage())).max(axis=2) < 40
    assert same.mean() > 0.93


@pytest.mark.parametrize("page", list(NAMES))
def test_that_every_view_in_sight_can_be_written(
    designed: MainWindow, picturing: PictureMaker, tmp_path: Path, qtbot: QtBot, files: object, page: str
) -> None:
    designed.commands[page].trigger()
    assert set(picturing.views()) == NAMES[page]
    menu = designed.picture_menu
    menu.refresh()
    for number, (name, view) in enumerate(picturing.views().items()):
        for end in (".png", ".svg"):
            path = tmp_path / f"{number}{end}"
            files.answer = path  # type: ignore[attr-defined]
            with qtbot.waitSignal(picturing.written, timeout=30_000):
                next(action for action in menu.actions() if action.text() == name).trigger()
            if end == ".png":
                with Image.open(path) as read:
                    assert read.size == (2 * view.width(), 2 * view.height())
                    assert len(read.convert("RGB").getcolors(2**24)) > 8
            else:
                ElementTree.parse(path)
    assert ("target silhouette.png" in files.proposals) is (page == "page_design")  # type: ignore[attr-defined]


def test_that_overlays_can_be_left_out_and_stay_on_the_screen(designed: MainWindow, picturing: PictureMaker) -> None:
    view = designed.stage.view
    seen, overlays = pixels(picturing.record(view).image(1)), view.overlays
    picturing.overlays = False
    bare = pixels(picturing.record(view).image(1))
    assert (np.abs(seen - bare).max(axis=2) > 30).sum() > 500, "the target's outline and the mismatch are gone"
    assert view.overlays == overlays and not view.rendering
    designed.commands["cuts"].trigger()
    cuts = designed.cuts.view
    cuts.gestures.select(frozenset({1, 2}))
    picturing.record(cuts)
    assert cuts.selected == {1, 2}


def test_that_a_picture_painted_in_bands_is_the_picture_painted_at_once(
    designed: MainWindow, picturing: PictureMaker, monkeypatch: pytest.MonkeyPatch
) -> None:
    recording = picturing.record(designed)
    monkeypatch.setattr(picture_jobs, "BAND", 10**9)
    whole = pixels(recording.image(2))
    monkeypatch.setattr(picture_jobs, "BAND", 37 * 2 * designed.width())
    differences = np.abs(pixels(recording.image(2)) - whole).max(axis=2)
    # Where a curve crosses from one band to the next, its edge may be shaded a little otherwise.
    assert (differences > 24).sum() == 0 and (differences > 0).mean() < 0.002


def test_that_a_picture_of_the_window_shows_its_views_on_plain_ground(
    designed: MainWindow, picturing: PictureMaker
) -> None:
    view = designed.stage.view
    drawn, seen = pixels(picturing.record(designed).image(1)), pixels(designed.grab().toImage())
    corner = view.mapTo(designed, view.rect().topLeft())
    empty = np.s_[corner.y() + 8 : corner.y() + 60, corner.x() + 8 : corner.x() + 60]
    canvas = QColor(designed.appearance.palette.canvas).getRgb()[:3]
    assert (drawn[empty] == canvas).all()
    assert not (seen[empty] == canvas).all(), "the screen has its dots"
    assert not view.rendering


def test_that_copying_takes_the_view_in_use(designed: MainWindow, picturing: PictureMaker, qtbot: QtBot) -> None:
    both = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier
    for view in (designed.stage.view, designed.gallery.view):
        view.setFocus()
        with qtbot.waitSignal(picturing.copied, timeout=30_000):
            qtbot.keyClick(designed, Qt.Key.Key_C, both)
        assert QGuiApplication.clipboard().image().size() == view.size() * 2
        assert "px picture" in designed.status_text.text()
    designed.settings.candidates.setFocus()
    largest = picturing.view_at_work()
    assert isinstance(largest, Canvas) and largest is designed.stage.view


def test_that_copied_cuts_are_the_exported_file(
    designed: MainWindow, picturing: PictureMaker, tmp_path: Path, qtbot: QtBot, until: Until
) -> None:
    with qtbot.waitSignal(picturing.copied, timeout=30_000):
        qtbot.keyClick(designed, Qt.Key.Key_C, Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.AltModifier)
    data = QGuiApplication.clipboard().mimeData()
    content = bytes(data.data("image/svg+xml").data())
    assert data.text().encode() == content
    with qtbot.waitSignal(designed.services.exporter.exported, timeout=30_000):
        designed.services.exporter.export(tmp_path / "cut.svg")
    assert (tmp_path / "cut.svg").read_bytes() == content and b"; VERDICT " in content
    (tmp_path / "copied.svg").write_bytes(content)
    assert read_with_svgelements(tmp_path / "copied.svg").extent == pytest.approx((100.3, 80.3), abs=20.0)
    assert b"FROM_SEED 7" in content and b"FROM_ORIGIN sampled" in content
    assert re.search(rb'width="[\d.]+mm"', content)


def test_that_the_animation_is_offered_in_the_menu(designed: MainWindow, files: object, tmp_path: Path) -> None:
    designed.commands["animation"].trigger()
    assert files.proposals == ["heart-A1.gif"]  # type: ignore[attr-defined]


def test_that_without_a_design_nothing_is_copied_and_that_is_said(window: MainWindow) -> None:
    QGuiApplication.clipboard().setText("before")
    window.commands["copy_cuts"].trigger()
    assert QGuiApplication.clipboard().text() == "before"
    assert "No design to copy" in window.messages.messages[-1].sentence
