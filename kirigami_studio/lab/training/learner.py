"""What every training run has in common: weights and their average, optimiser, noise, checkpoint, folder and log."""

from __future__ import annotations

import io
import json
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

import torch
from torch import Tensor, nn
from torch.nn.parallel import DistributedDataParallel

from kirigami_studio.foundation.errors import ExportError, ModelError, UsageError
from kirigami_studio.foundation.files import read_at_most, write_atomically
from kirigami_studio.generator.network import NetworkShape
from kirigami_studio.generator.velocity import Network, Shape, network_of
from kirigami_studio.lab.training.ranks import Ranks, own_gpu


@dataclass(slots=True)
class Checkpoint:
    """Everything a run needs to go on exactly where it stopped.

    Attributes
    ----------
    step : int
        Finished optimiser steps.
    network, average : dict of tensors
        Raw weights and their exponential moving average.
    optimiser : dict
    settings : dict
        The run's settings, compared on resume.
    generator : tensor
        State of the noise generator.
    others : list of tensor
        States of those of further processes, by rank from 1.
    more : dict
        What one kind of training needs beside: plain numbers and text.
    """

    step: int
    network: dict[str, torch.Tensor]
    average: dict[str, torch.Tensor]
    optimiser: dict[str, Any]
    settings: dict[str, Any]
    generator: torch.Tensor
    more: dict[str, Any] = field(default_factory=dict)
    others: list[torch.Tensor] = field(default_factory=list)

    def save(self, path: Path) -> None:
        """Write beside the old checkpoint, then rename: an interrupted save loses nothing.

        Raises
        ------
        ExportError
            The folder cannot be written or the disk is full; the old checkpoint is untouched.
        """
        buffer = io.BytesIO()
        torch.save({name: getattr(self, name) for name in self.__slots__}, buffer)
        write_atomically(path, buffer.getvalue())

    @classmethod
    def load(cls, path: Path) -> Checkpoint:
        """Read a checkpoint (weights-only unpickling: no code is run).

        Raises
        ------
        ModelError
            The file is damaged or not a checkpoint.
        """
        try:
            file = io.BytesIO(read_at_most(path, LARGEST_CHECKPOINT))
            content = torch.load(file, map_location="cpu", weights_only=True)
            return cls(**content)
        except Exception as error:  # torch raises many kinds on a damaged file
            raise ModelError("training.checkpoint_unreadable", path=path) from error

    def check_settings(self, wanted: dict[str, Any], path: Path) -> None:
        """Refuse to go on with other settings than those the checkpoint at ``path`` was made with.

        Raises
        ------
        ModelError
            Names the settings that differ.
        """
        if self.settings != wanted:
            names = ", ".join(name for name in wanted if self.settings.get(name) != wanted[name])
            raise ModelError("training.checkpoint_differs", path=path, settings=names)


#: Name of the resumable state in a run folder.
CHECKPOINT = "checkpoint.pt"
#: Largest checkpoint that is read (bytes).
LARGEST_CHECKPOINT = 8 * 2**30

Learning = TypeVar("Learning", bound=nn.Module)
Trained = TypeVar("Trained", covariant=True)


class _Loss(nn.Module):
    """A loss as the forward pass of a module: what DistributedDataParallel asks for.

    Losses call several methods of their networks, and those of a game between two networks both of them; as one pass of
    a module that holds all weights they are all seen.
    """

    def __init__(self, network: nn.Module) -> None:
        super().__init__()
        self.network = network

    def forward(self, compute: Callable[[], Tensor]) -> Tensor:
        return compute()


class Learner(Generic[Learning]):
    """A network in training, by this process or by all that torchrun started.

    Parameters
    ----------
    network : Module
        On the device that trains it.
    optimiser : torch.optim.Optimizer
        Of its parameters.
    generator : torch.Generator
        Of the run's noise.
    device : torch.device
    some_idle : bool
        Whether some weights may have no part in a loss.
    """

    def __init__(
        self,
        network: Learning,
        optimiser: torch.optim.Optimizer,
        generator: torch.Generator,
        device: torch.device,
        some_idle: bool = False,
    ) -> None:
        self.network, self.optimiser, self.generator, self.device = network, optimiser, generator, device
        self.some_idle = some_idle
        self.average = {name: value.detach().clone() for name, value in network.state_dict().items()}
        self.step = 0
        self.ranks = Ranks.present()
        self._parallel: DistributedDataParallel | None = None
        self._pairs: tuple[list[Tensor], list[Tensor]] | None = None

    def loss(self, compute: Callable[[], Tensor]) -> Tensor:
        """The loss of this process's share of a batch; :meth:`descend` averages over all shares."""
        if self.ranks.count == 1:
            return compute()
        if self._parallel is None:
            # Weights that a loss leaves out keep no gradient, as they do in one process; looking for them takes time.
            self._parallel = DistributedDataParallel(_Loss(self.network), find_unused_parameters=self.some_idle)
        loss: Tensor = self._parallel(compute)
        return loss

    def learn(self, loss: Tensor, decay: float, largest_gradient: float | None = None) -> None:
        """One step down ``loss``, its gradient bounded if asked for; the average keeps ``decay`` of itself."""
        self.descend(loss, largest_gradient)
        self.follow(decay)

    def descend(self, loss: Tensor, largest_gradient: float | None = None) -> None:
        """One step down ``loss``, its gradient bounded if asked for."""
        self.optimiser.zero_grad(set_to_none=True)
        loss.backward()
        if largest_gradient is not None:
            torch.nn.utils.clip_grad_norm_(self.network.parameters(), largest_gradient)
        self.optimiser.step()

    def follow(self, decay: float) -> None:
        """Move the average of weights towards the present ones; it keeps ``decay`` of itself."""
        with torch.no_grad():
            if self._pairs is None:
                values = self.network.state_dict()
                self._pairs = [self.average[name] for name in values], list(values.values())
            torch._foreach_lerp_(*self._pairs, 1.0 - decay)

    def set_rate(self, learning_rate: float) -> None:
        """Set the learning rate of the next step, in place for a recorded step on the GPU."""
        for group in self.optimiser.param_groups:
            if isinstance(group["lr"], Tensor):
                group["lr"].fill_(learning_rate)
            else:
                group["lr"] = learning_rate

    def averaged(self, network: Learning) -> Learning:
        """``network``, a fresh one of the same shape, with the averaged weights, ready to sample."""
        network.to(self.device).load_state_dict(self.average)
        return network.eval()

    def save(self, path: Path, settings: dict[str, Any], more: dict[str, float] | None = None) -> None:
        """Write a checkpoint, ``more`` numbers with it; all processes have to call this, the first one writes."""
        own, *others = self.ranks.states(self.generator)
        if not self.ranks.first:
            return
        Checkpoint(
            self.step,
            self.network.state_dict(),
            self.average,
            self.optimiser.state_dict(),
            settings,
            own,
            more or {},
            others,
        ).save(path)

    def resume(self, path: Path, settings: dict[str, Any]) -> dict[str, float]:
        """Go on where a checkpoint of the same settings stopped; returns the numbers stored with it.

        A process that was not there draws noise of its own from the step on.

        Raises
        ------
        ModelError
            The checkpoint is damaged or belongs to other settings.
        """
        state = Checkpoint.load(path)
        state.check_settings(settings, path)
        self.network.load_state_dict(state.network)
        self.average = {name: value.to(self.device) for name, value in state.average.items()}
        # How steps are taken belongs to the present device, not to the one that wrote the checkpoint.
        for group, stored in zip(self.optimiser.param_groups, state.optimiser["param_groups"], strict=True):
            stored |= {name: group[name] for name in ("lr", "fused", "foreach", "capturable")}
        self.optimiser.load_state_dict(state.optimiser)
        self._pairs = None
        states = [state.generator, *state.others]
        if self.ranks.rank < len(states):
            self.generator.set_state(states[self.ranks.rank])
        else:
            self.generator.manual_seed(self.generator.initial_seed() + 1_000_003 * state.step)
        self.step = state.step
        return state.more


def adamw(
    network: nn.Module,
    learning_rate: float,
    betas: tuple[float, float],
    weight_decay: float,
    device: torch.device,
    recorded: bool,
) -> torch.optim.AdamW:
    """The optimiser of flows and baselines, one kernel for all weights."""
    rate = torch.tensor(learning_rate, device=device) if recorded else learning_rate
    return torch.optim.AdamW(
        network.parameters(), lr=rate, betas=betas, weight_decay=weight_decay, fused=True, capturable=recorded
    )


def opened(folder: Path) -> Path:
    """Make a run folder; returns where its checkpoint lies.

    Raises
    ------
    ExportError
        The folder cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ExportError("training.folder_not_made", folder=folder, reason=error.strerror) from error
    return folder / CHECKPOINT


def logged(folder: Path, record: dict[str, float]) -> dict[str, float]:
    """Add a record to the folder's log; returns it."""
    with (folder / "log.jsonl").open("a", encoding="utf-8") as log:
        log.write(json.dumps(record) + "\n")
    return record


class Run(Protocol[Trained]):
    """What a training loop asks of a run."""

    @property
    def step(self) -> int:
        """Finished optimiser steps."""
        ...

    def advance(self) -> dict[str, float]:
        """One optimiser step; returns the loss, and parts of it."""
        ...

    def averaged(self) -> Trained:
        """A copy of the network with the averaged weights."""
        ...

    def save(self) -> None:
        """Write a checkpoint."""
        ...


#: Part of the running means of losses that each step renews.
RENEWED = 0.02


def trained(
    run: Run[Trained],
    steps: int,
    folder: Path,
    validate: Callable[[Trained], dict[str, float]],
    seconds: float,
    validate_every: int,
) -> Iterator[dict[str, float]]:
    """Advance a run to its last step; yields one record per validation, and writes each with a checkpoint.

    Of several processes the first one validates, writes and yields.

    Parameters
    ----------
    run : Run
    steps : int
        Optimiser steps in all.
    folder : Path
        Of the log.
    validate : callable
        Maps the averaged network to figures for the log.
    seconds : float
        Stop with a checkpoint after this wall time even if steps remain.
    validate_every : int
        Steps between validations.

    Yields
    ------
    record : dict
        ``step``, ``seconds``, running means of what ``advance`` returns, and the figures of ``validate``.
    """
    began = time.perf_counter()
    running: dict[str, float] = {}
    ranks = Ranks.present()
    while run.step < steps:
        for name, value in run.advance().items():
            running[name] = running.get(name, value) + RENEWED * (value - running.get(name, value))
        out_of_time = math.isfinite(seconds) and ranks.any(time.perf_counter() - began > seconds)
        if run.step % validate_every == 0 or run.step == steps or out_of_time:
            run.save()
            record = {"step": float(run.step), "seconds": time.perf_counter() - began} | ranks.means(running)
            if ranks.first:
                yield logged(folder, record | validate(run.averaged()))
        if out_of_time:
            break


def training_device(name: str, threads: int = 1) -> torch.device:
    """Resolve ``auto``, ``cpu`` or ``cuda``, and give torch that many processor threads.

    Raises
    ------
    UsageError
        The device does not exist on this machine, GPUs are fewer than processes, or fewer than one thread was asked
        for.
    """
    if threads < 1:
        raise UsageError("training.no_threads", threads=threads)
    torch.set_num_threads(threads)
    if name == "auto":
        return own_gpu() if torch.cuda.is_available() else torch.device("cpu")
    if name == "cuda" and not torch.cuda.is_available():
        raise UsageError("training.no_cuda")
    if name == "cuda":
        return own_gpu()
    try:
        return torch.device(name)
    except RuntimeError as error:
        raise UsageError("training.unknown_device", device=name) from error


def grown_state(network: Network, shape: Shape) -> dict[str, Tensor]:
    """Weights of ``network`` for a network of ``shape``: what is new counts for nothing at first.

    Raises
    ------
    ModelError
        The shapes differ in more than their inputs, or the new one sees less.
    """
    state = dict(network.state_dict())
    if network.shape == shape:
        return state
    if not isinstance(shape, NetworkShape) or not _sees_more(network.shape, shape):
        raise ModelError("training.other_network")
    grown = network_of(shape).state_dict()
    for name, value in grown.items():
        old = state.get(name)
        if old is None:
            state[name] = torch.zeros_like(value)
        elif old.shape != value.shape:
            state[name] = torch.cat([old, old.new_zeros(len(old), value.shape[1] - old.shape[1])], dim=1)
    return {name: state[name] for name in grown}


def _sees_more(old: Shape, new: NetworkShape) -> bool:
    if not isinstance(old, NetworkShape):
        return False
    senses = {"direction": new.direction, "preference": new.preference, "sheets": new.sheets, "rims": new.rims}
    lost = any(getattr(old, name) and not value for name, value in senses.items())
    return replace(old, **senses) == new and not lost
