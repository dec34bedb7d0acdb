"""Alignment by backpropagation through the sampler and the exact decoder, anchored to the prior.

The network is unrolled over the steps that the studio takes; the loss is measured on what comes out (the idea of
DRaFT, arXiv 2309.17400), so no reward has to be guessed from ranks.  One network learns the whole trade between match
and regularity: the preference is an input, drawn anew for every row.  ``grpo`` holds the paper's rule.

A share of the steps may distil runs: their rows are first designs (:mod:`kirigami_studio.lab.training.first_designs`)
in the place of targets alone.  Beside the same loss these steps have that of the flow, which leads from noise to the
design, and the distance of what the sampler ends at from it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from kirigami_studio.foundation.errors import ModelError
from kirigami_studio.foundation.paper import LOG_RATIO_LIMIT
from kirigami_studio.generator.conditioning import normalised
from kirigami_studio.generator.deployed_grid import DeployedGrid
from kirigami_studio.generator.flow import integrate, trail
from kirigami_studio.generator.network import NetworkShape, VelocityNetwork
from kirigami_studio.generator.weights import Model
from kirigami_studio.lab.training.corpus import deployed_outline
from kirigami_studio.lab.training.fields import mixed_fields
from kirigami_studio.lab.training.first_designs import DesignBatches, FirstDesigns
from kirigami_studio.lab.training.flow_path import ConditionalPath, cfm_loss
from kirigami_studio.lab.training.learner import CHECKPOINT, Checkpoint, Learner, grown_state, opened, trained
from kirigami_studio.lab.training.preference_loss import EARLY_WEIGHT, PreferenceTerms, trail_gap
from kirigami_studio.lab.training.ranks import Ranks
from kirigami_studio.lab.training.sampled_targets import SampledTargets, TargetSource
from kirigami_studio.lab.training.train_flow import LARGEST_GRADIENT, schedule
from kirigami_studio.lattice.batched import BatchedLattice
from kirigami_studio.lattice.symmetry import Symmetry

#: The weights of preference and sheet begin at zero and have few inputs: they learn this much faster than the others.
NEW_LAYERS, NEW_PACE = ("prefer", "lie"), 30.0
#: Least and most voids each way of other sheets, the share of them at phi = 0, and the largest angle of the others.
GRIDS, FLAT_SHARE, LARGEST_PHI = (6, 16), 0.6, 2 * math.pi / 3
#: Parts of the loss that records have.
NOTED = ("match", "variation", "unevenness")
#: Sheets among which the rows of a step that distils are divided.
SHEETS = 4
#: What is bundled of an aligned network: names and preferences, chosen on validation figures.
VARIANTS = {"accuracy": 0.0, "balanced": 0.35, "regularity": 0.9}


@dataclass(frozen=True, slots=True)
class AlignSettings:
    """Settings of one alignment run.

    Attributes
    ----------
    prior : str
        SHA-256 of the weights it stays near to, and begins with unless ``begin`` names others.
    begin : str
        SHA-256 of aligned weights to go on from; empty for none.
    steps : int
        Optimiser steps.
    batch : int
        Targets a step of all processes together, one sample each.
    drawn : int
        Drawn shapes among the targets, beside silhouettes of random fields.
    drawn_share : float
        Their share of every batch.
    sampling_steps : int
        Euler steps of the unrolled sampler.
    learning_rate, average_decay : float
    variation_weight : float
        Cost of the paper's TV(x) / (m n) at preference 1, in units of area; proportional below.
    evenness_weight : float
        The same of the coefficient of variation of panel areas.
    anchor_weight : float
        Cost of the mean squared distance of z to the prior's sample.
    anchored_every : int
        The prior is sampled too for one row in this many.
    vertex_noise : float
        Largest standard deviation of the target's contour as the network sees it, unit-area lengths (a pixel of 128 is
        about 0.009); drawn anew for every row.  The loss looks at the undisturbed target.
    pictured_share : float
        Share of the targets that the network sees as read from a picture instead, see ``sampled_targets``.
    shift_noise : float
        Standard deviation of the contour's start, in point spacings.
    other_sheets : float
        Share of the steps that draw on another sheet than the network's own.
    free_rims : float
        Share of the steps that draw on sheets whose rim is free; a network with ``rims`` is told so.
    symmetric_share : float
        Share of the steps that draw within a symmetry of the grid, where it has any.
    designs : str
        Digest of the first designs that take part; empty for none.
    design_share : float
        Share of the steps that are theirs.
    flow_weight, likeness_weight : float
        In these steps: of the flow matching loss (paper, Eq. 3), and of the mean squared distance of samples from the
        designs, both in squared log10 of the ratios.
    turn_noise : float, radians
        Standard deviation of the rotation of their targets against the sheet.
    seed : int
    shape : NetworkShape
    """

    prior: str
    begin: str = ""
    steps: int = 3000
    batch: int = 48
    drawn: int = 1000
    drawn_share: float = 0.35
    sampling_steps: int = 4
    learning_rate: float = 2e-4
    average_decay: float = 0.998
    variation_weight: float = 0.015
    evenness_weight: float = 0.0
    anchor_weight: float = 0.5
    anchored_every: int = 2
    vertex_noise: float = 0.01
    pictured_share: float = 0.5
    shift_noise: float = 0.3
    other_sheets: float = 0.5
    free_rims: float = 0.0
    symmetric_share: float = 0.0
    designs: str = ""
    design_share: float = 0.6
    flow_weight: float = 0.2
    likeness_weight: float = 0.3
    turn_noise: float = 0.03
    seed: int = 0
    shape: NetworkShape = field(default_factory=lambda: NetworkShape(direction=True, preference=True, sheets=True))

    def to_json(self) -> dict[str, object]:
        return asdict(self)


def train_aligned(
    settings: AlignSettings,
    folder: Path,
    device: torch.device,
    validate: Callable[[VelocityNetwork], dict[str, float]],
    prior: Model,
    begin: Model | None = None,
    designs: FirstDesigns | None = None,
    *,
    seconds: float = math.inf,
    validate_every: int = 500,
) -> Iterator[dict[str, float]]:
    """Align, or go on aligning, in ``folder``; yields one record per validation, in the first process alone.

    Parameters
    ----------
    settings : AlignSettings
    folder : Path
        Created if needed; a checkpoint found there is resumed.
    device : torch.device
    validate : callable
        Maps the averaged network to figures for the log.
    prior : Model
    begin : Model, optional
        Aligned weights to go on from.
    designs : FirstDesigns, optional
        What is distilled.
    seconds : float
        Stop with a checkpoint after this wall time even if steps remain.
    validate_every : int

    Raises
    ------
    ExportError
        The folder cannot be made or written.
    ModelError
        The checkpoint belongs to other settings, or prior, weights or designs are not those that the settings name.
    """
    found = prior.digest, begin.digest if begin else "", designs.digest if designs else ""
    if found != (settings.prior, settings.begin, settings.designs):
        raise ModelError("training.other_start")
    run = AlignRun(settings, opened(folder), device, prior, begin, designs)
    yield from trained(run, settings.steps, folder, validate, seconds, validate_every)


def aligned_network(settings: AlignSettings, folder: Path, device: torch.device) -> VelocityNetwork:
    """The averaged network of the checkpoint in ``folder``: what is shipped."""
    network = VelocityNetwork(settings.shape)
    network.load_state_dict(Checkpoint.load(folder / CHECKPOINT).average)
    return network.to(device).eval()


class AlignRun:
    """The mutable part of an alignment run.

    Parameters
    ----------
    settings : AlignSettings
    path : Path
        Of the checkpoint.
    device : torch.device
    prior : Model
    begin : Model, optional
        Aligned weights to go on from.
    designs : FirstDesigns, optional
        What is distilled.
    """

    def __init__(
        self,
        settings: AlignSettings,
        path: Path,
        device: torch.device,
        prior: Model,
        begin: Model | None = None,
        designs: FirstDesigns | None = None,
    ) -> None:
        self.settings, self.path, self.device = settings, path, device
        self.prior = prior.network.to(device)
        self.network = VelocityNetwork(settings.shape).to(device)
        self.network.load_state_dict(grown_state((begin or prior).network, settings.shape))
        new = [value for name, value in self.network.named_parameters() if name.startswith(NEW_LAYERS)]
        old = [value for name, value in self.network.named_parameters() if not name.startswith(NEW_LAYERS)]
        optimiser = torch.optim.AdamW(
            [{"params": old, "pace": 1.0}, {"params": new, "pace": NEW_PACE}], betas=(0.9, 0.99), weight_decay=0.0
        )
        ranks = Ranks.present()
        self.seed, self.batch = ranks.seed(settings.seed), ranks.share(settings.batch)
        self.generator = torch.Generator(device=device).manual_seed(self.seed)
        self.learner = Learner(self.network, optimiser, self.generator, device, some_idle=True)
        self._lattices: dict[tuple[int, int], BatchedLattice] = {}
        self.source = TargetSource(
            settings.drawn,
            settings.seed,
            settings.vertex_noise,
            settings.shift_noise,
            settings.pictured_share,
            self.generator,
            device,
        )
        self.designs = DesignBatches(designs, self.seed, device) if designs else None
        if path.exists():
            self.learner.resume(path, settings.to_json())

    @property
    def step(self) -> int:
        """Finished optimiser steps."""
        return self.learner.step

    def advance(self) -> dict[str, float]:
        """One optimiser step; returns the parts of its loss."""
        settings = self.settings
        for group in self.learner.optimiser.param_groups:
            group["lr"] = group["pace"] * settings.learning_rate * schedule(self.step, settings.steps)
        parts: dict[str, float] = {}
        chosen = np.random.default_rng((settings.seed, 2, self.step)).random() < settings.design_share
        compute = self._distilled if self.designs is not None and chosen else self._anchored
        loss = self.learner.loss(compute(parts))
        self.learner.learn(loss, settings.average_decay, LARGEST_GRADIENT)
        self.learner.step += 1
        return {"loss": float(loss.detach()), **parts}

    def _anchored(self, parts: dict[str, float]) -> Callable[[], Tensor]:
        """Loss of samples for targets alone, held near those of the prior; notes its ``parts``."""
        settings, grid = self.settings, self._grid()
        drawn = round(settings.drawn_share * self.batch) if settings.drawn else 0
        targets = self.source.targets(self._silhouettes(grid, self.batch - drawn), drawn, grid.symmetry)
        preference = self._preferences(self.batch)
        noise = self._noise(self.batch)

        def compute() -> Tensor:
            code = targets.code(self.network, grid, preference)
            designs = trail(self.network, noise, code, settings.sampling_steps)
            anchored = slice(0, None, settings.anchored_every)
            with torch.no_grad():
                code = targets.code(self.prior, grid, preference).picked(anchored)
                reference = integrate(self.prior, noise[anchored], code, settings.sampling_steps)
                reference = reference[:, : grid.cells].clamp(-LOG_RATIO_LIMIT, LOG_RATIO_LIMIT)
            anchor = (designs[-1][anchored, : grid.cells] - reference).square().mean()
            parts["anchor"] = float(anchor.detach())
            measured = self._measured(grid, designs, targets, parts)
            return self._loss(*measured, preference) + settings.anchor_weight * anchor

        return compute

    def _distilled(self, parts: dict[str, float]) -> Callable[[], Tensor]:
        """Loss of samples for the targets of first designs; notes its ``parts``."""
        settings = self.settings
        assert self.designs is not None
        sheets = self.designs.rows(self.step, self.batch, min(SHEETS, self.batch))
        drawn = [
            (
                rows,
                self.source.lying(rows.polygons, settings.turn_noise),
                self._preferences(len(rows.z)),
                self._noise(2 * len(rows.z)).chunk(2),
                torch.rand(len(rows.z), generator=self.generator, device=self.device),
            )
            for rows in sheets
        ]

        def compute() -> Tensor:
            losses = []
            for rows, targets, preference, (noise, start), times in drawn:
                code = targets.code(self.network, rows.grid, preference)
                transfer = code.transfer
                path = ConditionalPath.sample(transfer.state(start), transfer.state_of(rows.z), times)
                flow = cfm_loss(self.network(path.x_t, times, code), path)
                designs = trail(self.network, noise, code, settings.sampling_steps)
                likeness = (designs[-1][:, : rows.grid.cells] - rows.z).square().mean()
                parts.update(flow=float(flow.detach()), likeness=float(likeness.detach()))
                loss = self._loss(*self._measured(rows.grid, designs, targets, {}), preference)
                losses.append(loss + settings.flow_weight * flow + settings.likeness_weight * likeness)
            return torch.stack(losses).mean()

        return compute

    def averaged(self) -> VelocityNetwork:
        """A copy of the network with the averaged weights."""
        return self.learner.averaged(VelocityNetwork(self.settings.shape))

    def save(self) -> None:
        """Write the checkpoint."""
        self.learner.save(self.path, self.settings.to_json())

    def _measured(
        self, grid: DeployedGrid, designs: list[Tensor], targets: SampledTargets, parts: dict[str, float]
    ) -> tuple[PreferenceTerms, Tensor]:
        """Terms of the last design of a sampler, and the gap of those before it; notes ``parts``."""
        terms, early = trail_gap(self._lattice(grid), grid, designs, targets.loop)
        parts.update({name: float(getattr(terms, name).mean().detach()) for name in NOTED})
        return terms, early

    def _loss(self, terms: PreferenceTerms, early: Tensor, preference: Tensor) -> Tensor:
        settings = self.settings
        calm = settings.variation_weight * terms.variation + settings.evenness_weight * terms.unevenness
        return (terms.match + preference * calm + terms.excess).mean() + EARLY_WEIGHT * early

    def _noise(self, rows: int) -> Tensor:
        """Where the flow starts: (rows, own cells)."""
        shape = self.settings.shape
        noise = torch.randn((rows, shape.rows * shape.columns), generator=self.generator, device=self.device)
        return noise * shape.z_scale

    def _grid(self) -> DeployedGrid:
        """The grid, angle and rim of this step: the network's own grid, or any of 6 to 16 voids each way and any useful
        angle.
        """
        settings, shape = self.settings, self.settings.shape
        rng = np.random.default_rng((settings.seed, self.step))
        rows, columns, phi = shape.rows, shape.columns, 0.0
        if rng.random() < settings.other_sheets:
            rows, columns = (int(count) for count in rng.integers(GRIDS[0], GRIDS[1] + 1, size=2))
            phi = 0.0 if rng.random() < FLAT_SHARE else float(rng.uniform(0.0, LARGEST_PHI))
        free, kept = bool(rng.random() < settings.free_rims), bool(rng.random() < settings.symmetric_share)
        found = [symmetry for symmetry in Symmetry if symmetry.fits(rows, columns)] if kept else []
        symmetry = found[int(rng.integers(len(found)))] if found else None
        return DeployedGrid(rows, columns, phi, symmetry, free)

    def _lattice(self, grid: DeployedGrid) -> BatchedLattice:
        counts = grid.rows, grid.columns
        if counts not in self._lattices:
            self._lattices[counts] = BatchedLattice(*counts, self.device)
        return self._lattices[counts]

    def _silhouettes(self, grid: DeployedGrid, count: int) -> Tensor:
        """What random fields of a sheet show: (B, L, 2), unit area about the centroid."""
        rng = np.random.default_rng((self.seed, 1, self.step))
        drawn = mixed_fields(count, grid.rows, grid.columns, rng)
        if grid.symmetry is not None:
            drawn = grid.symmetry.symmetric(drawn)
        fields = torch.tensor(drawn, dtype=torch.float32)
        with torch.no_grad():
            return normalised(deployed_outline(self._lattice(grid), grid, fields.to(self.device)))

    def _preferences(self, rows: int) -> Tensor:
        """0 for two in five rows, 1 for three in ten, anything between for the others."""
        kind = torch.rand(rows, generator=self.generator, device=self.device)
        between = torch.rand(rows, generator=self.generator, device=self.device)
        return torch.where(kind < 0.4, 0.0 * kind, torch.where(kind < 0.7, torch.ones_like(kind), between))
