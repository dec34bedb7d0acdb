"""``train`` and ``dataset``: the room beside the app, loaded only when asked for."""

from __future__ import annotations

import argparse
from pathlib import Path

from kirigami_studio.cli.console import ProgressLine, print_json, say
from kirigami_studio.cli.inputs import parse_grid
from kirigami_studio.foundation.errors import UsageError


def dataset(arguments: argparse.Namespace) -> int:
    """Generate, verify and write the splits of one family."""
    from kirigami_studio.training.dataset import SPLITS, generate_split, verify

    grid = parse_grid(arguments.grid)
    line = ProgressLine()
    files: dict[str, str] = {}
    for name, (size, offset) in SPLITS.items():
        if arguments.split not in ("all", name):
            continue
        count = size if arguments.count is None else arguments.count
        split = generate_split(
            arguments.family,
            count,
            arguments.seed * len(SPLITS) + offset,
            grid,
            lambda done, name=name, count=count: line.show(f"{name}: {done} of {count}"),  # type: ignore[misc]
        )
        worst = verify(split)
        path = Path(arguments.out) / f"{arguments.family}-{name}.npz"
        split.save(path)
        line.clear()
        files[name] = str(path)
        if not arguments.json:
            say(f"{path}: {count} designs, re-rendered IoU >= {worst:.4f}, discarded {split.about['discarded']}")
    if arguments.json:
        print_json({"files": files})
    return 0


def train(arguments: argparse.Namespace) -> int:
    """Train the prior, or go on training it, and write its weights into the run folder."""
    from kirigami_studio.generator.network import NetworkShape
    from kirigami_studio.generator.weights import store_model
    from kirigami_studio.training.device import training_device
    from kirigami_studio.training.train_flow import FlowSettings, finished_network, train_flow
    from kirigami_studio.training.validation import validator

    if arguments.minutes is not None and arguments.minutes <= 0:
        raise UsageError(f"--minutes must be above 0, got {arguments.minutes:g}.")
    device = training_device(arguments.device, arguments.threads)
    settings = FlowSettings(
        steps=arguments.steps,
        batch=arguments.batch,
        coupling=arguments.coupling,
        outline_weight=arguments.outline_weight,
        seed=arguments.seed,
        shape=NetworkShape() if arguments.feedback else NetworkShape(loop_points=0),
    )
    folder = Path(arguments.out)
    seconds = float("inf") if arguments.minutes is None else 60.0 * arguments.minutes
    record: dict[str, float] = {}
    for record in train_flow(
        settings, folder, device, validator(200, device), seconds=seconds, validate_every=arguments.validate_every
    ):
        if not arguments.json:
            say(" ".join(f"{key} {value:.4f}" for key, value in record.items()))
    path = store_model("prior", finished_network(settings, folder, device), folder, {"validation": record})
    if arguments.json:
        print_json({"files": [str(path)], "record": record})
    else:
        say(f"Weights: {path}")
    return 0
