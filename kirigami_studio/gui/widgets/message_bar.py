"""Messages that do not stop the work: one line, details on demand, none lost.

The bar lies over the window's tool bar, where the project's name stands otherwise, and a long message hangs down over
the page: nothing on the page moves when one comes or goes.
"""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QEvent, QRect, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QGuiApplication, QHideEvent
from PySide6.QtWidgets import QBoxLayout, QFrame, QLabel, QPlainTextEdit, QSizePolicy, QWidget

from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.session.messages import Message, Tone
from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.widgets.announcing import announce
from kirigami_studio.gui.widgets.card import ToolButton
from kirigami_studio.gui.widgets.layouts import column, label, push_button, row
from kirigami_studio.gui.widgets.theme import LIGHT, Palette

#: Milliseconds after which a hint or a success has been read.
FADE_MS = 12_000
#: Lines of details that are shown without scrolling.
MOST_LINES = 9
#: Names of the tones for screen readers, in the place of the icon.
TONES = {Tone.HINT: mark("Hint"), Tone.DONE: mark("Done"), Tone.WARNING: mark("Warning"), Tone.ERROR: mark("Error")}


class MessageBar(QFrame):
    """The newest message; warnings and errors stay until they are closed, others go.

    Its owner says where it lies, by :meth:`lay_over`, whenever that changes or ``content_changed`` is told.
    """

    content_changed = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("messageBar")
        self._palette: Palette = LIGHT
        self._messages: list[Message] = []
        self._at = 0
        self.icon = QLabel()
        self.sentence = QLabel()
        self.sentence.setWordWrap(True)
        self.sentence.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.sentence.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.details = push_button(tr("Details"), name="link")
        self.details.setCheckable(True)
        self.copy = ToolButton("copyMessage", "copy", tr("Copy the message and its details."))
        self.previous = ToolButton("previousMessage", "previous", tr("Previous message."))
        self.position = label()
        self.next = ToolButton("nextMessage", "next", tr("Next message."))
        self.close_button = ToolButton("closeMessage", "close", tr("Close this message."))
        self.close_all_button = push_button(tr("Close all"), tr("Close all messages."), name="link")
        self.trace = QPlainTextEdit()
        self.trace.setReadOnly(True)
        self.trace.setAccessibleName(tr("Message details"))
        self._line = QBoxLayout(QBoxLayout.Direction.LeftToRight)
        self._actions = row(spacing=6)
        self._lay_out()
        self.details.toggled.connect(self._show_details)
        self.copy.clicked.connect(self._copy)
        self.previous.clicked.connect(lambda: self._go(self._at - 1))
        self.next.clicked.connect(lambda: self._go(self._at + 1))
        self.close_button.clicked.connect(self.close_message)
        self.close_all_button.clicked.connect(lambda: self.dismiss(*Tone))
        self._fading = QTimer(self, singleShot=True, interval=FADE_MS)
        self._fading.timeout.connect(self._fade)
        self.hide()

    def _lay_out(self) -> None:
        parts = (self.details, self.previous, self.position, self.next, self.close_all_button, self.copy)
        self._buttons = QBoxLayout(QBoxLayout.Direction.LeftToRight)
        self._buttons.setSpacing(8)
        self._buttons.addLayout(row(..., self._actions, spacing=0), 1)
        self._buttons.addLayout(row(..., *parts, self.close_button, spacing=8))
        self._line.setSpacing(8)
        self._line.addLayout(row(self.icon, (self.sentence, 1), spacing=8), 1)
        self._line.addLayout(self._buttons)
        column(self._line, self.trace, on=self, spacing=4, margins=(12, 5, 6, 5))
        self.trace.hide()

    @property
    def messages(self) -> tuple[Message, ...]:
        """All open messages, oldest first."""
        return tuple(self._messages)

    def add(self, message: Message) -> None:
        """Show a message; an equal one that is still open is not repeated."""
        if message in self._messages:
            self._go(self._messages.index(message))
            return
        # A hint or a success has had its say once something newer comes; errors and warnings stay.
        self._messages = [one for one in self._messages if one.tone in (Tone.ERROR, Tone.WARNING)]
        self._messages.append(message)
        self._go(len(self._messages) - 1)
        announce(self, message.sentence, urgent=message.tone in (Tone.ERROR, Tone.WARNING))

    def close_message(self) -> None:
        """Close the message that is shown."""
        if self._messages:
            del self._messages[self._at]
        self._go(min(self._at, len(self._messages) - 1))

    def dismiss(self, *tones: Tone) -> None:
        """Close all messages of these tones."""
        self._messages = [one for one in self._messages if one.tone not in tones]
        self._go(len(self._messages) - 1)

    def drop(self, message: Message) -> None:
        """Close one message, wherever it stands; one that is closed already stays so."""
        if message in self._messages:
            self._messages.remove(message)
            self._go(len(self._messages) - 1)

    def set_palette(self, palette: Palette) -> None:
        self._palette = palette
        unfolded = self.details.isChecked()
        self._go(self._at)
        self.details.setChecked(unfolded)

    def lay_over(self, room: QRect) -> None:
        """Lie over this part of the parent, from its top down as far as the message needs.

        Buttons stand beside the sentence, or below it where that takes less height; the answers to a question stand
        above the others where all of them are too wide for a line.
        """
        across, down = QBoxLayout.Direction.LeftToRight, QBoxLayout.Direction.TopToBottom
        halves = [self._buttons.itemAt(place) for place in (0, 1)]
        answers, others = (half.sizeHint() if half is not None else QSize(0, 0) for half in halves)
        margins = self.contentsMargins() if (layout := self.layout()) is None else layout.contentsMargins()
        line = answers.width() + self._buttons.spacing() + others.width()
        wide = room.width() - margins.left() - margins.right() - 2 * self.frameWidth()
        self._buttons.setDirection(across if line <= wide else down)
        buttons = self._buttons.sizeHint()
        # Room for the sentence below nothing but the icon, and what of it the buttons would take.
        words = room.width() - self.icon.sizeHint().width() - 4 * self._line.spacing()
        beside = self.sentence.heightForWidth(words - buttons.width() - self._line.spacing())
        below = self.sentence.heightForWidth(words) + self._line.spacing() + buttons.height()
        direction = across if max(beside, buttons.height()) <= below else down
        if direction is not self._line.direction():
            self._line.setDirection(direction)
        needed = 0 if layout is None else layout.totalHeightForWidth(room.width())
        self.setGeometry(room.x(), room.y(), room.width(), max(needed, room.height()))

    def event(self, event: QEvent) -> bool:
        """A layout that has changed may need another height."""
        if event.type() == QEvent.Type.LayoutRequest:
            self.content_changed.emit()
        return super().event(event)

    def _go(self, index: int) -> None:
        self.setVisible(bool(self._messages))
        self.raise_()
        self._fading.stop()
        if not self._messages:
            self._at = 0
            return
        self._at = min(max(index, 0), len(self._messages) - 1)
        message = self._messages[self._at]
        self.sentence.setText(message.sentence)
        self.trace.setPlainText(message.details)
        self.details.setVisible(bool(message.details))
        self.details.setChecked(False)
        several = len(self._messages) > 1
        for part in (self.previous, self.position, self.next, self.close_all_button):
            part.setVisible(several)
        self.position.setText(tr("{at} of {count}", at=self._at + 1, count=len(self._messages)))
        self.previous.setEnabled(self._at > 0)
        self.next.setEnabled(self._at < len(self._messages) - 1)
        colour = self._palette.accent if message.tone in (Tone.HINT, Tone.DONE) else self._palette.warning
        self.icon.setAccessibleName(tr(TONES[message.tone]))
        self.icon.setPixmap(icons.pixmap(message.tone.value, colour, 20, self.devicePixelRatioF()))
        passes = message.passing or not message.actions
        if message.tone in (Tone.HINT, Tone.DONE) and passes and self.isVisible():
            self._fading.start()
        self._show_actions(message)
        self.setProperty("tone", message.tone.value)
        self.style().unpolish(self)
        self.style().polish(self)

    def _fade(self) -> None:
        """Let a message go that has been read."""
        if self.underMouse() or self.details.isChecked():
            self._fading.start()
        else:
            self.close_message()

    def hideEvent(self, event: QHideEvent) -> None:  # noqa: N802 - Qt's name
        super().hideEvent(event)
        self._fading.stop()

    def _show_actions(self, message: Message) -> None:
        while (item := self._actions.takeAt(0)) is not None:
            button = item.widget()
            if button is not None:
                button.hide()
                button.deleteLater()
        for text, act in message.actions:
            choice = push_button(text, name="")
            choice.clicked.connect(lambda _=False, act=act: self._act(act, message))
            self._actions.addWidget(choice)

    def _act(self, act: Callable[[], None], message: Message) -> None:
        if message in self._messages:
            self._messages.remove(message)
        self._go(len(self._messages) - 1)
        act()

    def _show_details(self, shown: bool) -> None:
        lines = min(max(self.trace.blockCount(), 2), MOST_LINES)
        self.trace.setFixedHeight(lines * self.trace.fontMetrics().lineSpacing() + 18)
        self.trace.setVisible(shown)

    def _copy(self) -> None:
        message = self._messages[self._at]
        QGuiApplication.clipboard().setText(f"{message.sentence}\n\n{message.details}".strip())
