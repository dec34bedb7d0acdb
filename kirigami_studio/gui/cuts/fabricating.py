"""Gestures about cutting -> named edits: numbers, options, single connectors."""

from __future__ import annotations

from collections.abc import Callable
from typing import Unpack

from PySide6.QtCore import QObject, Signal

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import tr
from kirigami_studio.project import edits, hinge_edits
from kirigami_studio.project.document import Document
from kirigami_studio.project.edits import Edit, FabricationChange, OptionsChange


class Fabricating(QObject):
    """Proposes the edit that a gesture leads to, or says why there is none."""

    edited = Signal(object)  #: Edit
    refused = Signal(object)  #: KirigamiError

    def __init__(self, document: Callable[[], Document], parent: QObject) -> None:
        super().__init__(parent)
        self._document = document

    def change(self, **changes: Unpack[FabricationChange]) -> None:
        """Change sheet, material, widths or what files are written for."""
        self._propose(lambda document: edits.set_fabrication(document, **changes))

    def cut_at_drawn_size(self, width_mm: float) -> None:
        """Let the flat sheet be as wide as opens to the size that the target was drawn with."""
        self._propose(
            lambda document: Edit(
                tr("Cut at the drawn size"), edits.set_fabrication(document, width_mm=width_mm).document
            )
        )

    def change_options(self, **changes: Unpack[OptionsChange]) -> None:
        """Change connector style, order or tabs."""
        self._propose(lambda document: edits.set_cut_options(document, **changes))

    def set_hinge_width(self, hinges: frozenset[int], width_mm: float) -> None:
        """Give connectors a width of their own."""
        if hinges:
            self._propose(lambda document: hinge_edits.set_hinge_width(document, hinges, width_mm))

    def remove_hinges(self, hinges: frozenset[int]) -> None:
        """Leave no connector at these hinges."""
        if hinges:
            self._propose(lambda document: hinge_edits.remove_hinges(document, hinges))

    def reset_hinges(self, hinges: frozenset[int]) -> None:
        """Give connectors the usual width again."""
        if hinges:
            self._propose(lambda document: hinge_edits.reset_hinges(document, hinges))

    def _propose(self, make: Callable[[Document], Edit]) -> None:
        try:
            edit = make(self._document())
        except KirigamiError as error:
            self.refused.emit(error)
        else:
            self.edited.emit(edit)
