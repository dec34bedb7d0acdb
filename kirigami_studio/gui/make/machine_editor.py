"""The machine editor: copy a bundled machine, enter the numbers of one's own, delete it."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import (
    QDialog,
    QHBoxLayout,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

from kirigami_studio.fabricate.machine import SHELF, Machine, changed_machine, cuttable
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.make.material_form import ValueForm

SIZE = QSize(760, 520)
TEXTS = ("name", "note")
#: Numbers of a machine, in the order of the form.
NUMBERS = (
    "bed_width_mm",
    "bed_height_mm",
    "canvas_width_mm",
    "canvas_height_mm",
    "thickest_mm",
    "largest_speed_mm_s",
    "travel_mm_s",
    "acceleration_mm_s2",
    "on_delay_s",
    "off_delay_s",
    "corner_delay_s",
)
NEW = mark("Bundled machines are read-only. Copy one to change it.")


class MachineEditor(QDialog):
    """A list of all machines beside the form of the chosen one."""

    machines_changed = Signal()  #: one was saved or deleted

    def __init__(self, parent: QWidget, key: str) -> None:
        super().__init__(parent)
        self.setObjectName("machineEditor")
        self.setWindowTitle(tr("Machines"))
        self.setModal(False)
        self.resize(SIZE)
        self._contents = SHELF.contents()
        self.list = QListWidget()
        self.list.setAccessibleName(tr("Machines"))
        self.list.setObjectName("machineList")
        self.list.setFixedWidth(270)
        self.list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.list.setTextElideMode(Qt.TextElideMode.ElideRight)
        self.form = ValueForm(Machine, "machine_", TEXTS, NUMBERS)
        self.about, self.status = QLabel(), QLabel(tr(NEW))
        for label in (self.about, self.status):
            label.setWordWrap(True)
            label.setObjectName("muted")
        self.buttons = {
            name: _button(name, text, tip)
            for name, text, tip in (
                ("copy", tr("C&opy"), tr("Make an editable copy of this machine.")),
                ("delete", tr("&Delete"), tr("Delete this machine. Bundled ones cannot be deleted.")),
                ("save", tr("&Save"), tr("Save the values.")),
            )
        }
        self._lay_out()
        self.list.currentItemChanged.connect(self._show)
        self.form.changed.connect(self._show_buttons)
        for name, act in (("copy", self.copy), ("delete", self.delete), ("save", self.save)):
            self.buttons[name].clicked.connect(lambda _=False, act=act: self._try(act))
        self._list(key)

    def _lay_out(self) -> None:
        scrolled = QScrollArea()
        scrolled.setWidgetResizable(True)
        scrolled.setFrameShape(QScrollArea.Shape.NoFrame)
        scrolled.setWidget(self.form)
        left, right, pair, saving = QVBoxLayout(), QVBoxLayout(), QHBoxLayout(), QHBoxLayout()
        left.addWidget(self.list, 1)
        pair.addWidget(self.buttons["copy"])
        pair.addWidget(self.buttons["delete"])
        left.addLayout(pair)
        right.addWidget(self.about)
        right.addWidget(scrolled, 1)
        right.addWidget(self.status)
        saving.addWidget(self.buttons["save"])
        saving.addStretch(1)
        right.addLayout(saving)
        whole = QHBoxLayout(self)
        whole.setContentsMargins(14, 14, 14, 14)
        whole.setSpacing(14)
        whole.addLayout(left)
        whole.addLayout(right, 1)

    @property
    def chosen(self) -> Machine:
        """The machine in the form, as it is saved."""
        item = self.list.currentItem() or self.list.item(0)
        return self._contents.items[item.data(Qt.ItemDataRole.UserRole)]

    def choose(self, key: str) -> None:
        """Show a machine by its key."""
        rows = [row for row in range(self.list.count()) if self.list.item(row).data(Qt.ItemDataRole.UserRole) == key]
        self.list.setCurrentRow(rows[0] if rows else 0)

    def copy(self) -> None:
        """Save a copy of the chosen machine under a new key."""
        source = self.chosen
        numbered = (f"{source.key[:35]}-{number}" for number in range(2, 1000))
        key = next(one for one in numbered if one not in self._contents.items)
        made = changed_machine(source.key, key, {"name": tr("{name} (copy)", name=tr(source.name))})
        SHELF.save(made)
        self._saved(key, tr("Copied as {name!r}. Edit its values, then save.", name=made.name))
        self.form.texts["name"].setFocus()

    def save(self) -> None:
        """Save the form."""
        machine = self.chosen
        SHELF.save(changed_machine(machine.key, machine.key, self.form.changes()))
        self._saved(machine.key, tr("Saved."))

    def delete(self) -> None:
        """Delete the chosen own machine."""
        machine = self.chosen
        SHELF.delete(machine.key)
        self._saved(machine.key, tr("Deleted {name!r}.", name=machine.name))

    def _saved(self, key: str, sentence: str) -> None:
        self._list(key)
        self.status.setText(sentence)
        self.machines_changed.emit()

    def _list(self, key: str) -> None:
        """Read the machines again and show one."""
        self._contents = SHELF.contents()
        self.list.clear()
        for one, machine in sorted(self._contents.items.items(), key=lambda item: tr(item[1].name).casefold()):
            own = one in self._contents.own
            item = QListWidgetItem(tr("Custom  ·  {name}", name=machine.name) if own else tr(machine.name))
            item.setData(Qt.ItemDataRole.UserRole, one)
            item.setToolTip(f"{tr(machine.name)} ({one})")
            self.list.addItem(item)
        self.choose(key)
        self.status.setText("\n".join(fault.text for fault in self._contents.faults) or tr(NEW))

    def _show(self) -> None:
        if self.list.currentItem() is None:
            return
        machine = self.chosen
        self.form.show_value(machine, machine.key in self._contents.own)
        names = "  ·  ".join(tr(material.name) for material in cuttable(machine).values())
        self.about.setText(tr("Cuts: {materials}", materials=names))
        self._show_buttons()

    def _show_buttons(self) -> None:
        own = self.chosen.key in self._contents.own
        self.buttons["delete"].setEnabled(own)
        self.buttons["save"].setEnabled(own and bool(self.form.changes()))

    def _try(self, act: Callable[[], None]) -> None:
        """Run an action on files; show the error if it fails."""
        try:
            act()
        except KirigamiError as error:
            self.status.setText(str(error))


def _button(name: str, text: str, tip: str) -> QPushButton:
    button = QPushButton(text)
    button.setObjectName(f"machine_{name}")
    button.setToolTip(tip)
    button.setAutoDefault(False)
    return button
