"""How the chosen design is made: its numbers, its plan, and the verdict on the sheet."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.gui.make.cuts_page import CutsPage
from kirigami_studio.gui.make.cutting import CutPlanner, FabricationEditor
from kirigami_studio.gui.make.fabrication_panel import FabricationPanel
from kirigami_studio.gui.make.verdict import VerdictKeeper
from kirigami_studio.gui.make.verdict_bar import VerdictBar
from kirigami_studio.gui.run.generation import DesignRun
from kirigami_studio.gui.session.session import Entry, Session
from kirigami_studio.gui.stage.as_cut import AsCutEstimates
from kirigami_studio.gui.stage.hand_editor import HandEditor
from kirigami_studio.project.document import Document
from kirigami_studio.settings.fabrication import machine_for
from kirigami_studio.studio.making import MadePieces, Planned

if TYPE_CHECKING:
    from kirigami_studio.studio.fixes import Fix


class FabricationPresenter(QObject):
    """Shows plan and verdict in the panel, on the page of cuts and in the bar; takes changes.

    Parameters
    ----------
    panel : FabricationPanel
    cuts : CutsPage
    bar : VerdictBar
    session : Session
    editor : FabricationEditor
    planner : CutPlanner
    keeper : VerdictKeeper
    estimates : AsCutEstimates
    hand : HandEditor
    run : DesignRun
        While it runs, no fix is made.
    """

    def __init__(
        self,
        panel: FabricationPanel,
        cuts: CutsPage,
        bar: VerdictBar,
        session: Session,
        *,
        editor: FabricationEditor,
        planner: CutPlanner,
        keeper: VerdictKeeper,
        estimates: AsCutEstimates,
        hand: HandEditor,
        run: DesignRun,
    ) -> None:
        super().__init__(panel)
        self._panel, self._cuts, self._session, self._planner = panel, cuts, session, planner
        self._keeper, self._estimates, self._hand, self._run = keeper, estimates, hand, run
        panel.changed.connect(lambda changes: editor.change(**changes))
        panel.options_changed.connect(lambda changes: editor.change_options(**changes))
        cuts.width_wanted.connect(editor.set_hinge_width)
        cuts.remove_wanted.connect(editor.remove_hinges)
        cuts.reset_wanted.connect(editor.reset_hinges)
        for edited in (panel.edited, cuts.edited):
            edited.connect(session.history.end_drag)
        panel.machines_changed.connect(planner.plan_soon)
        planner.planned.connect(self._show_plan)
        planner.refused.connect(self._show_refusal)
        keeper.changed.connect(bar.show_state)
        keeper.changed.connect(panel.show_verdict)
        bar.fix_wanted.connect(self._apply_fix)
        self.show_document(session.document)

    def show_run(self) -> None:
        """Designs are being made: there is no plan to show."""
        self._panel.show_waiting()
        self._cuts.show_plan(None)

    def show_document(self, document: Document) -> None:
        """The document has changed: the numbers that it is cut with."""
        self._panel.show_settings(document.fabrication)
        with suppress(KirigamiError):  # a machine is gone, which the plan tells
            self._cuts.view.show_bed(machine_for(document.fabrication).reach_mm)

    def show_design(self, entry: Entry | None) -> None:
        """Another design is on the stage, or none."""
        if entry is None or entry.candidate.trim is None:
            self._panel.show_untrimmed()

    def reload_materials(self) -> None:
        """Offer the materials on disk, which have changed, and plan again."""
        self._panel.reload_materials()
        self._session.document_changed.emit(self._session.document)
        self._keeper.forget_fixes()
        self._estimates.forget_verdicts()
        self._planner.plan_soon()

    def _apply_fix(self, fix: Fix) -> None:
        """Make a change that was tried on the chosen design."""
        if not self._run.running and not self._hand.postpones(lambda: self._apply_fix(fix)):
            self._session.apply(fix.edit(self._session.document))
            self._session.history.end_drag()

    def show_unit(self) -> None:
        """Lengths are shown in another unit."""
        if self._planner.made is not None:
            self._show_plan(self._planner.made)
        self._keeper.changed.emit(self._keeper.state)

    def _show_plan(self, made: Planned | MadePieces | None) -> None:
        if made is None or isinstance(made, Planned):
            self._panel.show_plan(made)
            self._cuts.show_plan(made)
        else:
            self._panel.show_pieces(made)
            self._cuts.show_pieces(made)

    def _show_refusal(self, sentence: str) -> None:
        self._panel.show_refusal(sentence)
        self._cuts.show_refusal(sentence)
