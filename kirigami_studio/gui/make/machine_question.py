"""The first question: what designs are cut with; then which of the materials that it cuts."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QFrame, QGridLayout, QHBoxLayout, QLabel, QMenu, QPushButton, QSizePolicy, QVBoxLayout

from kirigami_studio.fabricate.machine import Machine, MachineKind, cuttable, machines
from kirigami_studio.fabricate.material import find_material
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.settings.fabrication import FabricationSettings
from kirigami_studio.settings.layers import note_on

#: Kinds of machines in the order in which they are offered, with their names on the buttons.
KINDS = (
    (MachineKind.HAND, mark("Paper and scissors"), mark("Print a PDF on paper or thin card and cut along its lines.")),
    (MachineKind.KNIFE, mark("Cutting plotter"), mark("A blade, as in Cricut and Silhouette machines.")),
    (MachineKind.CO2, mark("CO2 laser"), mark("Card, plastics, felt, leather.")),
    (MachineKind.DIODE, mark("Diode laser"), mark("Card, felt, leather, plywood.")),
    (MachineKind.UV, mark("UV laser"), mark("Thin films and foils.")),
    (MachineKind.PRINTER, mark("3D printer"), mark("PLA, PETG and TPU: pieces with their pins, or one soft sheet.")),
)


class CuttingQuestion(QFrame):
    """Asks for the machine, then for a material that it cuts: one button for each kind."""

    answered = Signal(str, str)  #: keys of a machine and of a material
    declined = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("machineQuestion")
        self.title = QLabel(tr("What will you cut with?"))
        self.title.setObjectName("cardTitle")
        self.why = QLabel(tr("It decides how fine designs may be. You can change it at any time."))
        self.why.setObjectName("muted")
        self.why.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.later = QPushButton(tr("Not now"))
        self.later.setObjectName("link")
        self.later.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.later.setToolTip(tr("Start with thin film and a UV laser; the material can be changed at any time."))
        self.later.clicked.connect(self.declined)
        self.buttons: dict[MachineKind, QPushButton] = {}
        head = QHBoxLayout()
        head.addWidget(self.title, 1)
        head.addWidget(self.later)
        self._grid = QGridLayout()
        self._grid.setSpacing(8)
        column = QVBoxLayout(self)
        column.setContentsMargins(12, 6, 8, 10)
        column.setSpacing(6)
        column.addLayout(head)
        column.addWidget(self.why)
        column.addLayout(self._grid)

    def offer(self) -> None:
        """Offer all machines by their kinds, bundled and own ones."""
        known = sorted(machines().items.values(), key=lambda machine: tr(machine.name).casefold())
        for kind, name, about in KINDS:
            found = [machine for machine in known if machine.kind is kind]
            if found and kind not in self.buttons:
                self._add(kind, tr(name), tr(about), found)

    def _add(self, kind: MachineKind, name: str, about: str, found: list[Machine]) -> None:
        button = QPushButton(name)
        button.setObjectName("machineChoice")
        button.setToolTip(about)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        menu = QMenu(button)
        for machine in found:
            self._offer_materials(menu if len(found) == 1 else menu.addMenu(tr(machine.name)), machine)
        button.setMenu(menu)
        button.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.buttons[kind] = button
        self._arrange()

    def _offer_materials(self, menu: QMenu, machine: Machine) -> None:
        """The materials that a machine cuts, by name; those that one sheet cannot be made of come last and say so."""
        menu.setToolTipsVisible(True)
        taken = [
            (material.limits_note is not None, tr(material.name), key) for key, material in cuttable(machine).items()
        ]
        for _, name, key in sorted(taken):
            action, material = menu.addAction(name), find_material(key)
            note = note_on(material, FabricationSettings())
            action.setToolTip(tr(material.note) if note is None else note.text)
            action.triggered.connect(lambda _=False, key=key: self.answered.emit(machine.key, key))

    def _arrange(self) -> None:
        """Put buttons in one row or in rows of three or two, where the reason gives way."""
        buttons = list(self.buttons.values())
        widest = max((button.sizeHint().width() for button in buttons), default=0)
        columns = next((count for count in (len(KINDS), 3) if count * (widest + 8) <= self.width()), 2)
        for place, button in enumerate(buttons):
            self._grid.addWidget(button, *divmod(place, columns))
        self.why.setVisible(columns > 3)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        super().resizeEvent(event)
        self._arrange()
