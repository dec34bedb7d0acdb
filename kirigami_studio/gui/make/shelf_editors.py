"""The editors of materials and of machines: copy a bundled one, enter the numbers of one's own, delete it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from datetime import date
from typing import Any, Generic, TypeVar

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

from kirigami_studio.fabricate import machine, material, material_copies
from kirigami_studio.fabricate.machine import Machine, changed_machine, cuttable
from kirigami_studio.fabricate.material import Material, find_material
from kirigami_studio.fabricate.shelf import Shelf
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.make.material_form import TEXTS, GapRow, MaterialForm, ValueForm

MACHINE_TEXTS = ("name", "note")
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


Item = TypeVar("Item", bound="Material | Machine")


class ShelfEditor(QDialog, Generic[Item]):
    """A list of all values of a shelf beside the form of the chosen one.

    Parameters
    ----------
    parent : QWidget
    shelf : Shelf
    changed : callable
        Makes the value of a key with changes, under another key or the same.
    form : ValueForm
    kind : str
        ``material`` or ``machine``; begins the names of widgets.
    title, new : str
        Of the window, and in the status line while nothing has happened.
    size : QSize
        Of the window, pixels.
    list_width : int
        Pixels.
    """

    contents_changed = Signal()  #: one was saved or deleted

    def __init__(
        self,
        parent: QWidget,
        shelf: Shelf[Item],
        changed: Callable[[str, str, Mapping[str, object]], Item],
        form: ValueForm,
        kind: str,
        title: str,
        new: str,
        size: QSize,
        list_width: int,
    ) -> None:
        super().__init__(parent)
        self._shelf, self._changed, self._kind, self._new = shelf, changed, kind, new
        self._contents = shelf.contents()
        self.setObjectName(f"{kind}Editor")
        self.setWindowTitle(title)
        self.setModal(False)
        self.resize(size)
        self.list = QListWidget()
        self.list.setAccessibleName(title)
        self.list.setObjectName(f"{kind}List")
        self.list.setFixedWidth(list_width)
        self.list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.list.setTextElideMode(Qt.TextElideMode.ElideRight)
        self.form = form
        self.about, self.status = QLabel(), QLabel(new)
        for label in (self.about, self.status):
            label.setWordWrap(True)
            label.setObjectName("muted")
        self.buttons: dict[str, QPushButton] = {}
        self.list.currentItemChanged.connect(self._show)
        self.form.changed.connect(self._show_buttons)

    def add_button(self, name: str, text: str, tip: str, act: Callable[[], None]) -> QPushButton:
        """Add a button whose action works on files; an error is shown in the status line."""
        button = QPushButton(text)
        button.setObjectName(f"{self._kind}_{name}")
        button.setToolTip(tip)
        button.setAutoDefault(False)
        button.clicked.connect(lambda: self.attempt(act))
        self.buttons[name] = button
        return button

    def lay_out(self, below_list: Sequence[QWidget] = (), beside_save: Sequence[tuple[QWidget, int]] = ()) -> None:
        """Lay out the buttons ``copy``, ``delete`` and ``save``, and others with their stretch."""
        scrolled = QScrollArea()
        scrolled.setWidgetResizable(True)
        scrolled.setFrameShape(QScrollArea.Shape.NoFrame)
        scrolled.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # its fields have the keyboard, and bring it along
        scrolled.setWidget(self.form)
        left, right, pair, saving = QVBoxLayout(), QVBoxLayout(), QHBoxLayout(), QHBoxLayout()
        left.addWidget(self.list, 1)
        pair.addWidget(self.buttons["copy"])
        pair.addWidget(self.buttons["delete"])
        left.addLayout(pair)
        for widget in below_list:
            left.addWidget(widget)
        right.addWidget(self.about)
        right.addWidget(scrolled, 1)
        right.addWidget(self.status)
        saving.addWidget(self.buttons["save"])
        saving.addStretch(1)
        for widget, stretch in beside_save:
            saving.addWidget(widget, stretch)
        right.addLayout(saving)
        whole = QHBoxLayout(self)
        whole.setContentsMargins(14, 14, 14, 14)
        whole.setSpacing(14)
        whole.addLayout(left)
        whole.addLayout(right, 1)

    @property
    def chosen(self) -> Item:
        """The value in the form, as it is saved."""
        key: str = (self.list.currentItem() or self.list.item(0)).data(Qt.ItemDataRole.UserRole)
        return self._contents.items[key]

    @property
    def own(self) -> bool:
        """Whether it is one of the user's own."""
        return self.chosen.key in self._contents.own

    def choose(self, key: str) -> None:
        """Show a value by its key; the shelf's first where there is none."""
        wanted = key if key in self._contents.items else next(iter(self._contents.items))
        keys = [self.list.item(row).data(Qt.ItemDataRole.UserRole) for row in range(self.list.count())]
        self.list.setCurrentRow(keys.index(wanted))

    def edited(self) -> Item:
        """The chosen value with the changes in the form; not saved yet."""
        return self._changed(self.chosen.key, self.chosen.key, self.form.changes())

    def description(self, value: Item) -> str:
        """Text above the form."""
        return ""

    def tip(self, value: Item) -> str:
        """Tooltip in the list."""
        return f"{tr(value.name)} ({value.key})"

    def copy(self) -> None:
        """Save a copy of the chosen value under a new key."""
        source = self.chosen
        numbered = (f"{source.key[:35]}-{number}" for number in range(2, 1000))
        key = next(one for one in numbered if one not in self._contents.items)
        made = self._changed(source.key, key, {"name": tr("{name} (copy)", name=tr(source.name))})
        self._shelf.save(made)
        self.show_saved(key, tr("Copied as {name!r}. Edit its values, then save.", name=made.name))
        self.form.texts["name"].setFocus()

    def save(self) -> None:
        """Save the form."""
        made = self.edited()
        self._shelf.save(made)
        self.show_saved(made.key, tr("Saved."))

    def delete(self) -> None:
        """Delete the chosen own value."""
        key, name = self.chosen.key, self.chosen.name
        self._shelf.delete(key)
        self.show_saved(key, tr("Deleted {name!r}.", name=name))

    def show_saved(self, key: str, sentence: str) -> None:
        """Show a value that was saved, or its neighbour, and say what was done."""
        self.reload(key)
        self.status.setText(sentence)
        self.contents_changed.emit()

    def reload(self, key: str) -> None:
        """Read the shelf again and show a value."""
        self._contents = self._shelf.contents()
        self.list.clear()
        for one, value in sorted(self._contents.items.items(), key=lambda item: tr(item[1].name).casefold()):
            own = one in self._contents.own
            item = QListWidgetItem(tr("Custom  ·  {name}", name=value.name) if own else tr(value.name))
            item.setData(Qt.ItemDataRole.UserRole, one)
            item.setToolTip(self.tip(value))
            self.list.addItem(item)
        self.choose(key)
        self.status.setText("\n".join(fault.text for fault in self._contents.faults) or self._new)

    def attempt(self, act: Callable[[], None]) -> None:
        """Run an action on files; show the error if it fails."""
        try:
            act()
        except KirigamiError as error:
            self.status.setText(str(error))

    def _show(self) -> None:
        if self.list.currentItem() is not None:
            self.form.show_value(self.chosen, self.own)
            self.about.setText(self.description(self.chosen))
            self._show_buttons()

    def _show_buttons(self) -> None:
        self.buttons["delete"].setEnabled(self.own)
        self.buttons["save"].setEnabled(self.own and bool(self.form.changes()))


class MachineEditor(ShelfEditor[Machine]):
    """A list of all machines beside the form of the chosen one."""

    def __init__(self, parent: QWidget, key: str) -> None:
        form = ValueForm(Machine, "machine_", MACHINE_TEXTS, NUMBERS)
        new = tr("Bundled machines are read-only. Copy one to change it.")
        super().__init__(
            parent, machine.SHELF, changed_machine, form, "machine", tr("Machines"), new, QSize(760, 520), 270
        )
        self.add_button("copy", tr("C&opy"), tr("Make an editable copy of this machine."), self.copy)
        self.add_button(
            "delete", tr("&Delete"), tr("Delete this machine. Bundled ones cannot be deleted."), self.delete
        )
        self.add_button("save", tr("&Save"), tr("Save the values."), self.save)
        self.lay_out()
        self.reload(key)

    def description(self, value: Machine) -> str:
        """Names of the materials that it cuts."""
        names = "  ·  ".join(tr(material.name) for material in cuttable(value).values())
        return tr("Cuts: {materials}", materials=names)


class MaterialEditor(ShelfEditor[Material]):
    """A list of all materials beside the form of the chosen one."""

    coupon_wanted = Signal(Material)

    def __init__(self, parent: QWidget, key: str) -> None:
        new = tr("Presets are read-only. Copy one to change it.")
        super().__init__(
            parent, material.SHELF, _changed, MaterialForm(), "material", tr("Materials"), new, QSize(820, 560), 300
        )
        self.about.setObjectName("")
        self.gaps = GapRow()
        self.author = QLineEdit()
        self.author.setAccessibleName(tr("Measured by"))
        self.author.setPlaceholderText(tr("Measured by …"))
        self.author.setToolTip(tr("Who measured the coupon."))
        self.add_button("copy", tr("C&opy"), tr("Make an editable copy of this material."), self.copy)
        self.add_button("delete", tr("&Delete"), tr("Delete this material. Presets cannot be deleted."), self.delete)
        coupon = self.add_button(
            "coupon",
            tr("Export &coupon …"),
            tr("Export a test piece for measuring kerf and smallest ligament."),
            lambda: self.coupon_wanted.emit(self.chosen),
        )
        self.add_button(
            "save", tr("&Save"), tr("Save the values. Changed values are marked as uncalibrated."), self.save
        )
        calibrate = self.add_button(
            "calibrate",
            tr("&Mark as calibrated"),
            tr("Record that these values were measured today on a coupon."),
            self.calibrate,
        )
        self.lay_out((coupon, self.gaps), ((self.author, 2), (calibrate, 0)))
        self.author.textChanged.connect(self._show_buttons)
        self.gaps.measured.connect(self._take_kerf)
        self.gaps.refused.connect(self.status.setText)
        self.reload(key)

    def description(self, value: Material) -> str:
        """Whether its numbers were measured."""
        return _state(value)

    def tip(self, value: Material) -> str:
        """Name, machine, and whether its numbers were measured."""
        return f"{super().tip(value)}\n{tr(value.machine)}\n{_state(value)}"

    def calibrate(self) -> None:
        """Save the form as measured today."""
        made = material_copies.mark_calibrated(self.edited(), date.today(), self.author.text())
        self.show_saved(made.key, tr("Saved as calibrated."))

    def _take_kerf(self, kerf_mm: float, sentence: str) -> None:
        """A coupon was measured; the form holds its kerf until it is saved."""
        self.form.numbers["kerf_mm"].setValue(kerf_mm)
        self.status.setText(sentence)

    def _show_buttons(self) -> None:
        super()._show_buttons()
        self.author.setEnabled(self.own)
        self.gaps.allow(self.own)
        self.buttons["calibrate"].setEnabled(self.own and bool(self.author.text().strip()))


def _changed(source: str, key: str, changes: Mapping[str, object]) -> Material:
    """A material with changes; numbers that are not measured count as uncalibrated, words change nothing."""
    if source == key and changes.keys() <= set(TEXTS):
        texts: dict[str, Any] = {field: str(entry) for field, entry in changes.items()}
        return replace(find_material(key), **texts)
    return material_copies.changed_copy(source, key, changes)


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
