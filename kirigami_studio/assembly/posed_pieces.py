"""Pieces over their target at any angle, layer by layer, in the look of their material.

Windows, bitmaps and drawings take outlines, places and colours from here.  An assembly may have any number of layers,
and no pins: then it has no heads.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from kirigami_studio.evaluate.boundary import as_plane, as_points
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.fabricate.fastener import Fastener
from kirigami_studio.foundation.arrays import ComplexArray, FloatArray, ShapeRings, as_rings

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry

    from kirigami_studio.assembly.backed import BackedSheet
    from kirigami_studio.assembly.holding import HoldPlace
    from kirigami_studio.assembly.pieces import Assembly, Piece
    from kirigami_studio.assembly.pinned import PinnedPlan
    from kirigami_studio.fabricate.material import Material

#: Red, green, blue from 0 to 255.
Shade = tuple[int, int, int]
#: Faces of sheets by the first word of their material's key, and of all others.
FACES: Mapping[str, Shade] = MappingProxyType(
    {
        "plywood": (228, 197, 150),
        "acrylic": (150, 205, 222),
        "card": (236, 226, 203),
        "paper": (246, 242, 232),
        "felt": (196, 92, 84),
        "eva": (104, 146, 178),
        "leather": (172, 118, 76),
        "cotton": (226, 219, 204),
        "foil": (201, 205, 210),
        "film": (226, 178, 92),
        "pla": (122, 170, 204),
        "petg": (140, 190, 172),
    }
)
USUAL_FACE: Shade = (212, 214, 218)
#: Heads of brass, and of steel.
BRASS: Shade = (206, 165, 74)
STEEL: Shade = (176, 182, 189)
STEEL_PINS = frozenset({Fastener.M2, Fastener.M3, Fastener.RIVET})
#: How bright the lowest layer is, lying in the shade of the others, lines round faces, and what stands on them, against
#: the top.
LOWEST, LINE, NUMBER = 0.86, 0.52, 0.25
#: The rim of a head, and the spot of light on it.
HEAD_RIM, GLINT = 0.62, 1.28
#: Shadows fall so far, in thicknesses of a layer.
FALL = 0.9
#: Number of the layer under tiles, which are layer 2.
CLOTH = 3
#: Small pictures, and drawings, leave out what is finer than these shares of a sheet's width.
SMALL, FINE = 1.0 / 800.0, 1.0 / 8000.0


def shaded(colour: Shade, light: float) -> Shade:
    """A colour in more light, or less."""
    red, green, blue = (min(255, round(part * light)) for part in colour)
    return red, green, blue


def face_of(material: Material) -> Shade:
    """Colour of sheets of a material."""
    return FACES.get(material.key.split("-")[0], USUAL_FACE)


@dataclass(frozen=True, slots=True)
class PieceLook:
    """Colours of pieces and of their pins."""

    face: Shade = USUAL_FACE
    head: Shade = BRASS
    thickness_mm: float = 3.0  #: of a layer, which decides how far its shadow falls
    under: Shade | None = None  #: the lowest layer where it is of another material

    @classmethod
    def of(cls, material: Material, fastener: Fastener, *, in_one_plane: bool = False) -> PieceLook:
        """The look of pieces of a material; those in one plane have pins of it, and cast no shadows."""
        face = face_of(material)
        if in_one_plane:
            return cls(face, face, 0.0)
        return cls(face, STEEL if fastener in STEEL_PINS else BRASS, material.thickness_mm)

    def layer(self, place: int, count: int) -> Shade:
        """Face of one of so many layers, the lowest being at 0."""
        if self.under is not None:
            return self.face if place else self.under
        return shaded(self.face, 1.0 if place + 1 >= count else LOWEST + (1.0 - LOWEST) * place / (count - 1))

    @property
    def line(self) -> Shade:
        """Of the edges of pieces."""
        return shaded(self.face, LINE)

    @property
    def number(self) -> Shade:
        """Of what stands on faces."""
        return shaded(self.face, NUMBER)


@dataclass(frozen=True, eq=False)
class PosedPieces:
    """The pieces of a design over its target."""

    assembly: Assembly
    design: PosedDesign  #: the lattice of the pieces: smaller than that of the design by their margin
    look: PieceLook
    head_mm: float = 0.0  #: diameter of the heads of pins; 0 for none
    holds: tuple[HoldPlace, ...] = ()  #: places that hold it in its end states
    grips: tuple[int, int] | None = None  #: panels to hold and to pull, row by row

    @classmethod
    def of(
        cls,
        plan: PinnedPlan,
        material: Material,
        fastener: Fastener = Fastener.BRAD,
        holds: tuple[HoldPlace, ...] = (),
    ) -> PosedPieces:
        """The pieces of a pinned or printed design."""
        assembly, options = plan.assembly, plan.options
        design = PosedDesign(assembly.deployment, plan.pose, assembly.phi_target)
        look = PieceLook.of(material, fastener, in_one_plane=options.in_one_plane)
        return cls(assembly, design, look, options.pin_mm if options.in_one_plane else options.head_mm, holds)

    @classmethod
    def on_cloth(
        cls,
        sheet: BackedSheet,
        tiles: Assembly,
        design: PosedDesign,
        board: Material,
        holds: tuple[HoldPlace, ...] = (),
    ) -> PosedPieces:
        """Tiles of a board on the panels of their hinge layer.

        Parameters
        ----------
        sheet : BackedSheet
        tiles : Assembly
            Of that sheet, with their holes.
        design : PosedDesign
            Of the sheet that is cut.
        board : Material
        holds : tuple of HoldPlace
        """
        from kirigami_studio.assembly.pieces import Piece
        from kirigami_studio.fabricate.cut_panels import cut_panels

        panels, columns = cut_panels(sheet.plan).outlines, sheet.deployment.topology.columns + 1
        corners = sheet.cell_mm * sheet.deployment.panels(np.pi) + sheet.shift
        rings = zip(panels.panel.tolist(), panels.split(panels.points), strict=True)
        cloth = [
            Piece(f"H{number}", CLOTH, divmod(number, columns), ring - corners[divmod(number, columns)].mean(axis=0))
            for number, ring in rings
        ]
        look = replace(PieceLook.of(board, Fastener.BRAD), under=face_of(sheet.plan.material))
        return cls(replace(tiles, pieces=(*cloth, *tiles.pieces)), design, look, 0.0, holds)

    @property
    def mm_per_world(self) -> float:
        """Millimetres of one world unit."""
        return self.assembly.cell_mm / self.design.pose.scale

    @property
    def shadow(self) -> float:
        """How far the shadow of a layer falls, world."""
        return FALL * self.look.thickness_mm / self.mm_per_world

    @cached_property
    def layers(self) -> tuple[tuple[int, ...], ...]:
        """Places of the pieces in the assembly by layers, the lowest first and layer 1 in front."""
        numbers = np.array([piece.layer for piece in self.assembly.pieces])
        return tuple(tuple(np.flatnonzero(numbers == layer).tolist()) for layer in np.unique(numbers)[::-1])

    @cached_property
    def _pins(self) -> tuple[list[int], ComplexArray]:
        """The upper piece of each pin, and where it is in that piece's frame (mm)."""
        place = {piece.id: number for number, piece in enumerate(self.assembly.pieces)}
        uppermost = [place[hinge.pieces[0]] for hinge in self.assembly.hinges]
        at = np.array([hinge.at[0] for hinge in self.assembly.hinges]).reshape(-1, 2)
        return uppermost, as_plane(at)

    def places(self, phi: float) -> tuple[ComplexArray, ComplexArray]:
        """Factors and shifts (P,) from frames of pieces (x + iy, mm) into the world, at an angle."""
        pose, poses = self.design.pose_at(phi), self.assembly.poses(phi)
        per_mm = pose.factor / self.assembly.cell_mm
        return per_mm * np.exp(1j * poses[:, 2]), per_mm * as_plane(poses[:, :2]) + complex(*pose.shift)

    def rings(self, phi: float) -> list[list[FloatArray]]:
        """Outline, openings and holes of every piece at an angle, each ring (L, 2) in the world."""
        factors, shifts = self.places(phi)
        return [
            [as_points(factor * as_plane(ring) + shift) for ring in rings]
            for rings, factor, shift in zip(self._own_rings, factors, shifts, strict=True)
        ]

    @cached_property
    def _own_rings(self) -> list[list[FloatArray]]:
        return [rings_of(piece) for piece in self.assembly.pieces]

    def outlines(self, phi: float) -> list[FloatArray]:
        """The outline (L, 2) of every piece at an angle, world."""
        return [rings[0] for rings in self.rings(phi)]

    def silhouette(self, phi: float, target: ShapeRings) -> BaseGeometry:
        """Pieces on pins at an angle, world, without a board: filled but at holes of the target."""
        import shapely

        from kirigami_studio.assembly.rim_pieces import filled
        from kirigami_studio.assembly.shaping import united

        outer, *holes = as_rings(target)
        bodies = [
            shapely.Polygon(outline, inside[: len(piece.openings)])
            for piece, (outline, *inside) in zip(self.assembly.pieces, self.rings(phi), strict=True)
            if piece.layer < CLOTH
        ]
        return filled(united(*bodies), shapely.Polygon(outer, holes))

    def points(self, phi: float) -> FloatArray:
        """Corners of all pieces at an angle: (P, 2) world."""
        return np.concatenate(self.outlines(phi))

    def drawn(self, phi: float) -> list[list[FloatArray]]:
        """Lines of artwork (L, 2) on every piece at an angle, world."""
        factors, shifts = self.places(phi)
        return [
            [as_points(factor * as_plane(line) + shift) for line in piece.drawn]
            for piece, factor, shift in zip(self.assembly.pieces, factors, shifts, strict=True)
        ]

    def heads(self, phi: float) -> FloatArray:
        """Where the heads of pins are at an angle: (H, 2) world; none where they have none."""
        if not self.head_mm:
            return np.zeros((0, 2))
        (uppermost, at), (factors, shifts) = self._pins, self.places(phi)
        return as_points(factors[uppermost] * at + shifts[uppermost])

    @cached_property
    def extent(self) -> FloatArray:
        """Points (P, 2), world, round which all pieces are at both ends of the motion."""
        return np.concatenate([self.points(np.pi), self.points(self.design.phi_target)])

    def upright(self) -> PosedPieces:
        """The flat pieces by themselves, as they are laid out to be pinned."""
        return replace(self, design=PosedDesign(self.design.deployment, Similarity(self.design.pose.scale), np.pi))

    @cached_property
    def small(self) -> PosedPieces:
        """The pieces as thumbnails show them."""
        return replace(self.simplified(SMALL), holds=())

    def simplified(self, share: float) -> PosedPieces:
        """The pieces without what is finer than a share of the sheet's width."""
        import shapely

        finest = share * float(np.ptp(self.assembly.deployment.compact[:, 0])) * self.assembly.cell_mm
        lines = shapely.simplify([shapely.LinearRing(piece.outline) for piece in self.assembly.pieces], finest)
        pieces = tuple(
            replace(
                piece,
                outline=shapely.get_coordinates(line)[:-1],
                drawn=tuple(
                    shapely.get_coordinates(shapely.simplify(shapely.LineString(one), finest)) for one in piece.drawn
                ),
            )
            for piece, line in zip(self.assembly.pieces, lines, strict=True)
        )
        return replace(self, assembly=replace(self.assembly, pieces=pieces))


#: Corners of a ring that stands for a drilled hole.
ROUND = 16


def rings_of(piece: Piece) -> list[FloatArray]:
    """Outline, openings and holes of a piece in its own frame, mm."""
    turn = np.exp(2j * np.pi * np.arange(ROUND) / ROUND)
    circle = np.column_stack([turn.real, turn.imag])
    holes = [hole.centre + 0.5 * hole.diameter_mm * circle for hole in piece.holes]
    return [piece.outline, *piece.openings, *holes]
