"""Rows and columns of widgets, said in one line, and the small controls that panels have in common."""

from __future__ import annotations

from types import EllipsisType

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QLabel, QLayout, QPushButton, QSlider, QVBoxLayout, QWidget

#: A widget or a layout, alone or with its stretch; pixels of room; or ``...`` for the room that is left.
Part = QWidget | QLayout | tuple[QWidget | QLayout, int] | int | EllipsisType
#: Left, top, right, bottom, pixels.
Margins = tuple[int, int, int, int]
#: Least edge (pixels) of what a finger presses; the style sheet keeps it for buttons, boxes and fields.
TOUCH = 32
NO_MARGINS: Margins = (0, 0, 0, 0)


def row(
    *parts: Part, on: QWidget | None = None, spacing: int | None = None, margins: Margins = NO_MARGINS
) -> QHBoxLayout:
    """Lay parts out side by side, ``on`` a widget or for another layout; without ``spacing`` as the style does."""
    line = QHBoxLayout() if on is None else QHBoxLayout(on)
    _fill(line, parts, spacing, margins)
    return line


def column(
    *parts: Part, on: QWidget | None = None, spacing: int | None = None, margins: Margins = NO_MARGINS
) -> QVBoxLayout:
    """Lay parts out below each other, as :func:`row` does side by side."""
    line = QVBoxLayout() if on is None else QVBoxLayout(on)
    _fill(line, parts, spacing, margins)
    return line


def _fill(line: QBoxLayout, parts: tuple[Part, ...], spacing: int | None, margins: Margins) -> None:
    line.setContentsMargins(*margins)
    if spacing is not None:
        line.setSpacing(spacing)
    for part in parts:
        if isinstance(part, int):
            line.addSpacing(part)
        elif isinstance(part, EllipsisType):
            line.addStretch(1)
        else:
            content, stretch = part if isinstance(part, tuple) else (part, 0)
            if isinstance(content, QWidget):
                line.addWidget(content, stretch)
            else:
                line.addLayout(content, stretch)


def plain_pane(name: str = "plain") -> QWidget:
    """A widget that only holds others, without a ground of its own."""
    pane = QWidget()
    pane.setObjectName(name)
    return pane


def label(text: str = "", buddy: QWidget | None = None, name: str = "muted", wraps: bool = False) -> QLabel:
    """Words in the style ``name``; the ``buddy`` gets the focus when their mnemonic is pressed."""
    words = QLabel(text)
    words.setObjectName(name)
    words.setWordWrap(wraps)
    if buddy is not None:
        words.setBuddy(buddy)
    return words


def push_button(text: str, tip: str = "", name: str = "small") -> QPushButton:
    """A button in the style ``name``, which the Tab key reaches and a click gives no focus."""
    button = QPushButton(text)
    button.setObjectName(name)
    button.setToolTip(tip)
    button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    return button


def slider(name: str, accessible: str, tip: str, last: int, page: int, first: int = 0) -> QSlider:
    """A slider from ``first`` to ``last``, which moves by ``page`` at a click beside its handle."""
    made = QSlider(Qt.Orientation.Horizontal)
    made.setObjectName(name)
    made.setRange(first, last)
    made.setPageStep(page)
    made.setAccessibleName(accessible)
    made.setToolTip(tip)
    return made
