"""The longest of several texts that fits into a line, in a time that depends on the line and not on the text."""

from __future__ import annotations

from textwrap import wrap

from PySide6.QtCore import Qt
from PySide6.QtGui import QFontMetrics

#: No text has more letters in a pixel, marks above and below letters among them; longer ones are not measured.
LETTERS_PER_PIXEL = 2
#: Letters that anybody reads of one line, in a tooltip; and that its lines are broken at.
LONGEST_LINE, TOOLTIP_LINE = 4000, 72


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
