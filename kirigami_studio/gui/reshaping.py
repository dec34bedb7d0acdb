"""Gestures of the target's editor -> named edits of the target."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QObject, Signal

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.session import Session
from kirigami_studio.gui.sketching.sketch_context import Change, SketchContext
from kirigami_studio.outlines.placed import Placed
from kirigami_studio.project.edits import Edit, as_drawn, without_designs

#: What the sliders do, by their names.
REFINEMENTS = {"simplify": mark("Simplify target"), "smooth": mark("Smooth target")}


class TargetReshaper(QObject):
    """Makes each complete gesture one edit, and keeps what the sliders started from."""

    edited = Signal(Edit)
    refused = Signal(KirigamiError)
    previewed = Signal(object)  #: Placed, or None
    restarted = Signal()  #: the sliders stand for another target now

    def __init__(self, context: SketchContext, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._context = context
        self._session = session
        self._kind = ""
        self._base: Placed | None = None
        self._result: Placed | None = None

    def take(self, change: Change) -> None:
        """Carry out a gesture, or say why it is impossible."""
        before = self._context.placed
        try:
            made = change.make()
        except KirigamiError as error:
            self.refused.emit(error)
            return
        if before is not None:
            self._context.remember(before)
        self._context.remember(made)
        self.edited.emit(self._edit(made, change))

    def _edit(self, made: Placed, change: Change) -> Edit:
        document = as_drawn(self._session.document, made.outline)
        same = made.outline == document.target  # of another size or elsewhere: its designs are still right
        changed = replace(document, target=made.outline) if same else without_designs(document, made.outline)
        return Edit(change.gesture, changed, change.merge_key)

    def preview(self, kind: str, strength: float) -> None:
        """Show what simplifying or smoothing (0..1) would make of the target."""
        made = self._refined(kind, strength)
        if made is not None:
            self.previewed.emit(made)

    def refine(self, kind: str, strength: float) -> None:
        """Simplify or smooth the target that the slider started from."""
        made = self._refined(kind, strength)
        self.previewed.emit(None)
        placed = self._context.placed
        if made is not None and (placed is None or made.outline != placed.outline):
            self._result = made
            self.take(Change(tr(REFINEMENTS[kind]), lambda: made))

    def _refined(self, kind: str, strength: float) -> Placed | None:
        from kirigami_studio.outlines import refining

        placed = self._context.placed
        if self._base is None or placed is not self._result or kind != self._kind:
            self._base, self._result, self._kind = placed, placed, kind
        if self._base is None:
            return None
        try:
            change = refining.simplified if kind == "simplify" else refining.smoothed
            return change(self._base, strength)
        except KirigamiError as error:
            self.refused.emit(error)
            return None

    def follow(self) -> None:
        """The document's target changed: the sliders start anew unless they did it."""
        if self._context.placed is not self._result:
            self._base = self._result = None
            self.restarted.emit()

    def resize(self, width_mm: float, height_mm: float) -> None:
        """Give the target another real size; its middle stays."""
        from kirigami_studio.outlines.refining import stretched

        placed = self._context.placed
        if placed is not None:
            known = placed.outline.size if placed.outline.unit == "mm" else None
            width, height = placed.size if known is None else known  # as the outline states it, free of rounding
            ring = placed.ring
            x, y = (0.5 * (ring.min(axis=0) + ring.max(axis=0))).tolist()
            factors = (width_mm / width, height_mm / height)
            self.take(Change(tr("Resize target"), lambda: stretched(placed, factors, (x, y))))

    def mirror(self, how: str) -> None:
        """Reflect: ``left``, ``right``, ``top`` or ``bottom`` keeps that half; ``across`` and ``over`` turn all."""
        from kirigami_studio.outlines.combining import Half, symmetric
        from kirigami_studio.outlines.refining import stretched

        placed = self._context.placed
        if placed is None:
            return
        if how in FLIPS:
            self.take(Change(tr("Flip target"), lambda: stretched(placed, FLIPS[how])))
        else:
            self.take(Change(tr("Mirror {how} half", how=how), lambda: symmetric(placed, Half(how))))


#: Factors along x and y of the reflections of the whole target.
FLIPS = {"across": (-1.0, 1.0), "over": (1.0, -1.0)}
