"""What alignment needs to know about a fixed outline, tabulated once and looked up thousands of times.

Two numbers are tabulated on a square lattice of points: the *stretch* F(x, y), the length of the target to the left of
x on the horizontal line at height y, and the *depth*, the signed distance to the outline (positive inside).  By Green's
theorem the area that a moving polygon shares with the target is the loop integral of F dy along the moving boundary, so
overlap costs a few lookups instead of a polygon clipping.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TypeVar

import numpy as np
import numpy.typing as npt
import shapely
from scipy.spatial import cKDTree
from shapely.geometry.base import BaseGeometry

from kirigami_studio.evaluate.boundary import (
    as_plane,
    as_points,
    checked_polygon,
    moments,
    resampled,
    scan_crossings,
    spread,
)
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.arrays import ComplexArray, FloatArray

_Number = TypeVar("_Number", np.float64, np.complex128)

#: Lattice points each way; with 1.5 target lengths across, one step is under 0.8 % of the target's length.
LATTICE = 193

#: Free margin around the target's bounding box, in lengths of its longer side.
MARGIN = 0.25

#: Scan lines averaged for one row of F, so that horizontal edges are placed to a tenth of a step.
SCAN_LINES = 8

#: Boundary points for cyclic correlation.
CYCLE = 128


@dataclass(frozen=True, slots=True, eq=False)
class AlignmentTarget:
    """A fixed outline in its own normal frame (area 1, centroid at the origin) with its lookup tables."""

    to_source: Similarity  #: normal frame -> frame of the points that it was made from
    polygon: BaseGeometry  #: the filled outline in the normal frame, prepared
    ring: shapely.LinearRing  #: its boundary
    area: float  #: area of ``polygon``: 1 unless the outline crosses itself
    axis: float  #: radians; direction of the longer principal axis
    spectrum: ComplexArray  #: (128,); discrete Fourier transform of the boundary, resampled by arc length
    corner: complex  #: lower left point of the lattice, x + iy
    step: float  #: lattice spacing
    table: ComplexArray  #: (193 * 193,), read-only; F + i depth at the lattice points, rows of constant y, bottom first
    stretch: FloatArray  #: (193 * 193,), read-only; F alone

    @classmethod
    def from_points(cls, points: npt.ArrayLike) -> AlignmentTarget:
        """Tabulate a polygon (K, 2) of any size and place.

        Raises
        ------
        KirigamiError
            Not finite, fewer than three points, or no area.
        """
        plane = as_plane(checked_polygon(points))
        area, centroid, axis = moments(plane)
        scale = float(np.sqrt(abs(area)))
        plane = (plane if area > 0 else plane[::-1]) / scale - centroid / scale
        ring = shapely.LinearRing(as_points(plane))
        polygon: BaseGeometry = shapely.Polygon(ring)
        if not polygon.is_valid:
            polygon = shapely.make_valid(polygon)
        shapely.prepare(polygon)
        low = complex(plane.real.min(), plane.imag.min())
        high = complex(plane.real.max(), plane.imag.max())
        span = (1.0 + 2.0 * MARGIN) * max(high.real - low.real, high.imag - low.imag)
        corner = 0.5 * (low + high) - 0.5 * span * (1.0 + 1.0j)
        step = span / (LATTICE - 1)
        table = (_stretch(plane, corner, step) + 1j * _depth(plane, polygon, corner, step)).ravel()
        table.setflags(write=False)
        stretch = table.real.copy()
        stretch.setflags(write=False)
        return cls(
            to_source=Similarity(scale, 0.0, (centroid.real, centroid.imag)),
            polygon=polygon,
            ring=ring,
            area=float(polygon.area),
            axis=axis,
            spectrum=np.fft.fft(resampled(plane, CYCLE)),
            corner=corner,
            step=step,
            table=table,
            stretch=stretch,
        )

    def lookup(self, places: ComplexArray) -> ComplexArray:
        """F + i depth at any places (x + iy), bilinear between lattice points, constant beyond the lattice."""
        return self._between(self.table, places)

    def stretch_at(self, places: ComplexArray) -> FloatArray:
        """F alone, which costs half as much."""
        return self._between(self.stretch, places)

    def _between(self, table: npt.NDArray[_Number], places: ComplexArray) -> npt.NDArray[_Number]:
        u = np.clip((places.real - self.corner.real) / self.step, 0.0, LATTICE - 1.000001)
        v = np.clip((places.imag - self.corner.imag) / self.step, 0.0, LATTICE - 1.000001)
        column, place = u.astype(np.intp), v.astype(np.intp)
        u -= column
        v -= place
        place *= LATTICE
        place += column
        # Places are inside already: mode "clip" spares a slow check.
        lower = table.take(place, mode="clip")
        place += 1
        lower += u * (table.take(place, mode="clip") - lower)
        place += LATTICE
        right = table.take(place, mode="clip")
        place -= 1
        upper = table.take(place, mode="clip")
        upper += u * (right - upper)
        lower += v * (upper - lower)
        return lower


def _stretch(plane: ComplexArray, corner: complex, step: float) -> FloatArray:
    """F at every lattice point, averaged over one step of height: (193, 193) float."""
    fine = step / SCAN_LINES
    bottom = corner.imag + fine * (0.5 - 0.5 * SCAN_LINES)
    line, crossing, downward = scan_crossings(plane, bottom, fine, LATTICE * SCAN_LINES)
    # Along a line F is piecewise linear: beyond a crossing at c it gains +-(x - c).
    place = (line // SCAN_LINES, np.ceil((crossing - corner.real) / step).astype(np.intp))
    slope = np.zeros((LATTICE, LATTICE))
    level = np.zeros((LATTICE, LATTICE))
    np.add.at(slope, place, downward)
    np.add.at(level, place, downward * crossing)
    x = corner.real + step * np.arange(LATTICE)
    averaged: FloatArray = (np.cumsum(slope, axis=1) * x - np.cumsum(level, axis=1)) / SCAN_LINES
    return averaged


def _depth(plane: ComplexArray, polygon: BaseGeometry, corner: complex, step: float) -> FloatArray:
    """Signed distance to the outline at every lattice point, positive inside: (193, 193) float.

    The nearest of many boundary samples names the edge; the distance to that edge is then exact.
    """
    edges = np.roll(plane, -1) - plane
    pieces = np.maximum(1, np.ceil(np.abs(edges) / (0.5 * step))).astype(np.intp)
    edge, part = spread(pieces)
    sample = plane[edge] + edges[edge] * (part + 0.5) / pieces[edge]
    axis = step * np.arange(LATTICE)
    lattice = (corner + axis + 1j * axis[:, None]).ravel()
    _, nearest = cKDTree(as_points(sample)).query(as_points(lattice))
    start, along = plane[edge[nearest]], edges[edge[nearest]]
    share = np.clip((np.conj(along) * (lattice - start)).real / np.maximum(np.abs(along) ** 2, 1e-300), 0.0, 1.0)
    distance = np.abs(lattice - start - share * along)
    inside = shapely.contains_xy(polygon, lattice.real, lattice.imag)
    signed: FloatArray = np.where(inside, distance, -distance).reshape(LATTICE, LATTICE)
    return signed


@lru_cache(maxsize=64)
def _cached(content: bytes) -> AlignmentTarget:
    return AlignmentTarget.from_points(np.frombuffer(content).reshape(-1, 2))


def alignment_target(points: npt.ArrayLike) -> AlignmentTarget:
    """The tables of a polygon (K, 2), kept for the last 64 polygons that were asked for."""
    return _cached(checked_polygon(points).tobytes())
