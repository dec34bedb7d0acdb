"""An opened project may bring a material that is not in stock, or has other numbers there: say so, offer to keep it."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QObject, Signal

from kirigami_studio.fabricate.material import Material, library
from kirigami_studio.fabricate.material_copies import save_copy
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.messages import Message, Tone
from kirigami_studio.project.document import Document
from kirigami_studio.project.material_record import carried_material


class MaterialStore(QObject):
    """Compares what a project carries with what is in stock."""

    stocked = Signal(str)  #: key of a material that is in stock now
    message = Signal(object)  #: Message
    status = Signal(str)

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)

    def welcome(self, document: Document) -> None:
        """A project was opened."""
        material = carried_material(document.fabrication)
        if material is None:
            return
        known = library().materials.get(material.key)
        if known is None:
            sentence = tr(
                "The material {name} is not among yours; its numbers came with the project and are used.",
                name=material.name,
            )
            keep = (tr("Add to my materials"), partial(self.keep, material))
            self.message.emit(Message(sentence, Tone.WARNING, actions=(keep,)))
        elif known != material:
            sentence = tr(
                "Your material {name} has other numbers than this project knew; yours are used.", name=known.name
            )
            self.message.emit(Message(sentence, Tone.WARNING, differences(material, known)))

    def keep(self, material: Material) -> None:
        """Save what a project carries among the own materials."""
        try:
            save_copy(material)
        except KirigamiError as error:
            self.message.emit(Message(str(error), Tone.ERROR))
            return
        self.status.emit(tr("{name} is among your materials now.", name=material.name))
        self.stocked.emit(material.key)


def differences(carried: Material, known: Material) -> str:
    """One line for every entry in which two materials differ."""
    entries = [name for name in Material.__dataclass_fields__ if getattr(carried, name) != getattr(known, name)]
    return "\n".join(
        tr(
            "{entry}: {theirs} in the project, {ours} in stock",
            entry=name,
            theirs=_told(carried, name),
            ours=_told(known, name),
        )
        for name in entries
    )


def _told(material: Material, name: str) -> str:
    value = getattr(material, name)
    return f"{value:g}" if isinstance(value, float) else str(value)
