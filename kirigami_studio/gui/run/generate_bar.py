"""Generate, see how far it is, stop it."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import QHBoxLayout, QLabel, QProgressBar, QPushButton, QVBoxLayout, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.widgets.theme import Palette


class GenerateBar(QWidget):
    """One big button; while a run goes on, its progress and a Cancel button."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.generate = QPushButton(tr("Generate"))
        self.generate.setObjectName("primary")
        self.generate.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.generate.setToolTip(tr("Design sheets for this target (Ctrl+G)"))
        self.generate.setIconSize(QSize(18, 18))
        self.stop = QPushButton(tr("Cancel"))
        self.stop.setObjectName("cancel")
        self.stop.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.stop.setToolTip(tr("Stop generating; the project stays unchanged (Esc)"))
        self.progress = QProgressBar()
        self.progress.setTextVisible(False)
        self.progress.setAccessibleName(tr("Run progress"))
        self.progress_text = QLabel()
        self.progress_text.setObjectName("muted")
        buttons = QHBoxLayout()
        buttons.setSpacing(8)
        buttons.addWidget(self.generate, 1)
        buttons.addWidget(self.stop)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(6)
        column.addLayout(buttons)
        column.addWidget(self.progress)
        column.addWidget(self.progress_text)
        self.show_idle()

    def show_ready(self, ready: bool) -> None:
        """Whether there is a target to design for."""
        if not self.stop.isVisibleTo(self):
            self.generate.setEnabled(ready)

    def show_running(self, total: int) -> None:
        """A run has begun."""
        self.generate.setEnabled(False)
        self.generate.setText(tr("Generating …"))
        self.progress.setRange(0, 0)
        self.progress_text.setText(tr("Starting (0 of {total})", total=total))
        for part in (self.stop, self.progress, self.progress_text):
            part.show()

    def show_fitting(self) -> None:
        """Designs are being fitted again."""
        self.progress.setRange(0, 0)
        self.progress_text.setText(tr("Fitting the designs again …"))
        for part in (self.stop, self.progress, self.progress_text):
            part.show()

    def show_progress(self, done: int, total: int, message: str) -> None:
        """A run moves on; the bar is indefinite until the first design is there."""
        # A progress bar paints at once, and all that waits for paint in the window with it; so it only asks for it.
        self.progress.setUpdatesEnabled(False)
        self.progress.setRange(0, total if done else 0)
        self.progress.setValue(done)
        self.progress.setUpdatesEnabled(True)
        self.progress_text.setText(message)

    def show_idle(self) -> None:
        """No run is going on."""
        self.generate.setEnabled(True)
        self.generate.setText(tr("Generate"))
        for part in (self.stop, self.progress, self.progress_text):
            part.hide()

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self.generate.setIcon(icons.icon("generate", palette, palette.on_accent))
        self.stop.setIcon(icons.icon("stop", palette))
