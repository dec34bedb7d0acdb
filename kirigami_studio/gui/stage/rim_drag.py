"""An edge cut that slides along its side of the sheet, between its two neighbours."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.gui.stage.rim_items import mouth_places
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.sheet import Rim, RimPath, Sheet, replace_sheet, rim_table

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
    return replace_sheet(sheet, rim=Rim.moved(*sheet.grid, offsets))


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

    Attributes
    ----------
    mouth : int
    place : (x, y) float, world
        Where the drag began.
    position : float, unit cells
        Of the cut at that time.
    motion : (2,) float, world
        How far it moves when its position grows by one cell.
    """

    mouth: int
    place: tuple[float, float]
    position: float
    motion: FloatArray

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
