"""Choice of a machine, and then of a material that it cuts."""

from __future__ import annotations

from PySide6.QtCore import QObject, QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QComboBox, QSizePolicy

from kirigami_studio.fabricate.machine import Machine, cuttable, machines
from kirigami_studio.fabricate.material import Material, library
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.widgets.choice_box import ComboBox
from kirigami_studio.settings.fabrication import (
    FabricationSettings,
    machine_changes,
    machine_for,
    material_changes,
    stored_machine,
    stored_material,
)
from kirigami_studio.settings.layers import note_on

#: In the place of a machine: the one that the material is for.
USUAL = mark("The usual one")


class MachineChooser(QObject):
    """A box of machines, and a box of the materials that the chosen one cuts.

    Attributes
    ----------
    machine, material : ComboBox
    """

    changed = Signal(dict)  #: field of FabricationSettings -> value
    edited = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._settings = FabricationSettings()
        self.machine, self.material = _box("machine", tr("Machine")), _box("material", tr("Material preset"))
        self.machine.activated.connect(self._take_machine)
        self.material.activated.connect(self._take_material)
        self.reload()

    def reload(self) -> None:
        """Read machines and materials again."""
        self._machines, self._library = machines().items, library().items
        with QSignalBlocker(self.machine), QSignalBlocker(self.material):
            self.machine.clear()
            self.machine.addItem(tr(USUAL), "")
            for key, machine in sorted(self._machines.items(), key=_shown_name):
                self.machine.addItem(tr(machine.name), key)
                self.machine.setItemData(self.machine.count() - 1, tr(machine.note), Qt.ItemDataRole.ToolTipRole)
            self.material.clear()
        self.show_settings(self._settings)

    def show_settings(self, settings: FabricationSettings) -> Material | None:
        """Show machine and material of settings, and return the material, None if unknown."""
        self._settings = settings
        machine = self._machine(settings.machine)
        offered = self._offer_materials(machine)
        stored = stored_material(settings)
        material = offered.get(settings.material) or self._library.get(settings.material) or stored
        with QSignalBlocker(self.machine), QSignalBlocker(self.material):
            if self.machine.findData(settings.machine) < 0:
                self.machine.addItem(tr(machine.name) if machine else settings.machine, settings.machine)
            self.machine.setCurrentIndex(self.machine.findData(settings.machine))
            if self.material.findData(settings.material) < 0:
                self.material.addItem(tr(material.name) if material else settings.material, settings.material)
            self.material.setCurrentIndex(self.material.findData(settings.material))
        if material is not None:
            about = tr(
                "{machine}, {thickness_mm:g} mm. {note}",
                machine=tr(material.machine),
                thickness_mm=material.thickness_mm,
                note=tr(material.note),
            )
            note = note_on(material, settings)
            self.material.setToolTip(about if note is None else f"{note.text}\n{about}")
            cutter = machine or machine_for(settings)
            self.machine.setToolTip(_about_machine(cutter))
        return material

    @property
    def wanted_file(self) -> str:
        """Extension of the file that the chosen machine's program takes best; "" without one."""
        machine = self._machine(self._settings.machine)
        return "" if machine is None else machine.file

    def _machine(self, key: str) -> Machine | None:
        """The machine of a key, or else the one that the project carries."""
        stored = stored_machine(self._settings)
        return self._machines.get(key, stored if stored is not None and stored.key == key else None)

    def _offer_materials(self, machine: Machine | None) -> dict[str, Material]:
        """Offer what a machine cuts, or everything; the order is that of the shown names."""
        offered = dict(self._library) if machine is None else cuttable(machine)
        listed = sorted(offered.items(), key=_shown_name)
        if [self.material.itemData(row) for row in range(self.material.count())] != [key for key, _ in listed]:
            usual = FabricationSettings()
            with QSignalBlocker(self.material):
                self.material.clear()
                for row, (key, material) in enumerate(listed):
                    note = note_on(material, usual)
                    self.material.addItem(tr(material.name), key)
                    self.material.setItemData(row, None if note is None else note.text, Qt.ItemDataRole.ToolTipRole)
        return offered

    def _take_machine(self, index: int) -> None:
        """A machine brings its profile and, where it does not cut the material, one that it cuts."""
        machine = self._machine(self.machine.itemData(index))
        self.changed.emit({"machine": ""} if machine is None else dict(machine_changes(self._settings, machine)))
        self.edited.emit()

    def _take_material(self, index: int) -> None:
        self.changed.emit(dict(material_changes(self._settings, self.material.itemData(index))))
        self.edited.emit()


def _about_machine(machine: Machine) -> str:
    """Name, reach and note of a machine."""
    width, height = machine.reach_mm
    return tr(
        "{machine}: reaches {width:g} x {height:g} mm. {note}",
        machine=tr(machine.name),
        width=width,
        height=height,
        note=tr(machine.note),
    )


def _shown_name(entry: tuple[str, Machine | Material]) -> str:
    return tr(entry[1].name).casefold()


def _box(name: str, spoken: str) -> ComboBox:
    box = ComboBox()
    box.setObjectName(name)
    box.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    box.setAccessibleName(spoken)
    box.setMinimumContentsLength(8)
    box.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
    box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
    return box
