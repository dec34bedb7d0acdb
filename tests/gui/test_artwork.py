"""Artwork in the window: chosen, laid otherwise, undone, saved, shown on the moving panels, exported."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

import numpy as np
import pytest
from PIL import Image
from PySide6.QtGui import QImage

from kirigami_studio.export.artwork import PictureFit, SheetState
from kirigami_studio.export.pdf_pages import page_boxes
from kirigami_studio.gui.stage.artwork_editor import ArtworkEditor
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.project import store

Until = Callable[[Callable[[], bool]], None]


class Answers(Protocol):
    """What is answered to the next question for a file or a folder."""

    answer: Path | None


@pytest.fixture
def photo(tmp_path: Path) -> Path:
    """Left half red, right half green."""
    pixels = np.zeros((200, 240, 3), dtype=np.uint8)
    pixels[:, :120, 0] = pixels[:, 120:, 1] = 255
    Image.fromarray(pixels).save(tmp_path / "photo.png")
    return tmp_path / "photo.png"


@pytest.fixture
def editor(designed: MainWindow, files: Answers, photo: Path, until: Until) -> ArtworkEditor:
    """The editor with the photo laid on the opened sheet, and painted."""
    designed.commands["artwork"].trigger()
    editor = designed.dialogs.artwork
    assert editor is not None and editor.isVisible()
    assert not editor.export.isEnabled() and not editor.scale.isEnabled()
    files.answer = photo
    editor.choose.click()
    until(lambda: designed.stage.view.artwork is not None)
    return editor


def colours(window: MainWindow) -> np.ndarray:
    """What the layout shows: (H, W, 3)."""
    window.repaint()
    image = window.stage.view.grab().toImage().convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(image.constBits(), dtype=np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : 3 * image.width()].reshape(image.height(), image.width(), 3).astype(int)


def shares(pixels: np.ndarray) -> tuple[float, float]:
    """How much of the picture is red and how much is green."""
    red, green, blue = np.moveaxis(pixels, 2, 0)
    pure = ((red > 220) & (green < 40) & (blue < 40), (green > 220) & (red < 40) & (blue < 40))
    return float(pure[0].mean()), float(pure[1].mean())


def test_that_a_picture_is_seen_whole_on_the_opened_sheet_and_cut_up_on_the_flat_one(
    designed: MainWindow, editor: ArtworkEditor
) -> None:
    view = designed.stage.view
    designed.stage.deployment.set_phi(view.design.phi_target)
    opened = colours(designed)
    red, green = shares(opened)
    assert red > 0.05 and green > 0.05
    middle = opened.shape[1] // 2
    left, right = shares(opened[:, : middle - 20]), shares(opened[:, middle + 20 :])
    assert left[0] > 20 * left[1] and right[1] > 20 * right[0]
    editor.state.setCurrentIndex(editor.state.findData(SheetState.FLAT))
    editor.state.activated.emit(editor.state.currentIndex())
    assert designed.session.document.artwork.first.state is SheetState.FLAT


def test_that_every_change_is_a_step_that_can_be_undone(
    designed: MainWindow, editor: ArtworkEditor, until: Until
) -> None:
    session = designed.session
    assert session.history.undo_label == "Lay photo.png on it"
    editor.scale.setValue(150.0)
    editor.scale.setValue(160.0)
    editor.scale.editingFinished.emit()
    editor.turn.setValue(90.0)
    editor.turn.editingFinished.emit()
    editor.right.setValue(10.0)
    editor.fitting.setCurrentIndex(editor.fitting.findData(PictureFit.FIT))
    editor.fitting.activated.emit(editor.fitting.currentIndex())
    laid = session.document.artwork.first
    assert (laid.scale, laid.turn, laid.shift, laid.fitting) == (
        1.6,
        pytest.approx(math.pi / 2),
        (0.1, 0.0),
        PictureFit.FIT,
    )
    steps = 0
    while session.history.undo_label == "Place the artwork":
        designed.commands["undo"].trigger()
        steps += 1
    assert steps == 4
    assert editor.scale.value() == 100.0 and editor.turn.value() == 0.0
    editor.remove.click()
    assert designed.stage.view.artwork is None and not editor.remove.isEnabled()
    designed.commands["undo"].trigger()
    until(lambda: designed.stage.view.artwork is not None)


def test_that_a_second_picture_shares_the_sheet_until_it_is_removed(
    designed: MainWindow, editor: ArtworkEditor, files: Answers, tmp_path: Path, until: Until
) -> None:
    Image.new("RGB", (60, 60), (0, 0, 255)).save(tmp_path / "blue.png")
    view, session = designed.stage.view, designed.session
    assert not editor.stripes.isEnabled()
    files.answer = tmp_path / "blue.png"
    alone = view.artwork
    editor.second.click()
    until(lambda: view.artwork is not alone)
    assert "blue.png" in editor.about_second.text()
    designed.stage.deployment.set_phi(view.design.phi_target)
    red, green, blue = np.moveaxis(colours(designed), 2, 0)
    assert ((blue > 200) & (red < 60) & (green < 60)).mean() > 0.02
    editor.stripes.setValue(40)
    editor.stripes.setValue(30)
    assert session.document.artwork.stripes == 30 and session.history.undo_label == "Change the stripes"
    designed.commands["undo"].trigger()
    assert editor.stripes.value() == 160
    editor.remove_second.click()
    assert session.document.artwork.second is None and not editor.remove_second.isEnabled()


def test_that_artwork_travels_with_the_project_and_with_another_design(
    designed: MainWindow, editor: ArtworkEditor, photo: Path, tmp_path: Path, until: Until
) -> None:
    services = designed.services
    services.project.save(tmp_path / "own.kiri")
    until(lambda: (tmp_path / "own.kiri").exists() and services.session.path is not None)
    stored = store.load(tmp_path / "own.kiri").artwork
    assert stored == services.session.document.artwork
    assert stored.first.picture.content == photo.read_bytes()
    shown = designed.stage.view.artwork
    designed.commands["next"].trigger()
    until(lambda: designed.stage.view.artwork is not shown)
    assert designed.stage.view.artwork.sheet.design is designed.stage.view.design
    services.project.new()
    assert services.session.document.artwork is None and designed.stage.view.artwork is None
    services.project.open(tmp_path / "own.kiri")
    until(lambda: designed.stage.view.artwork is not None)


def test_that_artwork_is_exported_alone_and_with_everything(
    designed: MainWindow, editor: ArtworkEditor, files: Answers, tmp_path: Path, until: Until
) -> None:
    names = {"artwork.svg", "artwork.pdf", "artwork.png", "artwork_opened.png"}
    files.answer = tmp_path / "print"
    editor.export.click()
    until(lambda: (tmp_path / "print" / "artwork_opened.png").exists())
    assert {path.name for path in (tmp_path / "print").iterdir()} == names
    files.answer = tmp_path / "all"
    designed.commands["export_all"].trigger()
    until(lambda: any((tmp_path / "all").glob("*.json")))
    assert names < {path.name for path in (tmp_path / "all").iterdir()}


def test_that_a_print_of_many_pages_is_written_only_after_asking(
    designed: MainWindow, editor: ArtworkEditor, files: Answers, tmp_path: Path, until: Until
) -> None:
    designed.services.fabrication.change(width_mm=1200.0, paper="a4")
    until(lambda: not designed.session.queue.busy and designed.fabrication.export.isEnabled())
    files.answer = tmp_path / "print"
    editor.export.click()
    until(lambda: any(message.actions for message in designed.messages.messages))
    (message,) = [message for message in designed.messages.messages if message.actions]
    assert "pages of a4" in message.sentence and not (tmp_path / "print").exists()
    designed.services.fabrication.change(width_mm=240.0)
    editor.export.click()
    until(lambda: (tmp_path / "print" / "artwork_opened.png").exists())
    assert 2 < len(page_boxes((tmp_path / "print" / "artwork.pdf").read_bytes())) < 10


def test_that_a_file_that_is_no_picture_is_refused_and_nothing_changes(
    designed: MainWindow, editor: ArtworkEditor, files: Answers, tmp_path: Path, until: Until
) -> None:
    before = designed.session.document
    (tmp_path / "text.png").write_text("no picture")
    files.answer = tmp_path / "text.png"
    editor.choose.click()
    until(lambda: any("text.png is damaged" in message.sentence for message in designed.messages.messages))
    assert designed.session.document is before


def test_that_export_without_a_picture_offers_to_choose_one(designed: MainWindow) -> None:
    designed.commands["export_artwork"].trigger()
    assert designed.dialogs.artwork is not None and designed.dialogs.artwork.isVisible()
