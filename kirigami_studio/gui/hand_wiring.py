"""Connects the hand on the layout view with the part of the controller that changes the design."""

from __future__ import annotations

from PySide6.QtCore import QObject, QPoint
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.controller import Controller
from kirigami_studio.gui.scene.void_items import VoidFacts
from kirigami_studio.gui.shell import Shell
from kirigami_studio.project.document import Document, Void


class HandWiring(QObject):
    """Keeps gestures, the row under the view and the label at the pointer in step with the document and the draft."""

    def __init__(self, window: Shell, controller: Controller, parent: QObject) -> None:
        super().__init__(parent)
        self.window, self.controller = window, controller
        self.view, self.gestures = window.stage.view, window.stage.view.voids
        self.bar, self.hand = window.stage.voids, controller.hand
        self._said, self._before = "", ""
        self.menu: QMenu | None = None
        self._connect()
        self._refresh()

    def _connect(self) -> None:
        window, gestures, hand, bar, controller = self.window, self.gestures, self.hand, self.bar, self.controller
        gestures.hovered.connect(self._tell)
        gestures.selection_changed.connect(lambda _: self._refresh())
        gestures.nudged.connect(hand.nudge)
        for begun in (gestures.pull_begun, gestures.vertex_begun):  # the drag is at the angle that was seen
            begun.connect(lambda *_: window.stage.deployment.play.setChecked(False))
        gestures.pull_begun.connect(hand.begin_pull)
        gestures.pulled.connect(hand.pull)
        gestures.vertex_begun.connect(hand.begin_vertex)
        gestures.vertex_moved.connect(hand.move_vertex)
        gestures.drag_ended.connect(hand.let_go)
        gestures.drag_cancelled.connect(hand.take_back)
        gestures.lock_wanted.connect(hand.lock)
        gestures.menu_wanted.connect(self._show_menu)
        hand.drafted.connect(self._show_draft)
        bar.ratio_wanted.connect(hand.set_ratio)
        bar.lock_wanted.connect(hand.lock)
        bar.all_wanted.connect(hand.lock_all)
        bar.refit_wanted.connect(self._refit)
        controller.session.document_changed.connect(lambda _: self._refresh())
        controller.session.display.stage_changed.connect(lambda _: self._refresh())
        controller.refitting.busy_changed.connect(self._show_fitting)
        controller.run.started.connect(lambda _: self._refresh())
        controller.run.ended.connect(lambda _: self._refresh())
        window.stage.switches_changed.connect(self._refresh)
        actions = window.actions_
        actions["hand"].triggered.connect(window.stage.hand.click)
        actions["lock"].triggered.connect(self.toggle_lock)
        actions["lock_all"].triggered.connect(lambda: hand.lock_all(True))
        actions["unlock_all"].triggered.connect(lambda: hand.lock_all(False))
        actions["refit"].triggered.connect(lambda: self._refit(True))

    def _refresh(self) -> None:
        """The document, the stage or the mode has changed."""
        document, stage = self.controller.document, self.window.stage
        ready = document.candidate is not None and not self.controller.running
        self.gestures.set_locked(document.locked)
        self.gestures.enable(ready and not stage.showing_before)
        stage.set_editable(ready)
        field = self.hand.field if ready else None
        chosen = min(self.gestures.selected, default=(0, 0))
        fits = field is not None and chosen[0] < field.rows and chosen[1] < field.columns
        ratio = float(field.ratio[chosen]) if field is not None and fits else None
        self.bar.show_voids(self.gestures.selected, ratio, document.locked)
        for name in ("lock", "lock_all", "unlock_all", "refit"):
            self.window.actions_[name].setEnabled(ready)
        self._show_switch()
        if self.gestures.void is not None:
            self._tell(self.gestures.void)

    def _show_switch(self) -> None:
        action: QAction = self.window.actions_["hand"]
        action.setEnabled(self.window.stage.hand.isEnabled())
        action.setChecked(self.window.stage.hand.isChecked())

    def _show_draft(self, design: PosedDesign) -> None:
        self.view.show_draft(design)
        self._refresh()

    # the label at the pointer --------------------------------------------------------------------------------------

    def _tell(self, void: Void | None) -> None:
        design = self.view.design
        if void is None or design is None:
            self.gestures.lines = ()
            if self.window.says.text() == self._said and self._said:
                self.window.says.setText(self._before)
            self._said = ""
            return
        document: Document = self.controller.document
        width, locked = document.fabrication.width_mm, void in document.locked
        facts = VoidFacts.of(design.deployment, void, self.view.phi, width, locked)
        self.gestures.lines = facts.lines()
        if self.controller.running:  # the line tells how far the run is
            return
        if self.window.says.text() != self._said or not self._said:
            self._before = self.window.says.text()
        self._said = facts.sentence()
        self.window.says.setText(self._said)

    # locks and fit -------------------------------------------------------------------------------------------------

    def toggle_lock(self) -> None:
        """Lock what is selected, or else what is pointed at; unlock it when all of it is locked."""
        here = self.gestures.void
        voids = self.gestures.selected or (frozenset() if here is None else frozenset({here}))
        if voids:
            self.hand.lock(voids, not voids <= self.controller.document.locked)
        else:
            self.controller.session.set_status(tr("Point at a void or select some, then press L to lock them."))

    def _show_menu(self, void: Void, place: QPoint) -> None:
        voids, locked = self.gestures.selected, self.controller.document.locked
        self.menu = QMenu(self.window)
        lock = self.menu.addAction(tr("Unlock") if voids <= locked else tr("Lock"))
        lock.triggered.connect(self.toggle_lock)
        even = self.menu.addAction(tr("Set ratio to 1"))
        even.setEnabled(not voids <= locked)
        even.triggered.connect(lambda: self.hand.set_ratio(voids, 1.0))
        self.menu.addSeparator()
        for name in ("lock_all", "unlock_all", "refit"):
            self.menu.addAction(self.window.actions_[name])
        self.menu.aboutToHide.connect(self.menu.deleteLater)
        self.menu.popup(place)

    def _refit(self, on: bool) -> None:
        controller = self.controller
        if not on:
            controller.cancel()
        else:
            controller.refit()
        self.bar.show_fitting(controller.refitting.busy)

    def _show_fitting(self, busy: bool) -> None:
        self.bar.show_fitting(busy)
        self.window.actions_["cancel"].setEnabled(busy or self.controller.running)
