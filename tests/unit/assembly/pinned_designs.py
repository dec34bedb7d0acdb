"""Designs for tests of pinned pieces: pinwheels over the outline that they show themselves, or over another."""

from __future__ import annotations

import math

import numpy as np
import shapely

from kirigami_studio.assembly.pieces import Assembly
from kirigami_studio.assembly.pinned import PinnedPlan
from kirigami_studio.evaluate.alignment import align
from kirigami_studio.evaluate.posed_design import PosedDesign
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.mechanics.gripping import SoftMotions
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.settings.fabrication import new_settings
from kirigami_studio.studio.as_cut import motions_on_pins


def pinwheel(
    rows: int = 4, columns: int = 4, z: float = 0.25, noise: float = 0.0, seed: int = 0, phi: float = 0.0
) -> tuple[PosedDesign, Outline]:
    """A pinwheel field over a square, signs of z like a checkerboard, with noise of the same signs."""
    row, column = np.indices((rows, columns))
    size = z + noise * np.random.default_rng(seed).uniform(0.0, 1.0, (rows, columns))
    field = RatioField.from_log10(size * (-1.0) ** (row + column))
    deployment, target = deploy(field), Outline.from_points([(0, 0), (1, 0), (1, 1), (0, 1)], "square")
    return PosedDesign(deployment, align(deployment.outline(phi), target.points), phi), target


def softest(plan: PinnedPlan) -> SoftMotions:
    """The softest motions of a sheet of plywood, as the program has them."""
    assembly = plan.assembly
    width = float(np.ptp(assembly.deployment.compact[:, 0])) * assembly.cell_mm
    return motions_on_pins(assembly.deployment, new_settings({"material": "plywood-co2", "width_mm": width}))


def bodies_at(assembly: Assembly, phi: float) -> list[tuple[int, shapely.Polygon]]:
    """Layer and place of every piece, each carried by its own pose: nothing shared with the making of the pieces."""
    found = []
    for piece, (x, y, turn) in zip(assembly.pieces, assembly.poses(phi), strict=True):
        cosine, sine = math.cos(turn), math.sin(turn)

        def there(points: FloatArray, c: float = cosine, s: float = sine, x: float = x, y: float = y) -> FloatArray:
            return points @ np.array([[c, s], [-s, c]]) + (x, y)

        found.append((piece.layer, shapely.Polygon(there(piece.outline), [there(ring) for ring in piece.openings])))
    return found


def overlap_at(assembly: Assembly, phi: float) -> float:
    """Area, mm2, that pieces of a layer have in common: the sum of their areas less that of their union."""
    placed = bodies_at(assembly, phi)
    layers = [[body for number, body in placed if number == layer] for layer in (1, 2)]
    return max(sum(body.area for body in layer) - shapely.union_all(layer).area for layer in layers)
