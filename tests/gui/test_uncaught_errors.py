"""An error that nobody caught becomes a message, wherever it happened; only the window's thread touches widgets."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterator

import pytest

from kirigami_studio.gui.session.messages import Message
from kirigami_studio.gui.session.queue import JobCallbacks
from kirigami_studio.gui.widgets.message_bar import MessageBar
from kirigami_studio.gui.widgets.uncaught_errors import message_for, show_uncaught
from kirigami_studio.gui.window.main_window import MainWindow

Until = Callable[[Callable[[], bool]], None]


@pytest.fixture(autouse=True)
def hooks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Python's hooks as they were, afterwards."""
    monkeypatch.setattr(sys, "excepthook", sys.excepthook)
    monkeypatch.setattr(threading, "excepthook", threading.excepthook)


class UnspeakableError(Exception):
    def __str__(self) -> str:
        raise ValueError("no text")


def raised_elsewhere(raise_one: Callable[[], None]) -> None:
    """Let a thread of its own end with an error that it hands to Python's hook."""

    def act() -> None:
        try:
            raise_one()
        except Exception as error:
            sys.excepthook(type(error), error, error.__traceback__)

    thread = threading.Thread(target=act)
    thread.start()
    thread.join()


def fail() -> None:
    raise UnspeakableError


def test_that_an_error_of_another_thread_is_told_by_the_windows_thread(window: MainWindow, until: Until) -> None:
    told_by: list[int] = []
    messages: list[Message] = []

    def tell(message: Message) -> None:
        told_by.append(threading.get_ident())
        messages.append(message)
        window.messages.add(message)

    show_uncaught(tell)
    raised_elsewhere(fail)
    assert told_by == []  # nothing happens before the window's thread has its turn
    until(lambda: bool(told_by))
    assert told_by == [threading.main_thread().ident]
    assert "UnspeakableError" in messages[0].sentence and "UnspeakableError" in messages[0].details
    assert window.messages.isVisible()


def test_that_no_widget_is_touched_from_another_thread(
    window: MainWindow, until: Until, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """Neither by a job that fails nor by a thread whose error nobody caught; Qt's warnings fail this test, too."""
    threads: list[int] = []
    show = MessageBar._go

    def noted(bar: MessageBar, index: int) -> None:
        threads.append(threading.get_ident())
        show(bar, index)

    monkeypatch.setattr(MessageBar, "_go", noted)

    def steps(cancel: Callable[[], bool]) -> Iterator[object]:
        yield 1
        raise UnspeakableError

    show_uncaught(window.messages.add)
    window.session.queue.start("reading", steps, JobCallbacks(on_failed=window.session.report_failure))
    raised_elsewhere(fail)
    until(lambda: len(window.messages.messages) == 2)
    assert set(threads) == {threading.main_thread().ident}
    caplog.clear()


def test_that_an_error_of_a_plain_thread_is_told_too(window: MainWindow, until: Until) -> None:
    show_uncaught(window.messages.add)
    thread = threading.Thread(target=fail)
    thread.start()
    thread.join()
    until(lambda: len(window.messages.messages) == 1)


def test_that_an_error_without_a_text_has_a_message() -> None:
    message = message_for(UnspeakableError())
    assert message.sentence.startswith("Unexpected error: UnspeakableError.") and "UnspeakableError" in message.details
