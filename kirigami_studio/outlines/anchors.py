"""Anchors: points of an outline that can be dragged, and the lines between them that follow.

A line between two anchors is straight, a cubic by the handles of its ends, or keeps the vertices that were traced or
read.  Such a kept line bends when one of its ends moves, so that the shape keeps its detail; a dragged handle, another
kind of anchor or one taken away makes it a cubic.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely.geometry import Polygon

from kirigami_studio.foundation.arrays import BoolArray, FloatArray
from kirigami_studio.foundation.errors import TargetError
from kirigami_studio.outlines import bezier
from kirigami_studio.outlines.nodes import FEWEST_NODES, Kind, Nodes
from kirigami_studio.outlines.placed import Placed

#: Anchors of a target are the corners of its simplification by this share of the root of its area.
ANCHOR_ERROR = 0.03
MOST_ANCHORS = 60
#: With those that a mirror sets.
MOST_NODES = 4 * MOST_ANCHORS
#: A turn below this is smooth.
SMOOTH_TURN = math.radians(40.0)
#: Anchors are found again among the vertices of a target within this share of the root of its area.
SAME_PLACE = 1e-6
#: A kept line whose end is pulled by more than this share of its chord follows its handles instead.
LARGEST_PULL = 0.5
#: The two handles of an anchor.
INTO, OUT = 0, 1


@dataclass(frozen=True, slots=True, eq=False)
class Anchors:
    """A closed line through anchors."""

    places: FloatArray  #: (K, 2), mm; anchors, counter-clockwise
    kinds: tuple[Kind, ...]  #: K of them
    #: (K, 2, 2), mm; from each anchor to its handles, towards the one before and towards the next; zero where there is
    #: none.
    handles: FloatArray
    #: tuple of K (P, 2) float arrays, mm; vertices between anchor k and the next, both left out.
    spans: tuple[FloatArray, ...]
    kept: BoolArray  #: (K,); whether span k keeps its vertices instead of following the handles

    @classmethod
    def of(cls, target: Placed) -> Anchors:
        """Anchors of a target: those it was drawn with, else its corners, or those of its simplification."""
        nodes, ring = target.outline.nodes, target.ring
        if nodes is not None:
            spans = _spans(ring, nodes.at.tolist())
            return cls(ring[nodes.at], nodes.kinds, nodes.handles * target.scale, spans, nodes.kept.copy())
        error = 1e-9 if len(ring) <= MOST_ANCHORS // 2 else ANCHOR_ERROR
        chosen = _corners(ring, error * target.scale)
        while len(chosen) > MOST_ANCHORS:
            error *= 1.5
            chosen = _corners(ring, error * target.scale)
        spans = _spans(ring, chosen)
        curved = np.array([len(span) > 0 for span in spans])
        soft = (_turns(ring)[chosen] < SMOOTH_TURN) & (curved | np.roll(curved, 1))
        kinds = tuple(Kind.SMOOTH if smooth else Kind.CORNER for smooth in soft.tolist())
        bare = cls(ring[chosen], kinds, np.zeros((len(chosen), 2, 2)), spans, curved)
        return bare._with_found_handles(range(len(chosen)))

    @classmethod
    def drawn(cls, places: FloatArray, kinds: tuple[Kind, ...], handles: FloatArray) -> Anchors:
        """Anchors as a pen sets them: (K, 2) places and (K, 2, 2) handles, mm."""
        count = len(places)
        bare = cls(places, kinds, handles, (np.empty((0, 2)),) * count, np.zeros(count, dtype=np.bool_))
        return bare._follow(range(count))

    def nodes_in(self, made: Placed) -> Nodes | None:
        """The anchors as nodes of the target that was made of their line; None when it had to be repaired."""
        ring, count = made.ring, len(made.outline.points)
        far = np.linalg.norm(ring[None] - self.places[:, None], axis=2)
        at = np.argmin(far, axis=1)
        if float(np.max(np.min(far, axis=1))) > SAME_PLACE * made.scale:
            return None
        ways, turned = np.mod(np.diff(at, append=at[:1]), count), np.mod(-np.diff(at, append=at[:1]), count)
        lengths = np.array([len(span) + 1 for span in self.spans])
        if np.array_equal(ways, lengths):
            return Nodes(at, self.kinds, self.handles / made.scale, self.kept.copy())
        if np.array_equal(turned, lengths):  # the line went clockwise
            other = Nodes((count - 1 - at).copy(), self.kinds, self.handles / made.scale, self.kept.copy())
            mirror = np.diag([1.0, -1.0])
            back = other.mapped(mirror, count)
            return Nodes(back.at, back.kinds, back.handles @ mirror, back.kept)
        return None

    @property
    def smooth(self) -> BoolArray:
        """(K,) bool: whether the line flows through the anchor."""
        return np.array([kind is not Kind.CORNER for kind in self.kinds])

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

    # moving --------------------------------------------------------------------------------------------------------

    def moved(self, index: int, place: tuple[float, float]) -> Anchors:
        """Put one anchor elsewhere."""
        there = self.shifted({index}, np.array(place) - self.places[index])
        places = there.places.copy()
        places[index] = place  # exactly, without the rounding of a way there
        return replace(there, places=places)

    def shifted(self, chosen: Collection[int], by: FloatArray | tuple[float, float]) -> Anchors:
        """Move anchors together, mm; lines between two of them go along, others follow at their moved end."""
        return self.displaced(dict.fromkeys(chosen, np.asarray(by, dtype=np.float64)))

    def displaced(self, ways: dict[int, FloatArray]) -> Anchors:
        """Move anchors each by its own way, mm."""
        count = len(self.places)
        shift = np.zeros((count, 2))
        for index, way in ways.items():
            shift[index] = way
        spans, kept = [], self.kept.copy()
        for index, span in enumerate(self.spans):
            one, other = shift[index], shift[(index + 1) % count]
            kept[index] &= not _torn(self.line(index), one - other)
            if len(span) and (np.any(one) or np.any(other)):
                line, soft = self.line(index), self.smooth
                towards = _weights(line[::-1], bool(soft[index]))[::-1, None]
                away = _weights(line, bool(soft[(index + 1) % count]))[:, None]
                moved = span + one if np.array_equal(one, other) else span + towards * one + away * other
                spans.append(moved)
            else:
                spans.append(span)
        return replace(self, places=self.places + shift, spans=tuple(spans), kept=kept)._settled(ways)

    def with_handle(
        self, index: int, side: int, offset: FloatArray, apart: bool = False, even: bool = False
    ) -> Anchors:
        """Move the end of a handle; the opposite one follows as the kind of the anchor says.

        Parameters
        ----------
        side : int
            :data:`INTO` or :data:`OUT`.
        offset : (2,) float, mm
            From the anchor to the handle's end.
        apart : bool
            The anchor becomes a corner: the opposite handle stays.
        even : bool
            The anchor becomes symmetric.
        """
        kind = Kind.CORNER if apart else Kind.SYMMETRIC if even else self.kinds[index]
        kind = Kind.SMOOTH if kind is Kind.AUTO else kind
        handles = self.handles.copy()
        handles[index, side] = offset
        length = float(np.linalg.norm(offset))
        touched = [side]
        if kind is not Kind.CORNER and length > 0:
            own = length if kind is Kind.SYMMETRIC else float(np.linalg.norm(handles[index, 1 - side]))
            if own > 0:
                handles[index, 1 - side] = -np.asarray(offset) * (own / length)
                touched.append(1 - side)
        spans = [(index - 1) % len(self.places) if which == INTO else index for which in touched]
        return replace(self, kinds=_put(self.kinds, index, kind), handles=handles)._redrawn(spans)

    # kinds ---------------------------------------------------------------------------------------------------------

    def with_kind(self, index: int, kind: Kind) -> Anchors:
        """Make an anchor of another kind; a corner loses its handles, so that its lines run straight to it."""
        if kind is self.kinds[index] and kind is not Kind.CORNER:
            return self
        handles = self.handles.copy()
        if kind is Kind.CORNER:
            handles[index] = 0.0
        elif kind is Kind.AUTO or not np.any(handles[index]):
            handles[index] = self._usual_handles(index)
        else:
            into, out = handles[index]
            across = out - into
            length = max(float(np.linalg.norm(across)), 1e-300)
            sides = [float(np.linalg.norm(into)), float(np.linalg.norm(out))]
            if kind is Kind.SYMMETRIC or 0.0 in sides:
                sides = [0.5 * sum(sides)] * 2 if min(sides) > 0 else [max(sides)] * 2
            handles[index] = [-across / length * sides[0], across / length * sides[1]]
        changed = replace(self, kinds=_put(self.kinds, index, kind), handles=handles)
        return changed._redrawn([(index - 1) % len(self.places), index])

    def as_cusp(self, index: int) -> Anchors:
        """Make an anchor a corner that keeps its handles: the line stays, each side can be bent alone from now on."""
        return replace(self, kinds=_put(self.kinds, index, Kind.CORNER))

    # more and fewer ------------------------------------------------------------------------------------------------

    def inserted(self, place: tuple[float, float]) -> tuple[Anchors, int]:
        """Set another anchor on the line, as near to a place as possible, and return its index."""
        best = self._nearest_span(place)
        line = self.line(best)
        piece, spot = _nearest(line, place)
        bent, after = len(self.spans[best]) > 0, (best + 1) % len(self.places)
        handles = np.insert(self.handles, best + 1, 0.0, axis=0)
        spans = [_apart(line[1 : piece + 1], spot), _apart(line[piece + 1 : -1], spot)]
        if bent and not self.kept[best]:
            ends = self.places[best], self.handles[best, OUT], self.handles[after, INTO], self.places[after]
            share = float(np.linalg.norm(spot - line[piece]) / np.linalg.norm(line[piece + 1] - line[piece]))
            spot, out, into_spot, out_of_spot, into = bezier.split(*ends, (piece + share) / (len(line) - 1))
            handles[best, OUT], handles[best + 1] = out, (into_spot, out_of_spot)
            handles[(best + 2) % len(handles), INTO] = into
        kinds = (*self.kinds[: best + 1], Kind.SMOOTH if bent else Kind.CORNER, *self.kinds[best + 1 :])
        more = Anchors(
            np.insert(self.places, best + 1, spot, axis=0),
            kinds,
            handles,
            (*self.spans[:best], *spans, *self.spans[best + 1 :]),
            np.insert(self.kept, best + 1, self.kept[best]),
        )
        if not bent:
            return more, best + 1
        if self.kept[best]:
            return more._with_found_handles([best, best + 1]), best + 1
        return more._redrawn([best, best + 1]), best + 1

    def _nearest_span(self, place: tuple[float, float]) -> int:
        """The span of the whole line's nearest piece."""
        ring = self.ring
        piece, _ = _nearest(np.concatenate([ring, ring[:1]]), place)
        starts = np.cumsum([0, *(len(span) + 1 for span in self.spans)])
        return int(np.searchsorted(starts, piece, side="right")) - 1

    def evened(self, images: Iterable[FloatArray], reach: float) -> Anchors:
        """Set anchors on the line within ``reach`` (mm) of places (P, 2) that have none: those of a mirror image."""
        more = self
        wanted = np.concatenate([*images, np.empty((0, 2))])
        off = shapely.distance(shapely.points(wanted), shapely.linearrings(self.ring))
        for place in wanted[off <= reach]:
            if float(np.min(np.linalg.norm(more.places - place, axis=1))) <= reach or len(more.places) >= MOST_NODES:
                continue
            fuller, index = more.inserted((float(place[0]), float(place[1])))
            if float(np.linalg.norm(fuller.places[index] - place)) <= reach:
                more = fuller
        return more

    def without(self, *chosen: int) -> Anchors:
        """Take anchors away; one line joins the neighbours of each.

        Raises
        ------
        TargetError
            Fewer than three anchors would be left, the fewest that enclose an area.
        """
        if len(self.places) - len(set(chosen)) < FEWEST_NODES:
            raise TargetError("nodes.too_few_left", fewest=FEWEST_NODES)
        fewer = self
        for index in sorted(set(chosen), reverse=True):
            fewer = fewer._without_one(index)
        return fewer

    def _without_one(self, index: int) -> Anchors:
        count = len(self.places)
        before, after = (index - 1) % count, (index + 1) % count
        joined = np.concatenate([self.line(before), self.line(index)[1:]])
        handles = self.handles.copy()
        ends = handles[before, OUT], handles[after, INTO]
        if np.any(ends[0]) and np.any(ends[1]):
            handles[before, OUT], handles[after, INTO] = bezier.handles_along(joined)
        else:  # as straight as the ends are; a single handle grows with its chord
            short = [float(np.linalg.norm(self.places[end] - self.places[index])) for end in (before, after)]
            chord = float(np.linalg.norm(self.places[after] - self.places[before]))
            handles[before, OUT] = ends[0] * chord / max(short[0], 1e-300)
            handles[after, INTO] = ends[1] * chord / max(short[1], 1e-300)
        spans = list(self.spans)
        del spans[index]
        fewer = Anchors(
            np.delete(self.places, index, axis=0),
            (*self.kinds[:index], *self.kinds[index + 1 :]),
            np.delete(handles, index, axis=0),
            tuple(spans),
            np.delete(self.kept, index),
        )
        return fewer._redrawn([(index - 1) % len(fewer.places)])

    # handles -------------------------------------------------------------------------------------------------------

    def _usual_handles(self, index: int) -> FloatArray:
        """Both handles of an automatic anchor: along its neighbours' chord, a third of the way to each."""
        place, before, after = self.places[index], self.places[index - 1], self.places[(index + 1) % len(self.places)]
        across = after - before
        length = float(np.linalg.norm(across))
        if length == 0.0:
            return np.zeros((2, 2))
        along = across / length * bezier.HANDLE_SHARE
        return np.stack([-along * float(np.linalg.norm(place - before)), along * float(np.linalg.norm(after - place))])

    def _with_found_handles(self, spans: Iterable[int]) -> Anchors:
        """Give the ends of kept lines the handles of the cubics that fit them best."""
        handles, count = self.handles.copy(), len(self.places)
        for index in spans:
            if self.kept[index]:
                handles[index, OUT], handles[(index + 1) % count, INTO] = bezier.handles_along(self.line(index))
        return replace(self, handles=handles)

    def _settled(self, moved: Iterable[int]) -> Anchors:
        """Set the handles of automatic anchors that moved, or whose neighbours did, and draw their lines anew."""
        count = len(self.places)
        near = {(index + step) % count for index in moved for step in (-1, 0, 1)}
        handles = self.handles.copy()
        for index in near:
            if self.kinds[index] is Kind.AUTO:
                handles[index] = self._usual_handles(index)
        touched = {(index + step) % count for index in near for step in (-1, 0)}
        return replace(self, handles=handles)._follow(touched)

    def _follow(self, spans: Iterable[int]) -> Anchors:
        """Draw lines by their handles, but for those that keep their vertices."""
        drawn, count = list(self.spans), len(self.places)
        for index in spans:
            if not self.kept[index]:
                after = (index + 1) % count
                ends = self.places[index], self.handles[index, OUT], self.handles[after, INTO], self.places[after]
                drawn[index] = bezier.curve(*ends)
        return replace(self, spans=tuple(drawn))

    def _redrawn(self, spans: Iterable[int]) -> Anchors:
        """Draw lines by their handles; what they kept is gone."""
        wanted = list(spans)
        kept = self.kept.copy()
        kept[wanted] = False
        return replace(self, kept=kept)._follow(wanted)


def with_anchors(target: Placed, anchors: Anchors) -> Placed:
    """The target that follows the anchors' line and remembers them.

    Raises
    ------
    TargetError
        The line crosses itself so that no single shape is meant, or encloses nothing.
    """
    made = target.reshaped(anchors.ring)
    return made.with_nodes(anchors.nodes_in(made))


def _put(kinds: tuple[Kind, ...], index: int, kind: Kind) -> tuple[Kind, ...]:
    return (*kinds[:index], kind, *kinds[index + 1 :])


def _spans(ring: FloatArray, at: list[int]) -> tuple[FloatArray, ...]:
    """The vertices between chosen ones, all the way round."""
    ways = [(after - first) % len(ring) for first, after in zip(at, [*at[1:], at[0]], strict=True)]
    return tuple(
        np.take(ring, np.arange(first + 1, first + way), axis=0, mode="wrap")
        for first, way in zip(at, ways, strict=True)
    )


def _corners(ring: FloatArray, tolerance: float) -> list[int]:
    """Indices of the vertices that a simplification keeps, in order, at least three."""
    kept = {tuple(vertex) for vertex in shapely.get_coordinates(Polygon(ring).simplify(tolerance)).tolist()}
    found = [index for index, vertex in enumerate(ring.tolist()) if tuple(vertex) in kept]
    return found if len(found) >= FEWEST_NODES else [0, len(ring) // 3, 2 * len(ring) // 3]


def _torn(line: FloatArray, by: FloatArray) -> bool:
    """Whether a line is pulled so far at one end that following would leave nothing of how it ran."""
    return float(np.linalg.norm(by)) > LARGEST_PULL * float(np.linalg.norm(line[-1] - line[0]))


def _turns(ring: FloatArray) -> FloatArray:
    """(L,) float, radians: by how much a closed line turns at each vertex, whichever way."""
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    angles: FloatArray = np.abs(np.arctan2(cross, np.sum(before * after, axis=1)))
    return angles


def _weights(line: FloatArray, smooth: bool) -> FloatArray:
    """(P,) float, 0..1: how far the inner vertices of a line follow its last one, by their way from its first."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    share = along[1:-1] / max(float(along[-1]), 1e-300)
    return share * share * (3.0 - 2.0 * share) if smooth else share


def _nearest(line: FloatArray, place: tuple[float, float]) -> tuple[int, FloatArray]:
    """Segment and spot of a polyline nearest to a place; ends of the line are kept out of reach."""
    start, along = line[:-1], np.diff(line, axis=0)
    squared = np.maximum(np.sum(along**2, axis=1), 1e-300)
    share = np.clip(np.sum((np.array(place) - start) * along, axis=1) / squared, 0.0, 1.0)
    share[0], share[-1] = max(share[0], 0.05), min(share[-1], 0.95)
    spots = start + share[:, None] * along
    distance = np.linalg.norm(spots - place, axis=1)
    best = int(np.argmin(distance))
    return best, spots[best]


def _apart(part: FloatArray, spot: FloatArray) -> FloatArray:
    """A part of a line without the vertices that coincide with the new anchor."""
    kept: FloatArray = part[np.linalg.norm(part - spot, axis=1) > 0]
    return kept
