"""Options that most sheets leave as they are: connector style, order, tabs, copies, files."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QGridLayout, QSizePolicy, QVBoxLayout, QWidget

from kirigami_studio.export.profile import PROFILES
from kirigami_studio.fabricate.hold import HoldKind
from kirigami_studio.fabricate.material import Construction, library
from kirigami_studio.fabricate.options import CutOptions
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.widgets.card import ElidedLabel
from kirigami_studio.gui.widgets.form import Form
from kirigami_studio.settings.fabrication import FabricationSettings, construction_for, is_pinned, pin_sizes


class MoreOptions(QWidget):
    """Reports each changed field by name."""

    options_changed = Signal(dict)  #: field of CutOptions -> value
    changed = Signal(dict)  #: field of FabricationSettings -> value
    edited = Signal()  #: a number was left

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.cuts, self.files = Form(CutOptions, parent=self), Form(FabricationSettings, parent=self)
        self.style_, self.order = self.cuts.choice("style"), self.cuts.choice("order")
        self.tabs, self.tab_mm = self.cuts.whole("tabs"), self.cuts.decimal("tab_mm")
        self.copies, self.copy_gap = self.cuts.whole("copies"), self.cuts.decimal("copy_gap_mm")
        profiles = [(key, one.name, one.note.text if one.note else "") for key, one in PROFILES.items()]
        self.profile = self.files.choice("profile", profiles)
        self.dxf_version, self.paper = self.files.choice("dxf_version"), self.files.choice("paper")
        materials = [(key, tr(one.name), "") for key, one in library().items.items()]
        usual = ("", tr("As suits the material"), tr("Cotton for a board, card for a soft sheet."))
        self.files.choice("second_material", [usual, *sorted(materials, key=lambda one: one[1].casefold())])
        self.markers, self.engrave = self.files.switch("markers"), self.files.switch("engrave")
        self.rows = ElidedLabel()
        self.rows.setObjectName("muted")
        self.rows.setFixedHeight(self.copies.sizeHint().height())  # beside the numbers, not beside their captions
        self.rows.setAccessibleDescription(tr("Rows of copies"))
        for box in (self.style_, self.order, self.dxf_version):  # as wide as their columns, whatever their words
            box.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self._lay_out()
        self._connect()

    def _lay_out(self) -> None:
        table = QGridLayout(self)
        table.setContentsMargins(0, 0, 0, 0)
        table.setHorizontalSpacing(8)
        table.setVerticalSpacing(6)
        cuts, files = self.cuts.captioned, self.files.captioned
        table.addLayout(cuts("order"), 0, 0, 1, 2)
        table.addLayout(files("dxf_version"), 0, 2, 1, 2)
        table.addLayout(cuts("style"), 1, 0, 1, 2)  # a row of its own, that pieces on pins have not
        table.addLayout(cuts("tabs"), 1, 2)
        table.addLayout(cuts("tab_mm"), 1, 3)
        table.addLayout(files("profile"), 2, 0, 1, 4)
        table.addLayout(cuts("copies"), 3, 0)
        table.addLayout(cuts("copy_gap_mm"), 3, 1)
        table.addWidget(self.rows, 3, 2, 1, 2, Qt.AlignmentFlag.AlignBottom)
        table.addLayout(files("paper"), 4, 0, 1, 2, Qt.AlignmentFlag.AlignBottom)
        marks = QVBoxLayout()
        marks.setSpacing(4)
        marks.addWidget(self.engrave)
        marks.addWidget(self.markers)
        table.addLayout(marks, 4, 2, 1, 2, Qt.AlignmentFlag.AlignBottom)
        table.addLayout(files("second_material"), 5, 0, 1, 4)
        elsewhere = ("width_mm", "connector_mm", "kerf_mm", "construction")  # above, in the panel
        for line, row in enumerate([*self.cuts.remaining(), *self.files.remaining(elsewhere)], 6):
            table.addLayout(row, line, 0, 1, 4)
        for column in range(4):
            table.setColumnStretch(column, 1)

    def _connect(self) -> None:
        self.cuts.changed.connect(self.options_changed)
        self.files.changed.connect(self.changed)
        for form in (self.cuts, self.files):
            form.edited.connect(self.edited)

    def show_settings(self, settings: FabricationSettings) -> None:
        """Show the document's choices without reporting them as gestures."""
        self.cuts.show_settings(settings.options)
        self.files.show_settings(settings)
        self._show_pins(settings)
        self.tab_mm.setEnabled(settings.options.tabs > 0)
        self.copy_gap.setEnabled(settings.options.copies != 1)

    def _show_pins(self, settings: FabricationSettings) -> None:
        """Offer what pinned and backed sheets have, with its sizes, where the sheet is one."""
        try:
            construction, sizes = construction_for(settings), pin_sizes(settings)
        except KirigamiError:  # its material is gone, or its ears are; the plan says so
            return
        self.files.show({"pin_mm": sizes.hole_mm, "ear_mm": sizes.ear_mm, "clearance_mm": sizes.clearance_mm})
        pinned = construction is Construction.PINNED
        self.cuts.offer(("style", "tabs", "tab_mm"), not is_pinned(settings))  # sheets alone have connectors
        for names, offered in (
            (("fastener", "moved_by"), pinned),
            (("held_when",), settings.held_by is not HoldKind.NONE),
            (("magnet_mm", "magnet_height_mm"), settings.held_by is HoldKind.MAGNETS),
            (("pin_mm", "ear_mm", "clearance_mm"), pinned or construction is Construction.PRINTED),
            (("gap_mm", "second_material", "board_cut"), construction is Construction.BACKED),
        ):
            self.files.offer(names, offered)
