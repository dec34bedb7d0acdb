"""Backed sheets: rigid tiles glued on a soft hinge layer, whose cuts are those of one sheet.

The hinge layer is cut by its ``CutPlan`` as it is.  The board layer is every panel that those cuts leave, smaller by a
gap all round, so that glue has room.  Round every connector a disc of the
board is left out: there the hinge layer has to bend, over the flexure length of the connector.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property

import numpy as np
import shapely
from shapely.geometry import Polygon

from kirigami_studio.assembly.pieces import Assembly, Piece, RoundHole
from kirigami_studio.fabricate.cut_panels import cut_panels
from kirigami_studio.fabricate.cut_path import check_length
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.finished_sheet import BLADE_MM
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.fabricate.strain import ROUNDING_MM, RigidPanels
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment

GAP_MM = 1.0
#: Width (mm) of the frame round the tiles, and diameter of its registration holes.
FRAME_MM, REGISTRATION_MM = 15.0, 3.0
#: Name of the frame among the pieces of the board.
FRAME = "FRAME"
#: A tile in which no disc of this diameter (mm) has room is left out: nobody can glue it.
LEAST_TILE_MM = 1.0
#: Segments of a quarter of a relief disc, and how well the middle of a tile is found (mm).
DISC_SEGMENTS, LABEL_MM = 16, 0.05
#: A number takes this share of the diameter of the largest disc in its tile, and no more than so many mm.
LABEL_SHARE, LARGEST_LABEL_MM = 0.5, 5.0


@dataclass(frozen=True, slots=True)
class TileSizes:
    """Sizes that decide on the tiles.

    Raises
    ------
    FabricationError
        A length below 0.
    """

    gap_mm: float = GAP_MM  #: how much smaller than their finished panels tiles are, all round
    relief_mm: float | None = None  #: radius free of tiles round connectors; None for the length they bend over

    def __post_init__(self) -> None:
        check_length("backed.gap_negative", self.gap_mm, zero_allowed=True)
        if self.relief_mm is not None:
            check_length("backed.relief_negative", self.relief_mm, zero_allowed=True)

    def radii(self, plan: CutPlan) -> FloatArray:
        """Radius (H,), mm, that is left free round each connector of a plan; 0 where it has none."""
        there = ~plan.hinges.removed & (plan.hinges.finished_mm > 0.0)
        radii: FloatArray = np.where(there, plan.hinges.flexure_mm if self.relief_mm is None else self.relief_mm, 0.0)
        return radii


class BoardCut(StrEnum):
    """How tiles are cut; the values stand on the command line and in files."""

    KISS = "kiss"  #: through the board, not its liner: tiles stay in place, what is between them is weeded
    THROUGH = "through"  #: all through: tape over the board keeps tiles in place


@dataclass(frozen=True, slots=True)
class Jig:
    """Frame and pins that keep tiles in register with their hinge layer.

    Raises
    ------
    FabricationError
        A length that is not positive, or holes wider than half of the frame.
    """

    cut: BoardCut = BoardCut.THROUGH
    frame_mm: float = FRAME_MM  #: width of the frame that is cut round the tiles
    pin_mm: float = REGISTRATION_MM  #: diameter of the holes in the frame and in the rest of the hinge layer

    def __post_init__(self) -> None:
        check_length("backed.frame_not_positive", self.frame_mm)
        check_length("backed.pin_not_positive", self.pin_mm)
        if self.pin_mm > 0.5 * self.frame_mm:
            raise FabricationError("backed.pin_too_wide", pin_mm=self.pin_mm, frame_mm=self.frame_mm)


@dataclass(frozen=True, slots=True, eq=False)
class Board:
    """Tiles and their frame on the flat hinge layer: cut file and template for gluing."""

    pieces: tuple[Piece, ...]  #: tiles, then the frame, each in its own frame of coordinates
    places: FloatArray  #: (P, 2) where their origins lie; the lower left corner of the frame is (0, 0)
    layer_at: FloatArray  #: (2,) where the origin of the hinge layer's plan lies
    kissed: frozenset[str]  #: ids of pieces that are not cut through; with them the opening of the frame

    @property
    def registration(self) -> tuple[RoundHole, ...]:
        """Holes to be made in what is left over round the hinge layer, in the frame of its plan."""
        at = self.places[-1] - self.layer_at
        return tuple(replace(hole, centre=hole.centre + at) for hole in self.pieces[-1].holes)


@dataclass(frozen=True, eq=False)
class BackedSheet:
    """A hinge layer and the tiles that are glued on it."""

    plan: CutPlan  #: of the hinge layer
    deployment: Deployment  #: the sheet that the plan cuts
    phi_target: float  #: radians
    tile_sizes: TileSizes

    @classmethod
    def of(
        cls, plan: CutPlan, design: Deployment, phi_target: float = 0.0, tile_sizes: TileSizes | None = None
    ) -> BackedSheet:
        """Back the sheet that is cut by the plan of a design."""
        return cls(plan, plan.cut_from(design), phi_target, tile_sizes or TileSizes())

    @cached_property
    def cell_mm(self) -> float:
        """Size of a unit cell of the lattice, mm."""
        return self.plan.size_mm[0] / float(np.ptp(self.deployment.compact[:, 0]))

    @cached_property
    def shift(self) -> FloatArray:
        """Shift (2,), mm, of the flat deployment into the frame of the plan."""
        nodes = cut_table(*self.deployment.sheet.grid).hinge_node
        found: FloatArray = (self.plan.hinges.position - self.cell_mm * self.deployment.compact[nodes]).mean(axis=0)
        return found

    @cached_property
    def flat_tiles(self) -> dict[tuple[int, int], Polygon]:
        """Tiles in the frame of the plan by the row and column of their panels, in reading order."""
        columns = self.deployment.topology.columns + 1
        panels = cut_panels(self.plan).outlines
        centres = self.plan.hinges.position if self.plan.centres is None else self.plan.centres
        radii = self.tile_sizes.radii(self.plan)
        discs = shapely.buffer(shapely.points(centres[radii > 0.0]), radii[radii > 0.0], quad_segs=DISC_SEGMENTS)
        free = shapely.union_all(discs)
        inset_mm = self.tile_sizes.gap_mm + 0.5 * max(self.plan.kerf_mm, BLADE_MM)
        found = {}
        for number, ring in zip(panels.panel.tolist(), panels.split(panels.points), strict=True):
            inset = shapely.buffer(Polygon(ring), -inset_mm, join_style="mitre")
            largest = max(shapely.get_parts(shapely.difference(inset, free)), key=shapely.area, default=Polygon())
            if not largest.is_empty and _room(largest)[1] >= 0.5 * LEAST_TILE_MM:
                found[divmod(number, columns)] = Polygon(largest.exterior)
        return found

    @cached_property
    def assembly(self) -> Assembly:
        """Tiles as pieces of layer 2, with their numbers.

        The hinge layer joins them: there are no pins.
        """
        corners = self.cell_mm * self.deployment.panels(math.pi) + self.shift
        pieces = []
        for number, (panel, tile) in enumerate(self.flat_tiles.items(), start=1):
            origin = corners[panel].mean(axis=0)
            middle, radius = _room(tile)
            ring = shapely.get_coordinates(shapely.orient_polygons(tile).exterior)[:-1] - origin
            height = min(LABEL_SHARE * 2.0 * radius, LARGEST_LABEL_MM)
            pieces.append(Piece(f"A{number}", 2, panel, ring, label_at=middle - origin, label_mm=height))
        return Assembly(self.deployment, self.cell_mm, self.phi_target, tuple(pieces), ())

    def rigid_panels(self, phi: float, flexure_mm: FloatArray | None = None) -> RigidPanels:
        """Free lengths of all connectors between tiles, for the strain of the hinge layer.

        Parameters
        ----------
        phi : float, radians
        flexure_mm : (H,) float, optional
            Over which strains were found that tiles are to make larger; those of the plan unless given.
        """
        length = self.plan.hinges.flexure_mm if flexure_mm is None else flexure_mm
        gap = self.tile_sizes.gap_mm + 0.5 * max(self.plan.kerf_mm, BLADE_MM)
        free = 2.0 * np.maximum(self.tile_sizes.radii(self.plan), gap)
        return RigidPanels(free, np.maximum(length, ROUNDING_MM), math.pi - phi)

    def board(self, jig: Jig) -> Board:
        """Lay tiles into a frame with registration holes.

        The opening of the frame is the sheet's outline, a gap larger.  Of four holes, one in each corner, one is out of
        line, so that board and hinge layer fit one way only.
        """
        outline = Polygon(self.plan.outline)
        opening = shapely.buffer(outline, max(self.tile_sizes.gap_mm, GAP_MM), join_style="mitre")
        left, bottom, right, top = opening.bounds
        low = np.array([left, bottom]) - jig.frame_mm
        size = np.array([right, top]) + jig.frame_mm - low
        inset = 0.5 * jig.frame_mm
        width, height = size
        corners = ((inset, inset), (width - inset, height - inset), (inset, height - inset))
        holes = (*corners, (width - 3.0 * inset, inset))
        frame = Piece(
            FRAME,
            2,
            (-1, -1),
            np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]]),
            tuple(RoundHole(np.array(hole), jig.pin_mm) for hole in holes),
            (shapely.get_coordinates(shapely.orient_polygons(opening).exterior)[:0:-1] - low,),
            np.array([2.0 * jig.frame_mm, inset]),
            min(LABEL_SHARE * jig.frame_mm, LARGEST_LABEL_MM),
        )
        flat = self.assembly.poses(math.pi)[:, :2] + self.shift - low
        kissed = frozenset(piece.id for piece in self.assembly.pieces) if jig.cut is BoardCut.KISS else frozenset[str]()
        places = np.concatenate([flat, np.zeros((1, 2))])
        return Board((*self.assembly.pieces, frame), places, -low, kissed)

    @property
    def missing(self) -> int:
        """How many panels of the hinge layer have no tile, because nothing is left to glue."""
        return len(cut_panels(self.plan).outlines.panel) - len(self.flat_tiles)

    @property
    def covered(self) -> float:
        """Share of the area of all panels that tiles cover."""
        panels = cut_panels(self.plan).outlines
        whole = sum(Polygon(ring).area for ring in panels.split(panels.points))
        return sum(tile.area for tile in self.flat_tiles.values()) / whole


def _room(tile: Polygon) -> tuple[FloatArray, float]:
    """Middle (2,) and radius of the largest disc in a tile, mm."""
    line = shapely.maximum_inscribed_circle(tile, tolerance=LABEL_MM)
    return shapely.get_coordinates(line)[0], float(line.length)
