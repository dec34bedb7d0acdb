"""The stage: the chosen design, its cuts and plots, how it is fabricated, and its voids changed by hand."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QPoint
from PySide6.QtWidgets import QMenu

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.session.overlays import Overlay
from kirigami_studio.gui.session.session import Entry
from kirigami_studio.gui.stage.rim_items import MouthFacts
from kirigami_studio.gui.stage.void_items import VoidFacts
from kirigami_studio.gui.window.controller import Controller
from kirigami_studio.project.document import Document, Void
from kirigami_studio.project.sheet_size import size_of
from kirigami_studio.studio.making import Motion, Planned
from kirigami_studio.studio.two_states import match_of_start, start_of

if TYPE_CHECKING:
    from kirigami_studio.gui.window.main_window import MainWindow


class StageConnections(QObject):
    """Connects the stage and the fabrication panel with the controller."""

    def __init__(self, window: MainWindow, controller: Controller) -> None:
        super().__init__(window)
        self._window = window
        self._controller = controller
        self._connect_stage()
        self._connect_cuts()
        self._connect_fabrication()
        controller.session.document_changed.connect(self._show_document)
        controller.session.display.stage_changed.connect(self._show_design)
        self._show_document(controller.document)
        self._show_design(None)

    def _connect_stage(self) -> None:
        window, stage, controller = self._window, self._window.stage, self._controller
        stage.before_wanted.connect(controller.show_before)
        stage.trim_wanted.connect(controller.trim)
        stage.plots_wanted.connect(controller.curves.want)
        stage.status.connect(window.status_text.setText)
        controller.sampled.known.connect(stage.show_sample)
        controller.trimming.busy_changed.connect(stage.show_trimming)
        controller.as_cut.changed.connect(stage.show_as_cut)
        controller.grips.changed.connect(stage.view.show_grips)
        controller.artwork.painted.connect(stage.view.show_artwork)
        stage.overlays_changed.connect(lambda shown: controller.grips.want(Overlay.GRIPS in shown))
        controller.curves.grown.connect(stage.plots.show_curves)

    def _connect_cuts(self) -> None:
        cuts, controller = self._window.stage.cuts, self._controller
        cuts.width_wanted.connect(controller.fabrication.set_hinge_width)
        cuts.remove_wanted.connect(controller.fabrication.remove_hinges)
        cuts.reset_wanted.connect(controller.fabrication.reset_hinges)
        cuts.edited.connect(controller.end_drag)
        controller.cutting.planned.connect(self._show_plan)
        controller.verdict.changed.connect(self._window.stage.verdict.show_state)
        controller.verdict.changed.connect(self._window.fabrication.show_verdict)
        self._window.stage.verdict.fix_wanted.connect(controller.apply_fix)
        controller.cutting.refused.connect(self._show_refusal)
        controller.cutting.exported.connect(self._window.dialogs.show_report)

    def _connect_fabrication(self) -> None:
        window, panel, controller = self._window, self._window.fabrication, self._controller
        panel.changed.connect(lambda changes: controller.fabrication.change(**changes))
        panel.options_changed.connect(lambda changes: controller.fabrication.change_options(**changes))
        panel.edited.connect(controller.end_drag)
        panel.materials_wanted.connect(window.dialogs.show_materials)
        panel.export_wanted.connect(window.files.export)
        panel.exports.all_wanted.connect(window.files.export_all)
        panel.exports.artwork_wanted.connect(window.files.export_artwork)
        panel.exports.ideal_wanted.connect(lambda: window.files.animate(Motion.IDEAL))
        size = window.target.opened
        size.size_wanted.connect(controller.fabrication.set_opened_size)
        size.drawn_wanted.connect(controller.fabrication.cut_at_drawn_size)
        size.edited.connect(controller.end_drag)

    def _show_document(self, document: Document) -> None:
        self._window.fabrication.show_settings(document.fabrication)
        follows = document.fabrication.opened_mm is not None
        self._window.target.opened.show_size(size_of(document), follows=follows)
        self._show_width()

    def _show_design(self, entry: Entry | None) -> None:
        """Another design is chosen, or none."""
        view, document = self._window.gallery.view, self._controller.document
        name = "" if entry is None else view.model_.name_of(entry.candidate)
        self._show_width()
        self._window.stage.show_entry(entry, document.target, name)
        self._controller.curves.show(None if entry is None else entry.design, document.target)
        view.mark(None if entry is None else entry.candidate)
        if entry is None or entry.candidate.trim is None:
            self._window.fabrication.show_untrimmed()
        self._window.facts.setText("" if entry is None else "   ·   ".join(_facts(entry)))

    def _show_width(self) -> None:
        """The flat sheet is as wide as opens the design on the stage to the size asked for."""
        self._window.stage.set_sheet_width(_stage_width(self._controller))

    def _show_plan(self, planned: Planned | None) -> None:
        self._window.fabrication.show_plan(planned)
        self._window.stage.cuts.show_plan(planned)
        self._window.stage.show_title()

    def _show_refusal(self, sentence: str) -> None:
        self._window.fabrication.show_refusal(sentence)
        self._window.stage.cuts.show_refusal(sentence)


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
    return [*facts, tr("feasible") if score.feasible else tr("not feasible")]


def _stage_width(controller: Controller) -> float:
    """Width of the flat sheet of the design on the stage, mm."""
    return controller.session.width_of(None if controller.stage is None else controller.stage.candidate)


class VoidConnections(QObject):
    """Connects gestures on voids and the void bar with hand editing."""

    def __init__(self, window: MainWindow, controller: Controller) -> None:
        super().__init__(window)
        self._window, self._controller = window, controller
        self._view, self._gestures = window.stage.view, window.stage.view.voids
        self._bar, self._hand = window.stage.voids, controller.hand
        self._void_facts, self._status_before = "", ""
        self.menu: QMenu | None = None
        self._connect()
        self._refresh()

    def _connect(self) -> None:
        window, gestures, hand, bar, controller = self._window, self._gestures, self._hand, self._bar, self._controller
        gestures.hovered.connect(self._describe)
        gestures.selection_changed.connect(self._refresh)
        gestures.nudged.connect(hand.nudge)
        for begun in (gestures.pull_begun, gestures.vertex_begun):
            begun.connect(self._pause)
        gestures.pull_begun.connect(hand.begin_drag)
        gestures.pulled.connect(hand.drag)
        gestures.rim.hovered.connect(self._describe_mouth)
        gestures.rim.selection_changed.connect(self._refresh)
        gestures.rim.grasped.connect(self._pause)
        gestures.rim.grasped.connect(hand.begin_mouth)
        gestures.rim.pulled.connect(hand.drag_mouth)
        gestures.rim.nudged.connect(hand.nudge_mouth)
        gestures.vertex_begun.connect(hand.begin_vertex)
        gestures.vertex_moved.connect(hand.move_vertex)
        gestures.drag_ended.connect(hand.release)
        gestures.drag_cancelled.connect(hand.cancel)
        gestures.lock_wanted.connect(hand.lock)
        gestures.menu_wanted.connect(self._show_menu)
        hand.drafted.connect(self._show_draft)
        bar.ratio_wanted.connect(hand.set_ratio)
        bar.lock_wanted.connect(hand.lock)
        bar.all_wanted.connect(hand.lock_all)
        bar.refit_wanted.connect(self.refit)
        controller.session.document_changed.connect(self._refresh)
        controller.session.display.stage_changed.connect(self._refresh)
        controller.refitting.busy_changed.connect(bar.show_fitting)
        controller.run.started.connect(self._refresh)
        controller.run.ended.connect(self._refresh)
        window.stage.switches_changed.connect(self._refresh)

    def _pause(self) -> None:
        """Stop playing, so that the angle stays the same during a drag."""
        self._window.stage.deployment.play.setChecked(False)

    def _refresh(self) -> None:
        """The document, the stage or the mode has changed."""
        document, stage = self._controller.document, self._window.stage
        ready = document.candidate is not None and not self._controller.running
        self._gestures.set_locked(document.locked)
        self._gestures.enable(ready and not stage.showing_before)
        stage.set_editable(ready)
        sheet = self._hand.sheet if ready else None
        chosen = min(self._gestures.selected, default=(0, 0))
        fits = sheet is not None and chosen[0] < sheet.rows and chosen[1] < sheet.columns
        ratio = float(sheet.field.ratio[chosen]) if sheet is not None and fits else None
        self._bar.show_voids(self._gestures.selected, ratio, document.locked)
        mouth, meant = self._gestures.rim.selected, self._gestures.rim.meant
        if sheet is not None and mouth is not None:
            facts = MouthFacts.of(sheet, mouth, _stage_width(self._controller))
            self._bar.show_mouth(facts.name, facts.short_name)
        if self._gestures.void is not None:
            self._describe(self._gestures.void)
        elif meant is not None:
            self._describe_mouth(meant)

    def _show_draft(self, design: PosedDesign) -> None:
        self._view.show_draft(design)
        self._refresh()

    # the label at the pointer --------------------------------------------------------------------------------------

    def _describe(self, void: Void | None) -> None:
        design = self._view.design
        if void is None or design is None:
            self._gestures.lines = ()
            if self._window.status_text.text() == self._void_facts and self._void_facts:
                self._window.status_text.setText(self._status_before)
            self._void_facts = ""
            return
        document = self._controller.document
        width, locked = _stage_width(self._controller), void in document.locked
        facts = VoidFacts.of(design.deployment, void, self._view.phi, width, locked)
        self._gestures.lines = facts.lines()
        self._tell(facts.sentence())

    def _tell(self, sentence: str) -> None:
        """Show what is pointed at in the status line; the text before comes back when nothing is."""
        if self._controller.running:  # the line tells how far the run is
            return
        if self._window.status_text.text() != self._void_facts or not self._void_facts:
            self._status_before = self._window.status_text.text()
        self._void_facts = sentence
        self._window.status_text.setText(sentence)

    def _describe_mouth(self, mouth: int | None) -> None:
        """Tell where an edge cut is that is pointed at."""
        design = self._view.design
        if mouth is None or design is None:
            self._describe(None)
            return
        width = _stage_width(self._controller)
        facts = MouthFacts.of(design.deployment.sheet, mouth, width)
        self._gestures.lines = facts.lines()
        self._tell(facts.sentence())

    # locks and fit -------------------------------------------------------------------------------------------------

    def toggle_lock(self) -> None:
        """Lock the selected voids, or the one under the pointer; unlock them when all are locked."""
        here = self._gestures.void
        voids = self._gestures.selected or (frozenset() if here is None else frozenset({here}))
        if voids:
            self._hand.lock(voids, not voids <= self._controller.document.locked)
        else:
            self._controller.session.set_status(tr("Point at a void or select some, then press L to lock them."))

    def _show_menu(self, void: Void, place: QPoint) -> None:
        voids, locked = self._gestures.selected, self._controller.document.locked
        self.menu = QMenu(self._window)
        lock = self.menu.addAction(tr("Unlock") if voids <= locked else tr("Lock"))
        lock.triggered.connect(self.toggle_lock)
        even = self.menu.addAction(tr("Set ratio to 1"))
        even.setEnabled(not voids <= locked)
        even.triggered.connect(lambda: self._hand.set_ratio(voids, 1.0))
        self.menu.addSeparator()
        for name in ("lock_all", "unlock_all", "even_rim", "refit"):
            self.menu.addAction(self._window.commands[name])
        self.menu.aboutToHide.connect(self.menu.deleteLater)
        self.menu.popup(place)

    def refit(self, on: bool) -> None:
        """Fit the chosen design again, or stop fitting."""
        controller = self._controller
        if not on:
            controller.cancel()
        else:
            controller.refit()
        self._bar.show_fitting(controller.refitting.busy)
