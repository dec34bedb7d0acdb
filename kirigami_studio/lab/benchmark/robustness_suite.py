"""What a drawing brings: the same shapes turned, with a shaky contour, in coarser and finer pictures.

The design is drawn from the disturbed shape and scored against the clean one, because that is what was meant.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator

from kirigami_studio.evaluate.boundary import as_plane, as_points, resampled
from kirigami_studio.evaluate.score import Score
from kirigami_studio.evaluate.silhouette import rasterise
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.paper import MASK_SIZE
from kirigami_studio.lab.benchmark.generator_suite import SUCCESS_SIOU, bootstrap_interval
from kirigami_studio.lab.benchmark.variants_suite import difference
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.read_image import outline_of_mask
from kirigami_studio.pipeline.request import Request, as_in_paper
from kirigami_studio.pipeline.run import best_of, sample
from kirigami_studio.pipeline.tasks import scored


@dataclass(frozen=True, slots=True)
class Disturbance:
    """How a shape becomes the target that the generator is given.

    Attributes
    ----------
    turned : bool
        Turned by a random angle, uniform in [0, 2 pi), before it is drawn into pixels.
    pixels : int
        Side of the mask that it is drawn into; the longer side of its bounding box fills it.
    noise : float
        Size of the contour noise, in pixels of a 128-pixel mask; see :func:`shaken`.
    bounded : bool
        The size is the largest displacement, all smaller ones being as likely; else the standard deviation.
    redrawn : bool
        The shaken contour is filled into a mask of ``pixels`` again and read from there, as from a picture.
    """

    turned: bool = False
    pixels: int = MASK_SIZE
    noise: float = 0.0
    bounded: bool = False
    redrawn: bool = False

    def seen(self, shape: Outline, rng: Generator) -> Outline:
        """The shape as it is read after all of this, in the order of the attributes."""
        points = shape.points
        if self.turned:
            points = _turned(points, rng.uniform(0.0, 2.0 * math.pi))
        outline = outline_of_mask(rasterise(points, self.pixels), shape.name)
        if self.noise:
            outline = Outline.from_points(shaken(outline.points, self.noise, rng, self.bounded), shape.name)
        if self.redrawn:
            outline = outline_of_mask(rasterise(outline.points, self.pixels), shape.name)
        return outline


#: What is compared with the clean 128-pixel mask.
DISTURBANCES: dict[str, Disturbance] = {
    "turned": Disturbance(turned=True),
    "contour_noise_bounded": Disturbance(noise=1.0, bounded=True),
    "contour_noise": Disturbance(noise=1.0),
    "contour_noise_redrawn": Disturbance(noise=1.0, redrawn=True),
    "mask_64": Disturbance(pixels=64),
    "mask_256": Disturbance(pixels=256),
    "together_64": Disturbance(turned=True, pixels=64, noise=1.0),
    "together_256": Disturbance(turned=True, pixels=256, noise=1.0),
}


def shaken(points: FloatArray, noise: float, rng: Generator, bounded: bool = False) -> FloatArray:
    """Move a contour in and out.

    It is resampled at equal arc length, one pixel apart, where a pixel is 1/128 of the longer side of the bounding box;
    every point is moved along the contour's normal there by its own random amount, independent of its neighbours.  The
    contour may cross itself afterwards; ``Outline.from_points`` keeps the large piece.

    Parameters
    ----------
    points : (L, 2) float
    noise : float, pixels
        Standard deviation of normally distributed amounts, or the largest of evenly distributed ones.
    rng : Generator
    bounded : bool
        Which of the two.

    Returns
    -------
    points : (M, 2) float
    """
    plane = as_plane(points)
    pixel = float(np.ptp(points, axis=0).max()) / MASK_SIZE
    length = float(np.abs(np.roll(plane, -1) - plane).sum())
    even = resampled(plane, max(3, round(length / pixel)))
    along = np.roll(even, -1) - np.roll(even, 1)
    normal = -1j * along / np.maximum(np.abs(along), 1e-12)
    size = noise * pixel
    amounts = rng.uniform(-size, size, len(even)) if bounded else rng.normal(0.0, size, len(even))
    return as_points(even + normal * amounts)


def measure_robustness(
    shapes: Sequence[Outline],
    variant: str,
    *,
    steps: int = 4,
    polish: int = 0,
    grid: tuple[int, int] = (10, 10),
    seeds: Sequence[int] = (0, 1, 2),
    report: Callable[[int, int], None] = lambda done, total: None,
) -> dict[str, object]:
    """One sample for the clean and for every disturbed target, all scored against the clean one.

    Polished, it tells what the disturbance itself takes away: a fit follows what it is given as closely as it can.

    Parameters
    ----------
    shapes : sequence of Outline
        Exact shapes; the clean target is the contour of their 128-pixel mask.
    variant, steps, polish, grid
        As in :class:`Request`.
    seeds : sequence of int
        Sampling seeds, the same for clean and disturbed targets; every seed also has its own angle and noise.
    report : callable
        Told (done, total) designs.

    Returns
    -------
    figures : dict
        The settings, and ``clean`` and the disturbances by name: ``siou`` with its bootstrap 95 % interval over shapes,
        ``success`` and, for disturbances, ``siou_difference`` to ``clean`` with its paired interval.

    Raises
    ------
    UsageError
        No shapes, or a variant that is not bundled.
    """
    if not shapes:
        raise UsageError("benchmark.no_targets")
    cases = {"clean": Disturbance(), **DISTURBANCES}
    scores: dict[str, list[list[Score]]] = {name: [] for name in cases}
    total, done = len(shapes) * len(cases) * len(seeds), 0
    for number, shape in enumerate(shapes):
        clean = cases["clean"].seen(shape, np.random.default_rng(0))
        for name, case in cases.items():
            row = []
            for seed in seeds:
                target = case.seen(shape, np.random.default_rng([seed, number]))
                asked = Request(target, grid, k=1, seed=seed, variant=variant, steps=steps, polish=polish)
                disturbed = as_in_paper(asked)
                wanted = replace(disturbed, target=clean, polish=0)
                sheets = [best_of(disturbed).best.sheet] if polish else sample(disturbed)
                row.append(scored(wanted, sheets, 0)[0].score)
                report(done := done + 1, total)
            scores[name].append(row)
    siou = {name: np.array([[score.siou for score in row] for row in rows]) for name, rows in scores.items()}
    settings = {
        "targets": len(shapes),
        "seeds": list(seeds),
        "steps": steps,
        "polish": polish,
        "grid": list(grid),
        "variant": variant,
    }
    return {**settings, **{name: _line(name, scores[name], siou) for name in cases}}


def _line(name: str, scores: list[list[Score]], siou: dict[str, FloatArray]) -> dict[str, object]:
    means = siou[name].mean(axis=1)
    success = [score.siou >= SUCCESS_SIOU and score.feasible for row in scores for score in row]
    line: dict[str, object] = {
        "siou": float(means.mean()),
        "siou_interval": bootstrap_interval(means),
        "success": float(np.mean(success)),
    }
    if name != "clean":
        gap = difference(means, siou["clean"].mean(axis=1))
        line |= {"siou_difference": gap["mean"], "siou_difference_interval": gap["interval"]}
    return line


def _turned(points: FloatArray, angle: float) -> FloatArray:
    """Points (L, 2) turned about the origin, radians, counter-clockwise."""
    return as_points(as_plane(points) * complex(math.cos(angle), math.sin(angle)))
