"""A second watched session, in a large window: many designs, plots, pairs, the hand, the drawing board, pictures.

``python tests/watched_tools.py FOLDER`` prints what ``watched_session.py`` prints.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from hand_gestures import OPEN, middle_of, turn
from PIL import Image
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QSlider, QWidget
from watched_session import LARGE, MANY, MOST, USUAL, WatchedSession, main, write_project

WINDOW = (2560, 1440)
#: Width of the gallery (pixels) in which all cards of the large project are seen at once.
ALL_CARDS = 1700
PHOTO = (4000, 3000)
DESIGNS = 128
STROKE = 60
LEFT = Qt.MouseButton.LeftButton


class WatchedTools(WatchedSession):
    """Plays what the first session leaves out."""

    rest = 0.15

    @classmethod
    def prepare(cls, folder: Path) -> None:
        write_project(folder / "large.kiri", MANY, LARGE)
        write_project(folder / "many.kiri", MOST, USUAL)
        write_photo(folder / "photo.png")

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self.folder = folder
        self.window.resize(*WINDOW)
        self.window.services.project.recovery.use(folder / "recovery")

    def play(self) -> None:
        self.large_gallery()
        self.many_designs()
        self.plots_and_pairs()
        self.hand()
        self.pictures()
        self.drawing_board()
        self.photo()
        self.many_saved()
        self.window.gallery.bar.filters.grouped.setChecked(False)
        self.all_designs(MOST)
        self.beside()

    def large_gallery(self) -> None:
        """64 designs of 24 x 24 voids, all of them in sight."""
        view = self.window.gallery.view
        self.open("open a large project in a large window", "large.kiri", MANY)
        self.step("widen the gallery to see all its cards", self.widen, lambda: not view.cards.pending)
        self.step("scroll through the wide gallery", self.look_through, lambda: not view.cards.pending)
        self.window.pages.splitter.setSizes([560, 1400, 600])
        self.window.session.history.mark_saved()

    def widen(self) -> None:
        self.window.pages.splitter.setSizes([340, WINDOW[0] - 340 - ALL_CARDS, ALL_CARDS])

    def many_designs(self) -> None:
        """128 designs, undone and redone."""
        self.step("choose a target in a large window", lambda: self.window.services.targeting.open("star"))
        self.until(lambda: self.window.run.generate.isEnabled() and not self.window.session.queue.busy)
        services, row = self.window.services, self.window.settings.second
        self.step("choose a second target", lambda: services.second.open("hexagon"))
        self.until(lambda: services.session.document.settings.second is not None and not services.session.queue.busy)
        self.step("do without it", row.remove.click)
        self.set_up(DESIGNS, 0, search=False)
        self.step(f"generate {DESIGNS} designs", self.generate, self.generated)
        for _ in range(10):
            self.press("next")
            self.let_live(0.02)
        self.step("undo ten times", lambda: self.in_turns([lambda: self.press("undo")] * 10), self.planned)
        self.step("redo ten times", lambda: self.in_turns([lambda: self.press("redo")] * 10), self.planned)

    def plots_and_pairs(self) -> None:
        """The first charts, and two designs side by side."""
        stage = self.window.stage
        self.step("open the plots", stage.plots_switch.click, lambda: stage.plots.complete)
        self.step("scrub with the plots open", self.scrub)
        self.step("choose with the plots open", lambda: self.press("next"), lambda: stage.plots.complete)
        stage.plots_switch.click()
        self.step("compare two designs", lambda: self.press("compare"), lambda: stage.comparing)
        self.step("scrub both", lambda: self.move(stage.compare.bar.slider))
        self.press("compare")
        self.step("play the deployment", stage.deployment.play.toggle)
        stage.deployment.play.setChecked(False)

    def hand(self) -> None:
        """The wheel on a void, and a void pulled."""
        view, hand = self.window.stage.view, self.window.services.hand
        self.window.stage.hand.click()
        self.window.stage.deployment.set_phi(OPEN)
        self.let_live(0.1)
        place = middle_of(view, (4, 4))
        self.step("turn the wheel on a void", lambda: self.in_turns([lambda: turn(view, place, 1)] * 8), self.settled)
        self.step("pull a void", lambda: self.drag(view, line(place, place + QPoint(30, 18))), self.settled)
        self.until(lambda: not hand.busy)
        self.window.stage.hand.click()

    def pictures(self) -> None:
        """Pictures of the view and of the whole window, four times as large, and on the clipboard."""
        stage, picturing = self.window.stage, self.window.picturing
        picturing.scale = 4
        for name, view in (("the view", stage.view), ("the whole window", self.window)):
            for suffix in (".png", ".svg"):
                path = self.folder / f"{name}{suffix}"
                self.write_picture(f"write {name} as {suffix[1:].upper()}", view, path)
        copied: list[bool] = []
        picturing.copied.connect(lambda: copied.append(True))
        self.step("copy a picture of the window", lambda: picturing.copy(self.window), lambda: bool(copied))
        QGuiApplication.clipboard().clear()
        self.step("export a report", lambda: self.press("export"), self.told)

    def write_picture(self, step: str, view: QWidget, path: Path) -> None:
        picturing = self.window.picturing
        written: list[object] = []
        picturing.written.connect(written.append)
        self.step(step, lambda: picturing.write(view, path), lambda: bool(written))

    def drawing_board(self) -> None:
        """A stroke on the board."""
        target, session = self.window.target, self.window.session
        self.step("open the drawing board", lambda: self.press("edit_target"), lambda: target.editing)
        self.press("freehand")
        self.let_live(0.1)
        width, height = target.view.width(), target.view.height()
        turns = np.linspace(0.0, 2.0 * math.pi, STROKE)
        radius = 0.35 * height * (1.0 + 0.2 * np.cos(5 * turns))
        places = np.stack([0.5 * width + radius * np.cos(turns), 0.5 * height + radius * np.sin(turns)], axis=1)
        stroke, before = [QPoint(round(x), round(y)) for x, y in places], session.document.target
        self.step(
            "draw a stroke", lambda: self.drag(target.view, stroke), lambda: session.document.target is not before
        )
        self.step("undo the stroke", lambda: self.press("undo"), lambda: session.document.target == before)
        self.step("leave the drawing board", lambda: self.press("edit_target"), lambda: not target.editing)

    def photo(self) -> None:
        """A large photo and its threshold."""
        bar, services = self.window.target.threshold, self.window.services
        opened = lambda: services.targeting.open(str(self.folder / "photo.png"))  # noqa: E731
        self.step("open a large photo", opened, lambda: bar.isVisible() and not services.session.queue.busy)
        self.step("move its threshold", self.move_threshold, lambda: not services.session.queue.busy)
        self.step("lay it on the drawing board", lambda: self.press("edit_target"))
        self.press("edit_target")

    def move_threshold(self) -> None:
        bar = self.window.target.threshold
        bar.slider.setSliderDown(True)
        for value in range(90, 151, 15):
            bar.slider.setValue(value)
            QApplication.processEvents()
        bar.slider.setSliderDown(False)

    def many_saved(self) -> None:
        """256 designs: opened, changed, kept for a recovery, saved."""
        recovering = self.window.services.project.recovery
        self.window.session.history.mark_saved()
        self.open(f"open {MOST} designs", "many.kiri", MOST)
        recovering.quiet_ms = 0
        kept: list[object] = []
        recovering.kept.connect(kept.append)
        self.step("pin one, which is kept for a recovery", lambda: self.press("pin"), lambda: bool(kept))
        self.places.saved.unlink(missing_ok=True)
        saved = lambda: not self.window.session.history.unsaved  # noqa: E731
        self.step(f"save {MOST} designs", lambda: self.press("save_as"), saved)
        orders = range(self.window.gallery.bar.order.count())
        self.step(
            "sort them in every way",
            lambda: self.in_turns([partial(self.sort_by, row) for row in orders]),
            self.planned,
        )

    def sort_by(self, row: int) -> None:
        box = self.window.gallery.bar.order
        box.setCurrentIndex(row)
        box.activated.emit(row)

    def beside(self) -> None:
        """Everything that opens beside the window."""
        names = ("library", "materials", "guide", "shortcuts", "history")
        for name in names:
            self.step(f"open: {name}", partial(self.press, name))
        self.window.dialogs.close()

    def settled(self) -> bool:
        return not self.window.services.hand.busy and self.planned()

    def in_turns(self, acts: Sequence[Callable[[], object]]) -> None:
        """Act once in each turn of the event loop."""
        for act in acts:
            act()
            QApplication.processEvents()

    def move(self, slider: QSlider) -> None:
        """Move a slider all the way."""
        self.in_turns([partial(slider.setValue, value) for value in range(0, slider.maximum(), 90)])

    def drag(self, view: QWidget, places: list[QPoint]) -> None:
        """Draw with the mouse."""
        QTest.mouseMove(view, places[0])
        QTest.mousePress(view, LEFT, Qt.KeyboardModifier.NoModifier, places[0])
        self.in_turns([partial(QTest.mouseMove, view, place) for place in places])
        QTest.mouseRelease(view, LEFT, Qt.KeyboardModifier.NoModifier, places[-1])


def line(start: QPoint, end: QPoint) -> list[QPoint]:
    """Places on the way from one to the other."""
    return [start + (end - start) * (step / 8) for step in range(9)]


def write_photo(path: Path) -> None:
    """A dark leaf on light paper with the grain of a photo."""
    width, height = PHOTO
    y, x = np.mgrid[0:height, 0:width].astype(np.float32)
    inside = ((x - width / 2) / 1300) ** 2 + ((y - height / 2) / 900) ** 2 < 1 + 0.2 * np.sin(x / 150)
    grain = np.random.default_rng(5).integers(0, 24, (height, width, 3), dtype=np.uint8)
    Image.fromarray(np.where(inside[:, :, None], 60, 200).astype(np.uint8) + grain).save(path, compress_level=1)


if __name__ == "__main__":
    sys.exit(main(WatchedTools))
