"""Uncaught errors become messages in the window; Qt's own messages go to the log."""

from __future__ import annotations

import logging
import sys
import threading
import traceback
from collections.abc import Callable
from types import TracebackType

from PySide6.QtCore import (
    QCoreApplication,
    QMessageLogContext,
    QObject,
    Qt,
    QtMsgType,
    Signal,
    Slot,
    qInstallMessageHandler,
)

from kirigami_studio.foundation.errors import KirigamiError, text_of
from kirigami_studio.foundation.log import topic
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.messages import Message, Tone

log = topic("gui")
qt_log = topic("gui.qt")

LEVELS = {
    QtMsgType.QtDebugMsg: logging.DEBUG,
    QtMsgType.QtInfoMsg: logging.INFO,
    QtMsgType.QtWarningMsg: logging.WARNING,
    QtMsgType.QtCriticalMsg: logging.ERROR,
    QtMsgType.QtFatalMsg: logging.CRITICAL,
}


def log_qt_message(kind: QtMsgType, context: QMessageLogContext, text: str) -> None:
    """Write one message of Qt to the log."""
    qt_log.log(LEVELS.get(kind, logging.WARNING), "%s", text)


def log_qt_messages() -> None:
    """Send Qt's messages to the log from now on."""
    qInstallMessageHandler(log_qt_message)


class UncaughtErrors(QObject):
    """Hands errors that nobody caught, in whatever thread, over to the thread that it was made in."""

    raised = Signal(Message)

    def __init__(self, tell: Callable[[Message], None], parent: QObject | None) -> None:
        super().__init__(parent)
        self._tell_message = tell
        self.raised.connect(self._tell, Qt.ConnectionType.QueuedConnection)

    @Slot(Message)
    def _tell(self, message: Message) -> None:
        self._tell_message(message)

    def take(self, kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        """Log an error and tell of it in the next turn of the event loop."""
        if issubclass(kind, KeyboardInterrupt):
            sys.__excepthook__(kind, error, trace)
            return
        log.error("uncaught error", exc_info=(kind, error, trace))
        self.raised.emit(message_for(error))


def show_uncaught(tell: Callable[[Message], None]) -> None:
    """Show uncaught errors of all threads as messages in the window from now on."""
    errors = UncaughtErrors(tell, QCoreApplication.instance())
    sys.excepthook = errors.take

    def take_from_thread(told: threading.ExceptHookArgs) -> None:
        if told.exc_value is not None and not issubclass(told.exc_type, SystemExit):
            errors.take(told.exc_type, told.exc_value, told.exc_traceback)

    threading.excepthook = take_from_thread


def message_for(error: BaseException) -> Message:
    """Return the message for an uncaught error: its own sentence where it has one for the user."""
    details = "".join(traceback.format_exception(error))
    if isinstance(error, KirigamiError):
        return Message(text_of(error), Tone.ERROR, details)
    sentence = tr(
        "Unexpected error: {value}. Your work is intact; save it to be safe.",
        value=text_of(error),
    )
    return Message(sentence, Tone.ERROR, details)
