"""Many outlines with equal numbers of vertices, normalised and cut into integration parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import shapely

from kirigami_studio.evaluate.boundary import PlaneArray, as_plane, as_points, checked_polygon, edge_parts, moments
from kirigami_studio.evaluate.similarity import FloatArray, Similarity

#: Boundary integrals use this many points more than there are vertices.
SPARE_PARTS = 256


@dataclass(frozen=True, slots=True, eq=False)
class OutlineBatch:
    """Outlines to be aligned, each in its own normal frame (area 1, centroid at the origin).

    Attributes
    ----------
    vertices : (B, L) complex
        Counter-clockwise.
    points : (B, Q) complex
        Midpoints of parts of the edges.
    steps : (B, Q) complex
        Those parts as vectors.
    axis : (B,) float, radians
        Direction of the longer principal axis.
    simple : (B,) bool
        Whether the outline neither crosses nor touches itself.
    to_normal : tuple of Similarity
        Source frame -> normal frame.
    """

    vertices: PlaneArray
    points: PlaneArray
    steps: PlaneArray
    axis: FloatArray
    simple: npt.NDArray[np.bool_]
    to_normal: tuple[Similarity, ...]

    @classmethod
    def from_outlines(cls, outlines: Sequence[npt.ArrayLike]) -> OutlineBatch:
        """Normalise polygons (L, 2) that all have the same number of vertices.

        Raises
        ------
        KirigamiError
            One of them is not finite, has fewer than three points, or no area.
        """
        planes, axes, normals = [], [], []
        for outline in outlines:
            plane = as_plane(checked_polygon(outline))
            area, centroid, axis = moments(plane)
            scale = abs(area) ** -0.5
            planes.append((plane if area > 0 else plane[::-1]) * scale - centroid * scale)
            axes.append(axis)
            normals.append(Similarity.from_complex(complex(scale), -centroid * scale))
        vertices = np.stack(planes)
        parts = [edge_parts(plane, SPARE_PARTS) for plane in planes]
        return cls(
            vertices=vertices,
            points=np.stack([points for points, _ in parts]),
            steps=np.stack([steps for _, steps in parts]),
            axis=np.array(axes),
            simple=np.atleast_1d(shapely.is_valid(shapely.polygons(as_points(vertices)))),
            to_normal=tuple(normals),
        )
