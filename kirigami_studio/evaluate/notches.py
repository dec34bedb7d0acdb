"""Deep trimming: notches that are cut through panels inside the sheet, and whose panels and hinges are given up.

A sheet stays one mechanism without some of its panels as long as the others still form voids that hang together.  The
four panels around a void open by one angle, and two voids that share a hinge share its two panels, so they open by the
same one.  What stays is therefore a set of voids, connected from hinge to hinge, each with its four panels and its four
hinges; a panel that belongs to none of them goes.  All that stays moves as it does in the whole sheet.

While the sheet is flat, slits are closed and may cut a part of a notch off from the outside.  Along slits of voids that
went, such a notch gets a way out, for the sheet has one outline.

Which voids stay is found by trying: those that mostly lie on the target at first, then every void along the boundary is
left out or taken back as long as the trimmed silhouette gains from it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from kirigami_studio.evaluate.kept_panels import (
    GRID,
    SLIVER,
    GeometryArray,
    KeptPanels,
    all_panels,
    enclosed,
    kept_part,
    largest_part,
    measured,
    moved_off,
    polygons,
    shared_parts,
    with_pockets,
)
from kirigami_studio.foundation.arrays import BoolArray, FloatArray, IntArray
from kirigami_studio.foundation.errors import KirigamiError
from kirigami_studio.lattice.left_corners import parts_with_corners

#: What sticks out counts so much more than what is missed: strips around hinges look worse than a short edge.
STICKING_OUT = 1.5
#: What lies farther off the target than ``keep`` counts so much more: hooks that reach into a hole; horns, strips of
#: panels to hinges that lie in a notch.  With 6 for horns, too, a puzzle's cover would lose 0.004 of its match.
HOOK, HORN = 6.0, 4.0
#: Voids whose panels lie on the target by this share stay at first.
MOSTLY = 0.5
#: A change has to gain this (unit cells squared), and so often all voids along the boundary are looked at.
LEAST_GAIN, ROUNDS = 1e-3, 4
#: A symmetric sheet keeps its symmetry where shares on the target differ by no more than this from their image's.
ALIKE = 0.1
#: How often hinges that two parts reach are given back.
GIVEN_BACK = 4
#: Nearer than this (unit cells) shapes touch.
TOUCH = 1e-7
#: Width of a way out of a notch as a share of ``keep``: wider than the kerf, for connectors need more than that.
WAY_OUT = 0.5
#: Enclosed parts of notches larger than this (unit cells squared) are worth leaving out more voids.
WORTH_OPENING = 0.04
#: Void (row, column), counted from a panel's: above left, above right, below left, below right; and which of them have
#: the panel's top, left, bottom and right corner.
AROUND = ((-1, -1), (-1, 0), (0, -1), (0, 0))
AT_CORNER = ((0, 1), (0, 2), (2, 3), (1, 3))
NOTHING = Polygon()
#: Voids that touch at a corner enclose what lies between them.
EIGHT_WAYS = np.ones((3, 3), dtype=np.intp)


def deep_cut(
    corners: FloatArray,
    targets: GeometryArray,
    slits: FloatArray,
    void_gain: FloatArray,
    keep: float,
    images: IntArray | None = None,
    open_inside: bool = False,
) -> tuple[KeptPanels, BoolArray]:
    """Trim all panels of a sheet to a target, and give up those that lie in its notches.

    Parameters
    ----------
    corners : ((m + 1) (n + 1), 4, 2) float, unit cells
        Of the compact sheet: top, left, bottom, right.
    targets : ((m + 1) (n + 1),) Polygon
        The target in each panel's frame.
    slits : (m, n, 2, 2) float, unit cells
        Both ends of every void in the compact sheet.
    void_gain : (m, n) float, unit cells squared
        What a void that stays adds to the silhouette: its part on the target, less ``STICKING_OUT`` times the rest.
    keep : float, unit cells
        Depth of the material that stays at every hinge that does.
    images : (G, m n) int, optional
        For each move of the sheet's symmetry, the void that each void is the image of.
    open_inside : bool
        Whether what is cut out may have no way out: a target with holes.

    Returns
    -------
    kept : KeptPanels
        What stays of every panel, row by row.
    voids : (m, n) bool
        The voids that stay.

    Raises
    ------
    KirigamiError
        No void lies mostly on the target.
    """
    cut = _NotchCut(corners, targets, slits, void_gain, keep, open_inside)
    voids = cut.first()
    if not voids.any():
        raise KirigamiError("trim.nothing_left")
    voids = cut.improved(voids, images)
    voids = voids if open_inside else cut.opened(voids, images)
    return cut.parts(voids), voids


@dataclass(frozen=True, slots=True, eq=False)
class _NotchDraft:
    """Parts of all panels for a set of voids, notches that they still enclose, and what all that is worth."""

    voids: BoolArray
    shapes: GeometryArray
    enclosed: list[Polygon]
    worth: float


class _NotchCut:
    """One sheet over its target: what every panel is worth with some of its hinges."""

    def __init__(
        self,
        corners: FloatArray,
        targets: GeometryArray,
        slits: FloatArray,
        void_gain: FloatArray,
        keep: float,
        open_inside: bool,
    ) -> None:
        self._rows, self._columns = void_gain.shape
        self._corners, self._targets, self._void_gain, self._keep = corners, targets, void_gain, keep
        self._slits, self._open_inside = slits, open_inside
        self._panels = polygons(corners)
        self._common = shared_parts(self._panels, targets)
        self._area, self._inside = shapely.area(self._panels), shapely.area(self._common)
        # Panels (P,) that have stayed whole so far, and their area.
        self._middle = np.ones(len(corners), dtype=np.bool_)
        self._united: BaseGeometry = NOTHING
        self._known: dict[tuple[int, bytes], tuple[float, BaseGeometry | None]] = {}
        self._wide: dict[int, BaseGeometry] = {}
        self._far_off = HOOK if open_inside else HORN

    def first(self) -> BoolArray:
        """The largest set of voids mostly on the target, without holes unless they may be open."""
        mostly = largest_set(self._shares() >= MOSTLY)
        if self._open_inside:
            return mostly
        outside, _ = _labelled(np.pad(~mostly, 1, constant_values=True), EIGHT_WAYS)
        whole: BoolArray = outside[1:-1, 1:-1] != outside[0, 0]
        return whole

    def _is_one(self, voids: BoolArray) -> bool:
        """Whether voids hang together by hinges, and so does all around them unless it may be open."""
        if _labelled(voids)[1] != 1:
            return False
        return self._open_inside or _labelled(np.pad(~voids, 1, constant_values=True), EIGHT_WAYS)[1] == 1

    def _shares(self) -> FloatArray:
        """Part of the panels around each void that lies on the target: (m, n)."""
        share = (self._inside / self._area).reshape(self._rows + 1, self._columns + 1)
        return np.asarray(0.25 * (share[:-1, :-1] + share[1:, :-1] + share[:-1, 1:] + share[1:, 1:]))

    def improved(self, voids: BoolArray, images: IntArray | None) -> BoolArray:
        """Voids left out and taken back, one after the other or with their images, as long as that gains."""
        orbits = self._orbits(images)
        crossed = (self._inside < self._area - SLIVER * SLIVER).reshape(self._rows + 1, self._columns + 1)
        near = crossed[:-1, :-1] | crossed[1:, :-1] | crossed[:-1, 1:] | crossed[1:, 1:]
        for _ in range(ROUNDS):
            changed = False
            for void in np.flatnonzero(near):
                other = voids.copy()
                other.flat[orbits[void]] = not voids.flat[void]
                if self._is_one(other) and self._gain(voids, other, orbits[void]) > LEAST_GAIN:
                    voids, changed = other, True
            if not changed:
                break
        return voids

    def opened(self, voids: BoolArray, images: IntArray | None) -> BoolArray:
        """Leave out more voids as long as that lets a notch out that the parts would enclose."""
        orbits, best = self._orbits(images), self._draft(voids, hinges_of(voids))
        tried: set[int] = set()
        while more := [void for void in self._that_enclose(best) if void not in tried]:
            tried.add(more[0])
            other = best.voids.copy()
            other.flat[orbits[more[0]]] = False
            # Enclosed places only take from what the parts are worth.
            if self._is_one(other) and self._parts_worth(other, hinged := hinges_of(other)) > best.worth + LEAST_GAIN:
                draft = self._draft(other, hinged)
                best = draft if draft.worth > best.worth + LEAST_GAIN else best
        return best.voids

    def _that_enclose(self, draft: _NotchDraft) -> list[int]:
        """Voids whose hinges bar the way out of the enclosed parts of notches, along slits of those that went."""
        if not draft.enclosed:
            return []
        slits: GeometryArray = np.asarray(shapely.linestrings(self._slits), dtype=object)
        went = slits[~draft.voids]
        bars = went[shapely.distance(went, shapely.union_all(draft.enclosed)) < TOUCH]
        beside = draft.voids & (shapely.distance(slits, shapely.union_all(bars)) < TOUCH)
        return [int(void) for void in np.flatnonzero(beside)]

    def _parts_worth(self, voids: BoolArray, hinged: BoolArray) -> float:
        """Worth that the parts with these voids and hinges add to the silhouette."""
        return sum(self._part(k, hinged[k])[0] for k in range(len(hinged))) + float(self._void_gain[voids].sum())

    def _draft(self, voids: BoolArray, hinged: BoolArray) -> _NotchDraft:
        """The parts with these voids and hinges before enclosed places are filled."""
        shapes = np.empty(len(self._panels), dtype=object)
        shapes[:] = [self._part(k, hinged[k])[1] for k in range(len(hinged))]
        worth = self._parts_worth(voids, hinged)
        notches = [] if self._open_inside else self._enclosed(shapes)
        if notches:
            self._open_ways_out(shapes, hinged, ~voids, notches)
            notches = [notch for notch in self._enclosed(shapes) if notch.area > WORTH_OPENING]
        filled = STICKING_OUT * sum(float(notch.area) for notch in notches)
        return _NotchDraft(voids, shapes, notches, worth - filled)

    def _enclosed(self, shapes: GeometryArray) -> list[Polygon]:
        """Places that the parts of all panels enclose; the many that are whole are united once."""
        middle = self._middle & np.array([shape is None for shape in shapes])
        if np.any(middle != self._middle):
            self._middle, self._united = middle, shapely.union_all(self._panels[middle], grid_size=GRID)
        return enclosed([self._united, *self._present(shapes)[~self._middle]])

    def _orbits(self, images: IntArray | None) -> IntArray:
        """Each void with its images, (m n, G + 1), if the target has the sheet's symmetry; else alone."""
        alone = np.arange(self._rows * self._columns)[:, None]
        share = self._shares().ravel()
        if images is None or np.abs(share[images] - share).max() > ALIKE:
            return alone
        return np.concatenate([alone, images.T], axis=1)

    def _gain(self, before: BoolArray, after: BoolArray, orbit: IntArray) -> float:
        """By how much the trimmed sheet is worth more with other voids, those of one orbit."""
        row, column = np.divmod(orbit, self._columns)
        beside = [(row + down) * (self._columns + 1) + column + right for down in (0, 1) for right in (0, 1)]
        panels = np.unique(np.concatenate(beside))
        changes = self._void_gain.flat[np.unique(orbit)].sum() * (1.0 if after.flat[orbit[0]] else -1.0)
        old, new = hinges_of(before), hinges_of(after)
        changes -= sum(self._part(k, old[k])[0] for k in panels.tolist())
        # No panel is worth more than its part on the target: where that is too little, no part has to be made.
        most = float(changes + sum(self._most(k, new[k]) for k in panels.tolist()))
        if most <= LEAST_GAIN:
            return most
        return float(changes + sum(self._part(k, new[k])[0] for k in panels.tolist()))

    def _most(self, k: int, hinged: BoolArray) -> float:
        """Bound of the worth that a panel with these hinges adds."""
        key = k, hinged.tobytes()
        if key in self._known:
            return self._known[key][0]
        return float(self._inside[k]) if hinged.any() else 0.0

    def _part(self, k: int, hinged: BoolArray) -> tuple[float, BaseGeometry | None]:
        """What a panel with these hinges adds to the silhouette's worth, and what stays of it."""
        key = k, hinged.tobytes()
        if key not in self._known:
            self._known[key] = self._looked_at(k, hinged)
        return self._known[key]

    def _looked_at(self, k: int, hinged: BoolArray) -> tuple[float, BaseGeometry | None]:
        if not hinged.any():
            return 0.0, NOTHING
        shape, area, shared = None, float(self._area[k]), float(self._inside[k])
        if shared < area - SLIVER * SLIVER:
            shape = kept_part(self._panels[k], self._common[k], self._corners[k], hinged, self._keep)
        return (shared - STICKING_OUT * (area - shared) if shape is None else self._worth(k, shape)), shape

    def _worth(self, k: int, shape: Polygon) -> float:
        """Worth of a part of a panel to the silhouette."""
        shared = float(shape.intersection(self._common[k]).area)
        if k not in self._wide:
            self._wide[k] = shapely.buffer(self._targets[k], self._keep)
        far = float(shape.difference(self._wide[k]).area)
        return shared - STICKING_OUT * (float(shape.area) - shared) - self._far_off * far

    def _clear_of_guests(self, shapes: GeometryArray, hinged: BoolArray) -> GeometryArray:
        """The parts of all panels, with room for connectors that rest on their sides."""
        panels, cleared = all_panels(self._rows, self._columns), shapes.copy()
        place, there = np.zeros((panels.corners.max() + 1, 2)), np.zeros(panels.corners.max() + 2, dtype=np.bool_)
        place[panels.corners] = self._corners
        there[panels.corners[hinged]] = True
        guests = there[panels.guests]  # the last one stands for none
        for k in np.flatnonzero(guests.any(axis=1)).tolist():
            if shapes[k] is not None and not shapes[k].is_empty:
                beside = place[panels.guests[k][guests[k]]]
                versions = moved_off(self._panels[k], shapes[k], self._corners[k], hinged[k], beside, self._keep)
                cleared[k] = max(versions, key=lambda part: self._worth(k, part), default=shapes[k])
        return cleared

    def parts(self, voids: BoolArray) -> KeptPanels:
        """What stays of all panels with these voids.

        Where both panels of a hinge that was given up reach it all the same, it stays: with its material.
        """
        hinged = hinges_of(voids)
        one, other = _hinge_pairs(self._rows, self._columns)
        there: BoolArray = np.asarray(hinged.any(axis=1))
        reached = self._reached(self._common)
        for _ in range(GIVEN_BACK):
            back = reached[one] & reached[other] & there[one[0]] & there[other[0]] & ~hinged[one]
            hinged[one] |= back
            hinged[other] |= back
            shapes = self._clear_of_guests(self._draft(voids, hinged).shapes, hinged)
            kept = measured(self._panels, self._common, shapes)
            # A crumb that is cut out beside a slit is no hole, and leaves no room for the slit's ends.
            most = self._keep**2 if self._open_inside else math.inf
            kept = with_pockets(kept, self._corners, self._targets, NOTHING, most)
            reached = self._reached(self._present(kept.shapes))
            if not np.any(reached[one] & reached[other] & ~hinged[one]):
                break
        return kept

    def _present(self, shapes: GeometryArray) -> GeometryArray:
        """The parts of all panels, whole ones included."""
        present = shapes.copy()
        whole = np.array([shape is None for shape in shapes])
        present[whole] = self._panels[whole]
        return present

    def _open_ways_out(
        self, shapes: GeometryArray, hinged: BoolArray, left_out: BoolArray, notches: list[Polygon]
    ) -> None:
        """Widen slits of voids that were left out, where they end in a notch that the parts enclose."""
        lines = shapely.linestrings(self._slits[left_out])
        wide = np.asarray(shapely.buffer(lines, 0.5 * WAY_OUT * self._keep, cap_style="square"), dtype=object)
        ways = shapely.union_all(wide[shapely.distance(shapely.union_all(notches), wide) < TOUCH])
        hinges = np.asarray(shapely.points(self._corners[hinged]), dtype=object)
        held = shapely.buffer(hinges[shapely.distance(hinges, ways) < self._keep], 1.02 * self._keep, quad_segs=8)
        way_out = shapely.difference(ways, shapely.union_all(held))
        beside = np.flatnonzero(shapely.intersects(way_out, self._panels) & hinged.any(axis=1))
        for k in beside.tolist():
            part = self._panels[k] if shapes[k] is None else shapes[k]
            rest = largest_part(part, way_out)
            if np.all(self._reached(np.array([rest], dtype=object), k)[0][hinged[k]]):
                shapes[k] = rest

    def _reached(self, shapes: GeometryArray, first: int = 0) -> BoolArray:
        """Which corners the part of each panel, from number ``first`` on, reaches: (P, 4)."""
        return parts_with_corners(shapes, self._corners[first : first + len(shapes)])


def hinges_of(voids: BoolArray) -> BoolArray:
    """Which corners of every panel are hinges of voids that stay: ((m + 1) (n + 1), 4)."""
    rows, columns = voids.shape
    padded = np.pad(voids, 1)
    around = [padded[1 + down : 2 + down + rows, 1 + right : 2 + right + columns] for down, right in AROUND]
    hinged = np.stack([around[one] | around[other] for one, other in AT_CORNER], axis=-1)
    return hinged.reshape(-1, 4)


def _hinge_pairs(rows: int, columns: int) -> tuple[tuple[IntArray, IntArray], tuple[IntArray, IntArray]]:
    """Every hinge as the (panel, corner) of both its panels: the lower or right one, then its neighbour."""
    hinged = all_panels(rows, columns).hinged
    above, left = np.flatnonzero(hinged[:, 0]), np.flatnonzero(hinged[:, 1])
    corner = np.repeat([0, 1], [len(above), len(left)])
    panel = np.concatenate([above, left])
    neighbour = np.concatenate([above - columns - 1, left - 1])
    return (panel, corner), (neighbour, corner + 2)


def _labelled(voids: BoolArray, touching: IntArray | None = None) -> tuple[IntArray, int]:
    """Numbers of the connected sets of voids, and how many there are."""
    # Imported when it is needed: it takes long, and the window starts without it.
    from scipy.ndimage import label

    numbers, count = label(voids, structure=touching)
    return np.asarray(numbers, dtype=np.intp), int(count)


def largest_set(voids: BoolArray) -> BoolArray:
    """The largest connected set of voids."""
    numbers, count = _labelled(voids)
    if count == 0:
        return voids
    largest: BoolArray = numbers == 1 + int(np.argmax(np.bincount(numbers.ravel())[1:]))
    return largest
