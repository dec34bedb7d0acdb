"""One line: how large the opened sheet shows the target, how large it was drawn, and a button that makes them one."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QWidget

from kirigami_studio.evaluate.opened_size import OpenedSize
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.look import icons
from kirigami_studio.gui.look.readable import TIMES
from kirigami_studio.gui.look.theme import Palette
from kirigami_studio.gui.panels.card import ElidedLabel, tool_button


class OpenedRow(QWidget):
    """Hidden until there is a design."""

    link_wanted = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("plain")
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        self.text = ElidedLabel()
        self.text.setAccessibleName(tr("Size of the opened sheet"))
        self.link = tool_button("cutAtDrawnSize", "")
        self.link.setAccessibleName(tr("Cut at the drawn size"))
        self.link.clicked.connect(self.link_wanted)
        row.addWidget(self.text, 1)
        row.addWidget(self.link)
        self.show_size(None)

    def show_size(self, size: OpenedSize | None) -> None:
        """Show both sizes where they differ."""
        self.setVisible(size is not None)
        if size is None:
            return
        opened = _sides(size.opened)
        if size.drawn is None:
            self.text.setText(tr("Opens to {opened} mm", opened=opened))
            tip = tr("The target has no size in mm. Give it one in the editor (E) to cut at that size.")
        elif size.agrees:
            self.text.setText(tr("Opens to {opened} mm, as drawn", opened=opened))
            tip = tr("The sheet's width fits the drawn size of the target.")
        else:
            self.text.setText(
                tr("Opens to {opened}, drawn {drawn} mm", opened=opened, drawn=_sides(size.drawn)),
                tr("Opens {opened} mm wide, drawn {drawn}", opened=_side(size.opened[0]), drawn=_side(size.drawn[0])),
            )
            tip = tr(
                "Cut at the drawn size: make the flat sheet {width:.1f} mm wide, so that it opens to the size in mm "
                "that the target was drawn with.",
                width=size.fitting_width_mm,
            )
        self.link.setToolTip(tip)
        self.link.setEnabled(size.drawn is not None and not size.agrees)

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self.link.setIcon(icons.icon("chain", palette))


def _sides(size: tuple[float, float]) -> str:
    return f"{_side(size[0])} {TIMES} {_side(size[1])}"


def _side(side: float) -> str:
    return f"{side:.0f}" if side >= 100 else f"{side:.1f}"
