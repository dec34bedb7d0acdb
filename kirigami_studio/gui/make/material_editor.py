"""The material editor: copy a preset, edit it, mark it as calibrated, delete it, export its coupon."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from datetime import date
from typing import Any

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import (
    QDialog,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

from kirigami_studio.fabricate import material_copies
from kirigami_studio.fabricate.material import Library, Material, library
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.make.material_form import TEXTS, GapRow, MaterialForm

SIZE = QSize(820, 560)
NEW = mark("Presets are read-only. Copy one to change it.")


class MaterialEditor(QDialog):
    """A list of all materials beside the form of the chosen one."""

    materials_changed = Signal()  #: one was saved or deleted
    coupon_wanted = Signal(Material)

    def __init__(self, parent: QWidget, key: str) -> None:
        super().__init__(parent)
        self.setObjectName("materialEditor")
        self.setWindowTitle(tr("Materials"))
        self.setModal(False)
        self.resize(SIZE)
        self._library: Library = library()
        self.list = QListWidget()
        self.list.setAccessibleName(tr("Materials"))
        self.list.setObjectName("materialList")
        self.list.setFixedWidth(300)
        self.list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.list.setTextElideMode(Qt.TextElideMode.ElideRight)
        self.form = MaterialForm()
        self.state, self.status = QLabel(), QLabel(tr(NEW))
        for label in (self.state, self.status):
            label.setWordWrap(True)
        self.status.setObjectName("muted")
        self.gaps = GapRow()
        self.author = QLineEdit()
        self.author.setAccessibleName(tr("Measured by"))
        self.author.setPlaceholderText(tr("Measured by …"))
        self.author.setToolTip(tr("Who measured the coupon."))
        self.buttons = {
            name: _button(name, text, tip)
            for name, text, tip in (
                ("copy", tr("C&opy"), tr("Make an editable copy of this material.")),
                ("delete", tr("&Delete"), tr("Delete this material. Presets cannot be deleted.")),
                ("coupon", tr("Export &coupon …"), tr("Export a test piece for measuring kerf and smallest ligament.")),
                ("save", tr("&Save"), tr("Save the values. Changed values are marked as uncalibrated.")),
                (
                    "calibrate",
                    tr("&Mark as calibrated"),
                    tr("Record that these values were measured today on a coupon."),
                ),
            )
        }
        self._lay_out()
        self._connect()
        self._list(key)

    def _lay_out(self) -> None:
        scrolled = QScrollArea()
        scrolled.setWidgetResizable(True)
        scrolled.setFrameShape(QScrollArea.Shape.NoFrame)
        scrolled.setWidget(self.form)
        left, right, saving = QVBoxLayout(), QVBoxLayout(), QHBoxLayout()
        left.addWidget(self.list, 1)
        pair = QHBoxLayout()
        pair.addWidget(self.buttons["copy"])
        pair.addWidget(self.buttons["delete"])
        left.addLayout(pair)
        left.addWidget(self.buttons["coupon"])
        left.addWidget(self.gaps)
        right.addWidget(self.state)
        right.addWidget(scrolled, 1)
        right.addWidget(self.status)
        saving.addWidget(self.buttons["save"])
        saving.addStretch(1)
        saving.addWidget(self.author, 2)
        saving.addWidget(self.buttons["calibrate"])
        right.addLayout(saving)
        whole = QHBoxLayout(self)
        whole.setContentsMargins(14, 14, 14, 14)
        whole.setSpacing(14)
        whole.addLayout(left)
        whole.addLayout(right, 1)

    def _connect(self) -> None:
        self.list.currentItemChanged.connect(self._show)
        self.form.changed.connect(self._show_buttons)
        self.author.textChanged.connect(self._show_buttons)
        self.gaps.measured.connect(self._take_kerf)
        self.gaps.refused.connect(self.status.setText)
        for name, act in (
            ("copy", self.copy),
            ("delete", self.delete),
            ("save", self.save),
            ("calibrate", self.calibrate),
        ):
            self.buttons[name].clicked.connect(lambda _=False, act=act: self._try(act))
        self.buttons["coupon"].clicked.connect(lambda: self.coupon_wanted.emit(self.chosen))

    @property
    def chosen(self) -> Material:
        """The material in the form, as it is saved."""
        item = self.list.currentItem() or self.list.item(0)
        return self._library.materials[item.data(Qt.ItemDataRole.UserRole)]

    def choose(self, key: str) -> None:
        """Show a material by its key."""
        rows = [row for row in range(self.list.count()) if self.list.item(row).data(Qt.ItemDataRole.UserRole) == key]
        self.list.setCurrentRow(rows[0] if rows else 0)

    def copy(self) -> None:
        """Save a copy of the chosen material under a new key."""
        source = self.chosen
        made = material_copies.changed_copy(
            source.key, self._free_key(source.key), {"name": tr("{name} (copy)", name=source.name)}
        )
        material_copies.save_copy(made)
        self._saved(made.key, tr("Copied as {name!r}. Edit its values, then save.", name=made.name))
        self.form.texts["name"].setFocus()

    def save(self) -> None:
        """Save the form; changed numbers count as uncalibrated."""
        made = self._edited()
        material_copies.save_copy(made)
        self._saved(made.key, tr("Saved."))

    def calibrate(self) -> None:
        """Save the form as measured today."""
        made = material_copies.mark_calibrated(self._edited(), date.today(), self.author.text())
        self._saved(made.key, tr("Saved as calibrated."))

    def delete(self) -> None:
        """Delete the chosen own material."""
        key, name = self.chosen.key, self.chosen.name
        material_copies.delete_copy(key)
        self._list(key)
        self.status.setText(tr("Deleted {name!r}.", name=name))
        self.materials_changed.emit()

    def _take_kerf(self, kerf_mm: float, sentence: str) -> None:
        """A coupon was measured; the form holds its kerf until it is saved."""
        self.form.numbers["kerf_mm"].setValue(kerf_mm)
        self.status.setText(sentence)

    def _edited(self) -> Material:
        """The chosen material with the values of the form."""
        material, changes = self.chosen, self.form.changes()
        words = set(TEXTS)
        if changes.keys() <= words:
            texts: dict[str, Any] = {field: str(entry) for field, entry in changes.items()}
            return replace(material, **texts)
        return material_copies.changed_copy(material.key, material.key, changes)

    def _free_key(self, key: str) -> str:
        numbered = (f"{key[:35]}-{number}" for number in range(2, 1000))
        return next(one for one in numbered if one not in self._library.materials)

    def _saved(self, key: str, sentence: str) -> None:
        self._list(key)
        self.status.setText(sentence)
        self.materials_changed.emit()

    def _list(self, key: str) -> None:
        """Read the library again and show a material."""
        self._library = library()
        self.list.clear()
        for one, material in self._library.materials.items():
            item = QListWidgetItem(
                tr("Custom  ·  {name}", name=material.name) if one in self._library.own else tr(material.name)
            )
            item.setData(Qt.ItemDataRole.UserRole, one)
            item.setToolTip(f"{tr(material.name)} ({one})\n{tr(material.machine)}\n{_state(material)}")
            self.list.addItem(item)
        self.choose(key)
        self.status.setText("\n".join(fault.text for fault in self._library.faults) or tr(NEW))

    def _show(self) -> None:
        if self.list.currentItem() is None:
            return
        material = self.chosen
        self.form.show_value(material, material.key in self._library.own)
        self.state.setText(_state(material))
        self._show_buttons()

    def _show_buttons(self) -> None:
        own = self.chosen.key in self._library.own
        self.buttons["delete"].setEnabled(own)
        self.buttons["save"].setEnabled(own and bool(self.form.changes()))
        self.author.setEnabled(own)
        self.gaps.allow(own)
        self.buttons["calibrate"].setEnabled(own and bool(self.author.text().strip()))

    def _try(self, act: Callable[[], None]) -> None:
        """Run an action on files; show the error if it fails."""
        try:
            act()
        except KirigamiError as error:
            self.status.setText(str(error))


def _state(material: Material) -> str:
    """Return in words whether the numbers were measured."""
    if not material.calibrated:
        return tr("Not calibrated: starting values only. Cut a coupon and measure it.")
    by, on = material.measured_by, material.measured_on
    if on and by:
        return tr("Calibrated on {on} by {by}.", on=on, by=by)
    if on:
        return tr("Calibrated on {on}.", on=on)
    return tr("Calibrated by {by}.", by=by) if by else tr("Calibrated.")


def _button(name: str, text: str, tip: str) -> QPushButton:
    button = QPushButton(text)
    button.setObjectName(f"material_{name}")
    button.setToolTip(tip)
    button.setAutoDefault(False)
    return button
