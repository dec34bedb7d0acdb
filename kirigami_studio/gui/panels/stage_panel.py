"""The chosen design, large: layout view, overlays, deployment."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QLabel, QToolButton, QWidget

from kirigami_studio.gui import icons
from kirigami_studio.gui.panels.card import Card, tool_button
from kirigami_studio.gui.panels.deployment_bar import DeploymentBar
from kirigami_studio.gui.theme import Palette
from kirigami_studio.gui.views.gallery_model import Entry, described
from kirigami_studio.gui.views.layout_view import LayoutView, Overlay
from kirigami_studio.target.outline import Outline

OVERLAYS = (
    (Overlay.TARGET, "target", "Show the target's outline (T)."),
    (
        Overlay.MISMATCH,
        "mismatch",
        "Show missing and extra area near the target angle (M). Orange stripes: missing; dark stripes: extra.",
    ),
    (Overlay.FAULTS, "fault", "Mark inverted panels and the first contact (F)."),
)

#: Narrower than this (pixels) the header has no room for numbers; the status line and the gallery show them too.
ROOM_FOR_NUMBERS = 500


class StagePanel(Card):
    """Shows one entry of the gallery at any angle."""

    overlays_changed = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__("Layout", parent)
        self.view = LayoutView()
        self.deployment = DeploymentBar()
        self.numbers = QLabel()
        self.numbers.setObjectName("muted")
        self.header.addWidget(self.numbers)
        self.header.addSpacing(8)
        self.toggles: dict[Overlay, QToolButton] = {}
        for overlay, _, tip in OVERLAYS:
            button = tool_button(f"show{overlay.value.capitalize()}", tip, checkable=True)
            button.setChecked(True)
            button.toggled.connect(self._tell_overlays)
            self.toggles[overlay] = button
            self.header.addWidget(button)
        self.whole = tool_button("fit", "Show everything (0).")
        self.whole.clicked.connect(self.view.fit)
        self.header.addWidget(self.whole)
        self.body.addWidget(self.view, 1)
        self.body.addWidget(self.deployment)
        self.deployment.phi_changed.connect(self.view.set_phi)

    def show_entry(self, entry: Entry | None, target: Outline | None, rank: int) -> None:
        """Show another design; the angle stays, or starts at the target angle for the first one."""
        first = entry is not None and self.view.scene_bounds() is None
        self.title.setText("Layout" if entry is None or rank <= 0 else f"Design {rank}")
        self.deployment.set_ready(entry is not None)
        if entry is None:
            self.numbers.clear()
            self.view.show_design(None, None, None)
            return
        score, design = entry.candidate.score, entry.design
        self.view.show_design(design, score, target)
        self.deployment.set_marks(design.phi_target, None if score.contact is None else score.contact.phi)
        self.numbers.setText(f"sIoU {100 * score.siou:.1f} %   gain {100 * score.siou_gain:+.1f}   TV {score.tv:.2f}")
        self.numbers.setToolTip(described(entry.candidate, max(rank, 1)))
        if first:
            self.view.fit()
            self.deployment.set_phi(design.phi_target)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        self.numbers.setVisible(self.width() >= ROOM_FOR_NUMBERS)
        super().resizeEvent(event)

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self.view.set_palette(palette)
        self.deployment.set_palette(palette)
        for overlay, icon, _ in OVERLAYS:
            self.toggles[overlay].setIcon(icons.icon(icon, palette))
        self.whole.setIcon(icons.icon("fit", palette))

    def _tell_overlays(self) -> None:
        chosen = frozenset(overlay for overlay, button in self.toggles.items() if button.isChecked())
        self.view.set_overlays(chosen)
        self.overlays_changed.emit(chosen)
