"""From design to cut file: machine, material, widths, options, live numbers, export."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QGridLayout, QSizePolicy, QWidget

from kirigami_studio.fabricate.machine import USUAL, MachineKind
from kirigami_studio.fabricate.material import PRINTER
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.foundation.words import mark, tr, tr_n
from kirigami_studio.gui.make.export_row import ExportRow
from kirigami_studio.gui.make.machine_chooser import MachineChooser
from kirigami_studio.gui.make.more_options import MoreOptions
from kirigami_studio.gui.make.verdict import VerdictState
from kirigami_studio.gui.widgets.card import (
    Card,
    ElidedLabel,
    ScrolledWhenShort,
    ToolButton,
    muted_label,
)
from kirigami_studio.gui.widgets.form import Form
from kirigami_studio.gui.widgets.layouts import column, label, plain_pane, row
from kirigami_studio.gui.widgets.number_field import leave_wheel
from kirigami_studio.gui.widgets.readable import (
    TIMES,
    UNKNOWN,
    readable_length,
    readable_range,
    readable_size,
    readable_time,
    readable_width,
)
from kirigami_studio.settings.fabrication import FabricationSettings, is_pinned, is_printed
from kirigami_studio.settings.layers import sheet_material

if TYPE_CHECKING:
    from kirigami_studio.fabricate.cut_plan import CutPlan
    from kirigami_studio.fabricate.timing import CutTimes
    from kirigami_studio.gui.make.shelf_editors import MachineEditor
    from kirigami_studio.studio.making import MadePieces, Planned

#: Settings that are shown at once.
LENGTHS = ("width_mm", "connector_mm", "kerf_mm")
#: Lengths of slots and of open cuts differ by much more than this share.
SAME_LENGTH = 1e-3
#: Height (pixels) that choices keep in a small window, where they scroll.
LEAST_CHOICES = 150
#: Key and label of the live numbers, in reading order.
NUMBERS = (
    ("size", mark("Sheet")),
    ("slits", mark("Cuts")),
    ("length", mark("Cut length")),
    ("time", mark("Time")),
    ("pieces", mark("Pieces")),
    ("ligament", mark("Min. ligament")),
)


class FabricationPanel(Card):
    """Reports changed fields by name and shows the plan that they lead to."""

    changed = Signal(dict)  #: field of FabricationSettings -> value
    options_changed = Signal(dict)  #: field of CutOptions -> value
    edited = Signal()
    materials_wanted = Signal()
    machines_changed = Signal()  #: those on disk
    export_wanted = Signal(str)  #: extension

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(tr("Fabrication"), parent)
        self.chooser = MachineChooser(self)
        self.chooser.changed.connect(self.changed)
        self.chooser.edited.connect(self.edited)
        self.machine, self.material = self.chooser.machine, self.chooser.material
        self._machine_editor: MachineEditor | None = None
        self.edit_machines = ToolButton("editMachines", "edit", tr("Copy and edit machines: bed, speeds, delays."))
        self.edit_machines.clicked.connect(self._edit_machines)
        self.edit_materials = ToolButton(
            "editMaterials", "material", tr("Copy, edit and calibrate materials (Ctrl+M).")
        )
        self.edit_materials.clicked.connect(self.materials_wanted)
        self.form = Form(FabricationSettings, 82, parent=self)
        self.form.changed.connect(self.changed)
        self.form.edited.connect(self.edited)
        self.construction = self.form.choice("construction")
        self.lengths = {name: self.form.decimal(name) for name in LENGTHS}
        self.numbers = {key: ElidedLabel(Qt.TextElideMode.ElideRight) for key, _ in NUMBERS}
        for shown in self.numbers.values():
            shown.setText(UNKNOWN)
        self.warnings = muted_label()
        self.warnings.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.warnings.setMinimumHeight(3 * self.warnings.fontMetrics().lineSpacing() + 2)
        self.warnings.setAlignment(Qt.AlignmentFlag.AlignTop)
        self.options = MoreOptions()
        self.options.changed.connect(self.changed)
        self.options.options_changed.connect(self.options_changed)
        self.options.edited.connect(self.edited)
        self.exports = ExportRow()
        self.exports.export_wanted.connect(self.export_wanted)
        self.export, self.more, self.kinds = self.exports.export, self.exports.more, self.exports.kinds
        self.summary = label()  #: what was trimmed off
        self.header.addWidget(self.summary)
        self._lay_out()
        self.body.addWidget(self.warnings)
        self.body.addWidget(self.exports)
        self.show_plan(None)

    def _material_row(self) -> QWidget:
        """The fields of machine, material and construction."""
        pane = plain_pane()
        table = QGridLayout(pane)
        table.setContentsMargins(0, 0, 0, 0)
        table.setHorizontalSpacing(6)
        table.setVerticalSpacing(4)
        table.setColumnStretch(1, 1)
        for line, (text, box, button) in enumerate(
            (
                (tr("Machine"), self.machine, self.edit_machines),
                (tr("&Material"), self.material, self.edit_materials),
                (tr("Construction"), self.construction, None),
            )
        ):
            table.addWidget(label(text, box), line, 0)
            table.addWidget(box, line, 1, 1, 1 if button is not None else 2)
            if button is not None:
                table.addWidget(button, line, 2)
        return pane

    def _edit_machines(self) -> None:
        """Open the machine editor, or bring it to the front."""
        from kirigami_studio.gui.make.shelf_editors import MachineEditor

        if self._machine_editor is None:
            self._machine_editor = MachineEditor(self.window(), self.machine.currentData())
            self._machine_editor.contents_changed.connect(self._reload_machines)
        self._machine_editor.choose(self.machine.currentData() or USUAL[MachineKind.CO2])
        leave_wheel(self._machine_editor)
        self._machine_editor.show()
        self._machine_editor.raise_()
        self._machine_editor.activateWindow()

    def _reload_machines(self) -> None:
        self.chooser.reload()
        self.machines_changed.emit()

    def _lay_out(self) -> None:
        choices = plain_pane()
        lengths = row(*((self.form.captioned(name), 1) for name in LENGTHS), spacing=8)
        column(self._material_row(), lengths, self.options, ..., on=choices, spacing=8, margins=(0, 0, 6, 0))
        self.scrolled = ScrolledWhenShort(choices, LEAST_CHOICES)
        self.body.addWidget(self.scrolled)
        self.body.addStretch(1)
        table = QGridLayout()
        table.setHorizontalSpacing(8)
        table.setVerticalSpacing(1)
        for place, (key, words) in enumerate(NUMBERS):
            line, across = divmod(place, 3)
            caption = label(tr(words), self.numbers[key])
            self.numbers[key].setObjectName("number")
            table.addWidget(caption, 3 * line, across)
            table.addWidget(self.numbers[key], 3 * line + 1, across)
            for part in (caption, self.numbers[key]):
                part.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        table.setRowMinimumHeight(2, 3)
        for across, stretch in enumerate((12, 9, 11)):
            table.setColumnStretch(across, stretch)
        self.body.addLayout(table)

    def reload_materials(self) -> None:
        """Read the library again."""
        self.chooser.reload()

    def show_settings(self, settings: FabricationSettings) -> None:
        """Show the document's numbers, the material's own where it has none."""
        chosen = material = self.chooser.show_settings(settings)
        with suppress(FabricationError):  # a material is gone, which the plan tells
            material = sheet_material(settings)  # connectors are those of the hinge layer
        shown = {
            "width_mm": settings.width_mm,
            "connector_mm": settings.connector_mm or (material.connector_mm if material else 0.0),
            "kerf_mm": settings.kerf_mm if settings.kerf_mm is not None else (material.kerf_mm if material else 0.0),
        }
        self.form.show(shown)
        self.construction.choose(settings.construction)
        self.lengths["connector_mm"].setEnabled(not is_pinned(settings))
        self.options.show_settings(settings)
        extension = ".pdf" if chosen is not None and chosen.by_hand else ".dxf"
        if settings.machine:
            extension = self.chooser.wanted_file or extension
        if is_printed(settings) or (material is not None and material.machine == PRINTER):
            extension = ".3mf"
        self.exports.show_goal(self.options.profile.currentText(), settings.dxf_version, extension)

    def show_plan(self, planned: Planned | None) -> None:
        """Show what the plan amounts to; None when there is no design."""
        self.exports.allow(cuts=planned is not None, pictures=planned is not None)
        if planned is None:
            self._forget_numbers()
            self._warn(tr("Choose a design to see its cut plan."))
            return
        plan, report = planned.plan, planned.report
        copies = len(plan.copies)
        length, times = plan.cut_length_mm, plan.times
        pieces = f"{copies * report.pieces}"
        if planned.work is not None:
            length, times = planned.work.cut_length_mm, planned.work.times
        if planned.layers is not None:
            pieces = tr("{pieces} + {tiles} tiles", pieces=report.pieces, tiles=len(planned.layers.assembly.pieces))
        texts = {
            "size": readable_size(*plan.size_mm),
            "slits": f"{copies * len(plan.paths)}",
            "length": readable_length(length),
            "time": readable_range(times.low, times.high),
            "pieces": pieces,
            "ligament": readable_width(report.min_ligament_mm),
        }
        for key, text in texts.items():
            self.numbers[key].setText(text)
        self.numbers["size"].setToolTip(format_copies(plan))
        self.options.rows.setText(*rows_of_copies(plan))
        self.options.rows.setToolTip(format_copies(plan))
        self.numbers["time"].setToolTip(format_times(times))
        self.numbers["length"].setToolTip(format_slots(planned))
        self._show_trim(planned.removed_share)

    def show_pieces(self, made: MadePieces) -> None:
        """Show the amount of pieces, pins and cuts of a pinned design."""
        self.exports.allow(cuts=True, pictures=True)
        assembly, works, cuts = made.made.assembly, made.works, made.cutting
        pieces, pins = len(assembly.pieces), len(assembly.hinges)
        beds = () if cuts is None else cuts.beds
        slits = sum(len(bed.pieces) + sum(len(one.holes) for one in bed.pieces) for bed in beds)
        texts = {
            "size": readable_size(*made.flat_size_mm),
            "slits": f"{slits}" if works else UNKNOWN,
            "length": readable_length(made.cut_length_mm) if works else UNKNOWN,
            "time": readable_range(sum(work.times.low for work in works), sum(work.times.high for work in works))
            if works
            else UNKNOWN,
            "pieces": tr("{pieces} + {pins} pins", pieces=pieces, pins=pins),
            "ligament": readable_width(made.report.figures.neck_mm),
        }
        for key, text in texts.items():
            self.numbers[key].setText(text)
        self.options.rows.setText("")
        self._show_trim(0.0)

    def show_verdict(self, state: VerdictState) -> None:
        """Show what is to be expected of the sheet, and why: the same list as in the banner."""
        if not state.known:
            return
        level, *reasons = state.lines
        weighty = state.verdict is not None and bool(state.verdict.problems)
        if reasons and not state.pending:
            first = tr("{level}: {reason}", level=level, reason=reasons[0])
        else:
            first = "\n".join([level, *reasons[:1]])
        self._warn("\n".join([first, *reasons[1:]]), muted=not weighty)

    def _show_trim(self, removed_share: float) -> None:
        """Say in the header that a sheet is trimmed."""
        percent = 100 * removed_share
        self.summary.setText(tr("trimmed, {percent:.1f} % cut off", percent=percent) if removed_share else "")
        tip = tr(
            "Trimmed: {percent:.1f} % of the sheet is cut off along the target, also in the cut file.",
            percent=percent,
        )
        self.summary.setToolTip(tip if removed_share else "")

    def show_waiting(self) -> None:
        """Designs are being made; there is no plan to show before one is chosen."""
        self.show_plan(None)
        self._warn(tr("The cut plan appears when the run is done."))

    def show_refusal(self, sentence: str) -> None:
        """Say why no plan can be made with these numbers."""
        self.exports.allow(cuts=False, pictures=True)
        self._forget_numbers()
        self._warn(sentence, muted=False)

    def show_untrimmed(self) -> None:
        """Forget the words on a trimmed design at once, before the plan of the whole one is made."""
        self._show_trim(0.0)

    def _forget_numbers(self) -> None:
        self._show_trim(0.0)
        for number in self.numbers.values():
            number.setText(UNKNOWN)

    def _warn(self, text: str, muted: bool = True) -> None:
        first, *more = text.split("\n")
        self.warnings.setText(tr("{first}  (+{count} more)", first=first, count=len(more)) if more else first)
        self.warnings.setToolTip(text)
        self.warnings.setObjectName("muted" if muted else "warning")
        self.warnings.style().unpolish(self.warnings)
        self.warnings.style().polish(self.warnings)


def format_copies(plan: CutPlan) -> str:
    """How the copies lie in the file, where it holds more than one."""
    if len(plan.copies) == 1:
        return ""
    rows, columns = plan.copies.rows_and_columns
    return tr(
        "{count} copies in the file, in rows of {columns} ({rows} rows), {gap:g} mm apart: {size}.",
        count=len(plan.copies),
        columns=columns,
        rows=rows,
        gap=plan.copies.gap_mm,
        size=readable_size(*plan.copies.spread_mm),
    )


def sheets_of(plan: CutPlan) -> str:
    """How many sheets of what size the file holds."""
    count, size = len(plan.copies), readable_size(*plan.size_mm)
    return tr_n("{count} sheet of {size}", "{count} sheets of {size}", count, size=size)


def rows_of_copies(plan: CutPlan) -> tuple[str, ...]:
    """Columns and rows of copies and what they take, longest text first; "" for a single sheet."""
    if len(plan.copies) == 1:
        return ("",)
    rows, columns = plan.copies.rows_and_columns
    short = tr_n("{count} copy", "{count} copies", len(plan.copies))
    middle = tr_n(
        "{count} copy, rows of {columns}", "{count} copies, rows of {columns}", len(plan.copies), columns=columns
    )
    return f"{short}: {columns} {TIMES} {rows}, {readable_size(*plan.copies.spread_mm)}", middle, short


def format_slots(planned: Planned) -> str:
    """Return the cost of slots, where the machine profile asks for them."""
    open_mm = len(planned.plan.copies) * planned.plan.cut_length_mm
    # Copies alone leave the length of every cut as it is.
    if (
        planned.work is None
        or planned.layers is not None
        or abs(planned.work.cut_length_mm / open_mm - 1.0) < SAME_LENGTH
    ):
        return ""
    return tr(
        "Closed slots: {factor:.2f} times the open cut length of {length}.",
        factor=planned.work.cut_length_mm / open_mm,
        length=readable_length(open_mm),
    )


def format_times(times: CutTimes) -> str:
    """Return the parts of the time in words."""
    return tr(
        "About {total}: {cut} cutting, {travel} travel, {extra} switching.\nRange: half to twice the acceleration.",
        total=readable_time(times.total),
        cut=readable_time(times.cut),
        travel=readable_time(times.travel),
        extra=readable_time(times.extra),
    )
