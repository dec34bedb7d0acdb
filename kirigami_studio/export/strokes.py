"""Cut plan + machine profile -> the strokes that a cut file must hold, in the order of cutting."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kirigami_studio.export.profile import Profile
from kirigami_studio.export.slots import slot_contours
from kirigami_studio.fabricate.bulges import CHORD_MM, flattened
from kirigami_studio.fabricate.cut_plan import DECIMALS, CutPlan
from kirigami_studio.foundation.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Stroke:
    """One curve as a file holds it.

    Attributes
    ----------
    points : (P, 2) float, mm
        The first point of a closed stroke is not repeated.
    closed : bool
    layer : str
        Name in the file.
    colour : int
        AutoCAD colour index.
    bulges : (P,) float or None
        Arcs, see ``fabricate.bulges``; None where all edges are straight.
    """

    points: FloatArray
    closed: bool
    layer: str
    colour: int
    bulges: FloatArray | None = None

    def drawn(self, chord_mm: float = CHORD_MM) -> FloatArray:
        """Points (V, 2) from start to end with chords for arcs; a closed stroke comes back to its first point."""
        points = self.points
        if self.bulges is not None:
            points = flattened(points, self.bulges, self.closed, chord_mm)
        return np.concatenate([points, points[:1]]) if self.closed else points

    @property
    def length(self) -> float:
        """Length in mm, arcs as arcs."""
        stops = np.roll(self.points, -1, axis=0)
        edges = len(self.points) if self.closed else len(self.points) - 1
        chords = np.linalg.norm(stops - self.points, axis=1)[:edges]
        if self.bulges is None:
            return float(chords.sum())
        bulge = np.abs(self.bulges[:edges])
        curved = bulge > 0.0
        stretch = np.ones(edges)
        stretch[curved] = (1.0 + bulge[curved] ** 2) * np.arctan(bulge[curved]) / bulge[curved]
        return float((chords * stretch).sum())


def strokes_of(plan: CutPlan, profile: Profile) -> tuple[Stroke, ...]:
    """Return what a file of this profile holds.

    Raises
    ------
    ExportError
        The profile wants slots and the plan has no kerf.
    """
    if profile.slots:
        return tuple(
            Stroke(ring, True, profile.layer_name(layer), profile.colour[layer]) for layer, ring in slot_contours(plan)
        )
    found = []
    for path in plan.paths:
        flat = profile.flatten and path.bulges is not None
        points, bulges = (np.round(path.flattened, DECIMALS) + 0.0, None) if flat else (path.points, path.bulges)
        found.append(Stroke(points, path.closed, profile.layer_name(path.layer), profile.colour[path.layer], bulges))
    return tuple(found)


def layer_colours(strokes: Sequence[Stroke]) -> dict[str, int]:
    """Colour of each layer by its name, in the order of cutting."""
    return {stroke.layer: stroke.colour for stroke in strokes}


def extent(strokes: Sequence[Stroke]) -> tuple[float, float]:
    """Largest x and y that the head reaches; the smallest are 0."""
    corner = np.concatenate([stroke.drawn() for stroke in strokes]).max(axis=0)
    return float(corner[0]), float(corner[1])
