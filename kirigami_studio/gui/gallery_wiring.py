"""Who tells whom about the collection of designs: gallery, commands and controller."""

from __future__ import annotations

from PySide6.QtCore import QObject, QPoint, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.controller import Controller
from kirigami_studio.gui.look import icons
from kirigami_studio.gui.session import Entry
from kirigami_studio.gui.shell import Shell
from kirigami_studio.gui.side_by_side import SideBySide
from kirigami_studio.project.document import Document, Mark


class GalleryWiring(QObject):
    """Connects the gallery of one window with its controller."""

    def __init__(self, window: Shell, controller: Controller, parent: QObject) -> None:
        super().__init__(parent)
        self.window = window
        self.controller = controller
        self.menu: QMenu | None = None
        self.side_by_side = SideBySide(window, controller, self)
        view, bar = window.gallery.view, window.gallery.bar
        view.pin_wanted.connect(controller.marks.pin)
        view.reject_wanted.connect(self.reject)
        view.menu_wanted.connect(self.show_menu)
        bar.again_wanted.connect(controller.generation.again)
        bar.alike_wanted.connect(controller.generation.more_like)
        window.settings.keep_changed.connect(self._keep_seed)
        actions = window.actions_
        actions["again"].triggered.connect(lambda _=False: controller.generation.again())
        actions["more_like"].triggered.connect(lambda _=False: controller.generation.more_like(bar.nearness_value))
        actions["pin"].triggered.connect(lambda _=False: controller.marks.pin(self._candidate))
        actions["reject"].triggered.connect(lambda _=False: self.reject(self._candidate))
        controller.session.document_changed.connect(self._show_document)
        controller.session.display.stage_changed.connect(self._show_stage)
        controller.session.display.gallery_reset.connect(lambda _: self._show_chosen())
        controller.run.started.connect(lambda _: self._show_ready())
        controller.run.ended.connect(lambda _: self._show_ready())
        self._show_document(controller.document)

    @property
    def _candidate(self) -> Candidate | None:
        stage = self.controller.stage
        return None if stage is None else stage.candidate

    def reject(self, candidate: Candidate | None) -> None:
        """Reject a design; where that hides the chosen one, the next card is chosen instead."""
        view = self.window.gallery.view
        hides = not view.model_.selection.show_rejected
        self.controller.marks.reject(candidate, view.beside(candidate) if hides else None)

    def show_menu(self, candidate: Candidate, place: QPoint) -> None:
        """Offer what can be done to one design, beside its card."""
        menu = QMenu(self.window)
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        menu.setToolTipsVisible(True)
        mark = self.window.gallery.view.model_.mark_of(candidate)
        ready = not self.controller.running and candidate in self.controller.document.candidates
        for name, text, wanted in (
            ("pin", tr("Unpin") if mark is Mark.PINNED else tr("Pin"), lambda: self.controller.marks.pin(candidate)),
            ("reject", tr("Restore") if mark is Mark.REJECTED else tr("Reject"), lambda: self.reject(candidate)),
            ("alike", tr("More like this"), lambda: self._more_like(candidate)),
            ("compare", tr("Compare with chosen"), lambda: self.side_by_side.compare_with(candidate)),
            ("dice", tr("Use seed {seed}", seed=candidate.seed), lambda: self._use_seed(candidate)),
        ):
            action = QAction(icons.icon(name, self.window.palette_), text, menu)
            action.setObjectName(name)
            action.setEnabled(ready)
            action.triggered.connect(lambda _=False, wanted=wanted: wanted())
            menu.addAction(action)
        self.menu = menu
        menu.destroyed.connect(self._forget_menu)
        menu.popup(place)

    def _forget_menu(self) -> None:
        self.menu = None

    def _more_like(self, candidate: Candidate) -> None:
        self.controller.choose(candidate)
        self.controller.generation.more_like(self.window.gallery.bar.nearness_value)

    def _use_seed(self, candidate: Candidate) -> None:
        self.controller.change_settings(seed=candidate.seed)
        self.controller.end_drag()

    def _keep_seed(self, keeps: bool) -> None:
        self.controller.generation.planner.keeps_seed = keeps

    # news ----------------------------------------------------------------------------------------------------------

    def _show_document(self, document: Document) -> None:
        gallery = self.window.gallery
        gallery.view.model_.set_width_mm(document.fabrication.width_mm)
        marks = dict(zip(document.candidates, document.marks, strict=True))
        gallery.view.show_marks(marks, self.controller.generation.planner.added)
        gallery.bar.show_count(document.settings.k)
        self._show_ready()
        self._show_chosen()

    def _show_stage(self, entry: Entry | None) -> None:
        self._show_ready()
        self._show_chosen()

    def _show_chosen(self) -> None:
        """The bar knows the chosen design by its number."""
        model, candidate = self.window.gallery.view.model_, self._candidate
        number = model.number_of(candidate)
        self.window.gallery.bar.set_chosen(None if candidate is None or not number else (candidate.field, number))

    def _show_ready(self) -> None:
        document, actions = self.controller.document, self.window.actions_
        ready = bool(document.candidates) and not self.controller.running
        self.window.gallery.bar.set_ready(ready)
        for name in ("again", "more_like"):
            actions[name].setEnabled(ready)
        chosen = None if document.chosen is None or self.controller.running else document.marks[document.chosen]
        for name in ("pin", "reject"):
            actions[name].setEnabled(chosen is not None)
        actions["pin"].setText(tr("Un&pin design") if chosen is Mark.PINNED else tr("&Pin design"))
        actions["reject"].setText(tr("Re&store design") if chosen is Mark.REJECTED else tr("Re&ject design"))
