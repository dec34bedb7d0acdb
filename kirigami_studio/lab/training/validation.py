"""Quick figures of a network during training: exact polygon IoU in the target's own pose, no search, no polish."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import shapely
import torch
from torch import Tensor

from kirigami_studio.evaluate.total_variation import total_variation
from kirigami_studio.foundation.arrays import FloatArray
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.generator.conditioning import normalised, square_pose, turned
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.generator.flow import integrate
from kirigami_studio.generator.velocity import Network, Velocity
from kirigami_studio.lab.baselines.conditional import ConditionalGenerator
from kirigami_studio.lab.training.corpus import outline_of_nodes, zero_outline
from kirigami_studio.lab.training.fields import released_fields, sobol_fields, structured_fields
from kirigami_studio.lab.training.preference_loss import area_variation
from kirigami_studio.lab.training.preference_loss import total_variation as batched_variation
from kirigami_studio.lab.training.sampled_targets import drawn_polygons
from kirigami_studio.lattice.batched import BatchedLattice
from kirigami_studio.lattice.ratio_field import RatioField

#: Seed of the fields that training watches; the test splits of ``dataset`` use others.
VALIDATION_SEED = 20_001


#: One field for each target: polygons as a network sees them, (B, L, 2) -> z (B, m * n).
Draw = Callable[[Tensor], Tensor]


def own_pose_iou(draw: Draw, z: Tensor, lattice: BatchedLattice) -> FloatArray:
    """IoU of one sample for each target made by fields z (B, m, n), compared as they stand: (B,).

    A lower bound of sIoU, cheap enough to watch during training.
    """
    with torch.no_grad():
        targets = normalised(zero_outline(lattice, z))
        return _ious(_sampled(draw, turned(targets, -square_pose(targets)), lattice), targets)


def upright_iou(draw: Draw, targets: Tensor, lattice: BatchedLattice) -> FloatArray:
    """IoU of one sample for each of the outlines (B, L, 2), compared as the network sees them, stood upright: (B,)."""
    with torch.no_grad():
        seen = normalised(targets)
        seen = turned(seen, -square_pose(seen))
        return _ious(_sampled(draw, seen, lattice), seen)


def flow_draw(network: Velocity, steps: int, seed: int) -> Draw:
    """Samples of a flow in Euler steps."""

    def draw(seen: Tensor) -> Tensor:
        generator = torch.Generator().manual_seed(seed)
        cells = network.shape.rows * network.shape.columns
        noise = torch.randn((len(seen), cells), generator=generator) * network.shape.z_scale
        return integrate(network, noise.to(seen.device), network.code(seen), steps)

    return draw


def baseline_draw(network: ConditionalGenerator, steps: int, seed: int) -> Draw:
    """Samples of a generator that the paper compares with its own."""

    def draw(seen: Tensor) -> Tensor:
        return network.draw(network.pixels.masks(seen), torch.Generator(device=seen.device).manual_seed(seed), steps)

    return draw


def _sampled(draw: Draw, seen: Tensor, lattice: BatchedLattice) -> Tensor:
    """Outlines of one sample for each target as seen."""
    z = draw(seen).clamp(-LOG_RATIO_LIMIT, LOG_RATIO_LIMIT)
    return normalised(zero_outline(lattice, z.view(-1, lattice.rows, lattice.columns)))


def _ious(results: Tensor, targets: Tensor) -> FloatArray:
    ours = shapely.make_valid(shapely.polygons(results.cpu().double().numpy()))
    theirs = shapely.make_valid(shapely.polygons(targets.cpu().double().numpy()))
    common = shapely.area(shapely.intersection(ours, theirs))
    return np.asarray(common / (shapely.area(ours) + shapely.area(theirs) - common))


def match_figures(draw: Draw, count: int, lattice: BatchedLattice) -> dict[str, float]:
    """Mean IoU of one sample on ``count`` validation targets of each family and on as many drawn shapes."""
    rows, columns, device = lattice.rows, lattice.columns, lattice.device
    families = {
        "structured": structured_fields(count, rows, columns, np.random.default_rng(VALIDATION_SEED)),
        "released": released_fields(count, rows, columns, np.random.default_rng(VALIDATION_SEED)),
        "sobol": sobol_fields(count, rows, columns, VALIDATION_SEED),
    }
    figures: dict[str, float] = {}
    for name, fields in families.items():
        z = torch.tensor(fields, dtype=torch.float32, device=device)
        figures[f"{name}_iou"] = float(own_pose_iou(draw, z, lattice).mean())
    figures["drawn_iou"] = float(upright_iou(draw, drawn_polygons(count, VALIDATION_SEED).to(device), lattice).mean())
    return figures


def validator(count: int, device: torch.device, steps: int = 4) -> Callable[[Network], dict[str, float]]:
    """Make the function that training of a flow calls: mean IoU on ``count`` targets of each family."""

    def measure(network: Network) -> dict[str, float]:
        lattice = BatchedLattice(network.shape.rows, network.shape.columns, device)
        return match_figures(flow_draw(network, steps, seed=0), count, lattice)

    return measure


def baseline_validator(
    count: int, device: torch.device, steps: int | None = None
) -> Callable[[ConditionalGenerator], dict[str, float]]:
    """The same for a baseline, in its usual number of steps unless told."""

    def measure(network: ConditionalGenerator) -> dict[str, float]:
        lattice = BatchedLattice(network.pixels.rows, network.pixels.columns, device)
        return match_figures(baseline_draw(network, steps or network.usual_steps, seed=0), count, lattice)

    return measure


def group_figures(network: Network, count: int, steps: int, samples: int = 16) -> dict[str, float]:
    """How ``samples`` designs of one target in one pose differ, on ``count`` structured validation targets.

    Returns
    -------
    figures : dict
        ``spread``: standard deviation of z among the designs of a target, mean over cells and targets; ``tv``: mean of
        the paper's total variation divided by m n.
    """
    rows, columns = network.shape.rows, network.shape.columns
    device = next(network.parameters()).device
    lattice = BatchedLattice(rows, columns, device)
    fields = structured_fields(count, rows, columns, np.random.default_rng(VALIDATION_SEED))
    with torch.no_grad():
        targets = normalised(zero_outline(lattice, torch.tensor(fields, dtype=torch.float32, device=device)))
        code = network.code(turned(targets, -square_pose(targets))).repeated(samples)
        generator = torch.Generator().manual_seed(0)
        noise = torch.randn((count * samples, rows * columns), generator=generator) * network.shape.z_scale
        sampled = integrate(network, noise.to(device), code, steps).clamp(-LOG_RATIO_LIMIT, LOG_RATIO_LIMIT)
    designs = sampled.cpu().double().view(count, samples, rows, columns)
    variation = [total_variation(RatioField.from_log10(z)) for z in designs.flatten(0, 1).numpy()]
    return {"spread": float(designs.std(dim=1).mean()), "tv": float(np.mean(variation))}


def preference_figures(
    network: Network, count: int, preferences: Sequence[float], steps: int, samples: int = 4
) -> dict[str, float]:
    """Match, total variation and spread at several preferences, on ``count`` validation targets of each family.

    Returns
    -------
    figures : dict
        For each family and preference p ``FAMILY_iou_p``, mean IoU as the network sees the target, upright;
        ``FAMILY_tv_p``, the paper's TV / (m n); ``FAMILY_cv_p``, coefficient of variation of panel areas;
        ``FAMILY_spread_p``, standard deviation of z among the samples.
    """
    rows, columns = network.shape.rows, network.shape.columns
    device = next(network.parameters()).device
    lattice = BatchedLattice(rows, columns, device)
    fields = {
        "structured": structured_fields(count, rows, columns, np.random.default_rng(VALIDATION_SEED)),
        "sobol": sobol_fields(count, rows, columns, VALIDATION_SEED),
    }
    figures: dict[str, float] = {}
    with torch.no_grad():
        targets = {name: zero_outline(lattice, torch.tensor(z, dtype=torch.float32)) for name, z in fields.items()}
        targets["drawn"] = drawn_polygons(count, VALIDATION_SEED)
        noise = torch.randn((count * samples, rows * columns), generator=torch.Generator().manual_seed(0))
        noise = (noise * network.shape.z_scale).to(device)
        for family, outlines in targets.items():
            seen = normalised(outlines.to(device))
            seen = turned(seen, -square_pose(seen))
            for preference in preferences:
                asked = torch.full((count,), preference, device=device)
                code = network.code(seen, preference=asked).repeated(samples)
                z = integrate(network, noise, code, steps).clamp(-LOG_RATIO_LIMIT, LOG_RATIO_LIMIT)
                ratio = torch.pow(10.0, z.view(-1, rows, columns))
                nodes = lattice.compact(ratio)
                made = normalised(outline_of_nodes(lattice, DeployedGrid(rows, columns), nodes))
                variation = batched_variation(ratio)
                figures[f"{family}_iou_{preference:g}"] = float(
                    _ious(made, seen.repeat_interleave(samples, dim=0)).mean()
                )
                figures[f"{family}_tv_{preference:g}"] = float(variation.mean())
                figures[f"{family}_cv_{preference:g}"] = float(area_variation(lattice, nodes).mean())
                spread = z.view(count, samples, -1).std(dim=1).mean()
                figures[f"{family}_spread_{preference:g}"] = float(spread)
    return figures
