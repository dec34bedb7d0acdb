"""Points of an outline that can be dragged, and the lines between them that follow.

An anchor is a corner, with lines that stay as straight as they were, or smooth, with lines that flow through it.
Moving one bends only the two lines that meet in it, so that a traced shape keeps its detail elsewhere.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import Polygon

from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.target.contour import FloatArray
from kirigami_studio.target.placed import Placed

#: Anchors of a target are the corners of its simplification by this share of the root of its area.
ANCHOR_ERROR = 0.03
MOST_ANCHORS = 60
#: A turn below this is smooth.
SMOOTH_TURN = math.radians(40.0)
#: Vertices of a curve between two anchors.
CURVE_VERTICES = 15
FEWEST_ANCHORS = 3


@dataclass(frozen=True, slots=True, eq=False)
class Anchors:
    """A closed line through anchors.

    Attributes
    ----------
    places : (K, 2) float, mm
        Anchors, counter-clockwise.
    smooth : (K,) bool
        Whether the line flows through the anchor.
    spans : tuple of K (P, 2) float arrays, mm
        Vertices between anchor k and the next, both left out.
    """

    places: FloatArray
    smooth: npt.NDArray[np.bool_]
    spans: tuple[FloatArray, ...]

    @classmethod
    def of(cls, target: Placed) -> Anchors:
        """Anchors of a target: its corners, or the corners of its simplification where it has many vertices."""
        ring = target.ring
        error = 1e-9 if len(ring) <= MOST_ANCHORS // 2 else ANCHOR_ERROR
        chosen = _corners(ring, error * target.scale)
        while len(chosen) > MOST_ANCHORS:
            error *= 1.5
            chosen = _corners(ring, error * target.scale)
        ends = [*chosen[1:], chosen[0] + len(ring)]
        spans = tuple(
            np.take(ring, np.arange(first + 1, last), axis=0, mode="wrap")
            for first, last in zip(chosen, ends, strict=True)
        )
        turns = _turns(ring)[chosen]
        curved = np.array([len(span) > 0 for span in spans])
        return cls(ring[chosen], (turns < SMOOTH_TURN) & (curved | np.roll(curved, 1)), spans)

    @property
    def ring(self) -> FloatArray:
        """(L, 2) float, mm: the whole line."""
        return np.concatenate(
            [part for place, span in zip(self.places, self.spans, strict=True) for part in (place[None], span)]
        )

    def line(self, index: int) -> FloatArray:
        """(P + 2, 2) float, mm: the line from anchor ``index`` to the next, both included."""
        after = self.places[(index + 1) % len(self.places)]
        return np.concatenate([self.places[index][None], self.spans[index], after[None]])

    def moved(self, index: int, place: tuple[float, float]) -> Anchors:
        """Put an anchor elsewhere; the two lines that meet in it follow, their other ends stay."""
        shift = np.array(place) - self.places[index]
        places = self.places.copy()
        places[index] = place
        before = (index - 1) % len(places)
        spans = list(self.spans)
        spans[before] = spans[before] + _weights(self.line(before), bool(self.smooth[index]))[:, None] * shift
        towards = _weights(self.line(index)[::-1], bool(self.smooth[index]))[::-1]
        spans[index] = spans[index] + towards[:, None] * shift
        return replace(self, places=places, spans=tuple(spans))

    def with_kind(self, index: int, smooth: bool) -> Anchors:
        """Make an anchor smooth (curves through it) or a corner (straight lines to its neighbours)."""
        kinds = self.smooth.copy()
        kinds[index] = smooth
        changed = replace(self, smooth=kinds)
        return changed._redrawn((index - 1) % len(self.places))._redrawn(index)

    def inserted(self, place: tuple[float, float]) -> tuple[Anchors, int]:
        """Set another anchor on the line, as near to a place as possible, and return its index."""
        best = min(range(len(self.places)), key=lambda index: _nearest(self.line(index), place)[0])
        line = self.line(best)
        _, piece, spot = _nearest(line, place)
        head, tail = line[1 : piece + 1], line[piece + 1 : -1]
        bent = len(self.spans[best]) > 0
        return replace(
            self,
            places=np.insert(self.places, best + 1, spot, axis=0),
            smooth=np.insert(self.smooth, best + 1, bent),
            spans=(*self.spans[:best], _apart(head, spot), _apart(tail, spot), *self.spans[best + 1 :]),
        ), best + 1

    def without(self, index: int) -> Anchors:
        """Take an anchor away; one line joins its neighbours.

        Raises
        ------
        TargetError
            Three anchors are left, the fewest that enclose an area.
        """
        if len(self.places) <= FEWEST_ANCHORS:
            raise TargetError(f"A target needs at least {FEWEST_ANCHORS} points; move them instead of deleting one.")
        spans = list(self.spans)
        del spans[index]
        fewer = replace(
            self,
            places=np.delete(self.places, index, axis=0),
            smooth=np.delete(self.smooth, index),
            spans=tuple(spans),
        )
        return fewer._redrawn((index - 1) % len(fewer.places))

    def _redrawn(self, index: int) -> Anchors:
        """Draw the line from an anchor to the next anew: a curve when one of them is smooth, else straight."""
        spans = list(self.spans)
        spans[index] = self._curve(index)
        return replace(self, spans=tuple(spans))

    def _curve(self, index: int) -> FloatArray:
        after = (index + 1) % len(self.places)
        if not (self.smooth[index] or self.smooth[after]):
            return np.empty((0, 2))
        chord = self.places[after] - self.places[index]
        out, into = self._tangent(index, chord), self._tangent(after, chord)
        t = (np.arange(1, CURVE_VERTICES + 1) / (CURVE_VERTICES + 1))[:, None]
        # Cubic Hermite between both ends.
        curve: FloatArray = (
            (2 * t**3 - 3 * t**2 + 1) * self.places[index]
            + (t**3 - 2 * t**2 + t) * out
            + (3 * t**2 - 2 * t**3) * self.places[after]
            + (t**3 - t**2) * into
        )
        return curve

    def _tangent(self, index: int, chord: FloatArray) -> FloatArray:
        """Direction of the line at an anchor, as long as the chord: Catmull and Rom's at a smooth one."""
        if not self.smooth[index]:
            return chord
        across = self.places[(index + 1) % len(self.places)] - self.places[index - 1]
        length = float(np.linalg.norm(across))
        return chord if length == 0 else across / length * float(np.linalg.norm(chord))


def _corners(ring: FloatArray, tolerance: float) -> list[int]:
    """Indices of the vertices that a simplification keeps, in order, at least three."""
    kept = {tuple(vertex) for vertex in shapely.get_coordinates(Polygon(ring).simplify(tolerance)).tolist()}
    found = [index for index, vertex in enumerate(ring.tolist()) if tuple(vertex) in kept]
    return found if len(found) >= FEWEST_ANCHORS else [0, len(ring) // 3, 2 * len(ring) // 3]


def _turns(ring: FloatArray) -> FloatArray:
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    turns: FloatArray = np.abs(np.arctan2(cross, np.sum(before * after, axis=1)))
    return turns


def _weights(line: FloatArray, smooth: bool) -> FloatArray:
    """(P,) float, 0..1: how far the inner vertices of a line follow its last one, by their way from its first."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    share = along[1:-1] / max(float(along[-1]), 1e-300)
    return share * share * (3.0 - 2.0 * share) if smooth else share


def _nearest(line: FloatArray, place: tuple[float, float]) -> tuple[float, int, FloatArray]:
    """Distance, segment and spot of a polyline nearest to a place; ends of the line are kept out of reach."""
    start, along = line[:-1], np.diff(line, axis=0)
    squared = np.maximum(np.sum(along**2, axis=1), 1e-300)
    share = np.clip(np.sum((np.array(place) - start) * along, axis=1) / squared, 0.0, 1.0)
    share[0], share[-1] = max(share[0], 0.05), min(share[-1], 0.95)
    spots = start + share[:, None] * along
    distance = np.linalg.norm(spots - place, axis=1)
    best = int(np.argmin(distance))
    return float(distance[best]), best, spots[best]


def _apart(part: FloatArray, spot: FloatArray) -> FloatArray:
    """A part of a line without the vertices that coincide with the new anchor."""
    kept: FloatArray = part[np.linalg.norm(part - spot, axis=1) > 0]
    return kept
