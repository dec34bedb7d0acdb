"""The generator is loaded when hands rest."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
import weakref

import pytest
from PySide6.QtCore import QObject, Qt
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot

from kirigami_studio.gui.window.application import WarmUp
from kirigami_studio.studio import importing


def test_that_it_happens_once_after_a_rest(qtbot: QtBot) -> None:
    calls: list[int] = []
    owner, widget = QObject(), QWidget()
    qtbot.addWidget(widget)
    warm = WarmUp(lambda: calls.append(1), lambda: False, owner, rest_ms=20)
    qtbot.keyClick(widget, Qt.Key.Key_A)
    qtbot.waitUntil(lambda: bool(calls), timeout=5000)
    assert not warm.waiting and calls == [1]
    qtbot.keyClick(widget, Qt.Key.Key_A)
    assert not warm.waiting


def test_that_a_window_that_nobody_uses_stays_small(qtbot: QtBot) -> None:
    calls: list[int] = []
    owner, widget = QObject(), QWidget()
    qtbot.addWidget(widget)
    warm = WarmUp(lambda: calls.append(1), lambda: False, owner, rest_ms=1)
    qtbot.mouseMove(widget)  # a pointer on its way to elsewhere
    qtbot.wait(50)
    assert not warm.waiting and calls == []
    qtbot.mouseClick(widget, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: bool(calls), timeout=5000)


def test_that_input_puts_it_off(qtbot: QtBot) -> None:
    owner, widget = QObject(), QWidget()
    qtbot.addWidget(widget)
    warm = WarmUp(lambda: None, lambda: False, owner, rest_ms=60_000)
    timer = warm.timer
    qtbot.keyClick(widget, Qt.Key.Key_A)
    timer.setTimerType(Qt.TimerType.PreciseTimer)  # coarse ones are moved about by seconds
    timer.start()
    qtbot.wait(30)
    left = timer.remainingTime()
    qtbot.mouseMove(widget)
    qtbot.keyClick(widget, Qt.Key.Key_A)
    assert timer.remainingTime() > left
    timer.stop()


def test_that_it_waits_while_a_job_runs(qtbot: QtBot) -> None:
    calls: list[int] = []
    asked: list[int] = []
    owner, widget = QObject(), QWidget()
    qtbot.addWidget(widget)

    def busy() -> bool:
        asked.append(1)
        return len(asked) < 3

    WarmUp(lambda: calls.append(len(asked)), busy, owner, rest_ms=10)
    qtbot.keyClick(widget, Qt.Key.Key_A)
    qtbot.waitUntil(lambda: bool(calls), timeout=5000)
    assert calls == [3]


def test_that_garbage_is_collected_after_the_rooms_are_imported() -> None:
    class Loop:
        def __init__(self) -> None:
            self.itself = self

    importing.import_exporters()
    gone = weakref.ref(Loop())
    importing.import_exporters()  # as every export does
    gc.collect()
    assert gone() is None


IMPORTED = """
import sys
from kirigami_studio.studio import designing, importing
from kirigami_studio.pipeline.request import Request
from kirigami_studio.outlines import silhouettes
from kirigami_studio.settings.fabrication import FabricationSettings
request = Request(silhouettes.load("heart"), (4, 4), k=4, polish=1, trim=True)
assert request.fitted_starts
importing.import_generator()
before = set(sys.modules)
assert "torch" in before
for event in designing.generating(request, FabricationSettings(), (), False, lambda: False):
    pass
print(sorted(set(sys.modules) - before))
"""


@pytest.mark.torch
def test_that_a_run_imports_nothing_after_the_generator_was_imported() -> None:
    done = subprocess.run([sys.executable, "-c", IMPORTED], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_that_collections_leave_out_what_the_start_has_made() -> None:
    script = (
        "import gc; from kirigami_studio.gui.window.application import create_application, create_window;"
        "create_application(['kirigami-studio']); before = gc.get_freeze_count(); window = create_window();"
        "print(before, gc.get_freeze_count(), len(gc.get_objects())); window.close()"
    )
    environment = os.environ | {"QT_QPA_PLATFORM": "offscreen"}
    done = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=True)
    before, frozen, looked_at = map(int, done.stdout.split())
    assert before == 0 and frozen > 50 * looked_at


OPENED = """
import sys, threading, time
from PySide6.QtCore import QCoreApplication
from kirigami_studio.foundation.resources import resource
from kirigami_studio.gui.window.application import create_application, create_window

class Finder:
    def find_spec(self, name, path=None, target=None):
        found[threading.current_thread() is threading.main_thread()].append(name)

found = {True: [], False: []}
create_application(["kirigami-studio"])
window = create_window()
window.show()
sys.meta_path.insert(0, Finder())
window.services.project.open(resource("examples", "heart.kiri"))
end = time.monotonic() + 30.0
while not window.services.verdict.state.known or window.services.verdict.state.pending:
    assert time.monotonic() < end
    QCoreApplication.processEvents()
    time.sleep(0.01)
print("kirigami_studio.studio.verdict" in found[False], found[True])
window.close()
"""


def test_that_opening_the_first_project_imports_nothing_in_the_windows_thread() -> None:
    environment = os.environ | {"QT_QPA_PLATFORM": "offscreen"}
    done = subprocess.run([sys.executable, "-c", OPENED], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "True []"
