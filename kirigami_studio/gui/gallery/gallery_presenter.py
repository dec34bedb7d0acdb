"""Designs: the run that generates them, their gallery, and the menu of a card."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QPoint, QRect, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.gallery_model import ALIKE_ROLE, OPEN_ROLE
from kirigami_studio.gui.gallery.side_by_side import SideBySide
from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.session.session import Entry
from kirigami_studio.gui.widgets import icons
from kirigami_studio.gui.window.controller import Controller
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.project.document import Document, Mark

if TYPE_CHECKING:
    from kirigami_studio.gui.window.main_window import MainWindow
    from kirigami_studio.studio.as_cut import AsCut


class DesignConnections(QObject):
    """Connects the Generate button and the gallery with the controller."""

    def __init__(self, window: MainWindow, controller: Controller, side_by_side: SideBySide) -> None:
        super().__init__(window)
        self._window = window
        self._controller = controller
        self._side_by_side = side_by_side
        self.menu: QMenu | None = None
        self._ranked_as_cut = False
        self._connect_run()
        self._connect_gallery()
        controller.session.document_changed.connect(self._show_document)
        controller.session.display.stage_changed.connect(self._show_chosen)
        self._show_document(controller.document)
        self._show_idle()

    def _connect_run(self) -> None:
        window, run = self._window, self._controller.run
        window.run.generate_wanted.connect(self._controller.generation.generate)
        window.run.cancel_wanted.connect(self._controller.cancel)
        run.started.connect(self._show_run)
        run.progressed.connect(window.run.show_progress)
        run.ended.connect(self._show_idle)
        regularity, settings = self._controller.regularity, window.settings
        settings.regular_moved.connect(self._move_balance)
        settings.regular_chosen.connect(self._choose_balance)
        self._controller.estimates.changed.connect(self._show_estimates)
        regularity.ranked.connect(lambda ranking: window.gallery.view.rank_by(self._estimated(ranking)))
        regularity.busy_changed.connect(self._show_fitting)
        regularity.progressed.connect(window.run.show_progress)

    def _connect_gallery(self) -> None:
        controller, view, bar = self._controller, self._window.gallery.view, self._window.gallery.bar
        view.chosen.connect(controller.choose)
        view.pin_wanted.connect(controller.marks.pin)
        view.reject_wanted.connect(self.reject)
        view.menu_wanted.connect(self.show_menu)
        bar.again_wanted.connect(controller.generation.again)
        bar.alike_wanted.connect(controller.generation.more_like)
        controller.session.display.gallery_reset.connect(self._show_gallery)
        controller.session.display.candidate_found.connect(self._add_card)
        controller.alikes.known.connect(view.set_groups)

    # the run -------------------------------------------------------------------------------------------------------

    def _show_run(self, total: int) -> None:
        window = self._window
        window.run.show_running(total)
        window.gallery.bar.set_ready(False)
        window.stage.set_trimmable(False)
        window.gallery.view.set_hint(tr("Generating …"), tr("The first designs appear shortly."))
        window.stage.show_run(self._controller.document.target)
        window.fabrication.show_waiting()
        window.stage.cuts.show_plan(None)
        window.messages.dismiss(Tone.HINT, Tone.DONE)

    def _show_idle(self) -> None:
        """No run is in progress."""
        window = self._window
        window.run.show_idle()
        window.stage.set_trimmable(True)
        window.stage.show_idle()
        hint = tr("Designs appear here, best first, as they are generated.")
        window.gallery.view.set_hint(tr("No designs yet"), hint)
        self._show_ready(self._controller.document)

    def _show_ready(self, document: Document) -> None:
        """Show whether designs can be generated or added."""
        window, running = self._window, self._controller.running
        window.gallery.bar.set_ready(bool(document.candidates) and not running)
        window.run.show_ready(document.target is not None)
        if running:
            return
        if document.target is not None:
            window.stage.set_hint("generate", tr("Ready to design"), tr("Press Generate (Ctrl+G)."))
        else:
            hint = tr(
                "Open a file (Ctrl+O), choose from the library (Ctrl+L), or draw a silhouette on the left. "
                "File > Examples of pairs has finished designs."
            )
            window.stage.set_hint("target", tr("Start with a target"), hint)

    def _move_balance(self, regular: float) -> None:
        """The balance of match and regularity is being moved: the cards follow, also those of a run."""
        controller = self._controller
        if controller.running:
            display = controller.session.display
            display.ranking = replace(display.ranking, regular=regular)
            self._window.gallery.view.rank_by(display.ranking)
        else:
            controller.regularity.preview(regular)

    def _choose_balance(self, regular: float) -> None:
        """The balance was let go."""
        controller, model = self._controller, self._window.gallery.view.model_
        if controller.running:
            controller.change_settings(regular=regular)
        elif not controller.hand.postpones(lambda: self._choose_balance(regular)):
            controller.regularity.choose(regular, tuple(entry.candidate for entry in model.taken))

    def _show_fitting(self, busy: bool) -> None:
        """Designs are being fitted again, or no longer."""
        if busy:
            self._window.run.show_fitting()
        elif not self._controller.running:
            self._show_idle()

    # the gallery ---------------------------------------------------------------------------------------------------

    def _show_estimates(self, known: Mapping[Candidate, AsCut]) -> None:
        """Designs were estimated as cut: the cards say so, and are ranked by it too."""
        view = self._window.gallery.view
        view.model_.set_as_cut(known, self._controller.estimates.strain_limit)
        if self._controller.running or not known:
            return
        ranking = self._ranking
        jams = any(ranking.missed(candidate) > 0.0 for candidate in known)
        if jams or self._ranked_as_cut:  # the document's order stays where all designs close
            view.rank_by(ranking)
            self._show_chosen()
        self._ranked_as_cut = jams

    @property
    def _ranking(self) -> Ranking:
        """That of the document, with what is estimated of its designs as cut."""
        return self._estimated(self._controller.session.ranking)

    def _estimated(self, ranking: Ranking) -> Ranking:
        found = {candidate: one.jam_phi for candidate, one in self._controller.estimates.known.items()}
        return replace(ranking, jam_phi={**ranking.jam_phi, **found})

    def _show_document(self, document: Document) -> None:
        gallery = self._window.gallery
        running = self._controller.running
        gallery.view.set_measure(document.fabrication.width_mm, None if running else self._ranking)
        marks = dict(zip(document.candidates, document.marks, strict=True))
        gallery.view.model_.set_labels(dict(zip(document.candidates, document.labels, strict=True)))
        gallery.view.show_marks(marks, self._controller.generation.planner.added)
        gallery.bar.show_count(document.settings.k)
        if not running:
            gallery.view.mark(document.candidate)
        self._show_ready(document)
        self._show_chosen()

    def _show_gallery(self, entries: tuple[Entry, ...]) -> None:
        view, document = self._window.gallery.view, self._controller.document
        running = self._controller.running
        ranking = self._controller.session.display.ranking if running else self._ranking
        view.model_.set_ranking(ranking)
        view.show_entries(list(entries), document.target)
        self._controller.alikes.look_at(tuple(entry.candidate for entry in entries), view.model_.ranking)
        view.mark(document.candidate)
        self._show_chosen()

    def _add_card(self, entry: Entry) -> None:
        self._window.gallery.view.add(entry)
        self._show_chosen()

    def _show_chosen(self) -> None:
        """Tell the bar and the stage which design is chosen, and what it is called."""
        candidate = self.chosen
        name = self._window.gallery.view.model_.name_of(candidate)
        self._window.stage.set_name(name)
        self._window.gallery.bar.set_chosen(None if candidate is None or not name else (candidate.sheet, name))

    @property
    def chosen(self) -> Candidate | None:
        """The design on the stage."""
        stage = self._controller.stage
        return None if stage is None else stage.candidate

    def reject(self, candidate: Candidate | None) -> None:
        """Reject a design; where that hides the chosen one, the next card is chosen instead."""
        view = self._window.gallery.view
        hides = not view.model_.selection.show_rejected
        self._controller.marks.reject(candidate, view.beside(candidate) if hides else None)

    def rename(self, candidate: Candidate | None) -> None:
        """Open the name and the note of a design, at its card where that is in sight."""
        table = self._window.connections.all_designs
        if table.shown and candidate is not None:
            self._window.dialogs.show_label(candidate, table.card(candidate))
            return
        view, title = self._window.gallery.view, self._window.stage.title
        row = view.model_.row_of(candidate)
        card = view.visualRect(view.model_.index(row, 0)) if row >= 0 else QRect()
        if card.isValid() and view.isVisible() and view.viewport().rect().intersects(card):
            beside = QRect(view.viewport().mapToGlobal(card.topLeft()), card.size())
        else:
            beside = QRect(title.mapToGlobal(QPoint(0, 0)), title.size())
        self._window.dialogs.show_label(candidate, beside)

    # the menu of a card --------------------------------------------------------------------------------------------

    def rename_current(self) -> None:
        """Open the name and the note of the chosen design, or of the one that is marked in the table of all."""
        table = self._window.connections.all_designs
        page = table.page
        self.rename(page.table.current if table.shown and page is not None else self.chosen)

    def show_menu(self, candidate: Candidate, place: QPoint, compare: Callable[[], None] | None = None) -> None:
        """Open the context menu of a card; ``compare`` is what comparing it means where it is."""
        menu = QMenu(self._window)
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        menu.setToolTipsVisible(True)
        controller = self._controller
        view = self._window.gallery.view
        row = view.model_.index(max(view.model_.row_of(candidate), 0), 0)
        alike: int = row.data(ALIKE_ROLE) if row.isValid() else 0
        mark = view.model_.mark_of(candidate)
        ready = not controller.running and candidate in controller.document.candidates
        comparing = (
            (("compare", tr("Compare with chosen"), lambda: self._side_by_side.compare_with(candidate)),)
            if compare is None
            else (("compare", tr("Mark to compare"), compare),)
        )
        for name, text, run in (
            ("pin", tr("Unpin") if mark is Mark.PINNED else tr("Pin"), lambda: controller.marks.pin(candidate)),
            ("reject", tr("Restore") if mark is Mark.REJECTED else tr("Reject"), lambda: self.reject(candidate)),
            ("note", tr("Name and note … (F2)"), lambda: self.rename(candidate)),
            ("alike", tr("More like this"), lambda: self.more_like(candidate)),
            *comparing,
            ("dice", tr("Use seed {seed}", seed=candidate.seed), lambda: self._use_seed(candidate)),
        ):
            action = QAction(icons.icon(name, self._window.palette_), text, menu)
            action.setObjectName(name)
            action.setEnabled(ready)
            action.triggered.connect(lambda _=False, run=run: run())
            menu.addAction(action)
        if alike:
            text = (
                tr("Hide designs that look the same") if row.data(OPEN_ROLE) else tr("Show designs that look the same")
            )
            stack = menu.addAction(text)
            stack.setObjectName("stack")
            stack.triggered.connect(lambda: view.toggle_alike(candidate))
        self.menu = menu
        menu.destroyed.connect(self._forget_menu)
        menu.popup(place)

    def _forget_menu(self) -> None:
        self.menu = None

    def more_like(self, candidate: Candidate) -> None:
        """Choose a design and draw more like it."""
        self._controller.choose(candidate)
        self._controller.generation.more_like(self._window.gallery.bar.nearness_value)

    def _use_seed(self, candidate: Candidate) -> None:
        self._controller.change_settings(seed=candidate.seed)
        self._controller.end_drag()
