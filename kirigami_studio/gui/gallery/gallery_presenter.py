"""The gallery: its cards, their order, and the menu of a card."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from PySide6.QtCore import QObject, QPoint, QRect, Qt, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.gallery_model import ALIKE_ROLE, OPEN_ROLE
from kirigami_studio.gui.gallery.gallery_panel import GalleryPanel
from kirigami_studio.gui.run.generation import Generation
from kirigami_studio.gui.run.look_alikes import LookAlikes
from kirigami_studio.gui.run.regularity import Regularity
from kirigami_studio.gui.run.settings_panel import SettingsPanel
from kirigami_studio.gui.session.collection import DesignMarks
from kirigami_studio.gui.session.session import Entry, Session
from kirigami_studio.gui.stage.as_cut import AsCutEstimates
from kirigami_studio.gui.stage.hand_editor import HandEditor
from kirigami_studio.gui.widgets import icons
from kirigami_studio.pipeline.rank import Ranking
from kirigami_studio.project.document import Document, Mark
from kirigami_studio.studio.as_cut import AsCut
from kirigami_studio.studio.designing import Judged, limit_of
from kirigami_studio.studio.two_states import shown_match


class GalleryPresenter(QObject):
    """Shows the designs of the document, or of a run, as cards, and passes requests on.

    Parameters
    ----------
    balance : SettingsPanel
        Moves the balance of match and regularity, which the cards follow.
    generation, marks, alikes, estimates, regularity, hand
        The parts that make designs, mark them, and find out what is known of them.
    choose, change : callable
        Puts a design on the stage; changes settings of the next run.
    """

    named = Signal(str)  #: what the design on the stage is called
    compare_wanted = Signal(Candidate)  #: with the design on the stage
    label_wanted = Signal(object, QRect)  #: Candidate or None, and the place of its card on the screen, if in sight

    def __init__(
        self,
        panel: GalleryPanel,
        balance: SettingsPanel,
        session: Session,
        *,
        generation: Generation,
        marks: DesignMarks,
        alikes: LookAlikes,
        estimates: AsCutEstimates,
        regularity: Regularity,
        hand: HandEditor,
        choose: Callable[[Candidate], None],
        change: Callable[..., None],
    ) -> None:
        super().__init__(panel)
        self._panel, self._view, self._session = panel, panel.view, session
        self._generation, self._marks, self._alikes, self._estimates = generation, marks, alikes, estimates
        self._regularity, self._hand, self._choose, self._change = regularity, hand, choose, change
        self.menu: QMenu | None = None
        self._ranked_as_cut = False
        self._connect(balance)
        self.show_document(session.document)
        self.show_idle()

    def _connect(self, balance: SettingsPanel) -> None:
        view, bar = self._view, self._panel.bar
        view.chosen.connect(self._choose)
        view.pin_wanted.connect(self._marks.pin)
        view.reject_wanted.connect(self.reject)
        view.menu_wanted.connect(self.show_menu)
        view.compare_wanted.connect(self.compare_wanted)
        bar.again.clicked.connect(self._generation.again)
        bar.draw.clicked.connect(lambda: self._generation.more_like(bar.nearness_value))
        balance.regular_moved.connect(self._move_balance)
        balance.regular_chosen.connect(self._choose_balance)
        self._regularity.ranked.connect(lambda ranking: view.rank_by(self._estimated(ranking)))
        self._estimates.changed.connect(self._show_estimates)
        self._estimates.judged.connect(self._show_judged)
        self._alikes.known.connect(view.set_groups)
        self._generation.run.judged.connect(self._show_look)

    @property
    def _running(self) -> bool:
        return self._generation.run.running

    # the run -------------------------------------------------------------------------------------------------------

    def show_run(self) -> None:
        """A run has begun."""
        self._panel.bar.set_ready(False)
        self._view.set_hint(tr("Generating …"), tr("The first designs appear shortly."))

    def show_idle(self) -> None:
        """No run is in progress."""
        hint = tr("Designs appear here, best first, as they are generated.")
        self._view.set_hint(tr("No designs yet"), hint)
        self._show_ready(self._session.document)

    def _show_ready(self, document: Document) -> None:
        """Show whether designs can be added."""
        self._panel.bar.set_ready(bool(document.candidates) and not self._running)

    def _show_look(self, looked: Judged) -> None:
        """A run has looked closely at a design: its card says so, and all keep their places."""
        display = self._session.display
        if looked.refusal is None:
            display.ranking = replace(display.ranking, losses={**display.ranking.losses, looked.candidate: looked.loss})
        else:
            refusals = {**display.ranking.refusals, looked.candidate: looked.refusal}
            display.ranking = replace(display.ranking, refusals=refusals)
        self._view.model_.set_ranking(display.ranking)
        self._estimates.take_look(looked)

    def _move_balance(self, regular: float) -> None:
        """The balance of match and regularity is being moved: the cards follow, also those of a run."""
        if self._running:
            display = self._session.display
            display.ranking = replace(display.ranking, regular=regular)
            self._view.rank_by(display.ranking)
        else:
            self._regularity.preview(regular)

    def _choose_balance(self, regular: float) -> None:
        """The balance was let go."""
        if self._running:
            self._change(regular=regular)
        elif not self._hand.postpones(lambda: self._choose_balance(regular)):
            self._regularity.choose(regular, tuple(entry.candidate for entry in self._view.model_.taken))

    # the gallery ---------------------------------------------------------------------------------------------------

    def _show_estimates(self, known: Mapping[Candidate, AsCut]) -> None:
        """Designs were estimated as cut: the cards say so, and are ranked by it too."""
        self._show_verdicts()
        if self._running or not known:
            return
        ranking = self._ranking
        # The document's order stays where all designs close and show what they did in the run.
        moves = any(ranking.missed(one) > 0.0 for one in known) or self._pieces_known
        if moves or self._ranked_as_cut:
            self._view.rank_by(ranking)
            self._show_chosen()
        self._ranked_as_cut = moves

    @property
    def _pieces_known(self) -> bool:
        """Whether pieces of a design were put together: their match is shown, and ranked by."""
        return any(
            verdict.as_cut is not None and verdict.as_cut.of_pieces for verdict in self._estimates.verdicts.values()
        )

    def _show_verdicts(self) -> None:
        """The cards have what is known of the designs as cut."""
        estimates = self._estimates
        self._view.model_.set_as_cut(estimates.found, estimates.material, estimates.verdicts)

    def _show_judged(self) -> None:
        """Show a new verdict; cards of sheets change places with the next estimate."""
        if self._pieces_known:
            self._show_estimates(self._estimates.found)
            return
        self._show_verdicts()
        if not self._running:
            self._view.model_.set_ranking(self._ranking)

    @property
    def _ranking(self) -> Ranking:
        """That of the document, with what is estimated of its designs as cut."""
        return self._estimated(self._session.ranking)

    def _estimated(self, ranking: Ranking) -> Ranking:
        """A ranking with all that is known as cut; a verdict overrules an estimate."""
        found, verdicts = self._estimates.found, self._estimates.verdicts
        jams = {candidate: one.jam_phi for candidate, one in found.items()}
        well = {candidate for candidate, one in verdicts.items() if one.ok}
        refusals = {candidate: why for candidate, why in ranking.refusals.items() if candidate not in well}
        pieces = {candidate: one for candidate, one in found.items() if one.of_pieces}
        losses = {candidate: candidate.match - shown_match(candidate, one) for candidate, one in pieces.items()}
        refusals |= {one: why for one in pieces if one in verdicts and (why := verdicts[one].refusal) is not None}
        jam_phi, losses = {**ranking.jam_phi, **jams}, {**ranking.losses, **losses}
        return replace(ranking, refusals=refusals, jam_phi=jam_phi, losses=losses)

    def show_document(self, document: Document) -> None:
        """The document has changed: marks, names and order of the cards."""
        view, running = self._view, self._running
        view.set_measure(document.fabrication.width_mm, None if running else self._ranking)
        marks = dict(zip(document.candidates, document.marks, strict=True))
        view.model_.set_labels(dict(zip(document.candidates, document.labels, strict=True)))
        view.show_marks(marks, self._generation.planner.added)
        self._panel.bar.show_count(document.settings.k)
        if not running:
            view.mark(document.candidate)
            limit = limit_of(document) if document.candidates else None
            filled = self._session.ranking.why_filled(document.candidates) if document.candidates else None
            self._panel.show_why("\n".join(note.text for note in (filled, limit) if note is not None))
        self._show_ready(document)
        self._show_chosen()

    def show_gallery(self, entries: tuple[Entry, ...]) -> None:
        """Show other designs."""
        view, document = self._view, self._session.document
        ranking = self._session.display.ranking if self._running else self._ranking
        view.model_.set_ranking(ranking)
        view.show_entries(list(entries), document.target)
        self._alikes.look_at(tuple(entry.candidate for entry in entries), view.model_.ranking)
        view.mark(document.candidate)
        self._show_chosen()

    def add(self, entry: Entry) -> None:
        """A run has found a design, or improved one."""
        self._view.add(entry)
        self._show_chosen()

    def _show_chosen(self) -> None:
        """Tell the bar and the stage which design is chosen, and what it is called."""
        candidate = self.chosen
        name = self._view.model_.name_of(candidate)
        self._panel.bar.set_chosen(None if candidate is None or not name else (candidate.sheet, name))
        self.named.emit(name)

    def show_design(self, entry: Entry | None) -> None:
        """Another design is on the stage, or none."""
        self._view.mark(None if entry is None else entry.candidate)
        self._show_chosen()

    @property
    def chosen(self) -> Candidate | None:
        """The design on the stage."""
        stage = self._session.stage
        return None if stage is None else stage.candidate

    def reject(self, candidate: Candidate | None) -> None:
        """Reject a design; where that hides the chosen one, the next card is chosen instead."""
        hides = not self._view.model_.selection.show_rejected
        self._marks.reject(candidate, self._view.beside(candidate) if hides else None)

    def rename(self, candidate: Candidate | None) -> None:
        """Ask for the name and the note of a design, at its card where that is in sight."""
        view = self._view
        row = view.model_.row_of(candidate)
        card = view.visualRect(view.model_.index(row, 0)) if row >= 0 else QRect()
        in_sight = card.isValid() and view.isVisible() and view.viewport().rect().intersects(card)
        corner = view.viewport().mapToGlobal(card.topLeft())
        self.label_wanted.emit(candidate, QRect(corner, card.size()) if in_sight else QRect())

    # the menu of a card --------------------------------------------------------------------------------------------

    def show_menu(self, candidate: Candidate, place: QPoint) -> None:
        """Open the context menu of a card."""
        compare = ("compare", tr("Compare with chosen"), lambda: self.compare_wanted.emit(candidate))
        self.open_menu(candidate, place, compare, lambda: self.rename(candidate))

    def open_menu(
        self,
        candidate: Candidate,
        place: QPoint,
        compare: tuple[str, str, Callable[[], None]],
        rename: Callable[[], None],
    ) -> None:
        """Open the menu of a design, with comparing and renaming as the place has them."""
        menu = QMenu(self._panel)
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        menu.setToolTipsVisible(True)
        view = self._view
        row = view.model_.index(max(view.model_.row_of(candidate), 0), 0)
        alike: int = row.data(ALIKE_ROLE) if row.isValid() else 0
        mark = view.model_.mark_of(candidate)
        ready = not self._running and candidate in self._session.document.candidates
        for name, text, run in (
            ("pin", tr("Unpin") if mark is Mark.PINNED else tr("Pin"), lambda: self._marks.pin(candidate)),
            ("reject", tr("Restore") if mark is Mark.REJECTED else tr("Reject"), lambda: self.reject(candidate)),
            ("note", tr("Name and note … (F2)"), rename),
            ("alike", tr("More like this"), lambda: self.more_like(candidate)),
            compare,
            ("dice", tr("Use seed {seed}", seed=candidate.seed), lambda: self._use_seed(candidate)),
        ):
            action = QAction(icons.icon(name, view.cards.palette_), text, menu)
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
        self._choose(candidate)
        self._generation.more_like(self._panel.bar.nearness_value)

    def _use_seed(self, candidate: Candidate) -> None:
        self._change(seed=candidate.seed)
        self._session.history.end_drag()
