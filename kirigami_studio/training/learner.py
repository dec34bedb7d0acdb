"""What every training run has in common: weights and their average, optimiser, noise, checkpoint, folder and log."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Generic, TypeVar

import torch
from torch import Tensor, nn

from kirigami_studio.foundation.errors import ExportError
from kirigami_studio.training.checkpoint import Checkpoint

#: Name of the resumable state in a run folder.
CHECKPOINT = "checkpoint.pt"

Learning = TypeVar("Learning", bound=nn.Module)


class Learner(Generic[Learning]):
    """A network in training.

    Parameters
    ----------
    network : Module
        On the device that trains it.
    optimiser : torch.optim.Optimizer
        Of its parameters.
    generator : torch.Generator
        Of the run's noise.
    device : torch.device
    """

    def __init__(
        self,
        network: Learning,
        optimiser: torch.optim.Optimizer,
        generator: torch.Generator,
        device: torch.device,
    ) -> None:
        self.network, self.optimiser, self.generator, self.device = network, optimiser, generator, device
        self.average = {name: value.detach().clone() for name, value in network.state_dict().items()}
        self.step = 0

    def learn(self, loss: Tensor, decay: float, largest_gradient: float | None = None) -> None:
        """One step down ``loss``, its gradient bounded if asked for; the average keeps ``decay`` of itself."""
        self.optimiser.zero_grad(set_to_none=True)
        loss.backward()
        if largest_gradient is not None:
            torch.nn.utils.clip_grad_norm_(self.network.parameters(), largest_gradient)
        self.optimiser.step()
        with torch.no_grad():
            names, values = zip(*self.network.state_dict().items(), strict=True)
            torch._foreach_lerp_([self.average[name] for name in names], list(values), 1.0 - decay)

    def averaged(self, network: Learning) -> Learning:
        """``network``, a fresh one of the same shape, with the averaged weights, ready to sample."""
        network.to(self.device).load_state_dict(self.average)
        return network.eval()

    def save(self, path: Path, settings: dict[str, Any], more: dict[str, float] | None = None) -> None:
        """Write a checkpoint, ``more`` numbers with it."""
        Checkpoint(
            self.step,
            self.network.state_dict(),
            self.average,
            self.optimiser.state_dict(),
            settings,
            self.generator.get_state(),
            more or {},
        ).save(path)

    def resume(self, path: Path, settings: dict[str, Any]) -> dict[str, float]:
        """Go on where a checkpoint of the same settings stopped; returns the numbers stored with it.

        Raises
        ------
        ModelError
            The checkpoint is damaged or belongs to other settings.
        """
        state = Checkpoint.load(path)
        state.check_settings(settings, path)
        self.network.load_state_dict(state.network)
        self.average = {name: value.to(self.device) for name, value in state.average.items()}
        self.optimiser.load_state_dict(state.optimiser)
        self.generator.set_state(state.generator)
        self.step = state.step
        return state.more


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
        raise ExportError(f"Cannot make the run folder {folder}: {error.strerror}. Choose another folder.") from error
    return folder / CHECKPOINT


def logged(folder: Path, record: dict[str, float]) -> dict[str, float]:
    """Add a record to the folder's log; returns it."""
    with (folder / "log.jsonl").open("a", encoding="utf-8") as log:
        log.write(json.dumps(record) + "\n")
    return record
