"""From design to cut file: material, widths in mm, live numbers, export."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QSignalBlocker, QSize, Qt, Signal
from PySide6.QtWidgets import (
    QComboBox,
    QDoubleSpinBox,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSizePolicy,
    QWidget,
)

from kirigami_studio.fabricate.material import presets
from kirigami_studio.gui import icons
from kirigami_studio.gui.panels.card import Card, captioned, compact, muted_label
from kirigami_studio.gui.theme import Palette
from kirigami_studio.project.settings import FabricationSettings

if TYPE_CHECKING:
    from kirigami_studio.gui.jobs.steps import Planned

#: Field, label, lowest, highest, step (mm), decimals, tooltip.
LENGTHS = (
    (
        "width_mm",
        "&Width, mm",
        5.0,
        3000.0,
        5.0,
        1,
        "Width of the flat sheet, mm (5 to 3000); the height follows the grid.",
    ),
    ("connector_mm", "&Connector, mm", 0.02, 20.0, 0.05, 2, "Finished width of the material left at each hinge, mm."),
    (
        "kerf_mm",
        "&Kerf, mm",
        0.0,
        5.0,
        0.01,
        3,
        "Full width of the cut, mm; the slits are shortened for it. 0 for a blade.",
    ),
)
#: Key and label of the live numbers, in reading order.
NUMBERS = (
    ("size", "Sheet"),
    ("slits", "Cuts"),
    ("length", "Cut length"),
    ("time", "Time"),
    ("pieces", "Pieces"),
    ("ligament", "Min. ligament"),
)

UNKNOWN = "\N{EN DASH}"
TIMES = "\N{MULTIPLICATION SIGN}"


class FabricationPanel(Card):
    """Reports changed fields by name and shows the plan that they lead to."""

    changed = Signal(dict)  #: field of FabricationSettings -> value
    edited = Signal()
    export_wanted = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__("Fabrication", parent)
        self._presets = presets()
        self.material = QComboBox()
        self.material.setObjectName("material")
        self.material.setAccessibleName("Material preset")
        self.material.setMinimumContentsLength(8)
        self.material.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.material.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        for key, material in self._presets.items():
            self.material.addItem(material.name, key)
        self.material.activated.connect(self._take_material)
        self.lengths = {row[0]: self._length(*row) for row in LENGTHS}
        self.numbers = {key: QLabel(UNKNOWN) for key, _ in NUMBERS}
        self.warnings = muted_label()
        self.warnings.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.warnings.setMinimumHeight(2 * self.warnings.fontMetrics().lineSpacing() + 2)
        self.warnings.setAlignment(Qt.AlignmentFlag.AlignTop)
        self.export = QPushButton("Export DXF")
        self.export.setObjectName("primary")
        self.export.setIconSize(QSize(18, 18))
        self.export.setToolTip("Write the cut file in mm, DXF R2010, and check it (Ctrl+E)")
        self.export.clicked.connect(self.export_wanted)
        self._lay_out()
        self.body.addWidget(self.warnings)
        self.body.addWidget(self.export)
        self.show_plan(None)

    def _length(
        self, field: str, label: str, low: float, high: float, step: float, digits: int, tip: str
    ) -> QDoubleSpinBox:
        box = QDoubleSpinBox()
        box.setObjectName(field)
        box.setRange(low, high)
        box.setSingleStep(step)
        box.setDecimals(digits)
        box.setToolTip(tip)
        box.setAccessibleName(label.replace("&", "").replace(", mm", " in millimetres"))
        box.setKeyboardTracking(False)
        compact(box, 92)
        box.valueChanged.connect(lambda value: self.changed.emit({field: value}))
        box.editingFinished.connect(self.edited)
        return box

    def _lay_out(self) -> None:
        self.body.addLayout(captioned("&Material", self.material, self.material))
        row = QHBoxLayout()
        row.setSpacing(8)
        for field, label, *_ in LENGTHS:
            row.addLayout(captioned(label, self.lengths[field], self.lengths[field]), 1)
        self.body.addLayout(row)
        table = QGridLayout()
        table.setHorizontalSpacing(8)
        table.setVerticalSpacing(1)
        for place, (key, label) in enumerate(NUMBERS):
            line, column = divmod(place, 3)
            caption = QLabel(label)
            caption.setObjectName("muted")
            self.numbers[key].setObjectName("number")
            self.numbers[key].setAccessibleName(label)
            table.addWidget(caption, 3 * line, column)
            table.addWidget(self.numbers[key], 3 * line + 1, column)
            for part in (caption, self.numbers[key]):
                part.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        table.setRowMinimumHeight(2, 5)
        for column, stretch in enumerate((12, 9, 11)):
            table.setColumnStretch(column, stretch)
        self.body.addSpacing(2)
        self.body.addLayout(table)

    def _take_material(self, index: int) -> None:
        """A new material brings its own connector and kerf."""
        self.changed.emit({"material": self.material.itemData(index), "connector_mm": None, "kerf_mm": None})
        self.edited.emit()

    def show_settings(self, settings: FabricationSettings) -> None:
        """Show the document's numbers, the material's own where it holds none."""
        material = self._presets.get(settings.material)
        with QSignalBlocker(self.material):
            if material is None and self.material.findData(settings.material) < 0:
                self.material.addItem(settings.material, settings.material)
            self.material.setCurrentIndex(self.material.findData(settings.material))
        if material is not None:
            self.material.setToolTip(f"{material.machine}, {material.thickness_mm:g} mm. {material.note}")
        own = {
            "width_mm": settings.width_mm,
            "connector_mm": settings.connector_mm or (material.connector_mm if material else 0.0),
            "kerf_mm": settings.kerf_mm if settings.kerf_mm is not None else (material.kerf_mm if material else 0.0),
        }
        for field, value in own.items():
            with QSignalBlocker(self.lengths[field]):
                self.lengths[field].setValue(value)

    def show_plan(self, planned: Planned | None) -> None:
        """Show what the plan amounts to; None when there is no design."""
        self.export.setEnabled(planned is not None)
        if planned is None:
            for label in self.numbers.values():
                label.setText(UNKNOWN)
            self._warn("Choose a design to see its cut plan.", calm=True)
            return
        plan, report = planned.plan, planned.report
        texts = {
            "size": f"{plan.size_mm[0]:.0f} {TIMES} {plan.size_mm[1]:.0f} mm",
            "slits": f"{len(plan.paths)}",
            "length": readable_length(plan.cut_length_mm),
            "time": readable_time(plan.seconds_estimate),
            "pieces": f"{report.pieces}",
            "ligament": f"{report.min_ligament_mm:.2f} mm",
        }
        for key, text in texts.items():
            self.numbers[key].setText(text)
        found = [*(problem.text for problem in report.problems), *plan.notes]
        self._warn("\n".join(found) if found else "The cut check found no problem.", calm=not found)

    def show_refusal(self, sentence: str) -> None:
        """Say why no plan can be made with these numbers."""
        self.export.setEnabled(False)
        for label in self.numbers.values():
            label.setText(UNKNOWN)
        self._warn(sentence, calm=False)

    def _warn(self, text: str, calm: bool) -> None:
        first, *more = text.split("\n")
        self.warnings.setText(f"{first}  (+{len(more)} more)" if more else first)
        self.warnings.setToolTip(text)
        self.warnings.setObjectName("muted" if calm else "warning")
        self.warnings.style().unpolish(self.warnings)
        self.warnings.style().polish(self.warnings)

    def set_palette(self, palette: Palette) -> None:
        """Draw in other colours."""
        self.export.setIcon(icons.icon("export", palette, palette.on_accent))


def readable_length(mm: float) -> str:
    """Millimetres up to a metre, then metres."""
    return f"{mm:.0f} mm" if mm < 1000 else f"{mm / 1000:.2f} m"


def readable_time(seconds: float) -> str:
    """Seconds up to two minutes, then minutes."""
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.1f} min"
