"""The name and the note of a design, in a small frame beside its card."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QPoint, QRect, QSize, Qt
from PySide6.QtGui import QGuiApplication, QHideEvent, QKeyEvent
from PySide6.QtWidgets import QFrame, QLineEdit, QPlainTextEdit, QPushButton, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.widgets.layouts import column, row
from kirigami_studio.gui.widgets.layouts import label as label_of
from kirigami_studio.project.labels import LONGEST_NAME, Label

#: Takes name and note; the sentence why it does not, "" where it does.
Take = Callable[[str, str], str]


class LabelEditor(QFrame):
    """Takes what was typed on Enter, on Done and when the user clicks elsewhere; Esc leaves everything as it was."""

    def __init__(self, parent: QWidget, label: Label, take: Take) -> None:
        super().__init__(parent, Qt.WindowType.Popup)
        self.setObjectName("popup")
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._take = take
        self._over = False
        self.name = QLineEdit(label.text)
        self.name.setObjectName("designName")
        self.name.setMaxLength(LONGEST_NAME)
        self.name.setPlaceholderText(label.code)
        self.name.setAccessibleName(tr("Name of the design"))
        self.name.setToolTip(tr("Leave empty to call it {code} again.", code=label.code))
        self.note = QPlainTextEdit(label.note)
        self.note.setObjectName("designNote")
        self.note.setTabChangesFocus(True)
        self.note.setAccessibleName(tr("Note on the design"))
        self.note.setPlaceholderText(tr("What you want to remember of this design"))
        self.problem = label_of(name="warning", wraps=True)
        self.problem.hide()
        self.done = QPushButton(tr("Done"))
        self.done.setToolTip(tr("Keep name and note (Enter; in the note Ctrl+Enter). Esc cancels."))
        self.done.clicked.connect(self._finish)
        name, note = label_of(tr("Name"), self.name), label_of(tr("Note"), self.note)
        parts = (name, self.name, note, self.note, self.problem, row(..., self.done))
        column(*parts, on=self, spacing=6, margins=(12, 10, 12, 12))
        self.resize(QSize(280, 220))

    def show_beside(self, place: QRect) -> None:
        """Open below a place on the screen, inside the screen; the whole name is selected."""
        corner = place.bottomLeft() + QPoint(0, 4)
        screen = QGuiApplication.screenAt(corner) or QGuiApplication.primaryScreen()
        area = screen.availableGeometry()
        top = corner.y() if corner.y() + self.height() <= area.bottom() else place.top() - self.height() - 4
        left = min(corner.x(), area.right() - self.width())
        self.move(max(left, area.left()), max(top, area.top()))
        self.show()
        self.name.setFocus()
        self.name.selectAll()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        if event.key() == Qt.Key.Key_Escape:
            self._over = True
            self.close()
        elif event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):  # the note takes its own ones
            self._finish()
        else:
            super().keyPressEvent(event)

    def hideEvent(self, event: QHideEvent) -> None:  # noqa: N802 - Qt's name
        if not self._over:
            self._over = True
            self._take(self.name.text(), self.note.toPlainText())
        super().hideEvent(event)

    def _finish(self) -> None:
        """Close, unless the name cannot be taken: then say why."""
        reason = self._take(self.name.text(), self.note.toPlainText())
        if reason:
            self.problem.setText(reason)
            self.problem.show()
            self.adjustSize()
            self.name.setFocus()
            self.name.selectAll()
        else:
            self._over = True
            self.close()
