"""The similarity that lays one outline over another with the largest intersection over union (IoU).

Four stages, the first three vectorised over many outlines:

1. *starts*: boundary Procrustes for every cyclic shift (Gower 1975), principal axes, and a ring of plain rotations, all
   with equal area and centroid; the few best distinct ones by IoU go on;
2. *ascent* on the tabulated IoU with its boundary-integral gradient, of ever fewer starts;
3. the same ascent of the last ones, with boundary integrals that are accurate to 1e-4 of the area;
4. *refinement* of near-copies on the exact polygons, as in point-to-line registration.

Reflections are never used: a sheet shows its target only the right way round.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import shapely
from numpy import newaxis

from kirigami_studio.evaluate.alignment_target import CYCLE, AlignmentTarget, alignment_target
from kirigami_studio.evaluate.boundary import (
    as_plane,
    as_points,
    checked_polygons,
    edge_parts,
    moments_of_many,
    resampled,
)
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.arrays import ComplexArray, FloatArray

#: Plain rotations tried as starts: every 10 degrees.
RING = 36

#: Starts at the best cyclic shifts of the boundary.
CYCLIC_STARTS = 3

#: Starts that go on, at least 15 degrees apart.
KEPT_STARTS = 4
APART = np.deg2rad(15.0)

#: Spare boundary parts of the integrals that choose among starts.
START_PARTS = 64

#: The ascent's stages: starts kept, spare boundary parts, and band of every step (see ``_ascended``); wide steps first.
STAGES: tuple[tuple[int, int, tuple[float, ...]], ...] = (
    (4, 128, (0.15, 0.12, 0.096, 0.077, 0.061, 0.049, 0.039, 0.031)),
    (2, 256, (0.025, 0.02)),
    (1, 512, (0.02, 0.02, 0.02, 0.02, 0.02)),
)

#: Tabulated IoU that a start may lack and still turn out to be the better near-copy.
RIVAL = 0.01

#: What half a turn counts as when two places are about equally good: the user would turn a design less.
TURN_PENALTY = 2e-4

#: Places of one outline that are closer than this (radians, shares of its size, lengths) slide to one summit.
SAME_PLACE = 0.01

#: Share of the band's weight that every boundary point keeps, so that no direction is left without curvature.
LEAST_WEIGHT = 0.1

#: Damping relative to the trace of the curvature; it only matters where a rotation changes nothing (a disc).
DAMPING = 1e-3

#: Longest step in log scale, radians and lengths.
LONGEST_STEP = 0.2

#: Above this IoU every boundary point has its partner next to it, and nearest-point steps converge to a copy.
NEAR_COPY = 0.98

#: The table blurs boundaries: it takes up to 0.031 off the IoU of a copy (46 library shapes).  What it places below
#: ``NEAR_COPY`` by more than this is not measured exactly.
TABLE_ERROR = 0.04

#: IoU differences below this are ties; the smaller rotation then wins, as the user would turn it.
TIE = 1e-6

#: Boundary points that slide, beside the vertices.
SLIDING_PARTS = 64

#: Pairs of a place and an edge of the target that are looked at together: few enough for the processor's cache.
PAIRS_AT_ONCE = 30_000

#: Slides: convergence is quadratic, so two reach a copy to rounding.
ROUNDS = 2


#: Products of two of four numbers, each once, and which of them stands in each place of a 4 x 4 table, row by row.
PRODUCTS = np.triu_indices(4)
PRODUCT_AT = np.array([0, 1, 2, 3, 1, 4, 5, 6, 2, 5, 7, 8, 3, 6, 8, 9])


@dataclass(frozen=True, slots=True, eq=False)
class Boundaries:
    """Outlines as sums over short parts, ready for boundary integrals."""

    points: ComplexArray  #: (B, Q); midpoints of parts of the edges
    steps: ComplexArray  #: (B, Q); those parts as vectors

    def fluxes(self) -> FloatArray:
        """Flux through each part by log scale, rotation, x and y in the outline's own frame: (B, 4, Q)."""
        moment = np.conj(self.points) * self.steps
        return np.stack([moment.imag, -moment.real, self.steps.imag, -self.steps.real], axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class OutlineBatch:
    """Outlines to be aligned, each in its own normal frame (area 1, centroid at the origin)."""

    vertices: ComplexArray  #: (B, L); counter-clockwise
    axis: FloatArray  #: (B,), radians; direction of the longer principal axis
    to_normal: tuple[Similarity, ...]  #: source frame -> normal frame

    @classmethod
    def from_outlines(cls, outlines: Sequence[npt.ArrayLike]) -> OutlineBatch:
        """Normalise polygons (L, 2) that all have the same number of vertices.

        Raises
        ------
        KirigamiError
            One of them is not finite, has fewer than three points, or no area.
        """
        planes = as_plane(checked_polygons(outlines))
        area, centroid, axis = moments_of_many(planes)
        scale = np.abs(area) ** -0.5
        planes = np.where(area[:, newaxis] > 0, planes, planes[:, ::-1])
        return cls(
            vertices=planes * scale[:, newaxis] - (centroid * scale)[:, newaxis],
            axis=axis,
            to_normal=tuple(
                Similarity.from_complex(complex(s), complex(-c * s)) for s, c in zip(scale, centroid, strict=True)
            ),
        )

    def boundaries(self, spare: int) -> Boundaries:
        """The outlines in L + ``spare`` parts each: more parts, more accurate integrals."""
        return Boundaries(*edge_parts(self.vertices, spare))


@dataclass(frozen=True, slots=True)
class Placement:
    """Where an outline lies, ``factor * p + shift``, and its IoU there."""

    factor: complex
    shift: complex
    iou: float


def align(moving: npt.ArrayLike, fixed: npt.ArrayLike) -> Similarity:
    """Lay ``moving`` over ``fixed``.

    Parameters
    ----------
    moving : (L, 2) float
    fixed : (K, 2) float
        Polygons, first vertex not repeated, either orientation.  The tables of ``fixed`` (about 25 ms) are kept.

    Returns
    -------
    Similarity
        Moving frame -> fixed frame, without reflection; the same input gives the same result.

    Raises
    ------
    KirigamiError
        Points that are not finite, fewer than three, or without area.
    """
    return align_many([moving], fixed)[0]


def align_many(moving: Sequence[npt.ArrayLike], fixed: npt.ArrayLike) -> list[Similarity]:
    """Lay each of several outlines with equal numbers of vertices over ``fixed``; equal to :func:`align` one by one."""
    if len(moving) == 0:
        return []
    target = alignment_target(fixed)
    outlines = OutlineBatch.from_outlines(moving)
    factor = _starts(outlines, target)
    shift = np.zeros_like(factor)
    iou = np.zeros(factor.shape)
    climbed = []
    for kept, parts, bands in STAGES:
        factor, shift = _best(kept, iou, factor, shift)
        factor, shift, iou = _ascended(outlines.boundaries(parts), target, factor, shift, bands)
        climbed.append((factor, shift, iou))
    first, last = climbed[0], climbed[-1]
    found = []
    for index, to_normal in enumerate(outlines.to_normal):
        places = [*_places(index, last, 1.0), *_places(index, first, RIVAL)]
        place = _refined(outlines.vertices[index], target, places)
        laid = Similarity.from_complex(place.factor, place.shift)
        found.append(target.to_source.compose(laid).compose(to_normal))
    return found


def align_near(moving: npt.ArrayLike, fixed: npt.ArrayLike, pose: Similarity) -> Similarity:
    """Climb from ``pose`` to the nearest best place of ``moving`` (L, 2) over ``fixed`` (K, 2)."""
    target, outlines = alignment_target(fixed), OutlineBatch.from_outlines([moving])
    to_normal = outlines.to_normal[0]
    start = target.to_source.inverse().compose(pose).compose(to_normal.inverse())
    factor, shift = np.array([[start.factor]]), np.array([[complex(*start.shift)]])
    iou = np.zeros(factor.shape)
    for _, parts, bands in STAGES:
        factor, shift, iou = _ascended(outlines.boundaries(parts), target, factor, shift, bands)
    place = Placement(complex(factor[0, 0]), complex(shift[0, 0]), float(iou[0, 0]))
    place = _slid(outlines.vertices[0], target, _measured(outlines.vertices[0], target, place))
    return target.to_source.compose(Similarity.from_complex(place.factor, place.shift)).compose(to_normal)


def _places(index: int, climbed: tuple[ComplexArray, ComplexArray, FloatArray], margin: float) -> list[Placement]:
    """Places of one outline within ``margin`` of its best IoU."""
    factor, shift, iou = (values[index] for values in climbed)
    near = np.flatnonzero(iou >= iou.max() - margin)
    return [Placement(complex(factor[slot]), complex(shift[slot]), float(iou[slot])) for slot in near]


def _best(count: int, iou: FloatArray, factor: ComplexArray, shift: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """The ``count`` best places of every outline, (B, count) each; of equal ones those that are turned less."""
    order = np.argsort(TURN_PENALTY * np.abs(np.angle(factor)) / np.pi - iou, axis=1, kind="stable")[:, :count]
    return np.take_along_axis(factor, order, axis=1), np.take_along_axis(shift, order, axis=1)


def _starts(outlines: OutlineBatch, target: AlignmentTarget) -> ComplexArray:
    """The best distinct start rotations of every outline: (B, KEPT_STARTS) complex of modulus 1."""
    count = len(outlines.axis)
    ring = np.tile(np.exp(2j * np.pi * np.arange(RING) / RING), (count, 1))
    half_turns = np.exp(1j * (target.axis - outlines.axis))[:, np.newaxis] * np.array([1.0, -1.0])
    cyclic = _procrustes(outlines.vertices, target)
    rotation = np.concatenate([ring, half_turns, cyclic], axis=1)
    coarse = outlines.boundaries(START_PARTS)
    intersection = _intersections(coarse, target, rotation)
    score = intersection / (2.0 - intersection)
    kept = np.empty((count, KEPT_STARTS), dtype=np.complex128)
    rows = np.arange(count)
    for slot in range(KEPT_STARTS):
        kept[:, slot] = rotation[rows, np.argmax(score, axis=1)]
        near = np.abs(np.angle(rotation / kept[:, slot, np.newaxis])) < APART
        score[near] = -1.0
    return kept


def _procrustes(vertices: ComplexArray, target: AlignmentTarget) -> ComplexArray:
    """Closed-form rotations at the best cyclic shifts of the boundary correspondence: (B, CYCLIC_STARTS) complex.

    With both boundaries resampled by arc length, sum(conj(z_j) w_(j+k)) has the best rotation of shift k as its phase
    and the fit as its modulus; one Fourier transform gives all shifts.
    """
    samples = np.stack([resampled(one, CYCLE) for one in vertices])
    product = np.fft.ifft(np.conj(np.fft.fft(samples)) * target.spectrum)
    fit = np.abs(product)
    peak = (fit >= np.roll(fit, 1, axis=1)) & (fit > np.roll(fit, -1, axis=1))
    best = np.argsort(np.where(peak, -fit, 0.0), axis=1, kind="stable")[:, :CYCLIC_STARTS]
    product, fit = np.take_along_axis(product, best, axis=1), np.take_along_axis(fit, best, axis=1)
    return np.where(fit > 0.0, product / np.maximum(fit, 1e-300), 1.0 + 0.0j)


def _intersections(outlines: Boundaries, target: AlignmentTarget, rotation: ComplexArray) -> FloatArray:
    """Tabulated intersection areas under plain rotations (B, S), complex numbers of modulus 1: (B, S)."""
    length = target.stretch_at(rotation[..., newaxis] * outlines.points[:, newaxis])
    length *= (rotation[..., newaxis] * outlines.steps[:, newaxis]).imag
    return np.asarray(length.sum(axis=-1))


def _ascended(
    outlines: Boundaries,
    target: AlignmentTarget,
    factor: ComplexArray,
    shift: ComplexArray,
    bands: Sequence[float],
) -> tuple[ComplexArray, ComplexArray, FloatArray]:
    """Climb from every start (B, S); returns the best factor, shift and tabulated IoU found, each (B, S).

    Parameters
    ----------
    bands : sequence of float
        Width of the band around the target's outline that gives the curvature, one entry a step (lengths of a target
        of area 1): wide ones far from the summit.
    """
    ascent = _Ascent(outlines, target)
    best = np.full(factor.shape, -np.inf)
    step = np.zeros((*factor.shape, 4))
    share = np.ones(factor.shape)
    trial_factor, trial_shift = factor, shift
    for band in (*bands, None):
        intersection, union, depth = ascent.overlap(trial_factor, trial_shift)
        iou = intersection / union
        better = iou > best
        best = np.where(better, iou, best)
        factor = np.where(better, trial_factor, factor)
        shift = np.where(better, trial_shift, shift)
        if band is None:
            break
        fresh = ascent.newton_step(trial_factor, intersection, union, depth, band)
        step = np.where(better[..., newaxis], fresh, step)
        # A failed step is retried shorter from the best place; successes lengthen it again.
        share = np.where(better, np.minimum(1.6 * share, 1.6), 0.35 * share)
        move = np.clip(share[..., newaxis] * step, -LONGEST_STEP, LONGEST_STEP)
        trial_factor = factor * np.exp(move[..., 0] + 1j * move[..., 1])
        trial_shift = shift + move[..., 2] + 1j * move[..., 3]
    return factor, shift, best


class _Ascent:
    """Tabulated overlap of outlines with a target, and Newton steps, in any place of the outlines.

    A place ``factor[b, s] * p + shift[b, s]`` multiplies what crosses the parts of an outline that moves in its own
    frame by the square of the scale alone, so that all sums over parts are products with tables made once.
    """

    def __init__(self, outlines: Boundaries, target: AlignmentTarget) -> None:
        self._target, self._points = target, outlines.points[:, newaxis]
        self._steps = np.stack([outlines.steps.real, outlines.steps.imag], axis=-1)
        flux = outlines.fluxes()
        self._through = flux.sum(axis=2)[:, newaxis]
        self._flux = np.swapaxes(flux, 1, 2)
        # Products of two of the four that cross a part, by its length: each pair once.
        squares = flux[:, PRODUCTS[0]] * (flux / np.maximum(np.abs(outlines.steps), 1e-12)[:, newaxis])[:, PRODUCTS[1]]
        self._squares = np.swapaxes(squares, 1, 2)

    def overlap(self, factor: ComplexArray, shift: ComplexArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Tabulated intersection and union areas in places (B, S), and depth of the boundary points (B, S, Q)."""
        found = self._target.lookup(factor[..., newaxis] * self._points + shift[..., newaxis])
        along = found.real @ self._steps
        intersection = factor.imag * along[..., 0] + factor.real * along[..., 1]
        return intersection, factor.real**2 + factor.imag**2 + 1.0 - intersection, found.imag

    def newton_step(
        self, factor: ComplexArray, intersection: FloatArray, union: FloatArray, depth: FloatArray, band: float
    ) -> FloatArray:
        """Ascent step (B, S, 4) in (log scale, rotation, x, y).

        With v the velocity of the boundary and n ds its outward normal, dI is the loop integral of v.n ds over the part
        inside the target, dA the same over the whole boundary, and U^2 d(I/U) = (U + I) dI - I dA.  The second
        derivative of I sits where the two outlines cross; a tent of width ``band`` in the depth stands for that delta
        function.
        """
        square, both = factor.real**2 + factor.imag**2, union + intersection
        inside = np.minimum(np.maximum(depth / self._target.step + 0.5, 0.0), 1.0)
        gradient = both[..., newaxis] * (inside @ self._flux) - intersection[..., newaxis] * self._through
        tent = np.maximum(1.0 - np.abs(depth) / band, LEAST_WEIGHT)
        curvature = (both * np.sqrt(square) / band)[..., newaxis] * (tent @ self._squares)[..., PRODUCT_AT]
        # The same in the target's frame but for a rotation, where shifts are longer by the scale: so damping is fair.
        trace = curvature[..., 0] + curvature[..., 5] + (curvature[..., 10] + curvature[..., 15]) / square
        curvature[..., 0:6:5] += (DAMPING * trace)[..., newaxis]
        curvature[..., 10::5] += (DAMPING * trace * square)[..., newaxis]
        own = np.linalg.solve(curvature.reshape(*square.shape, 4, 4), gradient[..., newaxis])[..., 0]
        moved = factor * (own[..., 2] + 1j * own[..., 3])
        return np.stack([own[..., 0], own[..., 1], moved.real, moved.imag], axis=-1)


def _refined(vertices: ComplexArray, target: AlignmentTarget, places: Sequence[Placement]) -> Placement:
    """Choose among places of an outline (L,) complex, in its normal frame.

    The first one unless it is a near-copy of the target: then all of them slide, and the best by exact IoU is chosen.
    Shapes that are almost symmetric have several near-copies, which the table cannot tell apart.
    """
    if places[0].iou < NEAR_COPY - TABLE_ERROR:
        return places[0]
    tops: list[Placement] = []
    for place in sorted((_measured(vertices, target, place) for place in places), key=lambda one: -one.iou):
        if all(_apart(place, top) > SAME_PLACE for top in tops):
            tops.append(place)
    slid = [_slid(vertices, target, top) for top in tops]
    top = max(place.iou for place in slid)
    ties = [place for place in slid if place.iou >= top - TIE]
    return min(ties, key=lambda place: abs(np.angle(place.factor)))


def _measured(vertices: ComplexArray, target: AlignmentTarget, place: Placement) -> Placement:
    """A place with its exact IoU."""
    return replace(place, iou=_exact_iou(vertices, target, place.factor, place.shift))


def _apart(one: Placement, other: Placement) -> float:
    return max(abs(one.factor / other.factor - 1.0), abs(one.shift - other.shift))


def _slid(vertices: ComplexArray, target: AlignmentTarget, start: Placement) -> Placement:
    """Move a near-copy so that its boundary points meet the tangents at their nearest target points.

    Least squares in the normal direction only, as in point-to-line registration.  Never worse by exact IoU, which both
    hold, than the given place; the given place itself unless that is a near-copy.
    """
    if start.iou < NEAR_COPY:
        return start
    factor, shift = start.factor, start.shift
    points, steps = edge_parts(vertices, SLIDING_PARTS)
    for _ in range(ROUNDS):
        arm = factor * points
        here = arm + shift
        gap = _to_nearest(here, target)
        edge = factor * steps
        # sqrt(ds) times the unit normal: every length of boundary counts the same.
        normal = 1j * np.conj(edge) / np.sqrt(np.maximum(np.abs(edge), 1e-12))
        rows = np.stack([(normal * arm).real, (1j * normal * arm).real, normal.real, -normal.imag], axis=-1)
        move = np.linalg.lstsq(rows, (normal * gap).real, rcond=1e-9)[0]
        factor *= complex(np.exp(move[0] + 1j * move[1]))
        shift += complex(move[2], move[3])
    end = _measured(vertices, target, Placement(factor, shift, start.iou))
    return end if end.iou > start.iou else start


def _to_nearest(places: ComplexArray, target: AlignmentTarget) -> ComplexArray:
    """From each place (Q,) to the nearest point of the target's boundary."""
    start = as_plane(shapely.get_coordinates(target.ring))
    edge, start = np.diff(start), start[:-1]
    unit = edge / np.maximum(np.abs(edge) ** 2, 1e-24)
    found = np.empty_like(places)
    for first in range(0, len(places), max(1, PAIRS_AT_ONCE // len(edge))):
        block = slice(first, first + max(1, PAIRS_AT_ONCE // len(edge)))
        back = start - places[block, newaxis]
        share = -(back.real * unit.real + back.imag * unit.imag)
        gap = back + np.clip(share, 0.0, 1.0, out=share) * edge
        nearest = (gap.real**2 + gap.imag**2).argmin(axis=1)
        found[block] = gap[np.arange(len(gap)), nearest]
    return found


def _exact_iou(vertices: ComplexArray, target: AlignmentTarget, factor: complex, shift: complex) -> float:
    """IoU of the polygons themselves, laid at ``factor * p + shift``."""
    polygon = shapely.Polygon(as_points(factor * vertices + shift))
    shape = polygon if polygon.is_valid else shapely.make_valid(polygon)
    common = shape.intersection(target.polygon).area
    return float(common / (shape.area + target.area - common))
