"""The run: its settings, the Generate button, and how far it is."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.run.generate_bar import GenerateBar
from kirigami_studio.gui.run.generation import Generation
from kirigami_studio.gui.run.regularity import Regularity
from kirigami_studio.gui.run.settings_editor import SettingsEditor
from kirigami_studio.gui.run.settings_panel import SettingsPanel
from kirigami_studio.gui.session.queue import JobCallbacks
from kirigami_studio.gui.session.session import Session
from kirigami_studio.project.document import Document
from kirigami_studio.studio import importing


class RunPresenter(QObject):
    """Shows the settings of the next run and the progress of the present one.

    Parameters
    ----------
    panel : SettingsPanel
    bar : GenerateBar
    session : Session
    generation : Generation
    regularity : Regularity
    editor : SettingsEditor
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
            self._bar.show_fitting()
        elif not self._generation.run.running:
            self.show_idle()

    def _keep_seed(self, keeps: bool) -> None:
        self._generation.planner.keeps_seed = keeps
