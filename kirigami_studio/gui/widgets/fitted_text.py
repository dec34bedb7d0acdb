"""The longest of several texts that fits into a line, in a time that depends on the line and not on the text."""

from __future__ import annotations

from textwrap import wrap

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtGui import QFontMetrics, QHelpEvent
from PySide6.QtWidgets import QAbstractButton, QAbstractSpinBox, QComboBox, QToolTip, QWidget

#: No text has more letters in a pixel, marks above and below letters among them; longer ones are not measured.
LETTERS_PER_PIXEL = 2
#: Letters that anybody reads of one line, in a tooltip; and that its lines are broken at.
LONGEST_LINE, TOOLTIP_LINE = 4000, 72
#: What is pressed or typed into, and the most lines of its tooltips.
CONTROLS, BRIEF = (QAbstractButton, QAbstractSpinBox, QComboBox), 2


def fits(metrics: QFontMetrics, text: str, room: float) -> bool:
    """Whether a text fits into ``room`` pixels."""
    return len(text) <= LETTERS_PER_PIXEL * room and metrics.horizontalAdvance(text) <= room


def elided(
    metrics: QFontMetrics, text: str, room: float, cut_off: Qt.TextElideMode = Qt.TextElideMode.ElideRight
) -> str:
    """The text with an ellipsis where it does not fit into ``room`` pixels."""
    half = max(round(LETTERS_PER_PIXEL * room), 1)
    return metrics.elidedText(text if len(text) <= 2 * half else text[:half] + text[-half:], cut_off, round(room))


def fitted(
    metrics: QFontMetrics, texts: tuple[str, ...], room: float, cut_off: Qt.TextElideMode = Qt.TextElideMode.ElideRight
) -> str:
    """The first of the texts that fits into ``room`` pixels, else the last one with an ellipsis."""
    return elided(metrics, next((text for text in texts if fits(metrics, text, room)), texts[-1]), room, cut_off)


def shortened(text: str) -> str:
    """The text as far as anybody reads it in one line."""
    return text if len(text) <= LONGEST_LINE else f"{text[:LONGEST_LINE]} \N{HORIZONTAL ELLIPSIS}"


def wrapped(text: str, most: int | None = None) -> str:
    """The text of a tooltip in lines that are soon read, ``most`` of them."""
    lines = [
        part
        for line in shortened(text).split("\n")
        for part in wrap(line, TOOLTIP_LINE, break_on_hyphens=False) or [""]
    ]
    if most is not None and len(lines) > most:
        lines = [*lines[: most - 1], f"{lines[most - 1]} \N{HORIZONTAL ELLIPSIS}"]
    return "\n".join(lines)


class BriefTooltips(QObject):
    """Shows the tooltips of controls in two short lines: more would lie over what it is about."""

    def __init__(self, root: QWidget) -> None:
        super().__init__(root)
        for control in root.findChildren(QWidget):
            if isinstance(control, CONTROLS):
                control.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        if not isinstance(event, QHelpEvent) or not isinstance(watched, QWidget) or not watched.toolTip():
            return False
        if event.type() == QEvent.Type.ToolTip:
            QToolTip.showText(event.globalPos(), wrapped(watched.toolTip(), BRIEF), watched)
            return True
        return False
