"""The last step of an alignment, on exact polygons: near-copies slide to where the boundaries meet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from kirigami_studio.evaluate.alignment_target import AlignmentTarget
from kirigami_studio.evaluate.boundary import as_points, edge_parts
from kirigami_studio.foundation.arrays import ComplexArray

#: Above this IoU every boundary point has its partner next to it, and nearest-point steps converge to a copy.
NEAR_COPY = 0.98

#: The table blurs boundaries: it takes up to 0.031 off the IoU of a copy (46 library shapes).  What it places below
#: ``NEAR_COPY`` by more than this is not measured exactly.
TABLE_ERROR = 0.04

#: IoU differences below this are ties; the smaller rotation then wins, as a person would turn it.
TIE = 1e-6

#: Boundary points that slide, beside the vertices.
SLIDING_PARTS = 64

#: Slides: convergence is quadratic, so two reach a copy to rounding.
ROUNDS = 2


@dataclass(frozen=True, slots=True)
class Placement:
    """Where an outline lies, ``factor * p + shift``, and its IoU there."""

    factor: complex
    shift: complex
    iou: float


def finished(vertices: ComplexArray, target: AlignmentTarget, places: Sequence[Placement]) -> Placement:
    """Choose among places of an outline (L,) complex, in its normal frame.

    The first one unless it is a near-copy of the target: then all of them slide, and the best by exact IoU is chosen.
    Shapes that are almost symmetric have several near-copies, which the table cannot tell apart.
    """
    if places[0].iou < NEAR_COPY - TABLE_ERROR:
        return places[0]
    measured = [slid(vertices, target, place) for place in places]
    top = max(place.iou for place in measured)
    ties = [place for place in measured if place.iou >= top - TIE]
    return min(ties, key=lambda place: abs(np.angle(place.factor)))


def slid(vertices: ComplexArray, target: AlignmentTarget, place: Placement) -> Placement:
    """Move a near-copy so that its boundary points meet the tangents at their nearest target points.

    Least squares in the normal direction only, as in point-to-line registration.  Never worse by exact IoU, which the
    result holds, than the given place; the given place itself unless that is a near-copy.
    """
    factor, shift = place.factor, place.shift
    start = Placement(factor, shift, exact_iou(vertices, target, factor, shift))
    if start.iou < NEAR_COPY:
        return start
    points, steps = edge_parts(vertices, SLIDING_PARTS)
    for _ in range(ROUNDS):
        arm = factor * points
        here = arm + shift
        along = shapely.line_locate_point(target.ring, shapely.points(here.real, here.imag))
        feet = shapely.line_interpolate_point(target.ring, along)
        gap = shapely.get_x(feet) + 1j * shapely.get_y(feet) - here
        edge = factor * steps
        # sqrt(ds) times the unit normal: every length of boundary counts the same.
        normal = 1j * np.conj(edge) / np.sqrt(np.maximum(np.abs(edge), 1e-12))
        rows = np.stack([(normal * arm).real, (1j * normal * arm).real, normal.real, -normal.imag], axis=-1)
        move = np.linalg.lstsq(rows, (normal * gap).real, rcond=1e-9)[0]
        factor *= complex(np.exp(move[0] + 1j * move[1]))
        shift += complex(move[2], move[3])
    end = Placement(factor, shift, exact_iou(vertices, target, factor, shift))
    return end if end.iou > start.iou else start


def exact_iou(vertices: ComplexArray, target: AlignmentTarget, factor: complex, shift: complex) -> float:
    """IoU of the polygons themselves, laid at ``factor * p + shift``."""
    polygon = shapely.Polygon(as_points(factor * vertices + shift))
    shape = polygon if polygon.is_valid else shapely.make_valid(polygon)
    common = shape.intersection(target.polygon).area
    return float(common / (shape.area + target.area - common))
