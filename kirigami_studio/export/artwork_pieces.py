"""Artwork on pieces, in register where a picture is whole: on the open or flat assembly.

A piece is rigid, so that what it shows comes from its picture by one similarity, as on a printed sheet.  Pixels are
printed on its front, a little over its edge; the lines of an SVG are engraved there, and end where it ends.  Layer 1
lies in front: where it covers a piece of layer 2 while the picture is whole, that one gets no lines, and is printed all
the same, so that no bare edge shows beside a pin with play.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import shapely
from shapely.geometry import Point, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.assembly.nesting import LaidShape
from kirigami_studio.assembly.pieces import Assembly, Piece
from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.export.artwork import Artwork, SheetState
from kirigami_studio.export.artwork_patches import (
    MITRE,
    PanelSimilarities,
    Patch,
    bands_across,
    check_bleed,
    patches_of,
)
from kirigami_studio.export.cut_bed import WEB_MM
from kirigami_studio.foundation.arrays import ComplexArray, FloatArray, ShapeRings, as_rings
from kirigami_studio.outlines.pieces import lines_within

if TYPE_CHECKING:
    from kirigami_studio.assembly.posed_pieces import PosedPieces

#: Shorter lines (mm) are left out: they would be dots.
SHORTEST_MM = 0.05
#: Chords of a quarter circle of a hole.
ROUND = 16


@dataclass(frozen=True, eq=False)
class PrintedPieces:
    """The pieces of a design as they are printed, and as they move."""

    posed: PosedPieces  #: with pieces of layers 1 and 2 alone
    target: ShapeRings = None  #: (L, 2), and its holes, world

    @property
    def mm_per_world(self) -> float:
        """Millimetres of one world unit."""
        return self.posed.mm_per_world

    @property
    def phi_target(self) -> float:
        """Angle of the open assembly, radians."""
        return self.posed.design.phi_target

    @cached_property
    def origins(self) -> ComplexArray:
        """Where the frames of the pieces lie in the flat assembly: (P,) mm."""
        return as_plane(self.posed.assembly.poses(math.pi)[:, :2])

    @cached_property
    def areas(self) -> tuple[BaseGeometry, ...]:
        """The pieces with their openings and holes, each in its frame, mm."""
        return tuple(map(_area, self.posed.assembly.pieces))

    @cached_property
    def cells(self) -> tuple[FloatArray, ...]:
        """Outlines (L, 2) in the flat assembly, mm."""
        shifts = as_points(self.origins)
        return tuple(piece.outline + at for piece, at in zip(self.posed.assembly.pieces, shifts, strict=True))

    def motion(self, phi: float) -> PanelSimilarities:
        """How the pieces come from the flat assembly (mm) to the world at an angle."""
        factors, shifts = self.posed.places(phi)
        return PanelSimilarities(factors, shifts - factors * self.origins)

    def places(self, state: SheetState) -> tuple[ComplexArray, ComplexArray]:
        """Factors and shifts (P,) from the frames of the pieces to where a picture is laid."""
        if state is SheetState.FLAT:
            return np.ones(len(self.origins), dtype=np.complex128), self.origins
        return self.posed.places(self.phi_target)

    def box(self, state: SheetState) -> FloatArray:
        """Corners (2, 2) of the box that pictures are laid on: world, or mm of the flat assembly."""
        if state is SheetState.FLAT:
            points = np.concatenate(self.cells)
        else:
            points = np.concatenate([self.posed.points(self.phi_target), *as_rings(self.target)])
        return np.stack([points.min(axis=0), points.max(axis=0)])

    def bands(self, artwork: Artwork) -> BaseGeometry | None:
        """Stripes of the flat assembly that show the second picture; None without one."""
        return None if artwork.second is None else bands_across(np.concatenate(self.cells), artwork.stripes)


def artwork_lines(printed: PrintedPieces, artwork: Artwork) -> dict[str, tuple[FloatArray, ...]]:
    """Lines (P, 2), mm, of artwork on the fronts of pieces, in their frames, by their ids."""
    found: dict[str, list[FloatArray]] = {}
    bands = printed.bands(artwork)
    for number, laid in enumerate(artwork.laid):
        if not laid.picture.lines:
            continue
        a, b = laid.map_into(*printed.box(laid.state))
        lines = [as_points(a * np.conj(as_plane(line)) + b) for line in laid.picture.lines]
        per_unit = 1.0 if laid.state is SheetState.FLAT else printed.mm_per_world
        seen = zip(_seen(printed, laid.state, bands, number), *printed.places(laid.state), strict=True)
        for piece, (area, factor, shift) in zip(printed.posed.assembly.pieces, seen, strict=True):
            own = [line for line in lines_within(lines, area) if per_unit * _length(line) >= SHORTEST_MM]
            if own:
                found.setdefault(piece.id, []).extend(as_points((as_plane(line) - shift) / factor) for line in own)
    return {name: tuple(lines) for name, lines in found.items()}


def with_lines(assembly: Assembly, lines: Mapping[str, tuple[FloatArray, ...]]) -> Assembly:
    """The assembly whose pieces have lines (P, 2), mm, on their fronts, by their ids."""
    pieces = (replace(piece, drawn=lines.get(piece.id, ())) for piece in assembly.pieces)
    return replace(assembly, pieces=tuple(pieces))


def _seen(printed: PrintedPieces, state: SheetState, bands: BaseGeometry | None, number: int) -> list[BaseGeometry]:
    """Parts of pieces that are seen where a picture is laid, without the other picture."""
    factors, shifts = printed.places(state)
    pieces = printed.posed.assembly.pieces
    flat: list[BaseGeometry] = list(printed.areas)
    if bands is not None:
        placed = [_moved(area, 1.0, complex(at)) for area, at in zip(flat, printed.origins, strict=True)]
        shares = shapely.intersection(placed, bands) if number else shapely.difference(placed, bands)
        flat = [_moved(share, 1.0, -complex(at)) for share, at in zip(shares, printed.origins, strict=True)]
    areas = [_moved(area, complex(f), complex(s)) for area, f, s in zip(flat, factors, shifts, strict=True)]
    layers = np.array([piece.layer for piece in pieces])
    front = [
        _moved(Polygon(piece.outline, piece.openings), complex(f), complex(s))
        for piece, f, s in zip(pieces, factors, shifts, strict=True)
    ]
    tree = shapely.STRtree(front)
    covered, covering = tree.query(areas, predicate="intersects")
    for one in np.unique(covered):
        above = covering[(covered == one) & (layers[covering] < layers[one])]
        if len(above):
            areas[one] = shapely.difference(areas[one], shapely.union_all([front[other] for other in above]))
    return areas


def bed_patches(
    printed: PrintedPieces, artwork: Artwork, placed: Mapping[str, LaidShape], bleed_mm: float
) -> tuple[Patch, ...]:
    """The print on the pieces of a bed, in the frame of its cut file.

    Parameters
    ----------
    printed : PrintedPieces
    artwork : Artwork
    placed : mapping of str to LaidShape
        Where pieces lie on the bed, by their ids; others are not on it.
    bleed_mm : float
        How far they are printed beyond their edge: half the way to the next piece at most.

    Raises
    ------
    ExportError
        A bleed that is negative or wider than 20 mm.
    """
    check_bleed(bleed_mm)
    cells = shapely.polygons([Polygon(cell).exterior for cell in printed.cells])
    grown = shapely.buffer(cells, min(bleed_mm, 0.5 * WEB_MM), join_style="mitre", mitre_limit=MITRE)
    found = []
    for patch in patches_of(artwork, printed, grown.tolist()):
        place = placed.get(printed.posed.assembly.pieces[patch.panel].id)
        if place is not None:
            turn, origin = complex(np.exp(1j * place.turn)), complex(printed.origins[patch.panel])
            found.append(patch.moved(turn, complex(*place.shift) - turn * origin))
    return tuple(found)


def posed_patches(printed: PrintedPieces, artwork: Artwork, phi: float) -> tuple[Patch, ...]:
    """Patches of the printed pieces at an angle, in mm, the lowest layer first."""
    flat = [_moved(area, 1.0, complex(at)) for area, at in zip(printed.areas, printed.origins, strict=True)]
    patches = patches_of(artwork, printed, flat)
    motion, scale = printed.motion(phi), printed.mm_per_world
    layers = [piece.layer for piece in printed.posed.assembly.pieces]
    return tuple(
        patch.moved(complex(motion.factor[patch.panel]) * scale, complex(motion.shift[patch.panel]) * scale)
        for patch in sorted(patches, key=lambda one: -layers[one.panel])
    )


def _area(piece: Piece) -> BaseGeometry:
    holes = [
        shapely.get_coordinates(Point(hole.centre).buffer(0.5 * hole.diameter_mm, quad_segs=ROUND))
        for hole in piece.holes
    ]
    whole = Polygon(piece.outline, piece.openings)
    if not holes:
        return whole
    # Holes may reach into openings, so that they are no rings of one polygon.
    bored: BaseGeometry = shapely.difference(whole, shapely.union_all([Polygon(hole) for hole in holes]))
    return bored


def _moved(area: BaseGeometry, factor: complex, shift: complex) -> BaseGeometry:
    moved: BaseGeometry = shapely.transform(area, lambda points: as_points(as_plane(points) * factor + shift))
    return moved


def _length(line: FloatArray) -> float:
    return float(np.hypot(*np.diff(line, axis=0).T).sum())
