"""Who tells whom: gestures of the panels to the controller, its news to the panels."""

from __future__ import annotations

from PySide6.QtCore import QObject
from PySide6.QtGui import QAction

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.commands import OVERLAY_ACTIONS, Commands
from kirigami_studio.gui.controller import Controller
from kirigami_studio.gui.designs.collection import DiscardedDesigns
from kirigami_studio.gui.gallery_wiring import GalleryWiring
from kirigami_studio.gui.hand_wiring import HandWiring
from kirigami_studio.gui.jobs.cut_jobs import Planned
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.gui.reshaping import OpenedSizes, TargetReshaper
from kirigami_studio.gui.session import Entry
from kirigami_studio.gui.shell import Shell
from kirigami_studio.gui.views.layout_view import Overlay
from kirigami_studio.project.document import Document


class Wiring(QObject):
    """Connects one window with its controller and keeps what was shown last."""

    def __init__(self, window: Shell, controller: Controller, commands: Commands) -> None:
        super().__init__(window)
        self.window = window
        self.controller = controller
        self.commands = commands
        self.reshaping = TargetReshaper(window.target.view.context, controller.session, self)
        self._slips: list[Message] = []
        self.discarded = DiscardedDesigns(controller.session, self)
        self.gallery = GalleryWiring(window, controller, self)
        self.sizing = OpenedSizes(self)
        self.sizing.known.connect(window.fabrication.opened.show_size)
        self.sizing.width_wanted.connect(controller.fabrication.cut_at_drawn_size)
        window.fabrication.opened.link_wanted.connect(self.sizing.link)
        self._shown = Document()
        self._connect_panels()
        self._connect_controller()
        self.by_hand = HandWiring(window, controller, self)
        self._show_document(controller.document, everything=True)
        self._show_stage(None)
        self._end_run(completed=False)
        window.says.setText(tr("Choose or draw a target to begin."))

    # gestures ------------------------------------------------------------------------------------------------------

    def _connect_panels(self) -> None:
        window, controller = self.window, self.controller
        window.target.open_wanted.connect(self.commands.ask_target)
        window.target.wants_silhouette.connect(self.commands.show_library)
        window.target.clear_wanted.connect(controller.targeting.clear)
        window.target.view.file_dropped.connect(self.commands.take_file)
        window.target.view.content_dropped.connect(self.commands.pasting.take)
        self._connect_editor()
        window.target.view.hint.connect(lambda text: window.says.setText(text) if text else None)
        window.target.threshold.changed.connect(controller.targeting.change_threshold)
        window.target.threshold.automatic_wanted.connect(lambda: controller.targeting.change_threshold(None))
        window.target.threshold.edited.connect(controller.targeting.tracer.end_drag)
        window.settings.changed.connect(lambda changes: controller.change_settings(**changes))
        window.settings.edited.connect(controller.end_drag)
        window.run.generate_wanted.connect(controller.generation.generate)
        window.run.cancel_wanted.connect(controller.cancel)
        window.gallery.view.chosen.connect(controller.choose)
        window.fabrication.changed.connect(lambda changes: controller.fabrication.change(**changes))
        window.fabrication.options_changed.connect(lambda changes: controller.fabrication.change_options(**changes))
        window.fabrication.edited.connect(controller.end_drag)
        window.fabrication.materials_wanted.connect(self.commands.show_materials)
        window.fabrication.export_wanted.connect(self.commands.export)
        window.fabrication.exports.all_wanted.connect(self.commands.export_all)
        window.stage.before_wanted.connect(controller.show_before)
        window.stage.trim_wanted.connect(controller.trim)
        window.stage.switches_changed.connect(self._show_switches)
        window.stage.plots_wanted.connect(controller.curves.want)
        window.stage.status.connect(window.says.setText)
        window.stage.overlays_changed.connect(self._show_overlay_actions)
        cuts = window.stage.cuts
        cuts.width_wanted.connect(controller.fabrication.set_hinge_width)
        cuts.remove_wanted.connect(controller.fabrication.remove_hinges)
        cuts.reset_wanted.connect(controller.fabrication.reset_hinges)
        cuts.edited.connect(controller.end_drag)

    def _connect_editor(self) -> None:
        window, controller, reshaping = self.window, self.controller, self.reshaping
        window.target.view.context.changed.connect(reshaping.take)
        window.target.tools.mirror_wanted.connect(reshaping.mirror)
        window.target.refine.previewed.connect(reshaping.preview)
        window.target.refine.refined.connect(reshaping.refine)
        window.target.refine.size_wanted.connect(reshaping.resize)
        reshaping.edited.connect(controller.targeting.reshape)
        reshaping.edited.connect(lambda _: self._forget_slips())
        controller.targeting.reader.failed.connect(self._note_unread)
        controller.targeting.source_read.connect(lambda _: self._forget_slips())
        reshaping.refused.connect(self._refuse)
        reshaping.previewed.connect(window.target.view.show_preview)
        self.discarded.undo_wanted.connect(controller.undo)
        reshaping.restarted.connect(window.target.refine.restart)
        controller.run.started.connect(lambda _: window.target.set_editing(False))

    def _refuse(self, error: KirigamiError) -> None:
        """A shape could not be made; the sentence is of use until one can."""
        self._slips.append(Message(str(error), Tone.ERROR))
        self.controller.session.refuse(error)

    def _note_unread(self, sentence: str, trace: str) -> None:
        """A file could not be read as a target; the sentence is of use until there is another one."""
        self._slips.append(Message(sentence, Tone.ERROR, trace))

    def _forget_slips(self) -> None:
        for slip in self._slips:
            self.window.messages.drop(slip)
        self._slips.clear()

    def _connect_controller(self) -> None:
        window, controller = self.window, self.controller
        controller.session.document_changed.connect(self._show_document)
        controller.session.display.stage_changed.connect(self._show_stage)
        controller.session.display.gallery_reset.connect(self._show_gallery)
        controller.session.display.candidate_found.connect(self._add_candidate)
        controller.sampled.known.connect(window.stage.show_sample)
        controller.trimming.busy_changed.connect(self._show_trimming)
        controller.run.started.connect(self._show_run)
        controller.run.progressed.connect(window.run.show_progress)
        controller.run.ended.connect(self._end_run)
        controller.cutting.planned.connect(self._show_plan)
        controller.cutting.refused.connect(self._show_refusal)
        controller.cutting.exported.connect(self.commands.show_report)
        controller.curves.grown.connect(window.stage.plots.show_curves)
        controller.session.message_withdrawn.connect(window.messages.drop)
        controller.variants_known.connect(window.settings.set_variants)
        controller.session.message_posted.connect(window.messages.add)
        controller.session.status_changed.connect(window.says.setText)

    # news ----------------------------------------------------------------------------------------------------------

    def _show_document(self, document: Document, everything: bool = False) -> None:
        window, before = self.window, self._shown
        self._shown = document
        moved = everything or document.target is not before.target
        if moved:
            window.target.show_target(document.target, self.controller.targeting.tracer.picture_of(document.target))
            self.reshaping.follow()
            has_target = document.target is not None
            window.run.show_ready(has_target)
            window.actions_["generate"].setEnabled(has_target and not self.controller.running)
            window.actions_["clear"].setEnabled(has_target)
            self._show_hints(has_target)
        if moved or document.settings.grid != before.settings.grid:
            window.target.show_reach(document.settings.grid)
        window.settings.show_settings(document.settings)
        window.fabrication.show_settings(document.fabrication)
        self.sizing.follow(self.controller.stage, document)
        window.stage.set_sheet_width(document.fabrication.width_mm)
        if not self.controller.running:
            window.gallery.view.mark(document.candidate)
        self._show_history()
        self._show_title()

    def _show_hints(self, has_target: bool) -> None:
        if has_target:
            self.window.stage.view.set_hint("generate", tr("Ready to design"), tr("Press Generate (Ctrl+G)."))
        else:
            hint = tr("Open a file (Ctrl+O), choose from the library (Ctrl+L), or draw a silhouette on the left.")
            self.window.stage.view.set_hint("target", tr("Start with a target"), hint)

    def _show_history(self) -> None:
        history, actions = self.controller.history, self.window.actions_
        steps = (("undo", tr("Undo"), history.undo_label), ("redo", tr("Redo"), history.redo_label))
        for name, word, label in steps:
            actions[name].setEnabled(label is not None)
            actions[name].setText(f"&{word}" if label is None else f"&{word} {label[0].lower()}{label[1:]}")
            keys = actions[name].shortcut().toString()
            actions[name].setToolTip(f"{word} ({keys})" if label is None else f"{word}: {label} ({keys})")

    def _show_title(self) -> None:
        unsaved = self.controller.history.unsaved
        name = self.controller.path.name if self.controller.path is not None else tr("Untitled")
        self.window.setWindowTitle(tr("{name}[*] \N{EN DASH} Kirigami Studio", name=name))
        self.window.setWindowModified(unsaved)
        self.window.heading.setText(tr("{name}  ·  unsaved changes", name=name) if unsaved else name)

    def _show_stage(self, entry: Entry | None) -> None:
        view = self.window.gallery.view
        rank = -1 if entry is None else view.model_.number_of(entry.candidate)
        target = self.controller.document.target
        self.window.stage.show_entry(entry, target, rank)
        self.sizing.follow(entry, self.controller.document)
        self.controller.curves.show(None if entry is None else entry.design, target)
        view.mark(None if entry is None else entry.candidate)
        for name in ("export", "export_all"):
            self.window.actions_[name].setEnabled(entry is not None)
        if entry is None:
            self.window.facts.clear()
            return
        field, score = entry.candidate.field, entry.candidate.score
        kind = tr("feasible") if score.feasible else tr("not feasible")
        grid = tr("{rows} \N{MULTIPLICATION SIGN} {columns} voids", rows=field.rows, columns=field.columns)
        facts = [grid, tr("exact IoU {iou_exact:.1f} %", iou_exact=100 * score.iou_exact), kind]
        if entry.candidate.trim is not None:
            facts.insert(2, tr("trimmed IoU {iou:.1f} %", iou=100 * entry.candidate.trim.iou))
        self.window.facts.setText("   ·   ".join(facts))

    def _show_plan(self, planned: Planned | None) -> None:
        self.window.fabrication.show_plan(planned)
        self.window.stage.cuts.show_plan(planned)
        self.window.stage.refresh_header()

    def _show_refusal(self, sentence: str) -> None:
        self.window.fabrication.show_refusal(sentence)
        self.window.stage.cuts.show_refusal(sentence)

    def _show_trimming(self, busy: bool) -> None:
        self.window.stage.show_trimming(busy)
        self.window.actions_["cancel"].setEnabled(busy or self.controller.running)

    def _show_switches(self) -> None:
        """The header's switches have their actions in the menu, which show the same."""
        stage = self.window.stage
        for name, button in (
            ("before", stage.before),
            ("trim", stage.trim),
            ("cuts", stage.cuts_switch),
            ("plots", stage.plots_switch),
        ):
            action: QAction = self.window.actions_[name]
            action.setEnabled(button.isEnabled())
            action.setChecked(button.isChecked())

    def _show_gallery(self, entries: tuple[Entry, ...]) -> None:
        view = self.window.gallery.view
        view.show_entries(list(entries), self.controller.document.target)
        view.mark(self.controller.document.candidate)

    def _add_candidate(self, entry: Entry) -> None:
        view = self.window.gallery.view
        view.add(entry)
        stage = self.controller.stage
        if stage is not None:
            self.window.stage.set_rank(view.model_.number_of(stage.candidate))

    def _show_run(self, total: int) -> None:
        self.window.run.show_running(total)
        self.window.stage.set_trimmable(False)
        self.window.gallery.view.set_hint(tr("Generating …"), tr("The first designs appear shortly."))
        self.window.stage.view.set_hint("generate", tr("Generating …"), tr("The best design so far appears here."))
        self.window.fabrication.show_waiting()
        self.window.stage.cuts.show_plan(None)
        self.window.actions_["cancel"].setEnabled(True)
        self.window.actions_["generate"].setEnabled(False)
        self.window.messages.dismiss(Tone.HINT, Tone.DONE)

    def _end_run(self, completed: bool) -> None:
        has_target = self.controller.document.target is not None
        self.window.run.show_idle()
        self.window.stage.set_trimmable(True)
        self.window.run.show_ready(has_target)
        self._show_hints(has_target)
        hint = tr("Designs appear here, best first, as they are generated.")
        self.window.gallery.view.set_hint(tr("No designs yet"), hint)
        self.window.actions_["cancel"].setEnabled(False)
        self.window.actions_["generate"].setEnabled(has_target)

    def _show_overlay_actions(self, overlays: frozenset[Overlay]) -> None:
        for name, overlay in OVERLAY_ACTIONS.items():
            action: QAction = self.window.actions_[name]
            action.setChecked(overlay in overlays)
