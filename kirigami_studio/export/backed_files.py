"""Tiles and their hinge layer in files: strokes, record, steps, lines of the parts list.

The hinge layer is the cut plan with registration holes round it, which are cut first.  Its outline hangs on tabs, so
that what is left over round it keeps the layer in register with the frame of the tiles.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from kirigami_studio.assembly.backed import BackedSheet, Board
from kirigami_studio.assembly.holding import HoldPlace
from kirigami_studio.assembly.pieces import RoundHole
from kirigami_studio.export.profile import Profile
from kirigami_studio.export.provenance import AROUND, THROUGH, exactly, facts_of
from kirigami_studio.export.strokes import Stroke, Work, cutting_work, frame_origin, sheet_strokes
from kirigami_studio.fabricate.cut_path import flattened
from kirigami_studio.fabricate.cut_plan import DECIMALS, CutPlan, Layer
from kirigami_studio.fabricate.hold import HoldKind
from kirigami_studio.fabricate.material import Construction, Material
from kirigami_studio.fabricate.options import BoardCut
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.words import mark

#: Stem of the file of the hinge layer, which is layer 1.
HINGE_LAYER = "layer-1"
STEPS = (
    mark(
        "Cut layer 1 out of the soft sheet and layer 2 out of the board. Leave the soft sheet on its tabs: what is "
        "left over round it has the holes."
    ),
    mark(
        "The hole that is out of line says how layers lie: with it on the same side, both face you as their files do."
    ),
)
KEEP = {
    BoardCut.THROUGH: mark(
        "Keep tiles in place: stretch tape over the whole board before you take it off the machine, and turn it over "
        "for the glue; the soft sheet then lies face down, too."
    ),
    BoardCut.KISS: mark(
        "Keep tiles in place: weed what lies between them off the liner, and glue on their upper sides; the soft sheet "
        "lies on them face up, and the liner comes off at the end."
    ),
}
GLUE_STEPS = (
    mark(
        "Put pins through the frame's holes into a flat surface, spread glue thinly on the tiles, and press the soft "
        "sheet on, hole on hole. Between tiles no glue may be left: connectors bend there."
    ),
    mark("Or glue tiles one by one: lay the soft sheet on the page at true size, each tile on its number."),
    mark("When the glue is dry, snip the tabs, take the sheet out of the frame, and open and close it by hand."),
)


@dataclass(frozen=True, eq=False)
class Glued:
    """A board of tiles and the hinge layer that they are glued on."""

    sheet: BackedSheet
    board: Board
    material: Material  #: of the board
    cut: BoardCut
    holds: tuple[HoldPlace, ...] = ()  #: places that hold the sheet, whose holes are in the tiles

    @property
    def plan(self) -> CutPlan:
        """Of the hinge layer."""
        return self.sheet.plan

    @property
    def steps(self) -> tuple[str, ...]:
        """Steps of assembly."""
        return (*STEPS, KEEP[self.cut], *GLUE_STEPS)

    @property
    def under(self) -> FloatArray:
        """Outline (L, 2) of the hinge layer on the board, mm."""
        return self.plan.outline + self.board.layer_at

    @cached_property
    def glue_mm2(self) -> float:
        """Area of all tiles."""
        return float(sum(tile.area for tile in self.sheet.flat_tiles.values()))

    @cached_property
    def through(self) -> tuple[RoundHole, ...]:
        """Holes of places that go through both layers, in the frame of the plan: for thread and eyelets."""
        numbers = {piece.id: number for number, piece in enumerate(self.board.pieces)}
        origins = self.board.places - self.board.layer_at
        return tuple(
            RoundHole(point + origins[numbers[name]], place.hole_mm)
            for place in self.holds
            if place.kind in (HoldKind.STITCHES, HoldKind.EYELETS)
            for name, at in zip(place.parts, place.at, strict=True)
            for point in at
        )

    def holes(self, profile: Profile) -> tuple[Stroke, ...]:
        """Registration holes round the sheet, then those through both layers, as the beam goes.

        In the frame of the sheet's strokes.
        """
        kerf = 0.0 if profile.slots else self.plan.kerf_mm
        layer, colour = profile.layer_name(Layer.RELIEF), profile.colour[Layer.RELIEF]
        origin = frame_origin(self.plan, profile)
        found = [
            Stroke.round(np.round(hole.centre - origin, DECIMALS), hole.diameter_mm - kerf, layer, colour)
            for hole in (*self.board.registration, *self.through)
        ]
        if not profile.flatten:
            return tuple(found)
        return tuple(
            Stroke(np.round(flattened(one.points, np.ones(2), closed=True), DECIMALS), True, layer, colour)
            for one in found
        )

    def strokes(self, profile: Profile) -> tuple[Stroke, ...]:
        """All strokes of a file of this profile from (0, 0): the holes, then the sheet."""
        holes = self.holes(profile)
        return tuple(shifted(stroke, self.shift(profile)) for stroke in (*holes, *sheet_strokes(self.plan, profile)))

    def shift(self, profile: Profile) -> FloatArray:
        """Shift (2,), mm, of the strokes of the sheet into the file."""
        low = np.min([stroke.travelled().min(axis=0) for stroke in self.holes(profile)], axis=0)
        found: FloatArray = np.ceil(-low * 10**DECIMALS) / 10**DECIMALS
        return found

    def sheet_in(self, strokes: Sequence[Stroke], profile: Profile) -> list[Stroke]:
        """The strokes of the sheet, of those that a file holds, where its plan has them."""
        return [
            shifted(stroke, -self.shift(profile))
            for stroke in strokes[len(self.board.registration) + len(self.through) :]
        ]

    def facts(self, profile: Profile, strokes: Sequence[Stroke]) -> dict[str, str]:
        """The record in a file of the layer of its making."""
        return facts_of(self.plan, profile) | {
            "CONSTRUCTION": Construction.BACKED.value,
            "LAYER": "1",
            "BED": "1 of 1",
            "BOARD": self.material.key,
            "GAP_MM": exactly(self.sheet.tile_sizes.gap_mm),
            AROUND: f"{len(self.board.registration)}",
            **({THROUGH: f"{len(self.through)}"} if self.through else {}),
            "LINES": f"{len(strokes)}",
        }

    def work(self, profile: Profile) -> Work:
        """Length and time of the cuts of the layer."""
        return cutting_work(self.strokes(profile), self.plan.material, self.plan.machine)


def shifted(stroke: Stroke, by: FloatArray) -> Stroke:
    """A stroke elsewhere, on the grid of coordinates."""
    return replace(stroke, points=np.round(stroke.points + by, DECIMALS) + 0.0)
