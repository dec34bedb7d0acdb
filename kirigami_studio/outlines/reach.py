"""Which parts of a target a sheet of a given grid can hardly show: thin arms, narrow notches and undercuts.

A sheet of m x n voids shows a target of area 1 with (m + 1)(n + 1) panels, so a panel is about
``1 / sqrt((m + 1)(n + 1))`` wide.  An arm is made of two rows of panels at least, and their hinges cannot lie anywhere.
What turns back by 180 degrees or more is out of reach for every grid, see ``turning``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import cast

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.foundation.words import tr, tr_n
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.turning import LIMIT, turn_back

#: Narrower than this many panels is marked.  Found with fits of 20 drawn shapes (8 x 8 and 12 x 12 voids, 6 samples
#: polished): the 14 of 40 that are marked miss 7.1 % on average and 2.3 % at least, the others 2.2 % on average; the
#: marked area is correlated by 0.75 with what the best fit misses.  From 2.5 panels on, shapes that fit to 1 % are
#: marked as well.  What is not marked may still be hard: long bends and deep bays are not judged.
NEEDED_PANELS = 2.0
#: Corners sharper than 60 degrees count as narrow towards their tip (mitre of the opening).
SHARPEST = 2.0
#: Smaller parts, in panel areas, are not worth a mark: the tip of a heart is lost on any grid, and hardly missed.
SMALLEST_PART = 0.5
#: The outline is simplified by this share of a panel first.
COARSENESS = 0.02
FINEST_GRID = 32
#: Outlines that turn back by this much more than closed layouts can (radians) are marked: parallel walls of a wide
#: notch turn back by 180 degrees and cost little when they lean a bit.
BEYOND = math.radians(10.0)


@dataclass(frozen=True, slots=True, eq=False)
class Reach:
    """Parts of a target that will probably be lost."""

    grid: tuple[int, int]  #: (rows, columns) voids
    #: arms, notches: tuple of (L, 2) float arrays, outline units; parts of the target, and of the ground between its
    #: parts, that are too narrow; largest first.
    arms: tuple[FloatArray, ...]
    notches: tuple[FloatArray, ...]
    narrowest: float  #: outline units; what the grid can show
    share: float  #: area of the marked parts, with the target's as 1
    #: (L, 2), outline units; the notch around which the outline turns back most, if no sheet with a convex outline can
    #: show it closed.
    undercut: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
    turns_back: float = 0.0  #: radians; by how much it turns back there; 0 where that is no hindrance

    @property
    def clear(self) -> bool:
        """Whether nothing is marked."""
        return not self.arms and not self.notches and not self.turns_back


def reach_of(outline: Outline, grid: tuple[int, int]) -> Reach:
    """Mark what a grid can hardly show of a target.

    Raises
    ------
    TargetError
        A grid without voids.
    """
    rows, columns = grid
    if rows < 1 or columns < 1:
        raise TargetError("reach.no_voids", rows=rows, columns=columns)
    panel = 1.0 / math.sqrt((rows + 1) * (columns + 1))
    shape = cast(Polygon, outline.polygon.simplify(COARSENESS * panel))
    radius = 0.5 * NEEDED_PANELS * panel
    arms = _parts(shape.difference(_there_and_back(shape, -radius)), panel)
    whole = Polygon(shape.exterior)  # a hole is cut out of the panels, however small it is
    notches = _parts(_there_and_back(whole, radius).difference(whole), panel)
    share = float(sum(Polygon(ring).area for ring in (*arms, *notches)))
    back = turn_back(outline)
    if back.angle < LIMIT + BEYOND:
        return Reach((rows, columns), arms, notches, 2.0 * radius, share)
    return Reach((rows, columns), arms, notches, 2.0 * radius, share, back.stretch, back.angle)


def share_of_arms(outline: Outline, radius: float) -> float:
    """Share of a target's area in parts that are narrower than twice a radius (unit-area lengths)."""
    shape = outline.polygon.simplify(COARSENESS * radius)
    return float(shape.difference(_there_and_back(shape, -radius)).area)


def _there_and_back(shape: BaseGeometry, by: float) -> BaseGeometry:
    """Grown and shrunk again, or the other way round, with pointed corners, so that a square stays a square."""
    there = shape.buffer(by, join_style="mitre", mitre_limit=SHARPEST)
    # A thousandth more on the way back swallows slivers along straight edges.
    return there.buffer(-1.001 * by, join_style="mitre", mitre_limit=SHARPEST)


def _parts(region: BaseGeometry, panel: float) -> tuple[FloatArray, ...]:
    found = [part for part in shapely.get_parts(region) if isinstance(part, Polygon)]
    worth = [part for part in found if part.area > SMALLEST_PART * panel**2]
    worth.sort(key=lambda part: part.area, reverse=True)
    return tuple(np.asarray(part.exterior.coords[:-1], dtype=np.float64) for part in worth)


def reach_texts(reach: Reach, outline: Outline, scale_mm: float | None = None) -> tuple[str, str]:
    """A text for the user and a shorter one, both "" when nothing is marked; in mm where the size is known.

    Parameters
    ----------
    outline : Outline
        The one that was looked at.
    scale_mm : float, optional
        mm for one outline unit.
    """
    if reach.clear:
        return "", ""
    if reach.turns_back:
        # This comes first: no grid helps.
        degrees = math.degrees(reach.turns_back)
        return (
            tr(
                "The outline turns back by {degrees:.0f}° around the marked notch. A closed sheet turns back by less "
                "than 180° on any grid, so it will fill a part of the notch. Make the notch wider at its mouth.",
                degrees=degrees,
            ),
            tr("The marked notch turns back too far."),
        )
    finer = _finer_grid(outline, reach.grid)
    lost, brief = _lost(reach, None if scale_mm is None else scale_mm * reach.narrowest)
    if finer is None:
        return f"{lost} {tr('Draw them wider.')}", f"{brief} {tr('Draw them wider.')}"
    rows, columns = finer
    whole = tr("Draw them wider, or try {rows} \N{MULTIPLICATION SIGN} {columns} voids.", rows=rows, columns=columns)
    short = tr("Try {rows} \N{MULTIPLICATION SIGN} {columns}.", rows=rows, columns=columns)
    return f"{lost} {whole}", f"{brief} {short}"


def _lost(reach: Reach, narrowest_mm: float | None) -> tuple[str, str]:
    """Fate of the marked parts on a sheet of the grid, and the same in short."""
    arms, notches = len(reach.arms), len(reach.notches)
    grid = "{} \N{MULTIPLICATION SIGN} {}".format(*reach.grid)
    width, known = narrowest_mm or 0.0, narrowest_mm is not None
    if arms and notches:
        brief = tr("Thin arms will be blunt, narrow notches filled.")
        if known:
            return tr(
                "Marked: {arms} thin arms and {notches} narrow notches, under {width:.2g} mm. A sheet of {grid} voids "
                "makes the arms blunt and fills the notches.",
                arms=arms,
                notches=notches,
                width=width,
                grid=grid,
            ), brief
        return tr(
            "Marked: {arms} thin arms and {notches} narrow notches. A sheet of {grid} voids makes the arms "
            "blunt and fills the notches.",
            arms=arms,
            notches=notches,
            grid=grid,
        ), brief
    if arms:
        brief = tr_n("{count} thin arm will be blunt.", "{count} thin arms will be blunt.", arms)
        if known:
            return tr_n(
                "The marked arm is thinner than {width:.2g} mm: a sheet of {grid} voids makes it blunt.",
                "The {count} marked arms are thinner than {width:.2g} mm: a sheet of {grid} voids makes them blunt.",
                arms,
                width=width,
                grid=grid,
            ), brief
        return tr_n(
            "The marked arm is thin: a sheet of {grid} voids makes it blunt.",
            "The {count} marked arms are thin: a sheet of {grid} voids makes them blunt.",
            arms,
            grid=grid,
        ), brief
    brief = tr_n("{count} narrow notch will be filled.", "{count} narrow notches will be filled.", notches)
    if known:
        return tr_n(
            "The marked notch is narrower than {width:.2g} mm: a sheet of {grid} voids fills it.",
            "The {count} marked notches are narrower than {width:.2g} mm: a sheet of {grid} voids fills them.",
            notches,
            width=width,
            grid=grid,
        ), brief
    return tr_n(
        "The marked notch is narrow: a sheet of {grid} voids fills it.",
        "The {count} marked notches are narrow: a sheet of {grid} voids fills them.",
        notches,
        grid=grid,
    ), brief


def _finer_grid(outline: Outline, grid: tuple[int, int]) -> tuple[int, int] | None:
    """The coarsest of a few finer grids that shows everything; None when none of them does."""
    for factor in (1.25, 1.5, 2.0, 3.0):
        rows, columns = (math.ceil(count * factor) for count in grid)
        if max(rows, columns) <= FINEST_GRID and reach_of(outline, (rows, columns)).clear:
            return rows, columns
    return None
