"""Backed sheets: rigid tiles glued on a soft hinge layer, whose cuts are those of one sheet.

The hinge layer is cut by its ``CutPlan`` as it is.  The board layer is every panel that those cuts leave, smaller by a
gap all round, so that glue has room.  Round every connector a disc of the
board is left out: there the hinge layer has to bend, over the flexure length of the connector.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import shapely
from shapely.geometry import Polygon

from kirigami_studio.assembly.pieces import Assembly, Piece, RoundHole
from kirigami_studio.fabricate.cut_panels import cut_panels
from kirigami_studio.fabricate.cut_path import check_length
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.options import BoardCut
from kirigami_studio.fabricate.slits import cut_table
from kirigami_studio.fabricate.strain import RigidPanels
from kirigami_studio.fabricate.tiles import GAP_MM
from kirigami_studio.fabricate.tiles import TileSizes as TileSizes
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment

#: Width (mm) of the frame round the tiles, and diameter of its registration holes.
FRAME_MM, REGISTRATION_MM = 15.0, 3.0
#: Name of the frame among the pieces of the board.
FRAME = "FRAME"
#: A tile in which no disc of this diameter (mm) has room is left out: nobody can glue it.
LEAST_TILE_MM = 1.0
#: Parts smaller than this share of an eroded tile are its corners; necks are left out with some room.
CORNER_SHARE, SAFE = 0.02, 1.02
#: Segments of a quarter of a relief disc, and how well the middle of a tile is found (mm).
DISC_SEGMENTS, LABEL_MM = 16, 0.05
#: A number takes this share of the diameter of the largest disc in its tile, and no more than so many mm.
LABEL_SHARE, LARGEST_LABEL_MM = 0.5, 5.0


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
    kissed: frozenset[str]  #: ids of pieces that are not cut through

    @property
    def size_mm(self) -> tuple[float, float]:
        """Width and height of the frame."""
        width, height = self.pieces[-1].outline.max(axis=0).tolist()
        return width, height

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
        radii = self.tile_sizes.radii(self.plan.hinges)
        discs = shapely.buffer(shapely.points(centres[radii > 0.0]), radii[radii > 0.0], quad_segs=DISC_SEGMENTS)
        free = shapely.union_all(discs)
        inset_mm = self.tile_sizes.inset_mm(self.plan.kerf_mm)
        found = {}
        for number, ring in zip(panels.panel.tolist(), panels.split(panels.points), strict=True):
            # Bows reach beyond the lattice's own panel, which passes all others; its tile does not.
            both = [shapely.make_valid(Polygon(points)) for points in (ring, self.plan.panels[number])]
            inset = shapely.intersection(*shapely.buffer(both, -inset_mm, join_style="mitre"))
            largest = max(shapely.get_parts(shapely.difference(inset, free)), key=shapely.area, default=Polygon())
            largest = without_necks(largest, self.tile_sizes.least_mm)
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
        """Free lengths of all connectors between tiles, see :meth:`TileSizes.rigid_panels`."""
        return self.tile_sizes.rigid_panels(self.plan.hinges, self.plan.kerf_mm, phi, flexure_mm)

    def jig(self, cut: BoardCut, beds: Sequence[tuple[float, float]]) -> Jig:
        """The widest frame, up to the usual one, for beds (width, height; mm, 0 for any)."""
        size = np.ptp(self.plan.outline, axis=0) + 2.0 * max(self.tile_sizes.gap_mm, GAP_MM)
        room = [
            max(0.5 * min(across - size[0], along - size[1]) for across, along in (bed, bed[::-1]))
            for bed in beds
            if min(bed) > 0.0
        ]
        return Jig(cut, float(np.clip(min(room, default=FRAME_MM), 2.0 * REGISTRATION_MM, FRAME_MM)))

    @property
    def between_mm(self) -> float:
        """Distance between the edges of two tiles whose panels meet."""
        return 2.0 * self.tile_sizes.inset_mm(self.plan.kerf_mm)

    def board(self, jig: Jig, assembly: Assembly | None = None) -> Board:
        """Lay tiles, as they are or as pieces of another assembly, into a frame with registration holes.

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
        tiles = (assembly or self.assembly).pieces
        flat = self.assembly.poses(math.pi)[:, :2] + self.shift - low
        kissed = frozenset(piece.id for piece in tiles) if jig.cut is BoardCut.KISS else frozenset[str]()
        places = np.concatenate([flat, np.zeros((1, 2))])
        return Board((*tiles, frame), places, -low, kissed)

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


def core(tile: Polygon, width_mm: float) -> tuple[Polygon, bool]:
    """Rest of a tile half a width off its edge, and whether that is one part, but for corners."""
    parts = shapely.get_parts(shapely.buffer(tile, -0.5 * width_mm))
    areas = shapely.area(parts)
    if not len(parts):
        return Polygon(), False
    return parts[int(np.argmax(areas))], int(np.sum(areas > CORNER_SHARE * areas.sum())) == 1


def without_necks(tile: Polygon, width_mm: float) -> Polygon:
    """The largest part of a tile that is nowhere narrower than a width, mm."""
    if width_mm <= 0.0 or tile.is_empty:
        return tile
    wide, whole = core(tile, SAFE * width_mm)
    if whole:
        return tile
    opened = shapely.intersection(tile, shapely.buffer(wide, 0.5 * SAFE * width_mm, quad_segs=DISC_SEGMENTS))
    return max((part for part in shapely.get_parts(opened)), key=shapely.area, default=Polygon())


def _room(tile: Polygon) -> tuple[FloatArray, float]:
    """Middle (2,) and radius of the largest disc in a tile, mm."""
    line = shapely.maximum_inscribed_circle(tile, tolerance=LABEL_MM)
    return shapely.get_coordinates(line)[0], float(line.length)
