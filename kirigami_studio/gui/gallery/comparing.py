"""The choice of compared designs, and the search for unknown figures of theirs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.compare_page import MOST, ComparedDesign, ComparePage
from kirigami_studio.gui.gallery.gallery_panel import GalleryPanel
from kirigami_studio.gui.session.queue import JobCallbacks, LatestJob
from kirigami_studio.gui.session.session import Entry, Session
from kirigami_studio.gui.stage.as_cut import AsCutReader, AsCutState
from kirigami_studio.gui.stage.piece_reader import PieceReader
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.project.sheet_size import cut_for
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.studio.making import CutRequest, TimedDesign, timing

if TYPE_CHECKING:
    from kirigami_studio.studio.as_cut import AsCut


class Comparison(QObject):
    """Keeps the compared designs, which are no part of the document: comparing is not undone.

    Parameters
    ----------
    as_cut : AsCutReader
        Simulates the design on the stage.
    pieces : PieceReader
        Makes what is shown of designs that are made of pieces.
    choose : callable
        Puts a design on the stage.
    turn : callable
        Turns the stage to the page, or back; :meth:`follow` is called then.
    """

    def __init__(
        self,
        panel: GalleryPanel,
        page: ComparePage,
        session: Session,
        as_cut: AsCutReader,
        pieces: PieceReader,
        *,
        choose: Callable[[Candidate], None],
        turn: Callable[[bool], None],
    ) -> None:
        super().__init__(page)
        self._view, self._switch, self._page, self._session = panel.view, panel.bar.compare.switch, page, session
        self._choose, self._turn, self._pieces = choose, turn, pieces
        self._comparing = False
        self._compared: tuple[Candidate, ...] = ()
        self._chosen: Candidate | None = None
        self._return: Callable[[], None] | None = None  # to where the comparison was asked for
        self._shown: tuple[tuple[ComparedDesign, ...], Outline | None] | None = None
        self._simulated: dict[Candidate, AsCut] = {}
        self._times: dict[tuple[Candidate, FabricationSettings], float | None] = {}
        self._job = LatestJob[TimedDesign](session.queue)
        self._switch.triggered.connect(self.show)
        page.swap.clicked.connect(self.swap)
        page.left.connect(self.leave)
        page.taken.connect(self._take)
        as_cut.changed.connect(self._take_as_cut)
        pieces.changed.connect(self.refresh)
        session.fabrication_changed.connect(self._forget)
        self._view.model_.dataChanged.connect(lambda *_: self.refresh())
        self._show_switches(False)

    @property
    def compared(self) -> tuple[Candidate, ...]:
        """The designs that are compared, as far as they are still in the gallery."""
        number_of = self._view.model_.number_of
        return tuple(candidate for candidate in self._compared if number_of(candidate))

    # which designs -------------------------------------------------------------------------------------------------

    def compare_with(self, candidate: Candidate) -> None:
        """Show a design beside the chosen one."""
        stage = self._session.stage
        if stage is None or candidate == stage.candidate:
            self._session.hint(tr("This is the chosen design. Ctrl+click another card to compare."))
            return
        self.compare((stage.candidate, candidate))

    def expect(self, candidates: Sequence[Candidate]) -> None:
        """Get ready for designs that are marked to be compared."""
        self._page.expect(tuple(map(self._known, candidates)), self._session.document.target)

    def compare(self, candidates: Sequence[Candidate], back: Callable[[], None] | None = None) -> None:
        """Show designs beside each other; closing the comparison leads ``back``."""
        self._compared = self._in_order(candidates[:MOST])
        self.show(True)
        self._return = back if self._comparing else None

    def show(self, on: bool) -> None:
        """Show the pair compared last, else the chosen design and the next card; or one alone."""
        stage = self._session.stage
        if not on:
            self.leave()
            return
        if len(self.compared) < 2 and stage is not None:
            other = self._view.beside(stage.candidate)
            self._compared = (stage.candidate,) if other is None else (stage.candidate, other)
        if stage is None or len(self.compared) < 2:
            self._show_switches(False)
            self._session.hint(tr("Nothing to compare yet. The gallery needs two designs."))
            return
        if not self._comparing:
            self._page.fit()
        self._turn(True)
        self.refresh()

    def leave(self) -> None:
        """Show the chosen design alone, or go back to where the comparison was asked for."""
        back = self._return
        self._turn(False)
        if back is not None:
            back()

    def follow(self, comparing: bool) -> None:
        """The stage shows several designs now, or one."""
        self._comparing = comparing
        self._show_switches(comparing)
        if not comparing:
            self._return = None
            self._job.stop()
            self._times = {key: seconds for key, seconds in self._times.items() if seconds is not None}
            if len(self._compared) > 2 or self._chosen not in self._compared:
                self._compared = ()  # the next comparison is one with the chosen design

    def swap(self) -> None:
        """Choose the other one of two designs."""
        if self._comparing and len(self.compared) == 2:
            self._choose(next(one for one in self.compared if one != self._chosen))

    def _take(self, candidate: Candidate) -> None:
        """Choose a design and show it alone."""
        self._turn(False)
        self._choose(candidate)

    def show_design(self, entry: Entry | None) -> None:
        """Let a newly chosen design take the place of the one before, unless it is compared."""
        candidate = None if entry is None else entry.candidate
        if candidate is not None and candidate not in self._compared and self._chosen in self._compared:
            self._compared = tuple(candidate if one == self._chosen else one for one in self._compared)
        self._chosen = candidate
        self._compared = self._in_order(self._compared)
        self.refresh()

    def _in_order(self, candidates: Sequence[Candidate]) -> tuple[Candidate, ...]:
        """Of two designs the chosen one is the first."""
        swapped = len(candidates) == 2 and candidates[1] == self._chosen
        return tuple(candidates[::-1] if swapped else candidates)

    # what is shown -------------------------------------------------------------------------------------------------

    def refresh(self) -> None:
        """Show all as they are now, or one alone where fewer than two are left."""
        if not self._comparing:
            return
        compared = self.compared
        if self._session.stage is None or len(compared) < 2:
            self._turn(False)
            return
        shown = tuple(map(self._known, compared)), self._session.document.target
        if shown != self._shown:
            self._shown = shown
            self._page.show_designs(*shown)
        other = next((one for one in compared if one != self._chosen), None)
        self._view.show_compared(other if len(compared) == 2 else None)
        self._find_times()

    def _known(self, candidate: Candidate) -> ComparedDesign:
        """All that is known of a design."""
        model, session = self._view.model_, self._session
        entry = model.all_entries[(model.number_of(candidate) or 1) - 1]
        simulated = self._simulated.get(candidate)
        return ComparedDesign(
            entry,
            model.name_of(candidate),
            session.width_of(candidate),
            chosen=candidate == self._chosen,
            as_cut=simulated or model.as_cut_of(candidate),
            simulated=simulated is not None,
            seconds=self._times.get(self._key(candidate)),
            pieces=self._pieces.of(candidate) if self._comparing else None,
        )

    def _show_switches(self, on: bool) -> None:
        """The switch says whether several designs are on the stage."""
        self._switch.setChecked(on)
        if not on:
            self._view.show_compared(None)

    # what is found out ---------------------------------------------------------------------------------------------

    def _key(self, candidate: Candidate) -> tuple[Candidate, FabricationSettings]:
        return candidate, cut_for(self._session.document, candidate)

    def _forget(self) -> None:
        """Designs are cut otherwise now."""
        self._simulated.clear()
        self._times.clear()
        self.refresh()

    def _take_as_cut(self, state: AsCutState) -> None:
        stage = self._session.stage
        if stage is not None and state.sheet is not None:
            self._simulated[stage.candidate] = state.sheet.as_cut
            self.refresh()

    def _find_times(self) -> None:
        """Plan the cuts of designs whose time is not known, in the worker."""
        document = self._session.document
        missing = [candidate for candidate in self.compared if self._key(candidate) not in self._times]
        if not missing or self._job.busy:
            return
        requests = []
        for candidate in missing:
            entry, (_, cut) = self._known(candidate).entry, self._key(candidate)
            self._times[candidate, cut] = None  # asked for
            requests.append(CutRequest(candidate, entry.design.deployment, document.target, cut, document=document))
        callbacks = JobCallbacks(self._take_time, self.refresh, on_failed=self._session.report_failure)
        self._job.start(tr("planning the compared cuts"), partial(timing, tuple(requests)), callbacks)

    def _take_time(self, found: TimedDesign) -> None:
        self._times[found.candidate, found.settings] = found.seconds
        self.refresh()
