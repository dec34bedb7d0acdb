"""How large the opened shape is to be, in mm: what is asked for first, and what the flat sheet's width follows."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QWidget

from kirigami_studio.evaluate.opened_size import OpenedSize
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.widgets.card import ToolButton, compact
from kirigami_studio.gui.widgets.layouts import label, row
from kirigami_studio.gui.widgets.number_field import LengthField, decimal_field
from kirigami_studio.gui.widgets.readable import TIMES, readable_size
from kirigami_studio.outlines.placed import LARGEST_MM

SIZE = mark("Size of the opened shape, mm; 3 in or 8.5 cm work too.")
FOLLOWED = mark("The flat sheet is made as wide as it takes; a flat width can be typed under Fabrication instead.")
TYPED_WIDTH = mark("This follows from the flat width that was typed; a size typed here takes its place.")


class OpenedSizeRow(QWidget):
    """Two sides that keep the target's proportions; reports the longer one."""

    size_wanted = Signal(float)  #: longer side, mm
    drawn_wanted = Signal(float)  #: the same, as drawn
    edited = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._size: OpenedSize | None = None
        self._folded = False
        self.width_ = _side("openedWidth", tr("Width of the opened shape in millimetres"))
        self.height_ = _side("openedHeight", tr("Height of the opened shape in millimetres"))
        self.caption = label(tr("&Opened size"), self.width_)
        self.caption.setMinimumWidth(self.caption.sizeHint().width())
        self.drawn = ToolButton("drawnSize", "chain", tr("Back to the drawn size."))
        self.drawn.setFixedSize(29, 29)
        sides = ((self.width_, 1), label(TIMES), (self.height_, 1), label(tr("mm")))
        row(self.caption, 4, *sides, self.drawn, on=self, spacing=4)
        self.width_.valueChanged.connect(lambda width: self._report(width, 0))
        self.height_.valueChanged.connect(lambda height: self._report(height, 1))
        for field in (self.width_, self.height_):
            field.editingFinished.connect(self.edited)
        self.drawn.clicked.connect(self._on_drawn)
        self.show_size(None, follows=False)

    def show_size(self, size: OpenedSize | None, *, follows: bool) -> None:
        """Show the size, and whether the flat width ``follows`` it or the other way round; nothing without a target."""
        self._size = size
        self.fold(self._folded)
        if size is None:
            return
        about = FOLLOWED if follows else TYPED_WIDTH
        for field, side in zip((self.width_, self.height_), size.opened, strict=True):
            with QSignalBlocker(field):
                field.setValue(side)
            field.setToolTip(f"{tr(SIZE)}\n{tr(about)}")
        self.drawn.setVisible(size.drawn is not None and not size.agrees)
        if size.drawn is not None:
            self.drawn.setToolTip(tr("Back to the drawn size, {size}.", size=readable_size(*size.drawn)))

    def fold(self, folded: bool) -> None:
        """Give the room to the drawing board, which has sizes of its own."""
        self._folded = folded
        self.setVisible(self._size is not None and not folded)

    def _report(self, side: float, which: int) -> None:
        if self._size is not None:
            self.size_wanted.emit(side * max(self._size.opened) / self._size.opened[which])

    def _on_drawn(self) -> None:
        if self._size is not None and self._size.drawn is not None:
            self.drawn_wanted.emit(max(self._size.drawn))
            self.edited.emit()


def _side(name: str, accessible: str) -> LengthField:
    field = decimal_field(LengthField, name, 1.0, LARGEST_MM, step=5.0, accessible=accessible)
    compact(field, 56)  # without buttons, in the style sheet: their room is the numbers'
    return field
