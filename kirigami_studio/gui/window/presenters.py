"""The presenters of all places, and the calls from place to place."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from PySide6.QtCore import QObject, QPoint, QRect
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QLabel

from kirigami_studio.evaluate.candidate import Candidate
from kirigami_studio.gui.gallery.all_designs_presenter import AllDesignsPresenter
from kirigami_studio.gui.gallery.comparing import Comparison
from kirigami_studio.gui.gallery.gallery_presenter import GalleryPresenter
from kirigami_studio.gui.make.fabrication_presenter import FabricationPresenter
from kirigami_studio.gui.run.generate_bar import RunPresenter
from kirigami_studio.gui.run.part_bar import PartPresenter
from kirigami_studio.gui.run.start_tile import DRAWN_START, FILE_START, LIBRARY_START, PAIRS
from kirigami_studio.gui.session.session import Entry
from kirigami_studio.gui.stage.void_bar import VoidPresenter
from kirigami_studio.gui.target.pasting import PasteReader
from kirigami_studio.gui.target.target_presenter import StartPresenter, TargetPresenter
from kirigami_studio.gui.window.file_commands import FileCommands
from kirigami_studio.gui.window.open_dialogs import Dialogs
from kirigami_studio.gui.window.pages import Pages, WindowPage
from kirigami_studio.gui.window.services import Services
from kirigami_studio.gui.window.stage_panel import StagePresenter
from kirigami_studio.gui.window.welcome_page import WelcomePresenter
from kirigami_studio.project.document import Document
from kirigami_studio.project.sheet_size import size_of
from kirigami_studio.studio.making import Motion
from kirigami_studio.studio.parts import Purpose
from kirigami_studio.studio.targets import TargetReading


class Presenters(QObject):
    """Gives each place's presenter its panel and services, and passes on calls between places.

    Parameters
    ----------
    status : QLabel
        Tells of the void that is pointed at.
    command : callable
        The action of a command, by its id.
    """

    def __init__(
        self,
        pages: Pages,
        services: Services,
        *,
        dialogs: Dialogs,
        files: FileCommands,
        pasting: PasteReader,
        status: QLabel,
        command: Callable[[str], QAction],
    ) -> None:
        super().__init__(pages)
        self._pages, self._services, self._dialogs, self._files = pages, services, dialogs, files
        session, chosen = services.session, services.chosen
        target, settings, stage, gallery = pages.target, pages.settings, pages.stage, pages.gallery
        self.designs = GalleryPresenter(
            gallery,
            settings,
            session,
            generation=services.generation,
            marks=services.marks,
            alikes=services.alikes,
            estimates=services.estimates,
            regularity=services.regularity,
            hand=services.hand,
            choose=chosen.choose,
            change=services.settings.change,
        )
        gallery.view.show_pieces(services.pieces)
        self.comparison = Comparison(
            gallery,
            stage.compare,
            session,
            services.as_cut,
            services.pieces,
            choose=chosen.choose,
            turn=stage.set_comparing,
        )
        self.all_designs = AllDesignsPresenter(
            pages.stack,
            gallery,
            self.designs,
            session,
            generation=services.generation,
            marks=services.marks,
            choose=chosen.choose,
            compare=self.comparison.compare,
            expect=self.comparison.expect,
        )
        self.target = TargetPresenter(
            target,
            session,
            targeting=services.targeting,
            pasting=pasting,
            preview=services.preview,
            undo=services.project.undo,
        )
        self.stage = StagePresenter(
            stage,
            session,
            curves=services.curves,
            grips=services.grips,
            name_of=gallery.view.model_.name_of,
            estimates=services.estimates,
        )
        self.making = FabricationPresenter(
            pages.fabrication,
            pages.cuts,
            stage.verdict,
            session,
            editor=services.fabrication,
            planner=services.cutting,
            keeper=services.verdict,
            estimates=services.estimates,
            hand=services.hand,
            run=services.run,
        )
        self.run = RunPresenter(
            settings,
            pages.run,
            session,
            services.generation,
            services.regularity,
            editor=services.settings,
            cancel=chosen.cancel,
        )
        self.start = StartPresenter(target.start, settings, session, services.start, services.settings)
        self.voids = VoidPresenter(
            stage.view,
            stage.voids,
            stage.deployment.play,
            status,
            session,
            hand=services.hand,
            running=lambda: services.run.running,
            showing_before=lambda: stage.showing_before,
            command=command,
        )
        self.parts = PartPresenter(pages.parts, session, services.generation, services.hand)
        self.welcome = WelcomePresenter(pages.welcome, session, services.preferences)
        self._connect_session()
        self._connect_stage()
        self._connect_pages()
        self._connect_target()
        self._connect_files(pasting)
        self._show_idle()
        self._show_document(session.document)

    def _connect_session(self) -> None:
        """Signals of document, stage and run, passed down to each place in this order."""
        session, run = self._services.session, self._services.run
        run.started.connect(self._show_run)
        run.ended.connect(self._show_idle)
        session.document_changed.connect(self._show_document)
        session.display.stage_changed.connect(self._show_design)
        session.display.gallery_reset.connect(self._show_gallery)
        session.display.candidate_found.connect(self._show_found)
        self._services.reader.known.connect(self._show_reading)

    def _connect_stage(self) -> None:
        stage, services = self._pages.stage, self._services
        chosen = services.chosen
        self.designs.named.connect(stage.set_name)
        self.designs.label_wanted.connect(self._show_label)
        self.voids.editable.connect(stage.set_editable)
        self.voids.refresh()
        stage.before_wanted.connect(chosen.show_before)
        stage.trim.switch.triggered.connect(chosen.trim)
        stage.voids.refit.clicked.connect(self.refit)
        chosen.sampled.known.connect(stage.show_sample)
        chosen.trimming.busy_changed.connect(stage.show_trimming)
        chosen.refitting.busy_changed.connect(stage.voids.refit.setChecked)
        services.as_cut.changed.connect(stage.show_as_cut)
        services.artwork.painted.connect(stage.view.show_artwork)
        services.cutting.planned.connect(stage.show_made)
        stage.switches_changed.connect(self.voids.refresh)

    def _connect_pages(self) -> None:
        """A view in the place of another."""
        stage = self._pages.stage
        self.designs.compare_wanted.connect(self.comparison.compare_with)
        stage.comparing_changed.connect(self.comparison.follow)
        stage.comparing_changed.connect(self.all_designs.leave_to)
        self._pages.turned.connect(lambda page: self.all_designs.leave_to(page is not WindowPage.DESIGN))
        self._pages.turned.connect(lambda page: self._services.preview.show_on(page is WindowPage.SHAPE))
        self.all_designs.shown_changed.connect(self._make_way)

    def _connect_target(self) -> None:
        panel, services, dialogs, files = self._pages.target, self._services, self._dialogs, self._files
        panel.buttons["openTarget"].clicked.connect(files.ask_target)
        panel.buttons["library"].clicked.connect(dialogs.show_library)
        panel.view.drops.file_dropped.connect(files.open)
        services.targeting.reader.design_read.connect(files.open_design)
        panel.opened.size_wanted.connect(services.fabrication.set_opened_size)
        panel.opened.drawn_wanted.connect(services.fabrication.cut_at_drawn_size)
        panel.opened.edited.connect(services.session.history.end_drag)
        settings, second = self._pages.settings, self._pages.settings.second
        openers: dict[str, Callable[[], object]] = {
            LIBRARY_START: lambda: dialogs.show_start_library(settings.start),
            FILE_START: files.ask_start,
            DRAWN_START: dialogs.show_start_board,
            PAIRS: self.show_pairs,
        }
        for wanted in (panel.start.other_wanted, settings.other_start_wanted):
            wanted.connect(lambda kind: openers[kind]())
        second_openers: dict[str, Callable[[], object]] = {
            LIBRARY_START: lambda: dialogs.show_second_library(second.shape),
            FILE_START: files.ask_second,
            DRAWN_START: dialogs.show_second_board,
        }
        second.other_wanted.connect(lambda kind: second_openers[kind]())
        second.drops.file_dropped.connect(services.second.open)
        for reader, purpose in (
            (services.targeting.reader, Purpose.TARGET),
            (services.start, Purpose.START),
            (services.second, Purpose.SECOND),
        ):
            reader.choice_wanted.connect(partial(dialogs.show_parts, purpose, reader.take_chosen))

    def _connect_files(self, pasting: PasteReader) -> None:
        panel, services, dialogs, files = self._pages.fabrication, self._services, self._dialogs, self._files
        panel.materials_wanted.connect(dialogs.show_materials)
        self._pages.cuts.generate.clicked.connect(services.generation.generate)
        panel.export_wanted.connect(files.export)
        panel.exports.all_wanted.connect(files.export_all)
        panel.exports.print_wanted.connect(dialogs.show_print)
        panel.exports.artwork_wanted.connect(dialogs.export_artwork)
        panel.exports.ideal_wanted.connect(lambda: files.animate(Motion.IDEAL))
        services.exporter.exported.connect(dialogs.show_report)
        services.exporter.open_wanted.connect(dialogs.open_in_program)
        services.project.recovery.recover_wanted.connect(files.recover)
        services.project.recovery.left_behind.connect(self._pages.welcome.offer_recovery)
        for changed in (services.project.stock.added, dialogs.materials_changed):
            changed.connect(self.making.reload_materials)
        pasting.file_wanted.connect(files.open)
        self._pages.welcome.pairs.chosen.connect(files.open_pair)
        for opened in (services.project.opened, services.project.recovery.recovered):
            opened.connect(lambda: self._pages.turn(WindowPage.DESIGN))
        services.project.begun.connect(lambda: self._pages.turn(WindowPage.SHAPE))

    def show_pairs(self) -> None:
        """Go to the finished pairs."""
        pairs = self._pages.welcome.pairs
        self._pages.turn(WindowPage.SHAPE)
        pairs.read(self._services.session.queue)
        pairs.list.setFocus()

    # what concerns several places ----------------------------------------------------------------------------------

    def _show_run(self, total: int) -> None:
        """A run has begun."""
        self.designs.show_run()
        self.all_designs.show_run()
        self._pages.turn(WindowPage.DESIGN)
        self.stage.show_run()
        self.making.show_run()
        self.run.show_run(total)
        self._offer_run()
        self.parts.show_document(self._services.session.document)
        self.voids.refresh()

    def _show_idle(self) -> None:
        """No run is in progress."""
        self.designs.show_idle()
        self.all_designs.show_run()
        self.stage.show_idle()
        self.run.show_idle()
        self._offer_run()
        self.parts.show_document(self._services.session.document)
        self.voids.refresh()

    def _show_document(self, document: Document) -> None:
        """The document has changed."""
        self.designs.show_document(document)
        self.comparison.refresh()
        self.all_designs.show_document()
        self.target.show_document(document)
        self.stage.show_document()
        self.making.show_document(document)
        self._offer_run()
        self.run.show_document(document)
        self.parts.show_document(document)
        self.start.show()
        self.voids.refresh()
        self._pages.target.opened.show_size(size_of(document), follows=document.fabrication.opened_mm is not None)

    def _offer_run(self) -> None:
        """Offer a run beside the empty plan, too: the page Make has no other way to one."""
        document = self._services.session.document
        ready = document.target is not None and not document.candidates and not self._services.run.running
        self._pages.cuts.offer_run(ready)

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
        pages, settings = self._pages, self._services.session.document.settings
        pages.settings.show_symmetry("" if reading is None else reading.symmetry)
        pages.settings.show_grid_choice(
            None if reading is None else reading.grid, "" if reading is None else reading.reason
        )
        pages.target.show_start_refusal("" if reading is None else reading.start_refusal)
        self.target.expect_grid(None if reading is None else reading.grid)
        if reading is not None and reading.grid is not None and settings.auto_grid:
            pages.target.show_reach(reading.grid)
        self.start.show()

    def _show_label(self, candidate: Candidate | None, card: QRect) -> None:
        """Open name and note of a design beside its card, or beside the title of the stage."""
        title = self._pages.stage.title
        beside = card if card.isValid() else QRect(title.mapToGlobal(QPoint(0, 0)), title.size())
        self._dialogs.show_label(candidate, beside)

    def _make_way(self, shown: bool) -> None:
        """The table of all designs comes, or is gone."""
        pages = self._pages
        if not shown:
            pages.stage.take_focus()
            return
        pages.turn(WindowPage.DESIGN)
        pages.stage.player.play.setChecked(False)

    def show_unit(self) -> None:
        """Lengths are shown in another unit: write them all again."""
        self._show_document(self._services.session.document)
        self.making.show_unit()
        self._pages.stage.plots.show_unit()

    def refit(self, on: bool) -> None:
        """Fit the chosen design again, or stop fitting."""
        chosen = self._services.chosen
        if on:
            chosen.refit()
        else:
            chosen.cancel()
        self._pages.stage.voids.refit.setChecked(chosen.refitting.busy)
