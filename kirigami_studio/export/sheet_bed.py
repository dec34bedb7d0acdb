"""Sheets of several designs on the beds of a machine: strokes and record of a file.

Every bed is one file: the names of all sheets first, then the cuts of one sheet after the other, so that each is done
before the next begins.  A file says of every sheet what the file of that sheet alone would say.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import accumulate

import numpy as np

from kirigami_studio import __version__
from kirigami_studio.assembly.nesting import LaidShape, nested
from kirigami_studio.export.profile import Profile
from kirigami_studio.export.provenance import (
    BOX,
    ONE_SHEET,
    PLACE,
    PROGRAM,
    SHEETS,
    VERDICT,
    exactly,
    facts_of,
    origin_facts,
)
from kirigami_studio.export.strokes import Stroke, extent, name_strokes, sheet_strokes
from kirigami_studio.fabricate.cut_plan import DECIMALS, CutPlan
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import FabricationError
from kirigami_studio.lattice.deployment import Deployment

#: A shift, mm, and the number of quarter turns.
_PLACE = re.compile(r"(-?\d{1,4}\.\d{4}) (-?\d{1,4}\.\d{4}) ([0-3])", re.ASCII)
#: Strokes of a plan in a profile.
_Drawn = Callable[[CutPlan, Profile], tuple[Stroke, ...]]


@dataclass(frozen=True, slots=True, eq=False)
class BedSheet:
    """A sheet that is to lie on a bed."""

    plan: CutPlan  #: of one copy
    deployment: Deployment | None = None  #: the design of the plan
    simulated_jam: float | None = None  #: radians; 0 if it closes; None where nobody has looked

    def strokes(self, profile: Profile) -> tuple[Stroke, ...]:
        """All strokes of a file of the sheet alone: its name first."""
        return (*name_strokes(self.plan, profile), *sheet_strokes(self.plan, profile))


@dataclass(frozen=True, eq=False)
class SheetBed:
    """Sheets on one bed, which one file cuts.

    Attributes
    ----------
    sheets : tuple of BedSheet
    places : tuple of LaidShape
        Of each of them; in quarter turns, no coordinate below 0.
    number, count : int
        Of the bed from 1, and of all beds.
    numbers : tuple of int
        Of the sheets among those of all beds, from 0.
    """

    sheets: tuple[BedSheet, ...]
    places: tuple[LaidShape, ...]
    number: int
    count: int
    numbers: tuple[int, ...]

    @cached_property
    def gap_mm(self) -> float:
        """Least distance between the cuts of neighbours."""
        return min(sheet.plan.options.copy_gap_mm for sheet in self.sheets)

    @property
    def size_mm(self) -> tuple[float, float]:
        """Width and height of everything that the head cuts, from (0, 0)."""
        corners = [
            place.put(np.array(sheet.plan.bounds_mm) * [(0, 0), (1, 1)])
            for sheet, place in zip(self.sheets, self.places, strict=True)
        ]
        width, height = np.concatenate(corners).max(axis=0).tolist()
        return width, height

    def strokes(self, profile: Profile) -> tuple[Stroke, ...]:
        """Everything that a file of this profile draws, in the order of cutting."""
        return (*self._placed(name_strokes, profile), *self._placed(sheet_strokes, profile))

    def cuts(self, profile: Profile) -> tuple[Stroke, ...]:
        """The same without names."""
        return self._placed(sheet_strokes, profile)

    def _boxes(self, profile: Profile) -> list[FloatArray]:
        """Left, bottom, right and top of all that is drawn of each sheet."""
        found, strokes = [], self.strokes(profile)
        numbers = allotted(
            [one.layer for one in strokes], [[one.layer for one in sheet.strokes(profile)] for sheet in self.sheets]
        )
        for at in range(len(self.sheets)):
            points = [one.travelled() for one, number in zip(strokes, numbers, strict=True) if number == at]
            cloud = np.concatenate(points)
            found.append(np.concatenate([cloud.min(axis=0), cloud.max(axis=0)]) + 0.0)
        return found

    def _placed(self, drawn: _Drawn, profile: Profile) -> tuple[Stroke, ...]:
        return tuple(
            replace(stroke, points=np.round(place.put(stroke.points), DECIMALS) + 0.0)
            for sheet, place in zip(self.sheets, self.places, strict=True)
            for stroke in drawn(sheet.plan, profile)
        )

    def by_sheet(self, strokes: Sequence[Stroke], profile: Profile) -> list[list[Stroke]]:
        """Strokes of a file by their sheets, each of them where its plan has it.

        Files are written sheet after sheet, or layer after layer with the sheets one after the other in each: on its
        layer, a stroke's place tells its sheet either way.  What is too much belongs to the last one.
        """
        layers = [stroke.layer for stroke in strokes]
        numbers = allotted(layers, [[one.layer for one in sheet.strokes(profile)] for sheet in self.sheets])
        found: list[list[Stroke]] = [[] for _ in self.sheets]
        for stroke, number in zip(strokes, numbers, strict=True):
            found[number].append(replace(stroke, points=self.places[number].taken(stroke.points)))
        return found

    def facts(self, profile: Profile, verdict: str = "") -> dict[str, str]:
        """The record in the file of its making; that of every sheet by its number, ``S1_DESIGN``."""
        first, strokes = self.sheets[0].plan, self.cuts(profile)
        width, height = extent(strokes)
        alone = [
            facts_of(replace(sheet.plan, verdict=verdict), profile)
            | {"COPY_GAP_MM": exactly(self.gap_mm)}
            | {BOX: " ".join(f"{side:.4f}" for side in box), PLACE: place_text(place)}
            for sheet, box, place in zip(self.sheets, self._boxes(profile), self.places, strict=True)
        ]
        return {
            PROGRAM: __version__,
            "CONSTRUCTION": ONE_SHEET,
            SHEETS: f"{len(self.sheets)}",
            "BED": f"{self.number} of {self.count}",
            "SIZE_MM": f"{width:.4f} x {height:.4f}",
            "COPY_GAP_MM": exactly(self.gap_mm),
            "KERF_MM": alone[0]["KERF_MM"],
            "PROFILE": profile.key,
            "MATERIAL": first.material.key,
            "PATHS": alone[0]["PATHS"],
            "LINES": f"{len(strokes)}",
            **({VERDICT: verdict} if verdict else {}),
            **origin_facts({"target": ", ".join(sheet.plan.origin.get("target", "") for sheet in self.sheets)}),
            **{key: text for number, one in enumerate(alone, 1) for key, text in of_sheet(one, number).items()},
        }


def of_sheet(facts: Mapping[str, str], number: int) -> dict[str, str]:
    """The facts of a sheet, by its number from 1, as the file of its bed has them."""
    return {f"S{number}_{key}": text for key, text in facts.items()}


def place_text(place: LaidShape) -> str:
    """Where a sheet lies, as a file has it: its shift, mm, and how many quarter turns."""
    x, y = place.shift.tolist()
    return f"{x:.4f} {y:.4f} {round(place.turn / (0.5 * math.pi)) % 4}"


def place_of_text(text: str, number: int) -> LaidShape | None:
    """The place in a file of a sheet, by its number from 0; None for a text that is none."""
    found = _PLACE.fullmatch(text)
    if found is None:
        return None
    return LaidShape(number, np.array([float(found[1]), float(found[2])]), 0.5 * math.pi * int(found[3]))


def allotted(layers: Sequence[str], planned: Sequence[Sequence[str]]) -> list[int]:
    """Number of the sheet to which each stroke of a file belongs, by the layers of its strokes.

    Parameters
    ----------
    layers : sequence of str
        Of the strokes of a file, in their order.
    planned : sequence of sequence of str
        Those of each sheet.
    """
    counts = [Counter(each) for each in planned]
    ends = {
        name: list(accumulate(count[name] for count in counts)) for name in {name for one in counts for name in one}
    }
    seen: Counter[str] = Counter()
    found = []
    for name in layers:
        last = [number for number, end in enumerate(ends.get(name, [])) if seen[name] < end]
        found.append(last[0] if last else len(planned) - 1)
        seen[name] += 1
    return found


def sheets_on_beds(sheets: Sequence[BedSheet]) -> tuple[SheetBed, ...]:
    """Lay sheets on as few beds of their machine as are found.

    Raises
    ------
    FabricationError
        A gap between sheets that the kerf would use up.
    """
    machine, gap = sheets[0].plan.machine, min(sheet.plan.options.copy_gap_mm for sheet in sheets)
    kerf = max(sheet.plan.kerf_mm for sheet in sheets)
    if gap <= kerf:
        raise FabricationError("copies.gap_too_narrow", gap_mm=gap, kerf_mm=kerf)
    corners = [np.array(sheet.plan.bounds_mm) * [(0, 0), (1, 0), (1, 1), (0, 1)] for sheet in sheets]
    beds = nested(corners, machine.reach_mm, gap)
    return tuple(
        SheetBed(
            tuple(sheets[place.shape] for place in places),
            tuple(replace(place, shift=np.round(place.shift, DECIMALS)) for place in places),
            number,
            len(beds),
            tuple(place.shape for place in places),
        )
        for number, places in enumerate(beds, start=1)
    )
