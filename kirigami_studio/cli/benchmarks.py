"""``benchmark``: every figure that README and model card quote, from one command each."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path

from kirigami_studio.cli.console import ProgressLine, plain, print_json, say
from kirigami_studio.cli.inputs import read_targets
from kirigami_studio.cli.option_types import parse_grid
from kirigami_studio.foundation.errors import UsageError
from kirigami_studio.foundation.files import write_atomically
from kirigami_studio.lattice.deployment import deploy
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.outlines.outline import Outline
from kirigami_studio.outlines.read_image import outline_of_mask
from kirigami_studio.outlines.silhouettes import load, names
from kirigami_studio.pipeline.request import POLISH_STEPS

#: Samples and targets of a family where ``--k`` and ``--count`` do not say.
SPREAD_K, SPREAD_TARGETS, ROBUSTNESS_TARGETS = 32, 50, 100
#: Designs that are drawn near each other where ``--k`` does not say.
NEARNESS_K = 8
#: Designs that are planned and checked where ``--count`` does not say.
FABRICATED_DESIGNS = 200


def benchmark(arguments: argparse.Namespace) -> int:
    """Run one suite, print its figures and write them where asked."""
    line = ProgressLine()
    results = SUITES[arguments.suite](arguments, line)
    line.clear()
    if arguments.out is not None:
        write_atomically(Path(arguments.out), (json.dumps(plain(results), indent=2) + "\n").encode())
    if arguments.json:
        print_json(results)
    else:
        say(json.dumps(plain(results), indent=2))
    return 0


def _generator_suite(arguments: argparse.Namespace, line: ProgressLine) -> dict[str, object]:
    """A bundled variant on the named targets, or on the test splits of both families."""
    from kirigami_studio.benchmark.generator_suite import measure_generator

    results: dict[str, object] = {}
    for family, outlines in _target_sets(arguments).items():
        results[family] = measure_generator(
            outlines,
            arguments.variant,
            k=arguments.k or 1,
            steps=arguments.steps,
            polish=arguments.polish,
            grid=parse_grid(arguments.grid),
            seeds=tuple(arguments.seeds),
            report=lambda done, total, family=family: line.show(f"{family}: {done} of {total}"),  # type: ignore[misc]
        )
    return results


def _polish_suite(arguments: argparse.Namespace, line: ProgressLine) -> dict[str, object]:
    """The fit alone, from the uniform sheet or by continuation."""
    from kirigami_studio.benchmark.polish_suite import measure_polish

    return {
        family: measure_polish(
            outlines,
            grid=parse_grid(arguments.grid),
            steps=arguments.polish or 40,
            effort=arguments.effort,
            report=lambda done, total, family=family: line.show(f"{family}: {done} of {total}"),  # type: ignore[misc]
        )
        for family, outlines in _target_sets(arguments).items()
    }


def _designs_suite(arguments: argparse.Namespace, line: ProgressLine) -> dict[str, object]:
    """The whole program on targets, shape by shape, with pictures where asked for."""
    from kirigami_studio.benchmark.design_suite import design_figures, make_designs, worst_of, write_contact_sheet
    from kirigami_studio.pipeline.request import Request

    results: dict[str, object] = {}
    for family, outlines in _target_sets(arguments).items():
        requests = [
            [
                Request(
                    outline,
                    parse_grid(grid),
                    k=arguments.k or 1,
                    seed=arguments.seeds[0],
                    variant=arguments.variant,
                    steps=arguments.steps,
                    polish=arguments.polish,
                    prefer=arguments.prefer,
                    search=arguments.effort or 0,
                    trim=arguments.trim,
                )
                for grid in arguments.grid.split(",")
            ]
            for outline in outlines
        ]
        made = make_designs(requests, lambda done, total, family=family: line.show(f"{family}: {done} of {total}"))  # type: ignore[misc]
        results[family] = design_figures(made)
        if arguments.picture is not None:
            shown = made if arguments.worst is None else worst_of(made, arguments.worst)
            write_contact_sheet(shown, Path(arguments.picture))
    return results


def _regularity_suite(arguments: argparse.Namespace, line: ProgressLine) -> dict[str, object]:
    """Agreement and total variation, unpolished and at every preference."""
    from kirigami_studio.benchmark.polish_suite import measure_regularity

    return {
        family: measure_regularity(
            outlines,
            arguments.variant,
            polish=arguments.polish or POLISH_STEPS,
            grid=parse_grid(arguments.grid),
            seed=arguments.seeds[0],
            report=lambda done, total, family=family: line.show(f"{family}: {done} of {total}"),  # type: ignore[misc]
        )
        for family, outlines in _target_sets(arguments).items()
    }


def _variants_suite(arguments: argparse.Namespace, line: ProgressLine) -> dict[str, object]:
    """Bundled variants side by side, each beside the prior."""
    from kirigami_studio.benchmark.variants_suite import measure_variants

    variants = _variants(arguments)
    return {
        family: measure_variants(
            outlines,
            variants,
            k=arguments.k or 1,
            steps=arguments.steps,
            grid=parse_grid(arguments.grid),
            seeds=tuple(arguments.seeds),
            report=lambda done, total, family=family: line.show(f"{family}: {done} of {total}"),  # type: ignore[misc]
        )
        for family, outlines in _target_sets(arguments).items()
    }


def _spread_suite(arguments: argparse.Namespace, line: ProgressLine) -> dict[str, object]:
    """How much the samples for one target differ, variant by variant."""
    from kirigami_studio.benchmark.variants_suite import measure_spread

    variants = _variants(arguments)
    return {
        family: measure_spread(
            outlines,
            variants,
            k=arguments.k or SPREAD_K,
            steps=arguments.steps,
            grid=parse_grid(arguments.grid),
            seed=arguments.seeds[0],
            report=lambda done, total, family=family: line.show(f"{family}: {done} of {total}"),  # type: ignore[misc]
        )
        for family, outlines in _target_sets(arguments, SPREAD_TARGETS).items()
    }


def _nearness_suite(arguments: argparse.Namespace, line: ProgressLine) -> dict[str, object]:
    """How near samples lie to a design that they were asked to be like."""
    from kirigami_studio.benchmark.nearness_suite import measure_nearness

    return {
        family: measure_nearness(
            outlines,
            arguments.variant,
            k=arguments.k or NEARNESS_K,
            steps=arguments.steps,
            polish=arguments.polish,
            grid=parse_grid(arguments.grid),
            seed=arguments.seeds[0],
            report=lambda done, total, family=family: line.show(f"{family}: {done} of {total}"),  # type: ignore[misc]
        )
        for family, outlines in _target_sets(arguments, SPREAD_TARGETS).items()
    }


def _robustness_suite(arguments: argparse.Namespace, line: ProgressLine) -> dict[str, object]:
    """What turned, shaky, coarse and fine drawings cost, variant by variant."""
    from kirigami_studio.benchmark.robustness_suite import measure_robustness

    # The suite draws the exact shapes into pixels itself.
    sets = _target_sets(arguments, ROBUSTNESS_TARGETS, exact=True)
    return {
        family: {
            variant: measure_robustness(
                outlines,
                variant,
                steps=arguments.steps,
                polish=arguments.polish,
                grid=parse_grid(arguments.grid),
                seeds=tuple(arguments.seeds),
                report=lambda done, total, of=f"{family}, {variant}": line.show(f"{of}: {done} of {total}"),  # type: ignore[misc]
            )
            for variant in _variants(arguments)
        }
        for family, outlines in sets.items()
    }


def _generation_speed_suite(arguments: argparse.Namespace, line: ProgressLine) -> dict[str, object]:
    """Timings of loading and sampling, variant by variant."""
    from kirigami_studio.benchmark.speed_suite import generation_timings

    line.show("Timing the generator")
    return generation_timings(
        _variants(arguments),
        steps=arguments.steps,
        grid=parse_grid(arguments.grid),
        report=lambda done, total: line.show(f"Timing the generator: {done} of {total} variants"),
    )


def _speed_suite(arguments: argparse.Namespace, line: ProgressLine) -> dict[str, object]:
    """Timings of scoring and polishing."""
    from kirigami_studio.benchmark.speed_suite import polish_timings

    line.show("Timing scores and fits")
    return polish_timings()


def _lattice_suite(arguments: argparse.Namespace, line: ProgressLine) -> dict[str, object]:
    """Timings of the exact geometry, with the ratio to the marching reference."""
    from kirigami_studio.benchmark.lattice_suite import lattice_timings

    line.show("Timing the lattice")
    return dict(lattice_timings())


def _fabrication_suite(arguments: argparse.Namespace, line: ProgressLine) -> dict[str, object]:
    """Timings of plan, check and DXF, travel of the orders of cutting, and random designs planned and checked."""
    from kirigami_studio.benchmark.fabrication_suite import measure_fabrication

    line.show("Timing plans and orders")
    return measure_fabrication(
        arguments.count or FABRICATED_DESIGNS,
        arguments.seeds[0],
        report=lambda done, total: line.show(f"Random designs: {done} of {total}"),
    )


def _variants(arguments: argparse.Namespace) -> tuple[str, ...]:
    """The variants that ``--variants`` names, or all that are bundled.

    Raises
    ------
    UsageError
        One of them is not bundled.
    """
    from kirigami_studio.generator.weights import digest_of
    from kirigami_studio.generator.weights import variants as bundled

    if arguments.variants is None:
        return bundled()
    named = tuple(dict.fromkeys(name.strip() for name in arguments.variants.split(",")))
    for name in named:
        digest_of(name)
    return named


def _target_sets(
    arguments: argparse.Namespace, usual: int | None = None, exact: bool = False
) -> dict[str, list[Outline]]:
    """Named lists of targets: ``--targets``, or a split of both families, of ``usual`` size unless told otherwise."""
    if arguments.targets == ["library"]:
        return {"library": [load(name) for name in names()]}
    if arguments.targets:
        found = [named.read() for named in read_targets(arguments.targets)]
        if not found:
            raise UsageError("No targets were found to measure on.")
        return {"targets": found}
    from kirigami_studio.training.dataset import SPLITS, generate_split

    size, offset = SPLITS[arguments.split]
    count = arguments.count or usual or size
    sets = {}
    for family in ("structured", "sobol"):
        split = generate_split(family, count, arguments.data_seed * len(SPLITS) + offset)
        if exact or arguments.exact:
            layouts = [deploy(RatioField(ratio)).outline(0.0) for ratio in split.ratios]
            sets[family] = [Outline.from_points(layout, f"{family} {k}") for k, layout in enumerate(layouts)]
        else:
            sets[family] = [outline_of_mask(mask, f"{family} {number}") for number, mask in enumerate(split.masks)]
    return sets


SUITES: dict[str, Callable[[argparse.Namespace, ProgressLine], dict[str, object]]] = {
    "generator": _generator_suite,
    "variants": _variants_suite,
    "spread": _spread_suite,
    "nearness": _nearness_suite,
    "robustness": _robustness_suite,
    "generation-speed": _generation_speed_suite,
    "polish": _polish_suite,
    "designs": _designs_suite,
    "regularity": _regularity_suite,
    "speed": _speed_suite,
    "lattice": _lattice_suite,
    "fabrication": _fabrication_suite,
}
