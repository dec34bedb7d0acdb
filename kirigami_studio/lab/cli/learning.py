"""``train`` and ``dataset``; training is loaded only when one of them is called."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from kirigami_studio.cli.console import ProgressLine, print_json, say
from kirigami_studio.cli.option_types import parse_grid, workers
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.settings.design import USUAL_GRID

if TYPE_CHECKING:
    from kirigami_studio.generator.velocity import Network, Shape
    from kirigami_studio.generator.weights import Model
    from kirigami_studio.lab.baselines.conditional import ConditionalGenerator
    from kirigami_studio.lab.training.dataset import Split
    from kirigami_studio.lab.training.ranks import Process
    from kirigami_studio.lab.training.train_flow import Sources

#: Fits of drawn shapes by default: about 3800 shapes, each fitted twice, of which nine in ten come near enough.
DRAWN_COUNT = 7_000
#: Shapes whose first designs are made by default.
DESIGNED_COUNT = 4_000
#: Validation targets of each family, and of the figures on groups of samples.
VALIDATION_COUNT = 200
GROUP_COUNT = 50


def dataset(arguments: argparse.Namespace) -> int:
    """Generate, verify and write the splits of one family, or add to the fits of drawn shapes."""
    from kirigami_studio.lab.training.dataset import SPLITS, Split, generate_split, verify

    grid = parse_grid(arguments.grid)
    if arguments.family in ("drawn", "first-designs"):
        if arguments.split not in ("all", "train"):
            raise UsageError("training.fits_are_not_split")
        if arguments.family == "drawn":
            return _drawn(arguments, grid)
        if grid != USUAL_GRID:
            raise UsageError("training.grids_are_chosen")
        return _first_designs(arguments)
    line = ProgressLine()
    files: dict[str, str] = {}
    about: dict[str, dict[str, object]] = {}
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
            workers(arguments),
        )
        path = Path(arguments.out) / f"{arguments.family}-{name}.npz"
        split.save(path)
        # What the file says counts, not what was meant to be written.
        written = Split.load(path)
        worst = verify(written)
        line.clear()
        files[name] = str(path)
        about[name] = {**written.about, "designs": len(written.ratios), "rendered_again_iou": worst}
        if not arguments.json:
            discarded = written.about["discarded"] or "none"
            say(f"{path}: {count} designs, re-rendered IoU >= {worst:.4f}, discarded {discarded}")
            say(f"  content SHA-256 {written.about['sha256']}")
    if arguments.json:
        print_json({"files": files, "splits": about})
    return 0


def _drawn(arguments: argparse.Namespace, grid: tuple[int, int]) -> int:
    """Fit drawn shapes until the archive holds as many as asked for."""
    from kirigami_studio.lab.training.fitted_fields import FittedFields, fit_shapes

    count = DRAWN_COUNT if arguments.count is None else arguments.count
    path = Path(arguments.out) / "drawn.npz"
    line = ProgressLine()
    for done in fit_shapes(path, count, arguments.seed, grid, workers=workers(arguments)):
        line.show(f"drawn: {done} of {count}")
    line.clear()
    fits = FittedFields.load(path)
    if arguments.json:
        print_json({"files": {"train": str(path)}, "fits": len(fits.z), "mean_iou": float(fits.iou.mean())})
    else:
        say(f"{path}: {len(fits.z)} fits of drawn shapes, mean exact IoU {fits.iou.mean():.4f}")
    return 0


def _first_designs(arguments: argparse.Namespace) -> int:
    """Design drawn shapes until the archive holds the first designs of as many as asked for."""
    from kirigami_studio.lab.training.first_designs import FirstDesigns, design_shapes

    count = DESIGNED_COUNT if arguments.count is None else arguments.count
    path = Path(arguments.out) / "first-designs.npz"
    line = ProgressLine()
    for done in design_shapes(path, count, arguments.seed, workers=workers(arguments)):
        line.show(f"first-designs: {done} of {count} shapes")
    line.clear()
    made = FirstDesigns.load(path)
    first = made.behind == 0.0
    if not first.any():
        raise UsageError("training.no_fits")
    found = {"mean_iou": float(made.iou[first].mean()), "mean_panel_area_cv": float(made.area_cv[first].mean())}
    if arguments.json:
        print_json({"files": {"train": str(path)}, "shapes": int(first.sum()), "designs": len(made.z), **found})
    else:
        text = "{0}: {1} designs of {2} shapes; first ones: mean exact IoU {mean_iou:.4f}, CV {mean_panel_area_cv:.3f}"
        say(text.format(path, len(made.z), int(first.sum()), **found))
    return 0


def _in_group(arguments: argparse.Namespace, work: Callable[[Process], None]) -> int:
    """Train on the device that is asked for, together with the other processes where torchrun started several."""
    from kirigami_studio.lab.training.learner import training_device
    from kirigami_studio.lab.training.ranks import process_group

    with process_group(training_device(arguments.device, arguments.threads)) as process:
        work(process)
    return 0


def _last_told(records: Iterator[dict[str, float]], arguments: argparse.Namespace) -> dict[str, float]:
    """Train to the end, print every record unless JSON is wanted, and return the last one."""
    record: dict[str, float] = {}
    for record in records:
        if not arguments.json:
            say(" ".join(f"{key} {value:.4f}" for key, value in record.items()))
    return record


def train(arguments: argparse.Namespace) -> int:
    """Train the prior, or go on training it, and write its weights into the run folder."""
    return _in_group(arguments, partial(_train, arguments))


def _train(arguments: argparse.Namespace, process: Process) -> None:
    from kirigami_studio.lab.trained_weights import store_model
    from kirigami_studio.lab.training.dataset import digest_of_designs
    from kirigami_studio.lab.training.train_flow import FlowSettings, train_flow, trained_network
    from kirigami_studio.lab.training.validation import validator

    seconds = seconds_allowed(arguments)
    shape = _shape(arguments)
    sources = _sources(arguments)
    settings = FlowSettings(
        steps=arguments.steps,
        noises=arguments.noises,
        learning_rate=arguments.learning_rate,
        weight_decay=arguments.weight_decay,
        warm_start=sources.start.digest if sources.start else "",
        fits=sources.fits.digest if sources.fits else "",
        fit_share=arguments.fit_share,
        batch=arguments.batch,
        coupling=arguments.coupling,
        outline_weight=arguments.outline_weight,
        average_decay=arguments.average_decay,
        family=_family(arguments, sources.designs),
        designs=digest_of_designs(sources.designs),
        seed=arguments.seed,
        shape=shape,
    )
    folder = Path(arguments.out)
    records = train_flow(
        settings,
        folder,
        process.device,
        validator(VALIDATION_COUNT, process.device),
        sources=sources,
        recorded=arguments.recorded,
        seconds=seconds,
        validate_every=arguments.validate_every,
    )
    record = _last_told(records, arguments)
    if process.ranks.first:
        about = {"validation": record, "settings": settings.to_json()}
        network = trained_network(settings, folder, process.device)
        _write_about(folder, about, network)
        _tell_weights(arguments, store_model("prior", network, folder, about), record)


def _shape(arguments: argparse.Namespace) -> Shape:
    """The network to train, as asked for."""
    from kirigami_studio.generator.network import NetworkShape
    from kirigami_studio.generator.unet import UNetShape

    if arguments.backbone != "unet":
        if arguments.channels is not None or arguments.latent is not None or arguments.residuals is not None:
            raise UsageError("training.channels_without_unet")
        return NetworkShape(loop_points=0) if arguments.feedback is False else NetworkShape()
    if arguments.feedback:
        raise UsageError("training.feedback_with_unet")
    usual = UNetShape()
    latent = arguments.latent or usual.latent
    return UNetShape(
        channels=usual.channels if arguments.channels is None else _channels(arguments.channels),
        residuals=arguments.residuals or usual.residuals,
        latent=latent,
        mask=_mask_pixels(latent),
    )


def _mask_pixels(latent: int) -> int:
    """Pixels of a mask: the paper's 128, or fewer that average to whole ones."""
    from kirigami_studio.foundation.paper import MASK_SIZE

    return max(1, MASK_SIZE // latent) * latent


def _channels(text: str) -> tuple[int, ...]:
    """Channels of each level, separated by commas."""
    try:
        return tuple(int(word) for word in text.split(","))
    except ValueError:
        raise UsageError("training.channels_not_whole", channels=text) from None


def cvae(arguments: argparse.Namespace) -> int:
    """Train the conditional autoencoder of the paper's comparison."""
    return _baseline(arguments, "cvae", {"kl_weight": arguments.kl_weight})


def cgan(arguments: argparse.Namespace) -> int:
    """Train the conditional GAN of the paper's comparison."""
    return _baseline(arguments, "cgan", {}, first_moment=0.5)


def diffusion(arguments: argparse.Namespace) -> int:
    """Train the diffusion model of the paper's comparison."""
    return _baseline(arguments, "diffusion", {"residuals": arguments.residuals})


def _baseline(arguments: argparse.Namespace, kind: str, network: dict[str, float], first_moment: float = 0.9) -> int:
    """Train a baseline, or go on training it, and write its weights into the run folder."""
    return _in_group(arguments, partial(_train_baseline, arguments, kind, network, first_moment))


def _train_baseline(
    arguments: argparse.Namespace,
    kind: str,
    network: dict[str, float],
    first_moment: float,
    process: Process,
) -> None:
    from kirigami_studio.lab.baselines.stored import store_generator
    from kirigami_studio.lab.training.dataset import digest_of_designs
    from kirigami_studio.lab.training.train_baseline import BaselineSettings, train_baseline, trained_baseline
    from kirigami_studio.lab.training.validation import baseline_validator

    seconds = seconds_allowed(arguments)
    designs = _designs(arguments)
    settings = BaselineSettings(
        kind,
        {
            **network,
            "latent": arguments.latent,
            "mask": _mask_pixels(arguments.latent),
            "channels": list(_channels(arguments.channels)),
        },
        steps=arguments.steps,
        batch=arguments.batch,
        learning_rate=arguments.learning_rate,
        first_moment=first_moment,
        average_decay=arguments.average_decay,
        family=_family(arguments, designs),
        designs=digest_of_designs(designs),
        seed=arguments.seed,
    )
    if arguments.still:
        settings = replace(settings, vertex_noise=0.0, turn_noise=0.0)
    folder = Path(arguments.out)
    records = train_baseline(
        settings,
        folder,
        process.device,
        baseline_validator(VALIDATION_COUNT, process.device),
        designs=designs,
        recorded=arguments.recorded,
        seconds=seconds,
        validate_every=arguments.validate_every,
    )
    record = _last_told(records, arguments)
    if process.ranks.first:
        about = {"validation": record, "settings": settings.to_json()}
        made = trained_baseline(settings, folder, process.device)
        _write_about(folder, about, made)
        _tell_weights(arguments, store_generator(kind, made, folder / f"{kind}.safetensors", about), record)


def _sources(arguments: argparse.Namespace) -> Sources:
    """Weights to begin with and fits of drawn shapes, as asked for."""
    from kirigami_studio.lab.training.fitted_fields import FittedFields
    from kirigami_studio.lab.training.train_flow import Sources

    if not 0.0 < arguments.fit_share < 1.0:
        raise UsageError("training.fit_share_out_of_range", share=arguments.fit_share)
    start = None if arguments.warm_start is None else starting_model(arguments.warm_start)
    fits = None if arguments.fits is None else FittedFields.load(Path(arguments.fits))
    return Sources(start, fits, _designs(arguments))


def _designs(arguments: argparse.Namespace) -> Split | None:
    """The data set to train on, if one is given."""
    from kirigami_studio.lab.training.dataset import Split

    return None if arguments.designs is None else Split.load(Path(arguments.designs))


def _family(arguments: argparse.Namespace, designs: Split | None) -> str:
    """Family of the training designs: that of the data set where there is one."""
    return str(arguments.family) if designs is None else str(designs.about["family"])


def grpo(arguments: argparse.Namespace) -> int:
    """Align a generator, or go on aligning it, and write its weights into the run folder."""
    from kirigami_studio.lab.trained_weights import store_model
    from kirigami_studio.lab.training.dataset import digest_of_designs
    from kirigami_studio.lab.training.grpo import GrpoSettings, aligned_network, train_grpo
    from kirigami_studio.lab.training.learner import training_device
    from kirigami_studio.lab.training.ranks import check_alone
    from kirigami_studio.lab.training.validation import group_figures, validator

    check_alone()
    seconds = seconds_allowed(arguments)
    device = training_device(arguments.device, arguments.threads)
    start, designs = starting_model(arguments.start), _designs(arguments)
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
        family=_family(arguments, designs),
        designs=digest_of_designs(designs),
        seed=arguments.seed,
    )
    watched = validator(VALIDATION_COUNT, device, settings.rollout_steps)

    def validate(network: Network) -> dict[str, float]:
        among = group_figures(network, GROUP_COUNT, settings.rollout_steps)
        return watched(network) | {f"structured_{name}": value for name, value in among.items()}

    folder = Path(arguments.out)
    records = train_grpo(
        settings,
        folder,
        device,
        validate,
        start,
        designs=designs,
        seconds=seconds,
        validate_every=arguments.validate_every,
        keep_at=arguments.keep_at,
    )
    record = _last_told(records, arguments)
    about = {"validation": record, "settings": settings.to_json(), "start": start.variant}
    path = store_model(f"grpo-{settings.reward}", aligned_network(folder, start), folder, about)
    _tell_weights(arguments, path, record)
    return 0


def align(arguments: argparse.Namespace) -> int:
    """Align a prior through the sampler, or go on aligning it, and write the variants into the run folder."""
    return _in_group(arguments, partial(_align, arguments))


def _align(arguments: argparse.Namespace, process: Process) -> None:
    from kirigami_studio.lab.trained_weights import store_variants
    from kirigami_studio.lab.training.first_designs import FirstDesigns
    from kirigami_studio.lab.training.train_aligned import VARIANTS, AlignSettings, aligned_network, train_aligned
    from kirigami_studio.lab.training.validation import preference_figures

    seconds = seconds_allowed(arguments)
    shares = {
        "--other-sheets": arguments.other_sheets,
        "--pictured": arguments.pictured,
        "--free-rims": arguments.free_rims,
        "--symmetric": arguments.symmetric,
        "--drawn-share": arguments.drawn_share,
        "--design-share": arguments.design_share or 0.0,
    }
    for option, share in shares.items():
        if share > 1.0:
            raise UsageError("training.share_above_one", option=option, share=share)
    distilling = {
        name: value
        for name in ("design_share", "flow_weight", "likeness_weight")
        if (value := getattr(arguments, name)) is not None
    }
    if distilling and arguments.designs is None:
        options = ", ".join("--" + name.replace("_", "-") for name in distilling)
        raise UsageError("training.nothing_to_distil", options=options)
    prior = starting_model(arguments.start)
    begin = None if arguments.go_on is None else starting_model(arguments.go_on, "accuracy")
    designs = None if arguments.designs is None else FirstDesigns.load(Path(arguments.designs))
    settings = AlignSettings(
        prior=prior.digest,
        begin="" if begin is None else begin.digest,
        steps=arguments.steps,
        batch=arguments.batch,
        drawn=arguments.drawn,
        drawn_share=arguments.drawn_share,
        learning_rate=arguments.learning_rate,
        variation_weight=arguments.variation_weight,
        evenness_weight=arguments.evenness_weight,
        anchor_weight=arguments.anchor_weight,
        other_sheets=arguments.other_sheets,
        pictured_share=arguments.pictured,
        free_rims=arguments.free_rims,
        symmetric_share=arguments.symmetric,
        designs=designs.digest if designs else "",
        **distilling,
        seed=arguments.seed,
        shape=replace(AlignSettings(prior.digest).shape, rims=arguments.free_rims > 0.0),
    )
    folder = Path(arguments.out)

    def validate(network: Network) -> dict[str, float]:
        return preference_figures(network, VALIDATION_COUNT, tuple(VARIANTS.values()), settings.sampling_steps)

    records = train_aligned(
        settings,
        folder,
        process.device,
        validate,
        prior,
        begin,
        designs,
        seconds=seconds,
        validate_every=arguments.validate_every,
    )
    record = _last_told(records, arguments)
    if process.ranks.first:
        network = aligned_network(settings, folder, process.device)
        record = record or validate(network)
        about = {"validation": record, "settings": settings.to_json()}
        _tell_weights(arguments, store_variants("aligned", VARIANTS, network, folder, about), record)


def _write_about(folder: Path, about: Mapping[str, object], network: Network | ConditionalGenerator) -> None:
    """Write how a network was trained, and its size, beside its log, where the benchmark report reads it."""
    size = sum(weights.numel() for weights in network.parameters())
    write_atomically(folder / "about.json", (json.dumps({**about, "parameters": size}, indent=2) + "\n").encode())


def _tell_weights(arguments: argparse.Namespace, path: Path, record: dict[str, float]) -> None:
    """Say where weights are, and in JSON what they scored last."""
    if arguments.json:
        print_json({"files": [str(path)], "record": record})
    else:
        say(f"Weights: {path}")


def seconds_allowed(arguments: argparse.Namespace) -> float:
    """Wall time of a run by ``--minutes``; infinite without."""
    if arguments.minutes is None:
        return float("inf")
    if arguments.minutes <= 0:
        raise UsageError("training.minutes_not_positive", minutes=arguments.minutes)
    return 60.0 * float(arguments.minutes)


def starting_model(name: str, bundled: str = "prior") -> Model:
    """The weights that a run begins with: ``bundled`` ones, or a .safetensors file beside its manifest."""
    from kirigami_studio.generator.weights import load_model
    from kirigami_studio.lab.trained_weights import load_weights

    if name == "bundled":
        return load_model(bundled)
    return load_weights(Path(name))
