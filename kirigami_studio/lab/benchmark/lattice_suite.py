"""How fast the exact geometry is: the slider, growing grids, and whole batches beside the marching reference."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import torch

from kirigami_studio.generator.sampler import one_torch_thread
from kirigami_studio.lab.baselines.marching import march
from kirigami_studio.lattice.batched import BatchedLattice
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField

GROWTH_SIZES = (10, 14, 20, 28, 38, 48)


@dataclass(frozen=True, slots=True)
class SliderTiming:
    """Dragging phi over one decoded design.

    Attributes
    ----------
    grid : (rows, columns)
    decode_ms : float
        The one solve before the drag begins.
    layouts_per_second : float
        Nodes, panels and outline at a new angle.
    """

    grid: tuple[int, int]
    decode_ms: float
    layouts_per_second: float


@dataclass(frozen=True, slots=True)
class GrowthTiming:
    """Decode, deploy and outline on square grids of growing size.

    Attributes
    ----------
    sizes : tuple of int
    milliseconds : tuple of float
        Median processor time of one design.
    exponent : float
        Slope of log time over log(m n).
    """

    sizes: tuple[int, ...]
    milliseconds: tuple[float, ...]
    exponent: float


@dataclass(frozen=True, slots=True)
class BatchTiming:
    """Decode, deploy and outline of one batch on one core, beside the marching reference.

    Attributes
    ----------
    grid : (rows, columns)
    batch : int
    designs_per_second : float
    marching_per_second : float
        The reference rebuilds the corners from seeds that it is given for nothing.
    ratio : float
        Of the two rates.
    """

    grid: tuple[int, int]
    batch: int
    designs_per_second: float
    marching_per_second: float
    ratio: float


def time_slider(size: int = 24, frames: int = 120) -> SliderTiming:
    """Time what one slider step computes, at ``frames`` different angles of one random size x size design."""
    field = _random_field(size)
    decode = _fastest(lambda: deploy(field), repeats=5)
    design = deploy(field)
    angles = np.linspace(0.0, math.pi, frames)

    def drag() -> None:
        for phi in angles:
            design.panels(float(phi))
            design.outline(float(phi))

    seconds = _fastest(drag, repeats=5)
    return SliderTiming((size, size), 1e3 * decode, frames / seconds)


def time_growth(sizes: tuple[int, ...] = GROWTH_SIZES, repeats: int = 9) -> GrowthTiming:
    """Time whole designs on growing grids and fit how the cost grows with the number of voids.

    Processor time, because a shared machine would otherwise put its other work into the slope.
    """
    medians = []
    for size in sizes:
        fields = [_random_field(size, seed) for seed in range(repeats)]
        deploy(fields[0]).outline(0.0)  # build the tables of this grid
        medians.append(statistics.median(_processor_time(field) for field in fields))
    slope, _ = np.polyfit(2 * np.log(sizes), np.log(medians), 1)
    return GrowthTiming(sizes, tuple(1e3 * value for value in medians), float(slope))


def time_batch(size: int = 10, batch: int = 256, repeats: int = 5) -> BatchTiming:
    """Time a batch of size x size designs in torch on one thread, and single ones by marching (Eq. 2)."""
    z = np.random.default_rng(0).uniform(-1, 1, (batch, size, size))
    with one_torch_thread(), torch.inference_mode():
        lattice = BatchedLattice(size, size)
        ratios = torch.tensor(10.0**z, dtype=torch.float32)
        seconds = _fastest(lambda: lattice.outline(ratios, 0.0), repeats)
    fields = [RatioField.from_log10(entry) for entry in z[:8]]
    seeds = [deploy(field).voids(0.0) for field in fields]

    def reference() -> None:
        for field, corners in zip(fields, seeds, strict=True):
            march(field, corners[:, 0, 0], corners[0, :, 3], 0.0)

    rate = batch / seconds
    marching = len(fields) / _fastest(reference, repeats)
    return BatchTiming((size, size), batch, rate, marching, rate / marching)


@dataclass(frozen=True, slots=True)
class LatticeTiming:
    """All timings of this suite."""

    slider: SliderTiming
    growth: GrowthTiming
    batch: BatchTiming

    def sentences(self) -> Iterator[str]:
        """The figures for the user, one a line."""
        slider, growth, batch = self.slider, self.growth, self.batch
        yield (
            f"slider   {slider.grid[0]} x {slider.grid[1]}: decode once {slider.decode_ms:.1f} ms, "
            f"then {slider.layouts_per_second:.0f} layouts/s"
        )
        for size, cost in zip(growth.sizes, growth.milliseconds, strict=True):
            yield f"growth   {size} x {size}: {cost:.2f} ms a design"
        yield f"growth   cost ~ (m n)^{growth.exponent:.2f}"
        yield (
            f"batch    {batch.batch} designs of {batch.grid[0]} x {batch.grid[1]}, one core: "
            f"{batch.designs_per_second:.0f} designs/s, {batch.ratio:.0f} times the marching reference "
            f"({batch.marching_per_second:.0f}/s)"
        )


def measure_lattice() -> LatticeTiming:
    """Run the whole suite: a few seconds."""
    return LatticeTiming(time_slider(), time_growth(), time_batch())


def _random_field(size: int, seed: int = 0) -> RatioField:
    return RatioField.from_log10(np.random.default_rng(seed).uniform(-1, 1, (size, size)))


def _fastest(work: Callable[[], object], repeats: int) -> float:
    """Shortest processor time of several runs, seconds: the run that other programs disturbed least."""
    work()
    durations = []
    for _ in range(repeats):
        start = time.process_time()
        work()
        durations.append(time.process_time() - start)
    return min(durations)


def _processor_time(field: RatioField) -> float:
    start = time.process_time()
    deploy(field).outline(0.0)
    return time.process_time() - start
