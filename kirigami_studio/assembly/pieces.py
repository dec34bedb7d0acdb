"""Pieces of an assembly, the pins that join them, and their poses over the exact motion.

A piece has a frame of its own: its origin is the mean of its panel's four corners, its axes are those of the flat
sheet, in mm, y up.  At angle phi, with 2a = pi - phi, pieces of panels with I + J even have turned by -a and the others
by +a (Eq. 1), so that those of one layer never turn against each other.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kirigami_studio.foundation.arrays import FloatArray, IntArray
from kirigami_studio.lattice.deployment import Deployment, check_phi, rotate


@dataclass(frozen=True, slots=True, eq=False)
class RoundHole:
    """A drilled hole.

    Attributes
    ----------
    centre : (2,) float, mm
        In the frame of its piece.
    diameter_mm : float
        Finished.
    """

    centre: FloatArray
    diameter_mm: float


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """One rigid part, as it is finished.

    Attributes
    ----------
    id : str
        ``A1``: the letter of its layer and a number in reading order of the flat sheet.
    layer : int
        1 for panels with I + J even, 2 for the others.
    panel : (I, J)
    outline : (L, 2) float, mm
        Counter-clockwise, not closed, in the frame of the piece.
    holes : tuple of RoundHole
        For pins, and for all that holds it open or flat.
    openings : tuple of (K, 2) float, mm
        Further holes, clockwise, not closed.
    label_at : (2,) float, mm
        Where its number has most room.
    label_mm : float
        Largest height of the number there.
    marks : tuple of (K, 2) float, mm
        Open lines to engrave, where tabs are stuck on.
    drawn : tuple of (K, 2) float, mm
        Lines of artwork on its front; a closed one repeats its first point.
    pivot : (2,) float or None, mm
        Of an arm: its origin in the frame of its panel's piece, about which it turns as the other layer does.
    """

    id: str
    layer: int
    panel: tuple[int, int]
    outline: FloatArray
    holes: tuple[RoundHole, ...] = ()
    openings: tuple[FloatArray, ...] = ()
    label_at: FloatArray | tuple[float, float] = (0.0, 0.0)
    label_mm: float = 3.0
    marks: tuple[FloatArray, ...] = ()
    drawn: tuple[FloatArray, ...] = ()
    pivot: FloatArray | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Hinge:
    """A pin through two pieces.

    Attributes
    ----------
    pieces : (str, str)
        Ids, the one of layer 1 first.
    at : pair of (2,) float, mm
        Where it is in the frame of each.
    node : int
        The node of the lattice.
    """

    pieces: tuple[str, str]
    at: tuple[FloatArray, FloatArray]
    node: int


@dataclass(frozen=True, eq=False)
class Assembly:
    """Pieces and pins of one design.

    Attributes
    ----------
    deployment : Deployment
    cell_mm : float
        Of a unit cell of the lattice.
    phi_target : float, radians
    pieces : tuple of Piece
    hinges : tuple of Hinge
    """

    deployment: Deployment
    cell_mm: float
    phi_target: float
    pieces: tuple[Piece, ...]
    hinges: tuple[Hinge, ...]

    @cached_property
    def by_id(self) -> Mapping[str, Piece]:
        """Pieces by their ids."""
        return {piece.id: piece for piece in self.pieces}

    @cached_property
    def numbers(self) -> IntArray:
        """Numbers (P,) of the pieces' panels in the sheet, row by row."""
        rows, columns = np.array([piece.panel for piece in self.pieces], dtype=np.int64).T
        return np.asarray(rows * (self.deployment.topology.columns + 1) + columns)

    def piece_on(self, panel: int) -> Piece:
        """The first piece on the panel of a number."""
        return self.pieces[int(np.argmax(self.numbers == panel))]

    @property
    def left_out(self) -> int:
        """How many nodes that two panels with pieces share have no pin."""
        nodes = self.deployment.topology.panel_nodes.reshape(-1, 4)[np.unique(self.numbers)]
        return int(np.count_nonzero(np.bincount(nodes.ravel()) > 1)) - len(self.hinges)

    def poses(self, phi: float) -> FloatArray:
        """Place of every piece at angle ``phi``, in the order of the pieces.

        Returns
        -------
        poses : (P, 3) float
            Shift x, shift y (mm, frame of the deployment) and turn (radians, counter-clockwise); a piece is turned
            about its origin, then shifted.
        """
        half = 0.5 * (math.pi - check_phi(phi))
        rows, columns = np.array([piece.panel for piece in self.pieces], dtype=np.int64).T
        origins = self.deployment.panels(phi)[rows, columns].mean(axis=1) * self.cell_mm
        turns = np.where((rows + columns) % 2 == 0, -half, half)
        for index, piece in enumerate(self.pieces):
            if piece.pivot is not None:
                origins[index] += rotate(piece.pivot, turns[index])
                turns[index] = -turns[index]
        return np.column_stack([origins, turns])

    def placing(self, phi: float) -> Callable[[Piece, FloatArray], FloatArray]:
        """Return the function that carries points (..., 2) of pieces to places at ``phi``, mm."""
        poses = dict(zip(self.pieces, self.poses(phi).tolist(), strict=True))

        def placed(piece: Piece, points: FloatArray) -> FloatArray:
            x, y, turn = poses[piece]
            return np.asarray(rotate(points, turn) + np.array([x, y]))

        return placed

    def placed(self, piece: Piece, points: FloatArray, phi: float) -> FloatArray:
        """Carry points (..., 2) of a piece's frame to their places at ``phi``, mm."""
        return self.placing(phi)(piece, points)
