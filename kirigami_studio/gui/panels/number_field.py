"""Number fields that leave alone what is not meant for them: the wheel of one who scrolls past, the window's keys."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QAbstractSpinBox

#: Keys that, with Ctrl, mean something to the window: undo, redo and export.  A field keeps undo while it is typed in.
WINDOW_KEYS = (Qt.Key.Key_Z, Qt.Key.Key_Y, Qt.Key.Key_E)


class _Courtesy(QObject):
    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        if isinstance(watched, QAbstractSpinBox):
            if event.type() == QEvent.Type.Wheel and not watched.hasFocus():
                event.ignore()
                return True
            if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent):
                typing = watched.lineEdit().isModified() and event.key() != Qt.Key.Key_E
                ctrl = bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier)
                if ctrl and event.key() in WINDOW_KEYS and not typing:
                    event.ignore()
                    return True
        return super().eventFilter(watched, event)


def number_field(box: QAbstractSpinBox) -> None:
    """Give a field its margin and its manners: it turns by the wheel only while it has the focus."""
    box.lineEdit().setTextMargins(6, 0, 0, 0)
    box.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    box.installEventFilter(_Courtesy(box))
