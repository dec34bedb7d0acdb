"""The numbers of one material, or of one machine, as a form, made from a table."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QFormLayout, QHBoxLayout, QLabel, QLineEdit, QPushButton, QWidget

from kirigami_studio.fabricate.coupon import kerf_from_gaps
from kirigami_studio.fabricate.machine import Machine
from kirigami_studio.fabricate.material import Material
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.foundation.settings import NamedSetting
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.widgets.form import Form, spoken
from kirigami_studio.gui.widgets.number_field import DecimalField, LengthField, names_length

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
    "join_tolerance_mm",
)


class ValueForm(QWidget):
    """Shows one value of a shelf; the user's own can be edited.

    Parameters
    ----------
    kind : type
        Material or Machine.
    prefix : str
        Of the object names of its fields.
    texts, numbers, wholes : sequence of str
        Names of its fields, in the order of the form.
    """

    changed = Signal()

    def __init__(
        self,
        kind: type,
        prefix: str,
        texts: Sequence[str],
        numbers: Sequence[str],
        wholes: Sequence[str] = (),
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self._shown: Any = None
        self._editable = False
        self.fields = Form(kind, None, prefix, self)
        self.texts = {name: _text(self.fields.settings[name], prefix) for name in texts}
        self.numbers = {name: self._number(name) for name in numbers}
        self.wholes = {name: self.fields.whole(name) for name in wholes}
        self.fields.changed.connect(lambda _: self.changed.emit())
        form = QFormLayout(self)
        form.setContentsMargins(0, 0, 6, 0)
        form.setVerticalSpacing(5)
        form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
        rows: dict[str, QWidget] = {**self.texts, **self.numbers, **self.wholes}
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
        if isinstance(box, LengthField):
            names_length(box)
        about = tr(one.setting.about)
        box.setToolTip(tr("{tip} Unit: {unit}, {low:g} to {high:g}.", tip=about, unit=unit, **one.numbers))
        return box

    def show_value(self, value: Material | Machine, editable: bool) -> None:
        """Show another material or machine."""
        self._shown, self._editable = value, editable
        values = asdict(value)
        for field, line in self.texts.items():
            line.setText(values[field] if editable else tr(values[field]))  # bundled ones are told in every language
            line.setCursorPosition(0)
            line.setEnabled(editable)
            line.setToolTip(line.text())
        self.fields.show_settings(value)
        for box in (*self.numbers.values(), *self.wholes.values()):
            box.setEnabled(editable)

    def changes(self) -> dict[str, object]:
        """Return the fields that differ from the value shown; none of one that cannot be edited."""
        if self._shown is None or not self._editable:
            return {}
        values = asdict(self._shown)
        entries: dict[str, object] = {field: line.text().strip() for field, line in self.texts.items()}
        found = {field: entry for field, entry in entries.items() if entry != values[field]}
        for name, box in self.numbers.items():
            scale = self.fields.settings[name].setting.scale
            if abs(box.value() - scale * values[name]) > 0.6 * 10.0 ** -box.decimals():
                found[name] = round(box.value() / scale, 9)
        found |= {name: box.value() for name, box in self.wholes.items() if box.value() != values[name]}
        return found


class MaterialForm(ValueForm):
    """Shows one material; the user's own can be edited."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(Material, "material_", TEXTS, NUMBERS, ("passes",), parent)


def _text(one: NamedSetting, prefix: str) -> QLineEdit:
    line = QLineEdit()
    line.setObjectName(prefix + one.name)
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
