"""Which vertices of an outline are points that the user drew, and which handles bend the lines between them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.foundation.errors import TargetError

#: Fewest nodes that enclose an area.
FEWEST_NODES = 3


class Kind(Enum):
    """How the line passes a node.

    Both handles of a corner go their own ways; at a smooth node they lie on one line, at a symmetric one they are also
    of one length; an automatic node sets its handles by its neighbours.
    """

    CORNER = "corner"
    SMOOTH = "smooth"
    SYMMETRIC = "symmetric"
    AUTO = "auto"


@dataclass(frozen=True, slots=True, eq=False)
class Nodes:
    """The nodes of one outline, in its order and its coordinates.

    Raises
    ------
    TargetError
        Fewer than three nodes, indices that do not rise, tables of other sizes, or numbers that are not finite.
    """

    #: (K,); index of each node's vertex, rising all the way round; at most one step goes past the last vertex.
    at: IntArray
    kinds: tuple[Kind, ...]  #: K of them
    #: (K, 2, 2), units of the outline; from each node to its handle towards the node before, and to that towards the
    #: next; zero where there is none.
    handles: FloatArray
    #: (K,); whether the line from a node to the next has vertices of its own, traced or read, instead of following the
    #: handles.
    kept: BoolArray

    def __post_init__(self) -> None:
        count = len(self.at)
        shapes = (self.at.shape, len(self.kinds), self.handles.shape, self.kept.shape)
        if count < FEWEST_NODES or shapes != ((count,), count, (count, 2, 2), (count,)):
            raise TargetError("nodes.wrong_tables", fewest=FEWEST_NODES)
        falls = int(np.sum(np.diff(self.at, append=self.at[:1]) <= 0))
        if falls != 1 or self.at.min() < 0:
            raise TargetError("nodes.not_in_order")
        if not np.isfinite(self.handles).all():
            raise TargetError("nodes.handles_not_finite")
        for table in (self.at, self.handles, self.kept):
            table.setflags(write=False)

    def mapped(self, matrix: FloatArray, vertices: int) -> Nodes:
        """The nodes after every point ``p`` became ``p @ matrix`` (2, 2).

        A reflection turns the order of the ``vertices`` of the outline round, to keep it counter-clockwise.
        """
        handles = self.handles @ matrix
        if np.linalg.det(matrix) >= 0:
            return Nodes(self.at, self.kinds, handles, self.kept)
        return Nodes(
            (vertices - 1 - self.at)[::-1].copy(),
            self.kinds[::-1],
            handles[::-1, ::-1].copy(),
            np.roll(self.kept[::-1], -1),
        )

    def _parts(self) -> tuple[bytes, tuple[Kind, ...], bytes, bytes]:
        return self.at.tobytes(), self.kinds, self.handles.tobytes(), self.kept.tobytes()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Nodes) and self._parts() == other._parts()

    def __hash__(self) -> int:
        return hash(self._parts())
