"""Uncaught errors become messages in the window; Qt's own messages go to the log."""

from __future__ import annotations

import logging
import sys
import traceback
from collections.abc import Callable
from types import TracebackType

from PySide6.QtCore import QMessageLogContext, QtMsgType, qInstallMessageHandler

from kirigami_studio.foundation.errors import KirigamiError
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


def show_uncaught(tell: Callable[[Message], None]) -> None:
    """Show uncaught errors as messages in the window from now on."""

    def hook(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        if issubclass(kind, KeyboardInterrupt):
            sys.__excepthook__(kind, error, trace)
            return
        log.error("uncaught error", exc_info=(kind, error, trace))
        tell(message_for(error))

    sys.excepthook = hook


def message_for(error: BaseException) -> Message:
    """Return the message for an uncaught error: its own sentence where it has one for the user."""
    details = "".join(traceback.format_exception(error))
    if isinstance(error, KirigamiError):
        return Message(str(error), Tone.ERROR, details)
    sentence = tr(
        "Unexpected error: {value}. Your work is intact; save it to be safe.",
        value=error or type(error).__name__,
    )
    return Message(sentence, Tone.ERROR, details)
