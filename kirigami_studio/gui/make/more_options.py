"""Choices about the cuts that most sheets leave as they are: connector style, order, tabs, what files are for."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QCheckBox, QGridLayout, QSpinBox, QVBoxLayout, QWidget

from kirigami_studio.export.paper import Paper
from kirigami_studio.export.profile import PROFILES
from kirigami_studio.fabricate.options import AS_MANY_AS_FIT, MOST_COPIES, MOST_TABS, ConnectorStyle, CutOrder
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.widgets.card import ElidedLabel, ToolButton, captioned, compact
from kirigami_studio.gui.widgets.choice_box import ChoiceBox
from kirigami_studio.gui.widgets.number_field import LengthField
from kirigami_studio.project.settings import FabricationSettings

#: Value, label, what it means.
STYLES = (
    (
        ConnectorStyle.CENTRED,
        mark("Centred"),
        mark("The cut that a slit ends on makes way, so that the connector turns exactly on its corner."),
    ),
    (ConnectorStyle.STRAIGHT, mark("Straight"), mark("The slit ends in a plain tip.")),
    (ConnectorStyle.ROUND, mark("Round"), mark("A round hole at the slit's end relieves stress.")),
    (ConnectorStyle.TEARDROP, mark("Teardrop"), mark("A drop-shaped hole at the slit's end: rounded, with no step.")),
    (ConnectorStyle.ARC, mark("Arc"), mark("A short arc across the slit's end guides the connector.")),
    (ConnectorStyle.DOUBLE, mark("Double"), mark("Two narrow connectors side by side that twist like a hinge.")),
)
ORDERS = (
    (CutOrder.SHORTEST, mark("Shortest way"), mark("The shortest travel found.")),
    (CutOrder.ROWS, mark("Row by row"), mark("Rows from one side to the other.")),
    (CutOrder.INSIDE_OUT, mark("Inside out"), mark("From the middle outwards; keeps the sheet flat longest.")),
    (CutOrder.SPREAD, mark("Spread"), mark("Successive cuts far apart, to spread the heat.")),
)
VERSIONS = (
    ("R2010", "R2010", mark("Recommended. Stores mm as the unit and uses light polylines.")),
    ("R12", "R12", mark("For old software. Stores no unit: import as mm.")),
)
PAPER_CHOICES = (
    (Paper.NONE, mark("One page"), mark("As large as the sheet, for plotters and print shops.")),
    ("a4", mark("A4 pages"), mark("Spread over A4 pages that overlap, with crosses to lay them over.")),
    (
        "letter",
        mark("Letter pages"),
        mark("Spread over Letter pages that overlap, with crosses to lay them over."),
    ),
)
PROFILE_TIP = mark("Machine profile: the colours and layers your machine's software expects in cut files.")


class MoreOptions(QWidget):
    """Reports each changed field by name; folded away until asked for."""

    options_changed = Signal(dict)  #: field of CutOptions -> value
    changed = Signal(dict)  #: field of FabricationSettings -> value
    edited = Signal()  #: a number was left

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.fold = ToolButton(
            "moreOptions", "down", tr("More options: connector style, order, tabs, copies, machine, DXF version.")
        )
        self.fold.setText(tr("More options"))
        self.fold.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.fold.setCheckable(True)
        self.style_ = ChoiceBox("connectorStyle", tr("Connector style"), STYLES)
        self.order = ChoiceBox("cutOrder", tr("Cutting order"), ORDERS)
        self.profile = ChoiceBox(
            "machineProfile",
            tr("Machine profile"),
            tuple((key, one.name, one.note.text if one.note else "") for key, one in PROFILES.items()),
        )
        self.profile.setToolTip(tr(PROFILE_TIP))
        self.dxf_version = ChoiceBox("dxfVersion", tr("DXF version"), VERSIONS)
        self.tabs = QSpinBox()
        self.tabs.setObjectName("tabs")
        self.tabs.setRange(0, MOST_TABS)
        self.tabs.setSpecialValueText(tr("Off"))
        self.tabs.setAccessibleName(tr("Number of tabs"))
        self.tabs.setToolTip(
            tr(
                "Uncut bridges in the outline that hold the sheet until you remove it (0 to {most}).",
                most=MOST_TABS,
            )
        )
        self.tab_mm = LengthField()
        self.tab_mm.setObjectName("tabWidth")
        self.tab_mm.setRange(0.05, 20.0)
        self.tab_mm.setSingleStep(0.1)
        self.tab_mm.setDecimals(2)
        self.tab_mm.setAccessibleName(tr("Tab width in millimetres"))
        self.tab_mm.setToolTip(tr("Finished width of a tab, mm (0.05 to 20)."))
        self.copies = QSpinBox()
        self.copies.setObjectName("copies")
        self.copies.setRange(AS_MANY_AS_FIT, MOST_COPIES)
        self.copies.setSpecialValueText(tr("Fit bed"))
        self.copies.setAccessibleName(tr("Number of copies"))
        self.copies.setToolTip(
            tr(
                "Copies of the sheet in one file, in rows (1 to {most}); below 1: as many as fit on the "
                "material's bed.",
                most=MOST_COPIES,
            )
        )
        self.copy_gap = LengthField()
        self.copy_gap.setObjectName("copyGap")
        self.copy_gap.setRange(0.1, 500.0)
        self.copy_gap.setSingleStep(1.0)
        self.copy_gap.setDecimals(1)
        self.copy_gap.setAccessibleName(tr("Gap between copies in millimetres"))
        self.copy_gap.setToolTip(tr("Gap between the cuts of neighbouring copies, mm (0.1 to 500)."))
        self.paper = ChoiceBox("paper", tr("PDF pages"), PAPER_CHOICES)
        self.markers = QCheckBox(tr("Mark connectors"))
        self.markers.setObjectName("markers")
        self.markers.setToolTip(
            tr("Mark connectors in LightBurn projects, on a tool layer: MeerK40t would engrave it.")
        )
        self.engrave = QCheckBox(tr("Engrave the name"))
        self.engrave.setObjectName("engraveName")
        self.engrave.setToolTip(
            tr(
                "Engrave the design's name on one panel, before the cuts and on a layer of its own. Times and lengths "
                "do not count it."
            )
        )
        self.rows = ElidedLabel()
        self.rows.setObjectName("muted")
        self.rows.setFixedHeight(self.copies.sizeHint().height())  # beside the numbers, not beside their captions
        self.rows.setAccessibleName(tr("Rows of copies"))
        self.content = QWidget()
        self.content.setObjectName("plain")
        self._lay_out()
        self._connect()
        self.content.hide()

    def _lay_out(self) -> None:
        table = QGridLayout(self.content)
        table.setContentsMargins(0, 0, 0, 0)
        table.setHorizontalSpacing(8)
        table.setVerticalSpacing(6)
        table.addLayout(captioned(tr("Connector st&yle"), self.style_, self.style_), 0, 0, 1, 2)
        table.addLayout(captioned(tr("&Order"), self.order, self.order), 0, 2, 1, 2)
        table.addLayout(captioned(tr("&Tabs"), self.tabs, self.tabs), 1, 0)
        table.addLayout(captioned(tr("Tab, mm"), self.tab_mm, self.tab_mm), 1, 1)
        table.addLayout(captioned(tr("D&XF version"), self.dxf_version, self.dxf_version), 1, 2, 1, 2)
        table.addLayout(captioned(tr("Machine profile"), self.profile, self.profile), 2, 0, 1, 4)
        table.addLayout(captioned(tr("Copies"), self.copies, self.copies), 3, 0)
        table.addLayout(captioned(tr("Gap, mm"), self.copy_gap, self.copy_gap), 3, 1)
        table.addWidget(self.rows, 3, 2, 1, 2, Qt.AlignmentFlag.AlignBottom)
        table.addLayout(captioned(tr("PDF pages"), self.paper, self.paper), 4, 0, 1, 2)
        marks = QVBoxLayout()
        marks.setSpacing(4)
        marks.addWidget(self.engrave)
        marks.addWidget(self.markers)
        table.addLayout(marks, 4, 2, 1, 2, Qt.AlignmentFlag.AlignBottom)
        for column in range(4):
            table.setColumnStretch(column, 1)
        whole = QVBoxLayout(self)
        whole.setContentsMargins(0, 0, 0, 0)
        whole.setSpacing(6)
        whole.addWidget(self.fold, 0, Qt.AlignmentFlag.AlignLeft)
        whole.addWidget(self.content)

    def _connect(self) -> None:
        self.fold.toggled.connect(self._show_content)
        for name, box in (("style", self.style_), ("order", self.order)):
            box.activated.connect(lambda _, name=name, box=box: self.options_changed.emit({name: box.currentData()}))
        self.markers.clicked.connect(lambda on: self.changed.emit({"markers": on}))
        self.engrave.clicked.connect(lambda on: self.changed.emit({"engrave": on}))
        for name, box in (("profile", self.profile), ("dxf_version", self.dxf_version), ("paper", self.paper)):
            box.activated.connect(lambda _, name=name, box=box: self.changed.emit({name: box.currentData()}))
        self.tabs.valueChanged.connect(lambda value: self.options_changed.emit({"tabs": value}))
        self.tab_mm.valueChanged.connect(lambda value: self.options_changed.emit({"tab_mm": value}))
        self.copies.valueChanged.connect(lambda value: self.options_changed.emit({"copies": value}))
        self.copy_gap.valueChanged.connect(lambda value: self.options_changed.emit({"copy_gap_mm": value}))
        for number in (self.tabs, self.tab_mm, self.copies, self.copy_gap):
            number.setKeyboardTracking(False)
            compact(number, 62)
            number.editingFinished.connect(self.edited)

    def show_settings(self, settings: FabricationSettings) -> None:
        """Show the document's choices without reporting them as gestures."""
        options = settings.options
        for box, value in (
            (self.style_, options.style),
            (self.order, options.order),
            (self.profile, settings.profile),
            (self.dxf_version, settings.dxf_version),
            (self.paper, settings.paper),
        ):
            with QSignalBlocker(box):
                box.choose(value)
        with QSignalBlocker(self.tabs), QSignalBlocker(self.tab_mm):
            self.tabs.setValue(options.tabs)
            self.tab_mm.setValue(options.tab_mm)
        self.tab_mm.setEnabled(options.tabs > 0)
        self.markers.setChecked(settings.markers)
        self.engrave.setChecked(settings.engrave)
        with QSignalBlocker(self.copies), QSignalBlocker(self.copy_gap):
            self.copies.setValue(options.copies)
            self.copy_gap.setValue(options.copy_gap_mm)
        self.copy_gap.setEnabled(options.copies != 1)

    def _show_content(self, shown: bool) -> None:
        self.content.setVisible(shown)
        self.fold.show_icon("up" if shown else "down")
