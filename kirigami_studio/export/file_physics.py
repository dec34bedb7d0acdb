"""What a written cut file does to the sheet: pieces, smallest ligament, lengths cut twice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.export.profile import Profile
from kirigami_studio.export.strokes import Stroke
from kirigami_studio.fabricate.bulges import MEASURED_CHORD_MM
from kirigami_studio.fabricate.cut_plan import CutPlan, Layer
from kirigami_studio.fabricate.finished_sheet import overlap_length, remaining_pieces, smallest_ligament
from kirigami_studio.fabricate.joints import Pair, joined_pairs
from kirigami_studio.fabricate.tabs import joined_ring


@dataclass(frozen=True, slots=True)
class Physics:
    """The sheet after cutting.

    Attributes
    ----------
    pieces : int
    min_ligament_mm : float or None
        None when there is nothing to measure.
    overlap_mm : float
    """

    pieces: int
    min_ligament_mm: float | None
    overlap_mm: float


def file_physics(strokes: Sequence[Stroke], plan: CutPlan, profile: Profile) -> Physics:
    """Cut the sheet along the strokes of a file.

    Parameters
    ----------
    strokes : sequence of Stroke
        As read, in file order.
    plan : CutPlan
        Its kerf, and which of the strokes are the outline (by number, for the names are the profile's).
    profile : Profile
    """
    outlines = 1 if profile.slots else len(plan.on_layer(Layer.OUTLINE))
    drawn = [stroke.drawn(MEASURED_CHORD_MM) for stroke in strokes]
    lines = [LineString(points) for points in drawn]
    inner, rim = lines[:-outlines], drawn[-outlines:]
    boundary = Polygon(rim[0] if outlines == 1 else joined_ring(rim))
    kerf = 0.0 if profile.slots else plan.kerf_mm
    loops = [Polygon(line) for line, stroke in zip(inner, strokes, strict=False) if stroke.closed]
    sheet: BaseGeometry = boundary.difference(shapely.union_all(loops))
    pieces = remaining_pieces(sheet, inner, kerf)
    ligament = smallest_ligament(inner, boundary.exterior, kerf, _meant(inner, plan)) if inner else None
    return Physics(len(pieces), None if ligament is None else ligament.width_mm, max(overlap_length(lines), 0.0))


def _meant(lines: Sequence[LineString], plan: CutPlan) -> set[Pair]:
    """Which of the file's cuts meet on purpose, by number; none where the file's cuts are not those of the plan."""
    paths = [path for path in plan.paths if path.layer is not Layer.OUTLINE]
    return joined_pairs(plan, paths, lines) if len(paths) == len(lines) else set()
