"""The measures that limits are held against: they see slow work, and nothing that merely takes long."""

from __future__ import annotations

import time

import pytest
from machine_pace import window_slowness
from paint_counter import PaintCounter
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot
from stopwatch import fastest, paced, slowness

pytestmark = pytest.mark.qt


def spin(seconds: float) -> None:
    """Compute for so many processor seconds."""
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass


def test_that_waiting_costs_nothing_and_computing_costs_its_time() -> None:
    assert fastest(lambda: time.sleep(0.2), 1) < 0.05
    assert 0.2 <= fastest(lambda: spin(0.2), 1) < 0.3


def test_that_slow_work_is_above_a_limit_at_any_pace() -> None:
    work = [0]

    def much() -> None:
        work[0] = sum(number * number % 7 for number in range(3_000_000))

    assert paced(much, 1) > 10.0 * paced(lambda: sum(number * number % 7 for number in range(30_000)), 3)


def test_that_a_slow_machine_is_given_as_much_longer(monkeypatch: pytest.MonkeyPatch, qtbot: QtBot) -> None:
    assert slowness() >= 1.0 and window_slowness() >= 1.0
    monkeypatch.setattr("stopwatch._reference_work", lambda: spin(0.0485))
    assert slowness() == pytest.approx(5.0, rel=0.2)
    assert paced(lambda: spin(0.5), 1) == pytest.approx(0.1, rel=0.3)
    monkeypatch.setattr("machine_pace._reference_work", lambda: spin(0.038))
    assert window_slowness() == pytest.approx(2.0, rel=0.2)


def test_that_every_painting_is_counted(qtbot: QtBot) -> None:
    widget = QWidget()
    qtbot.addWidget(widget)
    with qtbot.waitExposed(widget):
        widget.show()
    counter = PaintCounter(widget)
    for _ in range(3):
        widget.repaint()
    assert counter.count == 3
