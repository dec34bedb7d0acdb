"""A round start kept round: what the chords between mouths cut off, or add, may not grow much when mouths move.

Evenly spaced mouths cut off least; a fit that gathers them would leave long chords elsewhere.  The term is the square
of what is cut off beyond that and a little more, as a share of the start's area.  Its weight is the user's wish, see
``outlines.starts.StartShape``: a softer start gives way where that helps the match.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.sheet import RimPath, rim_table

#: Weight of the square of the share that is cut off beyond what is allowed, for a start of weight 1: a thousandth of
#: the area then weighs six times as much as the whole mismatch of a good fit, and round sheets stay within half a
#: percent of their start.
WEIGHT = 600.0
#: The same for a start with hollows.  Chords take and add more there anyway, and held like a disk, fits miss too much:
#: ten such starts open into a circle at a mean exact IoU of 0.990, a leaf at 0.988, instead of 0.981 and 0.914, for
#: 0.2 % more of the start's area at most.
HOLLOW_WEIGHT = 6.0
#: What may be cut off in any case, as a share of the area; where even mouths cut off more, as much as they do.
ALLOWED = 0.008
#: A start that loses no more than this (share of its area) has straight sides and its corners at mouths.
STRAIGHT = 1e-4


@dataclass(frozen=True, slots=True, eq=False)
class Chords:
    """The term for one grid and start outline."""

    path: RimPath
    area: float  #: unit cells squared; of the start outline
    allowed: float  #: share of it that may be cut off, or added across hollows
    weight: float  #: of the square of what is cut off beyond that

    @classmethod
    def of(cls, path: RimPath, start_weight: float = 1.0) -> Chords | None:
        """The term, for a start of some weight; None for a start that chords do not cut, such as a rectangle."""
        if path.start is None:
            return None
        area = _area(path.outline())
        shares = path.cut_off(rim_table(path.rows, path.columns).even) / area
        even, added = float(np.abs(shares).sum()), -float(shares[shares < 0.0].sum())
        weight = HOLLOW_WEIGHT if added > STRAIGHT else WEIGHT
        return cls(path, area, max(even, ALLOWED), start_weight * weight) if even > STRAIGHT else None

    def excess(self, positions: FloatArray) -> float:
        """Share of the area that is cut off or added beyond what is allowed, with the mouths at ``positions`` (R,)."""
        return max(0.0, float(np.abs(self.path.cut_off(positions)).sum()) / self.area - self.allowed)

    def slopes(self, positions: FloatArray) -> FloatArray:
        """Derivative (R,) of the share that is cut off or added by the mouths' positions."""
        points, sign = self.path.anchors(positions), np.sign(self.path.cut_off(positions))
        chord = np.roll(points, -1, axis=0) - points
        mouths, weighed = rim_table(*self.grid).mouths, sign[:, None] * chord
        across = (weighed + np.roll(weighed, 1, axis=0))[mouths]
        along = self.path.slopes(positions)
        # Clockwise, the area inside a chord grows by half of what its ends move to its left.
        grown = 0.5 * (across[:, 0] * along[:, 1] - across[:, 1] * along[:, 0])
        return np.asarray(-grown / self.area)

    @property
    def grid(self) -> tuple[int, int]:
        """(rows, columns) of voids."""
        return self.path.rows, self.path.columns


def _area(points: FloatArray) -> float:
    """Area of a polygon (P, 2) that runs clockwise."""
    after = np.roll(points, -1, axis=0)
    return 0.5 * float(np.sum(points[:, 1] * after[:, 0] - points[:, 0] * after[:, 1]))
