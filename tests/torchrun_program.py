"""What a test has torchrun start in two processes: the gradient of a batch in halves, and short training runs."""

from __future__ import annotations

import copy
import json
import sys
from functools import partial
from pathlib import Path
from unittest import mock

import torch
from torch import Tensor

from kirigami_studio import cli
from kirigami_studio.generator.network import NetworkShape
from kirigami_studio.generator.velocity import network_of
from kirigami_studio.lab.cli import learning
from kirigami_studio.lab.training import train_baseline, train_flow
from kirigami_studio.lab.training.learner import Learner
from kirigami_studio.lab.training.ranks import Process, process_group
from kirigami_studio.lab.training.train_baseline import BaselineSettings
from kirigami_studio.lab.training.train_flow import FlowSettings
from kirigami_studio.lab.training.validation import validator

CPU = torch.device("cpu")
SETTINGS = FlowSettings(
    steps=60, batch=32, noises=2, chunk=128, shape=NetworkShape(4, 4, 32, 64, 2, 16, 24, 32, 48), learning_rate=6e-3
)
#: The learning rate takes 200 steps to rise by default.
WARM_UP_STEPS = 4


def train(folder: Path, seconds: float = float("inf")) -> list[dict[str, float]]:
    """Train in a folder, with a validation every twenty steps."""
    watched = validator(60, CPU)
    with mock.patch.object(train_flow, "WARM_UP_STEPS", WARM_UP_STEPS):  # other tests of this process have their own
        return list(train_flow.train_flow(SETTINGS, folder, CPU, watched, seconds=seconds, validate_every=20))


def largest_difference(process: Process, rows: int) -> float:
    """Between the gradients of a batch by all processes and by one, as a share of the largest."""
    torch.manual_seed(1)
    network = network_of(SETTINGS.shape)
    for value in network.parameters():
        torch.nn.init.normal_(value, std=0.1)
    alone = copy.deepcopy(network)
    angle = 2 * torch.pi * torch.arange(40) / 40
    ring = torch.stack([angle.cos(), angle.sin()], dim=1) * torch.rand((rows, 40, 1)).add(1.0)
    z, wanted, t = torch.randn(rows, 16), torch.randn(rows, 16), torch.rand(rows)

    def loss(of: torch.nn.Module, some: slice) -> Tensor:
        return (of(z[some], t[some], of.code(ring[some])) - wanted[some]).square().mean()

    loss(alone, slice(None)).backward()
    learner = Learner(network, torch.optim.SGD(network.parameters(), lr=0.0), torch.Generator(), CPU, some_idle=True)
    own = process.ranks.share(rows)
    part = slice(process.ranks.rank * own, (process.ranks.rank + 1) * own)
    learner.learn(learner.loss(lambda: loss(network, part)), 0.9)
    pairs = [
        (one.grad, other.grad)
        for one, other in zip(network.parameters(), alone.parameters(), strict=True)
        if other.grad is not None
    ]
    largest = max(float(other.abs().max()) for _, other in pairs)
    return max(float((one - other).abs().max()) for one, other in pairs) / largest


def train_by_command(folder: Path) -> None:
    """The command, on few designs and targets."""
    train_baseline.BaselineSettings = partial(BaselineSettings, chunk=64)  # type: ignore[misc, assignment]
    learning.VALIDATION_COUNT = 4
    words = ["train", "cgan", "--channels", "4,8", "--latent", "8", "--batch", "8", "--steps", "2", "--device", "cpu"]
    if cli.main([*words, "--json", "--out", str(folder)]):
        raise SystemExit(1)


def main(folder: Path) -> None:
    with process_group(CPU) as process:
        difference = largest_difference(process, 16)
        records = train(folder / "whole")
        stopped = train(folder / "parts", 0.0)
        train(folder / "parts")
        train(folder / "begun by one")
        train(folder / "begun by two", 0.0)
        said = {"difference": difference, "records": records, "stopped": stopped}
        (folder / f"rank-{process.ranks.rank}.json").write_text(json.dumps(said))


if __name__ == "__main__":
    # A second group in one process would meet the first one's addresses in the store, and wait for them for ever.
    {"library": main, "command": train_by_command}[sys.argv[1]](Path(sys.argv[2]))
