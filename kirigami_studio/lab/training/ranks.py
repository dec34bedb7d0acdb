"""Processes that train one network together, as torchrun starts them.

Every process (rank) has a copy of the network and draws a share of every batch with a seed of its own; gradients are
averaged by DistributedDataParallel (``learner``), so all copies take the same steps.  Rank 0 validates and writes.
Processes talk by gloo, or by nccl where the network is on a GPU.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TypeVar

import torch
from torch import Tensor, distributed

from kirigami_studio.foundation.errors import UsageError

Value = TypeVar("Value")

#: Seeds of neighbouring ranks lie this far apart, so that ranks of one run are not first ranks of runs of other seeds.
SEED_STEP = 100_003


@dataclass(frozen=True, slots=True)
class Ranks:
    """This process among those of a run.

    Attributes
    ----------
    rank : int
        From 0.
    count : int
        Of processes; 1 without torchrun.
    """

    rank: int = 0
    count: int = 1

    @classmethod
    def present(cls) -> Ranks:
        """Those of the group that is open; this process alone without one."""
        if not distributed.is_initialized():
            return cls()
        return cls(distributed.get_rank(), distributed.get_world_size())

    @property
    def first(self) -> bool:
        """Whether this is the process that validates, prints and writes."""
        return self.rank == 0

    def seed(self, seed: int) -> int:
        """This rank's own seed; that of the run for rank 0."""
        return seed + SEED_STEP * self.rank

    def share(self, batch: int) -> int:
        """Rows of a batch that this rank draws.

        Raises
        ------
        UsageError
            The batch cannot be split evenly: the mean of the ranks' gradients would not be that of the batch.
        """
        if batch % self.count:
            raise UsageError("training.batch_not_shared", batch=batch, processes=self.count)
        return batch // self.count

    def any(self, flag: bool) -> bool:
        """Whether the flag is raised on any rank; all have to ask."""
        return flag if self.count == 1 else max(self._gathered(flag))

    def means(self, values: Mapping[str, float]) -> dict[str, float]:
        """Means of named numbers over the ranks; all have to ask, with the same names."""
        if self.count == 1:
            return dict(values)
        found = self._gathered(dict(values))
        return {name: sum(one[name] for one in found) / self.count for name in values}

    def states(self, generator: torch.Generator) -> list[Tensor]:
        """States of all ranks' noise generators, in order; all have to ask."""
        return [generator.get_state()] if self.count == 1 else self._gathered(generator.get_state())

    def _gathered(self, value: Value) -> list[Value]:
        found: list[Value | None] = [None] * self.count
        distributed.all_gather_object(found, value)
        return [one for one in found if one is not None]


@dataclass(frozen=True, slots=True)
class Process:
    """Where one process trains, and its place among those of the run."""

    device: torch.device
    ranks: Ranks


@contextmanager
def process_group(device: torch.device) -> Iterator[Process]:
    """Open the group of the processes that torchrun started; alone without torchrun."""
    if not distributed.is_torchelastic_launched():
        yield Process(device, Ranks())
        return
    if device.type == "cuda":
        torch.cuda.set_device(device)
    distributed.init_process_group("cpu:gloo,cuda:nccl" if device.type == "cuda" else "gloo")
    try:
        yield Process(device, Ranks.present())
    finally:
        distributed.destroy_process_group()


def own_gpu() -> torch.device:
    """The GPU of this process: the one with its number among those that torchrun started on this machine.

    Raises
    ------
    UsageError
        There are fewer GPUs than processes.
    """
    if not distributed.is_torchelastic_launched():
        return torch.device("cuda")
    number = int(os.environ["LOCAL_RANK"])
    if number >= torch.cuda.device_count():
        raise UsageError("training.too_few_gpus", gpus=torch.cuda.device_count(), number=number)
    return torch.device("cuda", number)


def check_alone() -> None:
    """Refuse what only one process can do.

    Raises
    ------
    UsageError
        torchrun started several.
    """
    if distributed.is_torchelastic_launched() and int(os.environ["WORLD_SIZE"]) > 1:
        raise UsageError("training.one_process_only", processes=int(os.environ["WORLD_SIZE"]))
