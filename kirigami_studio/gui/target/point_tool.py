"""Edit the points of the target, one or many, and the handles that bend the lines between them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from enum import Enum

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QKeyEvent, QPainter

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import mark, tr, tr_n
from kirigami_studio.gui.target.sketch_context import Change, PointerEvent, SketchContext, SketchTool, distance
from kirigami_studio.gui.widgets.paths import ink
from kirigami_studio.gui.widgets.readable import readable_place
from kirigami_studio.gui.widgets.target_items import paint_field, paint_handle, paint_label, paint_proposal
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.widgets.view_transform import Bounds, ViewTransform
from kirigami_studio.outlines.anchors import INTO, OUT, Anchors, with_anchors
from kirigami_studio.outlines.nodes import Kind
from kirigami_studio.outlines.placed import Placed

#: A click this near (pixels) takes a point or a handle, or sets a point on the line.
REACH = 9.0
#: The pointer moves this far (pixels) before a press becomes a drag: a click must not pull a point to the grid.
LEAST_DRAG = 3.0
#: A point is the mirror image of another within this share of the root of the target's area.
IMAGE_REACH = 0.03
#: Keys that, with Shift, change the kind of the selected points.
KINDS = {
    Qt.Key.Key_C: Kind.CORNER,
    Qt.Key.Key_S: Kind.SMOOTH,
    Qt.Key.Key_Y: Kind.SYMMETRIC,
    Qt.Key.Key_A: Kind.AUTO,
}
#: Half the side of a point's mark, pixels.
MARK = 4.5


class Grip(Enum):
    """What the pressed button holds."""

    NOTHING = "nothing"
    POINTS = "points"
    HANDLE = "handle"
    FIELD = "field"


#: One end of an anchor's handles: the anchor, and INTO or OUT.
Handle = tuple[int, int]


class PointTool(SketchTool):
    """Round marks are smooth points, square ones corners; selected ones are filled and show their handles."""

    cursor = Qt.CursorShape.ArrowCursor

    def __init__(self, context: SketchContext) -> None:
        super().__init__(context)
        self.hint = mark(
            "Drag points or handles; Shift+click or drag a box to select more. Double-click adds "
            "or rounds a point. Arrow keys nudge, Delete removes, [ and ] step through."
        )
        self._anchors: Anchors | None = None
        self._shown: Placed | None = None
        self._made: Placed | None = None
        self._dragged: Anchors | None = None
        self._grip = Grip.NOTHING
        self._handle: Handle | None = None
        self._start: PointerEvent | None = None
        self._field: tuple[PointerEvent, PointerEvent] | None = None
        self._toggled = False
        self.chosen: int | None = None
        self.selected: frozenset[int] = frozenset()
        context.kind_wanted.connect(self.set_kind)
        context.mirror_changed.connect(self._reset)
        context.selection_changed.connect(self._follow)

    @property
    def anchors(self) -> Anchors | None:
        """Points of the target; while they are dragged, as they would be."""
        return self._dragged or self._anchors

    def sync(self) -> None:
        placed = self.context.active
        self._dragged = None
        if placed is self._shown and self._anchors is not None:
            self._add_mirror_images()
            return
        if placed is None or placed is not self._made:
            self._anchors = None if placed is None else Anchors.of(placed)
            self.select(())
        self._shown = placed
        self._add_mirror_images()

    def _follow(self) -> None:
        """Another object may be the active one now."""
        if self.context.active is not self._shown:
            self.sync()

    def _reset(self) -> None:
        """Other axes hold: points that were set for the old ones only are gone."""
        if self.context.active is not None and self.context.active is self._shown:
            self._anchors = Anchors.of(self.context.active)
            self.select(())
            self._add_mirror_images()

    def _add_mirror_images(self) -> None:
        """With a mirror every point of the target has its image: set those that are missing on the line."""
        placed, anchors = self.context.active, self._anchors
        if placed is not None and anchors is not None and placed is self._shown:
            images = [self.context.mirror.image(anchors.places, factors) for factors in self.context.mirror.images]
            more = anchors.evened(images, IMAGE_REACH * placed.scale)
            if more is not anchors:
                self._anchors = more
                self.select(())
        self._emit_kinds()

    # selecting -----------------------------------------------------------------------------------------------------

    def select(self, indices: Iterable[int], chosen: int | None = None) -> None:
        """Select points; ``chosen`` is the one that walks and snaps."""
        self.selected = frozenset(indices)
        self.chosen = chosen if chosen in self.selected else next(iter(sorted(self.selected)), None)
        self._emit_kinds()

    def _emit_kinds(self) -> None:
        anchors = self._anchors
        kinds = frozenset() if anchors is None else frozenset(anchors.kinds[index] for index in self.selected)
        self.context.kinds_shown.emit(kinds)

    def press(self, pointer: PointerEvent) -> None:
        self._start, self._toggled = pointer, False
        index = self._at(pointer.pixel)
        self._handle = None if index is not None and not pointer.alt else self._handle_at(pointer.pixel)
        if self._handle is not None:
            self._grip = Grip.HANDLE
        elif index is not None:
            self._grip = Grip.POINTS
            self._press_point(index, pointer.shift)
        else:
            self._grip, self._field = Grip.FIELD, (pointer, pointer)
            if not pointer.shift:
                self.select(())
            other = self.context.drawing.at(pointer.free)
            if other is not None and other != self.context.drawing.active:
                self.context.select({other})
                self._grip, self._field = Grip.NOTHING, None

    def _press_point(self, index: int, more: bool) -> None:
        if more and index in self.selected:
            self._toggled = True
        elif more or index in self.selected:
            self.select(self.selected | {index}, index)
        else:
            self.select({index}, index)

    def move(self, pointer: PointerEvent, held: bool) -> None:
        anchors, start = self._anchors, self._start
        if not held or start is None or anchors is None:
            return
        if self._grip is Grip.FIELD:
            self._field = (start, pointer)
        elif self._dragged is None and distance(start.pixel, pointer.pixel) < LEAST_DRAG:
            return
        elif self._grip is Grip.HANDLE and self._handle is not None:
            self._dragged = self._with_handle(anchors, self._handle, pointer)
        elif self._grip is Grip.POINTS and self.chosen is not None:
            self._dragged = self._shifted(anchors, np.array(pointer.place) - anchors.places[self.chosen])

    def release(self, pointer: PointerEvent) -> None:
        dragged, grip, field, chosen = self._dragged, self._grip, self._field, self.chosen
        start = self._start
        self.drop()
        if grip is Grip.FIELD and field is not None:
            self._select_in_field(field[0], pointer)
        elif dragged is not None:
            points = tr_n("Move point", "Move points", len(self.selected))
            self._commit(dragged, tr("Move handle") if grip is Grip.HANDLE else points)
        elif grip is Grip.POINTS and start is not None and chosen is not None:
            index = self._at(start.pixel)
            if self._toggled and index is not None:
                self.select(self.selected - {index})
            elif not start.shift:
                self.select({chosen}, chosen)

    def _select_in_field(self, start: PointerEvent, end: PointerEvent) -> None:
        anchors = self._anchors
        if anchors is None or distance(start.pixel, end.pixel) < LEAST_DRAG:
            return
        low, high = np.minimum(start.free, end.free), np.maximum(start.free, end.free)
        inside = np.flatnonzero(np.all((anchors.places >= low) & (anchors.places <= high), axis=1))
        self.select({*inside.tolist(), *(self.selected if start.shift else ())})

    def double_click(self, pointer: PointerEvent) -> None:
        if self._anchors is None:
            return
        self._grip, self._start = Grip.NOTHING, None
        index = self._at(pointer.pixel)
        if index is not None:
            self.select({index}, index)
            self._on_kind(Kind.AUTO if self._anchors.kinds[index] is Kind.CORNER else Kind.CORNER)
            return
        more, index = self._anchors.inserted(pointer.free)
        if self._pixels_between(more.places[index], pointer.pixel) <= REACH:
            # Another point on the same line is no change of the target: nothing to undo, ready to be dragged.
            self._anchors = more
            self.select({index}, index)

    # changing ------------------------------------------------------------------------------------------------------

    def set_kind(self, kind: Kind) -> None:
        """Make the selected points, and their mirror images, of one kind.

        Corners keep their handles at first, so that each side can be bent alone; made corners again they lose them.
        """
        anchors = self._anchors
        if anchors is not None:
            soft = any(anchors.kinds[index] is not Kind.CORNER for index in self.selected)
            self._on_kind(kind, cusp=soft and kind is Kind.CORNER)

    def _on_kind(self, kind: Kind, cusp: bool = False) -> None:
        anchors = self._anchors
        if anchors is None or not self.selected or self.context.active is not self._shown:
            return
        for index in sorted(self.selected | self._images(anchors).keys()):
            anchors = anchors.as_cusp(index) if cusp else anchors.with_kind(index, kind)
        if anchors is not self._anchors:
            self._commit(anchors, _kind_change_name(kind, len(self.selected)))

    def key(self, event: QKeyEvent) -> bool:
        anchors = self._anchors
        if anchors is None:
            return False
        key, keys = event.key(), event.modifiers()
        nudge = self.context.nudge(event)
        if key in (Qt.Key.Key_BracketLeft, Qt.Key.Key_BracketRight):
            self._walk(1 if key == Qt.Key.Key_BracketRight else -1, len(anchors.places))
        elif key == Qt.Key.Key_A and keys & Qt.KeyboardModifier.ControlModifier:
            self.select(range(len(anchors.places)), self.chosen)
        elif not self.selected:
            return False
        elif key in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace):
            self._remove(anchors)
        elif nudge is not None:
            gesture = tr_n("Move point", "Move points", len(self.selected))
            self._commit(self._shifted(anchors, nudge[0]), gesture, nudge[1])
        elif key in KINDS and keys == Qt.KeyboardModifier.ShiftModifier:
            self.set_kind(KINDS[Qt.Key(key)])
        else:
            return False
        return True

    def _walk(self, step: int, count: int) -> None:
        start = (-1 if step > 0 else 0) if self.chosen is None else self.chosen
        self.select({(start + step) % count}, (start + step) % count)

    def _remove(self, anchors: Anchors) -> None:
        gone = self.selected | self._images(anchors).keys()
        gesture = tr_n("Delete point", "Delete points", len(self.selected))
        try:
            fewer = anchors.without(*gone)
        except TargetError as error:
            self.context.changed.emit(Change(gesture, _refusal(error)))
            return
        before = self.selected, self.chosen
        self.select(())
        if not self._commit(fewer, gesture):
            self.select(*before)

    def _shifted(self, anchors: Anchors, shift: FloatArray) -> Anchors:
        """Move the selected points; with a mirror their images move mirrored, points on an axis stay on it."""
        shifts: dict[int, FloatArray] = {}
        images = self._images(anchors)
        for index in sorted(self.selected, key=lambda index: index != self.chosen):
            own = [factors for factors in self.context.mirror.images if images.get(index) == factors]
            shifts.setdefault(index, shift)
            for factors in own:
                shifts[index] = 0.5 * (shifts[index] + shifts[index] * factors)
        for index, factors in images.items():
            shifts.setdefault(index, shift * factors)
        return anchors.displaced(shifts)

    def _images(self, anchors: Anchors) -> dict[int, tuple[int, int]]:
        """The mirror images of the selected points, and by which factors they are that."""
        found: dict[int, tuple[int, int]] = {}
        for factors in self.context.mirror.images:
            for index in self.selected:
                image = self._image(anchors, index, factors)
                if image is not None:
                    found.setdefault(image, factors)
        return found

    def _image(self, anchors: Anchors, index: int, factors: tuple[int, int]) -> int | None:
        """The point that is the mirror image of another one."""
        placed = self.context.active
        image = self.context.mirror.image(anchors.places[index], factors)
        far = np.linalg.norm(anchors.places - image, axis=1)
        nearest = int(np.argmin(far))
        return nearest if placed is not None and far[nearest] <= IMAGE_REACH * placed.scale else None

    def _with_handle(self, anchors: Anchors, handle: Handle, pointer: PointerEvent) -> Anchors:
        index, end = handle
        offset = np.array(pointer.place) - anchors.places[index]
        bent = anchors.with_handle(index, end, offset, pointer.alt, pointer.shift)
        for factors in self.context.mirror.images:
            image = self._image(anchors, index, factors)
            if image is not None and image != index:
                turned = factors[0] * factors[1] < 0  # a reflection turns the order of the points round
                side = (INTO + OUT - end) if turned else end
                bent = bent.with_handle(image, side, offset * factors, pointer.alt, pointer.shift)
        return bent

    @property
    def busy(self) -> bool:
        return self._grip is not Grip.NOTHING

    def deselect(self) -> bool:
        selected = bool(self.selected)
        self.select(())
        return selected

    def selected_box(self) -> Bounds | None:
        if self._anchors is None or len(self.selected) < 2:
            return super().selected_box()
        return Bounds.of(self._anchors.places[sorted(self.selected)])

    def drop(self) -> None:
        self._dragged, self._field, self._handle, self._start = None, None, None, None
        self._grip = Grip.NOTHING

    def _commit(self, anchors: Anchors, gesture: str, merge_key: str | None = None) -> bool:
        """Hand over the target with these points; whether it was taken.  They stay selected."""
        placed = self.context.active
        if placed is None:
            return False
        before = self._anchors

        def make() -> Placed:
            made = with_anchors(placed, anchors)
            self._made = made
            self._anchors = anchors if made.outline.nodes is not None else Anchors.of(made)
            return made

        self.context.changed.emit(Change(gesture, make, merge_key))
        if self.context.active is placed:  # refused
            self._anchors = before
            return False
        if self._anchors is not None and len(self._anchors.places) != len(anchors.places):
            self.select(())
        self._emit_kinds()
        return True

    # finding and painting ------------------------------------------------------------------------------------------

    def _at(self, pixel: QPointF) -> int | None:
        if self._anchors is None:
            return None
        far = np.array([self._pixels_between(place, pixel) for place in self._anchors.places])
        nearest = int(np.argmin(far))
        return nearest if far[nearest] <= REACH else None

    def _handle_at(self, pixel: QPointF) -> Handle | None:
        anchors = self._anchors
        if anchors is None:
            return None
        shown = [(index, side) for index in self.selected for side in (INTO, OUT)]
        far = {
            handle: self._pixels_between(anchors.places[handle[0]] + anchors.handles[handle], pixel)
            for handle in shown
            if np.any(anchors.handles[handle])
        }
        nearest = min(far, key=lambda handle: far[handle], default=None)
        return nearest if nearest is not None and far[nearest] <= REACH else None

    def _pixels_between(self, place: FloatArray, pixel: QPointF) -> float:
        return float(np.linalg.norm(self.context.transform.to_pixels(place) - (pixel.x(), pixel.y())))

    def paint(self, painter: QPainter, transform: ViewTransform, palette: Palette) -> None:
        anchors = self.anchors
        if anchors is None:
            return
        if self._dragged is not None:
            paint_proposal(painter, transform.to_pixels(anchors.ring), palette)
        self._paint_handles(painter, transform, palette, anchors)
        images = self._images(anchors).keys() - self.selected
        for index, (x, y) in enumerate(transform.to_pixels(anchors.places).tolist()):
            fill = palette.accent if index in self.selected else palette.canvas
            ink(painter, palette.accent, 2.4 if index in images else 1.6, fill=fill)
            _paint_point(painter, QPointF(x, y), anchors.kinds[index])
        if self._dragged is not None and self._grip is Grip.POINTS and self.chosen is not None:
            place = anchors.places[self.chosen]
            x, y = transform.to_pixels(place).tolist()
            paint_label(painter, QPointF(x, y), readable_place(*place), palette)
        if self._field is not None:
            paint_field(painter, self._field[0].pixel, self._field[1].pixel, palette)

    def _paint_handles(self, painter: QPainter, transform: ViewTransform, palette: Palette, anchors: Anchors) -> None:
        for index in self.selected:
            start = QPointF(*transform.to_pixels(anchors.places[index]).tolist())
            for offset in anchors.handles[index]:
                if np.any(offset):
                    end = QPointF(*transform.to_pixels(anchors.places[index] + offset).tolist())
                    paint_handle(painter, start, end, palette)


def _refusal(error: TargetError) -> Callable[[], Placed]:
    def refuse() -> Placed:
        raise error

    return refuse


def _kind_change_name(kind: Kind, count: int) -> str:
    """The change as it follows the word Undo."""
    return {
        Kind.CORNER: tr_n("Make point a corner", "Make points corners", count),
        Kind.SMOOTH: tr_n("Make point smooth", "Make points smooth", count),
        Kind.SYMMETRIC: tr_n("Make point symmetric", "Make points symmetric", count),
        Kind.AUTO: tr_n("Make point automatic", "Make points automatic", count),
    }[kind]


def _paint_point(painter: QPainter, pointer: QPointF, kind: Kind) -> None:
    """A square for a corner, a circle for what is smooth; automatic ones are diamonds."""
    box = QRectF(pointer.x() - MARK, pointer.y() - MARK, 2 * MARK, 2 * MARK)
    if kind is Kind.CORNER:
        painter.drawRect(box)
    elif kind is Kind.AUTO:
        far = 1.3 * MARK
        painter.drawPolygon([pointer + QPointF(*offset) for offset in ((0, -far), (far, 0), (0, far), (-far, 0))])
    else:
        painter.drawEllipse(box)
