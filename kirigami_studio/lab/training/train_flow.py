"""Train the prior: conditional flow matching on z = log10 x with the CFM loss (paper, Eq. 3).

One command for CPU and GPU, resumable: the run folder holds ``checkpoint.pt``, ``log.jsonl`` and, at the end,
``prior.safetensors``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

import torch
from torch import Tensor

from kirigami_studio.foundation.errors import ModelError, UsageError
from kirigami_studio.generator.conditioning import condition
from kirigami_studio.generator.network import NetworkShape
from kirigami_studio.generator.velocity import Network, Shape, joined, network_of
from kirigami_studio.generator.weights import Model
from kirigami_studio.lab.training.corpus import ChunkBatches, TargetNoise, zero_outline
from kirigami_studio.lab.training.dataset import Split, designs_of, digest_of_designs
from kirigami_studio.lab.training.fitted_fields import FittedBatches, FittedFields, Targets
from kirigami_studio.lab.training.flow_path import ConditionalPath, cfm_loss, paired_noise, pairing_cost
from kirigami_studio.lab.training.learner import (
    CHECKPOINT,
    Checkpoint,
    Learner,
    adamw,
    grown_state,
    opened,
    trained,
)
from kirigami_studio.lab.training.ranks import Ranks
from kirigami_studio.lab.training.recorded import Recorded, own_stream

WARM_UP_STEPS = 200
#: Gradients are scaled down to this norm.
LARGEST_GRADIENT = 1.0


@dataclass(frozen=True, slots=True)
class FlowSettings:
    """Settings of one training run.

    Attributes
    ----------
    steps : int
        Optimiser steps in all; the learning rate falls to zero along a cosine.
    batch : int
        Targets a step, of all processes together.
    noises : int
        Noise draws (and times t) for each target: the encoder runs once for all of them.
    learning_rate, weight_decay : float
    average_decay : float
        Of the exponential moving average that is shipped.
    outline_weight : float
        Weight of the squared outline error (unit-area lengths) of the predicted design, through the exact decoder,
        times t^2; on the draw with the largest t of each target.
    coupling : str
        See :mod:`kirigami_studio.lab.training.flow_path`.
    family : str
        Of the endless random designs, see :data:`kirigami_studio.lab.training.fields.SAMPLERS`.
    designs : str
        SHA-256 of the data set that is visited over and over instead of them; empty for none.
    chunk, passes : int
        Endless designs generated together, and how often each is visited before the next chunk.
    vertex_noise : float
        Standard deviation of outline vertices in unit-area lengths (a pixel of 128 is about 0.009).
    turn_noise : float, radians
        Standard deviation of the target's rotation against the sheet.
    shift_noise : float
        Standard deviation of the contour's start, in point spacings.
    warm_start : str
        SHA-256 of the weights that the run begins with; empty for random ones.
    fits : str
        Digest of the fits of drawn shapes that take part; empty for none.
    fit_share : float
        Their share of every batch.
    seed : int
    shape : NetworkShape or UNetShape
        Of the network; its kind says which backbone is trained.
    """

    steps: int = 12_000
    batch: int = 96
    noises: int = 3
    learning_rate: float = 1e-3
    weight_decay: float = 0.01
    average_decay: float = 0.999
    outline_weight: float = 50.0
    coupling: str = "independent"
    family: str = "mixed"
    designs: str = ""
    chunk: int = 32_768
    passes: int = 2
    vertex_noise: float = 0.003
    turn_noise: float = 0.02
    shift_noise: float = 0.3
    warm_start: str = ""
    fits: str = ""
    fit_share: float = 0.3
    seed: int = 0
    shape: Shape = field(default_factory=NetworkShape)

    def to_json(self) -> dict[str, object]:
        return asdict(self)

    def fitted_rows(self, batch: int) -> int:
        """Targets of a step of ``batch`` that are fits of drawn shapes."""
        return round(self.fit_share * batch) if self.fits else 0


@dataclass(frozen=True, slots=True)
class Sources:
    """What a run begins with and draws on beside random fields; the settings hold their digests.

    Attributes
    ----------
    start : Model, optional
        Weights to begin with, raw and averaged alike; the optimiser starts afresh.
    fits : FittedFields, optional
    designs : Split, optional
        A data set in place of random fields.
    """

    start: Model | None = None
    fits: FittedFields | None = None
    designs: Split | None = None

    def check(self, settings: FlowSettings) -> None:
        """Refuse sources that the settings do not name, or that do not fit the network.

        Raises
        ------
        ModelError
        """
        found = (
            self.start.digest if self.start else "",
            self.fits.digest if self.fits else "",
            digest_of_designs(self.designs),
        )
        if found != (settings.warm_start, settings.fits, settings.designs):
            raise ModelError("training.other_start")
        if self.start:
            grown_state(self.start.network, settings.shape)


def train_flow(
    settings: FlowSettings,
    folder: Path,
    device: torch.device,
    validate: Callable[[Network], dict[str, float]],
    *,
    sources: Sources | None = None,
    recorded: bool = False,
    seconds: float = math.inf,
    validate_every: int = 2000,
) -> Iterator[dict[str, float]]:
    """Train, or go on training, in ``folder``; yields one record per validation, in the first process alone.

    Parameters
    ----------
    settings : FlowSettings
    folder : Path
        Created if needed; a checkpoint found there is resumed.
    device : torch.device
    validate : callable
        Maps the averaged network to figures for the log.
    sources : Sources, optional
    recorded : bool
        Whether steps are recorded, see :mod:`kirigami_studio.lab.training.recorded`; not with fits of drawn shapes.
    seconds : float
        Stop with a checkpoint after this wall time even if steps remain.
    validate_every : int
        Steps between validations; each also writes a checkpoint.

    Raises
    ------
    ExportError
        The folder cannot be made or written.
    ModelError
        The checkpoint in ``folder`` belongs to other settings, or the sources do.
    """
    sources = sources or Sources()
    sources.check(settings)
    if recorded and sources.fits:
        raise UsageError("training.fits_not_recorded")
    with own_stream(device, recorded):
        run = FlowRun(settings, opened(folder), device, sources, recorded)
        yield from trained(run, settings.steps, folder, validate, seconds, validate_every)


def trained_network(settings: FlowSettings, folder: Path, device: torch.device) -> Network:
    """The averaged network of the checkpoint in ``folder``: what is shipped."""
    network = network_of(settings.shape)
    network.load_state_dict(Checkpoint.load(folder / CHECKPOINT).average)
    return network.to(device).eval()


class FlowRun:
    """The mutable part of a training run.

    Parameters
    ----------
    settings : FlowSettings
    path : Path
        Of the checkpoint.
    device : torch.device
    sources : Sources
    recorded : bool
        Whether steps are recorded, see :mod:`kirigami_studio.lab.training.recorded`.
    """

    def __init__(
        self, settings: FlowSettings, path: Path, device: torch.device, sources: Sources, recorded: bool = False
    ) -> None:
        self.settings, self.path, self.device = settings, path, device
        torch.manual_seed(settings.seed)
        self.network = network_of(settings.shape).to(device)
        if sources.start:
            self.network.load_state_dict(grown_state(sources.start.network, settings.shape))
        optimiser = adamw(self.network, settings.learning_rate, (0.9, 0.99), settings.weight_decay, device, recorded)
        ranks = Ranks.present()
        self.seed, batch = ranks.seed(settings.seed), ranks.share(settings.batch)
        self.generator = torch.Generator(device=device).manual_seed(self.seed)
        shape = settings.shape
        # Layers of the corrections have no part in flow matching.
        some_idle = isinstance(shape, NetworkShape) and shape.direction
        self.learner = Learner(self.network, optimiser, self.generator, device, some_idle)
        self.corpus = designs_of(
            settings.family, sources.designs, shape.rows, shape.columns, self.seed, settings.chunk, device
        )
        self.fitted_rows = settings.fitted_rows(batch)
        self.random = ChunkBatches(self.corpus, batch - self.fitted_rows, settings.passes)
        self.fitted = FittedBatches(sources.fits, self.corpus.lattice, self.seed) if sources.fits else None
        self._described: Callable[..., tuple[Tensor, ...]] = self._describe
        self._descended: Callable[..., tuple[Tensor, ...]] = self._descend
        if recorded:
            self._described = Recorded(self._describe, self.generator)
            self._descended = Recorded(self._descend, self.generator)
        if path.exists():
            self.learner.resume(path, settings.to_json())

    @property
    def step(self) -> int:
        """Finished optimiser steps."""
        return self.learner.step

    def advance(self) -> dict[str, float]:
        """One optimiser step; returns the loss."""
        self.learner.set_rate(self.settings.learning_rate * schedule(self.step, self.settings.steps))
        # Dropout draws from torch's own generator: by the step, so that a resumed run draws the same.
        torch.manual_seed(1_000_003 * self.seed + self.step)
        targets = [self._random_targets(), *self._fitted_targets()]
        fields = [part.z for part in targets]
        noise, times, *described = self._described(*fields, *(part.polygons for part in targets))
        if self.settings.coupling != "independent":
            cost, *described = described
            noise = paired_noise(noise, cost)
        (loss,) = self._descended(noise, times, *fields, *described)
        decay = self.settings.average_decay
        if not self.settings.warm_start:
            # Random weights must not linger in the average.
            decay = min(decay, (2 + self.step) / (11 + self.step))
        self.learner.follow(decay)
        self.learner.step += 1
        return {"loss": float(loss)}

    def averaged(self) -> Network:
        """A copy of the network with the averaged weights."""
        return self.learner.averaged(network_of(self.settings.shape))

    def save(self) -> None:
        self.learner.save(self.path, self.settings.to_json())

    def _fitted_targets(self) -> tuple[Targets, ...]:
        if self.fitted is None:
            return ()
        return self.fitted.targets(self.step, self.fitted_rows)

    def _random_targets(self) -> Targets:
        chunk = self.random.at(self.step)
        return Targets(chunk.z, chunk.polygons, on_sheet=False)

    def _describe(self, *parts: Tensor) -> tuple[Tensor, ...]:
        """All that a step draws.

        Parameters
        ----------
        parts : (B_i, m * n) tensors, then as many (B_i, L_i, 2) tensors
            Fields and their silhouettes: random designs, and fits where they take part.

        Returns
        -------
        noise : (B * noises, m * n) tensor
        times : (B * noises,) tensor
        cost : (B * noises, B * noises) tensor
            Of pairing designs with noise; only of couplings that pair.
        seen : (B_i, L_i, 2) tensors
            Silhouettes as they will arrive.
        shifts : (B_i,) tensors
            How far their contours' starts are moved.
        """
        settings, draws, count = self.settings, self.settings.noises, len(parts) // 2
        seen = [self._as_seen(polygons, index > 0) for index, polygons in enumerate(parts[count:])]
        target = torch.cat(parts[:count]).repeat_interleave(draws, dim=0)
        noise = self._normal(target.shape) * settings.shape.z_scale
        costs = []
        if settings.coupling != "independent":
            layout = settings.shape.condition_layout
            described = torch.cat([condition(polygons, layout, shift) for polygons, shift in seen])
            costs = [pairing_cost(settings.coupling, noise, target, described.repeat_interleave(draws, dim=0))]
        times = torch.rand(target.shape[0], generator=self.generator, device=self.device)
        return noise, times, *costs, *(polygons for polygons, _ in seen), *(shift for _, shift in seen)

    def _descend(self, noise: Tensor, times: Tensor, *parts: Tensor) -> tuple[Tensor]:
        """One step on fields, seen silhouettes and shifts of all parts; returns the loss."""
        count = len(parts) // 3
        fields, seen, shifts = parts[:count], parts[count : 2 * count], parts[2 * count :]
        loss = self.learner.loss(lambda: self._loss(noise, times, torch.cat(fields), seen, shifts))
        self.learner.descend(loss, LARGEST_GRADIENT)
        return (loss.detach(),)

    def _loss(self, noise: Tensor, t: Tensor, z: Tensor, seen: Sequence[Tensor], shifts: Sequence[Tensor]) -> Tensor:
        settings, draws = self.settings, self.settings.noises
        codes = [self.network.code(polygons, shift) for polygons, shift in zip(seen, shifts, strict=True)]
        code = joined(codes).repeated(draws)
        path = ConditionalPath.sample(noise, z.repeat_interleave(draws, dim=0), t)
        velocity = self.network(path.x_t, t, code)
        flow = cfm_loss(velocity, path)
        if not settings.outline_weight:
            return flow
        late = t.view(-1, draws).argmax(dim=1) + torch.arange(len(z), device=self.device) * draws
        predicted = ConditionalPath.predicted_data(path.x_t[late], velocity[late], t[late])
        return flow + settings.outline_weight * (t[late].square() * self._outline_error(predicted, z)).mean()

    def _outline_error(self, predicted: Tensor, z: Tensor) -> Tensor:
        """Mean squared distance of corresponding outline vertices at phi = 0, per design, unit-area lengths squared."""
        lattice = self.corpus.lattice
        both = torch.cat([predicted.clamp(-1.5, 1.5), z]).view(-1, lattice.rows, lattice.columns)
        outline = zero_outline(lattice, both)
        outline = outline - outline.mean(dim=1, keepdim=True)
        ours, theirs = outline.split(len(z))
        sheet_area = (lattice.rows + 1) * (lattice.columns + 1)
        return (ours - theirs).square().sum(dim=-1).mean(dim=1) / sheet_area

    def _as_seen(self, polygons: Tensor, on_sheet: bool) -> tuple[Tensor, Tensor]:
        """Targets as they will arrive, a little turned and rasterised, and a shift of where their contour starts."""
        settings = self.settings
        disturbance = TargetNoise(settings.vertex_noise, settings.turn_noise)
        moved = disturbance.seen(polygons, self.generator, upright=not on_sheet)
        return moved, settings.shift_noise * self._normal(polygons.shape[:1])

    def _normal(self, shape: torch.Size) -> Tensor:
        return torch.randn(shape, generator=self.generator, device=self.device)


def schedule(step: int, steps: int) -> float:
    """Learning rate factor: linear warm-up, then a cosine to zero."""
    if step < WARM_UP_STEPS:
        return (step + 1) / WARM_UP_STEPS
    progress = (step - WARM_UP_STEPS) / max(1, steps - WARM_UP_STEPS)
    return 0.5 * (1 + math.cos(math.pi * min(1.0, progress)))
