"""The last steps of an alignment, on exact polygons: nearest-point sliding of near-copies, then a few probes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from kirigami_studio.evaluate.alignment_target import AlignmentTarget
from kirigami_studio.evaluate.boundary import PlaneArray, as_points
from kirigami_studio.evaluate.outline_batch import OutlineBatch
from kirigami_studio.evaluate.similarity import FloatArray

#: Above this IoU every boundary point has its partner next to it, and nearest-point steps converge to a copy.
NEAR_COPY = 0.98

#: IoU differences below this are ties; the smaller rotation then wins, as a person would turn it.
TIE = 1e-6

#: Steps in log scale, radians and lengths (target of area 1) of the successive probes.
PROBES = (0.006, 0.003)

#: One step along each of the four parameters, both ways.
CROSS = np.concatenate([np.eye(4), -np.eye(4)])


@dataclass(frozen=True, slots=True)
class Placement:
    """Where an outline of the batch lies: ``factor * p + shift``, and its exact IoU there."""

    factor: complex
    shift: complex
    iou: float

    def moved(self, moves: FloatArray) -> tuple[PlaneArray, PlaneArray]:
        """Factors and shifts after small moves (S, 4) in (log scale, rotation, x, y)."""
        return (
            self.factor * np.exp(moves[:, 0] + 1j * moves[:, 1]),
            self.shift + moves[:, 2] + 1j * moves[:, 3],
        )


@dataclass(frozen=True, slots=True, eq=False)
class Finisher:
    """Exact refinement of outline number ``index`` of a batch."""

    outlines: OutlineBatch
    index: int
    target: AlignmentTarget

    def best_of(self, factor: PlaneArray, shift: PlaneArray) -> Placement:
        """Choose among places (S,) by exact IoU, then refine the choice."""
        places = [self._slid(place) for place in self._measured(factor, shift)]
        top = max(place.iou for place in places)
        ties = [place for place in places if place.iou >= top - TIE]
        chosen = min(ties, key=lambda place: abs(np.angle(place.factor)))
        for reach in PROBES:
            chosen = self._probed(chosen, reach)
        return chosen

    def exact_iou(self, factor: PlaneArray, shift: PlaneArray) -> FloatArray:
        """IoU of the polygons themselves at several places (S,)."""
        placed = factor[:, np.newaxis] * self.outlines.vertices[self.index] + shift[:, np.newaxis]
        drawn = shapely.polygons(as_points(placed))
        polygons = drawn if self.outlines.simple[self.index] else shapely.make_valid(drawn)
        common = shapely.area(shapely.intersection(polygons, self.target.polygon))
        return np.asarray(common / (shapely.area(polygons) + self.target.area - common))

    def _measured(self, factor: PlaneArray, shift: PlaneArray) -> list[Placement]:
        iou = self.exact_iou(factor, shift)
        return [Placement(complex(a), complex(b), float(value)) for a, b, value in zip(factor, shift, iou, strict=True)]

    def _slid(self, place: Placement, rounds: int = 2) -> Placement:
        """Move a near-copy so that its boundary points meet the tangents at their nearest target points.

        Least squares in the normal direction only (as in point-to-line registration): quadratic convergence, so two
        rounds reach a copy to rounding.
        """
        if place.iou < NEAR_COPY:
            return place
        points, steps = self.outlines.points[self.index], self.outlines.steps[self.index]
        factor, shift = place.factor, place.shift
        for _ in range(rounds):
            arm = factor * points
            here = arm + shift
            along = shapely.line_locate_point(self.target.ring, shapely.points(here.real, here.imag))
            feet = shapely.line_interpolate_point(self.target.ring, along)
            gap = shapely.get_x(feet) + 1j * shapely.get_y(feet) - here
            edge = factor * steps
            # sqrt(ds) times the unit normal: every length of boundary counts the same.
            normal = 1j * np.conj(edge) / np.sqrt(np.maximum(np.abs(edge), 1e-12))
            rows = np.stack([(normal * arm).real, (1j * normal * arm).real, normal.real, -normal.imag], axis=-1)
            move = np.linalg.lstsq(rows, (normal * gap).real, rcond=1e-9)[0]
            factor *= complex(np.exp(move[0] + 1j * move[1]))
            shift += complex(move[2], move[3])
        slid = self._measured(np.array([factor]), np.array([shift]))[0]
        return slid if slid.iou > place.iou else place

    def _probed(self, place: Placement, reach: float) -> Placement:
        """Try a cross of moves and the summit of the parabolas through them; keep the best place."""
        moves = reach * CROSS
        iou = self.exact_iou(*place.moved(moves))
        up, down = iou[:4], iou[4:]
        bend = np.maximum(2.0 * place.iou - up - down, 1e-9)
        jump = reach * np.clip(0.5 * (up - down) / bend, -2.0, 2.0)
        moves = np.concatenate([moves, [jump, 0.5 * jump]])
        iou = np.append(iou, self.exact_iou(*place.moved(moves[-2:])))
        best = int(np.argmax(iou))
        if iou[best] <= place.iou:
            return place
        factor, shift = place.moved(moves[best : best + 1])
        return Placement(complex(factor[0]), complex(shift[0]), float(iou[best]))
