"""A calibration coupon: one small sheet that shows the kerf and the smallest ligament of a machine and a material.

Comb
    ``COMB_SLITS`` parallel cuts run in from the lower edge, so that fingers stand between them.  Pushed together to one
    side, the fingers leave a gap at the edge that is as wide as all the cuts together (``kerf_from_gaps``).
Tongues
    Rows of flaps, cut on three sides by one path and on the fourth by a slit that ends before both arms of it.  What is
    left at each end is a connector like those of a design.  From left to right the connectors get wider; from the
    bottom row to the top the flaps do.  Lift them: the narrowest connectors that survive are the smallest ligament of
    the material.
Marks
    Short slits above a column count it; short cuts at the left edge count the row.

A material that asks for ligaments of more than ``WIDEST_RUNG_MM`` gets the coupon that many times larger: lengths below
are those of the coupon of all others.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np

from kirigami_studio.fabricate.connectors import OVERCUT_MM, SHORTEST_CUT_MM, Hinges, outline_path
from kirigami_studio.fabricate.cut_path import CutPath, Layer, check_length
from kirigami_studio.fabricate.cut_plan import DECIMALS, CutPlan
from kirigami_studio.fabricate.findings import Note
from kirigami_studio.fabricate.material import Material
from kirigami_studio.fabricate.ordering import in_cutting_order
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.foundation.words import number

SIZE_MM = (60.0, 40.0)
COMB_SLITS, FINGER_MM, FINGER_LENGTH_MM = 10, 1.5, 10.0
#: Widths of the flaps, one row each from the bottom: the slit pitches that designs have.
FLAP_WIDTHS_MM = (3.5, 5.0, 6.5)
FLAP_HEIGHT_MM, ROW_MM, COLUMN_MM = 5.0, 7.6, 8.2
#: Middle of the first column, and the fourth side of the lowest flaps.
FIRST_FLAP_MM = (5.4, 13.0)
#: How far the arms of a flap run beyond its fourth side.
ARM_MM = 0.8
RUNGS, NARROWEST_RUNG_MM, WIDEST_RUNG_MM = 7, 0.05, 1.0
MARK_MM, MARK_PITCH_MM = 0.8, 0.9
#: With a wider kerf neighbouring cuts of the coupon would meet.
WIDEST_KERF_MM = 0.5
#: The largest coupon is this many times as large: 600 mm wide.
LARGEST_SCALE = 10.0


@dataclass(frozen=True, slots=True)
class MeasuredKerf:
    """A kerf from measurements."""

    kerf_mm: float  #: Mean of all readings
    doubt_mm: float  #: Half of the range that the readings span, as kerf; 0 for a single one


def kerf_from_gaps(gaps_mm: Sequence[float], slits: int = COMB_SLITS) -> MeasuredKerf:
    """Turn the gap beside the comb, measured once or several times with all fingers pushed aside, into a kerf.

    Parameters
    ----------
    gaps_mm : sequence of float
    slits : int
        Cuts of the comb.

    Raises
    ------
    FabricationError
        No reading, or one that cannot be a width.
    """
    if not len(gaps_mm):
        raise FabricationError("coupon.no_reading")
    kerfs = np.array([check_length("coupon.gap_negative", gap, zero_allowed=True) for gap in gaps_mm]) / slits
    return MeasuredKerf(float(kerfs.mean()), 0.5 * float(np.ptp(kerfs)))


def coupon_scale(material: Material) -> float:
    """Enlargement of a material's coupon that has its smallest ligament among the connectors."""
    return max(1.0, material.min_ligament_mm / WIDEST_RUNG_MM)


def ligament_rungs(material: Material) -> tuple[float, ...]:
    """Connector widths (mm) of the columns: steps of sqrt(2) round the material's smallest ligament, ascending."""
    steps = sorted(range(-12, 13), key=lambda step: (abs(step), step))
    widths = [round(material.min_ligament_mm * 2.0 ** (0.5 * step), 2) for step in steps]
    widest = WIDEST_RUNG_MM * coupon_scale(material)
    inside = [width for width in widths if NARROWEST_RUNG_MM <= width <= widest]
    return tuple(sorted(list(dict.fromkeys(inside))[:RUNGS]))


def plan_coupon(material: Material, kerf_mm: float | None = None) -> CutPlan:
    """Plan the coupon of a material; every writer and check takes it like any other plan.

    Parameters
    ----------
    material : Material
    kerf_mm : float, optional
        What the connectors are planned with; the material's unless given.

    Raises
    ------
    FabricationError
        A kerf too wide for the flaps or the comb, or a material whose ligaments are nowhere near 0.05 to 10 mm.
    """
    kerf = check_length("kerf.negative", material.kerf_mm if kerf_mm is None else kerf_mm, zero_allowed=True)
    rungs, scale = ligament_rungs(material), coupon_scale(material)
    if not rungs or scale > LARGEST_SCALE:
        raise FabricationError(
            "coupon.ligament_out_of_range",
            narrowest_mm=NARROWEST_RUNG_MM,
            widest_mm=WIDEST_RUNG_MM * LARGEST_SCALE,
            key=material.key,
            ligament_mm=material.min_ligament_mm,
        )
    if kerf > WIDEST_KERF_MM * scale:
        raise FabricationError("coupon.kerf_too_wide", widest_mm=WIDEST_KERF_MM * scale, kerf_mm=kerf)
    reach = (0.5 * kerf + OVERCUT_MM) / scale
    slits = [*_flaps(rungs, kerf, scale), *_column_marks(len(rungs))]
    edges = [*_comb(reach), *_row_marks(reach)]
    outline = outline_path(SIZE_MM, kerf / scale)
    origin = np.concatenate([outline, *slits, *edges]).min(axis=0)

    def path(points: FloatArray, layer: Layer, closed: bool = False) -> CutPath:
        rounded: FloatArray = np.round(scale * (points - origin), DECIMALS) + 0.0
        return CutPath(rounded, layer, closed)

    paths = [
        *(path(points, Layer.SLITS) for points in slits),
        *(path(points, Layer.EDGE_SLITS) for points in edges),
        path(outline, Layer.OUTLINE, closed=True),
    ]
    return CutPlan(
        paths=in_cutting_order(paths),
        size_mm=(scale * SIZE_MM[0], scale * SIZE_MM[1]),
        connector_mm=rungs[0],
        kerf_mm=kerf,
        overcut_mm=OVERCUT_MM,
        hinges=Hinges.none(),
        material=material,
        design_hash=hashlib.sha256(f"coupon {asdict(material)} {kerf!r}".encode()).hexdigest()[:16],
        notes=_notes(rungs, scale),
    )


def _comb(reach: float) -> list[FloatArray]:
    """Parallel cuts from outside the lower edge inwards, in the middle of it."""
    first = 0.5 * (SIZE_MM[0] - (COMB_SLITS - 1) * FINGER_MM)
    return [
        np.array([[first + index * FINGER_MM, -reach], [first + index * FINGER_MM, FINGER_LENGTH_MM]])
        for index in range(COMB_SLITS)
    ]


def _flaps(rungs: Sequence[float], kerf: float, scale: float) -> list[FloatArray]:
    """For each flap the path round three sides and the slit at the fourth."""
    cuts: list[FloatArray] = []
    for row, width in enumerate(FLAP_WIDTHS_MM):
        for column, rung in enumerate(rungs):
            middle = FIRST_FLAP_MM[0] + column * COLUMN_MM
            base = FIRST_FLAP_MM[1] + row * ROW_MM
            left, right, top = middle - 0.5 * width, middle + 0.5 * width, base + FLAP_HEIGHT_MM
            inset = (rung + kerf) / scale
            if right - left - 2.0 * inset < max(SHORTEST_CUT_MM, 2.0 * kerf) / scale:
                named = {"flap_mm": scale * width, "connector_mm": rung, "kerf_mm": kerf}
                raise FabricationError("coupon.flap_too_narrow", **named)
            cuts.append(np.array([[left, base - ARM_MM], [left, top], [right, top], [right, base - ARM_MM]]))
            cuts.append(np.array([[left + inset, base], [right - inset, base]]))
    return cuts


def _column_marks(columns: int) -> list[FloatArray]:
    """Short slits above each column, as many as its number."""
    low = FIRST_FLAP_MM[1] + (len(FLAP_WIDTHS_MM) - 1) * ROW_MM + FLAP_HEIGHT_MM + 2.5
    marks = []
    for column in range(columns):
        first = FIRST_FLAP_MM[0] + column * COLUMN_MM - 0.5 * column * MARK_PITCH_MM
        for index in range(column + 1):
            x = first + index * MARK_PITCH_MM
            marks.append(np.array([[x, low], [x, low + MARK_MM]]))
    return marks


def _row_marks(reach: float) -> list[FloatArray]:
    """Short cuts at the left edge beside each row, as many as its number."""
    marks = []
    for row in range(len(FLAP_WIDTHS_MM)):
        middle = FIRST_FLAP_MM[1] + row * ROW_MM + 0.5 * FLAP_HEIGHT_MM
        for index in range(row + 1):
            y = middle + (index - 0.5 * row) * MARK_PITCH_MM
            marks.append(np.array([[-reach, y], [MARK_MM, y]]))
    return marks


def _notes(rungs: Sequence[float], scale: float) -> tuple[Note, ...]:
    widths = ", ".join(number(rung, "g") for rung in rungs)
    flaps = ", ".join(number(scale * width, "g") for width in FLAP_WIDTHS_MM)
    return (
        Note.of("coupon.how_to_read_kerf", fingers=COMB_SLITS - 1, slits=COMB_SLITS),
        Note.of("coupon.how_to_read_ligament", widths=widths, flaps=flaps),
    )
