"""Up to four designs beside each other, moved together, with their figures; the first is what the others are beside."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.compare_page import ComparedDesign, Side, number_texts
from kirigami_studio.gui.session.overlays import Overlay
from kirigami_studio.gui.stage.deployment_bar import DeploymentBar
from kirigami_studio.gui.widgets.card import ToolButton
from kirigami_studio.outlines.outline import Outline

#: Designs that have room beside each other.
MOST = 4


class CompareFour(QWidget):
    """Shows designs at one angle, zoom and place; keys 1 to 4 take one to the stage."""

    taken = Signal(int)  #: place of the design, from 0
    left = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.bar = DeploymentBar()
        self.sides: list[Side] = []
        self.shown = 0
        row = QHBoxLayout()
        row.setSpacing(10)
        for place in range(MOST):
            button = ToolButton(
                f"take{place + 1}", "check", tr("Take this design to the stage ({key}).", key=place + 1)
            )
            button.setText(tr("Use"))
            button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
            button.clicked.connect(lambda _=False, place=place: self.taken.emit(place))
            side = Side(f"compared{place + 1}", tr("Layout of design {number}", number=place + 1), button)
            side.view.set_overlays(frozenset({Overlay.TARGET}))  # legends would take the room of small drawings
            side.view.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # keys belong to the page
            self.bar.phi_changed.connect(side.view.set_phi)
            self.sides.append(side)
            row.addWidget(side, 1)
        for side in self.sides:
            for other in self.sides:
                if other is not side:
                    side.view.view_changed.connect(other.view.set_view)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(8)
        column.addLayout(row, 1)
        column.addWidget(self.bar)

    def show_designs(self, designs: Sequence[ComparedDesign], target: Outline | None) -> None:
        """Show these designs; angle, zoom and place stay."""
        self.shown = len(designs)
        first = designs[0] if designs else None
        for place, side in enumerate(self.sides):
            side.setVisible(place < len(designs))
            if place >= len(designs):
                side.view.show_design(None, None, None)
                continue
            one, name = designs[place], designs[place].name
            side.name(tr("{place}   Design {name}", place=place + 1, name=name), f"{place + 1}   {name}", name)
            side.show_design(one, target)
            side.show_numbers(*number_texts(one, None if place == 0 else first))
        bounds = [side.view.own_bounds() for side in self.sides[: len(designs)]]
        shared = None
        for box in bounds:
            shared = box if shared is None or box is None else shared.united(box)
        for side in self.sides:
            side.view.share(shared)
        self.bar.set_ready(first is not None)
        if first is not None:
            contacts = [one.entry.candidate.score.contact for one in designs]
            touches = max((contact.phi for contact in contacts if contact is not None), default=None)
            second = first.entry.candidate.second
            self.bar.set_marks(first.entry.design.phi_target, touches, None if second is None else second.target.phi)

    def fit(self) -> None:
        """Show everything of all."""
        self.sides[0].view.fit()

    def event(self, event: QEvent) -> bool:
        """Keys without Ctrl and Alt belong to the page."""
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent):
            held = event.modifiers() & (Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.AltModifier)
            if not held and not Qt.Key.Key_F1 <= event.key() <= Qt.Key.Key_F12 and event.text() != "?":
                event.accept()
                return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 - Qt's name
        key = event.key()
        if Qt.Key.Key_1 <= key < Qt.Key.Key_1 + self.shown:
            self.taken.emit(key - Qt.Key.Key_1)
        elif key in (Qt.Key.Key_Escape, Qt.Key.Key_C, Qt.Key.Key_K):
            self.left.emit()
        elif key == Qt.Key.Key_Space and self.bar.play.isEnabled():
            self.bar.play.toggle()
        elif key == Qt.Key.Key_0:
            self.fit()
        else:
            super().keyPressEvent(event)
