"""``train align`` and ``train grpo``: from a trained prior to what people prefer."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from kirigami_studio.cli.console import print_json, say
from kirigami_studio.foundation.errors import UsageError

if TYPE_CHECKING:
    from kirigami_studio.generator.backbones import Network
    from kirigami_studio.generator.weights import Model

#: Validation targets of each family, and of the figures on groups of samples.
VALIDATION_COUNT = 200
GROUP_COUNT = 50


def grpo(arguments: argparse.Namespace) -> int:
    """Align a generator, or go on aligning it, and write its weights into the run folder."""
    from kirigami_studio.generator.weights import store_model
    from kirigami_studio.training.device import training_device
    from kirigami_studio.training.grpo import GrpoSettings, aligned_network, train_grpo
    from kirigami_studio.training.validation import group_figures, validator

    seconds = seconds_allowed(arguments)
    device = training_device(arguments.device, arguments.threads)
    start = starting_model(arguments.start)
    settings = GrpoSettings(
        reward=arguments.reward,
        start=start.digest,
        calls=arguments.calls,
        group=arguments.group,
        batch=arguments.batch,
        temperature=arguments.temperature,
        learning_rate=arguments.learning_rate,
        rollout_steps=arguments.rollout_steps,
        advantages=arguments.advantages,
        weight_clip=arguments.weight_clip,
        reference=arguments.reference,
        least_spread=arguments.least_spread,
        average_decay=arguments.average_decay,
        seed=arguments.seed,
    )
    watched = validator(VALIDATION_COUNT, device, settings.rollout_steps)

    def validate(network: Network) -> dict[str, float]:
        among = group_figures(network, GROUP_COUNT, settings.rollout_steps)
        return watched(network) | {f"structured_{name}": value for name, value in among.items()}

    folder = Path(arguments.out)
    record: dict[str, float] = {}
    for record in train_grpo(
        settings, folder, device, validate, start, seconds=seconds, validate_every=arguments.validate_every
    ):
        if not arguments.json:
            say(" ".join(f"{key} {value:.4f}" for key, value in record.items()))
    about = {"validation": record, "settings": settings.to_json(), "start": start.variant}
    path = store_model(f"grpo-{settings.reward}", aligned_network(folder, start), folder, about)
    if arguments.json:
        print_json({"files": [str(path)], "record": record})
    else:
        say(f"Weights: {path}")
    return 0


def align(arguments: argparse.Namespace) -> int:
    """Align a prior through the sampler, or go on aligning it, and write the variants into the run folder."""
    from kirigami_studio.generator.weights import store_variants
    from kirigami_studio.training.device import training_device
    from kirigami_studio.training.train_aligned import VARIANTS, AlignSettings, aligned_network, train_aligned
    from kirigami_studio.training.validation import preference_figures

    seconds = seconds_allowed(arguments)
    for name in ("other_sheets", "pictured"):
        if (share := getattr(arguments, name)) > 1.0:
            raise UsageError(f"--{name.replace('_', '-')} is a share from 0 to 1, got {share:g}.")
    device = training_device(arguments.device, arguments.threads)
    prior = starting_model(arguments.start)
    begin = None if arguments.go_on is None else starting_model(arguments.go_on, "accuracy")
    settings = AlignSettings(
        prior=prior.digest,
        begin="" if begin is None else begin.digest,
        steps=arguments.steps,
        batch=arguments.batch,
        drawn=arguments.drawn,
        learning_rate=arguments.learning_rate,
        variation_weight=arguments.variation_weight,
        anchor_weight=arguments.anchor_weight,
        other_sheets=arguments.other_sheets,
        pictured_share=arguments.pictured,
        seed=arguments.seed,
    )
    folder = Path(arguments.out)

    def validate(network: Network) -> dict[str, float]:
        return preference_figures(network, VALIDATION_COUNT, tuple(VARIANTS.values()), settings.sampling_steps)

    record: dict[str, float] = {}
    for record in train_aligned(
        settings, folder, device, validate, prior, begin, seconds=seconds, validate_every=arguments.validate_every
    ):
        if not arguments.json:
            say(" ".join(f"{key} {value:.4f}" for key, value in record.items()))
    network = aligned_network(settings, folder, device)
    record = record or validate(network)
    about = {"validation": record, "settings": settings.to_json()}
    path = store_variants("aligned", VARIANTS, network, folder, about)
    if arguments.json:
        print_json({"files": [str(path)], "record": record})
    else:
        say(f"Weights: {path}")
    return 0


def seconds_allowed(arguments: argparse.Namespace) -> float:
    """Wall time of a run by ``--minutes``; infinite without."""
    if arguments.minutes is None:
        return float("inf")
    if arguments.minutes <= 0:
        raise UsageError(f"--minutes must be above 0, got {arguments.minutes:g}.")
    return 60.0 * float(arguments.minutes)


def starting_model(name: str, bundled: str = "prior") -> Model:
    """The weights that a run begins with: ``bundled`` ones, or a .safetensors file beside its manifest."""
    from kirigami_studio.generator.weights import load_model, load_weights

    if name == "bundled":
        return load_model(bundled)
    return load_weights(Path(name))
