"""From fault to fault: a command or a click on a fault's sign brings it to the middle, enlarged."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, QPointF, Qt, Signal
from PySide6.QtGui import QMouseEvent

from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.scene.fault_items import Fault, FaultKind
from kirigami_studio.gui.views.layout_view import LayoutView

#: How much a fault is enlarged over the fitted picture.
CLOSE_UP = 5.0
#: A mouse that moves less than this (pixels) between press and release has clicked.
STILL = 4.0


class FaultTour(QObject):
    """Watches one view; it takes no click away from it that is not on a fault."""

    phi_wanted = Signal(float)  #: radians, the angle at which the fault can be seen
    said = Signal(str)

    def __init__(self, view: LayoutView) -> None:
        super().__init__(view)
        self._view = view
        self._place = -1
        self._pressed: QPointF | None = None
        view.installEventFilter(self)

    def step(self, forth: int) -> None:
        """Go to the next fault, or to the one before; after the last one comes the first."""
        found = self._view.find_faults()
        if not found:
            self.said.emit(tr("No fault: no panel is inverted, and the sheet does not touch itself."))
            return
        self._place = (self._place + forth) % len(found) if self._place >= 0 else (0 if forth > 0 else len(found) - 1)
        self.visit(found[self._place])
        words = _words(found[self._place].kind)
        self.said.emit(tr("Fault {number} of {count}: {what}.", number=self._place + 1, count=len(found), what=words))

    def visit(self, fault: Fault) -> None:
        """Show one fault, at the angle at which it is seen."""
        if fault.phi is not None:
            self.phi_wanted.emit(fault.phi)
        self._view.zoom_to(fault.where, CLOSE_UP)

    def forget(self) -> None:
        """Another design: begin with its first fault."""
        self._place = -1

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        if isinstance(event, QMouseEvent) and event.button() is Qt.MouseButton.LeftButton:
            if event.type() == QEvent.Type.MouseButtonPress:
                self._pressed = event.position()
            elif event.type() == QEvent.Type.MouseButtonRelease and self._pressed is not None:
                moved = (event.position() - self._pressed).manhattanLength()
                fault = self._view.fault_at(event.position()) if moved < STILL else None
                self._pressed = None
                if fault is not None:
                    self.visit(fault)
                    self.said.emit(_words(fault.kind).capitalize() + ".")
        return False


def _words(kind: FaultKind) -> str:
    return {
        FaultKind.INVERTED: tr("inverted or collapsed panel"),
        FaultKind.CONTACT: tr("first contact while deploying"),
        FaultKind.CROSSING: tr("the sheet overlaps itself here"),
    }[kind]
