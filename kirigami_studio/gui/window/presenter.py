"""The window as a whole: title, messages, status line, and calls from place to place."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QPoint, QRect

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.gallery.all_designs_presenter import AllDesignsPresenter
from kirigami_studio.gui.gallery.comparing import Comparison
from kirigami_studio.gui.gallery.gallery_presenter import GalleryPresenter
from kirigami_studio.gui.make.fabrication_presenter import FabricationPresenter
from kirigami_studio.gui.run.run_presenter import RunPresenter
from kirigami_studio.gui.run.start_tile import DRAWN_START, FILE_START, LIBRARY_START, PAIRS
from kirigami_studio.gui.session.messages import Tone
from kirigami_studio.gui.session.session import Entry
from kirigami_studio.gui.stage.void_presenter import VoidPresenter
from kirigami_studio.gui.target.target_presenter import SecondPresenter, StartPresenter, TargetPresenter
from kirigami_studio.gui.window.controller import Controller
from kirigami_studio.gui.window.stage_presenter import StagePresenter
from kirigami_studio.gui.window.welcome_page import WelcomePresenter
from kirigami_studio.project.document import Document
from kirigami_studio.project.sheet_size import size_of
from kirigami_studio.studio.making import Motion
from kirigami_studio.studio.parts import Purpose
from kirigami_studio.studio.targets import TargetReading

if TYPE_CHECKING:
    from kirigami_studio.gui.window.main_window import MainWindow


class Connections(QObject):
    """Gives each place's presenter its panel and parts, and passes on calls between places."""

    def __init__(self, window: MainWindow, controller: Controller) -> None:
        super().__init__(window)
        self._window = window
        self._controller = controller
        session, stage, gallery = controller.session, window.stage, window.gallery
        self.designs = GalleryPresenter(
            gallery,
            window.settings,
            session,
            generation=controller.generation,
            marks=controller.marks,
            alikes=controller.alikes,
            estimates=controller.estimates,
            regularity=controller.regularity,
            hand=controller.hand,
            choose=controller.choose,
            change=controller.change_settings,
        )
        self.comparison = Comparison(
            gallery, stage.compare, session, controller.as_cut, choose=controller.choose, turn=stage.set_comparing
        )
        self.all_designs = AllDesignsPresenter(
            window.center,
            gallery,
            self.designs,
            session,
            generation=controller.generation,
            marks=controller.marks,
            choose=controller.choose,
            compare=self.comparison.compare,
        )
        self.target = TargetPresenter(
            window.target,
            session,
            targeting=controller.targeting,
            pasting=window.pasting,
            undo=controller.undo,
        )
        self.stage = StagePresenter(
            stage,
            session,
            curves=controller.curves,
            grips=controller.grips,
            name_of=gallery.view.model_.name_of,
        )
        self.making = FabricationPresenter(
            window.fabrication,
            stage.cuts,
            stage.verdict,
            session,
            editor=controller.fabrication,
            planner=controller.cutting,
            keeper=controller.verdict,
            apply_fix=controller.apply_fix,
        )
        self.run = RunPresenter(
            window.settings,
            window.run,
            session,
            controller.generation,
            controller.regularity,
            change=lambda changes: controller.change_settings(**changes),
            cancel=controller.cancel,
        )
        self.start = StartPresenter(
            window.target.start,
            window.settings,
            session,
            reader=controller.start,
            openers={
                LIBRARY_START: lambda: window.dialogs.show_start_library(window.settings.start),
                FILE_START: window.files.ask_start,
                DRAWN_START: window.dialogs.show_start_board,
                PAIRS: window.dialogs.show_pairs,
            },
            choose=lambda start: controller.change_settings(start=start),
        )
        self.second = SecondPresenter(
            window.settings.second,
            controller.second,
            {
                LIBRARY_START: lambda: window.dialogs.show_second_library(window.settings.second.shape),
                FILE_START: window.files.ask_second,
                DRAWN_START: window.dialogs.show_second_board,
            },
        )
        self.voids = VoidPresenter(
            stage.view,
            stage.voids,
            stage.deployment.play,
            window.status_text,
            session,
            hand=controller.hand,
            running=lambda: controller.running,
            showing_before=lambda: stage.showing_before,
            command=lambda name: window.commands[name],
        )
        self._connect_session()
        self._connect_stage()
        self._connect_pages()
        self._connect_target()
        self._connect_files()
        self._connect_messages()
        self.welcome = WelcomePresenter(stage.welcome, session, controller.preferences)
        self._show_idle()
        self._show_document(controller.document)
        window.status_text.setText(tr("Choose or draw a target to begin."))

    def _connect_session(self) -> None:
        """Signals of document, stage and run, passed down to each place in this order."""
        window, controller, run = self._window, self._controller, self._controller.run
        session = controller.session
        run.started.connect(self._show_run)
        run.ended.connect(self._show_idle)
        session.document_changed.connect(self._show_document)
        session.display.stage_changed.connect(self._show_design)
        session.display.gallery_reset.connect(self._show_gallery)
        session.display.candidate_found.connect(self._show_found)
        controller.variants_known.connect(window.settings.set_variants)
        controller.reader.known.connect(self._show_reading)

    def _connect_stage(self) -> None:
        window, stage, controller = self._window, self._window.stage, self._controller
        self.designs.named.connect(stage.set_name)
        self.designs.label_wanted.connect(self._show_label)
        self.stage.facts_changed.connect(window.facts.setText)
        self.voids.editable.connect(stage.set_editable)
        self.voids.refresh()
        stage.before_wanted.connect(controller.show_before)
        stage.trim.switch.triggered.connect(controller.trim)
        stage.voids.refit.clicked.connect(self.refit)
        controller.sampled.known.connect(stage.show_sample)
        controller.trimming.busy_changed.connect(stage.show_trimming)
        controller.refitting.busy_changed.connect(stage.voids.show_fitting)
        controller.as_cut.changed.connect(stage.show_as_cut)
        controller.artwork.painted.connect(stage.view.show_artwork)
        controller.cutting.planned.connect(stage.show_title)
        stage.switches_changed.connect(self.voids.refresh)

    def _connect_pages(self) -> None:
        """A view in the place of another."""
        window, stage = self._window, self._window.stage
        self.designs.compare_wanted.connect(self.comparison.compare_with)
        stage.comparing_changed.connect(self.comparison.follow)
        for hidden_by_table in (window.target.editing_changed, stage.comparing_changed):
            hidden_by_table.connect(self.all_designs.leave_to)
        self.all_designs.shown_changed.connect(self._make_way)

    def _connect_target(self) -> None:
        window, panel, controller = self._window, self._window.target, self._controller
        panel.buttons["openTarget"].clicked.connect(window.files.ask_target)
        panel.buttons["library"].clicked.connect(window.dialogs.show_library)
        panel.view.file_dropped.connect(window.files.open)
        controller.targeting.reader.design_read.connect(window.files.open_design)
        panel.opened.size_wanted.connect(controller.fabrication.set_opened_size)
        panel.opened.drawn_wanted.connect(controller.fabrication.cut_at_drawn_size)
        panel.opened.edited.connect(controller.end_drag)
        for reader, purpose in (
            (controller.targeting.reader, Purpose.TARGET),
            (controller.start, Purpose.START),
            (controller.second, Purpose.SECOND),
        ):
            reader.choice_wanted.connect(partial(window.dialogs.show_parts, purpose, reader.take_chosen))

    def _connect_files(self) -> None:
        window, panel = self._window, self._window.fabrication
        panel.materials_wanted.connect(window.dialogs.show_materials)
        panel.export_wanted.connect(window.files.export)
        panel.exports.all_wanted.connect(window.files.export_all)
        panel.exports.artwork_wanted.connect(window.files.export_artwork)
        panel.exports.ideal_wanted.connect(lambda: window.files.animate(Motion.IDEAL))
        self._controller.cutting.exported.connect(window.dialogs.show_report)
        self._controller.filing.recovery.recover_wanted.connect(window.files.recover)
        self._controller.filing.materials.material_added.connect(window.dialogs.reload_materials)
        window.pasting.file_wanted.connect(window.files.open)

    def _connect_messages(self) -> None:
        window, session = self._window, self._controller.session
        session.message_posted.connect(window.messages.add)
        session.status_changed.connect(window.status_text.setText)
        session.message_withdrawn.connect(window.messages.drop)

    # what concerns several places ----------------------------------------------------------------------------------

    def _show_run(self, total: int) -> None:
        """A run has begun."""
        self.designs.show_run()
        self.all_designs.show_run()
        self._window.target.set_editing(False)
        self.stage.show_run()
        self.making.show_run()
        self.run.show_run(total)
        self.voids.refresh()
        self._window.messages.dismiss(Tone.HINT, Tone.DONE)

    def _show_idle(self) -> None:
        """No run is in progress."""
        self.designs.show_idle()
        self.all_designs.show_run()
        self.stage.show_idle()
        self.run.show_idle()
        self.voids.refresh()

    def _show_document(self, document: Document) -> None:
        """The document has changed."""
        self.designs.show_document(document)
        self.comparison.refresh()
        self.all_designs.show_document()
        self.target.show_document(document)
        self.stage.show_document()
        self.making.show_document(document)
        self.run.show_document(document)
        self.start.show()
        self.voids.refresh()
        self._window.target.opened.show_size(size_of(document), follows=document.fabrication.opened_mm is not None)
        self._show_title()

    def _show_design(self, entry: Entry | None) -> None:
        """Another design is on the stage, or none."""
        self.designs.show_design(entry)
        self.comparison.show_design(entry)
        self.all_designs.show_design(entry)
        self.stage.show_design(entry)
        self.making.show_design(entry)
        self.start.show()
        self.voids.refresh()

    def _show_gallery(self, entries: tuple[Entry, ...]) -> None:
        """Other designs are in the gallery."""
        self.designs.show_gallery(entries)
        self.comparison.refresh()
        self.all_designs.show_document()

    def _show_found(self, entry: Entry) -> None:
        """A run has found a design, or improved one."""
        self.designs.add(entry)
        self.comparison.refresh()

    def _show_reading(self, reading: TargetReading | None) -> None:
        """Show what the target's shape says of symmetry and grid."""
        window, settings = self._window, self._controller.document.settings
        window.settings.show_symmetry("" if reading is None else reading.symmetry)
        window.settings.show_grid_choice(
            None if reading is None else reading.grid, "" if reading is None else reading.reason
        )
        window.target.show_start_refusal("" if reading is None else reading.start_refusal)
        if reading is not None and reading.grid is not None and settings.auto_grid:
            window.target.show_reach(reading.grid)
        self.start.show()

    def _show_label(self, candidate: Candidate | None, card: QRect) -> None:
        """Open name and note of a design beside its card, or beside the title of the stage."""
        title = self._window.stage.title
        beside = card if card.isValid() else QRect(title.mapToGlobal(QPoint(0, 0)), title.size())
        self._window.dialogs.show_label(candidate, beside)

    def _make_way(self, shown: bool) -> None:
        """The table of all designs comes, or is gone."""
        window = self._window
        if not shown:
            window.stage.take_focus()
            return
        if window.target.editing:
            window.target.set_editing(False)
        window.stage.player.play.setChecked(False)

    def refit(self, on: bool) -> None:
        """Fit the chosen design again, or stop fitting."""
        controller = self._controller
        if on:
            controller.refit()
        else:
            controller.cancel()
        self._window.stage.voids.show_fitting(controller.refitting.busy)

    def _show_title(self) -> None:
        window, controller = self._window, self._controller
        unsaved = controller.history.unsaved
        name = controller.path.name if controller.path is not None else tr("Untitled")
        literal = name.replace("[*]", "[*][*]")  # or Qt would take it for the place of its own star
        window.setWindowTitle(tr("{name}[*] \N{EN DASH} Kirigami Studio", name=literal))
        window.setWindowModified(unsaved)
        window.heading.setText(tr("{name}  ·  unsaved changes", name=name) if unsaved else name)
