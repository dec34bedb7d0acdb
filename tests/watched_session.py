"""One session through the real window in a process of its own, with the user-interface thread watched at every step.

``python tests/watched_session.py FOLDER`` prints one JSON object: step -> [own, kept], the longest turn of the event
loop in it, in processor seconds (``thread_watch``) of the machine for which limits are written (``machine_pace``).
``--last STEP`` ends after that step, ``--brief`` leaves out what takes long or repeats much, ``--block SECONDS`` plays
only steps that are known to hold the thread up.  Another session with other steps is in ``watched_tools.py``.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from machine_pace import window_slowness
from PySide6.QtCore import QEventLoop, Qt, QTimer
from PySide6.QtGui import QPaintEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget
from thread_watch import ThreadWatch, in_another_thread, long_number

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.foundation.settings import settings_of
from kirigami_studio.gui.files.file_dialogs import FileToOpen
from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.widgets.theme import LIGHT
from kirigami_studio.gui.window.application import create_application, create_window
from kirigami_studio.gui.window.main_window import FIRST, MainWindow
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines import silhouettes
from kirigami_studio.project import edits, store
from kirigami_studio.project.document import Document
from kirigami_studio.settings.design import DesignSettings

#: Seconds of the clock after which a session gives up: nothing is measured by it.
PATIENCE = 600.0
MANY, LARGE = 64, (24, 24)
MOST, USUAL = 256, (10, 10)
THEME = "switch the theme"
FULL_POLISH = settings_of(DesignSettings)["polish"].setting.choices[-1].value


class Places:
    """Answers every question for a file."""

    def __init__(self, folder: Path) -> None:
        self.folder_, self.project_ = folder, folder / "large.kiri"
        self.saved, self.cut, self.everything = folder / "saved.kiri", folder / "cut.dxf", folder / "everything"

    def open(self, wanted: FileToOpen) -> Path | None:
        return self.project_ if wanted is FileToOpen.PROJECT else None

    def save(self, proposal: str) -> Path | None:
        return self.saved

    def export(self, proposal: str, to_folder: bool = False) -> Path | None:
        return self.cut

    def picture(self, proposal: str) -> Path | None:
        return None

    def folder(self) -> Path | None:
        self.everything.mkdir(exist_ok=True)
        return self.everything


class LastStepDone(Exception):  # noqa: N818 - nothing is wrong
    """The session was to end here."""


class WatchedSession:
    """Plays the steps on one window."""

    rest = 0.2  #: seconds that the window lives on after each step, still watched
    last = ""  #: the step after which the session ends; without one it plays them all
    brief = False  #: whether it leaves out the longest runs and the most designs

    def __init__(self, folder: Path) -> None:
        self.places = Places(folder)
        self.window: MainWindow = create_window(LIGHT, file_dialogs=self.places)
        self.window.resize(FIRST)
        self.watch = ThreadWatch()
        self.longest: dict[str, tuple[float, float]] = {}

    @classmethod
    def prepare(cls, folder: Path) -> None:
        """Write the files that the session opens."""
        write_project(folder / "large.kiri", MANY, LARGE)
        write_project(folder / "many.kiri", MOST, USUAL)

    def begin(self) -> None:
        """Show the window."""
        self.window.show()
        self.until(self.window.isVisible)

    def block(self, seconds: float) -> None:
        """Steps that hold the thread up for so long, and one that does nothing."""
        self.step("nothing", lambda: None)
        self.step("computing in the handler of a timer", lambda: QTimer.singleShot(0, lambda: spin(seconds)))
        slow = SlowlyPainted(self.window, seconds)
        self.step("painting", slow.show, lambda: slow.painted)
        slow.close()
        compute = f"import time\nwhile time.process_time() < {seconds}: pass"
        self.step("waiting for a process", lambda: subprocess.run([sys.executable, "-c", compute], check=True))
        number = long_number(seconds)
        self.step("another thread keeps the lock", lambda: in_another_thread(number))

    def play(self) -> None:
        """Run every step: from the target to the files, one after the other as one works."""
        services = self.window.services
        self.step(
            "choose a target", lambda: services.targeting.open("heart"), lambda: self.window.run.generate.isEnabled()
        )
        if not self.brief:
            for step in ("generate 16, loading the generator", "generate 16 again"):
                self.set_up(16, 0, search=False)
                self.step(step, self.generate, self.generated)
        self.set_up(4, FULL_POLISH, search=False)
        self.step("generate 4 and polish fully", self.generate, self.generated)
        self.step("choose another design", lambda: self.press("next"), self.planned)
        self.step("trim", lambda: self.press("trim"), lambda: not services.chosen.trimming.busy and self.planned())
        for command in ("undo", "redo"):
            for number in range(1 if self.brief else 3):  # every press is a gesture of its own
                self.step(f"{command} step {number + 1}", lambda command=command: self.press(command), self.planned)
        self.step("scrub", self.scrub)
        if self.brief:
            self.step(THEME, lambda: self.press("theme"))
        else:
            self.set_up(2, 5, search=True, grid=(6, 6))  # the fits are other processes' work, whatever their size
            self.step("generate 2 and search", self.generate, self.generated)
        services.session.history.mark_saved()
        self.open("open a large project", "large.kiri", MANY)
        self.step("choose in the large project", lambda: self.press("next"), self.planned)
        self.step("move the balance over it", self.balance)
        self.step("show every look-alike", lambda: self.window.gallery.bar.filters.grouped.setChecked(False))
        self.step("look through its gallery", self.look_through)
        self.all_designs(MANY)
        self.step("scrub a large design", self.scrub)
        self.step("show its cuts", lambda: self.press("cuts"))
        self.step("save it", lambda: self.press("save_as"), self.places.saved.exists)
        self.step("export its DXF", lambda: self.press("export"), self.told)
        self.step("export everything", lambda: self.press("export_all"), self.told)
        if self.brief:
            return
        services.session.history.mark_saved()
        self.open(f"open {MOST} designs", "many.kiri", MOST)
        self.all_designs(MOST)
        self.step(THEME, lambda: self.press("theme"))

    def open(self, step: str, name: str, designs: int) -> None:
        """Open a project."""
        self.places.project_ = self.places.folder_ / name
        self.step(step, lambda: self.press("open_project"), lambda: self.shown(designs) and self.planned())

    def all_designs(self, designs: int) -> None:
        """The table of all designs: opened, walked through, scrolled, filtered, four of them compared."""
        press = self.press
        assert self.window.gallery.view.model_.rowCount() == designs
        self.step(f"show all {designs} designs at once", lambda: press("all_designs"), self.pictured)
        page = self.window.presenters.all_designs.page
        assert page is not None
        table, stage = page.table, self.window.stage
        self.step(
            f"walk through the {designs}",
            lambda: self.keys(table, *[Qt.Key.Key_Right] * 12, Qt.Key.Key_Down),
            self.pictured,
        )
        self.step(f"scroll through the {designs}", self.scroll_all, self.pictured)
        self.step(f"make the {designs} cards small", lambda: self.keys(table, Qt.Key.Key_Minus), self.pictured)
        self.step(f"filter the {designs}", lambda: page.filters.least.setValue(1.0), self.pictured)
        for number in range(4):  # every press is a gesture of its own
            self.step(f"mark design {number + 1} of the {designs}", lambda: self.keys(table, Qt.Key.Key_Space))
            if number < 3:
                self.keys(table, Qt.Key.Key_Right)
        self.step(f"compare four of the {designs}", lambda: self.keys(table, Qt.Key.Key_C), lambda: stage.comparing)
        self.step(f"scrub four of the {designs}", lambda: stage.compare.bar.slider.setValue(900))
        self.step(f"leave the comparison of the {designs}", lambda: press("compare"), lambda: page.isVisible())
        self.step(
            f"leave the table of {designs}",
            lambda: press("all_designs"),
            lambda: not self.window.presenters.all_designs.shown,
        )
        page.card_size.setValue(1)  # as it was, for the next time
        stage.compare.bar.slider.setValue(0)
        page.filters.least.setValue(0.0)

    def keys(self, widget: QWidget, *keys: Qt.Key) -> None:
        """Press keys, one in each turn of the event loop."""
        for key in keys:
            QTest.keyClick(widget, key)
            QApplication.processEvents()

    def pictured(self) -> bool:
        """Whether all cards in sight have their pictures."""
        page = self.window.presenters.all_designs.page
        return page is not None and page.isVisible() and not page.table.cards.pending

    def scroll_all(self) -> None:
        """Scroll through the table, page by page."""
        page = self.window.presenters.all_designs.page
        assert page is not None
        bar = page.table.verticalScrollBar()
        for value in range(0, bar.maximum() + 1, max(1, bar.pageStep())):
            bar.setValue(value)
            QApplication.processEvents()

    def step(self, name: str, act: Callable[[], object], happened: Callable[[], bool] = bool) -> None:
        """Do something from inside the event loop, wait until it has happened and note the longest turn."""
        while self.window.messages.messages:
            self.window.messages.close_message()
        self.let_live(0.1)
        acted: list[bool] = []

        def carry_out() -> None:
            act()
            acted.append(True)

        before = window_slowness()
        self.watch.begin()
        QTimer.singleShot(0, self.window, carry_out)
        self.until(lambda: bool(acted) and (happened is bool or happened()))
        self.let_live(self.rest)
        turn = self.watch.end()
        pace = 0.5 * (before + window_slowness())
        self.longest[name] = (turn.own / pace, turn.kept / pace)
        if name == self.last:
            raise LastStepDone

    def until(self, happened: Callable[[], bool]) -> None:
        """Let the window live until something has happened."""
        end = time.monotonic() + PATIENCE
        while not happened():
            wrong = [one.sentence for one in self.window.messages.messages if one.tone is Tone.ERROR]
            if wrong or time.monotonic() > end:
                done = ", ".join(self.longest)
                raise SystemExit(f"The session stopped after {done}: {wrong or 'nothing happened'}")
            QApplication.processEvents(QEventLoop.ProcessEventsFlag.WaitForMoreEvents)

    def let_live(self, seconds: float) -> None:
        """Let the window live for a while."""
        end = time.monotonic() + seconds
        self.until(lambda: time.monotonic() > end)

    def press(self, name: str) -> None:
        self.window.commands[name].trigger()

    def set_up(self, designs: int, polish: int, search: bool, grid: tuple[int, int] = (10, 10)) -> None:
        """Ask for so many designs."""
        settings = self.window.settings
        settings.candidates.setValue(designs)
        settings.search.setChecked(search)
        self.window.services.settings.change(polish=polish, grid=grid)
        self.let_live(0.1)

    def generate(self) -> None:
        QTest.mouseClick(self.window.run.generate, Qt.MouseButton.LeftButton)

    def generated(self) -> bool:
        services = self.window.services
        return not services.run.running and self.planned()

    def planned(self) -> bool:
        return self.window.fabrication.export.isEnabled() and not self.window.session.queue.busy

    def shown(self, designs: int) -> bool:
        return len(self.window.gallery.view.model_.all_entries) == designs

    def told(self) -> bool:
        """An export has said how it went."""
        return bool(self.window.messages.messages) and not self.window.session.queue.busy

    def scrub(self) -> None:
        """Move the slider all the way, one step in each turn."""
        slider = self.window.stage.deployment.slider
        for value in range(0, slider.maximum(), slider.maximum() // 20):
            slider.setValue(value)
            QApplication.processEvents()

    def balance(self) -> None:
        """Drag the slider from match to regular and back, without letting go elsewhere."""
        slider = self.window.settings.regular
        slider.setSliderDown(True)
        for value in (60, 70, 80, 90, 100, 80, 50):
            slider.setValue(value)
            QApplication.processEvents()
        slider.setSliderDown(False)

    def look_through(self) -> None:
        """Turn the pages of the gallery."""
        bar = self.window.gallery.view.verticalScrollBar()
        for page in range(4):
            bar.setValue(page * bar.maximum() // 3)
            QApplication.processEvents()


class SlowlyPainted(QWidget):
    """Takes so many processor seconds to paint."""

    def __init__(self, parent: QWidget, seconds: float) -> None:
        super().__init__(parent)
        self.resize(50, 50)
        self.seconds, self.painted = seconds, False

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        spin(self.seconds)
        self.painted = True


def spin(seconds: float) -> None:
    """Compute for so many processor seconds."""
    end = time.thread_time() + seconds
    while time.thread_time() < end:
        pass


def write_project(path: Path, designs: int, grid: tuple[int, int]) -> None:
    """So many designs of so many voids; one score serves them all."""
    target, draw = silhouettes.load("heart"), np.random.default_rng(3)
    fields = [RatioField.from_log10(0.05 * draw.normal(size=grid)) for _ in range(designs)]
    first = Candidate(Sheet(fields[0]), evaluate(deploy(fields[0]), target, 0.0), seed=3, index=0)
    many = tuple(replace(first, sheet=Sheet(field), index=index) for index, field in enumerate(fields))
    start = edits.set_target(Document(), target).document
    store.save(edits.set_candidates(start, many, {}).document, path)


def main(kind: type[WatchedSession]) -> int:
    """Play and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--block", type=float, default=0.0)
    parser.add_argument("--last", default="")
    parser.add_argument("--brief", action="store_true")
    chosen = parser.parse_args()
    if not chosen.block:
        kind.prepare(chosen.folder)
    create_application(["kirigami-studio"])
    session = kind(chosen.folder)
    session.last, session.brief = chosen.last, chosen.brief
    try:
        session.begin()
        if chosen.block:
            session.block(chosen.block)
        else:
            session.play()
    except LastStepDone:
        pass
    finally:
        session.watch.close()
        window: QWidget = session.window
        session.window.session.history.mark_saved()
        window.close()
    sys.stdout.write(json.dumps(session.longest))
    return 0


if __name__ == "__main__":
    sys.exit(main(WatchedSession))
