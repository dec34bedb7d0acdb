"""The job queue: order, failure, cancel, many at once."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from itertools import pairwise

import pytest
from PySide6.QtCore import QEventLoop, QThread, QTimer
from pytestqt.qtbot import QtBot

from kirigami_studio.foundation.errors import KirigamiError, TargetError
from kirigami_studio.foundation.steps import single
from kirigami_studio.gui.session.queue import JobCallbacks, JobQueue

Until = Callable[[Callable[[], bool]], None]


@pytest.fixture
def queue(qtbot: QtBot) -> Iterator[JobQueue]:
    made = JobQueue()
    yield made
    made.close()
    assert all(not thread.isRunning() for thread in made.findChildren(QThread))


def test_that_reports_arrive_in_order_in_the_window_thread(queue: JobQueue, until: Until) -> None:
    heard: list[object] = []
    threads: set[int] = set()

    def steps(cancel: Callable[[], bool]) -> Iterator[object]:
        threads.add(threading.get_ident())
        yield from range(50)

    def hear(report: object) -> None:
        heard.append(report)
        assert threading.get_ident() == threading.main_thread().ident

    done: list[bool] = []
    queue.start("counting", steps, JobCallbacks(hear, lambda: done.append(True)))
    until(lambda: bool(done))
    assert heard == list(range(50)) and threads != {threading.main_thread().ident}
    assert not queue.busy


def test_that_a_single_job_reports_once_what_its_work_returns(queue: JobQueue, until: Until) -> None:
    heard: list[int] = []
    done: list[bool] = []
    queue.start("counting", single(lambda cancel: 6 * 7), JobCallbacks(heard.append, lambda: done.append(True)))
    until(lambda: bool(done))
    assert heard == [42]


def test_that_a_short_job_does_not_wait_for_a_long_one(queue: JobQueue, until: Until) -> None:
    order: list[str] = []
    release = threading.Event()

    def long(cancel: Callable[[], bool]) -> Iterator[object]:
        while not release.is_set():
            yield None

    def short(cancel: Callable[[], bool]) -> Iterator[object]:
        yield None

    queue.start("long", long, JobCallbacks(on_finished=lambda: order.append("long")))
    queue.start("short", short, JobCallbacks(on_finished=lambda: (order.append("short"), release.set())[0]))
    until(lambda: len(order) == 2)
    assert order == ["short", "long"]


def test_that_a_cancelled_job_says_so_and_stops(queue: JobQueue, until: Until) -> None:
    heard: list[str] = []

    def endless(cancel: Callable[[], bool]) -> Iterator[object]:
        while True:
            yield None

    number = queue.start("going on", endless, JobCallbacks(on_cancelled=lambda: heard.append("cancelled")))
    queue.cancel(number)
    until(lambda: heard == ["cancelled"])
    assert not queue.busy


@pytest.mark.parametrize(
    ("error", "expected"),
    [
        (TargetError("The file is empty; choose another."), "The file is empty; choose another."),
        (ZeroDivisionError("division by zero"), "Unexpected error while dividing: division by zero."),
    ],
)
def test_that_a_failure_is_a_sentence_with_a_trace(
    queue: JobQueue, until: Until, error: Exception, expected: str
) -> None:
    heard: list[tuple[str, str]] = []

    def failing(cancel: Callable[[], bool]) -> Iterator[object]:
        yield None
        raise error

    queue.start("dividing", failing, JobCallbacks(on_failed=lambda sentence, trace: heard.append((sentence, trace))))
    until(lambda: bool(heard))
    assert heard[0][0] == expected and "failing" in heard[0][1]


def test_that_an_abandoned_job_is_no_longer_heard(queue: JobQueue, until: Until) -> None:
    heard: list[object] = []
    started, go = threading.Event(), threading.Event()

    def steps(cancel: Callable[[], bool]) -> Iterator[object]:
        started.set()
        go.wait(10)
        yield "too late"

    number = queue.start(
        "slow", steps, JobCallbacks(heard.append, lambda: heard.append("done"), lambda: heard.append("stop"))
    )
    assert started.wait(10)
    queue.abandon(number)
    go.set()
    until(lambda: not queue.busy)
    assert heard == []


def test_that_the_window_lives_between_reports_that_come_all_at_once(queue: JobQueue, until: Until) -> None:
    ticks: list[int] = []
    heard: list[int] = []
    timer = QTimer()
    timer.setInterval(0)
    timer.timeout.connect(lambda: ticks.append(len(heard)))

    def hear(report: object) -> None:
        time.sleep(0.004)
        heard.append(len(heard))

    done: list[bool] = []
    queue.start("counting", lambda cancel: iter(range(50)), JobCallbacks(hear, lambda: done.append(True)))
    time.sleep(0.3)  # the worker has said it all
    timer.start()
    until(lambda: bool(done))
    timer.stop()
    assert len(heard) == 50
    turns = sorted(set(ticks) | {0, 50})
    assert max(after - before for before, after in pairwise(turns)) <= 5


def test_that_a_dialog_opened_by_a_report_hears_the_next_ones(queue: JobQueue, until: Until) -> None:
    heard: list[object] = []
    dialog = QEventLoop()
    times_out = QTimer(dialog)
    times_out.setSingleShot(True)
    times_out.timeout.connect(lambda: dialog.exit(1))
    closed_by: list[int] = []

    def hear(report: object) -> None:
        heard.append(report)
        if report == 0:
            times_out.start(10_000)
            closed_by.append(dialog.exec())
        if report == 2:
            dialog.exit(0)

    queue.start("asking", lambda cancel: iter(range(3)), JobCallbacks(hear))
    until(lambda: not queue.busy and bool(closed_by))
    times_out.stop()
    assert heard == [0, 1, 2] and closed_by == [0]


class UnspeakableError(Exception):
    """An error whose own text cannot be made."""

    def __str__(self) -> str:
        raise ValueError("no text")


class UnspeakableRefusalError(KirigamiError):
    """The same of the program's own errors."""

    def __str__(self) -> str:
        raise RecursionError("no text")


@pytest.mark.parametrize(
    "error",
    [UnspeakableError(), UnspeakableRefusalError("target.empty"), SystemExit(3)],
    ids=lambda error: type(error).__name__,
)
def test_that_a_job_ends_whatever_its_error_says(
    queue: JobQueue, until: Until, error: BaseException, caplog: pytest.LogCaptureFixture
) -> None:
    def steps(cancel: Callable[[], bool]) -> Iterator[object]:
        yield 1
        raise error

    failures: list[tuple[str, str]] = []
    queue.start("reading heart.svg", steps, JobCallbacks(on_failed=lambda *failure: failures.append(failure)))
    until(lambda: bool(failures))
    assert not queue.busy
    assert failures[0][0] and type(error).__name__ in failures[0][1]
    done: list[bool] = []
    queue.start("counting", single(lambda cancel: 1), JobCallbacks(on_finished=lambda: done.append(True)))
    until(lambda: bool(done))  # and the thread lives
    caplog.clear()
