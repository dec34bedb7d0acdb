"""The drawn size of the target beside the size that the opened sheet gives it; one made the other when asked."""

from __future__ import annotations

from PySide6.QtCore import QObject, Signal

from kirigami_studio.evaluate.opened_size import OpenedSize, opened_size
from kirigami_studio.gui.designs.entry import Entry
from kirigami_studio.project.document import Document


class Sizing(QObject):
    """Follows the design on the stage and the document's sizes."""

    known = Signal(object)  #: OpenedSize, or None without a design
    width_wanted = Signal(float)  #: mm, of the flat sheet

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.size: OpenedSize | None = None

    def follow(self, entry: Entry | None, document: Document) -> None:
        """Another design, target or width holds now."""
        self.size = None
        if entry is not None and document.target is not None:
            design = entry.design
            self.size = opened_size(design.deployment, design.pose, document.target, document.fabrication.width_mm)
        self.known.emit(self.size)

    def link(self) -> None:
        """Let the sheet be as wide as shows the target in its drawn size."""
        if self.size is not None and self.size.fitting_width_mm is not None:
            self.width_wanted.emit(self.size.fitting_width_mm)
