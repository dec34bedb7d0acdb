"""The chosen design: the stage, its cuts and plots, and how it is fabricated."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.controller import Controller
from kirigami_studio.gui.jobs.cut_jobs import Planned
from kirigami_studio.gui.reshaping import OpenedSizes
from kirigami_studio.gui.session import Entry
from kirigami_studio.project.document import Document

if TYPE_CHECKING:
    from kirigami_studio.gui.main_window import MainWindow


class StageConnections(QObject):
    """Connects the stage and the fabrication panel with the controller."""

    def __init__(self, window: MainWindow, controller: Controller) -> None:
        super().__init__(window)
        self._window = window
        self._controller = controller
        self._sizing = OpenedSizes(self)
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
        controller.curves.grown.connect(stage.plots.show_curves)

    def _connect_cuts(self) -> None:
        cuts, controller = self._window.stage.cuts, self._controller
        cuts.width_wanted.connect(controller.fabrication.set_hinge_width)
        cuts.remove_wanted.connect(controller.fabrication.remove_hinges)
        cuts.reset_wanted.connect(controller.fabrication.reset_hinges)
        cuts.edited.connect(controller.end_drag)
        controller.cutting.planned.connect(self._show_plan)
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
        panel.opened.link_wanted.connect(self._sizing.link)
        self._sizing.known.connect(panel.opened.show_size)
        self._sizing.width_wanted.connect(controller.fabrication.cut_at_drawn_size)

    def _show_document(self, document: Document) -> None:
        self._window.fabrication.show_settings(document.fabrication)
        self._sizing.follow(self._controller.stage, document)
        self._window.stage.set_sheet_width(document.fabrication.width_mm)

    def _show_design(self, entry: Entry | None) -> None:
        """Another design is chosen, or none."""
        view, document = self._window.gallery.view, self._controller.document
        rank = -1 if entry is None else view.model_.number_of(entry.candidate)
        self._window.stage.show_entry(entry, document.target, rank)
        self._sizing.follow(entry, document)
        self._controller.curves.show(None if entry is None else entry.design, document.target)
        view.mark(None if entry is None else entry.candidate)
        self._window.facts.setText("" if entry is None else "   ·   ".join(_facts(entry)))

    def _show_plan(self, planned: Planned | None) -> None:
        self._window.fabrication.show_plan(planned)
        self._window.stage.cuts.show_plan(planned)
        self._window.stage.refresh_header()

    def _show_refusal(self, sentence: str) -> None:
        self._window.fabrication.show_refusal(sentence)
        self._window.stage.cuts.show_refusal(sentence)


def _facts(entry: Entry) -> list[str]:
    """What the status line says of a design."""
    field, score, trim = entry.candidate.field, entry.candidate.score, entry.candidate.trim
    facts = [
        tr("{rows} \N{MULTIPLICATION SIGN} {columns} voids", rows=field.rows, columns=field.columns),
        tr("exact IoU {iou_exact:.1f} %", iou_exact=100 * score.iou_exact),
    ]
    if trim is not None:
        facts.append(tr("trimmed IoU {iou:.1f} %", iou=100 * trim.iou))
    return [*facts, tr("feasible") if score.feasible else tr("not feasible")]
