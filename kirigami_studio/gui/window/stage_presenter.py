"""The stage of the window: the chosen design as sampled, trimmed and cut, and its facts."""

from __future__ import annotations

import math
from collections.abc import Callable

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.overlays import Overlay
from kirigami_studio.gui.session.session import Entry, Session
from kirigami_studio.gui.stage.curves import CurveReader
from kirigami_studio.gui.stage.gripping import GripFinder
from kirigami_studio.gui.window.stage_panel import StagePanel
from kirigami_studio.studio.two_states import match_of_start, start_of


class StagePresenter(QObject):
    """Shows the design on the stage, as wide as it would be cut, and what a run leaves of it.

    Parameters
    ----------
    panel : StagePanel
    session : Session
    curves : CurveReader
    grips : GripFinder
    name_of : callable
        What a design is called.
    """

    facts_changed = Signal(str)  #: what the status line says of the design

    def __init__(
        self,
        panel: StagePanel,
        session: Session,
        *,
        curves: CurveReader,
        grips: GripFinder,
        name_of: Callable[[Candidate | None], str],
    ) -> None:
        super().__init__(panel)
        self._panel, self._session, self._curves, self._name_of = panel, session, curves, name_of
        self._running = False
        panel.plots_switch.switch.toggled.connect(curves.want)
        panel.status.connect(session.set_status)
        panel.overlays_changed.connect(lambda shown: grips.want(Overlay.GRIPS in shown))
        curves.grown.connect(panel.plots.show_curves)
        grips.changed.connect(panel.view.show_grips)
        self.show_document()
        self.show_design(None)

    def show_run(self) -> None:
        """A run has begun: its target is shown, then the best design so far."""
        self._running = True
        self._panel.set_trimmable(False)
        self._panel.show_run(self._session.document.target)

    def show_idle(self) -> None:
        """No run is in progress."""
        self._running = False
        self._panel.set_trimmable(True)
        self._panel.show_idle()
        self._show_hint()

    def _show_hint(self) -> None:
        """Say what to do next while there is no design."""
        if self._running:
            return
        if self._session.document.target is not None:
            self._panel.set_hint("generate", tr("Ready to design"), tr("Press Generate (Ctrl+G)."))
            return
        hint = tr("Draw a shape, open a file, or take a silhouette.")
        self._panel.set_hint("target", tr("Start with a target"), hint)

    def show_document(self) -> None:
        """The document has changed."""
        self._show_width()
        self._show_hint()

    def show_design(self, entry: Entry | None) -> None:
        """Another design is chosen, or none."""
        target, candidate = self._session.document.target, None if entry is None else entry.candidate
        self._show_width()
        self._panel.show_entry(entry, target, self._name_of(candidate))
        self._curves.show(None if entry is None else entry.design, target)
        self.facts_changed.emit("" if entry is None else "   ·   ".join(_facts(entry)))

    def _show_width(self) -> None:
        """The flat sheet is as wide as opens the design on the stage to the size asked for."""
        stage = self._session.stage
        self._panel.set_sheet_width(self._session.width_of(None if stage is None else stage.candidate))


def _facts(entry: Entry) -> list[str]:
    """Facts about a design for the status line."""
    (rows, columns), score, trim = entry.candidate.sheet.grid, entry.candidate.score, entry.candidate.trim
    facts = [
        tr("{rows} \N{MULTIPLICATION SIGN} {columns} voids", rows=rows, columns=columns),
        tr("even rim") if entry.candidate.final_sheet.has_even_rim else tr("free rim"),
        tr("match {match:.1f} %", match=100 * score.iou_exact),
    ]
    if entry.candidate.sheet.start is not None and trim is None:
        share = 100 * match_of_start(entry.candidate.sheet)
        facts.append(tr("{start} {share:.1f} % when flat", start=start_of(entry.candidate), share=share))
    second = entry.candidate.second
    if second is not None:
        shown, angle = second.target.outline.name, math.degrees(second.target.phi)
        share = 100 * second.match.iou_exact
        if trim is None:
            facts.append(tr("{name} {share:.1f} % at {angle:.0f}°", name=shown, share=share, angle=angle))
        else:
            facts.append(tr("{name} {share:.1f} % at {angle:.0f}° untrimmed", name=shown, share=share, angle=angle))
    if entry.candidate.symmetry is not None:
        facts.insert(1, tr("symmetric"))
    if trim is not None:
        facts.append(tr("trimmed match {match:.1f} %", match=100 * trim.iou))
    return facts if score.feasible else [*facts, tr("overlaps itself")]
