"""The kind of the selected points: corner, smooth, symmetric, automatic."""

from __future__ import annotations

from PySide6.QtWidgets import QHBoxLayout, QToolButton, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.look import icons
from kirigami_studio.gui.look.theme import Palette
from kirigami_studio.gui.panels.card import tool_button
from kirigami_studio.gui.sketching.sketch_context import SketchContext
from kirigami_studio.outlines.nodes import Kind


class NodeOptions(QWidget):
    """One button for each kind; those of the selected points are down."""

    def __init__(self, context: SketchContext) -> None:
        super().__init__()
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(2)
        self.buttons: dict[Kind, QToolButton] = {}
        for kind, tip in (
            (
                Kind.CORNER,
                tr("Corner (Shift+C). Handles of the selected points go their own ways (Alt+drag); again: no handles."),
            ),
            (Kind.SMOOTH, tr("Smooth (Shift+S). Both handles of the selected points lie on one line.")),
            (Kind.SYMMETRIC, tr("Symmetric (Shift+Y). Both handles are also of one length; Shift+drag does the same.")),
            (Kind.AUTO, tr("Automatic (Shift+A). The neighbours of the selected points set their handles.")),
        ):
            button = tool_button(f"node{kind.value.capitalize()}", tip, checkable=True)
            button.clicked.connect(lambda _=False, kind=kind: context.kind_wanted.emit(kind))
            self.buttons[kind] = button
            row.addWidget(button)
        context.kinds_shown.connect(self.show_kinds)
        self.show_kinds(frozenset())

    def show_kinds(self, kinds: frozenset[Kind]) -> None:
        """Show which kinds the selected points have; without one there is nothing to change."""
        for kind, button in self.buttons.items():
            button.setEnabled(bool(kinds))
            button.setChecked(kind in kinds)

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        for kind, button in self.buttons.items():
            button.setIcon(icons.icon(f"node-{kind.value}", palette))
