"""The first question: what designs are cut with; then which of the materials that it cuts."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import QFrame, QListWidget, QListWidgetItem

from kirigami_studio.fabricate.machine import USUAL, MachineKind, cuttable, find_machine, machines
from kirigami_studio.foundation.resources import resource
from kirigami_studio.foundation.settings import settings_of
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.widgets.layouts import column, label, push_button, row
from kirigami_studio.gui.widgets.readable import rough_time
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.settings.layers import note_on
from kirigami_studio.studio.cutting import expected_seconds

#: What each construction is called.
CONSTRUCTIONS = {one.value: one for one in settings_of(FabricationSettings)["construction"].setting.choices}
#: Kinds of machines in the order in which they are listed, with what they are good for.
KINDS = (
    (MachineKind.HAND, mark("Print a PDF on paper or thin card and cut along its lines.")),
    (MachineKind.KNIFE, mark("A blade, as in Cricut and Silhouette machines.")),
    (MachineKind.CO2, mark("Card, plastics, felt, leather.")),
    (MachineKind.DIODE, mark("Card, felt, leather, plywood.")),
    (MachineKind.UV, mark("Thin films and foils.")),
    (MachineKind.PRINTER, mark("PLA, PETG and TPU: pieces with their pins, or one soft sheet.")),
)
#: Pixels: the picture of a construction, and the least height of the list: as many machines as there are kinds.
PICTURE, LEAST_LIST = QSize(56, 56), 212


class CuttingQuestion(QFrame):
    """Two lists: machines, then the materials of one, each with a picture of its construction."""

    answered = Signal(str, str)  #: keys of a machine and of a material
    declined = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("machineQuestion")
        self._machine = ""
        self.title = label(name="cardTitle", wraps=True)
        self.back = push_button(tr("Machines"), tr("Back to the list of machines."), name="link")
        self.back.clicked.connect(self.offer)
        tip = tr("Start with thin film and a UV laser; the material can be changed at any time.")
        self.later = push_button(tr("Not now"), tip, name="link")
        self.later.clicked.connect(self.declined)
        self.list = QListWidget()
        self.list.setObjectName("machineList")
        self.list.setMinimumHeight(LEAST_LIST)
        self.list.setIconSize(PICTURE)
        self.list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.list.setTextElideMode(Qt.TextElideMode.ElideRight)
        self.list.itemClicked.connect(self._take)
        self.list.itemActivated.connect(self._take)
        head = row((self.title, 1), self.back, self.later, spacing=0)
        column(head, (self.list, 1), on=self, spacing=4, margins=(10, 6, 8, 8))

    def offer(self) -> None:
        """List all machines: the usual one of each kind first, then the others by kind."""
        order, about = [kind for kind, _ in KINDS], dict(KINDS)
        known = sorted(
            machines().items.values(),
            key=lambda machine: (
                machine.key not in USUAL.values(),
                order.index(machine.kind),
                tr(machine.name).casefold(),
            ),
        )
        self._begin(tr("What will you cut with?"), "")
        for machine in known:
            self._add(tr(machine.name), machine.key, tr(about[machine.kind]))

    def _offer_materials(self, key: str) -> None:
        """List the materials of a machine by name, those that one sheet cannot be made of last."""
        machine = find_machine(key)
        spoken = tr("{machine}: which material?", machine=tr(machine.name))
        self._begin(tr("Which material?"), key, spoken)
        offered = cuttable(machine).items()
        for key, material in sorted(
            offered, key=lambda one: (one[1].limits_note is not None, tr(one[1].name).casefold())
        ):
            note = note_on(material, FabricationSettings())
            item = self._add(tr(material.name), key, tr(material.note) if note is None else note.text)
            construction = material.construction
            seconds = expected_seconds(
                FabricationSettings(machine=machine.key, material=key, width_mm=material.sheet_mm)
            )
            made = tr(CONSTRUCTIONS[construction].label)
            if seconds:
                made = tr("cut in about {time}  ·  {construction}", construction=made, time=rough_time(seconds))
            item.setText(f"{item.text()}\n{made}")
            item.setIcon(QIcon(str(resource("constructions", f"{construction.value}.png"))))

    def _begin(self, title: str, machine: str, spoken: str = "") -> None:
        self._machine = machine
        self.list.clear()
        self.list.setAccessibleName(spoken or title)
        self.title.setText(title)
        self.title.setToolTip(spoken)
        self.back.setVisible(bool(machine))

    def _add(self, text: str, key: str, tip: str) -> QListWidgetItem:
        item = QListWidgetItem(text, self.list)
        item.setData(Qt.ItemDataRole.UserRole, key)
        item.setToolTip(tip)
        item.setData(Qt.ItemDataRole.AccessibleDescriptionRole, tip)
        return item

    def _take(self, item: QListWidgetItem) -> None:
        key: str = item.data(Qt.ItemDataRole.UserRole)
        if self._machine:
            self.answered.emit(self._machine, key)
        else:
            self._offer_materials(key)
            self.list.setFocus()
            self.list.setCurrentRow(0)
