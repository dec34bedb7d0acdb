"""Places where cuts meet the rim of a sheet, as handles: picking, facts, drawing, drags and keys.

The handle of an edge cut stands a little outside the sheet, beside the middle of the two corners that lie together
there while the sheet is flat, so that it never covers a vertex of the outline.  A cut slides along its side of the
sheet, between its two neighbours.  :class:`~kirigami_studio.gui.stage.void_gestures.VoidGestures` owns the mouse; it
asks here first.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from PySide6.QtCore import QObject, QPointF, Qt, Signal
from PySide6.QtGui import QKeyEvent, QPainter

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.foundation.words import tr
from kirigami_studio.gui.stage.void_items import VoidShapes
from kirigami_studio.gui.widgets.paths import ink, round_pen
from kirigami_studio.gui.widgets.readable import readable_width
from kirigami_studio.gui.widgets.theme import Palette
from kirigami_studio.gui.widgets.view_transform import ViewTransform
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.sheet import Rim, RimPath, Sheet, anchor_points, replace_sheet, rim_table
from kirigami_studio.project.document import Void

#: Pixels from the rim to the middle of a handle, and from there to the pointer that still means it.
OUTSIDE, REACH = 13.0, 8.0
#: Radius (pixels) of a handle, and of the one that is meant or selected.
RADIUS, MEANT_RADIUS = 3.6, 5.6


@cache
def twins(rows: int, columns: int) -> IntArray:
    """The two nodes at each edge cut, which lie together while the sheet is flat: (R, 2) int, as in ``RimTable``."""
    table = rim_table(rows, columns)
    pairs: IntArray = np.array([table.node[table.share[:, anchor] == 1.0] for anchor in table.mouths]).reshape(-1, 2)
    pairs.setflags(write=False)
    return pairs


def mouth_places(design: PosedDesign, phi: float) -> FloatArray:
    """Middle of the two nodes at each edge cut at an angle: (R, 2) float, world."""
    places: FloatArray = design.nodes(phi)[twins(*design.deployment.sheet.grid)].mean(axis=1)
    return places


def outward(sheet: Sheet) -> FloatArray:
    """Unit vectors (R, 2) that point out of the flat sheet at its edge cuts."""
    table, anchors = rim_table(*sheet.grid), anchor_points(sheet)
    along = np.roll(anchors, -1, axis=0)[table.mouths] - anchors[table.mouths - 1]
    along /= np.maximum(np.hypot(*along.T), 1e-12)[:, None]
    return np.stack([-along[:, 1], along[:, 0]], axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class RimShapes:
    """Handles of one design at one angle, in pixels."""

    #: feet, handles: (R, 2), pixels; where the edge cuts are, and the handles beside them; in the order of
    #: :class:`~kirigami_studio.lattice.sheet.RimTable`.
    feet: FloatArray
    handles: FloatArray

    @classmethod
    def of(cls, design: PosedDesign, phi: float, transform: ViewTransform) -> RimShapes:
        """Place the handles of a design."""
        feet = transform.to_pixels(mouth_places(design, phi))
        # Panels on both sides of a cut turn by the same angle, one either way: the way out of the sheet stays.
        turned = outward(design.deployment.sheet) @ (design.pose_at(phi).matrix[:, :2].T / design.pose.scale)
        return cls(feet, feet + OUTSIDE * turned * (1.0, -1.0))

    def mouth_at(self, x: float, y: float) -> int | None:
        """The edge cut whose handle is nearest to pixel (x, y), if in reach."""
        if not len(self.handles):
            return None
        distance = np.hypot(*(self.handles - (x, y)).T)
        nearest = int(distance.argmin())
        return nearest if distance[nearest] <= REACH else None


@dataclass(frozen=True, slots=True)
class MouthFacts:
    """One edge cut on the sheet as it is cut."""

    side: int  #: 0 top, 1 right, 2 bottom, 3 left
    #: number, count: its number on that side from 1, from the left or from the top, and how many there are.
    number: int
    count: int
    position: float  #: unit cells; from the left or upper corner of that side
    offset: float  #: unit cells; from its place on an even rim
    position_mm: float

    @classmethod
    def of(cls, sheet: Sheet, mouth: int, width_mm: float) -> MouthFacts:
        """Measure an edge cut of a sheet that is ``width_mm`` wide."""
        table, anchors = rim_table(*sheet.grid), anchor_points(sheet)
        side = int(table.side[mouth])
        same = np.flatnonzero(table.side == side)
        position = float(sheet.rim.positions[mouth])
        corners = np.flatnonzero(np.isin(np.arange(len(anchors)), table.mouths, invert=True))
        # Positions count along with the rim on the first two sides and against it on the others.
        start = anchors[corners[side if side < 2 else (side + 1) % 4]]
        length = float(np.hypot(*(anchors[table.mouths[mouth]] - start)))
        scale = width_mm / float(np.ptp(anchors[:, 0]))
        offset = position - float(table.even[mouth])
        return cls(side, int(mouth - same[0]) + 1, same.size, position, offset, length * scale)

    @property
    def name(self) -> str:
        """Which one it is, for short texts."""
        templates = (
            tr("Edge cut {number} of {count}, top"),
            tr("Edge cut {number} of {count}, right"),
            tr("Edge cut {number} of {count}, bottom"),
            tr("Edge cut {number} of {count}, left"),
        )
        return templates[self.side].format(number=self.number, count=self.count)

    @property
    def short_name(self) -> str:
        """The same where there is little room."""
        return tr("Cut {number}", number=self.number)

    def lines(self) -> tuple[str, str]:
        """The lines of the label at the pointer."""
        place = tr("{place}   {cells:.2f} cells", place=readable_width(self.position_mm), cells=self.position)
        return self.name, place

    def sentence(self) -> str:
        """The text for the status line."""
        if self.side % 2 == 0:
            return tr(
                "{name}: {place} from the left corner, {cells:.2f} cells ({offset:+.2f} from even).",
                name=self.name,
                place=readable_width(self.position_mm),
                cells=self.position,
                offset=self.offset,
            )
        return tr(
            "{name}: {place} from the upper corner, {cells:.2f} cells ({offset:+.2f} from even).",
            name=self.name,
            place=readable_width(self.position_mm),
            cells=self.position,
            offset=self.offset,
        )


def paint_mouths(
    painter: QPainter, shapes: RimShapes, meant: int | None, selected: int | None, palette: Palette
) -> None:
    """Draw a small disc on a stem at every edge cut; larger where it is pointed at, filled where it is selected."""
    for mouth, (foot, handle) in enumerate(zip(shapes.feet.tolist(), shapes.handles.tolist(), strict=True)):
        marked = mouth in (meant, selected)
        painter.setPen(round_pen(palette.canvas, 3.6))
        painter.drawLine(QPointF(*foot), QPointF(*handle))
        painter.setPen(round_pen(palette.accent, 1.4))
        painter.drawLine(QPointF(*foot), QPointF(*handle))
        ink(painter, palette.accent, 1.6, fill=palette.accent if mouth == selected else palette.surface)
        radius = MEANT_RADIUS if marked else RADIUS
        painter.drawEllipse(QPointF(*handle), radius, radius)


#: Two neighbours on a side keep at least this distance (unit cells): half of it is an edge of a panel.
LEAST_GAP = 0.3
#: Unit cells by which the motion of an edge cut is measured.
PROBE = 0.01
#: Least motion (lengths of the world per unit cell) that is believed, in cells of the sheet.
LEAST_MOTION = 0.25


def room_of(sheet: Sheet, mouth: int) -> tuple[float, float]:
    """Lowest and highest position that an edge cut may take, unit cells; it may stay where it is.

    One that holds a sharp corner of the start outline has to, so that its neighbours stay between such corners, too.
    """
    table, positions = rim_table(*sheet.grid), sheet.rim.positions
    side = int(table.side[mouth])
    length = float(sheet.columns + 1 if side % 2 == 0 else sheet.rows + 1)
    same = np.flatnonzero(table.side == side)
    before = 0.0 if mouth == same[0] else float(positions[mouth - 1])
    after = length if mouth == same[-1] else float(positions[mouth + 1])
    here = float(positions[mouth])
    if holds_corner(sheet, mouth):
        return here, here
    return min(before + LEAST_GAP, here), max(after - LEAST_GAP, here)


def holds_corner(sheet: Sheet, mouth: int) -> bool:
    """Whether an edge cut belongs at a sharp corner of the start outline: moved, the flat sheet would lose it."""
    return bool(RimPath(*sheet.grid, sheet.start, sheet.cell).held[mouth])


def moved(sheet: Sheet, mouth: int, position: float) -> Sheet:
    """The sheet with an edge cut at another position, or as near to it as its neighbours let it."""
    low, high = room_of(sheet, mouth)
    return _placed(sheet, mouth, min(max(position, low), high))


def _placed(sheet: Sheet, mouth: int, position: float) -> Sheet:
    offsets = sheet.rim.offsets(*sheet.grid)
    offsets[mouth] = position - rim_table(*sheet.grid).even[mouth]
    return replace_sheet(sheet, rim=Rim.moved(*sheet.grid, offsets, sheet.rim.hinges))


def with_sheet(design: PosedDesign, sheet: Sheet) -> PosedDesign:
    """Another sheet over the same place: the mean of its nodes at the target angle stays."""
    placed = PosedDesign(deploy(sheet), design.pose, design.phi_target)
    drift = design.nodes(design.phi_target).mean(axis=0) - placed.nodes(design.phi_target).mean(axis=0)
    x, y = design.pose.shift
    shift = (x + float(drift[0]), y + float(drift[1]))
    return replace(placed, pose=replace(design.pose, shift=shift))


@dataclass(frozen=True, slots=True, eq=False)
class MouthDrag:
    """An edge cut that is being dragged.

    All nodes are linear in its position, so the cut stays under the pointer.
    """

    mouth: int
    place: tuple[float, float]  #: (x, y), world; where the drag began
    position: float  #: unit cells; of the cut at that time
    motion: FloatArray  #: (2,), world; how far it moves when its position grows by one cell

    @classmethod
    def of(cls, design: PosedDesign, mouth: int, place: tuple[float, float], phi: float) -> MouthDrag:
        """Begin to drag an edge cut at an angle (radians)."""
        sheet = design.deployment.sheet
        position = float(sheet.rim.positions[mouth])
        ends = [
            mouth_places(with_sheet(design, _placed(sheet, mouth, at)), phi)[mouth]
            for at in (position - PROBE, position + PROBE)
        ]
        motion = (ends[1] - ends[0]) / (2.0 * PROBE)
        short = LEAST_MOTION * design.pose.scale / max(float(np.hypot(*motion)), 1e-12)
        return cls(mouth, place, position, motion * max(1.0, short))

    def position_at(self, place: tuple[float, float]) -> float:
        """Its position, unit cells, when the pointer is at a place in the world."""
        along = np.subtract(place, self.place)
        return self.position + float(along @ self.motion) / max(float(self.motion @ self.motion), 1e-18)


#: Unit cells by which an arrow key moves an edge cut, and with Alt.
KEY_STEP, FINE_STEP = 0.05, 0.005
#: For each side (top, right, bottom, left): the keys that move a cut to lower and higher positions, and the key
#: that leaves it for the voids.
_KEYS = (
    (Qt.Key.Key_Left, Qt.Key.Key_Right, Qt.Key.Key_Down),
    (Qt.Key.Key_Up, Qt.Key.Key_Down, Qt.Key.Key_Left),
    (Qt.Key.Key_Left, Qt.Key.Key_Right, Qt.Key.Key_Up),
    (Qt.Key.Key_Up, Qt.Key.Key_Down, Qt.Key.Key_Right),
)
ARROWS = frozenset({Qt.Key.Key_Left, Qt.Key.Key_Right, Qt.Key.Key_Up, Qt.Key.Key_Down})


class RimHandles(QObject):
    """Edge cuts by their number in :class:`~kirigami_studio.lattice.sheet.RimTable`."""

    hovered = Signal(object)  #: int | None
    selection_changed = Signal()
    grasped = Signal(int, tuple, float)  #: edge cut; place in the world; angle (radians)
    nudged = Signal(int, float)  #: edge cut; change of its position, unit cells

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self.meant: int | None = None  #: pointed at or held
        self.selected: int | None = None  #: acted on by the keyboard

    def select(self, mouth: int | None) -> None:
        """Select this edge cut, or none."""
        if mouth != self.selected:
            self.selected = mouth
            self.selection_changed.emit()

    def point(self, shapes: VoidShapes | None, place: QPointF) -> bool:
        """Find the handle under the pointer; whether there is one.  Without shapes there is none."""
        mouth = None if shapes is None else _rim(shapes).mouth_at(place.x(), place.y())
        if mouth != self.meant:
            self.meant = mouth
            self.hovered.emit(mouth)
        return mouth is not None

    def follow(self, shapes: VoidShapes | None) -> None:
        """Another design is shown: forget an edge cut that it does not have."""
        count = 0 if shapes is None else len(rim_table(*shapes.design.deployment.sheet.grid).mouths)
        if self.selected is not None and self.selected >= count:
            self.select(None)

    def enter(self, shapes: VoidShapes, void: Void, down: int, right: int) -> bool:
        """Select the edge cut nearest to a void when a walk leaves the voids at a side; whether it did."""
        rows, columns = shapes.corners.shape[:2]
        row, column = void[0] + down, void[1] + right
        leaves = (row < 0, column >= columns, row >= rows, column < 0)
        if not any(leaves):
            return False
        mouths = np.flatnonzero(rim_table(rows, columns).side == leaves.index(True))
        if not mouths.size:
            return False
        middle = shapes.corners[void].mean(axis=0)
        distance = np.hypot(*(_rim(shapes).feet[mouths] - middle).T)
        self.select(int(mouths[distance.argmin()]))
        return True

    def take_key(self, event: QKeyEvent, shapes: VoidShapes) -> Void | None:
        """Move the selected edge cut by an arrow key; the void to go on with where the key leads back to the voids."""
        rows, columns = shapes.corners.shape[:2]
        mouth = self.selected
        if mouth is None:
            return None
        side = int(rim_table(rows, columns).side[mouth])
        lower, higher, leave = _KEYS[side]
        key = Qt.Key(event.key())
        step = FINE_STEP if event.modifiers() & Qt.KeyboardModifier.AltModifier else KEY_STEP
        if key in (lower, higher):
            self.nudged.emit(mouth, step if key is higher else -step)
        if key is not leave:
            return None
        middles = shapes.corners.mean(axis=2)
        line = ((0, slice(None)), (slice(None), columns - 1), (rows - 1, slice(None)), (slice(None), 0))[side]
        near = int(np.hypot(*(middles[line] - _rim(shapes).feet[mouth]).T).argmin())
        return ((0, near), (near, columns - 1), (rows - 1, near), (near, 0))[side]

    def paint(self, painter: QPainter, shapes: VoidShapes, palette: Palette) -> None:
        """Draw all handles."""
        paint_mouths(painter, _rim(shapes), self.meant, self.selected, palette)


def _rim(shapes: VoidShapes) -> RimShapes:
    return RimShapes.of(shapes.design, shapes.phi, shapes.transform)
