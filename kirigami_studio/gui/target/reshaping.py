"""Gestures of the target's editor -> named edits of the target."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QObject, Signal

from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.foundation.words import mark, tr
from kirigami_studio.gui.session.session import Session
from kirigami_studio.gui.target.sketch_context import Change, SketchContext
from kirigami_studio.outlines.drawing import Drawing
from kirigami_studio.outlines.placed import Placed
from kirigami_studio.project.edits import Edit, as_drawn, without_designs

#: What the sliders do, by their names.
REFINEMENTS = {"simplify": mark("Simplify target"), "smooth": mark("Smooth target")}


class TargetReshaper(QObject):
    """Makes each complete gesture one edit, and keeps what the sliders started from."""

    edited = Signal(Edit)
    refused = Signal(KirigamiError)
    proposed = Signal(object)  #: Placed, or None
    restarted = Signal()  #: the sliders stand for another target now

    def __init__(self, context: SketchContext, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self._context = context
        self._session = session
        self._kind = ""
        self._base: Placed | None = None
        self._result: Placed | None = None

    def take(self, change: Change) -> bool:
        """Carry out a gesture, or say why it is impossible; whether it was carried out."""
        context = self._context
        try:
            made = change.make()
            drawing = made if isinstance(made, Drawing) else context.drawing.with_active(made)
            target = drawing.united().target if drawing.objects else None
        except KirigamiError as error:
            self.refused.emit(error)
            return False
        for each in (context.placed, *context.drawing.objects, target, *drawing.objects):
            if each is not None:
                context.remember(each)
        self.edited.emit(self._edit(drawing, target, change))
        context.select(drawing.selected)
        return True

    def _edit(self, drawing: Drawing, target: Placed | None, change: Change) -> Edit:
        document = self._session.document
        objects = tuple(each.outline for each in drawing.objects) if len(drawing.objects) > 1 else ()
        if target is None:
            return Edit(change.gesture, without_designs(document, None))
        shown = self._context.placed
        before = document if shown is None else replace(document, target=shown.outline)  # in the size that is drawn on
        document = replace(as_drawn(before, target.outline), target=document.target)
        same = target.outline == document.target  # of another size or elsewhere: its designs are still right
        changed = document if same else without_designs(document, target.outline)
        return Edit(change.gesture, replace(changed, target=target.outline, drawing=objects), change.merge_key)

    def propose(self, kind: str, strength: float) -> None:
        """Show what simplifying or smoothing (0..1) would make of the target."""
        made = self._refined(kind, strength)
        if made is not None:
            self.proposed.emit(made)

    def refine(self, kind: str, strength: float) -> None:
        """Simplify or smooth the target that the slider started from."""
        made = self._refined(kind, strength)
        self.proposed.emit(None)
        placed = self._context.active
        if made is not None and (placed is None or made.outline != placed.outline):
            self._result = made
            self.take(Change(tr(REFINEMENTS[kind]), lambda: made))

    def _refined(self, kind: str, strength: float) -> Placed | None:
        from kirigami_studio.outlines import refining

        placed = self._context.active
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
        if self._context.active is not self._result:
            self._base = self._result = None
            self.restarted.emit()

    def resize(self, width_mm: float, height_mm: float) -> None:
        """Give the target another real size; its middle stays, and all objects go along."""
        from kirigami_studio.outlines.refining import stretched

        placed, drawing = self._context.placed, self._context.drawing
        if placed is not None:
            known = placed.outline.size if placed.outline.unit == "mm" else None
            width, height = placed.size if known is None else known  # as the outline states it, free of rounding
            ring = placed.ring
            x, y = (0.5 * (ring.min(axis=0) + ring.max(axis=0))).tolist()
            factors = (width_mm / width, height_mm / height)
            every = drawing.select(range(len(drawing.objects)))
            self.take(
                Change(
                    tr("Resize target"),
                    lambda: every.changed(lambda each: stretched(each, factors, (x, y))).select(drawing.selected),
                )
            )

    def mirror(self, how: str) -> None:
        """Reflect: ``left``, ``right``, ``top`` or ``bottom`` keeps that half of the active object; ``across`` and
        ``over`` turn what is selected, else all.
        """
        from kirigami_studio.outlines.combining import Half, symmetric
        from kirigami_studio.outlines.refining import stretched

        active, drawing = self._context.active, self._context.drawing
        if active is None:
            return
        if how in FLIPS:
            turned = drawing if drawing.chosen else drawing.select(range(len(drawing.objects)))
            low, high = turned.box(turned.chosen)
            x, y = (0.5 * (low + high)).tolist()
            middle = None if len(turned.chosen) == 1 else (x, y)
            self.take(
                Change(tr("Flip target"), lambda: turned.changed(lambda each: stretched(each, FLIPS[how], middle)))
            )
        else:
            self.take(Change(tr("Mirror {how} half", how=how), lambda: symmetric(active, Half(how))))


#: Factors along x and y of the reflections of the whole target.
FLIPS = {"across": (-1.0, 1.0), "over": (1.0, -1.0)}
