"""The framed box that every panel of the window sits in."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, QPoint, QSize, Qt
from PySide6.QtGui import QAction, QPainter, QPaintEvent, QResizeEvent
from PySide6.QtWidgets import (
    QAbstractSpinBox,
    QFrame,
    QLabel,
    QLayout,
    QScrollArea,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.widgets.fitted_text import fits, fitted, shortened
from kirigami_studio.gui.widgets.layouts import column, label, row
from kirigami_studio.gui.widgets.number_field import number_field
from kirigami_studio.gui.widgets.theme import Palette

TOOL_ICON = QSize(18, 18)
#: Pixels of a title that are shown in any window; a header plans no more than this share of its width for one.
LEAST_TITLE, TITLE_SHARE = 72, 0.4
INSET = 12


class Card(QFrame):
    """A titled box: a header row, then whatever is added to :attr:`body`."""

    def __init__(self, title: str, parent: QWidget | None = None, right_inset: int = INSET) -> None:
        super().__init__(parent)
        self.setObjectName("card")
        self.setAccessibleName(title)
        self.title = CardTitle(title)
        self.header, self.body = row((self.title, 1), spacing=4), column(spacing=8)
        column(self.header, (self.body, 1), on=self, spacing=8, margins=(INSET, 8, right_inset, INSET))


class ToolButton(QToolButton):
    """A flat button with one of the program's icons, in the colours of the theme once that is known."""

    def __init__(self, name: str, icon: str, tip: str, checkable: bool = False) -> None:
        super().__init__()
        self._icon_name = icon
        self._palette: Palette | None = None
        self.setObjectName(name)
        self.setToolTip(tip)
        self.setAccessibleName(tip.split(".")[0])
        self.setCheckable(checkable)
        self.setIconSize(TOOL_ICON)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)

    def show_icon(self, name: str) -> None:
        """Show another icon."""
        self._icon_name = name
        if self._palette is not None:
            self.setIcon(icons.icon(name, self._palette))

    def set_palette(self, palette: Palette) -> None:
        self._palette = palette
        self.show_icon(self._icon_name)


class SwitchButton(ToolButton):
    """A button that shows a switch, which is a checkable action: a command may be the same action."""

    def __init__(self, name: str, icon: str, tip: str) -> None:
        super().__init__(name, icon, tip)
        self.switch = QAction(self)
        self.switch.setCheckable(True)
        self.switch.setToolTip(tip)
        self.setDefaultAction(self.switch)

    def show_icon(self, name: str) -> None:
        self._icon_name = name
        if self._palette is not None:
            self.switch.setIcon(icons.icon(name, self._palette))


class ElidedLabel(QLabel):
    """One muted line, shorter or with an ellipsis where it does not fit; the tooltip has it whole."""

    def __init__(self, cut_off: Qt.TextElideMode = Qt.TextElideMode.ElideMiddle) -> None:
        super().__init__()
        self.setObjectName("muted")
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self._cut_off = cut_off
        self._shorter: tuple[str, ...] = ()

    def setText(self, text: str, *shorter: str) -> None:  # noqa: N802 - Qt's name
        """Set a text, and ``shorter`` versions of which the first that fits is shown."""
        self._shorter = shorter
        super().setText(shortened(text))
        self.setToolTip(self.text())

    def minimumSizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return QSize(0, super().minimumSizeHint().height())

    def drawn_text(self) -> str:
        """What is shown at the present width."""
        room = self.contentsRect().width()
        return fitted(self.fontMetrics(), (self.text(), *self._shorter), room, self._cut_off)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        painter = QPainter(self)
        painter.setPen(self.palette().color(self.foregroundRole()))
        painter.drawText(self.contentsRect(), int(self.alignment()), self.drawn_text())
        painter.end()


class CardTitle(ElidedLabel):
    """What a card is about; a long name ends in an ellipsis, and never makes the card wider."""

    def __init__(self, title: str) -> None:
        super().__init__(Qt.TextElideMode.ElideRight)
        self.setObjectName("cardTitle")
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)
        self.setMinimumHeight(30)
        self.setText(title)

    def minimumSizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return QSize(min(self.sizeHint().width(), LEAST_TITLE), super().minimumSizeHint().height())


class FittingLabel(QLabel):
    """Shows the longest of several texts that fits, or none."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("muted")
        self._texts: tuple[str, ...] = ()

    def set_texts(self, *texts: str) -> None:
        """The texts to choose from, longest first."""
        self._texts = texts

    def minimumSizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return QSize(0, super().minimumSizeHint().height())

    def fit(self, width: int) -> bool:
        """Show the longest text that fits into ``width`` pixels; whether any does."""
        chosen = next((text for text in self._texts if fits(self.fontMetrics(), text, width)), "")
        self.setText(chosen)
        self.setVisible(bool(chosen))
        return bool(chosen)


class ScrolledWhenShort(QScrollArea):
    """As high as its content where that fits; else scrolled, ending below a whole row at first."""

    def __init__(self, content: QWidget, least: int) -> None:
        super().__init__()
        self._least = least
        self._content = content
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        self.setWidget(content)
        content.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        if event.type() == QEvent.Type.LayoutRequest:
            self.updateGeometry()
            self._end_below_row()
        return super().eventFilter(watched, event)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        self._end_below_row()

    def _end_below_row(self) -> None:
        """Leave free the room where a row would be cut off."""
        room, free = self.height(), 0
        if self._content.sizeHint().height() > room:
            parts = [part for part in self._content.findChildren(QWidget) if _in_row(part, self._content)]
            spans = [_span(part, self._content) for part in parts]
            ends = [bottom for _, bottom in spans if bottom <= room]
            whole = [end for end in ends if not any(top < end < bottom for top, bottom in spans)]
            free = room - max(whole, default=room)
        if free != self.viewportMargins().bottom():
            self.setViewportMargins(0, 0, 0, free)

    def sizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        return self._content.sizeHint()

    def minimumSizeHint(self) -> QSize:  # noqa: N802 - Qt's name
        # The bar stands beside the content, not on it.
        width = self._content.minimumSizeHint().width() + self.verticalScrollBar().sizeHint().width()
        return QSize(width, min(self._least, self.sizeHint().height()))


def _in_row(part: QWidget, content: QWidget) -> bool:
    """Whether a layout has put it where it stands, and it is no pane that holds others."""
    holder = part.parentWidget()
    return part.isVisibleTo(content) and part.layout() is None and holder is not None and holder.layout() is not None


def _span(part: QWidget, content: QWidget) -> tuple[int, int]:
    """Upper and lower edge (pixels) of a part of the content; a caption ends where its field does."""
    field = part.buddy() if isinstance(part, QLabel) else None
    both = (part,) if field is None or not field.isVisibleTo(content) else (part, field)
    tops = [one.mapTo(content, QPoint()).y() for one in both]
    return min(tops), max(top + one.height() for top, one in zip(tops, both, strict=True))


def compact(box: QAbstractSpinBox, width: int = 62) -> None:
    """Let a number field be as narrow as its column instead of as wide as its largest number."""
    box.setMinimumWidth(width)
    number_field(box)
    box.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)


def captioned(text: str, buddy: QWidget, content: QWidget | QLayout) -> QVBoxLayout:
    """A small caption above a control; ``buddy`` gets the focus when its mnemonic is pressed."""
    return column(label(text, buddy), content, spacing=3)


def muted_label() -> QLabel:
    """A muted label that wraps."""
    return label(wraps=True)


def own_markup(words: QLabel) -> None:
    """Show a label's text as HTML: for text of the program's own, never for a name, a path or a message.

    Every other label and every tooltip of the application is plain text: ``studio.qss`` says so.
    """
    words.setProperty("markup", True)
    words.setTextFormat(Qt.TextFormat.RichText)
