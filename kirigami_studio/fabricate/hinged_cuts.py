"""All cuts of a sheet with the ends that their hinges get: straight, shaped, or cut through."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from shapely.geometry import Polygon

from kirigami_studio.fabricate.fitting import Fitting, Place, cut_through, places_of_ends
from kirigami_studio.fabricate.material import Material
from kirigami_studio.fabricate.measuring import SlitEnd, measured_widths, straight_end
from kirigami_studio.fabricate.options import ConnectorStyle, CutOptions
from kirigami_studio.fabricate.seats import Seat
from kirigami_studio.fabricate.slits import CutTable
from kirigami_studio.fabricate.trimmed_sheet import CutPiece
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import FabricationError

#: Styles whose slits end in a relief hole.
HOLED = (ConnectorStyle.ROUND, ConnectorStyle.TEARDROP)
#: A removed connector narrower than this (mm) is gone.
GONE_MM = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class HingedCuts:
    """Cuts and what their ends are.

    Attributes
    ----------
    pieces : tuple of CutPiece
        Slits and edge cuts, then the shapes at their ends.
    seats : tuple of Seat
        Of every hinge.
    places : tuple of Place
        Where the slit of each hinge ends.
    shapes : mapping of hinge to int
        Number of the piece that is the shape at a hinge, for those that have one.
    flexure_mm : (H,) float
        Length over which each connector bends.
    straight : Counter of str
        How many hinges stayed straight against the wish, by reason.
    """

    pieces: tuple[CutPiece, ...]
    seats: tuple[Seat, ...]
    places: tuple[Place, ...]
    shapes: Mapping[int, int]
    flexure_mm: FloatArray
    straight: Counter[str]

    def moved(self, move: Callable[[FloatArray], FloatArray]) -> HingedCuts:
        """The same cuts with all their points moved (and rounded)."""
        pieces = tuple(replace(piece, points=move(piece.points)) for piece in self.pieces)
        return replace(
            self, pieces=pieces, seats=tuple(replace(seat, junction=move(seat.junction)) for seat in self.seats)
        )

    def widths(self, table: CutTable, removed: Sequence[int], outline: Polygon, kerf_mm: float) -> FloatArray:
        """Finished widths (H,), mm, measured; 0 where a connector was removed and is gone."""
        ends = [self._end(hinge, hinge in removed) for hinge in range(len(self.places))]
        finished = measured_widths(ends, self.seats, table, self.pieces, outline, kerf_mm)
        gone = np.array(removed, dtype=np.intp)
        finished[gone] = np.where(finished[gone] < GONE_MM, 0.0, finished[gone])
        return finished

    def _end(self, hinge: int, removed: bool) -> SlitEnd:
        if hinge in self.shapes:
            shape = self.pieces[self.shapes[hinge]]
            return SlitEnd(shape.line, shape.points)
        index, last = self.places[hinge]
        piece = self.pieces[index]
        return SlitEnd(piece.line, piece.points) if removed else straight_end(piece, last)


def relief_radius(style: ConnectorStyle, material: Material) -> float:
    """Radius (mm) of the relief holes of a style, 0 for a style without.

    Raises
    ------
    FabricationError
        The style has holes, but the material's preset says that none are made.
    """
    if style not in HOLED:
        return 0.0
    if material.relief_radius_mm == 0.0:
        raise FabricationError(
            f"{style.value.capitalize()} slit ends need a relief radius, but that of {material.name!r} is 0 mm; choose "
            f"straight, arc or double connectors, or a material with a relief radius."
        )
    return material.relief_radius_mm


def hinged_cuts(
    pieces: Sequence[CutPiece],
    tips: FloatArray,
    hinge_seats: Sequence[Seat],
    table: CutTable,
    outline: Polygon,
    options: CutOptions,
    material: Material,
    kerf_mm: float,
    overcut_mm: float,
) -> HingedCuts:
    """End every slit as the options want it.

    Parameters
    ----------
    pieces : sequence of CutPiece
        Slits and edge cuts, pulled back from their junctions.
    tips : (H, 2) float, mm
        Where they end at each hinge.
    hinge_seats : sequence of Seat
    table : CutTable
    outline : Polygon, mm
        Inside the centre line of the outline cut.
    options, material, kerf_mm, overcut_mm
        As for ``plan_cuts``.

    Raises
    ------
    FabricationError
        A style that the material does not allow.
    """
    radius = relief_radius(options.style, material)
    places = places_of_ends(pieces, tips, table)
    made, places = cut_through(pieces, options.removed, places, hinge_seats, table, outline, overcut_mm)
    flexure = np.array([seat.span_mm for seat in hinge_seats])
    if options.style is ConnectorStyle.STRAIGHT:
        return HingedCuts(tuple(made), tuple(hinge_seats), tuple(places), {}, flexure, Counter())
    fitting = Fitting(options.style, hinge_seats, radius, table, made, places, outline, kerf_mm)
    removed = set(options.removed)
    fitted = fitting.fit([hinge for hinge in range(table.hinge_count) if hinge not in removed])
    shapes: dict[int, int] = {}
    for hinge, shape in sorted(fitted.items()):
        index, last = places[hinge]
        points = made[index].points.copy()
        points[-1 if last else 0] = shape.ending.tip
        made[index] = replace(made[index], points=points)
        shapes[hinge] = len(made)
        made.append(shape.piece)
        flexure[hinge] = shape.ending.flexure_mm
    return HingedCuts(tuple(made), tuple(hinge_seats), tuple(places), shapes, flexure, fitting.reasons())
