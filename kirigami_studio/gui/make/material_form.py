"""The numbers of one material as a form, made from a table."""

from __future__ import annotations

import re
from dataclasses import asdict

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QFormLayout, QHBoxLayout, QLabel, QLineEdit, QPushButton, QWidget

from kirigami_studio.fabricate.coupon import kerf_from_gaps
from kirigami_studio.fabricate.material import Material
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.foundation.settings import NamedSetting
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.widgets.form import Form, spoken
from kirigami_studio.gui.widgets.number_field import DecimalField

#: Texts and numbers of a material, in the order of the form.
TEXTS = ("name", "machine", "note")
NUMBERS = (
    "thickness_mm",
    "kerf_mm",
    "connector_mm",
    "sheet_mm",
    "min_ligament_mm",
    "min_slit_mm",
    "min_panel_mm",
    "relief_radius_mm",
    "yield_strain",
    "break_strain",
    "bend_strain",
    "young_gpa",
    "speed_mm_s",
    "power_percent",
    "travel_mm_s",
    "acceleration_mm_s2",
    "on_delay_s",
    "off_delay_s",
    "bed_width_mm",
    "bed_height_mm",
    "join_tolerance_mm",
)


class MaterialForm(QWidget):
    """Shows one material; the user's own can be edited."""

    changed = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._shown: Material | None = None
        self.fields = Form(Material, None, "material_", self)
        self.texts = {name: _text(self.fields.settings[name]) for name in TEXTS}
        self.numbers = {name: self._number(name) for name in NUMBERS}
        self.passes = self.fields.whole("passes")
        self.fields.changed.connect(lambda _: self.changed.emit())
        form = QFormLayout(self)
        form.setContentsMargins(0, 0, 6, 0)
        form.setVerticalSpacing(5)
        form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
        rows: dict[str, QWidget] = {**self.texts, **self.numbers, "passes": self.passes}
        for name, field in rows.items():
            caption = QLabel(tr(self.fields.settings[name].setting.label))
            caption.setObjectName("muted")
            form.addRow(caption, field)
        for line in self.texts.values():
            line.textEdited.connect(self.changed)

    def _number(self, name: str) -> DecimalField:
        one = self.fields.settings[name]
        unit = one.setting.unit
        box = self.fields.decimal(name, f" {unit}")
        box.setAccessibleName(f"{spoken(one)}, {unit}")
        about = tr(one.setting.about)
        box.setToolTip(tr("{tip} Unit: {unit}, {low:g} to {high:g}.", tip=about, unit=unit, **one.numbers))
        return box

    def show_material(self, material: Material, editable: bool) -> None:
        """Show another material."""
        self._shown = material
        values = asdict(material)
        for field, line in self.texts.items():
            line.setText(values[field] if editable else tr(values[field]))  # bundled ones are told in every language
            line.setCursorPosition(0)
            line.setEnabled(editable)
            line.setToolTip(line.text())
        self.fields.show_settings(material)
        for box in (*self.numbers.values(), self.passes):
            box.setEnabled(editable)

    def changes(self) -> dict[str, object]:
        """Return the fields that differ from the material shown; none of one that cannot be edited."""
        if self._shown is None or not self.passes.isEnabled():
            return {}
        values = asdict(self._shown)
        entries: dict[str, object] = {field: line.text().strip() for field, line in self.texts.items()}
        found = {field: entry for field, entry in entries.items() if entry != values[field]}
        for name, box in self.numbers.items():
            scale = self.fields.settings[name].setting.scale
            if abs(box.value() - scale * values[name]) > 0.6 * 10.0 ** -box.decimals():
                found[name] = round(box.value() / scale, 9)
        if self.passes.value() != self._shown.passes:
            found["passes"] = self.passes.value()
        return found


def _text(one: NamedSetting) -> QLineEdit:
    line = QLineEdit()
    line.setObjectName(f"material_{one.name}")
    line.setAccessibleName(spoken(one))
    line.setAccessibleDescription(tr(one.setting.about))
    return line


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
