"""A vertex of a large sheet is dragged by 30 moves; no turn of the loop computes for as long as one step takes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hand_gestures import LEFT, NONE, OPEN, shapes_of, vertex_at
from machine_pace import window_slowness
from PySide6.QtCore import QPoint, Qt, QTimer
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot
from thread_watch import ThreadWatch

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.evaluate.score import evaluate
from kirigami_studio.gui.widgets.theme import LIGHT
from kirigami_studio.gui.window.application import create_window
from kirigami_studio.gui.window.main_window import MainWindow
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines import silhouettes
from kirigami_studio.project import edits, store
from kirigami_studio.project.document import Document

pytestmark = pytest.mark.qt

#: Voids each way: at 40 the first step takes 0.85 s of processor time, drawing the sheet 0.05 s.
VOIDS = (20, 40)
MOVES, EVERY_MS, LIMIT = 30, 16, 0.3
#: Drags, of which the best counts: a cold cache makes the same work cost more, once.
DRAGS = 3


@pytest.mark.parametrize("voids", VOIDS)
def test_that_the_window_goes_on_while_a_vertex_of_a_large_sheet_is_dragged(
    voids: int, qtbot: QtBot, tmp_path: Path
) -> None:
    target, draw = silhouettes.load("heart"), np.random.default_rng(3)
    field = RatioField.from_log10(0.03 * draw.normal(size=(voids, voids)))
    design = Candidate(Sheet(field), evaluate(deploy(field), target, 0.0), seed=1, index=0)
    store.save(edits.set_candidates(edits.set_target(Document(), target).document, [design], {}).document,
               tmp_path / "large.kiri")  # fmt: skip
    window = create_window(LIGHT)
    window.show()
    window.services.project.open(tmp_path / "large.kiri")
    qtbot.waitUntil(lambda: window.fabrication.export.isEnabled() and not window.session.queue.busy, timeout=900_000)
    window.stage.deployment.set_phi(OPEN)
    window.commands["hand"].trigger()
    watch, longest = ThreadWatch(), []
    for _ in range(DRAGS):
        before = window_slowness()
        watch.begin()
        drag(window, qtbot)
        longest.append(watch.end().frozen / (0.5 * (before + window_slowness())))
        QTest.keyClick(window.stage.view, Qt.Key.Key_Escape)
        if longest[-1] < LIMIT:
            break
    print("\nlongest turns (ms): " + ", ".join(f"{1000 * turn:.0f}" for turn in longest))
    watch.close()
    window.session.history.mark_saved()
    assert window.close()
    assert min(longest) < LIMIT


def drag(window: MainWindow, qtbot: QtBot) -> None:
    """Take hold of the uppermost vertex, move it by a pixel in each turn, and wait until it has followed."""
    view = window.stage.view
    start = vertex_at(view, int(shapes_of(view).vertices[:, 1].argmin()))
    before, moved, timer = view.design, [0], QTimer()

    def move() -> None:
        if moved[0] == 0:
            QTest.mousePress(view, LEFT, NONE, start)
        QTest.mouseMove(view, start - QPoint(0, moved[0] // 4))
        moved[0] += 1

    timer.timeout.connect(move)
    timer.start(EVERY_MS)
    qtbot.waitUntil(lambda: moved[0] > MOVES, timeout=900_000)
    timer.stop()
    qtbot.waitUntil(lambda: view.design is not before, timeout=900_000)
