"""Many outlines with equal numbers of vertices, normalised and cut into integration parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from kirigami_studio.evaluate.boundary import as_plane, checked_polygons, edge_parts, moments_of_many
from kirigami_studio.evaluate.similarity import Similarity
from kirigami_studio.foundation.arrays import ComplexArray, FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Boundaries:
    """Outlines as sums over short parts, ready for boundary integrals.

    Attributes
    ----------
    points : (B, Q) complex
        Midpoints of parts of the edges.
    steps : (B, Q) complex
        Those parts as vectors.
    """

    points: ComplexArray
    steps: ComplexArray


@dataclass(frozen=True, slots=True, eq=False)
class OutlineBatch:
    """Outlines to be aligned, each in its own normal frame (area 1, centroid at the origin).

    Attributes
    ----------
    vertices : (B, L) complex
        Counter-clockwise.
    axis : (B,) float, radians
        Direction of the longer principal axis.
    to_normal : tuple of Similarity
        Source frame -> normal frame.
    """

    vertices: ComplexArray
    axis: FloatArray
    to_normal: tuple[Similarity, ...]

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
        planes = np.where(area[:, np.newaxis] > 0, planes, planes[:, ::-1])
        return cls(
            vertices=planes * scale[:, np.newaxis] - (centroid * scale)[:, np.newaxis],
            axis=axis,
            to_normal=tuple(
                Similarity.from_complex(complex(s), complex(-c * s)) for s, c in zip(scale, centroid, strict=True)
            ),
        )

    def boundaries(self, spare: int) -> Boundaries:
        """The outlines in L + ``spare`` parts each: more parts, more accurate integrals."""
        return Boundaries(*edge_parts(self.vertices, spare))
