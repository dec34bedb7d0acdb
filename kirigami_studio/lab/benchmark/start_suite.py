"""Sheets that start as something else than a rectangle: pairs of shapes designed, and random sheets measured."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from kirigami_studio.evaluate.candidate import Candidate, Origin
from kirigami_studio.evaluate.feasibility import UNION_GRID, invalid_quads, path_contact
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.lab.baselines.marching import void_angle
from kirigami_studio.lattice.deployment import Deployment, deploy, rotate
from kirigami_studio.lattice.laying import lost_to_chords, start_error
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Rim, RimPath, Sheet, anchor_points, rim_table
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.starts import StartShape
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import best_of
from kirigami_studio.polish.flat_sheet import first_sheet
from kirigami_studio.polish.unfolding import has_hollows

Report = Callable[[int, int], None]

#: Random fields have ratios between 0.1 and 10, and mouths moved by up to this (unit cells).
MOVED = 0.6
#: Random sheets are looked at half open and closed.
ANGLES = (0.5 * math.pi, 0.0)
#: A share of the panels' area that overlaps beyond this is a crossing that had to be reported.
OVERLAP = 1e-6


@dataclass(frozen=True, slots=True)
class PairFigures:
    """The first design that takes a start to a target.

    Attributes
    ----------
    start, target, grid : str
    iou_exact, uniform_iou : float
        Of the design, and of the uniform sheet of the same start.
    start_error, lost_to_chords : float
        Shares of the start's area, see ``lattice.laying``.
    panel_area_cv, least_neck, least_edge : float
        The last two in unit cells.
    symmetry : str or None
    best_sampled, best_guided : float or None
        Exact IoU of the best feasible design that began with a sample, and with the uniform sheet.
    seconds, processor_seconds : float
        Wall time; and processor time of this process, which is all of it where there are no workers.
    """

    start: str
    target: str
    grid: str
    iou_exact: float
    uniform_iou: float
    start_error: float
    lost_to_chords: float
    panel_area_cv: float
    least_neck: float
    least_edge: float
    symmetry: str | None
    best_sampled: float | None
    best_guided: float | None
    seconds: float
    processor_seconds: float


def design_pairs(
    starts: Sequence[StartShape],
    targets: Sequence[Outline],
    grid: tuple[int, int] | None,
    k: int,
    polish: int,
    seed: int,
    report: Report,
) -> list[PairFigures]:
    """Design every target from every start, unsearched."""
    pairs = []
    for number, (start, target) in enumerate((start, target) for start in starts for target in targets):
        report(number, len(starts) * len(targets))
        began = time.process_time()
        result = best_of(Request(target, grid, k=k, polish=polish, seed=seed, start=start))
        spent = time.process_time() - began
        best, (rows, columns) = result.best, result.request.chosen_grid
        even, symmetry = best.score.evenness, best.symmetry
        pairs.append(
            PairFigures(
                start.name,
                target.name,
                f"{rows}x{columns}",
                best.score.iou_exact,
                best.score.uniform_iou,
                start_error(best.sheet),
                lost_to_chords(best.sheet),
                even.area_cv,
                even.least_neck,
                even.least_edge,
                None if symmetry is None else symmetry.label,
                _best_of(result.candidates, Origin.SAMPLED),
                _best_of(result.candidates, Origin.GUIDED),
                result.seconds,
                spent,
            )
        )
    return pairs


def _best_of(candidates: Sequence[Candidate], origin: Origin) -> float | None:
    return max((one.score.iou_exact for one in candidates if one.origin is origin and one.score.feasible), default=None)


def pair_figures(pairs: Sequence[PairFigures]) -> dict[str, float]:
    """Means over all pairs, and the worst of what must not be large."""
    return {
        "pairs": float(len(pairs)),
        "iou_exact": float(np.mean([pair.iou_exact for pair in pairs])),
        "iou_exact_worst": min(pair.iou_exact for pair in pairs),
        "uniform_iou": float(np.mean([pair.uniform_iou for pair in pairs])),
        "start_error_worst": max(pair.start_error for pair in pairs),
        "panel_area_cv": float(np.mean([pair.panel_area_cv for pair in pairs])),
        "panel_area_cv_worst": max(pair.panel_area_cv for pair in pairs),
        "best_sampled": float(np.mean([pair.best_sampled or 0.0 for pair in pairs])),
        "best_guided": float(np.mean([pair.best_guided or 0.0 for pair in pairs])),
        "seconds": float(np.mean([pair.seconds for pair in pairs])),
        "processor_seconds": float(np.mean([pair.processor_seconds for pair in pairs])),
    }


@dataclass(frozen=True, slots=True)
class RandomSheets:
    """Random ratios and mouths on one start.

    Attributes
    ----------
    start : str
    count : int
    hollow : bool
        Whether the start has hollows, around which panels may be turned over.
    inverted : int
        Panels that are turned over in the flat sheet, which then is not feasible.
    local_rule, zip, partition : float
        Largest misses of Eq. 2, of the rim edges that fold onto each other at phi = 0 (unit cells), and of the panels'
        areas to the sheet's, as a share.
    crossings, unreported : int
        Sheets that are told to touch themselves on the way; those whose panels overlap though neither that nor a
        panel turned over was told.
    """

    start: str
    count: int
    hollow: bool
    inverted: int
    local_rule: float
    zip: float
    partition: float
    crossings: int
    unreported: int

    @property
    def ok(self) -> bool:
        """Whether all is as it has to be."""
        return (
            (self.hollow or not self.inverted)
            and not self.unreported
            and max(self.local_rule, self.zip, self.partition) < 1e-9
        )


def random_sheets(start: StartShape, grid: tuple[int, int], count: int, seed: int, report: Report) -> RandomSheets:
    """Measure ``count`` random sheets of a start and grid, around the one where fits begin."""
    random, flat = np.random.default_rng(seed), first_sheet(grid, start)
    z, hollow = flat.field.log10, start.outline is not None and has_hollows(start.outline.points)
    held = RimPath(*grid, flat.start, flat.cell).held
    inverted = crossings = unreported = 0
    misses = np.zeros(3)
    for number in range(count):
        report(number, count)
        field = RatioField.from_log10(np.clip(z + random.uniform(-1.0, 1.0, grid), -1.0, 1.0))
        offsets = np.where(held, 0.0, random.uniform(-MOVED, MOVED, held.size))
        sheet = Sheet(field, Rim.moved(*grid, offsets), flat.start, flat.cell)
        deployment = deploy(sheet)
        areas = _areas(deployment.panels(math.pi))
        inverted += int(np.count_nonzero(areas < 0.0))
        whole = shapely.Polygon(anchor_points(sheet)).area
        local = max(_local_rule(deployment, phi) for phi in ANGLES)
        misses = np.maximum(misses, [local, _zip_gap(deployment), abs(areas.sum() - whole) / whole])
        told = path_contact(deployment, 0.0) is not None
        crossings += told
        unreported += not told and not invalid_quads(deployment, 0.0) and _overlap(deployment) > OVERLAP
    rule, zipped, partition = (float(miss) for miss in misses)
    return RandomSheets(start.name, count, hollow, inverted, rule, zipped, partition, crossings, unreported)


def _areas(panels: FloatArray) -> FloatArray:
    """Signed areas of panels (..., 4, 2), positive counter-clockwise."""
    after = np.roll(panels, -1, axis=-2)
    return np.asarray(0.5 * (panels[..., 0] * after[..., 1] - panels[..., 1] * after[..., 0]).sum(axis=-1))


def _local_rule(deployment: Deployment, phi: float) -> float:
    """Largest miss of Eq. 2 over all voids, unit cells."""
    corners, field = deployment.voids(phi), deployment.field
    seed = corners[:, :, 3] - corners[:, :, 0]
    even = (np.add.outer(np.arange(field.rows), np.arange(field.columns)) % 2 == 0)[..., None]
    side = np.where(even, rotate(seed, -void_angle(0, 0, phi)), rotate(seed, -void_angle(0, 1, phi)))
    side = field.ratio[..., None] * side
    gaps = np.stack([corners[:, :, 1] - corners[:, :, 0] - side, corners[:, :, 2] - corners[:, :, 3] - side])
    return float(np.abs(gaps).max())


def _zip_gap(deployment: Deployment) -> float:
    """Largest distance at phi = 0 between the two neighbours of an edge hinge, unit cells."""
    table, loop = rim_table(*deployment.sheet.grid), deployment.topology.outline_nodes
    place = np.flatnonzero(np.isin(loop, table.node[table.share.max(axis=1) < 0.75]))
    outline = deployment.nodes(0.0)[loop]
    return float(np.abs(outline[place - 1] - outline[(place + 1) % loop.size]).max())


def _overlap(deployment: Deployment) -> float:
    """Share of the panels' area that is lost in their union at phi = 0."""
    panels = shapely.polygons(deployment.panels(0.0).reshape(-1, 4, 2))
    return 1.0 - float(shapely.union_all(panels, grid_size=UNION_GRID).area / shapely.area(panels).sum())
