"""Solids to print: extruded sheets and tiles, panels on pins that are printed with them.

Outlines are on a grid of a tenth of a micrometre: no two vertices fall together in single precision, which STL has.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from manifold3d import CrossSection, Error, FillRule, Manifold, OpType
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.assembly.backed import BackedSheet
from kirigami_studio.assembly.holding import HoldPlace
from kirigami_studio.assembly.pieces import Assembly
from kirigami_studio.assembly.solids import (
    LAYER_MM,
    ROUNDING_MM,
    TILE_MM,
    Plate,
    PrintForm,
    Printing,
    Solid,
    on_plates,
)
from kirigami_studio.fabricate.checks import finished_pieces
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.fastener import PRINTED_WALL_MM, PrintedPins
from kirigami_studio.fabricate.hold import HoldKind
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment

#: Coordinates of outlines are multiples of the first (mm), and of the second beyond ``LARGE_MM``.
GRID_MM, COARSE_GRID_MM, LARGE_MM = 1e-4, 1e-3, 1000.0
#: Edges of panels on pins that are shorter than this (mm) are none.
SHORTEST_EDGE_MM = 1e-3
#: Width (mm) of slits that take no material away, as blades cut them: something has to be between both sides.
LEAST_SLIT_MM = 0.01
#: Least thickness (mm) of the disc on a pin.
LEAST_WEB_MM = 0.8
#: The disc on a pin and its panel lap over by this much (mm), so that they are one body.
LAPPED_MM = 0.02
#: Room (mm) between the neck of a pin at a seam and its cap, which is glued on; between two caps on their plate.
CAP_FIT_MM, CAP_APART_MM = 0.1, 4.0
#: Segments of a full turn.
ROUND_SEGMENTS = 64
#: Corners sharper than 2 asin(1 / MITRE) = 23 degrees are blunted.
MITRE = 5.0


def print_plates(plan: CutPlan, design: Deployment, phi: float, printing: Printing) -> tuple[Plate, ...]:
    """Make the solids of a sheet or of its tiles, as many plates of them as the bed asks for.

    A sheet is as thick as its material unless asked for.

    Parameters
    ----------
    plan : CutPlan
        Of the sheet; of the hinge layer for tiles.
    design : Deployment
    phi : float, radians
        Target angle.
    printing : Printing

    Raises
    ------
    FabricationError
        A sheet that falls apart, a body larger than the bed, or one whose surface does not close.
    """
    wanted = printing.thickness_mm
    if printing.form is PrintForm.TILES:
        solids = tile_solids(BackedSheet.of(plan, design, phi, printing.tile_sizes), wanted or TILE_MM)
    else:
        solids = sheet_solids(plan, wanted or plan.material.thickness_mm)
    return on_plates(solids, printing.bed_mm)


def sheet_solids(plan: CutPlan, thickness_mm: float) -> Plate:
    """The finished sheet with its slits as wide as they are cut, and its copies.

    Raises
    ------
    FabricationError
        The sheet is not in one piece.
    """
    pieces = finished_pieces(plan, max(plan.kerf_mm, LEAST_SLIT_MM))
    if len(pieces) != 1:
        raise FabricationError("printed.falls_apart", pieces=len(pieces))
    solid = extruded("sheet", 1, pieces[0], thickness_mm)
    return tuple(
        replace(solid.moved(np.array([x, y, 0.0])), name=f"sheet {number}" if number > 1 else "sheet")
        for number, (x, y) in enumerate(plan.copies.places.tolist(), start=1)
    )


def tile_solids(backed: BackedSheet, thickness_mm: float) -> Plate:
    """Tiles as they lie on the flat hinge layer, one body each, named by their numbers.

    Raises
    ------
    FabricationError
        There are none.
    """
    if not backed.flat_tiles:
        raise FabricationError("printed.no_tiles", gap_mm=backed.tile_sizes.gap_mm)
    columns = zip(backed.assembly.pieces, backed.flat_tiles.values(), strict=True)
    return tuple(extruded(piece.id, 1 + sum(piece.panel) % 2, tile, thickness_mm) for piece, tile in columns)


def extruded(name: str, layer: int, region: Polygon, thickness_mm: float) -> Solid:
    """Extrude an area (mm) from z = 0.

    Raises
    ------
    FabricationError
        The surface does not close.
    """
    return solid_of(name, layer, prism(region, thickness_mm), region.area * thickness_mm)


def prism(region: BaseGeometry, thickness_mm: float) -> Manifold:
    """The body over an area (mm), from z = 0."""
    grid = COARSE_GRID_MM if max(map(abs, region.bounds)) > LARGE_MM else GRID_MM
    rings = _rings(region, grid)
    if len(np.unique(np.concatenate(rings), axis=0)) < sum(map(len, rings)):
        # Where the area hangs together in a point alone, four walls would meet in one edge.
        parted = shapely.buffer(shapely.buffer(region, -2.0 * grid, join_style="mitre"), 2.0 * grid, join_style="mitre")
        rings = _rings(parted, grid)
    return Manifold.extrude(CrossSection(rings, FillRule.Positive), thickness_mm)


def _rings(region: BaseGeometry, grid: float) -> list[FloatArray]:
    """Rings (P, 2) of an area on a grid, holes clockwise."""
    tidy = shapely.orient_polygons(shapely.set_precision(region, grid))
    rings = [ring for part in shapely.get_parts(tidy) for ring in (part.exterior, *part.interiors)]
    return [shapely.get_coordinates(ring)[:-1] for ring in rings]


def solid_of(name: str, layer: int, body: Manifold, volume_mm3: float) -> Solid:
    """Turn a body into vertices and faces.

    Raises
    ------
    FabricationError
        Its surface does not close, or it is in several pieces, or in none.
    """
    pieces = 0 if body.status() != Error.NoError else len(body.decompose())
    if pieces != 1:
        raise FabricationError("printed.not_one_body", name=name, pieces=pieces)
    mesh = body.to_mesh64()
    vertices = np.ascontiguousarray(np.asarray(mesh.vert_properties, dtype=np.float64)[:, :3])
    return Solid(name, layer, vertices, np.asarray(mesh.tri_verts, dtype=np.int64), volume_mm3)


# panels on pins that are printed with them ----------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class PinJoint:
    """Two ears that turn on each other about an upright axis, as areas of radius x height.

    The pin of layer 1 stands on the plate: a cone up to its neck, then a wider cone up to the disc that it carries.
    The ear of layer 2 is a ring round it, at the clearance on all sides; it lies on the plate, too.  Whatever hangs
    over rises by the cones' angle from its own body, so that nothing needs support; the neck holds the ring both ways.
    """

    pin: Polygon  #: the body of layer 1
    seam_pin: Polygon  #: the same without its foot, which a cap is, where the ring is printed on another plate
    cap: Polygon  #: the foot, with room for the neck
    round_pin: Polygon  #: what layer 2 leaves out for it
    round_ring: Polygon  #: what layer 1 leaves out for the ring of layer 2

    @classmethod
    def of(cls, pins: PrintedPins, thickness_mm: float) -> PinJoint:
        """Choose heights for panels of a thickness.

        Raises
        ------
        FabricationError
            Panels too thin, or ears too small for a pin that stays in.
        """
        slope, foot = math.tan(math.radians(pins.cone_deg)), cls._foot(pins)
        ear, neck, gap = 0.5 * pins.ear_mm, 0.5 * pins.pin_mm, pins.clearance_mm
        least = cls.least_mm(pins)
        if thickness_mm < least - ROUNDING_MM:
            raise FabricationError(
                "printed.too_thin_for_pins", thickness_mm=thickness_mm, ear_mm=pins.ear_mm, least_mm=least
            )
        # What the thickness has beyond the least makes the lower cone steeper and the disc thicker.
        height = slope * (foot - neck) + 0.5 * (thickness_mm - least)
        above, top = 2.0 * thickness_mm, thickness_mm
        rim = height + slope * (ear - neck)
        disc = ear / math.cos(math.pi / ROUND_SEGMENTS)  # holds all of the ear of its piece
        pin = [(0.0, 0.0), (foot, 0.0), (neck, height), (disc, rim + slope * (disc - ear)), (disc, top), (0.0, top)]
        seam_pin = [(0.0, 0.0), (neck, 0.0), *pin[2:]]
        cap = shapely.intersection(Polygon(pin[:3]), shapely.box(neck + CAP_FIT_MM, 0.0, foot, height))
        high = [(0.0, -above), (foot, -above), (foot, 0.0), (neck, height), (ear, rim), (ear, above), (0.0, above)]
        both = high + [(-x, z) for x, z in reversed(high[1:-1])]
        room = shapely.buffer(Polygon(both), gap, join_style="mitre", mitre_limit=MITRE)
        reach, low = ear + gap, height + LAPPED_MM
        ring = [(0.0, -above), (reach, -above), (reach, low + slope * (reach - neck)), (neck, low), (0.0, low)]
        return cls(
            Polygon(pin),
            Polygon(seam_pin),
            _polygon(cap),
            _polygon(shapely.intersection(room, shapely.box(0.0, -above, 2.0 * ear, above))),
            Polygon(ring),
        )

    @classmethod
    def least_mm(cls, pins: PrintedPins) -> float:
        """Thickness that panels need at least."""
        widths = cls._foot(pins) + 0.5 * pins.ear_mm + pins.clearance_mm - pins.pin_mm
        return math.tan(math.radians(pins.cone_deg)) * widths + LEAST_WEB_MM

    @classmethod
    def usual_mm(cls, pins: PrintedPins, material_mm: float) -> float:
        """Thickness of panels in whole layers, as of the material and enough for the pins."""
        return LAYER_MM * math.ceil(max(cls.least_mm(pins), material_mm) / LAYER_MM - ROUNDING_MM)

    @staticmethod
    def _foot(pins: PrintedPins) -> float:
        """Radius of the pin on the plate: all that the wall of the ring round it leaves."""
        if pins.ear_mm < pins.least_ear_mm - ROUNDING_MM:
            values = {"ear_mm": pins.ear_mm, "pin_mm": pins.pin_mm, "least_mm": pins.least_ear_mm}
            raise FabricationError("printed.ear_too_small", **values)
        return 0.5 * pins.ear_mm - PRINTED_WALL_MM - pins.beside_mm

    def bodies(self) -> tuple[Manifold, Manifold, Manifold, Manifold]:
        """Pin, seam pin, room for a pin and for a ring: the areas turned about the axis.

        No corner of one is at one of the others, nor of an ear of a piece.
        """
        pin, seam_pin, round_pin, round_ring = map(
            _revolved, (self.pin, self.seam_pin, self.round_pin, self.round_ring)
        )
        half = 180.0 / ROUND_SEGMENTS
        round_pin, round_ring = (one.rotate((0.0, 0.0, 0.5 * half)) for one in (round_pin, round_ring))
        return pin.rotate((0.0, 0.0, half)), seam_pin.rotate((0.0, 0.0, half)), round_pin, round_ring


def _polygon(shape: BaseGeometry) -> Polygon:
    """The shape, which is one polygon."""
    (found,) = (part for part in shapely.get_parts(shape) if isinstance(part, Polygon))
    return found


def _revolved(area: Polygon) -> Manifold:
    """An area of radius x height turned about the axis."""
    return Manifold.revolve(CrossSection(_rings(area, GRID_MM), FillRule.Positive), ROUND_SEGMENTS)


def cap_solids(count: int, thickness_mm: float, pins: PrintedPins) -> tuple[Solid, ...]:
    """Caps for pins at seams, side by side."""
    joint = PinJoint.of(pins, thickness_mm)
    body, step = _revolved(joint.cap), 2.0 * joint.cap.bounds[2] + CAP_APART_MM
    columns = math.ceil(math.sqrt(count))
    return tuple(
        solid_of(f"cap {number + 1}", 1, body, body.volume()).moved(
            step * np.array([number % columns, number // columns, 0.0])
        )
        for number in range(count)
    )


def pinned_solids(
    assembly: Assembly,
    thickness_mm: float,
    pins: PrintedPins,
    seams: Collection[int] = (),
    holds: Sequence[HoldPlace] = (),
    pocket_mm: float = 0.0,
) -> tuple[Solid, ...]:
    """Pieces in one plane, in the flat sheet, that turn on pins printed with them.

    Parameters
    ----------
    assembly : Assembly
    thickness_mm : float
    pins : PrintedPins
    seams : collection of int
        Nodes whose pins have no foot, for their rings are printed elsewhere.
    holds : sequence of HoldPlace
        Places that hold the sheet, whose holes are left out.
    pocket_mm : float
        Depth of those for magnets, from the upper face; they go through where no floor would be left.

    Raises
    ------
    FabricationError
        Sizes that do not fit together, or a piece that falls apart.
    """
    pin, seam_pin, round_pin, round_ring = PinJoint.of(pins, thickness_mm).bodies()
    joints: dict[str, list[tuple[FloatArray, bool]]] = {piece.id: [] for piece in assembly.pieces}
    for hinge in assembly.hinges:
        for name, at in zip(hinge.pieces, hinge.at, strict=True):
            joints[name].append((at, hinge.node in seams))
    floor = thickness_mm - pocket_mm
    drills: dict[str, list[Manifold]] = {piece.id: [] for piece in assembly.pieces}
    for place in (one for one in holds if one.hole_mm):
        low = floor if place.kind is HoldKind.MAGNETS and floor >= LEAST_WEB_MM else -thickness_mm
        drill = Manifold.cylinder(2.0 * thickness_mm - low, 0.5 * place.hole_mm, circular_segments=ROUND_SEGMENTS)
        for name, at in zip(place.parts, place.at, strict=True):
            drills[name] += [drill.translate((*point, low)) for point in at.tolist()]
    solids = []
    for piece, (x, y, _) in zip(assembly.pieces, assembly.poses(math.pi), strict=True):
        places = [((*at.tolist(), 0.0), seam) for at, seam in joints[piece.id]]
        taken = round_ring if piece.layer == 1 else round_pin
        body = prism(Polygon(piece.outline, piece.openings), thickness_mm)
        body -= Manifold.batch_boolean([taken.translate(at) for at, _ in places], OpType.Add)
        if piece.layer == 1:
            own = [(seam_pin if seam else pin).translate(at) for at, seam in places]
            body = Manifold.batch_boolean([body, *own], OpType.Add)
        if drills[piece.id]:
            body -= Manifold.batch_boolean(drills[piece.id], OpType.Add)
        # Where surfaces of several bodies nearly meet, vertices lie nearer to each other than STL can tell.
        body = body.as_original().set_tolerance(SHORTEST_EDGE_MM)
        solids.append(solid_of(piece.id, piece.layer, body, body.volume()).moved(np.array([x, y, 0.0])))
    return tuple(solids)
