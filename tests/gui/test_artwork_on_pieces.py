"""Artwork on pieces in the window: pictures lie on the fronts of both layers, lines are drawn, and follow changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image
from pinned_assemblies import plain_pinwheel
from PySide6.QtGui import QImage

from kirigami_studio.export.artwork import ArtPicture, Artwork, Laid, SheetState
from kirigami_studio.gui.stage.artwork_painting import ShownPrint
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.project import edits, store

Until = Callable[[Callable[[], bool]], None]


def two_halves(lines: tuple[np.ndarray, ...] = ()) -> Artwork:
    """Red on the left, green on the right."""
    pixels = np.zeros((200, 240, 3), dtype=np.uint8)
    pixels[:, :120, 0] = pixels[:, 120:, 1] = 255
    stream = BytesIO()
    Image.fromarray(pixels).save(stream, format="PNG")
    return Artwork(Laid(ArtPicture("halves.png", stream.getvalue(), (240, 200), lines), SheetState.TARGET))


def colours(window: MainWindow) -> np.ndarray:
    """What the layout shows: (H, W, 3)."""
    window.repaint()
    image = window.stage.view.grab().toImage().convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(image.constBits(), dtype=np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : 3 * image.width()].reshape(image.height(), image.width(), 3).astype(int)


def pure(pixels: np.ndarray, channel: int) -> np.ndarray:
    others = [one for one in range(3) if one != channel]
    return (pixels[..., channel] > 220) & (pixels[..., others].max(axis=2) < 40)


def test_that_a_picture_is_whole_on_opened_pieces_and_its_lines_are_drawn_in_its_place(
    window: MainWindow, tmp_path: Path, until: Until
) -> None:
    document = replace(plain_pinwheel(), artwork=two_halves())
    store.save(document, tmp_path / "square.kiri")
    window.services.project.open(tmp_path / "square.kiri")
    view = window.stage.view
    until(lambda: isinstance(view.artwork, ShownPrint))
    window.stage.deployment.set_phi(view.design.phi_target)
    opened = colours(window)
    columns = [np.flatnonzero(pure(opened, channel).any(axis=0)) for channel in (0, 1)]
    assert min(map(len, columns)) > 50
    assert columns[0].max() <= columns[1].min() + 2, "red ends where green begins, on pieces of both layers"
    assert min(pure(opened, channel).mean() for channel in (0, 1)) > 0.05
    window.stage.deployment.set_phi(np.pi)
    flat = colours(window)
    columns = [np.flatnonzero(pure(flat, channel).any(axis=0)) for channel in (0, 1)]
    assert columns[0].max() > columns[1].min() + 20, "cut up while it is flat"
    lines = (np.array([[20.0, 20.0], [220.0, 180.0]]),)
    window.session.apply(edits.set_artwork(window.session.document, two_halves(lines)))
    until(lambda: view._pieces is not None and any(piece.drawn for piece in view._pieces.assembly.pieces))
    until(lambda: isinstance(view.artwork, ShownPrint) and not view.artwork.patches)
    window.stage.deployment.set_phi(view.design.phi_target)
    assert not pure(colours(window), 0).any()
    assert not np.array_equal(colours(window), opened)
