"""The numbers of one material as a form, made from a table."""

from __future__ import annotations

import re
from dataclasses import asdict, dataclass

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QFormLayout, QHBoxLayout, QLabel, QLineEdit, QPushButton, QSpinBox, QWidget

from kirigami_studio.fabricate.coupon import kerf_from_gaps
from kirigami_studio.fabricate.material import Material
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.widgets.number_field import DecimalField, LengthField, number_field


@dataclass(frozen=True, slots=True)
class Number:
    """One row of the table: a field of Material that is a length, a speed, a time or a share."""

    field: str
    label: str
    unit: str
    low: float
    high: float
    step: float
    decimals: int
    tip: str
    scale: float = 1.0  #: shown = scale * kept


NUMBERS = (
    Number("thickness_mm", mark("Thickness"), "mm", 0.005, 50.0, 0.05, 3, mark("Sheet thickness.")),
    Number("kerf_mm", mark("Kerf"), "mm", 0.0, 5.0, 0.01, 3, mark("Full width of the cut; 0 for a blade.")),
    Number("connector_mm", mark("Connector"), "mm", 0.02, 20.0, 0.05, 3, mark("Default finished connector width.")),
    Number(
        "min_ligament_mm",
        mark("Smallest ligament"),
        "mm",
        0.005,
        20.0,
        0.01,
        3,
        mark("Warn about ligaments narrower than this."),
    ),
    Number("min_slit_mm", mark("Shortest slit"), "mm", 0.005, 20.0, 0.05, 3, mark("Shortest slit for this material.")),
    Number(
        "min_panel_mm", mark("Smallest panel"), "mm", 0.0, 100.0, 0.5, 3, mark("Warn about panels narrower than this.")
    ),
    Number(
        "relief_radius_mm",
        mark("Relief radius"),
        "mm",
        0.0,
        5.0,
        0.05,
        3,
        mark("Radius of the relief hole at a slit's end."),
    ),
    Number(
        "strain_limit",
        mark("Breaking strain"),
        "%",
        0.01,
        500.0,
        0.5,
        2,
        mark("Strain at which the material breaks."),
        100.0,
    ),
    Number("young_gpa", mark("Stiffness"), "GPa", 0.0001, 1000.0, 0.5, 4, mark("Young's modulus of the material.")),
    Number("speed_mm_s", mark("Cutting speed"), "mm/s", 0.01, 10_000.0, 5.0, 2, mark("Speed with the beam on.")),
    Number("power_percent", mark("Power"), "%", 0.0, 100.0, 5.0, 1, mark("Laser power while cutting; 0 for a blade.")),
    Number("travel_mm_s", mark("Travel speed"), "mm/s", 0.01, 20_000.0, 20.0, 2, mark("Speed between cuts.")),
    Number(
        "acceleration_mm_s2",
        mark("Acceleration"),
        "mm/s²",
        0.1,
        200_000.0,
        100.0,
        1,
        mark("How fast the head accelerates."),
    ),
    Number(
        "on_delay_s", mark("Delay before a cut"), "ms", 0.0, 10_000.0, 5.0, 1, mark("Pause before each cut."), 1000.0
    ),
    Number(
        "off_delay_s", mark("Delay after a cut"), "ms", 0.0, 10_000.0, 5.0, 1, mark("Pause after each cut."), 1000.0
    ),
    Number(
        "bed_width_mm", mark("Bed width"), "mm", 0.0, 5000.0, 10.0, 1, mark("Width that the machine reaches; 0: any.")
    ),
    Number(
        "bed_height_mm",
        mark("Bed height"),
        "mm",
        0.0,
        5000.0,
        10.0,
        1,
        mark("Height that the machine reaches; 0: any."),
    ),
    Number(
        "join_tolerance_mm",
        mark("Joins gaps below"),
        "mm",
        0.0,
        2.0,
        0.01,
        3,
        mark("Gaps that the machine software may close."),
    ),
)
TEXTS = (
    ("name", mark("Name"), mark("Name shown in the material list.")),
    ("machine", mark("Machine"), mark("Machine these values were measured on.")),
    ("note", mark("Note"), mark("Anything worth knowing.")),
)


class MaterialForm(QWidget):
    """Shows one material; the user's own can be edited."""

    changed = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._shown: Material | None = None
        self.texts = {field: _text(field, label, tip) for field, label, tip in TEXTS}
        self.numbers = {number.field: _number(number) for number in NUMBERS}
        self.passes = QSpinBox()
        self.passes.setObjectName("passes")
        self.passes.setRange(1, 100)
        number_field(self.passes)
        self.passes.setAccessibleName(tr("Passes"))
        self.passes.setToolTip(tr("How many times the job is cut (1 to 100)."))
        form = QFormLayout(self)
        form.setContentsMargins(0, 0, 6, 0)
        form.setVerticalSpacing(5)
        form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
        for field, label, _ in TEXTS:
            form.addRow(_caption(tr(label)), self.texts[field])
            self.texts[field].textEdited.connect(self.changed)
        for number in NUMBERS:
            form.addRow(_caption(tr(number.label)), self.numbers[number.field])
            self.numbers[number.field].valueChanged.connect(self.changed)
        form.addRow(_caption(tr("Passes")), self.passes)
        self.passes.valueChanged.connect(self.changed)

    def show_material(self, material: Material, editable: bool) -> None:
        """Show another material."""
        self._shown = material
        values = asdict(material)
        for field, line in self.texts.items():
            line.setText(values[field] if editable else tr(values[field]))  # bundled ones are told in every language
            line.setCursorPosition(0)
            line.setEnabled(editable)
            line.setToolTip(line.text())
        for number in NUMBERS:
            box = self.numbers[number.field]
            with QSignalBlocker(box):
                box.setValue(number.scale * values[number.field])
            box.setEnabled(editable)
        with QSignalBlocker(self.passes):
            self.passes.setValue(material.passes)
        self.passes.setEnabled(editable)

    def changes(self) -> dict[str, object]:
        """Return the fields that differ from the material shown; none of one that cannot be edited."""
        if self._shown is None or not self.passes.isEnabled():
            return {}
        values = asdict(self._shown)
        entries: dict[str, object] = {field: line.text().strip() for field, line in self.texts.items()}
        found = {field: entry for field, entry in entries.items() if entry != values[field]}
        for number in NUMBERS:
            kept, shown = number.scale * values[number.field], self.numbers[number.field].value()
            if abs(shown - kept) > 0.6 * 10.0**-number.decimals:
                found[number.field] = round(shown / number.scale, 9)
        if self.passes.value() != self._shown.passes:
            found["passes"] = self.passes.value()
        return found


def _caption(text: str) -> QLabel:
    caption = QLabel(text)
    caption.setObjectName("muted")
    return caption


def _text(field: str, label: str, tip: str) -> QLineEdit:
    line = QLineEdit()
    line.setObjectName(f"material_{field}")
    line.setAccessibleName(tr(label))
    line.setAccessibleDescription(tr(tip))
    return line


def _number(number: Number) -> DecimalField:
    box = LengthField() if number.unit == "mm" else DecimalField()
    box.setObjectName(f"material_{number.field}")
    box.setRange(number.low, number.high)
    box.setSingleStep(number.step)
    box.setDecimals(number.decimals)
    box.setSuffix(f" {number.unit}")
    number_field(box)
    box.setKeyboardTracking(False)
    box.setAccessibleName(f"{tr(number.label)}, {number.unit}")
    box.setToolTip(
        tr(
            "{tip} Unit: {unit}, {low:g} to {high:g}.",
            tip=tr(number.tip),
            unit=number.unit,
            low=number.low,
            high=number.high,
        )
    )
    return box


class GapRow(QWidget):
    """A field for the gaps measured at the coupon's comb, and a button that computes the kerf."""

    measured = Signal(float, str)  #: kerf in mm, sentence about it
    refused = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.gaps = QLineEdit()
        self.gaps.setObjectName("material_gaps")
        self.gaps.setPlaceholderText(tr("Gaps, mm: 0.29 0.31"))
        self.gaps.setAccessibleName(tr("Gaps beside the coupon's comb in millimetres"))
        self.gaps.setToolTip(
            tr(
                "Push all fingers of the coupon's comb to one side and measure the gap in mm. "
                "Separate several readings with spaces."
            )
        )
        self.button = QPushButton(tr("Set &kerf"))
        self.button.setObjectName("material_kerf_from_gaps")
        self.button.setAutoDefault(False)
        self.button.setToolTip(tr("Calculate this material's kerf from the measured gaps."))
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.gaps, 1)
        row.addWidget(self.button)
        self.gaps.textChanged.connect(lambda _: self.allow(self.gaps.isEnabled()))
        self.gaps.returnPressed.connect(self.take)
        self.button.clicked.connect(self.take)

    def allow(self, editable: bool) -> None:
        """Whether the chosen material may be changed."""
        self.gaps.setEnabled(editable)
        self.button.setEnabled(editable and bool(self.gaps.text().strip()))

    def take(self) -> None:
        """Compute the kerf from the gaps, or report why that is not possible."""
        words = re.split(r"[\s;]+", self.gaps.text().strip())
        try:
            found = kerf_from_gaps([float(word.replace(",", ".")) for word in words])
        except ValueError:
            self.refused.emit(tr("Enter gaps in mm separated by spaces, such as 0.29 0.31."))
        except FabricationError as error:
            self.refused.emit(str(error))
        else:
            if found.doubt_mm:
                sentence = tr(
                    "Kerf {kerf:.3f} ± {doubt:.3f} mm. Save to keep it.", kerf=found.kerf_mm, doubt=found.doubt_mm
                )
            else:
                sentence = tr("Kerf {kerf:.3f} mm. Save to keep it.", kerf=found.kerf_mm)
            self.measured.emit(found.kerf_mm, sentence)
