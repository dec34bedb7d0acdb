"""Places that hold one sheet open, or flat, as marks that are engraved on it: nothing is cut for them.

Two marks with one number meet in their state.  They keep off cuts and connectors as an engraved name does.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
import shapely
from shapely.geometry import LineString

from kirigami_studio.assembly.backed import BackedSheet, TileSizes
from kirigami_studio.assembly.holding import HoldPlace, held_tiles
from kirigami_studio.fabricate.cut_plan import CutPlan
from kirigami_studio.fabricate.engraving import clearance_mm, written_in
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.fabricate.hold import HeldState, HoldKind, HoldOptions
from kirigami_studio.fabricate.lettering import Engraving
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.words import tr
from kirigami_studio.lattice.deployment import Deployment

#: Arm of a cross where thread goes through, and half of the square that a number fits into, mm.
ARM_MM, HALF_NUMBER_MM = 0.7, 1.1
#: Least distance between marks and a name, mm.
APART_MM = 0.5
#: Corners of a circle.
ROUND = 24
#: What is done at marks of each kind.
DONE_BY: Mapping[HoldKind, str] = {
    HoldKind.MAGNETS: "hold.marks_for_magnets",
    HoldKind.EYELETS: "hold.marks_for_eyelets",
    HoldKind.STITCHES: "hold.marks_for_stitches",
    HoldKind.TABS: "hold.marks_for_tabs",
}


def with_marks(plan: CutPlan, design: Deployment, phi: float, options: HoldOptions) -> CutPlan:
    """The plan of one sheet with marks where parts of it are held together, and a note on them.

    Parameters
    ----------
    plan : CutPlan
        With its name, if it has one.
    design : Deployment
    phi : float, radians
        Target angle.
    options : HoldOptions
    """
    if options.kind is HoldKind.NONE:
        return plan
    sheet = BackedSheet.of(plan, design, phi, TileSizes(clearance_mm(plan.kerf_mm)))
    found = held_tiles(sheet.assembly, options, sheet.between_mm)
    notes = [Note.of(problem.code) for problem in found.problems]
    origins = dict(zip(sheet.assembly.by_id, sheet.assembly.poses(math.pi)[:, :2] + sheet.shift, strict=True))
    name = () if plan.engraving is None else plan.engraving.lines
    lines: list[FloatArray] = []
    numbers: dict[HeldState, list[int]] = {state: [] for state in HeldState}
    for place in found.places:
        marks = [
            line for part, at in zip(place.parts, place.at, strict=True) for line in _mark(place, at + origins[part])
        ]
        if _near(marks, name):
            continue
        lines += marks
        numbers[place.state].append(place.number)
    if not lines:
        return replace(plan, notes=(*plan.notes, *notes))
    told = {state.value: _listed(numbers[state]) for state in HeldState}
    engraving = Engraving("", 0.0, 0, tuple(lines))
    if plan.engraving is not None:
        engraving = replace(plan.engraving, lines=(*name, *lines))
    return replace(plan, engraving=engraving, notes=(*plan.notes, *notes, Note.of(DONE_BY[options.kind], **told)))


def _mark(place: HoldPlace, at: FloatArray) -> Iterator[FloatArray]:
    """Open strokes (P, 2), mm, of one mark of a place, and of its number."""
    if place.kind is HoldKind.STITCHES:
        for x, y in at.tolist():
            yield np.array([[x - ARM_MM, y], [x + ARM_MM, y]])
            yield np.array([[x, y - ARM_MM], [x, y + ARM_MM]])
    elif place.kind is HoldKind.TABS:
        yield at[[3, 0, 1, 2]] if len(at) == 4 else at
    else:
        turn = 2.0 * math.pi * np.arange(ROUND + 1) / ROUND
        yield at[0] + 0.5 * place.hole_mm * np.column_stack([np.cos(turn), np.sin(turn)])
    x, y = at.mean(axis=0).tolist()
    square = shapely.box(x - HALF_NUMBER_MM, y - HALF_NUMBER_MM, x + HALF_NUMBER_MM, y + HALF_NUMBER_MM)
    yield from written_in(square, f"{place.number}")


def _near(marks: Sequence[FloatArray], name: Sequence[FloatArray]) -> bool:
    if not name:
        return False
    both = [shapely.multilinestrings([LineString(line) for line in lines]) for lines in (marks, name)]
    return bool(shapely.dwithin(both[0], both[1], APART_MM))


def _listed(numbers: Sequence[int]) -> str:
    return ", ".join(map(str, numbers)) if numbers else tr("none")
