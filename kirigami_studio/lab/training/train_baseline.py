"""Train what the paper compares its generator with: cVAE, cGAN and diffusion, on the designs of the prior.

Designs, disturbance of targets, learning rate schedule, average and checkpoints are those of ``train_flow``, so that a
comparison at one number of steps and one batch is one of the generators.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from kirigami_studio.foundation.errors import ModelError
from kirigami_studio.generator.conditioning import square_pose, turned
from kirigami_studio.lab.baselines.conditional import ConditionalGenerator, FieldPixels
from kirigami_studio.lab.baselines.stored import generator_of
from kirigami_studio.lab.training.corpus import Chunk, ChunkBatches, TargetNoise, TrainingDesigns
from kirigami_studio.lab.training.dataset import Split, designs_of, digest_of_designs
from kirigami_studio.lab.training.learner import CHECKPOINT, Checkpoint, Learner, adamw, opened, trained
from kirigami_studio.lab.training.ranks import Ranks
from kirigami_studio.lab.training.recorded import Recorded, own_stream
from kirigami_studio.lab.training.train_flow import LARGEST_GRADIENT, schedule

#: Designs generated together, and how often each is visited before the next.
CHUNK, PASSES = 32_768, 2
#: Masks that are drawn in one batch.
DRAWN_TOGETHER = 256


@dataclass(frozen=True, slots=True)
class BaselineSettings:
    """Settings of one training run.

    Attributes
    ----------
    kind : str
        ``cvae``, ``cgan`` or ``diffusion``.
    network : dict
        Numbers of the network, see ``baselines.stored.generator_of``; missing ones are the paper's.
    steps : int
        Optimiser steps in all; the learning rate falls to zero along a cosine.
    batch : int
        Designs a step, of all processes together (paper: 64).
    learning_rate, weight_decay : float
    first_moment : float
        Decay of Adam's running mean of gradients; the paper's cGAN has 0.5.
    average_decay : float
        Of the exponential moving average that is kept.
    vertex_noise, turn_noise : float
        See :class:`kirigami_studio.lab.training.corpus.TargetNoise`.  Both 0: masks are drawn once, as in the paper.
    chunk : int
        Endless designs generated together.
    family, designs : str
        Of the training designs, see :class:`kirigami_studio.lab.training.train_flow.FlowSettings`.
    seed : int
    """

    kind: str
    network: dict[str, Any] = field(default_factory=dict)
    steps: int = 4_000
    batch: int = 64
    learning_rate: float = 2e-4
    weight_decay: float = 0.0
    first_moment: float = 0.9
    average_decay: float = 0.999
    vertex_noise: float = 0.003
    turn_noise: float = 0.02
    chunk: int = CHUNK
    family: str = "mixed"
    designs: str = ""
    seed: int = 0

    def to_json(self) -> dict[str, Any]:
        return asdict(self)


def train_baseline(
    settings: BaselineSettings,
    folder: Path,
    device: torch.device,
    validate: Callable[[ConditionalGenerator], dict[str, float]],
    *,
    designs: Split | None = None,
    recorded: bool = False,
    seconds: float = math.inf,
    validate_every: int = 500,
) -> Iterator[dict[str, float]]:
    """Train, or go on training, in ``folder``; yields one record per validation, in the first process alone.

    Parameters
    ----------
    settings : BaselineSettings
    folder : Path
        Created if needed; a checkpoint found there is resumed.
    device : torch.device
    validate : callable
        Maps the averaged network to figures for the log.
    designs : Split, optional
        The data set that the settings name.
    recorded : bool
        Whether steps are recorded, see :mod:`kirigami_studio.lab.training.recorded`.
    seconds : float
        Stop with a checkpoint after this wall time even if steps remain.
    validate_every : int
        Steps between validations; each also writes a checkpoint.

    Raises
    ------
    ExportError
        The folder cannot be made or written.
    ModelError
        The checkpoint in ``folder`` belongs to other settings, or the data set does.
    """
    if digest_of_designs(designs) != settings.designs:
        raise ModelError("training.other_start")
    with own_stream(device, recorded):
        run = BaselineRun(settings, opened(folder), device, designs, recorded)
        yield from trained(run, settings.steps, folder, validate, seconds, validate_every)


def trained_baseline(settings: BaselineSettings, folder: Path, device: torch.device) -> ConditionalGenerator:
    """The averaged network of the checkpoint in ``folder``."""
    network = generator_of(settings.kind, settings.network)
    network.load_state_dict(Checkpoint.load(folder / CHECKPOINT).average)
    return network.to(device).eval()


class Masked:
    """Designs with the masks of their silhouettes as they lie, drawn once for each chunk.

    Parameters
    ----------
    corpus : TrainingDesigns
        With polygons.
    pixels : FieldPixels
    """

    def __init__(self, corpus: TrainingDesigns, pixels: FieldPixels) -> None:
        self.seed, self.chunk_size, self.lattice = corpus.seed, corpus.chunk_size, corpus.lattice
        self._corpus, self._pixels = corpus, pixels

    def chunk(self, number: int) -> Chunk:
        """z (C, m * n) and, for polygons, masks (C, 1, latent, latent) of upright targets."""
        found = self._corpus.chunk(number)
        parts = found.polygons.split(DRAWN_TOGETHER)
        return Chunk(found.z, torch.cat([self._pixels.masks(turned(part, -square_pose(part))) for part in parts]))


class BaselineRun:
    """The mutable part of a training run.

    Parameters
    ----------
    settings : BaselineSettings
    path : Path
        Of the checkpoint.
    device : torch.device
    designs : Split, optional
        The data set that the settings name.
    recorded : bool
        Whether steps are recorded, see :mod:`kirigami_studio.lab.training.recorded`.
    """

    def __init__(
        self,
        settings: BaselineSettings,
        path: Path,
        device: torch.device,
        designs: Split | None = None,
        recorded: bool = False,
    ) -> None:
        self.settings, self.path = settings, path
        torch.manual_seed(settings.seed)
        network = generator_of(settings.kind, settings.network).to(device)
        betas = settings.first_moment, 0.999
        optimiser = adamw(network, settings.learning_rate, betas, settings.weight_decay, device, recorded)
        ranks = Ranks.present()
        self.seed = ranks.seed(settings.seed)
        self.generator = torch.Generator(device=device).manual_seed(self.seed)
        self.learner = Learner(network, optimiser, self.generator, device)
        pixels = network.pixels
        corpus = designs_of(settings.family, designs, pixels.rows, pixels.columns, self.seed, settings.chunk, device)
        self.disturbance = TargetNoise(settings.vertex_noise, settings.turn_noise)
        self.still = not (settings.vertex_noise or settings.turn_noise)
        self.designs = ChunkBatches(
            Masked(corpus, pixels) if self.still else corpus, ranks.share(settings.batch), PASSES
        )
        self._descended: Callable[..., tuple[Tensor, ...]] = self._descend
        if recorded:
            self._descended = Recorded(self._descend, self.generator)
        if path.exists():
            self.learner.resume(path, settings.to_json())

    @property
    def step(self) -> int:
        """Finished optimiser steps."""
        return self.learner.step

    def advance(self) -> dict[str, float]:
        """One optimiser step; returns the loss."""
        settings = self.settings
        self.learner.set_rate(settings.learning_rate * schedule(self.step, settings.steps))
        # Dropout draws from torch's own generator: by the step, so that a resumed run draws the same.
        torch.manual_seed(1_000_003 * self.seed + self.step)
        designs = self.designs.at(self.step)
        (loss,) = self._descended(designs.z, designs.polygons)
        # Random weights must not linger in the average.
        self.learner.follow(min(settings.average_decay, (2 + self.step) / (11 + self.step)))
        self.learner.step += 1
        return {"loss": float(loss)}

    def _descend(self, z: Tensor, targets: Tensor) -> tuple[Tensor]:
        """One step on designs z (B, m * n) with silhouettes (B, L, 2) or masks; returns the loss."""
        network = self.learner.network
        masks = targets if self.still else network.pixels.masks(self.disturbance.seen(targets, self.generator))
        loss = self.learner.loss(lambda: network.loss(z, masks, self.generator))
        self.learner.descend(loss, LARGEST_GRADIENT)
        return (loss.detach(),)

    def averaged(self) -> ConditionalGenerator:
        """A copy of the network with the averaged weights."""
        return self.learner.averaged(generator_of(self.settings.kind, self.settings.network))

    def save(self) -> None:
        self.learner.save(self.path, self.settings.to_json())
