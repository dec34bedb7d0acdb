"""Solids to print: extruded sheets and tiles, panels on pins that are printed with them.

Outlines are on a grid of a tenth of a micrometre: no two vertices fall together in single precision, which STL has.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from manifold3d import CrossSection, Error, FillRule, Manifold, OpType
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.assembly.backed import BackedSheet
from kirigami_studio.assembly.solids import (
    LAYER_MM,
    ROUNDING_MM,
    TILE_MM,
    Plate,
    PrintedPins,
    PrintForm,
    Printing,
    Solid,
    on_one_plate,
    on_plates,
)
from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.evaluate.kept_panels import all_panels
from kirigami_studio.fabricate.checks import finished_pieces
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.foundation.arrays import ComplexArray, FloatArray, IntArray
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment

#: Coordinates of outlines are multiples of the first (mm), and of the second beyond ``LARGE_MM``.
GRID_MM, COARSE_GRID_MM, LARGE_MM = 1e-4, 1e-3, 1000.0
#: Edges of panels on pins that are shorter than this (mm) are none.
SHORTEST_EDGE_MM = 1e-3
#: Width (mm) of slits that take no material away, as blades cut them: something has to be between both sides.
LEAST_SLIT_MM = 0.01
#: Walls round printed pins and necks of panels (mm) are two lines of a nozzle of 0.4 mm at least; so much is held at a
#: pin's neck beyond the clearance; the disc on a pin is as thick as this.
LEAST_WALL_MM, HELD_MM, LEAST_WEB_MM = 0.8, 0.1, 0.8
#: The disc on a pin and its panel lap over by this much (mm), so that they are one body.
LAPPED_MM = 0.02
#: Segments of a full turn, and of a full motion; how far (mm) its chords are from the true way, for radii up to 500 mm.
ROUND_SEGMENTS, MOTION_STEPS, SAGITTA_MM = 64, 361, 0.005
#: Corners sharper than 2 asin(1 / MITRE) = 23 degrees are blunted.
MITRE = 5.0
#: A trimmed panel still has its ear where it comes so near (mm) to its node.
REACHED_MM = 1.0


def print_plates(
    plan: CutPlan,
    design: Deployment,
    phi: float,
    printing: Printing,
    kept: Sequence[FloatArray | None] | None = None,
) -> tuple[Plate, ...]:
    """Make the solids of a design, as many plates of them as the bed asks for.

    A sheet is as thick as its material unless asked for.

    Parameters
    ----------
    plan : CutPlan
        Of the sheet; of the hinge layer for tiles.
    design : Deployment
    phi : float, radians
        Target angle.
    printing : Printing
    kept : sequence of (P, 2) float or None, unit cells, optional
        What stays of trimmed panels, row by row.

    Raises
    ------
    FabricationError
        A sheet that falls apart, a body larger than the bed, or one whose surface does not close.
    """
    wanted = printing.thickness_mm
    if printing.form is PrintForm.TILES:
        solids = tile_solids(BackedSheet.of(plan, design, phi, printing.tile_sizes), wanted or TILE_MM)
    elif printing.form is PrintForm.PINNED:
        thickness = wanted or LAYER_MM * math.ceil(PinJoint.least_mm(printing.pins) / LAYER_MM)
        solids = pinned_solids(design, kept, plan.size_mm[0], phi, thickness, printing.pins)
        return on_one_plate(solids, printing.bed_mm)
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
        pin = [(0.0, 0.0), (foot, 0.0), (neck, height), (ear, rim), (ear, top), (0.0, top)]
        high = [(0.0, -above), (foot, -above), (foot, 0.0), (neck, height), (ear, rim), (ear, above), (0.0, above)]
        both = high + [(-x, z) for x, z in reversed(high[1:-1])]
        room = shapely.buffer(Polygon(both), gap, join_style="mitre", mitre_limit=MITRE)
        reach, low = ear + gap, height + LAPPED_MM
        ring = [(0.0, -above), (reach, -above), (reach, low + slope * (reach - neck)), (neck, low), (0.0, low)]
        return cls(
            Polygon(pin),
            _largest(shapely.intersection(room, shapely.box(0.0, -above, 2.0 * ear, above))),
            Polygon(ring),
        )

    @classmethod
    def least_mm(cls, pins: PrintedPins) -> float:
        """Thickness that panels need at least."""
        widths = cls._foot(pins) + 0.5 * pins.ear_mm + pins.clearance_mm - pins.pin_mm
        return math.tan(math.radians(pins.cone_deg)) * widths + LEAST_WEB_MM

    @staticmethod
    def _foot(pins: PrintedPins) -> float:
        """Radius of the pin on the plate: all that the wall of the ring round it leaves."""
        ear, neck = 0.5 * pins.ear_mm, 0.5 * pins.pin_mm
        beside = pins.clearance_mm / math.sin(math.radians(pins.cone_deg))  # of a gap between cones, along the plate
        foot = ear - LEAST_WALL_MM - beside
        if foot < neck + beside + HELD_MM - ROUNDING_MM:
            least = 2.0 * (neck + 2.0 * beside + HELD_MM + LEAST_WALL_MM)
            raise FabricationError("printed.ear_too_small", ear_mm=pins.ear_mm, pin_mm=pins.pin_mm, least_mm=least)
        return foot

    def bodies(self) -> tuple[Manifold, Manifold, Manifold]:
        """The three areas turned about the axis; no corner of the first is at one of the others."""
        pin, round_pin, round_ring = (
            Manifold.revolve(CrossSection(_rings(area, GRID_MM), FillRule.Positive), ROUND_SEGMENTS)
            for area in (self.pin, self.round_pin, self.round_ring)
        )
        return pin.rotate((0.0, 0.0, 180.0 / ROUND_SEGMENTS)), round_pin, round_ring


def pinned_solids(
    deployment: Deployment,
    kept: Sequence[FloatArray | None] | None,
    width_mm: float,
    phi: float,
    thickness_mm: float,
    pins: PrintedPins,
) -> Plate:
    """Panels in the flat sheet that turn on pins printed with them.

    A body for each, named A1 ... in layer 1 and B1 ... in layer 2.

    Parameters
    ----------
    deployment : Deployment
    kept : sequence of (P, 2) float or None, unit cells
        What stays of trimmed panels, row by row, as a trim has it; None for an untrimmed sheet.
    width_mm : float
        Of the flat sheet, without ears that stick out.
    phi : float, radians
        Target angle: to there the panels turn freely.
    thickness_mm : float
    pins : PrintedPins

    Raises
    ------
    FabricationError
        Sizes that do not fit together, pins that come too near to each other, or panels that fall apart.
    """
    joint = PinJoint.of(pins, thickness_mm)
    motion = _SeenMotion.of(deployment, width_mm, phi)
    regions = motion.panel_areas(kept, pins)
    hinges = motion.hinges([not region.is_empty for region in regions], regions)
    motion.check_distances(hinges, pins.apart_mm)
    _check_connected(hinges, regions)
    pin, round_pin, round_ring = joint.bodies()
    solids, number = [], [0, 0]
    for index, region in enumerate(regions):
        if region.is_empty:
            continue
        layer = int(motion.layer[index])
        number[layer - 1] += 1
        name = f"{'AB'[layer - 1]}{number[layer - 1]}"
        own = [motion.flat[node] for node, pair in hinges.items() if index in pair]
        area = motion.printed_area(index, region, hinges, pins)
        if area is None:
            raise FabricationError("printed.panel_too_small", name=name)
        places = [(float(x), float(y), 0.0) for x, y in own]
        taken = Manifold.batch_boolean(
            [(round_ring if layer == 1 else round_pin).translate(place) for place in places], OpType.Add
        )
        body = prism(area, thickness_mm) - taken
        if layer == 1:
            body = Manifold.batch_boolean([body, *(pin.translate(place) for place in places)], OpType.Add)
        # Where surfaces of several bodies nearly meet, vertices lie nearer to each other than STL can tell.
        body = body.as_original().set_tolerance(SHORTEST_EDGE_MM)
        solids.append(solid_of(name, layer, body, body.volume()))
    return tuple(solids)


@dataclass(frozen=True, slots=True, eq=False)
class _SeenMotion:
    """Nodes over the motion, as they are seen from panels."""

    nodes: ComplexArray  #: (S, N) mm, of every node at each of S angles, from flat to the target
    turns: FloatArray  #: (S,) radians, of panels of layer 1, clockwise; those of layer 2 turn the other way
    panels: IntArray  #: (P, 4) nodes of every panel, row by row
    layer: IntArray  #: (P,) 1 for panels with I + J even, 2 for the others
    flat: FloatArray  #: (N, 2) mm, nodes of the flat sheet
    cell_mm: float

    @classmethod
    def of(cls, deployment: Deployment, width_mm: float, phi: float) -> _SeenMotion:
        cell_mm = width_mm / float(np.ptp(deployment.compact[:, 0]))
        angles = np.linspace(math.pi, phi, MOTION_STEPS)
        panels = all_panels(*deployment.sheet.grid)
        return cls(
            np.array([as_plane(deployment.nodes(angle)) * cell_mm for angle in angles]),
            0.5 * (math.pi - angles),
            panels.corners,
            np.where(panels.even, 1, 2),
            deployment.compact * cell_mm,
            cell_mm,
        )

    def panel_areas(self, kept: Sequence[FloatArray | None] | None, pins: PrintedPins) -> list[Polygon]:
        """Panels of the flat sheet, trimmed where they are, smaller by half the clearance all round."""
        corners = self.flat[self.panels]
        parts = kept or [None] * len(corners)
        rings = [whole if part is None else part * self.cell_mm for part, whole in zip(parts, corners, strict=True)]
        areas = [Polygon(ring) if len(ring) > 2 else Polygon() for ring in rings]
        return [_largest(area.buffer(-0.5 * pins.clearance_mm, join_style="mitre")) for area in areas]

    def hinges(self, there: Sequence[bool], regions: Sequence[Polygon]) -> dict[int, tuple[int, int]]:
        """The two panels that hang together at each node, that of layer 1 first.

        Nodes that trimming took from one of them are left out.
        """
        found: dict[int, list[int]] = {}
        for index in np.flatnonzero(there).tolist():
            for node in self.panels[index].tolist():
                if regions[index].distance(shapely.Point(self.flat[node])) < REACHED_MM:
                    found.setdefault(node, []).append(index)
        pairs = {node: sorted(both, key=lambda one: int(self.layer[one])) for node, both in found.items()}
        return {node: (both[0], both[1]) for node, both in sorted(pairs.items()) if len(both) == 2}

    def check_distances(self, hinges: Mapping[int, tuple[int, int]], apart_mm: float) -> None:
        """Refuse pins that come nearer to each other than their ears have room for."""
        places = self.nodes[:, list(hinges)]
        nearest = math.inf
        for moment in places:
            tree = shapely.STRtree([shapely.Point(place) for place in as_points(moment)])
            found = tree.query_nearest(tree.geometries, exclusive=True, return_distance=True, all_matches=False)[1]
            nearest = min(nearest, float(found.min(initial=math.inf)))
        if nearest < apart_mm - ROUNDING_MM:
            raise FabricationError("printed.pins_too_near", apart_mm=nearest, needed_mm=apart_mm)

    def printed_area(
        self, index: int, region: Polygon, hinges: Mapping[int, tuple[int, int]], pins: PrintedPins
    ) -> BaseGeometry | None:
        """A panel with its ears, less all that other ears sweep.

        None where it does not hang together with its own.
        """
        sense = 1.0 if self.layer[index] == 1 else -1.0
        others = [node for node, pair in hinges.items() if index not in pair]
        own = [node for node, pair in hinges.items() if index in pair]
        corner = int(self.panels[index][0])
        back = np.exp(1j * sense * self.turns)[:, None]
        seen = (self.nodes[:, others] - self.nodes[:, [corner]]) * back + complex(*self.flat[corner])
        ways = np.array([shapely.LineString(as_points(way)) for way in seen.T], dtype=object)
        radius = 0.5 * pins.ear_mm + pins.clearance_mm + SAGITTA_MM
        near = ways[shapely.distance(ways, region) < radius]
        angles = 2.0 * math.pi * (np.arange(ROUND_SEGMENTS) + 0.5) / ROUND_SEGMENTS  # as the pins have them
        disc = 0.5 * pins.ear_mm * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        ears = [Polygon(place + disc) for place in self.flat[own]]
        rest = shapely.difference(region, shapely.union_all(shapely.buffer(near, radius)))
        whole = shapely.union_all([rest, *ears])
        core = shapely.buffer(whole, -0.5 * LEAST_WALL_MM, join_style="mitre", mitre_limit=MITRE)
        for part in shapely.get_parts(shapely.buffer(core, 0.5 * LEAST_WALL_MM, join_style="mitre", mitre_limit=MITRE)):
            if np.all(shapely.contains_xy(part, self.flat[own])):
                # Sides that nearly coincide cross in stray vertices, which no ear may have; pins bring their own ears.
                shape = shapely.simplify(shapely.intersection(part, rest), SHORTEST_EDGE_MM)
                return shape if self.layer[index] == 1 else shapely.union_all([shape, *ears])
        return None


def _largest(shape: BaseGeometry) -> Polygon:
    return max(shapely.get_parts(shape), key=shapely.area, default=Polygon())


def _check_connected(hinges: Mapping[int, tuple[int, int]], regions: Sequence[Polygon]) -> None:
    """Refuse panels that do not all hang together."""
    there = {index for index, region in enumerate(regions) if not region.is_empty}
    group = {index: index for index in there}

    def leader(index: int) -> int:
        while group[index] != index:
            index = group[index]
        return index

    for one, other in hinges.values():
        group[leader(other)] = leader(one)
    if (parts := len({leader(index) for index in there})) != 1:
        raise FabricationError("printed.loose_parts", parts=parts)
