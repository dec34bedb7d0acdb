"""The run: the Generate button, how far it is, Cancel; and the presenter of it and of its settings."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QElapsedTimer, QObject, QSize, Qt, QTimer
from PySide6.QtGui import QHideEvent, QShowEvent
from PySide6.QtWidgets import QProgressBar, QSizePolicy, QStackedLayout, QWidget

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.run.generation import Generation
from kirigami_studio.gui.run.regularity import Regularity
from kirigami_studio.gui.run.settings_editor import SettingsEditor
from kirigami_studio.gui.run.settings_panel import SettingsPanel
from kirigami_studio.gui.session.queue import JobCallbacks
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.widgets.card import ElidedLabel
from kirigami_studio.gui.widgets.layouts import column, plain_pane, push_button, row
from kirigami_studio.gui.widgets.readable import readable_time
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.project.document import Document
from kirigami_studio.studio import importing

#: Seconds of one step of a run from which on they are shown.
WORTH_COUNTING = 3.0


class GenerateBar(QWidget):
    """One big button; while a run goes on, its progress and a Cancel button in the same place."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.generate = push_button(tr("Generate"), tr("Design sheets for this target (Ctrl+G)"), "primary")
        self.generate.setIconSize(QSize(18, 18))
        tip = tr("Stop generating; the project stays unchanged (Esc)")
        self.stop = push_button(tr("Cancel"), tip, "cancel")
        self.progress = QProgressBar()
        self.progress.setTextVisible(False)
        self.progress.setAccessibleName(tr("Run progress"))
        self.progress_text = ElidedLabel(Qt.TextElideMode.ElideRight)
        self._message, self._since = "", QElapsedTimer()
        self._seconds = QTimer(self, interval=1000)  # one step may take long: its seconds say that it goes on
        self._seconds.timeout.connect(self.show_seconds)
        self._work = plain_pane()
        row((column(self.progress_text, self.progress, spacing=3), 1), self.stop, on=self._work, spacing=8)
        self._work.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Ignored)
        self._pages = QStackedLayout(self)  # as high as the button, so that nothing moves when a run begins
        self._pages.addWidget(self.generate)
        self._pages.addWidget(self._work)
        self.show_idle()

    def show_ready(self, ready: bool) -> None:
        """Whether there is a target to design for."""
        if self._pages.currentWidget() is self.generate:
            self.generate.setEnabled(ready)

    def show_running(self, total: int) -> None:
        """A run has begun."""
        self.generate.setEnabled(False)
        self.show_work(tr("Starting (0 of {total})", total=total))

    def show_work(self, sentence: str) -> None:
        """Something goes on that can be stopped."""
        self.progress.setRange(0, 0)
        self._say(sentence)
        if self.isVisible():
            self._seconds.start()
        self._pages.setCurrentWidget(self._work)

    def show_progress(self, done: int, total: int, message: str) -> None:
        """A run moves on; the bar is indefinite until the first design is there."""
        # A progress bar paints at once, and all that waits for paint in the window with it; so it only asks for it.
        self.progress.setUpdatesEnabled(False)
        self.progress.setRange(0, total if done else 0)
        self.progress.setValue(done)
        self.progress.setUpdatesEnabled(True)
        self._say(message)

    def _say(self, message: str) -> None:
        if message != self._message or not self._since.isValid():
            self._message = message
            self._since.start()
            self.progress_text.setText(message)

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802 - Qt's name
        super().showEvent(event)
        if self._pages.currentWidget() is self._work:
            self._seconds.start()

    def hideEvent(self, event: QHideEvent) -> None:  # noqa: N802 - Qt's name
        super().hideEvent(event)
        self._seconds.stop()

    def show_seconds(self) -> None:
        """Add for how long the present step goes on, where there is room."""
        seconds = 1e-3 * self._since.elapsed()
        if seconds >= WORTH_COUNTING:
            self.progress_text.setText(f"{self._message}  \N{MIDDLE DOT}  {readable_time(seconds)}", self._message)

    def show_idle(self) -> None:
        """No run is going on."""
        self._seconds.stop()
        self._since.invalidate()
        self.generate.setEnabled(True)
        self._pages.setCurrentWidget(self.generate)

    def set_palette(self, palette: Palette) -> None:
        self.generate.setIcon(icons.icon("generate", palette, palette.on_accent))
        self.stop.setIcon(icons.icon("stop", palette))


class RunPresenter(QObject):
    """Shows the settings of the next run and the progress of the present one.

    Parameters
    ----------
    cancel : callable
        Stops the run, or the work on designs.
    """

    def __init__(
        self,
        panel: SettingsPanel,
        bar: GenerateBar,
        session: Session,
        generation: Generation,
        regularity: Regularity,
        *,
        editor: SettingsEditor,
        cancel: Callable[[], None],
    ) -> None:
        super().__init__(panel)
        self._panel, self._bar, self._session, self._generation = panel, bar, session, generation
        panel.changed.connect(lambda changes: editor.change(**changes))
        panel.edited.connect(session.history.end_drag)
        panel.keep_changed.connect(self._keep_seed)
        bar.generate.clicked.connect(generation.generate)
        bar.stop.clicked.connect(cancel)
        generation.run.progressed.connect(bar.show_progress)
        regularity.busy_changed.connect(self._show_fitting)
        regularity.progressed.connect(bar.show_progress)
        self.show_idle()
        self.show_document(session.document)

    def warm_up(self) -> None:
        """Import in the worker what the first run needs, and learn which generators there are."""
        callbacks = JobCallbacks(self._show_variants, on_failed=self._session.report_failure)
        self._session.queue.start(tr("loading the generator"), importing.warming, callbacks)

    def _show_variants(self, variants: tuple[str, ...]) -> None:
        if variants:
            self._panel.set_variants(variants)

    def show_document(self, document: Document) -> None:
        """Show the settings of the next run, and whether there is a target for it."""
        self._panel.show_settings(document.settings)
        self._bar.show_ready(document.target is not None)

    def show_run(self, total: int) -> None:
        """A run for so many designs has begun."""
        self._bar.show_running(total)

    def show_idle(self) -> None:
        """No run is in progress."""
        self._bar.show_idle()
        self._bar.show_ready(self._session.document.target is not None)

    def _show_fitting(self, busy: bool) -> None:
        """Designs are being fitted again, or no longer."""
        if busy:
            self._bar.show_work(tr("Fitting the designs again …"))
        elif not self._generation.run.running:
            self.show_idle()

    def _keep_seed(self, keeps: bool) -> None:
        self._generation.planner.keeps_seed = keeps
