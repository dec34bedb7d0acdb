"""Real windows, off-screen; every test fails on a Qt warning, a living worker thread or a running timer it leaves."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageDraw
from PySide6.QtCore import QCoreApplication, QEvent, QPoint, Qt, QThread, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.gui.files.file_dialogs import FileToOpen
from kirigami_studio.gui.widgets.language import SYSTEM, speak
from kirigami_studio.gui.widgets.theme import LIGHT
from kirigami_studio.gui.window.application import create_window
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.gui.window.pages import WindowPage
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines import silhouettes
from kirigami_studio.pipeline.rank import USUAL
from kirigami_studio.project import edits, store
from kirigami_studio.project.document import Document

#: Said by the off-screen platform itself about what it lacks.
PLATFORM_SAYS = "This plugin does not support"
#: Milliseconds of the clock after which a test gives up: nothing is measured by it.
PATIENCE = 120_000


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark everything here, and let Qt's warnings fail it."""
    here = Path(__file__).parent
    for item in items:
        if here in Path(item.path).parents:
            item.add_marker(pytest.mark.qt)
            item.add_marker(pytest.mark.qt_log_level_fail("WARNING"))
            item.add_marker(pytest.mark.qt_log_ignore(PLATFORM_SAYS))


class PathAnswers:
    """Answers the questions for files as a user would, without a dialog."""

    def __init__(self) -> None:
        self.answer: Path | None = None
        self.proposals: list[str] = []
        self.to_folders: list[bool] = []

    def open(self, wanted: FileToOpen) -> Path | None:
        return self.answer

    def save(self, proposal: str) -> Path | None:
        self.proposals.append(proposal)
        return self.answer

    def export(self, proposal: str, to_folder: bool = False) -> Path | None:
        self.proposals.append(proposal)
        self.to_folders.append(to_folder)
        return self.answer

    def picture(self, proposal: str) -> Path | None:
        self.proposals.append(proposal)
        return self.answer

    def folder(self) -> Path | None:
        return self.answer


@pytest.fixture
def files() -> PathAnswers:
    return PathAnswers()


def unstyled() -> None:
    """Take the last window's style sheet off the application, so that the next window begins as the first one does.

    With a sheet in place Qt styles every widget again each time it gets a parent: building takes twice as long.
    """
    application = QApplication.instance()
    assert isinstance(application, QApplication)
    application.setStyleSheet("")


@pytest.fixture
def window(qtbot: QtBot, files: PathAnswers) -> Iterator[MainWindow]:
    """An empty studio on the page of designs; closing it must leave nothing running."""
    unstyled()
    # Off screen, Qt hands a move of the pointer to the first window that holds its place: one that a test has left
    # open would take it.  And it tells of no move to where the pointer is, which is where an earlier test left it.
    while popup := QApplication.activePopupWidget():
        popup.close()
    for left in QApplication.topLevelWidgets():
        left.hide()
    made = create_window(LIGHT, file_dialogs=files)
    with qtbot.waitExposed(made):
        made.show()
    made.pages.turn(WindowPage.DESIGN)
    # Tests that draw would wait for fits that they do not look at.
    made.services.preferences.keep(replace(made.services.preferences.present, preview=False))
    for button in (Qt.MouseButton.LeftButton, Qt.MouseButton.RightButton):
        QTest.mouseRelease(made, button, pos=QPoint(1, made.height() - 2))  # a test may have kept it pressed
    QTest.mouseMove(made, QPoint(1, made.height() - 2))
    threads = made.findChildren(QThread)
    assert len(threads) == 1
    yield made
    made.session.history.mark_saved()
    assert made.close()
    assert not any(thread.isRunning() for thread in made.findChildren(QThread))
    assert [timer.parent() for timer in made.findChildren(QTimer) if timer.isActive()] == []
    made.deleteLater()
    # Outside an event loop nothing is deleted later: the window would live on into the next test and slow it down.
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    QApplication.processEvents()


@pytest.fixture
def until(qtbot: QtBot) -> Callable[[Callable[[], bool]], None]:
    """Let the window live until something has happened."""

    def wait(happened: Callable[[], bool]) -> None:
        qtbot.waitUntil(happened, timeout=PATIENCE)

    return wait


@pytest.fixture
def english_afterwards(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Speak the desktop's language again when the test is over."""
    yield
    monkeypatch.undo()
    speak(SYSTEM)


@pytest.fixture
def german(english_afterwards: None) -> None:
    """Speak German in windows that are made from now on."""
    speak("de")


@pytest.fixture
def heart(window: MainWindow, until: Callable[[Callable[[], bool]], None]) -> MainWindow:
    """A studio with the heart as target."""
    window.services.targeting.open("heart")
    until(lambda: window.target.view.outline is not None)
    return window


@pytest.fixture(scope="session")
def designs() -> Document:
    """Three scored designs of 4 x 5 voids for the heart, without a generator."""
    target, draw = silhouettes.load("heart"), np.random.default_rng(5)
    found = []
    for index in range(3):
        field = RatioField.from_log10(0.1 * (index + 1) * draw.normal(size=(4, 5)))
        found.append(Candidate(Sheet(field), evaluate(deploy(field), target, 0.0), seed=7, index=index))
    start = edits.set_target(Document(), target).document
    return edits.set_candidates(start, USUAL.ranked(found), {}).document


@pytest.fixture
def project_file(designs: Document, tmp_path: Path) -> Path:
    path = tmp_path / "heart.kiri"
    store.save(designs, path)
    return path


@pytest.fixture
def designed(window: MainWindow, project_file: Path, until: Callable[[Callable[[], bool]], None]) -> MainWindow:
    """A studio with that project open and its cuts planned."""
    window.services.project.open(project_file)
    until(lambda: window.session.stage is not None and window.fabrication.export.isEnabled())
    return window


@pytest.fixture
def by_hand(designed: MainWindow) -> MainWindow:
    """The three designs, half open, in the mode."""
    designed.stage.deployment.set_phi(math.radians(100.0))
    designed.commands["hand"].trigger()
    assert designed.stage.hand.isChecked() and designed.stage.voids.isVisible()
    return designed


@pytest.fixture
def photo(tmp_path: Path) -> Path:
    """A dark disc (grey 0.2) with a lighter ear (grey 0.6) on light paper."""
    page = Image.new("L", (120, 100), 240)
    draw = ImageDraw.Draw(page)
    draw.ellipse((10, 40, 60, 70), fill=150)
    draw.ellipse((40, 20, 100, 80), fill=50)
    path = tmp_path / "two greys.png"
    page.save(path)
    return path
