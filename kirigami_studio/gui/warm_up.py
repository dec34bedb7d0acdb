"""Loading the generator ahead of its first use, at a moment when nobody is touching the window.

Importing torch in another thread still holds up this one for most of a second: unnoticed by hands that rest, a freeze
under hands that drag.
"""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QCoreApplication, QEvent, QObject, QTimer

#: Rest (ms) after which nobody is held up: a reader's or a thinker's pause, longer than that between two gestures.
REST_MS = 2500
TOUCHES = frozenset(
    {
        QEvent.Type.MouseMove,
        QEvent.Type.MouseButtonPress,
        QEvent.Type.MouseButtonRelease,
        QEvent.Type.KeyPress,
        QEvent.Type.Wheel,
        QEvent.Type.DragMove,
        QEvent.Type.Resize,
    }
)


class WarmUp(QObject):
    """Calls ``act`` once, after the application has had no input for a while and ``busy`` says no."""

    def __init__(
        self, act: Callable[[], None], busy: Callable[[], bool], parent: QObject, rest_ms: int = REST_MS
    ) -> None:
        super().__init__(parent)
        self._act = act
        self._busy = busy
        self.timer = QTimer(self)
        self.timer.setInterval(rest_ms)
        self.timer.setSingleShot(True)
        self.timer.timeout.connect(self._rested)
        application = QCoreApplication.instance()
        if application is not None:
            application.installEventFilter(self)
        self.timer.start()

    @property
    def waiting(self) -> bool:
        """Whether it has not happened yet."""
        return self.timer.isActive()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        if event.type() in TOUCHES:
            self.timer.start()
        return False

    def _rested(self) -> None:
        if self._busy():
            self.timer.start()
            return
        application = QCoreApplication.instance()
        if application is not None:
            application.removeEventFilter(self)
        self._act()
